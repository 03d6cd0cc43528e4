"""Equations (12)-(13): mean and covariance of the mixture, and how to sum them in one pass.

The state is vector-valued through two of its components, xi and eta: an entry of (13) never needs more, so
two components stand for any dimension.
"""

import sympy as sp

from navsym.claims import Equation, claim, claims
from navsym_papers.multistructure import finite
from navsym_papers.multistructure.finite import Step, every_size, step
from navsym_papers.multistructure.recursion import UNIT


def values(s: Step, name: str):
    """Values of one component of the state."""
    return [sp.Symbol(f"{name}_{x}", real=True) for x in s.X]


def mean(s: Step, name: str):
    """Posterior mean of one component by Bayes' rule."""
    return sum(v * s.probability(Y=0, x=x) for x, v in enumerate(values(s, name))) / s.probability(Y=0)


def partial_mean(s: Step, name: str, i: int):
    """Posterior mean given mode i."""
    below = s.probability(Y=0, i=i)
    return sum(v * s.probability(Y=0, x=x, i=i) for x, v in enumerate(values(s, name))) / below


@claim(
    "12 | (12) as printed, summed over j. | paper: the sum runs over j while every factor carries i, as in (11); by "
    "hand: g = (3/4, 1/4), X^i = (0, 4) have the mean 1, the print has 2 g^i X^i, 0 or 2"
)
def estimate_printed():
    s = step(2, 2)
    return Equation(2 * finite.mode(s, 0) * partial_mean(s, "xi", 0), mean(s, "xi"), UNIT(s))


def mixture(size: int):
    """Weights and per-component moments: g_i, means a_i and b_i of xi and eta, covariance c_i of the two.

    The weights are shares of free positive numbers, so that they sum to one.
    """
    raw = [sp.Symbol(f"w_{i}", positive=True) for i in range(size)]
    letters = [[sp.Symbol(f"{name}_{i}", real=True) for i in range(size)] for name in "abc"]
    return [w / sum(raw) for w in raw], *letters


def covariance(size: int):
    """cov(xi, eta) of a mixture: E[xi eta] - E[xi] E[eta], by total expectation."""
    g, a, b, c = mixture(size)
    product = sum(w * (c[i] + a[i] * b[i]) for i, w in enumerate(g))
    return product - sum(w * x for w, x in zip(g, a, strict=True)) * sum(w * y for w, y in zip(g, b, strict=True))


def right_side_of_13(size: int):
    g, a, b, c = mixture(size)
    x = sum(w * v for w, v in zip(g, a, strict=True))
    y = sum(w * v for w, v in zip(g, b, strict=True))
    return [w * (c[i] + (a[i] - x) * (b[i] - y)) for i, w in enumerate(g)]


CLAIMS = claims(
    "12* | (12): the mean of the mixture is the sum over i of g^i times the partial mean [I,n = 2,2 3,2 2,3].",
    lambda: ((sum(finite.mode(s, i) * partial_mean(s, "xi", i) for i in s.I), mean(s, "xi")) for s in every_size()),
    "13 | (13), last expression as printed, summed over j (two components). | paper: the sum runs over j while "
    "every factor carries i, as in (11); by hand: g = (3/4, 1/4), X^i = (0, 4), P^i = 0 have the variance 3, the "
    "print has 1.5 or 4.5",
    lambda: Equation(2 * right_side_of_13(2)[0], covariance(2)),
    "13* | (13), last expression summed over i: covariance of a mixture of 1 to 6 components, any dimension.",
    lambda: Equation([sum(right_side_of_13(n)) for n in range(1, 7)], [covariance(n) for n in range(1, 7)]),
)


@claim("13.every | (13) for any number of components: one term, expanded, is linear in g, g a, g b and g (P + a b).")
def covariance_of_any_number():
    # Summed with sum g = 1, sum g a = X, sum g b = Y it leaves E[xi eta] - X Y, whatever the number.
    g, a, b, c, X, Y, S = sp.symbols("g a b c X Y S", real=True)
    term = g * (c + (a - X) * (b - Y))
    by_parts = g * (c + a * b) - Y * (g * a) - X * (g * b) + X * Y * g
    summed = S - Y * X - X * Y + X * Y * 1
    return Equation([term, S - X * Y], [by_parts, summed])


