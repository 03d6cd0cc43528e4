"""The guaranteed problem on a grid for casadi, for cvxpy or as an MPS file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from navsym.cli._settings import values_of
from navsym.cli.output import emit, put, write_text


def command(
    file: Annotated[Path, typer.Argument(help="model or basis file (TOML)")],
    to: Annotated[str, typer.Option(help="casadi, cvxpy or mps")] = "mps",
    kind: Annotated[str, typer.Option(help="lp (worst correlation), qp (white noise) or mixed")] = "lp",
    target: Annotated[str | None, typer.Option(help="name of the target; not needed where the file has one")] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="value of a parameter, such as T=2.5; may be repeated")
    ] = None,
    grid: Annotated[int, typer.Option(help="number of times of each measurement")] = 201,
    mixture: Annotated[float, typer.Option(help="factor of the quadratic term, for --kind mixed")] = 1.0,
    out: Annotated[Path | None, typer.Option(help="file to write; standard output otherwise")] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Write the linear or quadratic programme of the problem on a grid of times.

    Example: navsym formulate examples/schuler-velocity.toml --target drift --set T=1 --to mps --out drift.mps
    """
    import navsym as nav

    answer = nav.formulate(file, target, to=to, kind=kind, grid=grid, mixture=mixture, values=values_of(set_))
    if out is not None:
        write_text(out, answer.text)
    if json_:
        emit(answer.document() | {"out": None if out is None else str(out)}, as_json=True, text="")
    else:
        put(answer.text if out is None else f"{out}: {kind} for {to}, {grid} times of each measurement\n")
