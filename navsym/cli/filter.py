"""Filter measurements of a signal whose model switches: exact, pulsating, K-pulsating, GPB2, IMM, polygaussian."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from navsym.cli.output import emit, remark

if TYPE_CHECKING:
    from navsym.multimodel.engine import Estimates


def command(
    file: Annotated[
        Path, typer.Argument(metavar="BANK.json", help="JSON: models, mode_transition, initial, measurements")
    ],
    method: Annotated[str, typer.Option(help="pulsating, k-pulsating, polygaussian, imm, gpb2 or exact")] = "pulsating",
    depth: Annotated[int | None, typer.Option(help="K of k-pulsating: steps between two mergers  [default: 2]")] = None,
    missing: Annotated[
        bool, typer.Option("--missing", help="take null in a measurement for a number that did not come")
    ] = False,
    form: Annotated[
        str, typer.Option(help="how covariances are kept: joseph, or the factors qr, potter, ud")
    ] = "joseph",
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Mode probabilities, mean, covariance and log-likelihood after every measurement.

    Example: navsym filter examples/switching.json --method k-pulsating --depth 2
    """
    import navsym as nav

    found = nav.filter(file, method=method, depth=depth, missing=missing, form=form)
    for sentence in found.remarks:
        remark(sentence)
    emit(found.document(), as_json=json_, text=lambda: as_text(found))


def as_text(found: Estimates) -> str:
    """A table: step, most probable mode, its probability, mean, standard deviations."""
    lines = [f"{k:>4}  {mode:>4}  {share:>11}  {values}" for k, mode, share, values in found.rows()]
    total = found.log_likelihood[-1] if len(found.log_likelihood) else 0.0
    head = "step  mode  probability  mean (standard deviation)"
    return "\n".join([head, *lines, f"log-likelihood {total:.9g}; {found.filters_run} one-step filters"])
