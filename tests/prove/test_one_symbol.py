"""Relations in one symbol are decided exactly, however thin the set on which they fail."""

from __future__ import annotations

import random

import pytest
import sympy as sp

from navsym.checker import check
from navsym.claims import CONFIRMED, OPEN, PROVED, REFUTED, Bound, Equation, Optimum
from navsym.prove.ladder import decide
from navsym.prove.signs import Sign, prove_sign
from tests.prove.one_symbol import random_case, verdict_against
from tests.sampling import thinned

x = sp.Symbol("x", real=True)
THIN = sp.Rational(1, 10**30)
E, S = sp.exp(x), sp.sin(x)


def status(expression, relation, lower=None, upper=None):
    return decide(Bound(sp.sympify(expression), relation, sp.Integer(0), {x: (lower, upper)})).status


@pytest.mark.parametrize("seed", thinned([(seed,) for seed in range(10)]))
def test_random_relations_have_the_truth_that_another_program_finds(seed):
    generator = random.Random(1000 + seed)
    cases = [random_case(generator) for _ in range(12)]
    outcomes = [verdict_against(case)[2] for case in cases]
    assert "false" not in outcomes, cases[outcomes.index("false")]
    assert outcomes.count("undecided") <= 4


@pytest.mark.parametrize("gap", [sp.Rational(1, 10**9), THIN, sp.Rational(1, 10**200)])
def test_a_bound_that_fails_on_a_thin_interval_is_refuted_at_a_rational_point(gap):
    verdict = decide(Bound(sp.expand((x - 1) * (x - 1 - gap) * (1 + x**2)), ">=", sp.Integer(0)))
    assert verdict.status == REFUTED
    assert 1 < sp.Rational(verdict.counterexample["x"]) < 1 + gap


@pytest.mark.parametrize(
    ("true", "false"),
    [
        (E**2 - 2 * E + 1, E**2 - (2 + THIN) * E + 1 + THIN),
        (1 - S, 1 - S - THIN),
        (sp.sqrt(x) - 2 * x + x**2 / sp.sqrt(x), sp.sqrt(x) - 2 * x + x * sp.sqrt(x) - THIN),
        (sp.cosh(x) - 1, sp.cosh(x) - 1 - THIN),
        (sp.Abs(x - 1) + sp.Abs(x + 1) - 2, sp.Abs(x - 1) + sp.Abs(x + 1) - 2 - THIN),
        (
            3 * sp.Abs(x - sp.Rational(1, 3)) + 2 * sp.Abs(x + sp.Rational(4, 3)) - sp.Rational(10, 3),
            3 * sp.Abs(x - sp.Rational(1, 3)) + 2 * sp.Abs(x + sp.Rational(4, 3)) - sp.Rational(10, 3) - THIN,
        ),
        (sp.Abs(S) + sp.Abs(sp.cos(x)) - 1, sp.Abs(S) + sp.Abs(sp.cos(x)) - 1 - THIN),
    ],
    ids=str,
)
def test_what_touches_zero_is_proved_and_what_passes_it_by_little_is_refuted(true, false):
    assert status(true, ">=") == PROVED
    assert status(true, ">") == REFUTED
    assert status(false, ">=") == REFUTED


