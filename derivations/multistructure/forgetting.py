"""What the paper does not ask: how wrong the probabilities (10) and (17) can be, and for how long.

Every approximation of the posterior density (a fold, a K-pulsating filter, a wrong covariance) reaches the modes
through the likelihoods alone. Say that each is known within a factor exp(+-c). Then a step errs by at most
tanh(c/2), and (10) forgets: for two modes an error of the log-odds is multiplied by at most kappa, whatever is
measured, with

    kappa = (sqrt(p11 p22) - sqrt(p12 p21)) / (sqrt(p11 p22) + sqrt(p12 p21)),

so that after any number of steps it is at most 2 c/(1 - kappa) in log-odds, and tanh(c/(2 - 2 kappa)) in probability.
(A difference of log-odds is multiplied by the derivative somewhere between; kappa is Birkhoff's coefficient.)
"""

import sympy as sp

from navsym.claims import Equation, claim, claims

x = sp.Symbol("x", positive=True)  # odds g^1 / g^2 before the step
rho1, rho2 = sp.symbols("rho1 rho2", positive=True)
#: Square roots of p^11, p^12, p^21, p^22, so that kappa needs none.
a, b, c, d = sp.symbols("a b c d", positive=True)
CHAIN = ((a**2, b**2), (c**2, d**2))  # p^ij: row to, column from
error, share = sp.Symbol("c_rho", positive=True), sp.Symbol("g_i", positive=True)


def odds_after(switch: tuple[tuple[sp.Expr, ...], ...]) -> sp.Expr:
    """Odds after one step of (10) when rho^ij depends on the mode now alone, as in (16)."""
    before = (x / (1 + x), 1 / (1 + x))
    to_first, to_second = (
        rho * sum(p * g for p, g in zip(row, before, strict=True))
        for rho, row in zip((rho1, rho2), switch, strict=True)
    )
    return sp.cancel(to_first / to_second)


def amplification(switch: tuple[tuple[sp.Expr, ...], ...]) -> sp.Expr:
    """Derivative of the log-odds after the step by the log-odds before it."""
    after = odds_after(switch)
    return sp.cancel(x * sp.diff(after, x) / after)


def kappa() -> sp.Expr:
    """The largest amplification, in square roots of the transition probabilities."""
    return (a * d - b * c) / (a * d + b * c)


CLAIMS = claims(
    # For p11 p22 >= p12 p21 the multiplier lies between 0 and kappa < 1; else the modes change places, kappa its size.
    "10.forgets | (10) with rho^i, two modes: an error of log-odds is multiplied by kappa (1 - a square over a "
    "positive number).",
    lambda: Equation(
        kappa() * (1 - (a * c * x - b * d) ** 2 / ((a**2 * x + b**2) * (c**2 * x + d**2))), amplification(CHAIN)
    ),
    "10.forgets.sharp | (10) with rho^i, two modes: at the odds sqrt(p12 p22/(p11 p21)) the multiplier is kappa: "
    "no bound is smaller.",
    lambda: Equation(kappa(), amplification(CHAIN).subs(x, b * d / (a * c))),
)


@claim("10.forgets.cases")
def the_three_chains():
    """With rho^i kappa is 0 under (14), 1 - 2 s for a symmetric chain of changes s < 1/2, and 1 under (19)."""
    first, change = sp.symbols("p s", positive=True)
    chains = [
        ((first, first), (1 - first, 1 - first)),
        ((1 - change, change), (change, 1 - change)),
        ((sp.Integer(1), sp.Integer(0)), (sp.Integer(0), sp.Integer(1))),
    ]
    # The symmetric chain is worst at even odds, the others are the same at all odds.
    derived = [amplification(chain).subs(x, 1) for chain in chains]
    box = {first: (0, 1), change: (0, sp.Rational(1, 2))}
    return Equation([sp.Integer(0), 1 - 2 * change, sp.Integer(1)], derived, box)


@claim("17.error")
def one_wrong_likelihood():
    """(17): the likelihood of i exp(c) too large, the others as much too small: g^i errs by tanh(c/2) less a square.

    For any number of modes: the others together are one, and their common likelihood is known within the same factor.
    The worst case is that of a factor exp(c) for i and exp(-c) for the others.
    """
    E = sp.exp(error)
    wrong = share * E / (share * E + (1 - share) / E)
    largest = (E - 1) / (E + 1)
    square = largest * (1 - share * (E + 1)) ** 2 / (1 + share * (E**2 - 1))
    hyperbolic = sp.sinh(error / 2) / sp.cosh(error / 2)
    return Equation([largest - square, hyperbolic], [wrong - share, largest], {share: (0, 1), error: (0, None)})


@claim("17.error.sharp")
def the_worst_probability():
    """(17): at g^i = 1/(1 + exp(c)) the error is tanh(c/2) itself, from 1/(1 + exp(c)) to exp(c)/(1 + exp(c))."""
    E = sp.exp(error)
    start = 1 / (1 + E)
    wrong = start * E / (start * E + (1 - start) / E)
    return Equation([E / (1 + E), (E - 1) / (E + 1)], [wrong, wrong - start], {error: (0, None)})


@claim("10.error.steady")
def errors_do_not_pile_up():
    """(10), rho^i, two modes, kappa to 0.99: an error of 2 c/(1 - kappa) stays; a step leaves kappa of the rest.

    A step multiplies by kappa and adds at most 2 c: what is missing to the bound is multiplied by kappa, too.
    """
    k, now = sp.symbols("kappa e", nonnegative=True)
    bound = 2 * error / (1 - k)
    after = k * now + 2 * error
    below_one = {k: (0, sp.Rational(99, 100))}
    return Equation([bound, k * (bound - now)], [after.subs(now, bound), bound - after], below_one)
