"""Logarithms of composite numbers and nested radicals: decided exactly, their conditions said."""

from __future__ import annotations

import pytest
import sympy as sp

from navsym.claims import PROVED, REFUTED, Equation
from navsym.prove.ladder import decide

x = sp.Symbol("x", real=True)
root, log = sp.sqrt, sp.log
NEST = root(3 + 2 * root(2))


@pytest.mark.parametrize(
    ("left", "right", "assumed"),
    [
        (log(6), log(2) + log(3), ()),
        (log(3 + 2 * root(2)), 2 * log(1 + root(2)), ()),
        (1 / log(6), 1 / (log(2) + log(3)), ()),
        (log(6) + x, log(2) + log(3) + x, ()),
        (NEST, 1 + root(2), ()),
        (root(8 + 2 * root(15)), root(3) + root(5), ()),
        (1 / (x + NEST), 1 / (x + 1 + root(2)), ("x + sqrt(2*sqrt(2) + 3) != 0", "x + 1 + sqrt(2) != 0")),
        (sp.sin(x * NEST), sp.sin(x + x * root(2)), ()),
        (sp.exp(x * root(6 - 2 * root(5))), sp.exp(-x) * sp.exp(x * root(5)), ()),
        (log(x + NEST), log(x + 1 + root(2)), ("x + sqrt(2*sqrt(2) + 3) > 0", "x + 1 + sqrt(2) > 0")),
    ],
    ids=str,
)
def test_numbers_written_in_two_ways_are_proved_equal(left, right, assumed):
    verdict = decide(Equation(left, right))
    assert verdict.status == PROVED and verdict.assumptions == assumed


@pytest.mark.parametrize(
    ("left", "right"),
    [
        (sp.sin(x * root(3 - 2 * root(2))), sp.sin(x - x * root(2) + x * sp.Rational(1, 10**40))),
        (NEST, 1 + root(2) + sp.Rational(1, 10**40)),
        (log(6), log(2) + log(3) - sp.Rational(1, 10**60)),
    ],
    ids=str,
)
def test_what_differs_by_little_is_refuted(left, right):
    assert decide(Equation(left, right)).status == REFUTED
