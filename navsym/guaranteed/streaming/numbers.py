"""Numbers of the stream: exact rationals from text, integers, fractions and floats."""

from __future__ import annotations

from fractions import Fraction
from numbers import Integral, Rational, Real
from typing import Any

from flint import fmpq

from navsym.core.arrays import without_units
from navsym.core.errors import DomainError, ExpressionSyntaxError, NotFiniteError, TooLargeError, quote
from navsym.core.exact import to_fmpq
from navsym.core.units import NUMBER as NUMBER
from navsym.core.units import drop_unit, is_quantity, scale_of, unit_text

WORDS = frozenset("nan inf +inf -inf infinity +infinity -infinity".split())
LONGEST = 60
#: No number is larger, so that doubles near it are finite.
LARGEST = 10**300


def read_exact(value: Any, where: str) -> fmpq:
    """The rational number that a value means; a float is the decimal that it prints as.

    Raises ExpressionSyntaxError, NotFiniteError, TooLargeError or DomainError, all with ``where``.
    """
    found = read_number(value, where)
    if abs(found) > LARGEST:
        got = quote(value) if isinstance(value, str | float) else "a larger one"
        raise TooLargeError(f"expected a number of at most 1e300 in size; got {got}; scale the units", where=where)
    return found


def read_number(value: Any, where: str) -> fmpq:
    """The same for a number of any size."""
    if isinstance(value, str):
        return read_decimal(drop_unit(value, where).strip(), where)
    if is_quantity(value):
        return read_quantity(value, where)
    if isinstance(value, bool) or not isinstance(value, Real):
        message = f"expected a number; got {quote(value)}; give text, an int, a Fraction or a float"
        raise DomainError(message, where=where)
    if isinstance(value, Integral | Rational):
        return to_fmpq(value)
    return read_decimal(repr(float(value)), where)


def read_quantity(value: Any, where: str) -> fmpq:
    """A quantity of pint in SI: the number itself, or the nearest double of a float times pi or a root."""
    whole, roots = scale_of(unit_text(value), "", where)
    if not roots:
        return read_number(value.magnitude, where) * to_fmpq(whole)
    if not isinstance(value.magnitude, float):
        got = f"{quote(str(value))}, which is none in SI"
        raise DomainError(f"expected a rational number; got {got}; give its decimal in SI", where=where)
    return read_number(float(without_units(value, where)), where)


def read_decimal(text: str, where: str) -> fmpq:
    """The number of a decimal or a fraction."""
    if text.lower() in WORDS:
        raise NotFiniteError(f"expected a finite number; got {quote(text)}; leave it out", where=where)
    if len(text) > LONGEST:
        raise TooLargeError(
            f"expected a number of at most {LONGEST} characters; got {quote(text)}; round it", where=where
        )
    if not NUMBER.fullmatch(text):
        raise ExpressionSyntaxError(f"expected a number such as -1.25e3; got {quote(text)}; correct it", where=where)
    return to_fmpq(Fraction(text))


def to_float(q: fmpq) -> float:
    """The double nearest to a rational number."""
    return int(q.p) / int(q.q)
