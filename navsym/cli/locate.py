"""Fix a position over a height map from a measured profile."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli._options import called_options
from navsym.cli.output import Told, remark, table

if TYPE_CHECKING:
    from navsym.terrain.locate import Fix


def command(config: Path, *, method: str = "full", maps: bool = False, offset_free: bool = False) -> Told:
    """Fix a position, and the errors of velocity, over a height map from a measured profile.

    Positions are in metres of the map, velocities in m/s, the criterion in square metres.

    Example: navsym locate examples/flight.json --method sequential
    """
    with called_options("locate"):
        found = nav.locate(config, method, maps=maps, offset_free=offset_free)
    for line in found.remarks:
        remark(f"note: {line}")
    return Told(found.document, lambda: as_text(found))


def as_text(found: Fix) -> str:
    """The fix and its correction, after the hypothesis that gives them."""
    second = "none" if found.second_best is None else f"{found.second_best:.6g}"
    lines = [
        f"method {found.method}: hypothesis {list(found.position_index)}, "
        f"{list(found.velocity_index)}, {found.evaluated} evaluated",
        f"criterion {found.criterion:.6g}, second best {second}, unique {found.unique}",
    ]
    trust = found.trust
    if trust.direction is not None:
        where = ", ".join(f"{v:.3f}" for v in trust.direction)
        lines.append(f"weakest along ({where}): deviation {trust.weakest:.4g} m, {trust.strongest:.4g} m across")
    if found.geodetic is not None:
        lines.append(f"latitude {found.geodetic[0]:.7f}, longitude {found.geodetic[1]:.7f} degrees")
    if found.height_offset is not None:
        lines.append(f"height offset {found.height_offset:.3f} m, measured minus mapped")
    if found.t_G:
        low, high, middle = found.t_G
        lines.append(f"t_G from {low:.2f} to {high:.2f}, middle {middle:.2f} (measurements)")
    return "\n".join([*lines, table(*found.table(), right=("fix", "correction"))])
