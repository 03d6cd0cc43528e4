"""Linear systems over time for the tests of filters, their simulation, and least squares over the whole series."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

STEPS = 24


@dataclass(frozen=True)
class Linear:
    """F, Q (T, n, n), H (T, p, n), R (T, p, p), prior mean (n,) and covariance (n, n)."""

    F: np.ndarray
    Q: np.ndarray
    H: np.ndarray
    R: np.ndarray
    mean: np.ndarray
    P: np.ndarray


def over(value, scale=None):
    """The matrix at every step, times a factor that changes with time."""
    scale = np.ones(STEPS) if scale is None else np.asarray(scale)
    return np.asarray(value, dtype=float)[None] * scale[:, None, None]


def rising():
    return 0.2 + np.arange(STEPS) / 6.0


def pulsing():
    return 1.0 + 0.9 * np.sin(np.arange(STEPS))


def constant_velocity(q_scale=None, r_scale=None):
    F, H = [[1.0, 1.0], [0.0, 1.0]], [[1.0, 0.0]]
    Q = [[1 / 3, 1 / 2], [1 / 2, 1.0]]
    return Linear(over(F), over(Q, q_scale), over(H), over([[4.0]], r_scale), np.zeros(2), np.diag([9.0, 4.0]))


def schuler():
    """Velocity error, tilt and drift in Schuler units, a step of a tenth; only the velocity is measured."""
    c, s = np.cos(0.1), np.sin(0.1)
    F = [[c, -s, c - 1], [s, c, s], [0.0, 0.0, 1.0]]
    Q = np.diag([1e-4, 1e-4, 1e-6])
    return Linear(over(F), over(Q), over([[1.0, 0.0, 0.0]]), over([[0.01]]), np.zeros(3), np.diag([1.0, 1.0, 0.1]))


def no_process_noise():
    case = constant_velocity()
    return Linear(case.F, 0.0 * case.Q, case.H, case.R, case.mean, case.P)


def turning_antenna():
    """A measurement of two numbers whose direction turns, of four states driven through one of them."""
    angle = np.arange(STEPS) * 0.4
    H = np.zeros((STEPS, 2, 4))
    H[:, 0, 0], H[:, 0, 1], H[:, 1, 2] = np.cos(angle), np.sin(angle), 1.0
    F = np.eye(4) + 0.1 * np.diag([1.0, 1.0, 1.0], 1)
    Q = np.zeros((4, 4))
    Q[3, 3] = 0.5
    R = over([[1.0, 0.3], [0.3, 0.5]], pulsing())
    return Linear(over(F), over(Q, rising()), H, R, np.array([1.0, 0.0, -1.0, 0.0]), np.eye(4))


CASES = {
    "constant velocity": constant_velocity(),
    "rising Q": constant_velocity(q_scale=rising()),
    "pulsing R": constant_velocity(r_scale=pulsing()),
    "both over time": constant_velocity(rising(), pulsing()),
    "no process noise": no_process_noise(),
    "Schuler": schuler(),
    "turning antenna": turning_antenna(),
}


def root(covariance):
    """L with L L^T = covariance, also of semidefinite ones."""
    values, vectors = np.linalg.eigh(covariance)
    return vectors * np.sqrt(np.maximum(values, 0.0))


def simulate(case, runs, seed):
    """States (T, runs, n) and measurements (T, runs, p)."""
    rng = np.random.default_rng(seed)
    n, p = case.F.shape[1], case.H.shape[1]
    x = case.mean + rng.standard_normal((runs, n)) @ root(case.P).T
    states, measured = [], []
    for F, Q, H, R in zip(case.F, case.Q, case.H, case.R, strict=True):
        x = x @ F.T + rng.standard_normal((runs, n)) @ root(Q).T
        states.append(x)
        measured.append(x @ H.T + rng.standard_normal((runs, p)) @ root(R).T)
    return np.array(states), np.array(measured)


def batch_least_squares(case, measurements):
    """The last state and its covariance from all measurements (T, p) at once.

    The unknowns are white numbers u of unit variance: the prior is m + L u_0, every disturbance L_k u_k.
    Minimise |u|^2 + sum |R_k^(-1/2) (z_k - H_k x_k(u))|^2 by orthogonal reduction of one tall matrix.
    """
    n, T = case.F.shape[1], len(case.F)
    size = n * (T + 1)
    constant, linear = case.mean.copy(), np.zeros((n, size))
    linear[:, :n] = root(case.P)
    rows, values = [np.eye(size)], [np.zeros(size)]
    for k in range(T):
        constant, linear = case.F[k] @ constant, case.F[k] @ linear
        linear[:, n * (k + 1) : n * (k + 2)] += root(case.Q[k])
        whiten = np.linalg.inv(np.linalg.cholesky(case.R[k]))
        rows.append(whiten @ case.H[k] @ linear)
        values.append(whiten @ (measurements[k] - case.H[k] @ constant))
    Qm, Rm = np.linalg.qr(np.vstack(rows))
    inverse = np.linalg.inv(Rm)
    u = inverse @ (Qm.T @ np.concatenate(values))
    spread = linear @ inverse
    return constant + linear @ u, spread @ spread.T
