"""From the text of a record to a small tree: a formula as it stands, by the grammar of Python.

Nothing is evaluated, cancelled or reordered. What is not a formula (words, or text longer than a page) has no tree.
"""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass

LONGEST = 4_000
DEEPEST = 40
TOKEN = re.compile(
    r"\s*(?:(?P<number>\d+(?:\.\d+)?(?:e[+-]?\d+)?)|(?P<name>[A-Za-z][A-Za-z0-9_]*'{0,3})|"
    r"(?P<sign>\*\*|\+-|<=|>=|!=|==|[-+*/()\[\],;=<>]))"
)
#: Signs that Python spells otherwise; each relation is one of its comparisons, so that chains are read alike.
SPELLED = {"=": "==", "+-": "in", ";": ","}
RELATIONS: dict[type[ast.cmpop], str] = {
    ast.Eq: "=", ast.NotEq: "!=", ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.In: "+-",
}  # fmt: skip
OPERATIONS: dict[type[ast.operator], str] = {
    ast.Add: "sum", ast.Sub: "difference", ast.Mult: "product", ast.Div: "quotient", ast.Pow: "power",
}  # fmt: skip


class NotAFormulaError(ValueError):
    """Text that this small grammar does not read; the page shows it as it is."""


@dataclass(frozen=True, slots=True)
class Node:
    """kind: number, name, call, sum, difference, product, quotient, power, minus, relation, list, group."""

    kind: str
    text: str = ""
    parts: tuple[Node, ...] = ()


def read_formula(text: str) -> Node | None:
    """The tree of a formula; None when the text is not one."""
    try:
        return read_tokens(tokens_of(text))
    except (NotAFormulaError, SyntaxError, RecursionError, MemoryError):
        return None


def tokens_of(text: str) -> list[re.Match[str]]:
    """The tokens of a text; raises NotAFormulaError for one that is too long or has another sign."""
    if len(text) > LONGEST:
        raise NotAFormulaError("too long")
    found, place = [], 0
    text = text.rstrip()
    while place < len(text):
        match = TOKEN.match(text, place)
        if match is None or match["sign"] == "==":
            raise NotAFormulaError(f"column {place}")
        found.append(match)
        place = match.end()
    return found


def read_tokens(tokens: list[re.Match[str]]) -> Node:
    """The tree of tokens: numbers and names by their places, so that none is a word of Python.

    Raises NotAFormulaError, or what Python raises, for what is no formula.
    """
    depth, between, words = 0, "", list[str]()
    for place, token in enumerate(tokens):
        sign = token["sign"] or ""
        depth += (sign in ("(", "[")) - (sign in (")", "]"))
        if depth > DEEPEST or (sign == ";" and depth):
            raise NotAFormulaError(sign)
        between = sign if sign in (",", ";") and not depth else between
        words.append(SPELLED.get(sign, sign) or f"_{place}")
    if not tokens or tokens[-1]["sign"] in (",", ";"):
        raise NotAFormulaError("the end")
    whole = ast.parse(" ".join(words), mode="eval").body
    reader = Reader(tokens)
    if between and isinstance(whole, ast.Tuple):
        return Node("list", between, reader.all_of(whole.elts))
    return reader.node(whole)


class Reader:
    """From Python's tree to ours."""

    def __init__(self, tokens: list[re.Match[str]]):
        self.tokens = tokens
        self.read: set[ast.expr] = set()  # minus signs that stand before a product already

    def all_of(self, parts: list[ast.expr]) -> tuple[Node, ...]:
        """The trees of several parts."""
        return tuple(map(self.node, parts))

    def node(self, e: ast.expr) -> Node:
        """The tree of one part; raises NotAFormulaError for what formulas do not have."""
        if isinstance(e, ast.Name):
            token = self.tokens[int(e.id[1:])]
            return Node(token.lastgroup or "", token.group().strip())
        if isinstance(e, ast.BinOp) and type(e.op) in OPERATIONS:
            minus = self.leading_minus(e)
            if minus is not None:
                self.read.add(minus)
                return Node("minus", "", (self.node(e),))  # (-a)*t is written -a t
            return Node(OPERATIONS[type(e.op)], "", (self.node(e.left), self.node(e.right)))
        if isinstance(e, ast.UnaryOp):
            inner = self.node(e.operand)
            return inner if isinstance(e.op, ast.UAdd) or e in self.read else Node("minus", "", (inner,))
        if isinstance(e, ast.Compare):
            found = self.node(e.left)
            for sign, right in zip(e.ops, e.comparators, strict=True):
                found = Node("relation", RELATIONS[type(sign)], (found, self.node(right)))
            return found
        if isinstance(e, ast.Tuple | ast.List):
            return Node("group", "(" if isinstance(e, ast.Tuple) else "[", self.all_of(e.elts))
        if isinstance(e, ast.Call) and isinstance(e.func, ast.Name) and not e.keywords:
            function = self.node(e.func)
            if function.kind == "name":
                return Node("call", function.text, self.all_of(e.args))
        raise NotAFormulaError(type(e).__name__)

    def leading_minus(self, e: ast.BinOp) -> ast.UnaryOp | None:
        """The minus sign with which a product begins, outside of brackets; None where there is none, or it is read."""
        first: ast.expr = e
        while isinstance(first, ast.BinOp) and isinstance(first.op, ast.Mult | ast.Div) and starts_with(e, first):
            first = first.left
        is_minus = isinstance(first, ast.UnaryOp) and isinstance(first.op, ast.USub) and starts_with(e, first)
        return first if is_minus and first is not e and first not in self.read else None  # type: ignore[return-value]


def starts_with(whole: ast.expr, part: ast.expr) -> bool:
    """True when no bracket stands before a part that is the first one."""
    return part.col_offset == whole.col_offset
