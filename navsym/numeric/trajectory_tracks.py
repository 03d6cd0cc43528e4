"""Compiled loops for tracks: one channel, uneven times, polynomial motion with a noisy last derivative.

State (position, speed, acceleration, ...), n entries; white noise of density q drives the n-th derivative, so
that over a step dt

    Phi_ij = dt^(j-i) / (j-i)!,   Q_ij = q dt^(2n-1-i-j) / ((2n-1-i-j) (n-1-i)! (n-1-j)!),   i, j = 0..n-1.

Forward filter with bounded influence; Rauch, Tung and Striebel's smoother backwards (Maybeck, vol. 2, ch. 8).
An innovation beyond ``gate`` standard deviations is not cut off but believed less: its variance is raised until it
is exactly at the gate. A wild measurement then does little harm, and a manoeuvre is followed after a few steps.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.int64]

#: What happened to a measurement.
USED, LEFT_OUT, DOUBTED = 0, 1, 2


@njit(cache=True)
def step_matrices(dt: float, q: float, Phi: Array, Q: Array) -> None:
    """Write the transition matrix and the noise matrix of a step, both (n, n)."""
    n = Phi.shape[0]
    for i in range(n):
        for j in range(n):
            Phi[i, j] = 0.0
        factor = 1.0
        for j in range(i, n):
            Phi[i, j] = factor
            factor *= dt / (j - i + 1)
    for i in range(n):
        for j in range(n):
            power = 2 * n - 1 - i - j
            value = q * dt**power / power
            for k in range(2, n - i):
                value /= k
            for k in range(2, n - j):
                value /= k
            Q[i, j] = value


@njit(cache=True)
def forward(
    t: Array,
    z: Array,
    r: Array,
    use: Flags,
    q: float,
    spread: Array,
    gate: float,
    ahead: Array,
    ahead_P: Array,
    states: Array,
    covariances: Array,
    gains: Array,
    innovations: Array,
    variances: Array,
    flags: Flags,
) -> None:
    """Filter one channel.

    t, z, r (N,): times, measurements, variances; use (N,): zero leaves the measurement out
    spread (n,) : standard deviations of the first state; gate : largest |innovation| in sigmas, 0 for none
    ahead, states, gains (N, n); ahead_P, covariances (N, n, n); innovations, variances, flags (N,) are filled
    """
    N, n = states.shape
    Phi, Q = np.empty((n, n)), np.empty((n, n))
    y, P = np.zeros(n), np.zeros((n, n))
    for k in range(N):
        if k == 0:
            y[0] = z[0]
            for i in range(n):
                P[i, i] = spread[i] ** 2
        else:
            step_matrices(t[k] - t[k - 1], q, Phi, Q)
            y = Phi @ y
            P = Phi @ P @ Phi.T + Q
            P = (P + P.T) / 2
        S = P[0, 0] + r[k]
        innovation = z[k] - y[0]
        ahead[k], ahead_P[k] = y, P
        innovations[k], variances[k] = innovation, S
        flags[k] = USED if use[k] else LEFT_OUT
        gains[k] = 0.0
        if use[k]:
            noise = r[k]
            if gate > 0.0 and innovation * innovation > gate * gate * S:
                flags[k] = DOUBTED
                S = innovation * innovation / (gate * gate)
                noise = S - P[0, 0]
            gain = P[:, 0] / S
            y = y + gain * innovation
            # Joseph's form: with a first variance far above that of the measurement the short one fails.
            L = np.eye(n)
            L[:, 0] -= gain
            P = L @ P @ L.T + noise * np.outer(gain, gain)
            gains[k] = gain
        states[k], covariances[k] = y, P


@njit(cache=True)
def backward(
    t: Array, ahead: Array, ahead_P: Array, states: Array, covariances: Array, q: float
) -> None:
    """Smooth in place: states (N, n) and covariances (N, n, n) of the filter become those given all data."""
    N, n = states.shape
    Phi, Q = np.empty((n, n)), np.empty((n, n))
    for k in range(N - 2, -1, -1):
        step_matrices(t[k + 1] - t[k], q, Phi, Q)
        C = np.linalg.solve(ahead_P[k + 1], Phi @ covariances[k]).T
        states[k] += C @ (states[k + 1] - ahead[k + 1])
        P = covariances[k] + C @ (covariances[k + 1] - ahead_P[k + 1]) @ C.T
        covariances[k] = (P + P.T) / 2


@njit(cache=True)
def misfit(
    t: Array, z: Array, r: Array, use: Flags, q: float, spread: Array, order: int, gate: float
) -> tuple[float, float, int]:
    """Sums over the innovations after the first ``order``: of log S, of innovation^2 / S, and their number.

    With a gate the variance of a wild innovation is raised as in :func:`forward`.
    """
    n = order
    Phi, Q = np.empty((n, n)), np.empty((n, n))
    y, P = np.zeros(n), np.zeros((n, n))
    y[0] = z[0]
    for i in range(n):
        P[i, i] = spread[i] ** 2
    logs, squares, count, seen = 0.0, 0.0, 0, 0
    for k in range(t.shape[0]):
        if k > 0:
            step_matrices(t[k] - t[k - 1], q, Phi, Q)
            y = Phi @ y
            P = Phi @ P @ Phi.T + Q
        if use[k] == 0:
            continue
        S = P[0, 0] + r[k]
        innovation = z[k] - y[0]
        if gate > 0.0 and innovation * innovation > gate * gate * S:
            S = innovation * innovation / (gate * gate)
        if seen >= order:
            logs += np.log(S)
            squares += innovation * innovation / S
            count += 1
        seen += 1
        gain = P[:, 0] / S
        y = y + gain * innovation
        P = P - np.outer(gain, gain) * S
        P = (P + P.T) / 2
    return logs, squares, count
