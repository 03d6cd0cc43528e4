"""The two steps of the Kalman filter, for one estimate and for a stack of them.

Everything that a bank of filters needs from one of its members: prediction, correction in
Joseph's form, and the log-likelihood of the innovation, which is what (18) of the
multi-structure paper weighs the members by. Stacks ``(..., n)`` go through the same code.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating[Any]]

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
    gain = transposed(solve_factored(factor, H @ P))
    with np.errstate(over="ignore", invalid="ignore"):
        corrected = mean + times(gain, innovation)
    L = np.eye(mean.shape[-1]) - gain @ H
    joseph = symmetrise(L @ P @ transposed(L) + gain @ R @ transposed(gain))
    chosen = np.where(usable[..., None], corrected, mean)
    return chosen, np.where(usable[..., None, None], joseph, P), np.where(usable, log_likelihood, -np.inf)


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
    log_root = np.log(np.diagonal(factor, axis1=-2, axis2=-1)).sum(axis=-1)
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


def solve_factored(factor: Array, B: Array) -> Array:
    """``S^-1 B`` for ``S = L L^T``."""
    return np.linalg.solve(transposed(factor), np.linalg.solve(factor, B))


def times(A: Array, x: Array) -> Array:
    """``A x`` for stacks of matrices (..., m, n) and vectors (..., n)."""
    return (A @ x[..., None])[..., 0]


def transposed(A: Array) -> Array:
    """Every matrix of a stack transposed."""
    return np.swapaxes(A, -1, -2)


def scalar_corrections(z: Array, H: Array, R: Array) -> tuple[Array, Array, Array]:
    """Independent scalar measurements that say the same: rotate z, H by the eigenvectors of R.

    z : (p,), H : (p, n), R : (p, p)  ->  z' (p,), H' (p, n), variances (p,).
    A rotation leaves densities as they are, so likelihoods need no factor. A diagonal R is not touched.
    """
    diagonal = np.diagonal(R)
    if np.count_nonzero(R - np.diag(diagonal)) == 0:
        return z, H, diagonal.copy()
    variances, rotation = np.linalg.eigh(R)
    return rotation.T @ z, rotation.T @ H, np.maximum(variances, 0.0)
