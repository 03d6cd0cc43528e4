"""Decimal strings of exact numbers and of the ends of balls, rounded the way that is asked for."""

from __future__ import annotations

from typing import Any

from flint import arb, fmpq, fmpz

from navsym.guaranteed.certificate.enclosure import rational


def decimal(x: Any, digits: int, direction: int = 0) -> str:
    """``x`` with ``digits`` significant digits: to nearest (0), downwards (-1) or upwards (1).

    x : a ball (its midpoint), an fmpq, or an integer
    """
    value = rational(x)
    if value == 0:
        return "0"
    top, bottom = int(value.p), int(value.q)
    exponent = magnitude(top, bottom) - digits
    top, bottom = top * 10 ** max(-exponent, 0), bottom * 10 ** max(exponent, 0)
    if direction == 0:
        return placed((2 * top + bottom) // (2 * bottom), exponent)
    return placed(top // bottom if direction < 0 else -(-top // bottom), exponent)


def magnitude(top: int, bottom: int) -> int:
    """Smallest e with ``|top / bottom| < 10**e``, for a positive bottom."""
    size = abs(top)
    e = int((size.bit_length() - bottom.bit_length()) * 0.30103)
    while size * 10 ** max(-e, 0) >= bottom * 10 ** max(e, 0):
        e += 1
    while size * 10 ** max(1 - e, 0) < bottom * 10 ** max(e - 1, 0):
        e -= 1
    return e


def placed(whole: int, exponent: int) -> str:
    """``whole * 10**exponent`` written without a power of ten, trailing zeros dropped."""
    sign, text = ("-" if whole < 0 else ""), str(abs(whole))
    if exponent >= 0:
        return sign + text + "0" * exponent
    text = text.rjust(-exponent + 1, "0")
    head, tail = text[:exponent], text[exponent:].rstrip("0")
    return sign + head + ("." + tail if tail else "")


def lower_end(x: arb, digits: int) -> str:
    """A decimal below every number of the ball, by a unit of its last digit, so that a checker can see it."""
    end = rational(x.lower())
    return decimal(end - abs(end) * fmpq(1, 10) ** digits, digits, -1)


def upper_end(x: arb, digits: int) -> str:
    """A decimal above every number of the ball, by a unit of its last digit."""
    end = rational(x.upper())
    return decimal(end + abs(end) * fmpq(1, 10) ** digits, digits, 1)


def exact(text: str) -> fmpq:
    """The rational number that a decimal string of this module means."""
    head, _, tail = text.partition(".")
    sign = -1 if head.startswith("-") else 1
    whole = fmpz(head.lstrip("-") + tail)
    return sign * fmpq(whole, fmpz(10) ** len(tail))
