"""Signs of algebraic and trigonometric expressions over boxes, exactly, by the polynomials behind them.

Sines and cosines become rational functions (``half_angles``), absolute values are taken in both cases, roots
and exponentials are variables of their own that are nonnegative; the polynomials left are decided by
``polynomials``. What is forgotten about a variable (that g**2 = x + 1, or that e = exp(x)) only makes the
statement that is proved stronger than the one that is asked.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache

import sympy as sp
from flint import arb, fmpq, fmpq_mpoly

from navsym.core.balls import enclose, exact_ball, hull, tape
from navsym.core.errors import NavsymError
from navsym.core.exact import to_fmpq
from navsym.prove.identities.cases import half_range
from navsym.prove.identities.converter import Converter
from navsym.prove.sampling.points import Range
from navsym.prove.signs.exact import Limits, Sign, SignProof, monomial_sign
from navsym.prove.signs.half_angles import replace_angles
from navsym.prove.signs.polynomials import Effort, VariableRange, polynomial_sign
from navsym.prove.signs.products import monomial_expression
from navsym.prove.signs.sums import cases_of_sum

MOST_VALUES = 5
EFFORT = 4000


def algebraic_sign(expression: sp.Expr, limits: Limits, effort: int = EFFORT) -> SignProof:
    """Sign wherever the expression exists on the box; whether it exists everywhere is the caller's question."""
    ranges = tuple(sorted(((s, limits[s]) for s in expression.free_symbols), key=lambda item: item[0].name))
    return SignProof(remember_sign(expression, ranges, effort), "polynomials in nonnegative variables", exact=True)


@lru_cache(maxsize=512)
def remember_sign(expression: sp.Expr, ranges: tuple[tuple[sp.Symbol, Range], ...], effort: int) -> Sign:
    """The sign, kept: proofs by derivatives ask for the same ones again."""
    try:
        return sign_by_cases(expression, dict(ranges), Effort(effort), MOST_VALUES)
    except (NavsymError, OverflowError):
        return Sign.UNKNOWN


def sign_by_cases(expression: sp.Expr, limits: Mapping[sp.Symbol, Range], effort: Effort, left: int) -> Sign:
    """Absolute values by both signs, those of symbols first."""
    values = sorted(expression.atoms(sp.Abs), key=sp.default_sort_key)
    values = sorted(values, key=lambda value: not value.args[0].is_Symbol)
    inner = next((value for value in values if not value.args[0].has(sp.Abs)), None)
    if inner is None:
        return plain_sign(expression, limits, effort)
    if left == 0:
        return Sign.UNKNOWN
    worst = Sign.POSITIVE
    for case, narrowed in split_modulus(expression, inner, limits):
        worst = min(worst, sign_by_cases(case, narrowed, effort, left - 1))
        if worst == Sign.UNKNOWN:
            break
    return worst


def split_modulus(
    expression: sp.Expr, value: sp.Abs, limits: Mapping[sp.Symbol, Range]
) -> Iterator[tuple[sp.Expr, Mapping[sp.Symbol, Range]]]:
    """|x| of a symbol by the two parts of its range, of a sum by a variable for it, of anything else everywhere."""
    inside = value.args[0]
    sums = None if inside.is_Symbol else cases_of_sum(expression, value, limits)
    if sums is not None and not any(forms[0].wider for forms in sums):
        yield from ((forms[0].expression, forms[0].limits) for forms in sums)
        return
    for sign in (1, -1):
        narrowed = half_range(limits, inside, sign)
        if narrowed is not None:
            yield expression.xreplace({value: sign * inside}), narrowed


def plain_sign(expression: sp.Expr, limits: Mapping[sp.Symbol, Range], effort: Effort) -> Sign:
    """Sign of an expression without absolute values."""
    found = replace_angles(expression, limits)
    if found is None:
        return Sign.UNKNOWN
    rational, angles = found
    if rational.has(sp.zoo, sp.nan, sp.oo):
        return Sign.UNKNOWN
    converter = Converter([rational])
    quotient = converter.convert(rational)
    spans = spans_of(converter, {**limits, **angles.ranges})
    numerator = replace_roots(converter, quotient.numerator)
    sign = quotient_sign(numerator, quotient.denominator, spans, effort)
    return min(sign, Sign.NONNEGATIVE) if angles.endless else sign


