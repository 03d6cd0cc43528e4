"""asinh, acosh and atanh: logarithms for the prover and the checker, and shown as they are written."""

from __future__ import annotations

import math

import pytest
import sympy as sp

import navsym as nav
from navsym.core.errors import NavsymError
from navsym.language.expression import parse, read_tree, symbol
from navsym.language.names import INVERSES
from navsym.prove.grant import write_numerals

X = {"x": ("1/10", "9/10")}
#: A true formula, a false one in the same words, and the declarations of both.
PAIRS = [
    ("sinh(asinh(x)) = x", "sinh(asinh(x)) = -x", {}),
    ("cosh(acosh(x)) = x", "cosh(acosh(x)) = x + 1", {"x": ("1", "9")}),
    ("tanh(atanh(x)) = x", "tanh(atanh(x)) = x**2", X),
    ("diff(asinh(2*x), x) = 2/sqrt(1 + 4*x**2)", "diff(asinh(2*x), x) = 1/sqrt(1 + 4*x**2)", {}),
    ("diff(atanh(x), x) = 1/(1 - x**2)", "diff(atanh(x), x) = 1/(1 + x**2)", X),
    ("integral(1/sqrt(1 + s**2), s, 0, x) = asinh(x)", "integral(1/sqrt(1 + s**2), s, 0, x) = atan(x)", {}),
    ("atanh(x) >= x", "atanh(x) <= x", X),
]


@pytest.mark.parametrize(("true", "false", "given"), PAIRS, ids=[pair[0] for pair in PAIRS])
def test_a_formula_is_proved_and_its_false_variant_refuted(true, false, given):
    proved, refuted = nav.prove(true, **given), nav.prove(false, **given)
    assert (proved.status, refuted.status) == ("PROVED", "REFUTED"), proved.evidence
    assert proved.check().accepted
    assert str(proved.formula) == true
    name = next(name for name in INVERSES if name in true)
    assert rf"\operatorname{{{name}}}" in proved.formula._repr_latex_()


@pytest.mark.parametrize("name", INVERSES)
@pytest.mark.parametrize("x", [-3.0, -1.0, -0.5, 0.0, 0.25, 1.0, 1.5, 40.0])
def test_the_definition_has_the_value_of_the_mathematical_library_or_none_where_it_has_none(name, x):
    try:
        expected = getattr(math, name)(x)
    except ValueError:
        expected = None
    try:
        found = float(parse(f"{name}({x})", {}))
    except NavsymError:
        found = None
    assert (found is None) == (expected is None)
    assert found is None or abs(found - expected) <= 1e-12 * (1 + abs(expected))


def test_the_engines_and_the_checker_read_one_definition():
    a = symbol("a")
    for name, text in INVERSES.items():
        assert parse(f"{name}(a**2 + 3)", {"a": a}) == parse(text.replace("x", "(a**2 + 3)"), {"a": a})
        written = write_numerals(f"2*{name}({name}(a) + 1e-3)**2")
        assert name not in written
        assert read_tree(written) == read_tree(f"2*{name}({name}(a) + 0.001)**2")


def test_a_name_inside_of_another_is_no_function():
    assert write_numerals("casinh + asinh_2") == "casinh + asinh_2"
    with pytest.raises(NavsymError, match="already means a function"):
        symbol("asinh")


def test_latex_has_the_names_of_the_standard():
    verdict = nav.prove(r"\sinh(\operatorname{arsinh}(x)) = x")
    assert verdict.status == "PROVED"
    assert isinstance(parse("asinh(1)", {}), sp.log)
