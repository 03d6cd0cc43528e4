"""Error models in vectors, as they are printed, and attitudes by a quaternion whose convention is sought."""

from __future__ import annotations

import json
import re
from itertools import product
from typing import Any

import pytest
import sympy as sp

import navsym as nav
from navsym.cli.main import run

Q = sp.symbols("q_1:5")
READINGS = [*product(("Hamilton", "JPL"), ("body to frame", "frame to body"), ("scalar first", "scalar last"))]


def multiply(a, b, algebra):
    """The product of two quaternions, scalar first, of an algebra: in that of JPL i j is -k."""
    a, b = (a, b) if algebra == "Hamilton" else (b, a)
    (s, *u), (t, *v) = a, b
    turned = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    inner = sum(x * y for x, y in zip(u, v, strict=True))
    return [s * t - inner, *(s * y + t * x + z for x, y, z in zip(u, v, turned, strict=True))]


def rotation(algebra: str, direction: str, order: str) -> list[list[str]]:
    """The rotation from the body: q v q* turns a vector to where the quaternion leads, or the transposed matrix."""
    q = list(Q) if order == "scalar first" else [Q[3], *Q[:3]]
    conjugate = [q[0], *(-x for x in q[1:])]
    columns = []
    for k in range(3):
        unit = [0, *(int(k == j) for j in range(3))]
        columns.append(multiply(multiply(q, unit, algebra), conjugate, algebra)[1:])
    rows = columns if direction == "frame to body" else [*zip(*columns, strict=True)]
    return [[re.sub(r"q_(\d)", r"q[\1]", str(sp.expand(x))) for x in row] for row in rows]


def in_brackets(rows: list[list[str]]) -> str:
    """A matrix as a text of the language."""
    return f"[{', '.join('[' + ', '.join(row) + ']' for row in rows)}]"


def model(R: Any, quantity: dict[str, Any], **parameters: Any) -> dict[str, Any]:
    """Error-state equations with the error in the body, in vectors; R is a text or its entries."""
    R = R if isinstance(R, str) else in_brackets(R)
    return {
        "model": {
            "states": ["dv[3]", "p[3]", "bg[3]", "ba[3]"],
            "F": [
                ["0", f"-{R} @ skew(a)", "0", f"-{R}"],
                ["0", "-skew(w)", "-eye(3)", "0"],
                ["0", "0", "0", "0"],
                ["0", "0", "0", "0"],
            ],
        },
        "parameters": {"a": {"vector": 3}, "w": {"vector": 3}, **parameters},
        "roles": {"velocity": "dv", "attitude": "p", "gyro_bias": "bg", "accelerometer_bias": "ba"},
        "quantities": {"specific_force_body": "a", "angular_rate": "w", **quantity},
        "known": {"frame": "inertial", "error": "estimate - truth"},
    }


def with_quaternion(C: Any) -> dict[str, Any]:
    """The model whose attitude is a unit quaternion."""
    return model(C, {"quaternion": "q"}, q={"quaternion": "unit"})


def readings(answer: nav.Conventions) -> set[tuple[str | None, ...]]:
    """What the cards say of the quaternion."""
    return {(c.quaternion_algebra, c.quaternion_direction, c.quaternion_order) for c in answer.cards}


@pytest.mark.long
@pytest.mark.parametrize("reading", READINGS, ids=", ".join)
def test_the_convention_of_a_quaternion_is_found_with_the_other_one_that_is_the_same_rotation(reading):
    answer = nav.conventions(with_quaternion(rotation(*reading)))
    algebra, direction, order = reading
    other = (
        "JPL" if algebra == "Hamilton" else "Hamilton",
        {"body to frame": "frame to body"}.get(direction, "body to frame"),
        order,
    )
    assert answer.complete
    assert readings(answer) == {reading, other}
    assert all(c.attitude_error == "body" and c.rotation_sign == "+" for c in answer.cards)


def test_what_is_known_of_the_quaternion_leaves_one_card():
    document = with_quaternion("rot(q)")
    document["known"]["quaternion_algebra"] = "JPL"
    answer = nav.conventions(document)
    assert readings(answer) == {("JPL", "frame to body", "scalar first")}


