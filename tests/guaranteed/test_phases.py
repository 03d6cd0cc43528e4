"""Regimes of the guaranteed optimum: complete, exact boundaries, closed forms proved."""

from __future__ import annotations

import json
from fractions import Fraction

import pytest
import sympy as sp

import navsym as nav
from navsym import checker
from navsym.claims import CERTIFIED
from navsym.core.errors import DomainError, NotEstimableError
from navsym.guaranteed.certificate.basis import make_basis
from navsym.guaranteed.phases import boundaries as events
from navsym.guaranteed.phases import driver as changes
from navsym.guaranteed.phases.driver import find_phases
from navsym.guaranteed.phases.family import family_of
from navsym.guaranteed.phases.patterns import scan_patterns
from navsym.models.modelfile import model_from
from tests.guaranteed.phases_cover import lost
from tests.guaranteed.test_solver import VELOCITY

POSITION = {
    "model": {
        "name": "position",
        "states": ["x", "y1", "y2", "y3"],
        "F": [["0", "1", "0", "0"], ["0", "0", "-1", "0"], ["0", "0", "0", "1"], ["0", "0", "-1", "0"]],
    },
    "parameters": {"T": ["0", "2*pi"]},
    "measurement": [{"name": "position", "h": ["1", "0", "0", "0"], "sigma": "1"}],
    "interval": {"T": "T"},
}


def family(document, target):
    return family_of(model_from(document), target, "T")


def monomials(degree):
    rows = ["1"] + [f"s**{k}" for k in range(1, degree + 1)]
    return {"basis": {"variable": "s", "H": rows, "interval": ["0", "T"]}, "parameters": {"T": ["0", "10"]}}


@pytest.mark.long
@pytest.mark.parametrize(("state", "ends"), [("y1", []), ("y2", ["4*pi/3", "3*pi/2"]), ("y3", ["2*pi/3", "pi"])])
def test_the_velocity_problem_is_proved_up_to_a_full_period(state, ends):
    answer = find_phases(family(VELOCITY, state), sp.Integer(0), 2 * sp.pi)
    document = answer.document()
    assert [b["at"] for b in document["boundaries"]] == ends
    assert {row["status"] for row in document["regimes"]} == {"PROVED"}
    assert document["uncovered"] == []
    for b in document["boundaries"]:
        exact = sp.sympify(b["at"]).evalf(50)
        assert sp.Rational(b["lower"]) < sp.Rational(str(exact)) < sp.Rational(b["upper"])


@pytest.mark.parametrize("k", [1, 2, 4])
def test_monomials_have_one_regime_with_shifted_chebyshev_polynomials(k):
    answer = find_phases(family(monomials(4), f"c{k}"), sp.Integer(0), sp.Integer(4))
    (regime,) = answer.regimes
    s = sp.Symbol("s")
    shifted = sp.Poly(sp.chebyshevt(4, 2 * s - 1), s).coeff_monomial(s**k)
    assert regime.status == "PROVED"
    assert sp.simplify(regime.closed.value * answer.family.parameter**k) == abs(shifted)


def accepted(answer):
    return [checker.check(checker.load(json.dumps(c))) for c in answer.certificates()]


def test_a_regime_without_a_closed_form_is_certified_for_every_length():
    answer = find_phases(family(POSITION, "y1"), sp.Integer(2), sp.Rational(5, 2))
    (regime,) = answer.regimes
    assert regime.status == "CERTIFIED" and regime.closed is None
    assert accepted(answer) == ["all"]
    assert answer.uncovered == ()


@pytest.mark.slow
def test_position_alone_is_certified_for_every_length_from_zero_to_a_full_period():
    answer = find_phases(family(POSITION, "y3"), sp.Integer(0), 2 * sp.pi)
    assert answer.uncovered == () and lost(answer) == [] and len(answer.regimes) == 5
    assert {regime.status for regime in answer.regimes} == {"CERTIFIED"}
    assert all(float(sp.Rational(b.upper) - sp.Rational(b.lower)) < 1e-30 for b in answer.boundaries)
    assert set(accepted(answer)) == {"all", "sliver"}


