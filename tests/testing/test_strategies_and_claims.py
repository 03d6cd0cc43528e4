"""What users get for their own tests: formulas decided, strategies that draw what they promise."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings

from navsym.core.errors import DomainError
from navsym.testing import (
    ClaimFailedError,
    angles,
    assert_claim,
    covariances,
    intervals,
    mode_transitions,
    models,
    rationals,
)

a, b = sp.symbols("a b", real=True)
T = sp.Symbol("T", positive=True)


def test_a_textbook_formula_passes_and_says_where_it_holds():
    verdict = assert_claim(sp.tan(a + b), (sp.tan(a) + sp.tan(b)) / (1 - sp.tan(a) * sp.tan(b)))
    assert verdict.status == "PROVED" and verdict.assumptions


def test_a_wrong_textbook_formula_is_caught_with_its_counterexample():
    """The half-angle formula with a lost factor, as one finds it copied."""
    with pytest.raises(ClaimFailedError, match="REFUTED at a = ") as caught:
        assert_claim(sp.sin(a / 2) ** 2, 1 - sp.cos(a))
    assert caught.value.verdict.counterexample


def test_bounds_and_numerals():
    assert_claim(sp.sin(T), T, relation="<", box={T: (sp.Rational(1, 10), 3)})
    assert_claim(sp.Rational("3.14"), sp.pi, tolerance=sp.Rational("0.005"))
    with pytest.raises(ClaimFailedError):
        assert_claim(sp.Rational("3.15"), sp.pi, tolerance=sp.Rational("0.005"))


def test_what_a_text_or_an_id_does_not_take_is_refused_and_not_ignored():
    for claim, more in (
        ("sin(a) <= a", {"relation": "<", "a": ("0", "1")}),
        ("guaranteed_velocity:4.3.u2*", {"T": ("0", "1")}),
        ("guaranteed_velocity:4.3.u2*", {"tolerance": "1/2"}),
    ):
        with pytest.raises(DomainError, match=r"write it there|leave it out"):
            assert_claim(claim, **more)


def test_what_is_only_sampled_passes_only_when_it_is_asked_for():
    left, right = sp.log(2 * T), sp.log(2) + sp.log(T)
    found = None
    try:
        found = assert_claim(left, right, sampled=True)
    except ClaimFailedError as error:
        found = error.verdict
    assert found.status in ("PROVED", "CONFIRMED", "OPEN")
    if found.status == "CONFIRMED":
        with pytest.raises(ClaimFailedError):
            assert_claim(left, right)


@settings(max_examples=20)
@given(models(), intervals(), angles(), rationals())
def test_exact_strategies_draw_exact_things(model, interval, angle, number):
    F, H = sp.Matrix(model.F), sp.Matrix(model.H)
    assert F.shape[0] == F.shape[1] == H.shape[1] == len(model.states)
    assert interval[0] < interval[1] and abs(angle) <= sp.pi
    assert not any(value.has(sp.Float) for value in (F, H, *interval, angle, number))


@given(covariances(), mode_transitions())
def test_arrays_are_what_their_names_say(P, transition):
    assert np.allclose(P, P.T) and np.all(np.linalg.eigvalsh(P) > 0)
    assert np.allclose(transition.sum(axis=1), 1) and np.all(transition >= 0)
