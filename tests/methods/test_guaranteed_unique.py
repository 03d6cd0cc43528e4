"""Uniqueness is true or false only when it is proved."""

from __future__ import annotations

import pytest
import sympy as sp

from navsym.methods.guaranteed.problem import from_regressors
from navsym.methods.guaranteed.solver import solve

t = sp.Symbol("t", real=True)


def unique(rows, functional, interval, sigma=None):
    return solve(from_regressors(rows, functional, t, interval, sigma), 20).unique


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
    solution = solve(from_regressors(rows, functional, t, (0, end)), 30)
    assert solution.status == "CERTIFIED" and solution.width < 1e-30 and solution.unique is False
