"""A store whose file was damaged: what is read is what was kept, or it is said that it cannot be read."""

from __future__ import annotations

import random
import sqlite3

import pytest

from navsym.core.store import Store, StoreError

VALUES = {f"key-{k}": {"status": "PROVED", "k": k, "text": "Ω" * 40} for k in range(40)}


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "s.sqlite"
    store = Store(path)
    for key, value in VALUES.items():
        store.put(key, value)
    store.close()
    return path


def test_flipped_bytes_change_no_value(path):
    honest, source, seen = path.read_bytes(), random.Random(4), 0
    for _ in range(300):
        data = bytearray(honest)
        for _ in range(source.choice([1, 1, 1, 50])):
            data[source.randrange(len(data))] ^= source.randint(1, 255)
        path.write_bytes(bytes(data))
        try:
            store = Store(path, seconds=0.1)
            found = store.get(VALUES)
            store.close()
        except StoreError:
            continue
        seen += bool(found)
        assert found.items() <= VALUES.items()
    assert seen > 100


@pytest.mark.parametrize("value", ["17", "x'ff00'", "CAST(x'ff80' AS TEXT)", "'{}'", "''"])
@pytest.mark.parametrize("column", ["value", "digest"])
def test_a_damaged_entry_counts_as_not_kept_and_the_others_are_read(path, column, value):
    with sqlite3.connect(path) as raw:
        raw.execute(f"UPDATE results SET {column} = {value} WHERE key = 'key-3'")
    raw.close()
    found = Store(path).get(VALUES)
    assert set(VALUES) - set(found) == {"key-3"} and found.items() <= VALUES.items()
    Store(path).put("key-3", VALUES["key-3"])
    assert Store(path).get(VALUES) == VALUES


@pytest.mark.parametrize("length", [0, 1, 100, 4096, -1])
def test_a_truncated_file_is_empty_damaged_or_said(path, length):
    path.write_bytes(path.read_bytes()[:length])
    try:
        assert Store(path, seconds=0.1).get(VALUES).items() <= VALUES.items()
    except StoreError as error:
        assert "move a damaged file away" in str(error)


def test_what_is_no_store_is_said(tmp_path):
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_text("x")
    with sqlite3.connect(tmp_path / "foreign") as raw:
        raw.execute("CREATE TABLE results (a, b)")
    raw.close()
    for path in (tmp_path / "folder", tmp_path / "file" / "s.sqlite", tmp_path / "foreign"):
        with pytest.raises(StoreError, match="expected a store"):
            Store(path, seconds=0.1).put("key", {})


def test_texts_that_are_no_unicode_are_kept(tmp_path):
    store = Store(tmp_path / "s.sqlite")
    store.put("key", {"name": "\ud800\x00"})
    assert store.get(["key"]) == {"key": {"name": "\ud800\x00"}}
