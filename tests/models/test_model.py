"""Models of the front door: arguments become the document of a model file, and errors name the argument."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import navsym as nav
from navsym.core.errors import (
    DomainError,
    EmptyError,
    NavsymError,
    NotFiniteError,
    OutputError,
    ShapeError,
    UnknownSymbolError,
)
from navsym.language.tomlfile import parse_toml, toml_text
from navsym.models.linear import LinearModel
from navsym.models.model import as_model
from navsym.models.modelfile import model_from
from navsym.testing import models

ARGUMENTS = {
    "states": "y1 y2 y3",
    "F": [["0", "-1", "0"], ["0", "0", "1"], ["0", "-1", "0"]],
    "H": [["1", "0", "0"]],
    "sigma": ["1"],
    "interval": "T",
    "targets": {"drift": "y3"},
    "T": ("0", "2*pi"),
}

DOCUMENT = {
    "model": {"name": "model", "states": ["y1", "y2", "y3"], "F": ARGUMENTS["F"]},
    "parameters": {"T": ["0", "2*pi"]},
    "measurement": [{"name": "z1", "h": ["1", "0", "0"], "sigma": "1"}],
    "interval": {"T": "T"},
    "targets": {"drift": ["0", "0", "1"]},
}


def swing(**changes):
    arguments = {"states": "x v", "F": [[0, 1], [0, 0]], "H": [[1, 0]], "interval": 1}
    return nav.Model(**{**arguments, **changes})


def test_arguments_become_the_document_of_a_model_file():
    assert nav.Model(**ARGUMENTS).document() == DOCUMENT


def test_entries_of_every_exact_kind_mean_the_same():
    T = sp.Symbol("T", positive=True)
    others = [
        swing(F=np.array([[0, 1], [0, 0]]), H=np.array([[1, 0]])),
        swing(F=sp.Matrix([[0, 1], [0, 0]]), H=["x"]),
        swing(F=((Fraction(0), Fraction(1)), (0, 0)), H="x", states=["x", "v"]),
    ]
    assert {model for model in others} == {swing()}
    assert swing(interval=T).document()["parameters"] == {"T": "positive"}
    assert swing(F=[[0, T], [0, 0]], interval=T, T=("1", "2")).T.is_positive


def test_a_sign_that_the_algebra_has_used_is_not_taken_back():
    w = sp.Symbol("w", positive=True)
    with pytest.raises(DomainError, match="expected one declaration; got a symbol of sympy that is positive"):
        swing(F=[[0, sp.sqrt(w**2)], [0, 0]], w="real")


@pytest.mark.parametrize(
    ("changes", "error", "where", "message"),
    [
        ({"interval": 0.5}, DomainError, "Model: interval", 'got the float 0.5; write "1/2" or "0.5" as text'),
        ({"F": np.eye(2)}, DomainError, "Model: F[0][0]", "got the float 1.0"),
        ({"H": [[1, float("nan")]]}, NotFiniteError, "Model: H[0][1]", "got nan"),
        ({"sigma": [0.1]}, DomainError, "Model: sigma[0]", 'write "1/10" or "0.1" as text'),
        ({"F": [[sp.Float("0.25"), 1], [0, 0]]}, DomainError, "Model: F[0][0]", '"1/4"'),
        ({"F": [[0, 1]]}, ShapeError, "Model: F", "expected 2 rows"),
        ({"F": None}, EmptyError, "Model: F", "expected the key F"),
        ({"H": None}, EmptyError, "Model: H", "one row per measurement"),
        ({"H": [[1, 0, 0]]}, ShapeError, "Model: H[0]", "expected 2 entries"),
        ({"H": "x*v"}, DomainError, "Model: H[0]", "make it linear"),
        ({"sigma": 0}, DomainError, "Model: sigma[0]", "above zero"),
        ({"sigma": [1, 2]}, ShapeError, "Model: sigma", "one per measurement"),
        ({"measurements": "a b"}, ShapeError, "Model: measurements", "one per row of H"),
        ({"targets": {"d": [0, 0]}}, DomainError, "Model: targets.d", "not zero"),
        ({"targets": {"d": "q"}}, UnknownSymbolError, "Model: targets.d, column 1", "'q'"),
        ({"targets": 3}, ShapeError, "Model: targets", "name -> functional"),
        ({"F": [["a", 1], [0, 0]]}, UnknownSymbolError, "Model: F[0][0], column 1", "'a'"),
        ({"states": 3}, ShapeError, "Model: states", "expected names"),
        ({"T": 3}, NavsymError, "Model: T", "expected a range"),
        ({"parameters": 3}, ShapeError, "Model: parameters", "name -> declaration"),
        ({"pieces": 3}, ShapeError, "Model: pieces", "list of (from, to, F)"),
        ({"F": None, "pieces": [(0, 1)]}, ShapeError, "Model: pieces[0]", "(from, to, F)"),
        ({"F": [[object(), 1], [0, 0]]}, NavsymError, "Model: F[0][0]", "exact number"),
    ],
)
def test_errors_name_the_argument(changes, error, where, message):
    with pytest.raises(error) as caught:
        swing(**changes)
    assert caught.value.where == where
    assert message in caught.value.message


def test_values_are_put_in_exactly():
    model = swing(F=[["0", "1"], ["-w**2", "0"]], interval="T", w="positive", T=("0", "2*pi"))
    fixed = model.with_values(w="1/2", T=sp.pi)
    assert fixed.document()["model"]["F"] == [["0", "1"], ["-1/4", "0"]]
    assert sp.pi == fixed.T and not fixed.parameters
    assert model.with_values() is model
    with pytest.raises(DomainError, match="in the declared range") as caught:
        model.with_values(T=7)
    assert caught.value.where == "Model: values.T"
    with pytest.raises(UnknownSymbolError, match="expected a declared parameter"):
        model.with_values(q=1)


def test_regressors_without_a_system():
    model = nav.Model.from_basis(["1", "s", "s**2"], interval=(0, 1), targets={"curvature": "2*c2"})
    assert model.states == ("c0", "c1", "c2")
    assert model.document()["targets"] == {"curvature": ["0", "0", "2"]}
    assert model.H.shape == (1, 3)
    with pytest.raises(DomainError, match="got a basis of regressors"):
        model.linear()


def test_there_and_back_by_a_linear_model():
    w, time = sp.Symbol("w", positive=True), sp.Symbol("time")
    linear = LinearModel(
        [[0, 1], [-(w**2), 0]], None, [[sp.cos(time), 0]], ("x", "v"), measurements=("gps",), time=time
    )
    model = nav.Model.from_linear(linear, interval="T", T="positive")
    assert model.document()["parameters"] == {"T": "positive", "w": "positive"}
    assert model.document()["measurement"][0]["h"] == ["cos(t)", "0"]
    assert model.linear().F == linear.F
    assert nav.Model.from_linear(model.linear(), interval="T", T="positive") == model
    with pytest.raises(DomainError, match="without process noise"):
        nav.Model.from_linear(LinearModel([[0]], [[1]], [[1]]))


def test_a_blank_in_a_name_of_a_linear_model_becomes_an_underscore():
    linear = LinearModel([[0, 1], [0, 0]], None, [[1, 0]], ("east position", "v"), measurements=("gps  east",))
    document = nav.Model.from_linear(linear, interval="1", targets={"drift": "east_position"}).document()
    assert document["model"]["states"] == ["east_position", "v"]
    assert document["measurement"][0]["name"] == "gps_east"
    twice = LinearModel([[0, 1], [0, 0]], None, [[1, 0]], ("a b", "a_b"))
    with pytest.raises(NavsymError, match="distinct names"):
        nav.Model.from_linear(twice, interval="1")


@pytest.mark.parametrize("given", [{}, {"F": [["0"]]}, {"states": ""}, {"states": []}])
def test_a_model_without_states_is_an_error_that_says_what_is_missing(given):
    with pytest.raises(NavsymError) as caught:
        nav.Model(**given)
    assert caught.value.kind == "empty" and caught.value.where and caught.value.remedy


def test_save_then_load_gives_the_same_model(tmp_path):
    pieces = [(0, 1, [[0, 1], [0, 0]]), (1, "T", [[0, "w"], ["sin(t)", 0]])]
    saved = [
        nav.Model(**ARGUMENTS, name='quotes " and \\ and ű', measurements="a.b:c*'"),
        swing(F=None, pieces=pieces, interval="T", w="nonzero", T=(2, 3)),
        nav.Model.from_basis([["1", "s"], ["cos(s)", "a"]], sigma=[1, "1/10"], a="real"),
    ]
    for model in saved:
        model.save(tmp_path / "model.toml")
        again = nav.Model.load(tmp_path / "model.toml")
        assert again == model and again.document() == model.document()
        assert nav.Model.from_contents(model.read()).document() == nav.Model.from_contents(again.read()).document()
    with pytest.raises(OutputError):
        saved[0].save(tmp_path / "nowhere" / "model.toml")
    with pytest.raises(NavsymError, match="expected a readable file"):
        nav.Model.load(tmp_path / "nothing.toml")


@given(models())
@settings(max_examples=30)
def test_random_models_survive_the_file_and_the_contents(linear):
    model = nav.Model.from_linear(linear, interval="1/2")
    assert nav.Model.from_document(parse_toml(toml_text(model.document()))) == model
    assert nav.Model.from_contents(model.read()).linear().F == linear.F
    assert model_from(nav.Model.from_contents(model.read()).document()).pieces[0].F == linear.F


words = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)


@given(st.dictionaries(words, st.dictionaries(words, words | st.lists(words) | st.lists(st.lists(words)))))
def test_the_writer_of_toml_is_the_inverse_of_its_reader(document):
    text = toml_text(document)
    if text.strip():
        assert parse_toml(text) == document


def test_what_an_argument_may_mean(tmp_path):
    model = nav.Model(**ARGUMENTS)
    model.save(tmp_path / "model.toml")
    meanings = [model, model.document(), model.read(), tmp_path / "model.toml", str(tmp_path / "model.toml")]
    assert {as_model(meaning, "solve: model").linear().F for meaning in meanings} == {model.F}
    with pytest.raises(DomainError) as caught:
        as_model(3, "solve: model")
    assert caught.value.where == "solve: model"


def test_a_model_is_a_value_that_shows_itself():
    model = nav.Model(**ARGUMENTS)
    with pytest.raises(AttributeError):
        model.name = "other"
    model.document()["model"]["states"].append("more")
    assert model.document() == DOCUMENT
    assert "\n" not in repr(model) and len(repr(model)) < 200
    assert r"\frac{d}{dt} x" in model._repr_latex_() and model._repr_latex_().startswith("$")
    assert "<b>&lt;b&gt;</b>" in swing(name="<b>")._repr_html_()
