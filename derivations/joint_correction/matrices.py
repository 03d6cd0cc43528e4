"""Matrices of section 1: inverses of rational functions, unit rows, the shift and the corner of (1.14)."""

import sympy as sp

from navsym.core.errors import DomainError
from navsym.core.rational_functions import clear_denominators
from navsym.language.expression import to_text
from navsym.observability.linear import determinant, linear_relation
from navsym.observability.ring import Ring
from navsym.observability.splits import companion


def shift(size: int) -> sp.ImmutableMatrix:
    """F of (1.14): ones above the diagonal and nothing else."""
    return companion([sp.Integer(0)] * size)


def corner(rows: int, columns: int) -> sp.ImmutableMatrix:
    """F° of (1.14): a single one at the lower left."""
    return sp.ImmutableMatrix(rows, columns, lambda r, c: int(r == rows - 1 and c == 0))


def exact_inverse(name: str, matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """Exact inverse of a matrix of rational functions; DomainError when the determinant vanishes."""
    size = matrix.rows
    ring = Ring.of(matrix)
    columns = [[ring.quotient(matrix[r, c]) for r in range(size)] for c in range(size)]
    vectors, bottom = clear_denominators(columns, ring.constant(1))
    if determinant(vectors, ring) == 0:
        raise DomainError(f"{name}: expected an invertible matrix; got determinant 0 for all parameters; change it")
    result = sp.zeros(size, size)
    for c in range(size):
        target = [bottom if r == c else ring.constant(0) for r in range(size)]
        for r, value in enumerate(linear_relation(vectors, target, ring) or []):
            result[r, c] = ring.expression(value)
    return sp.ImmutableMatrix(result)


def unit_row(size: int) -> sp.ImmutableMatrix:
    """(1 0 ... 0)."""
    return sp.ImmutableMatrix(1, size, lambda _, c: int(c == 0))


def to_lowest_terms(matrix: sp.MatrixBase) -> sp.ImmutableMatrix:
    """Entries as quotients of polynomials in lowest terms."""
    ring = Ring.of(matrix)
    return sp.ImmutableMatrix(*matrix.shape, [ring.expression(ring.quotient(x)) for x in matrix])


def write_matrix(matrix: sp.MatrixBase) -> str:
    """A matrix in the language of statements."""
    return "[" + ", ".join(f"[{', '.join(map(to_text, row))}]" for row in matrix.tolist()) + "]"