def test_the_range_certificate_of_another_functional_is_refused():
    answer = find_phases(family(POSITION, "y1"), sp.Integer(2), sp.Rational(9, 4))
    (certificate,) = json.loads(json.dumps(answer.certificates()))
    certificate["of"][0]["functional"] = ["0", "0", "0", "1"]
    with pytest.raises(checker.Refused):
        checker.check(certificate)


SCHULER = {
    "model": {
        "name": "Schuler oscillator",
        "states": ["v", "phi", "drift"],
        "F": [["0", "-1", "0"], ["w**2", "0", "1"], ["0", "0", "0"]],
    },
    "parameters": {"w": ["1/2", "2"], "Tf": ["0", "7"], "s": ["1/10", "10"]},
    "measurement": [
        {"name": "velocity", "h": ["1", "0", "0"], "sigma": "1"},
        {"name": "tilt", "h": ["0", "1", "0"], "sigma": "s"},
    ],
    "interval": {"T": "Tf"},
}


@pytest.mark.long
def test_the_frequency_is_a_parameter_like_any_other():
    document = json.loads(json.dumps(SCHULER))
    del document["measurement"][1], document["parameters"]["s"]
    found = model_from(document, values={"Tf": "2"})
    answer = find_phases(family_of(found, "drift", "w"), sp.Rational(1, 2), sp.Integer(2))
    assert answer.uncovered == ()
    assert {regime.status for regime in answer.regimes} <= {"PROVED", "CERTIFIED"}
    assert set(accepted(answer)) <= {"all", "range", "sliver"}


@pytest.mark.long
def test_the_ratio_of_two_noise_bounds_is_a_parameter():
    found = model_from(SCHULER, values={"Tf": "2", "w": "1"})
    answer = find_phases(family_of(found, "drift", "s"), sp.Rational(1, 10), sp.Integer(4))
    assert answer.uncovered == ()
    assert set(accepted(answer)) <= {"all", "range", "sliver"}


@pytest.mark.long
def test_of_several_optimal_estimators_a_regime_keeps_one():
    document = {
        "model": {"name": "oscillator", "states": ["x", "v"], "F": [["0", "1"], ["-w**2", "0"]]},
        "parameters": {"w": ["1/2", "3"]},
        "measurement": [{"name": "position", "h": ["1", "0"], "sigma": "1"}],
        "interval": {"T": "2"},
    }
    answer = find_phases(family_of(model_from(document), "v", "w"), sp.Rational(1, 2), sp.Integer(3))
    first, second = answer.regimes
    assert answer.uncovered == () and first.upper == sp.pi / 4
    assert second.closed.value == answer.family.parameter and second.status.holds


def test_a_measurement_of_the_target_itself_is_enough_while_it_is_the_better_one():
    document = {
        "model": {"name": "double integrator", "states": ["x", "v"], "F": [["0", "1"], ["0", "0"]]},
        "parameters": {"q": ["1/10", "5"]},
        "measurement": [
            {"name": "position", "h": ["1", "0"], "sigma": "1"},
            {"name": "velocity", "h": ["0", "1"], "sigma": "q"},
        ],
        "interval": {"T": "2"},
    }
    answer = find_phases(family_of(model_from(document), "v", "q"), sp.Rational(1, 10), sp.Integer(5))
    first, second = answer.regimes
    assert answer.uncovered == () and first.closed.value == answer.family.parameter and second.closed.value == 1
    (edge,) = answer.boundaries
    assert sp.Rational(edge.lower) < 1 < sp.Rational(edge.upper)


