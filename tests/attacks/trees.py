"""Formulas as plain tuples: a reader, a writer and derivatives that share nothing with the package.

A tree is ``("number", Fraction)``, ``("pi",)``, ``("name", text)``, or an operation with its operands:
``+ - * / **``, ``neg``, or a function of the language of files.
"""

from __future__ import annotations

import re
from fractions import Fraction
from functools import lru_cache
from typing import Any

Tree = tuple[Any, ...]

FUNCTIONS = frozenset("sin cos tan cot sec csc exp log sqrt abs asin acos atan atan2 sinh cosh tanh".split())
RELATIONS = ("!=", "<=", ">=", "=", "<", ">")
TOKEN = re.compile(r"\s*(?:((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|([A-Za-z]\w*)|(\*\*|[-+*/(),]))")
PI: Tree = ("pi",)
#: How tightly an operation binds, for the writer.
STRENGTH = {"+": 1, "-": 1, "*": 2, "/": 2, "neg": 3, "**": 4}


class UnreadableError(ValueError):
    """A text that is no formula."""


class Reader:
    """Recursive descent over the tokens of one text."""

    def __init__(self, text: str):
        self.tokens: list[tuple[str, str]] = []
        place, text = 0, text.rstrip()
        while place < len(text):
            match = TOKEN.match(text, place)
            if match is None:
                raise UnreadableError(f"{text[place:]!r}")
            kind = ("number", "name", "mark")[match.lastindex - 1]
            self.tokens.append((kind, match[match.lastindex]))
            place = match.end()
        self.tokens.append(("end", ""))
        self.place = 0

    def take(self, *marks: str) -> str:
        """The next mark when it is one of these, else an empty text."""
        kind, text = self.tokens[self.place]
        if kind != "mark" or text not in marks:
            return ""
        self.place += 1
        return text

    def sum(self) -> Tree:
        tree = self.product()
        while mark := self.take("+", "-"):
            tree = (mark, tree, self.product())
        return tree

    def product(self) -> Tree:
        tree = self.unary()
        while mark := self.take("*", "/"):
            tree = (mark, tree, self.unary())
        return tree

    def unary(self) -> Tree:
        if mark := self.take("+", "-"):
            tree = self.unary()
            return tree if mark == "+" else ("neg", tree)
        base = self.atom()
        return ("**", base, self.unary()) if self.take("**") else base

    def atom(self) -> Tree:
        kind, text = self.tokens[self.place]
        self.place += 1
        if kind == "number":
            return ("number", Fraction(text))
        if kind == "name" and text in FUNCTIONS:
            self.expect("(")
            operands = [self.sum()]
            while self.take(","):
                operands.append(self.sum())
            self.expect(")")
            return (text, *operands)
        if kind == "name":
            return PI if text == "pi" else ("name", text)
        if text == "(":
            tree = self.sum()
            self.expect(")")
            return tree
        raise UnreadableError(text)

    def expect(self, mark: str) -> None:
        if not self.take(mark):
            raise UnreadableError(f"{self.tokens[self.place][1]!r}, expected {mark}")


@lru_cache(maxsize=4096)
def read(text: str) -> Tree:
    """The tree of a text; raises UnreadableError."""
    reader = Reader(text)
    tree = reader.sum()
    if reader.tokens[reader.place][0] != "end":
        raise UnreadableError(f"{text!r}")
    return tree


def read_relation(text: str) -> tuple[Tree, str, Tree]:
    """Left side, relation and right side of a text; raises UnreadableError."""
    for relation in RELATIONS:
        left, found, right = text.partition(relation)
        if found:
            return read(left), relation, read(right)
    raise UnreadableError(f"{text!r} has no relation")


def write(tree: Tree, least: int = 0) -> str:
    """A text that :func:`read` reads as this tree; brackets where something binds tighter than ``least``."""
    head, *parts = tree
    if head == "number":
        value = parts[0]
        if value.denominator != 1:
            return bracket(f"{value.numerator}/{value.denominator}", 2 if value > 0 else 1, least)
        return bracket(str(value), 9 if value >= 0 else 1, least)
    if head in ("pi", "name"):
        return parts[0] if parts else "pi"
    if head in FUNCTIONS:
        return f"{head}({', '.join(write(part) for part in parts)})"
    strength = STRENGTH[head]
    if head == "neg":
        return bracket(f"-{write(parts[0], 3)}", 1, least)
    if head == "**":
        return bracket(f"{write(parts[0], 5)}**{write(parts[1], 5)}", strength, least)
    spaces = " " if strength == 1 else ""
    return bracket(f"{write(parts[0], strength)}{spaces}{head}{spaces}{write(parts[1], strength + 1)}", strength, least)


