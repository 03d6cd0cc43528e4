"""Looking for a counterexample: awkward exact points first, then random ones.

A point is a dictionary symbol -> exact sympy number inside the box. Residuals are balls, so a
counterexample is rigorous: the ball of ``left - right`` excludes the printed relation.
"""

from __future__ import annotations

import itertools
import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp
from flint import arb

from navsym.claims.statement import Box
from navsym.core.balls import Tape, UnsupportedError, enclose, exact_ball, tape
from navsym.core.errors import DomainError
from navsym.language.expression import to_text

Point = dict[sp.Symbol, sp.Expr]

AWKWARD: tuple[sp.Expr, ...] = (
    sp.S.Zero, sp.S.One, sp.S.Half, sp.sqrt(2), sp.pi / 3, -sp.S.One, sp.Integer(2), sp.pi, sp.Rational(-3, 2),
    sp.pi / 2, sp.Rational(7, 3), sp.Integer(10), sp.Rational(1, 100),
)  # fmt: skip

BITS = 128
#: Candidates outside the range in a row, after which no more are tried.
PATIENCE = 500


@dataclass(frozen=True, slots=True)
class Range:
    """Range of one symbol; an end is None at infinity, and open when it is not attained."""

    lower: sp.Expr | None
    upper: sp.Expr | None
    open_lower: bool = False
    nonzero: bool = False
    integer: bool = False

    @property
    def parted(self) -> bool:
        """True when the symbol is nonzero and the range may have both signs."""
        above = self.lower is not None and exact_ball(self.lower) >= 0
        below = self.upper is not None and exact_ball(self.upper) <= 0
        return self.nonzero and not above and not below

    def contains(self, value: sp.Expr) -> bool:
        """Rigorous membership of an exact number."""
        if self.integer and not value.is_Integer:
            return False
        if (self.nonzero and exact_ball(value).contains(0)) or (self.open_lower and value == self.lower):
            return False
        below = self.lower is not None and value != self.lower and not exact_ball(value - self.lower) > 0
        above = self.upper is not None and value != self.upper and not exact_ball(self.upper - value) > 0
        return not below and not above


def range_of(symbol: sp.Symbol, box: Box) -> Range:
    """Range of a symbol: the box, cut down by what the symbol was declared to be."""
    lower, upper = box.get(symbol, (None, None))
    lower = None if lower is None else sp.sympify(lower, strict=True)
    upper = None if upper is None else sp.sympify(upper, strict=True)
    lower = None if lower is sp.S.NegativeInfinity else lower
    upper = None if upper is sp.S.Infinity else upper
    refuse_declarations(symbol)
    integer, nonzero = bool(symbol.is_integer), bool(symbol.is_nonzero)
    limits = Range(lower, upper, False, nonzero, integer)
    if symbol.is_positive and (lower is None or not exact_ball(lower) > 0):
        limits = Range(sp.Integer(0), upper, True, True, integer)
    elif symbol.is_nonnegative and (lower is None or exact_ball(lower) < 0):
        limits = Range(sp.Integer(0), upper, False, nonzero, integer)
    elif symbol.is_nonpositive and (upper is None or exact_ball(upper) > 0):
        limits = Range(lower, sp.Integer(0), False, nonzero, integer)
    return refuse_empty(symbol, limits)


def refuse_declarations(symbol: sp.Symbol) -> None:
    """What a range cannot say: sympy would simplify by it, and points of the range would not obey it."""
    strange = ("even", "odd", "prime", "composite", "irrational", "noninteger", "imaginary", "zero")
    declared = [name for name in strange if symbol.assumptions0.get(name)]
    if declared or not symbol.is_commutative or symbol.is_real is False:
        what = ", ".join(declared) or "not a real number"
        raise UnsupportedError(f"expected a real symbol or an integer one; got {symbol}: {what}; declare it so")


def refuse_empty(symbol: sp.Symbol, limits: Range) -> Range:
    """An empty range would make every statement true."""
    if limits.lower is not None and limits.upper is not None:
        width = exact_ball(limits.upper - limits.lower, 256)
        if width < 0 or (limits.open_lower and width <= 0):
            message = f"expected a lower end below the upper one; got {symbol} in [{limits.lower}, {limits.upper}]"
            raise DomainError(f"{message}; correct the range")
    return limits


def ranges_of(symbols: Sequence[sp.Symbol], box: Box) -> dict[sp.Symbol, Range]:
    """Range of every symbol."""
    return {symbol: range_of(symbol, box) for symbol in symbols}


