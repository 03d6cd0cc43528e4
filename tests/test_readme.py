"""The commands that the README promises run as they stand there."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

#: Commands that end with another status than 0, by the verb.
STATUS = {"prove": 1}


def commands() -> list[list[str]]:
    """The command lines of the section "Ten minutes", without the bootstrap."""
    section = (ROOT / "README.md").read_text(encoding="utf-8").split("## Ten minutes")[1]
    block = re.search(r"```sh\n(.*?)```", section, re.S)
    assert block is not None
    lines = [line.partition(" #")[0].strip() for line in block.group(1).splitlines()]
    return [shlex.split(line)[2:] for line in lines if line]


def run(words: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """One command, with outputs under a folder of the test."""
    words = [word.replace("build/", f"{folder}/") for word in words]
    environment = {**os.environ, "NAVSYM_CACHE": str(folder / "cache"), "NO_COLOR": "1"}
    command = [sys.executable, "-m", "navsym", *words]
    return subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=600)


def test_the_tour_has_its_steps() -> None:
    assert [words[0] for words in commands()] == [
        "verify", "explain", "prove", "derive", "solve", "phases", "export", "check", "report",
    ]  # fmt: skip


@pytest.mark.slow
def test_the_tour_runs_as_it_stands(tmp_path: Path) -> None:
    for words in commands():
        done = run(words, tmp_path)
        assert done.returncode == STATUS.get(words[0], 0), (words, done.stdout[-2000:], done.stderr[-2000:])
        assert "Traceback" not in done.stderr
    assert (tmp_path / "pages" / "index.html").exists()


@pytest.mark.parametrize(
    "words", [w for w in commands() if w[0] in ("explain", "prove", "derive", "solve")], ids=" ".join
)
def test_the_quick_steps_of_the_tour_run_in_every_run(words: list[str], tmp_path: Path) -> None:
    done = run(words, tmp_path)
    assert done.returncode == STATUS.get(words[0], 0), done.stderr[-2000:]
    assert done.stdout.strip()
