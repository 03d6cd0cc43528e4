"""Inputs guided by coverage: a few hundred here, a million by ``navsym campaign fuzz``."""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from pathlib import Path

import pytest

from navsym.cli.main import run
from navsym.core.errors import MissingEngineError
from tests.attacks.campaigns import fuzz
from tests.attacks.campaigns.parser import OUTCOMES, answer
from tests.attacks.campaigns.readers import READERS

FOUND = Path(__file__).parent / "found"

guided = pytest.mark.skipif(
    importlib.util.find_spec("atheris") is None,
    reason="atheris is not installed: python3 bootstrap.py extras, on Linux and x86-64",
)


@pytest.mark.long
@guided
def test_guided_inputs_are_read_or_refused_and_what_reached_new_lines_is_kept(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("NAVSYM_CACHE", str(tmp_path))
    monkeypatch.setattr(fuzz, "READERS", {"bank": READERS["bank"]})
    assert run(["campaign", "fuzz", "--inputs", "800", "--json"]) == 0
    first = json.loads(capsys.readouterr().out)
    assert sum(first["counts"].values()) >= 800 and set(first["counts"]) <= {*OUTCOMES}
    assert first["measured"]["bank"]["reached"] > 50 and not first["wrong"]
    kept = set((tmp_path / "corpus" / "bank").iterdir())
    assert len(kept) > 5
    assert run(["campaign", "fuzz", "--inputs", "800", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["resumed"] == first["batches"]


@guided
def test_a_reader_that_crashes_is_noticed_with_its_input_and_a_library_that_dies_too(tmp_path):
    crash = wrong_of(tmp_path, "lambda data: 1 / 0")
    assert crash[0]["why"].startswith("ZeroDivisionError") and "data" in crash[0] and len(crash) == 1
    death = wrong_of(tmp_path, "lambda data: __import__('ctypes').string_at(0) if data != b'{}' else 0")
    assert [(item["why"], item["reader"]) for item in death] == [("crash", "bank")]


def wrong_of(folder, reader):
    """What a round says of a reader that is this Python text in the process that is guided."""
    program = (
        "import runpy, sys\n"
        "from tests.attacks.campaigns import readers\n"
        f"readers.READERS['bank'] = ({reader}, b'{{}}')\n"
        "runpy.run_module('tests.attacks.campaigns.guided', run_name='__main__')\n"
    )
    inside = folder / str(len(list(folder.iterdir())))
    inside.mkdir()
    words = ["bank", str(inside), "-runs=300", "-seed=1", f"-artifact_prefix={inside}/end-"]
    command, root = [sys.executable, "-c", program, *words], Path(__file__).parents[2]
    told = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False, timeout=300)
    return fuzz.read_round("bank", inside, told)["wrong"]


def test_without_the_engine_the_campaign_says_what_to_install(monkeypatch, tmp_path):
    monkeypatch.setattr(fuzz.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(MissingEngineError, match=r"navsym\[fuzz\]"):
        fuzz.make_batches(100, tmp_path)


@pytest.mark.parametrize("path", sorted(FOUND.glob("*/*")), ids=lambda path: f"{path.parent.name}-{path.name}")
def test_what_once_crashed_a_reader_is_read_or_refused(path):
    assert answer(READERS[path.parent.name][0], path.read_bytes()) in OUTCOMES
