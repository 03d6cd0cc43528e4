"""Determinants of chains by values at integer points.

The vectors h, h G, ..., h G^(k-1) of a dense model have thousands of terms, and elimination multiplies them; their
determinant at a point in integers takes microseconds. Its degree in a parameter x is bounded beforehand: where G is
affine in x and x stands in r rows, or in r columns, of G, a unit lower triangular matrix turns row j > 1 of a chain
into one of degree r in x (plus that of h), so that the degree is at most r times the number of steps. With
G = G_0 + x B C, where C has r rows, h G^j = h G_0^j + x sum_i m_i C G_0^(j-1-i), and the series of the m_i is
h(z) (1 - x z Q(z))^-1: the Toeplitz matrix of the determinant of 1 - x z Q(z), of degree r in x, clears the inverse.
Values on the grid of all degrees determine the polynomial: nothing is left to chance.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence

from flint import fmpz, fmpz_mat

from navsym.methods.observability.linear import Matrix
from navsym.methods.observability.ring import Poly, Ring

#: So many points at most: about ten seconds of processor time for ten states.
POINTS = 120_000


def degree_in(entry: Poly, place: int) -> int:
    """Degree of a polynomial in one generator; 0 for the zero polynomial."""
    return int(entry.degrees()[place]) if entry != 0 else 0


def steps_of(matrix: Matrix, place: int) -> int | None:
    """r of the module's text for one generator; None where the matrix is not affine in it."""
    held = [[degree_in(entry, place) for entry in row] for row in matrix]
    if max(map(max, held)) > 1:
        return None
    return min(sum(map(any, held)), sum(map(any, zip(*held, strict=True))))


def degree_bound(starts: Sequence[tuple[list[Poly], int]], matrix: Matrix, place: int) -> int:
    """Degree in one generator that the determinant of the chains (h, number of vectors) cannot exceed."""
    first = sum(count * max(degree_in(entry, place) for entry in row) for row, count in starts)
    highest = max(degree_in(entry, place) for row in matrix for entry in row)
    plain = highest * sum(count * (count - 1) // 2 for _, count in starts)
    steps = steps_of(matrix, place)
    return first + (plain if steps is None else min(plain, steps * sum(count - 1 for _, count in starts if count)))


def points_needed(starts: Sequence[tuple[list[Poly], int]], matrix: Matrix) -> int:
    """Number of integer points at which the determinant of the chains is taken."""
    starts = [(row, count) for row, count in starts if count]
    return math.prod(degree_bound(starts, matrix, place) + 1 for place in range(generators(matrix)))


def generators(matrix: Matrix) -> int:
    """Number of generators of the ring of the entries."""
    return int(matrix[0][0].context().nvars())


def chain_determinant(starts: Sequence[tuple[list[Poly], int]], matrix: Matrix, ring: Ring) -> Poly | None:
    """Determinant of the chains (h, number of vectors), n vectors together; None when it takes too many points."""
    starts = [(row, count) for row, count in starts if count]
    bounds = [degree_bound(starts, matrix, place) for place in range(generators(matrix))]
    if math.prod(bound + 1 for bound in bounds) > POINTS:
        return None
    motion = Table(itertools.chain(*matrix))
    rows = [(Table(row), count) for row, count in starts]
    grid = itertools.product(*(range(bound + 1) for bound in bounds))
    values = [value_at(rows, motion, len(matrix), point) for point in grid]
    for bound in bounds:
        values = along_first_axis(values, bound)
    powers = itertools.product(*(range(b + 1) for b in bounds))
    return ring.context.from_dict({power: c for power, c in zip(powers, values, strict=True) if c != 0})


class Table:
    """Entries to be taken at many points: numbers are converted once."""

    def __init__(self, entries: Iterable[Poly]) -> None:
        listed = list(entries)
        self.fixed = [number(entry) for entry in listed]
        self.varying = [(place, entry) for place, entry in enumerate(listed) if entry != 0 and not entry.is_constant()]

    def at(self, point: Sequence[int]) -> list[fmpz]:
        """Values of all entries at a point."""
        values = self.fixed.copy()
        for place, entry in self.varying:
            values[place] = entry(*point)
        return values


def number(entry: Poly) -> fmpz:
    """A constant polynomial as an integer; 0 for any other, whose place is filled at every point."""
    return fmpz(int(entry.leading_coefficient())) if entry != 0 and entry.is_constant() else fmpz(0)


def value_at(starts: Sequence[tuple[Table, int]], motion: Table, n: int, point: Sequence[int]) -> fmpz:
    """The determinant at one point, in integers; chains are doubled with the squares of G."""
    powers = [fmpz_mat(n, n, motion.at(point))]
    rows: list[fmpz] = []
    for start, count in starts:
        chain = start.at(point)
        step = 0
        while len(chain) < n * count:
            if step == len(powers):
                powers.append(powers[-1] * powers[-1])
            more = fmpz_mat(len(chain) // n, n, chain) * powers[step]
            chain, step = chain + more.entries(), step + 1
        rows += chain[: n * count]
    return fmpz_mat(n, n, rows).det()


def along_first_axis(values: list[fmpz], bound: int) -> list[fmpz]:
    """From values at 0..bound to coefficients along the first axis of a grid, which becomes the last one."""
    size = bound + 1
    table = fmpz_mat(size, len(values) // size, values)
    found = (newton(bound) * table).transpose().entries()
    scale = math.factorial(bound)
    return [value // scale for value in found]


def newton(bound: int) -> fmpz_mat:
    """bound! times the inverse of the matrix of powers of 0..bound: Lagrange's polynomials, in integers."""
    columns = []
    for own in range(bound + 1):
        others = [other for other in range(bound + 1) if other != own]
        product = [1]
        for other in others:
            product = [a - other * b for a, b in zip([0, *product], [*product, 0], strict=True)]
        share = math.factorial(bound) // math.prod(own - other for other in others)
        columns.append([share * c for c in product])
    return fmpz_mat(bound + 1, bound + 1, [c for row in zip(*columns, strict=True) for c in row])
