"""Unknowns that the measurements do not tell apart, by coefficients of any kind; and those that only seem so."""

from __future__ import annotations

import json

import pytest
import sympy as sp

from navsym import checker
from navsym.core.errors import NavsymError, NotEstimableError
from navsym.guaranteed.problem import from_regressors
from navsym.guaranteed.solver import solve

s = sp.Symbol("s", real=True)
sin, cos, exp, pi, R = sp.sin, sp.cos, sp.exp, sp.pi, sp.Rational


def solved(row, functional, interval=(0, 1), digits=20):
    solution = solve(from_regressors([row], functional, s, interval), digits=digits)
    assert solution.status == "CERTIFIED"
    assert checker.check(checker.load(json.dumps(solution.certificate))) == solution.certificate["kind"]
    return solution


@pytest.mark.parametrize(
    ("row", "functional", "direction"),
    [
        ([1, sp.sqrt(2) * s, s], [0, 1, 0], r"\[0, -sqrt\(2\)/2, 1\]"),
        ([s, pi * s], [1, 3], r"\[-pi, 1\]"),
        ([sin(s), cos(s), sin(s + 1)], [1, 0, 0], "null direction"),
    ],
)
def test_a_relation_with_coefficients_that_are_not_rational_gives_a_null_direction(row, functional, direction):
    with pytest.raises(NotEstimableError, match=direction):
        solve(from_regressors([row], functional, s, (0, 1)))


def test_a_functional_that_respects_such_a_relation_is_estimated():
    assert float(solved([s, pi * s], [1, pi]).value) == pytest.approx(1.0, rel=1e-15)
    value = float(solved([sin(s), cos(s)], [1, 0]).value)
    assert float(solved([sin(s), cos(s), sin(s + 1)], [1, 0, cos(1)]).value) == pytest.approx(value, rel=1e-15)


@pytest.mark.long
def test_more_functions_than_the_first_grid_has_points_are_not_called_dependent():
    """The leading coefficient of degree 29 on [0, 1] costs 2**57, that of the Chebyshev polynomial."""
    solution = solved([s**k for k in range(30)], [int(k == 29) for k in range(30)])
    assert sp.Rational(solution.lower) <= 2**57 <= sp.Rational(solution.upper) and solution.unique is True


def test_functions_that_agree_at_the_points_of_the_first_grid_only_are_not_called_dependent():
    """``T_25 = -T_23`` at the 24 Chebyshev points; one instant tells the sum of their coefficients for 1."""
    row = [sp.chebyshevt(k, s).expand() for k in (23, 25)]
    assert float(solved(row, [1, 1], (-1, 1)).value) == pytest.approx(1.0, rel=1e-15)


@pytest.mark.parametrize("power", [40, 400])
def test_unknowns_that_differ_by_very_little_are_estimated_at_their_price(power):
    solution = solved([1, s, s + s**2 / sp.Integer(10) ** power], [0, 0, 1])
    assert sp.Rational(solution.lower) <= 8 * 10**power <= sp.Rational(solution.upper)


@pytest.mark.parametrize("length", [R(1, 10**400), sp.Integer(10) ** 400])
def test_lengths_beyond_the_range_of_a_double_are_solved(length):
    """The slope of a line costs 2 / T."""
    solution = solved([1, s], [0, 1], (0, length))
    assert sp.Rational(solution.lower) <= 2 / length <= sp.Rational(solution.upper)


def test_a_function_beyond_the_range_of_a_double_is_solved():
    """exp(1000 s) and 1 on [0, 1]: the coefficient of exp costs 2 / (exp(1000) - 1), far below any double."""
    solution = solved([1, exp(1000 * s)], [0, 1])
    assert sp.Rational(solution.lower) < 2 / (exp(1000) - 1).evalf(40) < sp.Rational(solution.upper)


def test_functions_that_differ_beyond_all_bits_are_left_open_with_the_direction_that_is_not_seen():
    with pytest.raises(NavsymError, match=r"about the direction \[0, -1, 1\]"):
        solve(from_regressors([[1, s, s + exp(s) / sp.Integer(10) ** 1100]], [0, 0, 1], s, (0, 1)))


@pytest.mark.parametrize("digits", [9, 12, 16, 20, 30])
def test_no_place_of_a_certificate_is_outside_its_panel(digits):
    """The optimum 1 is cos(9 t/2) at 0, a single contact at an end: Newton's steps had left the interval by 1e-31."""
    row = [cos(9 * s / 2), s * exp(-5 * s / 4), cos(9 * s / 4)]
    document = solved(row, [1, 0, 0], (0, 5), digits).certificate
    assert all(0 <= R(v) <= 1 for _, v in document.get("support", []))
