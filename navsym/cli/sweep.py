"""Run a Monte-Carlo or parameter study: resumable, here, on all cores or on a cluster."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli._options import called_options
from navsym.cli._progress import Progress
from navsym.cli.output import Told

if TYPE_CHECKING:
    from navsym.studies.run import Study


def command(
    config: Path,
    *,
    workers: int = os.cpu_count() or 1,
    scheduler: str | None = None,
    patience: float = 120.0,
    size: int | None = None,
    out: Path | None = None,
    fresh: bool = False,
) -> Told:
    """Compute the shards of a study that are not kept yet, and sum up; stopped, it goes on where it was.

    Every job has its own seed sequence: the rows are the same bits whoever computes them.

    Example: navsym sweep examples/study.json --workers 2
    """
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
    return Told(
        found.document, lambda: as_text(found), 1 if found.done < found.plan.jobs else 3 if found.unsaved else 0
    )


def as_text(found: Study) -> str:
    """Counts, errors of the filters, and what could not be kept."""
    lines = [f"{found.plan.kind}: {found.done} of {found.plan.jobs} jobs, {found.resumed} resumed"]
    if found.rmse:
        lines.append("root mean square errors: " + ", ".join(f"{value:.6g}" for value in found.rmse))
    lines += [f"not kept: {item}" for item in found.unsaved]
    lines += [f"T = {row['T']}: {row['lower']} … {row['upper']}" for row in found.rows if "T" in row]
    return "\n".join(lines)
