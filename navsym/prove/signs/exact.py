"""What is known of a sign, and the signs of numbers."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import sympy as sp

from navsym.core.balls import exact_ball
from navsym.prove.identities import is_zero


class Sign(IntEnum):
    """What is known of an expression on a box."""

    UNKNOWN = 0
    NONNEGATIVE = 1
    NONZERO = 2
    POSITIVE = 3


@dataclass(frozen=True, slots=True)
class SignProof:
    """A sign with its reason."""

    sign: Sign
    reason: str = ""
    exact: bool = False  # no balls were used

    def at_least(self, wanted: Sign) -> bool:
        """Whether the known sign gives the wanted one; what is nonzero may be negative."""
        return self.sign in (wanted, Sign.POSITIVE)


UNKNOWN = SignProof(Sign.UNKNOWN)


def constant_sign(expression: sp.Expr) -> SignProof:
    """Sign of a number: by a ball, or exactly zero by the normal form."""
    for bits in (64, 256, 1024):
        ball = exact_ball(expression, bits)
        if ball > 0:
            return SignProof(Sign.POSITIVE, "a positive number", exact=True)
        if ball < 0:
            return SignProof(Sign.NONZERO, "a negative number", exact=True)
    if is_zero(expression):
        return SignProof(Sign.NONNEGATIVE, "zero", exact=True)
    return UNKNOWN
