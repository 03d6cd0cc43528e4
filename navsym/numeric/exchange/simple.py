"""Among several optimal duals the one with the smallest sum of moduli, which likes round numbers and zeros."""

from __future__ import annotations

import numpy as np

from navsym.numeric.exchange.kernels import Array, grid_values
from navsym.numeric.exchange.search import Panels, nodes_for


def simple_dual(panels: Panels, transform: Array, value: float) -> Array | None:
    """x in the basis of the problem with ``|x . H| <= sigma`` on a grid and the optimal value, or None.

    transform : (m, m) A of ``q = A H``; value : optimum for the functional of ``panels``
    """
    from scipy.optimize import linprog

    G = grid_values(panels.coefficients, nodes_for(panels)[::2])
    m = G.shape[1]
    # x = A^T y; variables (y, s) with -s <= x <= s.
    X, one, zero = transform.T, np.eye(m), np.zeros((G.shape[0], m))
    answer = linprog(
        np.r_[np.zeros(m), np.ones(m)],
        A_ub=np.block([[G, zero], [-G, zero], [X, -one], [-X, -one]]),
        b_ub=np.r_[np.ones(2 * G.shape[0]), np.zeros(2 * m)],
        A_eq=np.r_[panels.functional, np.zeros(m)][None, :], b_eq=[value * (1 - 1e-10)],
        bounds=[(None, None)] * (2 * m),
    )  # fmt: skip
    return np.asarray(X @ answer.x[:m], dtype=float) if answer.success else None
