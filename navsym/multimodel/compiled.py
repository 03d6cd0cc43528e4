"""The compiled engine: a bank handed to the loops; where they stop, the readable engine goes on."""

from __future__ import annotations

import numpy as np

from navsym.core import arrays
from navsym.multimodel.bank import Bank
from navsym.multimodel.engine import UNDERFLOW, Estimates, run_in_numpy
from navsym.multimodel.kalman import Array, independent_scalars, logs
from navsym.multimodel.kernels.bank import ALL, BY_MODE, CROSS, KEEP, MIXED, OWN, run_bank
from navsym.multimodel.schemes import Scheme, filters_at

BRANCHING = {"cross": CROSS, "mixed": MIXED, "own": OWN}
FOLDING = {"none": KEEP, "all": ALL, "by mode": BY_MODE}
#: Hypotheses above which the loops would copy more than they compute.
WIDEST = 4096


def run_compiled(rule: Scheme, models: Bank, z: Array, count: int) -> Estimates:
    """The same estimate as :func:`navsym.multimodel.engine.run_in_numpy`, to rounding."""
    widest = widest_branching(rule, models, len(z))
    H, r, U, rotated = scalar_models(models)
    partly = np.isnan(z).any(axis=1) & ~np.isnan(z).all(axis=1)
    if widest > WIDEST or (rotated and partly.any()):
        return run_in_numpy(rule, models, z, count)
    T, m, n = len(z), models.modes, models.states
    out = (np.empty((T, m)), np.empty((T, n)), np.empty((T, n, n)), np.empty(T), np.empty(T))
    stopped = run_bank(
        (BRANCHING[rule.branching], FOLDING[rule.folding], rule.period, widest, models.common),
        (models.F, models.Q, H, r, U, rotated),
        (models.mode_transition, logs(models.mode_transition)),
        (logs(models.probabilities), models.means, models.covariances),
        np.array(z, order="C"),
        out,
    )
    if stopped:
        return run_in_numpy(rule, models, z, count)
    return Estimates(
        arrays.freeze(out[0]),
        arrays.freeze(out[1]),
        arrays.freeze(out[2]),
        arrays.freeze(out[3]),
        count,
        tuple(int(k) + 1 for k in np.flatnonzero(out[4] < UNDERFLOW)),
        engine="compiled",
    )


def widest_branching(rule: Scheme, models: Bank, steps: int) -> int:
    """Most hypotheses that any step branches into."""
    roots = 1 if models.common else models.modes
    horizon = range(1, min(steps, 2 * rule.period + 2 if rule.folding != "none" else steps) + 1)
    return max((filters_at(rule, models.modes, roots, k) for k in horizon), default=models.modes)


def scalar_models(models: Bank) -> tuple[Array, Array, Array, bool]:
    """H (T, m, p, n), variances (T, m, p), rotations (T, m, p, p) that make R diagonal, and whether they turn.

    All are copies of one layout that may be written to: loops are compiled again for every other type.
    """
    H, r, rotation = independent_scalars(models.H, models.R)
    turn = np.broadcast_to(np.eye(models.channels), (1, *models.R.shape[1:])) if rotation is None else rotation
    return np.array(H, order="C"), np.array(r, order="C"), np.array(turn, order="C"), rotation is not None
