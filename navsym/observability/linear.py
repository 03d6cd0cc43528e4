"""Fraction-free linear algebra over Z[parameters], with proofs.

``rank >= r`` is proved by one integer point: a minor that does not vanish there is not the zero
polynomial. ``rank <= r`` is proved by the relations that express every other vector. Both
together are the generic rank; no coefficient is ever tested for being "probably zero".
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from flint import nmod_mat

from navsym.core.rational_functions import Quotient, cancel_fraction
from navsym.observability.ring import Poly, Ring, gcd_all

Matrix = list[list[Poly]]

#: Arithmetic of the integer points: a minor that differs from zero modulo this prime differs from zero.
PRIME = 2305843009213693951


def integer_points(ring: Ring, count: int = 3) -> list[tuple[int, ...]]:
    """Integer points at which minors are looked at; always the same ones."""
    source = random.Random(20260101)
    size = len(ring.symbols)
    return [tuple(source.randrange(2, 1 << 40) for _ in range(size)) for _ in range(count)]


def at_point(matrix: Sequence[Sequence[Poly]], point: Sequence[int]) -> list[list[int]]:
    """Residues of the entries at an integer point."""
    return [[residue(entry, point) for entry in row] for row in matrix]


def residue(entry: Poly, point: Sequence[int]) -> int:
    """Value of a polynomial at an integer point, modulo the prime."""
    if entry == 0:
        return 0
    return int(entry(*point) if point else entry.leading_coefficient()) % PRIME


def residue_rank(rows: list[list[int]]) -> int:
    """Rank of a matrix of residues."""
    return nmod_mat(rows, PRIME).rank()


def residues_on(rows: list[list[int]], kernel: nmod_mat, count: int) -> list[list[int]]:
    """Independent vectors (k, count) that the rows make of the first columns of a kernel."""
    seen = nmod_mat(rows, PRIME) * kernel
    parts = [[int(x) for x in vector[:count]] for vector in seen.tolist()]
    return [parts[k] for k in independent_places(parts)]


def independent_places(rows: list[list[int]]) -> list[int]:
    """Places of the rows that are not combinations of earlier ones, modulo the prime."""
    columns, rank = nmod_mat([list(column) for column in zip(*rows, strict=True)], PRIME).rref()
    return [next(place for place in range(len(rows)) if columns[k, place] != 0) for k in range(rank)]


@dataclass(frozen=True, slots=True, eq=False)
class Reduced:
    """Triangular form without fractions: row k has zeros in the pivot columns of the earlier rows."""

    pivot: Poly
    rows: Matrix
    columns: tuple[int, ...]  # pivot column of each row
    sign: int  # of the row permutation


def triangular_form(matrix: Matrix, ring: Ring, columns: Sequence[int] | None = None) -> Reduced:
    """Bareiss' triangular form: row k has zeros in the pivot columns of the earlier rows.

    The pivot is the entry with the fewest terms, among equals the one whose row and column hold the fewest
    others (Markowitz): that keeps the intermediate minors small.
    """
    rows = [list(row) for row in matrix]
    free = list(range(len(rows[0]))) if columns is None and rows else list(columns or ())
    last, sign, taken = ring.constant(1), 1, []
    for step in range(len(rows)):
        place = sparsest(rows, step, free)
        if place is None:
            rows = rows[:step]
            break
        i, j = place
        if i != step:
            rows[step], rows[i], sign = rows[i], rows[step], -sign
        clear_column(rows, step, j, last)
        last = rows[step][j]
        free.remove(j)
        taken.append(j)
    return Reduced(last, rows, tuple(taken), sign)


def sparsest(rows: Matrix, step: int, columns: Sequence[int]) -> tuple[int, int] | None:
    """Place of the best pivot among the rows not yet used, None when they are zero there."""
    sizes = [[len(row[j]) for j in columns] for row in rows[step:]]
    filled = [sum(1 for size in row if size) for row in sizes]
    used = [sum(1 for size in column if size) for column in zip(*sizes, strict=True)]
    best, place = None, None
    for i, row in enumerate(sizes):
        for j, size in enumerate(row):
            if size:
                score = (size, (filled[i] - 1) * (used[j] - 1))
                if best is None or score < best:
                    best, place = score, (step + i, columns[j])
                    if score == (1, 0):
                        return place
    return place


def clear_column(rows: Matrix, step: int, column: int, last: Poly) -> None:
    """One step of Bareiss: clear the column in the rows below."""
    pivot_row = rows[step]
    pivot = pivot_row[column]
    one = last == 1
    held = [(k, y) for k, y in enumerate(pivot_row) if y != 0]
    for i in range(step + 1, len(rows)):
        row = rows[i]
        factor = row[column]
        if factor == 0:
            if pivot != last:
                rows[i] = [x if x == 0 else pivot * x if one else pivot * x / last for x in row]
            continue
        cleared = [x if x == 0 else pivot * x for x in row]
        for k, y in held:
            cleared[k] = cleared[k] - factor * y
        rows[i] = cleared if one else [x if x == 0 else x / last for x in cleared]


def determinant(matrix: Matrix, ring: Ring) -> Poly:
    """Determinant of a square matrix, by fraction-free elimination."""
    if not matrix:
        return ring.constant(1)
    reduced = triangular_form(matrix, ring)
    if len(reduced.rows) < len(matrix):
        return ring.constant(0)
    order = reduced.columns
    inversions = sum(a > b for i, a in enumerate(order) for b in order[i + 1 :])
    return reduced.pivot * reduced.sign * (-1) ** inversions


def scalar_product(row: Sequence[Poly], column: Sequence[Poly], zero: Poly) -> Poly:
    """Scalar product of polynomial vectors."""
    return sum((a * b for a, b in zip(row, column, strict=True) if a != 0 and b != 0), zero)


def transposed_times(matrix: Matrix, vector: list[Poly], ring: Ring) -> list[Poly]:
    """G^T a for sparse polynomial entries."""
    total = [ring.constant(0)] * len(vector)
    for row, factor in zip(matrix, vector, strict=True):
        if factor != 0:
            total = [t + factor * x if x != 0 else t for t, x in zip(total, row, strict=True)]
    return total


def linear_relation(vectors: Matrix, target: list[Poly], ring: Ring) -> list[Quotient] | None:
    """Coefficients c with ``target = sum c_k vectors_k`` as rational functions, or None.

    The vectors are independent. The answer is checked on every component before it leaves, so
    that it proves that the target lies in their span for all parameter values at which the
    denominators do not vanish.
    """
    if not vectors:
        return [] if all(x == 0 for x in target) else None
    stacked = [[*column, t] for column, t in zip(zip(*vectors, strict=True), target, strict=True)]
    size = len(vectors)
    found = triangular_form(stacked, ring, range(size))
    if len(found.rows) < size:
        raise ArithmeticError("relation: the vectors are dependent")
    (relation,) = null_columns(found.rows, found.columns, size + 1, ring)
    if any(scalar_product(row, relation, ring.constant(0)) != 0 for row in stacked):
        return None
    return [cancel_fraction(-value, relation[size]) for value in relation[:size]]


def null_vectors(rows: Matrix, size: int, ring: Ring, columns: Sequence[int] | None = None) -> Matrix:
    """Basis of ``{x : rows x = 0}`` with polynomial entries without a common factor.

    rows    : independent vectors of the given length; every answer is checked by multiplication
    columns : where the pivots are; anywhere by default
    """
    if not rows:
        return [[ring.constant(int(i == k)) for i in range(size)] for k in range(size)]
    found = triangular_form(rows, ring, columns)
    basis = list(null_columns(found.rows, found.columns, size, ring))
    for vector in basis:
        if any(scalar_product(row, vector, ring.constant(0)) != 0 for row in rows):
            raise ArithmeticError("null_vectors: a product does not vanish")
    return basis


def null_columns(rows: Matrix, places: Sequence[int], size: int, ring: Ring) -> Iterator[list[Poly]]:
    """For every free column the vector on which all rows vanish, without a common factor.

    rows : triangular: row k has zeros in the columns ``places`` of the earlier ones
    """
    for free in (k for k in range(size) if k not in places):
        vector = [ring.constant(0)] * size
        vector[free] = ring.constant(1)
        for row, place in zip(reversed(rows), reversed(places), strict=True):
            top = scalar_product(row, vector, ring.constant(0))
            if top != 0:
                common = top.gcd(row[place])
                vector = [entry * (row[place] / common) if entry != 0 else entry for entry in vector]
                vector[place] = -top / common
        yield primitive_vector(vector, ring)


def primitive_vector(vector: list[Poly], ring: Ring) -> list[Poly]:
    """The vector without the common factor of its entries, first nonzero entry with a positive sign."""
    common = gcd_all(vector, ring.constant(0))
    if common == 0:
        return vector
    first = next(x for x in vector if x != 0)
    sign = -1 if (first / common).leading_coefficient() < 0 else 1
    return [x / common * sign for x in vector]
