"""Compiled loops of the terrain search: criteria of a grid of hypotheses against a height map.

Everything is counted in map cells. A *case* is the tuple ``(H, bx, by, z, wx, wy)``: the map, the track, the
measured heights, and the velocity steps times the time since t0. A *shift* ``(px, py, vx, vy)`` puts measurement k at

    u = bx[k] + (px + vx wx[k])     column coordinate
    w = by[k] + (py + vy wy[k])     row coordinate

and hypothesis ``(i, j, Vi, Vj)`` is the shift ``((i - Nx) sx, (j - Ny) sy, Vi - Nvx, Vj - Nvy)``. Heights between nodes
are bilinear, columns first. Every search evaluates these expressions in this order and adds squares in the order of
the measurements: that makes the fast loops equal their slow twins to the last bit.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from navsym.core.loops import njit

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
def criterion_masked(case: Any, shift: Any, centred: bool, d: np.ndarray) -> float:
    """Either criterion of a track that may leave the map or cross voids, infinity when it does; d (n,): work space."""
    total = 0.0
    for k in range(d.shape[0]):
        d[k] = difference_or_nan(case, shift, k)
        if np.isnan(d[k]):
            return np.inf
        total = add_square(total, d[k])
    return about_the_mean(d, np.inf) if centred else total


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
def dense_masked(case: Any, steps: Any, counts: Any, centred: bool, out: np.ndarray) -> None:
    """Criteria of all hypotheses, one at a time, infinite where the track leaves the map or crosses a void.

    centred : take the mean difference off first, which makes the criterion free of a constant height error
    out     : flat, in the order Vi, Vj, j, i
    """
    d = np.empty(case[3].shape[0])
    for index in range(out.shape[0]):
        shift = shift_of(index, counts, steps)
        out[index] = criterion_masked(case, shift, centred, d)


@njit(**COMPILE)
def profile(H: np.ndarray, u: np.ndarray, w: np.ndarray, out: np.ndarray) -> None:
    """Heights along the positions (u, w), in cells; NaN off the map or without data."""
    for k in range(u.shape[0]):
        out[k] = height_or_nan(H, u[k], w[k])


@njit(**COMPILE)
def velocity_criteria(case: Any, centre: np.ndarray, steps: Any, counts: Any, centred: bool, out: np.ndarray) -> None:
    """Criteria of velocity hypotheses turning about one point: the track moved by (tau - centre) v.

    case   : with the times tau (n,) in the place of both wx and wy
    centre : (2, 2) matrix of times, in the axes of the map cells
    steps  : (svx, svy) velocity steps in cells per unit of time ; counts : (Mvx, Mvy)
    out    : (Mvx, Mvy), infinite where the track leaves the map
    """
    d = np.empty(case[3].shape[0])
    for Vi in range(counts[0]):
        for Vj in range(counts[1]):
            vx, vy = (Vi - counts[0] // 2) * steps[0], (Vj - counts[1] // 2) * steps[1]
            cx = centre[0, 0] * vx + centre[0, 1] * vy
            cy = centre[1, 0] * vx + centre[1, 1] * vy
            shift = (-cx, -cy, vx, vy)
            out[Vi, Vj] = criterion_masked(case, shift, centred, d)


#: Rows of hypotheses are padded to this many entries, so that vector loops have no remainder.
LANES = 16
#: Measurements that share one pass over the criterion.
TOGETHER = 4


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