def test_a_block_that_reads_the_quaternion_in_another_way_is_named():
    document = with_quaternion("rot(q)")
    for C in ("rot(q).T", in_brackets(rotation("Hamilton", "body to frame", "scalar last"))):
        document["model"]["F"][0][3] = f"-{C}"
        answer = nav.conventions(document)
        assert answer.complete and not answer.cards
        assert [(c.block, c.status) for c in answer.conflicts] == [(("velocity", "accelerometer_bias"), "PROVED")]


@pytest.mark.long
def test_a_card_with_a_quaternion_gives_the_model_and_converts_it():
    document = with_quaternion("rot(q)")
    card = nav.conventions(document).cards[0]
    derived = {**document, "card": card.words()}
    del derived["model"], derived["known"]
    derived["roles"] = {role: f"{name}[3]" for role, name in document["roles"].items()}
    found = nav.conventions(
        {**derived, "known": {"frame": "inertial", "vector_error": "difference", "attitude_error": "body"}}
    )
    assert found.complete and card in found.cards
    values = dict(zip((f"q_{k}" for k in range(1, 5)), (sp.Rational(x, 9) for x in (4, 4, 7, 0)), strict=True))
    written = nav.conventions(document).model()["F"]
    for row, other in zip(written, found.model()["F"], strict=True):
        for x, y in zip(row, other, strict=True):
            assert sp.expand(sp.sympify(x).subs(values) - sp.sympify(y).subs(values)) == 0
    moved = nav.conventions(document).convert(attitude_error="frame")
    assert moved.proved and moved.target.attitude_error == "frame"


def test_a_model_in_vectors_is_the_model_in_its_entries():
    wide = nav.conventions(model("C", {"rotation": "C"}, C={"rotation": "b to n"}))
    names = {f"{name}_{k}": "real" for name in ("a", "w") for k in (1, 2, 3)}
    names |= {f"C_{i}_{j}": "real" for i in (1, 2, 3) for j in (1, 2, 3)}
    roles = {"velocity": "dv", "attitude": "p", "gyro_bias": "bg", "accelerometer_bias": "ba"}
    document = {
        "model": wide.model(),
        "parameters": names,
        "roles": {role: [f"{name}_{k}" for k in (1, 2, 3)] for role, name in roles.items()},
        "quantities": {
            "specific_force_body": ["a_1", "a_2", "a_3"],
            "angular_rate": ["w_1", "w_2", "w_3"],
            "rotation": [[f"C_{i}_{j}" for j in (1, 2, 3)] for i in (1, 2, 3)],
        },
        "known": {"frame": "inertial", "error": "estimate - truth"},
    }
    assert nav.conventions(document).cards == wide.cards and len(wide.cards) == 1


def test_measurements_noises_and_resets_in_vectors_are_read():
    document = model("C", {"rotation": "C", "lever_arm": "l"}, C={"matrix": [3, 3]}, l={"vector": 3})
    document["model"]["G"] = [["0", "-C"], ["-eye(3)", "0"], ["0", "0"], ["0", "0"]]
    document["measurement"] = [{"name": "speed", "h": ["C.T", "C.T @ skew(v)", "skew(l)", "0"]}]
    document["measured"], document["noises"] = (
        {"body_velocity": "speed"},
        {"gyro": [1, 2, 3], "accelerometer": [4, 5, 6]},
    )
    document["parameters"]["v"] = {"vector": 3}
    document["quantities"]["velocity"] = "v"
    answer = nav.conventions(document)
    matrices = {conflict.matrix for conflict in answer.conflicts}
    assert matrices == {"H"}, "the error of the attitude is in the body, and H is written for one in the frame"
    document["measurement"][0]["h"] = ["C.T", "skew(C.T @ v)", "skew(l)", "0"]
    answer = nav.conventions(document)
    assert answer.complete and len(answer.cards) == 1
    document["model"]["H"] = [document.pop("measurement")[0]["h"]]
    document["measured"] = {"body_velocity": [1, 2, 3]}
    assert nav.conventions(document).cards == answer.cards


def test_equations_of_the_errors_are_linearised():
    document = model("C", {"rotation": "C"}, C={"rotation": "b to n"})
    right = nav.conventions(document)
    del document["model"]["F"]
    turned = "cross(cross(C @ (a + ba), C @ p) - C @ ba, [0, 0, 0])"  # nothing of first order
    document["model"]["dynamics"] = [f"C @ cross(p, a - ba) - C @ ba + {turned}", "cross(p, w) - bg", "0", "0"]
    assert nav.conventions(document).cards == right.cards
    document["model"]["dynamics"][0] = "C @ a"
    with pytest.raises(nav.NavsymError, match="no rate where the errors are zero"):
        nav.conventions(document)


