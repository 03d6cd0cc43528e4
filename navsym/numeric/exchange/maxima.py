"""Where a Chebyshev sum is largest in modulus: grid, parabola through three values, two Newton steps.

A hint like all of the exchange: balls decide later whether ``|f| <= 1``.
"""

from __future__ import annotations

import numpy as np

from navsym.numeric.exchange.kernels import Array, Ints, chebyshev_derivative, chebyshev_sum
from navsym.numeric.tiers import kernel, part

#: Nodes of the fine grid for each coefficient, and their bounds.
PER_COEFFICIENT, LEAST, MOST = 12, 128, 20_000


def fine_count(K: int) -> int:
    """How many nodes find the maxima of a sum of K terms."""
    return min(MOST, max(PER_COEFFICIENT * K, LEAST)) + 1


@kernel
def local_maxima(sums: Array, nodes: Array) -> tuple[Ints, Array, Array]:
    """Panel, place and ``|f|`` of the local maxima of ``|f|``, ends included; f has the coefficients (panels, K)."""
    panels, count = sums.shape[0], nodes.shape[0]
    slopes = chebyshev_derivative(np.ascontiguousarray(sums.T))
    bends = chebyshev_derivative(slopes)
    where = np.empty(panels * count, dtype=np.int64)
    places = np.empty(panels * count)
    heights = np.empty(panels * count)
    found = 0
    for k in range(panels):
        f = np.abs(values_on(sums[k], nodes))
        slope = np.ascontiguousarray(slopes[:, k])
        bend = np.ascontiguousarray(bends[:, k])
        for i in range(count):
            if (i == 0 or f[i] >= f[i - 1]) and (i == count - 1 or f[i] > f[i + 1]):
                top = newton_top(slope, bend, parabola_top(nodes, f, i))
                where[found], places[found] = k, top
                heights[found] = abs(chebyshev_sum(sums[k], top))
                found += 1
    return where[:found], places[:found], heights[:found]


@part
def values_on(c: Array, nodes: Array) -> Array:
    """``sum c_k T_k`` on many nodes, by Clenshaw's recurrence."""
    twice = 2.0 * nodes
    b1, b2 = np.zeros(nodes.shape[0]), np.zeros(nodes.shape[0])
    for k in range(c.shape[0] - 1, 0, -1):
        b1, b2 = twice * b1 - b2 + c[k], b1
    return nodes * b1 - b2 + c[0]


@part
def newton_top(slope: Array, bend: Array, u: float) -> float:
    """Two Newton steps on f' = 0 from inside a panel, as long as they stay near."""
    at = u
    for _ in range(2):
        curvature = chebyshev_sum(bend, at)
        if abs(u) >= 1.0 or curvature == 0.0:
            return u
        at -= chebyshev_sum(slope, at) / curvature
    return at if abs(at) < 1.0 and abs(at - u) < 0.05 else u


@part
def parabola_top(nodes: Array, f: Array, i: int) -> float:
    """Place of the top of the parabola through three neighbouring grid values (the node at an end)."""
    if i == 0 or i == nodes.shape[0] - 1:
        return nodes[i]
    left, right = nodes[i - 1] - nodes[i], nodes[i + 1] - nodes[i]
    a = (f[i - 1] - f[i]) / left
    b = (f[i + 1] - f[i]) / right
    bend = (b - a) / (right - left)
    if bend >= -1e-300:
        return nodes[i]
    shift = -(a - bend * left) / (2.0 * bend)
    return nodes[i] + shift if left <= shift <= right else nodes[i]
