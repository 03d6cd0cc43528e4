"""MATLAB and Octave: functions of numbers and matrices; all else is refused with its line."""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass
from typing import Any

from navsym.audit.form import Argument, Part
from navsym.audit.syntax import SourceReader, descend, field_of, find_body, list_above, named, sign_of, text_of

POWERS = ("^", ".^")
#: Commands that write no name.
QUIET = ("format", "hold", "close", "clc", "more", "warning", "figure", "disp", "drawnow")
#: Functions that may write any name.
RUNNING = ("eval", "evalin", "evalc", "assignin", "load", "clear", "run")
SIGNS = {**{sign: sign for sign in (".*", "./", ".^")}, "^": "**"}
OTHERS: dict[str, tuple[str, ...]] = {"~=": ("compare", "!="), "&": ("both",), "|": ("either",)}


@dataclass(slots=True, eq=False)
class Reader(SourceReader):
    """Walks the syntax tree of MATLAB."""

    VALUE = ("assignment", "right")
    UNARY = SourceReader.UNARY | {"~": "not"}
    OPERATORS = SourceReader.OPERATORS | {sign: ("op", meaning) for sign, meaning in SIGNS.items()} | OTHERS

    def read_file(self, root: Any) -> None:
        """The functions of a source in MATLAB."""
        for node in descend(root):
            if node.type == "function_definition":
                self.read_function(node)

    def read_function(self, node: Any) -> None:
        name = text_of(field_of(node, "name"))
        children = {child.type: child for child in named(node)}
        output, given, body = (children.get(kind) for kind in ("function_output", "function_arguments", "block"))
        arguments = tuple(Argument(text_of(n)) for n in named(given))
        outputs = () if output is None else tuple(re.findall(r"\w+", text_of(output)))
        statements = self.block(body)
        inner = any(child.type == "function_definition" for child in descend(node) if child.id != node.id)
        if inner or "function_definition" in list_above(node):
            statements = (self.part("jump", node, "a function in another one, which share their names", ()),)
        self.define(node, name, arguments, statements, outputs)

    def read_statement(self, node: Any) -> tuple[Part, ...] | None:
        match node.type:
            case "assignment":
                return (self.assignment(node),)
            case "if_statement":
                return (self.chain(node, [c for c in named(node) if c.type in ("elseif_clause", "else_clause")]),)
            case "switch_statement":
                return self.switch(node)
            case "for_statement":
                return (self.loop(node),)
            case "return_statement":
                return (self.unread(node, "a return before the end"),)
            case "command" if text_of(node).split()[0] in QUIET:
                return ()
            case "command" | "global_operator" | "persistent_operator":
                return (self.part("jump", node, f"the command {text_of(node).split()[0]}", ()),)
            case "function_call" if text_of(field_of(node, "name")) == "error":
                return (self.part("fail", node, "an error is raised"),)
            case "function_call" if text_of(field_of(node, "name")) in RUNNING:
                return (self.part("jump", node, "a text that is run, or names from a file", ()),)
            case "function_call":
                return (self.part("do", node, self.expression(node)),)
        return None

    def assignment(self, node: Any) -> Part:
        left, right = field_of(node, "left"), field_of(node, "right")
        if left.type == "multioutput_variable":
            return self.part("several", node, self.several(named(left)), self.expression(right))
        if left.type not in ("identifier", "function_call", "field_expression"):
            return self.unread(node, "several names assigned at once")
        if left.type == "function_call" and right.type == "matrix" and not named(right):
            return self.unread(node, "entries that are removed")
        return self.assign(node, left, right)

    def switch(self, node: Any) -> tuple[Part, ...]:
        """``switch`` over numbers as ``if``."""
        test, other = self.expression(field_of(node, "condition")), tuple[Part, ...]()
        for clause in reversed([c for c in named(node) if c.type.endswith("_clause")]):
            label, body = field_of(clause, "condition"), self.block(find_body(clause))
            if label is None:
                other = body
                continue
            rows = named(label) if label.type == "cell" else [label]
            labels = [cell for row in rows for cell in (named(row) if row.type == "row" else [row])]
            tests = [self.part("compare", clause, "==", test, self.expression(cell)) for cell in labels]
            whole = functools.reduce(lambda a, b: self.part("either", clause, a, b), tests)
            other = (self.part("if", clause, whole, body, other),)
        return other

    def loop(self, node: Any) -> Part:
        """``for i = a:b`` and ``for i = a:step:b``."""
        name, source = named(next(c for c in named(node) if c.type == "iterator"))
        ends = self.several(named(source)) if source.type == "range" else ()
        return self.count(node, name, source, (*ends[:1], *ends[-1:], *ends[1:-1]), True)

    def read_expression(self, node: Any) -> Part | None:
        match node.type:
            case "number":
                number = self.literal(node, text_of(node), True)
                is_whole = number.kind == "number" and number.parts[0].denominator == 1
                return self.literal(node, text_of(node), False) if is_whole else number
            case "binary_operator":
                sign = whole_sign(node)
                return self.power(node) if sign in POWERS else self.operate(node, sign, *named(node))
            case "postfix_operator":
                return self.part("method", node, self.expression(field_of(node, "operand")), "T", ())
            case "function_call":
                return self.call(node)
        return None

    def power(self, node: Any) -> Part:
        """Powers from left to right, before a sign in front: the grammar groups ``-x^2`` and ``a^b^c`` otherwise."""
        signs: list[str] = []
        operands = list_powers(node, signs)
        first, negative = operands[0], False
        while first.type == "unary_operator":
            negative ^= text_of(first).startswith("-")
            first = field_of(first, "operand")
        if any(x.type in ("unary_operator", "not_operator") for x in operands[1:-1]) or first.type == "not_operator":
            return self.refuse(node, "a sign inside a tower of powers, which MATLAB and Octave read differently")
        value = self.expression(first)
        for sign, operand in zip(signs, operands[1:], strict=True):
            value = self.part("op", node, SIGNS[sign], value, self.expression(operand))
        return self.part("minus", node, value) if negative else value

    def call(self, node: Any) -> Part:
        """A function, or entries ``M(i, j)``, which look alike."""
        name = field_of(node, "name")
        given = next((c for c in named(node) if c.type == "arguments"), None)
        arguments = tuple(map(self.index, named(given)))
        if name.type not in ("identifier", "field_expression"):
            return self.refuse(node, "a call of an expression")
        return self.part("call", node, "".join(text_of(name).split()), arguments)

    def index(self, node: Any) -> Part:
        """An index: a number, a range or all."""
        if node.type == "spread_operator":
            return self.part("slice", node, None, None)
        if node.type == "range":
            ends = self.several(named(node))
            return self.part("slice", node, *ends) if len(ends) == 2 else self.refuse(node, "a range with a step")
        return self.expression(node)


def whole_sign(node: Any) -> str:
    """The operator of two operands: the point of ``2./M`` belongs to it, and not to the number as in the grammar."""
    left = named(node)[0]
    is_dotted = text_of(left).endswith(".") and left.next_sibling.start_byte == left.end_byte
    return "." * is_dotted + sign_of(node)


def list_powers(node: Any, signs: list[str]) -> list[Any]:
    """The operands of a tower of powers as they stand in the text, and the operators between them into ``signs``."""
    if node.type != "binary_operator" or whole_sign(node) not in POWERS:
        return [node]
    left = list_powers(field_of(node, "left"), signs)
    signs.append(whole_sign(node))
    return [*left, *list_powers(field_of(node, "right"), signs)]
