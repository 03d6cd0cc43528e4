"""Efficiency of a sweep on several processes against one: the same study, alternately, with the shards thrown away.

    python tests/benchmarks/sweeps.py [jobs] [workers]
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from pathlib import Path

from navsym.methods.sweeps.plan import Sweep, run_job
from navsym.methods.sweeps.run import computed, run_shard, run_sweep
from navsym.methods.sweeps.shards import cut


def seconds_alone(sweep: Sweep, size: int) -> float:
    started = time.perf_counter()
    for part in cut(sweep.jobs, size):
        run_shard(sweep, part)
    return time.perf_counter() - started


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
        alone, together = seconds_alone(sweep, size), seconds_together(sweep, size, workers)
        efficiency = alone / together / workers
        print(f"{jobs} jobs, round {repeat + 1}: alone {alone:.2f} s, {workers} workers {together:.2f} s, "
              f"efficiency {efficiency:.2f}")  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        run_sweep(sweep, workers=workers, folder=Path(folder), size=size)
        print(f"with starting the processes and keeping the shards: {time.perf_counter() - started:.2f} s")


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:]))
