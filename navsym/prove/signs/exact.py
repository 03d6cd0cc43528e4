"""Signs that need no subdivision: sums of bounded terms, angles in a known half turn, corners of boxes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

import sympy as sp

from navsym.core.balls import exact_ball
from navsym.prove.identities.ingredients import linear_terms
from navsym.prove.identities.numbers import is_zero
from navsym.prove.sampling.points import Range

# What is known of the sign of an expression, and the signs of numbers and symbols.


Limits = Mapping[sp.Symbol, Range]


class Sign(IntEnum):
    """What is known of an expression on a box."""

    UNKNOWN = 0
    NONNEGATIVE = 1
    POSITIVE = 2


@dataclass(frozen=True, slots=True)
class SignProof:
    """A sign with its reason; ``boxes`` counts the balls that were needed."""

    sign: Sign
    reason: str = ""
    boxes: int = 0
    exact: bool = False  # no ball subdivision was used

    def at_least(self, wanted: Sign) -> bool:
        return self.sign >= wanted


UNKNOWN = SignProof(Sign.UNKNOWN)


def constant_sign(expression: sp.Expr) -> SignProof:
    """Sign of a number: by a ball, or exactly zero by the normal form."""
    for bits in (64, 256, 1024):
        ball = exact_ball(expression, bits)
        if ball > 0:
            return SignProof(Sign.POSITIVE, "a positive number", exact=True)
        if ball < 0:
            return UNKNOWN
    if is_zero(expression):
        return SignProof(Sign.NONNEGATIVE, "zero", exact=True)
    return UNKNOWN


def symbol_sign(limits: Range) -> SignProof:
    """Sign of a symbol by its range."""
    if limits.lower is None:
        return UNKNOWN
    lower = constant_sign(limits.lower)
    if lower.sign == Sign.NONNEGATIVE and (limits.open_lower or limits.nonzero):
        return SignProof(Sign.POSITIVE, "range of the symbol", exact=True)
    return lower


ENTIRE = (sp.Add, sp.Mul, sp.sin, sp.cos, sp.exp, sp.sinh, sp.cosh, sp.tanh, sp.atan, sp.Symbol, sp.Number)


def is_entire(expression: sp.Expr) -> bool:
    """True when the expression is defined and smooth for all real values of its symbols."""
    if expression in (sp.pi, sp.E):
        return True
    if isinstance(expression, sp.Pow):
        whole = isinstance(expression.exp, sp.Integer) and expression.exp > 0
        return whole and is_entire(expression.base)
    return isinstance(expression, ENTIRE) and all(is_entire(a) for a in expression.args)


def is_whole_polynomial(expression: sp.Expr) -> bool:
    """True when the symbols occur in sums, products and whole powers only."""
    if not expression.free_symbols or isinstance(expression, sp.Symbol):
        return True
    if isinstance(expression, sp.Pow):
        return isinstance(expression.exp, sp.Integer) and expression.exp > 0 and is_whole_polynomial(expression.base)
    return isinstance(expression, (sp.Add, sp.Mul)) and all(is_whole_polynomial(a) for a in expression.args)


def sum_of_bounded_terms(expression: sp.Expr, limits: Limits) -> SignProof:
    """A sum whose terms have exact least values: c sin(u) >= -|c|, c u**2 >= 0, c atan(u) > -|c| pi/2, c >= c."""
    found = [least_term_value(term) for term in sp.Add.make_args(expression)]
    least = [pair for pair in found if pair is not None]
    if len(least) < len(found):
        return UNKNOWN
    proof = constant_sign(sp.Add(*(value for value, _ in least)))
    above = proof.sign == Sign.NONNEGATIVE and any(left_out for _, left_out in least)
    return SignProof(Sign.POSITIVE if above else proof.sign, "least values of the terms", exact=True)


#: Functions with a range that is symmetric about zero: half of it, and whether its ends are left out.
SYMMETRIC = {
    sp.sin: (sp.Integer(1), False),
    sp.cos: (sp.Integer(1), False),
    sp.tanh: (sp.Integer(1), True),
    sp.atan: (sp.pi / 2, True),
}


def least_term_value(term: sp.Expr) -> tuple[sp.Expr, bool] | None:
    """An exact lower bound of one term for all real values of its symbols, and whether it is left out; or None."""
    coefficient, rest = term.as_independent(*term.free_symbols, as_Add=False)
    if not term.free_symbols:
        return term, False
    if not is_entire(rest):
        return None
    if rest.func in SYMMETRIC:
        half, left_out = SYMMETRIC[rest.func]
        return -sp.Abs(coefficient) * half, left_out
    if isinstance(rest, sp.Pow) and rest.exp % 2 == 0:
        if constant_sign(coefficient).sign != Sign.UNKNOWN:
            return sp.Integer(0), False
        if rest.base.func in SYMMETRIC and constant_sign(-coefficient).sign != Sign.UNKNOWN:
            half, left_out = SYMMETRIC[rest.base.func]
            return coefficient * half**rest.exp, left_out
    return None


def angle_sign(expression: sp.Expr, limits: Limits) -> SignProof:
    """sin(u) or cos(u), or its negative, when the exact range of u lies between two zeros."""
    negative = expression.could_extract_minus_sign() and isinstance(-expression, (sp.sin, sp.cos))
    inner = -expression if negative else expression
    if not isinstance(inner, (sp.sin, sp.cos)):
        return UNKNOWN
    angle = inner.args[0] if isinstance(inner, sp.sin) else inner.args[0] + sp.pi / 2
    values = corner_values(angle, limits)
    if values is None:
        return UNKNOWN
    half_turn = middle_half_turn(values)
    if (half_turn % 2 == 1) != negative:
        return UNKNOWN
    return range_sign(angle, values, limits, (half_turn * sp.pi, (half_turn + 1) * sp.pi))


def middle_half_turn(values: list[sp.Expr]) -> int:
    """k with the middle of the values between k pi and (k + 1) pi: a guess, checked afterwards."""
    middle = float(sum((value.evalf(20) for value in values), sp.Integer(0))) / len(values)
    return math.floor(middle / math.pi)


def range_sign(angle: sp.Expr, values: list[sp.Expr], limits: Limits, allowed: tuple[sp.Expr, sp.Expr]) -> SignProof:
    """Positive when the angle stays strictly inside the allowed range, nonnegative when it touches."""
    strict = True
    for margin in (lambda value: value - allowed[0], lambda value: allowed[1] - value):
        signs = {constant_sign(margin(value)).sign for value in values}
        if Sign.UNKNOWN in signs:
            return UNKNOWN
        # A corner on the limit may lie on an open end, as sin(T v) does at T = 0 for T > 0.
        strict &= Sign.NONNEGATIVE not in signs or monomial_sign(margin(angle), limits) == Sign.POSITIVE
    return SignProof(Sign.POSITIVE if strict else Sign.NONNEGATIVE, "exact range of the angle", exact=True)


def multilinear_sign(expression: sp.Expr, limits: Limits) -> SignProof:
    """A multilinear expression is least at a corner of the box."""
    if not isinstance(expression, (sp.Add, sp.Mul)):
        return UNKNOWN
    values = corner_values(expression, limits)
    if values is None:
        return UNKNOWN
    signs = [constant_sign(value).sign for value in values]
    return SignProof(min(signs), "least at a corner of the box", exact=True)


def monomial_sign(expression: sp.Expr, limits: Limits) -> Sign:
    """Sign of a product of numbers, symbols and multilinear factors, such as T (1/2 - v/4)."""
    spread = sp.expand(expression)
    gathered = sp.factor_terms(spread)
    sign = Sign.POSITIVE if sp.expand(gathered - spread) == 0 else Sign.UNKNOWN
    for factor in sp.Mul.make_args(gathered):
        if factor.is_number:
            sign = min(sign, constant_sign(factor).sign)
        elif isinstance(factor, sp.Symbol):
            sign = min(sign, symbol_sign(limits[factor]).sign)
        else:
            sign = min(sign, multilinear_sign(factor, limits).sign)
    return sign


def corner_values(angle: sp.Expr, limits: Limits) -> list[sp.Expr] | None:
    """Values of a multilinear expression at the corners of the box, which hold its extremes.

    None when the expression is not multilinear, the box is not bounded or it has many corners.
    """
    symbols = sorted(angle.free_symbols, key=str)
    if not is_whole_polynomial(angle):
        return None  # expanding it could cancel a pole
    if len(symbols) > 4 or any(limits[s].lower is None or limits[s].upper is None for s in symbols):
        return None
    for monomial in linear_terms(angle):
        for base, exponent in monomial:
            if exponent != 1 or not (isinstance(base, sp.Symbol) or base.is_number):
                return None
    corners: list[dict[sp.Symbol, sp.Expr]] = [{}]
    for symbol in symbols:
        ends = (limits[symbol].lower, limits[symbol].upper)
        corners = [{**corner, symbol: end} for corner in corners for end in ends]
    return [angle.subs(corner) for corner in corners]
