"""Sweeps killed at random moments, and two at once in one folder: the rows are those of one that was left alone."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from dataclasses import asdict
from pathlib import Path

import pytest

from navsym.studies.plan import Sweep
from navsym.studies.run import sweep as run_sweep

ROOT = Path(__file__).resolve().parents[2]
STUDY = Sweep("filter", jobs=12, seed=3, runs=16, steps=50)
SECONDS = 300


def started(tmp_path, workers):
    """``navsym sweep`` in a process group of its own."""
    config = tmp_path / "study.json"
    config.write_text(json.dumps(asdict(STUDY)))
    words = ("sweep", str(config), "--workers", str(workers), "--out", str(tmp_path / "s"), "--json")
    return subprocess.Popen(
        [sys.executable, "-m", "navsym", *words], cwd=ROOT, stdout=subprocess.PIPE, start_new_session=True
    )


def processes_of(group):
    """Numbers of the processes of a group that still run."""
    found = []
    for entry in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, pgrp = entry.read_text().rpartition(")")[2].split()[:3]
        except OSError:  # ended meanwhile
            continue
        if int(pgrp) == group and state != "Z":
            found.append(int(entry.parent.name))
    return found


@pytest.mark.slow
@pytest.mark.parametrize("workers", [0, 2])
def test_a_sweep_killed_at_random_moments_goes_on_and_leaves_nothing_running(tmp_path, workers):
    source = random.Random(workers)
    for _ in range(4):
        process = started(tmp_path, workers)
        with process.stdout:
            time.sleep(source.uniform(1.0, 15.0))
            process.send_signal(signal.SIGKILL)  # this one alone: its workers have to notice
            process.wait(SECONDS)
        deadline = time.monotonic() + 60
        while processes_of(process.pid) and time.monotonic() < deadline:
            time.sleep(0.2)
        assert processes_of(process.pid) == []
    found = run_sweep(STUDY, out=tmp_path / "s").document()
    assert json.dumps(found["rows"]) == json.dumps(run_sweep(STUDY, out=tmp_path / "alone").document()["rows"])


@pytest.mark.slow
def test_two_sweeps_at_once_in_one_folder_give_the_rows_of_one(tmp_path):
    both = [started(tmp_path, 0) for _ in range(2)]
    try:
        said = [json.loads(process.communicate(timeout=SECONDS)[0]) for process in both]
    finally:
        for process in both:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
    alone = run_sweep(STUDY, out=tmp_path / "alone").document()["rows"]
    assert said[0]["rows"] == said[1]["rows"] == alone and not said[0]["unsaved"] + said[1]["unsaved"]
