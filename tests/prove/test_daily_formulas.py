"""Formulas of daily use, and some at the edge of the language: each has a verdict or an error that says why."""

from __future__ import annotations

import pytest

import navsym as nav


@pytest.mark.parametrize(
    ("text", "declarations", "status"),
    [
        ("(1 - h/44330.77)**5.25588 > 0", {"h": ("0", "11000")}, ("PROVED",)),
        ("101325*(1 - h/44330.77)**5.25588 >= 22000", {"h": ("0", "11000")}, ("PROVED", "CERTIFIED")),
        ("(1 - 0.0065*h/288.15)**5.25588 = ((288.15 - 0.0065*h)/288.15)**5.25588", {"h": ("0", "11000")}, ("PROVED",)),
        ("x**5.25588*x**0.25588 = x**5.51176", {"x": "positive"}, ("PROVED",)),
        ("((9 + x)**(1/3))**3 = 9 + x", {"x": ("0", "1")}, ("PROVED",)),
        ("sqrt(cosh(exp(x))**2 - 1) = sinh(exp(x))", {"x": ("1", "100")}, ("PROVED", "CERTIFIED", "OPEN")),
        ("((x - y)**2)**(1/4) = sqrt(x - y)", {"x": "real", "y": "real"}, ("PROVED", "CONFIRMED", "OPEN")),
        ("atan2(x - y, 1/x) + atan2(1/x, x - y) = pi/2", {"x": "real", "y": "real"}, ("REFUTED", "OPEN")),
        ("x**x**x = x**(x**x)", {"x": "positive"}, ("PROVED",)),
    ],
)
def test_each_has_a_verdict(text, declarations, status):
    assert nav.prove(text, **declarations).status.name in status


@pytest.mark.parametrize(
    "text", ["0**0 = 1", "9**9**9 > 0", "atan2(x - x, 0) = 0", "x**0.1234567 > 0", "2**2**2**2**2 > 0"]
)
def test_each_has_an_error_with_a_place(text):
    with pytest.raises(nav.NavsymError, match=r"left, column \d+: expected .*; got .*; \w+"):
        nav.prove(text, **{"x": "positive"} if "x" in text else {})


def test_a_power_zero_asks_for_a_base_that_is_not_zero():
    assert nav.prove("x**0 = 1", x="real").assumptions == ("x != 0",)


WHOLE, FROM_FIVE, FEW = {"integer": ["-oo", "oo"]}, {"integer": ["5", "oo"]}, {"integer": ["0", "6"]}


@pytest.mark.parametrize(
    ("text", "n", "holds"),
    [
        ("n*(n - 1) >= 0", WHOLE, True),  # between whole numbers it is below 0
        ("(n - 1)*(n - 2)*(n - 3)*(n - 4) >= 0", WHOLE, True),
        ("2*n != 7", WHOLE, True),
        ("2**n > n**2", FROM_FIVE, True),
        ("sin(pi*n) = 0", FEW, True),
        ("(n - 1)*(n - 3) >= 0", WHOLE, False),
        ("n*(n - 1) > 0", WHOLE, False),
        ("cos(pi*n) = 1", FEW, False),
    ],
)
def test_whole_numbers_are_taken_one_by_one_where_real_ones_would_fail(text, n, holds):
    assert nav.prove(text, n=n).holds is holds


@pytest.mark.parametrize(
    ("text", "declarations", "status"),
    [
        ("where(p > 0, 1, 2) = 1", {"p": "positive"}, "PROVED"),  # the other case has no point
        ("where(p > 0, 1, 2) = 1", {"p": "nonnegative"}, "REFUTED"),
        ("p = 0", {"p": "nonnegative", "given": "p <= 0"}, "PROVED"),
        ("p = 1", {"p": ("0", "1"), "given": "p >= 1"}, "PROVED"),
        ("p = 1", {"p": ("0", "2"), "given": "p >= 1"}, "REFUTED"),
        ("p = q", {"given": ["p <= q", "p >= q"]}, "PROVED"),
    ],
)
def test_an_empty_case_and_two_bounds_that_meet_are_seen(text, declarations, status):
    assert nav.prove(text, **declarations).status.name == status


def test_a_root_alone_is_one_new_number():
    assert nav.prove("acos(1 - 2*h) = 2*asin(sqrt(h))").status.name == "PROVED"
    assert nav.prove("acos(1 - 2*h) = asin(sqrt(h))").status.name == "REFUTED"


def test_a_power_that_meets_a_number_is_refuted_at_its_root():
    assert nav.prove("x**3 != -2/3").counterexample == {"x": "-2**(1/3)*3**(2/3)/3"}
    assert nav.prove("x**3 != 2", x=("-1", "5/4")).holds
