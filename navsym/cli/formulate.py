"""The guaranteed problem on a grid for casadi, for cvxpy or as an MPS file."""

from __future__ import annotations

from pathlib import Path

import navsym as nav
from navsym.cli._settings import values_of
from navsym.cli.output import Told, write_text


def command(
    file: Path,
    *,
    to: str = "mps",
    kind: str = "lp",
    target: str | None = None,
    set_: list[str] | None = None,
    grid: int = 201,
    mixture: float = 1.0,
    out: Path | None = None,
) -> Told:
    """Write the linear or quadratic programme of the problem on a grid of times.

    Example: navsym formulate examples/schuler-velocity.toml --target drift --set T=1 --to mps --out drift.mps
    """
    answer = nav.formulate(file, target, to=to, kind=kind, grid=grid, mixture=mixture, values=values_of(set_))
    if out is not None:
        write_text(out, answer.text)
    text = answer.text if out is None else f"{out}: {kind} for {to}, {grid} times of each measurement"
    return Told(answer.document() | {"out": None if out is None else str(out)}, text)
