"""solve, phases, check and formulate from the command line: one document, the right keys, the right status."""

from __future__ import annotations

import json

import pytest

from navsym.cli.main import run

MODEL = """
[model]
states = ["y1", "y2", "y3"]
F = [["0", "-1", "0"], ["0", "0", "1"], ["0", "-1", "0"]]
[parameters]
T = ["0", "2*pi"]
[[measurement]]
name = "velocity"
h = ["1", "0", "0"]
sigma = "1"
[interval]
T = "T"
"""
BASIS = """
[basis]
variable = "s"
H = ["1", "s", "2*s"]
interval = ["0", "1"]
[targets]
shown = ["0", "1", "2"]
hidden = ["0", "1", "1"]
"""


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "model.toml"
    path.write_text(MODEL)
    return str(path)


GROWING = """
[model]
states = ["a", "b"]
F = [["0", "t"], ["0", "0"]]
[[measurement]]
name = "position"
h = ["1", "0"]
sigma = "1"
[interval]
T = "1"
[targets]
b = ["0", "1"]
"""


def document(capsys, *arguments):
    status = run([*arguments, "--json"])
    return status, json.loads(capsys.readouterr().out)


def test_solve_writes_a_certificate_that_check_accepts_and_a_forged_one_is_rejected(model, tmp_path, capsys):
    out = tmp_path / "c.json"
    status, data = document(capsys, "solve", model, "--target", "y3", "--set", "T=pi/2", "--out", str(out))
    assert status == 0
    assert data["value"]["lower"].startswith("4.82842712474619009760337744841939")
    assert data["support"][0] == {"measurement": "velocity", "at": "0", "weight": data["support"][0]["weight"]}
    status, data = document(capsys, "check", str(out))
    assert status == 0 and data["checked"][0]["status"] == "ACCEPTED"
    forged = json.loads(out.read_text()) | {"upper": "4.8"}
    out.write_text(json.dumps(forged))
    status, data = document(capsys, "check", str(out))
    assert status == 1 and data["checked"][0]["status"] == "REJECTED" and data["checked"][0]["why"]


def test_an_invisible_target_is_not_estimable(tmp_path, capsys):
    path = tmp_path / "basis.toml"
    path.write_text(BASIS)
    status, data = document(capsys, "solve", str(path), "--target", "hidden")
    assert status == 2 and data["error"]["kind"] == "not-estimable"
    status, data = document(capsys, "solve", str(path), "--target", "shown")
    assert status == 0 and float(data["value"]["upper"]) == pytest.approx(2.0)


def test_a_parameter_without_a_value_is_named(model, capsys):
    status, data = document(capsys, "solve", model, "--target", "y3")
    assert status == 2 and "T" in data["error"]["message"]


@pytest.mark.long
def test_phases_of_the_velocity_problem(model, capsys):
    status, data = document(capsys, "phases", model, "--target", "y3")
    assert status == 0
    assert [b["at"] for b in data["boundaries"]] == ["2*pi/3", "pi"]
    assert {row["status"] for row in data["regimes"]} == {"PROVED"} and data["uncovered"] == []
    assert data["regimes"][1]["value"] == "-1/cos(T)"


def test_a_range_that_is_none_is_bad_input(model, capsys):
    status, data = document(capsys, "phases", model, "--target", "y3", "--range", "1")
    assert status == 2 and data["error"]["kind"] == "syntax"


def test_formulate_writes_mps(model, capsys):
    status, data = document(capsys, "formulate", model, "--target", "y3", "--set", "T=1", "--to", "mps", "--grid", "5")
    assert status == 0 and data["text"].startswith("NAME") and data["text"].endswith("ENDATA\n")


def test_a_certificate_that_is_not_there_is_bad_input_and_no_rejection(tmp_path, capsys):
    status, data = document(capsys, "check", str(tmp_path / "nothing.json"))
    assert status == 2 and data["error"]["kind"] == "missing-file" and "nothing.json" in data["error"]["where"]


def test_fewer_digits_than_asked_for_are_open_with_status_one_and_say_what_is_missing(tmp_path, capsys):
    path = tmp_path / "growing.toml"
    path.write_text(GROWING)
    status, data = document(capsys, "solve", str(path), "--digits", "20")
    assert status == 0 and data["status"] == "CERTIFIED" and "missing" not in data
    status, data = document(capsys, "solve", str(path), "--digits", "80")
    assert status == 1 and data["status"] == "OPEN" and "of the 80 digits" in data["missing"]
    assert run(["solve", str(path), "--digits", "80"]) == 1
    assert data["missing"] in capsys.readouterr().out
