"""The exact minimum over four dimensions without evaluating four dimensions.

Partial sums of squares are lower bounds, whatever the order of the measurements. So the
measurements that tell hypotheses apart best come first; all hypotheses are summed over a few of
them in single precision by the vector loop, the survivors over more of them in double precision,
and the last few completely, by the same expression as the dense search. Nothing is ever dropped
unless its completely evaluated criterion would exceed the second smallest one that is known, so
the answer, the runner-up and their values are those of the dense search to the last bit.

**The margin.** Let ``Hm`` bound the heights of map and profile, ``u = 2**-24`` (single) or
``2**-53`` (double). One interpolated difference ``d = z - (a + g (b - a))`` is computed with an
error of at most ``16 u Hm``: the inputs a, b, z are rounded (u Hm each), g is rounded (u), and of
the four operations the results are bounded by 2 Hm, 2 Hm, Hm (1 + u) and 2 Hm; the terms add up to
13 u Hm and less than u Hm for products of errors. By the triangle inequality the root of a sum of
m squares moves by at most ``16 u Hm sqrt(m)``; the summation itself has the relative error
``gamma = (m + 2) u / (1 - (m + 2) u)`` in any order. Hence

    sqrt(exact) >= sqrt(computed / (1 + gamma)) - 16 u Hm sqrt(m),

With the first interpolation in single precision as well, as in :func:`search_one_velocity`, its
result has an error of 10 u Hm in the place of u Hm, and the difference one of 40 u Hm; 48 are allowed.

The bound is used downwards for single precision (:func:`floor_of`) and once upwards for the double sums of the
dense search (:func:`ceiling_of`). Positions are always computed in double by the same expression,
so they do not enter the comparison.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from navsym.numeric.search import TOGETHER, add_square, criterion_one, height_at, padded, patch_rows, slab

SINGLE, DOUBLE = 2.0**-24, 2.0**-53
#: Measurements summed for every hypothesis before the first comparison; a multiple of TOGETHER.
FIRST = 32
#: Measurements added to the survivors after that; the last stage takes all that remain.
STAGES = (32, 64)
#: The position search first looks at one measurement of so many.
EVERY = 8
#: Error of a difference, in units of u Hm, when both interpolations are single.
BLENDED = 48.0
#: Hypotheses on which the next measurements are chosen.
PROBES = 32


@dataclass(frozen=True, slots=True)
class BoundedResult:
    """What the bounded search found and what it cost.

    index, criterion : flat index (order Vi, Vj, j, i) and value of the minimum; the first of equals
    runner_up, second: the same of the second smallest
    completed        : hypotheses evaluated over all measurements
    samples          : squares evaluated, all stages together
    survivors        : hypotheses left after each stage
    """

    index: int
    criterion: float
    runner_up: int
    second: float
    completed: int
    samples: int
    survivors: tuple[int, ...]


def ceiling_of(value: float, n: int, bound: float) -> float:
    """Upper bound of the exact criterion of any hypothesis whose double sum is at most ``value``."""
    gamma = (n + 4) * DOUBLE
    root = math.sqrt(value) * (1.0 + gamma) + 16.0 * DOUBLE * bound * math.sqrt(n)
    return root * root * (1.0 + 8.0 * DOUBLE)


def single_limit(ceiling: float, m: int, bound: float, parts: float = 16.0) -> float:
    """A single-precision sum of m squares above this has an exact sum above ``ceiling``.

    parts : error of one difference in units of u Hm
    """
    gamma = (m + 2) * SINGLE / (1.0 - (m + 2) * SINGLE)
    root = math.sqrt(ceiling) + parts * SINGLE * bound * math.sqrt(m)
    return root * root * (1.0 + gamma) * (1.0 + 8.0 * DOUBLE)


def double_limit(ceiling: float, n: int, bound: float) -> float:
    """A double sum of squares, added in any order to a lower bound, above this exceeds ``ceiling``.

    With e = 16 u Hm sqrt(n), g = (n + 4) u and X above (sqrt(c) (1 + 4 g) + 4 e)^2, the exact sum is at
    least X (1 - g) - 2 e sqrt(X), which is above c.
    """
    gamma = (n + 4) * DOUBLE
    root = math.sqrt(ceiling) * (1.0 + 4.0 * gamma) + 64.0 * DOUBLE * bound * math.sqrt(n)
    return root * root * (1.0 + 8.0 * DOUBLE)


def floor_of(sums: NDArray[np.float32], m: int, bound: float, parts: float = 16.0) -> NDArray[np.float64]:
    """Lower bounds of the exact sums of m squares, from their single-precision values."""
    gamma = (m + 2) * SINGLE / (1.0 - (m + 2) * SINGLE)
    roots = np.sqrt(sums.astype(np.float64) / (1.0 + gamma)) - parts * SINGLE * bound * math.sqrt(m)
    return np.maximum(roots, 0.0) ** 2 * (1.0 - 8.0 * DOUBLE)


@njit(nogil=True, cache=True, error_model="numpy")
def unpack(index: Any, counts: Any, steps: Any) -> tuple[float, float, int, int]:
    """(px, py, vx, vy) of a flat index: position shifts in cells, velocity indices from the middle."""
    Mx, My, Mvx, Mvy = counts
    i, rest = index % Mx, index // Mx
    j, rest = rest % My, rest // My
    px, py = (i - Mx // 2) * steps[0], (j - My // 2) * steps[1]
    return px, py, rest // Mvy - Mvx // 2, rest % Mvy - Mvy // 2


@njit(nogil=True, cache=True, error_model="numpy")
def scores(
    H: np.ndarray,
    bx: np.ndarray,
    by: np.ndarray,
    z: np.ndarray,
    wx: np.ndarray,
    wy: np.ndarray,
    steps: Any,
    counts: Any,
    probes: np.ndarray,
    used: np.ndarray,
) -> np.ndarray:
    """How well each measurement tells the probes from the truth: the mean capped square.

    The cap is the mean square, so that one wild probe does not speak for a measurement.
    """
    n = z.shape[0]
    squares = np.zeros((probes.shape[0], n))
    for s in range(probes.shape[0]):
        px, py, vx, vy = unpack(probes[s], counts, steps)
        for k in range(n):
            if not used[k]:
                d = z[k] - height_at(H, bx[k] + (px + vx * wx[k]), by[k] + (py + vy * wy[k]))
                squares[s, k] = d * d
    cap = squares.mean()
    score = np.zeros(n)
    for s in range(probes.shape[0]):
        for k in range(n):
            score[k] += min(squares[s, k], cap)
    for k in range(n):
        if used[k]:
            score[k] = -1.0
    return score


@njit(nogil=True, cache=True, error_model="numpy")
def lowest_per_velocity(sums: np.ndarray, Mx: int, My: int) -> tuple[np.ndarray, np.ndarray]:
    """Flat index of the smallest partial sum of each (Vi, Vj). sums : (Mvx, Mvy, My, W)."""
    Mvx, Mvy = sums.shape[:2]
    found = np.empty(Mvx * Mvy, np.int64)
    value = np.empty(Mvx * Mvy, np.float32)
    for v in range(Mvx * Mvy):
        best, at = np.float32(np.inf), 0
        for j in range(My):
            for i in range(Mx):
                s = sums[v // Mvy, v % Mvy, j, i]
                if s < best:
                    best, at = s, j * Mx + i
        found[v] = v * My * Mx + at
        value[v] = best
    return found, value


@njit(nogil=True, cache=True, error_model="numpy")
def keep(sums: np.ndarray, Mx: int, My: int, limit: float, index: np.ndarray, value: np.ndarray) -> int:
    """Write index and sum of every hypothesis not above ``limit``; returns how many."""
    Mvx, Mvy = sums.shape[:2]
    count = 0
    for v in range(Mvx * Mvy):
        for j in range(My):
            for i in range(Mx):
                s = sums[v // Mvy, v % Mvy, j, i]
                if not (s > limit):
                    index[count] = (v * My + j) * Mx + i
                    value[count] = s
                    count += 1
    return count


@njit(nogil=True, cache=True, error_model="numpy")
def add_more(
    H: np.ndarray,
    bx: np.ndarray,
    by: np.ndarray,
    z: np.ndarray,
    wx: np.ndarray,
    wy: np.ndarray,
    steps: Any,
    counts: Any,
    index: Any,
    low: Any,
    limit: float,
) -> int:
    """Add measurements to the lower bounds of the survivors, in place; returns the samples used."""
    samples = 0
    for s in range(index.shape[0]):
        px, py, vx, vy = unpack(index[s], counts, steps)
        total = low[s]
        for k in range(z.shape[0]):
            d = z[k] - height_at(H, bx[k] + (px + vx * wx[k]), by[k] + (py + vy * wy[k]))
            total = add_square(total, d)
            samples += 1
            if total > limit:
                break
        low[s] = total
    return samples


@njit(nogil=True, cache=True, error_model="numpy")
def settle(
    H: np.ndarray,
    bx: np.ndarray,
    by: np.ndarray,
    z: np.ndarray,
    wx: np.ndarray,
    wy: np.ndarray,
    steps: Any,
    counts: Any,
    index: Any,
    limit: float,
) -> Any:
    """Smallest and second smallest complete criterion among ``index`` (ascending), first of equals."""
    first, second = np.int64(-1), np.int64(-1)
    low, next_low = np.inf, np.inf
    for s in range(index.shape[0]):
        px, py, vx, vy = unpack(index[s], counts, steps)
        q = criterion_one(H, bx, by, z, wx, wy, px, py, vx, vy, min(limit, next_low))
        if q < low:
            second, next_low, first, low = first, low, index[s], q
        elif q < next_low:
            second, next_low = index[s], q
    return first, low, second, next_low


def neighbours(index: int, counts: tuple[int, int, int, int], lag: tuple[float, float]) -> list[int]:
    """Grid neighbours of a hypothesis, straight and along the valley.

    lag : position steps by which the middle of the track moves per velocity step; along the valley
          a velocity step is taken back at the middle of the track.
    """
    Mx, My, Mvx, Mvy = counts
    i, rest = index % Mx, index // Mx
    j, rest = rest % My, rest // My
    Vi, Vj = rest // Mvy, rest % Mvy
    moves = [(1, 0, 0, 0), (0, 1, 0, 0), (round(-lag[0]), 0, 1, 0), (0, round(-lag[1]), 0, 1)]
    found = []
    for sign in (1, -1):
        for di, dj, dv, dw in moves:
            a, b, c, d = i + sign * di, j + sign * dj, Vi + sign * dv, Vj + sign * dw
            if 0 <= a < Mx and 0 <= b < My and 0 <= c < Mvx and 0 <= d < Mvy:
                found.append(((c * Mvy + d) * My + b) * Mx + a)
    return found


def descend(
    arguments: tuple, steps: np.ndarray, counts: tuple[int, int, int, int], start: NDArray[np.int64]
) -> tuple[float, float, int]:
    """Walk downhill on the grid from the best of ``start``; the two lowest values and the evaluations."""
    known: dict[int, float] = {}
    evaluate: Any = criterion_one

    def value(index: int) -> float:
        if index not in known:
            known[index] = evaluate(*arguments, *unpack(index, counts, steps), np.inf)
        return known[index]

    wx, wy = arguments[4], arguments[5]
    middle = wx.shape[0] // 2
    lag = (float(wx[middle] / steps[0]), float(wy[middle] / steps[1]))
    best = min((int(s) for s in start), key=value)
    while True:
        around = neighbours(best, counts, lag)
        lower = min(around, key=value, default=best)
        if value(lower) >= value(best):
            break
        best = lower
    two = sorted(known.values())[:2]
    return two[0], two[-1] if len(two) > 1 else math.inf, len(known)


def first_sums(
    arguments: tuple, steps: np.ndarray, counts: tuple[int, int, int, int], chosen: NDArray[np.int64]
) -> NDArray[np.float32]:
    """Single-precision sums (Mvx, Mvy, My, W) of every hypothesis over the chosen measurements."""
    H, bx, by, z, wx, wy = arguments
    Mx, My, Mvx, Mvy = counts
    sums = np.zeros((Mvx, Mvy, My, padded(Mx)), np.float32)
    rows = patch_rows(by, wy, float(steps[1]), My, Mvy, H.shape[0])
    patch = np.empty((TOGETHER, rows, sums.shape[3]), np.float32)
    part = (bx[chosen], by[chosen], z[chosen].astype(np.float32), wx[chosen], wy[chosen])
    for Vi in range(Mvx):
        slab(H, *part, (steps[0], steps[1]), (Mx, My, Mvy), Vi - Mvx // 2, patch, sums[Vi])
    return sums


def best_measurements(score: NDArray[np.float64], m: int) -> NDArray[np.int64]:
    """The m highest scores, best first, so that a hopeless sum is abandoned early."""
    return np.argsort(-score, kind="stable")[:m]


def probes_among(index: NDArray[np.int64]) -> NDArray[np.int64]:
    """At most PROBES of the survivors, evenly spread by the golden section."""
    if index.size <= PROBES:
        return index
    spread = (np.arange(PROBES) * 0.6180339887498949) % 1.0
    return index[(spread * index.size).astype(np.int64)]


def search_bounded(
    H: NDArray[np.float64],
    bx: NDArray[np.float64],
    by: NDArray[np.float64],
    z: NDArray[np.float64],
    wx: NDArray[np.float64],
    wy: NDArray[np.float64],
    steps: tuple[float, float],
    counts: tuple[int, int, int, int],
    bound: float,
) -> BoundedResult:
    """Minimum and runner-up of the criterion over all Mx My Mvx Mvy hypotheses, exactly.

    H      : (ny, nx) heights, all finite where hypotheses may look
    bx, by : (n,) track in cells ; z : (n,) measured heights
    wx, wy : (n,) velocity step times the time since t0, in cells
    steps  : (sx, sy) position steps in cells ; counts : (Mx, My, Mvx, Mvy), all odd
    bound  : at least the largest absolute height of H and z

    Every hypothesis must stay on the map. The result equals that of the dense double search,
    ties included; see the proof of the margin at the head of this file.
    """
    arguments = (H, bx, by, z, wx, wy)
    pair = np.array(steps, dtype=np.float64)
    n, total = z.shape[0], math.prod(counts)
    used = np.zeros(n, dtype=np.bool_)
    score = scores(*arguments, pair, counts, probes_among(np.arange(total)), used)
    chosen = best_measurements(score, min(FIRST, n))
    used[chosen] = True
    sums = first_sums(arguments, pair, counts, chosen)
    found, value = lowest_per_velocity(sums, counts[0], counts[1])
    _, second, tried = descend(arguments, pair, counts, found[np.argsort(value)[:8]])
    ceiling = ceiling_of(second, n, bound)
    index, partial = np.empty(total, np.int64), np.empty(total, np.float32)
    limit = single_limit(ceiling, chosen.size, bound)
    count = keep(sums, counts[0], counts[1], limit, index, partial)
    slack = double_limit(ceiling, n, bound)
    index, low = index[:count], floor_of(partial[:count], chosen.size, bound)
    samples = total * chosen.size + tried * n
    survivors = [count]
    for size in (*STAGES, n):
        score = scores(*arguments, pair, counts, probes_among(index), used)
        chosen = best_measurements(score, min(size, n - int(used.sum())))
        used[chosen] = True
        part = (bx[chosen], by[chosen], z[chosen], wx[chosen], wy[chosen])
        samples += add_more(H, *part, pair, counts, index, low, slack)
        index, low = index[low <= slack], low[low <= slack]
        survivors.append(index.size)
    best, criterion, runner_up, second = settle(*arguments, pair, counts, index, second)
    samples += index.size * n
    completed = min(index.size + tried, total)
    return BoundedResult(best, criterion, runner_up, second, completed, samples, tuple(survivors))


def search_one_velocity(
    single: NDArray[np.float32],
    H: NDArray[np.float64],
    bx: NDArray[np.float64],
    by: NDArray[np.float64],
    z: NDArray[np.float64],
    steps: tuple[float, float],
    counts: tuple[int, int],
    bound: float,
) -> BoundedResult:
    """Minimum and runner-up over positions only, as exact as :func:`search_bounded`.

    single : H in single precision ; counts : (Mx, My)

    Every eighth measurement is summed in single precision for all positions. When few survive, they are
    summed on in double; when many do, as with a wrong velocity, which makes all positions fit alike, the
    other measurements follow in single precision too. The last few are evaluated completely.
    """
    n, still = z.shape[0], np.zeros_like(bx)
    arguments, pair, all_counts = (H, bx, by, z, still, still), np.array(steps), (*counts, 1, 1)
    early = np.arange(n) % EVERY == 0
    sums = np.zeros((1, 1, counts[1], padded(counts[0])), np.float32)
    flat = add_single(single, arguments, steps, counts, early, sums)
    lowest = np.sort(np.argpartition(flat, min(8, flat.size - 1))[:8]).astype(np.int64)
    _, _, _, second = settle(*arguments, pair, all_counts, lowest, np.inf)
    ceiling, m = ceiling_of(second, n, bound) if math.isfinite(second) else math.inf, int(early.sum())
    index = below(flat, ceiling, m, bound)
    samples = flat.size * m + lowest.size * n
    if index.size * EVERY < flat.size:
        low, limit = floor_of(flat[index], m, bound, BLENDED), double_limit(ceiling, n, bound)
        part = (bx[~early], by[~early], z[~early], still[~early], still[~early])
        samples += add_more(H, *part, pair, all_counts, index, low, limit)
        index = index[low <= limit]
    else:
        flat = add_single(single, arguments, steps, counts, ~early, sums)
        index, samples = below(flat, ceiling, n, bound), samples + flat.size * (n - m)
    best, criterion, runner_up, second = settle(*arguments, pair, all_counts, index, second)
    completed = min(index.size + lowest.size, flat.size)
    return BoundedResult(best, criterion, runner_up, second, completed, samples + index.size * n, (index.size,))


def add_single(
    single: NDArray[np.float32],
    arguments: tuple,
    steps: tuple[float, float],
    counts: tuple[int, int],
    chosen: NDArray[np.bool_],
    sums: NDArray[np.float32],
) -> NDArray[np.float32]:
    """Add the chosen measurements to sums (1, 1, My, W); returns them as a flat copy without padding."""
    _, bx, by, z, wx, wy = (a if a.ndim == 2 else a[chosen] for a in arguments)
    rows = patch_rows(by, wy, steps[1], counts[1], 1, single.shape[0])
    patch = np.empty((TOGETHER, rows, sums.shape[3]), np.float32)
    slab(single, bx, by, z.astype(np.float32), wx, wy, steps, (*counts, 1), 0, patch, sums[0])
    return sums[0, 0, :, : counts[0]].ravel()


def below(flat: NDArray[np.float32], ceiling: float, m: int, bound: float) -> NDArray[np.int64]:
    """Indices, ascending, of the hypotheses that the sums of m squares do not exclude."""
    limit = single_limit(ceiling, m, bound, BLENDED) if math.isfinite(ceiling) else math.inf
    return np.flatnonzero(~(flat > limit)).astype(np.int64)
