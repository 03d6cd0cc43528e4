"""The configuration of a search as a map, a track and a grid of hypotheses.

Keys as in the interfaces; a key that is not among them is refused with those that are.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from navsym.core.arrays import without_units
from navsym.core.errors import DomainError, EmptyError, NavsymError, ShapeError
from navsym.language.names import only_keys, quote
from navsym.terrain.heights import Array, TerrainMap, vector
from navsym.terrain.maps import GEODETIC, PLANE, local_frame, metres_per_degree, middle_latitude, read_map, read_track
from navsym.terrain.track import Hypotheses, Profile

KEYS = ("map", "track", "position", "velocity", "interpolation")
KEYS_OF_GRID = ("step", "half_count")
#: What describes a map or a track: a file, or the numbers themselves, never both.
KEYS_OF_MAP_FILE = ("file", "nodata", "frame")
KEYS_OF_MAP = ("heights", "x0", "y0", "dx", "dy", "nodata")
KEYS_OF_TRACK_FILE = ("file",)


@dataclass(frozen=True, slots=True)
class OnEarth:
    """Where a map lies on the Earth: ``longitude = lon0 + x / per_degree[0]``, latitude likewise.

    per_degree : map units of a degree of longitude and of latitude; metres : metres of a map unit along x and y
    """

    lon0: float
    lat0: float
    per_degree: tuple[float, float]
    metres: tuple[float, float]

    def geodetic(self, x: float, y: float) -> tuple[float, float]:
        """(latitude, longitude) in degrees of a place of the map."""
        return self.lat0 + y / self.per_degree[1], self.lon0 + x / self.per_degree[0]


def read_search(
    config: Mapping[str, Any], folder: Path, *, velocity_needed: bool
) -> tuple[TerrainMap, Profile, Hypotheses, OnEarth | None]:
    """Map, track and hypotheses of a configuration, and where the map lies; file names start in ``folder``.

    velocity_needed : False when a grid without velocities will do
    """
    if not isinstance(config, Mapping):
        raise ShapeError(f"expected a table of map, track, position; got {type(config).__name__}; write one")
    only_keys(config, KEYS)
    if config.get("interpolation", "bilinear") != "bilinear":
        raise DomainError(f"interpolation: expected bilinear; got {config['interpolation']!r:.40}; leave it out")
    terrain, place = map_of(block(config, "map"), folder)
    length = "deg" if place is not None and place.metres != (1.0, 1.0) else "m"
    track = track_of(block(config, "track", length), folder, place)
    return terrain, track, grid_of(config, velocity_needed, length), place


def block(config: Mapping[str, Any], name: str, length: str = "m") -> Mapping[str, Any]:
    """A table of the configuration that must be there.

    length : unit of x and y of the map, in which quantities of pint go on
    """
    value: Any = config.get(name)
    if not (hasattr(value, "keys") and hasattr(value, "__getitem__")):  # a mapping or a data frame
        got = "nothing" if value is None else type(value).__name__
        raise ShapeError(f"{name}: expected a table; got {got}; add it", where=name)
    units = {"t": "s", "lat": "deg", "lon": "deg", **dict.fromkeys(("x", "y", "x0", "y0", "dx", "dy"), length)}
    units |= {"step": f"{length}/s" if name == "velocity" else length, "half_count": "1"}
    return {key: without_units(value[key], f"{name}.{key}", units.get(key, "m")) for key in value.keys()}  # noqa: SIM118


def entry(table: Mapping[str, Any], name: str, where: str) -> Any:
    """A value that must be there."""
    if name not in table:
        raise EmptyError(f"{name}: expected a value; got none; add it", where=where)
    return table[name]


def map_of(table: Mapping[str, Any], folder: Path) -> tuple[TerrainMap, OnEarth | None]:
    """A map from a file or from numbers, and where it lies on the Earth if that is known."""
    only_keys(table, KEYS_OF_MAP_FILE if "file" in table else KEYS_OF_MAP, "map")
    try:
        nodata = None if table.get("nodata") is None else number(table["nodata"], "nodata")
        if "file" in table:
            return map_in(folder / file_name(table, "map"), table.get("frame"), nodata)
        entries = {name: entry(table, name, "map") for name in KEYS_OF_MAP[:5]}
        return TerrainMap(**entries, nodata=nodata), None
    except NavsymError as error:
        raise error.at("map") if not error.where else error from None


def map_in(path: Path, frame: Any, nodata: float | None) -> tuple[TerrainMap, OnEarth | None]:
    """The map of a file, in the frame asked for, or in that of the file, and where it lies."""
    tile = read_map(path)
    frame = frame or ("geographic" if tile.geographic else "local")
    if frame not in ("geographic", "local"):
        raise DomainError(f"frame: expected geographic or local; got {frame!r:.40}; choose one")
    raster = local_frame(tile) if frame == "local" else tile
    void = raster.nodata if nodata is None else nodata
    terrain = TerrainMap(raster.heights, raster.x0, raster.y0, raster.dx, raster.dy, nodata=void)
    if not tile.geographic:
        return terrain, None
    metres = metres_per_degree(middle_latitude(tile))
    if frame == "local":
        return terrain, OnEarth(tile.x0, tile.y0, metres, (1.0, 1.0))
    return terrain, OnEarth(0.0, 0.0, (1.0, 1.0), metres)


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


def track_of(table: Mapping[str, Any], folder: Path, place: OnEarth | None) -> Profile:
    """A track from a CSV file or from four lists; ``lat`` and ``lon`` in degrees go to x and y of the map."""
    geodetic = "file" not in table and ("lat" in table or "lon" in table)
    only_keys(table, KEYS_OF_TRACK_FILE if "file" in table else GEODETIC if geodetic else PLANE, "track")
    try:
        columns = read_track(folder / file_name(table, "track")) if "file" in table else table
        if "lat" not in columns and "lon" not in columns:
            return Profile(*(entry(columns, name, "track") for name in PLANE))
        t, lat, lon, h = (entry(columns, name, "track") for name in GEODETIC)
        return Profile(t, *on_map(vector("lat", lat, None, "degrees"), vector("lon", lon, None, "degrees"), place), h)
    except NavsymError as error:
        raise error.at("track") if not error.where else error from None


def on_map(latitude: Array, longitude: Array, place: OnEarth | None) -> tuple[Array, Array]:
    """x and y of latitudes and longitudes in degrees; DomainError for a map that does not lie on the Earth."""
    if place is None:
        raise DomainError(
            "expected x and y for a map in metres; got lat and lon; use a tile in degrees, or give x and y"
        )
    if np.abs(latitude).max(initial=0.0) > 90.0 or np.abs(longitude).max(initial=0.0) > 360.0:
        raise DomainError("expected lat within 90 and lon within 360 degrees; got larger numbers; give degrees")
    return (longitude - place.lon0) * place.per_degree[0], (latitude - place.lat0) * place.per_degree[1]


def grid_of(config: Mapping[str, Any], velocity_needed: bool, length: str) -> Hypotheses:
    """Hypotheses of position and, where they are needed or given, of velocity."""
    places = steps_of(config, "position", length)
    still = not velocity_needed and "velocity" not in config
    speeds = [] if still else steps_of(config, "velocity", length)
    try:
        return Hypotheses(*places, *speeds)
    except NavsymError as error:
        raise error.at("position, velocity") if not error.where else error from None


def steps_of(config: Mapping[str, Any], name: str, length: str) -> list[Any]:
    """Step and half count of a table of hypotheses."""
    table = block(config, name, length)
    only_keys(table, KEYS_OF_GRID, name)
    return [entry(table, key, name) for key in KEYS_OF_GRID]
