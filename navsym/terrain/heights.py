"""Height maps: heights on a regular grid, bilinear between the nodes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.core.arrays import Array, as_array, as_floats, freeze, need_finite, need_shape
from navsym.core.errors import DomainError, NoDataError, OutsideMapError, ShapeError

# What may enter a map, a track or a grid of hypotheses: checked once, copied, read-only.

#: Sizes that no map, track or step in any unit has; within them no sum of squares overflows.
LARGEST, SMALLEST = 1e15, 1e-12
#: What stands for no height in many maps, and for one in hardly any.
MARKS = (-9999.0, -32767.0, -32768.0, -99999.0)


def put(owner: Any, name: str, value: Any) -> None:
    """Set a field of a frozen dataclass while it is being made."""
    object.__setattr__(owner, name, value)


def in_range(name: str, array: Array) -> Array:
    """The same array; NotFiniteError when it holds NaN or an infinity, DomainError above LARGEST."""
    if np.abs(need_finite(name, array)).max() > LARGEST:
        place = tuple(int(i) for i in np.argwhere(np.abs(array) > LARGEST)[0])
        raise DomainError(
            f"{name}: expected numbers below {LARGEST:g}; got {array[place]:g} at index {place}; check the unit"
        )
    return array


def vector(name: str, value: Any, length: int | None, why: str) -> Array:
    """A read-only finite vector (length,)."""
    return in_range(name, as_array(name, value, (length,), why))


def with_voids(heights: Any, nodata: float | None) -> Array:
    """A copy of a matrix of heights with NaN where ``nodata`` stood; other NaN are errors."""
    why = "rows of y by columns of x"
    array = need_shape("heights", as_floats("heights", heights, why), (None, None), why)
    if min(array.shape) < 2:
        raise ShapeError(f"heights: expected at least 2 x 2 nodes; got {array.shape}; give more")
    if nodata is None:
        for row, column in np.argwhere(np.isin(array, MARKS)).tolist():
            message = f"heights: expected heights; got {array[row, column]:g} at {row, column}, a usual mark of none"
            raise NoDataError(f"{message}; say which number is none with nodata")
        return in_range("heights", array)
    voids = voids_in(np.asarray(heights), nodata)
    in_range("heights", np.where(voids, 0.0, array))
    array[voids] = np.nan
    return array


def voids_in(heights: NDArray[Any], nodata: float | None) -> NDArray[np.bool_]:
    """Where a matrix of heights holds ``nodata``, or that number as single precision rounds it.

    A map of float32 holds -9999.9 as -9999.900390625, also after it was widened.
    """
    array = heights.astype(np.float64)
    if nodata is None or math.isnan(nodata):
        return np.isnan(array) & (nodata is not None)
    kinds = (np.float32, np.float16) if heights.dtype == np.float16 else (np.float32,)
    with np.errstate(over="ignore"):
        rounded = [float(kind(nodata)) for kind in kinds]
    return np.isin(array, [nodata, *filter(math.isfinite, rounded)])


def finite(name: str, value: Any) -> float:
    """A finite float; DomainError otherwise."""
    try:
        number = math.nan if isinstance(value, str | bytes | bool) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not abs(number) <= LARGEST:
        raise DomainError(f"{name}: expected a finite number below {LARGEST:g}; got {value!r:.60}; mend it")
    return number


def spacing(name: str, value: Any) -> float:
    """A positive float; the message for a negative one says what to do with north-up rasters."""
    number = finite(name, value)
    if number < SMALLEST:
        raise DomainError(
            f"{name}: expected a positive spacing; got {number:g}; "
            "reverse the rows (or columns) so that y (or x) grows with the index"
        )
    return number


def pair(name: str, value: Any) -> Sequence[Any]:
    """Two entries, for x and y; ShapeError otherwise."""
    if isinstance(value, str | bytes) or not hasattr(value, "__len__") or len(value) != 2:
        raise ShapeError(f"{name}: expected two entries, for x and y; got {value!r:.60}; give both")
    return list(value)


def step(name: str, value: Any) -> float:
    """A positive length; DomainError otherwise."""
    number = finite(name, value)
    if number < SMALLEST:
        raise DomainError(f"{name}: expected a positive step; got {value!r:.60}; give its length")
    return number


def count(name: str, value: Any) -> int:
    """An integer of at least 0; DomainError otherwise."""
    number = finite(name, value)
    if number != int(number) or number < 0:
        raise DomainError(f"{name}: expected an integer of at least 0; got {value!r:.60}; indices run from -N to N")
    return int(number)


#: Roundings that a coordinate may have seen before it is compared with the border of the map.
ROUNDINGS = 4.0
#: Flags of :meth:`TerrainMap.sample`.
ON_MAP, OFF_MAP, NO_DATA = 0, 1, 2


@dataclass(frozen=True, slots=True, eq=False)
class TerrainMap:
    """Heights on a regular grid, bilinear between the nodes.

    heights : (ny, nx) metres, row = y ascending, column = x ascending; NaN where there is none
    x0, y0  : coordinates of heights[0, 0]
    dx, dy  : spacing, positive, in the unit of the coordinates
    nodata  : value in ``heights`` that means "none", or None

    single  : the heights in single precision, for loops that prove their margin ; highest : largest |height|

    NaN in ``heights`` is accepted only with ``nodata=float("nan")``: otherwise it is an error.
    Raises ShapeError, NotFiniteError, EmptyError, DomainError.
    """

    heights: Array
    x0: float
    y0: float
    dx: float
    dy: float
    nodata: float | None = None
    single: NDArray[np.float32] = field(init=False, repr=False)
    highest: float = field(init=False, default=0.0)
    has_voids: bool = field(init=False, default=False)

    def __post_init__(self) -> None:
        heights = with_voids(self.heights, self.nodata)
        put(self, "heights", freeze(heights))
        with np.errstate(over="ignore"):
            put(self, "single", freeze(heights.astype(np.float32)))
        for name in ("x0", "y0"):
            put(self, name, finite(name, getattr(self, name)))
        for name in ("dx", "dy"):
            put(self, name, spacing(name, getattr(self, name)))
        voids = np.isnan(heights)
        if voids.all():
            raise NoDataError("heights: expected at least one height; got only voids; choose another map")
        put(self, "has_voids", bool(voids.any()))
        put(self, "highest", float(np.nanmax(np.abs(heights))))

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """(x of the first column, x of the last, y of the first row, y of the last)."""
        ny, nx = self.heights.shape
        return self.x0, self.x0 + (nx - 1) * self.dx, self.y0, self.y0 + (ny - 1) * self.dy

    def cells(self, x: Any, y: Any) -> tuple[Array, Array]:
        """Positions as column and row coordinates, counted in cells from heights[0, 0].

        A coordinate that leaves the map by no more than its own rounding is on the border.
        """
        ny, nx = self.heights.shape
        return along_axis(x, self.x0, self.dx, nx - 1), along_axis(y, self.y0, self.dy, ny - 1)

    def sample(self, x: Any, y: Any) -> tuple[Array, NDArray[np.int8]]:
        """Bilinear heights at positions of one shape, and a flag for each.

        The height is NaN exactly where the flag is not ON_MAP: OFF_MAP outside the rectangle of the
        nodes (its border belongs to the map), NO_DATA where a node of nonzero weight has no height.
        """
        u, w = np.broadcast_arrays(*self.cells(x, y))
        return bilinear(self.heights, u, w)

    def height(self, x: Any, y: Any) -> Array:
        """Bilinear heights; OutsideMapError or NoDataError when a position has none."""
        heights, flags = self.sample(x, y)
        demand_heights(self, np.broadcast_to(x, heights.shape), np.broadcast_to(y, heights.shape), flags)
        return heights


def along_axis(values: Any, first: float, step: float, last: int) -> Array:
    """Coordinates in cells along an axis from 0 to ``last``; rounding takes none off the border."""
    values = np.asarray(values, dtype=float)
    cells: Array = (values - first) / step
    slack = ROUNDINGS * np.finfo(float).eps * ((np.abs(values) + abs(first)) / step + last)
    cells = np.where((cells < 0.0) & (cells >= -slack), 0.0, cells)
    return np.where((cells > last) & (cells <= last + slack), float(last), cells)


def bilinear(heights: Array, u: Array, w: Array) -> tuple[Array, NDArray[np.int8]]:
    """Heights at column u and row w, and flags; columns first, then rows, as the compiled loops do."""
    ny, nx = heights.shape
    inside = (u >= 0.0) & (u <= nx - 1) & (w >= 0.0) & (w <= ny - 1)
    c = np.clip(np.floor(np.where(inside, u, 0.0)).astype(np.int64), 0, nx - 2)
    r = np.clip(np.floor(np.where(inside, w, 0.0)).astype(np.int64), 0, ny - 2)
    f, g = u - c, w - r
    low = blend(heights[r, c], heights[r, c + 1], f)
    high = blend(heights[r + 1, c], heights[r + 1, c + 1], f)
    value = np.where(inside, blend(low, high, g), np.nan)
    flags = np.where(inside, np.where(np.isnan(value), NO_DATA, ON_MAP), OFF_MAP).astype(np.int8)
    return value, flags


def blend(a: Array, b: Array, f: Array) -> Array:
    """a + f (b - a), where an end of weight zero may be missing."""
    mixed = a + f * (b - a)
    mixed = np.where((f == 0.0) & np.isnan(b), a, mixed)
    return np.where((f == 1.0) & np.isnan(a), b, mixed)


def demand_heights(terrain: TerrainMap, x: Array, y: Array, flags: NDArray[np.int8]) -> None:
    """Raise OutsideMapError or NoDataError for the first position without a height."""
    if (flags == OFF_MAP).any():
        k = int(np.flatnonzero(np.ravel(flags) == OFF_MAP)[0])
        left, right, bottom, top = terrain.extent
        raise OutsideMapError(
            f"track: expected positions within x {left:g}…{right:g}, y {bottom:g}…{top:g}; got "
            f"({np.ravel(x)[k]:g}, {np.ravel(y)[k]:g}) at point {k}"
            f" ({int((flags == OFF_MAP).sum())} of {flags.size} off the map); {hint(terrain, x, y)}"
        )
    if (flags == NO_DATA).any():
        k = int(np.flatnonzero(np.ravel(flags) == NO_DATA)[0])
        raise NoDataError(
            f"track: expected heights under all points; got a void at ({np.ravel(x)[k]:g}, "
            f"{np.ravel(y)[k]:g}), point {k} ({int((flags == NO_DATA).sum())} of {flags.size}); "
            "cut the track or fill the map"
        )


def hint(terrain: TerrainMap, x: Array, y: Array) -> str:
    """What may be wrong with positions off the map."""
    if (terrain.sample(y, x)[1] != OFF_MAP).all():
        return "x and y look exchanged"
    return "cut the track or use a larger map, and check units and origin"
