"""Kalman filters in lanes: eight at a time, predicted and corrected in place.

Layout of a group of eight: mean [a] at ``(g n + a) 8``, covariance [a, b] at ``((g n + a) n + b) 8``; models
the same way. Measurements are scalars one after another, which Joseph's form turns into two updates of rank
one instead of products of matrices.
"""

from __future__ import annotations

import math

import numpy as np

from navsym.core.lanes import load_lanes, spread_lanes, store_lanes
from navsym.core.loops import njit

LOG_TWO_PI = math.log(2.0 * math.pi)
COMPILE = {"error_model": "numpy", "nogil": True}


@njit(**COMPILE)
def aligned(size):  # type: ignore[no-untyped-def]
    """Zeros that begin on a cache line: eight doubles then never straddle two, which would cost half the speed."""
    raw = np.zeros(size + 8)
    skip = (64 - raw.ctypes.data % 64) % 64 // 8
    return raw[skip : skip + size]


@njit(**COMPILE)
def predict_group(g, n, F, Q, x, P, scratch):  # type: ignore[no-untyped-def]
    """x <- F x, P <- F P F^T + Q for the eight filters of group g; scratch (n + n n) 8."""
    start, square = g * n * 8, g * n * n * 8
    for a in range(n):
        total = load_lanes(F, square + a * n * 8) * load_lanes(x, start)
        for c in range(1, n):
            total = total + load_lanes(F, square + (a * n + c) * 8) * load_lanes(x, start + c * 8)
        store_lanes(scratch, a * 8, total)
    for a in range(n):
        store_lanes(x, start + a * 8, load_lanes(scratch, a * 8))
    rows, columns = n // 2 * 2, n // 3 * 3
    for a in range(0, rows, 2):
        for b in range(0, columns, 3):
            six_of_product(n, F, square, P, square, scratch, n * 8, a, b)
        for b in range(columns, n):
            one_of_product(n, F, square, P, square, scratch, n * 8, a, b)
            one_of_product(n, F, square, P, square, scratch, n * 8, a + 1, b)
    for a in range(rows, n):
        for b in range(n):
            one_of_product(n, F, square, P, square, scratch, n * 8, a, b)
    for a in range(n):
        full = (a + 1) // 3 * 3
        for b in range(0, full, 3):
            place = square + (a * n + b) * 8
            first, second, third = load_lanes(Q, place), load_lanes(Q, place + 8), load_lanes(Q, place + 16)
            for c in range(n):
                entry, row = load_lanes(scratch, (n + a * n + c) * 8), square + (b * n + c) * 8
                first = first + load_lanes(F, row) * entry
                second = second + load_lanes(F, row + n * 8) * entry
                third = third + load_lanes(F, row + 2 * n * 8) * entry
            store_twice(P, square, n, a, b, first)
            store_twice(P, square, n, a, b + 1, second)
            store_twice(P, square, n, a, b + 2, third)
        for b in range(full, a + 1):
            total = load_lanes(Q, square + (a * n + b) * 8)
            for c in range(n):
                total = total + load_lanes(F, square + (b * n + c) * 8) * load_lanes(scratch, (n + a * n + c) * 8)
            store_twice(P, square, n, a, b, total)


@njit(inline="always", **COMPILE)
def six_of_product(n, A, at_a, B, at_b, out, at_out, a, b):  # type: ignore[no-untyped-def]
    """Entries [a, b..b+2] and [a+1, b..b+2] of a product: five loads for six products."""
    s0, s1, s2 = spread_lanes(0.0), spread_lanes(0.0), spread_lanes(0.0)
    t0, t1, t2 = s0, s1, s2
    for c in range(n):
        up, down = load_lanes(A, at_a + (a * n + c) * 8), load_lanes(A, at_a + (a * n + n + c) * 8)
        row = at_b + (c * n + b) * 8
        p0, p1, p2 = load_lanes(B, row), load_lanes(B, row + 8), load_lanes(B, row + 16)
        s0, s1, s2 = s0 + up * p0, s1 + up * p1, s2 + up * p2
        t0, t1, t2 = t0 + down * p0, t1 + down * p1, t2 + down * p2
    place = at_out + (a * n + b) * 8
    store_lanes(out, place, s0)
    store_lanes(out, place + 8, s1)
    store_lanes(out, place + 16, s2)
    store_lanes(out, place + n * 8, t0)
    store_lanes(out, place + n * 8 + 8, t1)
    store_lanes(out, place + n * 8 + 16, t2)


@njit(inline="always", **COMPILE)
def one_of_product(n, A, at_a, B, at_b, out, at_out, a, b):  # type: ignore[no-untyped-def]
    """Entry [a, b] of a product."""
    total = spread_lanes(0.0)
    for c in range(n):
        total = total + load_lanes(A, at_a + (a * n + c) * 8) * load_lanes(B, at_b + (c * n + b) * 8)
    store_lanes(out, at_out + (a * n + b) * 8, total)


