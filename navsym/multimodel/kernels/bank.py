"""A whole series of measurements through any scheme of multiple models, in one compiled loop.

Hypotheses are the lanes of :mod:`navsym.multimodel.kernels.filter`; the fold happens on the fly, so nothing but
the current hypotheses is kept. The readable twin is :mod:`navsym.multimodel.engine`.
"""

from __future__ import annotations

import math

import numpy as np

from navsym.core.loops import njit
from navsym.multimodel.kernels.filter import COMPILE, aligned, correct_group, mix_group, moments, predict_group

# Probabilities of modes in compiled loops, as logarithms: prediction, mixing, and sums over branches.


@njit(**COMPILE)
def log_sum(values, count):  # type: ignore[no-untyped-def]
    """log of the sum of exp of the first entries; -inf when there is none."""
    top = -np.inf
    for s in range(count):
        top = max(top, values[s])
    if top == -np.inf:
        return top
    total = 0.0
    for s in range(count):
        total += math.exp(values[s] - top)
    return top + math.log(total)


@njit(**COMPILE)
def predict_modes(sources, known, modes, log_weights, log_p, out, terms):  # type: ignore[no-untyped-def]
    """log P[source, next mode] (sources, m).

    known : every source knows its last mode, source % m, and log_weights is (sources,);
            otherwise there is one source and log_weights (m,) belongs to its last modes
    """
    for s in range(sources):
        for i in range(modes):
            if known:
                out[s, i] = log_weights[s] + log_p[s % modes, i]
            else:
                for j in range(modes):
                    terms[j] = log_weights[j] + log_p[j, i]
                out[s, i] = log_sum(terms, modes)


