"""Many Monte-Carlo runs of one bank at once: eight runs in the lanes, models shared by all.

The loops are those of :mod:`navsym.multimodel.kernels.bank` for one Gaussian per mode (IMM, polygaussian) and
for one Gaussian in all (pulsating), turned round: modes outside, runs inside.
"""

from __future__ import annotations

import math

import numpy as np

from navsym.core.lanes import load_lanes, spread_lanes, store_lanes
from navsym.core.loops import njit
from navsym.multimodel.kernels.filter import COMPILE, account, aligned


@njit(**COMPILE)
def predict_mode(i, n, F, Q, x, P, scratch):  # type: ignore[no-untyped-def]
    """Predict mode i of eight runs by one model F, Q (n, n); scratch (n + n n) 8."""
    start, square = i * n * 8, i * n * n * 8
    for a in range(n):
        total = spread_lanes(F[a, 0]) * load_lanes(x, start)
        for c in range(1, n):
            total = total + spread_lanes(F[a, c]) * load_lanes(x, start + c * 8)
        store_lanes(scratch, a * 8, total)
        for b in range(n):
            total = spread_lanes(F[a, 0]) * load_lanes(P, square + b * 8)
            for c in range(1, n):
                total = total + spread_lanes(F[a, c]) * load_lanes(P, square + (c * n + b) * 8)
            store_lanes(scratch, (n + a * n + b) * 8, total)
    for a in range(n):
        store_lanes(x, start + a * 8, load_lanes(scratch, a * 8))
        for b in range(a + 1):
            total = spread_lanes(Q[a, b])
            for c in range(n):
                total = total + spread_lanes(F[b, c]) * load_lanes(scratch, (n + a * n + c) * 8)
            store_lanes(P, square + (a * n + b) * 8, total)
            store_lanes(P, square + (b * n + a) * 8, total)


@njit(**COMPILE)
def correct_mode(i, n, p, H, r, z, x, P, scratch, log_likelihood, volume):  # type: ignore[no-untyped-def]
    """Correct mode i of eight runs by scalars z [c] at 8 c; the same order as in ``correct_group``.

    The log-likelihood is what it adds to log_likelihood less half the log of the volume, the product of the
    variances: one logarithm later serves several of them and the prediction of the mode.
    """
    start, square = i * n * 8, i * n * n * 8
    store_lanes(volume, i * 8, spread_lanes(1.0))
    for c in range(p):
        variance, innovation = spread_lanes(r[c]), load_lanes(z, c * 8)
        for a in range(n):
            v = load_lanes(P, square + a * n * 8) * spread_lanes(H[c, 0])
            for b in range(1, n):
                v = v + load_lanes(P, square + (a * n + b) * 8) * spread_lanes(H[c, b])
            store_lanes(scratch, a * 8, v)
            variance = variance + spread_lanes(H[c, a]) * v
            innovation = innovation - spread_lanes(H[c, a]) * load_lanes(x, start + a * 8)
        inverse = spread_lanes(1.0) / variance
        weight = innovation * inverse
        store_lanes(scratch, 2 * n * 8, variance)
        store_lanes(scratch, 2 * n * 8 + 8, innovation * weight)
        if not account(scratch, 2 * n * 8, log_likelihood, i * 8, volume, i * 8):
            return False
        for a in range(n):
            v = load_lanes(scratch, a * 8)
            store_lanes(x, start + a * 8, load_lanes(x, start + a * 8) + v * weight)
            gain = v * inverse
            store_lanes(scratch, (n + a) * 8, gain)
            for b in range(n):
                place = square + (a * n + b) * 8
                store_lanes(P, place, load_lanes(P, place) - gain * load_lanes(scratch, b * 8))
        for a in range(n):
            left = spread_lanes(r[c]) * load_lanes(scratch, (n + a) * 8)
            for b in range(n):
                left = left - load_lanes(P, square + (a * n + b) * 8) * spread_lanes(H[c, b])
            store_lanes(scratch, a * 8, left)
        for a in range(n):
            for b in range(a + 1):
                place = square + (a * n + b) * 8
                value = load_lanes(P, place) + load_lanes(scratch, a * 8) * load_lanes(scratch, (n + b) * 8)
                store_lanes(P, place, value)
                store_lanes(P, square + (b * n + a) * 8, value)
    return True


