"""Terrain search: the correction under which the measured profile fits the map best.

A hypothesis moves the inertial track by ``(i Dx + Vi DVx tau, j Dy + Vj DVy tau)`` with tau the
time since the first measurement; its criterion is the sum of squared differences between the
measured and the mapped heights (terrain_search:2, terrain_search:4). Hypotheses whose track
leaves the map or meets a void have an infinite criterion and are never chosen.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from fractions import Fraction
from functools import partial

import numpy as np
from numpy.typing import NDArray

from navsym.core.arrays import Array
from navsym.core.errors import NotEstimableError
from navsym.terrain.heights import TerrainMap, demand_heights
from navsym.terrain.kernels.bounded import BoundedResult, add_slab, search_bounded, search_one_velocity
from navsym.terrain.kernels.criteria import dense_masked, padded, profile
from navsym.terrain.kernels.lattice import fits, lattice, rounded
from navsym.terrain.kernels.margins import DOUBLE, PLAIN, parts_about_the_mean
from navsym.terrain.track import Hypotheses, Profile

Index = tuple[int, int, int, int]


@dataclass(frozen=True, slots=True, eq=False)
class Prepared:
    """A map, a track and a grid of hypotheses, counted in cells, as the compiled loops want them.

    plain : every hypothesis stays on the map and off its voids, so the fast loops may run
    whole : there are no voids where a hypothesis may look, so that the bounded search may run
    bound : at least the largest absolute height of map and profile
    """

    H: Array
    single: NDArray[np.float32]
    bx: Array
    by: Array
    z: Array
    wx: Array
    wy: Array
    steps: tuple[float, float]
    counts: Index
    plain: bool
    bound: float
    whole: bool = True

    @property
    def case(self) -> tuple[Array, Array, Array, Array, Array, Array]:
        """What the compiled loops take: see :mod:`navsym.terrain.kernels.criteria`."""
        return self.H, self.bx, self.by, self.z, self.wx, self.wy

    @property
    def on_lattice(self) -> bool:
        """Whether :mod:`navsym.terrain.kernels.lattice` applies: positions only, the step is the cell."""
        alike = self.counts[2:] == (1, 1) and self.steps == (1.0, 1.0) and self.plain
        return alike and fits(self.H, self.bx, self.by, self.counts[:2], padded(self.counts[0]))


@dataclass(frozen=True, slots=True, eq=False)
class Search:
    """Result of a search over a grid.

    index     : (i, j, Vi, Vj) of the smallest criterion, each from -N to N; the first of equals
    criterion : its value, m^2; second_best that of the best other hypothesis (inf: there is none)
    unique    : True or False when proved, None when two criteria differ by less than rounding
    criteria  : (Mvx, Mvy, My, Mx), or None when they were not all computed
    evaluated : hypotheses evaluated over all measurements
    share     : squares evaluated, as a share of hypotheses x measurements
    """

    index: Index
    criterion: float
    second_best: float
    unique: bool | None
    evaluated: int
    share: float = 1.0
    criteria: Array | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Correction:
    """What every method has to say: hypothesis, criterion, and the correction at the last time.

    index, criterion, second_best, unique, evaluated : as in :class:`Search`
    shift, velocity : (2,) corrections of position, map units, and of velocity
    t_G, quadratic  : of the sequential search: (min, max, mid) counted in measurements from 0, and (A2, A1, A0)
    """

    index: Index
    criterion: float
    second_best: float
    unique: bool | None
    shift: Array
    velocity: Array
    evaluated: int
    t_G: tuple[float, float, float] | None = None
    quadratic: tuple[float, float, float] | None = None


def prepare(terrain: TerrainMap, track: Profile, grid: Hypotheses, *, on_map: bool = True) -> Prepared:
    """Count everything in cells.

    on_map : raise OutsideMapError or NoDataError when the inertial track itself has no heights
    """
    bx, by = (rounded(b, max(terrain.heights.shape)) for b in terrain.cells(track.x, track.y))
    if on_map:
        under = np.empty(bx.size)
        profile(terrain.heights, bx, by, under)
        if np.isnan(under).any():
            demand_heights(terrain, track.x, track.y, terrain.sample(track.x, track.y)[1])
    wx = grid.velocity_step[0] * track.elapsed / terrain.dx
    wy = grid.velocity_step[1] * track.elapsed / terrain.dy
    steps = (grid.step[0] / terrain.dx, grid.step[1] / terrain.dy)
    ny, nx = terrain.heights.shape
    Mx, My, Mvx, Mvy = grid.counts
    across = reach(bx, wx, steps[0], Mx, Mvx)
    along = reach(by, wy, steps[1], My, Mvy)
    inside = across[0] >= 0.0 and across[1] <= nx - 1 and along[0] >= 0.0 and along[1] <= ny - 1
    whole = not void_within(terrain, across, along)
    plain = inside and whole
    bound = max(terrain.highest, float(np.abs(track.h).max()))
    z = np.array(track.h)
    return Prepared(terrain.heights, terrain.single, bx, by, z, wx, wy, steps, grid.counts, plain, bound, whole)


def reach(b: Array, w: Array, s: float, M: int, Mv: int) -> tuple[float, float]:
    """Smallest and largest coordinate of any hypothesis, by the expressions of the loops."""
    span = np.abs((Mv // 2) * w)
    return float((b + (-(M // 2) * s - span)).min()), float((b + ((M // 2) * s + span)).max())


def void_within(terrain: TerrainMap, across: tuple[float, float], along: tuple[float, float]) -> bool:
    """True when the map has a void among the nodes that hypotheses may touch.

    across, along : smallest and largest coordinate in cells, of columns and of rows
    """
    if not terrain.has_voids:
        return False
    rows, columns = (slice(max(math.floor(low), 0), max(math.floor(high) + 2, 0)) for low, high in (along, across))
    return bool(np.isnan(terrain.heights[rows, columns]).any())


def criteria(prepared: Prepared, *, threads: int = 1, centred: bool = False) -> Array:
    """Criteria of all hypotheses (Mvx, Mvy, My, Mx), in double precision; inf where inadmissible.

    centred : less the mean difference of each hypothesis, ``sum (d - mean d)^2``
    """
    Mx, My, Mvx, Mvy = prepared.counts
    if centred or not prepared.plain:
        out = np.empty((Mvx, Mvy, My, Mx))
        dense_masked(prepared.case, prepared.steps, prepared.counts, centred, out.reshape(-1))
        return out
    sums = np.zeros((Mvx, Mvy, My, padded(Mx)))
    if prepared.on_lattice:
        lattice(*prepared.case[:4], (Mx, My), sums[0, 0])
    else:
        run = partial(add_slab, prepared.case, prepared.steps, prepared.counts)
        each_velocity(lambda Vi: run(Vi, False, sums[Vi]), Mvx, threads)
    return sums[..., :Mx]


def each_velocity(work: Callable[[int], None], count: int, threads: int) -> None:
    """Run the work for every Vi; the compiled loops release the interpreter lock."""
    if threads <= 1:
        for Vi in range(count):
            work(Vi)
        return
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(work, range(count)))


def search_position(
    terrain: TerrainMap, track: Profile, grid: Hypotheses, *, dense: bool = False, offset_free: bool = False
) -> Search:
    """The best position hypothesis, velocity errors taken as zero (terrain_search:2, terrain_search:3).

    dense       : keep all criteria in double precision; otherwise they may be summed in single precision, and
                  the lowest again in double: the same minimum, runner-up and values
    offset_free : the criterion ``sum (d - mean d)^2``, free of a constant height error (terrain_search:offset)
    Raises OutsideMapError, NoDataError, NotEstimableError (fewer than two measurements, three without offset).
    """
    need(track, *((3, "two coordinates and the height offset") if offset_free else (2, "two coordinates")))
    return found_by(prepare(terrain, track, grid.position_only), dense, offset_free)


def search_full(
    terrain: TerrainMap, track: Profile, grid: Hypotheses, *, dense: bool = False, offset_free: bool = False
) -> Search:
    """The best hypothesis in position and velocity (terrain_search:4, terrain_search:5).

    dense       : evaluate every hypothesis and keep the criteria; otherwise search by bounding, which
                  returns the same minimum, runner-up and values without them.
    offset_free : the criterion ``sum (d - mean d)^2``, free of a constant height error (terrain_search:offset)
    Raises OutsideMapError, NoDataError, NotEstimableError (fewer than four measurements, five without offset).
    """
    what = "two coordinates and two velocities"
    need(track, *((5, f"{what} and the height offset") if offset_free else (4, what)))
    return found_by(prepare(terrain, track, grid), dense, offset_free)


def found_by(prepared: Prepared, dense: bool, centred: bool) -> Search:
    """The minimum by bounding where that is possible and wanted, else by evaluating every hypothesis."""
    total = math.prod(prepared.counts)
    # Outside this range single precision could overflow or underflow; nobody measures such heights.
    usual = 1e-10 < prepared.bound < 1e15 and total > 1 and (prepared.z.size >= 4 or not centred)
    # On the lattice all criteria in double precision take less time than some of them in single.
    is_slow = (prepared.counts[2:] == (1, 1) and not prepared.plain) or (prepared.on_lattice and not centred)
    found = None if dense or is_slow or not (prepared.whole and usual) else quickly(prepared, centred)
    if found is None or found.index < 0:
        return lowest(prepared, criteria(prepared, centred=centred), centred)
    index, runner_up = unravel(found.index, prepared.counts), unravel(max(found.runner_up, 0), prepared.counts)
    best, second = (index, found.criterion), (runner_up, found.second)
    unique = math.isinf(found.second) or is_unique(prepared, best, second, centred)
    share = found.samples / (total * prepared.z.size)
    return Search(index, found.criterion, found.second, unique, found.completed, share)


def quickly(prepared: Prepared, centred: bool) -> BoundedResult:
    """The exact search that suits the number of velocities."""
    p = prepared
    if p.counts[2:] == (1, 1) and not centred:
        return search_one_velocity(p.single, p.case, p.steps, p.counts[:2], p.bound)
    return search_bounded(p.case, p.steps, p.counts, p.bound, centred=centred, inside=p.plain)


def need(track: Profile, least: int, what: str) -> None:
    """NotEstimableError when the track has fewer than ``least`` measurements."""
    if track.t.size < least:
        raise NotEstimableError(
            f"track: expected at least {least} measurements for {what}; got {track.t.size}; fly longer"
        )


def lowest(prepared: Prepared, values: Array, centred: bool = False) -> Search:
    """Minimum and runner-up of an array of criteria (Mvx, Mvy, My, Mx)."""
    best, criterion, runner_up, second = two_lowest(values)
    index, other = unravel(best, prepared.counts), unravel(runner_up, prepared.counts)
    unique = math.isinf(second) or is_unique(prepared, (index, criterion), (other, second), centred)
    return Search(index, criterion, second, unique, values.size, 1.0, values)


def two_lowest(values: Array) -> tuple[int, float, int, float]:
    """Flat index and value of the smallest number and of the second smallest; infinity where there is no other."""
    flat = np.ravel(values)
    best = int(flat.argmin())
    others = np.concatenate([flat[:best], flat[best + 1 :], [math.inf]])
    at = int(others.argmin())
    return best, float(flat[best]), min(at + (at >= best), flat.size - 1), float(others[at])


def unravel(flat: int, counts: Index) -> Index:
    """(i, j, Vi, Vj) from -N to N of a flat index in the order Vi, Vj, j, i."""
    Mx, My, Mvx, Mvy = counts
    Vi, Vj, j, i = map(int, np.unravel_index(flat, (Mvx, Mvy, My, Mx)))
    return i - Mx // 2, j - My // 2, Vi - Mvx // 2, Vj - Mvy // 2


# Uniqueness


def is_unique(
    prepared: Prepared, best: tuple[Index, float], second: tuple[Index, float], centred: bool = False
) -> bool | None:
    """Whether the smallest criterion belongs to one hypothesis only.

    True when the two smallest double sums differ by more than their rounding can; False when the
    two criteria are equal as rational numbers; None otherwise.
    """
    if apart(prepared, best[1], second[1], centred):
        return True
    if prepared.z.size > 5000:
        return None
    equal = exact_criterion(prepared, best[0], centred) == exact_criterion(prepared, second[0], centred)
    return False if equal else None


def apart(prepared: Prepared, criterion: float, second: float, centred: bool, times: float = 1.0) -> bool:
    """Whether two double sums differ by more than so many times what their rounding can."""
    n = prepared.z.size
    parts = parts_about_the_mean(n) if centred else PLAIN
    slack = times * DOUBLE * (parts * prepared.bound + PLAIN * position_noise(prepared)) * math.sqrt(n)
    grow = (n + 4) * DOUBLE
    return math.sqrt(second) * (1.0 - grow) - slack > math.sqrt(criterion) * (1.0 + grow) + slack


def position_noise(prepared: Prepared) -> float:
    """Height error of rounded positions, over 16 u: coordinates are off by a few u of their size."""
    largest = float(max(np.abs(prepared.bx).max(), np.abs(prepared.by).max())) + max(prepared.H.shape)
    return 4.0 * largest * prepared.bound


def exact_criterion(prepared: Prepared, index: Index, centred: bool = False) -> Fraction:
    """The criterion as a rational number, of the numbers in cells that the loops are given."""
    i, j, Vi, Vj = index
    sx, sy = map(Fraction, prepared.steps)
    found = []
    for k in range(prepared.z.size):
        u = Fraction(prepared.bx[k]) + i * sx + Vi * Fraction(prepared.wx[k])
        w = Fraction(prepared.by[k]) + j * sy + Vj * Fraction(prepared.wy[k])
        found.append(Fraction(prepared.z[k]) - exact_height(prepared.H, u, w))
    mean = sum(found, Fraction(0)) / len(found) if centred else Fraction(0)
    return sum(((d - mean) ** 2 for d in found), Fraction(0))


def exact_height(H: Array, u: Fraction, w: Fraction) -> Fraction:
    """Bilinear height in rational arithmetic."""
    c = max(min(math.floor(u), H.shape[1] - 2), 0)
    r = max(min(math.floor(w), H.shape[0] - 2), 0)
    f, g = u - c, w - r
    low, high = (1 - f) * (1 - g), (1 - f) * g
    weights = ((low, r, c), (1 - g - low, r, c + 1), (high, r + 1, c), (g - high, r + 1, c + 1))
    return sum((weight * Fraction(H[a, b]) for weight, a, b in weights if weight), Fraction(0))
