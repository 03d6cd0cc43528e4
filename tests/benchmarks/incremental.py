"""Processor time of ``navsym verify``: searching everything, checking in a fresh clone, and checking with a warm store.

Works on a copy of the sources, with a store of its own.

    python tests/benchmarks/incremental.py [paper …]
"""

from __future__ import annotations

import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SECONDS = 3600


def verify(folder: Path, *words: str) -> tuple[str, float, float]:
    """What ``navsym verify --json`` says in the copy, with its seconds of wall time and of processor time."""
    environment = {**os.environ, "NAVSYM_CACHE": str(folder / "cache"), "PYTHONPATH": str(folder)}
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    ended = subprocess.run(
        [sys.executable, "-m", "navsym", "verify", "--json", *words],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        text=True,
        check=False,
        timeout=SECONDS,
    )
    wall, after = time.perf_counter() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    return ended.stdout, wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main(papers: Sequence[str]) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for part, package in (("navsym", "navsym"), ("derivations", "navsym_papers")):
            shutil.copytree(ROOT / part, folder / package)
        for what, words in (("a fresh clone", ()), ("a warm store", ()), ("searching again", ("--fresh",))):
            told, wall, spent = verify(folder, *papers, *words)
            counts = json.loads(told)["counts"]
            print(f"{what}: {spent:.1f} s of processor time, {wall:.1f} s of wall time, {counts}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
