"""Campaigns that are tables of cases under ``tests/``: their cases in batches, judged by pytest, kept like any others.

What is kept depends on the sources of the cases too, so that an attack that was made harder is run again.
"""

from __future__ import annotations

import functools
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

from navsym.core.errors import NavsymError
from navsym.core.sandbox import die_with_parent
from navsym.core.store import key_of
from tests.attacks.campaigns.batches import Batch, Result, result

EVERY = ("-m", "slow or not slow")
SECONDS_TO_COLLECT = 300


def make_batches(root: Path, folder: str, size: int) -> list[Batch]:
    """The cases below a folder (or in a file) of the checkout, ``size`` of them in a batch."""
    names = case_names(root, folder)
    place = root / folder if (root / folder).is_dir() else (root / folder).parent  # with what neighbours share
    paths = sorted(path for path in place.rglob("*") if path.suffix in (".py", ".txt"))
    sources = key_of(*(path.read_text(encoding="utf-8") for path in paths))
    parts = [names[first : first + size] for first in range(0, len(names), size)]
    return [Batch(key_of(sources, *part), (str(root), part)) for part in parts]


def case_names(root: Path, folder: str) -> list[str]:
    """Names of all cases as pytest collects them, slow ones too; those of one parameter share what they derive."""
    command = pytest_of(root, "--collect-only", "-q", *EVERY, folder)
    told = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False, timeout=SECONDS_TO_COLLECT)
    names = [line for line in told.stdout.splitlines() if "::" in line]
    if told.returncode != 0 or not names:
        raise NavsymError(f"expected cases in {folder}; got {told.stdout[-300:]} {told.stderr[-300:]}; install pytest")
    return sorted(names, key=lambda name: name.partition("[")[2])


def pytest_of(root: Path, *words: str) -> list[str]:
    """The command that runs pytest on a checkout with these words, by this Python and without a cache folder."""
    return [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", f"--rootdir={root}", *words]


def judge(task: tuple[str, Sequence[str]]) -> Result:
    """Counts of the cases by outcome; wrong: those that failed; open: those that were skipped.

    pytest has no limit of time of its own here: the campaign ends this process, and pytest ends with it.
    """
    root, names = Path(task[0]), task[1]
    with tempfile.TemporaryDirectory() as folder:
        listed, record = Path(folder) / "cases", Path(folder) / "record.xml"
        listed.write_text("\n".join(names), encoding="utf-8")
        command = pytest_of(root, "-q", *EVERY, f"--junitxml={record}", f"@{listed}")
        mortal = functools.partial(die_with_parent, os.getpid())
        told = subprocess.run(
            command, cwd=root, capture_output=True, text=True, check=False, timeout=None, preexec_fn=mortal
        )
        outcomes = read_outcomes(record)
    if len(outcomes) != len(names):
        raise NavsymError(f"expected {len(names)} outcomes; got {len(outcomes)}; read pytest: {told.stdout[-300:]}")
    failed, skipped = ([name for name, outcome in outcomes if outcome == word] for word in ("failed", "skipped"))
    return result(Counter(outcome for _, outcome in outcomes), failed, skipped)


def read_outcomes(record: Path) -> list[tuple[str, str]]:
    """(name, outcome) of the cases in pytest's own record."""
    outcomes = []
    for case in ElementTree.parse(record).iter("testcase") if record.exists() else ():
        tags = {child.tag for child in case}
        outcome = "failed" if tags & {"failure", "error"} else "skipped" if "skipped" in tags else "passed"
        outcomes.append((case.get("name", "?"), outcome))
    return outcomes
