"""Exact numbers as each library writes them, and as decimals rounded to a side that is asked for."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any, TypeVar

import sympy as sp
from flint import arb, fmpq, fmpz

ONE = fmpz(1)
#: One unit of the eighth digit.
EIGHT = sp.Rational(1, 10**8)
Factor = TypeVar("Factor")


def raise_by_squaring(x: Factor, n: int, times: Callable[[Factor, Factor], Factor]) -> Factor:
    """x^n, n at least 1, by repeated squaring, for whatever can be multiplied."""
    result: Factor | None = None
    while n:
        if n & 1:
            result = x if result is None else times(result, x)
        n >>= 1
        x = times(x, x) if n else x
    assert result is not None, "the exponent is at least 1"
    return result


def to_fmpq(x: Any) -> fmpq:
    """A rational number of flint: the exact midpoint of a ball, or an exact number of any library.

    x : arb, fmpq, fmpz, int, Fraction, or a rational of sympy
    """
    if isinstance(x, arb):
        mantissa, exponent = x.mid().man_exp()
        power = int(exponent)
        return fmpq(mantissa << power) if power >= 0 else fmpq(mantissa, ONE << -power)
    return x if isinstance(x, fmpq) else fmpq(int(x.numerator), int(x.denominator))


def to_rational(x: Any) -> sp.Rational:
    """A rational number of sympy, from whatever :func:`to_fmpq` takes."""
    x = to_fmpq(x) if isinstance(x, arb) else x
    return sp.Rational(int(x.numerator), int(x.denominator))


def to_fraction(x: Any) -> Fraction:
    """A fraction of Python, from whatever :func:`to_fmpq` takes."""
    x = to_fmpq(x) if isinstance(x, arb) else x
    return Fraction(int(x.numerator), int(x.denominator))


def rational_near(x: Any, most: int, room: sp.Rational) -> sp.Rational | None:
    """The rational with a denominator of at most ``most`` next to x, or None: nothing rests on it.

    room : how far it may be, as a part of x where that is above one
    """
    value = to_rational(x)
    best = value.limit_denominator(most)
    return best if abs(best - value) < room * max(1, abs(value)) else None


def decimal(x: Any, digits: int, direction: int = 0) -> str:
    """``x`` with ``digits`` significant digits: to nearest (0), downwards (-1) or upwards (1).

    x : a ball (its midpoint), or an exact number
    """
    value = to_fmpq(x)
    if value == 0:
        return "0"
    top, bottom = int(value.p), int(value.q)
    exponent = magnitude(top, bottom) - digits
    top, bottom = top * 10 ** max(-exponent, 0), bottom * 10 ** max(exponent, 0)
    if direction == 0:
        return without_power((2 * top + bottom) // (2 * bottom), exponent)
    return without_power(top // bottom if direction < 0 else -(-top // bottom), exponent)


def magnitude(top: int, bottom: int) -> int:
    """Smallest e with ``|top / bottom| < 10**e``, for a positive bottom."""
    size = abs(top)
    e = int((size.bit_length() - bottom.bit_length()) * 0.30103)
    while size * 10 ** max(-e, 0) >= bottom * 10 ** max(e, 0):
        e += 1
    while size * 10 ** max(1 - e, 0) < bottom * 10 ** max(e - 1, 0):
        e -= 1
    return e


def without_power(whole: int, exponent: int) -> str:
    """``whole * 10**exponent`` written without a power of ten, trailing zeros dropped."""
    sign, text = ("-" if whole < 0 else ""), str(abs(whole))
    if exponent >= 0:
        return sign + text + "0" * exponent
    text = text.rjust(-exponent + 1, "0")
    head, tail = text[:exponent], text[exponent:].rstrip("0")
    return sign + head + ("." + tail if tail else "")


def lower_end(x: arb, digits: int) -> str:
    """A decimal below every number of the ball, by a unit of its last digit, so that a checker can see it."""
    end = to_fmpq(x.lower())
    return decimal(end - abs(end) * fmpq(1, 10) ** digits, digits, -1)


def upper_end(x: arb, digits: int) -> str:
    """A decimal above every number of the ball, by a unit of its last digit."""
    end = to_fmpq(x.upper())
    return decimal(end + abs(end) * fmpq(1, 10) ** digits, digits, 1)


def from_decimal(text: str) -> fmpq:
    """The rational number that a decimal string means."""
    head, _, tail = text.partition(".")
    sign = -1 if head.startswith("-") else 1
    return sign * fmpq(fmpz(head.lstrip("-") + tail), fmpz(10) ** len(tail))
