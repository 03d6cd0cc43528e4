"""MATLAB and Octave: functions of numbers and matrices; all else is refused with its line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from navsym.audit.form import Argument, Function, Part, Rules, Unit
from navsym.audit.syntax import SourceReader, descend, field_of, line_of, named, parse_source, read_decimal, text_of

RULES = Rules(first=1, matrix=True, entry=("{}({})", "{}({},{})"))
POWERS = ("^", ".^")
SIGNS = {"+": "+", "-": "-", "*": "*", "/": "/", "^": "**", ".*": ".*", "./": "./", ".^": ".^"}
COMPARISONS = {"<": "<", "<=": "<=", ">": ">", ">=": ">=", "==": "==", "~=": "!=", "!=": "!="}


def read_matlab(source: bytes, file: str) -> Unit:
    """The functions of a source in MATLAB."""
    unit = Unit(file, "matlab", RULES, source)
    reader = Reader(unit)
    for node in descend(parse_source(source, "matlab", file)):
        if node.type == "function_definition":
            reader.read_function(node)
    return unit


def read_matlab_expression(text: str, unit: Unit) -> Part:
    """One expression; its spans count from its own beginning."""
    head = "a_ = "
    root = parse_source(f"{head}{text};".encode(), "matlab", unit.file)
    nodes = named(root)
    if root.has_error or len(nodes) != 1 or nodes[0].type != "assignment":
        return Part("refused", 1, ("no expression",))
    return Reader(unit, -len(head)).expression(field_of(nodes[0], "right"))


@dataclass(slots=True, eq=False)
class Reader(SourceReader):
    """Walks the syntax tree of MATLAB."""

    def read_function(self, node: Any) -> None:
        name = text_of(field_of(node, "name"))
        children = {child.type: child for child in named(node)}
        output, given, body = (children.get(kind) for kind in ("function_output", "function_arguments", "block"))
        outputs = [text_of(n) for n in descend(output) if n.type == "identifier"] if output is not None else []
        arguments = [Argument(text_of(n)) for n in named(given)] if given is not None else []
        function = Function(name, line_of(node), tuple(arguments), self.block(body), tuple(sorted(outputs, key=lambda n:
            text_of(output).index(n))))  # fmt: skip
        self.unit.functions.setdefault(name, []).append(function)

    # -- statements --

    def block(self, node: Any) -> tuple[Part, ...]:
        return () if node is None else tuple(self.statement(child) for child in named(node))

    def statement(self, node: Any) -> Part:
        if node.has_error and node.type not in ("if_statement", "for_statement"):
            return self.unread(node, "a syntax error")
        match node.type:
            case "assignment":
                left, right = field_of(node, "left"), field_of(node, "right")
                if left.type == "multioutput_variable":
                    targets = tuple(map(self.expression, named(left)))
                    return self.part("several", node, targets, self.expression(right))
                if left.type not in ("identifier", "function_call", "field_expression"):
                    return self.unread(node, "several names assigned at once")
                return self.part("assign", node, self.expression(left), "", self.expression(right))
            case "if_statement":
                clauses = [c for c in named(node) if c.type in ("elseif_clause", "else_clause")]
                return self.branch(node, clauses)
            case "for_statement":
                return self.loop(node)
            case "return_statement":
                return self.unread(node, "a return before the end")
            case "function_call" if text_of(field_of(node, "name")) == "error":
                return self.part("fail", node, "an error is raised")
            case "function_call":
                return self.part("do", node, self.expression(node))
        return self.unread(node, f"a statement outside the language of audit ({node.type.replace('_', ' ')})")

    def branch(self, node: Any, clauses: list[Any]) -> Part:
        """``if``, with ``elseif`` as a branch of the other way."""
        then = next((c for c in node.named_children if c.type == "block"), None)
        test = self.expression(field_of(node, "condition"))
        if not clauses:
            return self.part("if", node, test, self.block(then), ())
        if clauses[0].type == "elseif_clause":
            return self.part("if", node, test, self.block(then), (self.branch(clauses[0], clauses[1:]),))
        other = next((c for c in clauses[0].named_children if c.type == "block"), None)
        return self.part("if", node, test, self.block(then), self.block(other))

    def loop(self, node: Any) -> Part:
        """``for i = a:b`` and ``for i = a:step:b``."""
        iterator = next((c for c in named(node) if c.type == "iterator"), None)
        body = next((c for c in named(node) if c.type == "block"), None)
        parts = named(iterator) if iterator is not None else []
        if len(parts) != 2 or parts[1].type != "range":
            return self.unread(node, "a loop over something else than a range")
        ends = [self.expression(child) for child in named(parts[1])]
        one = self.part("number", node, 1, "int")
        if len(ends) == 3:
            return self.unread(node, "a loop with a step")
        stop = self.part("op", node, "+", ends[1], one)
        return self.part("for", node, text_of(parts[0]), ends[0], stop, one, self.block(body))

    # -- expressions --

    def expression(self, node: Any) -> Part:
        match node.type:
            case "number":
                value = read_decimal(text_of(node))
                if value is None:
                    return self.refuse(node, f"the number {text_of(node)[:20]}")
                return self.part("number", node, value, "int" if value.denominator == 1 else "real")
            case "boolean":
                return self.part("number", node, int(text_of(node) == "true"), "int")
            case "identifier":
                return self.part("name", node, text_of(node))
            case "parenthesis":
                inner = named(node)
                return self.expression(inner[0]) if len(inner) == 1 else self.refuse(node, "parentheses")
            case "binary_operator" if sign_of(node) in POWERS:
                return self.power(node)
            case "binary_operator":
                sides = [self.expression(field_of(node, side)) for side in ("left", "right")]
                sign = sign_of(node)
                if sign not in SIGNS:
                    return self.refuse(node, f"the operator {sign}")
                return self.part("op", node, SIGNS[sign], *sides)
            case "unary_operator":
                operand = self.expression(field_of(node, "operand"))
                return operand if text_of(node).startswith("+") else self.part("minus", node, operand)
            case "not_operator":
                return self.part("not", node, self.expression(named(node)[0]))
            case "boolean_operator":
                kind = "both" if any(text_of(c) in ("&&", "&") for c in node.children) else "either"
                return self.part(kind, node, *(self.expression(field_of(node, side)) for side in ("left", "right")))
            case "comparison_operator":
                sign = next(text_of(child) for child in node.children if not child.is_named)
                pair = named(node)
                if sign not in COMPARISONS or len(pair) != 2:
                    return self.refuse(node, f"the comparison {sign}")
                return self.part("compare", node, COMPARISONS[sign], *map(self.expression, pair))
            case "postfix_operator":
                return self.part("method", node, self.expression(field_of(node, "operand")), "T", ())
            case "matrix":
                rows = [r for r in named(node) if r.type == "row"]
                return self.part("list", node, tuple(self.row(r) for r in rows))
            case "function_call":
                return self.call(node)
            case "field_expression":
                name = "".join(text_of(node).split())
                if not name.replace(".", "").replace("_", "").isalnum():
                    return self.refuse(node, "a member of an expression")
                return self.part("name", node, name)
        return self.refuse(node, f"an expression outside the language of audit ({node.type.replace('_', ' ')})")

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

    def row(self, node: Any) -> Part:
        return self.part("list", node, tuple(map(self.expression, named(node))))

    def call(self, node: Any) -> Part:
        """A function, or entries ``M(i, j)``, which look alike."""
        name = field_of(node, "name")
        given = next((c for c in named(node) if c.type == "arguments"), None)
        arguments = tuple(self.index(child) for child in (named(given) if given is not None else []))
        if name.type not in ("identifier", "field_expression"):
            return self.refuse(node, "a call of an expression")
        return self.part("call", node, "".join(text_of(name).split()), arguments)

    def index(self, node: Any) -> Part:
        """An index: a number, a range or all."""
        if node.type == "spread_operator":
            return self.part("slice", node, None, None)
        if node.type == "range":
            ends = [self.expression(child) for child in named(node)]
            return self.part("slice", node, *ends) if len(ends) == 2 else self.refuse(node, "a range with a step")
        return self.expression(node)


def sign_of(node: Any) -> str:
    """The operator between two operands."""
    return next(text_of(child) for child in node.children if not child.is_named)


def list_powers(node: Any, signs: list[str]) -> list[Any]:
    """The operands of a tower of powers as they stand in the text, and the operators between them into ``signs``."""
    if node.type != "binary_operator" or sign_of(node) not in POWERS:
        return [node]
    left = list_powers(field_of(node, "left"), signs)
    signs.append(sign_of(node))
    return [*left, *list_powers(field_of(node, "right"), signs)]
