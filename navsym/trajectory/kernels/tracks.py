"""Compiled loops for tracks: one channel, uneven times, polynomial motion with a noisy last derivative.

State (position, speed, acceleration, ...), n entries; white noise of density q drives the n-th derivative, so
that over a step dt

    Phi_ij = dt^(j-i) / (j-i)!,   Q_ij = q dt^(2n-1-i-j) / ((2n-1-i-j) (n-1-i)! (n-1-j)!),   i, j = 0..n-1.

Forward filter with bounded influence; Rauch, Tung and Striebel's smoother backwards (Maybeck, vol. 2, ch. 8).
An innovation beyond ``gate`` standard deviations is not cut off but believed less: its variance is raised until it
is exactly at the gate. A wild measurement then does little harm, and a manoeuvre is followed after a few steps.

Covariances are kept as upper triangular roots U, P = U^T U. The first spread of the speed may be 1e9 times the
noise of a position; with P itself such a track loses all digits, variances of the smoother came out negative and
speeds wrong by several of their deviations. The twin with P is in ``tests/trajectory/test_kernels.py``.

Products and solutions are written as loops: matrices have at most six rows, and calls of the linear algebra
library would take three times as long to compile at the first start.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from navsym.core.loops import njit

Array = NDArray[np.float64]
Flags = NDArray[np.int64]

#: What happened to a measurement.
USED, LEFT_OUT, DOUBTED = 0, 1, 2


@njit()
def transition(dt: float, Phi: Array) -> None:
    """Write the transition matrix of a step, (n, n), upper triangular with ones."""
    n = Phi.shape[0]
    for i in range(n):
        for j in range(i):
            Phi[i, j] = 0.0
        factor = 1.0
        for j in range(i, n):
            Phi[i, j] = factor
            factor *= dt / (j - i + 1)


@njit()
def noise_shape(n: int) -> Array:
    """Root (n, n) of the noise matrix of a unit step and density: row k holds moments of a Legendre polynomial.

    With a = n-1-i the entry is sqrt(2k+1) a! / ((a-k)! (a+k+1)!), and zero for k > a.
    """
    shape = np.zeros((n, n))
    for k in range(n):
        for i in range(n - k):
            value, a = np.sqrt(2.0 * k + 1.0), n - 1 - i
            for m in range(a - k + 1, a + 1):
                value *= m
            for m in range(2, a + k + 2):
                value /= m
            shape[k, i] = value
    return shape


@njit()
def noise_root(dt: float, q: float, shape: Array, root: Array) -> None:
    """Write a root (n, n) of the noise matrix of a step, root^T root = Q: columns of the shape by powers of dt."""
    n = shape.shape[0]
    power = np.sqrt(q * dt)
    for i in range(n - 1, -1, -1):
        for k in range(n):
            root[k, i] = power * shape[k, i]
        power *= dt


@njit()
def triangularise(W: Array, columns: int) -> None:
    """Turn the rows of W so that its first columns become upper triangular, in place (Householder).

    All columns of W are turned; W^T W stays. Below the diagonal of the first columns nothing is to be read.
    """
    rows, width = W.shape
    for j in range(columns):
        total = 0.0
        for i in range(j, rows):
            total += W[i, j] * W[i, j]
        if total == 0.0:
            continue
        length = np.sqrt(total)
        if W[j, j] > 0.0:
            length = -length
        head = W[j, j] - length
        for c in range(j + 1, width):
            dot = head * W[j, c]
            for i in range(j + 1, rows):
                dot += W[i, j] * W[i, c]
            dot /= length * head
            W[j, c] += dot * head
            for i in range(j + 1, rows):
                W[i, c] += dot * W[i, j]
        W[j, j] = length


@njit()
def move(Phi: Array, x: Array, out: Array) -> None:
    """out <- Phi x for upper triangular Phi; out may be x."""
    n = x.shape[0]
    for i in range(n):
        total = 0.0
        for k in range(i, n):
            total += Phi[i, k] * x[k]
        out[i] = total


@njit()
def stack(U: Array, Phi: Array, root: Array, W: Array) -> None:
    """Write U Phi^T above root into the first n columns of W (2n, ...): a root of Phi P Phi^T + Q."""
    n = U.shape[0]
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(max(i, j), n):
                total += U[i, k] * Phi[j, k]
            W[i, j] = total
            W[n + i, j] = root[i, j]


@njit()
def predict(dt: float, q: float, shape: Array, y: Array, U: Array, Phi: Array, root: Array, W: Array) -> None:
    """y <- Phi y and the root of Phi P Phi^T + Q, in place.

    The shape is that of noise_shape; Phi, root (n, n) and W (2n, n) are scratch.
    """
    n = y.shape[0]
    transition(dt, Phi)
    noise_root(dt, q, shape, root)
    move(Phi, y, y)
    stack(U, Phi, root, W)
    triangularise(W, n)
    for i in range(n):
        for j in range(i, n):
            U[i, j] = W[i, j]


@njit()
def correct(y: Array, U: Array, gain: Array, innovation: float, S: float, noise: float) -> None:
    """y and U after a measurement of the first state with variance ``noise``, S = P_00 + noise, in place.

    Only the first row of U sees the first state, so that the rotation with the row of the measurement shrinks
    that row by sqrt(noise / S) and leaves the others; gain (n,) is filled.
    """
    n = y.shape[0]
    share = U[0, 0] / S
    shrink = np.sqrt(noise / S)
    for i in range(n):
        gain[i] = share * U[0, i]
        y[i] += gain[i] * innovation
        U[0, i] *= shrink


@njit()
def begin(first: float, spread: Array, y: Array, U: Array) -> None:
    """The state before the first measurement: at its position, at rest, with deviations ``spread``."""
    for i in range(y.shape[0]):
        y[i] = 0.0
        for j in range(y.shape[0]):
            U[i, j] = 0.0
        U[i, i] = spread[i]
    y[0] = first


@njit()
def believed(innovation: float, S: float, gate: float) -> float:
    """Variance of an innovation, raised until it is at the gate; 0 for no gate."""
    if gate > 0.0 and innovation * innovation > gate * gate * S:
        return innovation * innovation / (gate * gate)
    return S


@njit()
def forward(
    t: Array,
    z: Array,
    r: Array,
    use: Flags,
    q: float,
    spread: Array,
    gate: float,
    states: Array,
    roots: Array,
    gains: Array,
    innovations: Array,
    variances: Array,
    flags: Flags,
) -> None:
    """Filter one channel.

    t, z, r (N,): times, measurements, variances; use (N,): zero leaves the measurement out
    spread (n,) : standard deviations of the first state; gate : largest |innovation| in sigmas, 0 for none
    states, gains (N, n); roots (N, n, n) of the covariances; innovations, variances, flags (N,) are filled
    """
    N, n = states.shape
    Phi, root, W = np.empty((n, n)), np.empty((n, n)), np.empty((2 * n, n))
    y, U, gain = np.empty(n), np.empty((n, n)), np.empty(n)
    shape = noise_shape(n)
    begin(z[0], spread, y, U)
    for k in range(N):
        if k > 0:
            predict(t[k] - t[k - 1], q, shape, y, U, Phi, root, W)
        before = U[0, 0] * U[0, 0]
        innovation = z[k] - y[0]
        innovations[k], variances[k], flags[k] = innovation, before + r[k], LEFT_OUT
        gain[:] = 0.0
        if use[k]:
            S = believed(innovation, variances[k], gate)
            flags[k] = DOUBTED if variances[k] < S else USED
            correct(y, U, gain, innovation, S, r[k] if flags[k] == USED else S - before)
        gains[k], states[k], roots[k] = gain, y, U


@njit()
def gain_and_rest(W: Array, back: Array) -> None:
    """The smoother's gain, transposed, from the triangle A of the first n columns of W: A back = W[:n, n:]."""
    n = back.shape[0]
    for j in range(n):
        for i in range(n - 1, -1, -1):
            total = W[i, n + j]
            for k in range(i + 1, n):
                total -= W[i, k] * back[k, j]
            back[i, j] = total / W[i, i]


