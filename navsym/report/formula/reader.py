"""From the text of a record to a small tree: a grammar of formulas as they stand.

Nothing is evaluated, cancelled or reordered. What is not a formula (words, or text longer than a page) has no tree.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

LONGEST = 4_000
DEEPEST = 40
TOKEN = re.compile(
    r"\s*(?:(?P<number>\d+(?:\.\d+)?(?:e[+-]?\d+)?)|(?P<name>[A-Za-z][A-Za-z0-9_]*'{0,3})|"
    r"(?P<sign>\*\*|\+-|<=|>=|!=|==|[-+*/()\[\],;=<>]))"
)
RELATIONS = frozenset(("=", "!=", "<", "<=", ">", ">=", "+-"))


class NotAFormulaError(ValueError):
    """Text that this small grammar does not read; the page shows it as it is."""


@dataclass(frozen=True, slots=True)
class Node:
    """kind: number, name, call, sum, difference, product, quotient, power, minus, relation, list, group."""

    kind: str
    text: str = ""
    parts: tuple[Node, ...] = ()


def tokens_of(text: str) -> list[str]:
    """The tokens of a text; raises NotAFormulaError for one that is too long or has another sign."""
    if len(text) > LONGEST:
        raise NotAFormulaError("too long")
    found, place = [], 0
    text = text.rstrip()
    while place < len(text):
        match = TOKEN.match(text, place)
        if match is None:
            raise NotAFormulaError(f"column {place}")
        found.append(match.group().strip())
        place = match.end()
    return found


class Reader:
    """Recursive descent, loosest first: parts between ; or , then relations, sums, products, powers."""

    def __init__(self, tokens: list[str]):
        self.tokens, self.place, self.depth = tokens, 0, 0

    def peek(self) -> str:
        """The token that is read next, empty at the end."""
        return self.tokens[self.place] if self.place < len(self.tokens) else ""

    def take(self) -> str:
        """The next token, which is read; empty at the end."""
        self.place += 1
        return self.tokens[self.place - 1] if self.place <= len(self.tokens) else ""

    def whole(self) -> Node:
        """The tree of the whole text; raises NotAFormulaError when something is left."""
        node = self.separated((";", ","))
        if self.peek():
            raise NotAFormulaError(self.peek())
        return node

    def separated(self, signs: tuple[str, ...]) -> Node:
        """Relations between these signs, as a list; a single one as it is."""
        parts, sign = [self.relation()], ""
        while self.peek() in signs:
            sign = self.take()
            if self.peek() in (")", "]"):  # (x,) has one member
                break
            parts.append(self.relation())
        return parts[0] if not sign else Node("list", sign, tuple(parts))

    def relation(self) -> Node:
        """Sums joined by relations, from the left."""
        node = self.sum()
        while self.peek() in RELATIONS:
            sign = self.take()
            node = Node("relation", sign, (node, self.sum()))
        return node

    def sum(self) -> Node:
        """Products joined by + and -, from the left."""
        node = self.product()
        while self.peek() in ("+", "-"):
            kind = "sum" if self.take() == "+" else "difference"
            node = Node(kind, "", (node, self.product()))
        return node

    def product(self) -> Node:
        """Factors joined by * and /, from the left; a minus before the first is one of the whole."""
        node = self.unary()
        negative = node.kind == "minus" and self.peek() in ("*", "/")
        node = node.parts[0] if negative else node
        while self.peek() in ("*", "/"):
            kind = "product" if self.take() == "*" else "quotient"
            node = Node(kind, "", (node, self.unary()))
        return Node("minus", "", (node,)) if negative else node  # (-a)*t is written -a t

    def unary(self) -> Node:
        """A sign before a power; ``-2**2`` is minus four."""
        if self.peek() in ("+", "-"):
            sign = self.take()
            inner = self.unary()
            return Node("minus", "", (inner,)) if sign == "-" else inner
        base = self.atom()
        if self.peek() != "**":
            return base
        self.take()
        return Node("power", "", (base, self.unary()))

    def atom(self) -> Node:
        """A number, name, call or bracket; raises NotAFormulaError for anything else."""
        token = self.take()
        if token[:1].isdigit():
            return Node("number", token)
        if token in ("(", "["):
            return self.bracket(token)
        if not token[:1].isalpha():
            raise NotAFormulaError(token)
        if self.peek() != "(":
            return Node("name", token)
        self.take()
        inner = self.bracket("(")
        return Node("call", token, inner.parts)

    def bracket(self, opening: str) -> Node:
        """What stands in a bracket whose opening is read; raises NotAFormulaError when it is not closed or too deep."""
        closing = ")" if opening == "(" else "]"
        self.depth += 1
        if self.depth > DEEPEST:
            raise NotAFormulaError("too deep")
        if self.peek() == closing:
            self.take()
            self.depth -= 1
            return Node("group", opening)
        inner = self.separated((",",))
        if self.take() != closing:
            raise NotAFormulaError(closing)
        self.depth -= 1
        one = inner.kind != "list"
        return Node("group", opening if not one or opening == "[" else "", (inner,) if one else inner.parts)


def read_formula(text: str) -> Node | None:
    """The tree of a formula; None when the text is not one."""
    try:
        return Reader(tokens_of(text)).whole()
    except (NotAFormulaError, RecursionError):
        return None


def unwrapped(node: Node) -> Node:
    """Brackets that only group are set again where the notation needs them."""
    while node.kind == "group" and not node.text and len(node.parts) == 1:
        node = node.parts[0]
    return node
