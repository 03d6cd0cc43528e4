"""Run a paper's numerical experiment by its name."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Container
from pathlib import Path
from typing import Annotated, Any

import typer

from navsym.cli._choice import one_of
from navsym.cli._progress import Progress
from navsym.cli.output import emit, table

#: Name -> "module:experiment:as_table". The experiment takes seed, progress and perhaps runs, steps, journal, and
#: returns plain data; as_table turns that into headings and rows. Modules are imported when their name is asked for.
EXPERIMENTS = {
    "joint_correction": "navsym.observability.two_stage.study:study:as_table",
    "multistructure": "navsym.multimodel.study:experiment:as_table",
    "terrain_search": "navsym.terrain.experiment:study:as_table",
    "trajectory": "navsym.trajectory.study:study:as_table",
}


def command(
    name: Annotated[str, typer.Argument(help="joint_correction, multistructure, terrain_search or trajectory")],
    runs: Annotated[int | None, typer.Option("--runs", help="Monte-Carlo runs; default: those of the study")] = None,
    steps: Annotated[
        int | None, typer.Option("--steps", help="time steps of each run; default: those of the study")
    ] = None,
    seed: Annotated[int, typer.Option("--seed", help="same seed, same answer")] = 1,
    journal: Annotated[
        Path | None, typer.Option("--journal", help="keep finished runs in this file and go on from it")
    ] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Run the numerical experiment of a paper again; its figures, with confidence intervals where it is random.

    Example: navsym simulate multistructure --runs 200 --seed 1
    """
    from navsym.core.errors import DomainError

    one_of(name, EXPERIMENTS, "name")
    if seed < 0:
        raise DomainError(f"expected a seed of at least 0; got {seed}; choose another", where="--seed")
    module_name, experiment, as_table = EXPERIMENTS[name].split(":")
    module = importlib.import_module(module_name)
    given = {"runs": runs, "steps": steps, "journal": journal}
    options: dict[str, Any] = {key: value for key, value in given.items() if value is not None}
    accepted = inspect.signature(getattr(module, experiment)).parameters
    for option in options:
        if option not in accepted:
            takes = ", ".join(f"--{key}" for key in ("seed", *given) if key in accepted)
            message = f"expected an option that {name} has ({takes}); got {option}; leave it out"
            raise DomainError(message, where=f"--{option}")
    with Progress("runs", resume=resume(journal, accepted)) as bar:
        document: dict[str, Any] = getattr(module, experiment)(seed=seed, progress=bar.told_by_job, **options)
    emit(document, as_json=json_, text=lambda: table(*getattr(module, as_table)(document)))


def resume(journal: Path | None, accepted: Container[str]) -> str:
    """How to go on after Ctrl-C."""
    if journal is not None:
        return f"finished runs are in {journal}: the same command goes on from there"
    if "journal" in accepted:
        return "nothing is kept: with --journal FILE finished runs are kept, and the same command goes on"
    return "nothing is kept" + (": fewer --runs take less time" if "runs" in accepted else "")
