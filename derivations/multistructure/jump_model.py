"""Equations (4)-(6), (14), (19): the switching model, its Markov property, and two kinds of switching."""

from itertools import product

import sympy as sp

from navsym.claims import Equation, claim
from navsym_papers.multistructure.finite import distribution, free, frozen

TWO = (0, 1)


def chain(size, entries=distribution):
    """P[I(k-1) = j] and p^ij(k) of a chain, free: start[j], switch[j][i]."""
    return entries("s", size), [entries(f"p{j}", size) for j in range(size)]


@claim("5 | (5): p^ij is the probability of i after j, so its columns (fixed j) sum to one (chains of 2 to 4 modes).")
def transition_probabilities():
    for size in (2, 3, 4):
        start, switch = chain(size)
        both = {(i, j): start[j] * switch[j][i] for i in range(size) for j in range(size)}
        for j in range(size):
            yield 1, sum(both[i, j] for i in range(size)) / start[j]


@claim("5.prediction")
def prediction_of_modes():
    """(5): with these indices P[I(k) = i] is the sum over j of p^ij P[I(k-1) = j] (chains of 2 to 4 modes)."""
    for size in (2, 3, 4):
        start, switch = chain(size)
        both = {(i, j): start[j] * switch[j][i] for i in range(size) for j in range(size)}
        for i in range(size):
            yield (
                sp.Matrix([switch[j][i] for j in range(size)]).dot(sp.Matrix(start)),
                sum(value for (to, _), value in both.items() if to == i),
            )


def path(start, switch, step, likelihood):
    """Joint table of (x0, i0), (x1, i1, y0), (x2, i2, y1): the chain rule of (4)-(6)."""
    table = {}
    for x0, i0, x1, i1, y0, x2, i2, y1 in product(TWO, repeat=8):
        table[x0, i0, x1, i1, y0, x2, i2, y1] = (
            start[i0][x0]
            * likelihood[i0][x0][y0]
            * switch[i0][i1]
            * step[i1][x0][x1]
            * likelihood[i1][x1][y1]
            * switch[i1][i2]
            * step[i2][x1][x2]
        )
    return table


def summed(table, **fixed):
    names = ("x0", "i0", "x1", "i1", "y0", "x2", "i2", "y1")
    wanted = [(names.index(name), value) for name, value in fixed.items()]
    return sp.expand(sp.Add(*(v for key, v in table.items() if all(key[a] == b for a, b in wanted))))


@claim("6.markov | Under (6): the vector of state, mode and previous measurement is Markov (two modes, two states).")
def markov():
    table = path(
        [free(f"s{i}", 2) for i in TWO],
        [distribution(f"p{j}", 2) for j in TWO],
        [[distribution(f"f{i}{y}", 2) for y in TWO] for i in TWO],
        [[distribution(f"l{i}{x}", 2) for x in TWO] for i in TWO],
    )
    now = {"x1": 0, "i1": 0, "y0": 0}
    for x2, i2, y1 in product(TWO, repeat=3):
        after = {"x2": x2, "i2": i2, "y1": y1}
        before = {"x0": 1, "i0": 1}
        yield (
            summed(table, **after, **now) / summed(table, **now),
            summed(table, **after, **now, **before) / summed(table, **now, **before),
        )


@claim(
    "14 | (14) as printed: p^i(k) = P[I(k) = 1] for every mode i. | undecidable: P[I(k) = 1] is one number for all "
    "modes; the digit 1 stands for the letter i, and j for ij; by hand: probabilities 1/2, 1/3, 1/6 would all be 1/2"
)
def forgetful_printed():
    start, _ = chain(3)
    box = {symbol: (0, sp.Rational(1, 3)) for symbol in start[:2]}
    return Equation([start[0]] * 3, start, box)


@claim("14* | (14): when p^ij(k) does not depend on j it is P[I(k) = i] (chains of 2 to 4 modes).")
def forgetful():
    for size in (2, 3, 4):
        start, row = distribution("s", size), distribution("p", size)
        for i in range(size):
            yield row[i], sum(row[i] * start[j] for j in range(size))


@claim(
    "14.follows | Before (14): after the Gaussian approximation the mode is predicted by P[I(k) = i] (two modes). | "
    "paper: folding pi[x(k-1)] into one Gaussian forgets the state's dependence on the mode, not the mode: the mode "
    "before is still known through g^j(k-1), and P[I(k) = i] is not its prediction; by hand: a mode that never "
    "changes, g = (0.9, 0.1) after an even start: the next mode is 1 with 0.9, not 0.5"
)
def follows_printed():
    start, switch = chain(2)
    seen = free("rho", 2)
    prior = sum(start[j] * switch[j][0] for j in TWO)
    given = sum(seen[j] * start[j] * switch[j][0] for j in TWO) / sum(seen[j] * start[j] for j in TWO)
    return Equation(prior, given, {start[0]: (0, 1), switch[0][0]: (0, 1), switch[1][0]: (0, 1)})


@claim("14.follows*")
def follows():
    """Before (14): after the Gaussian approximation the sum of p^ij g^j(k-1) predicts the mode (2 to 4 modes)."""
    for size in (2, 3, 4):
        modes = range(size)
        start, switch, seen = free("s", size), [free(f"p{j}", size) for j in modes], free("rho", size)
        # Bayes' rule on the joint table of (Y(k-1), I(k-1), I(k)); the state no longer depends on I(k-1).
        joint = {(i, j): seen[j] * start[j] * switch[j][i] for i in modes for j in modes}
        evidence = sum(seen[j] * start[j] for j in modes)
        g = [seen[j] * start[j] / evidence for j in modes]
        yield (
            [sum(switch[j][i] * g[j] for j in modes) for i in modes],
            [sum(joint[i, j] for j in modes) / evidence for i in modes],
        )


@claim("19 | (19): with the identity in place of p^ij the mode never changes, over any number of steps up to six.")
def no_switching():
    start = distribution("s", 3)
    identity = sp.Matrix(3, 3, frozen)
    for steps in range(1, 7):
        reached = identity**steps * sp.Matrix(start)
        yield start, reached
