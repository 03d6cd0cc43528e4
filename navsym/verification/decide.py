"""Deciding the claims of papers: each in a limited child process, several at once.

The result of one claim is a record of plain data, the same that ``navsym verify --json`` prints.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import sympy as sp

from navsym.claims import (
    OPEN,
    Bound,
    Claim,
    Equation,
    Optimum,
    Paper,
    Property,
    Statement,
    Verdict,
    claims_of,
    coverage,
)
from navsym.core.sandbox import Exhausted, Failed, run_many
from navsym.prove.ladder import decide
from navsym.prove.wording import text_of

Record = dict[str, Any]
SECONDS = 90.0


@dataclass(frozen=True, slots=True, eq=False)
class PaperModule:
    """A derivation module, its paper and its claims."""

    name: str
    paper: Paper
    claims: tuple[Claim, ...]


def paper_module(module: ModuleType) -> PaperModule:
    """Collect the paper card and the claims of an imported derivation module."""
    paper: Paper = module.PAPER
    return PaperModule(paper.module, paper, claims_of(module))


def verify(
    modules: Sequence[PaperModule],
    *,
    jobs: int | None = None,
    seconds: float = SECONDS,
    known: Mapping[str, Record] | None = None,
    progress: Callable[[Record], None] = lambda record: None,
) -> dict[str, Any]:
    """Decide every claim; the document of ``navsym verify``.

    jobs     : claims decided at the same time, by default one per core
    seconds  : limit for one claim; above it the verdict is OPEN
    known    : records of an earlier run that are still valid, by claim id
    progress : called with each new record

    Keys: ``claims`` (one record each, in the order of the sources), ``papers`` (coverage of the
    numbered equations), ``counts`` (by status).
    """
    known = known or {}
    claims = [(module.paper, claim) for module in modules for claim in module.claims]
    records: dict[str, Record] = {c.id: dict(known[c.id]) for _, c in claims if c.id in known}
    missing = [(paper, claim) for paper, claim in claims if claim.id not in records]
    warm_up()
    for outcome in run_many(lambda pair: record_of(*pair), missing, jobs or os.cpu_count() or 1, seconds):
        paper, claim = missing[outcome.place]
        record = outcome.value
        if isinstance(record, (Exhausted, Failed)):
            record = record_from(paper, claim, None, stopped(record))
        record["seconds"] = round(outcome.seconds, 3)
        records[claim.id] = record
        progress(record)
    ordered = [records[claim.id] for _, claim in claims]
    return {"claims": ordered, "papers": [paper_record(module) for module in modules], "counts": counts(ordered)}


def warm_up() -> None:
    """Decide a small identity here: what deciding imports is then loaded once, and not in the child of every claim."""
    x, y = sp.symbols("x y", real=True)
    decide(Equation(sp.sin(x + y), sp.sin(x) * sp.cos(y) + sp.cos(x) * sp.sin(y)))


def stopped(outcome: Exhausted | Failed) -> Verdict:
    """The OPEN verdict of a claim that reached a limit or ended with an error, with the reason."""
    why = outcome.why if isinstance(outcome, Exhausted) else str(outcome.error)
    return Verdict(OPEN, "none", evidence=f"not decided: {why}")


def record_of(paper: Paper, claim: Claim) -> Record:
    """Derive and decide one claim, in this process."""
    statement = claim.derive()
    return record_from(paper, claim, statement, decide(statement))


def record_from(paper: Paper, claim: Claim, statement: Statement | None, verdict: Verdict) -> Record:
    """The record of a claim: name, both sides as text, verdict and certificate, as plain data.

    statement : None when deriving it was stopped; the sides are then empty
    """
    printed, derived = ("", "") if statement is None else sides(statement)
    return {
        "id": claim.id,
        "paper": paper.module,
        "number": claim.number,
        "title": claim.title,
        "status": str(verdict.status),
        "expect": str(claim.expect),
        "method": verdict.method,
        "scope": verdict.scope,
        "assumptions": list(verdict.assumptions),
        "printed": printed,
        "derived": derived,
        "corrects": claim.corrects_id,
        "slip": claim.slip,
        "reason": claim.reason,
        "evidence": verdict.evidence,
        "counterexample": None if verdict.counterexample is None else dict(verdict.counterexample),
        "difference": None if verdict.difference is None else [verdict.difference.lower, verdict.difference.upper],
        "certificate": verdict.certificate,
        "seconds": 0.0,
    }


# -- the two sides as text -----------------------------------------------------------------


def sides(statement: Statement) -> tuple[str, str]:
    """Printed and derived side in the language of files."""
    if isinstance(statement, Equation):
        tail = "" if statement.tolerance is None else f" +- {text_of(sp.sympify(statement.tolerance, strict=True))}"
        return side_text(statement.printed) + tail, side_text(statement.derived)
    if isinstance(statement, Bound):
        return f"{side_text(statement.printed)} {statement.relation} {side_text(statement.derived)}", ""
    if isinstance(statement, Optimum):
        return optimum_text(statement)
    assert isinstance(statement, Property)
    return value_text(statement.printed), value_text(statement.derived.value)


def side_text(side: Any) -> str:
    """One side of a statement as text: a matrix by rows, a tuple, or one expression."""
    if isinstance(side, sp.MatrixBase):
        rows = ["[" + ", ".join(text_of(entry) for entry in side.row(i)) + "]" for i in range(side.rows)]
        return "[" + ", ".join(rows) + "]"
    if isinstance(side, (tuple, list)):
        return "(" + ", ".join(text_of(sp.sympify(entry, strict=True)) for entry in side) + ")"
    return text_of(sp.sympify(side, strict=True))


def value_text(value: Any) -> str:
    """A value of a property as text, tuples entry by entry."""
    if isinstance(value, tuple):
        return "(" + ", ".join(value_text(item) for item in value) + ")"
    return value if isinstance(value, str) else str(value)


def optimum_text(statement: Optimum) -> tuple[str, str]:
    """The printed dual, support, weights and value as text, and the regressors and functional."""
    parts = (
        ("dual", statement.dual),
        ("support", statement.support),
        ("weights", statement.weights),
        ("value", statement.value),
    )
    printed = "; ".join(f"{name} = {side_text(side)}" for name, side in parts)
    return printed, f"H = {side_text(statement.regressors)}, P = {side_text(statement.functional)}"


# -- summaries -------------------------------------------------------------------------------


def paper_record(module: PaperModule) -> Record:
    """Coverage of a paper: how many numbered equations are claimed or definitions, and which are missing."""
    covered = coverage(module.paper, module.claims)
    return {
        "module": module.name,
        "title": module.paper.title,
        "equations": len(module.paper.equations),
        "claimed": len(covered.claimed),
        "definitions": len(covered.definitions),
        "missing": list(covered.missing),
    }


def counts(records: Iterable[Record]) -> dict[str, int]:
    """How many records have each status, zero included."""
    found = Counter(record["status"] for record in records)
    return {status: found.get(status, 0) for status in ("PROVED", "CERTIFIED", "CONFIRMED", "REFUTED", "OPEN")}


def unexpected(records: Iterable[Record]) -> list[Record]:
    """Records whose verdict is not the one that the source declares."""
    return [record for record in records if record["status"] != record["expect"]]
