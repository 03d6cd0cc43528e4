"""Decide every claim of the papers and compare each verdict with the one its source declares."""

from __future__ import annotations

import textwrap
import time
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli._progress import Progress
from navsym.cli.output import Told, remark, table
from navsym.core.errors import NavsymError

if TYPE_CHECKING:
    from navsym.claims import Record
    from navsym.verification.ledger import Ledger

WIDTH = 100
RESUME = "the certificates so far are kept: the same command (without --fresh) goes on from there"


def command(
    modules: list[str] | None = None,
    *,
    workspace: bool = False,
    write: bool = False,
    jobs: int | None = None,
    seconds: float = 90.0,
    fresh: bool = False,
) -> Told:
    """Decide every claim of the papers. Status 1 when a verdict is not the one declared.

    Status 3 when every verdict is as declared but some of a ledger could not be kept; they are named.

    Every statement is built from its source. Where a certificate is kept for it, the checker grants it again.

    Example: navsym verify guaranteed_velocity
    """
    from navsym.claims.workspace import FILE, find_workspace
    from navsym.verification.ledger import ledger_file

    if workspace and find_workspace() is None:
        message = "expected a workspace; got a folder without one; run navsym init here, or name files to verify"
        raise NavsymError(message, where=FILE, kind="missing-file")
    started = time.monotonic()
    with Progress("claims", resume=RESUME) as bar:
        ledger = nav.verify(
            *(modules or []), jobs=jobs, seconds=seconds, fresh=fresh, progress=bar.follow, remark=remark
        )
    if write or not ledger_file().exists():
        try:
            ledger.write()
        except NavsymError as error:  # what was decided is printed all the same
            remark(f"the ledger is not written: {error}")
            ledger = replace(ledger, unsaved=tuple(record.id for record in ledger))
    status = 1 if ledger.unexpected or ledger.missing else 3 if ledger.unsaved and ledger.is_kept else 0
    return Told(ledger.document, lambda: as_text(ledger, time.monotonic() - started), status)


def as_text(ledger: Ledger, seconds: float) -> str:
    """A table in the order of the papers, and below it what is refuted and the counts: the end is what one sees."""
    from navsym.claims.display import count_in_words as counted

    papers = ledger.by_paper()
    several = len(papers) > 1  # each has an equation (1)
    every = [r for _, records in papers for r in records]
    rows = [(r.id if several else r.number, str(r.status), r.title, remark_of(r)) for r in every]
    blocks = [table(("claim", "verdict", "what it says", "remark"), rows)]
    for paper, records in papers:
        numbered = [counted(paper.equations, "numbered equation"), f"{paper.claimed} claimed"]
        numbered += [counted(paper.definitions, "definition"), f"missing: {', '.join(paper.missing) or 'none'}"]
        blocks.append(f"{paper.module}: {', '.join(numbered) if paper.equations else counted(len(records), 'claim')}")
        blocks += refuted_lines(records)
    statuses = ", ".join(f"{count} {status}" for status, count in ledger.counts.items() if count)
    blocks.append(f"{counted(len(ledger), 'claim')} in {seconds:.1f} s: {statuses}")
    if unchecked := ledger.unchecked:
        told = f"{counted(len(unchecked), 'verdict')}, {unchecked[0].id} first"
        blocks.append(f"unchecked, because the checker has no certificate of them: {told}; navsym show says why")
    return "\n".join([*blocks, compare_line(ledger), *unexpected_lines(ledger.unexpected)])


def compare_line(ledger: Ledger) -> str:
    """How the ledger as it was last written compares with these verdicts."""
    from navsym.claims.display import count_in_words as counted
    from navsym.verification.ledger import ledger_file

    if not ledger.is_kept:
        return "the verdicts of files are kept in a workspace; navsym init makes one"
    try:
        changed = ledger.changed
    except NavsymError as error:
        return f"the ledger cannot be compared: {error}"
    if changed:
        return f"the ledger differs in {counted(len(changed), 'claim')}, {changed[0]} first; --write updates it"
    return f"the ledger {ledger_file().name} agrees"


def refuted_lines(records: Sequence[Record]) -> list[str]:
    """The numbers of what is refuted, and how to ask why."""
    refuted = [record for record in records if record.status == "REFUTED"]
    if not refuted:
        return []
    listed = f"  refuted: {', '.join(record.number for record in refuted)}"
    told = textwrap.wrap(listed, WIDTH, subsequent_indent=" " * 11, break_on_hyphens=False)
    return [*told, f"  why: navsym explain {refuted[0].id}"]


def unexpected_lines(wrong: Sequence[Record]) -> list[str]:
    """A line for each verdict that is another one, with what helps where only time was short."""
    lines = [f"not as declared: {r.id} is {r.status}, declared {r.expect}: {r.evidence}" for r in wrong]
    if any(record.method == "none" for record in wrong):
        lines.append("give an OPEN claim more time with --seconds, or less company with --jobs 1; the others are kept")
    return lines


def remark_of(record: Record) -> str:
    """What is wrong, what is corrected, or for what it holds."""
    if record.status == "REFUTED":
        where = f"(at {record.point_text})" if record.point_text else ""
        return f"{': '.join(filter(None, (record.slip, record.reason)))} {where}".strip()
    if record.corrects:
        return f"corrects {record.corrects.partition(':')[2]}"
    text = "; ".join(record.assumptions) or record.scope
    return text if len(text) <= WIDTH + 10 else text[: WIDTH + 9] + "…"
