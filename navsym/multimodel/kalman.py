"""Gaussian estimates and their mixtures: prediction, correction and merging, of covariances and of their factors.

Stacks ``(..., n)`` go through the same code as one estimate. By the log-likelihood of the innovation, (18) of the
multi-structure paper weighs the members of a bank.

A covariance that is kept as a factor stays semidefinite whatever is rounded, and has twice the digits: what would be
lost at a condition number of 1e16 is lost at 1e32. Roots are upper triangular, ``P = S S^T``; a UD pair is one
array with the unit upper triangle of U above the diagonal and D on it.
Potter 1963; Bierman, Factorization Methods for Discrete Sequential Estimation, 1977, chapters V-VII.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import DomainError

Array = NDArray[np.floating[Any]]
Pair = tuple[Array, Array]

LOG_TWO_PI = float(np.log(2.0 * np.pi))


def symmetrise(P: Array) -> Array:
    """The symmetric part ``(P + P^T) / 2``; works on stacks ``(..., n, n)``."""
    return 0.5 * P + 0.5 * np.swapaxes(P, -1, -2)


def predict(mean: Array, P: Array, F: Array, Q: Array) -> tuple[Array, Array]:
    """One step of ``x(k) = F x(k-1) + w``, cov w = Q:  F m  and  F P F^T + Q.

    mean : (..., n)     P, F, Q : (..., n, n)
    """
    return times(F, mean), symmetrise(F @ P @ transposed(F)) + Q


def correct(mean: Array, P: Array, z: Array, H: Array, R: Array) -> tuple[Array, Array, Array]:
    """Correct by ``z = H x + r``, cov r = R; returns mean, covariance and log-likelihood of z.

    mean : (..., n)   P : (..., n, n)   z : (p,) or (..., p)   H : (..., p, n)   R : (..., p, p)

    The covariance is Joseph's ``L P L^T + K R K^T``, ``L = I - K H``: one product more than
    ``P - K S K^T``, and semidefinite by construction. A singular innovation covariance
    (a perfect measurement of a perfectly known state) gives the log-likelihood -inf and
    leaves the estimate as it was.
    """
    innovation, S = residual(mean, P, z, H, R)
    factor, regular = factor_of(S)
    log_likelihood = log_density(innovation, factor)
    usable = regular & np.isfinite(log_likelihood)
    gain = transposed(np.linalg.solve(transposed(factor), np.linalg.solve(factor, H @ P)))  # S^-1 H P
    with np.errstate(over="ignore", invalid="ignore"):
        corrected = mean + times(gain, innovation)
    L = np.eye(mean.shape[-1]) - gain @ H
    joseph = symmetrise(L @ P @ transposed(L) + gain @ R @ transposed(gain))
    return choose_usable(usable, corrected, joseph, log_likelihood, mean, P)


def residual(mean: Array, P: Array, z: Array, H: Array, R: Array) -> tuple[Array, Array]:
    """Innovation ``v = z - H m`` (..., p) and its covariance ``S = H P H^T + R`` (..., p, p)."""
    return z - times(H, mean), symmetrise(H @ P @ transposed(H)) + R


def log_density(innovation: Array, factor: Array) -> Array:
    """``log N(v; 0, S)`` from the Cholesky factor of S; -inf when v is too large to square.

    multistructure:18, in logarithms, so that 1e-300 is an ordinary number.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        whitened = np.linalg.solve(factor, innovation[..., None])[..., 0]
        distance = (whitened * whitened).sum(axis=-1)
    log_root = np.log(variances(factor)).sum(axis=-1)
    value = -0.5 * (distance + innovation.shape[-1] * LOG_TWO_PI) - log_root
    return np.asarray(np.where(np.isfinite(distance), value, -np.inf))


