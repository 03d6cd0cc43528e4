"""Shards computed by dask workers: a scheduler greeted, watched while nothing comes, and every failure said in words.

Nothing here waits for ever: who does not answer within :data:`SECONDS_TO_ANSWER` is given up, and so is a
scheduler that has had no worker for longer than the caller is patient.
"""

from __future__ import annotations

import asyncio
import contextlib
import gc
import logging
import os
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError, Future, InvalidStateError, ThreadPoolExecutor
from threading import Thread
from typing import Any, NoReturn

from navsym.core.errors import MissingEngineError, NavsymError

SECONDS_TO_ANSWER = 15.0
SECONDS_BETWEEN_LOOKS = 5.0  # at a scheduler from which nothing comes
PATIENCE = 120.0  # seconds without any worker
PAUSE = 0.02  # between two looks at the results
DEATHS = 10  # of workers under one shard before it is given up
AGAIN = "the same command goes on"
#: One worker is one thread: a shard whose loops take all cores is in the way of the others.
ALONE = {f"{name}_NUM_THREADS": 1 for name in ("NUMBA", "OMP", "OPENBLAS", "MKL")}


@contextlib.contextmanager
def cluster(workers: int, scheduler: str | None) -> Iterator[Any]:
    """A client of the scheduler, or of so many processes that live as long as the block.

    Raises MissingEngineError without dask, or when no scheduler answers.
    """
    try:
        import dask
        from dask.distributed import LocalCluster
    except ModuleNotFoundError:
        message = "expected the Python package dask.distributed; got none; install navsym[cluster], or --workers 0"
        raise MissingEngineError(message) from None
    with contextlib.ExitStack() as stack:
        stack.enter_context(hushed("distributed"))
        stack.enter_context(environment_restored())
        spawned = "distributed.nanny.pre-spawn-environ"
        settings = {"distributed.scheduler.allowed-failures": DEATHS, spawned: dask.config.get(spawned) | ALONE}
        stack.enter_context(dask.config.set(settings))
        if scheduler is None:
            local = LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address="127.0.0.1:0")
            scheduler = stack.enter_context(local).scheduler_address
        greet(scheduler)
        yield stack.enter_context(client_of(scheduler))


@contextlib.contextmanager
def environment_restored() -> Iterator[None]:
    """Leave nothing behind that dask sets here for its processes: numba refuses another number of threads later on."""
    before = {name: os.environ.get(name) for name in ALONE}
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name, None)
            if value is not None:
                os.environ[name] = value


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


# -- the scheduler -------------------------------------------------------------------------------


def greet(address: str) -> dict[str, Any]:
    """What the scheduler says of itself and of its workers; raises MissingEngineError when none answers.

    It is asked in a thread of its own, since a notebook has a loop running in this one.

    A client that fails to connect is left to the garbage collector, which closes it at any later moment. When
    that is the start of another client, each waits for the other's lock, for ever: clients are made for
    schedulers that have answered.
    """
    from distributed.core import rpc

    async def identity() -> dict[str, Any]:
        async with rpc(address, timeout=SECONDS_TO_ANSWER) as scheduler:
            return dict(await asyncio.wait_for(scheduler.identity(), SECONDS_TO_ANSWER))

    try:
        with ThreadPoolExecutor(1) as thread:
            told = thread.submit(lambda: asyncio.run(identity())).result()
    except Exception as error:  # dask asserts what an address may be, and what a stranger sends can raise anything
        nobody(address, f"no answer ({type(error).__name__}: {error!s:.80})")
    if told.get("type") != "Scheduler":
        nobody(address, f"an answer of a {told.get('type')!s:.80}")
    return told


def client_of(address: str) -> Any:
    """A client of a scheduler that has answered; should that be silent or gone now, MissingEngineError.

    dask's own limit of time does not hold once a connection stands, hence the thread: a client that comes too late
    is closed there.
    """
    from dask.distributed import Client

    made: Future[Any] = Future()

    def connect() -> None:
        try:
            client = Client(address, timeout=SECONDS_TO_ANSWER)
        except Exception as error:  # whatever it is: there is no client
            with contextlib.suppress(InvalidStateError):  # nobody waits any more
                made.set_exception(NavsymError(f"{type(error).__name__}: {error!s:.80}"))
            return
        if made.set_running_or_notify_cancel():
            made.set_result(client)
        else:
            client.close()

    Thread(target=connect, daemon=True).start()
    try:
        return made.result(2 * SECONDS_TO_ANSWER)
    except (NavsymError, TimeoutError) as error:
        made.cancel()
        why = str(error) or "silence"
    gc.collect()  # what is left of a client that failed is closed now
    nobody(address, f"no answer to a client ({why})")


def nobody(address: str, got: str) -> NoReturn:
    """Raises MissingEngineError: no dask scheduler at the address; got says what came instead."""
    message = f"expected a dask scheduler; got {got}; start one (dask scheduler), and {AGAIN}"
    raise MissingEngineError(message, where=address)


class Watch:
    """Looks, while nothing comes, whether anything can come: a scheduler that answers and has workers.

    patience : seconds without any worker until it is given up
    """

    def __init__(self, address: str, patience: float) -> None:
        self.address, self.patience = address, patience
        self.looked = self.alive = time.monotonic()

    def look(self) -> None:
        """Ask the scheduler, if the last time is long ago; raises MissingEngineError when it is in vain."""
        if time.monotonic() - self.looked < min(SECONDS_BETWEEN_LOOKS, self.patience):
            return
        workers = greet(self.address).get("workers")
        self.looked = time.monotonic()
        if workers:
            self.alive = self.looked
        elif self.looked - self.alive >= self.patience:
            got = f"none for {self.patience:g} s; start some (dask worker {self.address}), and {AGAIN}"
            raise MissingEngineError(f"expected workers; got {got}", where=self.address)


# -- results -------------------------------------------------------------------------------------


def answers(
    client: Any, function: Callable[..., Any], tasks: Sequence[tuple[Any, ...]], patience: float
) -> Iterator[Any]:
    """``function(*task)`` of every task, in the order in which they are ready."""
    from dask.distributed import as_completed

    # Not pure: a task is computed again rather than taken from another session's cluster memory.
    futures = (client.submit(function, *task, pure=False, retries=DEATHS) for task in tasks)
    ready = as_completed(futures, with_results=True)
    watch = Watch(client.scheduler.address, patience)
    while not ready.is_empty():
        if not ready.has_ready():
            watch.look()
            time.sleep(PAUSE)
        for _, result in ready.next_batch(block=False):
            # dask gives the error of a cancelled task, and (type, error, traceback) of one that failed.
            error = result[1] if isinstance(result, tuple) else result
            yield failed(error) if isinstance(error, BaseException) else result


def failed(error: BaseException) -> NoReturn:
    """Say in words why a task has no result."""
    from dask.distributed import KilledWorker

    if isinstance(error, NavsymError):
        raise error
    if isinstance(error, CancelledError):
        message = f"expected the scheduler to stay; got a lost connection; start it, and {AGAIN}"
        raise MissingEngineError(message, where="sweep")
    if isinstance(error, KilledWorker):
        message = f"expected workers that live; got {DEATHS} that died over one shard; give them more memory"
        raise NavsymError(message, where="sweep")
    message = f"expected rows; got {type(error).__name__} on a worker: {error!s:.200}; install navsym there as here"
    raise NavsymError(message, where="sweep")
