"""Compiled loops of the exchange: Chebyshev sums, the grid simplex, the contact Newton.

Every function works on plain float arrays and runs unchanged as numpy when numba is missing.
Nothing here is trusted: the numbers are hints that balls confirm or refuse later.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

try:
    from numba import njit
except ImportError:  # the twin without a compiler: the same code, slower

    def njit(*_args: Any, **_options: Any) -> Callable[[Any], Any]:
        return lambda function: function


Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@njit(cache=True)
def chebyshev_sum(c: Array, u: float) -> float:
    """``sum c_k T_k(u)`` by Clenshaw's recurrence."""
    b1 = 0.0
    b2 = 0.0
    for k in range(c.shape[0] - 1, 0, -1):
        b1, b2 = 2.0 * u * b1 - b2 + c[k], b1
    return u * b1 - b2 + c[0]


@njit(cache=True)
def chebyshev_rows(c: Array, u: float) -> Array:
    """``sum c_k T_k(u)`` for every column of c (K, m)."""
    K, m = c.shape
    out = np.empty(m)
    for j in range(m):
        b1 = 0.0
        b2 = 0.0
        for k in range(K - 1, 0, -1):
            b1, b2 = 2.0 * u * b1 - b2 + c[k, j], b1
        out[j] = u * b1 - b2 + c[0, j]
    return out


@njit(cache=True)
def chebyshev_derivative(c: Array) -> Array:
    """Chebyshev coefficients of the derivative with respect to u, column by column."""
    K, m = c.shape
    d = np.zeros((K, m))
    for j in range(m):
        for k in range(K - 1, 0, -1):
            above = d[k + 1, j] if k + 1 < K else 0.0
            d[k - 1, j] = above + 2.0 * k * c[k, j]
        d[0, j] *= 0.5
    return d


@njit(cache=True)
def spread_rows(G: Array) -> Ints:
    """m rows of G (n, m) that are far from dependent: Gram-Schmidt with the largest row first."""
    n, m = G.shape
    rest = G.copy()
    chosen = np.empty(m, dtype=np.int64)
    for k in range(m):
        best = -1.0
        at = 0
        for i in range(n):
            size = 0.0
            for j in range(m):
                size += rest[i, j] * rest[i, j]
            if size > best:
                best = size
                at = i
        chosen[k] = at
        row = rest[at] / np.sqrt(max(best, 1e-300))
        for i in range(n):
            along = 0.0
            for j in range(m):
                along += rest[i, j] * row[j]
            for j in range(m):
                rest[i, j] -= along * row[j]
    return chosen


@njit(cache=True)
def inverted(B: Array) -> tuple[Array, bool]:
    """Inverse of a small matrix by Gauss and Jordan with row pivots; False when it is singular."""
    m = B.shape[0]
    A = B.copy()
    X = np.eye(m)
    for k in range(m):
        at = k
        for i in range(k + 1, m):
            if abs(A[i, k]) > abs(A[at, k]):
                at = i
        if not abs(A[at, k]) > 1e-14:
            return X, False
        for j in range(m):
            A[k, j], A[at, j] = A[at, j], A[k, j]
            X[k, j], X[at, j] = X[at, j], X[k, j]
        pivot = A[k, k]
        for j in range(m):
            A[k, j] /= pivot
            X[k, j] /= pivot
        for i in range(m):
            if i != k and A[i, k] != 0.0:
                factor = A[i, k]
                for j in range(m):
                    A[i, j] -= factor * A[k, j]
                    X[i, j] -= factor * X[k, j]
    return X, True


@njit(cache=True)
def simplex(G: Array, p: Array, basis: Ints, limit: int) -> tuple[Ints, Array, Array, int]:
    """Minimise ``sum |w_i|`` subject to ``sum w_i G_i = p`` over the rows of G, from a basis of m rows.

    Any independent rows are a feasible start, because a weight of either sign is allowed; the
    dual of the basis is ``x`` with ``x . G_i = sign(w_i)``; the row with the largest ``|x . G_i|``
    enters. Returns the basis, its weights, the dual, and the number of exchanges (-1: limit met).
    """
    n, m = G.shape
    basis = basis.copy()
    signs = np.ones(m)
    weights = np.zeros(m)
    x = np.zeros(m)
    for count in range(limit):
        B = np.empty((m, m))
        for k in range(m):
            B[k] = G[basis[k]]
        inverse, regular = inverted(B)
        if not regular:
            return basis, weights, x, -1
        weights = p @ inverse
        if count == 0:
            for k in range(m):
                signs[k] = 1.0 if weights[k] >= 0.0 else -1.0
        x = inverse @ signs
        f = G @ x
        at = int(np.argmax(np.abs(f)))
        if abs(f[at]) <= 1.0 + 1e-10:
            return basis, weights, x, count
        enter = 1.0 if f[at] > 0.0 else -1.0
        d = (enter * G[at]) @ inverse
        leave = -1
        ratio = np.inf
        pivot = 0.0
        for k in range(m):
            along = signs[k] * d[k]
            if along > 1e-10:
                step = max(signs[k] * weights[k], 0.0) / along
                # among equal steps the largest pivot, so that the basis stays far from singular
                if step < ratio - 1e-13 or (step <= ratio + 1e-13 and along > pivot):
                    ratio = min(step, ratio)
                    leave = k
                    pivot = along
        if leave < 0:
            return basis, weights, x, -1
        basis[leave] = at
        signs[leave] = enter
    return basis, weights, x, -1


