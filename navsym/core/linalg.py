"""Small linear algebra that several rooms need.

Each function is the textbook formula in its numerically safe form.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import DomainError

Array = NDArray[np.floating[Any]]


def symmetrise(P: Array) -> Array:
    """The symmetric part ``(P + P^T) / 2``; works on stacks ``(..., n, n)``."""
    return 0.5 * P + 0.5 * np.swapaxes(P, -1, -2)


def cholesky(name: str, P: Array) -> Array:
    """Lower triangle L with ``P = L L^T``; DomainError when P is not positive definite."""
    try:
        return np.linalg.cholesky(P)
    except np.linalg.LinAlgError:
        least = float(np.linalg.eigvalsh(symmetrise(P)).min())
        raise DomainError(
            f"{name}: expected a positive definite matrix; got the eigenvalue {least:.6g}; mend its entries"
        ) from None


def log_determinant(name: str, P: Array) -> float:
    """``log det P`` of a positive definite matrix: twice the logs on the diagonal of its Cholesky factor.

    The determinant itself would overflow for a few hundred large entries.
    """
    return float(2.0 * np.log(np.diagonal(cholesky(name, P))).sum())


def gain(P: Array, H: Array, R: Array) -> tuple[Array, Array]:
    """Kalman gain ``K = P H^T S^-1`` (n, p) and innovation covariance ``S = H P H^T + R`` (p, p)."""
    S = H @ P @ H.T + R
    return np.linalg.solve(S, H @ P).T, S


def joseph(P: Array, K: Array, H: Array, R: Array) -> Array:
    """Covariance (n, n) after a correction with *any* gain K (n, p):  L P L^T + K R K^T,  L = I - K H.

    One product more than P - K S K^T, and symmetric and semidefinite by construction.
    Maybeck, Stochastic Models, Estimation and Control, vol. 1, chapter 5.
    """
    L = np.eye(P.shape[0]) - K @ H
    return symmetrise(L @ P @ L.T + K @ R @ K.T)


def mahalanobis(name: str, innovation: Array, S: Array) -> float:
    """``v^T S^-1 v`` of an innovation v (p,) with covariance S (p, p)."""
    whitened = np.linalg.solve(cholesky(name, S), innovation)
    return float(whitened @ whitened)


def gaussian_log_density(name: str, innovation: Array, S: Array) -> float:
    """``log N(v; 0, S) = -(v^T S^-1 v + log det S + p log 2 pi) / 2``."""
    constant = innovation.shape[0] * float(np.log(2.0 * np.pi))
    return -0.5 * (mahalanobis(name, innovation, S) + log_determinant(name, S) + constant)


def condition_number(A: Array) -> float:
    """Ratio of the largest to the smallest singular value, in double precision; inf when it is zero."""
    values = np.linalg.svd(A, compute_uv=False)
    return float(values[0] / values[-1]) if values[-1] > 0.0 else float("inf")
