"""From the tree of a formula to one notation, with brackets where the notation needs them."""

from __future__ import annotations

from collections.abc import Callable

from navsym.report.formula.notation import BESIDE_A_FUNCTION, Style
from navsym.report.formula.reader import Node
from navsym.report.names import letter_of, split_name

ATOM, POWER, FACTOR, PRODUCT, SUM, RELATION, LIST = 7, 6, 5, 4, 3, 2, 1
UNNAMED = frozenset(("sqrt", "abs", "Abs", "exp"))  # functions with a sign of their own
LEVELS = {
    "list": LIST,
    "relation": RELATION,
    "sum": SUM,
    "difference": SUM,
    "minus": SUM,
    "product": PRODUCT,
    "quotient": FACTOR,
    "power": POWER,
}


def write(node: Node, style: Style, floor: int = 0) -> str:
    """The tree in one notation, in brackets when it binds looser than its neighbours need."""
    if style.place != "line" and floor < FACTOR and is_simple(node):
        return write_two("/", PRODUCT, ATOM)(node, style)
    written = WRITERS[node.kind](node, style)
    return style.fenced("(", written, ")") if LEVELS.get(node.kind, ATOM) < floor else written


def write_two(sign: str, left: int, right: int) -> Callable[[Node, Style], str]:
    """A writer of two parts around a sign; left and right are how tightly each must bind."""

    def writer(node: Node, style: Style) -> str:
        first, second = node.parts
        return style.row([write(first, style, left), style.sign(sign), write(second, style, right)])

    return writer


def write_product(node: Node, style: Style) -> str:
    """A product: a dot before a number or beside a name of several letters, else the style's sign, as a rule unseen."""
    first, second = node.parts
    dotted = second.kind == "number" or any(is_word(part) for part in node.parts)
    sign = "·" if dotted else BESIDE_A_FUNCTION if any(is_function(part) for part in node.parts) else "*"
    return style.row([factor(first, style), style.sign(sign), factor(second, style)])


def factor(node: Node, style: Style) -> str:
    """A part of a product: a quotient is set as a fraction, because T/2 x in one line can be read in two ways."""
    return write(node, style, FACTOR if node.kind == "quotient" else PRODUCT)


def is_simple(node: Node) -> bool:
    """A quotient of numbers and names that one line holds: T/4, 2 T/3."""
    if node.kind != "quotient":
        return False
    top, bottom = node.parts
    factors = top.parts if top.kind == "product" else (top,)
    return all(part.kind in ("number", "name") for part in (*factors, bottom))


def is_word(node: Node) -> bool:
    """A name of several letters, or a product that ends in one: a dot keeps it from running into the next."""
    node = last_factor(node)
    return node.kind == "name" and len(letter_of(split_name(node.text)[0])) > 1


def is_function(node: Node) -> bool:
    """A function that is written by its name, itself or raised to a power, or a product that ends in one."""
    node = last_factor(node)
    if node.kind == "power":
        node = node.parts[0]
    return node.kind == "call" and node.text not in UNNAMED


def last_factor(node: Node) -> Node:
    """The second part of a product, or the node itself."""
    return node.parts[1] if node.kind == "product" else node


def write_power(node: Node, style: Style) -> str:
    """A power; of a function it stands at its name: sin^2(x)."""
    base, exponent = node.parts
    raised = write(exponent, style.above())
    if base.kind == "call" and base.text not in UNNAMED:
        head = style.power(style.function(base.text), raised)
        return style.row([head, arguments(base, style)])
    return style.power(write(base, style, ATOM), raised)


def write_call(node: Node, style: Style) -> str:
    """A call; root, modulus and exponential have signs of their own."""
    if node.text == "sqrt" and len(node.parts) == 1:
        return style.root(write(node.parts[0], style))
    if node.text in ("abs", "Abs") and len(node.parts) == 1:
        return style.fenced("|", write(node.parts[0], style), "|")
    if node.text == "exp" and len(node.parts) == 1:
        return style.power(style.name("e"), write(node.parts[0], style.above()))
    return style.row([style.function(node.text), arguments(node, style)])


def arguments(node: Node, style: Style) -> str:
    """The arguments of a call in brackets."""
    return style.fenced("(", joined(node.parts, ",", style.inside()), ")")


def joined(parts: tuple[Node, ...], sign: str, style: Style) -> str:
    """Parts with a sign between them."""
    written: list[str] = []
    for part in parts:
        written += [style.sign(sign)] * bool(written) + [write(part, style, RELATION)]
    return style.row(written) if written else style.row([style.sign(" ")])


def write_group(node: Node, style: Style) -> str:
    """A tuple, or a matrix when it is a list of rows of one length."""
    rows = [part.parts for part in node.parts if part.kind == "group" and part.text == "["]
    if node.text == "[" and rows and len(rows) == len(node.parts) and len({len(r) for r in rows}) == 1:
        return style.matrix([[write(cell, style.inside()) for cell in row] for row in rows])
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
    "quotient": lambda node, style: style.fraction(*(write(part, style.inside()) for part in node.parts)),
    "power": write_power,
    "relation": lambda node, style: style.row(
        [write(node.parts[0], style, RELATION), style.sign(node.text), write(node.parts[1], style, SUM)]
    ),
    "list": lambda node, style: joined(node.parts, node.text, style),
    "group": write_group,
}
