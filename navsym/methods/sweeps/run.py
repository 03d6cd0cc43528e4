"""Running a study: in this process, in processes of this machine, or on a dask cluster.

A task is one shard of consecutive jobs. Its rows depend on the configuration and the indices only, so that
neither the number of workers nor the death of one changes a bit; what is kept is not computed again.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from navsym.errors import DomainError, NavsymError
from navsym.methods.sweeps.cluster import PATIENCE, answers, cluster
from navsym.methods.sweeps.plan import Sweep, fingerprint, run_job, summary
from navsym.methods.sweeps.shards import Rows, Shards, cut, default_folder
from navsym.methods.verification.dependencies import rooms_digest
from navsym.store import key_of


def run_sweep(
    sweep: Sweep,
    *,
    workers: int = 0,
    scheduler: str | None = None,
    folder: Path | None = None,
    size: int | None = None,
    fresh: bool = False,
    patience: float = PATIENCE,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> dict[str, Any]:
    """Compute the shards that are not kept, keep each as it comes, and sum up.

    workers   : processes of this machine; 0 computes in this one
    scheduler : ``tcp://host:port`` of a running dask scheduler, instead of processes of this machine
    folder    : where the shards are; by default in the cache
    size      : jobs in a shard
    patience  : seconds without any worker until a scheduler is given up

    The document of ``navsym sweep``: that of :func:`summary` with ``resumed`` (jobs that were kept),
    ``folder`` and ``unsaved`` (shards that could not be kept). Raises MissingEngineError without dask,
    pyarrow, an answer of the scheduler, or workers.
    """
    if not patience > 0:
        raise DomainError(f"patience: expected seconds above 0; got {patience}; correct it")
    study = key_of("sweep", fingerprint(sweep), rooms_digest())
    shards = Shards(folder or default_folder(study), study)
    parts = cut(sweep.jobs, size)
    known = {} if fresh else {part: rows for part in parts if (rows := shards.read(part)) is not None}
    found, unsaved = dict(known), []
    done = sum(len(part) for part in known)
    missing = [part for part in parts if part not in known]
    progress(done, sweep.jobs)
    with computed(sweep, missing, workers, scheduler, patience) as results:
        for part, rows in results:
            found[part] = rows
            try:
                shards.write(part, rows)
            except OSError as error:
                unsaved.append(f"{shards.path(part).name}: {error.strerror or error}")
            done += len(part)
            progress(done, sweep.jobs)
    rows = [row for part in parts for row in found.get(part, [])]
    resumed = sum(len(part) for part in known)
    return {**summary(sweep, rows), "resumed": resumed, "folder": str(shards.folder), "unsaved": unsaved}


def run_shard(sweep: Sweep, part: range) -> tuple[range, str, Rows]:
    """The rows of a shard, with the digest of the code that made them."""
    return part, rooms_digest(), [run_job(sweep, index) for index in part]


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
    if rooms != rooms_digest():
        message = "expected workers with the code of this process; got another version; install the same one"
        raise NavsymError(message, where="sweep")
    return part, rows
