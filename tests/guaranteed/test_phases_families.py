"""Families not chosen to suit the code: lost ranks, critical damping, one contact, many optima, closed boundaries."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction

import pytest
import sympy as sp
from flint import fmpq

from navsym import checker
from navsym.claims import OPEN, PROVED, Verdict
from navsym.core.errors import DomainError
from navsym.core.exact import from_decimal
from navsym.guaranteed.phases.certify_range import covered, follow_regime
from navsym.guaranteed.phases.closed_forms import ClosedForm, prove_closed_form
from navsym.guaranteed.phases.driver import find_phases
from navsym.guaranteed.phases.family import family_of
from navsym.guaranteed.phases.narrow import certify_slivers
from navsym.guaranteed.phases.patterns import sample_contacts
from navsym.guaranteed.phases.recognise import recognise_constant
from navsym.guaranteed.phases.singular_values import exact_real_roots
from navsym.guaranteed.solver import solve
from navsym.models.modelfile import model_from
from navsym.prove.products import as_squares


def basis(H, interval, target, sigma=None):
    """A family of regressors with the parameter p."""
    return {
        "basis": {"variable": "u", "H": H, "interval": interval} | ({"sigma": sigma} if sigma else {}),
        "parameters": {"p": ["-20", "20"]},
        "targets": {"c": target},
    }


def oscillator(damping, sigmas, T="3"):
    """x'' = -x - damping x', position and perhaps velocity measured."""
    rows = (["1", "0"], ["0", "1"])
    return {
        "model": {"name": "oscillator", "states": ["x", "v"], "F": [["0", "1"], ["-1", damping]]},
        "parameters": {"p": ["-20", "20"]},
        "interval": {"T": T},
        "targets": {"c": ["1", "1"], "v": ["0", "1"]},
        "measurement": [{"name": f"z{k}", "h": rows[k], "sigma": s} for k, s in enumerate(sigmas)],
    }


def solved(document, lower, upper, target="c", **options):
    return find_phases(family_of(model_from(document), target, "p"), sp.sympify(lower), sp.sympify(upper), **options)


def regimes(answer):
    assert answer.uncovered == ()
    return [(str(r.lower), str(r.upper), str(r.closed.value)) for r in answer.regimes]


def rotation(h, sigma, target, speed="1"):
    """x' = speed v, v' = -speed x, with the length of the interval as the parameter p."""
    turn = [["0", speed], [f"-{speed}", "0"]]
    measured = [{"name": f"z{k}", "h": row, "sigma": s} for k, (row, s) in enumerate(zip(h, sigma, strict=True))]
    rest = {"parameters": {"p": ["0", "20"]}, "interval": {"T": "p"}, "targets": {"c": target}}
    return {"model": {"name": "rotation", "states": ["x", "v"], "F": turn}, "measurement": measured} | rest


@pytest.mark.long
def test_a_touch_at_an_irrational_angle_is_proved_and_not_only_sampled():
    document = rotation([["1", "0"], ["0", "1"]], ["1", "3"], ["2", "1"])
    (found,) = solved(document, sp.Rational(1, 2), sp.Rational(13, 20)).regimes
    assert found.closed.value == 2 + 2 * sp.sqrt(2) and found.status.holds
    known = solve(family_of(model_from(document), "c", "p").problem(sp.Rational(3, 5)), digits=20)
    assert float(known.lower) == pytest.approx(float(found.closed.value), rel=1e-15)


@pytest.mark.long
def test_a_constant_value_of_one_measurement_at_an_irrational_time_is_proved():
    answer = solved(rotation([["1", "1/2"]], ["5"], ["2", "2"], speed="2"), 3, sp.Rational(13, 4))
    assert regimes(answer) == [("3", "13/4", "4*sqrt(10)")] and answer.regimes[0].status is PROVED


@pytest.mark.parametrize(("c", "squares"), [("3", True), ("299/100", False), ("301/100", False)])
def test_a_sinusoid_is_a_sum_of_squares_where_it_touches_zero_only(c, squares):
    u = sp.Symbol("u", real=True)
    side = sp.Rational(c) - 2 * sp.sqrt(2) * sp.cos(2 * u) - sp.sin(2 * u)
    form = as_squares(side, u)
    assert (form is not None) is squares
    if squares:
        assert all(abs(sp.N((form - side).subs(u, k), 30)) < 1e-25 for k in range(5))
    assert as_squares(side + u, u) is as_squares(side + sp.cos(u), u) is None


