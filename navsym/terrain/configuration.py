"""The configuration of a search as a map, a track and a grid of hypotheses.

Keys as in the interfaces; a key that is not among them is refused with those that are.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from navsym.core.errors import DomainError, EmptyError, NavsymError, ShapeError
from navsym.language.names import only_keys, quote
from navsym.terrain.heights import TerrainMap
from navsym.terrain.maps import local_frame, read_map, read_track
from navsym.terrain.track import Hypotheses, Profile

KEYS = ("map", "track", "position", "velocity", "interpolation")
KEYS_OF_GRID = ("step", "half_count")
#: What describes a map or a track: a file, or the numbers themselves, never both.
KEYS_OF_MAP_FILE = ("file", "nodata", "frame")
KEYS_OF_MAP = ("heights", "x0", "y0", "dx", "dy", "nodata")
KEYS_OF_TRACK_FILE, KEYS_OF_TRACK = ("file",), ("t", "x", "y", "h")


def read_search(
    config: Mapping[str, Any], folder: Path, *, velocity_needed: bool
) -> tuple[TerrainMap, Profile, Hypotheses]:
    """Map, track and hypotheses of a configuration; file names start in ``folder``.

    velocity_needed : False when a grid without velocities will do
    """
    if not isinstance(config, Mapping):
        raise ShapeError(f"expected a table of map, track, position; got {type(config).__name__}; write one")
    only_keys(config, KEYS)
    if config.get("interpolation", "bilinear") != "bilinear":
        raise DomainError(f"interpolation: expected bilinear; got {config['interpolation']!r:.40}; leave it out")
    terrain = map_of(block(config, "map"), folder)
    return terrain, track_of(block(config, "track"), folder), grid_of(config, velocity_needed)


def block(config: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    """A table of the configuration that must be there."""
    value: Any = config.get(name)
    if not isinstance(value, Mapping) and hasattr(value, "keys") and hasattr(value, "__getitem__"):  # a data frame
        return {key: value[key] for key in value.keys()}  # noqa: SIM118
    if not isinstance(value, Mapping):
        got = "nothing" if value is None else type(value).__name__
        raise ShapeError(f"{name}: expected a table; got {got}; add it", where=name)
    return value


def entry(table: Mapping[str, Any], name: str, where: str) -> Any:
    """A value that must be there."""
    if name not in table:
        raise EmptyError(f"{name}: expected a value; got none; add it", where=where)
    return table[name]


def map_of(table: Mapping[str, Any], folder: Path) -> TerrainMap:
    """A map from a file or from numbers."""
    only_keys(table, KEYS_OF_MAP_FILE if "file" in table else KEYS_OF_MAP, "map")
    try:
        nodata = None if table.get("nodata") is None else number(table["nodata"], "nodata")
        if "file" in table:
            return map_in(folder / file_name(table, "map"), table.get("frame"), nodata)
        entries = {name: entry(table, name, "map") for name in KEYS_OF_MAP[:5]}
        return TerrainMap(**entries, nodata=nodata)
    except NavsymError as error:
        raise error.at("map") if not error.where else error from None


def map_in(path: Path, frame: Any, nodata: float | None) -> TerrainMap:
    """The map of a file, in the frame asked for, or in that of the file."""
    raster = read_map(path)
    frame = frame or ("geographic" if raster.geographic else "local")
    if frame not in ("geographic", "local"):
        raise DomainError(f"frame: expected geographic or local; got {frame!r:.40}; choose one")
    raster = local_frame(raster) if frame == "local" else raster
    void = raster.nodata if nodata is None else nodata
    return TerrainMap(raster.heights, raster.x0, raster.y0, raster.dx, raster.dy, nodata=void)


def number(value: Any, name: str) -> float:
    """One number; an integer that no float can hold is refused as well."""
    if isinstance(value, bool) or not isinstance(value, int | float) or abs(value) > sys.float_info.max:
        raise ShapeError(f"{name}: expected a number; got {quote(value)}; mend it")
    return float(value)


def file_name(table: Mapping[str, Any], where: str) -> str:
    """The name of a file; whether there is one is the reader's business."""
    name = table["file"]
    if not isinstance(name, str) or not name or "\0" in name:
        raise ShapeError(f"file: expected the name of a file; got {name!r:.60}; mend it", where=where)
    return name


def track_of(table: Mapping[str, Any], folder: Path) -> Profile:
    """A track from a CSV file or from four lists."""
    only_keys(table, KEYS_OF_TRACK_FILE if "file" in table else KEYS_OF_TRACK, "track")
    try:
        columns = read_track(folder / file_name(table, "track")) if "file" in table else table
        return Profile(*(entry(columns, name, "track") for name in KEYS_OF_TRACK))
    except NavsymError as error:
        raise error.at("track") if not error.where else error from None


def grid_of(config: Mapping[str, Any], velocity_needed: bool) -> Hypotheses:
    """Hypotheses of position and, where they are needed or given, of velocity."""
    places = steps_of(config, "position")
    still = not velocity_needed and "velocity" not in config
    speeds = [] if still else steps_of(config, "velocity")
    try:
        return Hypotheses(*places, *speeds)
    except NavsymError as error:
        raise error.at("position, velocity") if not error.where else error from None


def steps_of(config: Mapping[str, Any], name: str) -> list[Any]:
    """Step and half count of a table of hypotheses."""
    table = block(config, name)
    only_keys(table, KEYS_OF_GRID, name)
    return [entry(table, key, name) for key in KEYS_OF_GRID]
