"""Polynomial motion: structure of its matrices for many orders, exact."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import factorial, prod

import flint
import pytest
import sympy as sp

from navsym.core.errors import DomainError
from navsym.models import earth as motion
from navsym_papers.trajectory import model

rho, tau = sp.symbols("rho tau", positive=True)


@pytest.mark.parametrize("n", [1, 2, 5, 9])
def test_exact_rows_are_the_observability_matrix_of_the_model(n):
    A = model.dynamics(n, sp.Rational(1, 7))
    Phi = model.nilpotent_exponential(A, sp.Rational(2, 3))
    symbolic = model.stepped_rows(model.first_state(n) * Phi, Phi)
    exact = motion.observability_rows(n, Fraction(1, 7), Fraction(2, 3))
    assert [[Fraction(int(x.p), int(x.q)) for x in symbolic.row(i)] for i in range(n)] == exact


@pytest.mark.parametrize("n", [2, 3, 6])
def test_transitions_over_two_steps_multiply(n):
    s = sp.Symbol("s")
    A = model.dynamics(n, rho)
    product = (model.nilpotent_exponential(A, tau) * model.nilpotent_exponential(A, s)).applyfunc(sp.expand)
    assert product == model.nilpotent_exponential(A, tau + s).applyfunc(sp.expand)


@pytest.mark.parametrize("n", range(1, 31))
def test_the_determinant_of_the_first_stage_is_a_product_of_factorials(n):
    matrix = flint.fmpz_mat(n, n, [int(x) for row in motion.power_rows(n) for x in row])
    assert int(matrix.det()) == prod(factorial(k) for k in range(1, n))


@pytest.mark.parametrize("n", [3, 10, 30])
def test_rows_of_the_first_stage_follow_each_other_by_pascals_triangle(n):
    Phi, N_f = model.pascal_rows(n), motion.power_rows(n)
    for row, following in pairwise(N_f):
        assert [sum(row[i] * Phi[i][j] for i in range(n)) for j in range(n)] == following


def test_leading_blocks_are_the_matrices_of_smaller_orders():
    small, large = model.pascal_rows(6), model.pascal_rows(11)
    assert small == [row[:6] for row in large[:6]]
    assert motion.power_rows(6) == [row[:6] for row in motion.power_rows(11)[:6]]


def test_a_matrix_that_is_not_nilpotent_has_no_finite_series():
    with pytest.raises(DomainError, match="nilpotent"):
        model.nilpotent_exponential(sp.eye(2), tau)


def test_an_order_below_one_is_refused():
    with pytest.raises(DomainError, match="order of 1 or more"):
        motion.power_rows(0)
