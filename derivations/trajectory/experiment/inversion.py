"""The dynamic inversion algorithm: a scalar-measurement filter that tunes its diagonal Q on the way.

Estimates n states of a polynomial motion from measurements z of its coordinate. Two forms:

* ``printed``  : the gain reads the predicted matrix with the row H_p, as printed (trajectory:algorithm.K);
* ``corrected``: with the row H, which belongs to the state after the step (trajectory:algorithm.K*).

In the corrected form a criterion of one step sees only q_1: K = (g + q_1 e_1) / (g_1 + q_1 + R). The other
elements of Q are therefore tuned by :func:`windowed_filter`, which carries every candidate through a window.
"""

import math
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

from navsym.core.arrays import Array, as_array
from navsym.core.errors import DomainError, TooLargeError
from navsym.models.earth import need_order, power_rows
from navsym_papers.trajectory.experiment.transforms import (
    CORRECTED,
    LIKELIHOOD,
    PREDICTED,
    run_fixed_gain,
    tune_one_step,
)
from navsym_papers.trajectory.experiment.windows import tune_by_windows
from navsym_papers.trajectory.model import pascal_rows

Form = Literal["printed", "corrected"]
Criterion = Literal["predicted", "corrected", "likelihood"]

CRITERIA: dict[str, int] = {"predicted": PREDICTED, "corrected": CORRECTED, "likelihood": LIKELIHOOD}

#: 3^9 candidates are 19683; one order more no longer fits the caches.
LARGEST_FIELD = 9


@dataclass(frozen=True, slots=True, eq=False)
class SteppedModel:
    """x_(k+1) = Phi x_k, z_(k+1) = row x_k + noise.

    Phi      : (n, n) upper triangular with unit diagonal
    row      : (n,) row of the measurement after the step, on the state before it (H_p of the paper)
    gain_row : (n,) row with which the gain reads the predicted matrix
    """

    Phi: Array
    row: Array
    gain_row: Array

    def __post_init__(self) -> None:
        n = np.shape(self.Phi)[0]
        put = partial(object.__setattr__, self)
        put("Phi", as_array("Phi", self.Phi, (n, n), "states by states"))
        put("row", as_array("row", self.row, (n,), "one entry per state"))
        put("gain_row", as_array("gain_row", self.gain_row, (n,), "one entry per state"))
        if not np.allclose(np.tril(self.Phi), np.eye(n), rtol=0, atol=0):
            raise DomainError(
                "Phi: expected an upper triangle with ones on the diagonal; got another matrix; use a polynomial motion"
            )

    @property
    def order(self) -> int:
        """n, the number of states."""
        return len(self.row)


@dataclass(frozen=True, slots=True, eq=False)
class Tuning:
    """How Q is searched.

    R         : variance of the measurement, in squared units of z
    step      : factor by which an element of Q may rise or fall at a step, above 1
    criterion : ``predicted`` (J as printed), ``corrected`` (residual after the step) or ``likelihood``
    weights   : (3,) of the residual, of the change of state 2 and of state 3 in J
    stop      : number of tuned steps, after which the gain stays constant; None tunes to the end
    """

    R: float
    step: float = 2.0
    criterion: Criterion = "likelihood"
    weights: tuple[float, float, float] = (1.0, 1.0, 1.0)
    stop: int | None = None

    def __post_init__(self) -> None:
        if not (math.isfinite(self.R) and self.R > 0):
            raise DomainError(f"R: expected a positive variance; got {self.R}; give the noise of z squared")
        if not (math.isfinite(self.step) and self.step > 1):
            raise DomainError(f"step: expected a factor above 1; got {self.step}; 2 is usual")
        if self.criterion not in CRITERIA:
            raise DomainError(f"criterion: expected one of {', '.join(CRITERIA)}; got {self.criterion!r}; choose one")


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """Estimate (n,), its matrix (n, n) and the diagonal of Q (n,) before the first measurement."""

    estimate: Array
    P: Array
    Q: Array

    def __post_init__(self) -> None:
        n = len(np.shape(self.estimate)) and np.shape(self.estimate)[0]
        put = partial(object.__setattr__, self)
        put("estimate", as_array("estimate", self.estimate, (n,), "one entry per state"))
        put("P", as_array("P", self.P, (n, n), "states by states"))
        put("Q", as_array("Q", self.Q, (n,), "one entry per state"))
        if (self.Q < 0).any():
            raise DomainError("Q: expected no negative element; got one; Q is a diagonal of variances")

    def copies(self) -> tuple[Array, Array, Array]:
        """Estimate, P and Q as arrays that a run may overwrite."""
        return self.estimate.copy(), self.P.copy(), self.Q.copy()


@dataclass(frozen=True, slots=True, eq=False)
class AdaptiveRun:
    """What a filter did at steps 1..N.

    states, gains, diagonals : (N, n) estimates, gains in use, diagonals of Q
    values                   : (N,) criterion of the chosen candidate
    """

    states: Array
    gains: Array
    diagonals: Array
    values: Array


# -- models --------------------------------------------------------------------------------------------


def first_stage_model(n: int, form: Form = "corrected") -> SteppedModel:
    """Variables f = D_f x: Pascal's triangle, a row of ones; f_1 in the units of z (trajectory:6.Phif)."""
    need_order(n)
    Phi = np.array(pascal_rows(n), dtype=float)
    return SteppedModel(Phi, np.ones(n), np.ones(n) if form == "printed" else np.eye(n)[0])


