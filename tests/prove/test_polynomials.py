"""Attacks on the exact ways of signs and numbers: what is false by a hair is never proved."""

from __future__ import annotations

import random

import pytest
import sympy as sp

from navsym.claims import PROVED, Equation
from navsym.prove.identities import is_zero
from navsym.prove.ladder import decide
from navsym.prove.search import EASY
from navsym.prove.signs import Sign, prove_sign

x, y, z = sp.symbols("x y z", real=True)
T = sp.Symbol("T", positive=True)
k = sp.Symbol("k", real=True, nonzero=True)
HAIR = sp.Rational(1, 10**40)


def sign_of(expression, box=None):
    signs = (prove_sign(expression, box or {}, sign, rounds=EASY).sign for sign in (Sign.POSITIVE, Sign.NONNEGATIVE))
    return next(filter(None, signs), Sign.UNKNOWN)


TOUCHING = (
    x**2 + y**2 - 2 * x * y,
    x**4 * y**2 + x**2 * y**4 + 1 - 3 * x**2 * y**2,
    x**4 + y**4 + z**4 - x * y * z * (x + y + z),
    sp.sin(x) ** 4 + sp.cos(x) ** 4 - sp.Rational(1, 2),
    (x**2 - 2) ** 2,
    T + 1 / T - 2,
    sp.exp(x) + sp.exp(-x) - 2,
    sp.Abs(x) + sp.Abs(y) - sp.Abs(x + y),
)


@pytest.mark.parametrize("expression", TOUCHING)
def test_a_touched_zero_is_nonnegative_not_positive_and_nothing_below_it_is_proved(expression):
    assert sign_of(expression) == Sign.NONNEGATIVE
    assert sign_of(expression - HAIR) == Sign.UNKNOWN


@pytest.mark.parametrize("expression", [T, 1 / T, k**2, x**2 + HAIR, x**4 + x + 1, T**2 - T + 1, k**2 + y**2])
def test_a_positive_expression_is_positive(expression):
    assert sign_of(expression) == Sign.POSITIVE


@pytest.mark.parametrize(
    ("expression", "box"),
    [
        (x**2, {}),
        ((x - y) ** 2, {}),
        (x, {x: (0, 1)}),
        (1 - x, {x: (0, 1)}),
        (1 + sp.cos(x), {}),  # zero at pi, where tan(x/2) does not exist
        (1 + sp.cos(x), {x: (0, sp.pi)}),
        (sp.sin(x), {x: (0, sp.pi)}),
        (x * T, {x: (0, 1)}),
    ],
)
def test_what_vanishes_somewhere_is_not_positive(expression, box):
    assert sign_of(expression, box) == Sign.NONNEGATIVE
    assert prove_sign(expression, box, Sign.POSITIVE).sign != Sign.POSITIVE


@pytest.mark.parametrize(
    "false",
    [
        T + 3 - 2 * sp.sqrt(T**2 - 2 * T + 1),  # a kink: the second derivative does not see it
        x + 1 - 2 * sp.Abs(x - 1) + 2,
        sp.sqrt(x**2 + 1) - x - sp.Rational(1, 10**6),
        1 - T * sp.exp(-T) - sp.Rational(7, 10),
        x**6 + y**6 + z**6 - 3 * x**2 * y**2 * z**2 - HAIR,
        sp.sin(4 * x) + 1 - HAIR,
    ],
)
def test_a_false_sign_is_not_proved(false):
    assert prove_sign(false, {}).sign == Sign.UNKNOWN


def random_polynomial(source, symbols):
    terms = [(source.randint(-3, 4), [s ** source.randint(0, 3) for s in symbols]) for _ in range(source.randint(2, 4))]
    return sp.Add(*(sp.Mul(c, *powers) for c, powers in terms))


def test_no_sign_of_a_random_polynomial_is_contradicted_at_a_rational_point():
    source = random.Random(11)
    for _ in range(20):
        symbols = source.sample([x, y, T], source.randint(1, 2))
        expression = random_polynomial(source, symbols) ** source.choice([1, 2]) - source.choice([0, HAIR])
        found = sign_of(sp.expand(expression)) if expression.free_symbols else Sign.UNKNOWN
        if found == Sign.UNKNOWN:
            continue
        for _ in range(60):
            point = {s: sp.Rational(source.randint(1 if s is T else -30, 30), source.randint(1, 12)) for s in symbols}
            value = expression.subs(point)
            assert value >= 0 and (found == Sign.NONNEGATIVE or value > 0), (expression, point)


# -- numbers ---------------------------------------


@pytest.mark.parametrize("digits", [20, 60, 200])
def test_a_radical_that_is_almost_zero_is_not_zero(digits):
    near = sp.sqrt(3 + 2 * sp.sqrt(2)) - 1 - sp.sqrt(2)
    assert is_zero(near)
    assert not is_zero(near - sp.Rational(1, 10**digits))


@pytest.mark.parametrize(
    "number",
    [
        sp.log(4) - 2 * sp.log(2) - HAIR,
        16 * sp.atan(sp.Rational(1, 5)) - 4 * sp.atan(sp.Rational(1, 239)) - sp.pi - HAIR,
        4 * sp.atan(2) + 4 * sp.atan(3) - sp.pi,  # the tangents agree, the branch does not
        sp.asin(sp.Rational(3, 5)) + sp.asin(sp.Rational(4, 5)) + 3 * sp.pi / 2,
        sp.exp(sp.pi * sp.sqrt(163)) - 262537412640768744,
        sp.cos(2 * sp.pi / 17) - sp.Rational(4661, 4999),
    ],
)
def test_a_number_that_is_not_zero_is_not_called_so(number):
    assert not is_zero(number)


def test_absolute_values_are_taken_in_both_cases():
    def is_proved(left, right):
        return decide(Equation(left, right), seconds=2.0).status == PROVED

    assert is_proved(sp.cos(sp.Abs(x)), sp.cos(x))
    assert not is_proved(sp.Abs(x), x)
    assert not is_proved(sp.Abs(x + y), sp.Abs(x) + sp.Abs(y))
    assert not is_proved(sp.sqrt(x**2 - 2 * x + 1), x - 1)


@pytest.mark.long
def test_a_bound_that_is_monotone_in_one_symbol_may_come_within_a_hair_of_zero_in_the_other():
    s, u, cos, sin = sp.Symbol("s", positive=True), sp.Symbol("u", real=True), sp.cos, sp.sin
    top = sp.Rational("3.6609754434249038385")
    f = -s * sin(2 * u) + (1 - cos(2 * u)) * (-s * sin(2) - 1 + cos(2)) / (cos(2) - 1) + cos(2 * u) + 1
    assert prove_sign(f, {s: (sp.Rational(1, 10), top), u: (0, 1)}).sign >= Sign.NONNEGATIVE
    assert prove_sign(f, {s: (sp.Rational(1, 10), top + sp.Rational(1, 10**9)), u: (0, 1)}).sign == Sign.UNKNOWN
