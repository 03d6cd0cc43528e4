"""The fast twin of the ball analysis: exact values and rounding bounds at many points at once.

Sums, products and quotients run in :mod:`tests.attacks.points.bands`; every other operation runs through the very
functions of :mod:`navsym.export.accuracy.rounding` and :mod:`navsym.core.balls`, entry by entry. Whatever two doubles
do not decide (a value that cancels below its error, a denominator that comes near its own error) is left open and
goes to the balls. A bound that is returned differs from that of the balls by less than SLACK of itself, which the
tests hold on every ready-made function; what is accepted with that much to spare is therefore accepted by the balls,
too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp
from flint import arb

from navsym.core.balls import OPERATIONS, Tape, enclose, precision
from navsym.export.accuracy.continuation import filled_bounds
from navsym.export.accuracy.rounding import Arithmetic, Bounded, factor, rounded
from navsym.export.accuracy.vectors import tapes
from navsym.export.expression_graph import Node
from navsym.export.parts import Piece
from tests.attacks.points.bands import (
    BITS,
    UP,
    Array,
    Band,
    Flags,
    added,
    ball_of,
    constant,
    divided,
    exactly,
    multiplied,
    negated,
    parts_of,
    through_balls,
    upper,
    whole_power,
)

SLACK = 2.0**-10
KNOWN = 2.0**-40  # a value is known when its error is below this part of it


@dataclass(frozen=True, slots=True, eq=False)
class Rounded:
    """A node at many points: exact value, and bounds of the absolute and relative error of the computed one.

    doubt : entries whose bounds are not settled
    """

    value: Band
    absolute: Array
    relative: Array
    doubt: Flags


# -- exact values of the formulas ---------------------------------------


def formula_values(piece: Piece, columns: Sequence[Array]) -> list[Band]:
    """The formulas of the claim at points, named values first; one column for each input."""
    named = {symbol: exactly(x) for symbol, x in zip(piece.graph.inputs, columns, strict=True)}
    known: Known = {}
    lets, formulas = tapes(piece)
    for (name, _, _), flattened in zip(piece.lets, lets, strict=True):
        named[name] = run(flattened, named, known)
    return [run(flattened, named, known) for flattened in formulas]


#: (operation, constant, numbers of the arguments) -> number and value of what was computed before.
Known = dict[tuple[str, Any, tuple[int, ...]], tuple[int, "Band | arb"]]


def run(flattened: Tape, named: dict[sp.Symbol, Band], known: Known) -> Band:
    """Value of a flattened expression over bands; what is constant is a ball until it meets a band."""
    done: list[tuple[int, Band | arb]] = []
    for step in flattened.steps:
        args = [done[i] for i in step.arguments]
        key = (step.operation, step.constant, tuple(number for number, _ in args))
        if key not in known:
            known[key] = (len(known), instruction(step.operation, step.constant, [value for _, value in args], named))
        done.append(known[key])
    return as_band(done[-1][1])


def as_band(value: Band | arb) -> Band:
    """A ball as a band; bands as they are."""
    return value if isinstance(value, Band) else constant(value)


def instruction(operation: str, value: Any, args: list[Band | arb], named: dict[sp.Symbol, Band]) -> Band | arb:
    """One operation: of balls in balls, of bands in bands where they have it and through balls otherwise."""
    if operation == "symbol":
        return named[value]
    if all(isinstance(a, arb) for a in args):
        with precision(BITS):
            return arb(OPERATIONS[operation](value, args, {}))
    bands = [as_band(a) for a in args]
    if operation in ("add", "mul"):
        return folded(added if operation == "add" else multiplied, bands)
    if operation == "power":
        return whole_power(bands[0], value)
    return through_balls(lambda *balls: arb(OPERATIONS[operation](value, list(balls), {})), *bands)


def folded(operation: Callable[[Band, Band], Band], args: list[Band]) -> Band:
    """Several bands joined by an operation of two, from the left."""
    result = args[0]
    for other in args[1:]:
        result = operation(result, other)
    return result


# -- rounding bounds of the graph ---------------------------------------


def rounding_bounds(piece: Piece, columns: Sequence[Array], arithmetic: Arithmetic) -> tuple[list[Array], Flags]:
    """Bounds of the error of every result, and the points where they are not settled."""
    done: list[Rounded] = []
    zero = np.zeros(1)
    for node, literal in zip(piece.graph.nodes, piece.literals, strict=True):
        if node.op == "input":
            done.append(Rounded(exactly(columns[node.value]), zero, zero, zero > 0))
        elif node.op == "const":
            done.append(literal_error(node.value, literal))
        else:
            done.append(settled(node_bounds(node, [done[a] for a in node.args], arithmetic)))
    doubt: Flags = np.zeros(len(columns[0]) if columns else 1, dtype=bool)
    for known in done:
        doubt = doubt | known.doubt
    return [done[root].absolute for root in piece.graph.roots], doubt


def literal_error(value: Any, literal: Any) -> Rounded:
    """A constant with the error of the number in the code, which stands for it."""
    with precision(BITS):
        exact = enclose(value, {}, BITS)
        error = upper(abs(exact - arb(literal)))
    size = abs(float(exact.mid()))
    relative = error / size if size else (np.inf if error else 0.0)
    return Rounded(constant(exact), np.full(1, error), np.full(1, relative * UP), np.zeros(1, dtype=bool))


def settled(node: Rounded) -> Rounded:
    """In doubt as well where the value is known neither to KNOWN of itself nor of the error that is carried anyway."""
    known = node.value.error <= KNOWN * node.value.size()
    below = ~known & (node.value.error <= KNOWN * node.absolute)
    return Rounded(node.value, node.absolute, np.where(below, np.inf, node.relative), node.doubt | ~(known | below))


def node_bounds(node: Node, args: list[Rounded], arithmetic: Arithmetic) -> Rounded:
    """Value and bounds of one operation, by the ball analysis where it has no formula here."""
    if node.op in CARRIED:
        value, absolute, relative, doubt = CARRIED[node.op](*args)
        return with_own_rounding(node.op, value, absolute, relative, doubt, arithmetic)
    return by_the_balls(node, args, arithmetic)


def with_own_rounding(
    op: str, value: Band, absolute: Array, relative: Array, doubt: Flags, arithmetic: Arithmetic
) -> Rounded:
    """What the arguments bring and the operation's own rounding, each bound tightened by the other."""
    size, k = value.size(), factor(op, arithmetic) * 2.0**arithmetic.u
    absolute, relative = tightened(size, absolute, relative)
    if k == 0:
        return Rounded(value, absolute, relative, doubt)
    absolute = np.where(size + absolute < 0.99 * 2.0**arithmetic.top, absolute, np.inf)  # it may overflow
    relative = np.where(np.isfinite(absolute), relative, np.inf)
    eta = 0.0 if op in ("add", "sub") else 2.0 ** max(arithmetic.eta, -1074)
    own = (absolute + k * (size + absolute) + eta) * UP
    relative = (relative + k * (1 + relative) + ratio(np.full(1, eta), size)) * UP
    return Rounded(value, *tightened(size, own, relative), doubt)


