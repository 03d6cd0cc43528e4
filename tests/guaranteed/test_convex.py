"""Programmes on a grid against closed forms; the solvers' own words are never taken for the truth."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import navsym as nav
from navsym.core.errors import DomainError, NotEstimableError, NotFiniteError, ShapeError
from navsym.guaranteed.convex import LP_SOLVERS, GridProblem, grid_problem, guaranteed_lp
from navsym.guaranteed.problem import problem_of
from navsym.models.linear import LinearModel

UNKNOWNS = ("y1", "y2", "y3")
VELOCITY = LinearModel([[0, -1, 0], [0, 0, 1], [0, -1, 0]], H=[[1, 0, 0]], states=UNKNOWNS)


#: What a solver says when it believes that it has succeeded.
SUCCESS = ("Optimal", "solved", "optimal")


def velocity_correction(T, unknown, intervals=100):
    """z = y1 over [0, T], y1' = -y2, y2' = y3, y3' = -y2; estimate one component of y(T)."""
    times = np.linspace(0.0, T, intervals + 1)
    regressors = [np.ones(times.size), np.sin(T - times), -2 * np.sin((T - times) / 2) ** 2]
    spacing = np.full(times.size, T / intervals)
    spacing[[0, -1]] /= 2
    return GridProblem(regressors, np.eye(3)[UNKNOWNS.index(unknown)], spacing=spacing, times=times)


def test_a_problem_on_a_grid_has_the_regressors_derived_from_its_model():
    model = nav.Model.from_linear(VELOCITY, interval="3/2")
    grid, by_hand = grid_problem(problem_of(model, "y1", None, {}, ""), 7), velocity_correction(1.5, "y1", 6)
    for part in ("regressors", "functional", "bounds", "spacing", "times"):
        assert_allclose(getattr(grid, part), getattr(by_hand, part), rtol=1e-13, atol=1e-15)
    with pytest.raises(DomainError, match="2 to 100000"):
        grid_problem(problem_of(model, "y1", None, {}, ""), 1)


def optimum(T, unknown):
    """Closed forms for T <= pi/2: 1, 2 cot(T/4), cos(T/2)/sin(T/4)^2."""
    return {"y1": 1.0, "y2": 2 / np.tan(T / 4), "y3": np.cos(T / 2) / np.sin(T / 4) ** 2}[unknown]


@settings(max_examples=30, deadline=None)
@given(st.floats(0.05, np.pi / 2), st.sampled_from(UNKNOWNS))
def test_on_a_grid_with_the_optimal_instants_the_programme_has_the_closed_value(T, unknown):
    result = guaranteed_lp(velocity_correction(T, unknown, 60))
    assert_allclose(result.value, optimum(T, unknown), rtol=1e-8)
    assert result.status in SUCCESS
    assert result.residual < 1e-8 * result.value


@settings(max_examples=15, deadline=None)
@given(st.floats(0.2, np.pi / 2), st.sampled_from(UNKNOWNS), st.sampled_from([21, 51, 101]))
def test_off_the_optimal_instants_the_value_is_above_by_no_more_than_the_grid_error(T, unknown, odd):
    """A dual feasible on the grid exceeds 1 between its points by h^2/8 max|f''| at most.

    f = x . H has f'' = a - f with a = x1 - x3, and |a| is bounded by the guaranteed value of that functional.
    """
    problem = velocity_correction(T, unknown, odd)
    steep = GridProblem(problem.regressors, [1.0, 0.0, -1.0])
    bend = guaranteed_lp(steep).value + 1.0
    h = T / odd
    excess = h**2 / 8 * bend / (1 - h**2 / 8)
    value, exact = guaranteed_lp(problem).value, optimum(T, unknown)
    assert exact * (1 - 1e-9) <= value <= exact * (1 + excess) * (1 + 1e-9)


def test_the_support_is_the_beginning_the_middle_and_the_end():
    result = guaranteed_lp(velocity_correction(1.2, "y3"))
    assert np.flatnonzero(np.abs(result.weights) > 1e-9).tolist() == [0, 50, 100]
    quarter = 4 * np.sin(1.2 / 4) ** 2
    assert_allclose(result.weights[[0, 50, 100]] * quarter, [-1, 2 * np.cos(0.6), 1 - 2 * np.cos(0.6)], rtol=1e-9)


