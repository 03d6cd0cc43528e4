"""Parts with a hole at zero in code: a Taylor polynomial below a switch and the plain form above it, both proved.

For b with a zero of order v at the origin (:mod:`navsym.export.holes`) let g(t) = b(t)/t^k, k = 0 or v. By Taylor and
Lagrange, with P the first terms of b(t)/t^v (exact rational numbers) and N the order of the first term left out,

    |b(t)/t^v - P(t)| <= |t|^(N - v) max |b^(N)(s)/N!|,   |s| <= |t|,

where the maximum is enclosed by power series of balls over the whole interval; the derivative in the same way. The
switch is the largest power of two up to 1 for which few terms leave a remainder far below the rounding error. Code
below it is t^(v-k) P(t) by Horner's rule, above it b(t) divided by t k times. :func:`analyse` follows a whole graph:
operations by their own bounds, such parts by those of their branches.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, reduce
from typing import Any

import sympy as sp
from flint import arb, arb_series, fmpq

from navsym.core.balls import Tape, precision, series_terms, tape
from navsym.core.errors import DomainError
from navsym.export.accuracy.rounding import (
    ARITHMETICS,
    INFINITE,
    Arithmetic,
    Bounded,
    down,
    followed,
    literals_of,
    ratio,
    sane,
    tightened,
    up,
)
from navsym.export.expression_graph import Builder, Graph, pruned
from navsym.export.holes import Part, T
from navsym.export.series import taylor

BITS = 160
MOST_TERMS = 18  # that are not zero
SWITCHES = tuple(2.0**-k for k in range(7))
MARGIN = 1 + 2.0**-6  # the polynomial is proved a little beyond the switch, for arguments with a rounding error
SHARE = 2.0**-6  # remainder, as a part of u times the least value
CELLS = 16


@dataclass(frozen=True, slots=True, eq=False)
class Continuation:
    """What is known of the code of one part.

    power        : v - k
    polynomial   : Taylor coefficients of b/t^v
    switch       : below it the code is t^power times the polynomial
    below, above : operations of both branches, with t as input; literals: numbers in the second
    quotient     : b/t^k
    remainder    : bound of |b/t^v - polynomial| up to the switch and MARGIN
    near         : relative error of the code below the switch, underflow aside, in units of u
    slope        : bound of the derivative of b/t^v there
    least, most  : bounds of |b/t^v| there
    """

    power: int
    polynomial: tuple[fmpq, ...]
    switch: float
    below: Graph
    above: Graph
    literals: tuple[float | None, ...]
    quotient: Tape
    remainder: arb
    near: arb
    slope: arb
    least: arb
    most: arb

    def value(self, t: arb) -> arb:
        """b(t)/t^k in a ball up to the switch and MARGIN."""
        return t**self.power * (horner(self.polynomial, t) + arb(0, self.remainder))


@lru_cache(maxsize=256)
def continuation(part: Part, real: str) -> Continuation:
    """The branches of a part for double or float; DomainError when no switch is proved."""
    with precision(BITS):
        for switch in SWITCHES:
            found = at_switch(part, switch, ARITHMETICS[real])
            if found is not None:
                return found
    wanted = f"expected a formula that is smooth around zero; got {part.formula}"
    raise DomainError(f"{wanted}; keep zero out of the range")


def at_switch(part: Part, switch: float, arithmetic: Arithmetic) -> Continuation | None:
    """The branches with this switch; None when the remainder takes too many terms."""
    v, reach = part.order, arb(switch) * MARGIN
    exact = taylor(part.plain, T, v + 2 * MOST_TERMS)[v:]
    for terms in range(1, 2 * MOST_TERMS - 2):
        if sum(c != 0 for c in exact[:terms]) > MOST_TERMS:
            return None
        if exact[terms] == 0:
            continue  # one more term costs nothing
        remainder = lagrange(tape(part.plain), v + terms, reach) * reach**terms
        least = min((down(horner(exact[:terms], cell)) for cell in cells(-reach, reach)), key=float) - remainder
        if remainder < least * SHARE * arithmetic.unit():
            return proved(part, exact[:terms], switch, arithmetic, remainder, least)
    return None


def lagrange(formula: Tape, n: int, reach: arb) -> arb:
    """max |f^(n)/n!| over [-reach, reach], in cells."""
    worst = arb(0)
    with series_terms(n + 1):
        for cell in cells(-reach, reach):
            value = formula.run({T: arb_series([cell, arb(1)], n + 1)})[n]
            if not value.is_finite():
                return INFINITE
            worst = worst.max(up(value))
    return worst


def cells(low: arb, high: arb) -> list[arb]:
    """The interval from low to high cut in :data:`CELLS` balls that cover it."""
    ends = [low + (high - low) * k / CELLS for k in range(CELLS + 1)]
    return [a.union(b) for a, b in itertools.pairwise(ends)]


def horner(polynomial: Sequence[Any], t: Any) -> Any:
    """The polynomial at a ball, or at whatever can be multiplied; lowest coefficient first."""
    total = 0 * t
    for coefficient in reversed(polynomial):
        total = total * t + coefficient
    return total


def proved(
    part: Part, polynomial: tuple[fmpq, ...], switch: float, arithmetic: Arithmetic, remainder: arb, least: arb
) -> Continuation:
    """The branches, with the rounding error of the first and a bound of its derivative."""
    v, reach, terms = part.order, arb(switch) * MARGIN, len(polynomial)
    moved = T * sp.diff(part.plain, T) - v * part.plain  # t^(v+1) times the derivative of b/t^v
    rest = lagrange(tape(moved), v + terms, reach) * reach ** (terms - 1)
    derived = [k * c for k, c in enumerate(polynomial)][1:]
    slope = max((up(horner(derived, cell)) for cell in cells(-reach, reach)), key=float) + rest
    sums = polynomial_graph(polynomial, 0)
    literals, unit = literals_of(sums, arithmetic), arithmetic.unit()
    found = [followed(sums, [cell], arithmetic, literals)[sums.roots[0]] for cell in cells(-arb(switch), arb(switch))]
    rounding = max((one.relative for one in found), key=float)
    power = v - part.divided
    near = (rounding + remainder / least) / unit * (1 + 8 * unit) + 2 * power
    most = max((up(horner(polynomial, cell)) for cell in cells(-reach, reach)), key=float) + remainder
    above, quotient = plain_graph(part), tape(part.plain / T**part.divided)
    return Continuation(
        power,
        polynomial,
        switch,
        polynomial_graph(polynomial, power),
        above,
        literals_of(above, arithmetic),
        quotient,
        remainder,
        near,
        slope,
        least,
        most,
    )


def polynomial_graph(polynomial: Sequence[fmpq], power: int) -> Graph:
    """t^power P(t) by Horner's rule, in t^2 where only even powers occur."""
    builder = Builder((T,))
    t = builder.put("input", value=0)
    even = len(polynomial) > 1 and not any(polynomial[1::2])
    y, chosen = (builder.put("mul", t, t), polynomial[::2]) if even else (t, polynomial)
    total: int | None = None
    for coefficient in reversed(chosen):
        total = None if total is None else builder.put("mul", y, total)
        if coefficient != 0 or total is None:
            size = builder.put("const", value=sp.Rational(abs(int(coefficient.p)), int(coefficient.q)))
            if total is None:
                total = builder.put("neg", size) if coefficient < 0 else size
            else:
                total = builder.put("sub" if coefficient < 0 else "add", total, size)
    assert total is not None, "a polynomial has a first coefficient"
    if power:
        total = builder.put("mul", builder.whole_power(t, power), total)
    return pruned(Graph((T,), tuple(builder.nodes), (total,)))


