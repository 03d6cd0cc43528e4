"""What looks true at ordinary points and is not: the second look finds the place, or the verdict is OPEN."""

from __future__ import annotations

import pytest
import sympy as sp
from flint import arb

from navsym.claims import CONFIRMED, OPEN, PROVED, REFUTED
from navsym.claims.statement import Bound, Equation
from navsym.core.balls import ball_power, tape
from navsym.prove.ladder import decide
from navsym.prove.sampling.points import value_at

a, b, x, y = sp.symbols("a b x y", real=True)
p, q, r = sp.symbols("p q r", positive=True)
TINY = sp.Rational(1, 10**40)
UNIT = {x: (0, 1), y: (0, 1)}
MOTZKIN = a**4 * b**2 + a**2 * b**4 - 3 * a**2 * b**2 + 1

NEAR_MISSES = (
    Equation(sp.sin(a) ** 2 + sp.cos(a) ** 2, 1 + TINY),
    Equation(sp.sin(2 * a) * (1 + TINY), 2 * sp.sin(a) * sp.cos(a)),
    Equation(sp.cosh(a) ** 2 - sp.sinh(a) ** 2, 1 + a * TINY),
    Equation(sp.sin(10**40 * sp.pi * a), sp.Integer(0)),
    Equation(sp.exp(sp.Integer(1)), sp.Rational(271828182845904523536028747135266249775724709, 10**44)),
)

FALSE_BOUNDS = (
    Bound(4 * a**2 - 12 * a * b + sp.Rational(89, 10) * b**2, ">=", sp.Integer(-1)),  # negative in a cone only
    Bound((1 - sp.Rational(1, 10**6)) * a**2 + 4 * a * b + 4 * b**2, ">=", sp.Integer(-1)),
    Bound(sp.tan(x) * (1 - sp.Rational(1, 10**120)), ">=", x, {x: (0, sp.Rational(3, 2))}),
    Bound(sp.sin(a) ** 2 + sp.cos(a) ** 2, "<=", 1 - TINY),
    Bound(sp.pi, "<", sp.Rational(31415926535897932384626433832795028841971, 10**40)),
    Bound(a, "<", sp.Integer(10) ** 30),
    Bound(sp.log(p), "<", sp.Integer(50)),
    Bound(sp.atan(a), "<", sp.Rational(157, 100)),
    Bound(1 / (1 + a**2), ">", sp.Rational(1, 10**20)),
    Bound(sp.tanh(a), "<", 1 - sp.Rational(1, 10**30)),
    Bound(sp.sin(a) ** 4 + sp.cos(a) ** 4, ">=", sp.Rational(1, 2) + sp.Rational(1, 10**25)),
    Bound(MOTZKIN - sp.Rational(1, 10**20), ">=", sp.Integer(0)),
    Bound((x - sp.Rational(1, 3)) ** 2 * (x - sp.Rational(2, 3)) ** 2 - TINY, ">", sp.Integer(0), UNIT),
    Bound(
        sp.sin(x) + sp.sin(10 * x / 3),
        ">=",
        sp.Rational(-18995993, 10**7),
        {x: (sp.Rational(27, 10), sp.Rational(15, 2))},
    ),
)

#: False at one point only, at which no ball has a value: at a cut, and under a root.
ON_AN_EDGE = (
    Equation(sp.atan2(sp.sin(x), sp.cos(x)), x, {x: (-sp.pi, sp.pi)}),
    Bound(sp.sqrt(x - 1 - sp.Rational(1, 10**120)), ">", sp.Integer(0), {x: (1 + sp.Rational(1, 10**120), 2)}),
)

#: False so near to a zero, or so far out, that no decimal of a sample comes there.
BEYOND_DECIMALS = (
    Bound(sp.log(sp.Abs(a - sp.Rational(1, 2))), ">=", -(sp.Integer(10) ** 4)),
    Bound(sp.log(sp.Abs(a - sp.sqrt(2))), ">=", -(sp.Integer(10) ** 5)),
    Bound(sp.log(sp.log(x)), ">=", -(sp.Integer(10) ** 4), {x: (1, 2)}),
    Bound(sp.log(sp.Abs(sp.sin(a))), ">=", -(sp.Integer(10) ** 6)),
    Bound(sp.log(p), "<=", sp.Integer(10) ** 12),
    Bound(sp.sqrt(p + 1) - sp.sqrt(p), ">", sp.Rational(1, 10**200)),
)

