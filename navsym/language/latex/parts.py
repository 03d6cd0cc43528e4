"""The parts of a formula as it is printed, before anybody asks for vectors and matrices: both readers build them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

#: Nesting of groups, fractions and roots.
DEPTH = 60


@dataclass(frozen=True, slots=True)
class Part:
    """A piece of a formula.

    head : ``num name unknown + - * ^ mark () frac sqrt abs norm floor call matrix skew dot diff integral sum index``,
           ``limit inner list cases cond``, ``eye`` and ``zeros``, ``order`` for ``O(x^k)``
    args : parts and texts; a product has its marks between its factors: ``(a, "", b, "/", c)``
    at   : where it begins; two readings are compared without it
    """

    head: str
    args: tuple[Any, ...]
    at: int = field(compare=False, default=0)


class Refusal(Exception):
    """Why a formula is not read, and where: ``expected …; got …; remedy``."""

    def __init__(self, at: int, expected: str, got: str, remedy: str) -> None:
        super().__init__(f"expected {expected}; got {got}; {remedy}")
        self.at, self.got = at, got


def join_terms(terms: list[Part]) -> Part:
    """A sum; one term stands for itself."""
    return terms[0] if len(terms) == 1 else Part("+", tuple(terms), terms[0].at)


def join_factors(factors: list[Any]) -> Part:
    """A product of factors and marks; one factor stands for itself."""
    return factors[0] if len(factors) == 1 else Part("*", tuple(factors), factors[0].at)


def degrees(text: str, at: int) -> Part:
    """A number of degrees in radians."""
    return Part("frac", (Part("*", (Part("num", (text,)), "", Part("num", ("pi",)))), Part("num", ("180",))), at)


def list_unknown(part: Part) -> list[Part]:
    """The names in a part that nobody declared; ``"whole"`` stands behind a name that is the end of a sum."""
    found = [part] if part.head == "unknown" else []
    for place, inner in enumerate(part.args):
        if isinstance(inner, Part):
            names = list_unknown(inner)
            ends = part.head == "sum" and place > 2
            found += [replace(name, args=(*name.args[:2], "whole")) for name in names] if ends else names
    return found


def list_names(part: Part) -> list[str]:
    """The names in a part, in the order of writing."""
    if part.head in ("name", "index"):
        return [str(part.args[0])]
    return [name for inner in part.args if isinstance(inner, Part) for name in list_names(inner)]
