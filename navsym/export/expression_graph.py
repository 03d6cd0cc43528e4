"""One graph for all languages: every operation once, in the order in which it is computed.

Equal subexpressions are one node. Sines and cosines of rational multiples of one angle share one
sincos and follow by double angles and addition (:func:`build` with ``share``). Whole powers are
products, a product with negative powers is one quotient. ``Graph.meaning`` is the exact formula of
each root, which the normal form proves equal to the claim.

A long computation is a chain of named values (``lets``): a later formula refers to an earlier one by its symbol,
so that every link is proved by itself and no formula is ever written out in full.
"""

from __future__ import annotations

import operator
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce
from typing import Any

import sympy as sp

from navsym.core.errors import DomainError, UnknownSymbolError
from navsym.core.exact import raise_by_squaring
from navsym.export.atoms import expm1, filled, plain
from navsym.export.forms import common_step
from navsym.export.holes import part_of

SAME_NAME = "sin cos exp log asin acos atan sinh cosh tanh".split()
UNARY: dict[type, str] = {getattr(sp, name): name for name in SAME_NAME} | {sp.Abs: "abs", expm1: "expm1"}
BINARY: dict[type, str] = {sp.atan2: "atan2", sp.Max: "max", sp.Min: "min"}
MULTIPLES = 16  # above it an angle is computed by itself


@dataclass(frozen=True, slots=True)
class Node:
    """One operation; ``value`` is the exact number of a constant, the place of an input or the part that is filled."""

    op: str
    args: tuple[int, ...] = ()
    value: Any = None


@dataclass(frozen=True, slots=True, eq=False)
class Graph:
    """Inputs, operations in order, and the nodes that are the results.

    names  : node -> what its value is called in the formulas, for those that read the code
    guards : nodes whose overflow a later operation would hide, so that the code must ask for it
    """

    inputs: tuple[sp.Symbol, ...]
    nodes: tuple[Node, ...]
    roots: tuple[int, ...]
    names: Mapping[int, str] = field(default_factory=dict)
    guards: tuple[int, ...] = ()

    def uses(self) -> list[int]:
        """How often each node is used, as an argument or as a result."""
        counts = [0] * len(self.nodes)
        for place in (*(a for node in self.nodes for a in node.args), *self.roots, *self.guards):
            counts[place] += 1
        return counts

    def operations(self) -> Counter[str]:
        """Number of operations of each kind."""
        return Counter(node.op for node in self.nodes if node.op not in ("input", "const", "let"))

    def meaning(self) -> tuple[sp.Expr, ...]:
        """Exact value of every root, written with the symbols of the inputs and of the named values."""
        done = self.values()
        return tuple(plain(done[root]) for root in self.roots)

    def named_meanings(self) -> dict[sp.Symbol, sp.Expr]:
        """Exact value of every named value, written with the inputs and the names before it."""
        done = self.values()
        return {node.value: plain(done[node.args[0]]) for node in self.nodes if node.op == "let"}

    def values(self) -> list[sp.Expr]:
        """Exact value of every node."""
        done: list[sp.Expr] = []
        for node in self.nodes:
            done.append(value_of(node, [done[a] for a in node.args], self.inputs))
        return done

    def without_names(self) -> Graph:
        """The same operations with names for reading only; what they made different and is equal becomes one node."""
        builder = Builder(self.inputs)
        new: list[int] = []
        names: dict[int, str] = {}
        for node in self.nodes:
            args = [new[a] for a in node.args]
            new.append(args[0] if node.op == "let" else builder.put(node.op, *args, value=node.value))
            if node.op == "let":
                names.setdefault(args[0], node.value.name)
        return pruned(Graph(self.inputs, tuple(builder.nodes), tuple(new[root] for root in self.roots), names))


FUNCTION_OF: dict[str, Any] = {name: kind for kind, name in (*UNARY.items(), *BINARY.items())}
FUNCTION_OF |= {name: getattr(operator, name) for name in ("add", "sub", "mul", "neg", "pow")}
FUNCTION_OF |= {"div": operator.truediv, "sqrt": sp.sqrt}


def value_of(node: Node, args: list[sp.Expr], inputs: Sequence[sp.Symbol]) -> sp.Expr:
    """Exact value of one node from those of its arguments."""
    if node.op == "input":
        return inputs[node.value]
    if node.op in ("const", "let"):
        return node.value
    return node.value.at(*args) if node.op == "filled" else FUNCTION_OF[node.op](*args)