@pytest.mark.parametrize("count", [3, 5, 9])
def test_many_absolute_values_take_a_piece_between_two_zeros_each(count):
    total = sum((sp.Abs(x - sp.Rational(k, 3)) for k in range(count)), sp.S.Zero)
    middle = total.subs(x, sp.Rational(count // 2, 3))
    assert decide(Bound(total, ">=", middle)).status == PROVED
    assert decide(Bound(total, ">", middle)).status == REFUTED
    assert decide(Bound(total, ">=", middle + THIN)).status == REFUTED


@pytest.mark.parametrize("polynomial", [x**3 - x - 1, x**5 - x - 1])
def test_equality_at_a_root_without_a_formula_is_no_point_of_a_certificate(polynomial):
    verdict = decide(Bound(polynomial**2, ">", sp.Integer(0)))
    assert verdict.status == OPEN and "claimed REFUTED by real roots, but not granted" in verdict.evidence
    assert status(polynomial**2, ">=") == PROVED and status(polynomial**2 - THIN, ">=") == REFUTED
    assert decide(Bound((x**5 - x - 1) ** 2, ">", sp.Integer(0), {x: (2, None)})).status == PROVED


@pytest.mark.long
def test_ends_of_a_range_are_compared_exactly_with_roots():
    assert status(x**2 - 2, ">=", sp.sqrt(2)) == PROVED
    assert status(x**2 - 2 - THIN, ">=", sp.sqrt(2)) == REFUTED
    assert status(1 - 2 * S, ">=", 5 * sp.pi / 6, 13 * sp.pi / 6) in (PROVED, CONFIRMED, OPEN)
    assert status(1 - 2 * S, ">=", 5 * sp.pi / 6 - THIN, 2 * sp.pi) == REFUTED
    assert status(E - 2, ">=", sp.log(2)) == PROVED


def test_a_zero_where_a_side_does_not_exist_breaks_nothing():
    pole = 1 / (x - 2)
    verdict = decide(Bound((x - 2) ** 3 + pole, "!=", pole))
    assert verdict.status == PROVED and verdict.assumptions == ("x - 2 != 0",)
    assert status((x**2 - 2 * x + 1) / (x - 1), "!=") == PROVED


def test_poles_are_assumptions_and_not_signs():
    verdict = decide(Bound(1 / x**2, ">", sp.Integer(0)))
    assert verdict.status == PROVED and verdict.assumptions == ("x != 0",)
    assert prove_sign(1 / x**2, {}, Sign.POSITIVE).sign == Sign.UNKNOWN
    assert status(1 / x, ">=") == REFUTED


def test_half_of_a_domain_is_assumed_and_said():
    verdict = decide(Bound(sp.sqrt(2 * x - 1), "<=", x, {x: (0, None)}))
    assert verdict.status == PROVED and verdict.assumptions == ("2*x - 1 >= 0",)
    assert decide(Bound(sp.sqrt(2 * x - 1), "<=", x)).status in (PROVED, OPEN)
    assert decide(Equation((x**3) ** sp.Rational(1, 3), x)).assumptions == ("x**3 >= 0",)


def test_a_numeral_is_refuted_where_its_tolerance_is_passed_by_little():
    wave, half = x * (1 - x) / 10**6, sp.Rational(1, 2)
    quarter = sp.Rational(1, 4 * 10**6)
    assert decide(Equation(half, half + wave, {x: (0, 1)}, tolerance=quarter)).status.holds
    assert decide(Equation(half, half + wave, {x: (0, 1)}, tolerance=quarter - THIN)).status == REFUTED


def test_a_nonzero_symbol_is_no_assumption():
    n = sp.Symbol("n", real=True, nonzero=True)
    verdict = decide(Bound(1 / n, "!=", sp.Integer(0)))
    assert verdict.status == PROVED and verdict.assumptions == ()


def test_an_optimum_on_an_interval_with_holes_is_not_proved():
    """sqrt(t - 1/2) has no value on the first half of [0, 1]; a bound on the rest proves nothing."""
    t = sp.Symbol("t", real=True)
    regressor = sp.sqrt(t - sp.Rational(1, 2)) * 0 + sp.sqrt(2 * t - 1)
    one = sp.Integer(1)
    statement = Optimum((regressor,), (one,), t, (sp.Integer(0), one), (one,), (one,), (one,), one)
    assert not decide(statement).status.holds


def test_poles_of_a_dual_that_the_functional_does_not_meet_are_assumptions():
    t, T = sp.Symbol("t", real=True), sp.Symbol("T", positive=True)
    regressors = (sp.Integer(1), (T - 1) * t * 0 + sp.Integer(0))
    dual = (sp.Integer(1), 1 / (T - 1))
    one, zero = sp.Integer(1), sp.Integer(0)
    verdict = decide(Optimum(regressors, (one, zero), t, (zero, T), dual, (zero,), (one,), one))
    assert verdict.status == PROVED and verdict.assumptions == ("T - 1 != 0",)


@pytest.mark.parametrize(
    ("expression", "relation", "ends"),
    [
        (x**2 - 2 * x + 1, ">=", (None, None)),
        (x**2 + THIN, ">", (None, None)),
        (x**3, ">=", (0, None)),
        (x**3 - 1, "<=", (None, 1)),
        (x * (1 - x), ">=", (0, 1)),
        ((x**3 - x - 1) ** 2 * (x**2 + 1) / (x - 5) ** 2, ">=", (None, None)),
        (x / (x**2 + 1) - sp.Rational(1, 2), "<=", (None, None)),
    ],
    ids=str,
)
def test_a_bound_that_touches_or_has_no_last_end_has_a_certificate(expression, relation, ends):
    certificate = decide(Bound(expression, relation, sp.Integer(0), {x: ends})).certificate
    assert certificate is not None and check(certificate) == "proof"


def test_an_exponential_over_a_range_that_no_fraction_can_end_is_left_to_the_other_proofs():
    x = sp.Symbol("x")
    verdict = decide(Bound(sp.exp(x) + sp.exp(-x), ">=", sp.Integer(2), {x: (sp.Integer(0), sp.Integer(10**12))}))
    assert verdict.status is PROVED and verdict.method != "real roots"
