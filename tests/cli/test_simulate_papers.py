"""The experiments of the papers from the command line: one JSON document each, and a table for people."""

from __future__ import annotations

import json

import pytest

from navsym.cli.main import run


@pytest.mark.parametrize(
    ("name", "options"), [("joint_correction", []), pytest.param("trajectory", ["--runs", "1"], marks=pytest.mark.long)]
)
def test_an_experiment_is_one_document(name, options, capsys):
    assert run(["simulate", name, *options, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["experiment"] == name and document["rows"]


def test_the_optimal_filter_is_never_worse_than_an_observer(capsys):
    assert run(["simulate", "joint_correction", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["rows"]
    best = next(row["position_m"] for row in rows if row["estimator"].startswith("Kalman"))
    for row in rows:
        assert all(kalman <= 1.001 * other for kalman, other in zip(best, row["position_m"], strict=True))


def test_an_unknown_experiment_names_the_known_ones(capsys):
    assert run(["simulate", "nothing", "--json"]) == 2
    assert "joint_correction" in json.loads(capsys.readouterr().out)["error"]["message"]


@pytest.mark.parametrize(
    ("name", "option"), [("trajectory", "--steps"), ("joint_correction", "--runs"), ("joint_correction", "--steps")]
)
def test_an_option_that_an_experiment_does_not_have_is_bad_input(name, option, capsys):
    assert run(["simulate", name, option, "2", "--json"]) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert error["kind"] == "domain" and error["where"] == option


@pytest.mark.parametrize("options", [["--seed", "-1"], ["--runs", "0"], ["--runs", "-4"]])
def test_numbers_that_no_experiment_can_use_are_bad_input(options, capsys):
    assert run(["simulate", "trajectory", *options, "--json"]) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert error["kind"] == "domain" and error["where"] == options[0] and options[1] in error["message"]
