"""Fix a position over a height map from a measured profile.

The work is done by :func:`navsym.terrain.locate.locate`; this file reads, calls and prints.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from navsym.cli.output import emit, remark, table


def command(
    config: Annotated[Path, typer.Argument(help="JSON: map, track, position and velocity hypotheses")],
    method: Annotated[str, typer.Option("--method", help="position, full, sequential or refined")] = "full",
    maps: Annotated[bool, typer.Option("--maps", help="add the criterion over positions, row = j")] = False,
    offset_free: Annotated[
        bool, typer.Option("--offset-free", help="heights have an unknown constant error; estimate it too")
    ] = False,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Fix a position, and the errors of velocity, over a height map from a measured profile.

    Positions are in metres of the map, velocities in m/s, the criterion in square metres.

    Example: navsym locate examples/flight.json --method sequential
    """
    from navsym.core.errors import NavsymError
    from navsym.language.jsonfile import read_json
    from navsym.terrain.locate import locate

    document = read_json(config)
    try:
        found = locate(document, method, folder=config.parent, maps=maps, offset_free=offset_free)
    except NavsymError as error:
        raise error if error.where.startswith(str(config)) else error.at(str(config)) from None
    for line in found.remarks:
        remark(f"note: {line}")
    emit(found.document, as_json=json_, text=lambda: shown(found.document))


def shown(document: dict[str, Any]) -> str:
    """The answer for people."""
    fix, move = document["fix"], document["correction"]
    rows = [
        ("x", f"{fix['x']:.3f}", f"{move['dx']:+.3f}"),
        ("y", f"{fix['y']:.3f}", f"{move['dy']:+.3f}"),
        ("vx", f"{fix['vx']:.4f}", f"{move['dvx']:+.4f}"),
        ("vy", f"{fix['vy']:.4f}", f"{move['dvy']:+.4f}"),
    ]
    text = table(("", "fix", "correction"), rows, right=("fix", "correction"))
    second = "none" if document["second_best"] is None else f"{document['second_best']:.6g}"
    lines = [
        f"method {document['method']}: hypothesis {document['position_index']}, "
        f"{document['velocity_index']}, {document['evaluated']} evaluated",
        f"criterion {document['criterion']:.6g}, second best {second}, unique {document['unique']}",
    ]
    if "height_offset" in document:
        lines.append(f"height offset {document['height_offset']:.3f} m, measured minus mapped")
    if document["t_G"]:
        t_G = "t_G from {min:.2f} to {max:.2f}, middle {mid:.2f} (measurements)"
        lines.append(t_G.format(**document["t_G"]))
    return "\n".join([*lines, text])
