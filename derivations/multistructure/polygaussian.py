"""Equations (20)-(21): modes that never switch, and the polygaussian filter."""

from itertools import combinations

import sympy as sp

from navsym.claims import PROVED, Equation, claim, claims, fact, state
from navsym.multimodel.exact import ExactStep, Leaf, Model, run_exactly
from navsym.multimodel.schemes import scheme
from navsym_papers.multistructure import finite, pulsating
from navsym_papers.multistructure.examples import ANY_DENSITY, list_leaves, scalar
from navsym_papers.multistructure.finite import Step, step
from navsym_papers.multistructure.pulsating import say_sequences
from navsym_papers.multistructure.recursion import UNIT


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
    "20.integral | (20) with the double integral as printed, over x(k-1) and x(k). | undecidable: there are two "
    "integral signs and one differential: integrating over x(k) too leaves no function of x(k); (15) has one; by "
    "hand: without information the print is 1 for every x(k)"
)
def double_integral_printed():
    s = frozen_steps()[0]
    return Equation(s.L(0, 0) / rho(s, 0) * sum(predicted(s, 0, x) for x in s.X), finite.partial(s, 0, 0), UNIT(s))


@claim("20.integral* | (20) with one integral, for every value of x(k) [I,n = 2,2 3,2 2,3].")
def single_integral():
    cases = [(s, i, x) for s in frozen_steps() for i in s.I for x in s.X]
    return Equation(
        [s.L(i, x) / rho(s, i) * predicted(s, i, x) for s, i, x in cases],
        [finite.partial(s, x, i) for s, i, x in cases],
    )


@claim("20.rho | Below (20): rho^i is the density of Y(k) given that the mode is i throughout (two modes and states).")
def likelihood():
    s = step(2, 2, 2, entries=finite.distribution, switch=finite.frozen)
    return Equation([rho(s, i) for i in s.I], [finite.mode_likelihood(s, i) for i in s.I])


@claim("21 | (21): (10) under (19) [I,n = 2,2 3,2 2,3].")
def mode_probability():
    for s in frozen_steps():
        below = sp.expand(sum(rho(s, i) * s.modes[i] for i in s.I))
        yield [rho(s, i) * s.modes[i] / below for i in s.I], [finite.mode(s, i) for i in s.I]


MODES = [scalar(1, 0, 1, 1), scalar(sp.Rational(1, 2), 1, 1, 1), scalar(1, 4, 1, 9)]


def in_mode(i: int, modes: int, weight: sp.Rational, mean: int, variance: int) -> Leaf:
    """A Gaussian of one mode."""
    weights = tuple(weight * int(i == j) for j in range(modes))
    return Leaf(weights, [sp.Integer(mean)], [[sp.Integer(variance)]])


def without_switching(method: str, modes: list[Model], roots: list[Leaf], series: tuple[int, ...]) -> list[ExactStep]:
    """Steps of a filter with the identity for p^ij."""
    k = len(series)
    measurements = [[sp.Integer(value)] for value in series]
    return run_exactly(scheme(method), [modes] * k, [sp.eye(len(modes)).tolist()] * k, roots, measurements, ANY_DENSITY)


def polygaussian_and_exact() -> list[list[ExactStep]]:
    """Three steps of both filters from a Gaussian for each of three modes."""
    roots = [in_mode(i, 3, sp.Rational(1, 3), i, i + 1) for i in range(3)]
    return [without_switching(method, MODES, roots, (2, 1, 3)) for method in ("polygaussian", "exact")]


def living(step: ExactStep) -> list[Leaf]:
    """Hypotheses of positive weight."""
    return [leaf for leaf in step.leaves if sum(leaf.weights) != 0]


CLAIMS_21 = claims(
    "21.mixture | Below (21): the general formula (11) holds with the weights (21) and the densities (20) [I,n = "
    "2,2 3,2 2,3].",
    lambda: (
        (
            sum(s.L(i, 0) * predicted(s, i, 0) * s.modes[i] for i in s.I)
            / sp.expand(sum(rho(s, i) * s.modes[i] for i in s.I)),
            s.probability(Y=0, x=0) / s.probability(Y=0),
        )
        for s in frozen_steps()
    ),
)


@claim("19.count")
def living_sequences():
    """Under (19) only I of the I^(k+1) sequences have a positive probability, at every step (I = 3, k to 3)."""
    _, exact = polygaussian_and_exact()
    alive = tuple(len(living(step)) for step in exact)
    scope = "one model, I = 3, k = 1..3"
    meaning = [part for k in (1, 2, 3) for part in (say_sequences(3, k + 1, 3 ** (k + 1)), say_walks(3, k))]
    return fact((3, 3, 3), alive, "leaves of positive weight counted", PROVED, scope=scope, meaning=meaning)


def say_walks(modes: int, steps: int) -> dict:
    """That as many sequences as there are modes have only ones of (19) for transition probabilities."""
    ones = [1] * modes
    return state(f"[{ones}]" + f" @ eye({modes})" * steps + f" @ {[[one] for one in ones]}", "=", str(modes))


@claim("21.optimal")
def optimal():
    """Below (21): with a Gaussian for every mode the Kalman filters give the living hypotheses (I = 3, 3 steps)."""
    bank, exact = polygaussian_and_exact()
    equal = all(list(ours.leaves) == living(theirs) for ours, theirs in zip(bank, exact, strict=True))
    method = "weights (a function of the residual for each density), means and variances compared"
    sides = [[list_leaves(living(step)) for step in steps] for steps in (bank, exact)]
    meaning = [state(ours, "=", theirs) for ours, theirs in zip(*sides, strict=True)]
    return fact(True, equal, method, PROVED, scope="one model, I = 3, three steps", meaning=meaning)


def say_different(summands: int) -> dict:
    """That the Gaussians differ, each from each, in mean or variance."""
    pairs = combinations(sorted(different_gaussians(summands), key=str), 2)
    parts = [f"(({a[-2]} - ({b[-2]}))**2 + ({a[-1]} - ({b[-1]}))**2)" for a, b in pairs]
    return state("*".join(parts), "!=", "0")


def different_gaussians(summands: int) -> set[tuple[sp.Expr, ...]]:
    """Gaussians (weights, mean, variance) after one step, from a prior of several ones common to two modes."""
    weight = sp.Rational(1, 2 * summands)
    roots = [in_mode(i, 2, weight, number, 1) for number in range(summands) for i in (0, 1)]
    (step,) = without_switching("exact", MODES[:2], roots, (2,))
    return {(*leaf.weights, leaf.mean[0], leaf.covariance[0][0]) for leaf in living(step)}


CLAIMS_21_2 = claims(
    "21.prior | Below (21): one Gaussian per mode needs I filters; a sum of L common to all modes would need I L "
    "(I = 2).",
    lambda: fact(
        tuple(2 * L for L in (1, 2, 3)),
        tuple(len(different_gaussians(L)) for L in (1, 2, 3)),
        "different Gaussians of the exact tree counted",
        PROVED,
        scope="two modes, L = 1..3, one step",
        meaning=[part for L in (1, 2, 3) for part in (say_sequences(2 * L, 1, 2 * L), say_different(L))],
    ),
)
