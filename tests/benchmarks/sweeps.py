"""Efficiency of a sweep on several processes against one: the same study, alternately, with the shards thrown away.

Every process has one thread. The same shards in processes that share nothing show what the cores of this machine
give: two that are halves of one core are not twice as fast, whoever hands out the work.

    python tests/benchmarks/sweeps.py [jobs] [workers]
"""

from __future__ import annotations

import multiprocessing
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from navsym.studies.cluster import ALONE
from navsym.studies.plan import Sweep, run_job
from navsym.studies.run import computed, cut, run_shard
from navsym.studies.run import sweep as run_sweep

os.environ.update({name: str(count) for name, count in ALONE.items()})  # before numba is loaded


def seconds_alone(sweep: Sweep, size: int) -> float:
    started = time.perf_counter()
    for part in cut(sweep.jobs, size):
        run_shard(sweep, part)
    return time.perf_counter() - started


def seconds_apart(sweep: Sweep, size: int, workers: int) -> float:
    """Every process has its own part of the shards, and nobody hands anything out."""
    context, parts = multiprocessing.get_context("spawn"), cut(sweep.jobs, size)
    barrier = context.Barrier(workers + 1)
    own = [(sweep, parts[k::workers], barrier) for k in range(workers)]
    processes = [context.Process(target=run_parts, args=arguments) for arguments in own]
    for process in processes:
        process.start()
    barrier.wait()
    started = time.perf_counter()
    barrier.wait()
    spent = time.perf_counter() - started
    for process in processes:
        process.join()
    return spent


def run_parts(sweep: Sweep, parts: list[range], barrier: Any) -> None:
    """All begin together, with their engines loaded, and the last one ends it."""
    run_job(sweep, 0)
    barrier.wait()
    for part in parts:
        run_shard(sweep, part)
    barrier.wait()


def seconds_together(sweep: Sweep, size: int, workers: int) -> float:
    """The shards alone, after the processes have started and loaded their engines."""
    with computed(Sweep(sweep.kind, workers * 4), cut(workers * 4, 1), workers, None) as warm:
        list(warm)
        return seconds_of_client(sweep, size)


def seconds_of_client(sweep: Sweep, size: int) -> float:
    from dask.distributed import as_completed, default_client

    client, started = default_client(), time.perf_counter()
    futures = [client.submit(run_shard, sweep, part, pure=False) for part in cut(sweep.jobs, size)]
    for future in as_completed(futures):
        future.result()
    return time.perf_counter() - started


def main(jobs: int = 48, workers: int = os.cpu_count() or 1) -> None:
    sweep, size = Sweep("filter", jobs=jobs, runs=64, steps=200), max(1, jobs // (8 * workers))
    run_job(sweep, 0)
    for repeat in range(2):
        alone, apart = seconds_alone(sweep, size), seconds_apart(sweep, size, workers)
        together = seconds_together(sweep, size, workers)
        print(
            f"{jobs} jobs, round {repeat + 1}: alone {alone:.2f} s, {workers} workers {together:.2f} s, "
            f"efficiency {alone / together / workers:.2f}; {workers} processes that share nothing {apart:.2f} s, "
            f"efficiency {alone / apart / workers:.2f}"
        )
    with tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        run_sweep(sweep, workers=workers, out=Path(folder), size=size).document()
        print(f"with starting the processes and keeping the shards: {time.perf_counter() - started:.2f} s")


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:]))
