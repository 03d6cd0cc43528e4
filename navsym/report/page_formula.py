"""Formulas of records for reading: text to a small tree, and the tree to MathML or LaTeX.

Records hold both sides of a claim as text in the language of files. Here the text is only set
in type, as it stands: nothing is evaluated, cancelled or reordered. What is not a formula
(words, or text longer than a page) comes back as None, and its owner shows it as plain text.
"""

from __future__ import annotations

import functools
import html
import re
from collections.abc import Callable
from dataclasses import dataclass

from markupsafe import Markup

from navsym.report.page_names import latex_name, letter_of, mathml_name, split_name

LONGEST = 4_000
FOLDED = 700
DEEPEST = 40
TOKEN = re.compile(
    r"\s*(?:(?P<number>\d+(?:\.\d+)?(?:e[+-]?\d+)?)|(?P<name>[A-Za-z][A-Za-z0-9_]*'{0,3})|"
    r"(?P<sign>\*\*|\+-|<=|>=|!=|==|[-+*/()\[\],;=<>]))"
)
RELATIONS = frozenset(("=", "!=", "<", "<=", ">", ">=", "+-"))
ATOM, POWER, PRODUCT, SUM, RELATION, LIST = 6, 5, 4, 3, 2, 1


@dataclass(frozen=True, slots=True)
class Formula:
    """A side of a claim: its text, and its MathML and LaTeX where it is a formula."""

    text: str
    mathml: Markup | None
    latex: str | None

    @property
    def long(self) -> bool:
        """True for what is folded away until a reader asks for it."""
        return len(self.text) > FOLDED


class NotAFormulaError(ValueError):
    """Text that this small grammar does not read; the page shows it as it is."""


@dataclass(frozen=True, slots=True)
class Node:
    """kind: number, name, call, sum, difference, product, quotient, power, minus, relation, list, group."""

    kind: str
    text: str = ""
    parts: tuple[Node, ...] = ()


# -- reading ---------------------------------------------------------------------------------


def tokens_of(text: str) -> list[str]:
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
        return self.tokens[self.place] if self.place < len(self.tokens) else ""

    def take(self) -> str:
        self.place += 1
        return self.tokens[self.place - 1] if self.place <= len(self.tokens) else ""

    def whole(self) -> Node:
        node = self.separated((";", ","))
        if self.peek():
            raise NotAFormulaError(self.peek())
        return node

    def separated(self, signs: tuple[str, ...]) -> Node:
        parts, sign = [self.relation()], ""
        while self.peek() in signs:
            sign = self.take()
            if self.peek() in (")", "]"):  # (x,) has one member
                break
            parts.append(self.relation())
        return parts[0] if not sign else Node("list", sign, tuple(parts))

    def relation(self) -> Node:
        node = self.sum()
        while self.peek() in RELATIONS:
            sign = self.take()
            node = Node("relation", sign, (node, self.sum()))
        return node

    def sum(self) -> Node:
        node = self.product()
        while self.peek() in ("+", "-"):
            kind = "sum" if self.take() == "+" else "difference"
            node = Node(kind, "", (node, self.product()))
        return node

    def product(self) -> Node:
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


# -- writing ---------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Style:
    """How one notation writes the pieces."""

    number: Callable[[str], str]
    name: Callable[[str], str]
    function: Callable[[str], str]
    sign: Callable[[str], str]
    row: Callable[[list[str]], str]
    fraction: Callable[[str, str], str]
    power: Callable[[str, str], str]
    root: Callable[[str], str]
    fenced: Callable[[str, str, str], str]
    matrix: Callable[[list[list[str]]], str]


def scientific(text: str, plain: str, powered: str) -> str:
    """A numeral as it is printed; ``6.37e+07`` with a power of ten."""
    mantissa, mark, exponent = text.partition("e")
    return powered.format(mantissa, int(exponent)) if mark else plain.format(text)


