"""A child process with limits on time and memory, for work that might not end.

The child is forked, so that it has the parent's loaded engines and objects and only its result
travels back. A child that exceeds its limits is killed; the parent never waits for it longer.
"""

from __future__ import annotations

import multiprocessing
import resource
import time
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any

from navsym.errors import NavsymError


@dataclass(frozen=True, slots=True)
class Exhausted:
    """The child gave no result, and why."""

    why: str


def run_limited(
    function: Callable[..., Any], arguments: tuple[Any, ...], seconds: float, megabytes: int
) -> Any:
    """Result of ``function(*arguments)`` from a limited child, or :class:`Exhausted`.

    A NavsymError of the child is raised again here; any other exception is an Exhausted with
    its text.
    """
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=work, args=(sender, function, arguments, megabytes), daemon=True)
    child.start()
    sender.close()
    return collect(child, receiver, seconds)


def work(
    sender: Connection, function: Callable[..., Any], arguments: tuple[Any, ...], megabytes: int
) -> None:
    """Runs in the child."""
    limit = megabytes * 2**20
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        sender.send(("result", function(*arguments)))
    except NavsymError as error:
        sender.send(("error", error))
    except MemoryError:
        sender.send(("stopped", f"memory above {megabytes} MB"))
    except RecursionError:
        sender.send(("stopped", "an expression nested too deeply"))
    except Exception as error:
        sender.send(("stopped", f"{type(error).__name__}: {error}"))
    finally:
        sender.close()


def collect(child: Any, receiver: Connection, seconds: float) -> Any:
    deadline = time.monotonic() + seconds
    try:
        if not receiver.poll(max(0.0, deadline - time.monotonic())):
            return Exhausted(f"more than {seconds:g} s")
        kind, value = receiver.recv()
    except EOFError:
        child.join(1)
        return Exhausted(f"the child ended without a result (exit {child.exitcode})")
    finally:
        if child.is_alive():
            child.kill()
        child.join()
        receiver.close()
    if kind == "error":
        raise value
    return Exhausted(value) if kind == "stopped" else value
