"""A descent to where an expression is low: a search in floats, which proves nothing.

What it returns is a guess; the caller evaluates it exactly.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from fractions import Fraction

import sympy as sp
from flint import arb

from navsym.proof.balls import UnsupportedError, enclose, exact_ball, tape
from navsym.proof.sampling import Range

STARTS = 16
KEPT = 3
STEPS = 400

Place = list[float]


def lowest(goal: sp.Expr, limits: dict[sp.Symbol, Range]) -> Iterator[dict[sp.Symbol, Fraction]]:
    """Places where ``goal`` is low, the lowest start first."""
    symbols = list(limits)
    maps = [stretch(limits[symbol]) for symbol in symbols]
    try:
        program = tape(goal)
    except UnsupportedError:
        return

    def value(place: Place) -> float:
        try:
            at = {s: arb(to(x)) for s, to, x in zip(symbols, maps, place, strict=True)}
            ball = enclose(program, at, 64)
        except (OverflowError, ValueError):
            return math.inf
        return float(ball.mid()) if ball.is_finite() else math.inf

    for place in sorted(starts(len(symbols)), key=value)[:KEPT]:
        found = compass(value, place)
        try:
            yield {s: Fraction(to(x)) for s, to, x in zip(symbols, maps, found, strict=True)}
        except (OverflowError, ValueError):
            continue


def stretch(limit: Range) -> Callable[[float], float]:
    """From (0, 1) onto the range: straight between two ends, x / (1 - x) towards infinity."""
    lower = None if limit.lower is None else float(exact_ball(limit.lower).mid())
    upper = None if limit.upper is None else float(exact_ball(limit.upper).mid())
    if lower is not None and upper is not None:
        return lambda x: lower + (upper - lower) * x
    if lower is not None:
        return lambda x: lower + x / max(1 - x, 1e-9)
    if upper is not None:
        return lambda x: upper - x / max(1 - x, 1e-9)
    return lambda x: (2 * x - 1) / max(4 * x * (1 - x), 1e-9) * 2


def starts(size: int) -> list[Place]:
    """Points spread over the unit cube: the fractional parts of multiples of square roots of primes."""
    roots = [math.sqrt(p) for p in itertools.islice(sp.primerange(2, 10**4), size)]
    spread = [[(k * root) % 1 for root in roots] for k in range(1, STARTS)]
    return [[0.5] * size, *spread]


def compass(value: Callable[[Place], float], place: Place) -> Place:
    """Compass search: step along an axis when that goes down, halve the step when none does."""
    here, step, steps = value(place), 0.1, 0
    while step > 1e-15 and steps < STEPS:
        moved = False
        for axis, direction in itertools.product(range(len(place)), (1, -1)):
            trial = place.copy()
            trial[axis] = min(1.0, max(0.0, trial[axis] + direction * step))
            there = value(trial)
            steps += 1
            if there < here:
                place, here, moved = trial, there, True
        step = step if moved else step / 2
    return place
