"""A real scheduler and real workers on the loopback, started and stopped here: they change nothing in the rows."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from navsym.core.errors import MissingEngineError
from navsym.studies import cluster
from navsym.studies.plan import Sweep
from navsym.studies.run import sweep as run_sweep

ROOT = Path(__file__).resolve().parents[2]
STUDY = Sweep("filter", jobs=24, seed=3, runs=4, steps=6)


def dask(*words):
    """A dask command of this environment, in a process group of its own."""
    command = [str(Path(sys.executable).with_name("dask")), *words]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.Popen(
        command, cwd=ROOT, env=environment, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )


@contextlib.contextmanager
def stopped(processes):
    try:
        yield processes
    finally:
        for process in processes:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


@pytest.fixture
def scheduler(tmp_path):
    """Address of a scheduler, and a list to which its workers are added."""
    file = tmp_path / "scheduler.json"
    words = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--no-show", "--scheduler-file", str(file))
    with stopped([dask("scheduler", *words)]) as processes:
        for _ in range(600):
            with contextlib.suppress(OSError, ValueError):
                address = json.loads(file.read_text())["address"]
                break
            time.sleep(0.1)
        else:
            pytest.fail("the scheduler did not start")
        yield address, processes


def workers(address, count, folder):
    words = (address, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--local-directory", str(folder))
    return [dask("worker", *words) for _ in range(count)]


@pytest.mark.long
def test_two_workers_on_a_scheduler_give_the_bits_of_one_process(scheduler, tmp_path):
    address, processes = scheduler
    processes += workers(address, 2, tmp_path)
    alone = run_sweep(STUDY, out=tmp_path / "alone", size=3).document()
    together = run_sweep(STUDY, scheduler=address, out=tmp_path / "together", size=3).document()
    assert json.dumps(alone["rows"]) == json.dumps(together["rows"])
    shards = [sorted((tmp_path / name).iterdir()) for name in ("alone", "together")]
    assert [path.read_bytes() for path in shards[0]] == [path.read_bytes() for path in shards[1]]


@pytest.mark.long
def test_a_worker_killed_midway_changes_nothing(scheduler, tmp_path):
    address, processes = scheduler
    processes += workers(address, 2, tmp_path)
    victim, seen = processes[-1], []

    def progress(done, of):
        seen.append(done)
        if done >= 6 and victim.poll() is None:
            os.killpg(victim.pid, signal.SIGKILL)
            victim.wait()

    found = run_sweep(STUDY, scheduler=address, out=tmp_path / "s", size=1, progress=progress).document()
    assert victim.poll() is not None and found["done"] == STUDY.jobs and seen[-1] == STUDY.jobs
    assert json.dumps(found["rows"]) == json.dumps(run_sweep(STUDY, out=tmp_path / "alone").document()["rows"])


# -- what never comes is not waited for ------------------------------------------------------------


@pytest.fixture
def hasty(monkeypatch):
    monkeypatch.setattr(cluster, "SECONDS_TO_ANSWER", 3.0)
    monkeypatch.setattr(cluster, "SECONDS_BETWEEN_LOOKS", 0.5)


def stricken(process, sent):
    """A progress that sends a signal to the group of a process when three jobs are done."""

    def progress(done, of):
        if done >= 3 and process.poll() is None:
            os.killpg(process.pid, sent)

    return progress


def test_a_scheduler_without_workers_is_given_up_in_words(scheduler, tmp_path, hasty):
    address, _ = scheduler
    with pytest.raises(MissingEngineError, match=f"none for 2 s; start some .dask worker {address}"):
        run_sweep(STUDY, scheduler=address, out=tmp_path / "s", patience=2).document()


@pytest.mark.slow
def test_workers_that_all_die_midway_are_not_waited_for(scheduler, tmp_path, hasty):
    address, processes = scheduler
    processes += workers(address, 1, tmp_path)
    dying = stricken(processes[-1], signal.SIGKILL)
    with pytest.raises(MissingEngineError, match="expected workers; got none for 10 s"):
        run_sweep(STUDY, scheduler=address, out=tmp_path / "s", size=1, progress=dying, patience=10).document()
    assert 3 <= run_sweep(STUDY, out=tmp_path / "s", size=1).document()["resumed"] < STUDY.jobs


@pytest.mark.slow
@pytest.mark.parametrize("sent", [signal.SIGKILL, signal.SIGSTOP], ids=["dead", "silent"])
def test_a_scheduler_lost_midway_is_said_and_its_finished_shards_are_kept(scheduler, tmp_path, hasty, sent):
    address, processes = scheduler
    processes += workers(address, 1, tmp_path)
    losing = stricken(processes[0], sent)
    with pytest.raises(MissingEngineError, match="the same command goes on"):
        run_sweep(STUDY, scheduler=address, out=tmp_path / "s", size=1, progress=losing).document()
    found = run_sweep(STUDY, out=tmp_path / "s", size=1).document()
    assert 3 <= found["resumed"] < STUDY.jobs and found["done"] == STUDY.jobs


@pytest.mark.slow
@pytest.mark.parametrize("sent", [signal.SIGKILL, signal.SIGSTOP], ids=["dead", "silent"])
def test_a_scheduler_lost_between_its_greeting_and_its_work_is_said(scheduler, tmp_path, hasty, sent, monkeypatch):
    address, processes = scheduler
    greet = cluster.greet

    def last_words(where):
        told = greet(where)
        os.killpg(processes[0].pid, sent)
        return told

    monkeypatch.setattr(cluster, "greet", last_words)
    with pytest.raises(MissingEngineError, match="no answer to a client"):
        run_sweep(STUDY, scheduler=address, out=tmp_path / "s").document()
    monkeypatch.setattr(cluster, "greet", greet)
    assert run_sweep(STUDY, workers=1, out=tmp_path / "s").document()["done"] == STUDY.jobs  # the next client lives


@pytest.mark.slow
def test_two_processes_of_this_machine_give_the_bits_of_one(tmp_path):
    alone = run_sweep(STUDY, out=tmp_path / "alone", size=3).document()
    before = dict(os.environ)
    together = run_sweep(STUDY, workers=2, out=tmp_path / "together", size=3).document()
    assert {name: os.environ.get(name) for name in cluster.ALONE} == {name: before.get(name) for name in cluster.ALONE}
    assert json.dumps(alone["rows"]) == json.dumps(together["rows"])
