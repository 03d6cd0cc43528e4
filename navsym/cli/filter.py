"""Filter measurements of a signal whose model switches: exact, pulsating, K-pulsating, GPB2, IMM, polygaussian."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from navsym.cli.output import emit, remark

if TYPE_CHECKING:
    from navsym.multimodel.filters import Estimates


def command(
    file: Annotated[
        Path, typer.Argument(metavar="BANK.json", help="JSON: models, mode_transition, initial, measurements")
    ],
    method: Annotated[
        str, typer.Option("--method", help="pulsating, k-pulsating, polygaussian, imm, gpb2 or exact")
    ] = "pulsating",
    depth: Annotated[
        int | None, typer.Option("--depth", help="K of k-pulsating: steps between two mergers  [default: 2]")
    ] = None,
    missing: Annotated[
        bool, typer.Option("--missing", help="take null in a measurement for a number that did not come")
    ] = False,
    form: Annotated[
        str, typer.Option("--form", help="how covariances are kept: joseph, or the factors qr, potter, ud")
    ] = "joseph",
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Mode probabilities, mean, covariance and log-likelihood after every measurement.

    Example: navsym filter examples/switching.json --method k-pulsating --depth 2
    """
    from navsym.core.errors import NavsymError
    from navsym.language.jsonfile import read_json
    from navsym.multimodel.filters import read_bank, run

    document = read_json(file)
    try:
        given = read_bank(document)
        estimate = run(
            given.bank,
            given.measurements,
            method,
            depth=depth,
            forget=given.forget,
            missing=missing or given.missing,
            form=form,
        )
    except NavsymError as error:
        raise error.at(str(file)) from None
    if method == "polygaussian" and not stays(given.bank.mode_transition):
        remark("mode_transition is not used: polygaussian takes modes that never switch, equation (19)")
    for sentence in remarks(estimate):
        remark(sentence)
    emit(as_document(estimate), as_json=json_, text=lambda: as_text(estimate))


def stays(mode_transition: Any) -> bool:
    """Whether no mode ever leads to another."""
    import numpy as np

    return bool((mode_transition == np.eye(mode_transition.shape[-1])).all())


def as_document(estimate: Estimates) -> dict[str, Any]:
    """The answer with exactly the keys of the interface."""
    return {
        "probabilities": estimate.probabilities.tolist(),
        "mean": estimate.mean.tolist(),
        "covariance": estimate.covariance.tolist(),
        "log_likelihood": estimate.log_likelihood.tolist(),
        "filters_run": estimate.filters_run,
    }


def remarks(estimate: Estimates) -> list[str]:
    """What the user should know and the document does not say."""
    out = [
        f"step {k}: every mode gives this measurement a likelihood below 1e-323; weighed by logarithms"
        for k in estimate.impossible
        if k not in estimate.left_out
    ]
    out += [f"step {k}: the measurement is impossible under every mode; left out" for k in estimate.left_out]
    return out


def as_text(estimate: Estimates) -> str:
    """A table for people: step, most probable mode, its probability, mean, standard deviations."""
    import numpy as np

    lines = ["step  mode  probability  mean (standard deviation)"]
    for k, (p, x, P) in enumerate(
        zip(estimate.probabilities, estimate.mean, estimate.covariance, strict=True), start=1
    ):
        spread = np.sqrt(np.diagonal(P).clip(0.0))
        values = "  ".join(f"{value:.6g} ({sigma:.2g})" for value, sigma in zip(x, spread, strict=True))
        lines.append(f"{k:4d}  {int(p.argmax()):4d}  {p.max():11.6f}  {values}")
    total = estimate.log_likelihood[-1] if len(estimate.log_likelihood) else 0.0
    return "\n".join([*lines, f"log-likelihood {total:.9g}; {estimate.filters_run} one-step filters"])