def draw_candidates(limits: Range, generator: random.Random) -> Iterator[sp.Expr]:
    """Exact values of one symbol: inside points, ends and awkward numbers, then random rationals."""
    lower, upper = limits.lower, limits.upper
    if limits.integer:
        first = 0 if lower is None else int(sp.ceiling(lower))
        last = first + 40 if upper is None else int(sp.floor(upper))
        yield from (sp.Integer(n) for n in range(first, last + 1))
        while last >= first:
            yield sp.Integer(generator.randint(first, last))
        return
    if lower is not None and upper is not None:
        width = upper - lower
        for share in ((1, 2), (1, 3), (0, 1), (1, 1), (3, 4), (1, 7), (1, 1000)):
            yield lower + width * sp.Rational(*share)
    yield from (value for value in AWKWARD if limits.contains(value))
    while True:
        yield draw_value(limits, generator)


def draw_allowed(limits: Range, generator: random.Random) -> Iterator[sp.Expr]:
    """The candidates that lie in the range; it ends where many in a row do not, as in an empty one."""
    patience = PATIENCE
    for value in draw_candidates(limits, generator):
        inside = limits.contains(value)
        patience = PATIENCE if inside else patience - 1
        if patience == 0:
            return
        if inside:
            yield value


def draw_value(limits: Range, generator: random.Random) -> sp.Expr:
    share = sp.Rational(generator.randint(1, 9999), 10000)
    if limits.lower is not None and limits.upper is not None:
        return limits.lower + (limits.upper - limits.lower) * share
    stretched = share / (1 - share)  # (0, infinity)
    if limits.lower is not None:
        return limits.lower + stretched
    if limits.upper is not None:
        return limits.upper - stretched
    return stretched if generator.random() < 0.5 else -stretched


def draw_points(symbols: Sequence[sp.Symbol], box: Box, count: int, seed: int = 0) -> Iterator[Point]:
    """``count`` exact points of the box, the same ones for the same seed."""
    if not symbols:
        yield {}
        return
    generator = random.Random(seed)
    limits = ranges_of(symbols, box)
    # Different symbols start at different awkward values, so that they are not all equal.
    streams = {
        symbol: itertools.islice(
            draw_allowed(limits[symbol], generator), place if limits[symbol].integer else 2 * place, None
        )
        for place, symbol in enumerate(symbols)
    }
    for _ in range(count):
        point = {symbol: next(stream, None) for symbol, stream in streams.items()}
        if any(value is None for value in point.values()):
            return
        yield point  # type: ignore[misc]


def value_at(program: Tape, point: Mapping[sp.Symbol, sp.Expr], bits: int = BITS) -> arb:
    """Ball of the expression at an exact point."""
    return enclose(program, {symbol: exact_ball(value, bits) for symbol, value in point.items()}, bits)


@dataclass(frozen=True, slots=True)
class Sample:
    """What sampling found: a counterexample, or how close all the points were."""

    counterexample: Point | None
    difference: arb | None
    points: int
    largest: arb | None


def search_counterexample(
    difference: sp.Expr,
    excludes: Callable[[arb], bool],
    box: Box,
    count: int = 64,
    seed: int = 0,
    sides: Sequence[sp.Expr] = (),
) -> Sample:
    """Look for a point at which the ball of ``difference`` excludes the statement.

    excludes : true for a finite ball that contradicts the statement
    sides    : expressions that have to be finite at the point as well
    """
    symbols = sorted(difference.free_symbols | set().union(*(s.free_symbols for s in sides)), key=str)
    program, others = tape(difference), [tape(side) for side in sides]
    tried, largest = 0, None
    for point in draw_points(symbols, box, count, seed):
        place = {symbol: exact_ball(value, BITS) for symbol, value in point.items()}
        ball = enclose(program, place, BITS)
        if not ball.is_finite() or not all(enclose(other, place, BITS).is_finite() for other in others):
            continue
        tried += 1
        if excludes(ball):
            return Sample(point, ball, tried, None)
        size = abs(ball)
        largest = size if largest is None else largest.max(size)
    return Sample(None, None, tried, largest)


def write_range(limits: Range) -> list[Any]:
    """A range in the words of the checker; zero is left out where it is an end and excluded."""
    flags = []
    at_low = limits.nonzero and limits.lower == 0
    at_high = limits.nonzero and limits.upper == 0
    for flag, is_said in (
        ("open-low", limits.open_lower or at_low),
        ("open-high", at_high),
        ("nonzero", limits.parted),
        ("integer", limits.integer),
    ):
        flags += [flag] if is_said else []
    return [*(None if end is None else to_text(end) for end in (limits.lower, limits.upper)), flags]
