"""Parts with a hole at zero as functions of their own in code (:mod:`navsym.export.accuracy.continuation`).

Every language writes them from the same two branches (:func:`print_helper`): the operations whose bounds were proved.
"""

from __future__ import annotations

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
class Helper:
    """A part and the type it is computed in."""

    part: Part
    real: str

    @property
    def name(self) -> str:
        """What code calls it, behind ``navsym_``."""
        return name_of(self.part)

    @property
    def known(self) -> Continuation:
        """The two branches of the part for this type."""
        return continuation(self.part, self.real)

    @property
    def formula(self) -> str:
        """What it is, in x."""
        numerator = expression_text(self.part.plain.xreplace({T: sp.Symbol("x", real=True)}))
        power = {0: "", 1: "/x"}.get(self.part.divided, f"/x^{self.part.divided}")
        return f"({numerator}){power}" if power else numerator

    @property
    def operations(self) -> set[str]:
        """What both branches call."""
        return {*self.known.below.operations(), *self.known.above.operations()}


def helpers_used(*functions: ExportedFunction) -> list[Helper]:
    """The parts that the code needs, by name."""
    used = {
        Helper(node.value, function.arithmetic.name)
        for function in functions
        for piece in function.pieces
        for node in piece.graph.nodes
        if node.op == "filled"
    }
    return sorted(used, key=lambda helper: helper.name)


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


def print_helper(helper: Helper, s: Spelling, x: str) -> PrintedHelper:
    """A part in this language; ``x`` is the argument of the formula above the switch."""
    known, squared = helper.known, squared_node(helper) is not None
    below = bare(nested(known.below, helper, s, "x", "y" * squared))
    above = bare(nested(known.above, helper, s, x))
    return PrintedHelper(helper.name, helper_about(helper, s), s.number(known.switch), below, above, squared)


def nested(graph: Graph, helper: Helper, s: Spelling, x: str, y: str = "") -> str:
    """A graph of one argument as one expression."""
    literals, square = literals_of(graph, ARITHMETICS[helper.real]), squared_node(helper) if y else None
    text: list[str] = []
    for place in range(len(graph.nodes)):
        text.append(y if place == square else node_text(graph, place, text, [x], literals, s))
    return text[graph.roots[0]]


def squared_node(helper: Helper) -> int | None:
    """The node of the polynomial that is the square of the argument, None where there is none."""
    graph = helper.known.below
    t = next((k for k, node in enumerate(graph.nodes) if node.op == "input"), None)
    return next((k for k, node in enumerate(graph.nodes) if node.op == "mul" and node.args == (t, t)), None)


def helper_about(helper: Helper, s: Spelling) -> str:
    """The comment of a helper."""
    known = helper.known
    lost = int(sp.ceiling(sp.log(sp.Float(float(known.remainder / known.least)), 2)))
    switch = s.number(known.switch).removesuffix(s.suffix)
    return f"{helper.formula}; below {switch} its Taylor polynomial, proved within 2^{lost} of it; defined at zero."
