"""Results kept between runs: a key of what they depend on -> plain data, in one SQLite file.

Every write is one transaction with a full sync, so that what was acknowledged survives a kill, and
several processes may write at once. A store that cannot be opened, read or written never stops the
work: the caller is told what was not kept, and old results stay as they are.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import importlib.metadata
import json
import os
import sqlite3
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from navsym.core.errors import NavsymError

ROOT = Path(__file__).parents[1]
#: Engines of which a result may depend on the version.
ENGINES = "sympy mpmath python-flint numpy scipy numba casadi cvxpy highspy clarabel osqp".split()
SCHEMA = "CREATE TABLE IF NOT EXISTS results (key TEXT PRIMARY KEY, value TEXT NOT NULL, digest TEXT NOT NULL)"
#: As bytes, so that an entry whose text is none any more is one damaged entry and not the end of reading.
READ = "SELECT CAST(value AS BLOB), CAST(digest AS BLOB) FROM results WHERE key = ?"
#: What comes of a file that cannot be used; SQLite may name a damaged table in bytes that are no text.
TROUBLE = (sqlite3.Error, ValueError)


class StoreError(NavsymError):
    """A store that cannot be opened, read or written; the message names the file."""

    kind = "store"


def default_path() -> Path:
    """The file in ``NAVSYM_CACHE`` or in the user's cache folder; raises StoreError on a machine without a home."""
    folder = os.environ.get("NAVSYM_CACHE")
    if folder:
        return Path(folder) / "results.sqlite"
    try:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    except RuntimeError:
        message = "expected a home folder; got none; set NAVSYM_CACHE to a folder"
        raise StoreError(message, where="HOME") from None
    return base / "navsym" / "results.sqlite"


def key_of(*parts: str) -> str:
    """The key of a result: a digest of all that it depends on."""
    digest = hashlib.sha256()
    for part in parts:
        data = part.encode("utf-8")
        digest.update(f"{len(data)}:".encode() + data)
    return digest.hexdigest()


@functools.cache
def code_digest() -> str:
    """Digest of navsym's sources, of Python and of the versions of the engines: what a computed result depends on."""
    sources = [
        text for path in sorted(ROOT.rglob("*.py")) for text in (str(path.relative_to(ROOT)), path.read_text("utf-8"))
    ]
    return key_of("code", sys.version, sys.platform, f"optimize {sys.flags.optimize}", *map(version, ENGINES), *sources)


def version(name: str) -> str:
    """Name and version of an installed package, or that there is none."""
    try:
        return f"{name} {importlib.metadata.version(name)}"
    except importlib.metadata.PackageNotFoundError:
        return f"{name} none"


class Store:
    """Key -> plain JSON data.

    path : the file; its folder is made when it is missing
    Raises StoreError when the file cannot be opened or is not a store.
    """

    def __init__(self, path: Path | None = None, *, seconds: float = 30.0):
        self.path = path or default_path()
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            # Autocommit: every statement is its own transaction; writers wait for each other.
            self.connection = sqlite3.connect(self.path, timeout=seconds, isolation_level=None)
            self.connection.execute("PRAGMA journal_mode=WAL")
            self.connection.execute("PRAGMA synchronous=FULL")
            self.connection.execute(SCHEMA)
        except (OSError, *TROUBLE) as error:
            raise self.trouble("opened", error) from error

    def get(self, keys: Iterable[str]) -> dict[str, Any]:
        """What is kept under the keys; a damaged entry counts as not kept."""
        found: dict[str, Any] = {}
        try:
            for key in keys:
                row = self.connection.execute(READ, (key,)).fetchone()
                if row and row[0] is not None and key_of(key, row[0].decode("utf-8", "replace")).encode() == row[1]:
                    found[key] = json.loads(row[0])
        except TROUBLE as error:
            raise self.trouble("read", error) from error
        return found

    def put(self, key: str, value: Mapping[str, Any]) -> None:
        """Keep a result; when this returns, a kill or a power cut does not lose it."""
        text = json.dumps(value, allow_nan=False)
        try:
            self.connection.execute("INSERT OR REPLACE INTO results VALUES (?, ?, ?)", (key, text, key_of(key, text)))
        except TROUBLE as error:
            raise self.trouble("written", error) from error

    def close(self) -> None:
        """Close the file; the store is not used afterwards."""
        self.connection.close()

    def trouble(self, what: str, error: Exception) -> StoreError:
        """The StoreError of what could not be done with the file: opened, read or written."""
        message = (
            f"expected a store that can be {what}; got {error}; "
            "free space, mend the permissions, move a damaged file away, or set NAVSYM_CACHE to another folder"
        )
        return StoreError(message, where=str(self.path))


@contextlib.contextmanager
def open_store(path: Path | None = None) -> Iterator[Store]:
    """A store that is closed at the end."""
    store = Store(path)
    try:
        yield store
    finally:
        store.close()
