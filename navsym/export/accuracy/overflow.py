"""Intermediate values that may overflow or underflow where nobody would see it.

Under a division an infinity becomes a zero; under a root, or in a quotient, a product that underflows is a zero, or has
lost its digits. Sums never lose digits by underflow.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp
from flint import arb

from navsym.core.balls import precision
from navsym.export.accuracy.continuation import analyse
from navsym.export.accuracy.rounding import BITS, Arithmetic, Bounded, down, up
from navsym.export.accuracy.uniform import Box, starting_cells
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
        found |= {k for k in hidden - found if not finite(done[k], arithmetic)}
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
    tops = [a for a, b in quotients if margins.may_be_below_one(b) and margins.is_needed(a)]
    asked += [place for a in tops if (place := margins.of(a)) is not None]
    if not asked:
        return replace(graph, guards=tuple(large))
    four = margins.put("const", value=sp.Integer(4))
    places = [margins.put("div", four, k) for k in dict.fromkeys(asked)]
    return replace(graph, nodes=tuple(margins.nodes), guards=(*large, *places))


#: Operations whose result is near zero only where their first argument is, with the same relative error there.
FOLLOWS = frozenset({"neg", "abs", "sqrt", "sin", "asin", "atan", "sinh", "tanh", "expm1"})


class Margins:
    """Nodes that are normal numbers where no product behind a value has lost digits by underflow, else subnormal.

    The margin of a product is its magnitude, plus one where a factor is exactly zero; that of a sum its magnitude, plus
    the least margin of its terms, which counts where the terms are small; a value that is exact has none.
    """

    def __init__(self, graph: Graph, ranges: Sequence[Size | None], least: float):
        self.nodes = list(graph.nodes)
        self.ranges, self.least = ranges, least
        self.done: dict[int, int | None] = {}
        self.new: dict[tuple[str, tuple[int, ...], Any], int] = {}

    def put(self, op: str, *args: int, value: Any = None) -> int:
        """The place of a node behind those of the graph, made once."""
        key = (op, args, value)
        if key not in self.new:
            self.new[key] = len(self.nodes)
            self.nodes.append(Node(op, args, value))
        return self.new[key]

    def is_needed(self, place: int) -> bool:
        """Whether a value, whose size is not known, may have lost digits by underflow."""
        return self.ranges[place] is None and self.of(place) is not None

    def may_be_below_one(self, place: int) -> bool:
        """Whether a divisor may make a small error large."""
        size = self.ranges[place]
        return size is None or size.low < 0

    def of(self, place: int) -> int | None:
        """The margin of a value; None where underflow cannot reach it."""
        if place not in self.done:
            size = self.ranges[place]
            safe = size is not None and size.low >= self.least
            self.done[place] = None if safe else self.made(place)
        return self.done[place]

    def made(self, place: int) -> int | None:
        """The margin of the result of an operation."""
        node = self.nodes[place]
        behind = [margin for a in node.args if (margin := self.of(a)) is not None]
        if node.op in FOLLOWS:
            return behind[0] if behind else None
        if node.op in ("add", "sub", "max", "min"):
            return self.put("add", self.put("abs", place), self.smallest(behind)) if behind else None
        if node.op == "mul" and any(self.is_at_least_one(a) for a in node.args):
            return behind[0] if behind else None
        if node.op in ("mul", "div", "pow", "exp"):
            factors = node.args if node.op == "mul" else node.args[:1] if node.op != "exp" else ()
            zeros = [self.is_zero(a) for a in dict.fromkeys(factors) if self.ranges[a] is None]
            return self.smallest([self.total([self.put("abs", place), *zeros]), *behind])
        return None

    def is_at_least_one(self, place: int) -> bool:
        """Whether a factor makes nothing smaller."""
        size = self.ranges[place]
        return size is not None and size.low >= 0

    def total(self, places: Sequence[int]) -> int:
        """The sum of values."""
        return functools.reduce(lambda a, b: self.put("add", a, b), places)

    def smallest(self, places: Sequence[int]) -> int:
        """The least of values."""
        return functools.reduce(lambda a, b: self.put("min", a, b), dict.fromkeys(places))

    def is_zero(self, place: int) -> int:
        """One where a value is exactly zero, and zero elsewhere, without overflow: powers of two are exact."""
        half = int(self.least) + 2
        tiny = self.put("const", value=sp.Integer(2) ** half)
        huge = self.put("const", value=sp.Integer(2) ** -half)
        first = self.put("mul", self.put("min", self.put("abs", place), tiny), huge)
        second = self.put("const", value=sp.Integer(2) ** -64)
        full = self.put("mul", self.put("min", first, second), self.put("const", value=sp.Integer(2) ** 64))
        return self.put("sub", self.put("const", value=sp.Integer(1)), full)


def made(graph: Graph) -> set[int]:
    """The nodes that are results of operations."""
    return {k for k, node in enumerate(graph.nodes) if node.op not in ("input", "const")}


def on_cell(graph: Graph, cell: Box, arithmetic: Arithmetic, literals: Sequence[Any]) -> list[Bounded]:
    """Values and bounds of all nodes on one cell; in code a node without a bound would be infinite, or undefined."""
    with precision(BITS):
        balls = [arb(low).union(arb(high)) if low != high else arb(low) for low, high in cell]
    return analyse(graph, balls, arithmetic, literals)


def finite(found: Bounded, arithmetic: Arithmetic) -> bool:
    """True for a value that is proved to be finite in code."""
    with precision(BITS):
        return bool(up(found.value) + found.absolute < arb(2) ** arithmetic.top)


def log2(x: arb) -> float:
    """The binary logarithm of a positive number of any size, near enough."""
    with precision(BITS):
        return float(x.log() / arb(2).log())
