"""Units as text: a small table of SI and of what navigators write, read into powers of base units and of scales.

Quantities of pint come in as such a text: of pint nothing is used but a magnitude and names of units.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from fractions import Fraction
from math import pi, prod
from typing import Any, NoReturn

from navsym.core.errors import DomainError, TooLargeError, quote, suggest_nearest

#: Base unit, or a prime factor of a scale, or pi -> its exponent. The radian is 1.
Powers = dict[str | int, Fraction]

BASES = ("m", "s", "kg", "A", "K", "mol", "cd")
#: Unit -> its factor, powers of pi in it, and what it is a multiple of.
TABLE: dict[str, tuple[str, int, str]] = {
    "1": ("1", 0, ""), "rad": ("1", 0, ""), "sr": ("1", 0, ""), "%": ("1/100", 0, ""), "ppm": ("1/1000000", 0, ""),
    "deg": ("1/180", 1, ""), "arcmin": ("1/10800", 1, ""), "arcsec": ("1/648000", 1, ""), "gon": ("1/200", 1, ""),
    "cycle": ("2", 1, ""), "rev": ("2", 1, ""), "min": ("60", 0, "s"), "h": ("3600", 0, "s"), "day": ("86400", 0, "s"),
    "week": ("604800", 0, "s"), "Hz": ("1", 0, "1/s"), "ft": ("0.3048", 0, "m"), "inch": ("0.0254", 0, "m"),
    "mile": ("1609.344", 0, "m"), "nmi": ("1852", 0, "m"), "kn": ("463/900", 0, "m/s"), "g": ("9.80665", 0, "m/s^2"),
    "Gal": ("1/100", 0, "m/s^2"), "E": ("1/1000000000", 0, "1/s^2"), "N": ("1", 0, "kg m/s^2"), "J": ("1", 0, "N m"),
    "W": ("1", 0, "J/s"), "V": ("1", 0, "W/A"), "T": ("1", 0, "kg/s^2/A"), "G": ("1/10000", 0, "T"),
    "Pa": ("1", 0, "N/m^2"), "bar": ("100000", 0, "Pa"), "gram": ("1/1000", 0, "kg"),
}  # fmt: skip
#: Long names, which are those of pint, and the powers of ten of their prefixes. Its gauss is none of SI.
NAMES = {
    "meter": "m", "second": "s", "gram": "gram", "ampere": "A", "kelvin": "K", "mole": "mol", "candela": "cd",
    "radian": "rad", "steradian": "sr", "percent": "%", "degree": "deg", "arcminute": "arcmin", "arcsecond": "arcsec",
    "grade": "gon", "turn": "rev", "minute": "min", "hour": "h", "hertz": "Hz", "foot": "ft", "nautical_mile": "nmi",
    "knot": "kn", "kilometer_per_hour": "km/h", "revolutions_per_minute": "rev/min", "standard_gravity": "g",
    "galileo": "Gal", "newton": "N", "joule": "J", "watt": "W", "volt": "V", "tesla": "T",
    "pascal": "Pa", "bar": "bar",
}  # fmt: skip
PREFIXES = {
    "": 0, "giga": 9, "mega": 6, "kilo": 3, "hecto": 2, "deci": -1, "centi": -2, "milli": -3, "micro": -6, "nano": -9,
}  # fmt: skip
LETTERS = dict(zip("numcdhkMG", (-9, -6, -3, -2, -1, 2, 3, 6, 9), strict=True))
#: Multiples that are written short; others have their long names.
SHORT = "mrad urad ms us ns kHz MHz GHz km dm cm mm um mg ug mGal uT nT hPa kPa mbar".split()
TABLE |= {name: (f"1e{LETTERS[name[0]]}", 0, name[1:]) for name in SHORT}
#: A number, and one before a unit with a blank between; ``2 pi`` and a cut ``1.2E`` are none.
NUMBER = re.compile(r"[+-]?(?:\d++/\d*[1-9]\d*+|(?:\d++(?:\.\d*+)?+|\.\d++)(?:[eE][+-]?\d{1,3})?+)", re.ASCII)
AMOUNT = re.compile(rf"\s*({NUMBER.pattern})\s+((?!pi\b)[A-Za-z%].*)", re.ASCII)
MARK = re.compile(r"\s*(?:(?P<word>[A-Za-z%_]+|1)|(?P<power>\^|\*\*)|(?P<sign>[*/()·]))")
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
    prefix = next((p for p in PREFIXES if word.startswith(p) and word.removeprefix(p) in NAMES), None)
    if word not in TABLE and prefix is not None:
        unit = read_unit(NAMES[word.removeprefix(prefix)], where)
        return combine([(factorise(Fraction(10) ** PREFIXES[prefix]), 1), (unit, 1)])
    if word not in TABLE:
        message = f"expected a unit such as m/s, rad, deg/h or mg; got {quote(word)}; correct it"
        raise DomainError(f"{message}: {suggest_nearest(word, (*BASES, *TABLE, *NAMES))}", where=where)
    factor, turns, of = TABLE[word]
    turn: Powers = {"pi": Fraction(turns)} if turns else {}
    return combine([(factorise(Fraction(factor)), 1), (turn, 1), (read_unit(of, where) if of else {}, 1)])


def split_scale(powers: Powers) -> tuple[Fraction, Powers]:
    """The scale of a unit: a fraction, and the powers of pi and of roots beside it."""
    roots = {key: n for key, n in powers.items() if key == "pi" or (key not in BASES and n.denominator > 1)}
    return prod((Fraction(k) ** int(powers[k]) for k in powers.keys() - roots - {*BASES}), start=Fraction(1)), roots


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
    scale, roots = split_scale(powers)
    turns = roots.pop("pi", Fraction(0))
    above: list[str] = []
    below: list[str] = []
    for key, n in powers.items():
        if key in BASES or key in roots:
            power = "" if abs(n) == 1 else f"^{abs(n)}" if n.denominator == 1 else f"^({abs(n)})"
            (above if n > 0 else below).append(f"{key}{power}")
    unit = "/".join([" ".join(above) or ("1" if below else ""), *below])
    turn = {0: "", 1: "pi"}.get(turns, f"pi^({turns})")  # type: ignore[call-overload]
    number = f"{turn}/{scale.denominator}" if turn and scale.numerator == 1 else f"{scale}{turn}"
    return " ".join(part for part in ("" if number in ("1", "") else number, unit) if part) or "1"


# Numbers with units


def is_quantity(value: Any) -> bool:
    """Whether a value is a quantity of pint, which is not loaded to find that out."""
    return hasattr(type(value), "unit_items")


def unit_text(quantity: Any) -> str:
    """The unit of a quantity of pint as text; pint writes a square root as a float."""
    powers = ((name, Fraction(n).limit_denominator(99)) for name, n in quantity.unit_items())
    return " ".join(name if n == 1 else f"{name}^({n})" for name, n in powers) or "1"


def scale_of(text: str, unit: str, where: str) -> tuple[Fraction, Powers]:
    """What one of a unit is in another, or in SI where that is empty: a fraction, and powers of pi and of roots.

    Raises DomainError that names both units where their dimensions differ.

    >>> scale_of("deg/h", "", ""), scale_of("ft", "km", "")
    ((Fraction(1, 648000), {'pi': Fraction(1, 1)}), (Fraction(381, 1250000), {}))
    """
    powers = read_unit(text, where)
    wanted: Powers = read_unit(unit, where) if unit else {key: n for key, n in powers.items() if key in BASES}
    scale = combine([(powers, 1), (wanted, -1)])
    if not scale.keys().isdisjoint(BASES):
        raise DomainError(f"expected a quantity in {unit}; got one in {text}; correct it", where=where)
    return split_scale(scale)


def convert_number(number: Any, text: str, unit: str, where: str) -> Any:
    """A float, or an array of them, of a unit in another one, or in SI."""
    whole, roots = scale_of(text, unit, where)
    root = prod((pi if key == "pi" else float(key)) ** float(n) for key, n in roots.items())
    return number * float(whole.numerator) / float(whole.denominator) * root


def convert_text(number: str, text: str, unit: str, where: str) -> str:
    """The exact number of a unit, or of SI, in a number of another unit."""
    whole, roots = scale_of(text, unit, where)
    exact = NUMBER.fullmatch(number)
    factors = [str(Fraction(number) * whole) if exact else f"({number})*({whole})"]
    return "*".join([*factors, *(f"{key}" if n == 1 else f"{key}**({n})" for key, n in roots.items())])


def drop_unit(text: Any, where: str, unit: str = "") -> Any:
    """A text that is a number with a unit as the number in another unit, or in SI; everything else as it is.

    >>> drop_unit("3 deg/h", ""), drop_unit("90 min", "", "h"), drop_unit("pi/2", "")
    ('1/216000*pi', '3/2', 'pi/2')
    """
    found = AMOUNT.fullmatch(text) if isinstance(text, str) and len(text) <= 2 * LONGEST else None
    return text if found is None else convert_text(found[1], found[2], unit, where)
