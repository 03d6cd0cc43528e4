"""Changes of variables that split the estimation problem by measurements.

With chains a_j of sigma_1 (dimension m) and b_j of sigma_2, a basis a_1 ... a_i, b_1 ... b_j of the
whole space gives

* i = m: the two-stage split x = L_x xi, z = L_z xi, where x does not feel z
  (joint_correction:1.5, 1.8-1.10);
* i < m: the form u, v, w, in which v = (a_{i+1} ... a_m) xi is carried along
  (joint_correction:1.14);
* any rows L_z that complete L_x: the general variant of the Remark (joint_correction:1.13).

Everything is exact for symbolic systems; C_1, C_2, C_11, C_12, C_22 are free invertible matrices. The splits
are those of two scalar measurements, for any n and any dimensions m, l of what they observe; the paper defines
none for more. For more measurements ``Observability.staircase`` gives a basis of chain vectors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from navsym.core.errors import DomainError, ShapeError
from navsym.core.rational_functions import Quotient, cancel_fraction
from navsym.observability.chains import Chain, JointObservability, chain_rows, need_observable
from navsym.observability.linear import Matrix, determinant, linear_relation
from navsym.observability.ring import Ring


@dataclass(frozen=True, slots=True)
class FeasibleSplit:
    """a_1 ... a_i, b_1 ... b_j is a basis wherever the determinant is not zero."""

    i: int
    j: int
    determinant: sp.Expr


@dataclass(frozen=True, slots=True, eq=False)
class Split:
    """The chosen basis and the companion blocks in it.

    L       : (n, n) rows a_1 ... a_i, b_1 ... b_j
    tail    : (m - i, n) rows a_{i+1} ... a_m of the vector v, without rows when i = m
    theta   : m coefficients of a_{m+1}
    link    : i + j coefficients of b_{j+1}: phi when i = m (1.10), delta when i < m (1.14)
    determinant : det L
    """

    i: int
    j: int
    L: sp.ImmutableMatrix
    tail: sp.ImmutableMatrix
    theta: tuple[sp.Expr, ...]
    link: tuple[sp.Expr, ...]
    determinant: sp.Expr

    @property
    def m(self) -> int:
        """Dimension of the first chain (joint_correction:1.5)."""
        return len(self.theta)

    @property
    def Theta(self) -> sp.ImmutableMatrix:
        """Companion matrix (m, m) of the first chain (joint_correction:1.5)."""
        return companion(self.theta)

    @property
    def Phi_x(self) -> sp.ImmutableMatrix:
        """(j, i): how x or u drives the second chain; last row only (joint_correction:1.10, 1.14)."""
        return last_row(self.j, self.link[: self.i]) if self.j else sp.ImmutableMatrix.zeros(0, self.i)

    @property
    def Phi_z(self) -> sp.ImmutableMatrix:
        """(j, j): companion matrix of the second chain (joint_correction:1.10, 1.14)."""
        return companion(self.link[self.i :])


def companion(coefficients: Sequence[sp.Expr]) -> sp.ImmutableMatrix:
    """Ones above the diagonal, the coefficients in the last row."""
    size = len(coefficients)
    return sp.ImmutableMatrix(
        size, size, lambda r, c: coefficients[c] if r == size - 1 else sp.Integer(int(c == r + 1))
    )


def last_row(rows: int, coefficients: Sequence[sp.Expr]) -> sp.ImmutableMatrix:
    """Zeros, and the coefficients in the last row."""
    return sp.ImmutableMatrix(rows, len(coefficients), lambda r, c: coefficients[c] if r == rows - 1 else sp.Integer(0))


# Which splits there are


def feasible_splits(found: JointObservability) -> tuple[FeasibleSplit, ...]:
    """All i + j = n for which a_1 ... a_i, b_1 ... b_j is a basis, from the largest i down.

    Only 0 <= i <= m and 0 <= j <= l can be feasible: a longer piece of a chain is dependent.
    Raises UnobservableError and ShapeError (not two measurements).
    """
    need_two(found)
    need_observable(found)
    n = len(found.states)
    first, second = (measurement.dimension for measurement in found.measurements)
    found_splits = []
    for i in range(min(first, n), max(0, n - second) - 1, -1):
        value = split_determinant(found, i, n - i)
        if value.top != 0:
            found_splits.append(FeasibleSplit(i, n - i, found.chains.ring.factored(value)))
    return tuple(found_splits)


def best_split(found: JointObservability) -> FeasibleSplit:
    """The split with the least max(i, j); the one with the larger i when two are equally good.

    The longest chain of derivatives that must be estimated from one measurement is then shortest.
    """
    return min(feasible_splits(found), key=lambda split: (max(split.i, split.j), -split.i))


def need_two(found: JointObservability) -> None:
    """Refuse anything but two measurements."""
    if len(found.measurements) != 2:
        raise ShapeError(
            f"expected two measurements to split by; got {len(found.measurements)}; choose two of them "
            "(splits are defined for two)"
        )


def split_determinant(found: JointObservability, i: int, j: int) -> Quotient:
    """det of the rows a_1 ... a_i, b_1 ... b_j."""
    chains = found.chains
    value = determinant(chains.staircase_vectors((i, j)), chains.ring)
    return cancel_fraction(value, chains.weight((i, j)))


def choose_split(found: JointObservability, i: int | None = None, j: int | None = None) -> Split:
    """The split with i vectors of the first and j of the second chain; by default (m, n - m).

    Raises UnobservableError, ShapeError (i + j is not n) and DomainError (not a basis: the
    message says which determinant vanishes).
    """
    need_two(found)
    need_observable(found)
    n = len(found.states)
    i = found.measurements[0].dimension if i is None else i
    j = n - i if j is None else j
    if i < 0 or j < 0 or i + j != n:
        raise ShapeError(f"split: expected i + j = {n}, the number of states; got {i} + {j}; change them")
    value = split_determinant(found, i, j)
    if value.top == 0:
        raise not_a_basis(found, i, j)
    chains = found.chains
    first, second = chains.chains
    ring = chains.ring
    rows = [chain_rows(chains.first(chain, count), chain, ring) for chain, count in ((first, i), (second, j))]
    return Split(
        i=i,
        j=j,
        L=sp.ImmutableMatrix.vstack(*rows),
        tail=chain_rows(first.vectors, first, ring)[i:, :],
        theta=found.measurements[0].companion,
        link=tuple(ring.expression(q) for q in link_coefficients(found, first, second, i, j)),
        determinant=ring.factored(value),
    )


def link_coefficients(found: JointObservability, first: Chain, second: Chain, i: int, j: int) -> list[Quotient]:
    """Coefficients of b_{j+1} in the basis a_1 ... a_i, b_1 ... b_j; none are needed when j = 0."""
    if j == 0:
        return []
    chains = found.chains
    vectors = chains.first(second, j + 1)
    basis: Matrix = [*first.vectors[:i], *vectors[:j]]
    values = linear_relation(basis, vectors[j], chains.ring)
    if values is None:
        raise ArithmeticError("split: b_{j+1} lies outside of the basis")
    return [restore_denominators(chains.ring, value, k, first, second, i, j) for k, value in enumerate(values)]


def restore_denominators(ring: Ring, value: Quotient, k: int, first: Chain, second: Chain, i: int, j: int) -> Quotient:
    """Put the denominators back that the chain vectors were freed of."""
    clock = second.clock
    top, bottom = value.top, value.bottom * clock**j
    if k < i:
        return cancel_fraction(top * first.bottom * clock**k, bottom * second.bottom)
    return cancel_fraction(top * clock ** (k - i), bottom)


def not_a_basis(found: JointObservability, i: int, j: int) -> DomainError:
    """The error for a split whose determinant vanishes, with the splits that exist."""
    rows = [f"a{k + 1}" for k in range(i)] + [f"b{k + 1}" for k in range(j)]
    feasible = ", ".join(f"{s.i},{s.j}" for s in feasible_splits(found)) or "none"
    return DomainError(
        f"split {i},{j}: expected a basis; got det({', '.join(rows)}) = 0 for all parameters; choose one of {feasible}"
    )