def tightened(size: Array, absolute: Array, relative: Array) -> tuple[Array, Array]:
    """Absolute and relative bound, each lowered by what the other implies for values of this size."""
    absolute, relative = sane(absolute), sane(relative)
    implied = np.where(np.isfinite(relative), np.where(np.isfinite(relative), relative, 0.0) * size * UP, np.inf)
    absolute = np.minimum(absolute, implied)
    return absolute, np.minimum(relative, ratio(absolute, size))


def ratio(error: Array, size: Array) -> Array:
    """error / size rounded up; zero where there is no error, infinite where the size is zero."""
    found = np.where(size > 0, error / np.where(size > 0, size, 1.0) * UP, np.inf)
    return np.where(error == 0, 0.0, sane(found))


def sane(bound: Array) -> Array:
    """The bound; infinite where it is no finite number."""
    return np.where(np.isfinite(bound), bound, np.inf)


# -- what the arguments bring ---------------------------------------

Carried = tuple[Band, Array, Array, Flags]


def carried_sum(a: Rounded, b: Rounded) -> Carried:
    """a + b: absolute errors add, a relative bound only where both have one sign."""
    value = added(a.value, b.value)
    same = np.sign(a.value.high) * np.sign(b.value.high) >= 0
    relative = np.where(same, np.maximum(a.relative, b.relative), np.inf)
    return value, (a.absolute + b.absolute) * UP, relative, a.doubt | b.doubt


