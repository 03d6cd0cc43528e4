"""Plain twins of the compiled adaptive filters: one candidate at a time, matrices as in the textbook."""

from __future__ import annotations

from itertools import product

import numpy as np

from navsym.core.arrays import Array
from navsym_papers.trajectory.experiment.inversion import AdaptiveRun, Start, SteppedModel, Tuning


def candidates(q: Array, step: float) -> list[Array]:
    """The 3^n diagonals around q, q itself first; the first element changes fastest."""
    factors = (1.0, 1 / step, step)
    return [q * np.array(choice[::-1]) for choice in product(factors, repeat=len(q))]


def criterion_of(
    tuning: Tuning, model: SteppedModel, innovation: float, S: float, before: Array, after: Array, z: float
) -> float:
    """J of the paper or minus twice the log likelihood (up to a constant) of one candidate."""
    if tuning.criterion == "likelihood":
        return float(np.log(S) + innovation**2 / S)
    # The measured value of the state after the step has the first entry only.
    residual = innovation if tuning.criterion == "predicted" else z - model.row[0] * after[0]
    a, b, c = tuning.weights
    change = after - before
    return float(a * residual**2 + b * change[1] ** 2 + (c * change[2] ** 2 if len(after) > 2 else 0.0))


def adaptive_filter_slowly(z: Array, model: SteppedModel, start: Start, tuning: Tuning) -> AdaptiveRun:
    """Twin of ``adaptive_filter``: every candidate by its own matrices."""
    y, P, q = start.estimate.copy(), start.P.copy(), start.Q.copy()
    h, stop = model.gain_row, len(z) if tuning.stop is None else tuning.stop
    gain = np.zeros(model.order)
    record: list[tuple[Array, Array, Array, float]] = []
    for k, measured in enumerate(z):
        innovation = float(measured - model.row @ y)
        if k < stop:
            best = None
            for diagonal in candidates(q, tuning.step):
                ahead = model.Phi @ P @ model.Phi.T + np.diag(diagonal)
                S = float(h @ ahead @ h + tuning.R)
                K = ahead @ h / S
                after = model.Phi @ y + K * innovation
                value = criterion_of(tuning, model, innovation, S, y, after, measured)
                if best is None or value < best[0]:
                    best = (value, diagonal, K, after, ahead - np.outer(K, K) * S)
            assert best is not None
            value, q, gain, y, P = best
        else:
            y, value = model.Phi @ y + gain * innovation, innovation**2
        record.append((y, gain, q, value))
    states, gains, diagonals, values = zip(*record, strict=True)
    return AdaptiveRun(np.array(states), np.array(gains), np.array(diagonals), np.array(values))


def windowed_filter_slowly(z: Array, model: SteppedModel, start: Start, tuning: Tuning, *, window: int) -> AdaptiveRun:
    """Twin of ``windowed_filter``: every candidate is an ordinary filter over the window."""
    y, P, q = start.estimate.copy(), start.P.copy(), start.Q.copy()
    record: list[tuple[Array, Array, Array, float]] = []
    for first in range(0, len(z), window):
        part = z[first : first + window]
        runs = [one_filter(part, model, y, P, diagonal, tuning.R) for diagonal in candidates(q, tuning.step)]
        rows = [(s, p @ model.gain_row / tuning.R, q, c) for s, p, c in runs[0]]
        if len(part) == window:
            best = min(range(len(runs)), key=lambda c: runs[c][-1][2])
            y, P, cost = runs[best][-1]
            q = candidates(q, tuning.step)[best]
            # The diagonal in use during the window stays in the record until the next step.
            rows[-1] = (y, P @ model.gain_row / tuning.R, rows[-1][2], cost)
        record += rows
    states, gains, diagonals, values = zip(*record, strict=True)
    return AdaptiveRun(np.array(states), np.array(gains), np.array(diagonals), np.array(values))


def one_filter(
    z: Array, model: SteppedModel, y: Array, P: Array, q: Array, R: float
) -> list[tuple[Array, Array, float]]:
    """Estimates, matrices and running cost of one Kalman filter with constant diagonal Q."""
    h, cost, rows = model.gain_row, 0.0, []
    for measured in z:
        ahead, B = model.Phi @ y, model.Phi @ P @ model.Phi.T + np.diag(q)
        S, innovation = float(h @ B @ h + R), float(measured - h @ ahead)
        K = B @ h / S
        y, P = ahead + K * innovation, B - np.outer(K, K) * S
        cost += np.log(S) + innovation**2 / S
        rows.append((y, P, cost))
    return rows
