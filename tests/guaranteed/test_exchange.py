"""The exchange search against Chebyshev polynomials and against a general LP solver."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from numpy.polynomial import chebyshev
from scipy.optimize import linprog

from navsym.core import loops, simplex
from navsym.core.loops import compile_loop
from navsym.guaranteed.certificate.basis import make_basis
from navsym.guaranteed.certificate.enclosure import Panel, PanelProblem
from navsym.guaranteed.search import kernels
from navsym.guaranteed.search.alternance import chebyshev_values, local_maxima
from navsym.guaranteed.search.exchange import (
    Panels,
    chebyshev_nodes,
    contact_candidates,
    degenerate_contacts,
    drop_dependent_contacts,
    find_contacts,
    regressor_rows,
)
from tests.benchmarks.twofold import exact_panels, sharp_panels, two_product, two_sum


def power_panels(m, functional):
    """Chebyshev coefficients of T_0 … T_{m-1} themselves: an orthogonal basis of polynomials."""
    return Panels(np.eye(m)[None, :, :], functional)


@pytest.mark.parametrize("m", [2, 4, 7, 11])
def test_the_leading_chebyshev_coefficient_is_bounded_by_the_alternance(m):
    functional = np.zeros(m)
    functional[-1] = 1.0
    panels = power_panels(m, functional)
    found = find_contacts(panels)
    assert exact_panels(panels).value(found) == pytest.approx(1.0, rel=1e-12)
    assert np.allclose(np.sort(found.u), -np.cos(np.pi * np.arange(m) / (m - 1)), atol=1e-9)
    assert found.excess < 1e-12


@pytest.mark.long
def test_the_compiled_loops_give_the_bits_of_the_interpreted_ones():
    rng = np.random.default_rng(0)
    G, p = rng.standard_normal((40, 3)), rng.standard_normal(3)
    start = simplex.independent_rows(G, 3)
    pairs = [(simplex.simplex, (G, p, start, 500)), (local_maxima, (rng.standard_normal((2, 9)), chebyshev_nodes(101)))]
    for loop, arguments in pairs:
        fast, slow = compile_loop(loop.py_func)(*arguments), loop.py_func(*arguments)
        for a, b in zip(fast, slow, strict=True):
            assert np.array_equal(a, b)


def test_chebyshev_sums_agree_with_those_of_numpy():
    c = np.random.default_rng(0).standard_normal((9, 3))
    assert np.allclose(kernels.chebyshev_rows(c, 0.3), chebyshev.chebval(0.3, c), rtol=1e-13)
    assert np.allclose(kernels.chebyshev_derivative(c)[:-1], chebyshev.chebder(c), rtol=1e-13)
    assert np.allclose(
        chebyshev_values(c[:, 0], np.array([0.3, -1.0])), chebyshev.chebval([0.3, -1.0], c[:, 0]), rtol=1e-13
    )


def test_a_loop_is_interpreted_until_that_has_cost_as_much_as_compiling(monkeypatch):
    monkeypatch.setattr(loops, "compile_loop", lambda function: lambda *given: "compiled")
    loop = loops.kernel(lambda x: x)
    monkeypatch.setattr(loops.Meter, "spent", 0.0)
    assert loop(1) == 1
    monkeypatch.setattr(loops.Meter, "spent", loops.TO_COMPILE + 1.0)
    assert loop(1) == "compiled"


def test_inverses_of_small_matrices_are_those_of_numpy():
    B = np.random.default_rng(3).standard_normal((7, 7))
    X, regular = simplex.invert_matrix(B)
    assert regular and np.allclose(X, np.linalg.inv(B), rtol=1e-10)
    assert not simplex.invert_matrix(np.ones((3, 3)))[1]


@pytest.mark.parametrize("seed", range(12))
def test_the_grid_simplex_reaches_the_optimum_of_a_general_solver(seed):
    rng = np.random.default_rng(seed)
    m, n = int(rng.integers(1, 7)), 60
    G, p = rng.standard_normal((n, m)), rng.standard_normal(m)
    _, weights, x, count = simplex.simplex(G, p, simplex.independent_rows(G, m), 2000)
    reference = linprog(np.ones(2 * n), A_eq=np.hstack([G.T, -G.T]), b_eq=p)
    assert count >= 0
    assert np.abs(weights).sum() == pytest.approx(reference.fun, rel=1e-7)
    assert np.abs(G @ x).max() <= 1 + 1e-9


def test_dependent_contacts_are_reduced_without_changing_the_sum_or_the_cost():
    rng = np.random.default_rng(5)
    rows = rng.standard_normal((3, 4))
    rows = np.vstack([rows, rows[0] * 0.5 + rows[1] * 0.5])
    weights = np.array([1.0, 1.0, 0.5, 2.0])
    kept, left = drop_dependent_contacts(rows, weights)
    assert np.allclose(left @ rows[kept], weights @ rows)
    assert kept.size == 3 and (left > 0).all()


def test_a_functional_with_fewer_contacts_than_unknowns_is_solved():
    m = 4
    ends = regressor_rows(np.eye(m)[None], np.array([0]), np.array([1.0]))[0]
    panels = power_panels(m, ends)
    found = find_contacts(panels)
    assert exact_panels(panels).value(found) == pytest.approx(1.0, rel=1e-10)
    assert found.u.size == 1 and found.u[0] == 1.0


@pytest.mark.parametrize("k", [0, 3, 7])
def test_the_value_in_twofold_precision_is_that_of_the_chebyshev_polynomial_to_the_last_bits(k):
    t = sp.Symbol("t", real=True)
    panel = Panel(0, tuple(t**j for j in range(8)), t, sp.Integer(0), sp.Integer(1), sp.Integer(1))
    problem = PanelProblem((panel,), tuple(sp.Integer(int(j == k)) for j in range(8)))
    basis = make_basis(problem)
    sharp = sharp_panels(basis, problem)
    shifted = sp.Poly(sp.chebyshevt(7, 2 * t - 1), t).coeff_monomial(t**k)
    assert sharp.value(find_contacts(sharp.panels)) * basis.scale == pytest.approx(abs(int(shifted)), rel=1e-15)


def test_products_and_sums_of_two_doubles_lose_nothing():
    rng = np.random.default_rng(4)
    for a, b in rng.standard_normal((50, 2)) * 10.0 ** rng.integers(-8, 8, (50, 2)):
        product, rest = two_product(a, b)
        assert Fraction(product) + Fraction(rest) == Fraction(a) * Fraction(b)
        total, rest = two_sum(a, b)
        assert Fraction(total) + Fraction(rest) == Fraction(a) + Fraction(b)


@pytest.mark.parametrize("K", [1, 2, 3, 9, 30])
def test_the_matrix_of_the_derivative_does_what_the_loop_does(K):
    c = np.random.default_rng(K).standard_normal((K, 4))
    assert np.allclose(kernels.differentiation(K) @ c, kernels.chebyshev_derivative(c), rtol=1e-13, atol=1e-11)


def test_a_contact_whose_weight_is_nothing_is_a_touch_and_no_contact():
    """The value at 1 of functions one of which is 1e-9 of another: three contacts had weights of 1e-15, of any sign."""
    s = sp.Symbol("t", real=True)
    functions = (
        sp.exp(-s) / 10**9,
        sp.cos(8 * s / 3),
        sp.tanh(3 * s - 3),
        s**2 * sp.exp(-6 * s),
        s**2 * sp.exp(-s / 4),
        sp.exp(-2 * s),
    )
    panel = Panel(0, functions, s, sp.S.Zero, sp.Rational(33, 10), sp.S.One)
    basis = make_basis(PanelProblem((panel,), tuple(h.subs(s, 1) for h in functions)))
    for found in (find_contacts(basis.panels), degenerate_contacts(basis.panels, basis.panels.search.nodes)):
        f = regressor_rows(basis.panels.coefficients, found.panel, found.u) @ found.dual
        assert (found.weights * f > 0).all() and (found.sign == np.sign(found.weights)).all()
        assert np.abs(found.weights).min() > 1e-7 * np.abs(found.weights).sum()


def test_a_weight_that_changes_its_sign_between_the_grid_and_the_contacts_is_not_returned():
    """The contacts of the grid keep their signs in the dual; the second weight became positive where f is -1."""
    s = sp.Symbol("t", real=True)
    functions = (sp.exp(-s / 2) * sp.sin(3 * s / 2), s * sp.sin(8 * s / 3))
    panel = Panel(0, functions, s, sp.S.Zero, sp.Rational(27, 10), sp.S.One)
    basis = make_basis(PanelProblem((panel,), (sp.S.One, sp.Integer(-2))))
    for found in contact_candidates(basis.panels):
        f = regressor_rows(basis.panels.coefficients, found.panel, found.u) @ found.dual
        assert (found.weights * f > 0).all() or found.excess > 1e-7
