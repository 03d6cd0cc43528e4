"""Writers of the store killed at random moments.

Four writers take items from one list, keep each result in the store and then acknowledge it; they are killed
with SIGKILL at random moments. A new set of writers goes on. At the end nothing that was acknowledged is lost,
everything can be read, and an item was done twice only where its writer was killed between keeping and
acknowledging it: at most one item for each kill.
"""

from __future__ import annotations

import random
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any

from navsym.core.store import Store, StoreError
from tests.attacks.campaigns.batches import Batch, Result, deal, result

WRITERS = 4
ROUNDS_PER_BATCH = 10  # each kills all four writers
LONGEST = 0.25  # seconds until a round is killed
SECONDS_TO_DIE = 30  # longer than any machine needs


def make_batches(kills: int, seed: int = 0) -> list[Batch]:
    """``kills`` deaths of writers, in batches of rounds of four."""
    return deal(["writers"], -(-kills // WRITERS), ROUNDS_PER_BATCH, seed)


def judge(task: tuple[str, int, int]) -> Result:
    """Counts: kills, acknowledged, done twice; wrong: lost, unreadable, more repeats than kills."""
    _, rounds, seed = task
    source = random.Random(seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        Store(folder / "s.sqlite").close()
        deaths = sum(run_round(folder, place, source.uniform(0.02, LONGEST)) for place in range(rounds))
        counts, wrong = balance(folder, deaths, rounds)
    return result(counts, wrong)


def run_round(folder: Path, place: int, seconds: float) -> int:
    """Start the writers, kill them all after some time; the number of those that were still at work."""
    children = []
    for worker in range(WRITERS):
        command = [sys.executable, "-c", WRITER, str(folder), str(worker), str(place)]
        children.append(subprocess.Popen(command, stdout=subprocess.PIPE, start_new_session=True))
    for child in children:
        assert child.stdout is not None
        child.stdout.readline()  # at work
    time.sleep(seconds)
    deaths = 0
    for child in children:
        deaths += child.poll() is None
        child.send_signal(signal.SIGKILL)
        child.wait(SECONDS_TO_DIE)
        assert child.stdout is not None
        child.stdout.close()
    return deaths


#: A writer: the items of its own that have no result yet, one by one; a result, then its acknowledgement.
WRITER = """
import sys
from pathlib import Path
from navsym.core.store import Store
folder, worker, place = Path(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
store = Store(folder / "s.sqlite")
done = open(folder / f"done-{worker}", "ab", buffering=0)
acknowledged = open(folder / f"acknowledged-{worker}", "ab", buffering=0)
print("at work", flush=True)
for item in range(10**6):
    key = f"{worker}-{item}"
    if store.get([key]):
        continue
    done.write(f"{key}\\n".encode())
    store.put(key, {"item": item, "by": place, "filler": "x" * (item % 7 * 100)})
    acknowledged.write(f"{key}\\n".encode())
"""


def balance(folder: Path, deaths: int, rounds: int) -> tuple[Counter[str], list[Any]]:
    """What was acknowledged, what is kept, and what was done more than once by each writer."""
    acknowledged = read_lines(folder, "acknowledged-*")
    done = Counter(read_lines(folder, "done-*"))
    wrong: list[Any] = []
    try:
        kept = Store(folder / "s.sqlite").get(list(done))
    except StoreError as error:
        return Counter(kills=deaths), [f"unreadable: {error}"]
    lost = [key for key in acknowledged if key not in kept]
    bad = [key for key, value in kept.items() if value["item"] != int(key.split("-")[1])]
    repeated = Counter(key.split("-")[0] for key in done.elements()) - Counter(key.split("-")[0] for key in done)
    wrong += [f"lost: {key}" for key in lost] + [f"damaged: {key}" for key in bad]
    wrong += [f"writer {w}: {n} repeated, {rounds} kills" for w, n in repeated.items() if n > rounds]
    if sqlite3.connect(folder / "s.sqlite").execute("PRAGMA integrity_check").fetchone() != ("ok",):
        wrong.append("the file fails its own check")
    return Counter(kills=deaths, acknowledged=len(acknowledged), repeated=repeated.total()), wrong


def read_lines(folder: Path, pattern: str) -> list[str]:
    """Lines of all files of this name; each was written by one call."""
    text = b"".join(path.read_bytes() for path in sorted(folder.glob(pattern)))
    return text.decode().split()
