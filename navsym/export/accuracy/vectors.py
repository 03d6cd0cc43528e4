"""Test vectors: points of the domain with rigorous enclosures, widened by the derived rounding error.

Points are edges, places near zero, logarithmic and random ones, the same for the same function name.
Every enclosure is a ball around the exact formula of the claim (not of the graph), so that a wrong
graph, a wrong printer and a wrong compiler all fall outside.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from flint import arb

from navsym.core.balls import Tape, enclose, precision, tape
from navsym.export.accuracy.continuation import analyse, continuation
from navsym.export.accuracy.rounding import BITS, INFINITE, Arithmetic, Bounded, float_above
from navsym.export.expression_graph import Node
from navsym.export.parts import ExportedFunction, Piece

OK, DOMAIN, NOT_FINITE = 0, 1, 2
MORE_BITS = (512, 2048)
SHARP = 2.0**-10  # radius of an enclosure, as a part of the error bound that it is widened by
LARGEST = {"double": 2.0**1000, "float": 2.0**120}


@dataclass(frozen=True, slots=True)
class Vector:
    """One call: arguments, expected status, and for status 0 the bounds of every result.

    nearest : the double nearest to the exact value
    """

    inputs: tuple[float, ...]
    status: int
    lower: tuple[float, ...] = ()
    upper: tuple[float, ...] = ()
    nearest: tuple[float, ...] = ()


def vectors(function: ExportedFunction, count: int = 48, *, library: int = 1, widen: int = 1) -> list[Vector]:
    """About ``count`` vectors inside the domain, and those that must be refused.

    library : accuracy of the target's sin, cos, exp, … in ulps
    widen   : factor on the rounding error, for code whose order of operations is not ours
    """
    arithmetic = replace(function.arithmetic, library=library)
    found: list[Vector] = []
    for point in points(function, 3 * count):
        vector = vector_at(function, point, arithmetic, widen)
        if vector is not None:
            found.append(vector)
        if len(found) >= count:
            break
    return [*found, *refused(function)]


def vector_at(
    function: ExportedFunction, point: Sequence[float], arithmetic: Arithmetic, widen: int = 1
) -> Vector | None:
    """Enclosures at one point; None where the formula is undefined, overflows or has no error bound."""
    piece = piece_at(function, point)
    with precision(BITS):
        balls = [arb(x) for x in point]
        found = analysed(piece, balls, arithmetic)
        errors = [result.absolute for result in found]
        exact = fill_holes(piece, sharp_values(piece, balls, errors), found)
        ends = [outward_ends(value, error * widen) for value, error in zip(exact, errors, strict=True)]
    if any(end is None for end in ends):
        return None
    lower, upper, nearest = zip(*(end for end in ends if end is not None), strict=True)
    if max(map(abs, (*lower, *upper))) > LARGEST[function.arithmetic.name]:
        return None
    return Vector(tuple(point), OK, lower, upper, nearest)


def sharp_values(piece: Piece, balls: Sequence[arb], errors: Sequence[arb]) -> list[arb]:
    """The formulas at a point with as many bits as it takes: where one cancels, a wide ball would accept anything."""
    exact = exact_values(piece, balls)
    for bits in MORE_BITS:
        pairs = zip(exact, errors, strict=True)
        if all(x.is_finite() and x.rad() <= SHARP * (abs(x) * 2.0**-53 + error).upper() for x, error in pairs):
            break
        with precision(bits):
            exact = exact_values(piece, balls, bits)
    return exact


def exact_values(piece: Piece, balls: Sequence[arb], bits: int = BITS) -> list[arb]:
    """The formulas of the claim at a point, named values first."""
    named = dict(zip(piece.graph.inputs, balls, strict=True))
    lets, formulas = tapes(piece)
    for (name, _, _), flattened in zip(piece.lets, lets, strict=True):
        named[name] = enclose(flattened, named, bits)
    return [enclose(t, named, bits) for t in formulas]


def fill_holes(piece: Piece, exact: Sequence[arb], found: Sequence[Bounded]) -> list[arb]:
    """The formulas, and in a hole of one of them the graph's value, which is proved to be the formula around it."""
    proved = piece.tie != "enclosures"
    return [r.value if proved and not x.is_finite() else x for x, r in zip(exact, found, strict=True)]


@cache
def tapes(piece: Piece) -> tuple[list[Tape], list[Tape]]:
    """Flattened named values and formulas of a piece, made once."""
    return [tape(f) for _, f, _ in piece.lets], [tape(f) for f in piece.formulas]


def analysed(piece: Piece, balls: Sequence[arb], arithmetic: Arithmetic) -> list[Bounded]:
    """Exact values and error bounds of the graph's results; no bounds where a guard is not finite."""
    done = analyse(piece.graph, balls, arithmetic, piece.literals)
    found = [done[root] for root in piece.graph.roots]
    kept = all(done[guard].absolute.is_finite() for guard in piece.graph.guards)
    return found if kept else [replace(result, absolute=INFINITE) for result in found]


