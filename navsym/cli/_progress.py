"""What a person sees while a verb works: one line with count, time left and what is being done.

On a terminal the line is drawn again and again at the bottom and leaves no trace. Elsewhere nothing is said,
unless NAVSYM_PROGRESS=1 asks for a remark every ten seconds (for logs); NAVSYM_PROGRESS=0 is silence everywhere.
Nothing is shown for what takes less than two seconds.
"""

from __future__ import annotations

import os
import shutil
import sys
import threading
import time
from collections.abc import Callable
from types import TracebackType

PATIENCE = 2.0  # seconds without a word
BETWEEN_REMARKS = 10.0  # seconds, where there is no terminal
BETWEEN_TICKS = 0.5


class Line:
    """The line at the bottom of the terminal: there is one terminal, hence one line."""

    def __init__(self) -> None:
        self.text = ""
        self.lock = threading.Lock()
        self.job: Progress | None = None  # what counts at present, for the ticker

    @property
    def drawn(self) -> bool:
        """True where a line can be drawn and is wanted: standard error is a terminal that obeys control sequences."""
        terminal = bool(getattr(sys.stderr, "isatty", lambda: False)())
        return terminal and os.environ.get("TERM") != "dumb" and os.environ.get("NAVSYM_PROGRESS") != "0"

    def show(self, text: str) -> None:
        width = shutil.get_terminal_size().columns - 1
        with self.lock:
            self.text = text[:width]
            sys.stderr.write(f"\r\x1b[2K{self.text}")
            sys.stderr.flush()

    def clear(self) -> None:
        """Take the line away, so that other text can be written."""
        with self.lock:
            if self.text:
                self.text = ""
                sys.stderr.write("\r\x1b[2K")
                sys.stderr.flush()


LINE = Line()


class Progress:
    """Counts the steps of a long job; as a context it says how to go on when it is interrupted.

    what   : what is counted, ``"claims"``
    total  : how many there are; 0 when the job itself will say so
    resume : what is left after Ctrl-C and how to go on, a sentence
    """

    def __init__(self, what: str, total: int = 0, resume: str = "", clock: Callable[[], float] = time.monotonic):
        self.what, self.total, self.resume, self.clock = what, total, resume, clock
        self.count, self.before, self.started, self.doing = 0, 0, clock(), ""
        self.told = self.started + PATIENCE - BETWEEN_REMARKS

    def step(self, doing: str = "") -> None:
        """One more is done; ``doing`` names it."""
        self.to(self.count + 1, doing)

    def follow(self, done: int, of: int, doing: str = "") -> None:
        """The callback of jobs that report both numbers; results of an earlier run count as done, not as fast.

        The total may grow while a job finds out what it has to do.
        """
        if not self.total or done < self.count:  # the first step, or that of a second job
            self.before, self.started = max(done - 1, 0), self.clock() if self.total else self.started
        self.total = of
        self.to(done, doing)

    def to(self, count: int, doing: str = "") -> None:
        """``count`` of them are done."""
        self.count, self.doing = count, doing
        now = self.clock()
        if now - self.started < PATIENCE or count >= self.total:
            return
        if LINE.drawn:
            LINE.show(self.words(now, doing))
        elif os.environ.get("NAVSYM_PROGRESS", "0") not in ("", "0") and now - self.told >= BETWEEN_REMARKS:
            self.told = now
            sys.stderr.write(self.words(now, "") + "\n")
            sys.stderr.flush()

    def words(self, now: float, doing: str) -> str:
        left = (now - self.started) / max(self.count - self.before, 1) * (self.total - self.count)
        told = f"{self.count} of {self.total} {self.what}, about {duration(left)} left"
        return f"{told}  {doing}" if doing else told

    def __enter__(self) -> Progress:
        LINE.job = self
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        LINE.job = None
        LINE.clear()
        if isinstance(error, KeyboardInterrupt) and self.resume:
            done = f"at {self.count} of {self.total} {self.what}" if self.count else f"before any of the {self.what}"
            error.add_note(f"{done}; {self.resume}")


class Ticker:
    """Keeps the line of a verb alive on a terminal: the count, also between two steps, or for how long it works."""

    def __init__(self, verb: str):
        self.verb, self.started, self.over = verb, time.monotonic(), threading.Event()

    def __enter__(self) -> Ticker:
        if LINE.drawn:
            threading.Thread(target=self.run, daemon=True).start()
        return self

    def run(self) -> None:
        while not self.over.wait(BETWEEN_TICKS):
            spent = time.monotonic() - self.started
            if spent >= PATIENCE:
                LINE.show(self.words(spent, LINE.job))

    def words(self, spent: float, job: Progress | None) -> str:
        if job is not None and job.count > job.before:
            return job.words(job.clock(), job.doing)
        return f"{self.verb}: working for {duration(spent)}, Ctrl-C stops it"

    def __exit__(self, *_: object) -> None:
        self.over.set()
        LINE.clear()


def duration(seconds: float) -> str:
    """``8 s``, ``2 min 5 s``, ``1 h 3 min``."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