@pytest.mark.parametrize("solver", LP_SOLVERS)
@pytest.mark.parametrize("unknown", UNKNOWNS)
def test_every_solver_finds_the_optimum_of_a_mild_problem(solver, unknown):
    result = guaranteed_lp(velocity_correction(1.5, unknown), solver=solver)
    exact = optimum(1.5, unknown)
    loose = 0.03 if "osqp" in solver.lower() else 1e-6  # a first-order method stops early
    assert_allclose(result.value, exact, rtol=loose)
    assert result.residual < 1e-4
    assert result.status


def test_the_weighted_problem_scales_with_its_bounds():
    problem = velocity_correction(1.0, "y2")
    doubled = GridProblem(problem.regressors, problem.functional, bounds=np.full(101, 2.0))
    assert_allclose(guaranteed_lp(doubled).value, 2 * optimum(1.0, "y2"), rtol=1e-9)


@pytest.mark.parametrize("solver", LP_SOLVERS)
def test_a_short_interval_makes_solvers_wrong_one_by_one(solver):
    """Relative errors at lengths from 1.5 to 0.02: HiGHS holds six digits to 0.1, OSQP never has them."""
    lengths = (1.5, 0.5, 0.1, 0.02)
    results = [guaranteed_lp(velocity_correction(T, "y3", 40), solver=solver) for T in lengths]
    misses = [abs(r.value / optimum(T, "y3") - 1) for r, T in zip(results, lengths, strict=True) if r.value is not None]
    if solver == "casadi:highs":
        assert max(misses[:3]) < 1e-6
    if solver == "casadi:osqp":
        assert min(misses) > 1e-6
        assert any(r.status in SUCCESS for r in results)  # a success claimed and off


def test_a_status_is_no_proof():
    """At T = 1e-4 HiGHS calls a value optimal that is two fifths below the optimum."""
    T = 1e-4
    result = guaranteed_lp(velocity_correction(T, "y2"), solver="casadi:highs")
    assert result.status in SUCCESS
    assert result.value < 0.6 * optimum(T, "y2")
    assert result.residual > 1e-6  # and its weights are biased


def test_a_solver_that_fails_says_so_and_gives_no_value(monkeypatch):
    def broken(problem, engine):
        raise RuntimeError("licence expired\nsecond line")

    monkeypatch.setattr("navsym.guaranteed.convex.lp_by_cvxpy", broken)
    result = guaranteed_lp(velocity_correction(1.0, "y1"), solver="cvxpy:CLARABEL")
    assert result.status == "failed: RuntimeError: licence expired"
    assert (result.value, result.weights, result.residual) == (None, None, None)


def test_a_steep_basis_is_solved_or_shown_to_fail_but_not_called_unestimable():
    powers = np.linspace(0.0, 1.0, 101)[np.newaxis, :] ** np.arange(24)[:, np.newaxis]
    result = guaranteed_lp(GridProblem(powers, np.eye(24)[-1]))
    exact = 2.0 ** (2 * 23 - 1)  # leading coefficient of the Chebyshev polynomial
    assert result.value is None or result.residual > 1e-9 or abs(result.value / exact - 1) < 0.1


def test_bad_problems_are_refused_in_words():
    with pytest.raises(NotEstimableError, match="rank 1 of 2"):
        guaranteed_lp(GridProblem([[1.0, 1.0], [2.0, 2.0]], [0.0, 1.0]))
    with pytest.raises(NotEstimableError, match="rank 0 of 1"):
        guaranteed_lp(GridProblem([[0.0, 0.0]], [1.0]))
    with pytest.raises(DomainError, match="expected one of casadi:highs"):
        guaranteed_lp(velocity_correction(1.0, "y1"), solver="simplex")
    with pytest.raises(ShapeError, match=r"bounds: expected shape \(2,\)"):
        GridProblem(np.ones((1, 2)), [1.0], bounds=[1.0])
    with pytest.raises(DomainError, match="bounds: expected positive"):
        GridProblem(np.ones((1, 2)), [1.0], bounds=[1.0, 0.0])
    with pytest.raises(NotFiniteError):
        GridProblem([[1.0, np.nan]], [1.0])


def test_a_second_highs_library_is_reported_before_it_ends_the_process(monkeypatch, tmp_path):
    (tmp_path / "libhighs.so.1").touch()
    monkeypatch.setitem(sys.modules, "highspy", SimpleNamespace(__file__=str(tmp_path / "__init__.py")))
    result = guaranteed_lp(velocity_correction(1.0, "y1"), solver="casadi:highs")
    assert result.status.startswith("failed: MissingEngineError: casadi:highs: expected one HiGHS library")
