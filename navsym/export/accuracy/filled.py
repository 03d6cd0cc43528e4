"""Values and rounding bounds of a part with a hole: those of the branch, or the branches, that the code may take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any

from flint import arb, arb_series

from navsym.export.accuracy.continuation import MARGIN, Continuation, continuation
from navsym.export.accuracy.rounding import (
    ARITHMETICS,
    INFINITE,
    Arithmetic,
    Bounded,
    followed,
    ratio,
    sane,
    tightened,
    up,
)
from navsym.export.expression_graph import Graph
from navsym.export.holes import Part, T

NOTHING = Bounded(arb("nan"), INFINITE, INFINITE, INFINITE)


def analyse(graph: Graph, inputs: Sequence[arb], arithmetic: Arithmetic, literals: Sequence[Any]) -> list[Bounded]:
    """Value and error bounds of every node over the box of the inputs, which are taken as exact.

    literals : the number that stands in the code for each constant node (None for other nodes)
    """
    return followed(graph, inputs, arithmetic, literals, filled_bounds)


def filled_bounds(part: Part, a: Bounded, arithmetic: Arithmetic) -> Bounded:
    """``exact = b(t)/t^k`` for t in a ball, and how far the code may lie from it, called with a computed t."""
    known = continuation(part, arithmetic.name)
    if not (a.value.is_finite() and a.absolute.is_finite()):
        return NOTHING
    wide = zones(known, a.value + arb(0, a.absolute))
    value = exact_value(known, zones(known, a.value), arithmetic)
    own = [inside_rounding(known, t, arithmetic) for t in wide.inside]
    own += [(f.absolute, f.relative) for f in (outside_bounds(known, t, arithmetic) for t in wide.outside)]
    absolute, relative = (reduce(arb.max, side) for side in zip(*own, strict=True))
    if a.absolute == 0:
        return tightened(value, absolute, relative, INFINITE)
    carried = (
        reduce(
            arb.max, [*(slope_inside(known, t) for t in wide.inside), *(slope_outside(known, t) for t in wide.outside)]
        )
        * a.absolute
    )
    passed = ratio(sane(carried), value)
    if not wide.outside:
        passed = passed.min(relative_inside(known, a))
    return tightened(value, sane(carried + absolute), sane(passed + relative * (1 + passed)), INFINITE)


# -- which branch ---------------------------------------


@dataclass(frozen=True, slots=True)
class Zones:
    """The parts of a ball on which the polynomial may be used, and those on which the plain form may."""

    inside: tuple[arb, ...]
    outside: tuple[arb, ...]


def zones(known: Continuation, t: arb) -> Zones:
    """A ball cut at the switch; a margin beyond it belongs to the polynomial as well."""
    switch = arb(known.switch)
    if abs(t) < switch:
        return Zones((t,), ())
    if abs(t) >= switch:
        return Zones((), (t,))
    low, high, reach = arb(t.lower()), arb(t.upper()), switch * MARGIN
    inside = low.max(-reach).union(high.min(reach))
    outside = [switch.max(low).union(high)] if high >= switch else []
    outside += [low.union((-switch).min(high))] if low <= -switch else []
    return Zones((inside,), tuple(outside))


def exact_value(known: Continuation, where: Zones, arithmetic: Arithmetic) -> arb:
    """A ball of the part's exact value on the zones, b(t)/t^k."""
    values = [known.value(t) for t in where.inside]
    values += [outside_bounds(known, t, arithmetic).value for t in where.outside]
    return reduce(arb.union, values)


# -- below the switch ---------------------------------------


def inside_rounding(known: Continuation, t: arb, arithmetic: Arithmetic) -> tuple[arb, arb]:
    """(absolute, relative) rounding error of the polynomial's code; powers of t may underflow."""
    relative, value = known.near * arithmetic.unit(), known.value(t)
    lost = arb(4 * known.power) * (1 + up(value)) * arb(2) ** arithmetic.eta
    return up(relative * up(value) + lost), sane(relative + ratio(lost, value))


def slope_inside(known: Continuation, t: arb) -> arb:
    """A bound of the derivative of t^p g."""
    p, size = known.power, up(t)
    own = size**p * known.slope
    return own if p == 0 else own + p * size ** (p - 1) * known.most


def relative_inside(known: Continuation, a: Bounded) -> arb:
    """Relative error of t^p g(t) from that of t, which need not be far from zero."""
    if not a.relative < arb("0.01"):
        return INFINITE
    inner = known.slope * a.absolute / known.least
    return sane((1 + a.relative) ** known.power * (1 + inner) - 1)


# -- above it ---------------------------------------


def outside_bounds(known: Continuation, t: arb, arithmetic: Arithmetic) -> Bounded:
    """The plain form, called with exactly t."""
    strict = replace(arithmetic, top=ARITHMETICS[arithmetic.name].top)  # an overflow in here has no status of its own
    return followed(known.above, [t], strict, known.literals)[known.above.roots[0]]


def slope_outside(known: Continuation, t: arb) -> arb:
    """A bound of the derivative of b(t)/t^k."""
    return sane(known.quotient.run({T: arb_series([t, arb(1)], 2)})[1])
