"""Compiled loops of the terrain search: criteria of a grid of hypotheses against a height map.

A case and its shifts are those of :mod:`navsym.numeric.search.sample`: hypothesis ``(i, j, Vi, Vj)`` is the shift
``((i - Nx) sx, (j - Ny) sy, Vi - Nvx, Vj - Nvy)``. Rows of the map are interpolated once for all hypotheses that
read them.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from navsym.numeric.compiled import njit
from navsym.numeric.search.sample import COMPILE, add_square, blend, criterion_one, shift_of, unsigned

#: Rows of hypotheses are padded to this many entries, so that vector loops have no remainder.
LANES = 16
#: Measurements that share one pass over the criterion.
TOGETHER = 4


@njit(**COMPILE)
def dense_slowly(case: Any, steps: Any, counts: Any, out: np.ndarray) -> None:
    """Twin of :func:`slab` for all Vi, one hypothesis at a time. out : flat, in the order Vi, Vj, j, i."""
    for index in range(out.shape[0]):
        out[index] = criterion_one(case, shift_of(index, counts, steps), np.inf)


# The fast loops. Unsigned loop variables spare the test for negative indices, which would keep
# the compiler from using vector instructions.


@njit(**COMPILE)
def is_run(columns: np.ndarray) -> bool:
    """Whether the cells are consecutive, as they are when the step equals the cell."""
    apart = 0
    for i in range(columns.shape[0]):
        apart |= columns[i] - (columns[0] + i)
    return bool(apart == 0)


@njit(**COMPILE)
def place_columns(
    b: float, s: float, shift: float, nx: int, half: int, columns: np.ndarray, fraction: np.ndarray
) -> None:
    """Cell and fraction of every padded i."""
    for i in range(columns.shape[0]):
        u = b + ((i - half) * s + shift)
        c: Any = max(min(np.int64(np.floor(u)), nx - 2), 0)
        columns[i] = c
        fraction[i] = u - c


@njit(**COMPILE)
def place_rows(
    b: float, s: float, w: float, ny: int, My: int, Mvy: int, rows: np.ndarray, fraction: np.ndarray
) -> tuple[int, int]:
    """Row and fraction of every (Vj, j); returns the first and the last row needed."""
    low: Any = np.int64(ny)
    high: Any = np.int64(0)
    for v in range(Mvy):
        shift = (v - Mvy // 2) * w
        for j in range(My):
            u = b + ((j - My // 2) * s + shift)
            r: Any = max(min(np.int64(np.floor(u)), ny - 2), 0)
            rows[v * My + j] = r
            fraction[v * My + j] = u - r
            low = min(low, r)
            high = max(high, r)
    return low, high + 1


@njit(**COMPILE)
def blend_columns(
    H: np.ndarray, low: int, high: int, columns: np.ndarray, fraction: np.ndarray, patch: np.ndarray, start: int
) -> None:
    """Interpolate rows ``low..high`` of the map at all columns, once for all Vj and j."""
    width = unsigned(columns.shape[0])
    run = is_run(columns)
    for r in range(low, high + 1):
        base = unsigned(start + (r - low) * columns.shape[0])
        if run:
            near = H[r, columns[0] : columns[0] + columns.shape[0] + 1]
            for i in range(width):
                patch[base + i] = blend(near[i], near[i + unsigned(1)], fraction[i])
        else:
            line = H[r]
            for i in range(width):
                c = unsigned(columns[i])
                patch[base + i] = blend(line[c], line[c + unsigned(1)], fraction[i])


@njit(**COMPILE)
def add_four(patch: np.ndarray, at: np.ndarray, g: Any, z: np.ndarray, width: int, out: np.ndarray) -> None:
    """Add four measurements to every hypothesis: one pass over ``out`` instead of four."""
    W = unsigned(width)
    z0, z1, z2, z3 = z[0], z[1], z[2], z[3]
    for e in range(at.shape[1]):
        p0, p1, p2, p3 = unsigned(at[0, e]), unsigned(at[1, e]), unsigned(at[2, e]), unsigned(at[3, e])
        g0, g1, g2, g3 = g[0, e], g[1, e], g[2, e], g[3, e]
        o = unsigned(e * width)
        for i in range(W):
            d = z0 - blend(patch[p0 + i], patch[p0 + W + i], g0)
            s = add_square(out[o + i], d)
            d = z1 - blend(patch[p1 + i], patch[p1 + W + i], g1)
            s = add_square(s, d)
            d = z2 - blend(patch[p2 + i], patch[p2 + W + i], g2)
            s = add_square(s, d)
            d = z3 - blend(patch[p3 + i], patch[p3 + W + i], g3)
            out[o + i] = add_square(s, d)


@njit(**COMPILE)
def add_one(patch: np.ndarray, at: np.ndarray, g: np.ndarray, z: float, width: int, out: np.ndarray) -> None:
    """Add one measurement to every hypothesis."""
    W = unsigned(width)
    for e in range(at.shape[0]):
        p, o, ge = unsigned(at[e]), unsigned(e * width), g[e]
        for i in range(W):
            out[o + i] = add_square(out[o + i], z - blend(patch[p + i], patch[p + W + i], ge))


@njit(**COMPILE)
def add_four_centred(patch: np.ndarray, at: np.ndarray, g: Any, z: np.ndarray, width: int, out: np.ndarray) -> None:
    """:func:`add_four` less the square of the mean: ``sum (d - mean d)^2`` of each four measurements.

    As three squares of contrasts, so that nothing cancels: never more than the same sum over all measurements.
    """
    W, half, quarter = unsigned(width), out.dtype.type(0.5), out.dtype.type(0.25)
    z0, z1, z2, z3 = z[0], z[1], z[2], z[3]
    for e in range(at.shape[1]):
        p0, p1, p2, p3 = unsigned(at[0, e]), unsigned(at[1, e]), unsigned(at[2, e]), unsigned(at[3, e])
        g0, g1, g2, g3 = g[0, e], g[1, e], g[2, e], g[3, e]
        o = unsigned(e * width)
        for i in range(W):
            d0 = z0 - blend(patch[p0 + i], patch[p0 + W + i], g0)
            d1 = z1 - blend(patch[p1 + i], patch[p1 + W + i], g1)
            d2 = z2 - blend(patch[p2 + i], patch[p2 + W + i], g2)
            d3 = z3 - blend(patch[p3 + i], patch[p3 + W + i], g3)
            a, b, c = d0 - d1, d2 - d3, (d0 + d1) - (d2 + d3)
            out[o + i] += half * add_square(a * a, b) + quarter * (c * c)


@njit(**COMPILE)
def slab(case: Any, steps: Any, counts: Any, vx: float, centred: bool, patch: np.ndarray, out: np.ndarray) -> None:
    """Add all measurements to the criteria of one velocity hypothesis ``vx = Vi - Nvx``.

    steps   : (sx, sy) ; counts : (Mx, My, Mvy)
    centred : take the mean off each four measurements; what is left of a multiple of four is not used then
    patch   : (4, rows, W) work space, rows as :func:`patch_rows` says, W = Mx padded to LANES
    out     : (Mvy, My, W), added to; the padding is work space too
    The type of ``patch``, ``out`` and of z is that of the sums, that of H the one of the first
    interpolation; positions are always double.
    """
    H, bx, by, z, wx, wy = case
    sx, sy = steps
    Mx, My, Mvy = counts
    W, capacity = out.shape[2], patch.shape[1] * out.shape[2]
    columns, fx = np.empty(W, np.int64), np.empty(W, H.dtype)
    at = np.empty((TOGETHER, Mvy * My), np.int64)
    g = np.empty((TOGETHER, Mvy * My), out.dtype)
    flat, sums = patch.reshape(-1), out.reshape(-1)
    for k0 in range(0, z.shape[0], TOGETHER):
        m = min(TOGETHER, z.shape[0] - k0)
        for q in range(m):
            k = k0 + q
            place_columns(bx[k], sx, vx * wx[k], H.shape[1], Mx // 2, columns, fx)
            low, high = place_rows(by[k], sy, wy[k], H.shape[0], My, Mvy, at[q], g[q])
            blend_columns(H, low, high, columns, fx, flat, q * capacity)
            for e in range(at.shape[1]):
                at[q, e] = (at[q, e] - low) * W + q * capacity
        if m < TOGETHER:
            for q in range(0 if not centred else m, m):
                add_one(flat, at[q], g[q], z[k0 + q], W, sums)
        elif centred:
            add_four_centred(flat, at, g, z[k0 : k0 + m], W, sums)
        else:
            add_four(flat, at, g, z[k0 : k0 + m], W, sums)


def padded(Mx: int) -> int:
    """Mx rounded up to a multiple of LANES."""
    return -(-Mx // LANES) * LANES


def patch_rows(by: np.ndarray, wy: np.ndarray, sy: float, My: int, Mvy: int, ny: int) -> int:
    """Rows that the widest fan of hypotheses of one measurement can need."""
    span = (My - 1) * sy + 2 * (Mvy // 2) * float(np.abs(wy).max(initial=0.0))
    return int(min(ny, span + 4))