def outward_ends(value: arb, error: arb) -> tuple[float, float, float] | None:
    """(lower, upper, nearest) as doubles, rounded outwards."""
    if not (value.is_finite() and error.is_finite()):
        return None
    wide = value + arb(0, error)
    return 0.0 - float_above(-wide), float_above(wide), float(value.mid())


def piece_at(function: ExportedFunction, point: Sequence[float]) -> Piece:
    """The piece that the code takes at a point."""
    if function.switch is not None:
        for piece in function.pieces:
            if piece.limit is None or point[function.switch] <= piece.limit:
                return piece
    return function.pieces[-1]


def points(function: ExportedFunction, count: int) -> Iterator[tuple[float, ...]]:
    """Points of the domain: every edge first, then near-singular and random ones."""
    generator = random.Random(function.name)
    if not function.inputs:
        yield ()
        return
    edges = [edge_values(function, k) for k in range(len(function.inputs))]
    middle = [(i.test_low + i.test_high) / 2 for i in function.inputs]
    for k, values in enumerate(edges):
        for value in values[: max(4, count // (4 * len(edges)))]:
            others = sample_all(function, generator) if generator.random() < 0.7 else list(middle)
            others[k] = value
            yield cast(function, others)
    for _ in range(count):
        yield cast(function, sample_all(function, generator))


def edge_values(function: ExportedFunction, k: int) -> list[float]:
    """Ends of the range, the limits of the regimes and their neighbours, and numbers near zero."""
    i = function.inputs[k]
    step = next_float(function)
    values = [i.test_low, i.test_high]
    if function.switch == k:
        limits = [piece.limit for piece in function.pieces if piece.limit is not None]
        values += [x for limit in limits for x in (limit, step(limit, math.inf), step(limit, -math.inf))]
    values += [x for s in sorted(switches(function, k)) for t in (s, step(s, 0.0), s / 2) for x in (t, -t)]
    values += [1e-7, 1e-3, 1e-9, 0.0, -1e-5, 1.0, -1.0, 1e-30, -1e-160]
    return [x for x in values if i.test_low <= x <= i.test_high]


def switches(function: ExportedFunction, k: int) -> set[float]:
    """Where the code changes from a polynomial to a formula in one argument."""
    graphs, i = [piece.graph for piece in function.pieces], Node("input", (), k)
    parts = {n.value for g in graphs for n in g.nodes if n.op == "filled" and g.nodes[n.args[0]] == i}
    return {continuation(part, function.arithmetic.name).switch for part in parts}


def next_float(function: ExportedFunction):  # type: ignore[no-untyped-def]
    """The function (x, to) -> the number of the function's type next to x towards ``to``."""
    kind = np.float32 if function.arithmetic.name == "float" else np.float64

    def step(x: float, to: float) -> float:
        with np.errstate(over="ignore"):  # behind the largest number comes infinity
            return float(np.nextafter(kind(x), kind(to)))

    return step


def sample_all(function: ExportedFunction, generator: random.Random) -> list[float]:
    """A number for each input."""
    return [sample(i.test_low, i.test_high, generator) for i in function.inputs]


def sample(low: float, high: float, generator: random.Random) -> float:
    """Uniform, or logarithmic towards the end that is nearest to zero."""
    if low > 0 and generator.random() < 0.4:
        return math.exp(generator.uniform(math.log(max(low, 1e-6 * min(1.0, high))), math.log(high)))
    if low < 0 < high and generator.random() < 0.3:
        sign = generator.choice((-1, 1))
        return sign * min(-low, high) * 10 ** generator.uniform(-6, 0)
    return 2 * generator.uniform(low / 2, high / 2)  # the width of a range may be infinite


def cast(function: ExportedFunction, point: Sequence[float]) -> tuple[float, ...]:
    """Numbers of the type, inside the accepted range."""
    if function.arithmetic.name == "float":
        point = [float(np.float32(x)) for x in point]
    return tuple(min(max(x, i.test_low), i.test_high) for x, i in zip(point, function.inputs, strict=True))


def refused(function: ExportedFunction) -> list[Vector]:
    """Calls that must come back with a status: NaN, infinities, and just outside the domain."""
    found = []
    middle = [(i.test_low + i.test_high) / 2 for i in function.inputs]
    step = next_float(function)
    for k, i in enumerate(function.inputs):
        outside = [math.nan, math.inf, -math.inf]
        outside += [step(i.low, -math.inf)] if math.isfinite(i.low) else []
        outside += [step(i.high, math.inf)] if math.isfinite(i.high) else []
        for value in outside:
            point = list(cast(function, middle))
            point[k] = value
            found.append(Vector(tuple(point), DOMAIN))
    return found
