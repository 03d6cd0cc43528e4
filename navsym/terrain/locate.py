"""From a configuration to a fix."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from navsym.core.answers import Answer, named
from navsym.core.arrays import Array
from navsym.core.errors import DomainError, OutsideMapError
from navsym.core.tables import Table
from navsym.language.files import file_in_errors
from navsym.language.jsonfile import read_json
from navsym.language.names import quote
from navsym.terrain.centre import demand_estimable, one_sided
from navsym.terrain.configuration import OnEarth, read_search
from navsym.terrain.covariance import Trust, trust_of
from navsym.terrain.heights import ON_MAP, TerrainMap
from navsym.terrain.refine import refine
from navsym.terrain.search import Correction, Search, criteria, prepare, search_full, search_position
from navsym.terrain.sequential import search_sequential
from navsym.terrain.track import Hypotheses, Profile

FEET = 0.3048
#: Times the usual departure from the map beyond which a height is named, and the least that is usual, m.
GROSS, GRAIN = 20.0, 0.1
#: Share by which the misfit must fall before feet, or a misplaced datum, are suspected.
MUCH_BETTER = 0.25


@dataclass(frozen=True, slots=True, eq=False)
class Fix(Answer):
    """A position over a height map, from a measured profile; the answer of :func:`locate`.

    x, y, vx, vy : position and velocity at the last time, in map units and map units per second
    correction   : of x, y (2,) and of vx, vy (2,) at the last time
    position_index, velocity_index : (i, j), (Vi, Vj) of the best hypothesis, from -N to N
    criterion    : its sum of squared height differences, m^2; second_best : of the best other one, None without
    unique       : True or False where proved, else None
    t_G          : (min, max, mid) of the sequential method, counted in measurements; quadratic : (A2, A1, A0)
    evaluated    : hypotheses evaluated over all measurements
    height_offset : mean of the measured less the mapped heights, m; None unless it was asked for
    criterion_map : (My, Mx), row = j, inf off the map; None unless it was asked for
    trust        : covariance of the fix, of x, y[, vx, vy] in units of the map, its weakest direction in metres
    geodetic     : latitude and longitude in degrees, for a map that lies on the Earth, else None
    remarks      : sentences about units, the edge of the grid, ties, geometry
    """

    method: str
    x: float
    y: float
    vx: float
    vy: float
    correction: tuple[Array, Array]
    position_index: tuple[int, int]
    velocity_index: tuple[int, int]
    criterion: float
    second_best: float | None
    unique: bool | None
    t_G: tuple[float, float, float] | None
    quadratic: tuple[float, float, float] | None
    evaluated: int
    height_offset: float | None
    criterion_map: Array | None
    trust: Trust
    geodetic: tuple[float, float] | None
    remarks: tuple[str, ...]

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym locate``: plain numbers, no infinities."""
        moves = (float(value) for part in self.correction for value in part)
        document: dict[str, Any] = {
            **named(self, "method position_index velocity_index criterion second_best unique"),
            "t_G": None if self.t_G is None else dict(zip(("min", "max", "mid"), self.t_G, strict=True)),
            **named(self, "quadratic"),
            "fix": named(self, "x y vx vy"),
            "correction": dict(zip(("dx", "dy", "dvx", "dvy"), moves, strict=True)),
            "evaluated": self.evaluated,
            **named(self.trust, "covariance"),
            "weakest": None
            if self.trust.direction is None
            else {"direction": self.trust.direction.tolist(), "sd": self.trust.weakest, "across": self.trust.strongest},
            **named(self, "remarks"),
        }
        if self.geodetic is not None:
            document["fix"] |= {"latitude": self.geodetic[0], "longitude": self.geodetic[1]}
        if self.height_offset is not None:
            document["height_offset"] = self.height_offset
        if self.criterion_map is not None:
            document["criterion_map"] = [[finite_or_none(q) for q in row] for row in self.criterion_map]
        return document

    def __repr__(self) -> str:
        return f"<Fix x {self.x:.6g}, y {self.y:.6g}: method {self.method}, criterion {self.criterion:.6g}>"

    def table(self) -> Table:
        """The fix and its correction, in metres and metres per second."""
        moves = (float(value) for part in self.correction for value in part)
        values = zip(("x", "y", "vx", "vy"), (self.x, self.y, self.vx, self.vy), (3, 3, 4, 4), moves, strict=True)
        return ("", "fix", "correction"), [(name, f"{at:.{n}f}", f"{move:+.{n}f}") for name, at, n, move in values]


