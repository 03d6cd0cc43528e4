"""The graph computes the formula: exactly in its meaning, and without losing digits where none must be lost."""

from __future__ import annotations

import pytest
import sympy as sp
from flint import arb

from navsym.core.balls import enclose
from navsym.core.errors import UnknownSymbolError
from navsym.export.atoms import plain
from navsym.export.expression_graph import build
from navsym.export.forms import factored, safe
from navsym.prove.identities import vanishes_identically

x, y = sp.symbols("x y", real=True)
T = sp.Symbol("T", positive=True)


@pytest.mark.parametrize("share", [True, False])
@pytest.mark.parametrize(
    "formula",
    [
        (1 - 2 * sp.cos(T / 2)) / (4 * sp.sin(T / 4) ** 2),
        sp.sin(7 * x) * sp.cos(5 * x) - sp.tan(x / 2),
        -(x**5) / 3 - y / (x**2 + 1) + sp.Rational(7, 3) * sp.sqrt(x**2 + 2) ** 3,
        sp.exp(x) - 1 + sp.cosh(y) - 1,
        3 - 3 * sp.cos(x * y) + 2 * x - 2 * sp.sin(x),
        sp.Integer(-5) / 7,
    ],
)
def test_the_graph_means_the_formula(formula: sp.Expr, share: bool) -> None:
    graph = build([safe(formula, {})], sorted(formula.free_symbols, key=str), share=share)
    assert vanishes_identically(graph.meaning()[0] - formula)


def test_one_sincos_serves_all_multiples() -> None:
    formulas = [f(k * x) for k in range(1, 6) for f in (sp.sin, sp.cos)]
    operations = build(formulas, [x]).operations()
    assert operations["sin"] == operations["cos"] == 1
    assert build(formulas, [x], share=False).operations()["sin"] == 5


def test_equal_subexpressions_are_computed_once() -> None:
    graph = build([sp.sqrt(x**2 + 1) / y, sp.sqrt(x**2 + 1) * y], [x, y])
    assert graph.operations()["sqrt"] == 1


def test_what_cancels_at_zero_is_rewritten() -> None:
    assert safe(1 - sp.cos(x), {}) == 2 * sp.sin(x / 2) ** 2
    assert not safe((1 - sp.cos(x)) / x**2, {}).has(sp.cos)
    assert plain(safe((1 - sp.cos(x)) / x**2, {})).subs(x, 1) == 2 * sp.sin(sp.Rational(1, 2)) ** 2


def test_a_quotient_of_positive_numbers_keeps_its_division() -> None:
    assert safe(sp.sin(T) / T, {T: (0, 1)}) == sp.sin(T) / T


def test_a_factored_form_is_the_same_function() -> None:
    formula = (sp.sin(T / 2) - sp.sin(T)) / (sp.sin(T) * (sp.cos(T / 2) - 1) - sp.sin(T / 2) * (sp.cos(T) - 1))
    nicer = factored(formula)
    assert nicer is not None
    assert vanishes_identically(formula - nicer)
    ball = enclose(formula - nicer, {T: arb(0.75)}, 200)
    assert ball.contains(0) and ball.rad() < arb("1e-50")


def test_a_symbol_that_is_no_input_is_refused() -> None:
    with pytest.raises(UnknownSymbolError, match="expected only the inputs; got y"):
        build([x + y], [x])
