"""Parts with a hole at zero as functions of their own in code (:mod:`navsym.export.accuracy.continuation`).

Every language writes them from the same two branches (:func:`print_helper`): the operations whose bounds were proved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from navsym.export.accuracy.continuation import Continuation, continuation
from navsym.export.accuracy.rounding import ARITHMETICS, literals_of
from navsym.export.expression_graph import Graph
from navsym.export.holes import Part, T
from navsym.export.languages.names import name_of
from navsym.export.languages.printing import Spelling, bare, node_text
from navsym.export.parts import ExportedFunction
from navsym.prove.wording import expression_text


@dataclass(frozen=True, slots=True)
class PrintedHelper:
    """A part with a hole in a language: polynomial below the switch, formula above it.

    squared : the polynomial is written in y, the square of x
    """

    name: str
    about: str
    switch: str
    below: str
    above: str
    squared: bool


def helpers_used(*functions: ExportedFunction) -> list[tuple[Part, str]]:
    """The parts that the code needs, each with the type it is computed in, by name."""
    used = {
        (node.value, function.arithmetic.name)
        for function in functions
        for piece in function.pieces
        for node in piece.graph.nodes
        if node.op == "filled"
    }
    return sorted(used, key=lambda pair: name_of(pair[0]))


def print_helper(part: Part, real: str, s: Spelling, x: str) -> PrintedHelper:
    """A part in this language; ``x`` is the argument of the formula above the switch."""
    known = continuation(part, real)
    square = squared_node(known.below)
    literals = literals_of(known.below, ARITHMETICS[real])
    below = bare(nested(known.below, literals, s, "x", square))
    above = bare(nested(known.above, known.literals, s, x))
    switch, about = s.number(known.switch), helper_about(part, known, s)
    return PrintedHelper(name_of(part), about, switch, below, above, square is not None)


def nested(graph: Graph, literals: Sequence[float | None], s: Spelling, x: str, square: int | None = None) -> str:
    """A graph of one argument as one expression, with y for the node ``square``."""
    text: list[str] = []
    for place in range(len(graph.nodes)):
        text.append("y" if place == square else node_text(graph, place, text, [x], literals, s))
    return text[graph.roots[0]]


def squared_node(polynomial: Graph) -> int | None:
    """The node of a polynomial that is the square of the argument, None where there is none."""
    nodes = polynomial.nodes
    t = next((k for k, node in enumerate(nodes) if node.op == "input"), None)
    return next((k for k, node in enumerate(nodes) if node.op == "mul" and node.args == (t, t)), None)


def helper_about(part: Part, known: Continuation, s: Spelling) -> str:
    """The comment of a helper: what it is in x, and how near the polynomial is."""
    formula = expression_text(part.plain.xreplace({T: sp.Symbol("x", real=True)}))
    power = {0: "", 1: "/x"}.get(part.divided, f"/x^{part.divided}")
    formula = f"({formula}){power}" if power else formula
    lost = int(sp.ceiling(sp.log(sp.Float(float(known.remainder / known.least)), 2)))
    switch = s.number(known.switch).removesuffix(s.suffix)
    return f"{formula}; below {switch} its Taylor polynomial, proved within 2^{lost} of it; defined at zero."
