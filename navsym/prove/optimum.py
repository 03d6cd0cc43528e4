"""Optimality of a printed solution by an exact primal-dual pair, for every parameter value.

Primal: minimise ``integral |Phi|`` subject to ``integral H Phi = P``. Dual: maximise ``x . P``
subject to ``|x . H(t)| <= 1`` on the interval. Weak duality needs four things, and nothing else:

1. the weights satisfy the constraints, ``sum phi_j H(t_j) = P``;
2. the instants lie in the interval;
3. the dual is feasible on the whole interval, for every parameter value;
4. ``sum |phi_j| = x . P``, and this is the printed value.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import sympy as sp

from navsym.claims.statement import Box, Equation, Optimum
from navsym.claims.verdict import CERTIFIED, OPEN, PROVED, Status, Verdict
from navsym.prove.assumptions import is_nonnegative, remaining_assumptions
from navsym.prove.equations import decide_difference, decide_equation, weakest_verdict
from navsym.prove.products import as_product, as_squares
from navsym.prove.signs import Sign, SignProof, prove_sign
from navsym.prove.wording import scope_of

#: Position inside the interval: t = start + (end - start) * share.
SHARE = sp.Symbol("share", nonnegative=True)


def decide_optimum(statement: Optimum) -> Verdict:
    """Verdict of a printed optimum; REFUTED as soon as one of the four conditions is."""
    if statement.variable in fixed_parts(statement).free_symbols:
        return Verdict(OPEN, "none", evidence=f"{statement.variable} occurs outside the regressors; name it otherwise")
    parts = [
        decide_constraints(statement),
        decide_times(statement),
        decide_feasibility(statement),
        decide_values(statement),
    ]
    verdict = weakest_verdict(parts)
    if verdict.status.holds:
        verdict = replace(
            verdict, assumptions=tuple(dict.fromkeys((*verdict.assumptions, *existence_assumptions(statement))))
        )
    names = ("constraints", "instants inside", "dual feasible", "equal values")
    words = ", ".join(f"{name}: {part.status}" for name, part in zip(names, parts, strict=True))
    sides = sp.Tuple(*statement.regressors, *statement.interval, *statement.dual, statement.value)
    return replace(
        verdict,
        method=f"exact primal-dual pair ({verdict.method})",
        scope=scope_of(sides.subs(statement.variable, statement.interval[0]), statement.box),
        evidence=f"{words}. {verdict.evidence}",
    )


def existence_assumptions(statement: Optimum) -> tuple[str, ...]:
    """Where the printed solution and the regressors exist, as far as the box does not guarantee it.

    A component of the dual that the functional does not meet, or that a regressor cancels, is part of the solution
    as well: (1, 1/(T - 1)) is no dual at T = 1.
    """
    fixed = remaining_assumptions([fixed_parts(statement)], statement.box)
    start, end = statement.interval
    place, box = start + (end - start) * SHARE, {**statement.box, SHARE: (0, 1)}
    moving = remaining_assumptions(statement.regressors, box, at=lambda part: part.subs(statement.variable, place))
    return (*fixed, *moving)


def fixed_parts(statement: Optimum) -> sp.Basic:
    """What does not move with the variable: a dual that does, such as -5/t, would satisfy every bound."""
    return sp.Tuple(
        *statement.dual,
        *statement.support,
        *statement.weights,
        *statement.functional,
        *statement.interval,
        statement.value,
    )


def decide_constraints(statement: Optimum) -> Verdict:
    """sum_j phi_j H(t_j) = P."""
    total = [
        sum(
            (w * h.subs(statement.variable, at) for w, at in zip(statement.weights, statement.support, strict=True)),
            sp.Integer(0),
        )
        for h in statement.regressors
    ]
    return decide_equation(Equation(tuple(total), tuple(statement.functional), statement.box))


def decide_times(statement: Optimum) -> Verdict:
    """start <= t_j <= end for every printed instant."""
    start, end = statement.interval
    proofs = [
        prove_sign(sp.sympify(side, strict=True), statement.box)
        for at in statement.support
        for side in (at - start, end - at)
    ]
    return judge_signs(proofs, "instants inside the interval")


def judge_signs(proofs: Sequence[SignProof], what: str) -> Verdict:
    if any(proof.sign == Sign.UNKNOWN for proof in proofs):
        return Verdict(OPEN, "signs", evidence=f"{what}: not proved")
    status: Status = PROVED if all(proof.exact for proof in proofs) else CERTIFIED
    return Verdict(status, "signs", evidence=what)


def decide_feasibility(statement: Optimum) -> Verdict:
    """1 - x.H(t) >= 0 and 1 + x.H(t) >= 0 on the interval, as products or sums of squares where they are."""
    polynomial = sum((x * h for x, h in zip(statement.dual, statement.regressors, strict=True)), sp.Integer(0))
    start, end = statement.interval
    if SHARE in sp.Tuple(polynomial, start, end).free_symbols:
        return Verdict(OPEN, "none", evidence="the name share is taken by the position in the interval")
    box = {**statement.box, SHARE: (0, 1)}
    return weakest_verdict([decide_side(side, statement, box) for side in (1 - polynomial, 1 + polynomial)])


def decide_side(side: sp.Expr, statement: Optimum, box: Box) -> Verdict:
    """side >= 0 on the interval: proved, or broken by a point."""
    start, end = statement.interval
    place = start + (end - start) * SHARE
    written = (as_product(side), as_squares(side, statement.variable), side)
    forms = [form.subs(statement.variable, place) for form in written if form is not None]
    for form in forms:
        proof = prove_sign(form, box)
        if proof.sign != Sign.UNKNOWN:
            return judge_signs([proof], proof.reason)
    return require_everywhere(decide_difference(forms[-1], ">=", box, scope_of(forms[-1], box)))


def require_everywhere(verdict: Verdict) -> Verdict:
    """OPEN for a bound that is proved only where it exists: the interval of an optimum has no holes."""
    if not verdict.status.holds or not verdict.assumptions:
        return verdict
    words = f"the bound is proved only where {', '.join(verdict.assumptions)}"
    return Verdict(OPEN, verdict.method, verdict.scope, evidence=words)


def decide_values(statement: Optimum) -> Verdict:
    """sum |phi_j| = x . P = printed value, with the signs of the weights proved."""
    dual_value = sum((x * p for x, p in zip(statement.dual, statement.functional, strict=True)), sp.Integer(0))
    weights = [sp.sympify(weight, strict=True) for weight in statement.weights]
    proved = [next((w for w in (weight, -weight) if is_nonnegative(w, statement.box)), None) for weight in weights]
    sizes = [sp.Abs(weight) if size is None else size for size, weight in zip(proved, statement.weights, strict=True)]
    primal_value = sum(sizes, sp.Integer(0))
    sides = Equation((statement.value, primal_value), (dual_value, dual_value), statement.box)
    return decide_equation(sides)