@njit(**COMPILE)
def merge_modes(m, n, weights, place, x, P, target, mean, covariance, off):  # type: ignore[no-untyped-def]
    """Merge the m modes of eight runs by weights [s] at ``(place + s) 8`` into slot ``target``; off (m n) 8."""
    start, square = target * n * 8, target * n * n * 8
    for a in range(n):
        total = load_lanes(weights, place * 8) * load_lanes(x, a * 8)
        for s in range(1, m):
            total = total + load_lanes(weights, (place + s) * 8) * load_lanes(x, (s * n + a) * 8)
        store_lanes(mean, start + a * 8, total)
        for s in range(m):
            store_lanes(off, (a * m + s) * 8, load_lanes(x, (s * n + a) * 8) - total)
    for a in range(n):
        for b in range(a + 1):
            total = spread_lanes(0.0)
            for s in range(m):
                inner = load_lanes(P, ((s * n + a) * n + b) * 8) + load_lanes(off, (a * m + s) * 8) * load_lanes(
                    off, (b * m + s) * 8
                )
                total = total + load_lanes(weights, (place + s) * 8) * inner
            store_lanes(covariance, square + (a * n + b) * 8, total)
            store_lanes(covariance, square + (b * n + a) * 8, total)


@njit(**COMPILE)
def mode_weights(m, branching, p_mode, logs, totals, shares, mixing, raw):  # type: ignore[no-untyped-def]
    """P[next mode] as exp(totals) shares and, for IMM, P[mode | next mode] in mixing [target, source].

    One exponential per mode serves all next modes; raw (m 8) is work space. A next mode whose share would underflow is
    done again in logarithms.
    """
    for lane in range(8):
        top = -np.inf
        for s in range(m):
            top = max(top, logs[s * 8 + lane])
        for s in range(m):
            raw[s * 8 + lane] = math.exp(logs[s * 8 + lane] - top)
            totals[s * 8 + lane] = top
    for i in range(m):
        total = load_lanes(raw, 0) * spread_lanes(p_mode[0, i])
        for s in range(1, m):
            total = total + load_lanes(raw, s * 8) * spread_lanes(p_mode[s, i])
        store_lanes(shares, i * 8, total)
        if branching == 1:
            inverse = spread_lanes(1.0) / total
            for s in range(m):
                store_lanes(mixing, (i * m + s) * 8, load_lanes(raw, s * 8) * spread_lanes(p_mode[s, i]) * inverse)
        for lane in range(8):
            if shares[i * 8 + lane] < 1e-290:
                top = totals[i * 8 + lane]
                totals[i * 8 + lane] = slow_column(m, i, lane, top, p_mode, logs, mixing)
                shares[i * 8 + lane] = 1.0


@njit(**COMPILE)
def slow_column(m, i, lane, top, p_mode, logs, mixing):  # type: ignore[no-untyped-def]
    """One next mode in logarithms throughout, for weights that would underflow; returns its log-weight."""
    best = -np.inf
    for s in range(m):
        if p_mode[s, i] > 0.0:
            best = max(best, logs[s * 8 + lane] + math.log(p_mode[s, i]))
    if best == -np.inf:
        whole = 0.0
        for s in range(m):
            whole += math.exp(logs[s * 8 + lane] - top)
        for s in range(m):
            mixing[(i * m + s) * 8 + lane] = math.exp(logs[s * 8 + lane] - top) / whole
        return best
    total = 0.0
    for s in range(m):
        if p_mode[s, i] > 0.0:
            total += math.exp(logs[s * 8 + lane] + math.log(p_mode[s, i]) - best)
    for s in range(m):
        share = 0.0
        if p_mode[s, i] > 0.0:
            share = math.exp(logs[s * 8 + lane] + math.log(p_mode[s, i]) - best) / total
        mixing[(i * m + s) * 8 + lane] = share
    return best + math.log(total)


@njit(inline="always", **COMPILE)
def begin_eight(m, n, log_prior, means, covariances, logs, x, P):  # type: ignore[no-untyped-def]
    """The same first estimates, means (m, n), covariances (m, n, n), in every lane."""
    for i in range(m):
        for lane in range(8):
            logs[i * 8 + lane] = log_prior[i]
        for a in range(n):
            store_lanes(x, (i * n + a) * 8, spread_lanes(means[i, a]))
            for b in range(n):
                store_lanes(P, ((i * n + a) * n + b) * 8, spread_lanes(covariances[i, a, b]))


@njit(inline="always", **COMPILE)
def lay_eight(first, k, i, rotated, u, z, zl):  # type: ignore[no-untyped-def]
    """Measurement k of eight runs, rotated into independent scalars of mode i where R is not diagonal."""
    runs, _, p = z.shape
    for c in range(p):
        for lane in range(8):
            run = min(first + lane, runs - 1)
            value = z[run, k, c]
            if rotated:
                value = 0.0
                for a in range(p):
                    value += u[i, a, c] * z[run, k, a]
            zl[c * 8 + lane] = value


