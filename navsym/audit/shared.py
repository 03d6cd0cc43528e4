"""Long entries: the sums that code and expectation share become symbols of their own, with their meaning as hypotheses.

Code of a filter names its common parts, and what is expected of it has the same parts. Multiplied out they are long;
by name both sides are short. The statement ``shared1x = ... implies left = right`` is the same statement as the long
one: each symbol stands for a polynomial, which has one value at every point. The checker reads it as a whole.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from navsym.core.errors import DomainError, TooLargeError
from navsym.language.domains import rational_value
from navsym.language.polynomials import to_polynomial
from navsym.language.tree import (
    NUMBER,
    POWER,
    PRODUCT,
    SUM,
    SYMBOL,
    Tree,
    build,
    build_number,
    build_symbol,
    list_names,
    list_parts,
    parts_of,
    replace,
)

Pair = tuple[Tree, Tree]


@dataclass(frozen=True, slots=True, eq=False)
class Shortened:
    """Pairs of sides in which shared parts are symbols.

    meanings : symbol -> what it stands for, in the symbols of its own parts and the inputs
    """

    pairs: tuple[Pair, ...]
    meanings: Mapping[str, Tree]

    def inputs(self) -> list[str]:
        """The other symbols."""
        names = list_names(*itertools.chain(*self.pairs), *self.meanings.values())
        return [name for name in names if name not in self.meanings]

    def complete(self, point: Mapping[str, Fraction]) -> dict[str, Fraction]:
        """The point with the exact values of the shared parts."""
        known = {build_symbol(name): build_number(value) for name, value in point.items()}
        for name, tree in self.meanings.items():  # each behind those in it
            value = rational_value(replace(tree, known))
            if value is None:
                raise TooLargeError("expected numbers of bounded size; got larger ones; ask for fewer entries")
            known[build_symbol(name)] = build_number(value)
        return {symbol.args[0]: number.args[0] for symbol, number in known.items()}


def shorten_pairs(pairs: Sequence[Pair]) -> Iterator[tuple[list[Pair], Shortened]]:
    """Those pairs whose sides are equal as polynomials in shared parts, as they are and by these parts.

    The parts are the sums that both sides have: all of them, then only those without another one inside.
    """
    waiting = list(pairs)
    for is_inner in (False, True):
        codes, expected = ({*list_parts(*side)} for side in zip(*waiting, strict=True))
        parts = list_parts(*itertools.chain(*waiting))
        total: set[Tree] = set()
        for part in parts:
            if is_polynomial_head(part) and all(inner in total for inner in parts_of(part)):
                total.add(part)
        shared = {part for part in codes & expected & total if part.head == SUM} - {*itertools.chain(*waiting)}
        above: set[Tree] = set()  # parts with a shared one inside
        for part in parts:
            if any(inner in above or inner in shared for inner in parts_of(part)):
                above.add(part)
        shared = shared - above if is_inner else shared
        if not shared:
            return
        short = name_parts(waiting, parts, shared)
        equal = [is_same(*pair) for pair in short.pairs]
        if any(equal):
            kept = tuple(itertools.compress(short.pairs, equal))
            yield list(itertools.compress(waiting, equal)), Shortened(kept, short.meanings)
        waiting = [pair for pair, is_equal in zip(waiting, equal, strict=True) if not is_equal]
        if not waiting:
            return


def is_same(left: Tree, right: Tree) -> bool:
    """True for two polynomials that are equal."""
    names = list_names(left, right)
    try:
        return bool(to_polynomial(left, names) == to_polynomial(right, names))
    except (DomainError, TooLargeError):
        return False


def is_polynomial_head(part: Tree) -> bool:
    """True for what makes polynomials of polynomials, which have a value at every point."""
    if part.head != POWER:
        return part.head in (NUMBER, SYMBOL, SUM, PRODUCT)
    exponent = part.args[1]
    return exponent.head == NUMBER and exponent.args[0].denominator == 1 and 0 < exponent.args[0] <= 64


def name_parts(pairs: Sequence[Pair], parts: list[Tree], shared: set[Tree]) -> Shortened:
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
    return Shortened(tuple((renamed[code], renamed[expected]) for code, expected in pairs), meanings)
