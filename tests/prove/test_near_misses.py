"""Statements beside the truth by 1e-30, strict bounds that are equations, and what exists: decided, and rightly."""

from __future__ import annotations

import pytest

import navsym as nav
from navsym.claims import PROVED, REFUTED

VECTOR, ROTATION, UNIT, SQUARE = {"vector": 3}, {"rotation": "b to n"}, {"quaternion": "unit"}, {"matrix": [2, 2]}

#: Equations of every construct that decides its text, each with its symbols.
EQUATIONS = [
    ("norm(cross(u, v))**2 + dot(u, v)**2", "dot(u, u)*dot(v, v)", {"u": VECTOR, "v": VECTOR}),
    ("det(C)", "1", {"C": ROTATION}),
    ("norm(qmul(p, q))", "1", {"p": UNIT, "q": UNIT}),
    ("integral(1/(1 + s**2), s, -oo, oo)", "pi", {}),
    ("sum(1/2**k, k, 0, oo)", "2", {}),
    ("limit(sin(x)/x, x, 0)", "1", {}),
    ("diff(erf(x), x)", "2*exp(-x**2)/sqrt(pi)", {}),
    ("floor(x + 1)", "floor(x) + 1", {}),
    ("where(x > 0, x, -x)", "abs(x)", {}),
    ("E(w**2)", "m**2 + r", {"w": {"random": {"mean": "m", "cov": "r"}}, "r": "nonnegative"}),
]
FALSE = ("{0} = {1} - 1e-30", "{0} >= {1} + 1e-25", "{0} < {1}", "{0} != {1}")


@pytest.mark.long
@pytest.mark.parametrize(("left", "right", "symbols"), EQUATIONS, ids=[left for left, _, _ in EQUATIONS])
def test_an_equation_holds_and_its_near_misses_do_not(left, right, symbols):
    assert nav.prove(f"{left} = {right}", **symbols).status == PROVED
    for pattern in FALSE:
        assert nav.prove(pattern.format(left, right), **symbols).status == REFUTED, pattern


@pytest.mark.parametrize(
    ("text", "symbols"),
    [
        ("1 + tan(x)**2 - 1e-9 <= sec(x)**2 < 1 + tan(x)**2 + 1e-9", {}),
        ("atan(x) + atan(1/x) < pi/2 + 1e-20", {"x": "positive"}),
        ("atan2(y, x) <= 2*atan(y/(sqrt(x**2 + y**2) + x))", {"x": "positive"}),
        ("det(C) < 1 + 1e-20", {"C": ROTATION}),
        ("floor(pi*1e20) = 314159265358979323846", {}),
        ("(a**b)**c = a**(b*c)", {}),
    ],
)
def test_what_differs_by_a_number_is_proved(text, symbols):
    assert nav.prove(text, **symbols).status == PROVED


@pytest.mark.parametrize(
    ("text", "exists"),
    [("x >= 0", "sqrt(x)"), ("x > 0", "log(x)"), ("x != 0", "y + log(x)"), ("x + y >= 0", "sqrt(x + y)")],
)
def test_what_has_to_exist_is_known(text, exists):
    assert nav.prove(text, exists=exists).status == PROVED


def test_a_root_that_exists_does_not_make_its_number_positive():
    assert nav.prove("x > 0", exists="sqrt(x)").status == REFUTED


@pytest.mark.parametrize(
    ("left", "right"),
    [
        pytest.param("sqrt(R)**5*sqrt(g/R**3)", "R*sqrt(g)", marks=pytest.mark.long),
        ("log(R + sqrt(R**2 + g**2)) - log(g)", "log(R/g + sqrt((R/g)**2 + 1))"),
        pytest.param("asin(R/sqrt(R**2 + g))", "atan(R/sqrt(g))", marks=pytest.mark.long),
    ],
)
def test_real_symbols_have_the_sign_that_the_text_gives_them(left, right):
    verdict = nav.prove(f"{left} = {right}", seconds=60)
    assert verdict.status == PROVED and {"g >= 0", "g > 0"} & {*verdict.assumptions}
    assert nav.prove(f"{left} = {right} + 1e-20").status != PROVED


@pytest.mark.parametrize(
    ("text", "symbols"),
    [
        ("1/cosh(1e20*(x - sqrt(2)/3)) <= 1 - 1e-9", {"x": ("0", "1")}),
        ("cosh(x - 1e-9) - 1 + abs(y - 1e6) != 0", {}),
        ("(y - x**2)**2 + (x - 1/7)**2 > 0", {}),
        ("(x*y - 1)**2 + x**2 >= 1/10**20", {}),
    ],
)
def test_peaks_and_dips_are_found_before_anything_is_confirmed(text, symbols):
    assert nav.prove(text, **symbols).status == REFUTED


@pytest.mark.long
def test_a_power_with_a_symbol_above_is_stated_for_positive_bases_and_says_so():
    verdict = nav.prove("sum(x**k, k, 0, oo) = 1/(1 - x)", x=("-1/2", "1/2"))
    assert verdict.status == PROVED and verdict.assumptions == ("x > 0",)
    assert nav.prove("sum(x**k, k, 0, oo) = 1/(1 - x) + 1e-9", x=("-1/2", "1/2")).status == REFUTED


@pytest.mark.parametrize("excess", ["1e-18", "1e-30", "1e-300"])
def test_a_constant_excess_over_the_tolerance_is_never_within_it(excess):
    assert nav.prove("x = x + 1/1000", tolerance="1/1000").holds
    assert nav.prove("x = x + 1/1000", tolerance=f"1/1000 - {excess}").status == REFUTED


@pytest.mark.parametrize(
    ("text", "given", "symbols"),
    [
        ("max(x, -x) = x", (), {"x": ("-1e-40", "7")}),
        ("where(x + 2*y < z + 1e-20, x + 2*y, z) = min(x + 2*y, z)", (), {}),
        ("x = y", ("x <= y", "y <= x + 1e-40"), {}),
        ("x = 1", ("x > 1 - 1e-30", "x < 1 + 1e-30"), {}),
    ],
)
def test_what_fails_on_a_strip_is_refuted_however_thin_the_strip_is(text, given, symbols):
    assert nav.prove(text, given=given, **symbols).status == REFUTED


def test_an_order_that_is_lost_by_a_tiny_coefficient_is_refuted():
    assert nav.prove("exp(eps) = 1 + eps + 1e-20*eps", order={"eps": 2}).status == REFUTED


def test_an_absolute_value_of_a_product_is_the_product_of_absolute_values_however_thin_the_strip_between_its_zeros():
    left, right = "abs((x - y)*(x - y - 6e-9))", "abs(x - y)*abs(x - y - 6e-9)"
    assert nav.prove(f"{left} = {right}").status == PROVED
    assert nav.prove(f"{left} = {right} + 1e-40").status == REFUTED


def test_what_must_exist_bounds_what_it_is_made_of():
    assert nav.prove("x**2 <= 1", exists="acos(x)").status == PROVED
    assert nav.prove("x**2 <= 1 - 1e-30", exists="acos(x)").status == REFUTED
    assert nav.prove("x**2 <= 1").status == REFUTED
