"""The fast road of the exchange: a full alternance, as many separate contacts as unknowns, in one call.

Grid simplex, contacts taken from its basis, Newton on them, weights and dual, a look at all maxima. Where
anything is out of the ordinary the last move is infinite, and the careful road is taken.
"""

from __future__ import annotations

import numpy as np

from navsym.core.loops import kernel, part
from navsym.core.simplex import invert_matrix, rows_times, simplex, times_rows
from navsym.guaranteed.search.kernels import Array, Ints, chebyshev_derivative, chebyshev_rows, chebyshev_sum

# Where a Chebyshev sum is largest in modulus: grid, parabola through three values, two Newton steps.
#
# A hint like all of the exchange: balls decide later whether ``|f| <= 1``.


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
        f = np.abs(chebyshev_values(sums[k], nodes))
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
def chebyshev_values(c: Array, nodes: Array) -> Array:
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


Alternance = tuple[float, Ints, Array, Array, Array, float, Ints, Array]

#: A Newton move below this leaves contacts right to the square of it.
SETTLED = 1e-6
#: Places nearer than this are one.
SAME = 1e-5


@part
def place_rows(C: Array, panel: Ints, u: Array) -> Array:
    """q at the given places, (l, m)."""
    B = np.empty((u.shape[0], C.shape[2]))
    for k in range(u.shape[0]):
        B[k] = chebyshev_rows(C[panel[k]], u[k])
    return B


@part
def panel_sums(C: Array, x: Array) -> Array:
    """Chebyshev coefficients of ``x . q`` on every panel."""
    sums = np.empty((C.shape[0], C.shape[1]))
    for k in range(C.shape[0]):
        sums[k] = rows_times(C[k], x)
    return sums


@part
def move_contacts(sums: Array, panel: Ints, u: Array, sign: Array) -> tuple[Array, float]:
    """Each inner contact moved by ``-f'/f''``, and the largest move; infinite where f does not bend inwards."""
    slopes = chebyshev_derivative(np.ascontiguousarray(sums.T))
    bends = chebyshev_derivative(slopes)
    slope, bend = np.ascontiguousarray(slopes.T), np.ascontiguousarray(bends.T)
    u = u.copy()
    most = 0.0
    for k in range(u.shape[0]):
        if -1.0 < u[k] < 1.0:
            curvature = chebyshev_sum(bend[panel[k]], u[k])
            if curvature * sign[k] >= 0.0:
                return u, np.inf
            step = -chebyshev_sum(slope[panel[k]], u[k]) / curvature
            u[k] += step
            most = max(most, abs(step))
            if not abs(u[k]) < 1.0:
                return u, np.inf
    return u, most


@part
def remez_steps(C: Array, panel: Ints, u: Array, sign: Array, steps: int) -> tuple[Array, float]:
    """Contacts of a full alternance: Newton on ``f(u_i) = s_i, f'(u_i) = 0``.

    Solving for x with the contacts held and then moving each inner contact by ``-f'/f''`` is
    Newton's method up to a term that vanishes with f'. Returns contacts and the last move.
    """
    most = np.inf
    for _ in range(steps):
        inverse, regular = invert_matrix(place_rows(C, panel, u))
        if not regular:
            return u, np.inf
        u, most = move_contacts(panel_sums(C, rows_times(inverse, sign)), panel, u, sign)
        if most < SETTLED or most == np.inf:
            break
    return u, most


@part
def is_separate(basis: Ints, n: int) -> bool:
    """True when no two grid places in order are neighbours on one panel."""
    for k in range(basis.shape[0] - 1):
        if basis[k + 1] - basis[k] <= 2 and basis[k] // n == basis[k + 1] // n:
            return False
    return True


@part
def further_touches(where: Ints, places: Array, heights: Array, near: float, panel: Ints, u: Array) -> Ints:
    """Indices of the places where ``|f|`` exceeds ``near`` that are not among the contacts."""
    kept = np.empty(where.shape[0], dtype=np.int64)
    count = 0
    for i in range(where.shape[0]):
        if heights[i] > near:
            known = False
            for k in range(u.shape[0]):
                known = known or (where[i] == panel[k] and abs(places[i] - u[k]) < SAME)
            if not known:
                kept[count] = i
                count += 1
    return kept[:count]


@kernel
def find_alternance(C: Array, p: Array, nodes: Array, G: Array, start: Ints, fine: Array, near: float) -> Alternance:
    """(last move, panels, contacts, weights, dual, largest ``|f|``, panels and places of other touches)."""
    m, n = p.shape[0], nodes.shape[0]
    basis, weights, x, count = simplex(G, p, start, 60 * m + 200)
    order = np.argsort(basis)
    basis, weights = basis[order], weights[order]
    panel, u, sign = basis // n, nodes[basis % n], np.sign(weights)
    nowhere = (np.inf, panel, u, weights, x, np.inf, panel, u)
    if count < 0 or not is_separate(basis, n):
        return nowhere
    u, move = remez_steps(C, panel, u, sign, 12)
    if not move < SETTLED or not np.abs(sign).min() > 0.0:
        return nowhere
    inverse, regular = invert_matrix(place_rows(C, panel, u))
    if not regular:
        return nowhere
    weights, x = times_rows(inverse, p), rows_times(inverse, sign)
    if not (weights * sign).min() > 0.0:  # on the grid it had this sign, at the contacts it has not
        return nowhere
    where, places, heights = local_maxima(panel_sums(C, x), fine)
    rest = further_touches(where, places, heights, near, panel, u)
    return move, panel, u, weights, x, max(1.0, heights.max()), where[rest], places[rest]
