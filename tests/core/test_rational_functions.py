"""Quotients of polynomials obey the laws of fractions, over the integers and over the rationals."""

from __future__ import annotations

import pytest
import sympy as sp
from flint import Ordering, fmpq_mpoly_ctx, fmpz_mpoly_ctx
from hypothesis import given, settings
from hypothesis import strategies as st

from navsym.core.errors import DomainError
from navsym.core.rational_functions import (
    Quotient,
    clear_denominators,
    multiply_coefficients,
    polynomial_sum,
    powers_apart,
    read_arithmetic,
    replace_square,
)

NAMES = x, y = sp.symbols("x y")
RINGS = [fmpz_mpoly_ctx.get(("x", "y"), Ordering.degrevlex), fmpq_mpoly_ctx.get(("x", "y"), Ordering.degrevlex)]
over_both = pytest.mark.parametrize("ring", RINGS, ids=["integers", "rationals"])
atoms = st.sampled_from([x, y]) | st.integers(-4, 4).map(sp.Integer) | st.just(sp.Rational(2, 3))
formulas = st.recursive(atoms, lambda inner: st.builds(sp.Add, inner, inner) | st.builds(sp.Mul, inner, inner))


def read(expression, ring):
    def convert(part):
        if part in NAMES:
            return Quotient(ring.gen(NAMES.index(part)), ring.constant(1))
        return read_arithmetic(part, ring, convert)

    return convert(expression)


def written(quotient):
    return polynomial_sum(NAMES, quotient.top) / polynomial_sum(NAMES, quotient.bottom)


@over_both
@settings(max_examples=25, deadline=None)
@given(top=formulas, bottom=formulas)
def test_what_is_read_is_written_again_in_lowest_terms(ring, top, bottom):
    expression = top / (bottom**2 + 1) - 3 / (x * y + 2)
    quotient = read(expression, ring)
    assert sp.cancel(written(quotient) - expression) == 0
    assert quotient.top.gcd(quotient.bottom) == 1 and quotient.bottom.leading_coefficient() > 0


@over_both
def test_equal_expressions_are_read_as_one_quotient(ring):
    assert read((x**2 - y**2) / (2 * x - 2 * y), ring) == read(x / 2 + y / 2, ring)


@over_both
def test_a_divisor_that_is_zero_in_disguise_is_refused(ring):
    with pytest.raises(DomainError, match="nonzero divisor"):
        read(1 / ((x + 1) ** 2 - x**2 - 2 * x - 1), ring)


@over_both
def test_rows_times_their_common_denominator_are_polynomials(ring):
    row = [1 / x, y / (x * (x + y)), sp.Integer(2)]
    cleared, bottom = clear_denominators([[read(entry, ring) for entry in row]], ring.constant(1))
    for entry, top in zip(row, cleared[0], strict=True):
        assert sp.cancel(polynomial_sum(NAMES, top) / polynomial_sum(NAMES, bottom) - entry) == 0
    assert polynomial_sum(NAMES, bottom) == sp.expand(x * (x + y))


@over_both
def test_a_polynomial_is_the_sum_of_its_coefficients_times_powers(ring):
    poly = read((x + 2 * y + 1) ** 4, ring).top
    parts = powers_apart(poly, 0)
    assert sum((part * ring.gen(0) ** power for (power,), part in parts.items()), ring.constant(0)) == poly
    coefficients = [parts[power,] for power in range(5)]
    squared = powers_apart(poly * poly, 0)
    assert multiply_coefficients(coefficients, coefficients) == [squared[power,] for power in range(9)]


@over_both
def test_a_sine_to_a_power_becomes_one_of_degree_one(ring):
    sine, cosine = ring.gen(0), ring.gen(1)
    assert replace_square(sine**5 + cosine, 0, 1 - cosine**2) == sine * (1 - cosine**2) ** 2 + cosine
