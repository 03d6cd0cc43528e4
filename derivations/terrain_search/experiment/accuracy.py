"""Where will a terrain fix work: expected accuracy and the risk of a false fix, over a map.

At every place a straight profile of a given length is laid in a given direction. Its slopes give the
information G = sum g g' on the position, so the standard deviation along a unit vector e is
``sigma / sqrt(e' G e)`` in the direction of an eigenvector. How alike other places look is the squared
distance ``D(c)^2 = sum (h(p + c) - h(p))^2``: with independent normal errors of deviation sigma the
hypothesis c beats the truth with probability Phi(-D/(2 sigma)), and the sum over all c outside the
neighbourhood of the truth bounds the probability of a false fix (union bound).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import DomainError
from navsym.terrain.centre import information, slopes
from navsym.terrain.heights import ON_MAP, TerrainMap
from navsym.terrain.search import criteria, prepare
from navsym.terrain.track import Hypotheses, Profile

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Accuracy:
    """Maps over the places (rows of y, columns of x); NaN where the profile or its rivals leave the map.

    x, y      : (nx,), (ny,) centres of the profiles
    strong    : smaller standard deviation of the position, in the unit of the map; weak : the larger
    direction : angle of the weak direction from the x axis, radians in [0, pi)
    risk      : bound of the probability of a false fix, at most 1
    """

    x: Array
    y: Array
    strong: Array
    weak: Array
    direction: Array
    risk: Array


def accuracy_map(
    terrain: TerrainMap,
    length: float,
    heading: float,
    sigma: float,
    *,
    points: int = 100,
    rivals: Hypotheses | None = None,
    exclusion: float | None = None,
    places: tuple[int, int] = (40, 40),
) -> Accuracy:
    """Expected accuracy and false-fix risk for profiles of one length and heading.

    length, heading : of the profile (map units, radians from the x axis); points : measurements on it
    sigma           : standard deviation of one height difference (altimeter and map), metres
    rivals          : hypotheses that compete with the truth (default: 15 cells to each side)
    exclusion       : rivals nearer than this are the truth itself (default: three cells)
    places          : how many centres along x and y
    Raises DomainError for a length or sigma that is not positive, and for fewer than three points.
    """
    if not (length > 0 and sigma > 0 and points >= 3 and min(places) >= 1):
        raise DomainError(
            "expected a positive length and sigma, 3 or more points and places; got "
            f"{length:g}, {sigma:g}, {points} and {places}; mend them"
        )
    cell = max(terrain.dx, terrain.dy)
    rivals = Hypotheses((terrain.dx, terrain.dy), (15, 15)) if rivals is None else rivals.position_only
    near = too_near(rivals, 3 * cell if exclusion is None else exclusion)
    left, right, bottom, top = terrain.extent
    x, y = np.linspace(left, right, places[0] + 2)[1:-1], np.linspace(bottom, top, places[1] + 2)[1:-1]
    way = length * (np.arange(points) / (points - 1) - 0.5)
    found = np.full((4, y.size, x.size), np.nan)
    for row, cy in enumerate(y):
        for column, cx in enumerate(x):
            px, py = cx + way * math.cos(heading), cy + way * math.sin(heading)
            found[:, row, column] = at_place(terrain, px, py, sigma, rivals, near)
    return Accuracy(x, y, *found)


def too_near(rivals: Hypotheses, exclusion: float) -> NDArray[np.bool_]:
    """(My, Mx): hypotheses within the neighbourhood of the truth."""
    across = (np.arange(rivals.counts[0]) - rivals.half_count[0]) * rivals.step[0]
    along = (np.arange(rivals.counts[1]) - rivals.half_count[1]) * rivals.step[1]
    near: NDArray[np.bool_] = np.hypot(across[None, :], along[:, None]) < exclusion
    near[rivals.half_count[1], rivals.half_count[0]] = True
    return near


def at_place(
    terrain: TerrainMap, x: Array, y: Array, sigma: float, rivals: Hypotheses, near: NDArray[np.bool_]
) -> tuple[float, float, float, float]:
    """(strong, weak, direction, risk) of one profile; NaN when it or every rival leaves the map."""
    heights, flags = terrain.sample(x, y)
    if (flags != ON_MAP).any():
        return math.nan, math.nan, math.nan, math.nan
    times = np.arange(x.size, dtype=float)
    values, vectors = np.linalg.eigh(information(*slopes(terrain, x, y), times).G)
    strong, weak = (sigma / math.sqrt(v) if v > 0.0 else math.inf for v in (values[1], values[0]))
    direction = math.atan2(vectors[1, 0], vectors[0, 0]) % math.pi
    squares = criteria(prepare(terrain, Profile(times, x, y, heights), rivals))[0, 0]
    return strong, weak, direction, false_fix_bound(squares[~near], sigma)


def false_fix_bound(squares: Array, sigma: float) -> float:
    """min(1, sum Phi(-D/(2 sigma))) over the rivals; those off the map cannot be chosen."""
    distances = np.sqrt(squares[np.isfinite(squares)])
    total = sum(0.5 * math.erfc(d / (2.0 * sigma) / math.sqrt(2.0)) for d in distances if d < 80.0 * sigma)
    return min(1.0, total)
