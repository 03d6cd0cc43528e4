"""What follows from a file is what follows from its model."""

import pytest
import sympy as sp

from navsym.cli.derive import as_text
from navsym.core.errors import DomainError, NavsymError
from navsym.language.expression import parse
from navsym.models.derivation import derive
from navsym.models.modelfile import linear_model, model_from

PAPER = {
    "model": {
        "name": "velocity",
        "states": ["y1", "y2", "y3"],
        "F": [["0", "-1", "0"], ["0", "0", "1"], ["0", "-1", "0"]],
    },
    "parameters": {"T": "positive"},
    "measurement": [{"name": "z", "h": ["1", "0", "0"], "sigma": "2"}],
    "interval": {"T": "T"},
    "targets": {"y3": ["0", "0", "1"]},
}
PIECES = {
    "model": {"states": ["x", "v"]},
    "piece": [
        {"from": "0", "to": "1", "F": [["0", "1"], ["0", "0"]]},
        {"from": "1", "to": "3", "F": [["0", "1"], ["-w**2", "0"]]},
    ],
    "parameters": {"w": "real"},
    "measurement": [{"h": ["1", "0"]}, {"h": ["0", "1"]}],
}


def test_the_regressors_and_the_dual_polynomial_of_the_velocity_correction():
    derivation = derive(model_from(PAPER))
    T, tau = derivation.end, derivation.time
    assert derivation.pieces[0].rows == sp.ImmutableMatrix([[1, sp.sin(T - tau), sp.cos(T - tau) - 1]])
    x1, x2, x3 = derivation.multipliers
    f, slope = derivation.conditions[0].dual[0][0], derivation.conditions[0].slope[0][0]
    assert sp.expand(f - x1 - x2 * sp.sin(T - tau) - x3 * (sp.cos(T - tau) - 1)) == 0
    assert sp.expand(slope + x2 * sp.cos(T - tau) - x3 * sp.sin(T - tau)) == 0
    assert derivation.observability_matrix.tolist() == [[1, 0, 0], [0, -1, 0], [0, 0, -1]]


def test_regressors_of_a_motion_in_pieces_are_continuous_where_the_pieces_meet():
    derivation = derive(model_from(PIECES))
    tau, (first, second) = derivation.time, derivation.pieces
    assert (first.end, second.start, second.end) == (1, 1, 3)
    gap = (first.rows - second.rows).subs(tau, 1).applyfunc(lambda e: sp.expand(sp.expand_trig(e)))
    assert gap == sp.zeros(2, 2)
    assert second.rows.subs(tau, 3) == sp.eye(2)
    for piece, F in zip(derivation.pieces, derivation.system, strict=True):
        motion = piece.rows.diff(tau) - F * piece.rows  # h = I here
        assert all(sp.expand(sp.expand_trig(sp.expand_mul(entry))) == 0 for entry in motion)
    assert sp.Ne(sp.Symbol("w", real=True), 0) in derivation.assumptions
    assert derivation.observability_matrix is None


def test_every_printed_expression_reads_back_as_itself():
    derivation = derive(model_from(PAPER))
    data = derivation.document()
    names = {str(s): s for s in (derivation.end, derivation.time, *derivation.multipliers)}
    row = [parse(text, names) for text in data["regressors"][0]["H"][0]]
    assert sp.ImmutableMatrix([row]) == derivation.pieces[0].rows
    assert parse(data["conditions"][0]["dual_polynomial"][0][0], names) == derivation.conditions[0].dual[0][0]
    assert data["measurements"] == [{"name": "z", "sigma": "2"}]


def test_a_basis_has_regressors_and_conditions_but_no_system():
    found = model_from(
        {
            "basis": {"variable": "s", "H": [["1", "s", "s**2"]], "interval": ["0", "1"]},
            "targets": {"c2": ["0", "0", "1"]},
        }
    )
    derivation = derive(found)
    assert (derivation.system, derivation.transition, derivation.observability_matrix) == ((), (), None)
    s, (x1, x2, x3) = derivation.time, derivation.multipliers
    assert sp.expand(derivation.conditions[0].slope[0][0] - x2 - 2 * x3 * s) == 0
    assert sp.expand(derivation.conditions[0].dual[0][0] - x1 - x2 * s - x3 * s**2) == 0


def test_names_of_the_file_are_never_taken_twice():
    file = PAPER | {"parameters": {"T": "positive", "tau": "real", "x1": "real"}}
    derivation = derive(model_from(file))
    assert str(derivation.time) == "s"
    assert [str(x) for x in derivation.multipliers] == ["lambda_1", "lambda_2", "lambda_3"]


def test_text_and_latex_show_every_part():
    derivation = derive(model_from(PAPER))
    text, tex = as_text(derivation.document()), derivation.latex()
    for part in ("Phi(t)", "H(tau)", "observability matrix", "|f(tau)| <= 2", "guaranteed deviation"):
        assert part in text
    assert tex.count(r"\[") == tex.count(r"\]") == tex.count(r"\begin{pmatrix}") + 3
    assert r"\cos{\left(T - \tau \right)} - 1" in tex


def test_a_motion_that_varies_in_time_has_no_closed_form_here():
    file = PAPER | {"model": PAPER["model"] | {"F": [["0", "-t", "0"], ["0", "0", "1"], ["0", "-1", "0"]]}}
    with pytest.raises(DomainError, match="in pieces"):
        derive(model_from(file))
    assert not linear_model(model_from(file)).constant
    with pytest.raises(NavsymError):
        linear_model(model_from(PIECES))
