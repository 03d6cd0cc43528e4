"""The store keeps what it acknowledged, and its trouble never becomes the work's trouble."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sqlite3
import time

import pytest

from navsym.core.store import Store, StoreError, key_of


def test_what_was_put_is_there_for_the_next_process(tmp_path):
    store = Store(tmp_path / "s.sqlite")
    store.put(key_of("a"), {"status": "PROVED", "x": [1, None]})
    store.close()
    assert Store(tmp_path / "s.sqlite").get([key_of("a"), key_of("b")]) == {
        key_of("a"): {"status": "PROVED", "x": [1, None]}
    }


def test_keys_do_not_run_into_each_other():
    assert key_of("ab", "c") != key_of("a", "bc")


def test_a_damaged_entry_counts_as_not_kept(tmp_path):
    store = Store(tmp_path / "s.sqlite")
    store.put("k", {"status": "PROVED"})
    with sqlite3.connect(tmp_path / "s.sqlite") as raw:
        raw.execute("UPDATE results SET value = replace(value, 'PROVED', 'OPEN')")
    assert store.get(["k"]) == {}


def test_a_file_that_is_no_store_is_said_and_left_alone(tmp_path):
    path = tmp_path / "s.sqlite"
    path.write_bytes(b"not a database at all, but long enough to be looked at by the engine" * 20)
    before = path.read_bytes()
    with pytest.raises(StoreError, match="expected a store"):
        Store(path)
    assert path.read_bytes() == before


def test_a_folder_that_cannot_be_made_is_said(tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(StoreError, match="NAVSYM_CACHE"):
        Store(tmp_path / "file" / "s.sqlite")


def writer(path, log, name):
    store = Store(path)
    with open(log, "ab", buffering=0) as acknowledged:
        for count in range(10_000):
            store.put(f"{name}-{count}", {"count": count})
            acknowledged.write(f"{name}-{count}\n".encode())


def lines(log):
    return log.read_bytes().count(b"\n")


def wait_until(log, count):
    """Wait until the log has so many lines, however slow disk and machine are; at most two minutes."""
    end = time.monotonic() + 120
    while lines(log) < count and time.monotonic() < end:
        time.sleep(0.01)


def test_nothing_acknowledged_is_lost_when_writers_are_killed(tmp_path):
    path, log = tmp_path / "s.sqlite", tmp_path / "log"
    Store(path).close()
    log.touch()
    context = multiprocessing.get_context("fork")
    for round_ in range(6):
        children = [context.Process(target=writer, args=(path, log, f"{round_}{k}")) for k in range(2)]
        for child in children:
            child.start()
        wait_until(log, lines(log) + 3)
        time.sleep(0.03 * round_)
        for child in children:
            os.kill(child.pid, signal.SIGKILL)
            child.join()
    keys = log.read_text().split()
    assert len(keys) > 12
    found = Store(path).get(keys)
    assert set(found) == set(keys)
    assert all(found[key] == {"count": int(key.split("-")[1])} for key in keys)


def test_a_machine_without_a_home_is_told_to_set_the_folder(monkeypatch):
    monkeypatch.delenv("NAVSYM_CACHE", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)

    def none(self):
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr("pathlib.PosixPath.expanduser", none)
    with pytest.raises(StoreError, match="set NAVSYM_CACHE"):
        Store()


def test_a_cache_that_is_a_file_is_said(monkeypatch, tmp_path):
    (tmp_path / "file").write_text("x")
    monkeypatch.setenv("NAVSYM_CACHE", str(tmp_path / "file"))
    with pytest.raises(StoreError, match="NAVSYM_CACHE"):
        Store()


def test_a_store_of_another_layout_is_said_and_left_alone(tmp_path):
    with sqlite3.connect(tmp_path / "s.sqlite") as raw:
        raw.execute("CREATE TABLE results (key TEXT PRIMARY KEY, value TEXT)")
        raw.execute("INSERT INTO results VALUES ('k', 'old')")
    store = Store(tmp_path / "s.sqlite")
    with pytest.raises(StoreError, match="read"):
        store.get(["k"])
    with pytest.raises(StoreError, match="written"):
        store.put("k", {"new": 1})
    assert raw.execute("SELECT value FROM results").fetchall() == [("old",)]
