"""The verb ``guard``: its document, its states, and files that are no measurements."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from navsym.cli.main import run

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
MODEL = """
[model]
states = ["x", "v"]
F      = [["0", "1"], ["0", "0"]]
[[measurement]]
name  = "place"
h     = ["1", "0"]
sigma = "1"
[[measurement]]
name  = "speed"
h     = ["0", "1"]
sigma = "1/2"
[targets]
v = ["0", "1"]
"""
DATA = "t,place,speed\n0,0,\n1,1.5,\n2,1.75,0.875\n"


@pytest.fixture
def guard(tmp_path, capsys):
    (tmp_path / "model.toml").write_text(MODEL)

    def call(text=DATA, *options):
        (tmp_path / "data.csv").write_bytes(text if isinstance(text, bytes) else text.encode())
        files = [str(tmp_path / "model.toml"), "--data", str(tmp_path / "data.csv")]
        status = run(["guard", *files, *options, "--json"])
        return status, json.loads(capsys.readouterr().out)

    return call


def test_every_epoch_has_its_row(guard):
    status, document = guard()
    assert status == 0 and set(document) == {"epochs", "radius_kind"} and document["radius_kind"] == "bounded"
    first, second, third = document["epochs"]
    keys = {"t", "estimate", "radius", "support", "excluded", "certificate"}
    assert all(set(row) == keys for row in document["epochs"])
    assert first["radius"] is None and first["estimate"] is None and first["certificate"] is None
    assert second["estimate"] == 1.5 and second["support"] == 2 and float(second["radius"]["upper"]) == 2
    assert third["estimate"] == 0.875 and float(third["radius"]["lower"]) == 0.5


def test_the_certificates_are_accepted_by_check(guard, tmp_path, capsys):
    _, document = guard()
    (tmp_path / "proofs").mkdir()
    for k, row in enumerate(document["epochs"][1:]):
        (tmp_path / "proofs" / f"{k}.json").write_text(json.dumps(row["certificate"]))
    assert run(["check", str(tmp_path / "proofs"), "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["checked"]
    assert [(row["kind"], row["status"]) for row in rows] == [("gap", "ACCEPTED")] * 2


def check(capsys, *paths):
    status = run(["check", *map(str, paths), "--json"])
    return status, json.loads(capsys.readouterr().out)


def test_check_finds_the_certificates_in_a_document_and_says_where_there_are_none(guard, tmp_path, capsys):
    path, state = tmp_path / "answer.json", tmp_path / "state.json"
    _, document = guard(DATA, "--state", str(state))
    path.write_text(json.dumps(document))
    status, answer = check(capsys, path)
    assert status == 0 and [row["path"] for row in answer["checked"]] == ["epochs.2", "epochs.3"]
    document["epochs"][2]["certificate"]["upper"] = "1/4"
    path.write_text(json.dumps(document))
    status, answer = check(capsys, path)
    assert status == 1 and [row["status"] for row in answer["checked"]] == ["ACCEPTED", "REJECTED"]
    document["epochs"][1]["certificate"] = "gap"
    path.write_text(json.dumps(document))
    assert [row["status"] for row in check(capsys, path)[1]["checked"]] == ["REJECTED"] * 2
    status, answer = check(capsys, tmp_path / "proofs.json", state) if path.rename(tmp_path / "proofs.json") else None
    assert status == 2 and answer["error"]["kind"] == "empty" and "without" in answer["error"]["message"]


def test_a_state_continues_as_if_the_files_were_one(guard, tmp_path):
    head, *lines = DATA.splitlines()
    state = str(tmp_path / "guard.json")
    _, whole = guard()
    _, first = guard("\n".join([head, *lines[:2]]) + "\n", "--state", state)
    _, second = guard("\n".join([head, *lines[2:]]) + "\n", "--state", state)
    assert first["epochs"] + second["epochs"] == whole["epochs"]
    status, error = guard("t,place\n9,1\n", "--state", state, "--memory", "3")
    assert status == 2 and "another memory" in error["error"]["message"]


def test_a_column_of_bounds_changes_sigma(guard):
    _, document = guard("t,place,sigma place\n0,0,\n1,1,3\n")
    assert float(document["epochs"][1]["radius"]["upper"]) == 4


def test_the_memory_forgets(guard):
    _, document = guard("t,place\n" + "".join(f"{k},{k}\n" for k in range(9)), "--memory", "3")
    assert all(float(row["radius"]["upper"]) == 1 for row in document["epochs"][2:])


def test_data_that_no_state_explains_name_the_epochs(guard):
    status, document = guard("t,place\n0,0\n1,1\n2,90\n")
    error = document["error"]
    assert status == 2 and error["kind"] == "inconsistent" and "0, 1, 2" in error["message"]
    assert "line 4" in error["where"]
    assert guard("t,place\n0,0\n1,1\n2,90\n", "--bound", "variance")[0] == 0


def test_a_gross_error_is_excluded(guard):
    rows = "".join(f"{k},{90 if k == 3 else k}\n" for k in range(8))
    status, document = guard("t,place\n" + rows, "--outliers", "1")
    assert status == 0 and document["radius_kind"] == "outliers" and document["epochs"][-1]["excluded"] == [3.0]


@pytest.mark.parametrize(
    "text, kind",
    [
        ("", "empty"),
        ("t,place\n", "empty"),
        ("place\n1\n", "shape"),
        ("t,place,place\n0,1,1\n", "duplicate"),
        ("t,other\n0,1\n", "unknown-symbol"),
        ("t,place\n0\n", "shape"),
        ("t,place\n0,1,2\n", "shape"),
        ("t,place\n0,nan\n", "not-finite"),
        ("t,place\n0,inf\n", "not-finite"),
        ("t,place\n0,one\n", "syntax"),
        ("t,place\n,1\n", "empty"),
        ("t,place\n1,1\n0,1\n", "domain"),
        ("t,place\n1,1\n1,1\n", "duplicate"),
        ('t,place\n0,"1\n', "syntax"),
        ("t,place,sigma place\n0,1,0\n", "domain"),
        ("t,place\n0,1e999999\n", "syntax"),
        (b"\xff\xfe\x00", "syntax"),
        (b"t,place\n0,\x001\n", "syntax"),
    ],
)
def test_files_that_are_no_measurements_are_refused(guard, text, kind):
    status, document = guard(text)
    assert status == 2 and document["error"]["kind"] == kind and "data.csv" in document["error"]["where"]


def test_long_streams_certify_the_last_epoch(guard):
    _, document = guard("t,place\n" + "".join(f"{k},0\n" for k in range(150)))
    assert [row["certificate"] is not None for row in document["epochs"]] == [False] * 149 + [True]


def test_the_example_runs_and_contains_the_truth(capsys):
    files = [str(EXAMPLES / "guard.toml"), "--data", str(EXAMPLES / "guard.csv")]
    assert run(["guard", *files, "--target", "range", "--outliers", "1", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["epochs"]
    known = [row for row in rows if row["estimate"] is not None]
    assert len(known) > 40 and known[-1]["excluded"] == [18.5]
    for row in known:
        assert abs(row["estimate"] - (1200 - 3.5 * row["t"])) <= float(row["radius"]["upper"])