@njit()
def backward(t: Array, states: Array, roots: Array, q: float) -> None:
    """Smooth in place: states (N, n) and roots (N, n, n) of the filter become those given all data.

    Turning [[U Phi^T, U], [root of Q, 0]] into [[A, B], [0, D]] gives the gain C^T = A^-1 B, and D is a root of
    what the next state leaves unknown; with the next root V the new one is the triangle of [D; V C^T].
    """
    N, n = states.shape
    Phi, root, back = np.empty((n, n)), np.empty((n, n)), np.empty((n, n))
    shape = noise_shape(n)
    W, V, ahead = np.empty((2 * n, 2 * n)), np.empty((2 * n, n)), np.empty(n)
    for k in range(N - 2, -1, -1):
        transition(t[k + 1] - t[k], Phi)
        noise_root(t[k + 1] - t[k], q, shape, root)
        stack(roots[k], Phi, root, W)
        W[:n, n:] = roots[k]
        W[n:, n:] = 0.0
        triangularise(W, n)
        gain_and_rest(W, back)
        move(Phi, states[k], ahead)
        for i in range(n):
            for m in range(n):
                states[k, i] += back[m, i] * (states[k + 1, m] - ahead[m])
                V[m, i] = W[n + m, n + i]
                total = 0.0
                for j in range(m, n):
                    total += roots[k + 1, m, j] * back[j, i]
                V[n + m, i] = total
        triangularise(V, n)
        for i in range(n):
            roots[k, i, :i] = 0.0
            roots[k, i, i:] = V[i, i:]


@njit()
def misfit(
    t: Array, z: Array, r: Array, use: Flags, q: float, spread: Array, order: int, gate: float
) -> tuple[float, float, int]:
    """Sums over the innovations after the first ``order``: of log S, of innovation^2 / S, and their number.

    With a gate the variance of a wild innovation is raised as in :func:`forward`.
    """
    n = order
    Phi, root, W = np.empty((n, n)), np.empty((n, n)), np.empty((2 * n, n))
    y, U, gain = np.empty(n), np.empty((n, n)), np.empty(n)
    shape = noise_shape(n)
    begin(z[0], spread, y, U)
    logs, squares, count, seen = 0.0, 0.0, 0, 0
    for k in range(t.shape[0]):
        if k > 0:
            predict(t[k] - t[k - 1], q, shape, y, U, Phi, root, W)
        if use[k] == 0:
            continue
        before = U[0, 0] * U[0, 0]
        innovation = z[k] - y[0]
        S = believed(innovation, before + r[k], gate)
        if seen >= order:
            logs += np.log(S)
            squares += innovation * innovation / S
            count += 1
        seen += 1
        correct(y, U, gain, innovation, S, r[k] if before + r[k] == S else S - before)
    return logs, squares, count