def operator(text: str) -> str:
    return f"<mo>{html.escape(text)}</mo>"


def rowed(parts: list[str]) -> str:
    return parts[0] if len(parts) == 1 else "<mrow>" + "".join(parts) + "</mrow>"


def mathml_matrix(rows: list[list[str]]) -> str:
    body = "".join("<mtr>" + "".join(f"<mtd>{cell}</mtd>" for cell in row) + "</mtr>" for row in rows)
    return rowed([operator("["), f"<mtable>{body}</mtable>", operator("]")])


MATHML_SIGNS = {
    "-": "−", "*": "⁢", "<=": "≤", ">=": "≥", "!=": "≠", "+-": "±",
}  # fmt: skip
LATEX_SIGNS = {
    "*": r"\,", "<=": r" \le ", ">=": r" \ge ", "!=": r" \ne ", "+-": r" \pm ", "·": r" \cdot ", ";": r";\quad ",
}  # fmt: skip

POWER_OF_TEN = "<mrow><mn>{}</mn><mo>·</mo><msup><mn>10</mn><mn>{}</mn></msup></mrow>"
MATHML = Style(
    number=lambda text: scientific(text, "<mn>{}</mn>", POWER_OF_TEN),
    name=mathml_name,
    function=lambda text: mathml_name(text, function=True),
    sign=lambda text: operator(MATHML_SIGNS.get(text, text)),
    row=rowed,
    fraction=lambda top, bottom: f"<mfrac>{top}{bottom}</mfrac>",
    power=lambda base, exponent: f"<msup>{base}{exponent}</msup>",
    root=lambda inner: f"<msqrt>{inner}</msqrt>",
    fenced=lambda left, inner, right: rowed([operator(left), inner, operator(right)]),
    matrix=mathml_matrix,
)
LATEX = Style(
    number=lambda text: scientific(text, "{}", r"{} \cdot 10^{{{}}}"),
    name=latex_name,
    function=lambda text: latex_name(text, function=True),
    sign=lambda text: LATEX_SIGNS.get(text, f" {text} " if text != "," else ", "),
    row=lambda parts: "".join(parts),
    fraction=lambda top, bottom: rf"\frac{{{top}}}{{{bottom}}}",
    power=lambda base, exponent: f"{base}^{{{exponent}}}",
    root=lambda inner: rf"\sqrt{{{inner}}}",
    fenced=lambda left, inner, right: rf"\left{left} {inner} \right{right}",
    matrix=lambda rows: (
        r"\begin{bmatrix} " + r" \\ ".join(" & ".join(row) for row in rows) + r" \end{bmatrix}"
    ),
)
LEVELS = {
    "list": LIST, "relation": RELATION, "sum": SUM, "difference": SUM, "minus": SUM,
    "product": PRODUCT, "quotient": PRODUCT, "power": POWER,
}  # fmt: skip


def write(node: Node, style: Style, floor: int = 0) -> str:
    """The tree in one notation, in brackets when it binds looser than its neighbours need."""
    node = unwrapped(node)
    written = WRITERS[node.kind](node, style)
    return style.fenced("(", written, ")") if LEVELS.get(node.kind, ATOM) < floor else written


def unwrapped(node: Node) -> Node:
    """Brackets that only group are set again where the notation needs them."""
    while node.kind == "group" and not node.text and len(node.parts) == 1:
        node = node.parts[0]
    return node


def write_two(sign: str, left: int, right: int) -> Callable[[Node, Style], str]:
    def writer(node: Node, style: Style) -> str:
        first, second = node.parts
        return style.row([write(first, style, left), style.sign(sign), write(second, style, right)])

    return writer


def write_product(node: Node, style: Style) -> str:
    first, second = node.parts
    dotted = unwrapped(second).kind == "number" or any(is_word(part) for part in node.parts)
    sign = "·" if dotted else "*"
    return style.row([write(first, style, PRODUCT), style.sign(sign), write(second, style, PRODUCT)])


