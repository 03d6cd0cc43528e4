"""Compiled criteria of tracks that may leave the map or cross voids, and of other criteria.

Where every node is known these loops evaluate the expressions of :mod:`navsym.numeric.search` and give
the same values; where one is missing the criterion is infinite. They look at one hypothesis at a time.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from navsym.numeric.search import add_square, height_at


@njit(nogil=True, cache=True, error_model="numpy")
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


@njit(nogil=True, cache=True, error_model="numpy")
def beside_a_void(H: np.ndarray, u: float, w: float) -> float:
    """Height in a cell with a void corner: NaN unless the void corners have weight zero."""
    c, r = np.int64(np.floor(u)), np.int64(np.floor(w))
    f, g = u - c, w - r
    a = H[r, c] if f == 0.0 else H[r, c] + f * (H[r, c + 1] - H[r, c])
    if g == 0.0:
        return a
    b = H[r + 1, c] if f == 0.0 else H[r + 1, c] + f * (H[r + 1, c + 1] - H[r + 1, c])
    return a + g * (b - a)


@njit(nogil=True, cache=True, error_model="numpy")
def criterion_masked(
    H: np.ndarray,
    bx: np.ndarray,
    by: np.ndarray,
    z: np.ndarray,
    wx: np.ndarray,
    wy: np.ndarray,
    px: float,
    py: float,
    vx: float,
    vy: float,
    limit: float,
) -> float:
    """:func:`criterion_one` for tracks that may leave the map or cross voids: infinity when they do."""
    total = 0.0
    inside = True
    for k in range(z.shape[0]):
        h = height_or_nan(H, bx[k] + (px + vx * wx[k]), by[k] + (py + vy * wy[k]))
        if np.isnan(h):
            inside = False
            break
        d = z[k] - h
        total = add_square(total, d)
        if total > limit:
            break
    return total if inside else np.inf


@njit(nogil=True, cache=True, error_model="numpy")
def dense_masked(
    H: np.ndarray,
    bx: np.ndarray,
    by: np.ndarray,
    z: np.ndarray,
    wx: np.ndarray,
    wy: np.ndarray,
    steps: Any,
    counts: Any,
    out: np.ndarray,
) -> None:
    """Criteria of all hypotheses, infinite where the track leaves the map. out : (Mvx, Mvy, My, Mx)."""
    sx, sy = steps
    Mx, My, Mvx, Mvy = counts
    for Vi in range(Mvx):
        for Vj in range(Mvy):
            for j in range(My):
                for i in range(Mx):
                    px, py = (i - Mx // 2) * sx, (j - My // 2) * sy
                    out[Vi, Vj, j, i] = criterion_masked(
                        H, bx, by, z, wx, wy, px, py, Vi - Mvx // 2, Vj - Mvy // 2, np.inf
                    )


@njit(nogil=True, cache=True, error_model="numpy")
def profile(H: np.ndarray, u: np.ndarray, w: np.ndarray, out: np.ndarray) -> None:
    """Heights along the positions (u, w), in cells; NaN off the map or without data."""
    for k in range(u.shape[0]):
        out[k] = height_or_nan(H, u[k], w[k])


@njit(nogil=True, cache=True, error_model="numpy")
def velocity_criteria(
    H: np.ndarray,
    bx: np.ndarray,
    by: np.ndarray,
    z: np.ndarray,
    tau: np.ndarray,
    centre: np.ndarray,
    steps: Any,
    counts: Any,
    out: np.ndarray,
) -> None:
    """Criteria of velocity hypotheses turning about one point: the track moved by (tau - centre) v.

    tau : (n,) times ; centre : (2, 2) matrix of times, in the axes of the map cells
    steps : (svx, svy) velocity steps in cells per unit of time ; counts : (Mvx, Mvy)
    out : (Mvx, Mvy), infinite where the track leaves the map
    """
    for Vi in range(counts[0]):
        for Vj in range(counts[1]):
            vx, vy = (Vi - counts[0] // 2) * steps[0], (Vj - counts[1] // 2) * steps[1]
            cx = centre[0, 0] * vx + centre[0, 1] * vy
            cy = centre[1, 0] * vx + centre[1, 1] * vy
            total = 0.0
            for k in range(z.shape[0]):
                h = height_or_nan(H, bx[k] + (tau[k] * vx - cx), by[k] + (tau[k] * vy - cy))
                if np.isnan(h):
                    total = np.inf
                    break
                d = z[k] - h
                total = add_square(total, d)
            out[Vi, Vj] = total


@njit(nogil=True, cache=True, error_model="numpy")
def offset_free(
    H: np.ndarray,
    bx: np.ndarray,
    by: np.ndarray,
    z: np.ndarray,
    wx: np.ndarray,
    wy: np.ndarray,
    steps: Any,
    counts: Any,
    out: np.ndarray,
) -> None:
    """Criteria free of a constant height error: sum (d - mean d)^2, by the update of Welford."""
    sx, sy = steps
    Mx, My, Mvx, Mvy = counts
    for Vi in range(Mvx):
        for Vj in range(Mvy):
            for j in range(My):
                for i in range(Mx):
                    px, py = (i - Mx // 2) * sx, (j - My // 2) * sy
                    mean, total = 0.0, 0.0
                    for k in range(z.shape[0]):
                        u = bx[k] + (px + (Vi - Mvx // 2) * wx[k])
                        w = by[k] + (py + (Vj - Mvy // 2) * wy[k])
                        h = height_or_nan(H, u, w)
                        if np.isnan(h):
                            total = np.inf
                            break
                        d = z[k] - h
                        step = d - mean
                        mean += step / (k + 1)
                        total += step * (d - mean)
                    out[Vi, Vj, j, i] = total