def test_the_length_may_have_any_name():
    found = model_from(SCHULER, values={"w": "1", "s": "5"})
    answer = find_phases(family_of(found, "v", "Tf"), sp.Integer(0), sp.Integer(1))
    assert answer.family.growing and answer.uncovered == ()


def test_a_range_with_a_singular_value_is_split_there():
    document = {
        "basis": {"variable": "u", "H": ["1", "sin(2*u)", "sin(p*u)"], "interval": ["0", "1"]},
        "parameters": {"p": ["1", "3"]},
        "targets": {"c": ["1", "0", "0"]},
    }
    answer = find_phases(family_of(model_from(document), "c", "p"), sp.Integer(1), sp.Integer(3))
    (split,) = [b for b in answer.boundaries if b.at == 2]
    assert "dependent" in split.why


def test_an_unknown_that_depends_on_the_others_is_left_out_with_a_certificate():
    document = {
        "basis": {"variable": "u", "H": ["1", "u", "1+2*u"], "interval": ["0", "T"]},
        "parameters": {"T": ["0", "4"]},
        "targets": {"seen": ["0", "1", "2"], "hidden": ["0", "1", "1"]},
    }
    answer = find_phases(family_of(model_from(document), "seen", "T"), sp.Integer(0), sp.Integer(4))
    assert {regime.status for regime in answer.regimes} == {"PROVED"} and answer.uncovered == ()
    (row,) = answer.document()["regimes"]
    assert len(row["dual"]) == 3 and row["dual"][2] == "0"
    assert accepted(answer) == ["all", "identity", "identity"]
    with pytest.raises(NotEstimableError):
        find_phases(family_of(model_from(document), "hidden", "T"), sp.Integer(0), sp.Integer(4))


def test_a_parameter_that_the_file_does_not_have_is_refused():
    with pytest.raises(DomainError, match="a parameter of the file"):
        family_of(model_from(VELOCITY), "y1", "w")
    with pytest.raises(DomainError, match="from < to"):
        find_phases(family(VELOCITY, "y1"), sp.Integer(2), sp.Integer(1))
    with pytest.raises(DomainError, match="lengths"):
        find_phases(family(VELOCITY, "y1"), sp.Integer(-1), sp.Integer(1))


@pytest.mark.long
def test_a_change_at_zero_is_found_and_the_mirrored_regime_has_its_closed_form():
    document = {
        "model": {"name": "triple", "states": ["x", "v", "a"], "F": [["0", "1", "0"], ["0", "0", "1"], ["0"] * 3]},
        "parameters": {"k": ["-3", "3"]},
        "measurement": [{"name": "position", "h": ["1", "0", "0"], "sigma": "1"}],
        "interval": {"T": "1"},
        "targets": {"c": ["1", "k", "0"]},
    }
    answer = find_phases(family_of(model_from(document), "c", "k"), sp.Integer(-3), sp.Integer(3))
    k = answer.family.parameter
    assert [b.at for b in answer.boundaries] == [sp.Rational(-1, 3), 0] and answer.uncovered == ()
    assert sp.expand(answer.regimes[0].closed.value) == -8 * k - 1 and answer.regimes[1].status == "CERTIFIED"
    assert sp.expand(answer.regimes[2].closed.value) == 8 * k + 1 and answer.regimes[2].status == "PROVED"


@pytest.mark.slow
def test_a_boundary_that_is_not_located_is_enclosed_by_what_is_proved_on_both_sides(monkeypatch):
    monkeypatch.setattr(events, "recognise_root", lambda *_: None)
    monkeypatch.setattr(events, "is_pattern_optimal", lambda *_: False)
    monkeypatch.setattr(events, "is_pattern_optimal_near", lambda *_: False)
    answer = find_phases(family_of(model_from(VELOCITY), "y3", "T"), sp.Rational(1), sp.Rational(3))
    (edge,) = answer.boundaries
    assert not edge.proved and "not enclosed" in edge.why
    assert sp.Rational(edge.lower) <= 2 * sp.pi / 3 <= sp.Rational(edge.upper)