@njit(**COMPILE)
def mixing_weights(sources, modes, ahead, totals, weights, terms):  # type: ignore[no-untyped-def]
    """P[source | next mode] in lanes and log P[next mode]; an impossible mode takes the weights of all.

    One exponential per source serves all targets unless weights lie so far apart that it would underflow.
    """
    for b in range(((modes + 7) // 8) * 8):
        i = min(b, modes - 1)
        for s in range(sources):
            terms[s] = ahead[s, i]
        total = log_sum(terms, sources)
        if b < modes:
            totals[b] = total
        if total == -np.inf:
            for s in range(sources):
                terms[s] = -np.inf
                for j in range(modes):
                    terms[s] = max(terms[s], ahead[s, j])
            total = log_sum(terms, sources)
        for s in range(sources):
            weights[((b // 8) * sources + s) * 8 + b % 8] = math.exp(terms[s] - total)


@njit(inline="always", **COMPILE)
def mix_quickly(modes, logs, transition, totals, weights, terms):  # type: ignore[no-untyped-def]
    """The same with one exponential per source, when every source knows its mode; False when it must not.

    It must not when a weight would underflow beside the largest, or when a next mode is impossible.
    """
    top = logs[0]
    for s in range(1, modes):
        top = max(top, logs[s])
    for s in range(modes):
        if not logs[s] - top > -600.0:
            return False
        terms[s] = math.exp(logs[s] - top)
    for i in range(((modes + 7) // 8) * 8):
        column = min(i, modes - 1)
        total = 0.0
        for s in range(modes):
            total += terms[s] * transition[s, column]
        if not total > 1e-250:
            return False
        inverse = 1.0 / total
        for s in range(modes):
            weights[((i // 8) * modes + s) * 8 + i % 8] = terms[s] * transition[s, column] * inverse
        if i < modes:
            totals[i] = top + math.log(total)
    return True


@njit(**COMPILE)
def log_sums_by_mode(branches, modes, logs, totals, terms):  # type: ignore[no-untyped-def]
    """totals[i] <- log of the sum of the weights of all branches with the last mode i."""
    for i in range(modes):
        count = 0
        for b in range(i, branches, modes):
            terms[count] = logs[b]
            count += 1
        totals[i] = log_sum(terms, count)


@njit(inline="always", **COMPILE)
def weigh(branches, modes, totals, likelihoods, logs, weights, k, probabilities):  # type: ignore[no-untyped-def]
    """Bayes' rule over the branches: log of the evidence, and the largest log-likelihood.

    totals + likelihoods are the logarithms of the unnormalised weights; fills logs, normalised, weights (zero in
    idle lanes) and row k of the probabilities of the last modes. The evidence is -inf when every branch is impossible.
    """
    top, finest = -np.inf, -np.inf
    for b in range(branches):
        finest = max(finest, likelihoods[b])
        logs[b] = totals[b] + likelihoods[b]
        top = max(top, logs[b])
    if top == -np.inf:
        return top, finest
    whole = 0.0
    for b in range((branches + 7) // 8 * 8):
        weights[b] = math.exp(logs[b] - top) if b < branches else 0.0
        whole += weights[b]
    evidence = top + math.log(whole)
    for i in range(modes):
        probabilities[k, i] = 0.0
    for b in range(branches):
        weights[b] /= whole
        probabilities[k, b % modes] += weights[b]
    for b in range(branches):
        logs[b] -= evidence
    return evidence, finest


# Models, measurements and first estimates in the layout of lanes, for :mod:`navsym.multimodel.kernels.bank`.
#
# Branch b stands in lane b % 8 of group b // 8; its mode is b % modes.


@njit(**COMPILE)
def lay_start(sources, n, means, covariances, x, P):  # type: ignore[no-untyped-def]
    """The estimates of step 0, means (sources, n), covariances (sources, n, n), one in each lane."""
    for s in range(sources):
        for a in range(n):
            x[((s // 8) * n + a) * 8 + s % 8] = means[s, a]
            for c in range(n):
                P[(((s // 8) * n + a) * n + c) * 8 + s % 8] = covariances[s, a, c]


@njit(**COMPILE)
def lay_models(k, branches, modes, F, Q, H, r, lanes):  # type: ignore[no-untyped-def]
    """Models of step k, branch b has mode b % modes, into the layout of lanes; idle lanes get a unit model.

    F, Q (T or 1, m, n, n), H (T or 1, m, p, n), r (T or 1, m, p), lanes = (F, Q, H, r) flat.
    """
    n, p = F.shape[2], H.shape[2]
    f, q = F[min(k, F.shape[0] - 1)], Q[min(k, Q.shape[0] - 1)]
    h, v = H[min(k, H.shape[0] - 1)], r[min(k, r.shape[0] - 1)]
    for b in range(((branches + 7) // 8) * 8):
        g, lane, i = b // 8, b % 8, b % modes
        used = b < branches
        for a in range(n):
            for c in range(n):
                place = ((g * n + a) * n + c) * 8 + lane
                lanes[0][place] = f[i, a, c] if used else 0.0
                lanes[1][place] = q[i, a, c] if used else (1.0 if a == c else 0.0)
        for a in range(p):
            for c in range(n):
                lanes[2][((g * p + a) * n + c) * 8 + lane] = h[i, a, c] if used else 0.0
            lanes[3][(g * p + a) * 8 + lane] = v[i, a] if used else 1.0


@njit(inline="always", **COMPILE)
def lay_measurement(k, branches, modes, rotated, U, z, came, out):  # type: ignore[no-untyped-def]
    """Measurement k in every lane, rotated into independent scalars where R is not diagonal."""
    p = z.shape[1]
    u = U[min(k, U.shape[0] - 1)]
    for c in range(p):
        came[c] = not math.isnan(z[k, c])
    for b in range(((branches + 7) // 8) * 8):
        g, lane, i = b // 8, b % 8, b % modes
        for c in range(p):
            value = z[k, c] if came[c] else 0.0
            if rotated:
                value = 0.0
                for a in range(p):
                    value += u[i, a, c] * (z[k, a] if came[a] else 0.0)
            out[(g * p + c) * 8 + lane] = value if b < branches else 0.0


@njit(**COMPILE)
def copy_sources(branches, modes, n, x, P, mean, covariance):  # type: ignore[no-untyped-def]
    """Branch b starts from source b // m."""
    for b in range(branches):
        g, lane, s = b // 8, b % 8, b // modes
        for a in range(n):
            mean[(g * n + a) * 8 + lane] = x[((s // 8) * n + a) * 8 + s % 8]
            for c in range(n):
                source = (((s // 8) * n + a) * n + c) * 8 + s % 8
                covariance[((g * n + a) * n + c) * 8 + lane] = P[source]


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
def fold(folding, branches, m, n, logs, totals, terms, weights, nx, nP, mean, covariance, x, P):  # type: ignore[no-untyped-def]
    """The sources of the next step, and their log weights: one for all branches, or one for each mode."""
    log_sums_by_mode(branches, m, logs, totals, terms)
    if folding == ALL:  # the merged estimate is the only source: GPB1
        for a in range(n):
            x[a * 8] = mean[a]
            for c in range(n):
                P[(a * n + c) * 8] = covariance[a, c]
    else:
        fold_by_mode(branches, m, n, logs, totals, weights, nx, nP, x, P)
    for i in range(m):
        logs[i] = totals[i]


@njit(**COMPILE)
def run_bank(scheme, models, chain, start, z, results):  # type: ignore[no-untyped-def]
    """Filter a series z (T, p) with NaN for missing; fills results.

    scheme: branching, folding, period, most hypotheses, whether all modes start alike; models: F, Q (T or 1, m, n, n),
    H rotated, r variances, U rotations (T or 1, m, p, p), whether they rotate; chain: p_mode, log_p (T or 1, m, m);
    start: log_prior, means, covariances; results: probabilities, mean, covariance, cumulative log_likelihood, best.
    Returns 0, or the step (from 1) at which lanes cannot go on and the readable engine must take over.
    """
    branching, folding, period, widest, common = scheme  # by its own name: a tuple in the loop costs 5 % of a step
    F, Q, H, r, U, rotated = models
    p_mode, log_p = chain
    log_prior, means, covariances = start
    probabilities, mean, covariance, log_likelihood, best = results
    T, m, n, p = z.shape[0], F.shape[1], F.shape[2], z.shape[1]
    size, groups = max(widest, m), (max(widest, m) + 7) // 8
    x, P = aligned(groups * n * 8), aligned(groups * n * n * 8)
    nx, nP = aligned(groups * n * 8), aligned(groups * n * n * 8)
    lf, lq = aligned(groups * n * n * 8), aligned(groups * n * n * 8)
    lh, lr = aligned(groups * p * n * 8), aligned(groups * p * 8)
    current_mean, current, came = np.zeros(n), np.zeros((n, n)), np.zeros(p, dtype=np.bool_)
    scratch, ahead, totals = aligned((n * n + 3 * n + 3) * 8), np.zeros((size, m)), aligned(groups * 8)
    weights, logs, ll, zl = aligned(groups * 8), aligned(groups * 8), aligned(groups * 8), aligned(groups * p * 8)
    mixed = size if branching == MIXED else 1
    mixing, off, terms = aligned(groups * mixed * 8), aligned(mixed * n * 8), aligned(size)
    known, sources = (True, m) if branching == OWN or not common else (False, 1)
    lay_start(sources, n, means, covariances, x, P)
    logs[:m] = log_prior
    laid, total_log, unchanging = 0, 0.0, F.shape[0] == Q.shape[0] == H.shape[0] == r.shape[0] == 1
    for k in range(T):
        branches = sources * m if branching == CROSS else m
        branch_modes(branching, known, sources, m, k, logs, p_mode, log_p, totals, mixing, ahead, terms)
        if branching == OWN:
            x, nx, P, nP = nx, x, nP, P
        elif branching == CROSS:
            copy_sources(branches, m, n, x, P, nx, nP)
        if laid != branches or not unchanging:
            lay_models(k, branches, m, F, Q, H, r, (lf, lq, lh, lr))
            laid = branches
        lay_measurement(k, branches, m, rotated, U, z, came, zl)
        for g in range((branches + 7) // 8):
            ll[g * 8 : (g + 1) * 8] = 0.0
            if branching == MIXED:  # mixed, predicted and corrected group by group, while its numbers are near
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
            x, nx, P, nP = nx, x, nP, P
            sources, known = branches, True
        else:
            fold(folding, branches, m, n, logs, totals, terms, weights, nx, nP, current_mean, current, x, P)
            sources, known = (1, False) if folding == ALL else (m, True)
    return 0
