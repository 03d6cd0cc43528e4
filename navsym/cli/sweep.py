"""Run a Monte-Carlo or parameter study: resumable, here, on all cores or on a cluster."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from navsym.cli._options import called_options
from navsym.cli._progress import Progress
from navsym.cli.output import emit

if TYPE_CHECKING:
    from navsym.studies.run import Study


def command(
    config: Annotated[Path, typer.Argument(help='JSON: {"kind": "filter", "jobs": 100, "seed": 1, …}')],
    workers: Annotated[
        int, typer.Option(min=0, help="local processes, 0 computes in this one; default: all cores")
    ] = os.cpu_count() or 1,
    scheduler: Annotated[str | None, typer.Option(help="tcp://host:port of a running dask scheduler")] = None,
    patience: Annotated[
        float, typer.Option(min=1.0, help="seconds without any worker until a scheduler is given up")
    ] = 120.0,
    size: Annotated[
        int | None, typer.Option(min=1, help="jobs in a shard, which is kept whole; default: at most 100")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="folder of the shards in Parquet; default: one in the cache")] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="do everything again, ignoring what is kept")] = False,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> int:
    """Compute the shards of a study that are not kept yet, and sum up; stopped, it goes on where it was.

    Every job has its own seed sequence: the rows are the same bits whoever computes them.

    Example: navsym sweep examples/study.json --workers 2
    """
    import navsym as nav

    resume = "finished shards are kept: the same command (without --fresh) goes on from there"
    with called_options("sweep"), Progress("jobs", resume=resume) as bar:
        found = nav.sweep(
            config,
            workers=workers,
            scheduler=scheduler,
            out=out,
            size=size,
            fresh=fresh,
            patience=patience,
            progress=bar.follow,
        )
    emit(found.document(), as_json=json_, text=lambda: as_text(found))
    return 1 if found.done < found.plan.jobs else 3 if found.unsaved else 0


def as_text(found: Study) -> str:
    """Counts, errors of the filters, and what could not be kept."""
    lines = [f"{found.plan.kind}: {found.done} of {found.plan.jobs} jobs, {found.resumed} resumed"]
    if found.rmse:
        lines.append("root mean square errors: " + ", ".join(f"{value:.6g}" for value in found.rmse))
    lines += [f"not kept: {item}" for item in found.unsaved]
    lines += [f"T = {row['T']}: {row['lower']} … {row['upper']}" for row in found.rows if "T" in row]
    return "\n".join(lines)
