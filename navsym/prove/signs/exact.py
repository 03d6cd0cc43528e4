"""What is known of a sign, signs of numbers, and values at the corners of boxes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

import sympy as sp

from navsym.core.balls import exact_ball
from navsym.prove.identities.ingredients import linear_terms
from navsym.prove.identities.numbers import is_zero
from navsym.prove.sampling.points import Range

Limits = Mapping[sp.Symbol, Range]


class Sign(IntEnum):
    """What is known of an expression on a box."""

    UNKNOWN = 0
    NONNEGATIVE = 1
    POSITIVE = 2


@dataclass(frozen=True, slots=True)
class SignProof:
    """A sign with its reason."""

    sign: Sign
    reason: str = ""
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


def is_whole_polynomial(expression: sp.Expr) -> bool:
    """True when the symbols occur in sums, products and whole powers only."""
    if not expression.free_symbols or isinstance(expression, sp.Symbol):
        return True
    if isinstance(expression, sp.Pow):
        return isinstance(expression.exp, sp.Integer) and expression.exp > 0 and is_whole_polynomial(expression.base)
    return isinstance(expression, (sp.Add, sp.Mul)) and all(is_whole_polynomial(a) for a in expression.args)


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
