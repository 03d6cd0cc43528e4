"""The numerical rank of a flow: its sensitivity at many times, stacked, by singular values at 60 digits.

Nothing here is shared with navsym: series and exponentials in mpmath, polynomials as tables of exponents.
"""

from __future__ import annotations

from itertools import pairwise

import mpmath

DIGITS, ORDER = 60, 70
#: Singular values below this share of the largest are zero; observed ones of these small models are far above it.
SHARE = mpmath.mpf(10) ** -32


def numerical_rank(rows):
    """Rank of stacked rows by their singular values."""
    with mpmath.workdps(DIGITS):
        values = mpmath.svd_r(mpmath.matrix(rows), compute_uv=False)
        largest = max(values)
        return 0 if largest == 0 else sum(1 for value in values if value > SHARE * largest)


def multiply(a, b):
    """Product of power series, cut at the order."""
    result = [mpmath.mpf(0)] * ORDER
    for i, x in enumerate(a):
        if x:
            for j in range(ORDER - i):
                if b[j]:
                    result[i + j] += x * b[j]
    return result


def number(value):
    """An int or a Fraction to all digits; a real as it is."""
    return value if isinstance(value, mpmath.mpf) else mpmath.mpf(value.numerator) / value.denominator


def constant(value):
    return [number(value), *[mpmath.mpf(0)] * (ORDER - 1)]


def evaluate(table, series):
    """A polynomial {exponents: coefficient} at series."""
    total = [mpmath.mpf(0)] * ORDER
    for exponents, c in table.items():
        term = constant(c)
        for s, power in zip(series, exponents, strict=True):
            for _ in range(power):
                term = multiply(term, s)
        total = [x + y for x, y in zip(total, term, strict=True)]
    return total


def derivative(table, place):
    """Derivative of a polynomial by one variable."""
    found = {}
    for exponents, c in table.items():
        if exponents[place]:
            lower = tuple(e - (k == place) for k, e in enumerate(exponents))
            found[lower] = found.get(lower, 0) + c * exponents[place]
    return found


def flow_series(f, start):
    """x(t) of x' = f(x) as power series, one coefficient after the other."""
    series = [constant(value) for value in start]
    for k in range(ORDER - 1):
        rates = [coefficient(table, series, k) for table in f]
        for s, rate in zip(series, rates, strict=True):
            s[k + 1] = rate / (k + 1)
    return series


def coefficient(table, series, k):
    """Coefficient k of a polynomial of degree at most two at series known up to k."""
    total = mpmath.mpf(0)
    for exponents, c in table.items():
        factors = [s for s, e in zip(series, exponents, strict=True) for _ in range(e)]
        if not factors:
            total += c * (k == 0)
        elif len(factors) == 1:
            total += c * factors[0][k]
        else:
            a, b = factors
            total += c * sum(a[i] * b[k - i] for i in range(k + 1))
    return total


def rank_of_flow(f, z, start, times):
    """Rank of dz(t_i)/dx(0) for x' = f(x), all polynomials of degree at most two."""
    n = len(f)
    with mpmath.workdps(DIGITS):
        x = flow_series(f, start)
        F = [[evaluate(derivative(table, j), x) for j in range(n)] for table in f]
        H = [[evaluate(derivative(table, j), x) for j in range(n)] for table in z]
        return numerical_rank(stacked(F, H, n, times))


def rank_in_time(F, H, times):
    """Rank of H(t_i) Phi(t_i, 0) for entries that are lists of coefficients in t."""
    n = len(F)
    with mpmath.workdps(DIGITS):
        long = [[pad(entry) for entry in row] for row in F], [[pad(entry) for entry in row] for row in H]
        return numerical_rank(stacked(*long, n, times))


def pad(entry):
    return [*(number(c) for c in entry), *[mpmath.mpf(0)] * (ORDER - len(entry))]


def stacked(F, H, n, times):
    """Rows H(t) X(t) with X' = F X from the identity, at some times."""
    X = [[constant(int(i == j)) for j in range(n)] for i in range(n)]
    held = [[(k, j) for j in range(n) for k in range(ORDER) if F[i][j][k]] for i in range(n)]
    for step in range(ORDER - 1):
        for c in range(n):
            moved = [
                sum((F[i][j][k] * X[j][c][step - k] for k, j in held[i] if k <= step), mpmath.mpf(0)) for i in range(n)
            ]
            for i in range(n):
                X[i][c][step + 1] = moved[i] / (step + 1)
    rows = []
    for t in map(number, times):
        here = [[mpmath.polyval(X[i][c][::-1], t) for c in range(n)] for i in range(n)]
        for row in H:
            values = [mpmath.polyval(entry[::-1], t) for entry in row]
            rows.append([sum(a * here[i][c] for i, a in enumerate(values)) for c in range(n)])
    return rows


def rank_of_steps(Phi, H):
    """Rank of H, H Phi, H Phi^2, ... over n + 2 steps."""
    with mpmath.workdps(DIGITS):
        rows, whole = [], mpmath.eye(len(Phi))
        for _ in range(len(Phi) + 2):
            rows += (mpmath.matrix(H) * whole).tolist()
            whole = mpmath.matrix(Phi) * whole
        return numerical_rank(rows)


def rank_of_pieces(matrices, ends, H):
    """Rank of H Phi(t, 0) over constant pieces that end at the given times, by matrix exponentials."""
    n = len(H[0])
    with mpmath.workdps(DIGITS):
        whole, rows = mpmath.eye(n), []
        for F, (start, end) in zip(matrices, pairwise([0, *ends]), strict=True):
            for k in range(n + 1):
                Phi = mpmath.expm(mpmath.matrix(F) * number(end - start) * k / (n + 1)) * whole
                rows += (mpmath.matrix(H) * Phi).tolist()
            whole = mpmath.expm(mpmath.matrix(F) * number(end - start)) * whole
        return numerical_rank(rows)
