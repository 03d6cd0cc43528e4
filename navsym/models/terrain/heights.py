"""Height maps: heights on a regular grid, bilinear between the nodes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.errors import NoDataError, OutsideMapError, ShapeError
from navsym.models.terrain.gate import Array, finite, frozen, put, spacing, with_voids

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
        if min(heights.shape) < 2:
            raise ShapeError(f"heights: expected at least 2 x 2 nodes; got {heights.shape}; give more")
        put(self, "heights", frozen(heights))
        with np.errstate(over="ignore"):
            put(self, "single", frozen(heights.astype(np.float32)))
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
        """Positions as column and row coordinates, counted in cells from heights[0, 0]."""
        u = (np.asarray(x, dtype=float) - self.x0) / self.dx
        w = (np.asarray(y, dtype=float) - self.y0) / self.dy
        return u, w

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
