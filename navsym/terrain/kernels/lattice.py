"""The position search where the step equals the map cell: every hypothesis shares one pair of fractions.

Then the heights of all hypotheses are one block of the map under one pair of weights, a blended row serves the row
above and the row below, and nothing has to be placed or looked up. Eight hypotheses go in the lanes of
:mod:`navsym.core.lanes`, four measurements in one pass over the sums. Positions must be whole multiples
of a power of two fine enough that adding a number of cells is exact (:func:`rounded`).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from navsym.core.arrays import Array
from navsym.core.lanes import load_lanes, spread_lanes, store_lanes
from navsym.core.loops import njit
from navsym.terrain.kernels.criteria import COMPILE, add_square, blend


def rounded(cells: Array, side: int) -> Array:
    """Cell coordinates as multiples of the last place of the largest coordinate on the map.

    That is the place to which ``(x - x0)/dx`` is rounded at the far edge anyway; with it, sums of a coordinate and
    a whole number of cells on the map are exact, and their fractions all alike.
    """
    quantum = math.ldexp(1.0, math.frexp(4.0 * side)[1] - 53)
    return np.asarray(np.rint(cells / quantum) * quantum)


@njit(**COMPILE)
def add_four_lanes(
    h: np.ndarray, nx: int, at: Any, f: Any, g: Any, z: Any, My: int, W: int, first: int, out: np.ndarray
) -> None:
    """Add four measurements to the eight columns of hypotheses from ``first`` on.

    h : the map, flat ; at : four places of the first height of column 0 ; f, g, z : four fractions each way, heights
    out : (My, W) flat
    """
    f0, f1, f2, f3 = spread_lanes(f[0]), spread_lanes(f[1]), spread_lanes(f[2]), spread_lanes(f[3])
    g0, g1, g2, g3 = spread_lanes(g[0]), spread_lanes(g[1]), spread_lanes(g[2]), spread_lanes(g[3])
    z0, z1, z2, z3 = spread_lanes(z[0]), spread_lanes(z[1]), spread_lanes(z[2]), spread_lanes(z[3])
    p0, p1, p2, p3 = at[0] + first, at[1] + first, at[2] + first, at[3] + first
    a0 = blend(load_lanes(h, p0), load_lanes(h, p0 + 1), f0)
    a1 = blend(load_lanes(h, p1), load_lanes(h, p1 + 1), f1)
    a2 = blend(load_lanes(h, p2), load_lanes(h, p2 + 1), f2)
    a3 = blend(load_lanes(h, p3), load_lanes(h, p3 + 1), f3)
    for j in range(My):
        below = (j + 1) * nx
        total = load_lanes(out, j * W + first)
        b = blend(load_lanes(h, p0 + below), load_lanes(h, p0 + below + 1), f0)
        d = z0 - blend(a0, b, g0)
        total, a0 = add_square(total, d), b
        b = blend(load_lanes(h, p1 + below), load_lanes(h, p1 + below + 1), f1)
        d = z1 - blend(a1, b, g1)
        total, a1 = add_square(total, d), b
        b = blend(load_lanes(h, p2 + below), load_lanes(h, p2 + below + 1), f2)
        d = z2 - blend(a2, b, g2)
        total, a2 = add_square(total, d), b
        b = blend(load_lanes(h, p3 + below), load_lanes(h, p3 + below + 1), f3)
        d = z3 - blend(a3, b, g3)
        total, a3 = add_square(total, d), b
        store_lanes(out, j * W + first, total)


@njit(**COMPILE)
def add_one_measurement(
    h: np.ndarray, nx: int, at: Any, f: float, g: float, z: float, Mx: int, My: int, W: int, out: np.ndarray
) -> None:
    """One measurement: twin of :func:`add_four_lanes`, and what is left over at the end of a track."""
    for j in range(My):
        for i in range(Mx):
            p = at + j * nx + i
            a, b = blend(h[p], h[p + 1], f), blend(h[p + nx], h[p + nx + 1], f)
            out[j * W + i] = add_square(out[j * W + i], z - blend(a, b, g))


@njit(**COMPILE)
def lattice(H: np.ndarray, bx: np.ndarray, by: np.ndarray, z: np.ndarray, counts: Any, out: np.ndarray) -> None:
    """Criteria (My, W) of all positions, added to ``out``; W is Mx padded to a multiple of eight.

    The heights that the padding reads must exist: see :func:`fits`.
    """
    Mx, My = counts
    nx, W = H.shape[1], out.shape[1]
    heights, sums = H.reshape(-1), out.reshape(-1)
    at, f, g = np.empty(4, np.int64), np.empty(4), np.empty(4)
    for k0 in range(0, z.shape[0], 4):
        four = min(4, z.shape[0] - k0)
        for q in range(four):
            u, w = bx[k0 + q] - Mx // 2, by[k0 + q] - My // 2
            c, r = np.int64(np.floor(u)), np.int64(np.floor(w))
            at[q], f[q], g[q] = r * nx + c, u - c, w - r
        if four < 4:
            for q in range(four):
                add_one_measurement(heights, nx, at[q], f[q], g[q], z[k0 + q], Mx, My, W, sums)
            continue
        for i in range(0, W, 8):
            add_four_lanes(heights, nx, at, f, g, z[k0 : k0 + 4], My, W, i, sums)


def fits(H: Array, bx: Array, by: Array, counts: tuple[int, int], W: int) -> bool:
    """Whether all hypotheses keep off the last row and column, and the padded columns read inside the array."""
    (Mx, My), (ny, nx) = counts, H.shape
    column, row = math.floor(float(bx.max())) - Mx // 2, math.floor(float(by.max())) - My // 2
    on_map = min(float(bx.min()) - Mx // 2, float(by.min()) - My // 2) >= 0.0
    inside = column + Mx <= nx - 1 and row + My <= ny - 1 and (row + My) * nx + column + W < H.size
    return bool(on_map and inside and H.flags.c_contiguous)
