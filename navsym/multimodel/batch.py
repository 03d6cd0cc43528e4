"""Monte-Carlo batches: many series of measurements through one bank."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import NotFiniteError, ShapeError
from navsym.multimodel.bank import Bank
from navsym.multimodel.compiled import independent_scalars
from navsym.multimodel.filters import run_filter
from navsym.multimodel.kalman import logs
from navsym.multimodel.schemes import require_room, scheme

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
        bank = (models.F, models.Q, H, r, U, rotated, models.mode_transition)
        start = (logs(models.probabilities), models.means, models.covariances)
        fine = run_all(branching, bank, start, z, tuple(out))
    return bool(fine)


def one_by_one(models: Bank, z: Array, method: str, depth: int | None) -> Batch:
    """Every run through the single-run engine: folding schemes, and series at which lanes stop."""
    out = empty(z, models)
    for row, series in enumerate(z):
        estimate = run_filter(models, series, method, depth=depth, engine="compiled")
        for target, name in zip(out, ("mean", "covariance", "probabilities", "log_likelihood"), strict=True):
            target[row] = getattr(estimate, name)
    return out
