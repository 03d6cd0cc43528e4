"""Running a study: in this process, in processes of this machine, or on a dask cluster.

A task is one shard of consecutive jobs. Its rows depend on the configuration and the indices only, so that
neither the number of workers nor the death of one changes a bit; what is kept is not computed again.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from navsym.errors import MissingEngineError, NavsymError
from navsym.methods.sweeps.plan import Sweep, fingerprint, run_job, summary
from navsym.methods.sweeps.shards import Rows, Shards, cut, default_folder
from navsym.methods.verification.dependencies import rooms_digest
from navsym.store import key_of

SECONDS_TO_CONNECT = 15
DEATHS = 10  # of workers under one shard before it is given up
#: One worker is one thread: a shard whose loops take all cores is in the way of the others.
ALONE = {f"{name}_NUM_THREADS": 1 for name in ("NUMBA", "OMP", "OPENBLAS", "MKL")}


def run_sweep(
    sweep: Sweep,
    *,
    workers: int = 0,
    scheduler: str | None = None,
    folder: Path | None = None,
    size: int | None = None,
    fresh: bool = False,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> dict[str, Any]:
    """Compute the shards that are not kept, keep each as it comes, and sum up.

    workers   : processes of this machine; 0 computes in this one
    scheduler : ``tcp://host:port`` of a running dask scheduler, instead of processes of this machine
    folder    : where the shards are; by default in the cache
    size      : jobs in a shard

    The document of ``navsym sweep``: that of :func:`summary` with ``resumed`` (jobs that were kept),
    ``folder`` and ``unsaved`` (shards that could not be kept). Raises MissingEngineError without dask,
    pyarrow or an answer of the scheduler.
    """
    study = key_of("sweep", fingerprint(sweep), rooms_digest())
    shards = Shards(folder or default_folder(study), study)
    parts = cut(sweep.jobs, size)
    known = {} if fresh else {part: rows for part in parts if (rows := shards.read(part)) is not None}
    found, unsaved = dict(known), []
    done = sum(len(part) for part in known)
    missing = [part for part in parts if part not in known]
    progress(done, sweep.jobs)
    with computed(sweep, missing, workers, scheduler) as results:
        for part, rows in results:
            found[part] = rows
            try:
                shards.write(part, rows)
            except OSError as error:
                unsaved.append(f"{shards.path(part).name}: {error.strerror or error}")
            done += len(part)
            progress(done, sweep.jobs)
    rows = [row for part in parts for row in found.get(part, [])]
    resumed = sum(len(part) for part in known)
    return {**summary(sweep, rows), "resumed": resumed, "folder": str(shards.folder), "unsaved": unsaved}


def run_shard(sweep: Sweep, part: range) -> tuple[range, str, Rows]:
    """The rows of a shard, with the digest of the code that made them."""
    return part, rooms_digest(), [run_job(sweep, index) for index in part]


@contextlib.contextmanager
def computed(
    sweep: Sweep, parts: Sequence[range], workers: int, scheduler: str | None
) -> Iterator[Iterator[tuple[range, Rows]]]:
    """Shards as they are ready."""
    if not parts or (workers == 0 and scheduler is None):
        yield ((part, run_shard(sweep, part)[2]) for part in parts)
        return
    with connected(workers, scheduler) as (client, as_completed):
        # Not pure: a shard is computed again rather than taken from another session's cluster memory.
        futures = [client.submit(run_shard, sweep, part, pure=False, retries=DEATHS) for part in parts]
        yield (checked(answer(future)) for future in as_completed(futures))


def answer(future: Any) -> tuple[range, str, Rows]:
    """What a worker sent; an error in words when the scheduler is gone or a shard ended too many workers."""
    from concurrent.futures import CancelledError

    from dask.distributed import KilledWorker

    try:
        found: tuple[range, str, Rows] = future.result()
    except CancelledError:
        message = "expected the scheduler to stay; got a lost connection; start it, and the same command goes on"
        raise MissingEngineError(message, where="sweep") from None
    except KilledWorker:
        message = f"expected workers that live; got {DEATHS} that died over one shard; give them more memory"
        raise NavsymError(message, where="sweep") from None
    return found


def checked(result: tuple[range, str, Rows]) -> tuple[range, Rows]:
    part, rooms, rows = result
    if rooms != rooms_digest():
        message = "expected workers with the code of this process; got another version; install the same one"
        raise NavsymError(message, where="sweep")
    return part, rows


@contextlib.contextmanager
def hushed(name: str) -> Iterator[None]:
    """No tracebacks in the log of a library whose errors are said here."""
    logger = logging.getLogger(name)
    before = logger.level
    logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        logger.setLevel(before)


@contextlib.contextmanager
def connected(workers: int, scheduler: str | None) -> Iterator[tuple[Any, Any]]:
    """A client of the scheduler, or of processes that live as long as the block."""
    try:
        import dask
        from dask.distributed import Client, LocalCluster, as_completed
    except ModuleNotFoundError:
        message = "expected the Python package dask.distributed; got none; install navsym[cluster], or --workers 0"
        raise MissingEngineError(message) from None
    with contextlib.ExitStack() as stack:
        stack.enter_context(hushed("distributed"))
        stack.enter_context(dask.config.set({
            "distributed.scheduler.allowed-failures": DEATHS,
            "distributed.nanny.pre-spawn-environ": dask.config.get("distributed.nanny.pre-spawn-environ") | ALONE,
        }))  # fmt: skip
        where = scheduler
        if where is None:
            where = stack.enter_context(
                LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None)
            )
        else:
            greet(where)
        yield stack.enter_context(Client(where, timeout=SECONDS_TO_CONNECT)), as_completed


def greet(address: str) -> None:
    """Make sure that a scheduler answers, in a thread of its own (a notebook has a loop running in this one).

    Raises MissingEngineError when none does.

    A client that fails to connect is left to the garbage collector, which closes it at any later moment. When
    that is the start of another client, each waits for the other's lock, for ever: clients are made for
    schedulers that have answered.
    """
    from distributed.core import rpc

    async def identity() -> dict[str, Any]:
        async with rpc(address, timeout=SECONDS_TO_CONNECT) as scheduler:
            return await asyncio.wait_for(scheduler.identity(), SECONDS_TO_CONNECT)

    try:
        with ThreadPoolExecutor(1) as thread:
            kind = thread.submit(lambda: asyncio.run(identity())).result().get("type")
        got = f"an answer of a {kind}"
    except Exception as error:  # dask asserts what an address may be, and what a stranger sends can raise anything
        kind, got = None, f"no answer ({type(error).__name__}: {error!s:.80})"
    if kind != "Scheduler":
        message = f"expected a dask scheduler; got {got}; start one: dask scheduler"
        raise MissingEngineError(message, where=address)
