"""Long entries: the sums that code and expectation share become symbols of their own, with their meaning as hypotheses.

Code of a filter names its common parts, and what is expected of it has the same parts. Multiplied out they are long;
by name both sides are short. The statement ``shared1x = ... implies left = right`` is the same statement as the long
one: each symbol stands for a polynomial, which has one value at every point. The checker reads it as a whole.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from navsym.core.errors import DomainError, TooLargeError
from navsym.language.polynomials import to_polynomial
from navsym.language.tree import (
    NUMBER,
    POWER,
    PRODUCT,
    SUM,
    SYMBOL,
    Tree,
    build,
    build_symbol,
    list_names,
    list_parts,
    parts_of,
)


@dataclass(frozen=True, slots=True, eq=False)
class Shortened:
    """Two sides in which shared parts are symbols.

    meanings : symbol -> what it stands for, in the symbols of its own parts and the inputs
    """

    left: Tree
    right: Tree
    meanings: Mapping[str, Tree]

    def inputs(self) -> list[str]:
        """The other symbols."""
        names = list_names(self.left, self.right, *self.meanings.values())
        return [name for name in names if name not in self.meanings]

    def complete(self, point: Mapping[str, Fraction]) -> dict[str, Fraction]:
        """The point with the exact values of the shared parts."""
        known = dict(point)
        for name, tree in self.meanings.items():  # each behind those in it
            known[name] = evaluate_polynomial(tree, known)
        return known


def shorten_sides(code: Tree, expected: Tree) -> Shortened | None:
    """Both sides by shared parts, equal as polynomials then; None where no choice of parts makes them so."""
    parts = list_parts(code, expected)
    for shared in choose_shared(code, expected, parts):
        short = name_parts(code, expected, parts, shared)
        names = list_names(short.left, short.right)
        try:
            if to_polynomial(short.left, names) == to_polynomial(short.right, names):
                return short
        except (DomainError, TooLargeError):
            return None
    return None


def choose_shared(code: Tree, expected: Tree, parts: list[Tree]) -> Iterator[set[Tree]]:
    """The sums that both sides have: all of them, then only those without another one inside."""
    total: set[Tree] = set()
    for part in parts:
        if is_polynomial_head(part) and all(inner in total for inner in parts_of(part)):
            total.add(part)
    both = {*list_parts(code)} & {*list_parts(expected)}
    shared = {part for part in both if part.head == SUM and part in total} - {code, expected}
    above: set[Tree] = set()  # parts with a shared one inside
    for part in parts:
        if any(inner in above or inner in shared for inner in parts_of(part)):
            above.add(part)
    if shared:
        yield shared
    if shared & above:
        yield shared - above


def is_polynomial_head(part: Tree) -> bool:
    """True for what makes polynomials of polynomials, which have a value at every point."""
    if part.head != POWER:
        return part.head in (NUMBER, SYMBOL, SUM, PRODUCT)
    exponent = part.args[1]
    return exponent.head == NUMBER and exponent.args[0].denominator == 1 and 0 < exponent.args[0] <= 64


def name_parts(code: Tree, expected: Tree, parts: list[Tree], shared: set[Tree]) -> Shortened:
    """The sides with a symbol for each shared part, under names that occur nowhere in them."""
    taken = {part.args[0] for part in parts if part.head == SYMBOL}
    letter = "shared"
    while any(name.startswith(letter) for name in taken):
        letter += "x"
    renamed: dict[Tree, Tree] = {}
    meanings: dict[str, Tree] = {}
    for part in parts:
        inner = tuple(renamed.get(arg, arg) if isinstance(arg, Tree) else arg for arg in part.args)
        renamed[part] = build(part.head, inner) if parts_of(part) else part
        if part in shared:
            name = f"{letter}{len(meanings) + 1}"
            meanings[name], renamed[part] = renamed[part], build_symbol(name)
    left, right = renamed[code], renamed[expected]
    used = {*list_names(left, right)}
    for name in reversed(meanings):
        if name in used:
            used |= {*list_names(meanings[name])}
    return Shortened(left, right, {name: tree for name, tree in meanings.items() if name in used})


def evaluate_polynomial(tree: Tree, point: Mapping[str, Fraction]) -> Fraction:
    """The exact value of a polynomial."""
    values: dict[Tree, Fraction] = {}
    for part in list_parts(tree):
        inner = [values[arg] for arg in parts_of(part)]
        if part.head == SUM:
            values[part] = sum(inner, Fraction(0))
        elif part.head == PRODUCT:
            values[part] = math.prod(inner, start=Fraction(1))
        elif part.head == POWER:
            values[part] = inner[0] ** int(inner[1])
        else:
            values[part] = point[part.args[0]] if part.head == SYMBOL else part.args[0]
    return values[tree]
