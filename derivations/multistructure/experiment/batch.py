"""Monte-Carlo batches: many series of measurements through one bank."""

import warnings
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import NotFiniteError, ShapeError
from navsym.multimodel.bank import Bank
from navsym.multimodel.compiled import run_compiled
from navsym.multimodel.doubt import ROUNDING, disagreements, in_units, moments, other_units
from navsym.multimodel.engine import Estimates
from navsym.multimodel.filters import UNUSED, run_filter
from navsym.multimodel.schemes import require_room, scheme

Array = NDArray[np.floating[Any]]
#: mean (runs, T, n), covariance (runs, T, n, n), probabilities (runs, T, m), cumulative log-likelihood (runs, T)
Batch = tuple[Array, Array, Array, Array]


def run_batch(models: Bank, measurements: Any, method: str = "imm", *, depth: int | None = None) -> Batch:
    """Filter ``measurements`` (runs, T, p) without gaps, by any method.

    Runs at which doubles lose their digits are filtered one by one, with a hundred digits where that is possible and
    a warning where it is not.

    Raises ShapeError, NotFiniteError, and the errors of :func:`navsym.multimodel.filters.run_filter`.
    """
    z = np.array(measurements, dtype=float, order="C")
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
    count = require_room(rule, models.modes, models.states, 1 if models.common else models.modes, z.shape[1])
    units, out, twin = other_units(models), empty(z, models), empty(z, models)

    def run(bank: Bank, series: Array, target: Batch) -> NDArray[np.bool_]:
        found = [run_compiled(rule, bank, row, count) for row in series]
        put(target, found, range(len(found)))
        return np.array([not estimate.singular for estimate in found])

    with np.errstate(all="ignore"):  # what leaves the range is doubtful
        fine = run(models, z, out) & run(in_units(models, *units), z * units[1], twin)
    doubt = np.where(fine, disagreements(out, twin, z, *units).max(axis=1), np.inf)
    # Two runs of one program may err alike in a short series; the readable engine errs in another way.
    if run_filter(models, z[0], method, depth=depth, engine="compiled").engine == "digits":
        doubt[:] = np.inf
    doubtful = np.flatnonzero(doubt > ROUNDING)
    settled = [run_filter(models, z[row], method, depth=depth, engine="compiled") for row in doubtful]
    put(out, settled, doubtful)
    for row, estimate in zip(doubtful, settled, strict=True):
        for note in set(estimate.notes) - {UNUSED} if estimate.engine != "digits" else ():
            warnings.warn(f"run {row}: {note}", stacklevel=2)
    return out


def empty(z: Array, models: Bank) -> Batch:
    """Arrays for the answer."""
    runs, T, _ = z.shape
    n, m = models.states, models.modes
    return np.empty((runs, T, n)), np.empty((runs, T, n, n)), np.empty((runs, T, m)), np.empty((runs, T))


def put(out: Batch, found: Sequence[Estimates], rows: Iterable[int]) -> None:
    """Put estimates into rows of ``out``."""
    for row, estimate in zip(rows, found, strict=True):
        for target, value in zip(out, moments(estimate), strict=True):
            target[row] = value
