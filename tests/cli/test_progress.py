"""Progress is silent for what is quick, estimates the time left, and says how to go on after Ctrl-C."""

from __future__ import annotations

import importlib
import os
import pty
import select
import subprocess
import sys
import time
from pathlib import Path

import pytest

from navsym.cli._progress import LINE, Progress, Ticker, duration
from navsym.cli.main import stopped

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
        bar.follow(91, 100)
        clock.now = 10.0
        bar.to(92)
        assert bar.words(clock.now, "") == "92 of 100 jobs, about 40 s left"


def counted(clock):
    with Progress("claims", 1000, clock=clock) as bar:
        for _ in range(100):
            clock.now += 0.3
            bar.step("x")


def test_without_a_terminal_nothing_is_said(capsys, monkeypatch):
    monkeypatch.delenv("NAVSYM_PROGRESS", raising=False)
    counted(Clock())
    assert capsys.readouterr() == ("", "")


def test_a_log_that_asks_for_it_gets_a_remark_every_ten_seconds(capsys, monkeypatch):
    monkeypatch.setenv("NAVSYM_PROGRESS", "1")
    counted(Clock())
    said = capsys.readouterr().err.splitlines()
    assert [line.split(",")[0] for line in said] == ["7 of 1000 claims", "41 of 1000 claims", "75 of 1000 claims"]


def test_the_total_may_grow_while_a_job_finds_out_what_it_has_to_do():
    clock = Clock()
    with Progress("steps", clock=clock) as bar:
        bar.follow(1, 2)
        clock.now = 12.0
        bar.follow(3, 7)
        assert bar.words(clock.now, "") == "3 of 7 steps, about 16 s left"


def told_by(study, **options):
    """What a study tells while it runs: pairs (finished, all)."""
    told = []
    study(progress=lambda done, of: told.append((done, of)), **options)
    return told


@pytest.mark.parametrize(
    ("module", "name", "options"),
    [
        pytest.param(
            "navsym_papers.multistructure.experiment.study", "study", {"runs": 2, "steps": 2}, marks=pytest.mark.long
        ),
        pytest.param("navsym_papers.trajectory.experiment.study", "study", {"runs": 1}, marks=pytest.mark.long),
        ("navsym_papers.joint_correction.experiment.study", "study", {}),
    ],
)
def test_an_experiment_counts_every_step_to_the_last(module, name, options):
    told = told_by(getattr(importlib.import_module(module), name), **options)
    assert len(told) >= 10 and told == [(k, len(told)) for k in range(1, len(told) + 1)]


def test_between_two_steps_the_ticker_goes_on_with_the_count():
    clock = Clock()
    ticker = Ticker("phases")
    with Progress("steps", 8, clock=clock) as bar:
        assert ticker.words(3.0, LINE.job) == "phases: working for 3 s, Ctrl-C stops it"
        bar.step("a regime")
        clock.now = 6.0
        assert ticker.words(9.0, LINE.job) == "1 of 8 steps, about 42 s left  a regime"
    assert LINE.job is None


def test_an_interrupted_job_says_what_is_left(capsys):
    with pytest.raises(KeyboardInterrupt) as caught, Progress("claims", 5, "the rest is waiting") as bar:
        bar.step()
        raise KeyboardInterrupt
    assert stopped(caught.value) == 130
    assert capsys.readouterr().err == "navsym: interrupted at 1 of 5 claims; the rest is waiting\n"


def test_a_verb_that_cannot_count_says_that_nothing_is_kept(capsys):
    assert stopped(KeyboardInterrupt()) == 130
    assert capsys.readouterr().err == "navsym: interrupted and nothing is kept: the same command starts again\n"


def test_a_line_never_stays_behind_when_something_else_is_written(monkeypatch, capsys):
    LINE.show("half a line")
    LINE.clear()
    assert capsys.readouterr().err.endswith("\r\x1b[2K") and not LINE.text


# A test that runs in the background inherits an ignored interrupt.
PROGRAM = """
import signal, time
signal.signal(signal.SIGINT, signal.default_int_handler)
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