@njit(inline="always", **COMPILE)
def store_twice(P, square, n, a, b, value):  # type: ignore[no-untyped-def]
    """Write [a, b] and [b, a] of a symmetric matrix."""
    store_lanes(P, square + (a * n + b) * 8, value)
    store_lanes(P, square + (b * n + a) * 8, value)


@njit(inline="always", **COMPILE)
def account(found, at, log_likelihood, here, volume, there):  # type: ignore[no-untyped-def]
    """One scalar's part of the log-likelihood of eight filters; False when a variance is not positive.

    found : variances at ``at``, squares over variances eight doubles later. The product of the variances goes into
    volume, for one logarithm instead of several, as long as it is a number.
    """
    for lane in range(8):
        s, distance = found[at + lane], found[at + 8 + lane]
        if not (s > 0.0 and distance < np.inf):
            return False
        log_likelihood[here + lane] -= 0.5 * (distance + LOG_TWO_PI)
        product = volume[there + lane] * s
        if not 1e-200 < product < 1e200:
            log_likelihood[here + lane] -= 0.5 * (math.log(volume[there + lane]) + math.log(s))
            product = 1.0
        volume[there + lane] = product
    return True


@njit(**COMPILE)
def correct_group(g, n, p, came, H, r, z, x, P, scratch, log_likelihood):  # type: ignore[no-untyped-def]
    """Correct the eight filters of group g by the scalars that came; False when a variance is not positive.

    H [c, a] at ``((g p + c) n + a) 8``, r and z [c] at ``(g p + c) 8``, came (p,); adds to log_likelihood.
    Joseph's form for one scalar, in the order of Bierman: P1 = P - k v^T with v = P h, then
    P = P1 + (r k - P1 h) k^T. It costs n^2 and stays symmetric and positive under rounding.
    """
    start, square = g * n * 8, g * n * n * 8
    store_lanes(scratch, 2 * n * 8 + 16, spread_lanes(1.0))
    for c in range(p):
        if not came[c]:
            continue
        row = (g * p + c) * n * 8
        variance, innovation = load_lanes(r, (g * p + c) * 8), load_lanes(z, (g * p + c) * 8)
        for a in range(n):
            v = load_lanes(P, square + a * n * 8) * load_lanes(H, row)
            for b in range(1, n):
                v = v + load_lanes(P, square + (a * n + b) * 8) * load_lanes(H, row + b * 8)
            store_lanes(scratch, a * 8, v)
            variance = variance + load_lanes(H, row + a * 8) * v
            innovation = innovation - load_lanes(H, row + a * 8) * load_lanes(x, start + a * 8)
        inverse = spread_lanes(1.0) / variance
        weight = innovation * inverse
        store_lanes(scratch, 2 * n * 8, variance)
        store_lanes(scratch, 2 * n * 8 + 8, innovation * weight)
        if not account(scratch, 2 * n * 8, log_likelihood, g * 8, scratch, 2 * n * 8 + 16):
            return False
        for a in range(n):
            v = load_lanes(scratch, a * 8)
            store_lanes(x, start + a * 8, load_lanes(x, start + a * 8) + v * weight)
            store_lanes(scratch, (n + a) * 8, v * inverse)
        noise = load_lanes(r, (g * p + c) * 8)
        for a in range(n):
            # One row of P1 at a time: its sum with h is needed before any entry of the result.
            gain, line = load_lanes(scratch, (n + a) * 8), square + a * n * 8
            left = noise * gain
            for b in range(a + 1):
                entry = load_lanes(P, line + b * 8) - gain * load_lanes(scratch, b * 8)
                left = left - entry * load_lanes(H, row + b * 8)
                store_lanes(scratch, (2 * n + 3 + b) * 8, entry)
            for b in range(a + 1, n):
                left = left - (load_lanes(P, line + b * 8) - gain * load_lanes(scratch, b * 8)) * load_lanes(
                    H, row + b * 8
                )
            for b in range(a + 1):
                value = load_lanes(scratch, (2 * n + 3 + b) * 8) + left * load_lanes(scratch, (n + b) * 8)
                store_lanes(P, line + b * 8, value)
                store_lanes(P, square + (b * n + a) * 8, value)
    for lane in range(8):
        log_likelihood[g * 8 + lane] -= 0.5 * math.log(scratch[2 * n * 8 + 16 + lane])
    return True


