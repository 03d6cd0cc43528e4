"""Entries of the book by a formula: what is the same up to the names of symbols and the order of terms.

Two formulas match when one renaming of symbols, different ones for different ones, makes them equal; terms of sums,
factors of products and the sides of an equation may stand in any order, and ``sqrt(x)`` is ``x**(1/2)``. This finds
what was written alike: no algebra is done, and nothing is claimed of what is found but its own verdict.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from fractions import Fraction
from functools import lru_cache
from itertools import combinations
from math import comb
from typing import TYPE_CHECKING, Any

from navsym.core.errors import ExpressionSyntaxError, NavsymError
from navsym.language.expression import LENGTH, Reader
from navsym.language.names import quote
from navsym.language.tokens import Source, split_tokens
from navsym.language.tree import NUMBER, POWER, PRODUCT, SUM, SYMBOL, Tree, build, fold_tree
from navsym.language.vectors import ValueReader, guard

if TYPE_CHECKING:
    from navsym.book.entries import Entry

Form = tuple[Any, ...]  # head and arguments; ("number", q), ("symbol", name)

COMMUTATIVE = frozenset({SUM, PRODUCT, "=", "!=", "dot", "min", "max"})
SIGN = re.compile(r"[<>!]=|[<>=]")
MOST_SHARES = 500  # of a sum
MOST_STEPS = 5_000  # in comparing two formulas; beyond they count as different


def is_formula(text: str) -> bool:
    """Whether a search is for a formula and not for words.

    >>> is_formula("melbourne wubbena"), is_formula("time-of-flight"), is_formula("1 - e**2*sin(L)**2")
    (False, False, True)
    """
    return not re.fullmatch(r"[\w'., -]*", text) or bool(re.search(r"(^|\s)-|-\s|\w-\d", text))


def find_formula(text: str, entries: Mapping[str, Entry]) -> list[Entry]:
    """Entries that state the formula, then those with it as a side, then those with it as a part.

    Raises ExpressionSyntaxError, with the column, for a text that is no formula.
    """
    sides = read_sides(text)
    goals = {write_form(side) for side in (sides if len(sides) == 1 else pair_sides(text, sides))}
    if len(goals) > 1:
        message = f"expected an expression or one relation; got a chain, {quote(text)}; search for one link"
        raise ExpressionSyntaxError(message, where="search")
    (goal,) = goals
    if goal[0] in ("symbol", "number"):
        message = f"expected a formula of more than one symbol; got {quote(text)}; search for words"
        raise ExpressionSyntaxError(message, where="search")
    found = []
    for place, entry in enumerate(entries.values()):
        for rank, forms in enumerate(list_forms(entry.statement)):
            if any(is_renamed(goal, form) or (rank == 2 and is_share(goal, form)) for form in forms):
                found.append((rank, place, entry))
                break
    return [entry for _, _, entry in sorted(found, key=lambda row: row[:2])]


class LooseReader(ValueReader):
    """The grammar of values without declarations: a name may be a number, a vector or a matrix."""

    def size_of(self, at: int, part: Tree, sizes: list[Any]) -> None:
        """Shapes are not known."""

    def name(self, at: int, token: str) -> Tree:
        """Any name; inside an integral or sum its variable is not the only one."""
        self.names = None
        return super().name(at, token)

    def atom(self) -> Tree:
        """What may have .T and indices behind it."""
        value = self.rows() if self.tokens[self.position] == "[" else Reader.atom(self)
        while (mark := self.tokens[self.position]) in (".", "["):
            self.position += 1
            if mark == ".":
                if self.tokens[self.position] != "T":
                    self.unexpected("T behind the point, the transpose,")
                self.position += 1
                value = build("T", (value,))
                continue
            places = [self.place()]
            while self.tokens[self.position] == "," and len(places) < 2:
                self.position += 1
                places.append(self.place())
            if self.tokens[self.position] != "]":
                self.unexpected("] behind the index")
            self.position += 1
            value = build("index", (value, *(build(NUMBER, (Fraction(p),)) for p in places)))
        return value


def read_sides(text: str) -> list[Tree]:
    """The expressions between relations."""
    pieces, start = [], 0
    for mark in find_relations(text):
        pieces.append(text[start : mark.start()])
        start = mark.end()
    trees = []
    for piece in (*pieces, text[start:]):
        source = Source(piece, "search", wide=True)
        reader = LooseReader(source, split_tokens(source, LENGTH), None)
        trees.append(guard(reader, reader.whole))
    return trees


def find_relations(text: str) -> list[re.Match[str]]:
    """The relations of a text that stand in no brackets."""
    return [m for m in SIGN.finditer(text) if sum((c in "([") - (c in ")]") for c in text[: m.start()]) == 0]


def pair_sides(text: str, sides: list[Tree]) -> Iterator[Tree]:
    """The links of a chain."""
    for k, mark in enumerate(find_relations(text)):
        x, y = sides[k : k + 2]
        yield build(mark[0], (x, y)) if mark[0] not in (">", ">=") else build(mark[0].replace(">", "<"), (y, x))


@lru_cache(maxsize=4096)
def list_forms(statement: str) -> tuple[tuple[Form, ...], tuple[Form, ...], tuple[Form, ...]]:
    """The relations of a statement, their sides, and all parts of these that are more than a symbol."""
    links: list[Tree] = []
    for text in split_commas(statement):
        try:
            links += pair_sides(text, read_sides(text))
        except NavsymError:
            continue
    sides = [write_form(side) for link in links for side in link.args]
    parts = dict.fromkeys(part for side in sides for part in list_parts(side))
    return tuple(map(write_form, links)), tuple(sides), tuple(parts)


def split_commas(text: str) -> Iterator[str]:
    """The texts between commas that stand in no brackets."""
    depth, start = 0, 0
    for k, char in enumerate(text):
        depth += (char in "([") - (char in ")]")
        if char == "," and depth == 0:
            yield text[start:k]
            start = k + 1
    yield text[start:]


def write_form(tree: Tree) -> Form:
    """A tree with sums and products taken together, equal factors as powers, and numbers multiplied out."""

    def step(part: Tree, inner: list[Form]) -> Form:
        if part.head in (NUMBER, SYMBOL):
            return ("number" if part.head == NUMBER else "symbol", part.args[0])
        if part.head == "sqrt":
            return (POWER, inner[0], ("number", Fraction(1, 2)))
        if part.head == SUM:
            return collect(SUM, inner, Fraction(0))
        if part.head == PRODUCT:
            return collect(PRODUCT, inner, Fraction(1))
        if part.head == POWER and inner[0][0] == POWER and inner[0][2][0] == inner[1][0] == "number":
            q, r = inner[0][2][1], inner[1][1]
            return (POWER, inner[0][1], ("number", q * r)) if r.denominator == 1 else (POWER, *inner)
        return (part.head, *inner)

    return fold_tree(tree, step)


def collect(head: str, inner: list[Form], unit: Fraction) -> Form:
    """A sum or product: nested ones opened, numbers joined, equal factors counted."""
    flat = [part for form in inner for part in (form[1:] if form[0] == head else (form,))]
    number, powers = unit, Counter[Form]()
    rest: list[Form] = []
    for form in flat:
        if form[0] == "number":
            number = number + form[1] if head == SUM else number * form[1]
        elif head == PRODUCT:
            base, q = (form[1], form[2][1]) if form[0] == POWER and form[2][0] == "number" else (form, 1)
            powers[base] += q
        else:
            rest.append(form)
    rest += [base if q == 1 else (POWER, base, ("number", Fraction(q))) for base, q in powers.items() if q != 0]
    parts = [("number", number), *rest] if number != unit or not rest else rest
    return (head, *parts) if len(parts) > 1 else parts[0]


def list_parts(form: Form) -> Iterator[Form]:
    """A form and its parts that are more than a symbol or number."""
    if form[0] in ("symbol", "number"):
        return
    yield form
    for part in form[1:]:
        yield from list_parts(part)


@lru_cache(maxsize=65536)
def shape_of(form: Form) -> Form:
    """The form with all symbols alike: equal for what a renaming makes equal."""
    if form[0] in ("symbol", "number"):
        return ("symbol",) if form[0] == "symbol" else form
    parts = [shape_of(part) for part in form[1:]]
    return (form[0], *(sorted(parts, key=repr) if form[0] in COMMUTATIVE else parts))


def is_renamed(x: Form, y: Form) -> bool:
    """Whether one renaming of symbols makes two forms equal."""
    if shape_of(x) != shape_of(y):
        return False
    steps = [MOST_STEPS]
    return next(match(((x, y),), {}, {}, steps), None) is not None


def is_share(x: Form, y: Form) -> bool:
    """Whether a sum or product is, up to names, some of the terms or factors of another one."""
    if x[0] != y[0] or x[0] not in (SUM, PRODUCT) or len(x) >= len(y) or comb(len(y) - 1, len(x) - 1) > MOST_SHARES:
        return False
    return any(is_renamed(x, (x[0], *chosen)) for chosen in combinations(y[1:], len(x) - 1))


def match(
    pairs: tuple[tuple[Form, Form], ...], there: dict[str, str], back: dict[str, str], steps: list[int]
) -> Iterator[bool]:
    """Renamings, and their inverses, that make all pairs equal."""
    steps[0] -= 1
    if steps[0] < 0:
        return
    if not pairs:
        yield True
        return
    ((x, y), *others), rest = pairs, pairs[1:]
    if x[0] == "symbol" and y[0] == "symbol":
        if there.get(x[1], y[1]) == y[1] and back.get(y[1], x[1]) == x[1]:
            yield from match(tuple(others), there | {x[1]: y[1]}, back | {y[1]: x[1]}, steps)
    elif x[0] == y[0] and x[0] == "number":
        if x == y:
            yield from match(rest, there, back, steps)
    elif x[0] == y[0] and len(x) == len(y):
        if x[0] not in COMMUTATIVE:
            yield from match((*zip(x[1:], y[1:], strict=True), *rest), there, back, steps)
            return
        first, own = x[1], shape_of(x[1])
        for k in range(1, len(y)):
            if shape_of(y[k]) == own:
                left, right = (x[0], *x[2:]), (y[0], *y[1:k], *y[k + 1 :])
                more = ((left, right),) if len(left) > 1 else ()
                yield from match(((first, y[k]), *more, *rest), there, back, steps)
