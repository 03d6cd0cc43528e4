"""Graphs as assignments: what all languages share. A language adds its spelling.

Every binary operation stands in parentheses of its own, so that no language's precedence matters,
and a blank on either side of an operator, so that tests can find and corrupt it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from navsym.export.expression_graph import Graph
from navsym.export.languages.names import name_of
from navsym.export.parts import ExportedFunction, Piece

SIGNS = {"add": "+", "sub": "-", "mul": "*", "div": "/"}
LONGEST = 76


@dataclass(frozen=True, slots=True)
class Spelling:
    """How a language writes numbers and calls.

    calls     : operation -> format with {0}, {1}
    nan, inf  : how these are written, for test vectors
    suffix    : put behind every literal (``f`` in C with float)
    """

    calls: Mapping[str, str]
    nan: str
    inf: str
    suffix: str = ""
    exponent: str = "e"

    def number(self, value: float) -> str:
        """A literal that is read back as exactly this number."""
        if math.isnan(value):
            return self.nan
        if math.isinf(value):
            return self.inf if value > 0 else f"-{self.inf}"
        text = repr(float(value))
        if "e" in text:
            head, tail = text.split("e")
            text = f"{head if '.' in head else head + '.0'}{self.exponent}{int(tail)}"
        elif self.exponent != "e":
            text += f"{self.exponent}0"
        return text + self.suffix


def calls(prefix: str = "", suffix: str = "", **special: str) -> dict[str, str]:
    """Names of the library functions with a prefix or suffix, and those that are written otherwise."""
    names = "sin cos exp log sqrt asin acos atan sinh cosh tanh expm1".split()
    table = {name: f"{prefix}{name}{suffix}({{0}})" for name in names}
    pairs = {"atan2": "atan2", "pow": "pow", "max": "fmax", "min": "fmin"}
    table |= {name: f"{prefix}{word}{suffix}({{0}}, {{1}})" for name, word in pairs.items()}
    return table | {"abs": f"{prefix}fabs{suffix}({{0}})"} | special


def assignments(
    piece: Piece, names: list[str], spelling: Spelling, apart: frozenset[str] = frozenset()
) -> tuple[list[tuple[str, str, bool]], list[str]]:
    """([(temporary, expression, whether it is one of ``apart``), …], [expression of each result]).

    What the formulas name keeps its name; shared nodes, long expressions and the operations of ``apart`` get a
    temporary; everything else stands where it is used.
    """
    graph, counts = piece.graph, piece.graph.uses()
    text: list[str] = []
    lines: list[tuple[str, str, bool]] = []
    for place, node in enumerate(graph.nodes):
        written = node_text(graph, place, text, names, piece.literals, spelling)
        simple = node.op in ("input", "const") or (node.op == "neg" and graph.nodes[node.args[0]].op == "const")
        named = graph.names.get(place)
        if not simple and (named or counts[place] > 1 or len(written) > LONGEST or node.op in apart):
            name = named or f"t{len(lines)}"
            lines.append((name, bare(written), node.op in apart))
            written = name
        text.append(written)
    results = [bare(text[root]) for root in graph.roots]
    if graph.guards:
        results[0] = guarded(text[graph.roots[0]], [text[k] for k in graph.guards], spelling)
    return lines, results


def guarded(result: str, values: Sequence[str], spelling: Spelling) -> str:
    """The result, which is no number when one of the values is none: a finite one adds an exact zero."""
    for value in values:
        result = f"({result} + ({spelling.number(0.0)} * {value}))"
    return bare(result)


def node_text(
    graph: Graph, place: int, text: list[str], names: list[str], literals: Sequence[float | None], spelling: Spelling
) -> str:
    """One node in terms of its arguments."""
    node = graph.nodes[place]
    args = [text[a] for a in node.args]
    if node.op == "input":
        return names[node.value]
    if node.op == "const":
        value: Any = literals[place]
        return spelling.number(value)
    if node.op == "neg":
        return f"(-{args[0]})"
    if node.op in SIGNS:
        return f"({args[0]} {SIGNS[node.op]} {args[1]})"
    if node.op == "filled":
        return f"navsym_{name_of(node.value)}({bare(args[0])})"
    return spelling.calls[node.op].format(*(bare(a) for a in args))


def bare(text: str) -> str:
    """The text without the one pair of parentheses that encloses all of it."""
    if not (text.startswith("(") and text.endswith(")")):
        return text
    depth = 0
    for place, char in enumerate(text):
        depth += (char == "(") - (char == ")")
        if depth == 0 and place < len(text) - 1:
            return text
    return text[1:-1]


def result_fields(function: ExportedFunction, name: str) -> str:
    """``output: value`` of every output, from results that are written as ``name`` with their place."""
    parts = []
    for output, first in function.placed:
        entries = ", ".join(name.format(first + e) for e in range(output.size))
        parts.append(f"{output.name}: [{entries}]" if output.shape else f"{output.name}: {entries}")
    return ", ".join(parts)
