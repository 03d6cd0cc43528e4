"""Attacks on the store: writers killed at random moments, and disks that are full, closed or locked.

``kills``: four writers take items from one list, keep each result in the store and then acknowledge it; they
are killed with SIGKILL at random moments. A new set of writers goes on. At the end nothing that was
acknowledged is lost, everything can be read, and an item was done twice only where its writer was killed
between keeping and acknowledging it: at most one item for each kill.

``disk``: a full disk, a folder that cannot be written, a lock that nobody releases, a clock set back.
"""

from __future__ import annotations

import errno
import json
import os
import random
import resource
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from navsym.methods.campaigns.registry import Batch, Result, result
from navsym.methods.sweeps.plan import Sweep
from navsym.methods.sweeps.run import run_sweep
from navsym.store import Store, StoreError, key_of

WRITERS = 4
ROUNDS_PER_BATCH = 10  # each kills all four writers
LONGEST = 0.25  # seconds until a round is killed
SECONDS_TO_MOUNT, SECONDS_TO_VERIFY, SECONDS_TO_DIE = 30, 600, 30  # longer than any machine needs


# -- kills -----------------------------------------------------------------------------------


def kill_batches(kills: int, seed: int = 0) -> list[Batch]:
    """``kills`` deaths of writers, in batches of rounds of four."""
    rounds = -(-kills // WRITERS)
    sizes = [min(ROUNDS_PER_BATCH, rounds - k) for k in range(0, rounds, ROUNDS_PER_BATCH)]
    return [Batch(f"{seed} {k} {size}", (size, seed * 1000 + k)) for k, size in enumerate(sizes)]


def judge_kills(task: tuple[int, int]) -> Result:
    """Counts: kills, acknowledged, done twice; wrong: lost, unreadable, more repeats than kills."""
    rounds, seed = task
    source = random.Random(seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        Store(folder / "s.sqlite").close()
        deaths = sum(one_round(folder, place, source.uniform(0.02, LONGEST)) for place in range(rounds))
        counts, wrong = balance(folder, deaths, rounds)
    return result(counts, wrong, [], [])


def one_round(folder: Path, place: int, seconds: float) -> int:
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
from navsym.store import Store
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
    acknowledged = whole_lines(folder, "acknowledged-*")
    done = Counter(whole_lines(folder, "done-*"))
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


def whole_lines(folder: Path, pattern: str) -> list[str]:
    """Lines of all files of this name; each was written by one call."""
    text = b"".join(path.read_bytes() for path in sorted(folder.glob(pattern)))
    return text.decode().split()


# -- disks ------------------------------------------------------------------------------------


def disk_batches() -> list[Batch]:
    return [Batch(name, name) for name in TROUBLES]


def judge_disk(name: str) -> Result:
    """Counts: survived; wrong: what the trouble did to old results, or what was not said of it."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            wrong = TROUBLES[name](Path(folder))
        except NotPermittedError as error:
            return result(Counter(skipped=1), [], [f"{name}: {error}"], [])
    return result(Counter(survived=int(not wrong)), [f"{name}: {item}" for item in wrong], [], [])


class NotPermittedError(Exception):
    """The trouble cannot be made by this user on this machine."""


def old_results(path: Path, count: int = 50) -> dict[str, Any]:
    """A store with some results, as an earlier run left it."""
    store = Store(path)
    values = {key_of(str(k)): {"status": "PROVED", "k": k, "text": "x" * 200} for k in range(count)}
    for key, value in values.items():
        store.put(key, value)
    store.close()
    return values


def refused_writes(path: Path, attempts: int = 4000) -> list[str]:
    """Messages of a store that cannot be written; empty when every write was acknowledged."""
    try:
        store = Store(path, seconds=0.2)
        for k in range(attempts):
            store.put(f"new-{k}", {"text": "y" * 2000})
    except StoreError as error:
        return [str(error)]
    return []


def complaints(path: Path, old: dict[str, Any], said: list[str], hint: str) -> list[str]:
    """What went wrong: nothing said, old results changed, what was acknowledged lost."""
    found = [] if said and hint in said[0] and str(path) in said[0] else [f"not said: {said}"]
    return found + ([] if Store(path).get(old) == old else ["old results are not intact"])


def full_disk(folder: Path) -> list[str]:
    """A file system of one megabyte, where it may be mounted; otherwise a limit on the size of files."""
    small = folder / "small"
    small.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", str(small)],
        capture_output=True, check=False, timeout=SECONDS_TO_MOUNT,
    )
    if mounted.returncode != 0:
        return full_by_limit(folder)
    try:
        old = old_results(small / "s.sqlite")
        said = refused_writes(small / "s.sqlite")
        found = complaints(small / "s.sqlite", old, said, "full")
        return found + verb_on_full_disk(small)
    finally:
        subprocess.run(["umount", "-l", str(small)], check=False, timeout=SECONDS_TO_MOUNT)


def full_by_limit(folder: Path) -> list[str]:
    """Files of at most 256 kB, as a quota would have it."""
    path = folder / "s.sqlite"
    old = old_results(path)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2**18, before[1]))
    try:
        said = refused_writes(path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, handler)
    return complaints(path, old, said, "expected a store that can be")


def verb_on_full_disk(folder: Path) -> list[str]:
    """``verify`` with its store on the full disk: not status 0, no traceback, every lost verdict named."""
    with open(folder / "fill", "ab", buffering=0) as fill:
        try:
            while True:
                fill.write(bytes(4096))
        except OSError as error:
            if error.errno != errno.ENOSPC:
                raise
    command = [sys.executable, "-m", "navsym", "verify", "alpha_beta_filter", "--json"]
    environment = {**os.environ, "NAVSYM_CACHE": str(folder)}
    ended = subprocess.run(
        command, env=environment, capture_output=True, text=True, check=False, timeout=SECONDS_TO_VERIFY
    )
    unsaved = json.loads(ended.stdout).get("unsaved", [])
    fine = ended.returncode == 3 and len(unsaved) > 10 and unsaved[0] in ended.stderr
    return [] if fine and "Traceback" not in ended.stderr else [f"{ended.returncode}: {ended.stderr[-300:]}"]


def no_room_for_shards(folder: Path) -> list[str]:
    """A sweep whose shards find no room: every one is named, all rows are there, and nothing is half written."""
    study = Sweep("filter", jobs=4, runs=4, steps=6)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2**9, before[1]))  # a shard is larger
    try:
        document = run_sweep(study, folder=folder / "shards", size=1)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, handler)
    rows = run_sweep(study, folder=folder / "again", size=1)["rows"]
    fine = len(document["unsaved"]) == 4 and document["rows"] == rows and not any((folder / "shards").iterdir())
    return [] if fine else [f"{document['unsaved']}, {[path.name for path in (folder / 'shards').iterdir()]}"]


def read_only_folder(folder: Path) -> list[str]:
    """A store in a folder without permission to write; root needs a read-only mount for it."""
    place = folder / "place"
    place.mkdir()
    old = old_results(place / "s.sqlite")
    if os.geteuid() != 0:
        os.chmod(place / "s.sqlite", 0o400)
        os.chmod(place, 0o500)
        try:
            said = refused_writes(place / "s.sqlite")
        finally:
            os.chmod(place, 0o700)
            os.chmod(place / "s.sqlite", 0o600)
        return complaints(place / "s.sqlite", old, said, "permissions")
    bind = ["mount", "--bind", str(place), str(place)]
    if subprocess.run(bind, capture_output=True, check=False, timeout=SECONDS_TO_MOUNT).returncode != 0:
        raise NotPermittedError("root writes everywhere, and nothing may be mounted here")
    try:
        remount = ["mount", "-o", "remount,ro,bind", str(place)]
        subprocess.run(remount, check=True, capture_output=True, timeout=SECONDS_TO_MOUNT)
        said = refused_writes(place / "s.sqlite")
    finally:
        subprocess.run(["umount", "-l", str(place)], check=False, timeout=SECONDS_TO_MOUNT)
    return complaints(place / "s.sqlite", old, said, "permissions")


def stale_lock(folder: Path) -> list[str]:
    """A writer that holds the lock and never ends, then one that was killed while it held it."""
    path = folder / "s.sqlite"
    old = old_results(path)
    holder = subprocess.Popen([sys.executable, "-c", HOLDER, str(path)], stdout=subprocess.PIPE)
    assert holder.stdout is not None
    holder.stdout.readline()
    found = complaints(path, old, refused_writes(path, 1), "locked")
    holder.kill()
    holder.communicate(timeout=SECONDS_TO_DIE)
    return found + (["a dead writer's lock is still held"] if refused_writes(path, 1) else [])


HOLDER = """
import sqlite3, sys, time
connection = sqlite3.connect(sys.argv[1], isolation_level=None)
connection.execute("BEGIN IMMEDIATE")
print("held", flush=True)
time.sleep(600)
"""


def clock_set_back(folder: Path) -> list[str]:
    """Results kept, their file dated in the future, then read and written by a process with an old date."""
    path = folder / "s.sqlite"
    old = old_results(path)
    ahead = time.time() + 10 * 365 * 86400
    for file in folder.iterdir():
        os.utime(file, (ahead, ahead))
    said = refused_writes(path, 20)
    found = [f"a date stops it: {said}"] if said else []
    os.utime(path, (0, 0))
    return found + ([] if Store(path).get(old) == old else ["old results are not intact"])


def nothing_of_ours(folder: Path) -> list[str]:
    """A file that is no store is refused by name and left as it is."""
    path = folder / "s.sqlite"
    path.write_text(json.dumps({"precious": True}) * 200)
    before = path.read_bytes()
    said = refused_writes(path, 1)
    return [] if said and path.read_bytes() == before else [f"touched or not said: {said}"]


TROUBLES: dict[str, Callable[[Path], list[str]]] = {
    "full disk": full_disk,
    "file size limit": full_by_limit,
    "file size limit under a sweep": no_room_for_shards,
    "read-only folder": read_only_folder,
    "stale lock": stale_lock,
    "clock set back": clock_set_back,
    "another file": nothing_of_ours,
}
