"""Assertions that decide a formula, or questions about source code, and fail with the counterexample."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextvars import ContextVar
from typing import TYPE_CHECKING, Any

from navsym.claims import CONFIRMED, Bound, Equation, Verdict
from navsym.core.errors import DomainError, EmptyError
from navsym.prove.formulas import RELATION, prove
from navsym.prove.ladder import decide_within
from navsym.verification.certificates import verdict_of
from navsym.verification.decide import decide_claim_of

if TYPE_CHECKING:
    from navsym.audit.answer import Audit

#: Seconds of processor time for one claim; ``--navsym-budget`` sets it for a run of pytest.
BUDGET: ContextVar[float] = ContextVar("BUDGET", default=20.0)


class ClaimFailedError(AssertionError):
    """A formula that was not proved; ``verdict`` has the counterexample or what was tried."""

    def __init__(self, message: str, verdict: Verdict):
        super().__init__(message)
        self.verdict = verdict


def assert_claim(
    left: Any,
    right: Any = None,
    *,
    relation: str = "=",
    box: Mapping[Any, tuple[Any, Any]] | None = None,
    tolerance: Any = None,
    sampled: bool = False,
    seconds: float | None = None,
    **symbols: Any,
) -> Verdict:
    """Decide ``left relation right`` on the box and fail unless it is PROVED or CERTIFIED.

    left, right : sympy expressions, matrices of one shape, or sequences; no floats, write Rational. Or a formula as
                  text alone, ``"sin(T) <= T"``; or the id of a claim, which fails unless it is as declared
    relation    : one of = != < <= > >=
    box         : symbol -> (lower, upper), exact numbers, None for an end at infinity
    tolerance   : for a printed numeral, half a unit of its last digit
    sampled     : accept CONFIRMED as well, which is evidence and no proof
    seconds     : limit; above it the verdict is OPEN and the assertion fails; by default ``--navsym-budget``
    symbols     : declarations of names in a text, ``T=("0", "pi")``, as in :func:`navsym.prove`

    Returns the verdict: its scope and its assumptions belong to what was proved. Raises ClaimFailedError, an
    AssertionError, with the counterexample or with what was tried, and NavsymError for what is no formula or id.
    """
    __tracebackhide__ = True  # pytest shows the line of the test
    limit = BUDGET.get() if seconds is None else seconds
    if right is None and isinstance(left, str):
        if relation != "=":
            raise DomainError(
                f"expected the relation in the text; got {relation!r:.20}; write it there", where="relation"
            )
        return assert_text(left, limit, sampled, {"box": box, "tolerance": tolerance, **symbols})
    if relation == "=":
        verdict = decide_within(Equation(left, right, box or {}, tolerance), limit)
    else:
        verdict = decide_within(Bound(left, relation, right, box or {}), limit)
    return require_holds(verdict, f"{left} {relation} {right}", sampled)


class AuditFailedError(AssertionError):
    """Source code in which an entry was not proved; ``audit`` has all verdicts."""

    def __init__(self, message: str, audit: Audit):
        super().__init__(message)
        self.audit = audit


def assert_audited(spec: str | os.PathLike[str]) -> Audit:
    """Decide the questions of a specification and fail unless every entry is PROVED or CERTIFIED.

    spec : a file of questions about source code (TOML), as for :func:`navsym.audit`

    Returns the audit. Raises AuditFailedError, an AssertionError, with one line for each entry that is REFUTED or OPEN:
    ``file:line``, question and entry, and the counterexample with the mended right side or the reason. Raises
    NavsymError for what is no specification, and for one without questions.

    >>> from navsym.testing import AuditFailedError, assert_audited
    >>> try:
    ...     assert_audited("examples/audit/yaw_jacobian.toml")
    ... except AuditFailedError as failure:
    ...     print([entry.line for entry in failure.audit["transition"].entries if not entry.status.holds])
    [14]
    """
    from navsym.audit.answer import audit as decide_audit

    __tracebackhide__ = True
    audit = decide_audit(spec)
    if not audit.questions:
        raise EmptyError("expected [[question]] blocks; got none; ask a question", where=str(spec))
    if audit.holds:
        return audit
    raise AuditFailedError("\n".join(audit.list_failures()), audit)


def assert_text(text: str, seconds: float, sampled: bool, options: Mapping[str, Any]) -> Verdict:
    """The verdict of a formula as text, or of a claim by its id."""
    __tracebackhide__ = True
    if ":" not in text or RELATION.search(text):
        return require_holds(prove(text, seconds=seconds, **options), text, sampled)
    if beside := [name for name, value in options.items() if value is not None]:
        raise DomainError(f"expected an id alone; got {beside[0]} beside it; leave it out", where="assert_claim")
    record = decide_claim_of(text, seconds)[1]
    verdict = verdict_of(record)
    if record.is_expected:
        return verdict
    message = describe_failure(f"{text}, declared {record.expect}", verdict)
    raise ClaimFailedError(message, verdict)


def require_holds(verdict: Verdict, statement: str, sampled: bool = False) -> Verdict:
    """The verdict when it is PROVED or CERTIFIED; raises ClaimFailedError for another one."""
    __tracebackhide__ = True
    if verdict.status.holds or (sampled and verdict.status == CONFIRMED):
        return verdict
    raise ClaimFailedError(describe_failure(statement, verdict), verdict)


def describe_failure(statement: str, verdict: Verdict) -> str:
    """The message of a failed claim, the counterexample in its first line."""
    point = ", ".join(f"{name} = {value}" for name, value in (verdict.counterexample or {}).items())
    where = f" at {point}" if point else ""
    difference = f"; left - right = {verdict.difference.lower}" if verdict.difference else ""
    return f"{verdict.status}{where}{difference}\n  {statement}\n  {verdict.evidence}"