def bracket(text: str, strength: int, least: int) -> str:
    """The text, in brackets when it binds less than it must."""
    return f"({text})" if strength < least else text


def names_in(tree: Tree) -> set[str]:
    """Names of the symbols of a tree."""
    if tree[0] == "name":
        return {tree[1]}
    return set().union(*(names_in(part) for part in tree[1:] if isinstance(part, tuple)))


def replace(tree: Tree, values: dict[str, Tree]) -> Tree:
    """The tree with trees in place of names; nothing is simplified."""
    if tree[0] == "name":
        return values.get(tree[1], tree)
    return (tree[0], *(replace(part, values) if isinstance(part, tuple) else part for part in tree[1:]))


# Derivatives: df/dx of the functions of one argument, in the name x.
SLOPES = {
    "sin": "cos(x)", "cos": "-sin(x)", "tan": "1/cos(x)**2", "cot": "-1/sin(x)**2", "sec": "sin(x)/cos(x)**2",
    "csc": "-cos(x)/sin(x)**2", "exp": "exp(x)", "log": "1/x", "sqrt": "1/(2*sqrt(x))", "abs": "x/abs(x)",
    "asin": "1/sqrt(1 - x**2)", "acos": "-1/sqrt(1 - x**2)", "atan": "1/(1 + x**2)", "sinh": "cosh(x)",
    "cosh": "sinh(x)", "tanh": "1 - tanh(x)**2",
}  # fmt: skip
ZERO, ONE = ("number", Fraction(0)), ("number", Fraction(1))


def derivative(tree: Tree, name: str) -> Tree:
    """d(tree)/d(name); only sums and products with 0 and 1 are written shorter."""
    head, *parts = tree
    if name not in names_in(tree):
        return ZERO
    if head == "name":
        return ONE
    if head == "atan2":
        y, x = parts
        top = subtract(multiply(derivative(y, name), x), multiply(y, derivative(x, name)))
        return divide(top, ("+", ("**", x, number(2)), ("**", y, number(2))))
    slopes = [derivative(part, name) for part in parts]
    if head == "neg":
        return ("neg", slopes[0])
    if head in "+-":
        return add(*slopes) if head == "+" else subtract(*slopes)
    if head == "*":
        return add(multiply(slopes[0], parts[1]), multiply(parts[0], slopes[1]))
    if head == "/" and slopes[1] == ZERO:
        return divide(slopes[0], parts[1])
    if head == "/":
        top = subtract(multiply(slopes[0], parts[1]), multiply(parts[0], slopes[1]))
        return divide(top, ("**", parts[1], number(2)))
    if head == "**":
        return derivative_of_power(*parts, *slopes)
    return multiply(replace(read(SLOPES[head]), {"x": parts[0]}), slopes[0])


def derivative_of_power(base: Tree, exponent: Tree, slope: Tree, exponent_slope: Tree) -> Tree:
    """d(b**e) = e b**(e - 1) db, and b**e log(b) de where the exponent moves."""
    lower = ("number", exponent[1] - 1) if exponent[0] == "number" else ("-", exponent, ONE)
    first = multiply(multiply(exponent, ("**", base, lower)), slope)
    second = multiply(multiply(("**", base, exponent), ("log", base)), exponent_slope)
    return add(first, second)


def number(value: int | Fraction) -> Tree:
    return ("number", Fraction(value))


def add(a: Tree, b: Tree) -> Tree:
    return b if a == ZERO else a if b == ZERO else ("+", a, b)


def subtract(a: Tree, b: Tree) -> Tree:
    return ("neg", b) if a == ZERO else a if b == ZERO else ("-", a, b)


def multiply(a: Tree, b: Tree) -> Tree:
    if ZERO in (a, b):
        return ZERO
    return b if a == ONE else a if b == ONE else ("*", a, b)


def divide(a: Tree, b: Tree) -> Tree:
    return ZERO if a == ZERO else a if b == ONE else ("/", a, b)
