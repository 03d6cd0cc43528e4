"""Signs of polynomials over boxes, exactly: factors, discriminants, and cones.

A polynomial is split into irreducible factors, even powers are dropped, and what is left is

* a quadratic A v**2 + B v + C in one variable with A, C and 4 A C - B**2 nonnegative, or
* carried to cones: every range becomes a set of nonnegative variables (``x = lower + y``, both signs of a
  real x, ``x = (lower y' + upper y)/(y + y')`` for a bounded one), and ``cones`` decides by coefficients.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from itertools import product as choices
from typing import Any

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from navsym.core.rational_functions import factor_exactly
from navsym.prove.signs.exact import Sign

# Polynomials that are nonnegative where all variables are: by their coefficients, dividing the cone.
#
# If no coefficient is negative, the polynomial is not negative for nonnegative variables. Otherwise two
# variables are compared: where ``y_i >= y_j`` put ``y_i = y_j + u``, where ``y_j >= y_i`` put ``y_j = y_i + u``
# with u >= 0, and look at the coefficients again (successive difference substitution). Zeros at rational
# ratios of the variables end up on edges, so that touching inequalities are proved exactly.


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
        pair = choose_pair(terms, negative, depth)
        if pair is None:
            return Sign.UNKNOWN
        pending.extend((half, depth + 1) for half in halve_cone(here, *pair))
    return worst


def choose_pair(terms: dict[Any, Any], negative: dict[Any, Any], depth: int) -> tuple[int, int] | None:
    """The two variables to compare; None when a negative term has only one, so that nothing can mend it.

    Best are y_i, y_j with a negative term between two positive ones, as in y_i**2 - y_i y_j + y_j**2.
    """
    scores: dict[tuple[int, int], Any] = {}
    for exponents, value in negative.items():
        places = [i for i, e in enumerate(exponents) if e]
        if len(places) < 2:
            return None
        for pair in combinations(places, 2):
            framed = all(terms.get(shift_power(exponents, i, j), 0) > 0 for i, j in (pair, pair[::-1]))
            scores[pair] = scores.get(pair, 0) - (value if framed else 0)
    best = max(scores.values())
    ranked = sorted(pair for pair, score in scores.items() if score == best)
    return ranked[depth % len(ranked)]


def shift_power(exponents: Any, i: int, j: int) -> tuple[int, ...]:
    """One power moved from y_j to y_i."""
    return tuple(int(e) + (k == i) - (k == j) for k, e in enumerate(exponents))


def halve_cone(cone: Cone, i: int, j: int) -> Iterator[Cone]:
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


MOST_DEGREE = 48
MOST_TERMS = 400
MOST_CONES = 2000
SHARES = (fmpq(1, 2), fmpq(1, 5), fmpq(9, 10), fmpq(1, 1000))


@dataclass(frozen=True, slots=True)
class VariableRange:
    """Range of a variable with rational ends; None is infinity.

    left_out : the lower end is not attained; zero is not, where there is neither end
    """

    lower: fmpq | None = None
    upper: fmpq | None = None
    left_out: bool = False


def polynomial_sign(polynomial: fmpq_mpoly, spans: Sequence[VariableRange], effort: Effort) -> Sign:
    """POSITIVE or NONNEGATIVE when that is proved for all values of the variables in their ranges."""
    if polynomial.is_zero():
        return Sign.NONNEGATIVE
    if polynomial.total_degree() > MOST_DEGREE or len(polynomial) > MOST_TERMS or not effort.spend():
        return Sign.UNKNOWN
    constant, factors = factor_exactly(polynomial)
    rest, worst = polynomial.context().constant(constant), Sign.POSITIVE
    for factor, power in factors:
        sign, flipped = (
            sign_of_factor(factor, spans, effort) if len(factors) > 1 or power > 1 else (Sign.UNKNOWN, False)
        )
        if sign == Sign.UNKNOWN and (power % 2 or len(factor) == 1):  # the square of a variable may be positive
            rest = rest * factor ** (power if power % 2 == 0 else 1)
        else:
            worst = min(worst, max(sign, Sign.NONNEGATIVE))
            rest = -rest if flipped and power % 2 else rest
    return min(worst, irreducible_sign(rest, spans, effort))


def sign_of_factor(factor: fmpq_mpoly, spans: Sequence[VariableRange], effort: Effort) -> tuple[Sign, bool]:
    """Sign of a factor or of its negative; true when it is the negative."""
    sign = irreducible_sign(factor, spans, effort)
    return (sign, False) if sign != Sign.UNKNOWN else (irreducible_sign(-factor, spans, effort), True)


def irreducible_sign(polynomial: fmpq_mpoly, spans: Sequence[VariableRange], effort: Effort) -> Sign:
    if polynomial.is_constant():
        value = polynomial.to_dict().get((0,) * len(spans), fmpq(0))
        return Sign.POSITIVE if value > 0 else Sign.NONNEGATIVE if value == 0 else Sign.UNKNOWN
    if is_negative_at_a_point(polynomial, spans) or not effort.spend():
        return Sign.UNKNOWN
    by_cones = Sign.POSITIVE
    share = Effort(given := min(effort.left, MOST_CONES))
    for cone in cover_by_cones(polynomial, spans):
        by_cones = min(by_cones, cone_sign(cone, share))
        if by_cones == Sign.UNKNOWN:
            break
    effort.left -= given - share.left
    return by_cones if by_cones != Sign.UNKNOWN else quadratic_sign(polynomial, spans, effort)


def is_negative_at_a_point(polynomial: fmpq_mpoly, spans: Sequence[VariableRange]) -> bool:
    """A look at a few points, to give up early on what is not true."""
    for round_ in range(len(SHARES) + 2):
        place = [inner_number(span, SHARES[(round_ + k * (round_ // 2)) % len(SHARES)]) for k, span in enumerate(spans)]
        if polynomial(*place) < 0:
            return True
    return False


def inner_number(span: VariableRange, share: fmpq) -> fmpq:
    if span.lower is not None and span.upper is not None:
        return span.lower + (span.upper - span.lower) * share
    stretched = share / (1 - share)
    if span.lower is not None:
        return span.lower + stretched
    return span.upper - stretched if span.upper is not None else stretched - fmpq(2, 3)


# -- quadratics ---------------------------------------


def quadratic_sign(polynomial: fmpq_mpoly, spans: Sequence[VariableRange], effort: Effort) -> Sign:
    """A v**2 + B v + C >= 0 for all real v when A, C and 4 A C - B**2 are nonnegative."""
    for place, degree in enumerate(polynomial.degrees()):
        if degree != 2 or not effort.spend():
            continue
        c, b, a = quadratic_coefficients(polynomial, place)
        if any(polynomial_sign(part, spans, effort) == Sign.UNKNOWN for part in (a, c)):
            continue
        sign = polynomial_sign(4 * a * c - b * b, spans, effort)
        if sign != Sign.UNKNOWN:
            return sign
    return Sign.UNKNOWN


def quadratic_coefficients(polynomial: fmpq_mpoly, place: int) -> list[fmpq_mpoly]:
    """Coefficients of the powers 0, 1, 2 of one variable."""
    context = polynomial.context()
    parts: list[dict[tuple[int, ...], fmpq]] = [{}, {}, {}]
    for exponents, value in polynomial.to_dict().items():
        rest = tuple(0 if k == place else int(e) for k, e in enumerate(exponents))
        parts[int(exponents[place])][rest] = value
    return [context.from_dict(part) for part in parts]


# -- from ranges to cones ---------------------------------------


def cover_by_cones(polynomial: fmpq_mpoly, spans: Sequence[VariableRange]) -> Iterator[Cone]:
    """Cones that cover the box: two for every variable of both signs that occurs in odd powers."""
    used = [k for k, degree in enumerate(polynomial.degrees()) if degree]
    even = {k for k in used if all(e[k] % 2 == 0 for e in polynomial.to_dict())}
    signs = [(1, -1) if spans[k].lower is None and spans[k].upper is None and k not in even else (1,) for k in used]
    for chosen in choices(*signs):
        yield build_cone(polynomial, spans, dict(zip(used, chosen, strict=True)), even)


def build_cone(polynomial: fmpq_mpoly, spans: Sequence[VariableRange], signs: dict[int, int], even: set[int]) -> Cone:
    """Places 0 .. n-1 belong to the variables, n .. 2n-1 to the other ends of bounded ones, 2n makes it homogeneous."""
    n = len(spans)
    context = fmpq_mpoly_ctx.get([f"y{k}" for k in range(2 * n + 1)], Ordering.lex)
    y = context.gens()
    one = y[2 * n]
    tops, bottoms = [context.constant(0)] * n, [context.constant(1)] * n
    alive = [frozenset({2 * n})]
    halved = {k for k in even if spans[k].lower is None and spans[k].upper is None}
    for k, sign in signs.items():
        span, alone = spans[k], frozenset({k})  # y_k is what lies above the lower end
        tops[k], bottoms[k] = variable_on_cone(span, sign, y[k], y[n + k], one)
        bounded = span.lower is not None and span.upper is not None
        alive += [frozenset({k, n + k})] if bounded else []
        alive += [alone] if span.left_out and (span.lower is not None or span.upper is None) else []
    total = context.constant(0)
    degrees = {k: int(d) for k, d in enumerate(polynomial.degrees())}
    for exponents, value in polynomial.to_dict().items():
        term = context.constant(value)
        for k in signs:
            e, d = int(exponents[k]), degrees[k]
            e, d = (e // 2, d // 2) if k in halved else (e, d)
            term = term * tops[k] ** e * bottoms[k] ** (d - e)
        total = total + term
    return Cone(total, tuple(alive))


def variable_on_cone(
    span: VariableRange, sign: int, y: fmpq_mpoly, twin: fmpq_mpoly, one: fmpq_mpoly
) -> tuple[fmpq_mpoly, fmpq_mpoly]:
    """The variable as a quotient of two forms of nonnegative variables, the lower one positive."""
    if span.lower is not None and span.upper is not None:
        return span.lower * twin + span.upper * y, y + twin
    if span.lower is not None:
        return span.lower * one + y, one
    if span.upper is not None:
        return span.upper * one - y, one
    return sign * y, one
