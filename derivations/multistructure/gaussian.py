"""The Gaussian step: Kalman's relations for a fixed sequence of models, and the likelihood (16), (18).

A product of Gaussian densities is decided by its exponent and its normaliser, each an identity of rational
functions. Matrices are general symmetric ones of the stated sizes.
"""

import sympy as sp

from navsym.claims import Equation, claim


def symmetric(name: str, size: int) -> sp.Matrix:
    """A symmetric matrix of free symbols."""

    def entry(a: int, b: int) -> sp.Symbol:
        return sp.Symbol(f"{name}{min(a, b)}{max(a, b)}", positive=True if a == b else None, real=True)

    return sp.Matrix(size, size, entry)


def full(name: str, rows: int, columns: int) -> sp.Matrix:
    return sp.Matrix(rows, columns, lambda a, b: sp.Symbol(f"{name}{a}{b}", real=True))


def inverse(A: sp.Matrix) -> sp.Matrix:
    return A.adjugate() / A.det()


@claim("8.predict")
def prediction():
    """Between (13) and (14): A P A^T + Q is the covariance of x(k), A P that with x(k-1), for 1 and 2 states.

    The information matrix of (x(k), x(k-1)) read off the two exponents, times the covariance that Kalman's
    prediction says, is the identity.
    """
    for n in (1, 2):
        A, P, Q = full("a", n, n), symmetric("p", n), symmetric("q", n)
        Qi, Pi = inverse(Q), inverse(P)
        information = sp.Matrix(sp.BlockMatrix([[Qi, -Qi * A], [-A.T * Qi, Pi + A.T * Qi * A]]))
        moments = sp.Matrix(sp.BlockMatrix([[A * P * A.T + Q, A * P], [P * A.T, P]]))
        yield sp.eye(2 * n), information * moments


def measured(n: int, m: int):
    """Free prior, observation and noise: P, H, R, and Kalman's D, gain and corrected covariance."""
    P, H, R = symmetric("p", n), full("h", m, n), symmetric("r", m)
    D = H * P * H.T + R
    gain = P * H.T * inverse(D)
    return P, H, R, D, gain, P - gain * H * P


SHAPES = ((1, 1), (2, 1), (1, 2))


@claim("8.correct")
def correction():
    """Between (13) and (14): P - K H P inverts the sum of informations, (states, measurements) (1,1), (2,1), (1,2)."""
    for n, m in SHAPES:
        P, H, R, _, _, corrected = measured(n, m)
        yield sp.eye(n), (inverse(P) + H.T * inverse(R) * H) * corrected


@claim("8.joseph | Joseph's form (I - K H) P (I - K H)^T + K R K^T equals P - K H P at Kalman's gain.")
def joseph():
    for n, m in SHAPES:
        P, H, R, _, gain, corrected = measured(n, m)
        L = sp.eye(n) - gain * H
        yield L * P * L.T + gain * R * gain.T, corrected


@claim("8.posterior")
def posterior_exponent():
    """Between (13) and (14): the posterior of a fixed sequence of models is Gaussian with Kalman's moments.

    Likelihood times prior and the Gaussian of the corrected moments have exponents that differ by the
    exponent of (18), which does not depend on x.
    """
    for n, m in SHAPES:
        P, H, R, D, gain, corrected = measured(n, m)
        x, mean, Y = full("x", n, 1), full("m", n, 1), full("y", m, 1)
        v = Y - H * mean
        off, deviation = x - mean - gain * v, Y - H * x
        corrected_information = inverse(P) + H.T * inverse(R) * H
        product = deviation.T * inverse(R) * deviation + (x - mean).T * inverse(P) * (x - mean)
        yield (off.T * corrected_information * off + v.T * inverse(D) * v)[0], product[0]


v, D, P, R, H, Y, mean = (
    sp.Symbol("v", real=True),
    sp.Symbol("D", positive=True),
    sp.Symbol("P", positive=True),
    sp.Symbol("R", positive=True),
    sp.Symbol("H", real=True),
    sp.Symbol("Y", real=True),
    sp.Symbol("m", real=True),
)


@claim("18 | (18) for a scalar measurement of a scalar state: exponent and squared denominator of the integral.")
def likelihood():
    innovation, spread = Y - H * mean, H**2 * P + R
    # Both sides are exp(-a)/sqrt(b) with b > 0: they are equal when a and b are.
    printed = [innovation * innovation / (2 * spread), 2 * sp.pi * spread]
    # Complete the square: the exponent at its minimum c, and the width V that the integral leaves.
    V = 1 / (1 / P + H**2 / R)
    c = V * (H * Y / R + mean / P)
    least = (Y - H * c) ** 2 / R + (c - mean) ** 2 / P
    return Equation(printed, [least / 2, (2 * sp.pi * R) * (2 * sp.pi * P) / (2 * sp.pi * V)])


@claim("18.exponent | (18), exponent: the minimum over x of the two quadratic forms is v^T D^-1 v.")
def exponent():
    for n, m in SHAPES:
        prior, observe, noise, spread, gain, _ = measured(n, m)
        start, z = full("m", n, 1), full("y", m, 1)
        innovation = z - observe * start
        best = start + gain * innovation
        off = z - observe * best
        yield (
            (innovation.T * inverse(spread) * innovation)[0],
            (off.T * inverse(noise) * off + (best - start).T * inverse(prior) * (best - start))[0],
        )


@claim("18.normaliser")
def normaliser():
    """(18), denominator: |D| = |P| |R| / |P^+|, what the integral over x leaves of the three normalisers."""
    for n, m in SHAPES:
        prior, observe, noise, spread, _, _ = measured(n, m)
        information = inverse(prior) + observe.T * inverse(noise) * observe
        yield spread.det(), prior.det() * noise.det() * information.det()


d = sp.Symbol("d", positive=True)


@claim(
    "15.gaussian | Before (14): pi[x(k)] is Gaussian, so its fourth central moment is 3 P^2 (means -d and d, "
    "variances 1). | undecidable: the index i is lost: pi^i[x(k)] is Gaussian, the sum pi[x(k)] of two or more is "
    "not, as its fourth moment shows; the parameters named beside it carry i; by hand: d = 1 gives 12 against 1 + 6 "
    "+ 3 = 10"
)
def sum_is_gaussian():
    variance = 1 + d**2
    # E[(d + s)^4] of a standard normal s is d^4 + 6 d^2 + 3, the same for -d.
    return Equation(3 * variance**2, d**4 + 6 * d**2 + 3)


@claim("15.gaussian*")
def part_is_gaussian():
    """Before (14): pi^i[x(k)] is Gaussian with Kalman's X^i, P^i, by its logarithm's slope (1 state, 1 measurement)."""
    x, spread = sp.Symbol("x", real=True), H**2 * P + R
    logarithm = -((Y - H * x) ** 2 / R + (x - mean) ** 2 / P) / 2
    return Equation(-(x - mean - P * H / spread * (Y - H * mean)) / (P * R / spread), logarithm.diff(x))