#: Nobody knows how near a float, or a number without a formula, has to come.
BEYOND_SEARCH = (
    Bound(sp.log(sp.Abs(a**3 + a - 1)), ">=", -(sp.Integer(10) ** 4)),
    Bound(sp.log(sp.Abs(a - sp.Rational(1, 3))), ">=", -(sp.Integer(10) ** 6)),
    Bound(sp.atan(sp.log(sp.Abs(a - sp.Rational(1, 3))) / 10**6), ">=", sp.Rational(-3, 2)),
)

#: A zero of an absolute value in another, and of waves beyond the first turn.
ON_KINKS_AND_WAVES = (
    Bound(sp.Abs(sp.Abs(2 * a - b) - TINY), ">", sp.Integer(0)),
    Bound(sp.cos(a), "<", sp.Integer(1), exists=(1 / a,)),
    Bound(sp.Abs(p - sp.sqrt(2)) + sp.Abs(q**2 - 2), "!=", sp.Integer(0)),
)

TOUCHING_BUT_STRICT = (
    Bound(a, "!=", b),
    Bound((p + q) / 2, ">", sp.sqrt(p * q)),
    Bound(p / (q + r) + q / (p + r) + r / (p + q), ">", sp.Rational(3, 2)),
    Bound((a * x + b * y) ** 2, "<", (a**2 + b**2) * (x**2 + y**2)),
    Bound(MOTZKIN, ">", sp.Integer(0)),
    Bound(x * (1 - x) * y * (1 - y), "<", sp.Rational(1, 16), UNIT),
    Bound(sp.sin(a) + sp.cos(a), "<", sp.sqrt(2)),
)


@pytest.mark.parametrize("statement", (*NEAR_MISSES, *FALSE_BOUNDS, *BEYOND_DECIMALS, *ON_KINKS_AND_WAVES), ids=str)
def test_a_statement_that_is_false_by_little_or_far_away_is_refuted_at_a_point(statement):
    verdict = decide(statement)
    assert verdict.status == REFUTED
    assert verdict.difference is not None


@pytest.mark.parametrize("statement", BEYOND_SEARCH, ids=str)
def test_a_margin_that_falls_without_end_is_not_confirmed(statement):
    verdict = decide(statement, seconds=0.2)
    assert verdict.status == OPEN and "still falls" in verdict.evidence


@pytest.mark.parametrize(
    ("statement", "limits"),
    [
        (sp.sin(300 * x) + sp.sin(301 * x) < 2 - sp.Rational(1, 100), {x: (0, 4)}),
        (sp.sin(x) + sp.sin(sp.sqrt(2) * x) < 2 - sp.Rational(1, 100), {}),
        (sp.sin(x) + sp.cos(x**2) < 2 - sp.Rational(1, 10**9), {}),
    ],
    ids=str,
)
def test_waves_that_may_meet_between_all_samples_are_not_confirmed_to_stay_apart(statement, limits):
    assert decide(Bound(statement.lhs, "<", statement.rhs, limits), seconds=0.5).status in (OPEN, REFUTED)


@pytest.mark.parametrize("statement", ON_AN_EDGE, ids=str)
def test_what_is_false_on_an_edge_without_balls_is_not_proved(statement):
    assert decide(statement).status in (REFUTED, OPEN)


@pytest.mark.parametrize("statement", TOUCHING_BUT_STRICT, ids=str)
def test_a_strict_relation_is_refuted_where_equality_is_attained(statement):
    verdict = decide(statement)
    assert verdict.status == REFUTED
    assert verdict.difference.lower == verdict.difference.upper == "0" or float(verdict.difference.lower) != 0


