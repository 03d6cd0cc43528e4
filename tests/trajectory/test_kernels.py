"""The compiled loops of tracks: identities of a step, and a smoother with covariances in 80 digits beside the roots."""

from __future__ import annotations

import itertools
import math

import mpmath as mp
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import expm

from navsym.trajectory.kernels.tracks import ROWS, backward, forward, noise_root, respond, transition


def step_of(dt, q, n):
    """Transition and noise matrices of a step by their formulas."""
    Phi, Q = np.zeros((n, n)), np.zeros((n, n))
    for i in range(n):
        for j in range(n):
            power, divisor = 2 * n - 1 - i - j, math.factorial(n - 1 - i) * math.factorial(n - 1 - j)
            Q[i, j] = q * dt**power / (power * divisor)
            Phi[i, j] = dt ** (j - i) / math.factorial(j - i) if j >= i else 0.0
    return Phi, Q


def smoothed_exactly(t, z, r, q, spread):
    """The same smoother with covariances, in 80 digits: means (N, n), variances (N, n)."""
    N, n = len(t), len(spread)
    with mp.workdps(80):
        y, P, filtered, ahead = mp.matrix(n, 1), mp.diag([mp.mpf(s) ** 2 for s in spread]), [], []
        y[0] = mp.mpf(z[0])
        for k in range(N):
            Phi = mp.eye(n)
            if k:
                Phi, Q = (mp.matrix(n, n), mp.matrix(n, n))
                dt = mp.mpf(t[k]) - mp.mpf(t[k - 1])
                for i in range(n):
                    for j in range(n):
                        power = 2 * n - 1 - i - j
                        Q[i, j] = q * dt**power / (power * mp.factorial(n - 1 - i) * mp.factorial(n - 1 - j))
                        Phi[i, j] = dt ** (j - i) / mp.factorial(j - i) if j >= i else 0
                y, P = Phi * y, Phi * P * Phi.T + Q
            ahead.append((y, P, Phi))
            gain = P[:, 0] / (P[0, 0] + mp.mpf(r[k]))
            y, P = y + gain * (mp.mpf(z[k]) - y[0]), P - gain * P[0, :]
            filtered.append((y, P))
        found = [filtered[-1]]
        for k in range(N - 2, -1, -1):
            (y, P), (y1, P1, Phi) = filtered[k], ahead[k + 1]
            C = P * Phi.T * P1**-1
            found.insert(0, (y + C * (found[0][0] - y1), P + C * (found[0][1] - P1) * C.T))
        return (
            np.array([[float(v) for v in y] for y, _ in found]),
            np.array([[float(P[i, i]) for i in range(n)] for _, P in found]),
        )


def run_of(t, z, r, q, spread, c=0.0, rate=0.0, tau=1.0, w=0.0, lasting=1.0, fading=0.0, use=1):
    """The compiled filter and smoother: states and covariances of motion, coloured error and rate of the drift."""
    N, n = len(t), len(spread)
    states, gains, roots = np.empty((N, n + 2)), np.empty((N, n + 2)), np.empty((N, n + 2, n + 2))
    rest = np.empty(N), np.empty(N), np.empty(N), np.empty(N, dtype=np.int64)
    c, w, model = (
        np.broadcast_to(c, N).astype(float),
        np.broadcast_to(w, N).astype(float),
        [q, rate, tau, lasting, fading],
    )
    model = np.array(model)
    forward(t, z, r, c, w, np.full(N, use), model, spread, 0.0, states, roots, gains, *rest)
    backward(t, c, w, rest[2], n, states, roots, model)
    return states, np.einsum("kmi,kmj->kij", roots, roots)


@pytest.mark.parametrize("n", [2, 3, 5])
@pytest.mark.parametrize("rate", [0.0, 1e-3, 0.7, 30.0])
def test_noise_of_two_steps_is_noise_of_the_whole(n, rate):
    (whole_Phi, whole), (Phi1, Q1), (Phi2, Q2) = (compiled_step(dt, 0.3, n, rate) for dt in (1.7, 0.6, 1.1))
    assert_allclose(Phi2 @ Phi1, whole_Phi, rtol=1e-12, atol=1e-300)
    assert_allclose(Phi2 @ Q1 @ Phi2.T + Q2, whole, rtol=1e-5 if rate else 1e-12)


@pytest.mark.parametrize("n", [2, 3, 6])
@pytest.mark.parametrize("x", [1e-3, 0.4, 2.9, 3.1, 50.0])
def test_the_response_of_a_motion_that_forgets_is_the_matrix_exponential(n, x):
    A = np.diag(np.ones(n - 1), 1)
    A[-1, -1] = -x
    g = np.empty(n)
    respond(1.0, x, g)
    assert_allclose(g, expm(A)[:, -1], rtol=1e-11)


