"""The simplex method with bounds on absolute values: interpreted first, compiled when that pays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from navsym.core.loops import kernel, part

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Exchanges after which the inverse of the basis is made anew.
STALE = 24


@part
def times_rows(rows: Array, x: Array) -> Array:
    """``sum x_k row_k``, in this order, for rows (k, n)."""
    out = np.zeros(rows.shape[1])
    for k in range(rows.shape[0]):
        out += x[k] * rows[k]
    return out


@part
def rows_times(rows: Array, x: Array) -> Array:
    """``row_i . x`` for rows (n, m)."""
    out = np.zeros(rows.shape[0])
    for k in range(rows.shape[1]):
        out += x[k] * rows[:, k]
    return out


@part
def vector_dot(x: Array, y: Array) -> float:
    """``x . y``, summed in this order."""
    total = 0.0
    for k in range(x.shape[0]):
        total += x[k] * y[k]
    return total


def independent_rows(rows: Array, count: int, least: float = -1.0, near: float = 1.0) -> Ints:
    """Rows that are far from dependent, at most so many: each time the first whose rest is about the longest left.

    least, near : rests of no more than the first are zero, those above the second part of the longest about as long
    """
    rest, chosen = np.ascontiguousarray(np.transpose(rows)), list[int]()
    while len(chosen) < count:
        sizes = np.sqrt((rest * rest).sum(axis=0))
        best = int(np.argmax(sizes >= near * sizes.max()))
        if not sizes[best] > least:
            break
        chosen.append(best)
        unit = rest[:, best] / max(sizes[best], 1e-300)
        rest = rest - np.outer(unit, unit @ rest)
    return np.array(chosen, dtype=np.int64)


@part
def invert_matrix(B: Array) -> tuple[Array, bool]:
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
def basis_rows(G: Array, basis: Ints) -> Array:
    """The rows of a basis."""
    B = np.empty((basis.shape[0], G.shape[1]))
    for k in range(basis.shape[0]):
        B[k] = G[basis[k]]
    return B


@part
def leaving_row(signs: Array, weights: Array, d: Array) -> int:
    """The row whose weight vanishes first along d, -1 where none does.

    Among equal steps the largest pivot wins, so that the basis stays far from singular.
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
    inverse, regular = invert_matrix(basis_rows(G, basis))
    if not regular:
        return basis, weights, x, -1
    signs = np.full(m, 2.0) * (times_rows(inverse, p) >= 0.0) - 1.0
    age = 0
    for count in range(limit):
        weights, x = times_rows(inverse, p), rows_times(inverse, signs)
        f = times_rows(columns, x)
        at = np.argmax(np.abs(f))
        done = abs(f[at]) <= 1.0 + 1e-10
        if done and age == 0:
            return basis, weights, x, count
        if not done:
            entering = times_rows(inverse, G[at])
            enter = 1.0 if f[at] > 0.0 else -1.0
            leave = leaving_row(signs, weights, enter * entering)
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
            inverse, regular = invert_matrix(basis_rows(G, basis))
            age = 0
            if not regular:
                return basis, weights, x, -1
    return basis, weights, x, -1
