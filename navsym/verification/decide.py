"""Deciding the claims of papers: in limited child processes, with the certificates that are kept."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from navsym.claims import OPEN, Claim, Equation, Paper, Property, Record, Statement, Verdict
from navsym.core.sandbox import Exhausted, Failed, require_jobs, require_limits, run_limited, run_many
from navsym.prove.grant import write_statements
from navsym.prove.ladder import decide
from navsym.verification.certificates import Certificates, grant_entry, verdict_of
from navsym.verification.ledger import Ledger
from navsym.verification.papers import PaperModule, claim_ids, find_claim, load_papers, summarise_paper
from navsym.verification.sides import hash_statement, sides

SECONDS = 90.0
#: Of these, for the search for proofs.
SEARCH = 60.0
#: Most claims that one child decides one after another: those of a section share what they derive.
TOGETHER = 16
SHARE = 3  # of the seconds of a claim, one in so many for a kept certificate: the search has the rest


def verify(
    *papers: str,
    jobs: int | None = None,
    seconds: float = SECONDS,
    fresh: bool = False,
    progress: Callable[[int, int, str], None] = lambda done, of, claim: None,
    remark: Callable[[str], None] = lambda sentence: None,
) -> Ledger:
    """Verdicts on every claim of these papers, or of all of them.

    Every statement is built from its source. A certificate that is kept for it is granted again by the checker; what
    has none is decided, so that a run that was stopped goes on. Each claim has a child process with limits of its own.

    papers   : names of derivation modules, such as "guaranteed_velocity"; all when none is given
    jobs     : claims decided at the same time; one per core when none is given
    seconds  : limit of processor time for one claim; above it the verdict is OPEN
    fresh    : use no kept certificate, search again
    progress : called with (claims done, all claims, id) after each
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
    chosen = load_papers(papers)
    kept = Certificates(fresh, remark)
    total = sum(len(module.claims) for module in chosen)
    done = granted = 0

    def step(record: Record, is_granted_again: bool) -> None:
        nonlocal done, granted
        done, granted = done + 1, granted + is_granted_again
        if not is_granted_again:
            kept.keep(record)
        progress(done, total, record.id)

    try:
        ledger = decide_papers(chosen, jobs=jobs, seconds=seconds, kept=kept, progress=step)
    finally:
        kept.close()
    if granted:
        remark(
            f"the checker granted {granted} of {total} verdicts from kept certificates, {total - granted} are decided"
        )
    return replace(ledger, unsaved=tuple(kept.lost))


def require_workers(jobs: Any, seconds: Any) -> None:
    """Refuse numbers of jobs and limits of time that are none; raises DomainError."""
    if jobs is not None:
        require_jobs(jobs, "jobs")
    require_limits(seconds, where="seconds")


def decide_claim_of(wanted: str, seconds: float = SECONDS) -> tuple[Paper, Record]:
    """Paper card and record of one claim, decided now in a limited child process."""
    module, claim = find_claim(wanted)
    one = replace(module, claims=(claim,))
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
    kept: Certificates | None = None,
    stored: Mapping[str, Record] | None = None,
    progress: Callable[[Record, bool], None] = lambda record, is_old: None,
) -> Ledger:
    """The verdict of every claim of these papers.

    jobs     : claims decided at the same time, by default one per core
    seconds  : limit for one claim; above it the verdict is OPEN
    kept     : certificates that the checker may grant again
    stored   : records by claim id that are taken as they are where the statement is the same
    progress : called with each record, and whether nothing was searched for it
    """
    claims = [(module.paper, claim) for module in modules for claim in module.claims]
    known, records = stored or {}, dict[str, Record]()

    def work(pair: tuple[Paper, Claim]) -> tuple[Record, bool]:
        return record_of(*pair, kept, known.get(pair[1].id), seconds)

    warm_up()
    jobs = jobs or os.cpu_count() or 1
    share = max(1, min(TOGETHER, len(claims) // (4 * jobs)))
    for outcome in run_many(work, claims, jobs, seconds, share=share):
        paper, claim = claims[outcome.place]
        value = outcome.value
        if isinstance(value, (Exhausted, Failed)):
            value = make_record(paper, claim, None, open_verdict(value)), False
        records[claim.id] = replace(value[0], seconds=round(outcome.seconds, 3))
        progress(records[claim.id], value[1])
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


def record_of(
    paper: Paper, claim: Claim, kept: Certificates | None = None, stored: Record | None = None, seconds: float = SECONDS
) -> tuple[Record, bool]:
    """Derive one claim and give its verdict, in this process; and whether nothing was searched for it."""
    statement = claim.derive()
    texts = write_statements(statement)
    key = hash_statement(statement, texts)
    if stored is not None and stored.statement == key:
        verdict: Verdict | None = verdict_of(stored)
    else:
        verdict = None if kept is None else grant_kept(key, texts, kept, seconds / SHARE)
    is_known = verdict is not None
    if verdict is None:
        verdict = decide(statement, seconds=SEARCH)
        verdict = claim.complete(verdict) if claim.complete else verdict
    return replace(make_record(paper, claim, statement, verdict), statement=key), is_known


def grant_kept(
    key: str, texts: list[dict[str, Any]] | None, kept: Certificates, seconds: float = SECONDS / SHARE
) -> Verdict | None:
    """The verdict of a certificate that is kept for a statement and that the checker grants to its texts; else None."""
    entries = () if texts is None else kept.list_entries(key)
    return next(filter(None, (grant_entry(texts or [], entry, seconds) for entry in entries)), None)


def decide_or_grant(statement: Statement, seconds: float = SECONDS) -> Verdict:
    """The verdict of a certificate that is kept for a statement and granted again, else decided; in a limited child."""

    def work() -> Verdict:
        texts = write_statements(statement)
        kept = grant_kept(hash_statement(statement, texts), texts, Certificates(False, lambda sentence: None))
        return kept or decide(statement, seconds / 2)

    outcome = run_limited(work, (), seconds)
    return open_verdict(outcome) if isinstance(outcome, Exhausted) else outcome


def make_record(paper: Paper, claim: Claim, statement: Statement | None, verdict: Verdict) -> Record:
    """The record of a claim: name, both sides as text, verdict and certificate, as plain data.

    statement : None when deriving it was stopped: both sides are empty; a kept verdict may have another claim's scope
    """
    printed, derived = ("", "") if statement is None else sides(statement)
    scope = statement.derived.scope if isinstance(statement, Property) else verdict.scope.partition("; ")[0]
    return Record(
        id=claim.id,
        paper=paper.module,
        number=claim.number,
        title=claim.title,
        status=verdict.status,
        expect=verdict.status if claim.either and verdict.status.holds else claim.expect,
        method=verdict.method,
        scope=paper.scope_of(claim.number, scope),
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
        kind=paper.kind_of(claim.number),
        latex=claim.latex,
        cause=f"{paper.module}:{cause}" if (cause := paper.causes.get(claim.number)) else None,
    )