def locate(
    config: str | os.PathLike[str] | Mapping[str, Any],
    method: str = "full",
    *,
    folder: str | os.PathLike[str] | None = None,
    maps: bool = False,
    offset_free: bool = False,
) -> Fix:
    """Fix the position of a track over a height map, from the terrain heights measured along it.

    config : path of a JSON file, or its document: ``map``, ``track``, ``position``, ``velocity``; heights and columns
             may be arrays, the track a DataFrame with columns t, x, y, h. Metres, seconds.
             A geographic tile lies in degrees (x longitude, y latitude) unless its map block says
             ``"frame": "local"``: then in metres east and north of its south-west node.
    method : ``position``, ``full`` (t0 the first time), ``sequential`` (the paper's) or ``refined``
    folder : where relative file names start; default: that of the file
    maps   : add the criterion over positions, row = j
    offset_free : the criterion without its mean, for heights with an unknown constant error; adds its estimate

    The best hypothesis has the least ``sum (h_k - H(x_k + i Dx + Vi DVx tau_k, y_k + …))^2``, H bilinear between
    ``heights[row, column]`` at (x0 + column dx, y0 + row dy). The fix holds at the last time, where the inertial
    velocity is the difference quotient of the last two positions. t_G counts time in measurements from 0.

    Returns :class:`Fix`. Raises NavsymError: ``shape``, ``domain``, ``outside-map``, ``nodata``, ``not-estimable``
    (flat terrain), ``unknown-symbol`` (a key), ``too-large``, ``missing-file``. Source: terrain_search:2 to :14.

    >>> import navsym as nav
    >>> fix = nav.locate("examples/flight.json")
    >>> fix
    <Fix x 2000, y 1500: method full, criterion 31.7641>
    >>> fix.position_index, fix.velocity_index
    ((4, -2), (0, 0))
    >>> nav.locate({"map": {}})
    Traceback (most recent call last):
    navsym.core.errors.EmptyError: locate: map: heights: expected a value; got none; add it
    """
    if not isinstance(method, str) or method not in SEARCHES:
        message = f"expected one of {', '.join(SEARCHES)}; got {quote(method)}; choose one"
        raise DomainError(message, where="locate: method")
    if isinstance(config, str | os.PathLike) and folder is None:
        folder = Path(config).parent
    with file_in_errors(config, "locate"):
        document = read_json(config) if isinstance(config, str | os.PathLike) else config
        case = read_search(document, Path(folder or "."), velocity_needed=method != "position")
        return fix_of(*case, method, maps, offset_free)


def fix_of(
    terrain: TerrainMap,
    track: Profile,
    grid: Hypotheses,
    place: OnEarth | None,
    method: str,
    maps: bool,
    offset_free: bool,
) -> Fix:
    """The answer of one method."""
    found = SEARCHES[method](terrain, track, grid, offset_free)
    if not math.isfinite(found.criterion):
        message = "expected a hypothesis on known ground; got none; use a larger map, or smaller steps"
        raise OutsideMapError(message, where="position, velocity")
    x, y = float(track.x[-1]) + float(found.shift[0]), float(track.y[-1]) + float(found.shift[1])
    velocity = track.final_velocity
    trust = trust_of(
        terrain,
        track,
        corrected(track, found),
        velocity=method != "position",
        offset=offset_free,
        grid=None if method == "refined" else grid,
        metres=(1.0, 1.0) if place is None else place.metres,
    )
    return Fix(
        method,
        x,
        y,
        velocity[0] + float(found.velocity[0]),
        velocity[1] + float(found.velocity[1]),
        (found.shift, found.velocity),
        found.index[:2],
        found.index[2:],
        found.criterion,
        finite_or_none(found.second_best),
        None if is_alone(grid, found) else found.unique,
        found.t_G,
        found.quadratic,
        found.evaluated,
        height_offset(terrain, track, found) if offset_free else None,
        criterion_map(terrain, track, grid, found, offset_free) if maps else None,
        trust,
        None if place is None else place.geodetic(x, y),
        (*remarks(terrain, track, grid, found, offset_free), *trust.remarks),
    )


# The methods


def by_grid(
    search: Callable[..., Search], terrain: TerrainMap, track: Profile, grid: Hypotheses, offset_free: bool
) -> Correction:
    """The best hypothesis of a search over the grid; raises NotEstimableError over flat terrain."""
    answer = answer_of(search(terrain, track, grid, offset_free=offset_free), track, grid)
    demand_estimable(one_sided(terrain, *corrected(track, answer)))
    return answer


def answer_of(found: Search, track: Profile, grid: Hypotheses) -> Correction:
    """The correction of a grid hypothesis at the last time."""
    i, j, Vi, Vj = found.index
    velocity = np.array([Vi * grid.velocity_step[0], Vj * grid.velocity_step[1]])
    shift = np.array([i * grid.step[0], j * grid.step[1]]) + velocity * track.elapsed[-1]
    return Correction(found.index, found.criterion, found.second_best, found.unique, shift, velocity, found.evaluated)


