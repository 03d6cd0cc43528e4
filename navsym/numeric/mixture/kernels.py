"""A whole series of measurements through any scheme of multiple models, in one compiled loop.

Hypotheses are the lanes of :mod:`navsym.numeric.mixture.filter`; the fold happens on the fly, so nothing but
the current hypotheses is kept. The readable twin is ``navsym.methods.multimodel.steps``.
"""

from __future__ import annotations

import math

import numpy as np

from navsym.numeric.compiled import njit
from navsym.numeric.mixture.filter import COMPILE, aligned, correct_group, mix_group, moments, predict_group
from navsym.numeric.mixture.layout import copy_sources, lay_measurement, lay_models, lay_start
from navsym.numeric.mixture.modes import log_sums_by_mode, mix_quickly, mixing_weights, predict_modes, weigh

#: Branching and folding by number, because compiled code has no words.
CROSS, MIXED, OWN = 0, 1, 2
KEEP, ALL, BY_MODE = 0, 1, 2


@njit(inline="always", **COMPILE)
def branch_modes(  # type: ignore[no-untyped-def]
    branching, known, sources, m, k, logs, p_mode, log_p, totals, mixing, ahead, terms
):
    """totals[b] <- log P[branch b] before its measurement; for IMM also the weights of the mixing."""
    if branching == OWN:
        for b in range(m):
            totals[b] = logs[b]
    elif branching == MIXED:
        transition = p_mode[min(k, p_mode.shape[0] - 1)]
        if not (known and mix_quickly(m, logs, transition, totals, mixing, terms)):
            predict_modes(sources, known, m, logs, log_p[min(k, log_p.shape[0] - 1)], ahead, terms)
            mixing_weights(sources, m, ahead, totals, mixing, terms)
    else:
        predict_modes(sources, known, m, logs, log_p[min(k, log_p.shape[0] - 1)], ahead, terms)
        for b in range(sources * m):
            totals[b] = ahead[b // m, b % m]


@njit(inline="always", **COMPILE)
def keep(k, n, now_mean, now, mean, covariance):  # type: ignore[no-untyped-def]
    """Estimate of step k into the answer; by entries, since assigning a row of a short array takes longer."""
    for a in range(n):
        mean[k, a] = now_mean[a]
        for c in range(n):
            covariance[k, a, c] = now[a, c]


@njit(**COMPILE)
def fold_to_one(n, mean, covariance, x, P):  # type: ignore[no-untyped-def]
    """The merged estimate (n,), (n, n) as the only source: GPB1."""
    for a in range(n):
        x[a * 8] = mean[a]
        for c in range(n):
            P[(a * n + c) * 8] = covariance[a, c]


@njit(**COMPILE)
def fold_by_mode(branches, modes, n, logs, totals, weights, x, P, mean, covariance):  # type: ignore[no-untyped-def]
    """Merge the branches of every last mode: GPB2.

    Shares come from logarithms, logs (branches,) and their sums totals (m,): a mode whose weight underflows
    today may be the right one tomorrow, and must not forget how its branches compare. weights is overwritten.
    """
    for i in range(modes):
        g, lane = i // 8, i % 8
        for b in range(i, branches, modes):
            weights[b] = math.exp(logs[b] - totals[i]) if totals[i] > -np.inf else modes / branches
        for a in range(n):
            total = 0.0
            for b in range(i, branches, modes):
                total += weights[b] * x[((b // 8) * n + a) * 8 + b % 8]
            mean[(g * n + a) * 8 + lane] = total
        for a in range(n):
            for c in range(n):
                total = 0.0
                for b in range(i, branches, modes):
                    block, other = b // 8, b % 8
                    off = x[(block * n + a) * 8 + other] - mean[(g * n + a) * 8 + lane]
                    off *= x[(block * n + c) * 8 + other] - mean[(g * n + c) * 8 + lane]
                    total += weights[b] * (P[((block * n + a) * n + c) * 8 + other] + off)
                covariance[((g * n + a) * n + c) * 8 + lane] = total


@njit(**COMPILE)
def constant(F, Q, H, r):  # type: ignore[no-untyped-def]
    """Whether no model changes with time."""
    return F.shape[0] == 1 and Q.shape[0] == 1 and H.shape[0] == 1 and r.shape[0] == 1


@njit(**COMPILE)
def run_bank(  # type: ignore[no-untyped-def]
    branching,
    folding,
    period,
    widest,
    F,
    Q,
    H,
    r,
    U,
    rotated,
    p_mode,
    log_p,
    log_prior,
    common,
    means,
    covariances,
    z,
    probabilities,
    mean,
    covariance,
    log_likelihood,
    best,
):
    """Filter a series; fills probabilities (T, m), mean, covariance, log_likelihood (cumulative), best.

    F, Q (T or 1, m, n, n), H rotated, r variances, U rotations (T or 1, m, p, p), p_mode and log_p (T or 1, m, m),
    means (m, n), covariances (m, n, n), z (T, p) with NaN for missing.
    Returns 0, or the step (from 1) at which lanes cannot go on and the readable engine must take over.
    """
    T, m, n, p = z.shape[0], F.shape[1], F.shape[2], z.shape[1]
    size = max(widest, m)
    groups = (size + 7) // 8
    x, P = aligned(groups * n * 8), aligned(groups * n * n * 8)
    nx, nP = aligned(groups * n * 8), aligned(groups * n * n * 8)
    lanes = (
        aligned(groups * n * n * 8),
        aligned(groups * n * n * 8),
        aligned(groups * p * n * 8),
        aligned(groups * p * 8),
    )
    lf, lq, lh, lr = lanes  # each by its own name in the loop: a tuple there costs 5 % of a step
    zl, came = aligned(groups * p * 8), np.zeros(p, dtype=np.bool_)
    scratch = aligned((n * n + 3 * n + 3) * 8)
    ahead, totals = np.zeros((size, m)), aligned(groups * 8)
    weights, logs, ll = aligned(groups * 8), aligned(groups * 8), aligned(groups * 8)
    mixing, terms = aligned(groups * size * 8 if branching == MIXED else 8), aligned(size)
    off = aligned(size * n * 8 if branching == MIXED else 8)
    current_mean, current = np.zeros(n), np.zeros((n, n))

    known = branching == OWN or not common
    sources = m if known else 1
    lay_start(sources, n, means, covariances, x, P)
    logs[:m] = log_prior
    laid, total_log, unchanging = 0, 0.0, constant(F, Q, H, r)
    for k in range(T):
        branches = sources * m if branching == CROSS else m
        branch_modes(branching, known, sources, m, k, logs, p_mode, log_p, totals, mixing, ahead, terms)
        if branching == OWN:
            x, nx = nx, x
            P, nP = nP, P
        elif branching == CROSS:
            copy_sources(branches, m, n, x, P, nx, nP)
        if laid != branches or not unchanging:
            lay_models(k, branches, m, F, Q, H, r, U, z, lanes)
            laid = branches
        lay_measurement(k, branches, m, rotated, U, z, came, zl)
        for g in range((branches + 7) // 8):
            for lane in range(8):
                ll[g * 8 + lane] = 0.0
            if branching == MIXED:
                # Mixed, predicted and corrected group by group, while its numbers are near.
                mix_group(g, n, sources, mixing, x, P, nx, nP, off)
            predict_group(g, n, lf, lq, nx, nP, scratch)
            if not correct_group(g, n, p, came, lh, lr, zl, nx, nP, scratch, ll):
                return k + 1
        evidence, best[k] = weigh(branches, m, totals, ll, logs, weights, k, probabilities)
        if evidence == -np.inf:
            return k + 1
        total_log += evidence
        log_likelihood[k] = total_log
        moments((branches + 7) // 8, n, weights, nx, nP, current_mean, current, scratch)
        keep(k, n, current_mean, current, mean, covariance)
        if folding == KEEP or (folding == ALL and (k + 1) % period) or (folding == BY_MODE and branches <= m):
            x, nx = nx, x
            P, nP = nP, P
            sources, known = branches, True
            continue
        log_sums_by_mode(branches, m, logs, totals, terms)
        if folding == ALL:
            fold_to_one(n, current_mean, current, x, P)
        else:
            fold_by_mode(branches, m, n, logs, totals, weights, nx, nP, x, P)
        for i in range(m):
            logs[i] = totals[i]
        sources, known = (1, False) if folding == ALL else (m, True)
    return 0
