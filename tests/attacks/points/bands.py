"""Bands: arrays of numbers in two doubles with a bound of their error, for many points at once.

``|exact - (high + low)| <= error`` for every entry; an entry that nothing is known of has error ``inf``. Sums, products
and quotients are those of double-word arithmetic, whose relative errors are at most 3, 5 and 15 units of 2^-106 and of
higher order (Joldes, Muller and Popescu, Tight and rigorous error bounds for basic building blocks of double-word
arithmetic, ACM TOMS 44(2), 2017, AccurateDWPlusDW, DWTimesDW1 and DWDivDW2) while nothing underflows or overflows; 64
units are charged for each. Functions of the library are done in balls, entry by entry. The slow twin of all of it is
ball arithmetic.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import arb

from navsym.core.balls import precision

Array = np.ndarray[Any, np.dtype[np.float64]]
Flags = np.ndarray[Any, np.dtype[np.bool_]]
UNIT = 2.0**-100
UP = 1 + 2.0**-40  # more than the roundings of any bound below
LEAST, MOST = 2.0**-900, 2.0**900  # between them no part of an operation underflows or overflows
SPLIT = 2.0**27 + 1
BITS = 160


@dataclass(frozen=True, slots=True, eq=False)
class Band:
    """Numbers ``high + low`` (``high`` is the nearest double of the sum) within ``error``."""

    high: Array
    low: Array
    error: Array

    def size(self) -> Array:
        """``|high + low|`` as a double, within 2^-51 of itself."""
        return np.abs(self.high)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the numbers, the three parts broadcast together."""
        return np.broadcast_shapes(self.high.shape, self.low.shape, self.error.shape)


def exactly(values: Any) -> Band:
    """Doubles as they are."""
    high = np.asarray(values, dtype=float)
    return Band(high, np.zeros_like(high), np.zeros_like(high))


# -- without rounding ---------------------------------------


def two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """a + b as a double and what it lacks, exactly."""
    s = a + b
    t = s - a
    return s, (a - (s - t)) + (b - t)


def fast_two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """The same for |a| >= |b|."""
    s = a + b
    return s, b - (s - a)


def two_product(a: Array, b: Array) -> tuple[Array, Array]:
    """a b as a double and what it lacks, exactly (Dekker's splitting)."""
    p = a * b
    (ah, al), (bh, bl) = halves(a), halves(b)
    return p, ((ah * bh - p) + ah * bl + al * bh) + al * bl


def halves(a: Array) -> tuple[Array, Array]:
    """Dekker's splitting: a as the exact sum of two doubles of at most 26 bits each."""
    t = SPLIT * a
    high = t - (t - a)
    return high, a - high


# -- the four operations ---------------------------------------


def added(a: Band, b: Band) -> Band:
    """a + b within 64 units of 2^-106, and the errors of both."""
    sh, sl = two_sum(a.high, b.high)
    th, tl = two_sum(a.low, b.low)
    vh, vl = fast_two_sum(sh, sl + th)
    high, low = fast_two_sum(vh, tl + vl)
    return Band(high, low, (a.error + b.error + UNIT * np.abs(high)) * UP)


def negated(a: Band) -> Band:
    """-a, exactly."""
    return Band(-a.high, -a.low, a.error)


def multiplied(a: Band, b: Band) -> Band:
    """a b within 64 units of 2^-106, and the errors of each times the other."""
    ch, cl = two_product(a.high, b.high)
    high, low = fast_two_sum(ch, cl + (a.high * b.low + a.low * b.high))
    carried = a.size() * b.error + b.size() * a.error + a.error * b.error
    error = (carried + UNIT * np.abs(high)) * UP
    nothing = ((a.high == 0) & (a.error == 0)) | ((b.high == 0) & (b.error == 0))
    return within(high, low, error, nothing)


def divided(a: Band, b: Band) -> Band:
    """a / b; nothing is known where the error of b is not well below b."""
    q = a.high / b.high
    rh, rl = times_double(b, q)
    high, low = fast_two_sum(q, ((a.high - rh) + (a.low - rl)) / b.high)
    error = ((a.error + np.abs(high) * b.error) / (0.5 * b.size()) + UNIT * np.abs(high)) * UP
    sure = (b.error < 0.25 * b.size()) & (b.size() > LEAST) & (b.size() < MOST) & (a.size() < MOST)
    nothing = (a.high == 0) & (a.error == 0)
    sure &= (a.size() > LEAST) | nothing
    return within(high, low, np.where(sure, error, np.inf), nothing & sure)


def times_double(a: Band, q: Array) -> tuple[Array, Array]:
    """The number in two doubles times a double, as two doubles; the errors are not carried."""
    ch, cl = two_product(a.high, q)
    th, tl = fast_two_sum(ch, a.low * q)
    return fast_two_sum(th, tl + cl)


def within(high: Array, low: Array, error: Array, nothing: Flags) -> Band:
    """Where the result is an exact zero it is one; where a part may have underflowed nothing is known."""
    sure = (np.abs(high) > LEAST) & (np.abs(high) < MOST)
    error = np.where(nothing, 0.0, np.where(sure, error, np.inf))
    return Band(np.where(nothing, 0.0, high), np.where(nothing, 0.0, low), error)


def whole_power(a: Band, n: int) -> Band:
    """a^n by squaring."""
    if n < 0:
        return divided(exactly(1.0), whole_power(a, -n))
    result = exactly(1.0)
    for bit in f"{n:b}" if n else "":
        result = multiplied(result, result)
        result = multiplied(result, a) if bit == "1" else result
    return result


# -- to and from balls ---------------------------------------


def through_balls(function: Callable[..., arb], *bands: Band) -> Band:
    """A function of balls over bands, entry by entry."""
    shape = np.broadcast_shapes(*(band.shape for band in bands))
    columns = [spread(part, shape) for band in bands for part in (band.high, band.low, band.error)]
    with precision(BITS):
        parts = [parts_of(function(*balls_of(row))) for row in zip(*columns, strict=True)]
    return Band(*(np.array(column).reshape(shape) for column in zip(*parts, strict=True)))


def spread(values: Array, shape: tuple[int, ...]) -> list[float]:
    """Values broadcast to a shape, as a flat list."""
    found: list[float] = np.broadcast_to(values, shape).ravel().tolist()
    return found


def balls_of(row: tuple[float, ...]) -> list[arb]:
    """Balls of a row that holds high, low and error of one number after the other."""
    return [ball_of(*row[k : k + 3]) for k in range(0, len(row), 3)]


def ball_of(high: float, low: float, error: float) -> arb:
    """One entry as a ball; one that nothing is known of is none."""
    if not error < float("inf"):
        return arb("nan")
    exact = arb(high) + arb(low)
    return exact + arb(0, error) if error else exact


def parts_of(ball: arb) -> tuple[float, float, float]:
    """A ball as (high, low, error)."""
    if not ball.is_finite():
        return float("nan"), float("nan"), float("inf")
    first = float(ball.mid())
    second = float((ball - arb(first)).mid())
    high = first + second
    low = second - (high - first)
    return high, low, upper(abs(ball - arb(high) - arb(low)))


def upper(x: arb) -> float:
    """A double not below a ball."""
    found = float(arb(x.upper()).mid())
    return found if found == 0 and x == 0 else found * UP + 5e-324


def constant(ball: arb) -> Band:
    """A number as a band."""
    with precision(BITS):
        return Band(*(np.asarray(part) for part in parts_of(ball)))
