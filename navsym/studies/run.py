"""Running a study: in this process, in processes of this machine, or on a dask cluster.

A task is one shard of consecutive jobs. Its rows depend on the configuration and the indices only, so that
neither the number of workers nor the death of one changes a bit; what is kept is not computed again.
"""

from __future__ import annotations

import contextlib
import json
import os
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from navsym.claims.workspace import cache_file
from navsym.core.answers import Answer
from navsym.core.errors import DomainError, MissingEngineError, NavsymError
from navsym.core.store import code_digest, key_of
from navsym.core.tables import Table
from navsym.language.files import file_in_errors
from navsym.language.jsonfile import read_json
from navsym.language.names import quote
from navsym.studies.cluster import PATIENCE, answers, cluster
from navsym.studies.plan import Sweep, fingerprint, run_job, summary, sweep_from

# Rows of a study in Parquet files, one for each shard of consecutive jobs, written whole or not at all.
#
# A shard that is missing, cannot be read, or holds rows of another study is computed again; what is there
# is never computed twice. The folder belongs to one configuration and one version of the code. A shard carries a
# seal, the digest of its study and of its rows: Parquet itself does not notice every changed byte.


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


@dataclass(frozen=True, slots=True, eq=False)
class Study(Answer):
    """Rows of a study of many jobs; the answer of :func:`sweep`.

    plan    : what was asked; rows : one table of plain numbers for each finished job, by its index
    resumed : jobs that an earlier run had kept; folder : of the shards; unsaved : shards that could not be kept
    """

    plan: Sweep
    rows: list[dict[str, Any]]
    resumed: int
    folder: str
    unsaved: tuple[str, ...] = ()

    @property
    def done(self) -> int:
        """Number of finished jobs."""
        return len(self.rows)

    @property
    def rmse(self) -> tuple[float, ...]:
        """Root mean square error of every state over all jobs; empty for kinds other than ``filter``."""
        return tuple(summary(self.plan, self.rows).get("rmse", ()))

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym sweep``."""
        kept = {"resumed": self.resumed, "folder": self.folder, "unsaved": list(self.unsaved)}
        return {**summary(self.plan, self.rows), **kept}

    def __repr__(self) -> str:
        return f"<Study {self.plan.kind}: {self.done} of {self.plan.jobs} jobs, {self.resumed} resumed>"

    def table(self) -> Table:
        """The first fifty rows."""
        heads = list(self.rows[0]) if self.rows else []
        return heads, [[row.get(name) for name in heads] for row in self.rows[:50]]


def sweep(
    config: str | os.PathLike[str] | Mapping[str, Any] | Sweep,
    *,
    workers: int = 0,
    scheduler: str | None = None,
    out: str | os.PathLike[str] | None = None,
    size: int | None = None,
    fresh: bool = False,
    patience: float = PATIENCE,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> Study:
    """Run a Monte-Carlo or parameter study; stopped, a second call goes on where it was.

    config    : path of a JSON file, its document, or a Sweep: ``{"kind": "filter", "jobs": 100, "seed": 1, …}``;
                kinds are ``filter``, ``terrain``, ``guaranteed``, ``phases`` and ``two-stage``
    workers   : processes of this machine; 0 computes in this one
    scheduler : ``tcp://host:port`` of a running dask scheduler, instead of processes of this machine
    out       : folder of the shards in Parquet; default: one in the cache
    size      : jobs in a shard, which is kept whole; default: at most 100
    fresh     : compute everything again; patience : seconds without any worker until a scheduler is given up
    progress  : called with (finished, all)

    Every job has its own seed sequence: the rows are the same bits whoever computes them.

    Returns :class:`Study`. Raises NavsymError of the kinds ``domain`` and ``missing`` (no dask, no pyarrow, no
    scheduler that answers, no workers).

    >>> import navsym as nav
    >>> found = nav.sweep({"kind": "guaranteed", "jobs": 2, "degree": 1}, out="shards")
    >>> [(row["T"], round(float(row["upper"]), 9)) for row in found.rows]
    [('1', 2.0), ('2', 1.0)]
    """
    for name, value in (("workers", workers), ("size", size)):
        if value is not None and (isinstance(value, bool) or not isinstance(value, int) or value < 0):
            raise DomainError(f"expected a whole number; got {quote(value)}; give one", where=f"sweep: {name}")
    if size == 0:
        raise DomainError("expected at least one job in a shard; got 0; give more", where="sweep: size")
    plan = read_plan(msgspec.structs.asdict(config) if isinstance(config, Sweep) else config)
    try:
        folder = None if out is None else Path(out)
    except TypeError:
        raise DomainError(f"expected a folder; got {quote(out)}; give its path", where="sweep: out") from None
    if not patience > 0:
        raise DomainError(f"patience: expected seconds above 0; got {patience}; correct it")
    study = key_of("sweep", fingerprint(plan), code_digest())
    shards = Shards(folder or cache_file().parent / "sweeps" / study[:32], study)
    parts = cut(plan.jobs, size)
    known = {} if fresh else {part: rows for part in parts if (rows := shards.read(part)) is not None}
    missing = [part for part in parts if part not in known]
    with computed(plan, missing, workers, scheduler, patience) as results:
        return keep_shards(plan, shards, known, results, progress)


def keep_shards(
    plan: Sweep,
    shards: Shards,
    known: Mapping[range, Rows],
    results: Iterator[tuple[range, Rows]],
    progress: Callable[[int, int], None],
) -> Study:
    """The study of the shards that are known and of those that come, each of which is kept at once."""
    found, unsaved = dict(known), []
    resumed = done = sum(len(part) for part in known)
    progress(done, plan.jobs)
    for part, rows in results:
        found[part] = rows
        try:
            shards.write(part, rows)
        except OSError as error:
            unsaved.append(f"{shards.path(part).name}: {error.strerror or error}")
        done += len(part)
        progress(done, plan.jobs)
    ordered = [row for part in sorted(found, key=lambda part: part.start) for row in found[part]]
    return Study(plan, ordered, resumed, str(shards.folder), tuple(unsaved))


def read_plan(config: Any) -> Sweep:
    """The study of a configuration file, or of its document."""
    with file_in_errors(config, "sweep"):
        return sweep_from(read_json(config) if isinstance(config, str | os.PathLike) else config)


def run_shard(sweep: Sweep, part: range) -> tuple[range, str, Rows]:
    """The rows of a shard, with the digest of the code that made them."""
    return part, code_digest(), [run_job(sweep, index) for index in part]


@contextlib.contextmanager
def computed(
    sweep: Sweep, parts: Sequence[range], workers: int, scheduler: str | None, patience: float = PATIENCE
) -> Iterator[Iterator[tuple[range, Rows]]]:
    """Shards as they are ready."""
    if not parts or (workers == 0 and scheduler is None):
        yield ((part, run_shard(sweep, part)[2]) for part in parts)
        return
    with cluster(workers, scheduler) as client:
        yield map(checked, answers(client, run_shard, [(sweep, part) for part in parts], patience))


def checked(result: tuple[range, str, Rows]) -> tuple[range, Rows]:
    """A worker's rows, when it has computed them with the code of this process."""
    part, rooms, rows = result
    if rooms != code_digest():
        message = "expected workers with the code of this process; got another version; install the same one"
        raise NavsymError(message, where="sweep")
    return part, rows
