"""Attack navsym on purpose and print the figures: mutants, damaged files, killed writers, full disks and more."""

from __future__ import annotations

import sys
import time
from typing import Annotated, Any

import typer

from navsym.cli._choice import one_of
from navsym.cli._progress import Progress
from navsym.cli.output import emit, table

#: Campaign -> what is attacked, for the table of TRUST.md.
NAMES = {
    "mutants": "mutants of the formulas",
    "parser": "damaged files, and files that lie about their size",
    "fuzz": "every reader of files by inputs that coverage guides",
    "certificates": "altered certificates",
    "kills": "writers of the store killed at random moments",
    "disk": "full disk, read-only folder, stale lock, clock set back",
    "engines": "engines: known wrong answers",
    "identities": "textbook identities and their near misses",
    "filters": "NEES and NIS over 10,000 runs; every linear case against least squares",
    "fidelity": "what is decided is what is printed: every claim",
    "checker-mutants": "mutants of the checker itself",
}
#: Campaigns that are tables of cases: where they are, and how many are one batch.
TESTED = {
    "engines": ("tests/engines", 10),
    "identities": ("tests/prove/test_textbook.py", 40),
    "filters": ("tests/honesty", 30),
    "fidelity": ("tests/fidelity", 8),
    "checker-mutants": ("tests/checker/mutants.py", 24),
}
INPUTS = {"kills": 200}  # otherwise ten thousand


def command(
    name: Annotated[str, typer.Argument(help=" | ".join(NAMES))],
    modules: Annotated[list[str] | None, typer.Argument(help="papers, for mutants; default: all")] = None,
    share: Annotated[float, typer.Option(min=0.0, max=1.0, help="share of the mutants that are tried")] = 1.0,
    inputs: Annotated[
        int | None, typer.Option(min=1, help="number of damaged files, certificates or kills; default 10000, 200 kills")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="seed of the random choices")] = 0,
    jobs: Annotated[int, typer.Option(min=1, help="batches at the same time")] = 1,
    seconds: Annotated[float, typer.Option(min=1.0, help="limit for one batch, seconds")] = 3600.0,
    fresh: Annotated[bool, typer.Option("--fresh", help="do everything again, ignoring what is kept")] = False,
    markdown: Annotated[bool, typer.Option("--markdown", help="print the row for TRUST.md")] = False,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> int:
    """Run a campaign; it resumes where it was stopped. Status 1 when anything wrong was found.

    Example: navsym campaign mutants guaranteed_velocity --share 0.02 --jobs 2
    """
    one_of(name, NAMES, "NAME")
    started = time.monotonic()
    chosen = chosen_batches(name, modules or [], share, inputs or INPUTS.get(name, 10_000), seed)
    document = in_batches(name, *chosen, jobs=jobs, seconds=seconds, fresh=fresh)
    spent = time.monotonic() - started
    emit(document, as_json=json_, text=lambda: row(document, spent) if markdown else as_text(document))
    return 1 if document["wrong"] or document["stopped"] or document["unsaved"] else 0


def chosen_batches(name: str, modules: list[str], share: float, inputs: int, seed: int) -> tuple[Any, Any]:
    """The batches of a campaign and their judge."""
    from navsym.core.store import default_path
    from navsym.studies.campaigns import certificates, disks, fuzz, kills, mutants, parser

    if name in TESTED:
        return tested(name)
    if name == "mutants":
        claims = [claim for module in papers(modules) for claim in module.claims]
        return mutants.batches(claims, share, seed), mutants.judge
    if name == "parser":
        return parser.batches(inputs, seed), parser.judge
    if name == "fuzz":
        return fuzz.batches(inputs, default_path().with_name("corpus"), seed), fuzz.judge
    if name == "kills":
        return kills.batches(inputs, seed), kills.judge
    if name == "disk":
        return disks.batches(), disks.judge
    honest = certificates.honest_certificates()
    return certificates.batches(honest, inputs, seed), certificates.judge


def tested(name: str) -> tuple[Any, Any]:
    """The cases of a table under tests/, and pytest as their judge."""
    from navsym.claims.paper import papers_folder
    from navsym.core.errors import NavsymError
    from navsym.studies.campaigns import cases

    root, (place, size) = papers_folder().parent, TESTED[name]
    if not (root / place).exists():
        raise NavsymError(f"expected {place}; got an installation without tests; run it from a checkout")
    return cases.batches(root, place, size), cases.judge


def in_batches(name: str, batches: Any, judge: Any, *, jobs: int, seconds: float, fresh: bool) -> dict[str, Any]:
    """Judge the batches, those first that are not kept from an earlier run."""
    from navsym.core.store import opened
    from navsym.studies.campaigns.registry import run_campaign

    if fresh:
        with Progress("batches", resume="with --fresh nothing is kept: leave it out to be able to go on") as bar:
            return run_campaign(name, batches, judge, jobs=jobs, seconds=seconds, progress=bar.told_by_job)
    with opened() as store, Progress("batches", resume="they are kept: the same command goes on from there") as bar:
        return run_campaign(name, batches, judge, store=store, jobs=jobs, seconds=seconds, progress=bar.told_by_job)


def papers(names: list[str]) -> list[Any]:
    from navsym.claims.paper import import_paper, paper_names
    from navsym.verification.decide import paper_module

    return [paper_module(import_paper(name)) for name in names or paper_names()]


def row(document: dict[str, Any], seconds: float) -> str:
    """The row of the table in TRUST.md: what was attacked, the command, the outcome, the date."""
    import datetime
    import shlex

    words = shlex.join(word for word in sys.argv[1:] if word not in ("--markdown", "--fresh"))
    said = [f"{count:,} {outcome}" for outcome, count in document["counts"].items() if not is_kind(outcome)]
    said += [f"{len(document[name])} {name}" for name in ("wrong", "stopped") if document[name] or name == "wrong"]
    if document["measured"]:
        said.append(f"slowest {max(row['slowest'] for row in document['measured'].values()):.2f} s")
    took = f"{seconds / 60:.0f} min" if seconds > 90 else f"{seconds:.0f} s"
    took += f", {document['resumed']} of {document['batches']} batches kept from before" * bool(document["resumed"])
    date = datetime.date.today().isoformat()
    return f"| {NAMES[document['campaign']]} | `navsym {words}` | {', '.join(said)} ({took}) | {date} |"


def is_kind(outcome: str) -> bool:
    """Counts by the kind of change stand beside those by outcome."""
    return outcome.startswith("kind ")


def of_readers(measured: dict[str, dict[str, float]]) -> str:
    """The table of what was measured: a reader in each row."""
    names = list(next(iter(measured.values())))
    return table(("reader", *names), [(reader, *(f"{row[n]:g}" for n in names)) for reader, row in measured.items()])


def as_text(document: dict[str, Any]) -> str:
    rows = [(outcome, str(count)) for outcome, count in document["counts"].items()]
    lines = [table((document["campaign"], "count"), rows)]
    if document["measured"]:
        lines.append(of_readers(document["measured"]))
    lines.append(f"{document['batches']} batches, {document['resumed']} resumed, wrong: {len(document['wrong'])}")
    lines += [f"wrong: {item}" for item in document["wrong"][:20]]
    lines += [f"open: {item}" for item in document["open"][:20]]
    lines += [f"stopped: {item}" for item in document["stopped"][:20]]
    lines += [f"not kept: {item}" for item in document["unsaved"][:20]]
    return "\n".join(lines)
