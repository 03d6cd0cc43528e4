"""Uniqueness is true or false only when it is proved."""

from __future__ import annotations

import pytest
import sympy as sp

from navsym.guaranteed.problem import from_regressors
from navsym.guaranteed.solver import solve

t = sp.Symbol("t", real=True)


def unique(rows, functional, interval, sigma=None):
    return solve(from_regressors(rows, functional, t, interval, sigma), digits=20).unique


def test_a_mean_over_the_interval_has_many_estimators():
    """The middle of a line is the mean of any symmetric pair: x = (1, 0) and f = 1 on the whole interval."""
    assert unique([[1, t]], [1, 0], (-1, 1)) is False


def test_a_harmonic_over_several_periods_can_be_had_at_several_instants():
    rows = [[1, sp.sin(t), sp.cos(t)]]
    assert unique(rows, [0, 1, 0], (0, 6 * sp.pi)) is False


def test_two_equal_measurements_can_share_the_work():
    rows = [[1, t, t**2], [1, t, t**2]]
    assert unique(rows, [0, 0, 1], (0, 1)) is False


@pytest.mark.parametrize("k", [1, 2, 3])
def test_a_full_alternance_is_the_only_one(k):
    assert unique([[1, t, t**2, t**3]], [int(j == k) for j in range(4)], (0, 1)) is True


def test_an_end_value_is_not_said_to_have_several():
    """The value at 0 of a polynomial costs 1 with one instant; nothing else reaches it, whatever is proved."""
    assert unique([[1, t, t**2]], [1, 0, 0], (0, 1)) is not False


def test_a_dual_with_more_contacts_than_needed_but_one_estimator_is_not_called_several():
    """The slope at -1, 1: T_2 has three contacts, two unknowns of one parity stay unused."""
    assert unique([[1, t, t**2, t**3]], [0, 0, 1, 0], (-1, 1)) is not False


@pytest.mark.parametrize(
    ("rows", "functional", "end"),
    [([[1, sp.sin(t), sp.cos(t) - 1]], [1, 0, 0], 2 * sp.pi), ([[sp.cos(t)]], [1], 4 * sp.pi)],
)
def test_several_good_instants_cost_no_digits(rows, functional, end):
    solution = solve(from_regressors(rows, functional, t, (0, end)), digits=30)
    assert solution.status == "CERTIFIED" and solution.width < 1e-30 and solution.unique is False


@pytest.mark.parametrize("m", [2, 3, 6])
def test_the_value_at_the_end_of_an_interval_has_one_estimator_though_a_dual_is_constant(m):
    """1 - c t is optimal, too, and touches at 0 alone."""
    assert unique([[t**k for k in range(m)]], [int(k == 0) for k in range(m)], (0, 1)) is True


@pytest.mark.parametrize(("k", "answer"), [(0, False), (1, True), (2, False), (3, True), (4, False)])
def test_harmonics_over_a_full_period_have_one_estimator_unless_both_ends_carry_weight(k, answer):
    """Sines: one. Cosines share the weight of 0 with 2 pi; the mean has many."""
    rows = [1, sp.sin(t), sp.cos(t), sp.sin(2 * t), sp.cos(2 * t)]
    assert unique([rows], [int(j == k) for j in range(5)], (0, 2 * sp.pi)) is answer


def test_the_third_cosine_over_a_full_period_shares_the_weight_of_its_ends():
    rows = [1, *(f(k * t) for k in (1, 2, 3) for f in (sp.sin, sp.cos))]
    assert unique([rows], [0, 0, 0, 0, 0, 0, 1], (0, 2 * sp.pi)) is False


def test_a_second_measurement_that_only_touches_is_seen_before_one_estimator_is_called_the_only_one():
    """z2 = 1 - t repeats at 0 what z1 = 1 + t says there: weights may be shared."""
    assert unique([[1, t], [1, -t]], [1, 0], (0, 1)) is False


def test_an_end_where_the_dual_is_flat_in_any_case_has_one_estimator():
    """cos(t) and t**2 at 0: every dual has slope zero there."""
    assert unique([[sp.cos(t), t**2 * sp.exp(-t)]], [1, 0], (0, 1)) is True
