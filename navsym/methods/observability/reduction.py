"""Small matrices with the same rank: what is regular for all parameters is taken out first.

Observable functionals are rows over Z[parameters]. A row with an entry that is a number different from zero is
independent everywhere: it clears its column from all other rows and from all later vectors of the chains, which
keeps their degrees low. What remains has few rows and columns, and its rank drops where the whole rank does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import gcd

from navsym.methods.observability.linear import Matrix, at_point, independent_rows, points, transposed_times
from navsym.methods.observability.ring import Poly, Ring


@dataclass(frozen=True, slots=True, eq=False)
class Remainder:
    """rank of the whole = regular + rank(rows) for every value of the parameters."""

    regular: int
    rows: Matrix


def is_number(entry: Poly) -> bool:
    """A constant polynomial that is not zero."""
    return entry != 0 and entry.is_constant()


class UnitBasis:
    """Rows with a number as pivot; every column of a pivot is zero in all other rows of the basis."""

    def __init__(self) -> None:
        self.rows: list[list[Poly]] = []
        self.columns: list[int] = []

    def reduced(self, row: list[Poly]) -> list[Poly]:
        """The row without its parts along the basis, times a number."""
        for own, column in zip(self.rows, self.columns, strict=True):
            if (factor := row[column]) != 0:
                row = [p * own[column] - factor * q for p, q in zip(row, own, strict=True)]
        return lowered(row)

    def take(self, row: list[Poly]) -> bool:
        """Add a reduced row that has a number among its entries; False when it has none."""
        column = next((k for k, entry in enumerate(row) if is_number(entry)), None)
        if column is None:
            return False
        pivot = row[column]
        for place, own in enumerate(self.rows):
            if (factor := own[column]) != 0:
                cleared = [p * pivot - factor * q for p, q in zip(own, row, strict=True)]
                self.rows[place] = lowered(cleared)
        self.rows.append(row)
        self.columns.append(column)
        return True


def lowered(row: list[Poly]) -> list[Poly]:
    """The row without a common numerical factor."""
    contents = [int(abs(entry.content())) for entry in row if entry != 0]  # type: ignore[attr-defined]
    if not contents or min(contents) == 1:
        return row
    common = gcd(*contents)
    return row if common == 1 else [entry / common if entry != 0 else entry for entry in row]


def remainder(rows: Sequence[list[Poly]]) -> Remainder:
    """Take out everything regular from some rows."""
    basis = UnitBasis()
    waiting, passed = list(rows), True
    while passed:
        passed = False
        rest = []
        for row in sorted(waiting, key=weight):
            row = basis.reduced(row)
            if basis.take(row):
                passed = True
            elif any(entry != 0 for entry in row):
                rest.append(row)
        waiting = rest
    return without_columns(basis, waiting)


def without_columns(basis: UnitBasis, rows: Sequence[list[Poly]]) -> Remainder:
    """Rows reduced by the basis, on the columns that it leaves free; no zeros, no repetitions."""
    width = len(rows[0]) if rows else 0
    free = [k for k in range(width) if k not in basis.columns]
    kept: dict[str, list[Poly]] = {}
    for row in rows:
        short = [basis.reduced(row)[k] for k in free]
        if any(entry != 0 for entry in short):
            kept.setdefault(str(short), short)
    return Remainder(len(basis.rows), list(kept.values()))


def weight(row: list[Poly]) -> int:
    """How much there is to multiply."""
    return sum(len(entry) for entry in row)


def krylov_remainder(starts: Sequence[tuple[list[Poly], int]], matrix: Matrix, ring: Ring) -> Remainder:
    """Regular part and remainder of the chains h, G^T h, ...: (h, number of vectors) for each of them."""
    basis, rest = krylov_basis(starts, matrix, ring)
    inner = remainder(without_columns(basis, rest).rows)
    return Remainder(len(basis.rows) + inner.regular, inner.rows)


def krylov_rows(starts: Sequence[tuple[list[Poly], int]], matrix: Matrix, rank: int, ring: Ring) -> Matrix:
    """``rank`` generically independent rows that span what the chains span."""
    basis, rest = krylov_basis(starts, matrix, ring)
    rows = [basis.reduced(row) for row in sorted(rest, key=weight)]
    point = points(ring)
    chosen = max((independent_rows(at_point([*basis.rows, *rows], p)) for p in point), key=len)
    listed = [*basis.rows, *rows]
    return [listed[k] for k in chosen[:rank]]


def krylov_basis(starts: Sequence[tuple[list[Poly], int]], matrix: Matrix, ring: Ring) -> tuple[UnitBasis, Matrix]:
    """Regular rows of the chains and all others, which span together what the chains span at every point.

    Every vector is reduced before it is multiplied on: modulo the basis, which is multiplied on as well,
    nothing is lost, and degrees stay low.
    """
    basis = UnitBasis()
    step = [(list(row), count) for row, count in starts]
    rest: Matrix = []
    while step:
        following = []
        for row, count in step:
            row = basis.reduced(row)
            if all(entry == 0 for entry in row):
                continue
            if not basis.take(row):
                rest.append(row)
            if count > 1:
                following.append((transposed_times(matrix, row, ring), count - 1))
        step = following
    return basis, rest
