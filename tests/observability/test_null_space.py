"""First-estimate Jacobians keep what the model never shows; those of the usual filter do not."""

from __future__ import annotations

import json

import pytest
import sympy as sp

import navsym as nav
from navsym.cli.main import run
from navsym.observability.null_space import read_jacobians

STATES = "x y p a b"
DYNAMICS = ["v*cos(p)", "v*sin(p)", "w", "0", "0"]
SEEN = ["cos(p)*(a - x) + sin(p)*(b - y)", "-sin(p)*(a - x) + cos(p)*(b - y)"]
MAP = nav.Model(STATES, dynamics=DYNAMICS, H=SEEN, v="real", w="real")
FIRST = {"x": "x0", "y": "y0", "p": "p0", "a": "a0", "b": "b0"}


def measurement(x, y, p, a, b):
    """The gradient of SEEN at a point, by sympy."""
    names = sp.symbols(STATES)
    rows = sp.Matrix([sp.sympify(z) for z in SEEN]).jacobian(names)
    put = dict(zip(names, sp.symbols([x, y, p, a, b]), strict=True))
    return [[str(entry) for entry in row] for row in rows.subs(put, simultaneous=True).tolist()]


def motion(dx, dy):
    """Of a step that moves by dx, dy: a turn of the heading turns the way (Huang et al. 2010, (7))."""
    rows = sp.eye(5).tolist()
    rows[0][2], rows[1][2] = f"-({dy})", dx
    return [[str(entry) for entry in row] for row in rows]


#: predicted poses X1 Y1 p1, X2 Y2 p2; x1 y1 is the corrected one, a1 b1 and a2 b2 the mark after corrections
USUAL = {
    "H": [
        measurement("x0", "y0", "p0", "a0", "b0"),
        measurement("X1", "Y1", "p1", "a1", "b1"),
        measurement("X2", "Y2", "p2", "a2", "b2"),
    ],
    "Phi": [motion("X1 - x0", "Y1 - y0"), motion("X2 - x1", "Y2 - y1")],
}
FIRST_ESTIMATES = {
    "H": [
        measurement("x0", "y0", "p0", "a0", "b0"),
        measurement("X1", "Y1", "p1", "a0", "b0"),
        measurement("X2", "Y2", "p2", "a0", "b0"),
    ],
    "Phi": [motion("X1 - x0", "Y1 - y0"), motion("X2 - X1", "Y2 - Y1")],
}


def test_first_estimates_keep_all_three_directions_and_the_checker_grants_it():
    answer = nav.observe(MAP)
    assert len(answer.unobservable) == 3
    kept = answer.null_space(**FIRST_ESTIMATES, first=FIRST)
    assert kept.holds and [direction.step for direction in kept.directions] == [None] * 3
    assert len(kept.certificates()) == 9 and "all ACCEPTED" in repr(kept.check())


def test_the_usual_filter_keeps_the_place_and_gains_information_on_the_heading():
    kept = nav.observe(MAP).null_space(**USUAL, first=FIRST)
    turn = next(d for d in kept.directions if d.status == "REFUTED")
    assert sorted(d.status.value for d in kept.directions) == ["PROVED", "PROVED", "REFUTED"]
    assert turn.step == 2 and "p" in turn.name
    # the counterexample, put in by sympy: H_1 Phi_0 N differs from zero there
    N = nav.observe(MAP).unobservable_basis
    point = {sp.Symbol(s): sp.sympify(value) for s, value in turn.verdicts[-1].counterexample.items()}
    row = next(N.row(k) for k in range(3) if nav.observe(MAP).unobservable[k] == turn.name)
    start = {s: sp.Symbol(FIRST[s.name]) for s in row.free_symbols}
    H, Phi = sp.Matrix(USUAL["H"][1]), sp.Matrix(USUAL["Phi"][0])
    product = H * Phi * row.subs(start, simultaneous=True).T
    assert max(abs(sp.N(entry.subs(point))) for entry in product) > 1e-9


def test_one_changed_sign_in_the_motion_is_noticed():
    spoiled = {**FIRST_ESTIMATES, "Phi": [motion("X1 - x0", "y0 - Y1"), FIRST_ESTIMATES["Phi"][1]]}
    assert not nav.observe(MAP).null_space(**spoiled, first=FIRST).holds


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"H": []}, "expected H of each step"),
        ({"H": [[["1", "2"]]]}, "expected rows of 5 entries"),
        ({"H": [[["1"] * 5], [["1"] * 5]]}, "Phi between two"),
        ({"H": [[["1"] * 5]], "first": {"q": "1"}}, "expected a state; got 'q'"),
        ({"H": [[["1 +"] * 5]]}, "expected"),
    ],
)
def test_what_are_no_jacobians_is_refused_in_words(arguments, words):
    with pytest.raises(nav.NavsymError, match=words):
        nav.observe(MAP).null_space(**{"Phi": [], **arguments})


def test_a_model_that_shows_all_has_no_direction_to_keep():
    with pytest.raises(nav.NavsymError, match="every state is observed"):
        nav.observe(nav.Model("x", F=[[0]], H=["x"])).null_space([[["1"]]])


def test_the_command_says_it_and_its_status_does(tmp_path, capsys):
    model, spec = tmp_path / "map.toml", tmp_path / "filter.toml"
    MAP.save(model)

    def write(steps):
        blocks = ["[first]", *(f'{state} = "{point}"' for state, point in FIRST.items())]
        for k, rows in enumerate(steps["H"]):
            blocks += ["[[step]]", f"H = {json.dumps(rows)}"]
            blocks += [f"Phi = {json.dumps(steps['Phi'][k])}"] if k < len(steps["Phi"]) else []
        spec.write_text("\n".join(blocks), encoding="utf-8")

    write(FIRST_ESTIMATES)
    assert run(["observe", str(model), "--jacobians", str(spec), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["null_space"]["directions"]
    assert [direction["status"] for direction in found] == ["PROVED"] * 3
    write(USUAL)
    assert run(["observe", str(model), "--jacobians", str(spec)]) == 1
    assert "REFUTED" in capsys.readouterr().out


def test_a_step_without_its_transition_is_refused_where_it_stands(tmp_path):
    """Else the next step's matrix would move up into its place."""
    file = tmp_path / "filter.toml"
    rows = [
        'H = [["1", "0"]]\nPhi = [["1", "1"], ["0", "1"]]',
        'H = [["1", "0"]]',
        'H = [["1", "0"]]\nPhi = [["1", "0"], ["0", "1"]]',
    ]
    file.write_text("".join(f"[[step]]\n{row}\n" for row in rows))
    with pytest.raises(nav.NavsymError) as refused:
        read_jacobians(file)
    assert refused.value.where.endswith("step[1].Phi")