def scaled_model(model: SteppedModel, scale: Array) -> SteppedModel:
    """The same motion in the variables scale * f, scale (n,) positive."""
    scale = as_array("scale", scale, (model.order,), "one factor per state")
    return SteppedModel(model.Phi * scale[:, None] / scale, model.row / scale, model.gain_row / scale)


def normalised_scale(n: int) -> Array:
    """D_s: x^q = D_s f, column norms of N_f (trajectory:6.D), (n,)."""
    return np.linalg.norm(np.array(power_rows(n), dtype=float), axis=0)


def metric_scale(n: int, tau: float) -> Array:
    """Factors from f in metres to (m, m/s, m/s^2, ...): j! / tau^j, (n,)."""
    return np.array([math.factorial(j) / tau**j for j in range(n)])


# -- filters ----------------------------------------------------------------------------------------------


def checked(z: Array, model: SteppedModel, start: Start) -> Array:
    """The measurements (N,) as an array.

    Raises TooLargeError for more than :data:`LARGEST_FIELD` states, and DomainError for a start of another size.
    """
    if model.order > LARGEST_FIELD:
        raise TooLargeError(
            f"n: expected at most {LARGEST_FIELD} states, 3^n candidates; got {model.order}; lower the order"
        )
    if start.estimate.shape != (model.order,):
        raise DomainError(f"start: expected {model.order} states; got {len(start.estimate)}; give one per state")
    return as_array("z", z, (None,), "one entry per step")


def empty_run(N: int, n: int) -> tuple[Array, Array, Array, Array]:
    """Arrays for a run to fill: states, gains, diagonals (N, n), and values of the criterion (N,)."""
    return np.empty((N, n)), np.empty((N, n)), np.empty((N, n)), np.empty(N)


def adaptive_filter(z: Array, model: SteppedModel, start: Start, tuning: Tuning) -> AdaptiveRun:
    """Tune Q anew at every step over its 3^n neighbours by a criterion of that step.

    z : (N,) measurements at steps 1..N.
    """
    z = checked(z, model, start)
    out, stop = empty_run(len(z), model.order), len(z) if tuning.stop is None else tuning.stop
    given, weights = (model.Phi, model.gain_row, model.row), np.array(tuning.weights, dtype=float)
    kind = CRITERIA[tuning.criterion]
    tune_one_step(given, float(tuning.R), z, start.copies(), float(tuning.step), weights, kind, stop, out)
    return AdaptiveRun(*out)


def windowed_filter(
    z: Array,
    model: SteppedModel,
    start: Start,
    tuning: Tuning,
    *,
    window: int = 50,
    bounds: tuple[float, float] = (0.0, math.inf),
) -> AdaptiveRun:
    """Tune Q by carrying all 3^n candidates through windows of steps and keeping the likeliest.

    z : (N,) measurements; window : steps; bounds : range of each element of Q
    Raises DomainError and TooLargeError for windows below one step, starts of another size, and too many candidates.
    """
    z = checked(z, model, start)
    if window < 1:
        raise DomainError(f"window: expected at least one step; got {window}; 50 is usual")
    only_first = not model.gain_row[1:].any() and model.gain_row[0] > 0
    if not only_first:
        raise DomainError("model: expected the corrected form; got a gain row with more than one entry; use it")
    out, ends = empty_run(len(z), model.order), [np.full(model.order, b) for b in bounds]
    R, step = float(tuning.R), float(tuning.step)
    tune_by_windows(model.Phi, model.gain_row, R, z, start.copies(), step, window, *ends, out)
    return AdaptiveRun(*out)


def fixed_gain_filter(z: Array, model: SteppedModel, gain: Array, estimate: Array) -> Array:
    """y_(k+1) = Phi y_k + K (z_(k+1) - row y_k), estimates (N, n).

    z : (N,); gain : (n,) in the variables of the model; estimate : (n,) before the first measurement
    """
    z = as_array("z", z, (None,), "one entry per step")
    gain = as_array("gain", gain, (model.order,), "one entry per state")
    states = np.empty((len(z), model.order))
    start = as_array("estimate", estimate, (model.order,), "one entry per state")
    run_fixed_gain(model.Phi, model.row, gain, z, start.copy(), states)
    return states


def steady_gain(model: SteppedModel, R: float, Q: Array, *, rounds: int = 200) -> tuple[Array, Array]:
    """Gain (n,) and matrix (n, n) of the corrected state to which a constant diagonal Q leads.

    Doubling algorithm for the Riccati equation: each round doubles the number of steps.
    """
    n = model.order
    Q = np.diag(as_array("Q", Q, (n,), "one entry per state"))
    h = model.gain_row[:, None]
    A, G, X = model.Phi.T.copy(), h @ h.T / R, Q.copy()
    for _ in range(rounds):
        W = np.linalg.solve(np.eye(n) + G @ X, np.hstack([A, G]))
        step = A.T @ X @ W[:, :n]
        G, A, X = G + A @ W[:, n:] @ A.T, A @ W[:, :n], X + (step + step.T) / 2
        if np.abs(step).max() <= 1e-14 * np.abs(X).max():
            break
    S = float(h[:, 0] @ X @ h[:, 0] + R)
    gain = X @ h[:, 0] / S
    return gain, X - np.outer(gain, gain) * S
