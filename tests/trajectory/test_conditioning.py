"""Certified condition numbers: two routes, closed forms, mpmath, and the paper's own table."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from navsym.checker import Refused, check
from navsym.core.errors import DomainError, NotEstimableError, ShapeError, TooLargeError
from navsym.models.earth import observability_rows, power_rows
from navsym.trajectory.conditioning import (
    Enclosure,
    certify_condition,
    condition,
    condition_by_eigenvalues,
    condition_by_signs,
    condition_number,
)
from navsym.trajectory.enclosure import scientific
from navsym_papers.trajectory.experiment.columns import best_scaling

fractions = st.fractions(min_value=-5, max_value=5, max_denominator=9)


def encloses(found: Enclosure, value: mpmath.mpf) -> bool:
    low, high = (mpmath.mpf(x.numerator) / x.denominator for x in (found.lower, found.upper))
    return bool(low <= value <= high)


def test_the_golden_ratio_conditions_the_first_motion():
    """N_f for n = 2 is [[1, 1], [1, 2]], whose condition number is the fourth power of the golden ratio."""
    with mpmath.workdps(60):
        assert encloses(condition_number(power_rows(2), digits=40), ((1 + mpmath.sqrt(5)) / 2) ** 4)
        assert encloses(condition_number(power_rows(2), digits=40, equilibrate=True), 3 + mpmath.sqrt(10))


@pytest.mark.parametrize("n", [1, 2, 3, 7, 12])
@pytest.mark.parametrize("equilibrate", [False, True])
def test_both_routes_enclose_the_same_number(n, equilibrate):
    for rows in (power_rows(n), observability_rows(n, Fraction(1, 6371000), Fraction(1, 5))):
        one = condition_by_eigenvalues(rows, digits=30, equilibrate=equilibrate)
        two = condition_by_signs(rows, digits=30, equilibrate=equilibrate)
        assert two is not None
        assert max(one.lower, two.lower) <= min(one.upper, two.upper)


@given(st.lists(st.lists(fractions, min_size=3, max_size=3), min_size=3, max_size=5))
@settings(max_examples=25)
def test_any_rational_matrix_agrees_with_double_precision(rows):
    matrix = np.array([[float(x) for x in row] for row in rows])
    values = np.linalg.svd(matrix, compute_uv=False)
    assume(values[-1] >= 1e-6 * max(values[0], 1e-12))
    found = condition_number(rows, digits=12)
    assert abs(float(found.lower) / (values[0] / values[-1]) - 1) < 1e-7


def test_scaling_a_column_changes_nothing_once_columns_are_equilibrated():
    rows = [[Fraction(3), Fraction(1)], [Fraction(-1), Fraction(2)], [Fraction(5), Fraction(1, 3)]]
    scaled = [[7 * a, b / 1000] for a, b in rows]
    one, two = (condition_number(r, digits=25, equilibrate=True) for r in (rows, scaled))
    assert max(one.lower, two.lower) <= min(one.upper, two.upper)


@pytest.mark.parametrize("n", [10, 20])
def test_mpmath_lies_in_the_enclosure(n):
    with mpmath.workdps(100):
        matrix = mpmath.matrix([[int(x) for x in row] for row in power_rows(n)])
        values = mpmath.svd_r(matrix, compute_uv=False)
        assert encloses(condition_number(power_rows(n), digits=40), max(values) / min(values))


@pytest.mark.parametrize("digits", [1, 30, 120])
def test_enclosures_are_as_narrow_as_asked(digits):
    found = condition_number(power_rows(6), digits=digits)
    assert 0 < found.upper - found.lower < found.lower * Fraction(1, 10**digits)


def test_double_precision_is_doubted_when_it_is_wrong():
    found = condition(20)
    assert not found.N_f.trustworthy
    assert found.N_f.relative_error < -0.99
    assert any("N_f" in line for line in found.warnings)
    assert condition(5).warnings == ()


def test_conditioning_of_the_normalised_matrices_does_not_depend_on_rho_and_tau():
    for rho, tau in (("1", "1"), ("-3/7", "12"), ("1/6371000", "1/5")):
        found = condition(6, tau, rho, 20)
        assert found.N_pN.enclosure.decimal(15) == found.N_s.enclosure.decimal(15)


def test_decimal_strings_enclose():
    found = condition_number(power_rows(9), digits=20)
    lower, upper = map(Fraction, found.decimal(10))
    assert lower <= found.lower <= found.upper <= upper
    assert upper - lower <= 2 * Fraction(lower) / 10**9


def test_rounding_to_scientific_notation_carries():
    assert scientific(Fraction("9.99996"), 5) == "1.0000e+01"
    assert scientific(Fraction("0.00123454"), 4) == "1.235e-03"


def test_bad_requests_say_what_is_wrong():
    with pytest.raises(DomainError, match=r"n: expected 1 to.*positive"):
        condition(0)
    with pytest.raises(TooLargeError, match=r"n: expected 1 to.*smaller"):
        condition(121)
    with pytest.raises(TooLargeError, match="digits"):
        condition_number(power_rows(3), digits=10**6)
    with pytest.raises(DomainError, match="tau"):
        condition(3, "0")
    with pytest.raises(NotEstimableError, match="singular"):
        condition_number([[Fraction(1), Fraction(2)], [Fraction(2), Fraction(4)]])
    with pytest.raises(ShapeError, match="rows"):
        condition_number([[Fraction(1)], [Fraction(1), Fraction(2)]])


def test_a_zero_column_cannot_be_equilibrated():
    with pytest.raises(NotEstimableError, match="zero column"):
        condition_number([[Fraction(1), Fraction(0)], [Fraction(1), Fraction(0)]], equilibrate=True)


def test_the_printed_digits_imply_a_radius_of_6371_km():
    from navsym_papers.trajectory.table import fits, implied_radius

    low, high = implied_radius()
    assert 6370996 < low < 6371000 < high < 6371008.0
    assert fits(Fraction(6371000))
    # mean radius of WGS-84, equator, pole
    assert not any(fits(Fraction(x)) for x in ("6371008.8", "6378137", "6356752"))


@pytest.mark.parametrize("n", [2, 3, 5, 8])
def test_the_best_scaling_beats_unit_columns_and_is_stationary(n):
    found = best_scaling(n)
    assert found.stationarity < 1e-5
    assert found.enclosure.lower <= found.unit.upper * (1 + Fraction(1, 10**9))
    # van der Sluis: unit columns are within sqrt(n) of the best
    assert found.unit.lower**2 <= n * found.enclosure.upper**2
    for j in range(1, n):
        for factor in (Fraction(99, 100), Fraction(101, 100)):
            scale = [f * (factor if i == j else 1) for i, f in enumerate(found.factors)]
            norms = np.linalg.norm(np.array(power_rows(n), dtype=float), axis=0)
            moved = [
                [x * s / Fraction(float(l)) for x, s, l in zip(row, scale, norms, strict=True)] for row in power_rows(n)
            ]
            assert condition_number(moved, digits=15).upper >= found.enclosure.lower * (1 - Fraction(1, 10**8))


def test_unit_columns_are_worse_than_none_in_the_radius_channel():
    rows = observability_rows(5, Fraction(1), Fraction(13, 20))
    plain, scaled = (condition_number(rows, digits=20, equilibrate=flag) for flag in (False, True))
    assert plain.upper < Fraction(9, 10) * scaled.lower


@pytest.mark.parametrize("n", [1, 2, 7, 20])
def test_the_checker_grants_each_end_of_an_answer_and_no_narrower_one(n: int) -> None:
    import navsym as nav

    answer = nav.condition(n, tau="0.2", digits=20)
    assert answer.check().accepted
    for part, certificate in zip(answer, answer.certificates(), strict=True):
        statement = certificate["statement"]
        if Fraction(part.value.lower) > 1:
            wrong = statement | {"lower": part.value.upper, "upper": str(2 * Fraction(part.value.upper))}
            with pytest.raises(Refused):
                check(certificate | {"statement": wrong})
            assert check(certify_condition(wrong, 40)) == "condition" and certify_condition(wrong, 40)["outside"]


def test_the_error_of_a_double_does_not_depend_on_the_digits_that_are_shown() -> None:
    """With one digit asked for the error of a good double was said to be 1e-6: that of the coarse enclosure."""
    import navsym as nav

    few, many = (nav.condition(5, tau="3", rho="1/2", digits=digits) for digits in (1, 40))
    for one, other in zip(few, many, strict=True):
        assert one.relative_error == pytest.approx(other.relative_error, rel=1e-3)


@pytest.mark.parametrize("tau, rho", [("68750000000000000000", "-4/3"), ("1/500000000000000000000", "7")])
def test_the_certificate_of_a_huge_condition_number_is_accepted(tau: str, rho: str) -> None:
    """Eigenvalues at few bits agreed on a wrong smallest one, and the checker refused what was right."""
    import navsym as nav

    assert nav.condition(5, tau=tau, rho=rho, digits=3).check().accepted
    assert nav.condition(1, tau="1e-100", rho="1e100").check().accepted
