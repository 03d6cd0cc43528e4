"""The sequential search of the paper, and the form of it that loses nothing.

Both first search the position alone and then the velocity, turning the track about the point that
the first stage has found. The paper turns it about one instant t_G (terrain_search:6…14). But a
velocity error v displaces the first fix by ``C v`` with the matrix C = G^-1 M1, not by ``t_G v``; with
t_G the velocity comes out as ``(S + R)^-1 S v``, too small unless v is an eigenvector of C
(terrain_search:sequential.shrinks). With C in the place of t_G the two stages together are the
joint least-squares solution (terrain_search:sequential.exact) at the cost of six sums.
"""

from __future__ import annotations

import numpy as np

from navsym.core.arrays import Array
from navsym.terrain.centre import demand_estimable, information, slopes
from navsym.terrain.heights import TerrainMap
from navsym.terrain.kernels.criteria import velocity_criteria
from navsym.terrain.search import Correction, apart, criteria, lowest, need, prepare, two_lowest, unravel
from navsym.terrain.track import Hypotheses, Profile


def search_sequential(
    terrain: TerrainMap, track: Profile, grid: Hypotheses, *, improved: bool = False, offset_free: bool = False
) -> Correction:
    """Position first, then velocity, whose ``criterion`` is Q_V (terrain_search:6); ``second_best`` among velocities.

    improved    : turn about the matrix centre C instead of the middle of [t_min, t_max]
    offset_free : both stages and t_G without the means that a constant height error takes away
    Raises OutsideMapError, NoDataError, NotEstimableError (fewer than four measurements, or flat).
    """
    need(track, 5 if offset_free else 4, "two coordinates, two velocities and the height offset if it is unknown")
    position = prepare(terrain, track, grid.position_only)
    coarse = lowest(position, criteria(position, centred=offset_free), offset_free)
    i, j = coarse.index[:2]
    start = np.array([i * grid.step[0], j * grid.step[1]])
    gx, gy = slopes(terrain, track.x + start[0], track.y + start[1])
    numbered = information(gx, gy, np.arange(track.t.size, dtype=np.float64), centred=offset_free)
    demand_estimable(numbered)
    low, high = numbered.interval
    middle = 0.5 * (low + high)
    timed = information(gx, gy, track.elapsed, centred=offset_free)
    instant = float(np.interp(middle, np.arange(track.t.size), track.elapsed))
    centre = timed.centre if improved else instant * np.eye(2)
    at = (position.bx + i * position.steps[0], position.by + j * position.steps[1])
    values = velocity_stage(terrain, track, grid, at, centre, offset_free)
    best, criterion, _, second = two_lowest(values)
    _, _, Vi, Vj = unravel(best, (1, 1, *values.shape))
    velocity = np.array([Vi * grid.velocity_step[0], Vj * grid.velocity_step[1]])
    shift = start + (track.elapsed[-1] * np.eye(2) - centre) @ velocity  # terrain_search:14
    # Turning a track about a centre takes a few roundings of coordinates more than moving it: four times the margin.
    is_apart = apart(position, criterion, second, offset_free, 4.0)
    unique = coarse.unique if coarse.unique is not True else is_apart or None
    index, t_G = (i, j, Vi, Vj), (low, high, middle)
    evaluated = coarse.evaluated + values.size
    return Correction(index, criterion, second, unique, shift, velocity, evaluated, t_G, numbered.quadratic)


def velocity_stage(
    terrain: TerrainMap, track: Profile, grid: Hypotheses, at: tuple[Array, Array], centre: Array, centred: bool
) -> Array:
    """Criteria (Mvx, Mvy) of the velocities, the track turning about ``centre`` (terrain_search:6).

    at : the track of the first stage in cells, by its own expressions: without a velocity the criterion is its
    """
    bx, by = at
    spacing = np.array([terrain.dx, terrain.dy])
    cells = centre * spacing[None, :] / spacing[:, None]  # from map units to cells, row by row
    steps = (grid.velocity_step[0] / terrain.dx, grid.velocity_step[1] / terrain.dy)
    out = np.empty(grid.counts[2:])
    case = (terrain.heights, bx, by, np.array(track.h), track.elapsed, track.elapsed)
    velocity_criteria(case, cells, steps, grid.counts[2:], centred, out)
    return out
