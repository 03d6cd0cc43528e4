"""Polynomial motion of one coordinate in symbols: everything is derived from its matrix A."""

import math
from typing import Any

import sympy as sp

from navsym.core.errors import DomainError
from navsym.models.earth import need_order


def dynamics(n: int, rho: Any) -> sp.Matrix:
    """A of trajectory:3, (n, n): rho at the first place above the diagonal, ones at the others."""
    need_order(n)
    return sp.Matrix(n, n, lambda i, j: (rho if i == 0 else 1) if j == i + 1 else 0)


def first_state(n: int) -> sp.Matrix:
    """H, (1, n): the coordinate itself is measured."""
    return sp.Matrix(1, n, lambda _, j: 1 if j == 0 else 0)


def nilpotent_exponential(A: sp.Matrix, tau: Any) -> sp.Matrix:
    """exp(A tau) of a nilpotent A, (n, n): the series sum (A tau)^k / k! ends after n terms."""
    n = A.rows
    total, power = sp.eye(n), sp.eye(n)
    for k in range(1, n + 1):
        power = power * A
        total += power * tau**k / sp.factorial(k)
    if power != sp.zeros(n, n):
        raise DomainError("A: expected a nilpotent matrix; got one with A^n != 0; the series does not end")
    return total


def stepped_rows(h: sp.Matrix, Phi: sp.Matrix) -> sp.Matrix:
    """Rows h, h Phi, ..., h Phi^(n-1), (n, n)."""
    rows = [h]
    for _ in range(Phi.rows - 1):
        rows.append(rows[-1] * Phi)
    return sp.Matrix.vstack(*rows)


def norms_of_columns(matrix: sp.Matrix) -> list[sp.Expr]:
    """Euclidean norms of the columns (symbols of the matrix are taken as declared)."""
    return [sp.sqrt(sum(x**2 for x in matrix[:, j])) for j in range(matrix.cols)]


def row_scaling(h: sp.Matrix) -> sp.Matrix:
    """D_f = diag(h): the variables in which the row h becomes (1, ..., 1)."""
    return sp.diag(*h)


def pascal_rows(n: int) -> list[list[int]]:
    """Phi_f as exact numbers: the binomial coefficient (j-1 over i-1), i, j = 1..n."""
    need_order(n)
    return [[math.comb(j, i) for j in range(n)] for i in range(n)]
