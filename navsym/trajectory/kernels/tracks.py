"""Compiled loops for tracks: one channel, uneven times, a motion with a noisy last derivative, coloured errors.

The motion (position, speed, acceleration, ...) has n entries. Its last one u is driven by white noise of density q and
forgets at a rate a >= 0, du = -a u dt + dw; the others integrate it (Singer 1970; a = 0: a polynomial motion):

    Phi_ij = dt^(j-i) / (j-i)!  for j < n-1,    Phi_i,n-1 = g_i(dt),    Q = q int_0^dt g(s) g(s)^T ds,
    g_n-1(s) = exp(-a s),    g_i' = g_i+1,    g_i(0) = 0.

A position is measured with a white error of variance r and a coloured one, b(k+1) = f c(k+1)/c(k) b(k) + noise with
f = exp(-dt/tau), whose deviation is c(k) at row k, and with an error that drifts at a rate d, a first-order Markov
process of time constant ``lasting`` whose deviation is w(k). The first state is what is measured without its white
error, position + b + drift; the last two are b and d: the loops then correct by the first state alone, and Phi stays
upper triangular. Where w falls, d falls with it; where it grows, fresh noise makes up the difference. What has drifted
stays (``fading`` 0), or becomes part of b, which forgets and follows c (``fading`` 1).

Forward filter with bounded influence; Rauch, Tung and Striebel's smoother backwards (Maybeck, vol. 2, ch. 8).
An innovation beyond ``gate`` standard deviations is not cut off but believed less: its variance is raised until it
is exactly at the gate. A wild measurement then does little harm, and a manoeuvre is followed after a few steps. Where
errors are coloured, the excess is a jump of the coloured error, which stays: a receiver that changes its satellites.

Covariances are kept as upper triangular roots U, P = U^T U. The first spread of the speed may be 1e9 times the
noise of a position; with P itself such a track loses all digits, variances of the smoother came out negative and
speeds wrong by several of their deviations. The twin with P is in ``tests/trajectory/test_kernels.py``.

Products and solutions are written as loops: matrices have at most six rows, and calls of the linear algebra
library would take three times as long to compile at the first start.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from navsym.core.arrays import Array
from navsym.core.loops import njit

Flags = NDArray[np.int64]

#: What happened to a measurement.
USED, LEFT_OUT, DOUBTED = 0, 1, 2


#: Nodes and weights of Gauss and Legendre on [0, 1]: exact for the products of g at a = 0 up to six states.
NODES, WEIGHTS = (np.polynomial.legendre.leggauss(6)[0] + 1.0) / 2.0, np.polynomial.legendre.leggauss(6)[1] / 2.0
#: Ends of the pieces of a step, in times of forgetting; each piece has six nodes.
PIECES = np.array([1.5, 4.0, 8.0, 16.0, np.inf])
#: Rows that hold all nodes.
ROWS = 30


@njit()
def respond(s: float, rate: float, g: Array) -> None:
    """Write g(s) (n,): the motion a time s after a unit impulse on its last entry."""
    n, x = g.shape[0], rate * s
    if x >= 3.0:
        g[n - 1], power = np.exp(-x), 1.0
        for j in range(1, n):
            g[n - 1 - j] = (power - g[n - j]) / rate
            power *= s / j
        return
    power = 1.0
    for j in range(n):
        term, total = power, 0.0
        for k in range(1, 40):
            total += term
            term *= -x / (k + j)
            if abs(term) < 1e-18 * abs(total):
                break
        g[n - 1 - j] = total
        power *= s / (j + 1)


@njit()
def transition(dt: float, rate: float, Phi: Array, g: Array) -> None:
    """Write the transition matrix of the motion into the first n rows and columns of Phi; g (n,) is scratch."""
    n = g.shape[0]
    for i in range(n):
        for j in range(i):
            Phi[i, j] = 0.0
        factor = 1.0
        for j in range(i, n):
            Phi[i, j] = factor
            factor *= dt / (j - i + 1)
    respond(dt, rate, g)
    for i in range(n):
        Phi[i, n - 1] = g[i]


@njit()
def noise_root(dt: float, rate: float, rows: Array, g: Array) -> None:
    """Write a triangular root of Q at q = 1 into the first rows of ``rows`` (ROWS, n); g (n,) is scratch.

    Each row is a value of g by the root of its weight, so that the sum of squares loses no digits.
    """
    n, start, used = g.shape[0], 0.0, 0
    for piece in range(5):
        end = min(dt, PIECES[piece] / rate) if rate > 0.0 else dt
        if end <= start:
            continue
        for k in range(6):
            respond(start + (end - start) * NODES[k], rate, g)
            weight = np.sqrt((end - start) * WEIGHTS[k])
            for i in range(n):
                rows[used, i] = weight * g[i]
            used += 1
        start = end
    triangularise(rows[:used], n)
    for i in range(n):
        rows[i, :i] = 0.0


@njit()
def colour(
    dt: float, model: Array, c0: float, c1: float, w0: float, w1: float, n: int, Phi: Array, root: Array
) -> None:
    """Write what the errors add to Phi (m, m) and root (m+1, m): their entries, and their shares of the first.

    model : (q, rate, tau, lasting, fading) ; c0, c1, w0, w1 : deviations of coloured error and drift at both ends
    n     : states of the motion; m - n is 0, 1 with a coloured error, 2 with a drift also
    """
    m = Phi.shape[0]
    if m == n:
        return
    for i in range(m):
        for j in range(n, m):
            Phi[j, i], Phi[i, j], root[j, i], root[i, j], root[m, i] = 0.0, 0.0, 0.0, 0.0, 0.0
    kept = np.exp(-dt / model[2])
    ratio = kept * c1 / c0 if c0 > 0.0 else 0.0
    fresh = c1 * np.sqrt(-np.expm1(-2.0 * dt / model[2]))
    Phi[n, n], Phi[0, n] = ratio, ratio - 1.0
    root[n, 0], root[n, n] = fresh, fresh
    if m == n + 1 or (w0 == 0.0 and w1 == 0.0):
        return
    lasting, fading = model[3], model[4]
    kept = np.exp(-dt / lasting)
    ratio = kept if w1 >= w0 else kept * w1 / w0
    fresh = np.sqrt(max(w1 * w1 - ratio * ratio * w0 * w0, 0.0))
    Phi[n + 1, n + 1], Phi[0, n + 1], Phi[n, n + 1] = ratio, lasting * (1.0 - kept), fading * lasting * (1.0 - kept)
    half = np.tanh(dt / (2.0 * lasting))
    share = lasting * half * fresh
    root[n + 1, 0], root[n + 1, n], root[n + 1, n + 1] = share, fading * share, fresh
    rest = w1 * lasting * np.sqrt(max(2.0 * (dt / lasting - 2.0 * half), 0.0))
    root[n + 2, 0], root[n + 2, n] = rest, fading * rest


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
    """Write U Phi^T above root into the first n columns of W (2n+1, ...): a root of Phi P Phi^T + Q."""
    n = U.shape[0]
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(max(i, j), n):
                total += U[i, k] * Phi[j, k]
            W[i, j] = total
    for i in range(n + 1):
        for j in range(n):
            W[n + i, j] = root[i, j]


@njit()
def step_of(
    dt: float, last: float, model: Array, c: Array, w: Array, k: int, Phi: Array, root: Array, rows: Array, g: Array
) -> float:
    """Write Phi and root of the step dt from row k-1 to k, and return the step that they are of.

    They stay where that differs from ``last`` by less than a millionth, as steps of decimal times do.

    model : (q, rate, tau, lasting, fading); rows (ROWS, n) keeps the root at q = 1 from step to step, g (n,) is scratch
    """
    n = g.shape[0]
    if abs(dt - last) > 1e-6 * dt:
        last = dt
        transition(dt, model[1], Phi, g)
        noise_root(dt, model[1], rows, g)
        for i in range(n):
            for j in range(n):
                root[i, j] = np.sqrt(model[0]) * rows[i, j]
    colour(dt, model, c[k - 1], c[k], w[k - 1], w[k], n, Phi, root)
    return last


@njit()
def predict(y: Array, U: Array, Phi: Array, root: Array, W: Array) -> None:
    """y <- Phi y and U <- the triangular root of Phi P Phi^T + Q, in place; W (2 m + 1, m) is scratch."""
    m = y.shape[0]
    move(Phi, y, y)
    stack(U, Phi, root, W)
    triangularise(W, m)
    for i in range(m):
        for j in range(i, m):
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
def begin(first: float, spread: Array, c: float, w: float, y: Array, U: Array) -> None:
    """The state before the first measurement: at its position, at rest; deviations ``spread``, colour c, drift w."""
    n = spread.shape[0]
    y[:], U[:] = 0.0, 0.0
    for i in range(n):
        U[i, i] = spread[i]
    y[0] = first
    if y.shape[0] > n:  # position and coloured error are independent, their sum and the error are not
        U[0, 0] = np.hypot(spread[0], c)
        U[0, n], U[n, n] = c * c / U[0, 0], c * spread[0] / U[0, 0]
    if y.shape[0] > n + 1:
        U[n + 1, n + 1] = w


@njit()
def believed(innovation: float, S: float, gate: float) -> float:
    """Variance of an innovation, raised until it is at the gate; 0 for no gate."""
    if gate > 0.0 and innovation * innovation > gate * gate * S:
        return innovation * innovation / (gate * gate)
    return S


@njit()
def leap(U: Array, excess: float, n: int, W: Array) -> None:
    """U after a jump of the coloured error of variance ``excess``: root of P + excess d d^T, d one at 0 and n."""
    m = U.shape[0]
    W[: m + 1, :m] = 0.0
    W[:m, :m] = U
    W[m, 0], W[m, n] = np.sqrt(excess), np.sqrt(excess)
    triangularise(W[: m + 1, :m], m)
    for i in range(m):
        for j in range(i, m):
            U[i, j] = W[i, j]


@njit()
def forward(
    t: Array,
    z: Array,
    r: Array,
    c: Array,
    w: Array,
    use: Flags,
    model: Array,
    spread: Array,
    gate: float,
    states: Array,
    roots: Array,
    gains: Array,
    innovations: Array,
    variances: Array,
    jumps: Array,
    flags: Flags,
) -> None:
    """Filter one channel.

    t, z, r, c, w (N,): times, measurements, variances of white, deviations of coloured errors and of their drift;
    c and w are zero in all rows or in none; use (N,): zero leaves the measurement out
    model : (q, rate, tau, lasting, fading) ; spread (n,) : standard deviations of the first state
    gate : largest |innovation| in sigmas, 0 for none
    states, gains (N, m); roots (N, m, m) of the covariances, m as in :func:`colour`; innovations, variances,
    flags (N,) are filled, and jumps (N,): variances of jumps of the coloured error, to which wild innovations are put
    down where there is one
    """
    N, m, n = states.shape[0], states.shape[1], spread.shape[0]
    Phi, root, W, rows = np.zeros((m, m)), np.zeros((m + 1, m)), np.empty((2 * m + 1, m)), np.empty((ROWS, n))
    y, U, gain, g = np.empty(m), np.empty((m, m)), np.empty(m), np.empty(n)
    begin(z[0], spread, c[0], w[0], y, U)
    last = -1.0
    for k in range(N):
        if k > 0:
            last = step_of(t[k] - t[k - 1], last, model, c, w, k, Phi, root, rows, g)
            predict(y, U, Phi, root, W)
        before = U[0, 0] * U[0, 0]
        innovation = z[k] - y[0]
        innovations[k], variances[k], flags[k] = innovation, before + r[k], LEFT_OUT
        gain[:], jumps[k] = 0.0, 0.0
        if use[k]:
            S = believed(innovation, variances[k], gate)
            flags[k] = DOUBTED if variances[k] < S else USED
            if flags[k] == DOUBTED and c[k] > 0.0 and k > 0:
                jumps[k] = S - variances[k]
                leap(U, jumps[k], n, W)
                correct(y, U, gain, innovation, S, r[k])
            else:
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
            # Without a coloured error its entry has no spread, and nothing to learn.
            back[i, j] = total / W[i, i] if W[i, i] != 0.0 else 0.0


@njit()
def backward(t: Array, c: Array, w: Array, jumps: Array, n: int, states: Array, roots: Array, model: Array) -> None:
    """Smooth in place: states (N, m) and roots (N, m, m) of the filter become those given all data.

    Turning [[U Phi^T, U], [root of Q, 0]] into [[A, B], [0, D]] gives the gain C^T = A^-1 B, and D is a root of
    what the next state leaves unknown; with the next root V the new one is the triangle of [D; V C^T].
    """
    N, m = states.shape
    Phi, root, back = np.zeros((m, m)), np.zeros((m + 1, m)), np.empty((m, m))
    W, V, ahead = np.empty((2 * m + 1, 2 * m)), np.empty((2 * m + 1, m)), np.empty(m)
    rows, g, last = np.empty((ROWS, n)), np.empty(n), -1.0
    for k in range(N - 2, -1, -1):
        last = step_of(t[k + 1] - t[k], last, model, c, w, k + 1, Phi, root, rows, g)
        if jumps[k + 1] > 0.0:
            fresh = np.sqrt(root[n, 0] ** 2 + jumps[k + 1])
            root[n, 0], root[n, n] = fresh, fresh
        stack(roots[k], Phi, root, W)
        W[:m, m:] = roots[k]
        W[m:, m:] = 0.0
        triangularise(W, m)
        gain_and_rest(W, back)
        move(Phi, states[k], ahead)
        for i in range(m):
            for q in range(m):
                states[k, i] += back[q, i] * (states[k + 1, q] - ahead[q])
                V[q, i] = W[m + q, m + i]
                total = 0.0
                for j in range(q, m):
                    total += roots[k + 1, q, j] * back[j, i]
                V[m + q, i] = total
            V[2 * m, i] = W[2 * m, m + i]
        triangularise(V, m)
        for i in range(m):
            roots[k, i, :i] = 0.0
            roots[k, i, i:] = V[i, i:]


@njit()
def misfit(
    t: Array, z: Array, r: Array, c: Array, w: Array, use: Flags, model: Array, spread: Array, gate: float
) -> tuple[float, float, int]:
    """Sums over the innovations after the first n: of log S, of innovation^2 / S, and their number.

    With a gate the variance of a wild innovation is raised as in :func:`forward`.
    """
    n = spread.shape[0]
    m = n + 2 if w[0] > 0.0 else n + 1 if c[0] > 0.0 else n
    Phi, root, W, rows = np.zeros((m, m)), np.zeros((m + 1, m)), np.empty((2 * m + 1, m)), np.empty((ROWS, n))
    y, U, gain, g = np.empty(m), np.empty((m, m)), np.empty(m), np.empty(n)
    begin(z[0], spread, c[0], w[0], y, U)
    logs, squares, count, seen, last = 0.0, 0.0, 0, 0, -1.0
    for k in range(t.shape[0]):
        if k > 0:
            last = step_of(t[k] - t[k - 1], last, model, c, w, k, Phi, root, rows, g)
            predict(y, U, Phi, root, W)
        if use[k] == 0:
            continue
        before = U[0, 0] * U[0, 0]
        innovation = z[k] - y[0]
        S = believed(innovation, before + r[k], gate)
        if seen >= n:
            logs += np.log(S)
            squares += innovation * innovation / S
            count += 1
        seen += 1
        if before + r[k] < S and c[k] > 0.0 and k > 0:
            leap(U, S - before - r[k], n, W)
            correct(y, U, gain, innovation, S, r[k])
        else:
            correct(y, U, gain, innovation, S, r[k] if before + r[k] == S else S - before)
    return logs, squares, count
