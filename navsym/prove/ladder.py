"""A statement goes in, a verdict comes out.

Every rung first tries to break the statement and then to prove it. ``decide_within`` works in a child process with
limits: a statement that needs more time or memory is OPEN.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from navsym.claims.statement import UNDECIDED, Bound, Equation, Finding, Optimum, Property, Statement, Worded
from navsym.claims.verdict import OPEN, REFUTED, Verdict
from navsym.core.errors import DomainError
from navsym.core.sandbox import Exhausted, run_limited
from navsym.prove.equations import decide_bound, decide_equation
from navsym.prove.grant import grant_verdict
from navsym.prove.optimum import decide_optimum
from navsym.prove.search import SECONDS
from navsym.prove.statements import require_statement

DEFAULT_SECONDS = 20.0
DEFAULT_MEGABYTES = 4096


def decide(statement: Statement, seconds: float = SECONDS) -> Verdict:
    """Verdict of a statement, in this process and without limits.

    The ladder: counterexamples at exact points, exact algebra, real roots, a second look at samples, the search for a
    proof; the first that decides is the method of the verdict. The checker grants it on the statement's own text.
    ``seconds`` of processor time are a net below the search. Raises DomainError for what is no statement: a relation of
    sympy may have been evaluated already.
    """
    require_statement(statement)
    return grant_verdict(statement, search_verdict(statement), seconds)


def search_verdict(statement: Statement) -> Verdict:
    """What the search makes of a statement; the checker has not seen it."""
    if isinstance(statement, Equation):
        return decide_equation(statement)
    if isinstance(statement, Bound):
        return decide_bound(statement)
    if isinstance(statement, Optimum):
        return decide_optimum(statement)
    return decide_property(statement)


def decide_within(
    statement: Statement, seconds: float = DEFAULT_SECONDS, megabytes: int = DEFAULT_MEGABYTES
) -> Verdict:
    """The same in a child process; OPEN when it needs more time or memory than allowed."""
    outcome = run_limited(decide, (statement, seconds / 2), seconds, megabytes)
    return leave_open(outcome) if isinstance(outcome, Exhausted) else outcome


def leave_open(outcome: Exhausted) -> Verdict:
    """OPEN, with the limit that was met."""
    return Verdict(OPEN, "none", evidence=f"stopped: {outcome.why}; nothing is known")


def decide_property(statement: Property) -> Verdict:
    """A printed fact beside a computed one: they are equal, or the computed one refutes it; undecided is OPEN."""
    finding = statement.derived
    if is_undecided(finding.value):
        words = f"{finding.method} did not decide. {finding.evidence}".strip()
        return Verdict(OPEN, finding.method, finding.scope, evidence=words)
    if not is_same_value(statement.printed, finding.value):
        return contradict(statement, finding)
    return Verdict(
        finding.status,
        method=finding.method,
        scope=finding.scope,
        assumptions=finding.assumptions,
        evidence=finding.evidence,
        certificate=finding.certificate,
    )


def contradict(statement: Property, finding: Finding) -> Verdict:
    """REFUTED by a decided value; a value that was only sampled cannot refute."""
    point: Mapping[str, Any] = statement.counterexample if isinstance(statement, Worded) else {}
    told = "" if isinstance(statement, Worded) else f"printed {statement.printed!r}, found {finding.value!r}. "
    words = f"{told}{finding.evidence}".strip()
    if not finding.status.holds:
        return Verdict(OPEN, finding.method, finding.scope, evidence=f"{words} (sampled only)")
    return Verdict(
        REFUTED,
        method=finding.method,
        scope=finding.scope,
        evidence=words,
        counterexample=point,
        certificate=finding.certificate,
    )


def is_undecided(value: object) -> bool:
    """True for a value that the method left undecided, or a tuple with such a part."""
    return any(map(is_undecided, value)) if isinstance(value, (tuple, list)) else value in (UNDECIDED, None)


def is_same_value(printed: object, found: object) -> bool:
    """Equality of exact values; True is not 1, and a float is never compared."""
    if isinstance(printed, float) or isinstance(found, float):
        raise DomainError("expected exact values in a property; got a float; write a Fraction or Rational")
    if isinstance(printed, (tuple, list)) and isinstance(found, (tuple, list)):
        pairs = zip(printed, found, strict=False)
        return len(printed) == len(found) and all(is_same_value(p, f) for p, f in pairs)
    return isinstance(printed, bool) == isinstance(found, bool) and printed == found
