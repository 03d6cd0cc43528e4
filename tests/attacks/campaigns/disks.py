"""Disks that are full, closed or locked, and clocks set back, under a store with old results and under a sweep.

Each trouble gives its complaints: nothing was said, old results have changed, what was acknowledged is lost.
"""

from __future__ import annotations

import contextlib
import errno
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from navsym.core.store import Store, StoreError, key_of
from navsym.studies.plan import Sweep
from navsym.studies.run import sweep as run_sweep
from tests.attacks.campaigns.batches import Batch, Result, result

SECONDS_TO_MOUNT, SECONDS_TO_VERIFY, SECONDS_TO_DIE = 30, 600, 30  # longer than any machine needs


def make_batches() -> list[Batch]:
    """One batch for each trouble of :data:`TROUBLES`."""
    return [Batch(name, name) for name in TROUBLES]


def judge(name: str) -> Result:
    """Counts: survived; wrong: what the trouble did to old results, or what was not said of it."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            wrong = TROUBLES[name](Path(folder))
        except NotPermittedError as error:
            return result(Counter(skipped=1), undecided=[f"{name}: {error}"])
    return result(Counter(survived=int(not wrong)), [f"{name}: {item}" for item in wrong])


class NotPermittedError(Exception):
    """The trouble cannot be made by this user on this machine."""


def make_old_results(path: Path, count: int = 50) -> dict[str, Any]:
    """A store with some results, as an earlier run left it."""
    store = Store(path)
    values = {key_of(str(k)): {"status": "PROVED", "k": k, "text": "x" * 200} for k in range(count)}
    for key, value in values.items():
        store.put(key, value)
    store.close()
    return values


def attempt_writes(path: Path, attempts: int = 4000) -> tuple[list[str], dict[str, Any]]:
    """What a store says that cannot be written, or nothing; and the results that it acknowledged before."""
    acknowledged: dict[str, Any] = {}
    try:
        store = Store(path, seconds=0.2)
        for k in range(attempts):
            store.put(f"new-{k}", {"text": "y" * 2000})
            acknowledged[f"new-{k}"] = {"text": "y" * 2000}
    except StoreError as error:
        return [str(error)], acknowledged
    return [], acknowledged


def find_complaints(path: Path, old: dict[str, Any], attempt: tuple[list[str], dict[str, Any]], hint: str) -> list[str]:
    """What went wrong: nothing said, old results changed, what was acknowledged lost."""
    said, acknowledged = attempt
    found = [] if said and hint in said[0] and str(path) in said[0] else [f"not said: {said}"]
    return found + find_damage(path, old | acknowledged)


def find_damage(path: Path, results: dict[str, Any]) -> list[str]:
    """A complaint when the store does not give back what it has taken."""
    return [] if Store(path).get(results) == results else ["results that were kept are not intact"]


def full_disk(folder: Path) -> list[str]:
    """A file system of one megabyte, where it may be mounted; otherwise a limit on the size of files."""
    small = folder / "small"
    small.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", str(small)],
        capture_output=True,
        check=False,
        timeout=SECONDS_TO_MOUNT,
    )
    if mounted.returncode != 0:
        return full_by_limit(folder)
    try:
        old = make_old_results(small / "s.sqlite")
        found = find_complaints(small / "s.sqlite", old, attempt_writes(small / "s.sqlite"), "full")
        return found + verb_on_full_disk(small)
    finally:
        subprocess.run(["umount", "-l", str(small)], check=False, timeout=SECONDS_TO_MOUNT)


@contextlib.contextmanager
def limit_file_size(size: int) -> Iterator[None]:
    """No file of this process grows above so many bytes in the block: a write fails there as on a full disk.

    Nor does it write the bytecode of what it imports: Python puts the half of a module in place without a look.
    """
    written, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        sys.dont_write_bytecode = written
        signal.signal(signal.SIGXFSZ, handler)


def full_by_limit(folder: Path) -> list[str]:
    """Files of at most 256 kB, as a quota would have it."""
    path = folder / "s.sqlite"
    old = make_old_results(path)
    with limit_file_size(2**18):
        attempt = attempt_writes(path)
    return find_complaints(path, old, attempt, "expected a store that can be")


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
    with limit_file_size(2**9):  # a shard is larger
        document = run_sweep(study, out=folder / "shards", size=1).document()
    rows = run_sweep(study, out=folder / "again", size=1).document()["rows"]
    fine = len(document["unsaved"]) == 4 and document["rows"] == rows and not any((folder / "shards").iterdir())
    return [] if fine else [f"{document['unsaved']}, {[path.name for path in (folder / 'shards').iterdir()]}"]


def read_only_folder(folder: Path) -> list[str]:
    """A store in a folder without permission to write; root needs a read-only mount for it."""
    place = folder / "place"
    place.mkdir()
    old = make_old_results(place / "s.sqlite")
    if os.geteuid() != 0:
        os.chmod(place / "s.sqlite", 0o400)
        os.chmod(place, 0o500)
        try:
            attempt = attempt_writes(place / "s.sqlite")
        finally:
            os.chmod(place, 0o700)
            os.chmod(place / "s.sqlite", 0o600)
        return find_complaints(place / "s.sqlite", old, attempt, "permissions")
    bind = ["mount", "--bind", str(place), str(place)]
    if subprocess.run(bind, capture_output=True, check=False, timeout=SECONDS_TO_MOUNT).returncode != 0:
        raise NotPermittedError("root writes everywhere, and nothing may be mounted here")
    try:
        remount = ["mount", "-o", "remount,ro,bind", str(place)]
        subprocess.run(remount, check=True, capture_output=True, timeout=SECONDS_TO_MOUNT)
        attempt = attempt_writes(place / "s.sqlite")
    finally:
        subprocess.run(["umount", "-l", str(place)], check=False, timeout=SECONDS_TO_MOUNT)
    return find_complaints(place / "s.sqlite", old, attempt, "permissions")


def stale_lock(folder: Path) -> list[str]:
    """A writer that holds the lock and never ends, then one that was killed while it held it."""
    path = folder / "s.sqlite"
    old = make_old_results(path)
    holder = subprocess.Popen([sys.executable, "-c", HOLDER, str(path)], stdout=subprocess.PIPE)
    assert holder.stdout is not None
    holder.stdout.readline()
    found = find_complaints(path, old, attempt_writes(path, 1), "locked")
    holder.kill()
    holder.communicate(timeout=SECONDS_TO_DIE)
    return found + (["a dead writer's lock is still held"] if attempt_writes(path, 1)[0] else [])


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
    old = make_old_results(path)
    ahead = time.time() + 10 * 365 * 86400
    for file in folder.iterdir():
        os.utime(file, (ahead, ahead))
    said, acknowledged = attempt_writes(path, 20)
    found = [f"a date stops it: {said}"] if said else []
    os.utime(path, (0, 0))
    return found + find_damage(path, old | acknowledged)


def nothing_of_ours(folder: Path) -> list[str]:
    """A file that is no store is refused by name and left as it is."""
    path = folder / "s.sqlite"
    path.write_text(json.dumps({"precious": True}) * 200)
    before = path.read_bytes()
    said, _ = attempt_writes(path, 1)
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