@pytest.mark.parametrize(
    ("expression", "box"), [(x * sp.exp(x) - 3, {x: (1, 2)}), (sp.exp(x) - sp.cos(x) - 2, {x: (0, 2)})], ids=str
)
def test_two_sides_that_change_order_are_not_confirmed_to_be_different(expression, box):
    verdict = decide(Bound(expression, "!=", sp.Integer(0), box))
    assert verdict.status == OPEN
    assert "changes its sign" in verdict.evidence


@pytest.mark.parametrize("relation", [">", "!="])
def test_sides_that_touch_at_an_irrational_point_are_not_confirmed_to_be_apart(relation):
    verdict = decide(Bound((x * sp.exp(x) - 1) ** 2, relation, sp.Integer(0), {x: (sp.Rational(1, 2), 1)}))
    assert verdict.status == OPEN


def test_a_bound_that_fails_by_little_around_an_irrational_point_is_refuted():
    assert decide(Bound((x**2 - 2) ** 2, ">=", sp.Rational(1, 10**30))).status == REFUTED
    assert decide(Bound((x**3 - x - 1) ** 2 - TINY, ">", sp.Integer(0), {x: (1, 2)})).status == REFUTED


@pytest.mark.long
@pytest.mark.parametrize(
    "statement",
    [
        Bound(sp.atan((a - 10**6) ** 2), ">", -TINY),
        Bound(1 - 1 / (1 + (a - sp.sqrt(2)) ** 2) + TINY, ">", sp.Integer(0)),
        Bound(sp.cosh(a - sp.pi), ">=", sp.Integer(1)),
        Bound(sp.log(1 + p) + sp.log(1 + q), ">=", sp.log(1 + p + q)),
    ],
    ids=str,
)
def test_bounds_that_are_reached_far_from_zero_are_proved(statement):
    assert decide(statement, seconds=60.0).status == PROVED


def test_what_is_true_but_not_proved_stays_confirmed():
    verdict = decide(Bound(sp.cosh(x), "<=", sp.exp(x**2 / 2)), seconds=2.0)
    assert verdict.status == CONFIRMED


def test_the_power_of_a_ball_around_zero_is_the_hull_of_its_values():
    square, cube = ball_power(arb(0, 1.5), 2), ball_power(arb(0, 1.5), 3)
    assert square >= 0 and square.contains(arb(0)) and square.contains(arb(2.25))
    assert cube.contains(arb(3.375)) and cube.contains(arb(-3.375))
    assert square.rad() < 1.2 and cube.rad() < 3.4


def test_a_point_at_a_double_root_of_a_square_is_evaluated_not_skipped():
    at_a_third = value_at(tape((x - sp.Rational(1, 3)) ** 2 - TINY), {x: sp.Rational(1, 3)}, 512)
    assert at_a_third < 0


@pytest.mark.parametrize(
    "square",
    [3 * (a + b + sp.Rational(61, 20)) ** 2, (a**2 + b**2 - 3) ** 4 * (1 + sp.exp(a)), (a * b - 1) ** 2],
    ids=str,
)
def test_a_square_that_vanishes_on_a_line_is_not_positive(square):
    verdict = decide(Bound(sp.expand(square), ">", sp.Integer(0), {b: (-3, sp.Rational(-4, 5))}))
    assert verdict.status == REFUTED


def test_a_form_that_vanishes_on_a_line_is_not_positive():
    c = sp.Symbol("c", real=True)
    u, v, w = a + sp.Rational(6, 5), b + 2, c + sp.Rational(1, 2)
    form = sp.expand(19 * u**2 - 10 * u * v - 16 * u * w + 3 * v**2 + 6 * w**2)
    assert decide(Bound(form, ">", sp.Integer(0))).status == REFUTED


def test_what_is_only_confirmed_says_what_it_takes_to_exist():
    n = sp.Symbol("n", integer=True)
    verdict = decide(Bound(sp.log(n**2) * sp.tanh(a), ">=", 2 * sp.log(n) * sp.tanh(a), {a: (2, 4)}))
    assert "n > 0" in verdict.assumptions
