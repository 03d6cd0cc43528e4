"""From a configuration to a fix: what ``navsym locate`` does, as a function."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import DomainError
from navsym.terrain.centre import demand_estimable, one_sided
from navsym.terrain.configuration import read_search
from navsym.terrain.heights import ON_MAP, TerrainMap
from navsym.terrain.refine import refine
from navsym.terrain.search import Search, criteria, prepare, search_full, search_position
from navsym.terrain.sequential import search_sequential
from navsym.terrain.track import Hypotheses, Profile

Array = NDArray[np.float64]

METHODS = ("position", "full", "sequential", "refined")
FEET = 0.3048
#: Share by which the misfit must fall before feet, or a misplaced datum, are suspected.
MUCH_BETTER = 0.25


@dataclass(frozen=True, slots=True, eq=False)
class Fix:
    """The document of the interface, and remarks for people."""

    document: dict[str, Any]
    remarks: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Correction:
    """What every method has to say: indices, criterion and the correction at the last time."""

    index: tuple[int, int, int, int]
    criterion: float
    second_best: float
    unique: bool | None
    shift: Array
    velocity: Array
    evaluated: int
    t_G: tuple[float, float, float] | None = None
    quadratic: tuple[float, float, float] | None = None


def locate(
    config: Mapping[str, Any],
    method: str = "full",
    *,
    folder: str | os.PathLike[str] = ".",
    maps: bool = False,
    offset_free: bool = False,
) -> Fix:
    """Fix the position of a track over a map.

    config : ``map``, ``track``, ``position``, ``velocity``, ``interpolation`` as the interfaces have them.
             A geographic tile lies in degrees (x longitude, y latitude) unless its map block says
             ``"frame": "local"``: then in metres east and north of its south-west node.
    method : ``position``, ``full`` (t0 the first time), ``sequential`` (the paper's) or ``refined``
    folder : where relative file names start ; maps : add the criterion over positions, row = j
    offset_free : the criterion without its mean, for heights with an unknown constant error; the document then
             has its estimate as ``height_offset``, measured minus mapped

    t_G and quadratic count time in measurements from 0, as the paper does. The fix holds at the
    last time; the inertial velocity there is the difference quotient of the last two positions.
    Raises NavsymError of the kinds in the interfaces.
    """
    if method not in METHODS:
        raise DomainError(f"--method: expected one of {', '.join(METHODS)}; got {method!r:.40}; choose one")
    terrain, track, grid = read_search(config, Path(folder), velocity_needed=method != "position")
    answer = SEARCHES[method](terrain, track, grid, offset_free)
    document = written(method, track, grid, answer)
    if offset_free:
        document["height_offset"] = height_offset(terrain, track, answer)
    if maps:
        rows = criterion_map(terrain, track, grid, answer, offset_free)
        document["criterion_map"] = [[nullable(q) for q in row] for row in rows]
    return Fix(document, remarks(terrain, track, grid, answer, offset_free))


# The methods


def by_position(terrain: TerrainMap, track: Profile, grid: Hypotheses, offset_free: bool) -> Correction:
    """The best position, velocity errors taken as zero; raises NotEstimableError over flat terrain."""
    found = search_position(terrain, track, grid, offset_free=offset_free)
    return checked(terrain, track, answer_of(found, track, grid))


def by_full(terrain: TerrainMap, track: Profile, grid: Hypotheses, offset_free: bool) -> Correction:
    """The best of all hypotheses in position and velocity; raises NotEstimableError over flat terrain."""
    found = search_full(terrain, track, grid, offset_free=offset_free)
    return checked(terrain, track, answer_of(found, track, grid))


def answer_of(found: Search, track: Profile, grid: Hypotheses) -> Correction:
    """The correction of a grid hypothesis at the last time."""
    i, j, Vi, Vj = found.index
    velocity = np.array([Vi * grid.velocity_step[0], Vj * grid.velocity_step[1]])
    shift = np.array([i * grid.step[0], j * grid.step[1]]) + velocity * track.elapsed[-1]
    return Correction(found.index, found.criterion, found.second_best, found.unique, shift, velocity, found.evaluated)


def checked(terrain: TerrainMap, track: Profile, answer: Correction) -> Correction:
    """The same answer; NotEstimableError when the terrain under it is flat."""
    x, y = corrected(track, answer)
    demand_estimable(one_sided(terrain, x, y))
    return answer


def corrected(track: Profile, answer: Correction) -> tuple[Array, Array]:
    """The track under the correction found."""
    back = track.elapsed - track.elapsed[-1]
    dx, dy = (answer.shift[k] + answer.velocity[k] * back for k in (0, 1))
    return track.x + dx, track.y + dy


def by_sequence(terrain: TerrainMap, track: Profile, grid: Hypotheses, offset_free: bool) -> Correction:
    """Position first and then velocity, with the times t_G and the quadratic of the paper."""
    found = search_sequential(terrain, track, grid, offset_free=offset_free)
    return Correction(
        found.index,
        found.criterion,
        found.second_best,
        found.unique,
        found.shift,
        found.velocity,
        found.evaluated,
        found.t_G,
        found.quadratic,
    )


def by_refinement(terrain: TerrainMap, track: Profile, grid: Hypotheses, offset_free: bool) -> Correction:
    """The full search, then the minimum between its grid points."""
    start = by_full(terrain, track, grid, offset_free)
    velocity = start.velocity
    position = start.shift - velocity * track.elapsed[-1]
    fine = refine(terrain, track, (position[0], position[1]), (velocity[0], velocity[1]), offset=offset_free)
    shift = fine.position + fine.velocity * track.elapsed[-1]
    return Correction(
        start.index, fine.criterion, start.second_best, start.unique, shift, fine.velocity, start.evaluated
    )


SEARCHES = {"position": by_position, "full": by_full, "sequential": by_sequence, "refined": by_refinement}


# The document


def nullable(value: float) -> float | None:
    """A finite number, or None for infinity and nan, which JSON does not have."""
    return float(value) if math.isfinite(value) else None


def written(method: str, track: Profile, grid: Hypotheses, answer: Correction) -> dict[str, Any]:
    """The document of the interface: plain numbers, no infinities."""
    i, j, Vi, Vj = answer.index
    vx, vy = track.final_velocity
    names = ("min", "max", "mid")
    t_G = None if answer.t_G is None else dict(zip(names, answer.t_G, strict=True))
    dx, dy, dvx, dvy = (float(v) for v in (*answer.shift, *answer.velocity))
    return {
        "method": method,
        "position_index": [i, j],
        "velocity_index": [Vi, Vj],
        "criterion": answer.criterion,
        "second_best": nullable(answer.second_best),
        "unique": None if alone(grid, answer) else answer.unique,
        "t_G": t_G,
        "quadratic": None if answer.quadratic is None else list(answer.quadratic),
        "fix": {"x": float(track.x[-1]) + dx, "y": float(track.y[-1]) + dy, "vx": vx + dvx, "vy": vy + dvy},
        "correction": {"dx": dx, "dy": dy, "dvx": dvx, "dvy": dvy},
        "evaluated": answer.evaluated,
    }


def alone(grid: Hypotheses, answer: Correction) -> bool:
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
    if (flags == ON_MAP).all() and not offset_free and looks_like_feet(track.h, mapped):
        found.append("the measured heights fit the map far better as feet; expected metres")
    ends = (*grid.half_count, *grid.velocity_half_count)
    if any(n > 0 and abs(k) == n for k, n in zip(answer.index, ends, strict=True)):
        found.append("the best hypothesis lies on the edge of the grid; widen it")
    if alone(grid, answer):
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
