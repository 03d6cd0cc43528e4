"""Other programs: started without a shell, in a folder, for a limited time, and ended with all that they started."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
from pathlib import Path

SECONDS = 120
QUIET = {"PYTHONDONTWRITEBYTECODE": "1", "ASAN_OPTIONS": "detect_leaks=0"}


def run(command: list[str], folder: Path, seconds: float | None = None) -> tuple[int, str]:
    """Exit status and output of one command without a shell or input, limited in time."""
    try:
        process = subprocess.Popen(
            command,
            cwd=folder,
            env=os.environ | QUIET,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
            start_new_session=True,
        )
    except OSError as error:
        return -1, error.strerror or "cannot be started"
    with process:
        try:
            text, trouble = process.communicate(timeout=seconds or SECONDS)
        except subprocess.TimeoutExpired:
            end_all(process)
            return -1, f"stopped after {seconds or SECONDS} s"
        except BaseException:
            end_all(process)
            raise
    return process.returncode, text + trouble


def end_all(process: subprocess.Popen[str]) -> None:
    """End a program with those that it started: they hold its pipes, and a compiler's children hold a processor."""
    with contextlib.suppress(OSError):
        if hasattr(os, "killpg"):
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()
