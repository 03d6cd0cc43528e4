"""Compiled loops of the adaptive trajectory filter in which every candidate carries its own estimate.

Candidates lie in the innermost dimension, so that the compiler takes several at once, and go in blocks
whose matrices stay in the first cache through a whole window of steps.
"""

import numpy as np

from navsym.core.loops import njit
from navsym_papers.trajectory.experiment.transforms import candidate

#: Candidates in a block: a multiple of what one vector instruction takes.
LANES = 32


@njit(error_model="numpy", fastmath={"contract"})
def bank_step(Phi, h0, R, z, ys, Ps, qs, misfit, product, ahead, T, B):
    """One step of a block of W candidates, each with its own estimate; W is the innermost dimension.

    ys (n, W), Ps (n, n, W; upper triangle), qs (n, W) are overwritten; ``misfit`` (W,) grows by
    innovation^2 / S and ``product`` (W,) is multiplied by S. ahead (n, W), T, B (n, n, W) are scratch.
    """
    n, W = ys.shape
    for i in range(n):
        ahead[i] = ys[i]
        for k in range(i + 1, n):
            f = Phi[i, k]
            for c in range(W):
                ahead[i, c] += f * ys[k, c]
        for j in range(n):
            for c in range(W):
                T[i, j, c] = Ps[min(i, j), max(i, j), c]
            for k in range(i + 1, n):
                f = Phi[i, k]
                a, b = min(k, j), max(k, j)
                for c in range(W):
                    T[i, j, c] += f * Ps[a, b, c]
    for i in range(n):
        for j in range(i, n):
            for c in range(W):
                B[i, j, c] = T[i, j, c]
            for k in range(j + 1, n):
                f = Phi[j, k]
                for c in range(W):
                    B[i, j, c] += f * T[i, k, c]
        for c in range(W):
            B[i, i, c] += qs[i, c]
    for c in range(W):
        S = h0 * h0 * B[0, 0, c] + R
        innovation = z - h0 * ahead[0, c]
        product[c] *= S
        T[0, 0, c] = h0 * innovation / S
        T[0, 1, c] = h0 * h0 / S
        misfit[c] += innovation * innovation / S
    for i in range(n):
        for c in range(W):
            ys[i, c] = ahead[i, c] + B[0, i, c] * T[0, 0, c]
        for j in range(i, n):
            for c in range(W):
                Ps[i, j, c] = B[i, j, c] - B[0, i, c] * B[0, j, c] * T[0, 1, c]


@njit(error_model="numpy")
def run_block(Phi, h0, R, z, y, P, qs, ys, Ps, cost, scratch, trace):
    """Carry one block of candidates through a window z (L,) from a common start y, P.

    qs (n, W) diagonals; ys, Ps, cost are written: estimates, matrices, sum of log S + innovation^2 / S.
    trace : (L, 2 n + 1) estimate, first row of P and cost of candidate 0 after each step
    """
    n, W = ys.shape
    misfit, product, ahead, T, B = scratch
    for c in range(W):
        misfit[c], product[c], cost[c] = 0.0, 1.0, 0.0
        for i in range(n):
            ys[i, c] = y[i]
            for j in range(i, n):
                Ps[i, j, c] = P[i, j]
    for k in range(z.shape[0]):
        bank_step(Phi, h0, R, z[k], ys, Ps, qs, misfit, product, ahead, T, B)
        for i in range(n):
            trace[k, i], trace[k, n + i] = ys[i, 0], Ps[0, i, 0]
        trace[k, 2 * n] = cost[0] + np.log(product[0]) + misfit[0]
        # One logarithm for four factors: four variances of up to 1e75 cannot overflow.
        if k % 4 == 3 or k == z.shape[0] - 1:
            for c in range(W):
                cost[c] += np.log(product[c])
                product[c] = 1.0
    for c in range(W):
        cost[c] += misfit[c]


@njit(error_model="numpy")
def report_window(trace, q, h0, R, first, steps, out):
    """States, gains P h / R after the correction (no inverse is needed), diagonals and values of one window."""
    n, (states, gains, diagonals, values) = q.shape[0], out
    for k in range(steps):
        for i in range(n):
            states[first + k, i] = trace[k, i]
            gains[first + k, i] = trace[k, n + i] * h0 / R
            diagonals[first + k, i] = q[i]
        values[first + k] = trace[k, 2 * n]


@njit(error_model="numpy")
def tune_by_windows(Phi, h, R, z, start, step, window, floor, ceiling, out):
    """The adaptive filter with all 3^n candidates carried through windows of steps.

    At the end of each window the likeliest candidate becomes the centre of the next field, its estimate
    and matrix the common start. Inside a window the unchanged candidate, number 0, is reported.
    Candidates go in blocks of at most 32, whose matrices stay in the first cache for a whole window;
    a last block that is not full repeats the last candidate. start and out as for :func:`tune_one_step`.
    """
    (y, P, q), (states, gains, _, values) = start, out
    n = y.shape[0]
    C, h0 = 3**n, h[0]
    W = min(C, LANES)
    qs, ys, cost = np.empty((n, W)), np.empty((n, W)), np.empty(W)
    Ps = np.empty((n, n, W))
    scratch = (np.empty(W), np.empty(W), np.empty((n, W)), np.empty((n, n, W)), np.empty((n, n, W)))
    trace = np.empty((window, 2 * n + 1))
    # Carried through a window, every element of Q makes a difference.
    seen = np.ones(n, dtype=np.bool_)
    diagonal, best_y, best_q, best_P = np.empty(n), np.empty(n), np.empty(n), np.empty((n, n))
    for first in range(0, z.shape[0], window):
        part = z[first : min(first + window, z.shape[0])]
        lowest = np.inf
        for block in range(0, C, W):
            for c in range(W):
                candidate(q, seen, step, min(block + c, C - 1), diagonal)
                for i in range(n):
                    qs[i, c] = min(max(diagonal[i], floor[i]), ceiling[i])
            run_block(Phi, h0, R, part, y, P, qs, ys, Ps, cost, scratch, trace)
            if block == 0:
                report_window(trace, q, h0, R, first, part.shape[0], out)
            c = int(np.argmin(cost))
            if cost[c] < lowest:
                lowest = cost[c]
                for i in range(n):
                    best_y[i], best_q[i] = ys[i, c], qs[i, c]
                    for j in range(n):
                        best_P[i, j] = Ps[min(i, j), max(i, j), c]
        if part.shape[0] == window:
            y[:], P[:], q[:] = best_y, best_P, best_q
            last = first + window - 1
            for i in range(n):
                states[last, i] = y[i]
                gains[last, i] = P[0, i] * h0 / R
            values[last] = lowest