def test_a_row_may_be_an_entry_of_the_book():
    document = {
        "model": {
            "states": ["dv[3]", "phi[3]", "nab[3]"],
            "dynamics": ["book:velocity-error-specific-force", "-cross(wn, phi)", "0"],
        },
        "parameters": {"wn": {"vector": 3}},
        "roles": {"velocity": "dv", "attitude": "phi", "accelerometer_bias": "nab"},
        "quantities": {"rotation": "C", "specific_force_body": "f", "transport_rate": "wn"},
        "known": {
            "frame": "local-level",
            "axes": "NED",
            "angle": "phi",
            "error": "estimate - truth",
            "earth": "sphere",
        },
    }
    (card,) = nav.conventions(document).cards
    # The entry has C_est = (E - [phi x]) C, and a sensor that shows more than the truth: the bias is left in.
    assert (card.attitude_error, card.rotation_sign, card.bias_sign) == ("frame", "-", "truth - estimate")
    document["model"]["dynamics"][0] = "book:velocity-error-specific-forces"
    with pytest.raises(nav.NavsymError, match="did you mean 'velocity-error-specific-force'"):
        nav.conventions(document)


BAD = [
    ({"quantities": {"quaternion": ["a", "w"]}}, "shape"),
    ({"quantities": {"quaternion": "q", "rotation": "rot(q)"}}, "duplicate"),
    ({"quantities": {"quaternion": "a"}}, "shape"),
    ({"quantities": {"quaternion": ["1", "1", "1", "1"]}}, "domain"),
    ({"known": {"quaternion_order": "last"}}, "domain"),
]


@pytest.mark.parametrize(("change", "kind"), BAD)
def test_what_is_no_quaternion_is_refused(change, kind):
    with pytest.raises(nav.NavsymError) as refusal:
        nav.conventions({**model("rot(q)", {"quaternion": "q"}, q={"vector": 4}), **change})
    assert refusal.value.kind == kind
    assert "expected" in str(refusal.value)


SMALL = {
    "model": {"states": ["dv[3]", "p[3]"], "F": [["0", "-skew(f)"], ["0", "0"]]},
    "parameters": {"f": {"vector": 3}, "C": {"matrix": [3, 3]}},
    "roles": {"velocity": "dv", "attitude": "p"},
    "quantities": {"specific_force": "f", "rotation": "C"},
    "known": {"frame": "inertial"},
}


def test_a_card_that_is_neither_proved_nor_excluded_is_none_of_the_cards():
    near = "-skew(f)*(1 + 1/10**300)"  # closer than every ball
    answer = nav.conventions({**SMALL, "model": {**SMALL["model"], "F": [["0", near], ["0", "0"]]}})
    assert not answer.cards and not answer.complete and answer.undecided and not answer.conflicts


def test_an_entry_that_should_be_zero_is_seen_however_small_it_is():
    tiny = "[[f[1]/10**300, 0, 0], [0, 0, 0], [0, 0, 0]]"
    answer = nav.conventions({**SMALL, "model": {**SMALL["model"], "F": [["0", "-skew(f)"], ["0", tiny]]}})
    (conflict,) = answer.conflicts
    assert not answer.cards and answer.complete and conflict.status == "PROVED" and conflict.entries == ((4, 4),)


REFUSED = [
    ({"quantities": {"rotation": [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "-1"]]}}, "a reflection"),
    ({"quantities": {"rotation": [["C_1_1"] * 3] * 3}}, "a rotation"),
    ({"quantities": {"specific_force": "f", "specific_force_body": "f", "rotation": "C"}}, "a contradiction"),
    ({"quantities": {"specific_force": "f", "radii": "0"}}, "above zero"),
    ({"known": {"frame": "inertial", "axes": "NED"}}, "expected axes|expected frame"),
    ({"known": {"quaternion_order": "scalar first"}}, "quaternion_order"),
    ({"known": {"innovation": "measurement - prediction"}}, "innovation"),
    ({"card": {"frame": "earth"}}, "expected 'earth', as the card says; got 'inertial'"),
    (
        {"parameters": {"f": {"vector": 3}, "C": {"rotation": "b to n"}}, "quantities": {"rotation": ["C", "C"]}},
        "three rows",
    ),
    ({"model": {**SMALL["model"], "G": [["0", "0"], ["C", "0"]]}, "noises": {"gyro": [1, 2, 3]}}, "with a size"),
    *(
        ({"model": {**SMALL["model"], "states": [name, "p[3]"]}}, r"model.states\[0\]: expected a name")
        for name in ("dv[-3]", "dv[3.5]", "dv[x]", "dv[]", "dv[3")
    ),
]


