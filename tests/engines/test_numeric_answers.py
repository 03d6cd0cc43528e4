"""Answers of numpy, HiGHS, OSQP and Clarabel that are wrong on our kind of problem, and what navsym says."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from navsym.claims import PROVED, Bound, Equation
from navsym.guaranteed import convex
from navsym.guaranteed.convex import LP_SOLVERS, GridProblem, guaranteed_lp
from navsym.guaranteed.problem import from_regressors
from navsym.guaranteed.solver import solve
from navsym.prove.ladder import decide

s = sp.Symbol("t", real=True)


def engine_is_wrong(wrong, note=""):
    if not wrong:
        pytest.skip(f"this version has it right {note}")


def hilbert(n):
    return [[sp.Rational(1, i + j + 1) for j in range(n)] for i in range(n)]


def nonzero(value):
    return decide(Bound(sp.sympify(value, strict=True), "!=", sp.Integer(0))).status.holds


# -- numpy ----------------------------------------------------------------------------------------


def test_a_rank_of_a_matrix_in_mixed_units():
    engine_is_wrong(np.linalg.matrix_rank(np.diag([1.0, 1e-20])) == 1)
    assert nonzero(sp.Matrix([[1, 0], [0, sp.Rational(1, 10**20)]]).det())


def test_a_rank_of_monomials_at_twenty_instants():
    engine_is_wrong(np.linalg.matrix_rank(np.vander(np.linspace(0, 1, 20))) < 20)
    nodes = [sp.Rational(k, 19) for k in range(20)]
    determinant = sp.prod(b - a for i, a in enumerate(nodes) for b in nodes[i + 1 :])  # Vandermonde
    assert nonzero(determinant)


def test_a_rank_that_one_part_in_ten_to_the_seventeen_decides():
    engine_is_wrong(np.linalg.matrix_rank(np.array([[1, 1], [1, 1 + 1e-17]])) == 1)
    assert nonzero(sp.Matrix([[1, 1], [1, 1 + sp.Rational(1, 10**17)]]).det())


def test_a_determinant_below_the_smallest_double():
    engine_is_wrong(np.linalg.det(np.diag([1e-200, 1e-200])) == 0.0)
    assert nonzero(sp.Rational(1, 10**400))


def test_a_linear_system_of_hilbert():
    n = 15
    H = sp.Matrix(hilbert(n))
    b = H * sp.ones(n, 1)
    found = np.linalg.solve(np.array(H, dtype=float), np.array(b, dtype=float).ravel())
    engine_is_wrong(np.abs(found - 1).max() > 0.5)
    assert decide(Equation(H * sp.ones(n, 1), b)).status == PROVED


def test_the_roots_of_wilkinsons_polynomial():
    found = np.roots(np.poly(np.arange(1, 21)))
    engine_is_wrong(min(abs(found - 15)) > 1e-3)
    x = sp.Symbol("x", real=True)
    polynomial = sp.expand(sp.prod(x - k for k in range(1, 21)))
    assert decide(Equation(polynomial.subs(x, 15), sp.Integer(0))).status == PROVED


def test_the_eigenvalues_of_a_long_chain():
    chain = np.eye(10, k=1)
    chain[9, 0] = 1e-16
    engine_is_wrong(np.abs(np.linalg.eigvals(chain)).max() > 0.01, "and the perturbation is real")
    # A chain of ten integrators without the perturbation is nilpotent: all eigenvalues are zero.
    exact = sp.zeros(10)
    for k in range(9):
        exact[k, k + 1] = 1
    assert decide(Equation(exact**10, sp.zeros(10))).status == PROVED


def test_a_sum_that_depends_on_its_order():
    engine_is_wrong(0.1 + 0.2 + 0.3 != 0.3 + 0.2 + 0.1)
    tenths = [sp.Rational(k, 10) for k in (1, 2, 3)]
    assert decide(Equation(sum(tenths), sum(reversed(tenths)))).status == PROVED


# -- solvers: the last coefficient of a polynomial of degree n on [0, 1], optimum 2**(2n - 1) -------------


def monomials(n, nodes=400):
    """The regressors at Chebyshev's points, so that the grid holds the support."""
    instants = (1 - np.cos(np.pi * np.arange(n * (nodes // n) + 1) / (n * (nodes // n)))) / 2
    functional = np.zeros(n + 1)
    functional[-1] = 1.0
    return GridProblem(np.vander(instants, n + 1, increasing=True).T, functional)


@pytest.mark.parametrize("solver", [name for name in LP_SOLVERS if name.startswith("casadi") or "highs" not in name])
@pytest.mark.parametrize("degree", [9, 19])
def test_a_solvers_success_is_only_a_word(solver, degree):
    """Whatever the solver says, its weights are judged here by the constraints and the exact optimum."""
    exact = float(2 ** (2 * degree - 1))
    result = guaranteed_lp(monomials(degree), solver=solver)
    error = None if result.value is None else abs(result.value / exact - 1.0)
    engine_is_wrong(error is None or error > 1e-6, f"(error {error})")


@pytest.mark.parametrize("degree", [9, 19])
def test_navsym_encloses_the_optimum_that_the_solvers_miss(degree):
    problem = from_regressors([[s**k for k in range(degree + 1)]], [0] * degree + [1], s, (0, 1))
    found = solve(problem, digits=12)
    assert sp.Rational(found.lower) <= 2 ** (2 * degree - 1) <= sp.Rational(found.upper)


def test_a_column_of_a_billionth_is_a_unit_and_nothing_else():
    tiny = sp.Rational(1, 10**9)
    found = solve(from_regressors([[sp.Integer(1), tiny * s]], [0, tiny], s, (0, 1)), digits=12)
    assert sp.Rational(found.lower) <= 2 <= sp.Rational(found.upper)


@pytest.mark.parametrize("solver", LP_SOLVERS)
@pytest.mark.parametrize("status", ["optimal", "optimal_inaccurate", "maximum iterations reached"])
@pytest.mark.parametrize("lie", ["zeros", "half", "nan"])
def test_a_solver_that_lies_is_found_out(monkeypatch, lie, status, solver):
    problem = monomials(2)
    honest = guaranteed_lp(problem, solver="casadi:highs").weights
    false = {"zeros": np.zeros_like(honest), "half": honest / 2, "nan": honest * np.nan}[lie]
    bridge = f"lp_by_{solver.partition(':')[0]}"
    monkeypatch.setattr(convex, bridge, lambda problem, engine: (false, status))
    result = guaranteed_lp(problem, solver=solver)
    assert result.weights is None or result.residual > 0.4
    assert result.value is None or abs(result.value / 8.0 - 1.0) > 0.4
