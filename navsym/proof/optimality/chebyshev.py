"""Chebyshev coefficients from values at Chebyshev points: in doubles for a search, in balls for the last bits of it."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from flint import arb, arb_mat
from numpy.typing import NDArray

from navsym.proof.balls import precision

#: Trailing coefficients below this part of the largest: the functions are resolved. Up to ``SHARP`` points a panel
#: they can be computed in balls and resolved beyond the digits of a double.
RESOLVED, SHARP_RESOLVED = 3e-13, 1e-19
SHARP = 96
NODE_BITS = 128


def double(matrix: arb_mat) -> NDArray[np.float64]:
    """The midpoints as doubles."""
    return np.array(list(map(float, matrix.entries()))).reshape(matrix.nrows(), matrix.ncols())


def twofold(matrix: arb_mat) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The midpoints as doubles, and what these lack."""
    high = double(matrix)
    low = [float(e - h) for e, h in zip(matrix.entries(), high.ravel().tolist(), strict=True)]
    return high, np.array(low).reshape(high.shape)


def rounded_coefficients(q: arb_mat, panels: int, count: int) -> NDArray[np.float64]:
    """Coefficients (panels, count, m) from values at the points of the first kind, in doubles."""
    values, cosines = double(q), double_cosines(count)
    return np.stack([cosines @ values[i * count : (i + 1) * count] for i in range(panels)])


@lru_cache(maxsize=8)
def double_cosines(count: int) -> NDArray[np.float64]:
    """``2/n cos(pi k (j + 1/2) / n)``, the first row halved."""
    k = np.arange(count)
    quarters = np.outer(k, 2 * k + 1) % (4 * count)  # whole turns off before anything is rounded
    cosines: NDArray[np.float64] = np.cos(np.pi * quarters / (2 * count)) * (2.0 / count)
    cosines[0] *= 0.5
    return cosines


def sharp_coefficients(q: arb_mat, panels: int, count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The same as doubles and what these lack."""
    rows = q.tolist()
    with precision(NODE_BITS):
        parts = [transformed(rows[i * count : (i + 1) * count]) for i in range(panels)]
    return np.stack([high for high, _ in parts]), np.stack([low for _, low in parts])


def tail(high: NDArray[np.float64]) -> float:
    """The last coefficients as a part of the largest."""
    return float(np.abs(high[:, -3:, :]).max() / np.abs(high).max())


def transformed(rows: list[list[arb]]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Coefficients from an even number of values, the even ones from their sums about the middle, the odd ones
    from their differences."""
    count, half = len(rows), len(rows) // 2
    pairs = list(zip(rows[:half], reversed(rows), strict=False))
    even = arb_mat([[a + b for a, b in zip(*pair, strict=True)] for pair in pairs])
    odd = arb_mat([[a - b for a, b in zip(*pair, strict=True)] for pair in pairs])
    high, low = np.empty((2, count, len(rows[0])))
    for k, folded in enumerate((even, odd)):
        high[k::2], low[k::2] = twofold(ball_cosines(count)[k] * folded)
    return high, low


@lru_cache(maxsize=8)
def ball_cosines(count: int) -> tuple[arb_mat, arb_mat]:
    """``2/n cos(pi k (j + 1/2) / n)`` for j < n/2 with k even, the first row halved, and with k odd."""
    with precision(NODE_BITS):
        cosines = [arb.cos_pi(arb(j) / (2 * count)) * 2 / count for j in range(4 * count)]
        rows = [[cosines[k * (2 * j + 1) % (4 * count)] for j in range(count // 2)] for k in range(count)]
        rows[0] = [c / 2 for c in rows[0]]
        return arb_mat(rows[::2]), arb_mat(rows[1::2])


def resolved(high: NDArray[np.float64], least: float = 1e-15) -> int:
    """How many coefficients are above their rounding, or another part of the largest."""
    size = np.abs(high).max(axis=(0, 2))
    return max(int(np.flatnonzero(size > least * size.max()).max()) + 1, 3)
