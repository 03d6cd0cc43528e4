"""Scopes, points, balls and refutations in words: decimal strings are always rounded outwards."""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp
from flint import arb

from navsym.claims.statement import Box
from navsym.claims.verdict import REFUTED, Verdict
from navsym.core.balls import precision
from navsym.core.errors import NavsymError
from navsym.core.numbers import Number
from navsym.language.expression import to_text
from navsym.prove.sampling.points import Point, Range, range_of

#: Powers of two beyond which a number is written as a power of ten.
MOST_SIZE = 10_000


def expression_text(expression: sp.Basic) -> str:
    """Text in the language of files; sympy's own words for what lies outside it."""
    try:
        return to_text(expression)
    except NavsymError:
        return str(expression)


def point_text(point: Point) -> Mapping[str, str]:
    """A counterexample in the language of files, by name."""
    return {symbol.name: expression_text(value) for symbol, value in sorted(point.items(), key=lambda i: i[0].name)}


def scope_of(expression: sp.Basic, box: Box) -> str:
    """The quantifier in words: ``all T in (0, pi/2]``."""
    symbols = sorted(expression.free_symbols, key=str)
    if not symbols:
        return "numbers"
    return "all " + ", ".join(range_text(symbol, range_of(symbol, box)) for symbol in symbols)


def range_text(symbol: sp.Symbol, limits: Range) -> str:
    if limits.lower is None and limits.upper is None:
        kind = "integer" if limits.integer else "real"
        return f"{kind} {symbol}" + (" != 0" if limits.nonzero else "")
    left = "(" if limits.open_lower or limits.lower is None else "["
    right = ")" if limits.upper is None else "]"
    lower = "-oo" if limits.lower is None else expression_text(limits.lower)
    upper = "oo" if limits.upper is None else expression_text(limits.upper)
    return f"{symbol} in {left}{lower}, {upper}{right}" + (" whole" if limits.integer else "")


def decimal_ends(ball: arb, digits: int = 20) -> Number:
    """Decimal strings below and above every point of the ball."""
    with precision(256):
        lower, upper = ball.lower(), ball.upper()
    return Number(write_decimal(lower, digits, -1), write_decimal(upper, digits, 1))


def write_decimal(end: arb, digits: int, direction: int) -> str:
    """An exact ball as a decimal rounded downwards (-1) or upwards (1)."""
    mantissa, exponent = end.man_exp()
    numerator, power = int(mantissa), int(exponent)
    if numerator == 0:
        return "0"
    size = abs(numerator).bit_length() + power
    if abs(size) > MOST_SIZE:
        return write_power_of_ten(size, numerator > 0, direction)
    places = max(0, digits - int(size * 0.30103) - 1)
    scaled = numerator * 10**places
    whole = scaled << power if power >= 0 else scaled >> -power if direction < 0 else -(-scaled >> -power)
    text = str(abs(whole)).rjust(places + 1, "0")
    head, tail = (text[:-places], text[-places:]) if places else (text, "")
    sign = "-" if whole < 0 else ""
    return sign + (f"{head}.{tail}" if tail else head)


def write_power_of_ten(size: int, positive: bool, direction: int) -> str:
    """A power of ten beyond a number between 2**(size - 1) and 2**size: its digits would fill the memory.

    log10(2) lies between 0.30102 and 0.30103.
    """
    away = (direction > 0) == positive
    two = size if away else size - 1
    ends = (two * 30102 // 10**5, two * 30103 // 10**5)
    return f"{'' if positive else '-'}1e{max(ends) + 1 if away else min(ends)}"


def refute_at_point(point: Point, difference: arb, exact: bool = False) -> Verdict:
    """REFUTED at one exact point."""
    ends = Number("0", "0") if exact else decimal_ends(difference)
    words = "the difference is exactly zero there" if exact else f"the sides differ by {ends.lower} at an exact point"
    method = "exact point" if exact else "exact point, ball arithmetic"
    return Verdict(REFUTED, method, "one point", evidence=words, counterexample=point_text(point), difference=ends)
