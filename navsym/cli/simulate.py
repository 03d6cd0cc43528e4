"""Run a paper's numerical experiment by its name."""

from __future__ import annotations

import importlib
from typing import Annotated, Any

import typer

from navsym.cli.output import emit, table

#: Name -> "module:experiment:as_table". The experiment takes runs, seed, steps and returns plain data;
#: as_table turns that into headings and rows. Modules are imported when their name is asked for.
EXPERIMENTS = {
    "multistructure": "navsym.methods.multimodel_study:experiment:as_table",
    "terrain_search": "navsym.methods.terrain_experiment:study:as_table",
}


def command(
    name: Annotated[str, typer.Argument(help="name of the experiment")],
    runs: Annotated[int | None, typer.Option("--runs", help="Monte-Carlo runs")] = None,
    steps: Annotated[int | None, typer.Option("--steps", help="steps of each run")] = None,
    seed: Annotated[int, typer.Option("--seed", help="same seed, same answer")] = 1,
    json_: Annotated[bool, typer.Option("--json", help="one JSON document")] = False,
) -> None:
    """The numbers of one study, with confidence intervals."""
    from navsym.errors import DomainError

    if name not in EXPERIMENTS:
        raise DomainError(f"name: expected one of {', '.join(EXPERIMENTS)}; got {name!r}; choose one")
    module_name, experiment, as_table = EXPERIMENTS[name].split(":")
    module = importlib.import_module(module_name)
    given = {"runs": runs, "steps": steps}
    options = {key: value for key, value in given.items() if value is not None}
    document: dict[str, Any] = getattr(module, experiment)(seed=seed, **options)
    emit(document, as_json=json_, text=lambda: table(*getattr(module, as_table)(document)))
