"""A limit of work, shared among the steps that are still to do; what is given up for it is written down.

Work is processor time, of this thread and of its children that have ended, so that the answer does not depend on what
else the machine does. A step that may not end (a search by algebra) runs in a child, which is stopped; a step that
is made of short ones (a scan, pieces of a range) asks between them whether its limit is met.
"""

from __future__ import annotations

import resource
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from navsym.core.sandbox import DEFAULT_MEGABYTES, Exhausted, require_limits, run_limited

#: Seconds of work for one answer, unless told otherwise.
DEFAULT_SECONDS = 300.0
#: A child is not started for less than this many seconds.
LEAST = 0.1


def processor_seconds() -> float:
    """Seconds of processor time of this thread and of the children that have ended."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.thread_time() + children.ru_utime + children.ru_stime


@dataclass(frozen=True, slots=True, eq=False)
class Budget:
    """Until when, on the clock of :func:`processor_seconds`, a step may go on.

    given_up : what was stopped or not begun, in words; the same list for all parts of one limit
    """

    until: float
    given_up: list[str] = field(default_factory=list)

    @classmethod
    def of(cls, seconds: float) -> Budget:
        """So many seconds from now on. Raises DomainError for what is no time."""
        require_limits(seconds, DEFAULT_MEGABYTES)
        return cls(processor_seconds() + seconds)

    def left(self) -> float:
        """Seconds that are left, not below zero."""
        return max(0.0, self.until - processor_seconds())

    def met(self) -> bool:
        """True when nothing is left."""
        return processor_seconds() >= self.until

    def share(self, part: float) -> Budget:
        """A part of what is left, for one step; what the step leaves of it goes to the others."""
        return replace(self, until=processor_seconds() + self.left() * part)

    def gives_up(self, what: str, why: str = "the limit of work is met") -> None:
        """Write down what was not done."""
        self.given_up.append(f"{what}: {why}")

    def within(self, what: str, function: Callable[..., Any], *arguments: Any) -> Any:
        """``function(*arguments)`` from a child that is stopped at the limit; None, and a word on it, when it is.

        An error of the user's making is raised here.
        """
        seconds = self.left()
        if seconds < LEAST:
            return self.gives_up(what)
        found = run_limited(function, arguments, seconds)
        return self.gives_up(what, found.why) if isinstance(found, Exhausted) else found
