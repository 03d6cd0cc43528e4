"""Model files: what is read is exact, and what is wrong is named with its place."""

from __future__ import annotations

from dataclasses import FrozenInstanceError

import pytest
import sympy as sp

from navsym.core.errors import NavsymError, ShapeError
from navsym.language.tomlfile import parse_toml
from navsym.models.modelfile import BasisFile, ModelFile, model_from, read_model

SCHULER = """
[model]
name   = "schuler-velocity"
states = ["y1", "y2", "y3"]
F      = [["0", "-1", "0"], ["0", "0", "1"], ["0", "-w**2", "0"]]
[parameters]
w = ["1/2", "2"]
[[measurement]]
name  = "velocity"
h     = ["1", "0", "0"]
sigma = "1"
[interval]
T = "pi/2"
[targets]
y3 = ["0", "0", "1"]
"""

BASIS = """
[basis]
variable = "s"
H        = ["1", "s", "s**2"]
interval = ["0", "1"]
[targets]
c2 = ["0", "0", "1"]
"""

PIECES = """
[model]
states = ["x", "v"]
[parameters]
T = "positive"
[[piece]]
from = "0"
to = "T/2"
F = [["0", "1"], ["0", "0"]]
[[piece]]
from = "T/2"
to = "T"
F = [["0", "1"], ["-t", 0.1]]
[[measurement]]
h = [1, 0]
[interval]
T = "T"
"""


def read(text, values=None):
    return model_from(parse_toml(text, "m.toml"), "m.toml", values)


def test_the_model_of_the_manual_is_read_exactly(tmp_path):
    path = tmp_path / "schuler.toml"
    path.write_text(SCHULER)
    model = read_model(path)
    w = model.parameters["w"].symbol
    assert isinstance(model, ModelFile) and model.name == "schuler-velocity"
    assert sp.Matrix([[0, -1, 0], [0, 0, 1], [0, -(w**2), 0]]) == model.F
    assert w.is_positive and model.box == {w: (sp.Rational(1, 2), sp.Integer(2))}
    assert sp.pi / 2 == model.T and model.targets == {"y3": (0, 0, 1)}
    assert model.measurements[0].name == "velocity" and model.measurements[0].h == (1, 0, 0)


def test_the_basis_of_the_manual_is_read_exactly():
    basis = read(BASIS)
    s = basis.variable
    assert isinstance(basis, BasisFile)
    assert ((1, s, s**2),) == basis.H and basis.sigma == (1,) and basis.interval == (0, 1)


def test_several_measurements_of_a_basis_have_a_bound_each():
    basis = read(BASIS.replace('["1", "s", "s**2"]', '[["1", "s", "0"], ["0", "1", 2.50]]\nsigma = ["1", "2"]'))
    s = basis.variable
    assert ((1, s, 0), (0, 1, sp.Rational(5, 2))) == basis.H and basis.sigma == (1, 2)


def test_a_bare_decimal_is_what_its_digits_say():
    model = read(PIECES)
    assert model.pieces[1].F[1, 1] == sp.Rational(1, 10)
    assert model.pieces[1].F[1, 0] == -model.time


def test_pieces_join_and_end_at_T():
    model = read(PIECES)
    T = model.parameters["T"].symbol
    assert [(piece.start, piece.end) for piece in model.pieces] == [(0, T / 2), (T / 2, T)]
    with pytest.raises(ShapeError, match="got 2 pieces"):
        _ = model.F


def test_every_state_is_a_target_when_none_is_named():
    assert read(PIECES).targets == {"x": (1, 0), "v": (0, 1)}


def test_a_value_on_the_command_line_replaces_the_parameter_everywhere():
    model = read(SCHULER, {"w": "1.5"})
    assert model.F[2, 1] == sp.Rational(-9, 4) and model.parameters == {} and model.box == {}
    halves = read(PIECES, {"T": "5/2"}).T
    assert halves == sp.Rational(5, 2)


@pytest.mark.parametrize(
    ("values", "kind"),
    [
        ({"w": "3"}, "domain"),
        ({"w": "1/0"}, "domain"),
        ({"v": "1"}, "unknown-symbol"),
        ({"w": "x"}, "unknown-symbol"),
        ({"w": "__import__('os')"}, "syntax"),
        ({"w": "9**9**9"}, "too-large"),
        ({"w": ""}, "empty"),
    ],
)
def test_a_wrong_value_on_the_command_line_is_refused(values, kind):
    with pytest.raises(NavsymError) as caught:
        read(SCHULER, values)
    assert caught.value.kind == kind and caught.value.where.startswith("--set")


