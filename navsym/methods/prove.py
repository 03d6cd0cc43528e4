"""A user's own formulas, decided one by one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import sympy as sp

from navsym.claims import OPEN, REFUTED, Bound, Equation, Statement, Verdict
from navsym.proof.assumptions import is_nonzero, is_positive
from navsym.proof.ladder import decide
from navsym.proof.sandbox import Exhausted, Failed, run_many
from navsym.proof.signs.bounds import Sign, prove_sign
from navsym.proof.wording import scope_of, text_of
from navsym.text.claimfile import ClaimFile, FileClaim, UndefinedClaim

SECONDS = 20.0


def prove(
    claims: ClaimFile,
    *,
    jobs: int = 1,
    seconds: float = SECONDS,
    progress: Callable[[dict[str, Any]], None] = lambda record: None,
) -> dict[str, Any]:
    """Decide every claim of a file; the document of ``navsym prove``.

    A claim that needs more than ``seconds`` is OPEN. Order and verdicts do not depend on ``jobs``. Where a side
    has no value, the claim is OPEN with its ``error``, and so is the document with the first of them.
    """
    records: dict[int, dict[str, Any]] = {}
    for outcome in run_many(decide_claim, claims.claims, jobs, seconds):
        verdict = outcome.value
        if isinstance(verdict, (Exhausted, Failed)):
            why = verdict.why if isinstance(verdict, Exhausted) else str(verdict.error)
            verdict = Verdict(OPEN, "none", evidence=f"not decided: {why}")
        records[outcome.place] = record_of(claims.claims[outcome.place], verdict)
        progress(records[outcome.place])
    done = [records[place] for place in sorted(records)]
    for claim in claims.undefined:
        done.insert(claim.place, undefined_record(claim))
    first = claims.undefined[0].error.as_json() if claims.undefined else {}
    return {**first, "claims": done}


def undefined_record(claim: UndefinedClaim) -> dict[str, Any]:
    """What is said of a claim of which a side has no value."""
    verdict = Verdict(OPEN, "none", evidence=claim.error.message)
    return {"id": claim.id, **outcome(verdict), **claim.error.as_json()}


def decide_claim(claim: FileClaim) -> Verdict:
    """Verdict of one claim, with what its text divides by and takes roots of among the assumptions."""
    verdict = decide(statement_of(claim))
    if verdict.status == REFUTED:
        return verdict
    assumptions = dict.fromkeys((*verdict.assumptions, *text_conditions(claim)))
    return replace(verdict, scope=scope_of_text(claim), assumptions=tuple(assumptions))


def scope_of_text(claim: FileClaim) -> str:
    """All symbols of the text, also those that the algebra has cancelled since, as in a/a = 1."""
    sides = [tuple(side) if isinstance(side, sp.MatrixBase) else side for side in (claim.left, claim.right)]
    return scope_of(sp.Tuple(*sides, *claim.divisors, *claim.radicands, *claim.arguments), claim.box)


def text_conditions(claim: FileClaim) -> list[str]:
    """What the text divides by and takes roots and logarithms of, where the algebra has cancelled it since."""
    found = [f"{text_of(d)} != 0" for d in claim.divisors if not is_nonzero(d, claim.box)]
    at_least = (r for r in claim.radicands if not prove_sign(r, claim.box).at_least(Sign.NONNEGATIVE))
    found += [f"{text_of(r)} >= 0" for r in at_least]
    return found + [f"{text_of(a)} > 0" for a in claim.arguments if not is_positive(a, claim.box)]


def existing(claim: FileClaim) -> tuple[sp.Expr, ...]:
    """Expressions with a value exactly where the text has one, whatever the algebra has cancelled."""
    return (
        *(1 / divisor for divisor in claim.divisors),
        *(sp.sqrt(radicand) for radicand in claim.radicands),
        *(sp.log(argument) for argument in claim.arguments),
    )


def statement_of(claim: FileClaim) -> Statement:
    """The file's claim as a statement of the ladder."""
    if claim.relation == "=":
        return Equation(claim.left, claim.right, claim.box, exists=existing(claim))
    return Bound(claim.left, claim.relation, claim.right, claim.box, existing(claim))


def record_of(claim: FileClaim, verdict: Verdict) -> dict[str, Any]:
    """The id of a claim of a file with its verdict, as plain data."""
    return {"id": claim.id, **outcome(verdict)}


def outcome(verdict: Verdict) -> dict[str, Any]:
    """A verdict as plain data."""
    refuted = verdict.status == REFUTED
    difference = verdict.difference
    return {
        "status": str(verdict.status),
        "method": verdict.method,
        "scope": verdict.scope,
        "assumptions": list(verdict.assumptions),
        "evidence": verdict.evidence,
        "counterexample": dict(verdict.counterexample or {}) if refuted else None,
        "difference": {"lower": difference[0], "upper": difference[1]} if refuted and difference else None,
        "certificate": verdict.certificate,
    }