def is_word(node: Node) -> bool:
    """A name of several letters, or a product that ends in one: a dot keeps it from running into the next."""
    node = unwrapped(node)
    if node.kind == "product":
        node = unwrapped(node.parts[1])
    return node.kind == "name" and len(letter_of(split_name(node.text)[0])) > 1


def write_power(node: Node, style: Style) -> str:
    base, exponent = (unwrapped(part) for part in node.parts)
    raised = write(exponent, style)
    if base.kind == "call" and base.text not in ("sqrt", "abs", "exp"):
        head = style.power(style.function(base.text), raised)
        return style.row([head, arguments(base, style)])
    return style.power(write(base, style, ATOM), raised)


def write_call(node: Node, style: Style) -> str:
    if node.text == "sqrt" and len(node.parts) == 1:
        return style.root(write(node.parts[0], style))
    if node.text in ("abs", "Abs") and len(node.parts) == 1:
        return style.fenced("|", write(node.parts[0], style), "|")
    if node.text == "exp" and len(node.parts) == 1:
        return style.power(style.name("e"), write(node.parts[0], style))
    return style.row([style.function(node.text), arguments(node, style)])


def arguments(node: Node, style: Style) -> str:
    return style.fenced("(", joined(node.parts, ",", style), ")")


def joined(parts: tuple[Node, ...], sign: str, style: Style) -> str:
    written: list[str] = []
    for part in parts:
        written += [style.sign(sign)] * bool(written) + [write(part, style, RELATION)]
    return style.row(written) if written else style.row([style.sign(" ")])


def write_group(node: Node, style: Style) -> str:
    """A tuple, or a matrix when it is a list of rows of one length."""
    rows = [part.parts for part in node.parts if part.kind == "group" and part.text == "["]
    if node.text == "[" and rows and len(rows) == len(node.parts) and len({len(r) for r in rows}) == 1:
        return style.matrix([[write(cell, style) for cell in row] for row in rows])
    left, right = ("[", "]") if node.text == "[" else ("(", ")")
    return style.fenced(left, joined(node.parts, ",", style), right)


WRITERS: dict[str, Callable[[Node, Style], str]] = {
    "number": lambda node, style: style.number(node.text),
    "name": lambda node, style: style.name(node.text),
    "call": write_call,
    "sum": write_two("+", SUM, SUM),
    "difference": write_two("-", SUM, PRODUCT),
    "minus": lambda node, style: style.row([style.sign("-"), write(node.parts[0], style, PRODUCT)]),
    "product": write_product,
    "quotient": lambda node, style: style.fraction(write(node.parts[0], style), write(node.parts[1], style)),
    "power": write_power,
    "relation": lambda node, style: style.row(
        [write(node.parts[0], style, RELATION), style.sign(node.text), write(node.parts[1], style, SUM)]
    ),
    "list": lambda node, style: joined(node.parts, node.text, style),
    "group": write_group,
}


@functools.lru_cache(maxsize=4096)
def formula(text: str) -> Formula:
    """A side of a claim, set in type where it can be."""
    written = mathml(text) if text not in ("", "True", "False") else None
    return Formula(text, None, None) if written is None else Formula(text, Markup(written), latex(text))


def mathml(text: str) -> str | None:
    """MathML of a formula, one element for each part between semicolons; None for what is not a formula."""
    node = read_formula(text)
    if node is None:
        return None
    several = node.kind == "list" and node.text == ";"
    bodies = [write(part, MATHML) for part in (node.parts if several else (node,))]
    return "".join(
        f'<math xmlns="http://www.w3.org/1998/Math/MathML" display="block">{body}</math>' for body in bodies
    )


def latex(text: str) -> str | None:
    """LaTeX of a formula, for a display of its own; or None."""
    node = read_formula(text)
    return None if node is None else write(node, LATEX)
