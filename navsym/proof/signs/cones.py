"""Polynomials that are nonnegative where all variables are: by their coefficients, dividing the cone.

If no coefficient is negative, the polynomial is not negative for nonnegative variables. Otherwise two
variables are compared: where ``y_i >= y_j`` put ``y_i = y_j + u``, where ``y_j >= y_i`` put ``y_j = y_i + u``
with u >= 0, and look at the coefficients again (successive difference substitution). Zeros at rational
ratios of the variables end up on edges, so that touching inequalities are proved exactly.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from flint import fmpq_mpoly

from navsym.proof.signs.known import Sign

CONE_TERMS = 3000
MOST_DEPTH = 24


@dataclass(slots=True)
class Effort:
    """How many polynomials may still be looked at; a count, so that the same question has the same answer."""

    left: int

    def spend(self, terms: int = 1) -> bool:
        """One step of this size, when there is enough left for it."""
        self.left -= 1 + terms // 8
        return self.left > 0


@dataclass(frozen=True, slots=True, eq=False)
class Cone:
    """A polynomial for nonnegative variables; of every set in ``alive`` at least one variable is positive."""

    polynomial: fmpq_mpoly
    alive: tuple[frozenset[int], ...]


def cone_sign(cone: Cone, effort: Effort) -> Sign:
    """Sign of the polynomial on its cone, or unknown."""
    pending, worst = [(cone, 0)], Sign.POSITIVE
    while pending:
        here, depth = pending.pop()
        terms = here.polynomial.to_dict()
        if depth > MOST_DEPTH or len(terms) > CONE_TERMS or not effort.spend(len(terms)):
            return Sign.UNKNOWN
        negative = {e: c for e, c in terms.items() if c < 0}
        if not negative:
            worst = min(worst, sign_of_terms(terms, here.alive))
            continue
        pair = compared_pair(terms, negative, depth)
        if pair is None:
            return Sign.UNKNOWN
        pending.extend((half, depth + 1) for half in halves(here, *pair))
    return worst


def compared_pair(terms: dict[Any, Any], negative: dict[Any, Any], depth: int) -> tuple[int, int] | None:
    """The two variables to compare; None when a negative term has only one, so that nothing can mend it.

    Best are y_i, y_j with a negative term between two positive ones, as in y_i**2 - y_i y_j + y_j**2.
    """
    scores: dict[tuple[int, int], Any] = {}
    for exponents, value in negative.items():
        places = [i for i, e in enumerate(exponents) if e]
        if len(places) < 2:
            return None
        for pair in combinations(places, 2):
            framed = all(terms.get(shifted(exponents, i, j), 0) > 0 for i, j in (pair, pair[::-1]))
            scores[pair] = scores.get(pair, 0) - (value if framed else 0)
    best = max(scores.values())
    ranked = sorted(pair for pair, score in scores.items() if score == best)
    return ranked[depth % len(ranked)]


def shifted(exponents: Any, i: int, j: int) -> tuple[int, ...]:
    """One power moved from y_j to y_i."""
    return tuple(int(e) + (k == i) - (k == j) for k, e in enumerate(exponents))


def halves(cone: Cone, i: int, j: int) -> Iterator[Cone]:
    """The parts where y_i >= y_j and where y_j >= y_i."""
    generators = list(cone.polynomial.context().gens())
    for larger, smaller in ((i, j), (j, i)):
        moved = list(generators)
        moved[larger] = generators[larger] + generators[smaller]
        alive = tuple(s | {smaller} if larger in s else s for s in cone.alive)
        yield Cone(cone.polynomial.compose(*moved), alive)


def sign_of_terms(terms: dict[Any, Any], alive: tuple[frozenset[int], ...]) -> Sign:
    """Sign of a sum of positive terms: positive when some term has no vanishing variable in it."""
    supports = {frozenset(i for i, e in enumerate(exponents) if e) for exponents in terms}
    if not supports:
        return Sign.NONNEGATIVE
    if frozenset() in supports:
        return Sign.POSITIVE
    used = sorted(set().union(*supports) | set().union(*alive))
    if len(used) > 10:
        return Sign.NONNEGATIVE
    for size in range(len(used) + 1):
        for positive in map(frozenset, combinations(used, size)):
            if all(positive & group for group in alive) and not any(s <= positive for s in supports):
                return Sign.NONNEGATIVE
    return Sign.POSITIVE
