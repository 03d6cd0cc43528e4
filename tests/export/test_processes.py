"""Programs that are started end, with all that they started."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import pytest

from navsym.export import processes

CHILD = """
import pathlib, subprocess, sys, time
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
pathlib.Path("child").write_text(str(child.pid))
time.sleep(60)
"""


def test_a_program_that_does_not_end_is_ended_with_its_children(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(processes, "SECONDS", 3)
    start = time.monotonic()
    status, said = processes.run([sys.executable, "-c", CHILD], tmp_path)
    assert (status, said) == (-1, "stopped after 3 s") and time.monotonic() - start < 30
    pid = int((tmp_path / "child").read_text())
    for _ in range(100):
        if not alive(pid):
            return
        time.sleep(0.1)
    pytest.fail("the child of the program still runs")


def alive(pid: int) -> bool:
    """False for a process that is gone, or has ended and waits to be collected."""
    try:
        os.kill(pid, 0)
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_a_program_that_waits_for_input_gets_none(tmp_path: Path) -> None:
    assert processes.run([sys.executable, "-c", "print(len(input()))"], tmp_path)[0] == 1


def test_output_that_is_no_text_is_no_traceback(tmp_path: Path) -> None:
    code = "import sys; sys.stdout.buffer.write(bytes([255, 254])); sys.exit(3)"
    status, said = processes.run([sys.executable, "-c", code], tmp_path)
    assert status == 3 and len(said) == 2


def test_a_program_that_is_not_there_is_said_in_words(tmp_path: Path) -> None:
    assert processes.run(["no-such-program-at-all"], tmp_path) == (-1, "No such file or directory")
