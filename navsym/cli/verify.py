"""Decide every claim of the papers and compare each verdict with the one its source declares."""

from __future__ import annotations

import textwrap
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from navsym.claims.paper import import_paper, paper_names, papers_folder
from navsym.cli._choice import one_of
from navsym.cli._progress import Progress
from navsym.cli.output import emit, remark, table, write_text

if TYPE_CHECKING:
    from navsym.claims import Paper
    from navsym.verification.decide import PaperModule
    from navsym.verification.fingerprints import Snapshot

WIDTH = 100


def command(
    modules: Annotated[list[str] | None, typer.Argument(help="derivation modules; default: all")] = None,
    write: Annotated[
        bool, typer.Option("--write", help="write the verdicts to the ledger derivations/verdicts.json")
    ] = False,
    jobs: Annotated[int | None, typer.Option(help="claims decided at the same time; default: one per core")] = None,
    seconds: Annotated[
        float, typer.Option(help="limit for one claim, seconds of processor time; above it the verdict is OPEN")
    ] = 90.0,
    fresh: Annotated[bool, typer.Option("--fresh", help="decide everything again, ignoring what is kept")] = False,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> int:
    """Decide every claim of the papers. Status 1 when a verdict is not the one declared.

    Status 3 when all are but some could not be kept; they are named.

    Verdicts are kept, so that a stopped run goes on and a second one takes seconds.

    Example: navsym verify guaranteed_velocity
    """
    from navsym.verification.decide import unexpected

    started = time.monotonic()
    before = sources()
    chosen = load(modules or [])
    document = decided(chosen, jobs, seconds, fresh, before)
    if write or not ledger_file().exists():
        write_ledger(document)
    changed = differences(document)
    wrong = unexpected(document["claims"])
    missing = [number for paper in document["papers"] for number in paper["missing"]]
    spent = time.monotonic() - started
    emit(document, as_json=json_, text=lambda: as_text(document, cards_of(chosen), wrong, changed, spent))
    return 1 if wrong or missing else 3 if document.get("unsaved") else 0


def cards_of(chosen: Sequence[PaperModule]) -> dict[str, Paper]:
    """The cards of papers by module."""
    return {module.name: module.paper for module in chosen}


def load(wanted: Sequence[str]) -> list[PaperModule]:
    """Import the modules asked for, or all of them."""
    from navsym.verification.decide import paper_module

    known = paper_names()
    for name in wanted:
        one_of(name, known, "command line")
    chosen = list(dict.fromkeys(wanted)) or known
    return [paper_module(import_paper(name)) for name in chosen]


def sources() -> Snapshot:
    """What the sources of the derivations and of the deciding rooms are now."""
    from navsym.verification.fingerprints import snapshot

    return snapshot(papers_folder())


def decided(
    chosen: Sequence[PaperModule], jobs: int | None, seconds: float, fresh: bool, before: Snapshot | None = None
) -> dict[str, Any]:
    """The document of all verdicts: those that are kept and still valid, the others decided now and kept.

    before : the sources before they were imported; by default what they are now
    """
    from navsym.verification.decide import verify

    kept = KeptVerdicts(chosen, fresh, before or sources())
    missing = len(kept.keys) - len(kept.known)
    if kept.known and missing:
        remark(f"{len(kept.known)} of {len(kept.keys)} claims are as they were, {missing} are decided now")
    resume = "the verdicts so far are kept: the same command (without --fresh) goes on from there"
    try:
        with Progress("claims", missing, resume) as bar:

            def step(record: dict[str, Any]) -> None:
                kept.keep(record)
                bar.step(record["id"])

            document = verify(chosen, jobs=jobs, seconds=seconds, known=kept.known, progress=step)
    finally:
        kept.close()
    return {**document, "unsaved": kept.lost} if kept.lost else document


class KeptVerdicts:
    """Verdicts of earlier runs whose claims and rooms have not changed; what could not be kept is in ``lost``."""

    def __init__(self, chosen: Sequence[PaperModule], fresh: bool, before: Snapshot):
        from navsym.core.store import Store, StoreError
        from navsym.verification.fingerprints import fingerprints, not_yet_imported

        self.keys = fingerprints(claim for module in chosen for claim in module.claims)
        self.mixed = sources() != before
        self.later = not_yet_imported(sources())
        self.known: dict[str, dict[str, Any]] = {}
        self.store: Store | None = None
        self.lost: list[str] = []
        try:
            self.store = Store()
            records = {} if fresh else self.store.get(self.keys.values())
            self.known = {name: records[key] for name, key in self.keys.items() if key in records}
        except StoreError as error:
            self.lost = [name for name in self.keys if name not in self.known]
            if self.store is not None:
                self.store.close()
            self.store = None  # what cannot be read is not written either, and named once
            remark(f"verdicts are not kept: {error}")

    def keep(self, record: dict[str, Any]) -> None:
        """Keep a verdict, unless it ran out of time, which another run may not."""
        from navsym.core.store import StoreError

        if self.store is None or record["method"] == "none":
            return  # without a store all are named as lost already
        try:
            if self.mixed or not set(self.later) <= set(sources()):
                raise StoreError("expected sources that stay as they are; got changed ones; run it again")
            self.store.put(self.keys[record["id"]], record)
        except StoreError as error:
            if not self.lost:
                remark(f"verdicts are not kept any more: {error}")
            self.lost.append(record["id"])

    def close(self) -> None:
        if self.store is not None:
            self.store.close()
        if self.lost:
            remark(f"not kept: {len(self.lost)} verdicts: {', '.join(self.lost[:12])}{' …' * (len(self.lost) > 12)}")


def ledger_file() -> Path:
    return papers_folder() / "verdicts.json"


def differences(document: dict[str, Any]) -> list[str]:
    """Claims whose verdict is not the one in the ledger, or that it does not have."""
    from navsym.verification.ledger import read_ledger

    stored = read_ledger(ledger_file())
    return [r["id"] for r in document["claims"] if stored.get(r["id"], {}).get("status") != r["status"]]


def write_ledger(document: dict[str, Any]) -> None:
    """Update ``verdicts.json`` and ``README.md`` of the derivations."""
    import json

    from navsym.verification.ledger import ledger_text, merged, people_text

    path = ledger_file()
    old = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {"claims": [], "papers": []}
    whole = merged(document, {record["id"]: record for record in old["claims"]}, old["papers"])
    write_text(path, ledger_text(whole))
    write_text(papers_folder() / "README.md", people_text(whole, cards_of(load([]))))


def as_text(
    document: dict[str, Any],
    cards: Mapping[str, Paper],
    wrong: list[dict[str, Any]],
    changed: list[str],
    seconds: float,
) -> str:
    """A table in the order of the papers, and below it what is refuted and the counts: the end is what one sees."""
    from navsym.verification.ledger import papers_in_order

    papers = papers_in_order(document, cards)
    rows = [(r["number"], r["status"], r["title"], remark_of(r)) for _, records in papers for r in records]
    blocks = [table(("claim", "verdict", "what it says", "remark"), rows)]
    for paper, records in papers:
        blocks.append(
            f"{paper['module']}: {paper['equations']} numbered equations, {paper['claimed']} claimed, "
            f"{paper['definitions']} definitions, missing: {', '.join(paper['missing']) or 'none'}"
        )
        blocks += refuted_lines(records)
    counted = ", ".join(f"{count} {status}" for status, count in document["counts"].items() if count)
    blocks.append(f"{len(document['claims'])} claims in {seconds:.1f} s: {counted}")
    if changed:
        blocks.append(f"the ledger differs in {len(changed)} claims, {changed[0]} first; --write updates it")
    else:
        blocks.append(f"the ledger {ledger_file().name} agrees")
    return "\n".join(blocks + not_as_declared(wrong))


def refuted_lines(records: Sequence[Mapping[str, Any]]) -> list[str]:
    """The numbers of what is refuted, and how to ask why."""
    refuted = [record for record in records if record["status"] == "REFUTED"]
    if not refuted:
        return []
    listed = f"  refuted: {', '.join(record['number'] for record in refuted)}"
    told = textwrap.wrap(listed, WIDTH, subsequent_indent=" " * 11, break_on_hyphens=False)
    return [*told, f"  why: navsym explain {refuted[0]['id']}"]


def not_as_declared(wrong: Sequence[dict[str, Any]]) -> list[str]:
    """A line for each verdict that is another one, with what helps where only time was short."""
    lines = [f"not as declared: {r['id']} is {r['status']}, declared {r['expect']}: {r['evidence']}" for r in wrong]
    if any(record["method"] == "none" for record in wrong):
        lines.append("give an OPEN claim more time with --seconds, or less company with --jobs 1; the others are kept")
    return lines


def remark_of(record: Mapping[str, Any]) -> str:
    if record["status"] == "REFUTED":
        point = ", ".join(f"{k} = {v}" for k, v in (record["counterexample"] or {}).items())
        where = f" (at {point})" if point else ""
        slip = f"{record['slip']}: " if record["slip"] else ""
        return f"{slip}{record['reason']}{where}"
    if record["corrects"]:
        return f"corrects {record['corrects'].partition(':')[2]}"
    return shortened("; ".join(record["assumptions"]) or record["scope"])


def shortened(text: str, width: int = 110) -> str:
    """The text, or its beginning with an ellipsis; the JSON document has it whole."""
    return text if len(text) <= width else text[: width - 1] + "…"