@pytest.mark.parametrize("turns", [-2, -1, 1, 3])
def test_places_beyond_a_half_turn_are_recognised(turns):
    exact = turns * sp.pi - sp.atan(sp.sqrt(10) - 3)
    found = recognise_constant(sp.Rational(str(exact.evalf(90))))
    assert abs(sp.N(found - exact, 60)) < 1e-50


def test_where_estimability_is_lost_inside_the_range_it_is_split_and_said_so():
    answer = solved(basis(["1", "p*u"], ["0", "1"], ["0", "1"]), -1, 1)
    assert regimes(answer) == [("-1", "0", "-2/p"), ("0", "1", "2/p")]
    (edge,) = answer.boundaries
    assert edge.at == 0 and "dependent" in edge.why


@pytest.mark.long
def test_a_range_below_zero_is_proved_like_its_mirror():
    answer = solved(basis(["1", "(1-exp(-p*u))/p"], ["0", "2"], ["0", "1"]), -1, 1)
    assert answer.uncovered == () and {r.status.holds for r in answer.regimes} == {True}
    assert all(r.closed is not None for r in answer.regimes) and [b.at for b in answer.boundaries] == [0]


def test_the_value_of_a_parabola_is_measured_inside_and_extrapolated_outside():
    answer = solved(basis(["1", "u", "u**2"], ["0", "1"], ["1", "p", "p**2"]), -1, 2)
    outside = "8*p**2 - 8*p + 1"
    assert regimes(answer) == [("-1", "0", outside), ("0", "1", "1"), ("1", "2", outside)]
    assert answer.regimes[1].closed.places == (answer.family.parameter,)


def test_a_contact_with_a_weight_of_rounding_is_none():
    answer = solved(basis(["1", "u", "u**2"], ["-p", "1"], ["1", "0", "0"]), 0, 2)
    assert regimes(answer) == [("0", "2", "1")] and answer.boundaries == ()


def test_a_contact_has_the_sign_of_the_dual_polynomial():
    family = family_of(model_from(oscillator("0", ("1+p**2", "2-p"), "2")), "c", "p")
    _, found = sample_contacts(family, Fraction("0.578"))
    assert found.panel.tolist() == [1] and found.sign.tolist() == [1]


@pytest.mark.long
def test_both_sides_of_a_boundary_are_tried_before_it_is_given_up():
    answer = solved(oscillator("0", ("1+p**2", "2-p"), "2"), "2/5", "3/5")
    assert len(answer.boundaries) == 2 and all(b.proved for b in answer.boundaries) and answer.uncovered == ()


def test_slivers_where_a_noise_bound_moves_are_accepted():
    family = family_of(model_from(oscillator("0", ("1+p**2", "2-p"), "2")), "c", "p")
    made, left = certify_slivers(family, from_decimal("0.506604"), from_decimal("0.506606"))
    assert left == [] and {checker.check(checker.load(json.dumps(dict(s.certificate)))) for s in made} == {"sliver"}


def test_a_dual_that_two_contacts_leave_free_is_held_at_an_end_of_the_other_measurement():
    """Two velocities give the acceleration while they are the better ones: up to sigma = 4 for two seconds."""
    triple = {
        "model": {"name": "triple", "states": ["x", "v", "a"], "F": [["0", "1", "0"], ["0", "0", "1"], ["0"] * 3]},
        "parameters": {"p": ["1/10", "10"]},
        "interval": {"T": "2"},
        "targets": {"c": ["0", "0", "1"]},
        "measurement": [
            {"name": "position", "h": ["1", "0", "0"], "sigma": "1"},
            {"name": "velocity", "h": ["0", "1", "0"], "sigma": "p"},
        ],
    }
    answer = solved(triple, "1/10", 10)
    assert regimes(answer) == [("1/10", "4", "p"), ("4", "10", "4")]


@pytest.mark.long
def test_where_many_are_optimal_the_closed_form_next_to_it_is_continued():
    triple = {
        "model": {"name": "triple", "states": ["x", "v", "a"], "F": [["0", "1", "0"], ["0", "0", "1"], ["0"] * 3]},
        "parameters": {"p": ["-9", "9"]},
        "interval": {"T": "1"},
        "targets": {"c": ["1-p", "p", "1"]},
        "measurement": [{"name": "position", "h": ["1", "0", "0"], "sigma": "1"}],
    }
    answer = solved(triple, -3, -2)
    assert [str(b.at) for b in answer.boundaries] == ["-sqrt(3) - 1"]
    assert regimes(answer)[1] == ("-sqrt(3) - 1", "-2", "1 - p")
    assert answer.regimes[1].closed.places == (0, -2 / answer.family.parameter)


