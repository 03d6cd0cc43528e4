"""Models with vectors and matrices are the models that one would write out by hand."""

from __future__ import annotations

import pytest
import sympy as sp

import navsym as nav
from navsym.language.expression import parse

BLOCKS = {
    "states": ["phi[3]", "dv[3]", "d"],
    "F": [["-skew(win)", "0", "u"], ["skew(f)", "-skew(wie + win)", "0"], ["0", "0", "-1/tau"]],
    "H": [["0", "eye(3)", "0"], ["u.T", "0", "1"]],
    "measurements": "velocity sum",
    "sigma": ["1/10", "2"],
    "parameters": {name: {"vector": 3} for name in ("win", "wie", "f", "u")} | {"tau": "positive"},
    "targets": {"tilt": ["[1, 0, 0]".join(("[", "]")), "0", "0"]},
}


def cross(name: str) -> sp.Matrix:
    """The matrix of a cross product, from its definition."""
    x, y, z = (sp.Symbol(f"{name}_{i}", real=True) for i in (1, 2, 3))
    return sp.Matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def test_blocks_are_the_matrix_written_out() -> None:
    model = nav.Model(**BLOCKS)
    u, tau = sp.Matrix([sp.Symbol(f"u_{i}", real=True) for i in (1, 2, 3)]), sp.Symbol("tau", positive=True)
    zero = sp.zeros(3, 3)
    rows = [[-cross("win"), zero, u], [cross("f"), -cross("wie") - cross("win"), sp.zeros(3, 1)]]
    expected = sp.Matrix(sp.BlockMatrix([*rows, [sp.zeros(1, 3), sp.zeros(1, 3), sp.Matrix([[-1 / tau]])]]))
    assert sp.simplify(model.F - expected) == sp.zeros(7, 7)
    assert list(model.states) == ["phi_1", "phi_2", "phi_3", "dv_1", "dv_2", "dv_3", "d"]


def test_a_measured_vector_is_as_many_measurements() -> None:
    contents = nav.Model(**BLOCKS)._contents
    assert [m.name for m in contents.measurements] == ["velocity_1", "velocity_2", "velocity_3", "sum"]
    assert [str(m.sigma) for m in contents.measurements] == ["1/10", "1/10", "1/10", "2"]
    assert contents.measurements[1].h == (0, 0, 0, 0, 1, 0, 0)
    assert [str(entry) for entry in contents.measurements[3].h] == ["u_1", "u_2", "u_3", "0", "0", "0", "1"]
    assert contents.targets["tilt"] == (1, 0, 0, 0, 0, 0, 0)


def test_one_flipped_sign_in_a_block_gives_another_model() -> None:
    changed = BLOCKS | {"F": [["skew(win)", "0", "u"], *BLOCKS["F"][1:]]}
    assert nav.Model(**BLOCKS).F != nav.Model(**changed).F


def test_a_quaternion_seen_by_gravity_loses_the_turn_about_gravity() -> None:
    model = nav.Model(
        states="q[4] b[3]",
        dynamics=["qmul(q, [0, w[1] - b[1], w[2] - b[2], w[3] - b[3]])/2", "0"],
        relations=["dot(q, q) = 1"],
        H=["rot(q).T @ [0, 0, 1]"],
        parameters={"w": {"vector": 3}},
    )
    found = nav.observe(model)
    assert found.rank == 6 and found.unobservable_basis.rows == 1


def test_pieces_rates_and_the_whole_matrix_in_one_text() -> None:
    pieces = [("0", "1", "zeros(3, 3)"), ("1", "2", [["-skew(w)"]])]
    model = nav.Model(states="x[3]", pieces=pieces, H=[["[[1, 0, 0]]"]], parameters={"w": {"vector": 3}})
    assert model._contents.pieces[0].F == sp.zeros(3, 3) != model._contents.pieces[1].F
    moving = nav.Model(
        states="x[3]",
        F="-skew(w)",
        H="[[1, 0, 0]]",
        rates={"w": "cross(w, a)"},
        parameters={"w": {"vector": 3}, "a": {"vector": 3}},
    )
    w, a = (sp.Matrix([sp.Symbol(f"{name}_{i}", real=True) for i in (1, 2, 3)]) for name in "wa")
    assert [moving._contents.rates[f"w_{i}"] - w.cross(a)[i - 1] for i in (1, 2, 3)] == [0, 0, 0]


