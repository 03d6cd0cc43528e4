"""Units in the column heads of a track: each converts to seconds, radians or metres with one rounding."""

from __future__ import annotations

import math
import re
import tomllib
from dataclasses import dataclass, replace
from decimal import Context, Decimal
from fractions import Fraction
from pathlib import Path

from navsym.core.errors import DomainError
from navsym.language.names import quote

#: Digits of a conversion before its one rounding to a double.
EXACTLY = Context(prec=40)
#: A head such as ``lat (1e-7 deg)``: what stands in brackets, and a number before the unit.
BRACKETS = re.compile(r"[(\[](.*?)[)\]]")
MULTIPLE = re.compile(
    r"(?P<number>10(?:\^|\*\*)[+-]?\d{1,2}|\d*\.?\d+(?:e[+-]?\d{1,2})?)\s*[*x\u00b7\u00d7]?\s*(?P<unit>\D.*)"
)


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit of a column.

    name   : as the head has it; empty where it names none
    factor : seconds, degrees or metres in one of it; radians where ``radian`` is set
    angle  : whether the column is an angle, which leaves in radians; radian : whether it comes in them
    """

    name: str
    factor: Fraction
    angle: bool = False
    radian: bool = False

    def convert(self, value: float) -> float:
        """Seconds, radians or metres of a value; the decimals that were written are multiplied exactly."""
        if self.factor != 1:
            product = EXACTLY.multiply(Decimal(repr(value)), self.factor.numerator)
            value = float(EXACTLY.divide(product, Decimal(self.factor.denominator)))
        return math.radians(value) if self.angle and not self.radian else value


#: Quantity -> unit -> how much one is of the usual unit, and its other spellings.
TABLE: dict[str, dict[str, list[str]]] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
#: Words of a head that name a clock, a datum or a direction and no unit.
REMARKS = frozenset(
    "utc gps gpst gnss tai unix epoch tow sow wgs84 wgs-84 itrf etrs89 nad83 north east "
    "ellipsoid ellipsoidal hae msl amsl".split()
)


def table_of(quantity: str, **kind: bool) -> dict[str, Unit]:
    """Spelling -> unit."""
    return {
        word: Unit(name, Fraction(factor), **kind)
        for name, (factor, others) in TABLE[quantity].items()
        for word in (spelling(name), *map(spelling, others.split()))
    }


def spelling(text: str) -> str:
    """A unit in lower case, with hyphens between its words."""
    plain = text.lower().replace("\u00b5", "u").replace("\u03bc", "u").replace("\u00b0", "deg")
    return re.sub(r"[\s_.-]+", "-", plain).strip("-")


ANGLES = table_of("degrees", angle=True) | table_of("radians", angle=True, radian=True)
#: Column -> the units that it may have; the first is that of a column without one.
UNITS = {"t": table_of("time"), "lat": ANGLES, "lon": ANGLES, "h": table_of("length")}
QUANTITIES = {"t": "time", "lat": "angle", "lon": "angle", "h": "length"}


def usual_unit(column: str) -> Unit:
    """Seconds, degrees or metres: the unit of a column that names none."""
    unit = next(iter(UNITS[column].values()))
    return Unit("", unit.factor, unit.angle)


def unit_of(column: str, head: str, where: str) -> Unit:
    """The unit in brackets of a head, ``height (ft)``; the usual one where it names none.

    column : ``t``, ``lat``, ``lon`` or ``h``; where : place of the head; raises DomainError for an unknown unit
    """
    units = [read_unit(column, part) for part in ",".join(BRACKETS.findall(head)).split(",")]
    named = [unit for unit in units if unit is None or unit.name]
    if not named and any(not text.strip() for text in BRACKETS.findall(head)):
        named = [None]  # brackets that name nothing
    if not named:
        return usual_unit(column)
    if named.count(named[0]) < len(named) or named[0] is None:
        known = ", ".join(dict.fromkeys(unit.name for unit in UNITS[column].values()))
        expected = f"a column {column} in a unit of {QUANTITIES[column]} ({known})"
        message = f"expected {expected}; got the head {quote(head)}; correct it, or convert the column"
        raise DomainError(message, where=where)
    return named[0]


def read_unit(column: str, text: str) -> Unit | None:
    """The unit of a text, the usual one of a text that names none, and None for one that is not known."""
    plain = re.sub(r"\bsince\b.*", "", text.strip().lower())
    if not plain or spelling(plain) in REMARKS:
        return usual_unit(column)
    multiple = MULTIPLE.fullmatch(plain)
    number = re.sub(r"10(\^|\*\*)", "1e", multiple["number"]) if multiple else "1"
    words = spelling(multiple["unit"] if multiple else plain).split("-")
    unit = UNITS[column].get("-".join(word for word in words if word not in REMARKS))
    if unit is None or not multiple or not Fraction(number):
        return unit if not multiple else None
    return replace(unit, name=f"{number} {unit.name}", factor=unit.factor * Fraction(number))
