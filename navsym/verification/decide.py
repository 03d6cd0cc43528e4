"""Deciding the claims of papers: each in a limited child process, several at once, with the verdicts that are kept."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from navsym.claims import OPEN, Bound, Claim, Equation, Optimum, Paper, Property, Record, Statement, Verdict
from navsym.core.errors import DomainError
from navsym.core.sandbox import Exhausted, Failed, require_limits, run_many
from navsym.prove.ladder import decide
from navsym.prove.wording import expression_text
from navsym.verification.ledger import Ledger
from navsym.verification.papers import PaperModule, claim_ids, find_claim, load_papers, summarise_paper
from navsym.verification.verdict_store import VerdictStore, sources

SECONDS = 90.0


def verify(
    *papers: str,
    jobs: int | None = None,
    seconds: float = SECONDS,
    fresh: bool = False,
    progress: Callable[[int, int, str], None] = lambda done, of, claim: None,
    remark: Callable[[str], None] = lambda sentence: None,
) -> Ledger:
    """Verdicts on every claim of these papers, or of all of them.

    Verdicts are kept: a claim whose own sources and whose deciding sources have not changed is not decided again, and
    a run that was stopped goes on. Each claim is decided in a child process with limits of its own.

    papers   : names of derivation modules, such as "guaranteed_velocity"; all when none is given
    jobs     : claims decided at the same time; one per core when none is given
    seconds  : limit of processor time for one claim; above it the verdict is OPEN
    fresh    : decide everything again
    progress : called with (claims done, claims to decide, id) after each
    remark   : called with a sentence on what is kept

    Raises DomainError for a name that is no paper, and for limits that are none.

    >>> import navsym as nav
    >>> ledger = nav.verify("alpha_beta_filter")
    >>> ledger.counts["REFUTED"], ledger.unexpected, ledger.missing
    (1, (), ())
    >>> ledger["alpha_beta_filter:12.stable"].scope
    'all r in (0, 1]'
    """
    require_workers(jobs, seconds)
    before = sources()
    chosen = load_papers(papers)
    store = VerdictStore(chosen, fresh, before, remark)
    missing = len(store.keys) - len(store.known)
    if store.known and missing:
        remark(f"{len(store.known)} of {len(store.keys)} claims are as they were, {missing} are decided now")
    done = 0

    def step(record: Record) -> None:
        nonlocal done
        store.keep(record)
        done += 1
        progress(done, missing, record.id)

    try:
        ledger = decide_papers(chosen, jobs=jobs, seconds=seconds, known=store.known, progress=step)
    finally:
        store.close()
    return replace(ledger, unsaved=tuple(store.lost))


def require_workers(jobs: Any, seconds: Any) -> None:
    """Refuse numbers of jobs and limits of time that are none; raises DomainError."""
    if jobs is not None and (not isinstance(jobs, int) or isinstance(jobs, bool) or jobs < 1):
        raise DomainError(f"expected a whole number of jobs from 1 on; got {jobs!r}; correct it", where="jobs")
    if not isinstance(seconds, (int, float)) or isinstance(seconds, bool):
        raise DomainError(f"expected seconds as a number; got {seconds!r}; correct it", where="seconds")
    require_limits(seconds, 1)


def decide_claim_of(wanted: str, seconds: float = SECONDS) -> tuple[Paper, Record]:
    """Paper card and record of one claim, decided now in a limited child process."""
    module, claim = find_claim(wanted)
    one = PaperModule(module.name, module.paper, (claim,))
    return module.paper, decide_papers([one], jobs=1, seconds=seconds).claims[0]


def show(claim: str, *, seconds: float = SECONDS) -> tuple[Record, ...]:
    """Both sides of a claim and its verdict, decided now; of an equation in several parts, one record for each.

    claim   : id such as "guaranteed_velocity:4.3.u2", or an equation, "guaranteed_velocity:4.16"
    seconds : limit of processor time for each claim; above it the verdict is OPEN

    Raises DomainError, with the ids that come closest, for an id that is none.

    >>> import navsym as nav
    >>> (record,) = nav.show("alpha_beta_filter:12.stable")
    >>> str(record.status), record.printed, record.scope
    ('PROVED', '4*r', 'all r in (0, 1]')
    """
    require_workers(None, seconds)
    return tuple(decide_claim_of(part, seconds)[1] for part in claim_ids(claim))


def decide_papers(
    modules: Sequence[PaperModule],
    *,
    jobs: int | None = None,
    seconds: float = SECONDS,
    known: Mapping[str, Record] | None = None,
    progress: Callable[[Record], None] = lambda record: None,
) -> Ledger:
    """The verdict of every claim of these papers.

    jobs     : claims decided at the same time, by default one per core
    seconds  : limit for one claim; above it the verdict is OPEN
    known    : records of an earlier run that are still valid, by claim id
    progress : called with each new record
    """
    known = known or {}
    claims = [(module.paper, claim) for module in modules for claim in module.claims]
    records = {claim.id: known[claim.id] for _, claim in claims if claim.id in known}
    missing = [(paper, claim) for paper, claim in claims if claim.id not in records]
    warm_up()
    for outcome in run_many(lambda pair: record_of(*pair), missing, jobs or os.cpu_count() or 1, seconds):
        paper, claim = missing[outcome.place]
        record = outcome.value
        if isinstance(record, (Exhausted, Failed)):
            record = make_record(paper, claim, None, open_verdict(record))
        records[claim.id] = replace(record, seconds=round(outcome.seconds, 3))
        progress(records[claim.id])
    cards = {module.name: module.paper for module in modules}
    return Ledger(tuple(records[claim.id] for _, claim in claims), tuple(map(summarise_paper, modules)), cards=cards)


def warm_up() -> None:
    """Decide a small identity here: what deciding imports is then loaded once, and not in the child of every claim."""
    x, y = sp.symbols("x y", real=True)
    decide(Equation(sp.sin(x + y), sp.sin(x) * sp.cos(y) + sp.cos(x) * sp.sin(y)))


def open_verdict(outcome: Exhausted | Failed) -> Verdict:
    """The OPEN verdict of a claim that reached a limit or ended with an error, with the reason."""
    why = outcome.why if isinstance(outcome, Exhausted) else str(outcome.error)
    return Verdict(OPEN, "none", evidence=f"not decided: {why}")


def record_of(paper: Paper, claim: Claim) -> Record:
    """Derive and decide one claim, in this process."""
    statement = claim.derive()
    return make_record(paper, claim, statement, decide(statement))


def make_record(paper: Paper, claim: Claim, statement: Statement | None, verdict: Verdict) -> Record:
    """The record of a claim: name, both sides as text, verdict and certificate, as plain data.

    statement : None when deriving it was stopped; the sides are then empty
    """
    printed, derived = ("", "") if statement is None else sides(statement)
    return Record(
        id=claim.id,
        paper=paper.module,
        number=claim.number,
        title=claim.title,
        status=verdict.status,
        expect=claim.expect,
        method=verdict.method,
        scope=verdict.scope,
        assumptions=tuple(verdict.assumptions),
        printed=printed,
        derived=derived,
        corrects=claim.corrects_id,
        slip=claim.slip,
        reason=claim.reason,
        evidence=verdict.evidence,
        counterexample=verdict.counterexample,
        difference=verdict.difference,
        certificate=verdict.certificate,
    )


# The two sides as text


def sides(statement: Statement) -> tuple[str, str]:
    """Printed and derived side in the language of files."""
    if isinstance(statement, Equation):
        tail = (
            ""
            if statement.tolerance is None
            else f" +- {expression_text(sp.sympify(statement.tolerance, strict=True))}"
        )
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
        rows = ["[" + ", ".join(expression_text(entry) for entry in side.row(i)) + "]" for i in range(side.rows)]
        return "[" + ", ".join(rows) + "]"
    if isinstance(side, (tuple, list)):
        return "(" + ", ".join(expression_text(sp.sympify(entry, strict=True)) for entry in side) + ")"
    return expression_text(sp.sympify(side, strict=True))


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
