"""Regimes of the guaranteed optimum: complete, exact boundaries, closed forms proved."""

from __future__ import annotations

import json

import pytest
import sympy as sp

from navsym import checker
from navsym.errors import DomainError
from navsym.methods.phases import phases
from navsym.methods.phases_family import family_of
from navsym.text.modelfile import model_from
from tests.methods.test_guaranteed import VELOCITY

POSITION = {
    "model": {
        "name": "position", "states": ["x", "y1", "y2", "y3"],
        "F": [["0", "1", "0", "0"], ["0", "0", "-1", "0"], ["0", "0", "0", "1"], ["0", "0", "-1", "0"]],
    },
    "parameters": {"T": ["0", "2*pi"]},
    "measurement": [{"name": "position", "h": ["1", "0", "0", "0"], "sigma": "1"}],
    "interval": {"T": "T"},
}  # fmt: skip


def family(document, target):
    return family_of(model_from(document), target, "T")


def monomials(degree):
    rows = ["1"] + [f"s**{k}" for k in range(1, degree + 1)]
    return {"basis": {"variable": "s", "H": rows, "interval": ["0", "T"]}, "parameters": {"T": ["0", "10"]}}


@pytest.mark.parametrize(
    ("state", "ends"),
    [
        ("y1", []),
        ("y2", ["4*pi/3", "3*pi/2"]),
        ("y3", ["2*pi/3", "pi"]),
    ],
)
def test_the_velocity_problem_is_proved_up_to_a_full_period(state, ends):
    answer = phases(family(VELOCITY, state), sp.Integer(0), 2 * sp.pi)
    document = answer.document()
    assert [b["at"] for b in document["boundaries"]] == ends
    assert {row["status"] for row in document["regimes"]} == {"PROVED"}
    assert document["uncovered"] == []
    for b in document["boundaries"]:
        exact = sp.sympify(b["at"]).evalf(50)
        assert sp.Rational(b["lower"]) < sp.Rational(str(exact)) < sp.Rational(b["upper"])


@pytest.mark.parametrize("k", [1, 2, 4])
def test_monomials_have_one_regime_with_shifted_chebyshev_polynomials(k):
    answer = phases(family(monomials(4), f"c{k}"), sp.Integer(0), sp.Integer(4))
    (regime,) = answer.regimes
    s = sp.Symbol("s")
    shifted = sp.Poly(sp.chebyshevt(4, 2 * s - 1), s).coeff_monomial(s**k)
    assert regime.status == "PROVED"
    assert sp.simplify(regime.closed.value * answer.family.parameter**k) == abs(shifted)


@pytest.mark.slow
def test_a_regime_without_a_closed_form_is_certified_for_every_length():
    answer = phases(family(POSITION, "y1"), sp.Integer(2), sp.Rational(5, 2))
    (regime,) = answer.regimes
    assert regime.status == "CERTIFIED" and regime.closed is None
    (certificate,) = answer.certificates()
    assert checker.check(checker.load(json.dumps(certificate))) == "range"
    assert answer.uncovered == ()


def test_a_parameter_that_is_not_the_length_is_refused():
    with pytest.raises(DomainError, match="ends at the parameter"):
        family_of(model_from(VELOCITY), "y1", "w")
    with pytest.raises(DomainError, match="0 <= from < to"):
        phases(family(VELOCITY, "y1"), sp.Integer(2), sp.Integer(1))
