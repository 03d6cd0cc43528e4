"""Write the guaranteed problem on a grid for casadi, for cvxpy or as an MPS file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from navsym.cli._settings import values_of
from navsym.cli.output import emit, put, write_text
from navsym.core.errors import NavsymError


def command(
    file: Annotated[Path, typer.Argument(help="model or basis file (TOML)")],
    to: Annotated[str, typer.Option(help="casadi, cvxpy or mps")] = "mps",
    kind: Annotated[str, typer.Option(help="lp (worst correlation), qp (white noise) or mixed")] = "lp",
    target: Annotated[str | None, typer.Option(help="name of the target; not needed where the file has one")] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="value of a parameter, such as T=2.5; may be repeated")
    ] = None,
    grid: Annotated[int, typer.Option(help="number of instants of each measurement")] = 201,
    mixture: Annotated[float, typer.Option(help="factor of the quadratic term, for --kind mixed")] = 1.0,
    out: Annotated[Path | None, typer.Option(help="file to write; standard output otherwise")] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Write the LP or QP of the problem on a grid of instants for another program.

    Example: navsym formulate examples/schuler-velocity.toml --target drift --set T=1 --to mps --out drift.mps
    """
    from navsym.guaranteed.formulate import formulate
    from navsym.guaranteed.problem import from_file
    from navsym.models.modelfile import read_model

    found = read_model(file, values_of(set_))
    try:
        text = formulate(from_file(found, target), to, kind=kind, count=grid, mixture=mixture)
    except NavsymError as error:
        raise error.at(str(file)) from None
    if out is not None:
        write_text(out, text)
    if json_:
        emit(
            {"to": to, "kind": kind, "grid": grid, "out": None if out is None else str(out), "text": text},
            as_json=True,
            text="",
        )
    else:
        put(text if out is None else f"{out}: {kind} for {to}, {grid} instants of each measurement\n")
