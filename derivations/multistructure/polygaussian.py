"""Equations (20)-(21): modes that never switch, and the polygaussian filter."""

from fractions import Fraction

import sympy as sp

from navsym.claims import PROVED, Equation, claim, fact
from navsym.multimodel.exact import Leaf, Model, run_exactly
from navsym.multimodel.schemes import scheme
from navsym_papers.multistructure import finite, pulsating
from navsym_papers.multistructure.examples import fractions_kit
from navsym_papers.multistructure.finite import Step, step
from navsym_papers.multistructure.recursion import UNIT

RUN = "a program is run and what it does is counted"


def frozen_steps():
    """Steps under (19), all sizes."""
    return [step(m, n, switch=finite.frozen) for m, n in finite.SIZES]


def predicted(s: Step, i: int, x: int) -> sp.Expr:
    """The single integral of (20)."""
    return sp.expand(sum(s.f(i, x, y) * s.past[i][y] for y in s.X))


def rho(s: Step, i: int) -> sp.Expr:
    """f[Y(k) / Y_0^{k-1}, i]: what makes (20) sum to one."""
    return pulsating.rho(s, i, predicted)


partial_densities = pulsating.product_of("20", "19", frozen_steps, predicted, ", as in (15)")


@claim(
    "20.integral",
    slip="undecidable",
    reason="there are two integral signs and one differential: integrating over x(k) too leaves no function of "
    "x(k); (15) has one; by hand: without information the print is 1 for every x(k)",
)
def double_integral_printed():
    """(20) with the double integral as printed, over x(k-1) and x(k)."""
    s = frozen_steps()[0]
    return Equation(s.L(0, 0) / rho(s, 0) * sum(predicted(s, 0, x) for x in s.X), finite.partial(s, 0, 0), UNIT(s))


@claim("20.integral*")
def single_integral():
    """(20) with one integral, for every value of x(k) [I,n = 2,2 3,2 2,3]."""
    cases = [(s, i, x) for s in frozen_steps() for i in s.I for x in s.X]
    return Equation(
        [s.L(i, x) / rho(s, i) * predicted(s, i, x) for s, i, x in cases],
        [finite.partial(s, x, i) for s, i, x in cases],
    )


@claim("20.rho")
def likelihood():
    """Below (20): rho^i is the density of Y(k) given that the mode is i throughout (two modes and states)."""
    s = step(2, 2, 2, entries=finite.distribution, switch=finite.frozen)
    return Equation([rho(s, i) for i in s.I], [finite.mode_likelihood(s, i) for i in s.I])


@claim("21")
def mode_probability():
    """(21): (10) under (19) [I,n = 2,2 3,2 2,3]."""
    for s in frozen_steps():
        below = sp.expand(sum(rho(s, i) * s.modes[i] for i in s.I))
        yield [rho(s, i) * s.modes[i] / below for i in s.I], [finite.mode(s, i) for i in s.I]


@claim("21.mixture")
def mixture():
    """Below (21): the general formula (11) holds with the weights (21) and the densities (20) [I,n = 2,2 3,2 2,3]."""
    for s in frozen_steps():
        below = sp.expand(sum(rho(s, i) * s.modes[i] for i in s.I))
        yield (
            sum(s.L(i, 0) * predicted(s, i, 0) * s.modes[i] for i in s.I) / below,
            s.probability(Y=0, x=0) / s.probability(Y=0),
        )


def polygaussian_and_exact(steps: int):
    """Mode probabilities, mean and variance of both filters, with the identity for p^ij and a Gaussian per mode."""
    models = [[Model([[F]], [[Q]], [[Fraction(1)]], [[R]]) for F, Q, R in MODES]] * steps
    identity = [[[Fraction(int(i == j)) for j in range(len(MODES))] for i in range(len(MODES))]] * steps
    third = Fraction(1, len(MODES))
    roots = [
        Leaf(tuple(third if i == j else Fraction(0) for j in range(len(MODES))), [Fraction(i)], [[Fraction(i + 1)]])
        for i in range(len(MODES))
    ]
    series = [[Fraction(value)] for value in (2, -1, 3)][:steps]
    return [
        run_exactly(scheme(method), models, identity, roots, series, fractions_kit())
        for method in ("polygaussian", "exact")
    ]


MODES = [
    (Fraction(1), Fraction(0), Fraction(1)),
    (Fraction(1, 2), Fraction(1), Fraction(1)),
    (Fraction(1), Fraction(4), Fraction(9)),
]


@claim("19.count")
def living_sequences():
    """Under (19) only I of the I^(k+1) sequences have a positive probability, at every step (I = 3, k to 3)."""
    _, exact = polygaussian_and_exact(3)
    alive = tuple(sum(1 for leaf in step.leaves if sum(leaf.weights) > 0) for step in exact)
    return fact(
        (3, 3, 3), alive, "leaves of positive weight counted", PROVED, scope="one model, I = 3, k = 1..3", unsaid=RUN
    )


@claim("21.optimal")
def optimal():
    """Below (21): with a Gaussian for every mode the bank of Kalman filters gives exactly the living hypotheses."""
    bank, exact = polygaussian_and_exact(3)
    equal = True
    for ours, theirs in zip(bank, exact, strict=True):
        living = [leaf for leaf in theirs.leaves if sum(leaf.weights) > 0]
        equal = equal and sorted(map(gaussian, ours.leaves)) == sorted(map(gaussian, living))
    method = "Gaussians of both compared as rationals"
    return fact(True, equal, method, PROVED, scope="one model, I = 3, three steps", unsaid=RUN)


def gaussian(leaf: Leaf):
    """Mode, mean and variance of a leaf."""
    return [weight != 0 for weight in leaf.weights].index(True), leaf.mean[0], leaf.covariance[0][0]


prior = claim(
    "21.prior",
    "Below (21): one Gaussian per mode needs I filters; a sum of L common to all modes would need I L (I = 2).",
    lambda: fact(
        tuple(2 * L for L in (1, 2, 3)),
        tuple(len(different_gaussians(L)) for L in (1, 2, 3)),
        "different Gaussians of the exact tree counted",
        PROVED,
        scope="two modes, L = 1..3, one step",
        unsaid=RUN,
    ),
)


def different_gaussians(summands: int):
    """Gaussians after one step without switching, from a prior of several Gaussians common to two modes."""
    share = Fraction(1, 2 * summands)
    roots = [
        Leaf(tuple(share if i == j else Fraction(0) for j in (0, 1)), [Fraction(number)], [[Fraction(1)]])
        for number in range(summands)
        for i in (0, 1)
    ]
    models = [[Model([[F]], [[Q]], [[Fraction(1)]], [[R]]) for F, Q, R in MODES[:2]]]
    identity = [[[Fraction(1), Fraction(0)], [Fraction(0), Fraction(1)]]]
    (step,) = run_exactly(scheme("exact"), models, identity, roots, [[Fraction(2)]], fractions_kit())
    return {gaussian(leaf) for leaf in step.leaves if sum(leaf.weights) > 0}
