"""The verb and its files: documents, statuses, and errors that name the place."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import navsym as nav
from navsym.cli.main import run
from navsym.language.tomlfile import read_toml
from tests.conventions import models

EXAMPLE = Path(__file__).parents[2] / "examples" / "conventions.toml"


def test_the_example_has_two_cards(capsys):
    assert run(["conventions", str(EXAMPLE), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert [(c["error"], c["rotation_sign"], c["bias_sign"]) for c in data["cards"]] == [
        ("estimate - truth", "-", "truth - estimate"),
        ("truth - estimate", "+", "estimate - truth"),
    ]
    assert data["complete"] is True
    assert data["conflicts"] == []
    assert {"frame", "axes", "attitude_error", "angle", "earth"} <= set(data["cards"][0])


def test_a_changed_sign_has_status_one_and_the_blocks(tmp_path, capsys):
    text = EXAMPLE.read_text()
    for k in (1, 2, 3):
        text = text.replace(f'"-c{k}1", "-c{k}2", "-c{k}3"', f'"c{k}1", "c{k}2", "c{k}3"')
    file = tmp_path / "spoiled.toml"
    file.write_text(text)
    assert run(["conventions", str(file), "--json"]) == 1
    data = json.loads(capsys.readouterr().out)
    assert data["cards"] == []
    assert [(c["block"], c["status"]) for c in data["conflicts"]] == [(["velocity", "accelerometer_bias"], "PROVED")]
    assert run(["conventions", str(file)]) == 1
    assert "change the sign" in capsys.readouterr().out


def test_text_shows_the_card_and_what_excludes_its_neighbours(capsys):
    assert run(["conventions", str(EXAMPLE)]) == 0
    shown = capsys.readouterr().out
    assert "attitude error in the: frame" in shown
    assert "is excluded" in shown
    assert "F[4,7]" in shown


BAD = [
    ({"roles": {"velocity": ["x_v0", "x_v1", "nothing"]}}, "unknown-symbol", "roles.velocity[2]"),
    ({"roles": {"velocity": ["x_v0", "x_v1"]}}, "shape", "roles.velocity"),
    ({"roles": {"velocity": ["x_v0", "x_v1", "x_v1"]}}, "duplicate", "roles.velocity[2]"),
    ({"roles": {"speed": ["x_v0", "x_v1", "x_v2"]}}, "syntax", "roles"),
    ({"roles": {"gyro_bias": ["x_g0", "x_g1", "x_g2"]}}, "empty", "roles"),
    ({"quantities": {"force": ["a1", "a2", "a3"]}}, "syntax", "quantities"),
    ({"quantities": {"specific_force": ["a1", "a2"]}}, "shape", "quantities.specific_force"),
    ({"quantities": {"rotation": ["a1"] * 9}}, "shape", "quantities.rotation"),
    ({"quantities": {"specific_force": ["a1", "a2", "zz"]}}, "unknown-symbol", "quantities.specific_force[2]"),
    ({"quantities": {"rotation": [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "2"]]}}, "domain", "quantities"),
    ({"known": {"frame": "moon"}}, "domain", "known.frame"),
    ({"known": {"frames": "earth"}}, "syntax", "known"),
    ({"parameters": {"unnamed_c00": "real"}}, "domain", "parameters"),
]


@pytest.mark.parametrize(("change", "kind", "where"), BAD)
def test_bad_input_is_named_with_its_place(change, kind, where):
    with pytest.raises(nav.NavsymError) as caught:
        nav.conventions({**models.sola_local(), **change})
    assert caught.value.kind == kind
    assert where in caught.value.where
    assert caught.value.expected and caught.value.remedy


def test_a_matrix_of_another_size_is_refused():
    document = models.sola_local()
    document["model"]["F"].pop()
    with pytest.raises(nav.NavsymError, match="one per state"):
        nav.conventions(document)


@pytest.mark.parametrize("entry", ["10**10**10", "asin(2)"])
def test_an_entry_without_a_value_is_named(entry):
    document = models.sola_local()
    document["model"]["F"][3][7] = entry
    with pytest.raises(nav.NavsymError) as caught:
        nav.conventions(document)
    assert entry[:5] in caught.value.where.replace("(10", "10") and "claim" not in caught.value.where


@pytest.mark.parametrize("value", [None, 5, True, "x"])
@pytest.mark.parametrize("table", ["roles", "quantities", "measured", "noises", "card", "known"])
def test_a_card_file_with_something_else_for_a_table_is_refused(table, value):
    with pytest.raises(nav.NavsymError) as caught:
        nav.conventions({**read_toml(EXAMPLE.parent / "card.toml"), table: value})
    assert caught.value.expected and caught.value.remedy


def test_states_without_a_role_are_named(tmp_path, capsys):
    file = tmp_path / "part.toml"
    file.write_text(EXAMPLE.read_text().replace('accelerometer_bias = ["ba1", "ba2", "ba3"]\n', ""))
    assert run(["conventions", str(file)]) == 0
    assert "not looked at: measurement, ranges, state ba1, state ba2, state ba3" in " ".join(
        capsys.readouterr().out.split()
    )


def test_bad_input_with_json_has_status_two(tmp_path, capsys):
    file = tmp_path / "bad.toml"
    file.write_text('[model]\nstates = ["a"]\nF = [["0"]]\n')
    assert run(["conventions", str(file), "--json"]) == 2
    assert json.loads(capsys.readouterr().out)["error"]["kind"] == "empty"
