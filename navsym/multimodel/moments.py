"""Gaussian mixtures: weights in logarithms, moments in two passes and in one.

Claims (12) and (13) of the multi-structure paper. The one-pass form keeps the paper's promise
that partial estimates need not be stored, without the cancellation of ``E[x x^T] - m m^T``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.multimodel.kalman.steps import symmetrise

Array = NDArray[np.floating[Any]]


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


def merge(weights: Array, means: Array, covariances: Array) -> tuple[Array, Array]:
    """Mean (n,) and covariance (n, n) of a Gaussian mixture of k components.

    weights : (k,), sum one    means : (k, n)    covariances : (k, n, n)
    Twin: :func:`merge_slowly`.
    """
    mean = weights @ means  # multistructure:12*
    spread = means - mean
    covariance = np.einsum("k,kij->ij", weights, covariances)
    covariance += np.einsum("k,ki,kj->ij", weights, spread, spread)  # multistructure:13
    return mean, symmetrise(covariance)


def merge_slowly(weights: Array, means: Array, covariances: Array) -> tuple[Array, Array]:
    """Twin of :func:`merge`: sum over components of w_i (P_i + (x_i - x)(x_i - x)^T)."""
    mean = sum((w * x for w, x in zip(weights, means, strict=True)), np.zeros(means.shape[1]))
    terms = zip(weights, means, covariances, strict=True)
    zero = np.zeros(covariances.shape[1:])
    return mean, sum((w * (P + np.outer(x - mean, x - mean)) for w, x, P in terms), zero)


@dataclass(frozen=True, slots=True, eq=False)
class Moments:
    """Running sums of a mixture: what the paper's averaging adders hold.

    log_weight : log of the sum of the weights so far
    mean       : (n,)   mean so far
    covariance : (n, n) covariance so far, already divided by the sum of the weights
    """

    log_weight: float
    mean: Array
    covariance: Array


def nothing(n: int) -> Moments:
    """Moments before the first component."""
    return Moments(-np.inf, np.zeros(n), np.zeros((n, n)))


def accumulate(sums: Moments, log_weight: float, mean: Array, P: Array) -> Moments:
    """Add one component and forget it: multistructure:accumulate.

    With g the share of the newcomer in the new total and d = mean - old mean:
    ``m + g d`` and ``(1 - g) C + g P + g (1 - g) d d^T``. Every term is semidefinite, nothing is subtracted,
    so no digits are lost where second moments about zero would lose all of them. Weights stay unnormalised
    logarithms until the last component has come.
    """
    if log_weight == -np.inf:
        return sums
    total = float(np.logaddexp(sums.log_weight, log_weight))
    share = float(np.exp(log_weight - total))
    rest = float(np.exp(sums.log_weight - total))
    d = mean - sums.mean
    covariance = rest * sums.covariance + share * P + share * rest * np.outer(d, d)
    return Moments(total, sums.mean + share * d, covariance)


def merge_in_one_pass(weights: Array, means: Array, covariances: Array) -> tuple[Array, Array]:
    """Twin of :func:`merge` that sees every component once."""
    sums = nothing(means.shape[1])
    for log_weight, mean, P in zip(logs(weights), means, covariances, strict=True):
        sums = accumulate(sums, float(log_weight), mean, P)
    return sums.mean, symmetrise(sums.covariance)


def merge_by_second_moments(weights: Array, means: Array, covariances: Array) -> tuple[Array, Array]:
    """The tempting one-pass form ``E[x x^T] - m m^T``; kept to show how it loses digits."""
    mean = weights @ means
    second = np.einsum("k,kij->ij", weights, covariances) + np.einsum("k,ki,kj->ij", weights, means, means)
    return mean, second - np.outer(mean, mean)


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
