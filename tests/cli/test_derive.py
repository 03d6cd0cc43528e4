"""The verb derive: one document, or text, or LaTeX; bad input is status 2."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from navsym.cli import main

MODEL = """
[model]
name   = "schuler"
states = ["v", "phi", "eps"]
F      = [["0", "-g", "0"], ["1/R", "0", "1"], ["0", "0", "0"]]
[parameters]
g = "positive"
R = "positive"
T = "positive"
[[measurement]]
name = "velocity"
h    = ["1", "0", "0"]
[interval]
T = "T"
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "model.toml"
    path.write_text(MODEL, encoding="utf-8")
    return path


def test_the_document_holds_every_part(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main.run(["derive", str(file), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["F"] == [[["0", "-g", "0"], ["1/R", "0", "1"], ["0", "0", "0"]]]
    assert data["transition"][0]["matrix"][0][0] == "cos(t*sqrt(g)/sqrt(R))"
    assert [item["form"] for item in data["transition"][0]["characteristic"]] == ["constant", "trigonometric"]
    assert data["observability_matrix"][1] == ["0", "-g", "0"]
    assert [c["target"] for c in data["conditions"]] == ["v", "phi", "eps"]
    assert data["assumptions"] == []
    assert "latex" not in data


def test_latex_goes_to_the_page_and_into_the_document(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main.run(["derive", str(file), "--latex"]) == 0
    assert r"\Phi(t) = \begin{pmatrix}" in capsys.readouterr().out
    assert main.run(["derive", str(file), "--latex", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["latex"]["F"][0][0][1] == "- g"


def test_a_parameter_may_be_set_and_the_text_written_to_a_file(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "page.txt"
    assert main.run(["derive", str(file), "--set", "R=1", "--set", "g=4", "--out", str(page)]) == 0
    assert "cos(2*t)" in page.read_text(encoding="utf-8")
    assert page.read_text(encoding="utf-8") == capsys.readouterr().out


@pytest.mark.parametrize(
    ("old", "new", "options", "kind"),
    [
        ('"-g"', '"-g*t"', [], "domain"),
        ('"-g"', '"-k"', [], "unknown-symbol"),
        ('"-g", ', "", [], "shape"),
        ('"-g"', "'__import__(\"os\")'", [], "syntax"),
        ("", "", ["--set", "g"], "syntax"),
        ("", "", ["--set", "g=0"], "domain"),
    ],
)
def test_bad_input_has_a_kind_and_a_place(
    file: Path, capsys: pytest.CaptureFixture[str], old: str, new: str, options: list[str], kind: str
) -> None:
    file.write_text(MODEL.replace(old, new, 1) if old else MODEL, encoding="utf-8")
    assert main.run(["derive", str(file), "--json", *options]) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert error["where"]
    assert (error["kind"] == kind) or (kind == "syntax" and error["kind"] == "unknown-symbol")


def test_the_transition_matrix_and_the_observed_rank_come_with_proofs_that_check_accepts(file, tmp_path, capsys):
    proofs = tmp_path / "proofs.json"
    assert main.run(["derive", str(file), "--certificate", str(proofs)]) == 0
    assert main.run(["check", str(proofs)]) == 0
    kinds = [part["kind"] for part in json.loads(proofs.read_text())["of"]]
    assert kinds == ["exponential", "rank"]
    capsys.readouterr()
