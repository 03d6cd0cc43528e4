"""Finite-state analogues: densities are tables of free symbols, integrals are sums, and Bayes' rule is exact.

One step of the switching model with I modes, n values of the state and q outcomes of the measurement. The
joint table is the chain rule of the model and nothing else; a derived side is a quotient of two sums over
that table. Quotients given the measurement that came need no sum to be one, so there every entry is a free
symbol and one outcome is enough; where a sum over outcomes enters, the last entry of every distribution is
one minus the others.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product

import sympy as sp

Table = dict[tuple[int, ...], sp.Expr]

#: (modes, states) for which the recurrences are decided, with every probability a free symbol.
SIZES = ((2, 2), (3, 2), (2, 3))


def distribution(name: str, size: int) -> list[sp.Expr]:
    """Free probabilities that sum to one."""
    free = [sp.Symbol(f"{name}_{k}", positive=True) for k in range(size - 1)]
    return [*free, 1 - sum(free, sp.Integer(0))]


@dataclass(frozen=True, slots=True)
class Step:
    """One step k-1 -> k given the measurements up to k-1, with free probabilities.

    transition[i][y][x] = f^i[x(k) = x / x(k-1) = y]     likelihood[i][x][v] = f^i[Y(k) = v / x(k) = x]
    switch[j][i] = p^ij(k) = P[I(k) = i / I(k-1) = j]
    modes[j] = g^j(k-1)                                   past[j][y] = pi^j[x(k-1) = y]
    """

    transition: list[list[list[sp.Expr]]]
    likelihood: list[list[list[sp.Expr]]]
    switch: list[list[sp.Expr]]
    modes: list[sp.Expr]
    past: list[list[sp.Expr]]
    joint: Table

    @property
    def I(self) -> range:
        return range(len(self.modes))

    @property
    def X(self) -> range:
        return range(len(self.past[0]))

    def p(self, i: int, j: int) -> sp.Expr:
        """p^ij: to i, from j."""
        return self.switch[j][i]

    def f(self, i: int, x: int, y: int) -> sp.Expr:
        """f^i[x(k) / x(k-1) = y]."""
        return self.transition[i][y][x]

    def L(self, i: int, x: int) -> sp.Expr:
        """f^i[Y(k) / x(k) = x] of the measurement that came (outcome 0)."""
        return self.likelihood[i][x][0]

    def probability(self, **fixed: int) -> sp.Expr:
        """Sum of the joint table over everything that is not fixed: Y, x, i at k; y, j at k-1."""
        names = ("Y", "x", "i", "y", "j")
        wanted = [(names.index(name), value) for name, value in fixed.items()]
        # Expanded, because sums over what must be one cancel here and cost minutes further on.
        return sp.expand(sp.Add(*(v for key, v in self.joint.items() if all(key[a] == b for a, b in wanted))))


def free(name: str, size: int) -> list[sp.Expr]:
    """Free positive numbers, proportional to probabilities."""
    return [sp.Symbol(f"{name}_{k}", positive=True) for k in range(size)]


def step(
    modes: int,
    states: int,
    outcomes: int = 1,
    *,
    switch: Callable[[int, int], sp.Expr] | None = None,
    entries: Callable[[str, int], list[sp.Expr]] = free,
) -> Step:
    """The step of given sizes; ``switch(i, j)`` prescribes p^ij, for (14) and (19)."""
    I, X = range(modes), range(states)
    T = [[entries(f"f{i}x{y}", states) for y in X] for i in I]
    L = [[entries(f"l{i}x{x}", outcomes) for x in X] for i in I]
    p = [[switch(i, j) for i in I] for j in I] if switch else [entries(f"p{j}", modes) for j in I]
    g, past = entries("g", modes), [entries(f"q{j}", states) for j in I]
    joint = {
        (Y, x, i, y, j): g[j] * past[j][y] * p[j][i] * T[i][y][x] * L[i][x][Y]
        for Y, x, i, y, j in product(range(outcomes), X, I, X, I)
    }
    return Step(T, L, p, g, past, joint)


def every_size(**options: object) -> Iterator[Step]:
    """One step of each size."""
    for modes, states in SIZES:
        yield step(modes, states, **options)  # type: ignore[arg-type]


def normalised(states: int) -> Step:
    """Two modes, two outcomes, and distributions that sum to one."""
    return step(2, states, 2, entries=distribution)


def forgetful(modes: int, entries: Callable[[str, int], list[sp.Expr]] = free) -> Callable[[int, int], sp.Expr]:
    """p^ij = p^i, whatever j: condition (14)."""
    row = entries("p", modes)
    return lambda i, j: row[i]


def frozen(i: int, j: int) -> sp.Expr:
    """p^ij = 1 for i = j, else 0: condition (19)."""
    return sp.Integer(int(i == j))


def posterior(s: Step, x: int, i: int) -> sp.Expr:
    """f[x(k), i(k) / Y_0^k] by Bayes' rule."""
    return s.probability(Y=0, x=x, i=i) / s.probability(Y=0)


def partial(s: Step, x: int, i: int) -> sp.Expr:
    """pi^i[x(k)] = f[x(k) / Y_0^k, i(k)] by Bayes' rule."""
    return s.probability(Y=0, x=x, i=i) / s.probability(Y=0, i=i)


def mode(s: Step, i: int) -> sp.Expr:
    """g^i(k) = f[i(k) / Y_0^k] by Bayes' rule."""
    return s.probability(Y=0, i=i) / s.probability(Y=0)


def pair_likelihood(s: Step, i: int, j: int) -> sp.Expr:
    """f[Y(k) / Y_0^{k-1}, i(k), j(k-1)] by the definition of a conditional probability."""
    return s.probability(Y=0, i=i, j=j) / s.probability(i=i, j=j)


def mode_likelihood(s: Step, i: int) -> sp.Expr:
    """f[Y(k) / Y_0^{k-1}, i(k)] by the definition of a conditional probability."""
    return s.probability(Y=0, i=i) / s.probability(i=i)
