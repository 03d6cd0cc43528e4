"""Compiled loops of the adaptive trajectory filter: all candidates of a step in one pass.

The measurement is a scalar, so a candidate diagonal q = (q_1, ..., q_n) enters one step only through

    S = s0 + sum_i h_i^2 q_i            innovation variance
    K_j = (g_j + h_j q_j) / S           gain, with g = (Phi P Phi^T) h^T and s0 = h g + R,

and no candidate needs a covariance of its own. When every candidate carries its own estimate through a
window of steps, candidates lie in the innermost dimension, so that the compiler takes several at once.
Plain twins of both loops are in ``navsym.methods.trajectory_twins``.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Criteria by number: see ``navsym.methods.trajectory``.
PREDICTED, CORRECTED, LIKELIHOOD = 0, 1, 2


@njit(cache=True)
def predict(
    Phi: Array,
    y: Array,
    P: Array,
    h: Array,
    ahead: Array,
    B: Array,
    g: Array,
) -> float:
    """Write Phi y into ``ahead``, Phi P Phi^T into B, B h into g; return h g. Phi is upper triangular."""
    n = y.shape[0]
    for i in range(n):
        s = 0.0
        for k in range(i, n):
            s += Phi[i, k] * y[k]
        ahead[i] = s
    # g serves as one row of Phi P before it gets its own meaning.
    for i in range(n):
        for j in range(n):
            s = 0.0
            for k in range(i, n):
                s += Phi[i, k] * P[k, j]
            g[j] = s
        for j in range(n):
            s = 0.0
            for k in range(j, n):
                s += g[k] * Phi[j, k]
            B[i, j] = s
    total = 0.0
    for i in range(n):
        s = 0.0
        for j in range(n):
            s += B[i, j] * h[j]
        g[i] = s
        total += s * h[i]
    return total


@njit(cache=True)
def innovation_variances(
    s0: float,
    h: Array,
    q: Array,
    step: float,
    out: Array,
) -> None:
    """S of all 3^n candidates; candidate c has q_i step^(digit_i(c) - 1), digit 0 varies fastest."""
    n = h.shape[0]
    base = s0
    for i in range(n):
        base += h[i] * h[i] * q[i] / step
    out[0] = base
    size = 1
    for i in range(n):
        low = h[i] * h[i] * q[i] / step
        middle = h[i] * h[i] * q[i]
        first = middle - low
        second = middle * step - low
        for c in range(size):
            out[size + c] = out[c] + first
            out[2 * size + c] = out[c] + second
        size *= 3


@njit(cache=True)
def likeliest(
    S: Array,
    squared: float,
) -> int:
    """Index of the smallest log S + squared / S, the first of equals.

    The function falls for S < squared and rises above it: only the largest S below and the smallest S
    above are compared, and two logarithms are enough for all candidates.
    """
    below, above = -1, -1
    low, high = -np.inf, np.inf
    for c in range(S.shape[0]):
        s = S[c]
        if s <= squared:
            if s > low:
                low, below = s, c
        elif s < high:
            high, above = s, c
    if below < 0:
        return above
    if above < 0:
        return below
    left, right = np.log(low) + squared / low, np.log(high) + squared / high
    if left == right:
        return min(below, above)
    return below if left < right else above


@njit(cache=True)
def smallest_change(
    S: Array,
    g: Array,
    h: Array,
    q: Array,
    step: float,
    innovation: float,
    ahead: Array,
    y: Array,
    weights: Array,
    kind: int,
    row: Array,
) -> tuple[int, float]:
    """Index and value of the smallest criterion J of the paper over all candidates, first of equals.

    weights : three numbers, of the residual, of the change of state 2 and of state 3
    kind    : PREDICTED takes z - H_p x_k, the same for all; CORRECTED what remains after the step
    row     : (n,) the row that turns the corrected state into its measured value
    """
    n = h.shape[0]
    best, value = -1, np.inf
    for c in range(S.shape[0]):
        rest = c
        residual = innovation
        change2, change3 = 0.0, 0.0
        for i in range(n):
            digit = rest % 3
            rest //= 3
            qi = q[i] / step if digit == 0 else (q[i] if digit == 1 else q[i] * step)
            move = (g[i] + h[i] * qi) / S[c] * innovation
            if kind == CORRECTED:
                residual -= row[i] * move
            if i == 1:
                change2 = ahead[i] + move - y[i]
            elif i == 2:
                change3 = ahead[i] + move - y[i]
        J = weights[0] * residual**2 + weights[1] * change2**2 + weights[2] * change3**2
        if value > J:
            best, value = c, J
    return best, value


@njit(cache=True)
def candidate(
    q: Array,
    step: float,
    index: int,
    out: Array,
) -> None:
    """Write the diagonal of a candidate by its number into ``out``."""
    for i in range(q.shape[0]):
        digit = index % 3
        index //= 3
        out[i] = q[i] / step if digit == 0 else (q[i] if digit == 1 else q[i] * step)


@njit(cache=True)
def apply(
    B: Array,
    g: Array,
    h: Array,
    q: Array,
    S: float,
    ahead: Array,
    innovation: float,
    y: Array,
    P: Array,
    gain: Array,
) -> None:
    """Correct by the chosen candidate: y, P and gain are written. P = (E - K h) P^-."""
    n = y.shape[0]
    for i in range(n):
        gain[i] = (g[i] + h[i] * q[i]) / S
        y[i] = ahead[i] + gain[i] * innovation
    for i in range(n):
        for j in range(n):
            P[i, j] = B[i, j] - gain[i] * (g[j] + h[j] * q[j])
        P[i, i] += q[i]


@njit(cache=True)
def tune_one_step(
    Phi: Array,
    h: Array,
    row: Array,
    R: float,
    z: Array,
    y: Array,
    P: Array,
    q: Array,
    step: float,
    weights: Array,
    kind: int,
    stop: int,
    states: Array,
    gains: Array,
    diagonals: Array,
    values: Array,
) -> None:
    """The adaptive filter, Q chosen anew at each of the first ``stop`` steps, then a constant gain.

    z : (N,) measurements 1..N; y, P, q : estimate, matrix and diagonal at step 0, overwritten
    h : (n,) row in the gain; row : (n,) row of the predicted measurement, z = row x_k (H_p of the paper)
    states, gains, diagonals : (N, n) and values (N,) are filled
    """
    n = y.shape[0]
    ahead, g, chosen, gain = np.empty(n), np.empty(n), np.empty(n), np.zeros(n)
    B = np.empty((n, n))
    S = np.empty(3**n)
    direct = np.zeros(n)
    direct[0] = row[0]
    for k in range(z.shape[0]):
        innovation = z[k]
        for i in range(n):
            innovation -= row[i] * y[i]
        if k < stop:
            s0 = predict(Phi, y, P, h, ahead, B, g) + R
            innovation_variances(s0, h, q, step, S)
            if kind == LIKELIHOOD:
                best = likeliest(S, innovation * innovation)
                values[k] = np.log(S[best]) + innovation * innovation / S[best]
            else:
                best, values[k] = smallest_change(
                    S, g, h, q, step, innovation, ahead, y, weights, kind, direct
                )
            candidate(q, step, best, chosen)
            q[:] = chosen
            apply(B, g, h, q, S[best], ahead, innovation, y, P, gain)
        else:
            for i in range(n):
                s = 0.0
                for j in range(i, n):
                    s += Phi[i, j] * y[j]
                ahead[i] = s
            for i in range(n):
                y[i] = ahead[i] + gain[i] * innovation
            values[k] = innovation * innovation
        states[k], gains[k], diagonals[k] = y, gain, q


@njit(cache=True)
def bank_step(
    Phi: Array,
    h: Array,
    R: float,
    z: float,
    ys: Array,
    Ps: Array,
    qs: Array,
    cost: Array,
    ahead: Array,
    T: Array,
    B: Array,
) -> None:
    """One step of all candidates, each with its own estimate; ``cost`` grows by log S + innovation^2 / S.

    ys (n, C), Ps (n, n, C), qs (n, C), cost (C,) are overwritten; ahead (n, C), T, B (n, n, C) are scratch.
    The correction is that of the corrected algorithm: predict, then H on the predicted state.
    """
    n, C = ys.shape
    for i in range(n):
        for c in range(C):
            ahead[i, c] = ys[i, c]
        for k in range(i + 1, n):
            f = Phi[i, k]
            for c in range(C):
                ahead[i, c] += f * ys[k, c]
    for i in range(n):
        for j in range(n):
            for c in range(C):
                T[i, j, c] = Ps[i, j, c]
            for k in range(i + 1, n):
                f = Phi[i, k]
                for c in range(C):
                    T[i, j, c] += f * Ps[k, j, c]
    for i in range(n):
        for j in range(i, n):
            for c in range(C):
                B[i, j, c] = T[i, j, c]
            for k in range(j + 1, n):
                f = Phi[j, k]
                for c in range(C):
                    B[i, j, c] += f * T[i, k, c]
        for c in range(C):
            B[i, i, c] += qs[i, c]
    h0 = h[0]
    for c in range(C):
        T[0, 0, c] = 1.0 / (h0 * h0 * B[0, 0, c] + R)  # 1 / S
        T[0, 1, c] = z - h0 * ahead[0, c]  # innovation
        cost[c] += T[0, 1, c] * T[0, 1, c] * T[0, 0, c] - np.log(T[0, 0, c])
    for i in range(n):
        for c in range(C):
            ys[i, c] = ahead[i, c] + h0 * B[0, i, c] * T[0, 0, c] * T[0, 1, c]
        for j in range(i, n):
            for c in range(C):
                Ps[i, j, c] = B[i, j, c] - h0 * h0 * B[0, i, c] * B[0, j, c] * T[0, 0, c]
            if j > i:
                for c in range(C):
                    Ps[j, i, c] = Ps[i, j, c]


@njit(cache=True)
def tune_by_windows(
    Phi: Array,
    h: Array,
    R: float,
    z: Array,
    y: Array,
    P: Array,
    q: Array,
    step: float,
    window: int,
    floor: Array,
    ceiling: Array,
    states: Array,
    gains: Array,
    diagonals: Array,
    values: Array,
) -> None:
    """The adaptive filter with all 3^n candidates carried through windows of steps.

    At the end of each window the likeliest candidate becomes the centre of the next field, its estimate
    and matrix the common start. Inside a window the middle candidate's estimate is reported.
    """
    n = y.shape[0]
    C = 3**n
    ys, qs, cost = np.empty((n, C)), np.empty((n, C)), np.zeros(C)
    Ps = np.empty((n, n, C))
    ahead, T, B = np.empty((n, C)), np.empty((n, n, C)), np.empty((n, n, C))
    diagonal = np.empty(n)
    middle = C // 2
    for k in range(z.shape[0]):
        if k % window == 0:
            for c in range(C):
                candidate(q, step, c, diagonal)
                cost[c] = 0.0
                for i in range(n):
                    qs[i, c] = min(max(diagonal[i], floor[i]), ceiling[i])
                    ys[i, c] = y[i]
                    for j in range(n):
                        Ps[i, j, c] = P[i, j]
        bank_step(Phi, h, R, z[k], ys, Ps, qs, cost, ahead, T, B)
        for i in range(n):
            states[k, i] = ys[i, middle]
            # After the correction P h / R is the gain; it needs no inverse.
            gains[k, i] = Ps[0, i, middle] * h[0] / R
            diagonals[k, i] = q[i]
        values[k] = cost[middle]
        if (k + 1) % window == 0:
            best = 0
            for c in range(1, C):
                if cost[c] < cost[best]:
                    best = c
            for i in range(n):
                y[i] = ys[i, best]
                q[i] = qs[i, best]
                for j in range(n):
                    P[i, j] = Ps[i, j, best]
                states[k, i] = y[i]
                gains[k, i] = P[0, i] * h[0] / R
            values[k] = cost[best]