def corrected(track: Profile, answer: Correction) -> tuple[Array, Array]:
    """The track under the correction found."""
    back = track.elapsed - track.elapsed[-1]
    dx, dy = (answer.shift[k] + answer.velocity[k] * back for k in (0, 1))
    return track.x + dx, track.y + dy


def by_refinement(terrain: TerrainMap, track: Profile, grid: Hypotheses, offset_free: bool) -> Correction:
    """The full search, then the minimum between its grid points."""
    start = by_grid(search_full, terrain, track, grid, offset_free)
    velocity = start.velocity
    position = start.shift - velocity * track.elapsed[-1]
    fine = refine(terrain, track, (position[0], position[1]), (velocity[0], velocity[1]), offset=offset_free)
    shift = fine.position + fine.velocity * track.elapsed[-1]
    return replace(start, criterion=fine.criterion, shift=shift, velocity=fine.velocity)


SEARCHES: dict[str, Callable[[TerrainMap, Profile, Hypotheses, bool], Correction]] = {
    "position": partial(by_grid, search_position),
    "full": partial(by_grid, search_full),
    "sequential": lambda terrain, track, grid, free: search_sequential(terrain, track, grid, offset_free=free),
    "refined": by_refinement,
}


# What the answer says beside the correction


def finite_or_none(value: float) -> float | None:
    """A finite number, or None for infinity and nan, which JSON does not have."""
    return float(value) if math.isfinite(value) else None


def is_alone(grid: Hypotheses, answer: Correction) -> bool:
    """Whether no other hypothesis could be compared with the best one, although there are others."""
    counts = (*grid.half_count, *grid.velocity_half_count)
    return math.isinf(answer.second_best) and any(n > 0 for n in counts)


def height_offset(terrain: TerrainMap, track: Profile, answer: Correction) -> float:
    """Mean of the measured less the mapped heights under the correction found."""
    return float((track.h - terrain.height(*corrected(track, answer))).mean())


def criterion_map(
    terrain: TerrainMap, track: Profile, grid: Hypotheses, answer: Correction, offset_free: bool = False
) -> Array:
    """Criteria over positions (My, Mx) at the velocity of the coarse solution: row = j, column = i."""
    at = answer.index[2:] if answer.t_G is None else (0, 0)
    vx, vy = (v * s for v, s in zip(at, grid.velocity_step, strict=True))
    moved = Profile(track.t, track.x + vx * track.elapsed, track.y + vy * track.elapsed, track.h)
    return criteria(prepare(terrain, moved, grid.position_only, on_map=False), centred=offset_free)[0, 0]


def remarks(
    terrain: TerrainMap, track: Profile, grid: Hypotheses, answer: Correction, offset_free: bool = False
) -> tuple[str, ...]:
    """Things that a person should look at: units, the edge of the grid, ties."""
    found = []
    x, y = corrected(track, answer)
    mapped, flags = terrain.sample(x, y)
    away = np.abs(track.h - mapped - (np.median(track.h - mapped) if offset_free else 0.0))
    worst, usual = int(np.argmax(away)), max(float(np.median(away)), GRAIN)
    if (flags == ON_MAP).all() and away[worst] > GROSS * usual:
        found.append(
            f"the height at t = {track.t[worst]:g} departs from the map by {away[worst]:.3g} m, "
            f"{away[worst] / usual:.0f} times as far as the others: leave it out if it is a gross error"
        )
    elif (flags == ON_MAP).all() and not offset_free and looks_like_feet(track.h, mapped):
        found.append("the measured heights fit the map far better as feet; expected metres")
    ends = (*grid.half_count, *grid.velocity_half_count)
    if any(n > 0 and abs(k) == n for k, n in zip(answer.index, ends, strict=True)):
        found.append("the best hypothesis lies on the edge of the grid; widen it")
    if is_alone(grid, answer):
        found.append(
            "no other hypothesis lies on known ground, so that nothing was compared: are the steps in the unit of the "
            'map? A tile in degrees is searched in metres with "frame": "local"'
        )
    elif answer.unique is not True:
        found.append("two hypotheses fit equally well, or too nearly so to tell them apart")
    return tuple(found)


def looks_like_feet(measured: Array, mapped: Array) -> bool:
    """Whether feet for metres, in either direction, would shrink the misfit about its mean much."""

    def misfit(scale: float) -> float:
        difference = scale * measured - mapped
        return float(difference @ difference)

    best = min(misfit(FEET), misfit(1.0 / FEET))
    return bool(best < MUCH_BETTER * misfit(1.0) and misfit(1.0) > 0.0)
