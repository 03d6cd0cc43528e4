"""Unknowns that the measurements do not tell apart: the exact relation between their regressors.

Balls tell which regressors are involved; the coefficients are then rational numbers next to the balls, or the
exact solution of as many equations at instants. Only a proof for all instants counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import sympy as sp
from flint import arb

from navsym.claims import PROVED, Equation
from navsym.errors import NavsymError, NotEstimableError
from navsym.methods.guaranteed.problem import GuaranteedProblem
from navsym.methods.guaranteed.unobservable import null_directions
from navsym.proof.balls import enclose, exact_rational
from navsym.proof.decimals import decimal
from navsym.proof.ladder import decide
from navsym.proof.optimality.enclosure import rational
from navsym.text.expression import to_text

#: More regressors than this with coefficients that are not rational are not solved for; longer ones are rounded.
MOST, LETTERS = 4, 40
TINY = 1e-40
SHARES = [sp.Rational(k, 12) for k in (0, 12, 6, 3, 9, 4, 8, 2, 10, 1, 5, 7, 11)]
DECIDING = 1200
Relation = dict[int, sp.Expr]


@dataclass(frozen=True, slots=True)
class Null:
    """Entries of a direction that no measurement shows, and the unknown that is dropped for it."""

    entries: Relation
    at: int


def drop_dependent(problem: GuaranteedProblem, kept: list[int], index: int, coefficients: Sequence[arb]) -> None:
    """Remove an unknown: ``kept[index]``, whose regressor is about this combination of those before it, or another.

    Raises NotEstimableError with a null direction where the functional changes along it, and a NavsymError of
    kind ``"open"`` where neither this nor the relation can be proved.
    """
    k, balls = kept[index], dict(zip(kept, coefficients, strict=False))
    direction = integrated_direction(problem, kept) if problem.model else exact_direction(problem, k, balls)
    if direction is None:
        raise undecided(problem, k, balls)
    change = sum((c * problem.functional[j] for j, c in direction.entries.items()), sp.S.Zero)
    if decide(Equation(change, sp.S.Zero)).status is not PROVED:
        if enclose(change, bits=DECIDING).contains(0):
            raise undecided(problem, k, balls)
        words = ", ".join(in_words(direction.entries.get(j, sp.S.Zero)) for j in range(len(problem.functional)))
        raise NotEstimableError(
            f"functional: expected one that the measurements determine; got one that changes along the null "
            f"direction [{words}] which no measurement shows; estimate another combination"
        )
    kept.remove(direction.at)


def exact_direction(problem: GuaranteedProblem, k: int, balls: dict[int, arb]) -> Null | None:
    """The direction of the proved relation of the regressor k."""
    relation = proved_relation(problem, k, balls)
    return None if relation is None else Null({j: -c for j, c in relation.items()} | {k: sp.S.One}, k)


def integrated_direction(problem: GuaranteedProblem, kept: Sequence[int]) -> Null | None:
    """A direction of an integrated model, proved from F and h, whose own unknown is left."""
    assert problem.model is not None
    known = (d for d in null_directions(problem.model) if d.at in kept)
    return next((Null({j: c for j, c in enumerate(d.entries) if c != 0}, d.at) for d in known), None)


def undecided(problem: GuaranteedProblem, k: int, balls: dict[int, arb]) -> NavsymError:
    """What is known where no relation is proved: the direction along which nothing is seen to change."""
    seen = {j: decimal(-c, 12) for j, c in balls.items() if not abs(c) < TINY} | {k: "1"}
    near = [seen.get(j, "0") for j in range(len(problem.functional))]
    got = "functions that agree to 1800 digits"
    if problem.error:
        got = f"integrated functions that agree within their error of {float(problem.error):.0e}"
    return NavsymError(
        f"expected regressors whose dependence can be decided; got {got}: no measurement shows about the "
        f"direction [{', '.join(near)}]; leave that unknown out or rewrite equal functions alike",
        kind="open",
    )


def in_words(c: sp.Expr) -> str:
    """An exact number, rounded where its text is long."""
    text = to_text(c)
    return text if len(text) <= LETTERS else decimal(enclose(c), 15)


def proved_relation(problem: GuaranteedProblem, k: int, balls: dict[int, arb]) -> Relation | None:
    """Exact c with ``H_k = sum c_j H_j`` on all measurements at all times, or None where there is no proof."""
    involved = [j for j, c in balls.items() if not abs(c) < TINY]
    near = {j: recognised(balls[j]) for j in involved}
    if all(c is not None for c in near.values()):
        relation: Relation | None = {j: c for j, c in near.items() if c is not None}
    else:
        relation = solved_at_instants(problem, k, involved)
    return relation if relation is not None and holds(problem, k, relation) else None


def recognised(x: arb) -> sp.Rational | None:
    """The rational number with a small denominator next to x, or None."""
    value = rational(x)
    number = exact_rational(value)
    best = number.limit_denominator(10**9)
    return best if abs(best - number) < sp.Rational(1, 10**40) else None


def solved_at_instants(problem: GuaranteedProblem, k: int, involved: list[int]) -> Relation | None:
    """The coefficients from as many exact equations as there are of them, or None where there are too many."""
    if problem.error or not 1 <= len(involved) <= MOST:
        return None
    rows = [
        [row[j].subs(problem.variable, stretch.start + (stretch.end - stretch.start) * share) for j in (*involved, k)]
        for stretch in problem.stretches
        for row in stretch.rows
        for share in SHARES
    ]
    chosen = rows_of_full_rank(np.array([[float(enclose(h).mid()) for h in row] for row in rows]), len(involved))
    if chosen is None:
        return None
    N = sp.Matrix([rows[i][:-1] for i in chosen])
    right = sp.Matrix([rows[i][-1] for i in chosen])
    return dict(zip(involved, N.adjugate() * right / N.det(method="berkowitz"), strict=True))


def rows_of_full_rank(values: np.ndarray, count: int) -> list[int] | None:
    """Rows whose first ``count`` entries are independent, the best first; None when there are not enough."""
    if not np.isfinite(values).all():
        return None
    rest, chosen = values[:, :count] / np.maximum(np.abs(values[:, :count]).max(axis=0), 1e-300), []
    for _ in range(count):
        sizes = np.linalg.norm(rest, axis=1)
        best = int(np.argmax(sizes > 0.5 * sizes.max()))  # the simplest of the good ones
        if not sizes[best] > 1e-6:
            return None
        chosen.append(best)
        unit = rest[best] / sizes[best]
        rest = rest - np.outer(rest @ unit, unit)
    return chosen


def holds(problem: GuaranteedProblem, k: int, relation: Relation) -> bool:
    """The relation is proved for every measurement on every stretch."""
    for stretch in problem.stretches:
        for row in stretch.rows:
            other = sum((c * row[j] for j, c in relation.items()), sp.S.Zero)
            if decide(Equation(row[k], other)).status is not PROVED:
                return False
    return True