@claim("13.densities | (13) for posteriors of any form: finite-state densities in place of Gaussian ones [I,n = 2,2].")
def covariance_of_densities():
    for s in (step(2, 2),):
        xi, eta = values(s, "xi"), values(s, "eta")
        X, Y = mean(s, "xi"), mean(s, "eta")
        whole = s.probability(Y=0)
        second = sum(xi[x] * eta[x] * s.probability(Y=0, x=x) for x in s.X) / whole
        terms = []
        for i in s.I:
            a, b, below = partial_mean(s, "xi", i), partial_mean(s, "eta", i), s.probability(Y=0, i=i)
            both = sum(xi[x] * eta[x] * s.probability(Y=0, x=x, i=i) for x in s.X) / below
            terms.append(finite.mode(s, i) * (both - a * b + (a - X) * (b - Y)))
        yield sum(terms), second - X * Y


def expected_product(first, second, i, symbols):
    """Partial expectation of a product of two affine functions of xi and eta: (constant each, deviation one).

    first = (xi - a_i) + p, second = (eta - b_i) + q has the expectation c_i + p q.
    """
    return symbols[i] + first * second


@claim(
    "13.middle | (13), middle expression as printed: [x - X] + [X^i - X] beside [x - X^i] + [X^i - X]. | "
    "undecidable: the first bracket must be x - X^i like the second, and X(k) the estimate: as printed the spread of "
    "the partial estimates is counted twice; by hand: g = (1/2, 1/2), X^i = (-1, 1), P^i = 0 have the variance 1, "
    "the print has 2"
)
def middle_printed():
    g, a, b, c = mixture(2)
    x = sum(w * v for w, v in zip(g, a, strict=True))
    y = sum(w * v for w, v in zip(g, b, strict=True))
    # x - X = (x - X^i) + (X^i - X), so the first bracket stands 2 (X^i - X) away from the partial mean.
    printed = sum(w * expected_product(2 * (a[i] - x), b[i] - y, i, c) for i, w in enumerate(g))
    return Equation(printed, covariance(2))


@claim("13.middle* | (13), middle expression with both brackets [x - X^i] + [X^i - X] (1 to 4 components).")
def middle():
    printed = []
    for size in range(1, 5):
        g, a, b, c = mixture(size)
        x = sum(w * v for w, v in zip(g, a, strict=True))
        y = sum(w * v for w, v in zip(g, b, strict=True))
        printed.append(sum(w * expected_product(a[i] - x, b[i] - y, i, c) for i, w in enumerate(g)))
    return Equation(printed, [covariance(size) for size in range(1, 5)])


@claim("accumulate")
def accumulate():
    """Partial estimates can be added one at a time: total, mean and covariance after one more component.

    With the share s of the newcomer: mean + s d and (1 - s) C + s c + s (1 - s) d e, d and e the differences.
    """
    W, w = sp.symbols("W w", positive=True)
    X, Y, C, a, b, c = sp.symbols("X Y C a b c", real=True)
    share = w / (W + w)
    printed = [X + share * (a - X), (1 - share) * C + share * c + share * (1 - share) * (a - X) * (b - Y)]
    mean_x, mean_y = (W * X + w * a) / (W + w), (W * Y + w * b) / (W + w)
    product = (W * (C + X * Y) + w * (c + a * b)) / (W + w)
    return Equation(printed, [mean_x, product - mean_x * mean_y])


@claim("accumulate.all | 2 to 4 partial estimates added one at a time give (12) and (13).")
def accumulate_all():
    for size in (2, 3, 4):
        w = [sp.Symbol(f"w_{i}", positive=True) for i in range(size)]
        _, a, b, c = mixture(size)
        W, X, Y, C = w[0], a[0], b[0], c[0]
        for i in range(1, size):
            share = w[i] / (W + w[i])
            C = (1 - share) * C + share * c[i] + share * (1 - share) * (a[i] - X) * (b[i] - Y)
            W, X, Y = W + w[i], X + share * (a[i] - X), Y + share * (b[i] - Y)
        yield C, covariance(size)
