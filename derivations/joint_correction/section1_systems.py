"""Symbolic systems on which the statements of section 1 are examined, for several n and m.

The state is scrambled by an integer matrix of determinant one, so that no formula can be read
off the entries. Nothing here knows a printed formula.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import sympy as sp

from navsym.claims import Finding, Property, certify_at_sight, state
from navsym.models.linear import LinearModel
from navsym.observability.certificates import Certifier
from navsym.observability.chains import JointObservability, observe_jointly
from navsym_papers.joint_correction.matrices import exact_inverse

p = sp.Symbol("p", real=True)
g = sp.symbols("g1:10", real=True)
c = sp.symbols("c1:10", real=True)
k = sp.symbols("k1:10", real=True)


def say_ranks(
    printed: Any, finding: Finding, ranks: Iterable[tuple[LinearModel, int]], *relations: tuple[Any, ...]
) -> Property:
    """A property that follows from ranks, which the checker grants one by one, and from relations between them.

    ranks     : models with the rank that all their measurements show together
    relations : what :func:`state` takes, seen to hold at sight
    """
    parts = []
    for model, rank in ranks:
        found = observe_jointly(model)
        part = Certifier.of(model).certify_rank(found) if found.joint_dimension == rank else None
        if part is None:
            return Property(printed, finding, unsaid="a rank has no certificate")
        parts.append(part)
    parts += [certify_at_sight(state(*relation)) for relation in relations]
    meaning = [part["statement"] for part in parts]
    certificate = parts[0] if len(parts) == 1 else {"kind": "all", "of": parts}
    return Property(printed, replace(finding, certificate=certificate), tuple(meaning))


def seen_at_once(rows: sp.MatrixBase) -> LinearModel:
    """The model that stands still and shows these rows: its rank is that of the rows."""
    return LinearModel(sp.zeros(rows.cols, rows.cols), None, sp.Matrix(rows))


@dataclass(frozen=True, slots=True, eq=False)
class System:
    """A system in scrambled coordinates with its chains by definition (1.2).

    block : the matrix (m, m) that acts on what sigma_1 observes, by construction
    """

    model: LinearModel
    found: JointObservability
    block: sp.ImmutableMatrix

    @property
    def n(self) -> int:
        return self.model.size

    @property
    def m(self) -> int:
        return self.found.measurements[0].dimension

    @property
    def rest(self) -> int:
        return self.n - self.m

    @property
    def G(self) -> sp.ImmutableMatrix:
        return self.model.F

    def h(self, number: int) -> sp.ImmutableMatrix:
        return self.model.H[number - 1, :].T

    def chain(self, number: int, count: int) -> sp.ImmutableMatrix:
        """(count, n): the first vectors of chain a (1) or b (2) as rows, by (1.2) alone."""
        vectors = [self.h(number)]
        while len(vectors) < count:
            vectors.append((self.G.T * vectors[-1]).applyfunc(sp.expand))
        return sp.ImmutableMatrix(count, self.n, [x for v in vectors[:count] for x in v])


def scrambled(core: sp.Matrix, m: int, second: sp.Matrix) -> System:
    """G = T^-1 core T with ``core`` block lower triangular; h_1 sees the first block only."""
    n = core.rows
    upper = sp.Matrix(n, n, lambda r, s: int(r == s) if s <= r else (r + 2 * s) % 3 - 1)
    lower = sp.Matrix(n, n, lambda r, s: int(r == s) if s >= r else (2 * r + s) % 3 - 1)
    T = upper * lower
    first = sp.Matrix(1, n, lambda _, s: int(s == 0))
    model = LinearModel(
        exact_inverse("T", sp.ImmutableMatrix(T)) * core * T, None, sp.Matrix.vstack(first * T, second * T)
    )
    found = observe_jointly(model)
    return System(model, found, sp.ImmutableMatrix(core[:m, :m]))


@cache
def systems() -> tuple[System, ...]:
    """(n, m) = (2, 1), (3, 2), (4, 2), (5, 3) with symbols g."""
    one = sp.Matrix([[g[0], 0], [g[1], g[2]]])
    two = sp.Matrix([[0, 1, 0], [g[0], g[1], 0], [g[2], 1, g[3]]])
    three = sp.Matrix([[g[0], 1, 0, 0], [g[1], 0, 0, 0], [0, g[2], 0, 1], [1, 0, g[3], g[4]]])
    four = sp.Matrix([[0, 1, 0, 0, 0], [g[0], 0, 1, 0, 0], [1, g[1], 0, 0, 0], [g[2], 0, 0, 1, 1], [0, 1, 0, g[3], 2]])
    return (
        scrambled(one, 1, sp.Matrix([[1, 2]])),
        scrambled(two, 2, sp.Matrix([[0, 1, 1]])),
        scrambled(three, 2, sp.Matrix([[1, 0, 1, 0]])),
        scrambled(four, 3, sp.Matrix([[0, 0, 1, 1, 0]])),
    )


@cache
def direct_sum() -> System:
    """n = 3, m = 2, l = 1: neither measurement sees a state of the other, and m + l is just n."""
    core = sp.Matrix([[0, 1, 0], [g[0], g[1], 0], [0, 0, g[2]]])
    return scrambled(core, 2, sp.Matrix([[0, 0, 1]]))


@cache
def overlapping() -> System:
    """n = 4, m = 3, l = 4: the chains overlap, so that i = 2 and i = 1 are possible."""
    core = sp.Matrix([[0, 1, 0, 0], [0, 0, 1, 0], [g[0], g[1], g[2], 0], [0, 0, g[3], g[4]]])
    return scrambled(core, 3, sp.Matrix([[0, 0, 0, 1]]))


def free(name: str, size: int) -> sp.ImmutableMatrix:
    """A matrix of determinant c_1 (c_1 = 0 is excluded): full for size 2, triangular for more."""
    place = {"x": 0, "z": 3, "v": 6}[name]
    first, second, third = c[place : place + 3]
    if size == 2:
        return sp.ImmutableMatrix([[first, first * second], [third, 1 + second * third]])
    return sp.ImmutableMatrix(
        size, size, lambda r, s: (first if r == 0 else 1) if r == s else (r + 2 * s) % 3 if s > r else 0
    )


def flat(*matrices: sp.MatrixBase) -> list[sp.Expr]:
    """All entries of all matrices, one after the other."""
    return [entry for matrix in matrices for entry in matrix]


def coordinates(system: System, C1: sp.MatrixBase, C2: sp.MatrixBase) -> tuple[sp.ImmutableMatrix, sp.ImmutableMatrix]:
    """L of (1.8) and its inverse."""
    L = sp.ImmutableMatrix.vstack(C1 * system.chain(1, system.m), C2 * system.chain(2, system.rest))
    return L, exact_inverse("L", L)


def polynomial_of(matrix: sp.MatrixBase) -> sp.Expr:
    """Characteristic polynomial det(p E - matrix) in the symbol p, by Berkowitz' division-free scheme.

    Not ``Matrix.charpoly``: its variable loses the assumption of p and is then another symbol.
    """
    return sp.expand((p * sp.eye(matrix.rows) - matrix).det(method="berkowitz"))


def coefficients_of_polynomial(matrix: sp.MatrixBase) -> list[sp.Expr]:
    """Coefficients of :func:`polynomial_of`, the leading one first."""
    polynomial = polynomial_of(matrix)
    return [sp.expand(polynomial).coeff(p, power) for power in range(matrix.rows, -1, -1)]
