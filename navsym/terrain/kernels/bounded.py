"""The exact minimum over four dimensions without evaluating four dimensions.

Partial sums of squares are lower bounds, whatever the order of the measurements. So the
measurements that tell hypotheses apart best come first; all hypotheses are summed over a few of
them in single precision by the vector loop, the survivors over more of them in double precision,
and the last few completely, by the same expression as the dense search. Nothing is ever dropped
unless its completely evaluated criterion would exceed the second smallest one that is known, so
the answer, the runner-up and their values are those of the dense search to the last bit.

The criterion that is free of a constant height error, ``sum (d - mean d)^2``, is searched in the same way:
the same sum over a group of measurements, about the mean of the group, is a lower bound of the group's share
of the whole, because a mean of its own fits a group best.

The margin for rounding is proved at the head of :mod:`navsym.terrain.kernels.margins`.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.terrain.kernels.criteria import TOGETHER, padded, patch_rows, shift_of, slab
from navsym.terrain.kernels.margins import (
    BLENDED,
    CONTRASTS,
    PLAIN,
    ceiling_of,
    double_limit,
    floor_of,
    parts_about_the_mean,
    single_limit,
)
from navsym.terrain.kernels.stages import add_more, evaluate, scores, settle

#: Measurements summed for every hypothesis before the first comparison; a multiple of TOGETHER.
FIRST = 32
#: Measurements added to the survivors after that; the last stage takes all that remain.
STAGES = (32, 64)
#: The position search first looks at one measurement of so many.
EVERY = 8
#: The largest number in single precision.
LARGEST = float(np.finfo(np.float32).max)
#: Hypotheses on which the next measurements are chosen.
PROBES = 32

Counts = tuple[int, int, int, int]
#: ``(H, bx, by, z, wx, wy)`` as in :mod:`navsym.terrain.kernels.criteria`; H may be in single precision.
Case = tuple[NDArray[Any], ...]


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


def neighbours(index: int, counts: Counts, lag: tuple[float, float]) -> list[int]:
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
    case: Case,
    steps: NDArray[np.float64],
    counts: Counts,
    centred: bool,
    start: NDArray[np.int64],
    allowed: Callable[[NDArray[np.int64]], NDArray[np.bool_]],
) -> tuple[float, float, int]:
    """Walk downhill on the grid from the best of ``start``; the two lowest values and the evaluations."""
    known: dict[int, float] = {}
    shift: Any = shift_of
    work = np.empty(case[3].shape[0])

    def value(index: int) -> float:
        if index not in known:
            inside = bool(allowed(np.array([index]))[0])
            known[index] = evaluate(case, shift(index, counts, steps), np.inf, centred, work) if inside else math.inf
        return known[index]

    wx, wy = case[4], case[5]
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


def borders(
    case: Case, steps: NDArray[np.float64], counts: Counts, inside: bool
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """(Mvx, Mx) and (Mvy, My): hypotheses that stay between the first and the last column, and row."""
    H, bx, by, _, wx, wy = case
    Mx, My, Mvx, Mvy = counts
    if inside:
        return np.ones((Mvx, Mx), np.bool_), np.ones((Mvy, My), np.bool_)
    return (
        stays_within(bx, wx, steps[0], Mx, Mvx, H.shape[1] - 1),
        stays_within(by, wy, steps[1], My, Mvy, H.shape[0] - 1),
    )


def stays_within(b: Any, w: Any, s: float, M: int, Mv: int, last: int) -> NDArray[np.bool_]:
    """(Mv, M): whether one coordinate of a hypothesis stays within 0…last at every measurement."""
    shifts = (np.arange(M) - M // 2)[:, None] * s
    places = (b + (shifts + (v - Mv // 2) * w) for v in range(Mv))
    return np.array([((u >= 0.0) & (u <= last)).all(axis=1) for u in places])


def admissible(
    sides: tuple[NDArray[np.bool_], NDArray[np.bool_]], counts: Counts, index: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Whether hypotheses of flat indices stay on the map."""
    Mx, My, _, Mvy = counts
    i, rest = index % Mx, index // Mx
    j, rest = rest % My, rest // My
    return np.asarray(sides[0][rest // Mvy, i] & sides[1][rest % Mvy, j])


def part_of(case: Case, chosen: NDArray[Any]) -> Case:
    """The case of some of the measurements."""
    return (case[0], *(column[chosen] for column in case[1:]))


def first_sums(
    case: Case, steps: NDArray[np.float64], counts: Counts, centred: bool, chosen: NDArray[np.int64]
) -> NDArray[np.float32]:
    """Single-precision sums (Mvx, Mvy, My, W) of every hypothesis over the chosen measurements."""
    part, (Mx, My, Mvx, Mvy) = part_of(case, chosen), counts
    sums = np.zeros((Mvx, Mvy, My, padded(Mx)), np.float32)
    for Vi in range(Mvx):
        add_slab(part, (steps[0], steps[1]), counts, Vi, centred, sums[Vi])
    return sums


def add_slab(
    case: Case, steps: tuple[float, float], counts: Counts, Vi: int, centred: bool, sums: NDArray[np.floating[Any]]
) -> None:
    """Add all measurements to the criteria at one velocity index Vi across, in the precision of the sums.

    sums : (Mvy, My, W), W = Mx padded to whole lanes
    """
    H, bx, by, z, wx, wy = case
    Mx, My, Mvx, Mvy = counts
    rows = patch_rows(by, wy, float(steps[1]), My, Mvy, H.shape[0])
    patch = np.empty((TOGETHER, rows, sums.shape[2]), sums.dtype)
    part = (H, bx, by, z.astype(sums.dtype), wx, wy)
    slab(part, steps, (Mx, My, Mvy), float(Vi - Mvx // 2), centred, patch, sums)


def best_measurements(score: NDArray[np.float64], m: int) -> NDArray[np.int64]:
    """The m highest scores, best first, so that a hopeless sum is abandoned early."""
    return np.argsort(-score, kind="stable")[:m]


def first_probes(total: int, allowed: Callable[[NDArray[np.int64]], NDArray[np.bool_]]) -> NDArray[np.int64]:
    """At most PROBES hypotheses on the map, evenly spread over the grid, without a list of all of them."""
    if total <= 8 * PROBES:
        return probes_among(np.flatnonzero(allowed(np.arange(total))))
    spread = (np.arange(64 * PROBES) * 0.6180339887498949) % 1.0
    index = (spread * total).astype(np.int64)
    return index[allowed(index)][:PROBES]


def probes_among(index: NDArray[np.int64]) -> NDArray[np.int64]:
    """At most PROBES of the survivors, evenly spread by the golden section."""
    if index.size <= PROBES:
        return index
    spread = (np.arange(PROBES) * 0.6180339887498949) % 1.0
    return index[(spread * index.size).astype(np.int64)]


@dataclass(slots=True)
class Survivors:
    """Hypotheses that are left, with what is known of them.

    index, low : flat indices, ascending, and lower bounds of their criteria
    second     : second smallest criterion known ; slack : bound above which a hypothesis is dropped
    used       : (n,) measurements that are in the bounds
    tried      : hypotheses evaluated over all measurements ; samples : squares evaluated so far
    """

    index: NDArray[np.int64]
    low: NDArray[np.float64]
    second: float
    slack: float
    used: NDArray[np.bool_]
    tried: int
    samples: int


def first_look(
    case: Case, pair: NDArray[np.float64], counts: Counts, bound: float, centred: bool, inside: bool
) -> Survivors:
    """All hypotheses over the measurements that tell them apart best, in single precision."""
    n, total = case[3].shape[0], math.prod(counts)
    across, along = sides = borders(case, pair, counts, inside)
    allowed = functools.partial(admissible, sides, counts)
    parts, first = (parts_about_the_mean(n), CONTRASTS) if centred else (PLAIN, PLAIN)
    used = np.zeros(n, dtype=np.bool_)
    score = scores(case, pair, counts, centred, first_probes(total, allowed), used)
    chosen = best_measurements(score, min(FIRST, n // TOGETHER * TOGETHER if centred else n))
    used[chosen] = True
    if centred:
        # Four neighbours on the track err alike, and their mean would take it all: spread every four.
        chosen = np.sort(chosen).reshape(TOGETHER, -1).T.ravel()
    sums = first_sums(case, pair, counts, centred, chosen)[..., : counts[0]]
    if not (across.all() and along.all()):
        sums[~(across[:, None, None, :] & along[:, :, None])] = np.inf
    flat = sums.reshape(len(across) * len(along), -1)
    lowest = np.argsort(flat.min(axis=1))[:8]  # of each velocity
    start = lowest * flat.shape[1] + flat[lowest].argmin(axis=1)
    _, second, tried = descend(case, pair, counts, centred, start, allowed)
    ceiling = ceiling_of(second, n, bound, parts)
    limit = min(single_limit(ceiling, chosen.size, bound, first), LARGEST)  # what leaves the map is infinite
    single = np.float32(limit)
    index = np.flatnonzero(flat <= (single if single <= limit else np.nextafter(single, np.float32(0.0))))
    low = floor_of(flat.ravel()[index], chosen.size, bound, first)
    slack = double_limit(ceiling, n, bound, parts)
    return Survivors(index, low, second, slack, used, tried, total * chosen.size + tried * n)


def second_look(
    case: Case, pair: NDArray[np.float64], counts: Counts, centred: bool, left: Survivors, most: int
) -> None:
    """The survivors over at most ``most`` more measurements, in double precision; drops those above the slack."""
    score = scores(case, pair, counts, centred, probes_among(left.index), left.used)
    chosen = best_measurements(score, min(most, len(left.used) - int(left.used.sum())))
    left.used[chosen] = True
    left.samples += add_more(part_of(case, chosen), pair, counts, centred, left.index, left.low, left.slack)
    fits = left.low <= left.slack
    left.index, left.low = left.index[fits], left.low[fits]


def search_bounded(
    case: Case, steps: tuple[float, float], counts: Counts, bound: float, *, centred: bool = False, inside: bool = False
) -> BoundedResult:
    """Minimum and runner-up of the criterion over all Mx My Mvx Mvy hypotheses, exactly.

    case    : (H, bx, by, z, wx, wy), heights all finite where hypotheses may look
    steps   : (sx, sy) position steps in cells ; counts : (Mx, My, Mvx, Mvy), all odd
    bound   : at least the largest absolute height of H and z
    centred : the criterion free of a constant height error; at least four measurements then
    inside  : True when every hypothesis is known to stay on the map

    Hypotheses that leave the map are never chosen; at least one must stay on it. The result equals that of the
    dense double search, ties included; see the proof of the margin in :mod:`navsym.terrain.kernels.margins`.
    """
    pair = np.array(steps, dtype=np.float64)
    n, total = case[3].shape[0], math.prod(counts)
    left = first_look(case, pair, counts, bound, centred, inside)
    survivors = [left.index.size]
    for most in (*STAGES, n):
        second_look(case, pair, counts, centred, left, most)
        survivors.append(left.index.size)
    best, criterion, runner_up, second = settle(case, pair, counts, centred, left.index, left.second)
    samples = left.samples + left.index.size * n
    completed = min(left.index.size + left.tried, total)
    return BoundedResult(best, criterion, runner_up, second, completed, samples, tuple(survivors))


def search_one_velocity(
    single: NDArray[np.float32], case: Case, steps: tuple[float, float], counts: tuple[int, int], bound: float
) -> BoundedResult:
    """Minimum and runner-up over positions only, as exact as :func:`search_bounded`.

    single : H in single precision ; counts : (Mx, My) ; wx and wy of the case are not used

    Every eighth measurement is summed in single precision for all positions. When few survive, they are
    summed on in double; when many do, as with a wrong velocity, which makes all positions fit alike, the
    other measurements follow in single precision too. The last few are evaluated completely.
    """
    n, still = case[3].shape[0], np.zeros_like(case[1])
    case, pair, all_counts = (*case[:4], still, still), np.array(steps), (*counts, 1, 1)
    early, rough = np.arange(n) % EVERY == 0, (single, *case[1:])
    sums = np.zeros((1, 1, counts[1], padded(counts[0])), np.float32)
    flat = add_single(part_of(rough, early), steps, counts, sums)
    lowest = np.sort(np.argpartition(flat, min(8, flat.size - 1))[:8]).astype(np.int64)
    _, _, _, second = settle(case, pair, all_counts, False, lowest, np.inf)
    ceiling, m = ceiling_of(second, n, bound) if math.isfinite(second) else math.inf, int(early.sum())
    index = below(flat, ceiling, m, bound)
    samples = flat.size * m + lowest.size * n
    if index.size * EVERY < flat.size:
        low, limit = floor_of(flat[index], m, bound, BLENDED), double_limit(ceiling, n, bound)
        samples += add_more(part_of(case, ~early), pair, all_counts, False, index, low, limit)
        index = index[low <= limit]
    else:
        flat = add_single(part_of(rough, ~early), steps, counts, sums)
        index, samples = below(flat, ceiling, n, bound), samples + flat.size * (n - m)
    best, criterion, runner_up, second = settle(case, pair, all_counts, False, index, second)
    completed = min(index.size + lowest.size, flat.size)
    return BoundedResult(best, criterion, runner_up, second, completed, samples + index.size * n, (index.size,))


def add_single(
    part: Case, steps: tuple[float, float], counts: tuple[int, int], sums: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Add the measurements of a part, with H in single precision, to sums (1, 1, My, W); flat, without padding."""
    add_slab(part, steps, (*counts, 1, 1), 0, False, sums[0])
    return sums[0, 0, :, : counts[0]].ravel()


def below(flat: NDArray[np.float32], ceiling: float, m: int, bound: float) -> NDArray[np.int64]:
    """Indices, ascending, of the hypotheses that the sums of m squares do not exclude."""
    limit = single_limit(ceiling, m, bound, BLENDED) if math.isfinite(ceiling) else math.inf
    return np.flatnonzero(~(flat > limit)).astype(np.int64)
