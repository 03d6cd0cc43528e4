"""Equations (7)-(11): the exact recursion for densities and mode probabilities.

Decided on finite-state analogues with (modes, states) = (2,2), (3,2), (2,3); all probabilities are free.
"""

import sympy as sp

from navsym.claims import Bound, Equation, claims
from navsym_papers.multistructure import finite
from navsym_papers.multistructure.finite import Step, every_size, step


def total(terms):
    return sp.Add(*terms)


def rho(s: Step, i: int, j: int) -> sp.Expr:
    """The double integral of (9) with the density that belongs there, pi^j[x(k-1)]."""
    return total(s.L(i, x) * s.f(i, x, y) * s.past[j][y] for x in s.X for y in s.X)


def bayes_numerator(s: Step, i: int, x: int) -> sp.Expr:
    """Numerator of (7): pi[x(k-1), j] is g^j pi^j[x(k-1)]."""
    return s.L(i, x) * total(s.f(i, x, y) * s.p(i, j) * s.modes[j] * s.past[j][y] for j in s.I for y in s.X)


def chain():
    s = finite.normalised(2)
    return Equation(
        [s.f(i, 0, 1) * s.p(i, 0) for i in s.I],
        [s.probability(x=0, i=i, y=1, j=0) / s.probability(y=1, j=0) for i in s.I],
    )


def posterior_printed():
    s = step(2, 2)
    return Equation(
        bayes_numerator(s, 0, 0)
        / total(
            s.L(i, x) * s.f(i, x, y) ** 2 * s.p(i, j) * s.modes[j] * s.past[j][y]
            for i in s.I
            for j in s.I
            for x in s.X
            for y in s.X
        ),
        finite.posterior(s, 0, 0),
        UNIT(s),
    )


def posterior_corrected():
    for s in every_size():
        whole = total(bayes_numerator(s, i, x) for i in s.I for x in s.X)
        yield [bayes_numerator(s, i, 0) / whole for i in s.I], [finite.posterior(s, 0, i) for i in s.I]


def state_posterior(s: Step, x: int) -> sp.Expr:
    """f[x(k) / Y_0^k] by Bayes' rule."""
    return s.probability(Y=0, x=x) / s.probability(Y=0)


def UNIT(s: Step):
    """Every free probability between zero and 1/4, so that the last one is a probability too."""
    symbols = sorted(set().union(*(value.free_symbols for value in s.joint.values())), key=str)
    return {symbol: (sp.Rational(1, 100), sp.Rational(1, 4)) for symbol in symbols}


def partial_definition_printed():
    s = step(2, 2)
    return Equation(s.probability(Y=0, x=0, i=0) / s.probability(Y=0), finite.partial(s, 0, 0), UNIT(s))


def right_side_of_8(s: Step, i: int, x: int) -> sp.Expr:
    above = s.L(i, x) * total(s.f(i, x, y) * total(s.p(i, j) * s.modes[j] * s.past[j][y] for j in s.I) for y in s.X)
    return above / total(rho(s, i, j) * s.p(i, j) * s.modes[j] for j in s.I)


def pair_likelihood_printed():
    s = finite.normalised(2)
    return Equation(
        [total(s.L(0, x) * s.f(0, x, y) * s.past[0][y] for x in s.X for y in s.X), finite.pair_likelihood(s, 0, 0)],
        [finite.pair_likelihood(s, 0, 1), rho(s, 0, 1)],
        UNIT(s),
    )


def pairs():
    """(step, i, j): staying and switching, two and three values of the state."""
    return [(s, 0, j) for s in map(finite.normalised, (2, 3)) for j in s.I]


def mode_definition_printed():
    s = step(2, 2)
    return Equation(
        s.probability(Y=0, i=0, j=1) / total(s.probability(Y=0, i=i, j=j) for i in s.I for j in s.I),
        finite.mode(s, 0),
        UNIT(s),
    )


def mode_definition():
    for s in every_size():
        below = total(s.probability(Y=0, i=i, j=j) for i in s.I for j in s.I)
        yield [total(s.probability(Y=0, i=i, j=j) for j in s.I) / below for i in s.I], [finite.mode(s, i) for i in s.I]


def mode_probability_by_densities():
    s = finite.normalised(2)
    weight = {(i, j): finite.pair_likelihood(s, i, j) * s.p(i, j) * s.modes[j] for i in s.I for j in s.I}
    whole = total(weight.values())
    yield [total(weight[i, j] for j in s.I) / whole for i in s.I], [finite.mode(s, i) for i in s.I]


def mode_probability():
    for s in every_size():
        weight = {(i, j): rho(s, i, j) * s.p(i, j) * s.modes[j] for i in s.I for j in s.I}
        whole = total(weight.values())
        yield [total(weight[i, j] for j in s.I) / whole for i in s.I], [finite.mode(s, i) for i in s.I]


def mixture_printed():
    s = step(2, 2)
    i = 0
    return Equation(total(finite.mode(s, i) * finite.partial(s, 0, i) for _ in s.I), state_posterior(s, 0), UNIT(s))


def form():
    # The text says "in the form (1)", which is the error equation and no density: the number (11) lost a digit.
    for s in every_size():
        weight = [total(rho(s, i, j) * s.p(i, j) * s.modes[j] for j in s.I) for i in s.I]
        whole = total(weight)
        yield total(weight[i] / whole * right_side_of_8(s, i, 0) for i in s.I), state_posterior(s, 0)


