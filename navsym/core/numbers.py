"""Numbers that are known by an enclosure."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True, slots=True)
class Number:
    """A real number between two decimal strings that are rounded outwards: it lies between them for certain.

    lower, upper : decimal strings

    >>> root = Number("1.41421356", "1.41421357")
    >>> root.digits, float(root), str(root)
    (8, 1.414213565, '1.4142135')
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
        """The digits that both ends share; where they share none, the middle to as many digits as are certain."""
        if self.lower == self.upper:
            return self.lower
        shared = 0
        for a, b in zip(self.lower, self.upper, strict=False):
            if a != b:
                break
            shared += 1
        text, whole = self.lower[:shared], len(self.lower.partition(".")[0])
        if shared > whole and text.strip("-0."):
            return text.rstrip(".")
        wide = self.digits < 3 or text.strip("-0.") != ""
        return f"{self.lower} … {self.upper}" if wide else f"{float(self):.{min(self.digits, 15)}g}"

    def __contains__(self, value: object) -> bool:
        """True when an exact number lies between the ends: ``Fraction(1, 3) in number``."""
        return isinstance(value, (int, Fraction)) and Fraction(self.lower) <= value <= Fraction(self.upper)

    def document(self) -> dict[str, str]:
        """``{"lower", "upper"}``, as in the documents of the verbs."""
        return {"lower": self.lower, "upper": self.upper}

    def _repr_latex_(self) -> str:
        return f"${self}$" if "…" not in str(self) else rf"$[{self.lower},\ {self.upper}]$"
