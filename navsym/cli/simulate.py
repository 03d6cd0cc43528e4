"""Run a paper's numerical experiment by its name."""

from __future__ import annotations

import inspect
from collections.abc import Container
from pathlib import Path
from typing import Annotated, Any

import typer

from navsym.cli._choice import one_of
from navsym.cli._progress import Progress
from navsym.cli.output import emit, table


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
    from navsym.claims.paper import experiment_names, import_paper
    from navsym.core.errors import DomainError

    one_of(name, experiment_names(), "name")
    if seed < 0:
        raise DomainError(f"expected a seed of at least 0; got {seed}; choose another", where="--seed")
    # A study takes seed, progress and perhaps runs, steps, journal; as_table gives headings and rows of its document.
    module = import_paper(f"{name}.experiment.study")
    given = {"runs": runs, "steps": steps, "journal": journal}
    options: dict[str, Any] = {key: value for key, value in given.items() if value is not None}
    accepted = inspect.signature(module.study).parameters
    for option in options:
        if option not in accepted:
            takes = ", ".join(f"--{key}" for key in ("seed", *given) if key in accepted)
            message = f"expected an option that {name} has ({takes}); got {option}; leave it out"
            raise DomainError(message, where=f"--{option}")
    with Progress("runs", resume=resume(journal, accepted)) as bar:
        document: dict[str, Any] = module.study(seed=seed, progress=bar.told_by_job, **options)
    emit(document, as_json=json_, text=lambda: table(*module.as_table(document)))


def resume(journal: Path | None, accepted: Container[str]) -> str:
    """How to go on after Ctrl-C."""
    if journal is not None:
        return f"finished runs are in {journal}: the same command goes on from there"
    if "journal" in accepted:
        return "nothing is kept: with --journal FILE finished runs are kept, and the same command goes on"
    return "nothing is kept" + (": fewer --runs take less time" if "runs" in accepted else "")
