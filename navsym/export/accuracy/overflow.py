"""Intermediate values that may overflow where nobody would see it: under a division, an infinity becomes a zero."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from flint import arb

from navsym.export.accuracy.rounding import BITS, Arithmetic, analyse, up
from navsym.export.accuracy.uniform import Box, starting_cells
from navsym.export.expression_graph import Graph
from navsym.proof.balls import precision

#: Places of the arguments whose infinity (or, for extremes, NaN) a result may hide. Every other operation hands it on,
#: or has with it the very value that it has just below (exp, atan, tanh).
HIDES = {"div": (1,), "atan2": (0, 1), "pow": (0, 1), "max": (0, 1), "min": (0, 1), "filled": (0,)}


def unseen(
    graph: Graph, box: Sequence[tuple[float, float]], arithmetic: Arithmetic, literals: Sequence[Any]
) -> tuple[int, ...]:
    """Nodes that a later operation hides and that are not proved to stay finite on the box."""
    hidden = {node.args[k] for node in graph.nodes for k in HIDES.get(node.op, ())}
    left = {place for place in hidden if graph.nodes[place].op not in ("input", "const")}
    found: set[int] = set()
    for cell in starting_cells(box):
        found |= {place for place in left - found if place in large(graph, cell, arithmetic, literals)}
        if found == left:
            break
    return tuple(sorted(found))


def large(graph: Graph, cell: Box, arithmetic: Arithmetic, literals: Sequence[Any]) -> set[int]:
    """Nodes that are not proved to be finite on one cell; in code they would be infinite, or undefined."""
    with precision(BITS):
        balls = [arb(low).union(arb(high)) if low != high else arb(low) for low, high in cell]
        largest = arb(2) ** arithmetic.top
        done = analyse(graph, balls, arithmetic, literals)
        return {k for k, node in enumerate(done) if not up(node.value) + node.absolute < largest}