def compiled_step(dt, q, n, rate=0.0):
    Phi, rows, g = np.empty((n, n)), np.empty((ROWS, n)), np.empty(n)
    transition(dt, rate, Phi, g)
    noise_root(dt, rate, rows, g)
    return Phi, q * rows[:n].T @ rows[:n]


@pytest.mark.parametrize("n", [2, 3, 4, 5, 6])
@pytest.mark.parametrize("dt", [1e-9, 0.02, 7.0, 1e9])
def test_the_root_of_the_noise_gives_the_noise(n, dt):
    for found, expected in zip(compiled_step(dt, 0.3, n), step_of(dt, 0.3, n), strict=True):
        assert_allclose(found, expected, rtol=1e-13)


@pytest.mark.long
@pytest.mark.parametrize("n", [2, 3, 5])
@pytest.mark.parametrize("ratio", [1.0, 1e4, 1e9])
def test_a_first_spread_far_above_the_noise_costs_no_digits(n, ratio):
    """With covariances instead of roots the variances at 1e9 are wrong by factors of thousands, or negative."""
    rng = np.random.default_rng(n)
    t, sigma = np.cumsum(rng.uniform(0.5, 1.5, 15)), 1e-2
    z, r = 100.0 * t + sigma * rng.normal(size=15), np.full(15, sigma**2)
    spread = np.array([1.0, *([sigma * ratio] * (n - 1))])
    states, covariances = run_of(t, z, r, 1e-6, spread)
    means, variances = smoothed_exactly(t, z, r, 1e-6, spread)
    assert_allclose(np.diagonal(covariances, axis1=1, axis2=2)[:, :n], variances, rtol=1e-5)
    assert (np.abs(states[:, :n] - means) < 1e-4 * np.sqrt(variances) + 1e-13 * np.abs(means)).all()


def test_the_smoother_is_the_least_squares_fit_of_all_data():
    """Filter and smoother against one big linear system of prior, motion and measurements."""
    rng = np.random.default_rng(2)
    N, n, q = 25, 2, 0.4
    t = np.cumsum(rng.uniform(0.3, 2.0, N))
    z, r, spread = rng.normal(size=N), rng.uniform(0.5, 2.0, N), np.array([10.0, 5.0])
    states, covariances = run_of(t, z, r, q, spread)
    information, vector = np.zeros((N * n, N * n)), np.zeros(N * n)
    information[:n, :n] += np.diag(spread**-2.0)
    vector[0] += z[0] / spread[0] ** 2  # the filter starts at the first measurement
    for k in range(N):
        information[k * n, k * n] += 1 / r[k]
        vector[k * n] += z[k] / r[k]
        if k:
            Phi, Q = step_of(t[k] - t[k - 1], q, n)
            rows = np.zeros((n, N * n))
            rows[:, (k - 1) * n : k * n], rows[:, k * n : (k + 1) * n] = -Phi, np.eye(n)
            information += rows.T @ np.linalg.inv(Q) @ rows
    solved = np.linalg.solve(information, vector).reshape(N, n)
    assert_allclose(states[:, :n], solved, atol=1e-8)
    blocks = np.linalg.inv(information).reshape(N, n, N, n)[np.arange(N), :, np.arange(N), :]
    assert_allclose(covariances[:, :n, :n], blocks, atol=1e-8)


def dense_smoother(t, z, r, q, spread, c, rate, tau, w=0.0, lasting=1.0):
    """Mean and variance (N,) of the speed from the joint covariance of all rows: two states, no recursion.

    The speed is an Ornstein-Uhlenbeck process from a first spread, the position its integral; errors are white of
    variance r, coloured with covariance c_i c_j exp(-|t_i - t_j|/tau), and integrals from the first row of a rate with
    covariance w^2 exp(-|t - s|/lasting).
    """
    grid = np.concatenate([np.linspace(a, b, 9)[:-1] for a, b in itertools.pairwise(t)] + [t[-1:]])
    at = np.searchsorted(grid, t)
    P = np.diag(np.square(spread))
    blocks, states = [P], [np.eye(2)]
    for dt in np.diff(grid):
        Phi = np.array([[1.0, -math.expm1(-rate * dt) / rate], [0.0, math.exp(-rate * dt)]])
        e, E = -math.expm1(-rate * dt), -math.expm1(-2 * rate * dt)
        Q = np.array([[(dt - 2 * e / rate + E / (2 * rate)) / rate**2, e**2 / (2 * rate**2)], [0, E / (2 * rate)]])
        Q[1, 0] = Q[0, 1]
        blocks.append(Phi @ blocks[-1] @ Phi.T + q * Q)
        states.append(Phi @ states[-1])
    N = len(t)
    K = np.empty((2 * N, 2 * N))
    for i in range(N):
        for j in range(i + 1):
            move = states[at[i]] @ np.linalg.inv(states[at[j]])
            K[2 * i : 2 * i + 2, 2 * j : 2 * j + 2] = move @ blocks[at[j]]
            K[2 * j : 2 * j + 2, 2 * i : 2 * i + 2] = (move @ blocks[at[j]]).T
    errors = np.diag(r) + np.outer(c, c) * np.exp(-np.abs(t[:, None] - t) / tau)
    since = (t - t[0]) / lasting
    first, far = np.minimum(since[:, None], since), np.abs(since[:, None] - since)
    errors += (w * lasting) ** 2 * (2 * first - 1 + np.exp(-since[:, None]) + np.exp(-since) - np.exp(-far))
    gain = np.linalg.solve(K[::2, ::2] + errors, K[::2, 1::2]).T
    return gain @ (z - z[0]), np.diag(K[1::2, 1::2] - gain @ K[::2, 1::2])