def carried_difference(a: Rounded, b: Rounded) -> Carried:
    """a - b as the sum of a and -b."""
    return carried_sum(a, Rounded(negated(b.value), b.absolute, b.relative, b.doubt))


def carried_product(a: Rounded, b: Rounded) -> Carried:
    """a b: ``|a| db + |b| da + da db``, and the same of relative errors; zero where both are exact."""
    value, x, y = multiplied(a.value, b.value), a.value.size(), b.value.size()
    absolute = (x * b.absolute + y * a.absolute + a.absolute * b.absolute) * UP
    relative = (a.relative + b.relative + a.relative * b.relative) * UP
    none = (a.absolute == 0) & (b.absolute == 0)
    return value, np.where(none, 0.0, absolute), np.where(none, 0.0, relative), a.doubt | b.doubt


def carried_quotient(a: Rounded, b: Rounded) -> Carried:
    """A denominator whose error is within a factor two of itself is left to the balls."""
    value = divided(a.value, b.value)
    doubt = (b.relative > 0.5) & (b.relative < 2)
    less = np.where(b.relative <= 0.5, b.relative, 0.0)
    absolute = (a.absolute + value.size() * b.absolute) / np.where(b.value.size() > 0, b.value.size() * (1 - less), 1.0)
    none = (a.absolute == 0) & (b.absolute == 0)
    good = b.relative <= 0.5
    absolute = np.where(none, 0.0, np.where(good, absolute * UP, np.inf))
    relative = np.where(none, 0.0, np.where(good, (a.relative + less) / (1 - less) * UP, np.inf))
    return value, absolute, relative, a.doubt | b.doubt | doubt


def carried_negation(a: Rounded) -> Carried:
    """-a, which changes no error."""
    return negated(a.value), a.absolute, a.relative, a.doubt


CARRIED: dict[str, Callable[..., Carried]] = {
    "add": carried_sum,
    "sub": carried_difference,
    "mul": carried_product,
    "div": carried_quotient,
    "neg": carried_negation,
}


def by_the_balls(node: Node, args: list[Rounded], arithmetic: Arithmetic) -> Rounded:
    """Any other operation: the rule of the ball analysis itself, point by point."""
    columns = [x for a in args for x in (a.value.high, a.value.low, a.value.error, a.absolute, a.relative)]
    rows = zip(*(x.tolist() for x in np.broadcast_arrays(*columns, np.zeros(1))[:-1]), strict=True)
    doubt: Flags = np.zeros(1, dtype=bool)
    for a in args:
        doubt = doubt | a.doubt
    with precision(BITS):
        found = [row_bounds(node, row, arithmetic) for row in rows]
    high, low, error, absolute, relative = (np.array(column) for column in zip(*found, strict=True))
    return Rounded(Band(high, low, error), absolute, relative, doubt)


def row_bounds(node: Node, row: tuple[float, ...], arithmetic: Arithmetic) -> tuple[float, ...]:
    """One operation at one point by the ball analysis: high, low, error of the value, absolute and relative bound.

    row : the same five numbers of every argument. All is nan and infinite where an argument is not finite
    """
    args = []
    for k in range(0, len(row), 5):
        high, low, error, absolute, relative = row[k : k + 5]
        args.append(Bounded(ball_of(high, low, error), arb(absolute), arb(relative), arb("inf")))
    if any(not a.value.is_finite() for a in args):
        return float("nan"), float("nan"), float("inf"), float("inf"), float("inf")
    found = rounded(node, args, arithmetic, filled_bounds)
    return (*parts_of(found.value), bound_of(found.absolute), bound_of(found.relative))


def bound_of(x: arb) -> float:
    """A bound as a double above it; infinite where the ball is not finite."""
    return upper(x) if x.is_finite() else float("inf")