def test_the_range_of_a_vector_is_that_of_its_entries() -> None:
    model = nav.Model(
        states="x[2] y", F=[["0", "0"], ["0", "0"]], H=[["0", "1"]], ranges={"x": ["-1", "2"], "y": [0, 1]}
    )
    assert {name: [float(end) for end in ends] for name, ends in model._contents.ranges.items()} == {
        "x_1": [-1, 2],
        "x_2": [-1, 2],
        "y": [0, 1],
    }


def test_a_file_with_blocks_is_read_and_saved_as_it_is_written(tmp_path) -> None:
    first = nav.Model(**BLOCKS)
    first.save(tmp_path / "model.toml")
    again = nav.Model.load(tmp_path / "model.toml")
    assert again.F == first.F and "skew(win)" in (tmp_path / "model.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("change", "where", "words"),
    [
        ({"F": [["0", "0"], ["0", "0"]]}, "Model: F", "expected 3 entries, one for each state of the list; got 2"),
        ({"F": "eye(6)"}, "Model: F", "expected 7 x 7; got a 6 x 6 matrix"),
        ({"F": [["0", "eye(2)", "0"], *BLOCKS["F"][1:]]}, "Model: F[0][1]", "expected 3 x 3; got a 2 x 2 matrix"),
        ({"F": [["1", "0", "0"], *BLOCKS["F"][1:]]}, "Model: F[0][0]", "expected 3 x 3; got a number"),
        ({"F": [["skew(z)", "0", "0"], *BLOCKS["F"][1:]]}, "Model: F[0][0]", "expected a declared name"),
        ({"F": [["skew(f", "0", "0"], *BLOCKS["F"][1:]]}, "Model: F[0][0]", "expected )"),
        ({"F": [["where(tau > 1, skew(f), 0*skew(f))", "0", "0"], *BLOCKS["F"][1:]]}, "Model: F[0][0]", "no cases"),
        ({"states": "phi[3] dv[0] d"}, "Model: states[1]", "expected 1 to 64 entries"),
        ({"states": "phi[3] phi[3] d"}, "Model: states[1]", "declared already"),
        ({"states": "phi[3] f[3] d"}, "Model: states[1]", "declared already"),
        ({"parameters": {"w": {"rotation": "b to n"}}}, "Model: w", "expected a number, a vector or a matrix"),
        ({"parameters": {"w": {"vector": 1.5}}}, "Model: w", "expected"),
        ({"H": ["[1, 0, 0, 0, 0, 0, 0]", "phi[1]"]}, "Model: H[0]", "expected 7 x 7; got a vector of 7"),
    ],
)
def test_what_does_not_fit_is_said_with_its_place(change, where, words) -> None:
    with pytest.raises(nav.NavsymError) as caught:
        nav.Model(**(BLOCKS | change))
    assert caught.value.where.startswith(where) and words in str(caught.value)


@pytest.mark.parametrize(
    ("text", "entry"),
    [
        ("integral(exp(-s/tau), s, 0, t)", "tau - tau*exp(-t/tau)"),
        ("integral(x, x, 0, a)", "a**2/2"),
        ("expm(-t/tau*eye(2))[2,2]", "exp(-t/tau)"),
        ("limit((1 - cos(a*s))/s**2, s, 0)", "a**2/2"),
        ("sum(k*a, k, 1, 3)", "6*a"),
        ("dot_(a*t)", "a + b*t"),
        ("dot_(w)[2]", "w_3"),
        ("dot_(b)", "expected a rate below dot_; got none of b"),
        ("dot_(x)", "no rate is known"),
        ("integral(sin(s)/s, s, 0, t)", "no closed form of the integral was found"),
        ("floor(a)", "expected no cases, floor and erf"),
        ("erf(a)", "expected no cases, floor and erf"),
    ],
)
def test_calculus_in_a_model_is_that_of_claims(text, entry) -> None:
    names = {"a": "real", "b": "real", "tau": "positive", "w": {"vector": 3}}
    rates = {"a": "b", "w": "cross(w, [1, 0, 0])"}
    model = {"states": "x y", "F": [[text, "1"], ["0", "0"]], "H": [["1", "0"]], "rates": rates, "parameters": names}
    if "expected" in entry or entry.startswith("no "):
        with pytest.raises(nav.NavsymError, match=entry):
            nav.Model(**model)
        return
    found = nav.Model(**model)._contents.pieces[0].F[0, 0]
    known = {name: sp.Symbol(name, real=True) for name in ("a", "b", "t", "w_3")} | {
        "tau": sp.Symbol("tau", positive=True)
    }
    assert found == parse(entry, known)
