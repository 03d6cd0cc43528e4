"""Units as text: a small table of SI and of what navigators write, read into powers of base units and of scales."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import NoReturn

from navsym.core.errors import DomainError, TooLargeError
from navsym.language.names import quote, suggest_nearest

#: Base unit, or a prime factor of a scale, or pi -> its exponent. The radian is 1.
Powers = dict[str | int, Fraction]

BASES = ("m", "s", "kg", "A", "K", "mol", "cd")
#: Unit -> its factor, powers of pi in it, and what it is a multiple of.
TABLE: Mapping[str, tuple[str, int, str]] = {
    "1": ("1", 0, ""), "rad": ("1", 0, ""), "sr": ("1", 0, ""), "%": ("1/100", 0, ""), "ppm": ("1/1000000", 0, ""),
    "deg": ("1/180", 1, ""), "arcmin": ("1/10800", 1, ""), "arcsec": ("1/648000", 1, ""), "gon": ("1/200", 1, ""),
    "mrad": ("1/1000", 0, ""), "urad": ("1/1000000", 0, ""), "cycle": ("2", 1, ""), "rev": ("2", 1, ""),
    "min": ("60", 0, "s"), "h": ("3600", 0, "s"), "day": ("86400", 0, "s"),
    "ms": ("1/1000", 0, "s"), "us": ("1/1000000", 0, "s"), "ns": ("1/1000000000", 0, "s"),
    "Hz": ("1", 0, "1/s"), "kHz": ("1000", 0, "1/s"), "MHz": ("1000000", 0, "1/s"), "GHz": ("1000000000", 0, "1/s"),
    "km": ("1000", 0, "m"), "dm": ("1/10", 0, "m"), "cm": ("1/100", 0, "m"), "mm": ("1/1000", 0, "m"),
    "um": ("1/1000000", 0, "m"), "ft": ("0.3048", 0, "m"), "nmi": ("1852", 0, "m"), "kn": ("463/900", 0, "m/s"),
    "g": ("9.80665", 0, "m/s^2"), "mg": ("0.00980665", 0, "m/s^2"), "ug": ("0.00000980665", 0, "m/s^2"),
    "Gal": ("1/100", 0, "m/s^2"), "mGal": ("1/100000", 0, "m/s^2"), "E": ("1/1000000000", 0, "1/s^2"),
    "N": ("1", 0, "kg m/s^2"), "J": ("1", 0, "kg m^2/s^2"), "W": ("1", 0, "kg m^2/s^3"),
    "V": ("1", 0, "kg m^2/s^3/A"), "T": ("1", 0, "kg/s^2/A"), "uT": ("1/1000000", 0, "T"),
    "nT": ("1/1000000000", 0, "T"), "G": ("1/10000", 0, "T"), "Pa": ("1", 0, "kg/m/s^2"), "hPa": ("100", 0, "Pa"),
    "mbar": ("100", 0, "Pa"), "kPa": ("1000", 0, "Pa"), "bar": ("100000", 0, "Pa"),
}  # fmt: skip
MARK = re.compile(r"\s*(?:(?P<word>[A-Za-z%]+|1)|(?P<power>\^|\*\*)|(?P<sign>[*/()·]))")
EXPONENT = re.compile(r"\s*(?:\(\s*(?P<inner>[+-]?\d{1,2}(?:/[1-9]\d?)?)\s*\)|(?P<number>[+-]?\d{1,2}))")
LONGEST = 100


def combine(parts: Iterable[tuple[Powers, Fraction | int]]) -> Powers:
    """The product of powers of units."""
    result: Powers = {}
    for powers, exponent in parts:
        for key, n in powers.items():
            result[key] = result.get(key, Fraction(0)) + n * exponent
    return {key: n for key, n in result.items() if n}


def factorise(factor: Fraction) -> Powers:
    """A scale by its primes; what has no small prime factor stands for itself."""
    result: Powers = {}
    for number, sign in ((factor.numerator, 1), (factor.denominator, -1)):
        for prime in (2, 3, 5, 7, 11, 13):
            while number % prime == 0:
                number //= prime
                result[prime] = result.get(prime, Fraction(0)) + sign
        if number > 1:
            result[number] = result.get(number, Fraction(0)) + sign
    return {key: n for key, n in result.items() if n}


def read_word(word: str, where: str) -> Powers:
    """A unit by its name."""
    if word in BASES:
        return {word: Fraction(1)}
    if word not in TABLE:
        message = f"expected a unit such as m/s, rad, deg/h or mg; got {quote(word)}; correct it"
        raise DomainError(f"{message}: {suggest_nearest(word, (*BASES, *TABLE))}", where=where)
    factor, turns, of = TABLE[word]
    pi: Powers = {"pi": Fraction(turns)} if turns else {}
    return combine([(factorise(Fraction(factor)), 1), (pi, 1), (read_unit(of, where) if of else {}, 1)])


def read_unit(text: str, where: str = "") -> Powers:
    """The powers of a unit: products with ``*`` or a space, quotients, ``^`` or ``**`` with a fraction, ``sqrt(...)``.

    Raises DomainError for a name that is not known or a text that is no unit, TooLargeError for a long one.

    >>> print_unit(read_unit("kg m/s^2")), print_unit(read_unit("m/s/sqrt(Hz)"))
    ('kg m/s^2', 'm/s^(1/2)')
    """
    if len(text) > LONGEST:
        message = f"expected a unit of at most {LONGEST} characters; got {len(text)}; shorten it"
        raise TooLargeError(message, where=where)
    powers, at = read_product(text, 0, where)
    if text[at:].strip():
        refuse(text, at, where)
    return powers


def refuse(text: str, at: int, where: str) -> NoReturn:
    """Refuse a text that is no unit."""
    got = f"{quote(text[at:].strip() or 'the end')} in {quote(text)}"
    raise DomainError(f"expected a unit such as m/s^2, deg/sqrt(h) or 1; got {got}; correct it", where=where)


def read_product(text: str, at: int, where: str) -> tuple[Powers, int]:
    """Factors up to a closing bracket or the end, and the place behind them; every ``/`` inverts one factor."""
    factors: list[tuple[Powers, Fraction | int]] = []
    sign = 1
    while (mark := MARK.match(text, at)) and mark["sign"] != ")":
        if mark["sign"] in ("*", "/", "·") and factors and sign:
            sign, at = (-1 if mark["sign"] == "/" else 1), mark.end()
            mark = MARK.match(text, at)
        if not mark or mark["power"] or mark["sign"] not in (None, "("):
            refuse(text, at, where)
        powers, at = read_factor(text, mark, where)
        exponent = Fraction(1)
        if (power := MARK.match(text, at)) and power["power"]:
            number = EXPONENT.match(text, power.end())
            if not number:
                refuse(text, power.end(), where)
            exponent, at = Fraction(number["inner"] or number["number"]), number.end()
        factors.append((powers, sign * exponent))
        sign = 1
    if not factors:
        refuse(text, at, where)
    return combine(factors), at


def read_factor(text: str, mark: re.Match[str], where: str) -> tuple[Powers, int]:
    """A name, a bracket or a square root, and the place behind it."""
    rooted = mark["word"] == "sqrt"
    opening = MARK.match(text, mark.end()) if rooted else mark
    if opening is None or opening["sign"] != "(":
        return read_word(mark["word"], where), mark.end()
    powers, at = read_product(text, opening.end(), where)
    closing = MARK.match(text, at)
    if not closing or closing["sign"] != ")":
        refuse(text, at, where)
    return combine([(powers, Fraction(1, 2) if rooted else 1)]), closing.end()


def print_unit(powers: Powers) -> str:
    """The base units of powers; a scale stands before them as a number.

    >>> print_unit(read_unit("deg/h")), print_unit({})
    ('pi/648000 1/s', '1')
    """
    scale = Fraction(1)
    turns = Fraction(0)
    above: list[str] = []
    below: list[str] = []
    for key, n in powers.items():
        if key == "pi":
            turns = n
        elif isinstance(key, int):
            scale *= Fraction(key) ** int(n) if n.denominator == 1 else 1
        else:
            power = "" if abs(n) == 1 else f"^{abs(n)}" if n.denominator == 1 else f"^({abs(n)})"
            (above if n > 0 else below).append(f"{key}{power}")
    unit = "/".join([" ".join(above) or ("1" if below else ""), *below])
    pi = {0: "", 1: "pi"}.get(turns.numerator if turns.denominator == 1 else -1, f"pi^{turns}")
    number = f"{pi}/{scale.denominator}" if pi and scale.numerator == 1 else f"{scale}{pi}"
    return " ".join(part for part in ("" if number in ("1", "") else number, unit) if part) or "1"
