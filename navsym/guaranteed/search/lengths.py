"""Many lengths of one interval at once: the contacts of one length start Newton for the next.

The functions are Chebyshev sums on the longest interval; a shorter one ends at u < 1 of the same
panel. Only a full alternance (as many contacts as unknowns) is followed; where its pattern fails,
the length is left to the general search.
"""

from __future__ import annotations

import numpy as np

from navsym.core.tiers import kernel
from navsym.guaranteed.search.exchange import Panels
from navsym.guaranteed.search.kernels import (
    Array,
    Ints,
    applied,
    chebyshev_derivative,
    chebyshev_rows,
    chebyshev_sum,
    combined,
    inverted,
)

CHECKS = 24


@kernel
def follow(
    C: Array, C1: Array, C2: Array, p: Array, ends: Array, u: Array, kind: Ints, sign: Array
) -> tuple[Array, Array, Array]:
    """Values, contacts and weights for every end; NaN from the first length on where the pattern fails.

    kind : 0 at the start of the panel, 1 inside, 2 at the moving end
    """
    m, n = u.shape[0], ends.shape[0]
    values = np.full(n, np.nan)
    places = np.full((n, m), np.nan)
    loads = np.full((n, m), np.nan)
    u = u.copy()
    before = u[m - 1] if kind[m - 1] == 2 else 1.0
    for i in range(n):
        stretch = (ends[i] + 1.0) / (before + 1.0)
        for k in range(m):
            if kind[k] == 1:
                u[k] = (u[k] + 1.0) * stretch - 1.0
            elif kind[k] == 2:
                u[k] = ends[i]
        before = ends[i]
        x = np.zeros(m)
        inverse = np.eye(m)
        move = 1.0
        for _ in range(8):
            B = np.empty((m, m))
            for k in range(m):
                B[k] = chebyshev_rows(C, u[k])
            inverse, regular = inverted(B)
            if not regular:
                return values, places, loads
            x = applied(inverse, sign)
            move = 0.0
            slopes, bends = applied(C1, x), applied(C2, x)
            for k in range(m):
                if kind[k] == 1:
                    bend = chebyshev_sum(bends, u[k])
                    if bend * sign[k] >= 0.0:
                        return values, places, loads
                    step = -chebyshev_sum(slopes, u[k]) / bend
                    u[k] += step
                    move = max(move, abs(step))
            if move < 1e-8:
                break
        weights = combined(inverse, p)
        total = 0.0
        for k in range(m):
            if not (weights[k] * sign[k] > 0.0 and -1.0 <= u[k] <= ends[i]):
                return values, places, loads
            total += abs(weights[k])
        f = applied(C, x)
        for j in range(CHECKS):
            if abs(chebyshev_sum(f, -1.0 + (ends[i] + 1.0) * j / (CHECKS - 1.0))) > 1.0 + 1e-7:
                return values, places, loads
        values[i] = total
        places[i] = u
        loads[i] = weights
    return values, places, loads


def follow_lengths(panels: Panels, ends: Array, u: Array, kind: Ints, sign: Array) -> tuple[Array, Array, Array]:
    """:func:`follow` on the only panel of a problem."""
    C = panels.coefficients[0]
    C1 = chebyshev_derivative(C)
    return follow(C, C1, chebyshev_derivative(C1), panels.functional, ends, u, kind, sign)
