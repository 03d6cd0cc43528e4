"""Compiled loops of the adaptive trajectory filter: all candidates of a step in one pass.

The measurement is a scalar, so a candidate diagonal q = (q_1, ..., q_n) enters one step only through

    S = s0 + sum_i h_i^2 q_i            innovation variance
    K_j = (g_j + h_j q_j) / S           gain, with g = (Phi P Phi^T) h^T and s0 = h g + R,

and no candidate needs a covariance of its own. Candidates that carry their own estimates are in
:mod:`navsym_papers.trajectory.experiment.windows`.
"""

import numpy as np
from numpy.typing import NDArray

from navsym.core.loops import njit

Array = NDArray[np.float64]

#: Criteria by number: see ``navsym_papers.trajectory.experiment.inversion``.
PREDICTED, CORRECTED, LIKELIHOOD = 0, 1, 2

#: The bits of minus zero and of a NaN, as integers.
LEAST, GREATEST = np.iinfo(np.int64).min, np.iinfo(np.int64).max


@njit(error_model="numpy", fastmath={"contract"})
def predict(Phi: Array, y: Array, P: Array, h: Array, ahead: Array, B: Array, g: Array) -> float:
    """Write Phi y into ``ahead``, Phi P Phi^T into B, B h into g; return h g. Phi is upper triangular."""
    n = y.shape[0]
    for i in range(n):
        s = 0.0
        for k in range(i, n):
            s += Phi[i, k] * y[k]
        ahead[i] = s
    # g serves as one row of Phi P before it gets its own meaning.
    for i in range(n):
        for j in range(i, n):
            s = 0.0
            for k in range(i, n):
                s += Phi[i, k] * P[k, j]
            g[j] = s
        for j in range(i, n):
            s = 0.0
            for k in range(j, n):
                s += g[k] * Phi[j, k]
            B[i, j] = s
            B[j, i] = s
    total = 0.0
    for i in range(n):
        s = 0.0
        for j in range(n):
            s += B[i, j] * h[j]
        g[i] = s
        total += s * h[i]
    return total


@njit(error_model="numpy")
def innovation_variances(s0: float, h: Array, q: Array, seen: NDArray[np.bool_], step: float, out: Array) -> None:
    """S of all candidates: digit i of the number c, base 3, keeps, lowers or raises the i-th q that is seen.

    Digit 0 keeps, so that among equal candidates the first one changes least. A q_i that the measurement does
    not see (h_i = 0) has no digit: its candidates are equal, and the first of them keeps it.
    """
    n = h.shape[0]
    base = s0
    for i in range(n):
        base += h[i] * h[i] * q[i]
    out[0] = base
    size = 1
    for i in range(n):
        if not seen[i]:
            continue
        own = h[i] * h[i] * q[i]
        lowered = own / step - own
        raised = own * step - own
        for c in range(size):
            out[size + c] = out[c] + lowered
            out[2 * size + c] = out[c] + raised
        size *= 3


@njit(error_model="numpy")
def neighbours(S: Array, around: Array) -> None:
    """Write the largest S up to around[0] into around[1] and the smallest S above it into around[2].

    Where there is none: minus zero and NaN. Positive doubles are ordered like their bits, and the compiler takes
    extremes of integers, unlike those of doubles, several at once.
    """
    bits, ends = S.view(np.int64), around.view(np.int64)
    squared, low, high = ends[0], LEAST, GREATEST
    for c in range(bits.shape[0]):
        s = bits[c]
        low = max(low, s if s <= squared else LEAST)
        high = min(high, s if s > squared else GREATEST)
    ends[1], ends[2] = low, high


@njit(error_model="numpy")
def first_place(S: Array, value: float) -> int:
    """Index of the first entry that equals ``value``; the length when none does.

    Without leaving the loop early: several entries are compared at once, which takes less than half the time.
    """
    place = S.shape[0]
    for c in range(S.shape[0]):
        place = min(place, c if S[c] == value else S.shape[0])
    return place


@njit(error_model="numpy")
def likeliest(S: Array, squared: float, around: Array) -> tuple[int, float]:
    """Index and value of the smallest log S + squared / S, the first of equals.

    The function falls for S < squared and rises above it: only the largest S below and the smallest S
    above are compared, and two logarithms are enough for all candidates. around (3,) is work space.
    """
    around[0] = squared
    neighbours(S, around)
    low, high = around[1], around[2]
    left = np.log(low) + squared / low if low > 0.0 else np.inf
    right = np.log(high) + squared / high if high < 1e308 else np.inf
    place = first_place(S, low if left <= right else high)
    if place == S.shape[0]:
        return 0, np.inf
    return place, min(left, right)


