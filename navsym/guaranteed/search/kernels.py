"""Loops of the exchange: Chebyshev sums and the optimality system.

Every function works on plain float arrays, interpreted or compiled (:mod:`navsym.core.loops`). Nothing
here is trusted: the numbers are hints that balls confirm or refuse later.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from navsym.core.loops import kernel, part
from navsym.core.simplex import vector_dot

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@part
def chebyshev_sum(c: Array, u: float) -> float:
    """``sum c_k T_k(u)`` by Clenshaw's recurrence."""
    b1 = 0.0
    b2 = 0.0
    for k in range(c.shape[0] - 1, 0, -1):
        b1, b2 = 2.0 * u * b1 - b2 + c[k], b1
    return u * b1 - b2 + c[0]


@part
def chebyshev_rows(c: Array, u: float) -> Array:
    """``sum c_k T_k(u)`` for every column of c (K, m)."""
    K, m = c.shape
    out = c[0].copy()
    before, now = 1.0, u
    for k in range(1, K):
        for j in range(m):
            out[j] += now * c[k, j]
        before, now = now, 2.0 * u * now - before
    return out


@part
def chebyshev_derivative(c: Array) -> Array:
    """Chebyshev coefficients of the derivative with respect to u, column by column."""
    K = c.shape[0]
    d = np.zeros_like(c)
    for k in range(K - 1, 0, -1):
        d[k - 1] = 2.0 * k * c[k]
        if k + 1 < K:
            d[k - 1] += d[k + 1]
    d[0] *= 0.5
    return d


@lru_cache(maxsize=16)
def differentiation(K: int) -> Array:
    """The matrix (K, K) of :func:`chebyshev_derivative`, for many columns outside compiled loops."""
    D: Array = np.triu(np.tile(2.0 * np.arange(K), (K, 1)), 1)
    D[np.add.outer(np.arange(K), np.arange(K)) % 2 == 0] = 0.0
    D[0] *= 0.5
    return D


@kernel
def contact_system(
    C: Array, C1: Array, C2: Array, p: Array, panel: Ints, u: Array, inner: Ints, sign: Array, x: Array, weights: Array
) -> tuple[Array, Array]:
    """Residual and Jacobian of the optimality system in (x, inner contacts, weights).

    ``f(u_i) - s_i``, ``f'(u_i)`` at inner contacts, ``sum w_i q(u_i) - p``.
    """
    m, l = x.shape[0], u.shape[0]
    free = int(inner.sum())
    F = np.zeros(l + free + m)
    J = np.zeros((l + free + m, m + free + l))
    F[l + free :] = -p
    row = l
    for i in range(l):
        q = chebyshev_rows(C[panel[i]], u[i])
        F[i] = vector_dot(x, q) - sign[i]
        J[i, :m] = q
        F[l + free :] += weights[i] * q
        J[l + free :, m + free + i] = q
        if inner[i] == 1:
            q1 = chebyshev_rows(C1[panel[i]], u[i])
            column = m + row - l
            F[row] = vector_dot(x, q1)
            J[i, column] = F[row]
            J[row, :m] = q1
            J[row, column] = vector_dot(x, chebyshev_rows(C2[panel[i]], u[i]))
            J[l + free :, column] = weights[i] * q1
            row += 1
    return F, J


@kernel
def grid_values(C: Array, nodes: Array) -> Array:
    """All functions on the nodes of every panel: (panels * nodes, m)."""
    panels, K, m = C.shape
    n = nodes.shape[0]
    out = np.zeros((panels * n, m))
    before, now = np.ones(n), nodes.copy()
    for k in range(K):
        for j in range(panels):
            for i in range(m):
                out[j * n : (j + 1) * n, i] += C[j, k, i] * before
        before, now = now, 2.0 * nodes * now - before
    return out