def test_what_was_read_cannot_be_changed():
    model = read(SCHULER)
    with pytest.raises(FrozenInstanceError):
        model.name = "other"
    with pytest.raises(TypeError):
        model.F[0, 0] = 1


@pytest.mark.parametrize("kind", ["real", "positive", "nonnegative", "nonzero"])
def test_a_declaration_says_what_is_known_of_the_sign(kind):
    parameter = read(SCHULER.replace('["1/2", "2"]', f'"{kind}"')).parameters["w"]
    assert parameter.kind == kind and parameter.lower is None
    assert parameter.symbol.is_real and getattr(parameter.symbol, f"is_{kind}")


@pytest.mark.parametrize(("ends", "nonnegative"), [('["0", "1"]', True), ('["-1", "1"]', None)])
def test_a_range_gives_the_sign_that_it_proves(ends, nonnegative):
    made = read(SCHULER.replace('["1/2", "2"]', ends)).parameters["w"].symbol
    assert made.is_positive is None and made.is_nonnegative is nonnegative


WRONG = [
    ('states = ["y1", "y2", "y3"]', 'states = ["y1", "y2"]', "shape", "model.F"),
    ('states = ["y1", "y2", "y3"]', "states = []", "empty", "model.states"),
    ('states = ["y1", "y2", "y3"]', 'states = ["y1", "y1", "y3"]', "duplicate", "model.states"),
    ('states = ["y1", "y2", "y3"]', 'states = ["y1", "w", "y3"]', "duplicate", "model.states"),
    ('states = ["y1", "y2", "y3"]', 'states = ["y1", "y2", "t"]', "duplicate", "model.states"),
    ('states = ["y1", "y2", "y3"]', 'states = "y1"', "shape", "model.states"),
    ('states = ["y1", "y2", "y3"]', 'states = ["y1", "y2", 3]', "syntax", "model.states[2]"),
    ('states = ["y1", "y2", "y3"]', 'stats = ["y1"]', "syntax", "model.stats"),
    ('states = ["y1", "y2", "y3"]\n', "", "empty", "model.states"),
    ('["0", "-1", "0"]', '["0", "-1"]', "shape", "model.F[0]"),
    ('["0", "-1", "0"]', '"0"', "shape", "model.F[0]"),
    ('"-w**2"', '"-omega**2"', "unknown-symbol", "model.F[2][1]"),
    ('"-w**2"', '"-w^2"', "syntax", "model.F[2][1]"),
    ('"-w**2"', "nan", "not-finite", "model.F[2][1]"),
    ('"-w**2"', "-inf", "not-finite", "model.F[2][1]"),
    ('"-w**2"', "true", "syntax", "model.F[2][1]"),
    ('"-w**2"', "1979-05-27", "syntax", "model.F[2][1]"),
    ('"-w**2"', "1e999999999", "too-large", "model.F[2][1]"),
    ('"-w**2"', '"1/0"', "domain", "model.F[2][1]"),
    ('"pi/2"', '"0"', "domain", "interval.T"),
    ('"pi/2"', '"-1"', "domain", "interval.T"),
    ('"pi/2"', '"3 - pi"', "domain", "interval.T"),
    ('"pi/2"', '"t"', "unknown-symbol", "interval.T"),
    ('"pi/2"', '"T"', "unknown-symbol", "interval.T"),
    ('T = "pi/2"', "", "empty", "interval.T"),
    ('sigma = "1"', 'sigma = "0"', "domain", "measurement[0].sigma"),
    ('sigma = "1"', "sigma = -0.5", "domain", "measurement[0].sigma"),
    ('sigma = "1"', 'sigma = "t"', "unknown-symbol", "measurement[0].sigma"),
    ('h     = ["1", "0", "0"]', 'h = ["1", "0"]', "shape", "measurement[0].h"),
    ('h     = ["1", "0", "0"]', "h = []", "empty", "measurement[0].h"),
    ("[[measurement]]", "[measurement]", "shape", "measurement"),
    ("[[measurement]]", "[measurment]", "syntax", "measurment"),
    ('["1/2", "2"]', '["2", "1/2"]', "domain", "parameters.w"),
    ('["1/2", "2"]', '["2", "2"]', "domain", "parameters.w"),
    ('["1/2", "2"]', '["2"]', "shape", "parameters.w"),
    ('["1/2", "2"]', '["-1", "oo"]', "unknown-symbol", "parameters.w[1]"),
    ('["1/2", "2"]', '"postive"', "syntax", "parameters.w"),
    ('["1/2", "2"]', "3", "syntax", "parameters.w"),
    ('w = ["1/2", "2"]', 'w = "real"\nw = "real"', "duplicate", "line"),
    ('w = ["1/2", "2"]', 'pi = "real"', "duplicate", "parameters.pi"),
    ('w = ["1/2", "2"]', '"x; system(1)" = "real"', "syntax", "parameters.x; system(1)"),
    ('y3 = ["0", "0", "1"]', 'y3 = ["0", "0", "0"]', "domain", "targets.y3"),
    ('y3 = ["0", "0", "1"]', 'y3 = ["0", "1"]', "shape", "targets.y3"),
    ('y3 = ["0", "0", "1"]', "", "empty", "targets"),
    ('name   = "schuler-velocity"', 'name = "\\u001b[31m"', "syntax", "model.name"),
    ('name   = "schuler-velocity"', "name = 3", "syntax", "model.name"),
]


