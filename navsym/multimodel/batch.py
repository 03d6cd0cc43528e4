"""Monte-Carlo batches: many series of measurements through one bank."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import NotFiniteError, ShapeError
from navsym.multimodel.bank import Bank
from navsym.multimodel.compiled import independent_scalars
from navsym.multimodel.doubt import ROUNDING, disagreements, in_units, moments, other_units
from navsym.multimodel.filters import UNUSED, run_filter
from navsym.multimodel.kalman import logs
from navsym.multimodel.schemes import require_room, scheme

Array = NDArray[np.floating[Any]]
#: mean (runs, T, n), covariance (runs, T, n, n), probabilities (runs, T, m), cumulative log-likelihood (runs, T)
Batch = tuple[Array, Array, Array, Array]

IN_LANES = {"pulsating": 0, "imm": 1, "polygaussian": 2}


def run_batch(models: Bank, measurements: Any, method: str = "imm", *, depth: int | None = None) -> Batch:
    """Filter ``measurements`` (runs, T, p) without gaps; any method, eight runs at a time where lanes fit.

    Runs at which doubles lose their digits are filtered one by one, with a hundred digits where that is possible and
    a warning where it is not.

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
    out = empty(z, models)
    every = np.arange(len(z))
    if method not in IN_LANES or (method == "pulsating" and not models.common):
        return one_by_one(models, z, method, depth, out, every)
    units, twin, lanes = other_units(models), empty(z, models), IN_LANES[method]
    if not (in_lanes(models, z, lanes, out) and in_lanes(in_units(models, *units), z * units[1], lanes, twin)):
        return one_by_one(models, z, method, depth, out, every)
    doubt = disagreements(out, twin, z, *units).max(axis=1)
    # Two runs of one program may err alike in a short series; the readable engine errs in another way.
    single = run_filter(models, z[0], method, engine="compiled")
    if single.engine == "digits":
        doubt[:] = np.inf
    return one_by_one(models, z, method, depth, out, np.flatnonzero(doubt > ROUNDING))


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


def one_by_one(models: Bank, z: Array, method: str, depth: int | None, out: Batch, rows: NDArray[np.intp]) -> Batch:
    """``out`` with these runs by the single-run engine: folding schemes, and series at which lanes stop or err."""
    for row in rows:
        estimate = run_filter(models, z[row], method, depth=depth, engine="compiled")
        for target, value in zip(out, moments(estimate), strict=True):
            target[row] = value
        for note in set(estimate.notes) - {UNUSED} if estimate.engine != "digits" else ():
            warnings.warn(f"run {row}: {note}", stacklevel=3)
    return out
