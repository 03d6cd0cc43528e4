"""Compiled loops of the terrain search: criteria of a grid of hypotheses against a height map.

Everything here is counted in map cells: a hypothesis ``(i, j, Vi, Vj)`` puts measurement k at

    u = bx[k] + ((i - Nx) sx + (Vi - Nvx) wx[k])     column coordinate
    w = by[k] + ((j - Ny) sy + (Vj - Nvy) wy[k])     row coordinate

with ``bx, by`` the positions of the track, ``sx, sy`` the position steps and ``wx, wy`` the
velocity steps times the time since t0. Heights between nodes are bilinear, columns first. Every
loop evaluates these expressions in this order and adds squares in the order of the
measurements: that makes the fast loops equal their slow twins to the last bit.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

unsigned = np.uint64

#: Rows of hypotheses are padded to this many entries, so that vector loops have no remainder.
LANES = 16
#: Measurements that share one pass over the criterion.
TOGETHER = 4


#: Multiplication and addition may be fused into one rounding, in these two expressions only: the
#: compiler has no choice how, so that scalar and vector code still agree to the last bit.
FUSED = {"contract"}


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FUSED)
def blend(a: Any, b: Any, f: Any) -> Any:
    """a + f (b - a)."""
    return a + f * (b - a)


@njit(nogil=True, cache=True, error_model="numpy", fastmath=FUSED)
def add_square(total: Any, d: Any) -> Any:
    """total + d^2."""
    return total + d * d


@njit(nogil=True, cache=True, error_model="numpy")
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


@njit(nogil=True, cache=True, error_model="numpy")
def criterion_one(
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
    """Sum of squared height differences of one hypothesis, abandoned once it exceeds ``limit``.

    px, py : (i - Nx) sx and (j - Ny) sy, in cells ; vx, vy : Vi - Nvx and Vj - Nvy

    An abandoned sum is a lower bound above ``limit``: rounded sums of squares never decrease.
    """
    total = 0.0
    for k in range(z.shape[0]):
        d = z[k] - height_at(H, bx[k] + (px + vx * wx[k]), by[k] + (py + vy * wy[k]))
        total = add_square(total, d)
        if total > limit:
            break
    return total


@njit(nogil=True, cache=True, error_model="numpy")
def dense_slowly(
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
    """Twin of :func:`slab` for all Vi: four plain loops. out : (Mvx, Mvy, My, Mx)."""
    sx, sy = steps
    Mx, My, Mvx, Mvy = counts
    for Vi in range(Mvx):
        for Vj in range(Mvy):
            for j in range(My):
                for i in range(Mx):
                    px, py = (i - Mx // 2) * sx, (j - My // 2) * sy
                    out[Vi, Vj, j, i] = criterion_one(
                        H, bx, by, z, wx, wy, px, py, Vi - Mvx // 2, Vj - Mvy // 2, np.inf
                    )


# The fast loops. Unsigned loop variables spare the test for negative indices, which would keep
# the compiler from using vector instructions.


@njit(nogil=True, cache=True, error_model="numpy")
def is_run(columns: np.ndarray) -> bool:
    """Whether the cells are consecutive, as they are when the step equals the cell."""
    apart = 0
    for i in range(columns.shape[0]):
        apart |= columns[i] - (columns[0] + i)
    return bool(apart == 0)


@njit(nogil=True, cache=True, error_model="numpy")
def place_columns(
    b: float, s: float, shift: float, nx: int, half: int, columns: np.ndarray, fraction: np.ndarray
) -> None:
    """Cell and fraction of every padded i."""
    for i in range(columns.shape[0]):
        u = b + ((i - half) * s + shift)
        c: Any = max(min(np.int64(np.floor(u)), nx - 2), 0)
        columns[i] = c
        fraction[i] = u - c


@njit(nogil=True, cache=True, error_model="numpy")
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


@njit(nogil=True, cache=True, error_model="numpy")
def blend_columns(
    H: np.ndarray,
    low: int,
    high: int,
    columns: np.ndarray,
    fraction: np.ndarray,
    patch: np.ndarray,
    start: int,
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


@njit(nogil=True, cache=True, error_model="numpy")
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


@njit(nogil=True, cache=True, error_model="numpy")
def add_one(patch: np.ndarray, at: np.ndarray, g: np.ndarray, z: float, width: int, out: np.ndarray) -> None:
    """Add one measurement to every hypothesis."""
    W = unsigned(width)
    for e in range(at.shape[0]):
        p, o, ge = unsigned(at[e]), unsigned(e * width), g[e]
        for i in range(W):
            out[o + i] = add_square(out[o + i], z - blend(patch[p + i], patch[p + W + i], ge))


@njit(nogil=True, cache=True, error_model="numpy")
def add_four_directly(
    heights: np.ndarray,
    nx: int,
    start: np.ndarray,
    rows: np.ndarray,
    f: np.ndarray,
    g: np.ndarray,
    z: np.ndarray,
    width: int,
    out: np.ndarray,
) -> None:
    """:func:`add_four` from the map itself, where the step equals the cell.

    With one velocity a blended row serves two hypotheses only: blending it twice is cheaper than
    keeping it. heights : the map, flat ; start, f : (4,) first columns and the fraction that all
    columns share ; rows, g : (4, My)
    """
    W, one, below = unsigned(width), unsigned(1), unsigned(nx)
    z0, z1, z2, z3 = z[0], z[1], z[2], z[3]
    f0, f1, f2, f3 = f[0], f[1], f[2], f[3]
    for j in range(rows.shape[1]):
        p0, p1 = unsigned(rows[0, j] * nx + start[0]), unsigned(rows[1, j] * nx + start[1])
        p2, p3 = unsigned(rows[2, j] * nx + start[2]), unsigned(rows[3, j] * nx + start[3])
        g0, g1, g2, g3 = g[0, j], g[1, j], g[2, j], g[3, j]
        o = unsigned(j * width)
        for i in range(W):
            a = blend(heights[p0 + i], heights[p0 + i + one], f0)
            b = blend(heights[p0 + below + i], heights[p0 + below + i + one], f0)
            d = z0 - blend(a, b, g0)
            s = add_square(out[o + i], d)
            a = blend(heights[p1 + i], heights[p1 + i + one], f1)
            b = blend(heights[p1 + below + i], heights[p1 + below + i + one], f1)
            d = z1 - blend(a, b, g1)
            s = add_square(s, d)
            a = blend(heights[p2 + i], heights[p2 + i + one], f2)
            b = blend(heights[p2 + below + i], heights[p2 + below + i + one], f2)
            d = z2 - blend(a, b, g2)
            s = add_square(s, d)
            a = blend(heights[p3 + i], heights[p3 + i + one], f3)
            b = blend(heights[p3 + below + i], heights[p3 + below + i + one], f3)
            d = z3 - blend(a, b, g3)
            out[o + i] = add_square(s, d)


@njit(nogil=True, cache=True, error_model="numpy")
def slab(
    H: np.ndarray,
    bx: np.ndarray,
    by: np.ndarray,
    z: np.ndarray,
    wx: np.ndarray,
    wy: np.ndarray,
    steps: Any,
    counts: Any,
    vx: float,
    patch: np.ndarray,
    out: np.ndarray,
) -> None:
    """Add all measurements to the criteria of one velocity hypothesis ``vx = Vi - Nvx``.

    steps  : (sx, sy) ; counts : (Mx, My, Mvy)
    patch  : (4, rows, W) work space, rows as :func:`patch_rows` says, W = Mx padded to LANES
    out    : (Mvy, My, W), added to; the padding is work space too
    The type of ``patch``, ``out`` and ``z`` is that of the sums, that of H the one of the first
    interpolation; positions are always double.
    """
    sx, sy = steps
    Mx, My, Mvy = counts
    W, capacity = out.shape[2], patch.shape[1] * out.shape[2]
    columns, fx = np.empty((TOGETHER, W), np.int64), np.empty((TOGETHER, W), H.dtype)
    at = np.empty((TOGETHER, Mvy * My), np.int64)
    g = np.empty((TOGETHER, Mvy * My), out.dtype)
    low, high = np.empty(TOGETHER, np.int64), np.empty(TOGETHER, np.int64)
    flat, sums, heights = patch.reshape(-1), out.reshape(-1), H.reshape(-1)
    for k0 in range(0, z.shape[0], TOGETHER):
        m = min(TOGETHER, z.shape[0] - k0)
        alike = m == TOGETHER and Mvy == 1
        for q in range(m):
            k = k0 + q
            place_columns(bx[k], sx, vx * wx[k], H.shape[1], Mx // 2, columns[q], fx[q])
            low[q], high[q] = place_rows(by[k], sy, wy[k], H.shape[0], My, Mvy, at[q], g[q])
            alike = alike and is_run(columns[q]) and (fx[q] == fx[q, 0]).all()
        if alike:
            add_four_directly(heights, H.shape[1], columns[:, 0], at, fx[:, 0], g, z[k0 : k0 + m], W, sums)
            continue
        for q in range(m):
            blend_columns(H, low[q], high[q], columns[q], fx[q], flat, q * capacity)
            for e in range(at.shape[1]):
                at[q, e] = (at[q, e] - low[q]) * W + q * capacity
        if m == TOGETHER:
            add_four(flat, at, g, z[k0 : k0 + m], W, sums)
        else:
            for q in range(m):
                add_one(flat, at[q], g[q], z[k0 + q], W, sums)


def padded(Mx: int) -> int:
    """Mx rounded up to a multiple of LANES."""
    return -(-Mx // LANES) * LANES


def patch_rows(by: np.ndarray, wy: np.ndarray, sy: float, My: int, Mvy: int, ny: int) -> int:
    """Rows that the widest fan of hypotheses of one measurement can need."""
    span = (My - 1) * sy + 2 * (Mvy // 2) * float(np.abs(wy).max(initial=0.0))
    return int(min(ny, span + 4))
