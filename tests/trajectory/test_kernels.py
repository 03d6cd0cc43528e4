"""The compiled loops of tracks: identities of a step, and a smoother with covariances in 80 digits beside the roots."""

from __future__ import annotations

import math

import mpmath as mp
import numpy as np
import pytest
from numpy.testing import assert_allclose

from navsym.trajectory.kernels.tracks import backward, forward, noise_root, noise_shape, transition


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


def run_of(t, z, r, q, spread):
    """The compiled filter and smoother: states, covariances."""
    N, n = len(t), len(spread)
    states, gains, roots = np.empty((N, n)), np.empty((N, n)), np.empty((N, n, n))
    rest = np.empty(N), np.empty(N), np.empty(N, dtype=np.int64)
    forward(t, z, r, np.ones(N, np.int64), q, spread, 0.0, states, roots, gains, *rest)
    backward(t, states, roots, q)
    return states, np.einsum("kmi,kmj->kij", roots, roots)


@pytest.mark.parametrize("n", [2, 3, 5])
def test_noise_of_two_steps_is_noise_of_the_whole(n):
    (whole_Phi, whole), (Phi1, Q1), (Phi2, Q2) = (compiled_step(dt, 0.3, n) for dt in (1.7, 0.6, 1.1))
    assert_allclose(Phi2 @ Phi1, whole_Phi, rtol=1e-13)
    assert_allclose(Phi2 @ Q1 @ Phi2.T + Q2, whole, rtol=1e-12)


def compiled_step(dt, q, n):
    Phi, root = np.empty((n, n)), np.empty((n, n))
    transition(dt, Phi)
    noise_root(dt, q, noise_shape(n), root)
    return Phi, root.T @ root


@pytest.mark.parametrize("n", [2, 3, 4, 5, 6])
@pytest.mark.parametrize("dt", [1e-9, 0.02, 7.0, 1e9])
def test_the_root_of_the_noise_gives_the_noise(n, dt):
    for found, expected in zip(compiled_step(dt, 0.3, n), step_of(dt, 0.3, n), strict=True):
        assert_allclose(found, expected, rtol=1e-13)


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
    assert_allclose(np.diagonal(covariances, axis1=1, axis2=2), variances, rtol=1e-5)
    assert (np.abs(states - means) < 1e-4 * np.sqrt(variances) + 1e-13 * np.abs(means)).all()


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
    assert_allclose(states, solved, atol=1e-8)
    blocks = np.linalg.inv(information).reshape(N, n, N, n)[np.arange(N), :, np.arange(N), :]
    assert_allclose(covariances, blocks, atol=1e-8)
