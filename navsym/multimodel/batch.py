"""Monte-Carlo batches: many series of measurements through one bank.

:func:`run_batch` is compiled; :func:`imm_in_numpy` is its readable twin, all runs stacked.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import DomainError, NotFiniteError, ShapeError
from navsym.multimodel import filters as multimodel
from navsym.multimodel import moments as mixture
from navsym.multimodel.bank import Bank
from navsym.multimodel.fast import independent_scalars
from navsym.multimodel.kalman import steps as kalman
from navsym.multimodel.kalman.steps import symmetrise
from navsym.multimodel.steps import require_room, scheme

Array = NDArray[np.floating[Any]]
#: mean (runs, T, n), covariance (runs, T, n, n), probabilities (runs, T, m), cumulative log-likelihood (runs, T)
Batch = tuple[Array, Array, Array, Array]

IN_LANES = {"pulsating": 0, "imm": 1, "polygaussian": 2}


def run_batch(models: Bank, measurements: Any, method: str = "imm", *, depth: int | None = None) -> Batch:
    """Filter ``measurements`` (runs, T, p) without gaps; any method, eight runs at a time where lanes fit.

    Raises ShapeError, NotFiniteError, and the errors of :func:`navsym.multimodel.filters.run_filter`.
    """
    z = np.ascontiguousarray(measurements, dtype=float)
    if z.ndim != 3 or z.shape[2] != models.channels or 0 in z.shape:
        raise ShapeError(f"measurements: expected (runs, steps, {models.channels}); got {z.shape}; match H")
    if not np.isfinite(z).all():
        place = tuple(int(i) for i in np.argwhere(~np.isfinite(z))[0])
        raise NotFiniteError(f"measurements: expected finite numbers; got {z[place]} at {place}; run gaps singly")
    if models.horizon is not None and z.shape[1] > models.horizon:
        raise ShapeError(
            f"measurements: expected at most {models.horizon} steps, those for which models are given; "
            f"got {z.shape[1]}; give models for every step"
        )
    rule = scheme(method, depth)
    require_room(rule, models.modes, models.states, 1 if models.common else models.modes, z.shape[1])
    if method not in IN_LANES or (method == "pulsating" and not models.common):
        return one_by_one(models, z, method, depth)
    out = empty(z, models)
    if not in_lanes(models, z, IN_LANES[method], out):
        return one_by_one(models, z, method, depth)
    return out


def empty(z: Array, models: Bank) -> Batch:
    """Arrays for the answer."""
    runs, T, _ = z.shape
    n, m = models.states, models.modes
    return np.empty((runs, T, n)), np.empty((runs, T, n, n)), np.empty((runs, T, m)), np.empty((runs, T))


def in_lanes(models: Bank, z: Array, branching: int, out: Batch) -> bool:
    """Fill ``out`` by the compiled loops; False when a run had to stop."""
    from navsym.multimodel.kernels.batch import run_all

    H, r, U, rotated = independent_scalars(models)
    with np.errstate(all="ignore"):
        fine = run_all(
            branching,
            models.F,
            models.Q,
            H,
            r,
            U,
            rotated,
            models.mode_transition,
            mixture.logs(models.probabilities),
            models.means,
            models.covariances,
            z,
            *out,
        )
    return bool(fine)


def one_by_one(models: Bank, z: Array, method: str, depth: int | None) -> Batch:
    """Every run through the single-run engine: folding schemes, and series at which lanes stop."""
    out = empty(z, models)
    for row, series in enumerate(z):
        estimate = multimodel.run_filter(models, series, method, depth=depth, engine="compiled")
        for target, name in zip(out, ("mean", "covariance", "probabilities", "log_likelihood"), strict=True):
            target[row] = getattr(estimate, name)
    return out


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
