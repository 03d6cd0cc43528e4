"""nav.solve, nav.phases and nav.formulate: answers agree with the verbs, show themselves, and refuse in words."""

from __future__ import annotations

import json
from dataclasses import FrozenInstanceError, replace
from fractions import Fraction

import pytest
import sympy as sp

import navsym as nav
from navsym.cli.main import run
from navsym.core.numbers import Number
from navsym.guaranteed.problem import from_regressors

VELOCITY = {
    "states": "y1 y2 y3",
    "F": [["0", "-1", "0"], ["0", "0", "1"], ["0", "-1", "0"]],
    "H": [["1", "0", "0"]],
    "interval": "T",
    "T": ("0", "2*pi"),
}


@pytest.fixture(scope="module")
def model():
    return nav.Model(**VELOCITY, measurements=["velocity"], targets={"tilt": "y2", "drift": "y3"})


@pytest.fixture(scope="module")
def estimator(model):
    return nav.solve(model, "drift", T="pi/2")


@pytest.fixture(scope="module")
def regimes(model):
    return nav.phases(model, "drift", T=("5/2", "4"))


def printed(capsys, *words):
    assert run([*words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_the_document_of_an_estimator_is_that_of_the_verb(model, estimator, tmp_path, capsys):
    path = tmp_path / "model.toml"
    model.save(path)
    words = ("solve", str(path), "--target", "drift", "--set", "T=pi/2")
    assert json.loads(json.dumps(estimator.document())) == printed(capsys, *words)


@pytest.mark.long
def test_the_document_of_phases_is_that_of_the_verb(model, regimes, tmp_path, capsys):
    path = tmp_path / "model.toml"
    model.save(path)
    words = ("phases", str(path), "--target", "drift", "--range", "5/2, 4")
    assert json.loads(json.dumps(regimes.document())) == printed(capsys, *words)


def test_the_document_of_a_formulation_is_that_of_the_verb(model, tmp_path, capsys):
    path = tmp_path / "model.toml"
    model.save(path)
    words = ("formulate", str(path), "--target", "tilt", "--set", "T=1", "--grid", "5", "--to", "cvxpy")
    assert nav.formulate(model, "tilt", T=1, grid=5, to="cvxpy").document() == printed(capsys, *words)


def test_certified_numbers_enclose_the_closed_form(estimator):
    half = sp.sqrt(2) / 2
    exact = (2 + 2 * sp.sqrt(2), -1 - half, 1 + sp.sqrt(2), -half)
    for number, expected in zip((estimator.value, *estimator.weights), exact, strict=True):
        assert isinstance(number, Number) and number.digits >= 30
        assert sp.Rational(number.lower) < sp.Rational(str(expected.evalf(60))) < sp.Rational(number.upper)
    assert [point.measurement for point in estimator.support] == ["velocity"] * 3
    assert (estimator.lower, estimator.upper) == (estimator.value.lower, estimator.value.upper)


def test_the_same_answer_comes_from_a_model_a_file_and_a_problem(model, estimator, tmp_path):
    path = tmp_path / "model.toml"
    model.save(path)
    for answer in (nav.solve(path, "drift", T=sp.pi / 2), nav.solve(estimator.problem)):
        assert answer.document() == estimator.document()


def test_phases_at_one_value_are_the_estimator_there(model, regimes):
    here = regimes.at(T=3)
    assert here.document() == nav.solve(model, "drift", T="3").document()
    regime = regimes.regimes[0]
    T = regime.family.parameter
    assert float(here.value) == pytest.approx(float(regime.value.subs(T, 3)), rel=1e-14)
    assert regime.ends == ("5/2", "pi") and len(regime.support) == len(here.support) and len(regime.dual) == 3


def test_answers_are_frozen_and_show_themselves_in_one_line(estimator, regimes):
    for answer in (estimator, regimes, regimes.regimes[0], regimes.boundaries[0], estimator.compare(solvers=[])):
        assert len(repr(answer).splitlines()) == 1 and len(repr(answer)) < 250
        with pytest.raises((FrozenInstanceError, AttributeError, TypeError)):
            answer.status = "PROVED"


def test_tables_in_notebooks_escape_the_names_of_a_problem():
    t = sp.Symbol("t", real=True)
    piece = from_regressors([[1, t]], [0, 1], t, (0, 1))
    problem = replace(piece, measurements=("<b>z</b>",), target="<i>slope</i>")
    shown = nav.solve(problem, digits=8)._repr_html_()
    assert "&lt;b&gt;z" in shown and "&lt;i&gt;slope" in shown and "<b>z" not in shown and "<i>slope" not in shown


@pytest.mark.parametrize(
    ("call", "kind", "where", "words"),
    [
        (lambda m: nav.solve(m, "drift", T=0.5), "domain", "solve: T", '"1/2"'),
        (lambda m: nav.solve(m, "drift"), "domain", "", "got none for T"),
        (lambda m: nav.solve(m, "drift", T=100), "domain", "solve: T", "declared range"),
        (lambda m: nav.solve(m, "drift", q=1), "unknown-symbol", "solve: q", "declared parameter"),
        (lambda m: nav.solve(m, "velocity", T=1), "domain", "solve: target", "name one of tilt, drift"),
        (lambda m: nav.solve(m, T=1), "domain", "solve: target", "expected one target"),
        (lambda m: nav.solve(m, ["drift"], T=1), "domain", "solve: target", "target of the model"),
        (lambda m: nav.solve(m, "drift", T=1, values={"T": 1}), "duplicate", "solve: T", "two of T"),
        (lambda m: nav.solve(m, "drift", T=1, digits=2.5), "domain", "solve: digits", "1 to 1000"),
        (lambda m: nav.solve(3), None, "solve: model", "expected a model"),
        (lambda m: nav.solve("nowhere.toml"), "missing-file", "nowhere.toml", "readable file"),
        (lambda m: nav.phases(m, "drift", T=("1",)), "syntax", "phases: T", "two ends"),
        (lambda m: nav.phases(m, "drift", T=("2", "1")), "domain", "", "from < to"),
        (lambda m: nav.phases(m, "drift", T=(1, 2.0)), "domain", "phases: T", "float 2.0"),
        (lambda m: nav.phases(m, "drift", parameter="w"), "domain", "phases: w", "a range of w"),
        (lambda m: nav.formulate(m, "drift", T=1, to="gams"), "domain", "", "casadi, cvxpy, mps"),
    ],
)
def test_wrong_arguments_are_refused_with_kind_and_place(model, call, kind, where, words):
    with pytest.raises(nav.NavsymError) as caught:
        call(model)
    error = caught.value
    assert kind is None or error.kind == kind
    assert where in error.where and words in error.message


def test_a_value_outside_the_range_of_phases_is_refused(regimes):
    for wrong in ({"T": "1"}, {"w": "3"}, {"T": 3.0}, {}):
        with pytest.raises(nav.NavsymError):
            regimes.at(**wrong)


def test_exact_values_of_every_kind_mean_the_same(model):
    texts = {nav.solve(model, "tilt", T=value, digits=10).lower for value in ("1/2", "0.5", Fraction(1, 2), sp.S.Half)}
    assert len(texts) == 1