def test_coloured_errors_and_a_motion_that_forgets_are_smoothed_as_by_the_joint_covariance():
    """The filter with one more state against all rows at once; without the colour the variances are others."""
    rng = np.random.default_rng(4)
    t = np.cumsum(rng.uniform(0.3, 1.5, 14))
    z, r, c = rng.normal(size=14), rng.uniform(0.1, 0.4, 14), rng.uniform(0.5, 2.0, 14)
    spread, q, rate, tau = np.array([8.0, 5.0]), 0.6, 0.4, 3.0
    states, covariances = run_of(t, z, r, q, spread, c, rate, tau)
    mean, variance = dense_smoother(t, z, r, q, spread, c, rate, tau)
    assert_allclose(states[:, 1], mean, atol=1e-6)
    assert_allclose(covariances[:, 1, 1], variance, rtol=1e-6)
    white = run_of(t, z, r, q, spread, 0.0, rate, tau)[1]
    assert (variance > 1.2 * white[:, 1, 1]).all()


@pytest.mark.parametrize("w, lasting", [(0.7, 2.5), (3.0, 0.05), (0.2, 400.0)])
def test_errors_that_drift_are_smoothed_as_by_the_joint_covariance(w, lasting):
    """An integrated Markov process, short and long beside the steps; without it the variances are others."""
    rng = np.random.default_rng(5)
    t = np.cumsum(rng.uniform(0.3, 1.5, 14))
    z, r, c = rng.normal(size=14), rng.uniform(0.1, 0.4, 14), rng.uniform(0.5, 2.0, 14)
    spread, q, rate, tau = np.array([8.0, 5.0]), 0.6, 0.4, 3.0
    states, covariances = run_of(t, z, r, q, spread, c, rate, tau, w, lasting)
    mean, variance = dense_smoother(t, z, r, q, spread, c, rate, tau, w, lasting)
    assert_allclose(states[:, 1], mean, atol=1e-6)
    assert_allclose(covariances[:, 1, 1], variance, rtol=1e-6)
    steady = run_of(t, z, r, q, spread, c, rate, tau)[1]
    assert (variance > 1.01 * steady[:, 1, 1]).all()


def test_the_rate_of_the_drift_has_the_deviation_of_each_row():
    """Better positions shrink the rate at once, worse ones add to it, and no measurement is needed for either."""
    t, w = np.cumsum(np.full(9, 0.7)), np.array([1.0, 1.0, 3.0, 0.1, 0.1, 5.0, 0.2, 0.01, 2.0])
    covariances = run_of(t, np.zeros(9), np.ones(9), 1.0, np.array([1.0, 1.0]), 0.5, 0.2, 3.0, w, 2.0, use=0)[1]
    assert_allclose(covariances[:, 3, 3], w**2, rtol=1e-9, atol=1e-15)


def test_a_drift_that_fades_is_part_of_the_coloured_error():
    """With a colour that neither forgets nor follows, both kinds are one; one that forgets bounds what has drifted."""
    rng = np.random.default_rng(6)
    t, spread = np.cumsum(rng.uniform(0.3, 1.5, 14)), np.array([8.0, 5.0])
    z, r = rng.normal(size=14), rng.uniform(0.1, 0.4, 14)
    stays, fades = (run_of(t, z, r, 0.6, spread, 1.0, 0.4, 1e9, 0.7, 2.5, kind) for kind in (0.0, 1.0))
    assert_allclose(fades[0][:, :2], stays[0][:, :2], atol=1e-5)
    assert_allclose(fades[1][:, :2, :2], stays[1][:, :2, :2], rtol=1e-5)
    free = run_of(np.arange(200.0), np.zeros(200), np.ones(200), 1e-9, spread, 1.0, 0.4, 2.0, 0.7, 2.5, 1.0, use=0)[1]
    assert free[-1, 2, 2] < 30 and np.abs(np.diff(free[100:, 2, 2])).max() < 1e-9
