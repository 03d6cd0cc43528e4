"""The doctor: what is required decides the status, everything missing comes with advice."""

from __future__ import annotations

import json
import os
import tomllib
from pathlib import Path

import pytest

from navsym.cli import main
from navsym.core import machine
from navsym.core.machine import Equipment

HEALTHY = Equipment("sympy", True, True, "1.14", "")
OPTIONAL = Equipment("julia", False, False, "", "for exported Julia: install julia")
LACKING = Equipment("flint", True, False, "", "install it")


def answers(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *findings: Equipment
) -> tuple[int, str]:
    """Status and output of ``navsym doctor --json`` on a machine with these findings."""
    monkeypatch.setattr(machine, "examine", lambda: list(findings))
    return main.run(["doctor", "--json"]), capsys.readouterr().out


def test_optional_things_may_be_missing(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    status, out = answers(monkeypatch, capsys, HEALTHY, OPTIONAL)
    assert status == 0 and json.loads(out)["complete"] is True


def test_required_things_may_not(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    status, out = answers(monkeypatch, capsys, HEALTHY, LACKING)
    assert status == 3 and json.loads(out)["missing"] == ["flint"]


def test_the_table_says_what_to_do(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(machine, "examine", lambda: [HEALTHY, OPTIONAL, LACKING])
    assert main.run(["doctor"]) == 3
    out = capsys.readouterr().out
    assert "for exported Julia: install julia" in out and "something required is missing" in out


def test_an_engine_that_crashes_on_import_is_a_finding(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "crashing.py").write_text("import os\nos.abort()\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    found = machine.engine("crashing", "crashing")
    assert found.required and not found.found and "bootstrap.py" in found.advice


def test_an_engine_that_is_there_is_found() -> None:
    found = machine.engine("msgspec", "msgspec")
    assert found.found and found.version and not found.advice


@pytest.mark.skipif(os.name == "nt", reason="a shell script stands in for the program")
def test_a_program_that_does_not_answer_is_not_there(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    script = tmp_path / "cc"
    script.write_text("#!/bin/sh\nexit 1\n")
    script.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert not machine.program("C compiler", machine.PROGRAMS["C compiler"]).found
    script.write_text("#!/bin/sh\necho cc 1.2\n")
    assert machine.program("C compiler", machine.PROGRAMS["C compiler"]).version == "cc 1.2"


def test_a_data_folder_that_is_not_there_is_said(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("NAVSYM_DATA", str(tmp_path / "no"))
    assert not machine.data_folder().found
    monkeypatch.setenv("NAVSYM_DATA", str(tmp_path))
    assert machine.data_folder().found


def test_a_file_in_place_of_the_cache_folder_is_a_fault(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file" / "cache"))
    assert not machine.cache_folder().found
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "not yet"))
    assert machine.cache_folder().found


def test_the_doctor_knows_every_engine_and_extra_of_the_project() -> None:
    root = Path(__file__).resolve().parents[2]
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    assert set(machine.ENGINES.values()) <= {name.split(">")[0] for name in project["dependencies"]}
    for distribution in machine.EXTRAS:
        assert any(name.startswith(distribution) for names in extras.values() for name in names)
    # no path of a checkout: a user of the wheel has none
    assert machine.extra("no-such", "maps").advice == "for maps: python -m pip install no-such in the environment"