@pytest.mark.parametrize(("old", "new", "kind", "place"), WRONG)
def test_a_mistake_in_a_model_is_named_with_its_place(old, new, kind, place):
    assert old in SCHULER
    with pytest.raises(NavsymError, match=r"expected .*; got .*; \w") as caught:
        read(SCHULER.replace(old, new))
    assert caught.value.kind == kind
    assert caught.value.where.startswith("m.toml: ") and place in caught.value.where


@pytest.mark.parametrize(
    ("text", "old", "new", "kind"),
    [
        (BASIS, '"s**2"]', '["s"]]', "shape"),
        (BASIS, '["1", "s", "s**2"]', '[["1", "s"], ["1"]]', "shape"),
        (BASIS, '["1", "s", "s**2"]', "[]", "empty"),
        (BASIS, '["0", "1"]', '["1", "0"]', "domain"),
        (BASIS, '["0", "1"]', '["0", "s"]', "unknown-symbol"),
        (BASIS, '["0", "1"]', '["0"]', "shape"),
        (BASIS, 'variable = "s"', 'variable = "sin"', "duplicate"),
        (BASIS, 'variable = "s"', 'variable = "s"\nsigma = ["1", "2"]', "shape"),
        (BASIS, 'variable = "s"', 'variable = "s"\nsigma = "-1"', "domain"),
        (BASIS, "[targets]", "[model]\n[targets]", "syntax"),
        (PIECES, 'from = "T/2"', 'from = "T/3"', "domain"),
        (PIECES, 'to = "T"', 'to = "2*T"', "domain"),
        (PIECES, "[model]", '[model]\nF = [["0"]]', "duplicate"),
        (PIECES, '"positive"', '"real"', "domain"),
        (PIECES, 'to = "T/2"', 'end = "T/2"', "syntax"),
        (PIECES, "[model]", "[modell]", "syntax"),
    ],
)
def test_a_mistake_in_a_basis_or_a_piece_is_named(text, old, new, kind):
    assert old in text
    with pytest.raises(NavsymError, match=r"expected .*; got .*; \w") as caught:
        read(text.replace(old, new))
    assert caught.value.kind == kind and caught.value.where


def test_a_wrong_key_is_answered_with_the_nearest_one():
    with pytest.raises(NavsymError, match="did you mean 'states'"):
        read(SCHULER.replace("states", "state"))


@pytest.mark.parametrize(
    ("declared", "advice"),
    [
        ("9.81", "give the value by --set g=…, or write the number in place of g"),
        (9, "give the value by --set g=…, or write the number in place of g"),
        (["6", "6"], "write a constant in place of the name"),
        ("positiv", "correct it: did you mean 'positive'?"),
    ],
)
def test_a_constant_among_the_parameters_is_refused_with_the_way_to_write_it(declared, advice):
    document = {"model": {"states": ["x"], "F": [["g"]]}, "parameters": {"g": declared}, "measurement": [{"h": ["1"]}]}
    with pytest.raises(NavsymError) as refused:
        model_from(document)
    assert advice in str(refused.value)


def test_the_table_of_names_of_a_claim_file_is_called_parameters_here():
    with pytest.raises(NavsymError, match="did you mean 'parameters'"):
        read('[symbols]\ng = "positive"\n[model]\nstates = ["x"]\nF = [["g"]]\n')