@njit(error_model="numpy")
def smallest_change(S, g, h, q, seen, step, innovation, ahead, y, weights, kind, row):
    """Index and value of the smallest criterion J of the paper over all candidates, first of equals.

    weights : three numbers, of the residual, of the change of state 2 and of state 3
    kind    : PREDICTED takes z - H_p x_k, the same for all; CORRECTED what remains after the step
    row     : (n,) the row that turns the corrected state into its measured value
    """
    n = h.shape[0]
    best, value = -1, np.inf
    chosen = np.empty(n)
    for c in range(S.shape[0]):
        candidate(q, seen, step, c, chosen)
        residual = innovation
        change2, change3 = 0.0, 0.0
        for i in range(n):
            move = (g[i] + h[i] * chosen[i]) / S[c] * innovation
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


@njit(error_model="numpy")
def candidate(q: Array, seen: NDArray[np.bool_], step: float, index: int, out: Array) -> None:
    """Write the diagonal of a candidate by its number into ``out``; elements that are not seen stay."""
    for i in range(q.shape[0]):
        out[i] = q[i]
        if seen[i]:
            digit = index % 3
            index //= 3
            if digit:
                out[i] = q[i] / step if digit == 1 else q[i] * step


@njit(error_model="numpy", fastmath={"contract"})
def apply(B, g, h, q, S, ahead, innovation, y, P, gain):
    """Correct by the chosen candidate: y, P and gain are written; P = P^- - K S K^T is symmetric by construction."""
    n = y.shape[0]
    inverse = 1.0 / S
    for i in range(n):
        gain[i] = (g[i] + h[i] * q[i]) * inverse
        y[i] = ahead[i] + gain[i] * innovation
    for i in range(n):
        for j in range(i, n):
            P[i, j] = B[i, j] - gain[i] * gain[j] * S
            P[j, i] = P[i, j]
        P[i, i] += q[i]


@njit(error_model="numpy")
def tune_one_step(model, R, z, start, step, weights, kind, stop, out):
    """The adaptive filter, Q chosen anew at each of the first ``stop`` steps, then a constant gain.

    model : Phi (n, n), h (n,) row in the gain, row (n,) of the predicted measurement, z = row x_k (H_p of the paper)
    z : (N,) measurements 1..N; start : estimate, matrix and diagonal at step 0, overwritten
    out, filled here : states, gains, diagonals (N, n) and values (N,)
    """
    (Phi, h, row), (y, P, q), (states, gains, diagonals, values) = model, start, out
    n = y.shape[0]
    ahead, g, chosen, gain = np.empty(n), np.empty(n), np.empty(n), np.zeros(n)
    B = np.empty((n, n))
    seen = h != 0.0
    S, around = np.empty(3 ** np.sum(seen)), np.empty(3)
    direct = np.zeros(n)
    direct[0] = row[0]
    for k in range(z.shape[0]):
        innovation = z[k]
        for i in range(n):
            innovation -= row[i] * y[i]
        if k < stop:
            s0 = predict(Phi, y, P, h, ahead, B, g) + R
            innovation_variances(s0, h, q, seen, step, S)
            if kind == LIKELIHOOD:
                best, values[k] = likeliest(S, innovation * innovation, around)
            else:
                best, values[k] = smallest_change(S, g, h, q, seen, step, innovation, ahead, y, weights, kind, direct)
            candidate(q, seen, step, best, chosen)
            for i in range(n):
                q[i] = chosen[i]
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
        for i in range(n):
            states[k, i], gains[k, i], diagonals[k, i] = y[i], gain[i], q[i]


@njit(error_model="numpy")
def run_fixed_gain(Phi: Array, row: Array, gain: Array, z: Array, y: Array, states: Array) -> None:
    """Constant gain: y <- Phi y + gain (z - row y); Phi upper triangular, y (n,) is overwritten."""
    n = y.shape[0]
    for k in range(z.shape[0]):
        innovation = z[k]
        for i in range(n):
            innovation -= row[i] * y[i]
        for i in range(n):
            s = gain[i] * innovation
            for j in range(i, n):
                s += Phi[i, j] * y[j]
            y[i] = s
        states[k] = y
