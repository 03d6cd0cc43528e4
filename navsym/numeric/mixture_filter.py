"""Kalman filters in lanes: eight at a time, predicted and corrected in place.

Layout of a group of eight: mean [a] at ``(g n + a) 8``, covariance [a, b] at ``((g n + a) n + b) 8``; models
the same way. Measurements are scalars one after another, which Joseph's form turns into two updates of rank
one instead of products of matrices.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from navsym.numeric.mixture_lanes import load, spread, store

LOG_TWO_PI = math.log(2.0 * math.pi)
COMPILE = {"cache": True, "error_model": "numpy", "nogil": True}


@numba.njit(**COMPILE)
def predict_group(g, n, F, Q, x, P, scratch):  # type: ignore[no-untyped-def]
    """x <- F x, P <- F P F^T + Q for the eight filters of group g; scratch (n + n n) 8."""
    start, square = g * n * 8, g * n * n * 8
    for a in range(n):
        total = load(F, square + a * n * 8) * load(x, start)
        for c in range(1, n):
            total = total + load(F, square + (a * n + c) * 8) * load(x, start + c * 8)
        store(scratch, a * 8, total)
        for b in range(n):
            total = load(F, square + a * n * 8) * load(P, square + b * 8)
            for c in range(1, n):
                total = total + load(F, square + (a * n + c) * 8) * load(P, square + (c * n + b) * 8)
            store(scratch, (n + a * n + b) * 8, total)
    for a in range(n):
        store(x, start + a * 8, load(scratch, a * 8))
        for b in range(a + 1):
            total = load(Q, square + (a * n + b) * 8)
            for c in range(n):
                total = total + load(F, square + (b * n + c) * 8) * load(scratch, (n + a * n + c) * 8)
            store(P, square + (a * n + b) * 8, total)
            store(P, square + (b * n + a) * 8, total)


@numba.njit(**COMPILE)
def correct_group(g, n, p, came, H, r, z, x, P, scratch, log_likelihood):  # type: ignore[no-untyped-def]
    """Correct the eight filters of group g by the scalars that came; False when a variance is not positive.

    H [c, a] at ``((g p + c) n + a) 8``, r and z [c] at ``(g p + c) 8``, came (p,); adds to log_likelihood.
    Joseph's form for one scalar, in the order of Bierman: P1 = P - k v^T with v = P h, then
    P = P1 + (r k - P1 h) k^T. It costs n^2 and stays symmetric and positive under rounding.
    """
    start, square = g * n * 8, g * n * n * 8
    for c in range(p):
        if not came[c]:
            continue
        row = (g * p + c) * n * 8
        variance, innovation = load(r, (g * p + c) * 8), load(z, (g * p + c) * 8)
        for a in range(n):
            v = load(P, square + a * n * 8) * load(H, row)
            for b in range(1, n):
                v = v + load(P, square + (a * n + b) * 8) * load(H, row + b * 8)
            store(scratch, a * 8, v)
            variance = variance + load(H, row + a * 8) * v
            innovation = innovation - load(H, row + a * 8) * load(x, start + a * 8)
        store(scratch, 2 * n * 8, variance)
        store(scratch, 2 * n * 8 + 8, innovation * innovation / variance)
        for lane in range(8):
            s, distance = scratch[2 * n * 8 + lane], scratch[2 * n * 8 + 8 + lane]
            if not (s > 0.0 and distance < np.inf):
                return False
            log_likelihood[g * 8 + lane] -= 0.5 * (distance + math.log(s) + LOG_TWO_PI)
        weight = innovation / variance
        for a in range(n):
            v = load(scratch, a * 8)
            store(x, start + a * 8, load(x, start + a * 8) + v * weight)
            gain = v / variance
            store(scratch, (n + a) * 8, gain)
            for b in range(n):
                place = square + (a * n + b) * 8
                store(P, place, load(P, place) - gain * load(scratch, b * 8))
        noise = load(r, (g * p + c) * 8)
        for a in range(n):
            left = noise * load(scratch, (n + a) * 8)
            for b in range(n):
                left = left - load(P, square + (a * n + b) * 8) * load(H, row + b * 8)
            store(scratch, a * 8, left)
        for a in range(n):
            for b in range(a + 1):
                place = square + (a * n + b) * 8
                value = load(P, place) + load(scratch, a * 8) * load(scratch, (n + b) * 8)
                store(P, place, value)
                store(P, square + (b * n + a) * 8, value)
    return True


@numba.njit(**COMPILE)
def mix_group(g, n, sources, weights, x, P, mean, covariance, off):  # type: ignore[no-untyped-def]
    """Merge all sources with the weights of each of eight targets: the interaction of IMM.

    weights [source, lane] at ``(g sources + s) 8``; sources are read from x, P in the layout of lanes,
    targets are written to mean, covariance, group g. Deviations are taken from each target's own mean and
    kept in off (2 sources n 8), plain and weighted, so that the inner loop holds its sums in registers.
    """
    start, square, plain = g * n * 8, g * n * n * 8, sources * n * 8
    for a in range(n):
        total = spread(0.0)
        for s in range(sources):
            total = total + load(weights, (g * sources + s) * 8) * spread(x[((s // 8) * n + a) * 8 + s % 8])
        store(mean, start + a * 8, total)
        for s in range(sources):
            deviation = spread(x[((s // 8) * n + a) * 8 + s % 8]) - total
            store(off, (a * sources + s) * 8, deviation)
            store(off, plain + (a * sources + s) * 8, load(weights, (g * sources + s) * 8) * deviation)
    full = sources // 8 * 8
    for a in range(n):
        for b in range(a + 1):
            inside, between = spread(0.0), spread(0.0)
            left, right, given = plain + a * sources * 8, b * sources * 8, g * sources * 8
            # Blocks of eight without divisions of the index; the second sum keeps the chains short.
            for s in range(0, full, 8):
                value = (s * n * n) + (a * n + b) * 8
                for lane in range(8):
                    step = (s + lane) * 8
                    inside = inside + load(weights, given + step) * spread(P[value + lane])
                    between = between + load(off, left + step) * load(off, right + step)
            for s in range(full, sources):
                value = spread(P[full * n * n + (a * n + b) * 8 + s - full])
                inside = inside + load(weights, given + s * 8) * value
                between = between + load(off, left + s * 8) * load(off, right + s * 8)
            store(covariance, square + (a * n + b) * 8, inside + between)
            store(covariance, square + (b * n + a) * 8, inside + between)


@numba.njit(**COMPILE)
def moments(groups, n, weights, x, P, mean, covariance, scratch):  # type: ignore[no-untyped-def]
    """Mean (n,) and covariance (n, n) of all lanes with their weights (8 groups,); scratch (8,)."""
    for a in range(n):
        total = spread(0.0)
        for g in range(groups):
            total = total + load(weights, g * 8) * load(x, (g * n + a) * 8)
        store(scratch, 0, total)
        mean[a] = gathered(scratch)
    for a in range(n):
        for b in range(a + 1):
            total = spread(0.0)
            for g in range(groups):
                off = load(x, (g * n + a) * 8) - spread(mean[a])
                other = load(x, (g * n + b) * 8) - spread(mean[b])
                total = total + load(weights, g * 8) * (load(P, ((g * n + a) * n + b) * 8) + off * other)
            store(scratch, 0, total)
            covariance[a, b] = gathered(scratch)
            covariance[b, a] = covariance[a, b]


@numba.njit(**COMPILE)
def gathered(lanes):  # type: ignore[no-untyped-def]
    """Sum of eight doubles, in pairs."""
    return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) + ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]))