def parts_are_needed():
    # Everything but the parts is the same in both: modes 1/2 each, the state kept, and a mode that is kept.
    s = finite.normalised(2)
    half, quarter = sp.Rational(1, 2), sp.Rational(1, 4)
    # Mode 0 keeps the state and mode 1 turns it; modes stay; the measurement tells the modes apart by 3 : 1.
    known = {s.modes[0]: half, s.switch[0][0]: sp.Integer(1), s.switch[1][0]: sp.Integer(0)}
    for i in s.I:
        for y in s.X:
            known[s.transition[i][y][0]] = sp.Integer(int(y == i))
        for x in s.X:
            known[s.likelihood[i][x][0]] = 3 * quarter if i == 0 else quarter
    after = [
        state_posterior(s, 0).subs({**known, s.past[0][0]: a, s.past[1][0]: 1 - a}, simultaneous=True)
        for a in (half, 3 * quarter)
    ]
    return Bound(after[0], "!=", after[1])


CLAIMS = claims(
    "7.chain | f[x(k), i(k) / x(k-1), j(k-1)] = f^i[x(k)/x(k-1)] p^ij(k) [I,n = 2,2].",
    chain,
    "7 | (7) with the denominator as printed, the transition density f^i[x(k)/x(k-1)] standing there twice. | "
    "undecidable: the denominator prints the transition density twice; the sum of the numerator over x and i has "
    "it once, and without that the posterior does not sum to one; by hand: with f = 1/2 for both values of x the "
    "denominator is half of what it should be",
    posterior_printed,
    "7* | (7) with one transition density in the denominator is Bayes' rule for state and mode [I,n = 2,2 3,2 2,3].",
    posterior_corrected,
    "8.definition | The fraction above (8): pi^i with a denominator summed over i and j. | undecidable: the "
    "denominator sums over i as well, which gives the joint density of state and mode; given i(k) the sum runs "
    "over j alone, as (8) itself has it; by hand: two modes that fit equally well would each have half of a "
    "density",
    partial_definition_printed,
    "8.definition* | The fraction above (8) with a denominator summed over j alone [I,n = 2,2 3,2 2,3].",
    lambda: (
        (
            total(s.probability(Y=0, x=0, i=i, j=j, y=y) for j in s.I for y in s.X)
            / total(s.probability(Y=0, x=x, i=i, j=j, y=y) for x in s.X for j in s.I for y in s.X),
            finite.partial(s, 0, i),
        )
        for s in every_size()
        for i in s.I
    ),
    "8 | (8): pi^i[x(k)] from the partial densities and mode probabilities of the step before [I,n = 2,2 3,2 2,3].",
    lambda: (([right_side_of_8(s, i, 0) for i in s.I], [finite.partial(s, 0, i) for i in s.I]) for s in every_size()),
    "9 | (9) as printed: the density pi^i in the double integral, and the density of Y(k) given i(k) and i(k-1). | "
    "paper: the density of the state before must be pi^j[x(k-1)], and the condition of the last line j(k-1), as "
    "(10) has it: with i in both places the left side's j does not occur on the right; by hand: all rho^ij of one "
    "i would be equal, however different the densities before",
    pair_likelihood_printed,
    "9* | (9) with pi^j[x(k-1)] is the density of Y(k) given i(k) and j(k-1) [I,n = 2,2 2,3].",
    lambda: Equation([rho(s, i, j) for s, i, j in pairs()], [finite.pair_likelihood(s, i, j) for s, i, j in pairs()]),
    "10.definition | The fraction above (10): g^i with a numerator that is not summed over j. | undecidable: an "
    "integral sign stands where the sum over j must be: unsummed, the numerator still depends on j; by hand: two "
    "modes before with equal terms: the numerator is half of g^i",
    mode_definition_printed,
    "10.definition* | The fraction above (10) with a numerator summed over j [I,n = 2,2 3,2 2,3].",
    mode_definition,
    "10.first | (10), first line: the modes from f[Y(k) / i(k), j(k-1)], p^ij and g^j [I,n = 2,2].",
    mode_probability_by_densities,
    "10 | (10), second line: mode probabilities from rho^ij [I,n = 2,2 3,2 2,3].",
    mode_probability,
    "11 | (11) as printed, summed over j. | paper: the sum runs over j while every factor carries i: taken "
    "literally it is I g^i pi^i; the same index stands in (12) and (13); by hand: two modes of 1/2 would make pi = "
    "pi^1, without pi^2",
    mixture_printed,
    "11* | (11) summed over i: the posterior is the mixture of the partial ones [I,n = 2,2 3,2 2,3].",
    lambda: (
        (total(finite.mode(s, i) * finite.partial(s, 0, i) for i in s.I), state_posterior(s, 0)) for s in every_size()
    ),
    "11.form | Below (11): in the form (11) the recursion is closed: (8), (10), (11) give pi[x(k)] [I,n = 2,2 3,2 "
    "2,3].",
    form,
    "11.parts | Below (11): the parts are needed: two priors of one sum pi[x(k-1)] but other parts give other "
    "posteriors.",
    parts_are_needed,
)
