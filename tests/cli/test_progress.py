"""Progress is silent for what is quick, estimates the time left, and says how to go on after Ctrl-C."""

from __future__ import annotations

import os
import pty
import select
import subprocess
import sys
import time
from pathlib import Path

import pytest

from navsym.cli._progress import LINE, Progress, duration

ROOT = Path(__file__).parents[2]


class Clock:
    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now


@pytest.mark.parametrize(("seconds", "words"), [(0.4, "0 s"), (59, "59 s"), (125, "2 min 5 s"), (3800, "1 h 3 min")])
def test_durations_are_told_as_people_tell_them(seconds, words):
    assert duration(seconds) == words


def test_the_time_left_is_that_of_the_steps_done_here_and_not_of_those_kept():
    clock = Clock()
    with Progress("jobs", clock=clock) as bar:
        bar.told_by_job(91, 100)
        clock.now = 10.0
        bar.to(92)
        assert bar.words(clock.now, "") == "92 of 100 jobs, about 40 s left"


def test_nothing_is_said_within_two_seconds_and_a_remark_every_ten_without_a_terminal(capsys):
    clock = Clock()
    with Progress("claims", 1000, clock=clock) as bar:
        for _ in range(100):
            clock.now += 0.3
            bar.step("x")
    said = capsys.readouterr().err.splitlines()
    assert [line.split(",")[0] for line in said] == ["7 of 1000 claims", "41 of 1000 claims", "75 of 1000 claims"]


def test_an_interrupted_job_says_what_is_left(capsys):
    with pytest.raises(KeyboardInterrupt), Progress("claims", 5, "the rest is waiting") as bar:
        bar.step()
        raise KeyboardInterrupt
    assert capsys.readouterr().err == "stopped at 1 of 5 claims; the rest is waiting\n"


def test_a_line_never_stays_behind_when_something_else_is_written(monkeypatch, capsys):
    LINE.show("half a line")
    LINE.clear()
    assert capsys.readouterr().err.endswith("\r\x1b[2K") and not LINE.text


PROGRAM = """
import time
from navsym.cli import main
from navsym.cli._progress import Progress
def command():
    with Progress("steps", 1000, "run it again") as bar:
        for _ in range(1000):
            time.sleep(0.05)
            bar.step("working")
main.module_of = lambda verb: "slow"
import sys, types
sys.modules["slow"] = types.SimpleNamespace(command=command)
sys.exit(main.run(["slow"]))
"""


def test_on_a_terminal_the_line_counts_and_ctrl_c_ends_with_130_and_advice():
    outer, inner = pty.openpty()
    env = {**os.environ, "TERM": "xterm", "NO_COLOR": ""}
    command, ends = [sys.executable, "-c", PROGRAM], {"stdin": inner, "stdout": inner, "stderr": inner}
    child = subprocess.Popen(command, cwd=ROOT, env=env, start_new_session=True, **ends)
    os.close(inner)
    seen, sent, end = b"", False, time.monotonic() + 60
    while time.monotonic() < end:
        if select.select([outer], [], [], 0.1)[0]:
            try:
                seen += os.read(outer, 4096)
            except OSError:
                break
        if b"steps, about" in seen and not sent:
            sent = True
            child.send_signal(2)
        if child.poll() is not None and not select.select([outer], [], [], 0.2)[0]:
            break
    os.close(outer)
    assert child.wait(timeout=30) == 130
    assert b"1000 steps, about" in seen and b"; run it again" in seen and b"interrupted" in seen
