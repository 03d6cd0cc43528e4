"""Kalman's two steps on factors of the covariance: arrays by QR, Potter's update, Bierman's U D U^T.

A covariance that is kept as a factor stays semidefinite whatever is rounded, and has twice the digits: what would be
lost at a condition number of 1e16 is lost at 1e32. Roots are upper triangular, ``P = S S^T``; a UD pair is one
array with the unit upper triangle of U above the diagonal and D on it. Stacks ``(..., n, n)`` throughout.
Potter 1963; Bierman, Factorization Methods for Discrete Sequential Estimation, 1977, chapters V-VII.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.multimodel.kalman.steps import LOG_TWO_PI, times, transposed

Array = NDArray[np.floating[Any]]


def root_of(P: Array) -> Array:
    """A factor A (..., n, n) with ``A A^T = P`` for semidefinite P, by eigenvalues; not triangular."""
    values, vectors = np.linalg.eigh(P)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :])


def triangular(A: Array) -> Array:
    """Upper triangular S (..., n, n), diagonal not negative, with ``S S^T = A A^T`` for A (..., n, m).

    By QR of the rows in reversed order: no product of A with itself is ever formed.
    """
    n, m = A.shape[-2:]
    wide = A if m >= n else np.concatenate([A, np.zeros((*A.shape[:-1], n - m))], axis=-1)
    S = transposed(np.asarray(np.linalg.qr(transposed(wide[..., ::-1, :]), mode="r")))[..., ::-1, ::-1]
    signs = np.where(np.diagonal(S, axis1=-2, axis2=-1) < 0.0, -1.0, 1.0)
    return np.asarray(S * signs[..., None, :])


def triangular_root(P: Array) -> Array:
    """Upper triangular root of a semidefinite P."""
    return triangular(root_of(P))


def square(S: Array) -> Array:
    """``S S^T``, symmetric by construction."""
    product = S @ transposed(S)
    return np.asarray(0.5 * (product + transposed(product)))


def predict_root(mean: Array, S: Array, F: Array, Q: Array) -> tuple[Array, Array]:
    """``F m`` and the root of ``F P F^T + Q``: the triangle of [F S, root of Q]."""
    FS = F @ S
    noise = np.broadcast_to(root_of(Q), (*FS.shape[:-1], Q.shape[-1]))
    return times(F, mean), triangular(np.concatenate([FS, noise], axis=-1))


def merge_root(weights: Array, means: Array, roots: Array) -> tuple[Array, Array]:
    """Mean and root of mixtures: weights (g, k), means (k, n), roots (k, n, n) -> (g, n), (g, n, n).

    multistructure:12*, :13 as the triangle of all ``sqrt(w_i) [S_i, x_i - m]`` side by side.
    """
    mean = weights @ means
    g, (k, n) = len(weights), means.shape
    off = means[None] - mean[:, None]
    columns = np.concatenate([np.broadcast_to(roots, (g, k, n, n)), off[..., None]], axis=-1)
    columns = np.sqrt(weights)[..., None, None] * columns
    return mean, triangular(np.moveaxis(columns, 1, 2).reshape(g, n, k * (n + 1)))


def correct_by_qr(mean: Array, S: Array, z: Array, H: Array, R: Array) -> tuple[Array, Array, Array]:
    """Mean, root and log-likelihood from one triangle: rows of [[S, 0], [H S, root of R]].

    In reversed order of its rows the triangle is [[Z, Y], [0, X]] with X X^T the innovation covariance, the gain
    Y X^-1 and Z the corrected root.
    """
    HS = H @ S
    p, n = HS.shape[-2:]
    noise = np.broadcast_to(root_of(R), (*HS.shape[:-2], p, p))
    S = np.broadcast_to(S, (*HS.shape[:-2], n, n))
    upper = np.concatenate([S, np.zeros((*HS.shape[:-2], n, p))], axis=-1)
    T = triangular(np.concatenate([upper, np.concatenate([HS, noise], axis=-1)], axis=-2))
    X, Y, Z = T[..., n:, n:], T[..., :n, n:], T[..., :n, :n]
    spread = np.diagonal(X, axis1=-2, axis2=-1)
    regular = np.asarray((spread > 0.0).all(axis=-1))
    X = np.where(regular[..., None, None], X, np.eye(p))
    white = np.linalg.solve(X, (z - times(H, mean))[..., None])[..., 0]
    distance, volume = squared(white), np.log(np.where(regular[..., None], spread, 1.0)).sum(axis=-1)
    likelihood = -0.5 * (distance + p * LOG_TWO_PI) - volume
    usable = regular & np.isfinite(likelihood)
    with np.errstate(over="ignore", invalid="ignore"):
        corrected = mean + times(Y, white)
    return chosen(usable, corrected, Z, likelihood, mean, S)


def squared(v: Array) -> Array:
    """Sum of squares, infinite without a warning."""
    with np.errstate(over="ignore", invalid="ignore"):
        return np.asarray((v * v).sum(axis=-1))


def chosen(
    usable: NDArray[np.bool_], mean: Array, factor: Array, likelihood: Array, old_mean: Array, old: Array
) -> tuple[Array, Array, Array]:
    """The corrected estimates where the measurement was possible, the old ones and -inf elsewhere."""
    return (
        np.where(usable[..., None], mean, old_mean),
        np.where(usable[..., None, None], factor, old),
        np.where(usable, likelihood, -np.inf),
    )


def rotated(z: Array, H: Array, R: Array) -> tuple[Array, Array, Array]:
    """Independent scalars that say the same: z', H', variances, by the eigenvectors of R; a diagonal R stays."""
    diagonal = np.diagonal(R, axis1=-2, axis2=-1)
    if not np.any(R - diagonal[..., None] * np.eye(R.shape[-1])):
        return z, H, diagonal
    variances, vectors = np.linalg.eigh(R)
    turn = transposed(vectors)
    return times(turn, np.broadcast_to(z, variances.shape)), turn @ H, np.maximum(variances, 0.0)


def by_scalars(update: Any, mean: Array, factor: Array, z: Array, H: Array, R: Array) -> tuple[Array, Array, Array]:
    """Correct by one scalar after another; ``update(factor, h, r)`` gives variance, P h and the new factor."""
    z, H, r = rotated(z, H, R)
    x, made = mean, factor
    likelihood, usable = np.zeros(H.shape[:-2]), np.ones(H.shape[:-2], dtype=bool)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        for c in range(H.shape[-2]):
            h = H[..., c, :]
            innovation = z[..., c] - (h * x).sum(axis=-1)
            variance, cross, made = update(made, h, r[..., c])
            usable = usable & (variance > 0.0)
            safe = np.where(variance > 0.0, variance, 1.0)
            x = x + cross * (innovation / safe)[..., None]
            likelihood = likelihood - 0.5 * (innovation / safe * innovation + np.log(safe) + LOG_TWO_PI)
    usable = usable & np.isfinite(likelihood)
    return chosen(usable, x, made, likelihood, mean, factor)


def potter(S: Array, h: Array, r: Array) -> tuple[Array, Array, Array]:
    """Potter's scalar update of a root: ``S (I - g f f^T)``, f = S^T h, g = 1/(d + sqrt(d r)), d = f^T f + r.

    S (..., n, n), h (..., n), r (...); the new root is not triangular.
    """
    f = (S * h[..., :, None]).sum(axis=-2)
    d = (f * f).sum(axis=-1) + r
    cross = (S * f[..., None, :]).sum(axis=-1)
    scale = np.where(d > 0.0, 1.0 / np.where(d > 0.0, d + np.sqrt(d * r), 1.0), 0.0)
    return d, cross, S - scale[..., None, None] * cross[..., :, None] * f[..., None, :]


def bierman(UD: Array, h: Array, r: Array) -> tuple[Array, Array, Array]:
    """Bierman's scalar update of a UD pair, column by column."""
    n = UD.shape[-1]
    U, D = np.triu(UD, 1) + np.eye(n), np.diagonal(UD, axis1=-2, axis2=-1)
    f = (U * h[..., :, None]).sum(axis=-2)
    v = D * f
    made = np.array(np.broadcast_to(UD, (*v.shape, n)))
    alpha = np.array(np.broadcast_to(r, v.shape[:-1]), dtype=float)
    cross = np.zeros(v.shape)
    for j in range(n):
        before, alpha = alpha, alpha + f[..., j] * v[..., j]
        # Where no variance has come yet (alpha = 0) the column stays as it is.
        safe = np.where(alpha > 0.0, alpha, 1.0)
        made[..., j, j] = np.where(alpha > 0.0, D[..., j] * (before / safe), D[..., j])
        ratio = np.where(before > 0.0, f[..., j] / np.where(before > 0.0, before, 1.0), 0.0)
        column = U[..., :, j].copy()
        made[..., :j, j] = column[..., :j] - ratio[..., None] * cross[..., :j]
        cross = cross + v[..., j, None] * np.where(np.arange(n) <= j, column, 0.0)
    return alpha, cross, made


def ud_of(S: Array) -> Array:
    """UD pair of an upper triangular root; a zero column gives D = 0."""
    n = S.shape[-1]
    diagonal = np.diagonal(S, axis1=-2, axis2=-1)
    unit = np.triu(S, 1) / np.where(diagonal > 0.0, diagonal, 1.0)[..., None, :]
    return np.asarray(unit + (diagonal * diagonal)[..., None] * np.eye(n))


def root_of_ud(UD: Array) -> Array:
    """Upper triangular root ``U sqrt(D)`` of a UD pair."""
    n = UD.shape[-1]
    D = np.diagonal(UD, axis1=-2, axis2=-1)
    return np.asarray((np.triu(UD, 1) + np.eye(n)) * np.sqrt(np.maximum(D, 0.0))[..., None, :])
