"""The exchange search against Chebyshev polynomials and against a general LP solver."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import chebyshev
from scipy.optimize import linprog

from navsym.numeric import exchange_kernels as kernels
from navsym.numeric.exchange import Panels, find_contacts, independent, rows_at


def plain(function):
    """The same function without the compiler, where there is one."""
    return getattr(function, "py_func", function)


def power_panels(m, functional):
    """Chebyshev coefficients of T_0 … T_{m-1} themselves: an orthogonal basis of polynomials."""
    return Panels(np.eye(m)[None, :, :], functional)


@pytest.mark.parametrize("m", [2, 4, 7, 11])
def test_the_leading_chebyshev_coefficient_is_bounded_by_the_alternance(m):
    functional = np.zeros(m)
    functional[-1] = 1.0
    found = find_contacts(power_panels(m, functional))
    assert found.value == pytest.approx(1.0, rel=1e-12)
    assert np.allclose(np.sort(found.u), -np.cos(np.pi * np.arange(m) / (m - 1)), atol=1e-9)
    assert found.excess < 1e-12


def test_the_compiled_loops_and_their_plain_twins_agree():
    rng = np.random.default_rng(0)
    c = rng.standard_normal((9, 3))
    assert np.allclose(kernels.chebyshev_rows(c, 0.3), plain(kernels.chebyshev_rows)(c, 0.3), rtol=1e-14)
    assert np.allclose(kernels.chebyshev_rows(c, 0.3), chebyshev.chebval(0.3, c), rtol=1e-13)
    assert np.allclose(kernels.chebyshev_derivative(c)[:-1], chebyshev.chebder(c), rtol=1e-13)
    G, p = rng.standard_normal((40, 3)), rng.standard_normal(3)
    start = kernels.spread_rows(G)
    fast, slow = kernels.simplex(G, p, start, 500), kernels.simplex.py_func(G, p, start, 500)
    assert np.allclose(np.abs(fast[1]).sum(), np.abs(slow[1]).sum(), rtol=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_the_grid_simplex_reaches_the_optimum_of_a_general_solver(seed):
    rng = np.random.default_rng(seed)
    m, n = int(rng.integers(1, 7)), 60
    G, p = rng.standard_normal((n, m)), rng.standard_normal(m)
    _, weights, x, count = kernels.simplex(G, p, kernels.spread_rows(G), 2000)
    reference = linprog(np.ones(2 * n), A_eq=np.hstack([G.T, -G.T]), b_eq=p)
    assert count >= 0
    assert np.abs(weights).sum() == pytest.approx(reference.fun, rel=1e-7)
    assert np.abs(G @ x).max() <= 1 + 1e-9


def test_dependent_contacts_are_reduced_without_changing_the_sum_or_the_cost():
    rng = np.random.default_rng(5)
    rows = rng.standard_normal((3, 4))
    rows = np.vstack([rows, rows[0] * 0.5 + rows[1] * 0.5])
    weights = np.array([1.0, 1.0, 0.5, 2.0])
    kept, left = independent(rows, weights)
    assert np.allclose(left @ rows[kept], weights @ rows)
    assert kept.size == 3 and (left > 0).all()


def test_a_functional_with_fewer_contacts_than_unknowns_is_solved():
    m = 4
    ends = rows_at(np.eye(m)[None], np.array([0]), np.array([1.0]))[0]
    found = find_contacts(power_panels(m, ends))
    assert found.value == pytest.approx(1.0, rel=1e-10)
    assert found.u.size == 1 and found.u[0] == 1.0
