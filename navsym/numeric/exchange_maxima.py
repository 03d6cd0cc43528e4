"""Where a Chebyshev sum is largest in modulus: grid, parabola through three values, two Newton steps.

A hint like all of the exchange: balls decide later whether ``|f| <= 1``.
"""

from __future__ import annotations

import numpy as np

from navsym.numeric.exchange_kernels import (
    Array,
    Ints,
    chebyshev_derivative,
    chebyshev_rows,
    chebyshev_sum,
    njit,
)

#: Nodes of the fine grid for each coefficient, and their bounds.
PER_COEFFICIENT, LEAST, MOST = 24, 256, 20_000


@njit(cache=True)
def settle(
    C: Array, p: Array, panel: Ints, u: Array, sign: Array, near: float
) -> tuple[Array, Array, float, Ints, Array]:
    """Weights and dual of a full alternance, the largest ``|f|``, and the places where it comes near one.

    Raises LinAlgError where the contacts determine no weights.
    """
    m, K = p.shape[0], C.shape[1]
    B = np.empty((m, m))
    for i in range(m):
        B[i] = chebyshev_rows(C[panel[i]], u[i])
    x = np.linalg.solve(B, sign).astype(np.float64)
    weights = np.linalg.solve(np.ascontiguousarray(B.T), p).astype(np.float64)
    sums = np.empty((C.shape[0], K))
    for k in range(C.shape[0]):
        sums[k] = C[k] @ x
    where, places, heights = local_maxima(sums)
    close = heights > near
    return weights, x, float(max(1.0, heights.max())), where[close], places[close]


@njit(cache=True)
def local_maxima(sums: Array) -> tuple[Ints, Array, Array]:
    """Panel, place and ``|f|`` of the local maxima of ``|f|``, ends included; f has the coefficients (panels, K)."""
    panels = sums.shape[0]
    count = min(MOST, max(PER_COEFFICIENT * sums.shape[1], LEAST)) + 1
    nodes = -np.cos(np.pi * np.arange(count) / (count - 1))
    nodes[0], nodes[-1] = -1.0, 1.0
    slopes = chebyshev_derivative(np.ascontiguousarray(sums.T))
    bends = chebyshev_derivative(slopes)
    where = np.empty(panels * count, dtype=np.int64)
    places = np.empty(panels * count)
    heights = np.empty(panels * count)
    f = np.empty(count)
    found = 0
    for k in range(panels):
        for i in range(count):
            f[i] = abs(chebyshev_sum(sums[k], nodes[i]))
        slope = np.ascontiguousarray(slopes[:, k])
        bend = np.ascontiguousarray(bends[:, k])
        for i in range(count):
            if (i == 0 or f[i] >= f[i - 1]) and (i == count - 1 or f[i] > f[i + 1]):
                top = newton_top(slope, bend, parabola_top(nodes, f, i))
                where[found], places[found] = k, top
                heights[found] = abs(chebyshev_sum(sums[k], top))
                found += 1
    return where[:found], places[:found], heights[:found]


@njit(cache=True)
def newton_top(slope: Array, bend: Array, u: float) -> float:
    """Two Newton steps on f' = 0 from inside a panel, as long as they stay near."""
    at = u
    for _ in range(2):
        curvature = chebyshev_sum(bend, at)
        if abs(u) >= 1.0 or curvature == 0.0:
            return u
        at -= chebyshev_sum(slope, at) / curvature
    return at if abs(at) < 1.0 and abs(at - u) < 0.05 else u


@njit(cache=True)
def parabola_top(nodes: Array, f: Array, i: int) -> float:
    """Place of the top of the parabola through three neighbouring grid values (the node at an end)."""
    if i == 0 or i == nodes.size - 1:
        return float(nodes[i])
    left, right = nodes[i - 1] - nodes[i], nodes[i + 1] - nodes[i]
    a = (f[i - 1] - f[i]) / left
    b = (f[i + 1] - f[i]) / right
    bend = (b - a) / (right - left)
    if bend >= -1e-300:
        return float(nodes[i])
    shift = -(a - bend * left) / (2.0 * bend)
    return float(nodes[i] + shift) if left <= shift <= right else float(nodes[i])
