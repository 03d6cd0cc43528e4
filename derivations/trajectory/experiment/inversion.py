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
from itertools import product
from typing import Literal, get_args

import numpy as np

from navsym.core.arrays import Array, as_array
from navsym.core.errors import DomainError, TooLargeError
from navsym.models.earth import need_order, power_rows
from navsym_papers.trajectory.model import pascal_rows

Form = Literal["printed", "corrected"]
Criterion = Literal["predicted", "corrected", "likelihood"]

CRITERIA = get_args(Criterion)

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


def empty_run(N: int, n: int) -> AdaptiveRun:
    """A run whose arrays are to be filled."""
    return AdaptiveRun(np.empty((N, n)), np.empty((N, n)), np.empty((N, n)), np.empty(N))


def field_around(q: Array, seen: Array, step: float) -> Array:
    """Diagonals (3^k, n) around q: each of the k elements that are seen stays, falls or rises; the first one is q."""
    factors = np.ones((3 ** int(seen.sum()), len(q)))
    # The first element changes fastest.
    factors[:, np.flatnonzero(seen)[::-1]] = list(product((1.0, 1 / step, step), repeat=int(seen.sum())))
    return q * factors


def adaptive_filter(z: Array, model: SteppedModel, start: Start, tuning: Tuning) -> AdaptiveRun:
    """Tune Q anew at every step over its 3^n neighbours by a criterion of that step.

    A candidate q enters through S = h P^- h + R and K = P^- h/S with P^- = Phi P Phi^T + diag q; none needs a
    covariance of its own. Those of an element that the measurement does not see (h_i = 0) are equal.
    z : (N,) measurements at steps 1..N.
    """
    z, h = checked(z, model, start), model.gain_row
    run, gain = empty_run(len(z), model.order), np.zeros(model.order)
    y, P, q = start.estimate, start.P, start.Q
    for k, measured in enumerate(z):
        innovation, ahead, value = measured - model.row @ y, model.Phi @ y, (measured - model.row @ y) ** 2
        if tuning.stop is None or k < tuning.stop:
            predicted = model.Phi @ P @ model.Phi.T
            field = field_around(q, h != 0, tuning.step)
            g = predicted @ h + field * h
            S = g @ h + tuning.R
            J = criterion(tuning, S, g / S[:, None] * innovation, innovation, ahead - y, model.row[0])
            best = int(np.argmin(J))
            q, gain, value = field[best], g[best] / S[best], J[best]
            P = predicted + np.diag(q) - np.outer(gain, gain) * S[best]
        y = ahead + gain * innovation
        run.states[k], run.gains[k], run.diagonals[k], run.values[k] = y, gain, q, value
    return run


def criterion(tuning: Tuning, S: Array, moves: Array, innovation: float, change: Array, first: float) -> Array:
    """The criterion of each candidate; moves (C, n): corrections, change (n,): of the state by the prediction."""
    if tuning.criterion == "likelihood":
        return np.log(S) + innovation**2 / S
    residual = innovation - (first * moves[:, 0] if tuning.criterion == "corrected" else 0.0 * S)
    squares = np.column_stack([residual, (change + moves)[:, 1:3]]) ** 2
    return squares @ np.array(tuning.weights)[: squares.shape[1]]


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

    At the end of each window the likeliest candidate becomes the centre of the next field, its estimate and matrix
    the common start. Inside a window the unchanged candidate, number 0, is reported.
    z : (N,) measurements; window : steps; bounds : range of each element of Q
    Raises DomainError and TooLargeError for windows below one step, starts of another size, and too many candidates.
    """
    z, h = checked(z, model, start), model.gain_row[0]
    if window < 1:
        raise DomainError(f"window: expected at least one step; got {window}; 50 is usual")
    if model.gain_row[1:].any() or h <= 0:
        raise DomainError("model: expected the corrected form; got a gain row with more than one entry; use it")
    run, eye, Phi = empty_run(len(z), model.order), np.eye(model.order), model.Phi
    y, P, q = start.estimate, start.P, start.Q
    for first in range(0, len(z), window):
        field = np.clip(field_around(q, np.ones(model.order, bool), tuning.step), *bounds)
        ys, Ps, cost = np.tile(y, (len(field), 1)), np.tile(P, (len(field), 1, 1)), np.zeros(len(field))
        for k, measured in enumerate(z[first : first + window], first):
            ahead, predicted = ys @ Phi.T, Phi @ Ps @ Phi.T + eye * field[:, None, :]
            g, innovation = predicted[:, :, 0] * h, measured - h * ahead[:, 0]
            S = h * g[:, 0] + tuning.R
            gain = g / S[:, None]
            ys = ahead + gain * innovation[:, None]
            Ps = predicted - gain[:, :, None] * gain[:, None, :] * S[:, None, None]
            cost = cost + np.log(S) + innovation**2 / S
            # P h/R after the correction is the gain, without an inverse.
            run.states[k], run.gains[k], run.diagonals[k], run.values[k] = ys[0], Ps[0, 0] * h / tuning.R, q, cost[0]
        if k + 1 == first + window:
            best = int(np.argmin(cost))
            y, P, q = ys[best], Ps[best], field[best]
            run.states[k], run.gains[k], run.values[k] = y, P[0] * h / tuning.R, cost[best]
    return run


def fixed_gain_filter(z: Array, model: SteppedModel, gain: Array, estimate: Array) -> Array:
    """y_(k+1) = Phi y_k + K (z_(k+1) - row y_k), estimates (N, n).

    z : (N,); gain : (n,) in the variables of the model; estimate : (n,) before the first measurement
    """
    z = as_array("z", z, (None,), "one entry per step")
    gain = as_array("gain", gain, (model.order,), "one entry per state")
    y = as_array("estimate", estimate, (model.order,), "one entry per state")
    states = np.empty((len(z), model.order))
    for k, measured in enumerate(z):
        states[k] = y = model.Phi @ y + gain * (measured - model.row @ y)
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
