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
