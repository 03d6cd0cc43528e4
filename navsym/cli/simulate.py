"""Run a paper's numerical experiment by its name."""

from __future__ import annotations

from collections.abc import Container
from pathlib import Path

import navsym as nav
from navsym.cli._options import called_options
from navsym.cli._progress import Progress
from navsym.cli.output import Told, table


def command(
    name: str, *, runs: int | None = None, steps: int | None = None, seed: int = 1, journal: Path | None = None
) -> Told:
    """Run the numerical experiment of a paper again; its figures, with confidence intervals where it is random.

    Example: navsym simulate multistructure --runs 200 --seed 1
    """
    from navsym.studies.experiments import options_of

    with called_options("simulate"), Progress("runs", resume=resume(journal, options_of(name))) as bar:
        found = nav.simulate(name, runs=runs, steps=steps, seed=seed, journal=journal, progress=bar.follow)
    return Told(found.document, lambda: table(*found.table()))


def resume(journal: Path | None, accepted: Container[str]) -> str:
    """How to go on after Ctrl-C."""
    if journal is not None:
        return f"finished runs are in {journal}: the same command goes on from there"
    if "journal" in accepted:
        return "nothing is kept: with --journal FILE finished runs are kept, and the same command goes on"
    return "nothing is kept" + (": fewer --runs take less time" if "runs" in accepted else "")