@pytest.mark.slow
def test_beyond_critical_damping_sines_become_hyperbolic():
    answer = solved(oscillator("-p", ("1",)), "9/4", "5/2", "v")
    assert answer.uncovered == () and all(r.status.holds for r in answer.regimes)


def test_beyond_critical_damping_no_regressor_is_imaginary():
    family = family_of(model_from(oscillator("-p", ("1",))), "v", "p")
    beyond = family.real_near(sp.Rational(5, 2))
    assert family.real_near(1) is family
    assert not any(h.has(sp.I) for row in beyond.rows for h in row) and any(h.has(sp.sinh) for h in beyond.rows[0])
    place = {
        family.parameter: sp.Rational(5, 2),
        **{s: sp.Rational(1, 3) for s in beyond.rows[0][0].free_symbols if s != family.parameter},
    }
    for one, other in zip(family.rows[0], beyond.rows[0], strict=True):
        assert abs(sp.N(one.subs(place) - other.subs(place), 30)) < 1e-25


def test_a_closed_form_that_is_followed_is_proved_to_be_the_only_optimum():
    answer = solved(basis(["1", "u", "u**2"], ["0", "p"], ["0", "1", "0"]), 1, 2, unique=True)
    (row,) = answer.document()["regimes"]
    assert row["status"] == "PROVED" and row["unique"] is True and row["unique_between"] == ["1", "2"]
    assert {checker.check(checker.load(json.dumps(c))) for c in answer.certificates()} <= {"all", "range"}


@pytest.mark.parametrize(
    "text", ["3-pi/2", "-1+sqrt(2)", "1/2+sqrt(5)/2", "log(3/2)", "log(1+sqrt(2))", "1/3+sqrt(11)", "2*pi/7", "0"]
)
def test_constants_with_short_coefficients_are_recognised(text):
    value = sp.sympify(text)
    assert sp.simplify(recognise_constant(sp.Rational(str(sp.N(value, 60)))) - value) == 0


def test_a_number_without_a_short_form_is_not_recognised():
    assert recognise_constant(sp.Rational(str(sp.N(sp.E * sp.sqrt(3), 60)))) is None


def test_roots_with_one_square_root_are_found():
    p = sp.Symbol("p", real=True)
    assert set(exact_real_roots(sp.sqrt(4 - p**2) / 2, p)) == {2, -2}
    assert exact_real_roots(p / 2 - sp.sqrt(4 - p**2) / 2, p) == [sp.sqrt(2)]


def test_a_closed_form_that_divides_by_zero_inside_its_range_is_not_proved():
    """2 (p - 2)/(p (p - 2)) is 2/p but for p = 2, where it is nothing."""
    family = family_of(model_from(basis(["1", "u"], ["0", "p"], ["0", "1"])), "c", "p")
    p = family.parameter
    guess = ClosedForm((0, 0), (sp.S.Zero, p), (-1 / p, 1 / p), (sp.S.NegativeOne, 2 / p), 2 / p, Verdict(OPEN, "none"))
    holed = sp.Mul(2 * (p - 2), 1 / p, 1 / (p - 2), evaluate=False)
    for value, status in ((2 / p, PROVED), (holed, OPEN)):
        found = prove_closed_form(family, [replace(guess, value=value)], sp.S.One, sp.Integer(3))
        assert found is not None and found.verdict.status is status


def test_an_unknown_of_the_dual_that_is_zero_throughout_does_not_stop_the_contacts_from_being_followed():
    H = ["a*cos(u)+sin(u)", "cos(u)-a*sin(u)"]
    document = {
        "basis": {"variable": "u", "H": H, "interval": ["0", "3"]},
        "parameters": {"a": ["-2", "2"]},
        "targets": {"c": ["1", "0"]},
    }
    family = family_of(model_from(document), "c", "a")
    found = follow_regime(family, ((0, "no", 1),), fmpq(-2), fmpq(2))
    assert covered(found.pieces) == [(-2, 2)]
    assert [checker.check(checker.load(json.dumps(one))) for one in found.documents] == ["range"]


def test_eigenvalues_without_a_closed_form_are_refused_in_words_of_the_model():
    F = [["0", "1", "0"], ["0", "0", "1"], ["-1", "-p", "-2"]]
    document = {
        "model": {"name": "cubic", "states": ["x", "v", "w"], "F": F},
        "parameters": {"p": ["1", "2"]},
        "interval": {"T": "2"},
        "targets": {"c": ["0", "1", "0"]},
        "measurement": [{"name": "z", "h": ["1", "0", "0"], "sigma": "1"}],
    }
    with pytest.raises(DomainError, match=r"F: expected eigenvalues with a closed form.*solve for single values"):
        family_of(model_from(document), "c", "p")
