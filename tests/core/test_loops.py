"""Compiled loops work where their machine code cannot be kept, and where what was kept is damaged."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROGRAM = """
import resource, signal, sys
sys.dont_write_bytecode = True  # Python would leave the half of a module where others import it
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
if sys.argv[1:]:
    resource.setrlimit(resource.RLIMIT_FSIZE, (512, resource.RLIM_INFINITY))
from navsym.core.loops import njit
import loops
print(njit()(loops.twice)(21))
"""


def run(folder, *limited):
    cache = {**os.environ, "NUMBA_CACHE_DIR": str(folder / "cache"), "PYTHONPATH": f"{ROOT}{os.pathsep}{folder}"}
    command = [sys.executable, "-c", PROGRAM, *limited]
    return subprocess.run(command, env=cache, capture_output=True, text=True, timeout=300, check=False)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "loops.py").write_text("def twice(x):\n    return 2 * x\n")
    return tmp_path


def test_a_full_disk_costs_time_and_nothing_else(folder):
    ended = run(folder, "small")
    assert ended.stdout == "42\n", ended.stderr
    assert not list(folder.rglob("*.nbi"))


def test_what_was_kept_and_is_damaged_is_compiled_again(folder):
    assert run(folder).stdout == "42\n"
    kept = [*folder.rglob("*.nbi"), *folder.rglob("*.nbc")]
    assert len(kept) == 2
    for file in kept:
        file.write_bytes(file.read_bytes()[:40])
    ended = run(folder)
    assert ended.stdout == "42\n", ended.stderr
    assert {file.stat().st_size > 40 for file in kept} == {True}
