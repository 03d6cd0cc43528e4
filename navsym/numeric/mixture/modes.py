"""Probabilities of modes in compiled loops, as logarithms: prediction, mixing, and sums over branches."""

from __future__ import annotations

import math

import numpy as np

from navsym.numeric.compiled import njit
from navsym.numeric.mixture.filter import COMPILE


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