def quotient_sign(top: fmpq_mpoly, bottom: fmpq_mpoly, spans: list[VariableRange], effort: Effort) -> Sign:
    """Sign of top/bottom where bottom is not zero."""
    if any(int(p.degrees()[-1]) > 0 for p in (top, bottom)):
        return Sign.UNKNOWN  # a root of unity: the coefficients are not rational
    for flip in (1, -1):
        if polynomial_sign(flip * bottom, spans, effort) != Sign.UNKNOWN:
            return polynomial_sign(flip * top, spans, effort)
    return Sign.UNKNOWN


def replace_roots(converter: Converter, polynomial: fmpq_mpoly) -> fmpq_mpoly:
    """Powers g**q replaced by the radicand, where that is a polynomial over one, so that no sign changes."""
    for index in reversed(range(len(converter.roots))):
        if converter.convert(converter.roots[index][0]).denominator.is_one():
            polynomial = converter.reduce_root(polynomial, index)
    return polynomial


# -- ranges of the generators ---------------------------------------


def spans_of(converter: Converter, limits: Mapping[sp.Symbol, Range]) -> list[VariableRange]:
    """Ranges of the generators of the ring, in its order; the last one, the root of unity, never counts."""
    found = converter.found
    if found.angles:
        raise OverflowError("an angle is left")
    spans = [symbol_span(limits[symbol], q) for symbol, q in found.symbols.items()]
    spans += [exponential_span(monomial_expression(m), limits) for m in found.exponents]
    numbered = {place: atom for atom, place in converter.atoms.items()}
    spans += [ball_span(numbered[place], limits) for place in sorted(numbered)]
    spans += [root_span(radicand, q, limits) for radicand, q in converter.roots]
    return [*spans, VariableRange()]


def symbol_span(limit: Range, q: int) -> VariableRange:
    """Rational ends outside those of the range; of its root for a symbol that stands under one."""
    left_out = limit.open_lower or (limit.nonzero and limit.lower in (None, 0))
    if q > 1:
        return VariableRange(fmpq(0), None, left_out and limit.lower == 0)
    lower = None if limit.lower is None else rational_end(exact_ball(limit.lower, 256), limit.lower, -1)
    upper = None if limit.upper is None else rational_end(exact_ball(limit.upper, 256), limit.upper, 1)
    return VariableRange(lower, upper, left_out) if lower is None or lower != upper else VariableRange(lower, lower + 1)


def rational_end(ball: arb, exact: sp.Expr, direction: int) -> fmpq | None:
    """The number itself when it is rational, otherwise a rational number beyond it."""
    if isinstance(exact, sp.Rational):
        return to_fmpq(exact)
    return round_outwards(ball, direction)


def round_outwards(ball: arb, direction: int) -> fmpq | None:
    """A short rational number below (-1) or above (1) the ball; None when the ball is not finite."""
    if not ball.is_finite():
        return None
    scale = 10**12
    end = (ball.lower() if direction < 0 else ball.upper()) * scale
    whole = end.floor() if direction < 0 else end.ceil()
    value = whole.unique_fmpz()
    if value is None:
        return None
    return fmpq(int(value) + direction, scale)


def exponential_span(monomial: sp.Expr, limits: Limits) -> VariableRange:
    """exp(u): above one where u is not negative, below one where u is not positive."""
    sign = monomial_sign(monomial, limits)
    if sign != Sign.UNKNOWN:
        return VariableRange(fmpq(1), None, sign == Sign.POSITIVE)
    if monomial_sign(-monomial, limits) != Sign.UNKNOWN:
        return VariableRange(fmpq(0), fmpq(1), True)
    return VariableRange(fmpq(0), None, True)


def ball_span(atom: sp.Expr, limits: Limits) -> VariableRange:
    """A function that is a variable of its own, with the range that a ball gives."""
    values = {s: hull(limits[s].lower, limits[s].upper) for s in atom.free_symbols}
    ball = enclose(tape(atom), values)
    return VariableRange(round_outwards(ball, -1), round_outwards(ball, 1)) if ball.is_finite() else VariableRange()


def root_span(radicand: sp.Expr, q: int, limits: Limits) -> VariableRange:
    """A root is not negative; of a number it has a ball."""
    if radicand.free_symbols:
        return VariableRange(fmpq(0))
    span = ball_span(sp.Pow(radicand, sp.Rational(1, q)), limits)
    return span if span.lower is not None and span.lower > 0 else VariableRange(fmpq(0))