@njit(cache=True)
def remez_steps(
    C: Array, C1: Array, C2: Array, panel: Ints, u: Array, inner: Ints, sign: Array, steps: int
) -> tuple[Array, Array, float]:
    """Contacts of a full alternance (as many as unknowns): Newton on ``f(u_i) = s_i, f'(u_i) = 0``.

    Solving for x with the contacts held and then moving each inner contact by ``-f'/f''`` is
    Newton's method up to a term that vanishes with f'. Returns contacts, dual and the last move.
    """
    m = u.shape[0]
    u = u.copy()
    x = np.zeros(m)
    move = np.inf
    for _ in range(steps):
        B = np.empty((m, m))
        for k in range(m):
            B[k] = chebyshev_rows(C[panel[k]], u[k])
        inverse, regular = inverted(B)
        if not regular:
            return u, x, np.inf
        x = inverse @ sign
        move = 0.0
        for k in range(m):
            if inner[k] == 1:
                slope = chebyshev_sum(C1[panel[k]] @ x, u[k])
                bend = chebyshev_sum(C2[panel[k]] @ x, u[k])
                if bend * sign[k] >= 0.0:
                    return u, x, np.inf
                step = -slope / bend
                u[k] += step
                move = max(move, abs(step))
        if move < 1e-9:
            break
    return u, x, move


@njit(cache=True)
def contact_system(
    C: Array, C1: Array, C2: Array, p: Array, panel: Ints, u: Array, inner: Ints,
    sign: Array, x: Array, weights: Array,
) -> tuple[Array, Array]:  # fmt: skip
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
        F[i] = x @ q - sign[i]
        J[i, :m] = q
        F[l + free :] += weights[i] * q
        J[l + free :, m + free + i] = q
        if inner[i] == 1:
            q1 = chebyshev_rows(C1[panel[i]], u[i])
            column = m + row - l
            F[row] = x @ q1
            J[i, column] = x @ q1
            J[row, :m] = q1
            J[row, column] = x @ chebyshev_rows(C2[panel[i]], u[i])
            J[l + free :, column] = weights[i] * q1
            row += 1
    return F, J


@njit(cache=True)
def grid_values(C: Array, nodes: Array) -> Array:
    """All functions on the nodes of every panel: (panels * nodes, m)."""
    panels, K, m = C.shape
    n = nodes.shape[0]
    T = np.empty((n, K))
    for i in range(n):
        T[i, 0] = 1.0
        if K > 1:
            T[i, 1] = nodes[i]
        for k in range(2, K):
            T[i, k] = 2.0 * nodes[i] * T[i, k - 1] - T[i, k - 2]
    out = np.empty((panels * n, m))
    for j in range(panels):
        out[j * n : (j + 1) * n] = T @ C[j]
    return out


@njit(cache=True)
def seek(C: Array, p: Array, nodes: Array) -> tuple[Ints, Array, Array, float]:
    """Grid simplex, contacts taken from its basis, Newton when the alternance is full.

    The whole fast road in one compiled call: for the regular case (as many separate contacts as
    unknowns). Returns panels, contacts, inner flags as signs of curvature are checked, and the
    last Newton move; an infinite move says that the careful road must be taken.
    """
    m = p.shape[0]
    n = nodes.shape[0]
    G = grid_values(C, nodes)
    basis, weights, x, count = simplex(G, p, spread_rows(G), 60 * m + 200)
    if count < 0:
        return basis // n, nodes[basis % n], weights, np.inf
    order = np.argsort(basis)
    basis = basis[order]
    weights = weights[order]
    for k in range(m - 1):
        if basis[k + 1] - basis[k] <= 2 and basis[k] // n == basis[k + 1] // n:
            return basis // n, nodes[basis % n], weights, np.inf
    panel = basis // n
    u = nodes[basis % n]
    inner = np.ones(m, dtype=np.int64)
    for k in range(m):
        if u[k] <= -1.0 or u[k] >= 1.0:
            inner[k] = 0
    panels, K, _ = C.shape
    C1 = np.empty_like(C)
    C2 = np.empty_like(C)
    for j in range(panels):
        C1[j] = chebyshev_derivative(C[j])
        C2[j] = chebyshev_derivative(C1[j])
    sign = np.sign(weights)
    u, x, move = remez_steps(C, C1, C2, panel, u, inner, sign, 12)
    for k in range(m):
        if not abs(u[k]) <= 1.0 or sign[k] == 0.0:
            move = np.inf
    return panel, u, weights, move
