"""Loops of the exchange: Chebyshev sums, the grid simplex, the optimality system.

Every function works on plain float arrays, interpreted or compiled (:mod:`navsym.core.loops`). Nothing
here is trusted: the numbers are hints that balls confirm or refuse later.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from navsym.core.loops import kernel, part

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Exchanges after which the inverse of the basis is made anew.
STALE = 24


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


@part
def combined(rows: Array, x: Array) -> Array:
    """``sum x_k row_k``, in this order, for rows (k, n)."""
    out = np.zeros(rows.shape[1])
    for k in range(rows.shape[0]):
        out += x[k] * rows[k]
    return out


@part
def applied(rows: Array, x: Array) -> Array:
    """``row_i . x`` for rows (n, m)."""
    out = np.zeros(rows.shape[0])
    for k in range(rows.shape[1]):
        out += x[k] * rows[:, k]
    return out


@part
def dot(x: Array, y: Array) -> float:
    """``x . y``, summed in this order."""
    total = 0.0
    for k in range(x.shape[0]):
        total += x[k] * y[k]
    return total


@kernel
def spread_rows(G: Array) -> Ints:
    """m rows of G (n, m) that are far from dependent: Gram-Schmidt with the largest row first."""
    n, m = G.shape
    rest = np.ascontiguousarray(G.T).copy()
    chosen = np.empty(m, dtype=np.int64)
    for k in range(m):
        sizes = np.zeros(n)
        for j in range(m):
            sizes += rest[j] * rest[j]
        at = np.argmax(sizes)
        chosen[k] = at
        row = rest[:, at] / np.sqrt(max(sizes[at], 1e-300))
        along = combined(rest, row)
        for j in range(m):
            rest[j] -= row[j] * along
    return chosen


@part
def inverted(B: Array) -> tuple[Array, bool]:
    """Inverse of a small matrix by Gauss and Jordan with row pivots, in place; False when it is singular."""
    m = B.shape[0]
    A = B.copy()
    order = np.arange(m)
    for k in range(m):
        at = k
        for i in range(k + 1, m):
            if abs(A[i, k]) > abs(A[at, k]):
                at = i
        pivot = A[at, k]
        if not abs(pivot) > 1e-14:
            return A, False
        order[k], order[at] = order[at], order[k]
        for j in range(m):
            A[k, j], A[at, j] = A[at, j], A[k, j]
        A[k, k] = 1.0
        for j in range(m):
            A[k, j] /= pivot
        for i in range(m):
            factor = A[i, k]
            if i != k:
                A[i, k] = 0.0
                for j in range(m):
                    A[i, j] -= factor * A[k, j]
    X = np.empty((m, m))
    for k in range(m):
        for i in range(m):
            X[i, order[k]] = A[i, k]
    return X, True


@part
def picked(G: Array, basis: Ints) -> Array:
    """The rows of a basis."""
    B = np.empty((basis.shape[0], G.shape[1]))
    for k in range(basis.shape[0]):
        B[k] = G[basis[k]]
    return B


@part
def leaving(signs: Array, weights: Array, d: Array) -> int:
    """The row whose weight vanishes first along d; among equal steps the largest pivot, so that the basis
    stays far from singular. -1 where none does.
    """
    leave = -1
    ratio = np.inf
    pivot = 0.0
    for k in range(d.shape[0]):
        along = signs[k] * d[k]
        if along > 1e-10:
            step = max(signs[k] * weights[k], 0.0) / along
            if step < ratio - 1e-13 or (step <= ratio + 1e-13 and along > pivot):
                ratio = min(step, ratio)
                leave = k
                pivot = along
    return leave


@kernel
def simplex(G: Array, p: Array, basis: Ints, limit: int) -> tuple[Ints, Array, Array, int]:
    """Minimise ``sum |w_i|`` subject to ``sum w_i G_i = p`` over the rows of G, from a basis of m rows.

    Any independent rows are a feasible start, because a weight of either sign is allowed; the
    dual of the basis is ``x`` with ``x . G_i = sign(w_i)``; the row with the largest ``|x . G_i|``
    enters. Returns the basis, its weights, the dual, and the number of rounds (-1: limit met).
    """
    m = G.shape[1]
    columns = np.ascontiguousarray(G.T)
    basis = basis.copy()
    weights, x = np.zeros(m), np.zeros(m)
    inverse, regular = inverted(picked(G, basis))
    if not regular:
        return basis, weights, x, -1
    signs = np.where(combined(inverse, p) >= 0.0, 1.0, -1.0)
    age = 0
    for count in range(limit):
        weights, x = combined(inverse, p), applied(inverse, signs)
        f = combined(columns, x)
        at = np.argmax(np.abs(f))
        done = abs(f[at]) <= 1.0 + 1e-10
        if done and age == 0:
            return basis, weights, x, count
        if not done:
            entering = combined(inverse, G[at])
            enter = 1.0 if f[at] > 0.0 else -1.0
            leave = leaving(signs, weights, enter * entering)
            if leave < 0:
                return basis, weights, x, -1
            basis[leave] = at
            signs[leave] = enter
            column = inverse[:, leave] / entering[leave]
            for i in range(m):
                for j in range(m):
                    inverse[i, j] -= column[i] * entering[j]
                inverse[i, leave] = column[i]
            age += 1
        if done or age == STALE:
            inverse, regular = inverted(picked(G, basis))
            age = 0
            if not regular:
                return basis, weights, x, -1
    return basis, weights, x, -1


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
        F[i] = dot(x, q) - sign[i]
        J[i, :m] = q
        F[l + free :] += weights[i] * q
        J[l + free :, m + free + i] = q
        if inner[i] == 1:
            q1 = chebyshev_rows(C1[panel[i]], u[i])
            column = m + row - l
            F[row] = dot(x, q1)
            J[i, column] = F[row]
            J[row, :m] = q1
            J[row, column] = dot(x, chebyshev_rows(C2[panel[i]], u[i]))
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
