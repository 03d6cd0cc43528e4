"""Where products that underflow make a value wrong, and nodes that tell it in the code."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import TYPE_CHECKING

import sympy as sp

from navsym.export.expression_graph import Builder, Graph, Node

if TYPE_CHECKING:
    from navsym.export.accuracy.overflow import Size

#: No double but zero, and no float, is nearer to a multiple of pi/2 than two to this power: so are sines and cosines.
SMALL = -64.0
#: Digits of a double and one more.
DIGITS = 54.0
#: Functions that are near zero beside a zero of their own, no nearer than :data:`SMALL`.
TRIGONOMETRIC = frozenset({"sin", "cos", "acos", "asin", "log"})
#: Operations whose result is near zero only where their first argument is, with the same relative error there.
FOLLOWS = frozenset({"neg", "abs", "sqrt", "sin", "asin", "atan", "sinh", "tanh", "expm1"})
SUMS, PRODUCTS = ("add", "sub", "max", "min"), ("mul", "div", "pow", "exp")


class Margins(Builder):
    """Nodes that are normal numbers where no product behind a value has lost digits by underflow, else subnormal.

    The margin of a product is its magnitude, plus one where a factor is exactly zero; that of a sum its magnitude, plus
    the least margin of its terms, which counts where the terms are small; a value that is exact has none.
    """

    def __init__(self, graph: Graph, ranges: Sequence[Size | None], least: float):
        super().__init__(graph.inputs)
        self.nodes += graph.nodes  # those of the margins come behind them, each once
        self.ranges, self.least = ranges, least
        self.lows: list[float] = []
        for node, size in zip(graph.nodes, ranges, strict=True):
            self.lows.append(self.low_of(node) if size is None else size.low - 1.0)
        self.suffering: dict[int, bool] = {}
        self.done: dict[int, int | None] = {}

    def is_needed(self, place: int) -> bool:
        """Whether a value, whose size is not known, may have lost digits by underflow."""
        return self.ranges[place] is None and self.may_suffer(place)

    def may_suffer(self, place: int) -> bool:
        """Whether a product behind a value may underflow, and the value be so small that this counts."""
        if place not in self.suffering:
            node = self.nodes[place]
            behind = node.op in (*FOLLOWS, *SUMS, *PRODUCTS) and any(self.may_suffer(a) for a in node.args)
            self.suffering[place] = not self.is_large(place) and (behind or self.underflows(place))
        return self.suffering[place]

    def underflows(self, place: int) -> bool:
        """Whether the operation itself may give a result below the normal numbers from arguments that are exact."""
        node = self.nodes[place]
        sizes = [self.ranges[a] for a in node.args]
        grows = node.op == "mul" and any(size is not None and size.low >= 0 for size in sizes)  # a factor of at least 1
        return node.op in PRODUCTS and not grows and self.lows[place] < self.least

    def is_large(self, place: int) -> bool:
        """Whether a value is a normal number for certain: by its size, or as a sum with a term that is one."""
        size, node = self.ranges[place], self.nodes[place]
        if size is not None:
            return size.low >= self.least
        return node.op == "add" and all(map(self.is_nonnegative, node.args)) and any(map(self.is_large, node.args))

    def is_nonnegative(self, place: int) -> bool:
        """Whether a value is known to be zero or above: a square, and what comes from squares and positive values."""
        size, node = self.ranges[place], self.nodes[place]
        if size is not None:
            return size.sign > 0
        if node.op == "mul" and node.args[0] == node.args[1]:
            return True
        keeps = node.op in ("add", "mul", "div", "sqrt")
        return node.op in ("abs", "exp") or (keeps and all(map(self.is_nonnegative, node.args)))

    def is_tiny(self, place: int) -> bool:
        """Whether a divisor may be so small that a numerator below all normal numbers gives a quotient of size."""
        return self.lows[place] < self.least / 2

    def low_of(self, node: Node) -> float:
        """At most the binary logarithm of the magnitude of a computed value that is not exactly zero."""
        args = [self.lows[a] for a in node.args]
        if node.op in TRIGONOMETRIC:
            return min([*args, SMALL]) if node.op in FOLLOWS else SMALL
        if node.op in ("add", "sub"):
            return min(args) - DIGITS  # both terms are whole multiples of the last place of the smaller one
        if node.op in ("max", "min", *FOLLOWS):
            return min([*args, 0.0]) - 1.0
        if node.op == "mul":
            return sum(args)
        return 2.0 * self.least if node.args else self.least - DIGITS

    def of_quotient(self, numerator: int, divisor: int) -> int:
        """The margin of a numerator, or the divisor where that leaves next to nothing of the error."""
        size = self.put("mul", self.put("abs", divisor), self.put("const", value=sp.Integer(2) ** int(self.least / 2)))
        margin = self.of(numerator)
        return size if margin is None else self.put("max", margin, size)

    def of(self, place: int) -> int | None:
        """The margin of a value; None where underflow cannot reach it."""
        if place not in self.done:
            self.done[place] = self.built(place) if self.may_suffer(place) else None
        return self.done[place]

    def built(self, place: int) -> int:
        """The margin of the result of an operation."""
        node = self.nodes[place]
        behind = [margin for a in node.args if (margin := self.of(a)) is not None]
        if node.op in SUMS:
            return self.put("add", self.put("abs", place), self.smallest(behind))
        if not self.underflows(place):
            return self.smallest(behind)
        factors = node.args if node.op == "mul" else node.args[:1] if node.op != "exp" else ()
        zeros = [self.is_zero(a) for a in dict.fromkeys(factors) if self.ranges[a] is None]
        return self.smallest([self.total([self.put("abs", place), *zeros]), *behind])

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
