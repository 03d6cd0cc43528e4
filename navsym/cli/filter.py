"""Filter measurements of a signal whose model switches: exact, pulsating, K-pulsating, GPB2, IMM, polygaussian."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli.output import Told, remark

if TYPE_CHECKING:
    from navsym.multimodel.engine import Estimates


def command(
    file: Path, *, method: str = "pulsating", depth: int | None = None, missing: bool = False, form: str = "joseph"
) -> Told:
    """Mode probabilities, mean, covariance and log-likelihood after every measurement.

    Example: navsym filter examples/switching.json --method k-pulsating --depth 2
    """
    found = nav.filter(file, method=method, depth=depth, missing=missing, form=form)
    for sentence in found.remarks:
        remark(sentence)
    return Told(found.document, lambda: as_text(found))


def as_text(found: Estimates) -> str:
    """A table: step, most probable mode, its probability, mean, standard deviations."""
    lines = [f"{k:>4}  {mode:>4}  {share:>11}  {values}" for k, mode, share, values in found.rows()]
    total = found.log_likelihood[-1] if len(found.log_likelihood) else 0.0
    head = "step  mode  probability  mean (standard deviation)"
    return "\n".join([head, *lines, f"log-likelihood {total:.9g}; {found.filters_run} one-step filters"])
