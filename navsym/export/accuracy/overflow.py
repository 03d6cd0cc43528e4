"""Intermediate values that may overflow or underflow where nobody would see it.

Under a division an infinity becomes a zero; under a root, or in a quotient, a product that underflows is a zero, or has
lost its digits. Sums never lose digits by underflow.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp
from flint import arb

from navsym.core.balls import precision
from navsym.export.accuracy.rounding import BITS, Arithmetic, down, up
from navsym.export.accuracy.underflow import Margins
from navsym.export.accuracy.uniform import on_cell, starting_cells
from navsym.export.expression_graph import Graph, Node

#: Places of the arguments whose infinity (or, for extremes, NaN) a result may hide. Every other operation hands it on,
#: or has with it the very value that it has just below (exp, atan, tanh).
HIDES = {"div": (1,), "atan2": (0, 1), "pow": (0, 1), "max": (0, 1), "min": (0, 1), "filled": (0,)}


#: Operations whose result is as wrong, relative to its size, as their arguments are.
RELATIVE = frozenset({"mul", "div", "sqrt", "log", "pow", "atan2"})


def watched(graph: Graph, box: Sequence[tuple[float, float]], arithmetic: Arithmetic, literals: Sequence[Any]) -> Graph:
    """The graph with guards for what may overflow unseen on the box, or lose its digits by underflow."""
    hidden = {node.args[k] for node in graph.nodes for k in HIDES.get(node.op, ())} & made(graph)
    found: set[int] = set()
    for cell in starting_cells(box):
        if found == hidden:
            break
        done = on_cell(graph, cell, arithmetic, literals)
        found |= {k for k in hidden - found if not done[k].is_finite(arithmetic)}
    needed = {a for node in graph.nodes if node.op in RELATIVE for a in node.args} & made(graph)
    ranges, least = sizes(graph, box, arithmetic, literals), arithmetic.eta - arithmetic.u
    small = [k for k in sorted(needed) if (known := ranges[k]) is not None and known.low < least]
    return with_guards(graph, sorted(found), small, Margins(graph, ranges, least))


@dataclass(frozen=True, slots=True)
class Size:
    """Sign of a quantity that is never zero, and bounds of log2 of its magnitude, near enough."""

    sign: int
    low: float
    high: float


def sizes(
    graph: Graph, box: Sequence[tuple[float, float]], arithmetic: Arithmetic, literals: Sequence[Any]
) -> list[Size | None]:
    """How small and how large every node may be on the box; None for one that may be zero.

    Quantities that range over hundreds of decades are followed in logarithms, where balls hold zero.
    """
    done, found = on_cell(graph, tuple(box), arithmetic, literals), list[Size | None]()
    for node, value in zip(graph.nodes, (one.value for one in done), strict=True):
        if node.op == "input":
            found.append(size_of_input(*box[node.value]))
        elif value.is_finite() and not value.contains(0):
            found.append(Size(1 if value > 0 else -1, log2(down(value)), log2(up(value))))
        else:
            found.append(combined(node, [found[a] for a in node.args], graph))
    return found


def size_of_input(low: float, high: float) -> Size | None:
    """The size of an argument; None for a range that has zero in it."""
    if low <= 0 <= high:
        return None
    small, large = sorted((abs(low), abs(high)))
    return Size(1 if low > 0 else -1, math.log2(small), math.log2(large))


def combined(node: Node, args: Sequence[Size | None], graph: Graph) -> Size | None:
    """The size of a result from those of its arguments."""
    if not args or args[0] is None:
        return None
    a, b = args[0], args[-1]
    if node.op in ("neg", "abs"):
        return Size(1 if node.op == "abs" else -a.sign, a.low, a.high)
    if node.op == "sqrt" and a.sign > 0:
        return Size(1, a.low / 2, a.high / 2)
    if node.op == "pow" and a.sign > 0 and graph.nodes[node.args[1]].op == "const":
        low, high = sorted(end * float(graph.nodes[node.args[1]].value) for end in (a.low, a.high))
        return Size(1, low, high)
    if b is None:
        return None
    if node.op == "mul":
        return Size(a.sign * b.sign, a.low + b.low, a.high + b.high)
    if node.op == "div":
        return Size(a.sign * b.sign, a.low - b.high, a.high - b.low)
    if node.op == "add" and a.sign == b.sign:
        return Size(a.sign, max(a.low, b.low), max(a.high, b.high) + 1)
    return None


def with_guards(graph: Graph, large: Sequence[int], small: Sequence[int], margins: Margins) -> Graph:
    """Guards are finite where all is well: a value itself, and 4/value, which overflows where the value is subnormal.

    A quotient of values that may be zero asks its divisor, which is not zero by right, and the margin of its numerator.
    """
    quotients = [node.args for node in graph.nodes if node.op == "div"]
    asked = [*small, *(b for _, b in quotients if margins.is_needed(b))]
    asked += [margins.of_quotient(a, b) for a, b in quotients if margins.is_tiny(b) and margins.is_needed(a)]
    if not asked:
        return replace(graph, guards=tuple(large))
    four = margins.put("const", value=sp.Integer(4))
    places = [margins.put("div", four, k) for k in dict.fromkeys(asked)]
    return replace(graph, nodes=tuple(margins.nodes), guards=(*large, *places))


def made(graph: Graph) -> set[int]:
    """The nodes that are results of operations."""
    return {k for k, node in enumerate(graph.nodes) if node.op not in ("input", "const")}


def log2(x: arb) -> float:
    """The binary logarithm of a positive number of any size, near enough."""
    with precision(BITS):
        return float(x.log() / arb(2).log())
