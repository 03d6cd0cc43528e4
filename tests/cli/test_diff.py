"""The verb diff: things of one kind are compared, others are refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from navsym.cli.main import run

EXAMPLES = Path(__file__).parents[2] / "examples"
MODEL, CLAIMS = str(EXAMPLES / "schuler-velocity.toml"), str(EXAMPLES / "formulas.toml")


@pytest.mark.parametrize("pair", [(MODEL, CLAIMS), (CLAIMS, MODEL), (MODEL, "a + b"), ("a + b", MODEL)])
def test_a_model_is_not_compared_with_something_else(pair, capsys):
    assert run(["diff", *pair, "--json"]) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert error["kind"] == "shape" and "a model file" in error["message"]


def test_a_file_is_equal_to_itself(capsys):
    assert run(["diff", MODEL, MODEL, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["equal"]
