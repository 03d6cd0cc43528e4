"""Numbers that are known by an enclosure."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import takewhile
from typing import Any

from navsym.core.errors import MissingEngineError
from navsym.core.units import BASES, convert_number, read_unit

#: Fewer shared digits than these are no picture of a number: 1.6999 … 1.7001 would be 1.
FEW = 4


@dataclass(frozen=True, slots=True)
class Number:
    """A real number between two decimal strings that are rounded outwards: it lies between them for certain.

    lower, upper : decimal strings

    >>> root = Number("1.41421356", "1.41421357")
    >>> root.digits, float(root), str(root), str(Number("2.59999999", "2.60000001"))
    (8, 1.414213565, '1.4142135', '2.6')
    """

    lower: str
    upper: str

    @property
    def digits(self) -> int:
        """Significant digits to which both ends agree: ``floor(-log10(relative width))``, at least 0."""
        low, high = Fraction(self.lower), Fraction(self.upper)
        size = max(abs(low), abs(high))
        if low == high:
            return len(self.lower.strip("-").replace(".", "").lstrip("0")) or 1
        count = 0
        while (high - low) * 10 ** (count + 1) <= size and count < 10_000:
            count += 1
        return count

    def __float__(self) -> float:
        return float((Fraction(self.lower) + Fraction(self.upper)) / 2)

    def __str__(self) -> str:
        """The digits that both ends share; the middle where these are few, as beside 2.6 = 2.5999 … 2.6001."""
        if self.lower == self.upper:
            return self.lower
        pairs = takewhile(lambda pair: pair[0] == pair[1], zip(self.lower, self.upper, strict=False))
        text = "".join(letter for letter, _ in pairs)
        shared = len(text.strip("-").replace(".", "").lstrip("0"))
        if "." in text[:-1] and shared >= max(FEW, self.digits - 1):
            return text.rstrip(".")
        if self.digits < 3:
            return f"{self.lower} … {self.upper}"
        rounded = (f"{float(self):.{count}g}" for count in range(min(self.digits, 15), 18))
        return next((number for number in rounded if Fraction(number) in self), f"{self.lower} … {self.upper}")

    @property
    def words(self) -> str:
        """What stands behind a name: ``= 2``, ``= 1.4142135…``, ``≈ 2.6``, or both ends where they share no digits."""
        if self.lower == self.upper:
            return f"= {self.lower.rstrip('0').rstrip('.') if '.' in self.lower else self.lower}"
        text = str(self)
        if "…" in text:
            return f"in [{self.lower}, {self.upper}]"
        return f"= {text}…" if self.lower.startswith(text) and self.upper.startswith(text) else f"≈ {text}"

    def __contains__(self, value: object) -> bool:
        """True when an exact number lies between the ends: ``Fraction(1, 3) in number``."""
        return isinstance(value, (int, Fraction)) and Fraction(self.lower) <= value <= Fraction(self.upper)

    def quantity(self, unit: str, registry: Any = None) -> Any:
        """A number of a unit, such as ``"deg/h"`` or ``"mg"``, as a quantity of pint in SI: its middle as a double.

        registry : that of pint in which it is one; by default that of the application

        Raises MissingEngineError without pint, DomainError for a text that is no unit.
        """
        if registry is None:
            try:
                import pint
            except ImportError:
                message = "expected the package pint for quantities; got none; pip install 'navsym[units]'"
                raise MissingEngineError(message, where="quantity") from None
            registry = pint.get_application_registry()
        powers = {key: float(n) for key, n in read_unit(unit, "quantity: unit").items() if key in BASES}
        return registry.Quantity(
            convert_number(float(self), unit, "", "quantity: unit"), registry.UnitsContainer(powers)
        )

    def document(self) -> dict[str, str]:
        """``{"lower", "upper"}``, as in the documents of the verbs."""
        return {"lower": self.lower, "upper": self.upper}

    def _repr_latex_(self) -> str:
        return f"${self}$" if "…" not in str(self) else rf"$[{self.lower},\ {self.upper}]$"
