"""One hypothesis against a height map: interpolation, differences of heights, and the two criteria.

Everything is counted in map cells. A *case* is the tuple ``(H, bx, by, z, wx, wy)``: the map, the track, the
measured heights, and the velocity steps times the time since t0. A *shift* ``(px, py, vx, vy)`` puts
measurement k at

    u = bx[k] + (px + vx wx[k])     column coordinate
    w = by[k] + (py + vy wy[k])     row coordinate

Heights between nodes are bilinear, columns first. Every search evaluates these expressions in this order and
adds squares in the order of the measurements: that makes the fast loops equal their slow twins to the last bit.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from navsym.numeric.compiled import njit

unsigned = np.uint64
COMPILE: dict[str, Any] = {"nogil": True, "error_model": "numpy"}

#: Multiplication and addition may be fused into one rounding, in these two expressions only: the
#: compiler has no choice how, so that scalar and vector code still agree to the last bit.
FUSED = {"contract"}


@njit(fastmath=FUSED, **COMPILE)
def blend(a: Any, b: Any, f: Any) -> Any:
    """a + f (b - a)."""
    return a + f * (b - a)


@njit(fastmath=FUSED, **COMPILE)
def add_square(total: Any, d: Any) -> Any:
    """total + d^2."""
    return total + d * d


@njit(**COMPILE)
def height_at(H: np.ndarray, u: float, w: float) -> float:
    """Bilinear height at column ``u`` and row ``w`` of H (ny, nx); positions on the map only."""
    ny, nx = H.shape
    c = max(min(np.int64(np.floor(u)), nx - 2), 0)
    r = max(min(np.int64(np.floor(w)), ny - 2), 0)
    f, g = u - c, w - r
    column, row, one = unsigned(c), unsigned(r), unsigned(1)
    a = blend(H[row, column], H[row, column + one], f)
    b = blend(H[row + one, column], H[row + one, column + one], f)
    return blend(a, b, g)


@njit(**COMPILE)
def height_or_nan(H: np.ndarray, u: float, w: float) -> float:
    """Like :func:`height_at`, NaN off the map or when a node that takes part has no height.

    A node takes part when its weight is not zero, so a position exactly on a node, or on the line
    between two nodes, does not look at the others.
    """
    ny, nx = H.shape
    if not (0.0 <= u <= nx - 1 and 0.0 <= w <= ny - 1):
        return np.nan
    h = height_at(H, u, w)
    return beside_a_void(H, u, w) if np.isnan(h) else h


@njit(**COMPILE)
def beside_a_void(H: np.ndarray, u: float, w: float) -> float:
    """Height in a cell with a void corner: NaN unless the void corners have weight zero."""
    c, r = np.int64(np.floor(u)), np.int64(np.floor(w))
    f, g = u - c, w - r
    a = H[r, c] if f == 0.0 else H[r, c] + f * (H[r, c + 1] - H[r, c])
    if g == 0.0:
        return a
    b = H[r + 1, c] if f == 0.0 else H[r + 1, c] + f * (H[r + 1, c + 1] - H[r + 1, c])
    return a + g * (b - a)


@njit(**COMPILE)
def difference(case: Any, shift: Any, k: Any) -> float:
    """Measured minus mapped height of measurement k; on the map only."""
    H, bx, by, z, wx, wy = case
    px, py, vx, vy = shift
    return z[k] - height_at(H, bx[k] + (px + vx * wx[k]), by[k] + (py + vy * wy[k]))


@njit(**COMPILE)
def difference_or_nan(case: Any, shift: Any, k: Any) -> float:
    """:func:`difference`, NaN where the map has no height."""
    H, bx, by, z, wx, wy = case
    px, py, vx, vy = shift
    return z[k] - height_or_nan(H, bx[k] + (px + vx * wx[k]), by[k] + (py + vy * wy[k]))


@njit(**COMPILE)
def shift_of(index: Any, counts: Any, steps: Any) -> tuple[float, float, float, float]:
    """Shift of a flat index in the order Vi, Vj, j, i: positions in cells, velocities counted from the middle."""
    Mx, My, Mvx, Mvy = counts
    i, rest = index % Mx, index // Mx
    j, rest = rest % My, rest // My
    px, py = (i - Mx // 2) * steps[0], (j - My // 2) * steps[1]
    return px, py, 1.0 * (rest // Mvy - Mvx // 2), 1.0 * (rest % Mvy - Mvy // 2)


@njit(**COMPILE)
def criterion_one(case: Any, shift: Any, limit: float) -> float:
    """Sum of squared height differences of one hypothesis, abandoned once it exceeds ``limit``.

    An abandoned sum is a lower bound above ``limit``: rounded sums of squares never decrease.
    """
    total = 0.0
    for k in range(case[3].shape[0]):
        total = add_square(total, difference(case, shift, k))
        if total > limit:
            break
    return total


@njit(**COMPILE)
def criterion_masked(case: Any, shift: Any) -> float:
    """:func:`criterion_one` for tracks that may leave the map or cross voids: infinity when they do."""
    total = 0.0
    for k in range(case[3].shape[0]):
        d = difference_or_nan(case, shift, k)
        if np.isnan(d):
            return np.inf
        total = add_square(total, d)
    return total


@njit(**COMPILE)
def about_the_mean(d: np.ndarray, limit: float) -> float:
    """``sum (d - mean d)^2`` in two passes, abandoned like :func:`criterion_one`: free of a constant error."""
    mean = 0.0
    for k in range(d.shape[0]):
        mean += d[k]
    mean /= d.shape[0]
    total = 0.0
    for k in range(d.shape[0]):
        total = add_square(total, d[k] - mean)
        if total > limit:
            break
    return total


@njit(**COMPILE)
def offset_free_one(case: Any, shift: Any, limit: float, d: np.ndarray) -> float:
    """The criterion free of a constant height error; d (n,) is work space. On the map only."""
    for k in range(d.shape[0]):
        d[k] = difference(case, shift, k)
    return about_the_mean(d, limit)


@njit(**COMPILE)
def offset_free_masked(case: Any, shift: Any, d: np.ndarray) -> float:
    """:func:`offset_free_one` for tracks that may leave the map or cross voids: infinity when they do."""
    for k in range(d.shape[0]):
        d[k] = difference_or_nan(case, shift, k)
        if np.isnan(d[k]):
            return np.inf
    return about_the_mean(d, np.inf)