@pytest.mark.parametrize(("change", "words"), REFUSED)
def test_what_contradicts_itself_is_refused_with_its_reason(change, words):
    with pytest.raises(nav.NavsymError, match=words):
        nav.conventions({**SMALL, **change})


def test_a_missing_model_beside_vectors_is_named_as_such():
    with pytest.raises(nav.NavsymError, match="model: expected the key model"):
        nav.conventions({name: table for name, table in SMALL.items() if name != "model"})


@pytest.mark.parametrize("body", ["C.T @ f", "[C[1, 1]*f[1] + C[2, 1]*f[2] + C[3, 1]*f[3], 0, 0]"])
def test_a_quantity_may_be_written_by_the_rotation(body):
    document = {**SMALL, "quantities": {**SMALL["quantities"], "specific_force_body": body}}
    if "0" in body:
        with pytest.raises(nav.NavsymError, match="a contradiction in specific_force"):
            nav.conventions(document)
    else:
        assert len(nav.conventions(document).cards) == len(nav.conventions(SMALL).cards)


def test_the_mended_rows_stand_in_the_order_of_the_states():
    document = {**SMALL, "roles": {"velocity": ["dv_3", "dv_2", "dv_1"], "attitude": ["p_3", "p_2", "p_1"]}}
    document["quantities"] = {"specific_force": ["f_3", "f_2", "f_1"], "specific_force_body": ["f_3", "f_2", "f_1"]}
    document["quantities"]["rotation"] = [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]]
    document["model"] = {
        **SMALL["model"],
        "F": [["0", "[[0, f[3], -f[2]], [-f[3], 0, f[1]], [f[2], f[1], 0]]"], ["0", "0"]],
    }
    (conflict,) = nav.conventions(document).conflicts
    assert conflict.change == "write [[0, f_3, -f_2], [-f_3, 0, f_1], [f_2, -f_1, 0]]"


def test_what_has_no_derivative_at_zero_is_refused():
    document = model("C", {"rotation": "C"}, C={"rotation": "b to n"})
    del document["model"]["F"]
    for more in ("a*dot(p, p)/dot(dv, dv)", "a*sqrt(dot(p, p))"):
        document["model"]["dynamics"] = [f"C @ cross(p, a) + {more}", "cross(p, w)", "0", "0"]
        with pytest.raises(nav.NavsymError, match="a value where the errors or the step are zero"):
            nav.conventions(document)


TEXT = """
[model]
states = ["dv[3]", "p[3]"]
F = [["0", "-skew(f)"], ["0", "0"]]
[parameters]
f = { vector = 3 }
C = { matrix = [3, 3] }
[roles]
velocity = "dv"
attitude = "p"
[quantities]
specific_force = "f"
rotation = "C"
[known]
frame = "inertial"
error = "estimate - truth"
"""


def test_the_verb_converts_a_model_and_prints_latex(tmp_path, capsys):
    file = tmp_path / "model.toml"
    file.write_text(TEXT)
    assert run(["conventions", str(file), "--convert", "rotation_sign=-", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["conversion"]["proved"] is True
    assert [row[3:] for row in data["conversion"]["T"][3:]] == [["-1", "0", "0"], ["0", "-1", "0"], ["0", "0", "-1"]]
    assert run(["conventions", str(file), "--convert", "rotation_sign=-"]) == 0
    assert "F of the new errors" in capsys.readouterr().out
    assert run(["conventions", str(file), "--latex"]) == 0
    assert r"\hat C = \left(E + [\varphi \times]\right) C" in capsys.readouterr().out
    assert run(["conventions", str(file), "--convert", "rotation_sign=*"]) == 2
    assert "expected one of +, -" in capsys.readouterr().err
