"""Attack navsym on purpose and print the figures: mutants, engines, parser, certificates, identities."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from navsym.cli._progress import Progress
from navsym.cli.output import emit, table

NAMES = ("mutants", "engines", "parser", "certificates", "identities")
TESTED = {"engines": "tests/engines", "identities": "tests/proof/test_textbook.py"}


def command(
    name: Annotated[str, typer.Argument(help=" | ".join(NAMES))],
    modules: Annotated[list[str] | None, typer.Argument(help="papers, for mutants; default: all")] = None,
    share: Annotated[float, typer.Option(min=0.0, max=1.0, help="share of the mutants that are tried")] = 1.0,
    inputs: Annotated[
        int, typer.Option(min=1, help="number of inputs, for parser and certificates"),
    ] = 10_000,
    seed: Annotated[int, typer.Option(min=0, help="seed of the random choices")] = 0,
    jobs: Annotated[int, typer.Option(min=1, help="batches at the same time")] = 1,
    seconds: Annotated[float, typer.Option(min=1.0, help="limit for one batch, seconds")] = 3600.0,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="do everything again, ignoring what is kept"),
    ] = False,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> int:
    """Run a campaign; it resumes where it was stopped. Status 1 when anything wrong was found.

    Example: navsym campaign mutants guaranteed_velocity --share 0.02 --jobs 2
    """
    from navsym.errors import DomainError

    if name not in NAMES:
        raise DomainError(f"expected one of {', '.join(NAMES)}; got {name}; correct the name", where="NAME")
    document = (
        by_tests(name)
        if name in TESTED
        else in_batches(name, modules or [], share, inputs, seed, jobs, seconds, fresh)
    )
    emit(document, as_json=json_, text=lambda: as_text(document))
    return 1 if document["wrong"] or document["stopped"] else 0


def in_batches(
    name: str,
    modules: list[str],
    share: float,
    inputs: int,
    seed: int,
    jobs: int,
    seconds: float,
    fresh: bool,
) -> dict[str, Any]:
    from navsym.methods import campaign_certificates, campaign_mutants, campaign_parser
    from navsym.methods.campaign import run_campaign
    from navsym.store import opened

    judge: Any
    if name == "mutants":
        chosen = [claim for module in papers(modules) for claim in module.claims]
        batches, judge = campaign_mutants.batches(chosen, share, seed), campaign_mutants.judge
    elif name == "parser":
        batches, judge = campaign_parser.batches(inputs, seed), campaign_parser.judge
    else:
        batches = campaign_certificates.batches(campaign_certificates.honest_certificates(), inputs, seed)
        judge = campaign_certificates.judge
    if fresh:
        with Progress("batches", resume="with --fresh nothing is kept: leave it out to be able to go on") as bar:
            return run_campaign(name, batches, judge, jobs=jobs, seconds=seconds, progress=bar.told_by_job)
    with opened() as store, Progress("batches", resume="they are kept: the same command goes on from there") as bar:
        return run_campaign(
            name, batches, judge, store=store, jobs=jobs, seconds=seconds, progress=bar.told_by_job
        )


def papers(names: list[str]) -> list[Any]:
    import importlib

    from navsym.cli import verify
    from navsym.methods.verification import paper_module

    chosen = names or verify.names()
    return [paper_module(importlib.import_module(f"derivations.{name}")) for name in chosen]


def by_tests(name: str) -> dict[str, Any]:
    """Campaigns that are tables of cases under tests/: one outcome for each case, from pytest's own record."""
    import subprocess
    import sys
    import tempfile

    from navsym.cli.verify import ledger_folder
    from navsym.errors import NavsymError

    path = ledger_folder().parent / TESTED[name]
    if not path.exists():
        raise NavsymError(
            f"expected {TESTED[name]}; got an installation without tests; run it from a checkout"
        )
    with tempfile.TemporaryDirectory() as folder:
        record = Path(folder) / "record.xml"
        subprocess.run(
            [
                sys.executable,
                "-m",
                "pytest",
                "-q",
                "-p",
                "no:cacheprovider",
                f"--junitxml={record}",
                str(path),
            ],
            stdout=sys.stderr,
            check=False,
        )
        found = outcomes(record)
    return {
        "campaign": name,
        "batches": sum(len(cases) for cases in found.values()),
        "counts": {outcome: len(cases) for outcome, cases in found.items()},
        "wrong": found["failed"],
        "open": found["skipped"],
        "stopped": [] if any(found.values()) else ["pytest left no record"],
        "resumed": 0,
    }


def outcomes(record: Path) -> dict[str, list[str]]:
    """Names of the cases by outcome."""
    from xml.etree import ElementTree

    found: dict[str, list[str]] = {"passed": [], "failed": [], "skipped": []}
    if not record.exists():
        return found
    for case in ElementTree.parse(record).iter("testcase"):
        tags = {child.tag for child in case}
        outcome = "failed" if tags & {"failure", "error"} else "skipped" if "skipped" in tags else "passed"
        found[outcome].append(case.get("name", "?"))
    return found


def as_text(document: dict[str, Any]) -> str:
    rows = [(outcome, str(count)) for outcome, count in document["counts"].items()]
    lines = [table((document["campaign"], "count"), rows)]
    lines.append(
        f"{document['batches']} batches, {document['resumed']} resumed, wrong: {len(document['wrong'])}"
    )
    lines += [f"wrong: {item}" for item in document["wrong"][:20]]
    lines += [f"open: {item}" for item in document["open"][:20]]
    lines += [f"stopped: {item}" for item in document["stopped"][:20]]
    return "\n".join(lines)
