"""Observability and derivation by the front door: documents are those of the verbs, errors name the argument."""

from __future__ import annotations

import json

import numpy as np
import pytest
import sympy as sp

import navsym as nav
from navsym.cli.main import run
from navsym.core.errors import DomainError, DuplicateError, NavsymError, ShapeError, UnobservableError
from navsym.models.linear import LinearModel

CHAIN = [[0, 1, 0, 0], [0, 0, "g", 0], [0, 0, 0, 0], [0, 0, 0, 0]]


def drifts(**changes):
    arguments = {"states": "x v b c", "F": CHAIN, "H": ["v + c"], "measurements": "log", "g": "positive"}
    return nav.Model(**{**arguments, **changes})


def two_sensors():
    return drifts(H=["v + c", "x"], measurements="log fix")


def document_of_verb(verb, model, tmp_path, capsys, *options):
    model.save(tmp_path / "model.toml")
    assert run([verb, str(tmp_path / "model.toml"), *options, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def plain(document):
    return json.loads(json.dumps(document))


def test_the_document_is_that_of_the_verb_observe(tmp_path, capsys):
    options = ("--split", "2,2", "--poles", "(p+lam)**2; (p+1)**2", "--restore")
    said = document_of_verb("observe", two_sensors(), tmp_path, capsys, *options)
    asked = {"split": (2, 2), "poles": ["(p + lam)**2", (sp.Symbol("p") + 1) ** 2], "restore": True}
    assert plain(nav.observe(two_sensors(), **asked).document()) == said
    assert said["gains"]["K_x"] == ["2*lam", "lam**2"]


def test_the_document_is_that_of_the_verb_derive(tmp_path, capsys):
    model = drifts(interval="T", T="positive", targets={"drift": "c - b"})
    said = document_of_verb("derive", model, tmp_path, capsys, "--latex")
    assert plain(nav.derive(model).document(latex=True)) == said
    assert "latex" not in nav.derive(model).document()


def test_what_is_unobservable_and_what_restores_it():
    answer = nav.observe(drifts(), restore=True, candidates={"gps": "x + g*c", "second": [0, 2, 0, 2]})
    assert (answer.rank, answer.observable) == (2, False)
    assert answer.unobservable_basis.shape == (2, 4) and len(answer.unobservable) == 2
    assert answer.restoration.sets == (("gps",),) and answer.candidates == ("gps", "second")
    assert nav.observe(drifts()).restoration is None
    assert nav.observe(drifts(), restore=True).candidates == ("x", "v", "b", "c")


def test_values_may_be_put_in_and_other_kinds_of_model_go_in(tmp_path):
    drifts().save(tmp_path / "model.toml")
    g = sp.Symbol("g", positive=True)
    linear = LinearModel([[0, 1], [0, 0]], None, [[g, 0]])
    assert nav.observe(tmp_path / "model.toml", g="1/2").rank == 2
    assert nav.observe(drifts(), values={"g": sp.Rational(1, 2)}).rank == 2
    assert nav.observe(linear).rank == 2
    assert [drop.zeros for drop in nav.observe(linear).rank_drops] == [(g,), (g,)]
    assert nav.derive(nav.Model.from_basis(["1", "s"])).system == ()


@pytest.mark.parametrize(
    ("arguments", "error", "where"),
    [
        ({"g": 0.5}, DomainError, "observe: g"),
        ({"g": -1}, DomainError, "observe: g"),
        ({"q": 1}, NavsymError, "observe: q"),
        ({"g": 1, "values": {"g": 2}}, DuplicateError, "observe: g"),
        ({"split": 3}, NavsymError, "observe: split"),
        ({"split": (1.5, 2)}, NavsymError, "observe: split"),
        ({"poles": 0.5}, DomainError, "observe: poles"),
        ({"poles": "(p + x)**2"}, DuplicateError, "observe: poles"),
        ({"candidates": 3}, ShapeError, "observe: candidates"),
        ({"candidates": {"a": "x*v"}}, DomainError, "observe: candidates.a"),
        ({"candidates": {"a": np.eye(2)}}, NavsymError, "observe: candidates.a[0][0]"),
        ({"candidates": {"a": [1]}}, ShapeError, ""),
        ({"split": (1, 3)}, UnobservableError, ""),
    ],
)
def test_errors_name_the_argument(arguments, error, where):
    with pytest.raises(error) as caught:
        nav.observe(drifts(), **arguments)
    assert caught.value.where == where


@pytest.mark.parametrize("verb", [nav.observe, nav.derive])
@pytest.mark.parametrize("wrong", [3, None, 0.5, sp.eye(2), [[0]], b"model.toml"])
def test_what_is_no_model_is_refused(verb, wrong):
    with pytest.raises(NavsymError) as caught:
        verb(wrong)
    assert caught.value.where == f"{verb.__name__}: model"


def test_regressors_have_nothing_to_observe_and_a_time_that_varies_none_to_derive():
    with pytest.raises(DomainError, match="got a \\[basis\\]"):
        nav.observe(nav.Model.from_basis(["1", "s"]))
    with pytest.raises(DomainError):
        nav.derive(drifts(F=[["t"] * 4] * 4))
    with pytest.raises(DomainError, match="expected a model with F"):
        nav.derive(nav.Model.from_basis(["1", "s"])).Phi  # noqa: B018


def test_answers_show_themselves_and_carry_their_proofs():
    answer, derivation = nav.observe(two_sensors()), nav.derive(two_sensors())
    for shown in (answer, derivation):
        assert "\n" not in repr(shown) and len(repr(shown)) < 200
        assert shown._repr_html_().startswith("<div") and "$" in shown._repr_latex_()
        assert all("kind" in proof for proof in shown.certificates())
    assert [proof["kind"] for proof in derivation.certificates()] == ["exponential", "rank"]
    assert r"\Phi(t)" in derivation.latex() and r"\Theta" in answer.latex() and "<math" in answer.page()
    assert "<script>" not in nav.observe(drifts(name="<script>")).page()
