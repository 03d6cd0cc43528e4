"""Child processes with limits on time and memory, for work that might not end.

A child is forked, so that it has the parent's loaded engines and objects and only its results
travel back. A child that exceeds its limits is killed; the parent never waits for it longer. Time is
processor time, so that what is decided does not depend on what else the machine does.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import multiprocessing
import os
import resource
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any

from navsym.core.errors import DomainError, NavsymError

DEFAULT_SECONDS = 60.0
DEFAULT_MEGABYTES = 6144

#: A child has this many times its seconds of processor time by the clock: a machine may be busy with other things.
PATIENCE = 10

MOST_SECONDS = 1e7
MOST_MEGABYTES = 2**30


@dataclass(frozen=True, slots=True)
class Exhausted:
    """The child gave no result, and why."""

    why: str


@dataclass(frozen=True, slots=True)
class Failed:
    """The child ended with an error of the user's making."""

    error: NavsymError


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of one item: its place, a result, Exhausted or Failed, and the seconds it took."""

    place: int
    value: Any
    seconds: float


@dataclass(frozen=True, slots=True)
class Limits:
    """What a child may use; the processor time is watched by the parent, the process whose number stands here."""

    seconds: float
    megabytes: int
    parent: int

    def apply(self, items: int) -> None:
        """Bound memory and, should nobody watch any more, processor time of so many items; no core files."""
        size = address_space() + self.megabytes * 2**20
        cpu = items * int(self.seconds + 1) * (os.cpu_count() or 1) + 10
        resource.setrlimit(resource.RLIMIT_AS, (size, size))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        _, most = resource.getrlimit(resource.RLIMIT_CPU)
        if most == resource.RLIM_INFINITY or cpu < most:
            resource.setrlimit(resource.RLIMIT_CPU, (cpu, most))


def address_space() -> int:
    """Bytes that this process has mapped. A child is born with all of them: the limit is on what it adds."""
    try:
        with open("/proc/self/statm") as file:
            return int(file.read().split()[0]) * resource.getpagesize()
    except OSError:  # no Linux: the limit is on the whole
        return 0


@dataclass(slots=True, eq=False)
class Child:
    """A running child: places of the items before it, of which the first is at work, and both clocks when it began."""

    places: list[int]
    process: Any
    receiver: Connection
    started: float
    used: float = 0.0
    alone: bool = True  # no item was decided before the one at work


def run_limited(
    function: Callable[..., Any],
    arguments: tuple[Any, ...],
    seconds: float = DEFAULT_SECONDS,
    megabytes: int = DEFAULT_MEGABYTES,
) -> Any:
    """Result of ``function(*arguments)`` from a limited child, or :class:`Exhausted`.

    A NavsymError of the child is raised again here; any other exception is an Exhausted with
    its text. Raises DomainError for limits that are none.
    """
    (outcome,) = run_many(lambda packed: function(*packed), [arguments], 1, seconds, megabytes)
    if isinstance(outcome.value, Failed):
        raise outcome.value.error
    return outcome.value


def run_many(
    function: Callable[[Any], Any],
    items: Sequence[Any],
    jobs: int,
    seconds: float = DEFAULT_SECONDS,
    megabytes: int = DEFAULT_MEGABYTES,
    share: int = 1,
) -> Iterator[Outcome]:
    """Outcomes of ``function(item)``, each in a limited child, at most ``jobs`` at once.

    share : so many items at most have one child, one after another, so that what one loads and keeps serves the next.
            A child that meets a limit or an unforeseen error ends, and the items behind have another. The seconds are
            those of one item, the memory that of a child

    Outcomes come as they are ready, in no particular order. Raises DomainError for limits that are none.
    """
    require_limits(seconds, megabytes)
    waiting = [list(range(len(items)))[k : k + share] for k in range(0, len(items), share)][::-1]
    running: list[Child] = []
    try:
        while waiting or running:
            while waiting and len(running) < max(1, jobs):
                running.append(start_child(waiting.pop(), function, items, Limits(seconds, megabytes, os.getpid())))
            for child in wait_for_children(running, seconds):
                alone = child.alone
                outcome = collect_outcome(child, seconds)
                if child.receiver.closed:
                    running.remove(child)
                    waiting += [child.places] if child.places else []
                if isinstance(outcome.value, Exhausted) and not alone:
                    waiting.append([outcome.place])  # those before it may have used up the memory
                else:
                    yield outcome
    finally:
        for child in running:
            stop_child(child)


def require_limits(seconds: Any, megabytes: int = 1, where: str = "") -> None:
    """Refuse a time that no child can have: nan, infinity, nothing, more than the kernel counts, or no number."""
    if not isinstance(seconds, int | float) or isinstance(seconds, bool):
        got = type(seconds).__name__
        raise DomainError(f"expected seconds as a number; got an object of type {got}; correct it", where=where)
    if not 0 < seconds <= MOST_SECONDS:
        got = f"{seconds:g}" if abs(seconds) < 1e300 else "more"
        message = f"expected seconds above 0 and at most {MOST_SECONDS:g}; got {got}; correct the limit"
        raise DomainError(message, where=where)
    if not 0 < megabytes <= MOST_MEGABYTES:
        raise DomainError(f"expected megabytes above 0 and at most {MOST_MEGABYTES}; got {megabytes}; correct it")


def require_jobs(jobs: Any, where: str) -> None:
    """Refuse a number of child processes that is none."""
    if not isinstance(jobs, int) or isinstance(jobs, bool) or jobs < 1:
        got = jobs if isinstance(jobs, int) and jobs.bit_length() < 99 else f"an object of type {type(jobs).__name__}"
        raise DomainError(f"expected a whole number of jobs from 1 on; got {got}; correct it", where=where)


def start_child(places: list[int], function: Callable[[Any], Any], items: Sequence[Any], limits: Limits) -> Child:
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    mine = [items[place] for place in places]
    process = context.Process(target=work_in_child, args=(sender, function, mine, limits), daemon=True)
    process.start()
    sender.close()
    return Child(places, process, receiver, time.monotonic())


def die_with_parent(parent: int) -> None:
    """Ask the kernel to end this process when its parent ends, however that ends; Linux only.

    parent : number of the process that made this one, which may be gone already
    """
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG
    if os.getppid() != parent:
        os._exit(1)


def work_in_child(sender: Connection, function: Callable[[Any], Any], items: Sequence[Any], limits: Limits) -> None:
    """Runs in the child. Ctrl-C reaches the whole group; here the parent answers it, and kills its children."""
    die_with_parent(limits.parent)
    gc.freeze()  # what came from the parent is neither looked through nor copied
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.dup2(2, 1)  # a C library that gives up writes to standard output, where the parent's document is to stand alone
    limits.apply(len(items))
    try:
        for item in items:
            try:
                sender.send(("result", function(item)))
            except NavsymError as error:
                sender.send(("error", strip_causes(error)))
    except MemoryError:
        sender.send(("stopped", f"more than {limits.megabytes} MB of memory"))
    except RecursionError:
        sender.send(("stopped", "an expression nested too deeply"))
    except Exception as error:
        sender.send(("stopped", f"{type(error).__name__}: {error}"))
    finally:
        sender.close()


def strip_causes(error: NavsymError) -> NavsymError:
    """The error without those that led to it.

    Where tblib is at work (distributed brings it), they would be sent along, and what their frames hold cannot
    always be.
    """
    error.__cause__ = error.__context__ = None
    return error.with_traceback(None)


def wait_for_children(running: Sequence[Child], seconds: float) -> list[Child]:
    """Children with a result or out of time; waits until there is one."""
    while True:
        late = [child for child in running if seconds_left(child, seconds) <= 0]
        answered = wait(
            [child.receiver for child in running], 0 if late else min(seconds_left(c, seconds) for c in running)
        )
        if late or answered:
            return [child for child in running if child in late or child.receiver in answered]


def seconds_left(child: Child, seconds: float) -> float:
    """Seconds that a child may still go on, at the least: of processor time, and of the clock, of which it has more."""
    gone = time.monotonic() - child.started
    return min(seconds - (processor_time(child, child.used + gone) - child.used), PATIENCE * seconds - gone)


def processor_time(child: Child, otherwise: float) -> float:
    """Seconds of processor time that a child has used; ``otherwise`` where this cannot be asked."""
    try:
        return time.clock_gettime((~child.process.pid << 3) | 2)  # Linux: the clock of another process
    except OSError:
        return otherwise


def collect_outcome(child: Child, seconds: float) -> Outcome:
    """The outcome of the item at work; the child goes on with the next one, or is stopped."""
    place, spent = child.places.pop(0), time.monotonic() - child.started
    kind: str = "stopped"
    value: Any = f"more than {seconds:g} s"
    try:
        if child.receiver.poll(0):
            kind, value = child.receiver.recv()
    except EOFError:
        child.process.join(1)
        value = f"the child ended without a result (exit {child.process.exitcode})"
    child.started, child.used = child.started + spent, processor_time(child, child.used + spent)
    child.alone = False
    if kind == "stopped" or not child.places:
        stop_child(child)
    if kind == "result":
        return Outcome(place, value, spent)
    return Outcome(place, Failed(value) if kind == "error" else Exhausted(value), spent)


def stop_child(child: Child) -> None:
    if child.process.is_alive():
        child.process.kill()
    child.process.join()
    child.receiver.close()
