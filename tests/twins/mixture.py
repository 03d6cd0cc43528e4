"""Plain twins of the Gaussian mixtures of navsym.multimodel: one component at a time, in two passes and in one."""

from __future__ import annotations

import numpy as np

from navsym.core.errors import DomainError
from navsym.multimodel import kalman
from navsym.multimodel import kalman as mixture
from navsym.multimodel.bank import Bank
from navsym.multimodel.kalman import Array, logs, symmetrise
from navsym_papers.multistructure.experiment.batch import Batch, empty
from navsym_papers.multistructure.experiment.memory import accumulate, nothing


def merge(weights: Array, means: Array, covariances: Array) -> tuple[Array, Array]:
    """Mean (n,) and covariance (n, n) of a Gaussian mixture of k components.

    weights : (k,), sum one    means : (k, n)    covariances : (k, n, n)
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


def imm_in_numpy(models: Bank, measurements: Array) -> Batch:
    """Twin of :func:`run_batch` for IMM: stacks (runs, modes, ...) through numpy's products.

    Weights in logarithms, Joseph's form; every mode must stay possible (no zero column of transitions).
    """
    if (models.mode_transition.sum(axis=1) <= 0.0).any():
        raise DomainError("mode_transition: expected every mode to be reachable; got a zero column; use run_batch")
    out = empty(measurements, models)
    runs = len(measurements)
    log_w: Array = np.tile(mixture.logs(models.probabilities), (runs, 1))
    x: Array = np.tile(models.means, (runs, 1, 1))
    P: Array = np.tile(models.covariances, (runs, 1, 1, 1))
    total = np.zeros(runs)
    for k in range(measurements.shape[1]):
        x, P, log_next = mixed(log_w, models.at("mode_transition", k + 1), x, P)
        x, P = kalman.predict(x, P, models.at("F", k + 1), models.at("Q", k + 1))
        z = measurements[:, k, None, :]
        x, P, ll = kalman.correct(x, P, z, models.at("H", k + 1), models.at("R", k + 1))
        joint = log_next + ll
        top = joint.max(axis=1, keepdims=True)
        step = top[:, 0] + np.log(np.exp(joint - top).sum(axis=1))
        total = total + step
        log_w = joint - step[:, None]
        weights = np.exp(log_w)
        mean, covariance = merged(weights[:, None, :], x, P)
        for target, value in zip(out, (mean[:, 0], covariance[:, 0], weights, total), strict=True):
            target[:, k] = value
    return out


def mixed(log_w: Array, transition: Array, x: Array, P: Array) -> tuple[Array, Array, Array]:
    """The interaction of IMM for all runs: means, covariances and log P[next mode]."""
    top = log_w.max(axis=1, keepdims=True)
    joint = np.exp(log_w - top)[:, :, None] * transition
    total = joint.sum(axis=1)
    weights = np.swapaxes(joint / total[:, None, :], 1, 2)
    mean, covariance = merged(weights, x, P)
    return mean, covariance, top + mixture.logs(total)


def merged(weights: Array, x: Array, P: Array) -> tuple[Array, Array]:
    """Mixtures of all runs: weights (runs, g, m), x (runs, m, n), P (runs, m, n, n)."""
    mean = weights @ x
    spread = x[:, None] - mean[:, :, None]
    runs, m, n = x.shape
    covariance = (weights @ P.reshape(runs, m, n * n)).reshape(runs, -1, n, n)
    covariance += np.swapaxes(spread * weights[..., None], -1, -2) @ spread
    return mean, np.asarray(symmetrise(covariance))
