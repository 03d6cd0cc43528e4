"""What is known of the sign of an expression, and the signs of numbers and symbols."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

import sympy as sp

from navsym.proof.balls import exact_ball
from navsym.proof.identities.numbers import is_zero
from navsym.proof.sampling.points import Range

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
