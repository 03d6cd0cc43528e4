"""From the tree of a formula to one notation, with brackets where the notation needs them."""

from __future__ import annotations

from collections.abc import Callable

from navsym.report.formula.notation import Style
from navsym.report.formula.reader import Node, unwrapped
from navsym.report.page_names import letter_of, split_name

ATOM, POWER, PRODUCT, SUM, RELATION, LIST = 6, 5, 4, 3, 2, 1
LEVELS = {
    "list": LIST, "relation": RELATION, "sum": SUM, "difference": SUM, "minus": SUM,
    "product": PRODUCT, "quotient": PRODUCT, "power": POWER,
}  # fmt: skip


def write(node: Node, style: Style, floor: int = 0) -> str:
    """The tree in one notation, in brackets when it binds looser than its neighbours need."""
    node = unwrapped(node)
    written = WRITERS[node.kind](node, style)
    return style.fenced("(", written, ")") if LEVELS.get(node.kind, ATOM) < floor else written


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