@njit(inline="always", **COMPILE)
def weigh_eight(m, totals, shares, volume, ll, logs, weights, total_log):  # type: ignore[no-untyped-def]
    """Bayes' rule over the modes of every run; False when all modes of one are impossible."""
    for lane in range(8):
        top = -np.inf
        for i in range(m):
            share = shares[i * 8 + lane] / math.sqrt(volume[i * 8 + lane])
            logs[i * 8 + lane] = totals[i * 8 + lane] + ll[i * 8 + lane] + math.log(share)
            top = max(top, logs[i * 8 + lane])
        if top == -np.inf:
            return False
        whole = 0.0
        for i in range(m):
            weights[i * 8 + lane] = math.exp(logs[i * 8 + lane] - top)
            whole += weights[i * 8 + lane]
        step_log = top + math.log(whole)
        total_log[lane] += step_log
        for i in range(m):
            weights[i * 8 + lane] /= whole
            logs[i * 8 + lane] -= step_log
    return True


@njit(inline="always", **COMPILE)
def keep_eight(  # type: ignore[no-untyped-def]
    first, k, m, n, total_log, weights, now_mean, now, mean, covariance, probabilities, log_likelihood
):
    """The answers of step k out of the lanes; lanes beyond the last run are left."""
    for lane in range(min(8, mean.shape[0] - first)):
        run = first + lane
        log_likelihood[run, k] = total_log[lane]
        for i in range(m):
            probabilities[run, k, i] = weights[i * 8 + lane]
        for a in range(n):
            mean[run, k, a] = now_mean[a * 8 + lane]
            for b in range(n):
                covariance[run, k, a, b] = now[(a * n + b) * 8 + lane]


@njit(inline="always", **COMPILE)
def restart_eight(m, n, now_mean, now, x, P):  # type: ignore[no-untyped-def]
    """Every mode goes on from the merged estimate: the pulsating filter."""
    for i in range(m):
        for a in range(n):
            store_lanes(x, (i * n + a) * 8, load_lanes(now_mean, a * 8))
            for b in range(n):
                store_lanes(P, ((i * n + a) * n + b) * 8, load_lanes(now, (a * n + b) * 8))


@njit(**COMPILE)
def run_eight(first, branching, models, start, z, out):  # type: ignore[no-untyped-def]
    """Eight runs from ``first`` on through all steps; branching 0 pulsating, 1 IMM, 2 polygaussian.

    models : F, Q, H, r, U, whether the measurements are rotated by U, mode transition; start : log probabilities (m,),
    means (m, n), covariances (m, n, n) at step 0; z (runs, T, p) without gaps; out, filled here : mean (runs, T, n),
    covariance (runs, T, n, n), probabilities (runs, T, m), log_likelihood (runs, T).
    Returns False when a variance is not positive.
    """
    F, Q, H, r, U, rotated, p_mode = models
    log_prior, means, covariances = start
    mean, covariance, probabilities, log_likelihood = out
    _, T, p = z.shape
    m, n = F.shape[1], F.shape[2]
    x, P, y, S = aligned(m * n * 8), aligned(m * n * n * 8), aligned(m * n * 8), aligned(m * n * n * 8)
    logs, totals, weights, mixing = aligned(m * 8), aligned(m * 8), aligned(m * 8), aligned(m * m * 8)
    ll, zl, off = aligned(m * 8), aligned(p * 8), aligned(m * n * 8)
    shares, volume = aligned(m * 8), aligned(m * 8)
    scratch = aligned((n * n + 2 * n + 2) * 8)
    now_mean, now = aligned(n * 8), aligned(n * n * 8)
    total_log = np.zeros(8)
    begin_eight(m, n, log_prior, means, covariances, logs, x, P)
    for k in range(T):
        f, q = F[min(k, F.shape[0] - 1)], Q[min(k, Q.shape[0] - 1)]
        h, v, u = H[min(k, H.shape[0] - 1)], r[min(k, r.shape[0] - 1)], U[min(k, U.shape[0] - 1)]
        if branching == 2:
            totals[:], shares[:] = logs, 1.0
        else:
            mode_weights(m, branching, p_mode[min(k, p_mode.shape[0] - 1)], logs, totals, shares, mixing, weights)
        if branching == 1:
            for i in range(m):
                merge_modes(m, n, mixing, i * m, x, P, i, y, S, off)
            x, y, P, S = y, x, S, P
        for i in range(m):
            lay_eight(first, k, i, rotated, u, z, zl)
            store_lanes(ll, i * 8, spread_lanes(0.0))
            predict_mode(i, n, f[i], q[i], x, P, scratch)
            if not correct_mode(i, n, p, h[i], v[i], zl, x, P, scratch, ll, volume):
                return False
        if not weigh_eight(m, totals, shares, volume, ll, logs, weights, total_log):
            return False
        merge_modes(m, n, weights, 0, x, P, 0, now_mean, now, off)
        keep_eight(first, k, m, n, total_log, weights, now_mean, now, mean, covariance, probabilities, log_likelihood)
        if branching == 0:
            restart_eight(m, n, now_mean, now, x, P)
    return True
