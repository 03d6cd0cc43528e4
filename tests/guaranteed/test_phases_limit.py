"""Work that exceeds its limit returns what is known; ranges in which a root is imaginary; lengths from zero on."""

from __future__ import annotations

import json
import time
from types import SimpleNamespace

import pytest
import sympy as sp
from flint import fmpq

from navsym import checker
from navsym.core.errors import DomainError
from navsym.core.exact import to_rational
from navsym.guaranteed.phases import budget as limits
from navsym.guaranteed.phases import certify_range as range_
from navsym.guaranteed.phases.budget import Budget
from navsym.guaranteed.phases.certify_range import covered, echelon_form, group_pieces
from navsym.guaranteed.phases.driver import find_phases
from navsym.guaranteed.phases.family import family_of
from navsym.models.modelfile import model_from
from tests.guaranteed.phases_cover import followed_pieces, gaps


def basis(H, interval, target, parameter="p", sigma=None):
    return {
        "basis": {"variable": "u", "H": H, "interval": interval} | ({"sigma": sigma} if sigma else {}),
        "parameters": {parameter: ["-20", "20"]},
        "targets": {"c": target},
    }


def solved(document, lower, upper, parameter="p", **options):
    family = family_of(model_from(document), "c", parameter)
    return find_phases(family, sp.sympify(lower), sp.sympify(upper), **options)


def accepted(answer):
    return {checker.check(checker.load(json.dumps(c))) for c in answer.certificates()}


HARD = basis(["1", "u", "exp(-u)", "sin(u)"], ["0", "T"], ["0", "0", "1", "0"], "T")


class Clock:
    """Processor time that goes on by the same step whenever somebody looks, on every machine."""

    def __init__(self, step: float):
        self.now, self.step = 0.0, step

    def __call__(self) -> float:
        self.now += self.step
        return self.now


def test_work_beyond_its_limit_ends_with_what_is_known_and_names_the_rest(monkeypatch):
    monkeypatch.setattr(limits, "processor_seconds", Clock(0.12))
    answer = solved(HARD, 0, 5, "T", seconds=20.0)
    document = answer.document()
    assert document["uncovered"] and any("limit of work" in what for what in document["given_up"])
    assert {row["status"] for row in document["regimes"]} <= {"CERTIFIED", "PROVED", "OPEN"}
    assert accepted(answer) <= {"range", "sliver", "all"}


def test_a_search_that_meets_its_limit_leaves_the_rest_of_the_range(monkeypatch):
    monkeypatch.setattr(limits, "processor_seconds", Clock(0.5))
    answer = solved(HARD, 1, 2, "T", seconds=20.0, certify=False)
    assert any(what.startswith("the search for patterns") for what in answer.given_up)
    assert answer.uncovered[-1][1] == "2"


def test_with_next_to_no_time_all_of_the_range_is_uncovered(monkeypatch):
    monkeypatch.setattr(limits, "processor_seconds", Clock(1.0))
    answer = solved(HARD, 1, 2, "T", seconds=0.5)
    assert answer.given_up and answer.document()["uncovered"] == [["1", "2"]]


@pytest.mark.parametrize("seconds", [0.0, -1.0, float("nan"), float("inf")])
def test_a_limit_that_is_no_time_is_refused(seconds):
    with pytest.raises(DomainError, match="seconds"):
        solved(HARD, 1, 2, "T", seconds=seconds)


def test_a_step_that_does_not_end_is_stopped_and_written_down():
    limit = Budget.of(0.5)
    assert limit.within("sleeping", time.sleep, 0) is None and limit.given_up == []
    assert limit.within("turning", turning) is None
    assert limit.given_up[0].startswith("turning: ") and limit.share(0.5).given_up is limit.given_up


def turning():
    while True:
        pass


def test_where_a_root_is_imaginary_the_range_is_split_and_said_so():
    answer = solved(basis(["1", "u*sqrt(p)"], ["0", "1"], ["0", "1"]), -1, 1)
    (regime,) = answer.regimes
    assert (regime.lower, regime.upper, str(regime.closed.value)) == (0, 1, "2/sqrt(p)")
    assert answer.uncovered == (("-1", "0"),)
    assert "sqrt(p) is imaginary for p from -1 to 0" in answer.boundaries[0].why


def test_a_root_that_is_imaginary_on_the_whole_range_is_named_as_it_stands_in_the_file():
    with pytest.raises(DomainError, match=r"sqrt\(p - 2\) is imaginary for p from -1 to 1.*give a range"):
        solved(basis(["1", "u"], ["0", "1"], ["0", "1"], sigma=["sqrt(p-2)"]), -1, 1)


@pytest.mark.parametrize(
    "H",
    [
        pytest.param(["1", "u", "1/(1+u)"], marks=pytest.mark.long),
        pytest.param(["1", "sinh(u)", "cosh(u)"], marks=pytest.mark.long),
        pytest.param(["1", "u", "exp(u)/(2+u)"], marks=pytest.mark.long),
    ],
)
def test_hyperbolic_functions_and_quotients_have_a_scaled_form_from_length_zero_on(H):
    target = ["0", "1"] + ["0"] * (len(H) - 2)
    answer = solved(basis(H, ["0", "T"], target, "T"), 0, sp.Rational(1, 8), "T")
    assert answer.uncovered == () and accepted(answer) <= {"all", "range", "sliver"}


@pytest.mark.parametrize(
    ("h", "scaled"), [("1/u", False), ("log(1+u)", False), ("1/(1+u)", True), ("sinh(u)", True), ("exp(u)/(2+u)", True)]
)
def test_a_pole_at_zero_or_another_function_has_no_scaled_form(h, scaled):
    family = family_of(model_from(basis(["1", h], ["0", "T"], ["1", "0"], "T")), "c", "T")
    assert (echelon_form(family) is not None) == scaled


@pytest.mark.long
@pytest.mark.parametrize("seconds", [300.0, 12.0])
def test_between_the_pieces_from_zero_on_and_those_from_the_middle_nothing_is_lost(monkeypatch, seconds):
    found = range_.follow_pattern
    monkeypatch.setattr(range_, "follow_pattern", lambda *these: found(*these)[1:])
    monkeypatch.setattr(limits, "processor_seconds", Clock(0.1))
    answer = solved(basis(["1", "u", "exp(-u)"], ["0", "T"], ["0", "0", "1"], "T"), 0, 1, "T", seconds=seconds)
    pieces = followed_pieces(answer)
    slivers = [(to_rational(s.start), to_rational(s.end)) for regime in answer.regimes for s in regime.slivers]
    assert gaps(pieces, 0, answer.upper) and gaps([*pieces, *slivers, *answer.uncovered], 0, 1) == []
    for regime in answer.regimes:
        assert gaps([*pieces, *slivers], regime.lower, regime.upper) == []
        assert regime.alone is None or gaps(pieces, *map(to_rational, regime.alone)) == []
    assert any(regime.alone for regime in answer.regimes)
    assert accepted(answer) <= {"all", "range", "sliver"}


def test_pieces_with_a_gap_between_them_have_certificates_of_their_own():
    one, two, three = (SimpleNamespace(lower=fmpq(k), upper=fmpq(k + 1), cells=7) for k in (0, 1, 5))
    assert group_pieces([one, two, three]) == [[one, two], [three]] and covered([one, two, three]) == [(0, 2), (5, 6)]
