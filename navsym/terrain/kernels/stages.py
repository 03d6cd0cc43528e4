"""Compiled stages of the bounded search: which measurements to look at next, and what survives them."""

from __future__ import annotations

from typing import Any

import numpy as np

from navsym.core.loops import njit
from navsym.terrain.kernels.criteria import COMPILE, add_square, criterion_one, difference, offset_free_one, shift_of


@njit(**COMPILE)
def evaluate(case: Any, shift: Any, limit: float, centred: bool, d: np.ndarray) -> float:
    """The criterion of one hypothesis, about its mean when ``centred``; d (n,) is work space."""
    return offset_free_one(case, shift, limit, d) if centred else criterion_one(case, shift, limit)


@njit(**COMPILE)
def scores(case: Any, steps: Any, counts: Any, centred: bool, probes: np.ndarray, used: np.ndarray) -> np.ndarray:
    """How well each measurement tells the probes from the truth: the mean capped square; -1 for used ones.

    The cap is the mean square, so that one wild probe does not speak for a measurement.
    """
    n = used.shape[0]
    squares = np.zeros((probes.shape[0], n))
    for s in range(probes.shape[0]):
        shift = shift_of(probes[s], counts, steps)
        mean, free = 0.0, 0
        for k in range(n):
            if not used[k]:
                squares[s, k] = difference(case, shift, k)
                mean, free = mean + squares[s, k], free + 1
        mean = mean / free if centred and free > 0 else 0.0
        for k in range(n):
            d = 0.0 if used[k] else squares[s, k] - mean
            squares[s, k] = d * d
    cap = squares.mean()
    score = np.zeros(n)
    for k in range(n):
        for s in range(probes.shape[0]):
            score[k] += min(squares[s, k], cap)
        if used[k]:
            score[k] = -1.0
    return score


@njit(**COMPILE)
def on_map(b: np.ndarray, w: np.ndarray, s: float, M: int, Mv: int, last: float) -> np.ndarray:
    """(Mv, M): whether one coordinate of a hypothesis stays within 0…last at every measurement."""
    out = np.empty((Mv, M), np.bool_)
    for v in range(Mv):
        for i in range(M):
            shift, rate, inside = (i - M // 2) * s, 1.0 * (v - Mv // 2), True
            for k in range(b.shape[0]):
                u = b[k] + (shift + rate * w[k])
                if not 0.0 <= u <= last:
                    inside = False
                    break
            out[v, i] = inside
    return out


@njit(**COMPILE)
def shut_out(sums: np.ndarray, across: np.ndarray, along: np.ndarray) -> None:
    """Infinite sums for hypotheses that leave the map. sums : (Mvx, Mvy, My, W), across (Mvx, Mx), along (Mvy, My)."""
    for Vi in range(sums.shape[0]):
        for Vj in range(sums.shape[1]):
            for j in range(sums.shape[2]):
                for i in range(across.shape[1]):
                    if not (across[Vi, i] and along[Vj, j]):
                        sums[Vi, Vj, j, i] = np.inf


@njit(**COMPILE)
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


@njit(**COMPILE)
def keep(sums: np.ndarray, Mx: int, My: int, limit: float, index: np.ndarray, value: np.ndarray) -> int:
    """Write index and sum of every hypothesis not above ``limit``; returns how many."""
    Mvx, Mvy = sums.shape[:2]
    count = 0
    for v in range(Mvx * Mvy):
        for j in range(My):
            for i in range(Mx):
                s = sums[v // Mvy, v % Mvy, j, i]
                if not (s > limit) and s < np.inf:
                    index[count] = (v * My + j) * Mx + i
                    value[count] = s
                    count += 1
    return count


@njit(**COMPILE)
def add_more(case: Any, steps: Any, counts: Any, centred: bool, index: Any, low: Any, limit: float) -> int:
    """Add the measurements of a case to the lower bounds of the survivors, in place; returns the samples used.

    centred : squares about the mean of these measurements, a lower bound of their share of the whole
    """
    samples, m = 0, case[3].shape[0]
    d = np.empty(m)
    for s in range(index.shape[0]):
        shift = shift_of(index[s], counts, steps)
        if centred:
            low[s] += offset_free_one(case, shift, np.inf, d) if m > 0 else 0.0
            samples += m
            continue
        total = low[s]
        for k in range(m):
            total = add_square(total, difference(case, shift, k))
            samples += 1
            if total > limit:
                break
        low[s] = total
    return samples


@njit(**COMPILE)
def settle(case: Any, steps: Any, counts: Any, centred: bool, index: Any, limit: float) -> Any:
    """Smallest and second smallest complete criterion among ``index`` (ascending), first of equals."""
    first, second = np.int64(-1), np.int64(-1)
    low, next_low = np.inf, np.inf
    d = np.empty(case[3].shape[0])
    for s in range(index.shape[0]):
        q = evaluate(case, shift_of(index[s], counts, steps), min(limit, next_low), centred, d)
        if q < low:
            second, next_low, first, low = first, low, index[s], q
        elif q < next_low:
            second, next_low = index[s], q
    return first, low, second, next_low
