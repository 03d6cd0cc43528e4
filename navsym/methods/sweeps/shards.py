"""Rows of a study in Parquet files, one for each shard of consecutive jobs, written whole or not at all.

A shard that is missing, cannot be read, or holds rows of another study is computed again; what is there
is never computed twice. The folder belongs to one configuration and one version of the code.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from navsym.errors import MissingEngineError

SHARDS = 256  # a study is cut into about so many, unless jobs are fewer
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
    from navsym.store import default_path

    return default_path().parent / "sweeps" / study[:32]


def cut(jobs: int, size: int | None = None) -> list[range]:
    """Consecutive indices of every shard."""
    size = size or max(1, -(-jobs // SHARDS))
    return [range(first, min(first + size, jobs)) for first in range(0, jobs, size)]


@dataclass(frozen=True, slots=True)
class Shards:
    """The folder of a study.

    study : digest that every file carries; files of another one are not read
    """

    folder: Path
    study: str

    def path(self, shard: range) -> Path:
        return self.folder / f"jobs-{shard.start:07d}-{shard.stop:07d}.parquet"

    def read(self, shard: range) -> Rows | None:
        """The rows of a shard, or None when it is missing, damaged or of another study."""
        _, pq = parquet()
        try:
            table = pq.read_table(self.path(shard))
            rows: Rows = table.to_pylist()
            same = (table.schema.metadata or {}).get(NAME) == self.study.encode()
        except Exception:  # whatever Parquet says of a damaged file
            return None
        return rows if same and [row.get("index") for row in rows] == list(shard) else None

    def write(self, shard: range, rows: Sequence[dict[str, Any]]) -> None:
        """Keep a shard: a temporary file beside it, synced, renamed. Raises OSError."""
        pa, pq = parquet()
        table = pa.Table.from_pylist(list(rows)).replace_schema_metadata({NAME: self.study.encode()})
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
