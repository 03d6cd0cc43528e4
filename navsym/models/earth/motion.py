"""Polynomial motion of one coordinate, and the two ways of scaling it.

The coordinate x_1 obeys dx_1/dt = rho x_2, dx_2/dt = x_3, ..., dx_n/dt = 0: its speed is a polynomial of
degree n - 2. Everything is derived from A: powers, the transition matrix, the rows of the observability
matrix. The functions that end in ``rows`` work on exact numbers and load no symbolic engine.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from navsym.errors import DomainError

if TYPE_CHECKING:
    import sympy as sp


def dynamics(n: int, rho: Any) -> sp.Matrix:
    """A of trajectory:3, (n, n): rho at the first place above the diagonal, ones at the others."""
    import sympy as sp

    check_order(n)
    return sp.Matrix(n, n, lambda i, j: (rho if i == 0 else 1) if j == i + 1 else 0)


def first_state(n: int) -> sp.Matrix:
    """H, (1, n): the coordinate itself is measured."""
    import sympy as sp

    return sp.Matrix(1, n, lambda _, j: 1 if j == 0 else 0)


def transition(A: sp.Matrix, tau: Any) -> sp.Matrix:
    """exp(A tau) of a nilpotent A, (n, n): the series sum (A tau)^k / k! ends after n terms."""
    import sympy as sp

    n = A.rows
    total, power = sp.eye(n), sp.eye(n)
    for k in range(1, n + 1):
        power = power * A
        total += power * tau**k / sp.factorial(k)
    if power != sp.zeros(n, n):
        raise DomainError("A: expected a nilpotent matrix; got one with A^n != 0; the series does not end")
    return total


def observability(h: sp.Matrix, Phi: sp.Matrix) -> sp.Matrix:
    """Rows h, h Phi, ..., h Phi^(n-1), (n, n)."""
    import sympy as sp

    rows = [h]
    for _ in range(Phi.rows - 1):
        rows.append(rows[-1] * Phi)
    return sp.Matrix.vstack(*rows)


def column_norms(matrix: sp.Matrix) -> list[sp.Expr]:
    """Euclidean norms of the columns (symbols of the matrix are taken as declared)."""
    import sympy as sp

    return [sp.sqrt(sum(x**2 for x in matrix[:, j])) for j in range(matrix.cols)]


def row_scaling(h: sp.Matrix) -> sp.Matrix:
    """D_f = diag(h): the variables in which the row h becomes (1, ..., 1)."""
    import sympy as sp

    return sp.diag(*h)


def check_order(n: int) -> None:
    """DomainError below order one."""
    if n < 1:
        raise DomainError(f"n: expected an order of 1 or more; got {n}; choose a larger one")


# -- exact numbers ---------------------------------------------------------------------------------


def observability_rows(n: int, rho: Fraction, tau: Fraction) -> list[list[Fraction]]:
    """N_p as exact numbers: row i is h Phi^i = (1, rho i tau, ..., rho (i tau)^(n-1) / (n-1)!), i = 1..n."""
    check_order(n)
    scales = [rho * tau**j / math.factorial(j) for j in range(1, n)]
    return [[Fraction(1), *(s * i**j for j, s in enumerate(scales, 1))] for i in range(1, n + 1)]


def power_rows(n: int) -> list[list[Fraction]]:
    """N_f as exact numbers: entry i^(j-1), i, j = 1..n; the same for every rho and tau."""
    check_order(n)
    return [[Fraction(i) ** j for j in range(n)] for i in range(1, n + 1)]


def pascal_rows(n: int) -> list[list[int]]:
    """Phi_f as exact numbers: the binomial coefficient (j-1 over i-1), i, j = 1..n."""
    check_order(n)
    return [[math.comb(j, i) for j in range(n)] for i in range(n)]
