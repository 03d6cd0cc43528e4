"""Attack navsym on purpose and print the figures: mutants, engines, parser, certificates, identities."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from navsym.cli.output import emit, table

NAMES = ("mutants", "engines", "parser", "certificates", "identities")
TESTED = {"engines": "tests/engines", "identities": "tests/proof/test_textbook.py"}


def command(
    name: Annotated[str, typer.Argument(help=" | ".join(NAMES))],
    modules: Annotated[list[str] | None, typer.Argument(help="papers, for mutants; default: all")] = None,
    share: Annotated[float, typer.Option(min=0.0, max=1.0, help="share of the mutants")] = 1.0,
    inputs: Annotated[int, typer.Option(min=1, help="inputs of parser and certificates")] = 10_000,
    seed: Annotated[int, typer.Option(min=0)] = 0,
    jobs: Annotated[int, typer.Option(min=1, help="batches at the same time")] = 1,
    seconds: Annotated[float, typer.Option(min=1.0, help="limit for one batch")] = 3600.0,
    fresh: Annotated[bool, typer.Option("--fresh", help="do not resume from the store")] = False,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> int:
    """Run a campaign; it resumes where it was stopped. Status 1 when anything wrong was found."""
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
        batches = campaign_certificates.batches(honest_certificates(), inputs, seed)
        judge = campaign_certificates.judge
    if fresh:
        return run_campaign(name, batches, judge, jobs=jobs, seconds=seconds, progress=told)
    with opened() as store:
        return run_campaign(name, batches, judge, store=store, jobs=jobs, seconds=seconds, progress=told)


def papers(names: list[str]) -> list[Any]:
    import importlib

    from navsym.cli import verify
    from navsym.methods.verification import paper_module

    chosen = names or verify.names()
    return [paper_module(importlib.import_module(f"derivations.{name}")) for name in chosen]


def honest_certificates() -> list[dict[str, Any]]:
    """Certificates of our own making: three identities and three optima."""
    import sympy as sp

    from navsym.methods.guaranteed import solve
    from navsym.methods.guaranteed_problem import from_regressors
    from navsym.proof.certificates import identity_certificate

    a, b = sp.symbols("a b", real=True)
    identities = [
        identity_certificate(sp.sin(a + b), sp.sin(a) * sp.cos(b) + sp.cos(a) * sp.sin(b)),
        identity_certificate(sp.cos(3 * a), 4 * sp.cos(a) ** 3 - 3 * sp.cos(a)),
        identity_certificate((a**3 - b**3) / (a - b), a**2 + a * b + b**2),
    ]
    s = sp.Symbol("t", real=True)
    bases = ([1, s], [1, s, s**2], [1, sp.sin(s)])
    optima = []
    for basis in bases:
        target = [0] * (len(basis) - 1) + [1]
        optima.append(dict(solve(from_regressors([basis], target, s, (0, 1)), 12).certificate))
    return [dict(item) for item in identities if item is not None] + optima


def by_tests(name: str) -> dict[str, Any]:
    """Campaigns that are tables of cases under tests/: one outcome for each case."""
    import contextlib
    import importlib
    import sys

    from navsym.cli.verify import ledger_folder
    from navsym.errors import NavsymError

    path = ledger_folder().parent / TESTED[name]
    if not path.exists():
        raise NavsymError(
            f"expected {TESTED[name]}; got an installation without tests; run it from a checkout"
        )
    counter = Counter()
    with contextlib.redirect_stdout(sys.stderr):
        importlib.import_module("pytest").main(["-q", "-p", "no:cacheprovider", str(path)], plugins=[counter])
    counts = {key: len(found) for key, found in counter.found.items()}
    return {
        "campaign": name,
        "batches": sum(counts.values()),
        "counts": counts,
        "wrong": counter.found["failed"],
        "open": counter.found["skipped"],
        "stopped": [],
        "resumed": 0,
    }


class Counter:
    """A pytest plugin that notes the outcome of each case."""

    def __init__(self) -> None:
        self.found: dict[str, list[str]] = {"passed": [], "failed": [], "skipped": []}

    def pytest_runtest_logreport(self, report: Any) -> None:
        if report.when == "call" or report.outcome != "passed":
            self.found[report.outcome].append(report.nodeid)


def told(done: int, of: int) -> None:
    import sys

    if done % 20 == 0 or done == of:
        print(f"{done} of {of} batches", file=sys.stderr, flush=True)


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
