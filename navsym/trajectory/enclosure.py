"""Exact rational enclosures of a positive number, and their decimal strings."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True, slots=True)
class Enclosure:
    """Exact rational numbers with ``lower <= value <= upper``."""

    lower: Fraction
    upper: Fraction

    def decimal(self, digits: int) -> tuple[str, str]:
        """Decimal strings of about ``digits`` significant digits, rounded outwards."""
        return write_decimal(self.lower, digits, math.floor), write_decimal(self.upper, digits, math.ceil)

    def rounded(self, digits: int) -> str | None:
        """``d.ddde+XX`` with ``digits`` significant digits if both ends agree on it, else None."""
        low, high = scientific(self.lower, digits), scientific(self.upper, digits)
        return low if low == high else None


def exponent_of(x: Fraction) -> int:
    """The e with 10^e <= x < 10^(e + 1), for positive x."""
    guess = len(str(x.numerator)) - len(str(x.denominator))
    return guess if x >= Fraction(10) ** guess else guess - 1


def write_decimal(x: Fraction, digits: int, rounding: Callable[[Fraction], int]) -> str:
    """Plain decimal string of ``digits`` significant digits, rounded by floor or ceil; x positive."""
    places = digits - 1 - exponent_of(x)
    whole = rounding(x * Fraction(10) ** places)
    if places <= 0:
        return str(whole * 10**-places)
    text = str(whole).rjust(places + 1, "0")
    return f"{text[:-places]}.{text[-places:]}"


def scientific(x: Fraction, digits: int) -> str:
    """``d.ddde+XX``, rounded to nearest (a tie goes up); x positive."""
    exponent = exponent_of(x)
    whole = math.floor(x / Fraction(10) ** (exponent - digits + 1) + Fraction(1, 2))
    if whole == 10**digits:
        whole, exponent = whole // 10, exponent + 1
    text = str(whole)
    return f"{text[0]}.{text[1:]}e{exponent:+03d}"


def square_root(lower: Fraction, upper: Fraction, digits: int) -> Enclosure:
    """Rational bounds of the square roots of the ends."""
    shift = 10 ** max(digits, digits - exponent_of(lower) // 2 + 1)
    down = Fraction(math.isqrt(math.floor(lower * shift**2)), shift)
    up = Fraction(math.isqrt(math.ceil(upper * shift**2)) + 1, shift)
    return Enclosure(down, up)
