"""The position search one measurement at a time, as it runs in flight."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import EmptyError
from navsym.terrain.heights import TerrainMap
from navsym.terrain.search import Prepared, Search, criteria, lowest, prepare
from navsym.terrain.track import Hypotheses, Profile

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Accumulated:
    """Criteria so far: ``values`` (1, 1, My, Mx), and how many measurements went into them."""

    terrain: TerrainMap
    grid: Hypotheses
    values: Array
    measurements: int = 0


def begin(terrain: TerrainMap, grid: Hypotheses) -> Accumulated:
    """No measurement yet: every criterion is zero."""
    _, My, Mx = 1, grid.counts[1], grid.counts[0]
    return Accumulated(terrain, grid.position_only, np.zeros((1, 1, My, Mx)))


def add_measurement(state: Accumulated, t: float, x: float, y: float, h: float) -> Accumulated:
    """The state after one more measurement; the state given is left as it was (terrain_search:2).

    A hypothesis that leaves the map at any measurement stays inadmissible (infinite).
    Raises OutsideMapError or NoDataError when the inertial position itself has no height.
    """
    one = prepare(state.terrain, Profile([t], [x], [y], [h]), state.grid)  # type: ignore[arg-type]
    return replace(state, values=state.values + criteria(one), measurements=state.measurements + 1)


def fix(state: Accumulated) -> Search:
    """The best hypothesis so far (terrain_search:3). Uniqueness is not decided from sums alone."""
    if not state.measurements:
        raise EmptyError("measurements: expected at least one; got none; add measurements first")
    Mx, My = state.grid.counts[:2]
    empty, terrain = np.zeros(1), state.terrain
    cells = (empty, empty, empty, empty, empty, (1.0, 1.0), (Mx, My, 1, 1))
    shown = Prepared(terrain.heights, terrain.single, *cells, plain=True, bound=0.0)
    return lowest(shown, state.values, exactly=False)
