"""The fast road of the exchange: a full alternance, as many separate contacts as unknowns, in one call.

Grid simplex, contacts taken from its basis, Newton on them, weights and dual, a look at all maxima, the value in
twofold precision. Where anything is out of the ordinary the last move is infinite, and the careful road is taken.
"""

from __future__ import annotations

import numpy as np

from navsym.numeric.exchange.kernels import (
    Array,
    Ints,
    applied,
    chebyshev_derivative,
    chebyshev_rows,
    chebyshev_sum,
    combined,
    inverted,
    simplex,
)
from navsym.numeric.exchange.maxima import local_maxima
from navsym.numeric.exchange.twofold import lagrangian
from navsym.numeric.tiers import kernel, part

Road = tuple[float, Ints, Array, Array, Array, float, float, Ints, Array]

#: A Newton move below this leaves contacts right to the square of it.
SETTLED = 1e-6
#: Places nearer than this are one.
SAME = 1e-5


@part
def rows_of(C: Array, panel: Ints, u: Array) -> Array:
    """q at the given places, (l, m)."""
    B = np.empty((u.shape[0], C.shape[2]))
    for k in range(u.shape[0]):
        B[k] = chebyshev_rows(C[panel[k]], u[k])
    return B


@part
def sums_of(C: Array, x: Array) -> Array:
    """Chebyshev coefficients of ``x . q`` on every panel."""
    sums = np.empty((C.shape[0], C.shape[1]))
    for k in range(C.shape[0]):
        sums[k] = applied(C[k], x)
    return sums


@part
def moved(sums: Array, panel: Ints, u: Array, sign: Array) -> tuple[Array, float]:
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
        inverse, regular = inverted(rows_of(C, panel, u))
        if not regular:
            return u, np.inf
        u, most = moved(sums_of(C, applied(inverse, sign)), panel, u, sign)
        if most < SETTLED or most == np.inf:
            break
    return u, most


@part
def separate(basis: Ints, n: int) -> bool:
    """True when no two grid places in order are neighbours on one panel."""
    for k in range(basis.shape[0] - 1):
        if basis[k + 1] - basis[k] <= 2 and basis[k] // n == basis[k + 1] // n:
            return False
    return True


@part
def others(where: Ints, places: Array, heights: Array, near: float, panel: Ints, u: Array) -> Ints:
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
def alternance(
    C: Array, C_low: Array, p: Array, p_low: Array, nodes: Array, G: Array, start: Ints, fine: Array, near: float
) -> Road:
    """(last move, panels, contacts, weights, dual, largest ``|f|``, value, panels and places of other touches)."""
    m, n = p.shape[0], nodes.shape[0]
    basis, weights, x, count = simplex(G, p, start, 60 * m + 200)
    order = np.argsort(basis)
    basis, weights = basis[order], weights[order]
    panel, u, sign = basis // n, nodes[basis % n], np.sign(weights)
    nowhere = (np.inf, panel, u, weights, x, np.inf, np.inf, panel, u)
    if count < 0 or not separate(basis, n):
        return nowhere
    u, move = remez_steps(C, panel, u, sign, 12)
    if not move < SETTLED or not np.abs(sign).min() > 0.0:
        return nowhere
    inverse, regular = inverted(rows_of(C, panel, u))
    if not regular:
        return nowhere
    weights, x = combined(inverse, p), applied(inverse, sign)
    if not (weights * sign).min() > 0.0:  # on the grid it had this sign, at the contacts it has not
        return nowhere
    where, places, heights = local_maxima(sums_of(C, x), fine)
    rest = others(where, places, heights, near, panel, u)
    value = lagrangian(C, C_low, p, p_low, panel, u, sign, weights, x)
    return move, panel, u, weights, x, max(1.0, heights.max()), value, where[rest], places[rest]