@pytest.mark.slow
def test_the_position_measured_model_is_complete_with_four_boundaries_of_thirty_digits():
    document = {
        "model": {
            "name": "position",
            "states": ["y1", "y2", "y3", "x"],
            "F": [["0", "-1", "0", "0"], ["0", "0", "1", "0"], ["0", "-1", "0", "0"], ["1", "0", "0", "0"]],
        },
        "parameters": {"T": ["0", "2*pi"]},
        "interval": {"T": "T"},
        "measurement": [{"name": "position", "h": ["0", "0", "0", "1"], "sigma": "1"}],
    }
    answer = find_phases(family_of(model_from(document), "y3", "T"), sp.Integer(0), 2 * sp.pi)
    assert answer.uncovered == () and lost(answer) == [] and len(answer.boundaries) == 4
    widths = [sp.Rational(b.upper) - sp.Rational(b.lower) for b in answer.boundaries]
    assert all(b.proved for b in answer.boundaries) and max(widths) < sp.Rational(1, 10**29)
    assert set(accepted(answer)) <= {"all", "sliver", "range"}


def test_a_numerator_that_vanishes_with_its_denominator_is_no_zero():
    T = sp.Symbol("T", positive=True)
    assert events.recognise_root((T - 1) / (T**2 - 1), T, 1.0, 0.1) is None
    assert events.recognise_root((T - 1) / (T**2 + 1), T, 1.0, 0.1) == 1


def test_a_pattern_is_followed_to_where_its_weight_at_an_end_vanishes():
    """Three contacts, the first and the last at ends; at T = 2 pi/3 the weight of the first is zero."""
    own = family_of(model_from(VELOCITY), "y3", "T")
    left = scan_patterns(own, Fraction(19, 10), Fraction(23, 10), 6)[0]
    contacts, begin = next(events.nearby_contacts(own, left, left.upper, -1))
    root = sp.Rational(str(sp.N(2 * sp.pi / 3, 60)))
    T = sp.Rational(round((root - sp.Rational(1, 10**20)) * 10**24), 10**24)
    found = events.walk_to(own, events.solve_pattern(own, begin, left.pattern, contacts, begin), begin, root, T)
    assert found.inner == (False, True, False) and [float(v) for v in found.v] == [0, 0.5, 1]
    assert float(found.weights[0]) == pytest.approx(-float((2 * sp.pi / 3 - T) * sp.sqrt(3) / 2), rel=1e-6)
    problem = own.exact(T)
    assert events.certify_touch(problem, make_basis(problem), found, 160, 1600) is not None


@pytest.mark.long
def test_a_change_does_not_rest_on_a_closed_form_that_is_not_proved(monkeypatch):
    monkeypatch.setattr(changes, "prove_form", lambda *_: None)
    answer = find_phases(family(VELOCITY, "y2"), sp.Integer(4), sp.Rational(9, 2))
    (change,) = answer.boundaries
    assert {r.status for r in answer.regimes} == {CERTIFIED}
    assert change.at is None and change.proved
    assert sp.Rational(change.lower) <= 4 * sp.pi / 3 <= sp.Rational(change.upper)


def test_a_closed_form_is_proved_whatever_the_unit_of_the_measurements():
    F = [["0", "1", "0"], ["0", "0", "1"], ["0"] * 3]
    for unit in ("1", "1/1000000000000"):
        h = [f"({unit})*(x + a)"]
        model = nav.Model("x v a", F, h, "1000000", interval="T", targets={"g": "x + v + 2*a"}, T=("0", "20"))
        (regime,) = nav.phases(model, T=("1/2", "4")).regimes
        T = regime.family.parameter
        assert regime.status == nav.PROVED
        assert sp.simplify(regime.value * sp.Rational(unit) * T**2 / (T + 4) ** 2) == 10**6