def plain_graph(part: Part) -> Graph:
    """b(t), divided by t as often as it takes: no power of t overflows."""
    builder = Builder((T,))
    t = builder.put("input", value=0)
    root = builder.visit(part.formula)
    for _ in range(part.divided):
        root = builder.put("div", root, t)
    return pruned(Graph((T,), tuple(builder.nodes), (root,)))


# -- values and rounding bounds: those of the branch, or the branches, that the code may take -----------------------

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
    inside, outside = zones(known, a.value + arb(0, a.absolute))
    exact = zones(known, a.value)
    values = [outside_bounds(known, t, arithmetic).value for t in exact[1]]
    value = reduce(arb.union, [*map(known.value, exact[0]), *values])
    own = [inside_rounding(known, t, arithmetic) for t in inside]
    own += [(f.absolute, f.relative) for f in (outside_bounds(known, t, arithmetic) for t in outside)]
    absolute, relative = (reduce(arb.max, side) for side in zip(*own, strict=True))
    if a.absolute == 0:
        return tightened(value, absolute, relative, INFINITE)
    slopes = [slope_inside(known, t) for t in inside]
    slopes += [sane(known.quotient.run({T: arb_series([t, arb(1)], 2)})[1]) for t in outside]
    carried = reduce(arb.max, slopes) * a.absolute
    passed = ratio(sane(carried), value)
    if not outside:
        passed = passed.min(relative_inside(known, a))
    return tightened(value, sane(carried + absolute), sane(passed + relative * (1 + passed)), INFINITE)


def zones(known: Continuation, t: arb) -> tuple[list[arb], list[arb]]:
    """A ball cut at the switch: parts for the polynomial, with a margin beyond the switch, and for the plain form."""
    switch = arb(known.switch)
    if abs(t) < switch:
        return [t], []
    if abs(t) >= switch:
        return [], [t]
    low, high, reach = arb(t.lower()), arb(t.upper()), switch * MARGIN
    inside = low.max(-reach).union(high.min(reach))
    outside = [switch.max(low).union(high)] if high >= switch else []
    outside += [low.union((-switch).min(high))] if low <= -switch else []
    return [inside], outside


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


def outside_bounds(known: Continuation, t: arb, arithmetic: Arithmetic) -> Bounded:
    """The plain form, called with exactly t."""
    strict = replace(arithmetic, top=ARITHMETICS[arithmetic.name].top)  # an overflow in here has no status of its own
    return followed(known.above, [t], strict, known.literals)[known.above.roots[0]]
