"""Every reader of files by inputs that coverage guides: rounds of atheris, each a process with limits of its own.

What reached a new line is kept in a folder, a corpus for each reader, from which the next round goes on; what a
round found is kept like any batch. A round that libFuzzer ends, at a crash of a library, a minute without an answer
or two gigabytes, is counted as far as it came and its last input is among what is wrong.
"""

from __future__ import annotations

import functools
import importlib.util
import json
import os
import re
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from navsym.core.errors import MissingEngineError
from navsym.core.sandbox import die_with_parent
from tests.attacks.campaigns.batches import Batch, Result, deal, result
from tests.attacks.campaigns.parser import MEGABYTES, NUMBERS, OUTCOMES, PIECES
from tests.attacks.campaigns.readers import READERS

ROUND = 20_000
LONGEST = 4096  # bytes of one input
SECONDS = 60  # by the clock, for one input

#: What libFuzzer prints of the lines it reached, and of its memory.
REACHED = re.compile(r"cov: (\d+) ft: \d+ corp: (\d+)/.*rss: (\d+)Mb")


def make_batches(inputs: int, corpus: Path, seed: int = 0) -> list[Batch]:
    """``inputs`` in rounds, the readers in turn.

    corpus : folder of what reached new lines, made when it is missing
    Raises MissingEngineError without atheris.
    """
    if importlib.util.find_spec("atheris") is None:
        raise MissingEngineError("expected atheris; got an environment without it; run pip install 'navsym[fuzz]'")
    subjects = [(reader, str(corpus)) for reader in READERS]
    return deal(subjects, inputs, min(ROUND, max(1, inputs // len(subjects))), seed)


def judge(task: tuple[tuple[str, str], int, int]) -> Result:
    """Counts: read, refused, missing; wrong: as in the campaign ``parser``, and the input at which a round ended."""
    (reader, corpus), size, seed = task
    known = Path(corpus, reader)
    known.mkdir(parents=True, exist_ok=True)
    known.joinpath("honest").write_bytes(READERS[reader][1])
    with tempfile.TemporaryDirectory(prefix="navsym-fuzz-") as folder:
        words = Path(folder, "words")
        words.write_text("".join(f'"{quote(word)}"\n' for word in (*PIECES, *NUMBERS)), encoding="ascii")
        told = run_round([reader, folder, *make_options(folder, size, seed + 1), str(known)], folder)
        return read_round(reader, Path(folder), told)


def make_options(folder: str, size: int, seed: int) -> list[str]:
    """What libFuzzer is told: how much, how long, and where it leaves the input that ends it (seed 0 is random)."""
    extent = [f"-runs={size}", f"-seed={seed}", f"-max_len={LONGEST}", "-len_control=0", "-mutate_depth=1"]
    limits = [f"-timeout={SECONDS}", f"-report_slow_units={SECONDS}", f"-rss_limit_mb={MEGABYTES}"]
    return [*extent, *limits, f"-artifact_prefix={folder}/end-", f"-dict={folder}/words"]


def quote(word: bytes) -> str:
    """A word of a dictionary of libFuzzer."""
    return "".join(f"\\x{byte:02x}" for byte in word)


def run_round(words: list[str], folder: str) -> subprocess.CompletedProcess[str]:
    """One round, which ends with this process and leaves no file outside the folder."""
    return subprocess.run(
        [sys.executable, "-m", "tests.attacks.campaigns.guided", *words],
        capture_output=True,
        text=True,
        errors="replace",
        check=False,
        stdin=subprocess.DEVNULL,
        env={**os.environ, "TMPDIR": folder, "PYTHONPATH": os.pathsep.join(sys.path)},
        preexec_fn=functools.partial(die_with_parent, os.getpid()),
    )


def read_round(reader: str, folder: Path, told: subprocess.CompletedProcess[str]) -> Result:
    """The record of one round, whether it came to its end or not."""
    wrong = read_lines(folder / "wrong")
    for path in folder.glob("end-*"):
        wrong.append({"reader": reader, "data": path.read_bytes().decode("latin-1"), "why": path.name.split("-")[1]})
    if told.returncode != 0 and not wrong:
        wrong.append({"reader": reader, "data": "", "why": f"status {told.returncode}: {told.stderr[-500:]}"})
    tally = np.fromfile(folder / "tally") if (folder / "tally").exists() else np.zeros(len(OUTCOMES) + 2)
    counts = Counter({name: int(n) for name, n in zip((*OUTCOMES, "crashed"), tally[:-1], strict=True) if n})
    reached = REACHED.findall(told.stderr) or [("0", "0", "0")]
    covered, corpus, peak = (max(int(row[k]) for row in reached) for k in range(3))
    measured = {"slowest": round(float(tally[-1]), 4), "peak": peak, "reached": covered, "corpus": corpus}
    return result(counts, wrong, kept=[{"reader": reader, **measured}])


def read_lines(path: Path) -> list[Any]:
    """The JSON documents of a file, one in each line; none when there is no file."""
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()] if path.exists() else []