def factor_of(S: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Cholesky factors of a stack, and which of them exist; the identity stands in for the others."""
    try:
        return np.linalg.cholesky(S), np.ones(S.shape[:-2], dtype=bool)
    except np.linalg.LinAlgError:
        flat = [factor_or_none(one) for one in S.reshape(-1, *S.shape[-2:])]
        regular = np.array([one is not None for one in flat]).reshape(S.shape[:-2])
        factors = np.array([np.eye(S.shape[-1]) if one is None else one for one in flat])
        return factors.reshape(S.shape), regular


def factor_or_none(S: Array) -> Array | None:
    """Cholesky factor, or None. Eigenvalues would not do: positive ones may still have no factor in doubles."""
    try:
        return np.linalg.cholesky(S)
    except np.linalg.LinAlgError:
        return None


def times(A: Array, x: Array) -> Array:
    """``A x`` for stacks of matrices (..., m, n) and vectors (..., n)."""
    return (A @ x[..., None])[..., 0]


def transposed(A: Array) -> Array:
    """Every matrix of a stack transposed."""
    return np.swapaxes(A, -1, -2)


def variances(P: Array) -> Array:
    """Diagonals (..., n) of matrices (..., n, n)."""
    return np.diagonal(P, axis1=-2, axis2=-1)


# Mixtures, their weights in logarithms


def normalise(log_weights: Array) -> tuple[Array, float]:
    """Probabilities (k,) that sum to one, and the log of the sum, from logs of weights.

    The largest weight is taken out first, so that 1e-300, or e^-10000, beside its like is harmless.
    All weights zero: returns zeros and -inf; the caller decides what that means.
    """
    top = float(log_weights.max())
    if not np.isfinite(top):
        return np.zeros_like(log_weights), top
    raw = np.exp(log_weights - top)
    total = float(raw.sum())
    return raw / total, top + float(np.log(total))


def logs(probabilities: Array) -> Array:
    """Logarithms with log 0 = -inf and no warning."""
    with np.errstate(divide="ignore"):
        return np.log(probabilities)


def merge_groups(weights: Array, means: Array, covariances: Array) -> tuple[Array, Array]:
    """Merge several mixtures of the same components at once.

    weights : (g, k), each row sums to one   means : (k, n)   covariances : (k, n, n)
    Returns means (g, n) and covariances (g, n, n).
    """
    mean = weights @ means
    spread = means[None, :, :] - mean[:, None, :]
    covariance = np.einsum("gk,kij->gij", weights, covariances)
    covariance += np.einsum("gk,gki,gkj->gij", weights, spread, spread)
    return mean, symmetrise(covariance)


# Factors of covariances


def root_of(P: Array) -> Array:
    """A factor A (..., n, n) with ``A A^T = P`` for semidefinite P, by eigenvalues of correlations; not triangular."""
    spread = np.sqrt(variances(P))
    safe = np.where(spread > 0.0, spread, 1.0)
    values, vectors = np.linalg.eigh(P / safe[..., None] / safe[..., None, :])
    return np.asarray(safe[..., None] * vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :])


def triangular(A: Array) -> Array:
    """Upper triangular S (..., n, n), diagonal not negative, with ``S S^T = A A^T`` for A (..., n, m).

    By QR of the rows in reversed order: no product of A with itself is ever formed.
    """
    n, m = A.shape[-2:]
    wide = A if m >= n else np.concatenate([A, np.zeros((*A.shape[:-1], n - m))], axis=-1)
    S = transposed(np.asarray(np.linalg.qr(transposed(wide[..., ::-1, :]), mode="r")))[..., ::-1, ::-1]
    signs = np.where(variances(S) < 0.0, -1.0, 1.0)
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
    spread = variances(X)
    regular = np.asarray((spread > 0.0).all(axis=-1))
    X = np.where(regular[..., None, None], X, np.eye(p))
    white = np.linalg.solve(X, (z - times(H, mean))[..., None])[..., 0]
    volume = np.log(np.where(regular[..., None], spread, 1.0)).sum(axis=-1)
    with np.errstate(over="ignore", invalid="ignore"):
        distance, corrected = (white * white).sum(axis=-1), mean + times(Y, white)
    likelihood = -0.5 * (distance + p * LOG_TWO_PI) - volume
    return choose_usable(regular & np.isfinite(likelihood), corrected, Z, likelihood, mean, S)


def choose_usable(
    usable: NDArray[np.bool_], mean: Array, factor: Array, likelihood: Array, old_mean: Array, old: Array
) -> tuple[Array, Array, Array]:
    """The corrected estimates where the measurement was possible, the old ones and -inf elsewhere."""
    return (
        np.where(usable[..., None], mean, old_mean),
        np.where(usable[..., None, None], factor, old),
        np.where(usable, likelihood, -np.inf),
    )


def independent_scalars(H: Array, R: Array) -> tuple[Array, Array, Array | None]:
    """Independent scalar measurements that say the same: H', variances, and the rotation of z by eigenvectors of R.

    H : (..., p, n), R : (..., p, p). A rotation leaves densities as they are, so likelihoods need no factor. Diagonal R
    are not touched, and have no rotation.
    """
    diagonal = variances(R)
    if not np.any(R - diagonal[..., None] * np.eye(R.shape[-1])):
        return H, diagonal, None
    values, vectors = np.linalg.eigh(R)
    return transposed(vectors) @ H, np.maximum(values, 0.0), transposed(vectors)


def by_scalars(update: Any, mean: Array, factor: Array, z: Array, H: Array, R: Array) -> tuple[Array, Array, Array]:
    """Correct by one scalar after another; ``update(factor, h, r)`` gives variance, P h and the new factor."""
    H, r, rotation = independent_scalars(H, R)
    z = z if rotation is None else times(rotation, np.broadcast_to(z, r.shape))
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
    return choose_usable(usable, x, made, likelihood, mean, factor)


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
    U, D = np.triu(UD, 1) + np.eye(n), variances(UD)
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
    diagonal = variances(S)
    unit = np.triu(S, 1) / np.where(diagonal > 0.0, diagonal, 1.0)[..., None, :]
    return np.asarray(unit + (diagonal * diagonal)[..., None] * np.eye(n))


def root_of_ud(UD: Array) -> Array:
    """Upper triangular root ``U sqrt(D)`` of a UD pair."""
    n = UD.shape[-1]
    D = variances(UD)
    return np.asarray((np.triu(UD, 1) + np.eye(n)) * np.sqrt(np.maximum(D, 0.0))[..., None, :])


# The forms in which a filter keeps covariances


@dataclass(frozen=True, slots=True)
class Form:
    """How covariances are kept, (..., n, n) each.

    keep    : P -> what is kept ; show : what is kept -> P
    predict : (mean, kept, F, Q) -> mean, kept
    correct : (mean, kept, z, H, R) -> mean, kept, log-likelihood
    merge   : (weights (g, k), means (k, n), kept (k, n, n)) -> means (g, n), kept (g, n, n)
    """

    name: str
    keep: Callable[[Array], Array]
    show: Callable[[Array], Array]
    predict: Callable[[Array, Array, Array, Array], Pair]
    correct: Callable[[Array, Array, Array, Array, Array], tuple[Array, Array, Array]]
    merge: Callable[[Array, Array, Array], Pair]


def in_ud(moments: Pair) -> Pair:
    """Mean and UD pair of a mean and a root."""
    return moments[0], ud_of(moments[1])


ROOTS = (triangular_root, square, predict_root)
FORMS = {
    "joseph": Form("joseph", lambda P: P, lambda P: P, predict, correct, merge_groups),
    "qr": Form("qr", *ROOTS, correct_by_qr, merge_root),
    "potter": Form("potter", *ROOTS, functools.partial(by_scalars, potter), merge_root),
    "ud": Form(
        "ud",
        lambda P: ud_of(triangular_root(P)),
        lambda UD: square(root_of_ud(UD)),
        lambda mean, UD, F, Q: in_ud(predict_root(mean, root_of_ud(UD), F, Q)),
        functools.partial(by_scalars, bierman),
        lambda weights, means, kept: in_ud(merge_root(weights, means, root_of_ud(kept))),
    ),
}


def form_of(name: str) -> Form:
    """The form of a name; DomainError for another."""
    if not isinstance(name, str) or name not in FORMS:
        raise DomainError(f"form: expected one of {', '.join(FORMS)}; got {name!r}; choose one")
    return FORMS[name]
