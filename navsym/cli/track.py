"""Velocity and acceleration of a track of positions, with standard deviations.

The work is done by :mod:`navsym.trajectory.document`; this file reads, calls and prints.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from navsym.cli.output import emit, remark, table
from navsym.core.errors import DomainError, NavsymError

SHOWN = 12


def command(
    file: Annotated[Path, typer.Argument(help="CSV of time, latitude, longitude, height, or an RTKLIB .pos")],
    window: Annotated[
        float | None, typer.Option("--window", help="length of the sliding window, seconds; chooses --method window")
    ] = None,
    order: Annotated[
        int, typer.Option("--order", help="states of the motion: 2 to speed, 3 to acceleration, up to 6")
    ] = 3,
    method: Annotated[
        str | None, typer.Option("--method", help="differences, window, filter, smoother (default) or guaranteed")
    ] = None,
    sigma: Annotated[
        float | None, typer.Option("--sigma", help="standard deviation of positions, metres; default: the file's")
    ] = None,
    gate: Annotated[
        float, typer.Option("--gate", help="innovations beyond so many standard deviations are believed less; 0: off")
    ] = 5.0,
    policy: Annotated[
        str, typer.Option("--policy", help="bad rows: strict refuses them, repair mends and lists them")
    ] = "strict",
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Velocity (m/s) and acceleration (m/s^2) from measured positions, with standard deviations.

    Example: navsym track examples/drive.csv --order 3 --sigma 0.5
    """
    chosen = method_of(method, window)
    if sigma is not None and not 0 < sigma < float("inf"):
        message = f"expected a positive number of metres; got {sigma}; leave it out if unknown"
        raise DomainError(message, where="--sigma")
    found = answer(file, policy, sigma, {"method": chosen, "order": order, "window": window, "gate": gate})
    for line in found["warnings"]:
        remark(f"warning: {line}")
    for line in found["repairs"]:
        remark(f"repaired: {line}")
    emit(found, as_json=json_, text=lambda: shown(found))


def method_of(named: str | None, window: float | None) -> str:
    """The method: a window asks for the sliding window, every other choice has to be named."""
    chosen = named or ("window" if window is not None else "smoother")
    if window is not None and chosen not in ("window", "guaranteed"):
        message = f"expected method window or guaranteed with it; got {chosen}; drop one"
        raise DomainError(message, where="--window")
    return chosen


def answer(file: Path, policy: str, sigma: float | None, chosen: dict[str, Any]) -> dict[str, Any]:
    """The document of the estimate; ``chosen`` goes to ``Settings``, which checks it."""
    from navsym.trajectory.document import document
    from navsym.trajectory.estimate import Settings
    from navsym.trajectory.reader import read_track
    from navsym.trajectory.tracks import project_positions

    settings = Settings(**chosen, fixed_scale=sigma is not None)
    read = read_track(file, policy)  # type: ignore[arg-type]
    try:
        given = read.sigma if sigma is None else sigma
        track = project_positions(read.t - read.t[0], read.latitude, read.longitude, read.height, given)
        return document(read.t, track, settings, lines=read.lines, warnings=read.warnings, repairs=read.repairs)
    except NavsymError as error:
        raise error.at(str(file)) from None


def shown(found: dict[str, Any]) -> str:
    """A table of some rows for people."""
    rows = found["rows"]
    step = max(1, rows // SHOWN)
    lines = [
        (
            f"{found['t'][k]:.3f}",
            *quantity(found, "velocity", k),
            *quantity(found, "acceleration", k),
            found["flags"][k],
        )
        for k in range(0, rows, step)
    ]
    head = ("t, s", "vE, m/s", "vN", "vU", "aE, m/s2", "aN", "aU", "row")
    noise = found["noise"]["position_sd"]
    text = table(head, lines, right=head[:-1])
    summary = (
        f"{rows} rows, method {found['method']}, {found['order']} states; noise of the positions "
        f"{noise[0]:.3g} m horizontal, {noise[2]:.3g} m vertical"
    )
    return f"{summary}\n{text}"


def quantity(found: dict[str, Any], name: str, k: int) -> list[str]:
    pairs = zip(found[name][k], found[f"{name}_sd"][k], strict=True)
    return [f"{value:.3f} ± {deviation:.3f}" for value, deviation in pairs]