@njit(**COMPILE)
def mix_group(g, n, sources, weights, x, P, mean, covariance, off):  # type: ignore[no-untyped-def]
    """Merge all sources with the weights of each of eight targets: the interaction of IMM.

    weights [source, lane] at ``(g sources + s) 8``; sources are read from x, P in the layout of lanes,
    targets are written to mean, covariance, group g. Deviations are taken from each target's own mean and
    kept in off (sources n 8), so that the inner loop holds its sums in registers.
    """
    start = g * n * 8
    for a in range(n):
        total = spread_lanes(0.0)
        for s in range(sources):
            total = total + load_lanes(weights, (g * sources + s) * 8) * spread_lanes(x[((s // 8) * n + a) * 8 + s % 8])
        store_lanes(mean, start + a * 8, total)
        for s in range(sources):
            deviation = spread_lanes(x[((s // 8) * n + a) * 8 + s % 8]) - total
            store_lanes(off, (a * sources + s) * 8, deviation)
    even = n // 2 * 2
    for a in range(0, even, 2):
        for b in range(0, a + 2, 2):
            mix_four(g, n, sources, weights, P, covariance, off, a, b)
    for b in range(n if even < n else 0):
        mix_one(g, n, sources, weights, P, covariance, off, even, b)


@njit(inline="always", **COMPILE)
def mix_four(g, n, sources, weights, P, covariance, off, a, b):  # type: ignore[no-untyped-def]
    """Entries [a, b], [a, b + 1], [a + 1, b], [a + 1, b + 1]: nine loads for four entries, and see mix_one."""
    square, up, given = g * n * n * 8, a * sources * 8, g * sources * 8
    down, one, two = up + sources * 8, b * sources * 8, (b + 1) * sources * 8
    i00, i01, i10, i11 = spread_lanes(0.0), spread_lanes(0.0), spread_lanes(0.0), spread_lanes(0.0)
    d00, d01, d10, d11 = spread_lanes(0.0), spread_lanes(0.0), spread_lanes(0.0), spread_lanes(0.0)
    for block in range(0, sources, 8):
        value = block * n * n + (a * n + b) * 8
        for lane in range(min(8, sources - block)):
            step = (block + lane) * 8
            w = load_lanes(weights, given + step)
            e0, e1 = w * load_lanes(off, up + step), w * load_lanes(off, down + step)
            f0, f1 = load_lanes(off, one + step), load_lanes(off, two + step)
            i00 = i00 + w * spread_lanes(P[value + lane])
            i01 = i01 + w * spread_lanes(P[value + 8 + lane])
            i10 = i10 + w * spread_lanes(P[value + n * 8 + lane])
            i11 = i11 + w * spread_lanes(P[value + n * 8 + 8 + lane])
            d00, d01, d10, d11 = d00 + e0 * f0, d01 + e0 * f1, d10 + e1 * f0, d11 + e1 * f1
    store_twice(covariance, square, n, a, b, i00 + d00)
    store_twice(covariance, square, n, a + 1, b, i10 + d10)
    store_twice(covariance, square, n, a + 1, b + 1, i11 + d11)
    if b < a:
        store_twice(covariance, square, n, a, b + 1, i01 + d01)


@njit(inline="always", **COMPILE)
def mix_one(g, n, sources, weights, P, covariance, off, a, b):  # type: ignore[no-untyped-def]
    """Entry [a, b] of the mixed covariance: sum of w (P + d d^T) over the sources.

    Blocks of eight sources keep divisions out of the index; two sums keep the chains short.
    """
    left, right, given = a * sources * 8, b * sources * 8, g * sources * 8
    inside, between = spread_lanes(0.0), spread_lanes(0.0)
    for block in range(0, sources, 8):
        value = block * n * n + (a * n + b) * 8
        for lane in range(min(8, sources - block)):
            step = (block + lane) * 8
            w = load_lanes(weights, given + step)
            inside = inside + w * spread_lanes(P[value + lane])
            between = between + w * load_lanes(off, left + step) * load_lanes(off, right + step)
    store_twice(covariance, g * n * n * 8, n, a, b, inside + between)


@njit(**COMPILE)
def moments(groups, n, weights, x, P, mean, covariance, scratch):  # type: ignore[no-untyped-def]
    """Mean (n,) and covariance (n, n) of all lanes with their weights (8 groups,); scratch (8,)."""
    for a in range(n):
        total = spread_lanes(0.0)
        for g in range(groups):
            total = total + load_lanes(weights, g * 8) * load_lanes(x, (g * n + a) * 8)
        store_lanes(scratch, 0, total)
        mean[a] = gathered(scratch)
    for a in range(n):
        for b in range(a + 1):
            total = spread_lanes(0.0)
            for g in range(groups):
                off = load_lanes(x, (g * n + a) * 8) - spread_lanes(mean[a])
                other = load_lanes(x, (g * n + b) * 8) - spread_lanes(mean[b])
                total = total + load_lanes(weights, g * 8) * (load_lanes(P, ((g * n + a) * n + b) * 8) + off * other)
            store_lanes(scratch, 0, total)
            covariance[a, b] = gathered(scratch)
            covariance[b, a] = covariance[a, b]


@njit(**COMPILE)
def gathered(lanes):  # type: ignore[no-untyped-def]
    """Sum of eight doubles, in pairs."""
    return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) + ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]))
