"""A descent to where an expression is low: a search, which proves nothing.

A compass search in floats comes first, then Newton's steps on the gradient with 640 bits. What it
returns is a guess; the caller evaluates it exactly.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from fractions import Fraction

import sympy as sp
from flint import arb, arb_mat, fmpq

from navsym.core.balls import DEFAULT_BITS, Tape, UnsupportedError, enclose, exact_ball, precision, tape
from navsym.core.exact import to_fmpq, to_fraction
from navsym.prove.sampling.points import Range

STARTS = 256
KEPT = 3
STEPS = 400
ROUNDS = 8
BITS = 640

#: A Newton step below this one is believed without looking whether it goes down; so many larger ones are taken.
SMALL = 1e-3
LARGE_STEPS = 24

Place = list[float]
Guess = dict[sp.Symbol, Fraction]


def find_lowest(goal: sp.Expr, limits: dict[sp.Symbol, Range]) -> Iterator[dict[sp.Symbol, Fraction]]:
    """Places where ``goal`` is low, the lowest start first."""
    symbols = list(limits)
    maps = [map_onto_range(limits[symbol]) for symbol in symbols]
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

    polish = make_polisher(goal, symbols)
    for place in sorted(spread_starts(len(symbols)), key=value)[:KEPT]:
        found = search_by_compass(value, place)
        try:
            rough = {s: Fraction(to(x)) for s, to, x in zip(symbols, maps, found, strict=True)}
        except (OverflowError, ValueError):
            continue
        yield rough
        yield from polish(rough)


def map_onto_range(limit: Range) -> Callable[[float], float]:
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


def spread_starts(size: int) -> list[Place]:
    """Points spread over the unit cube: the fractional parts of multiples of square roots of primes."""
    roots = [math.sqrt(p) for p in itertools.islice(sp.primerange(2, 10**4), size)]
    spread = [[(k * root) % 1 for root in roots] for k in range(1, STARTS)]
    return [[0.5] * size, *spread]


def search_by_compass(value: Callable[[Place], float], place: Place) -> Place:
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


# -- Newton ---------------------------------------


def make_polisher(goal: sp.Expr, symbols: list[sp.Symbol]) -> Callable[[dict[sp.Symbol, Fraction]], Iterator[Guess]]:
    """Newton's method towards a zero of the gradient; it yields nothing where there is no gradient."""
    gradient = [sp.diff(goal, symbol) for symbol in symbols]
    hessian = [[sp.diff(slope, symbol) for symbol in symbols] for slope in gradient]
    try:
        slopes, curves = [tape(g) for g in gradient], [[tape(h) for h in row] for row in hessian]
        height = tape(goal)
    except UnsupportedError:
        return lambda rough: iter(())

    def polish(rough: dict[sp.Symbol, Fraction]) -> Iterator[Guess]:
        at = {s: arb(to_fmpq(x)) for s, x in rough.items()}
        at = approach_zero(height, slopes, curves, at)
        for _ in range(ROUNDS):
            step = solve_newton_step(slopes, curves, at)
            if step is None or not all(abs(float(d)) < SMALL for d in step):
                return
            with precision(BITS):
                at = {s: arb((at[s] - d).mid()) for s, d in zip(symbols, step, strict=True)}
        yield {s: to_fraction(x) for s, x in at.items()}

    return polish


def approach_zero(
    height: Tape, slopes: list[Tape], curves: list[list[Tape]], at: dict[sp.Symbol, arb]
) -> dict[sp.Symbol, arb]:
    """Newton's steps as long as they are large, each halved until it goes down: a compass stops in narrow valleys."""
    here = enclose(height, at).mid()
    for _ in range(LARGE_STEPS):
        step = solve_newton_step(slopes, curves, at, DEFAULT_BITS)
        if step is None or all(abs(float(d)) < SMALL for d in step):
            break
        halved = ({s: arb((at[s] - d * fmpq(1, 2**k)).mid()) for s, d in zip(at, step, strict=True)} for k in range(8))
        lower = next((place for place in halved if enclose(height, place).mid() < here), None)
        if lower is None:
            break
        at, here = lower, enclose(height, lower).mid()
    return at


def solve_newton_step(
    slopes: list[Tape], curves: list[list[Tape]], at: dict[sp.Symbol, arb], bits: int = BITS
) -> list[arb] | None:
    """Solution of hessian * step = gradient by midpoints; None where it is singular or undefined."""
    size = len(slopes)
    right = arb_mat([[enclose(program, at, bits).mid()] for program in slopes])
    matrix = arb_mat([[enclose(program, at, bits).mid() for program in row] for row in curves])
    if not all(entry.is_finite() for entry in (*right.entries(), *matrix.entries())):
        return None
    try:
        with precision(bits):
            solution = matrix.solve(right)
    except ZeroDivisionError:
        return None
    return [solution[i, 0].mid() for i in range(size)]
