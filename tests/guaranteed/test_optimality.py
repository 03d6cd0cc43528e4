"""Enclosures of the guaranteed optimum against theory, and their certificates against the checker."""

from __future__ import annotations

import json

import numpy as np
import pytest
import sympy as sp

from navsym import checker
from navsym.core.exact import decimal, from_decimal
from navsym.guaranteed.certificate.enclosure import Panel, PanelProblem
from navsym.guaranteed.certificate.fixed import certify

t = sp.Symbol("t", real=True)


def problem(functions, functional, end, sigma=1):
    rows = tuple(sp.sympify(h) for h in functions)
    panel = Panel(0, rows, t, sp.Integer(0), sp.sympify(end), sp.sympify(sigma))
    return PanelProblem((panel,), tuple(sp.sympify(p) for p in functional))


def accepted(found) -> str:
    return checker.check(checker.load(json.dumps(found.certificate)))


def monomials(m, k, end=1):
    return problem([t**j for j in range(m)], [int(j == k) for j in range(m)], end)


def velocity(k, T):
    return problem([1, -sp.sin(T - t), sp.cos(T - t) - 1], [int(j == k) for j in range(3)], T)


@pytest.mark.parametrize("m", [2, 3, 5, 8, 12])
@pytest.mark.parametrize("back", [1, 2])
def test_coefficients_of_polynomials_have_the_optimum_of_shifted_chebyshev_polynomials(m, back):
    found = certify(monomials(m, m - back), 30)
    shifted = sp.Poly(sp.chebyshevt(m - 1, 2 * t - 1), t)
    value = abs(int(shifted.coeff_monomial(t ** (m - back))))
    assert found.lower <= value <= found.upper
    assert found.width < 1e-30
    assert accepted(found) == found.certificate["kind"]


@pytest.mark.parametrize("T", ["1/1000000", "1/3", "pi/2", "2"])
def test_the_drift_of_the_velocity_problem_has_the_error_of_its_closed_form(T):
    length = sp.sympify(T)
    found = certify(velocity(2, length), 30)
    value = sp.cos(length / 2) / sp.sin(length / 4) ** 2
    assert sp.Rational(str(found.lower)) - 0 <= sp.Rational(str(value.evalf(60)))
    assert sp.Rational(str(value.evalf(60))) <= sp.Rational(str(found.upper))
    assert found.unique is True
    assert accepted(found) == "touch"


def test_two_hundred_digits_are_a_matter_of_precision():
    found = certify(velocity(2, sp.pi / 2), 200)
    value = 2 + 2 * sp.sqrt(2)
    assert found.width < 1e-200
    assert sp.Rational(str(found.lower)) < sp.Rational(str(value.evalf(230))) < sp.Rational(str(found.upper))
    assert accepted(found) == "touch"


def test_fewer_contacts_than_unknowns_and_a_constant_dual_are_no_trouble():
    found = certify(velocity(0, sp.Rational(5, 2)), 30)
    assert found.lower <= 1 <= found.upper and found.width < 1e-30
    assert accepted(found) == "gap"


def test_a_dual_polynomial_that_is_constant_on_the_whole_interval_is_certified():
    found = certify(problem([1, t], [1, sp.Rational(1, 2)], 1), 30)
    assert found.lower <= 1 <= found.upper and found.width < 1e-30
    assert found.unique is None
    assert accepted(found) == "gap"


def test_a_column_of_one_billionth_is_solved_and_not_called_unbounded():
    found = certify(problem([1, t / 10**9], [0, 1], 1), 30)
    assert found.lower <= 2 * 10**9 <= found.upper
    assert accepted(found) == "touch"


def test_a_pattern_of_many_equal_maxima_is_reduced_to_independent_instants():
    rows = [1, t, sp.cos(3 * t), sp.sin(3 * t), sp.exp(-t), t * sp.exp(-t)]
    found = certify(problem(rows, [0, 0, 1, 0, 0, 0], 10), 12)
    assert found.lower <= 1 <= found.upper and found.width < 1e-12
    assert accepted(found) == "gap"


def test_noise_bounds_scale_the_optimum():
    single, triple = (certify(problem([1, t, t**2], [0, 0, 1], 1, sigma), 20) for sigma in (1, 3))
    assert single.lower <= 8 <= single.upper
    assert triple.lower <= 24 <= triple.upper


def test_two_measurements_are_never_worse_than_the_better_one():
    H = (sp.Integer(1), t), (sp.Integer(0), sp.Integer(1))
    panels = tuple(
        Panel(j, row, t, sp.Integer(0), sp.Integer(1), s)
        for j, (row, s) in enumerate(zip(H, (sp.Integer(1), sp.Rational(3, 2)), strict=True))
    )
    both = certify(PanelProblem(panels, (sp.Integer(0), sp.Integer(1))), 20)
    assert both.lower <= sp.Rational(3, 2) <= both.upper
    assert accepted(both) in ("gap", "touch")


@pytest.mark.parametrize("value", ["0", "1", "-12.5", "0.000123", "-98700"])
def test_decimals_are_read_back_exactly(value):
    assert decimal(from_decimal(value), 12) == value


def test_decimals_are_rounded_outwards():
    third = from_decimal("1") / 3
    assert from_decimal(decimal(third, 5, -1)) < third < from_decimal(decimal(third, 5, 1))
    assert np.isclose(float(from_decimal(decimal(third, 5))), 1 / 3, atol=1e-5)


@pytest.mark.parametrize("digits", [14, 30])
def test_twenty_monomials_have_exact_contacts_at_few_digits_too(digits):
    found = certify(problem([t**k for k in range(20)], [int(k == 11) for k in range(20)], 1), digits)
    assert found.certificate["kind"] == "touch" and found.reaches(digits) and found.unique is True


def test_a_dual_that_is_constant_with_coefficients_of_no_round_numbers_is_certified():
    """``x = (1 + sqrt(2)) (1, 0, sqrt(2))`` makes f the bound on the whole interval: the cost is its square."""
    root = sp.sqrt(2)
    c = sp.cos(sp.root(2, 4) * (3 - t))
    found = certify(problem([-c, sp.sin(sp.root(2, 4) * (3 - t)), root * c / 2 - root / 2 + 1], [1, 0, 1], 3), 30)
    assert found.width < 1e-30
    value = ((1 + root) ** 2).evalf(50)
    assert sp.Rational(str(found.lower)) < value < sp.Rational(str(found.upper))
    assert accepted(found) == "gap"


@pytest.mark.long
def test_a_stiff_motion_that_cancels_hundreds_of_digits_ends_with_two_bounds():
    """Cells of three thousand bits are dear: fewer are tried, and what is known comes back within seconds."""
    fast = sp.exp(1000 - 1000 * t)
    found = certify(problem([fast, sp.exp(1 - t) / 999 - fast / 999], [0, 1], 1), 12)
    assert found.lower <= found.upper and accepted(found) == "gap"