def build(
    expressions: Sequence[sp.Expr],
    inputs: Sequence[sp.Symbol],
    *,
    share: bool = True,
    lets: Sequence[tuple[sp.Symbol, sp.Expr]] = (),
) -> Graph:
    """The graph of expressions that are already in their safe form.

    share : multiples of one angle from one sincos; otherwise each angle by itself
    lets  : named values in order; expressions and later values may contain their symbols
    Raises UnknownSymbolError (a symbol that is no input) or DomainError (no counterpart in code).
    """
    builder = Builder(tuple(inputs))
    if share:
        builder.collect([*(form for _, form in lets), *expressions])
    for name, form in lets:
        builder.known[name] = builder.put("let", builder.visit(sp.sympify(form, strict=True)), value=name)
    roots = tuple(builder.visit(sp.sympify(e, strict=True)) for e in expressions)
    return pruned(Graph(tuple(inputs), tuple(builder.nodes), roots))


def pruned(graph: Graph) -> Graph:
    """The graph without operations that no result needs."""
    needed = set(graph.roots)
    for place in reversed(range(len(graph.nodes))):
        if place in needed:
            needed.update(graph.nodes[place].args)
    new = {place: k for k, place in enumerate(sorted(needed))}
    nodes = tuple(replace(graph.nodes[place], args=tuple(new[a] for a in graph.nodes[place].args)) for place in new)
    names = {new[place]: name for place, name in graph.names.items() if place in new}
    return Graph(graph.inputs, nodes, tuple(new[root] for root in graph.roots), names)


