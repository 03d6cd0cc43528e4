"""The relation that ends a chain, from the characteristic polynomial.

a_{m+1} = theta_1 a_1 + ... + theta_m a_m says that p^m - theta_m p^(m-1) - ... annihilates the chain. It divides
the characteristic polynomial of the matrix, which is monic with coefficients in Z[parameters]; by Gauss' lemma so
are its monic factors. For m = n it is the characteristic polynomial itself (Cayley and Hamilton); for m < n the
factor is picked at an integer point and then checked on every component.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

from flint import nmod_mat

from navsym.methods.observability.linear import PRIME, Matrix, at_point, residue
from navsym.methods.observability.ring import Poly, Ring

#: So many combinations of factors are tried.
CHOICES = 4096
#: A characteristic polynomial with more terms is not factored.
TERMS = 4000


def characteristic(matrix: Matrix, ring: Ring) -> list[Poly]:
    """Coefficients of det(pE - matrix), the leading 1 first, without divisions (Samuelson and Berkowitz)."""
    zero, one = ring.constant(0), ring.constant(1)
    found = [one]
    for size in range(len(matrix)):
        column = [matrix[r][size] for r in range(size)]
        toeplitz = [one, -matrix[size][size]]
        for _ in range(size):
            toeplitz.append(-dot(matrix[size][:size], column, zero))
            column = [dot(matrix[r][:size], column, zero) for r in range(size)]
        found = [
            sum((toeplitz[i - j] * found[j] for j in range(max(0, i - size - 1), min(i, size) + 1)), zero)
            for i in range(size + 2)
        ]
    return found


def dot(row: Sequence[Poly], column: Sequence[Poly], zero: Poly) -> Poly:
    """Scalar product of polynomial vectors."""
    return sum((a * b for a, b in zip(row, column, strict=True) if a != 0 and b != 0), zero)


def chain_relation(vectors: Matrix, m: int, matrix: Matrix, ring: Ring, point: Sequence[int]) -> list[Poly] | None:
    """theta_1 ... theta_m of a chain whose first m vectors are independent; None when it was not found.

    vectors : a_1 ... a_{m+1};  point : integers at which a_1 ... a_m are independent modulo the prime
    """
    whole = characteristic(matrix, ring)
    if m == len(matrix):
        return [-c for c in whole[:0:-1]]
    if sum(map(len, whole)) > TERMS:
        return None
    wanted = residue_relation(vectors, m, point)
    for factor in monic_factors(whole, m, ring):
        theta = [-c for c in factor[:0:-1]]
        if [residue(t, point) for t in theta] == wanted and annihilates(theta, vectors, ring):
            return theta
    return None


def residue_relation(vectors: Matrix, m: int, point: Sequence[int]) -> list[int] | None:
    """theta modulo the prime at the point; None when the point is unlucky."""
    rows = at_point(vectors, point)
    width = len(rows[0])
    augmented = nmod_mat(width, m + 1, [rows[r][c] for c in range(width) for r in range(m + 1)], PRIME)
    reduced, rank = augmented.rref()
    if rank != m:
        return None
    return [int(reduced[k, m]) for k in range(m)]


def annihilates(theta: Sequence[Poly], vectors: Matrix, ring: Ring) -> bool:
    """Whether a_{m+1} = sum theta_j a_j, component by component."""
    zero = ring.constant(0)
    size = len(theta)
    return all(
        dot(theta, [vectors[j][k] for j in range(size)], zero) == vectors[size][k] for k in range(len(vectors[0]))
    )


def monic_factors(coefficients: Sequence[Poly], degree: int, ring: Ring) -> list[list[Poly]]:
    """Monic divisors of the given degree of a monic polynomial in p, each as coefficients, the 1 first."""
    wider, p = with_variable(ring)
    total: Poly = sum(
        (
            wider.from_dict({(*powers, place): int(c) for powers, c in coefficient.to_dict().items()})
            for place, coefficient in enumerate(reversed(coefficients))
        ),
        wider.constant(0),
    )
    parts = [(by_power(f, p, ring), int(power)) for f, power in total.factor()[1]]
    found = []
    for count, powers in enumerate(product(*(range(power + 1) for _, power in parts))):
        if count > CHOICES:
            break
        if sum(k * (len(f) - 1) for k, (f, _) in zip(powers, parts, strict=True)) == degree:
            value = [ring.constant(1)]
            for k, (f, _) in zip(powers, parts, strict=True):
                for _ in range(k):
                    value = multiplied(value, f, ring)
            found.append(value)
    return found


def with_variable(ring: Ring) -> tuple[Any, int]:
    """The ring with one generator more, and the place of that generator."""
    import sympy as sp

    wider = Ring.over([*ring.symbols, sp.Dummy("p")])
    return wider.context, len(ring.symbols)


def by_power(f: Poly, place: int, ring: Ring) -> list[Poly]:
    """Coefficients of a monic polynomial by the powers of one generator, the leading 1 first."""
    degree = int(f.degrees()[place])
    parts: list[dict[tuple[int, ...], int]] = [{} for _ in range(degree + 1)]
    for powers, c in f.to_dict().items():
        parts[degree - int(powers[place])][tuple(map(int, powers[:place]))] = int(c)
    found = [ring.context.from_dict(part) for part in parts]
    return [-c for c in found] if found[0] == -1 else found


def multiplied(left: Sequence[Poly], right: Sequence[Poly], ring: Ring) -> list[Poly]:
    """Product of two polynomials given by coefficients."""
    result = [ring.constant(0)] * (len(left) + len(right) - 1)
    for i, a in enumerate(left):
        for j, b in enumerate(right):
            result[i + j] += a * b
    return result
