"""Run a Monte-Carlo or parameter study: resumable, here, on all cores or on a cluster."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from navsym.cli._progress import Progress
from navsym.cli.output import emit


def command(
    config: Annotated[Path, typer.Argument(help='JSON: {"kind": "filter", "jobs": 100, "seed": 1, …}')],
    workers: Annotated[int, typer.Option(min=0, help="local processes; 0 computes in this one")] = 2,
    scheduler: Annotated[str | None, typer.Option(help="tcp://host:port of a running dask scheduler")] = None,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="do everything again, ignoring what is kept"),
    ] = False,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> int:
    """Compute the jobs of a study that are not kept yet, and sum them up; stopped, it goes on where it was.

    Every job has its own seed sequence: the rows are the same bits whoever computes them.

    Example: navsym sweep study.json --workers 2
    """
    from navsym.methods.sweep import sweep_from
    from navsym.text.jsonfile import read_json

    sweep = sweep_from(read_json(config))
    document = run_sweep(sweep, workers=workers, scheduler=scheduler, fresh=fresh)
    emit(document, as_json=json_, text=lambda: as_text(document))
    return 0 if document["done"] == sweep.jobs else 1


def run_sweep(sweep: Any, *, workers: int, scheduler: str | None, fresh: bool) -> dict[str, Any]:
    """Compute the jobs that are not in the store, keep each as it comes, and sum up."""
    from navsym.methods.dependencies import rooms_digest
    from navsym.methods.sweep import fingerprint, summary
    from navsym.store import key_of, opened

    name = fingerprint(sweep)
    keys = [key_of("job", name, str(index), rooms_digest()) for index in range(sweep.jobs)]
    with opened() as store:
        known = {} if fresh else store.get(keys)
        rows = [known[key] for key in keys if key in known]
        missing = [index for index, key in enumerate(keys) if key not in known]
        resume = "their rows are kept: the same command (without --fresh) goes on from there"
        with computed(sweep, missing, workers, scheduler) as results, Progress("jobs", resume=resume) as bar:
            for row in results:
                store.put(keys[row["index"]], row)
                rows.append(row)
                bar.told_by_job(len(rows), sweep.jobs)
    return {**summary(sweep, rows), "resumed": len(known)}


@contextlib.contextmanager
def computed(
    sweep: Any, indices: Sequence[int], workers: int, scheduler: str | None
) -> Iterator[Iterator[Any]]:
    """Rows as they are ready: in this process, from local processes, or from a cluster."""
    from navsym.methods.sweep import run_job

    if not indices or (workers == 0 and scheduler is None):
        yield (run_job(sweep, index) for index in indices)
        return
    from dask.distributed import Client, LocalCluster, as_completed

    with contextlib.ExitStack() as stack:
        where = scheduler or stack.enter_context(
            LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None)
        )
        client = stack.enter_context(Client(where))
        # Not pure: a row is computed again rather than taken from another session's cluster memory.
        futures = [client.submit(run_job, sweep, index, pure=False) for index in indices]
        yield (row for _, row in as_completed(futures, with_results=True))


def as_text(document: dict[str, Any]) -> str:
    lines = [
        f"{document['kind']}: {document['done']} of {document['jobs']} jobs, {document['resumed']} resumed"
    ]
    if "rmse" in document:
        lines.append("root mean square errors: " + ", ".join(f"{value:.6g}" for value in document["rmse"]))
    lines += [f"T = {row['T']}: {row['lower']} … {row['upper']}" for row in document["rows"] if "T" in row]
    return "\n".join(lines)
