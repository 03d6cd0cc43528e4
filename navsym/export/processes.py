"""Other programs: started without a shell, in a folder, for a limited time."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

SECONDS = 120


def run(command: list[str], folder: Path) -> tuple[int, str]:
    """Exit status and output of one command without a shell, limited in time."""
    quiet = {"PYTHONDONTWRITEBYTECODE": "1", "ASAN_OPTIONS": "detect_leaks=0"}
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=SECONDS,
            check=False,
            env=os.environ | quiet,
        )
    except subprocess.TimeoutExpired:
        return -1, f"stopped after {SECONDS} s"
    except OSError as error:
        return -1, error.strerror or "cannot be started"
    return done.returncode, done.stdout + done.stderr
