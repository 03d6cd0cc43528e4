"""Rows of a study in Parquet files, one for each shard of consecutive jobs, written whole or not at all.

A shard that is missing, cannot be read, or holds rows of another study is computed again; what is there
is never computed twice. The folder belongs to one configuration and one version of the code. A shard carries a
seal, the digest of its study and of its rows: Parquet itself does not notice every changed byte.
"""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from navsym.errors import MissingEngineError
from navsym.store import default_path, key_of

SHARDS = 256  # a study is cut into about so many, unless jobs are fewer,
LONGEST = 100  # or so many that a shard would take long: what is not finished is lost with its process
NAME = b"navsym"

Rows = list[dict[str, Any]]


def parquet() -> tuple[Any, Any]:
    """pyarrow and its Parquet module, or an error that says how to get them."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ModuleNotFoundError:
        message = "expected the Python package pyarrow for shards of a sweep; got none; install navsym[cluster]"
        raise MissingEngineError(message) from None
    return pyarrow, pyarrow.parquet


def default_folder(study: str) -> Path:
    """A folder of the cache for a study, named by the digest of its configuration and of the code."""
    return default_path().parent / "sweeps" / study[:32]


def cut(jobs: int, size: int | None = None) -> list[range]:
    """Consecutive indices of every shard."""
    size = size or min(LONGEST, -(-jobs // SHARDS))
    return [range(first, min(first + size, jobs)) for first in range(0, jobs, size)]


@dataclass(frozen=True, slots=True)
class Shards:
    """The folder of a study.

    study : digest of configuration and code; files of another one are not read
    """

    folder: Path
    study: str

    def path(self, shard: range) -> Path:
        """File of a shard, named by its first index and the one after its last."""
        return self.folder / f"jobs-{shard.start:07d}-{shard.stop:07d}.parquet"

    def read(self, shard: range) -> Rows | None:
        """The rows of a shard, or None when it is missing, damaged or of another study."""
        _, pq = parquet()
        if not self.path(shard).is_file():
            return None
        try:
            table = pq.read_table(self.path(shard))
            rows: Rows = table.to_pylist()
            same = (table.schema.metadata or {}).get(NAME) == self.seal(rows)
        except Exception:  # whatever Parquet says of a damaged file
            return None
        return rows if same and [row.get("index") for row in rows] == list(shard) else None

    def seal(self, rows: Sequence[dict[str, Any]]) -> bytes:
        """Digest of the study and of the rows, kept in the metadata of the file."""
        return key_of(self.study, *(json.dumps(row, sort_keys=True) for row in rows)).encode()

    def write(self, shard: range, rows: Sequence[dict[str, Any]]) -> None:
        """Keep a shard: a temporary file beside it, synced, renamed. Raises OSError."""
        pa, pq = parquet()
        table = pa.Table.from_pylist(list(rows)).replace_schema_metadata({NAME: self.seal(rows)})
        self.folder.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=".shard-", dir=self.folder)
        try:
            with os.fdopen(handle, "wb") as file:
                pq.write_table(table, file)
                file.flush()
                os.fsync(file.fileno())
            os.replace(name, self.path(shard))
        except BaseException:
            Path(name).unlink(missing_ok=True)
            raise
