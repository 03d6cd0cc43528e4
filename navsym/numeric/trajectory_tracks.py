"""Compiled loops for tracks: one channel, uneven times, polynomial motion with a noisy last derivative.

State (position, speed, acceleration, ...), n entries; white noise of density q drives the n-th derivative, so
that over a step dt

    Phi_ij = dt^(j-i) / (j-i)!,   Q_ij = q dt^(2n-1-i-j) / ((2n-1-i-j) (n-1-i)! (n-1-j)!),   i, j = 0..n-1.

Forward filter with bounded influence; Rauch, Tung and Striebel's smoother backwards (Maybeck, vol. 2, ch. 8).
An innovation beyond ``gate`` standard deviations is not cut off but believed less: its variance is raised until it
is exactly at the gate. A wild measurement then does little harm, and a manoeuvre is followed after a few steps.

Products and solutions are written as loops: matrices have at most six rows, and calls of the linear algebra
library would take three times as long to compile at the first start.
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
def predict(Phi: Array, Q: Array, y: Array, P: Array, work: Array) -> None:
    """y <- Phi y and P <- Phi P Phi^T + Q in place, Phi upper triangular; work (n, n) is scratch."""
    n = y.shape[0]
    for i in range(n):
        total = 0.0
        for k in range(i, n):
            total += Phi[i, k] * y[k]
        y[i] = total
        for j in range(n):
            total = 0.0
            for k in range(i, n):
                total += Phi[i, k] * P[k, j]
            work[i, j] = total
    for i in range(n):
        for j in range(i, n):
            total = Q[i, j]
            for k in range(j, n):
                total += work[i, k] * Phi[j, k]
            P[i, j] = total
            P[j, i] = total


@njit(cache=True)
def correct(y: Array, P: Array, gain: Array, innovation: float, noise: float, work: Array) -> None:
    """y and P after a measurement of the first state with variance ``noise``, in place.

    Joseph's form: with a first variance far above that of the measurement the short one fails.
    """
    n = y.shape[0]
    for i in range(n):
        y[i] += gain[i] * innovation
        for j in range(n):
            work[i, j] = (1.0 - gain[0]) * P[0, j] if i == 0 else P[i, j] - gain[i] * P[0, j]
    for i in range(n):
        for j in range(i, n):
            kept = (1.0 - gain[0]) * work[i, 0] if j == 0 else work[i, j] - work[i, 0] * gain[j]
            P[i, j] = kept + noise * gain[i] * gain[j]
            P[j, i] = P[i, j]


@njit(cache=True)
def solve_rows(A: Array, B: Array) -> None:
    """Overwrite B (n, n) by A^-1 B, A is destroyed; Gaussian elimination with row exchanges."""
    n = A.shape[0]
    for step in range(n):
        best = step
        for i in range(step + 1, n):
            if abs(A[i, step]) > abs(A[best, step]):
                best = i
        for j in range(n):
            A[step, j], A[best, j] = A[best, j], A[step, j]
            B[step, j], B[best, j] = B[best, j], B[step, j]
        for i in range(step + 1, n):
            factor = A[i, step] / A[step, step]
            for j in range(n):
                A[i, j] -= factor * A[step, j]
                B[i, j] -= factor * B[step, j]
    for i in range(n - 1, -1, -1):
        for j in range(n):
            total = B[i, j]
            for k in range(i + 1, n):
                total -= A[i, k] * B[k, j]
            B[i, j] = total / A[i, i]


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
    Phi, Q, work = np.empty((n, n)), np.empty((n, n)), np.empty((n, n))
    y, P, gain = np.zeros(n), np.zeros((n, n)), np.empty(n)
    y[0] = z[0]
    for i in range(n):
        P[i, i] = spread[i] * spread[i]
    for k in range(N):
        if k > 0:
            step_matrices(t[k] - t[k - 1], q, Phi, Q)
            predict(Phi, Q, y, P, work)
        S = P[0, 0] + r[k]
        innovation = z[k] - y[0]
        innovations[k], variances[k] = innovation, S
        flags[k] = USED if use[k] else LEFT_OUT
        for i in range(n):
            ahead[k, i], gains[k, i] = y[i], 0.0
            for j in range(n):
                ahead_P[k, i, j] = P[i, j]
        if use[k]:
            noise = r[k]
            if gate > 0.0 and innovation * innovation > gate * gate * S:
                flags[k] = DOUBTED
                S = innovation * innovation / (gate * gate)
                noise = S - P[0, 0]
            for i in range(n):
                gain[i] = P[i, 0] / S
                gains[k, i] = gain[i]
            correct(y, P, gain, innovation, noise, work)
        for i in range(n):
            states[k, i] = y[i]
            for j in range(n):
                covariances[k, i, j] = P[i, j]


@njit(cache=True)
def backward(
    t: Array, ahead: Array, ahead_P: Array, states: Array, covariances: Array, q: float
) -> None:
    """Smooth in place: states (N, n) and covariances (N, n, n) of the filter become those given all data."""
    N, n = states.shape
    Phi, Q = np.empty((n, n)), np.empty((n, n))
    A, C, change = np.empty((n, n)), np.empty((n, n)), np.empty((n, n))
    for k in range(N - 2, -1, -1):
        step_matrices(t[k + 1] - t[k], q, Phi, Q)
        for i in range(n):
            for j in range(n):
                A[i, j] = ahead_P[k + 1, i, j]
                change[i, j] = covariances[k + 1, i, j] - A[i, j]
                total = 0.0
                for m in range(i, n):
                    total += Phi[i, m] * covariances[k, m, j]
                C[i, j] = total
        solve_rows(A, C)  # the transposed gain of the smoother
        for i in range(n):
            total = 0.0
            for m in range(n):
                total += C[m, i] * (states[k + 1, m] - ahead[k + 1, m])
            states[k, i] += total
            for j in range(n):
                total = 0.0
                for m in range(n):
                    total += C[m, i] * change[m, j]
                A[i, j] = total
        for i in range(n):
            for j in range(i, n):
                total = 0.0
                for m in range(n):
                    total += A[i, m] * C[m, j]
                covariances[k, i, j] += total
                covariances[k, j, i] = covariances[k, i, j]


@njit(cache=True)
def misfit(
    t: Array, z: Array, r: Array, use: Flags, q: float, spread: Array, order: int, gate: float
) -> tuple[float, float, int]:
    """Sums over the innovations after the first ``order``: of log S, of innovation^2 / S, and their number.

    With a gate the variance of a wild innovation is raised as in :func:`forward`.
    """
    n = order
    Phi, Q, work = np.empty((n, n)), np.empty((n, n)), np.empty((n, n))
    y, P, gain = np.zeros(n), np.zeros((n, n)), np.empty(n)
    y[0] = z[0]
    for i in range(n):
        P[i, i] = spread[i] * spread[i]
    logs, squares, count, seen = 0.0, 0.0, 0, 0
    for k in range(t.shape[0]):
        if k > 0:
            step_matrices(t[k] - t[k - 1], q, Phi, Q)
            predict(Phi, Q, y, P, work)
        if use[k] == 0:
            continue
        S = P[0, 0] + r[k]
        innovation = z[k] - y[0]
        noise = r[k]
        if gate > 0.0 and innovation * innovation > gate * gate * S:
            S = innovation * innovation / (gate * gate)
            noise = S - P[0, 0]
        if seen >= order:
            logs += np.log(S)
            squares += innovation * innovation / S
            count += 1
        seen += 1
        for i in range(n):
            gain[i] = P[i, 0] / S
        correct(y, P, gain, innovation, noise, work)
    return logs, squares, count
