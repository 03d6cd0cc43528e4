"""Velocity and acceleration of a track of positions, with standard deviations."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli._options import called_options
from navsym.cli._progress import Progress
from navsym.cli.output import Told, remark, table

if TYPE_CHECKING:
    from navsym.trajectory.motion import Track


def command(
    file: Path,
    *,
    window: float | None = None,
    order: int = 3,
    method: str | None = None,
    sigma: float | None = None,
    gate: float = 5.0,
    policy: str = "strict",
    reference: Path | None = None,
    out: Path | None = None,
) -> Told:
    """Velocity (m/s) and acceleration (m/s^2) from measured positions, with standard deviations.

    Seconds, degrees, metres, or the units in the heads of the columns, such as t (ms) or height (feet).

    Example: navsym track examples/drive.csv --order 3 --sigma 0.5
    """
    with called_options("track"), Progress("steps") as bar:
        found = nav.track(
            file,
            window=window,
            order=order,
            method=method,
            sigma=sigma,
            gate=gate,
            policy=policy,
            reference=reference,
            progress=bar.follow,
        )
    if out is not None:
        found.save(out)
    for line in found.warnings:
        remark(f"warning: {line}")
    for line in found.repairs:
        remark(f"repaired: {line}")
    return Told(found.document, lambda: as_text(found))


def as_text(found: Track) -> str:
    """A table of some rows."""
    head, lines = found.table()
    summary = (
        f"{len(found.t)} rows, method {found.method}, {found.order} states; noise of the positions "
        f"{found.position_sd[0]:.3g} m horizontal, {found.position_sd[2]:.3g} m vertical"
    )
    for name, value in (("NIS", found.nis), ("NEES", found.nees)):
        if value is not None:
            word = "in" if value.holds else "outside"
            low, high = value.band
            summary += f"\n{name} {value.mean:.3g}, {word} its 95 % band {low:.3g} to {high:.3g}"
    return f"{summary}\n{table(head, lines, right=head[:-1])}"
