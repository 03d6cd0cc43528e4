"""Regimes where F comes in pieces, next to values where a pattern is singular, and what slivers leave."""

from __future__ import annotations

import json
from fractions import Fraction
from itertools import pairwise

import pytest
import sympy as sp
from flint import fmpq

import navsym as nav
from navsym import checker
from navsym.core.errors import DomainError
from navsym.core.exact import from_decimal
from navsym.guaranteed.phases import narrow as thin
from navsym.guaranteed.phases.boundaries import (
    has_double_contact,
    is_pattern_optimal_near,
    nearby_contacts,
    solve_pattern,
)
from navsym.guaranteed.phases.driver import find_phases
from navsym.guaranteed.phases.family import family_of
from navsym.guaranteed.phases.patterns import PatternInterval
from navsym.guaranteed.phases.singular_values import find_singular_values
from navsym.guaranteed.solver import solve
from navsym.models.modelfile import model_from

STOPPED = {
    "model": {"name": "a body whose spring is hooked at t = 1", "states": ["x", "v"]},
    "piece": [
        {"from": "0", "to": "1", "F": [["0", "1"], ["0", "0"]]},
        {"from": "1", "to": "T", "F": [["0", "1"], ["-1", "0"]]},
    ],
    "parameters": {"T": ["0", "3"]},
    "measurement": [{"name": "position", "h": ["1", "0"], "sigma": "1"}],
    "interval": {"T": "T"},
}

RAMP = {
    "model": {
        "name": "Schuler oscillator with a ramp",
        "states": ["v", "phi", "e", "r"],
        "F": [["0", "-1", "0", "0"], ["1", "0", "1", "0"], ["0", "0", "0", "1"], ["0", "0", "0", "0"]],
    },
    "parameters": {"T": ["0", "7"]},
    "measurement": [{"name": "velocity", "h": ["1", "0", "0", "0"], "sigma": "1"}],
    "interval": {"T": "T"},
}


def accepted(answer):
    return {checker.check(checker.load(json.dumps(c))) for c in answer.certificates()}


def test_before_the_switch_the_family_is_that_of_the_first_piece():
    family = family_of(model_from(STOPPED), "v", "T")
    first, second = family.chain
    assert first.growing and not second.growing and second.least == 1
    half = sp.Rational(1, 2)
    assert first.problem(half).exact().panels[0].functions == (1, -sp.Symbol("u", real=True))
    assert len(second.problem(2).exact().panels) == 2


def test_a_switch_inside_the_interval_splits_the_range_and_each_part_has_its_own_closed_form():
    answer = find_phases(family_of(model_from(STOPPED), "x", "T"), sp.Rational(1, 2), sp.Integer(2))
    first, second = answer.regimes
    assert (first.upper, second.lower) == (1, 1) and first.closed.value == second.closed.value == 1
    (edge,) = answer.boundaries
    assert edge.at == 1 and "a piece of the interval has no length" in edge.why
    assert answer.uncovered == ()


@pytest.fixture(scope="module")
def stopped():
    """All regimes of the velocity of a body that stops."""
    return find_phases(family_of(model_from(STOPPED), "v", "T"), sp.Integer(0), sp.Integer(3))


@pytest.mark.long
def test_a_regime_in_pieces_agrees_with_single_values(stopped):
    family, regime = stopped.family, stopped.regimes[1]
    assert regime.status.holds and regime.closed is not None
    for T in (sp.Rational(5, 4), sp.Rational(11, 8)):
        assert regime.lower < T < regime.upper
        found, value = solve(family.problem(T), digits=12), regime.closed.value.subs(family.parameter, T).evalf(30)
        assert sp.Rational(found.lower) <= sp.Rational(str(value)) <= sp.Rational(found.upper)


@pytest.mark.long
def test_a_contact_at_the_switch_stands_in_one_stretch_and_every_regime_has_its_closed_form(stopped):
    answer = stopped
    assert answer.uncovered == () and all(regime.status.holds for regime in answer.regimes)
    assert [b.at for b in answer.boundaries] == [1, 1 + sp.pi / 4, 1 + sp.pi / 2]
    T = answer.family.parameter
    first, _, third, last = (regime.closed.value for regime in answer.regimes)
    assert (first, third, last) == (2 / T, sp.sin(T - 1), 1)


def test_a_length_that_only_depends_on_the_parameter_is_refused_where_F_comes_in_pieces():
    document = json.loads(json.dumps(STOPPED))
    document["interval"]["T"] = document["piece"][1]["to"] = "2*T"
    with pytest.raises(DomainError, match="the length T itself"):
        family_of(model_from(document), "v", "T")


def test_an_F_that_depends_on_the_time_is_refused_with_the_reason():
    document = json.loads(json.dumps(STOPPED))
    del document["piece"]
    document["model"]["F"] = [["0", "1+t"], ["0", "0"]]
    with pytest.raises(DomainError, match="no contact is exact"):
        family_of(model_from(document), "v", "T")


# -- next to a full period the contacts of the ramp merge at the ends -------------------------------