class Builder:
    """Nodes under construction; equal operations are found in ``place``."""

    def __init__(self, inputs: tuple[sp.Symbol, ...]):
        self.inputs = {symbol: i for i, symbol in enumerate(inputs)}
        self.nodes: list[Node] = []
        self.place: dict[Node, int] = {}
        self.known: dict[sp.Basic, int] = {}
        self.steps: dict[sp.Expr, sp.Rational] = {}  # direction of an angle -> common step

    def put(self, op: str, *args: int, value: Any = None) -> int:
        """The place of an operation, an old one when it is already there."""
        node = Node(op, args, value)
        if node not in self.place:
            self.place[node] = len(self.nodes)
            self.nodes.append(node)
        return self.place[node]

    def visit(self, e: sp.Expr) -> int:
        """Place of an expression."""
        if e not in self.known:
            self.known[e] = self.node(e)
        return self.known[e]

    def node(self, e: sp.Expr) -> int:
        """Place of an expression that was not met before."""
        if isinstance(e, sp.Symbol):
            if e not in self.inputs:
                raise UnknownSymbolError(f"expected only the inputs; got {e.name}; list it as one")
            return self.put("input", value=self.inputs[e])
        if e.is_number and e.is_real:
            return self.number(e)
        if isinstance(e, sp.Add):
            return self.sum(e)
        if isinstance(e, sp.Mul):
            return self.product(e)
        if isinstance(e, sp.Pow):
            return self.power(e.base, e.exp)
        if isinstance(e, (sp.sin, sp.cos)):
            return self.circular(e)
        if isinstance(e, filled):
            return self.put("filled", self.visit(e.args[2]), value=part_of(e))
        if type(e) in UNARY:
            return self.put(UNARY[type(e)], self.visit(e.args[0]))
        if type(e) in BINARY:
            return reduce(lambda x, y: self.put(BINARY[type(e)], x, y), [self.visit(a) for a in e.args])
        raise DomainError(f"expected functions that code has; got {type(e).__name__}; rewrite the formula")

    def number(self, e: sp.Expr) -> int:
        """A constant; a negative one is the negation of a positive one."""
        if e.is_negative:
            return self.put("neg", self.put("const", value=-e))
        return self.put("const", value=e)

    # -- sums, products, powers ---------------------------------------

    def sum(self, e: sp.Add) -> int:
        """Positive terms first, then differences; a sum of negative terms is negated as a whole."""
        terms = list(e.as_ordered_terms())
        plus = [t for t in terms if not t.could_extract_minus_sign()]
        minus = [-t for t in terms if t.could_extract_minus_sign()]
        if not plus:
            return self.put("neg", self.chain("add", minus))
        return self.chain("sub", minus, self.chain("add", plus))

    def chain(self, op: str, terms: Sequence[sp.Expr], start: int | None = None) -> int:
        """The node of terms joined by an operation from the left, behind the node ``start`` if there is one."""
        places = [self.visit(term) for term in terms]
        if start is not None:
            places.insert(0, start)
        return reduce(lambda x, y: self.put(op, x, y), places)

    def product(self, e: sp.Mul) -> int:
        """One quotient: numerator over denominator; a dyadic coefficient scales the numerator exactly."""
        coefficient, rest = e.as_coeff_Mul()
        above: list[int] = []
        below: list[int] = []
        for factor in rest.as_ordered_factors() if isinstance(rest, sp.Mul) else [rest]:
            base, exponent = factor.as_base_exp()
            if exponent.is_Rational and exponent < 0:
                below.append(self.power(base, -exponent))
            else:
                above.append(self.visit(factor))
        size = abs(coefficient)
        # By p/2^k with small p one multiplies, with one rounding at most, and need not divide.
        whole = not size.is_Rational or size.q & (size.q - 1) == 0
        scale, divisor = (size, sp.S.One) if whole else (size.p, sp.Integer(size.q))
        if scale != 1 or not above:
            above.insert(0, self.number(sp.sympify(scale, strict=True)))
        if divisor != 1:
            below.insert(0, self.number(divisor))
        result = self.times(above)
        if below:
            result = self.put("div", result, self.times(below))
        return self.put("neg", result) if coefficient.is_negative else result

    def times(self, places: Sequence[int]) -> int:
        """The node of the product of nodes, from the left."""
        return reduce(lambda x, y: self.put("mul", x, y), places)

    def power(self, base: sp.Expr, exponent: sp.Expr) -> int:
        """A power: products for whole exponents, the square root for halves, ``pow`` otherwise."""
        if base is sp.E:
            return self.put("exp", self.visit(exponent))
        if exponent.is_Rational and exponent < 0:
            return self.put("div", self.number(sp.S.One), self.power(base, -exponent))
        if exponent.is_Integer:
            return self.whole_power(self.visit(base), int(exponent))
        if exponent.is_Rational and exponent.q == 2:
            return self.whole_power(self.put("sqrt", self.visit(base)), int(exponent.p))
        return self.put("pow", self.visit(base), self.visit(exponent))

    def whole_power(self, x: int, n: int) -> int:
        """The node of x^n, n at least 1, by repeated squaring."""
        return raise_by_squaring(x, n, lambda a, b: self.put("mul", a, b))

    # -- angles ---------------------------------------

    def collect(self, expressions: Sequence[sp.Expr]) -> None:
        """Find the directions whose multiples occur more than once, and their common step."""
        found: dict[sp.Expr, set[sp.Rational]] = {}
        for e in expressions:
            for node in sp.sympify(e, strict=True).atoms(sp.sin, sp.cos):
                coefficient, direction = direction_of(node.args[0])
                found.setdefault(direction, set()).add(abs(coefficient))
        for direction, coefficients in found.items():
            step = common_step(coefficients)
            if len(coefficients) > 1 and max(coefficients) / step <= MULTIPLES:
                self.steps[direction] = step

    def circular(self, e: sp.Expr) -> int:
        """sin or cos, from the shared base angle where there is one."""
        name = UNARY[type(e)]
        coefficient, direction = direction_of(e.args[0])
        sign = -1 if coefficient < 0 else 1
        step = self.steps.get(direction, abs(coefficient))
        angle = self.visit(sp.expand(step * direction) if direction.is_Add else step * direction)
        result = self.of_multiple(name, angle, int(abs(coefficient) / step))
        return self.put("neg", result) if sign < 0 and name == "sin" else result

    def of_multiple(self, name: str, angle: int, n: int) -> int:
        """sin(n x) or cos(n x) by doubling and addition from sin x and cos x."""
        if n == 1:
            return self.put(name, angle)
        if n % 2 == 0:
            s = self.of_multiple("sin", angle, n // 2)
            two = self.number(sp.Integer(2))
            if name == "sin":
                return self.put("mul", self.put("mul", two, s), self.of_multiple("cos", angle, n // 2))
            return self.put("sub", self.number(sp.S.One), self.put("mul", two, self.put("mul", s, s)))
        a, b = (n + 1) // 2, n // 2
        sa, ca, sb, cb = (self.of_multiple(f, angle, k) for k in (a, b) for f in ("sin", "cos"))
        if name == "sin":
            return self.put("add", self.put("mul", sa, cb), self.put("mul", ca, sb))
        return self.put("sub", self.put("mul", ca, cb), self.put("mul", sa, sb))


def direction_of(angle: sp.Expr) -> tuple[sp.Rational, sp.Expr]:
    """(coefficient, direction) with the direction in a normal sign and size."""
    if isinstance(angle, sp.Add):
        coefficient, direction = angle.primitive()
    else:
        coefficient, direction = angle.as_coeff_Mul()
    if direction.could_extract_minus_sign():
        coefficient, direction = -coefficient, -direction
    return (coefficient, direction) if coefficient.is_Rational else (sp.S.One, angle)
