"""Concrete syntax: the grammars of tree-sitter, loaded when first needed, and bounds on what they are given."""

from __future__ import annotations

import functools
import importlib
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from navsym.audit.form import Part, Unit
from navsym.core.errors import MissingEngineError, TooLargeError

DEPTH = 200
SIZE = 2_000_000
NODES = 400_000


@functools.cache
def load_parser(grammar: str) -> Any:
    """The parser of a grammar, such as ``c`` or ``rust``; raises MissingEngineError without its wheel."""
    try:
        from tree_sitter import Language, Parser

        module = importlib.import_module(f"tree_sitter_{grammar}")
    except ImportError:
        wheel = f"tree-sitter-{grammar}"
        message = f"expected the grammar {wheel}; got none on this machine; install tree-sitter and {wheel} with pip"
        raise MissingEngineError(message, where="audit") from None
    return Parser(Language(module.language()))


def parse_source(source: bytes, grammar: str, where: str) -> Any:
    """The root of the syntax tree of a source; raises TooLargeError for files and trees past the bounds."""
    if len(source) > SIZE:
        raise TooLargeError(f"expected a file of at most {SIZE} bytes; got {len(source)}; split it", where=where)
    root = load_parser(grammar).parse(source).root_node
    bound_tree(root, where)
    return root


def bound_tree(root: Any, where: str) -> None:
    """Refuse trees that are too deep or too large for what reads them."""
    cursor, depth, count = root.walk(), 0, 0
    while True:
        count += 1
        if depth > DEPTH or count > NODES:
            got = f"one deeper than {DEPTH}" if depth > DEPTH else f"more than {NODES} parts"
            line = cursor.node.start_point[0] + 1
            raise TooLargeError(
                f"expected nested source of bounded size; got {got}; split it", where=f"{where}: line {line}"
            )
        if cursor.goto_first_child():
            depth += 1
            continue
        while not cursor.goto_next_sibling():
            if not cursor.goto_parent():
                return
            depth -= 1


def text_of(node: Any) -> str:
    """The source of a node."""
    return str(node.text.decode("utf-8", "replace"))


def line_of(node: Any) -> int:
    """The line of a node, from 1."""
    return int(node.start_point[0]) + 1


def named(node: Any) -> list[Any]:
    """The children that are more than signs; comments left out."""
    return [
        child
        for child in node.named_children
        if child.type not in ("comment", "line_continuation", "line_comment", "block_comment")
    ]


def field_of(node: Any, name: str) -> Any:
    """The child in a field, or None."""
    return node.child_by_field_name(name)


def descend(node: Any) -> Iterator[Any]:
    """A node and all below it."""
    waiting = [node]
    while waiting:
        current = waiting.pop()
        yield current
        waiting.extend(current.children)


def identifiers_in(node: Any) -> tuple[str, ...]:
    """The names below a node: what a refused statement may write."""
    kinds = ("identifier", "field_identifier")
    return tuple(dict.fromkeys(text_of(inner) for inner in descend(node) if inner.type in kinds))


def read_decimal(text: str) -> Fraction | None:
    """The exact value of decimal digits, with a point and an exponent of at most three digits; None for others."""
    head, _, exponent = text.lower().partition("e")
    plain = head.replace(".", "", 1)
    if not (plain.isascii() and plain.isdigit()) or len(text) > 60:
        return None
    power = exponent.removeprefix("+").removeprefix("-")
    if ("e" in text.lower()) != bool(power) or (power and not (power.isascii() and power.isdigit() and len(power) < 4)):
        return None
    return Fraction(text)


#: Where the order of statements is left, in any of the grammars.
JUMPS = frozenset(
    "return_statement goto_statement break_statement continue_statement throw_statement raise_statement yield "
    "labeled_statement case_statement ERROR return_expression break_expression continue_expression try_expression "
    "macro_invocation await_expression".split()
)


#: What may write names inside an expression, in any of the grammars.
WRITES = frozenset(
    "assignment_expression update_expression assignment augmented_assignment named_expression call_expression call "
    "function_call lambda_expression lambda compound_statement new_expression delete_expression ERROR "
    "compound_assignment_expr macro_invocation closure_expression unsafe_block".split()
)


@dataclass(slots=True, eq=False)
class SourceReader:
    """Walks the syntax tree of one language; ``shift`` moves the spans of a text that was read alone."""

    unit: Unit
    shift: int = 0

    def part(self, kind: str, node: Any, *parts: Any) -> Part:
        """A part with its line and span."""
        start, end = node.start_byte + self.shift, node.end_byte + self.shift
        return Part(kind, line_of(node), parts, (start, end))

    def refuse(self, node: Any, why: str) -> Part:
        """An expression that is not read: its names, whether it may write them, and whether it may leave the way."""
        inside = {inner.type for inner in descend(node)}
        is_shouting = "call_expression" in inside and any(name.isupper() for name in identifiers_in(node))
        return self.part(
            "refused", node, why, identifiers_in(node), bool(inside & WRITES), bool(inside & JUMPS) or is_shouting
        )

    def unread(self, node: Any, why: str) -> Part:
        """A statement that is not read: all names in it may have been written, or the way may be left there."""
        kind = "jump" if any(inner.type in JUMPS for inner in descend(node)) else "unread"
        return self.part(kind, node, why, identifiers_in(node))