def test_a_pattern_is_proved_next_to_the_value_where_its_contacts_merge():
    """On [-T/2, T/2] the ramp t is approximated by k sin t; past 2 pi the contacts next to either end merge with it."""
    family = family_of(model_from(RAMP), "r", "T")
    pattern = ((0, "from", -1), (0, "no", -1), (0, "no", 1), (0, "to", 1))
    span = PatternInterval(Fraction("6.28319"), Fraction(7), pattern)
    root = sp.Rational(str(sp.N(2 * sp.pi, 60)))
    T = sp.Rational(round((root + sp.Rational(1, 10**32)) * 10**40), 10**40)
    assert is_pattern_optimal_near(family, span, T, 1, root)
    assert not is_pattern_optimal_near(family, span, 2 * root - T, 1, root)


def test_past_a_full_period_the_ramp_is_covered_by_slivers_that_the_checker_accepts():
    family = family_of(model_from(RAMP), "r", "T")
    start, end = from_decimal("6.2831853"), from_decimal("6.32")
    made, left = thin.certify_slivers(family, start, end)
    assert left == [] and made[0].start == start and made[-1].end == end
    assert {checker.check(checker.load(json.dumps(dict(s.certificate)))) for s in made} == {"sliver"}
    assert all(a.end == b.start for a, b in pairwise(made))


def test_what_the_attempts_do_not_reach_is_left_in_one_part(monkeypatch):
    monkeypatch.setattr(thin, "MOST_TRIES", 6)
    family = family_of(model_from(RAMP), "r", "T")
    made, left = thin.certify_slivers(family, fmpq(63, 10), fmpq(7))
    assert len(left) == 1 and left[0][1] == 7 and left[0][0] == (made[-1].end if made else fmpq(63, 10))


def test_a_contact_at_a_switch_touches_twice_and_is_not_tried():
    family = family_of(model_from(STOPPED), "v", "T").chain[1]
    span = PatternInterval(Fraction("1.9"), Fraction("2.5"), ((0, "from", -1), (0, "to", -1)))
    contacts, T = next(nearby_contacts(family, span, span.lower, 1))
    assert has_double_contact(family.exact(T), solve_pattern(family, T, span.pattern, contacts, T))


# -- fewer contacts than unknowns ------------------------------------------------------------------


def test_one_contact_that_leaves_the_dual_free_has_a_closed_form_with_three_measurements():
    """The speed is measured: two units for every length. x = (1, 2, 1) keeps all three bounds up to T = 4."""
    document = {
        "model": {"name": "inertial", "states": ["x", "v", "a"], "F": [["0", "1", "0"], ["0", "0", "1"], ["0"] * 3]},
        "parameters": {"T": ["0", "4"]},
        "interval": {"T": "T"},
        "measurement": [
            {"name": "position", "h": ["1", "0", "0"], "sigma": "1"},
            {"name": "velocity", "h": ["0", "1", "0"], "sigma": "2"},
            {"name": "acceleration", "h": ["0", "0", "1"], "sigma": "3"},
        ],
    }
    answer = find_phases(family_of(model_from(document), "v", "T"), sp.Integer(0), sp.Integer(4))
    (regime,) = answer.regimes
    assert regime.status == "PROVED" and regime.closed.value == 2 and answer.uncovered == ()


# -- singular values -------------------------------------------------------------------------------


def reasons(rows, target=None, sigma=None, lower="-1", upper="4", end="1"):
    document = {
        "basis": {"variable": "u", "H": rows, "interval": ["0", end]} | ({"sigma": sigma} if sigma else {}),
        "parameters": {"p": ["-9", "9"]},
        "targets": {"c": target or ["1"] + ["0"] * (len(rows) - 1)},
    }
    found, unknown = find_singular_values(
        family_of(model_from(document), "c", "p"), sp.sympify(lower), sp.sympify(upper)
    )
    return {str(s.at): s.why for s in found}, [str(e) for e in unknown]


def test_only_a_pole_is_called_a_pole():
    assert "a regressor has a pole" in reasons(["1", "u/(p-1)"])[0]["1"]
    assert "become dependent" in reasons(["1", "sin(2*u)", "sin(p*u)"])[0]["2"]
    assert "no length" in reasons(["1", "u"], end="p")[0]["0"]
    assert "expected one that is not zero" in reasons(["1", "u"], target=["p", "0"])[0]["0"]


def test_expressions_without_roots_in_the_range_are_shown_to_have_none_and_others_are_named():
    assert reasons(["1", "exp(exp(p)*u)", "exp(3*u)"], lower="0", upper="1") == ({}, [])
    assert reasons(["1", "exp(exp(p)*u)", "exp(2*u)"], lower="0", upper="1") == ({}, ["exp(p) - 2"])


def test_many_frequencies_are_all_looked_at():
    rows = [f"sin({k}*p*u)" for k in range(1, 7)] + [f"sin({k}*u/5)" for k in range(31, 36)]
    found, unknown = reasons(rows, lower="6", upper="7")
    assert unknown == [] and set(found) == {"31/5", "32/5", "33/5", "34/5", "7"}


@pytest.mark.long
def test_a_guess_whose_divisor_vanishes_is_passed_over():
    model = nav.Model(
        states="y1 y2 y3",
        F=[["0", "-1", "0"], ["0", "0", "1"], ["0", "-1", "0"]],
        H=["y1", "y2"],
        sigma=["1", "1/2"],
        interval="T",
        targets={"m": "y1 + y2 - y3"},
        T=("1", "3"),
    )
    found = nav.phases(model, T=("1", "3"))
    assert not found.uncovered and all(regime.status.holds for regime in found.regimes)
    assert [b.at for b in found.boundaries] == [sp.pi / 2]
