"""Where the information lies along a track: the sums behind t_G, in O(n).

With the slopes g_k = (dh/dx, dh/dy) of the map at the measurements and their times t_k,

    G = sum g_k g_k^T,   M1 = sum t_k g_k g_k^T

are all that the theory of the paper needs. ``t_G(v) = v^T M1 v / v^T G v`` is a Rayleigh quotient
(terrain_search:11*), its extremes are the roots of ``det(M1 - t G)`` (terrain_search:roots.values), and
the matrix ``centre = G^-1 M1`` is what the scalar t_G stands for (terrain_search:centre).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from navsym.core.arrays import Array
from navsym.core.errors import NotEstimableError
from navsym.terrain.heights import TerrainMap, blend

Indices = NDArray[np.int64]
#: Ratio of the smallest to the largest information below which a direction counts as flat.
FLAT = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class Information:
    """G and M1 (2, 2), slopes squared and times slopes squared.

    M1 is not symmetric when the means were taken off (``information(..., centred=True)``).
    """

    G: Array
    M1: Array

    @property
    def centre(self) -> Array:
        """C = G^-1 M1 (2, 2), times: a velocity error v moves the position fix by C v."""
        return np.asarray(np.linalg.solve(self.G, self.M1), dtype=np.float64)

    @property
    def symmetric(self) -> Array:
        """The symmetric part of M1, all of it that quadratic forms see."""
        return 0.5 * (self.M1 + self.M1.T)

    @property
    def interval(self) -> tuple[float, float]:
        """(t_min, t_max): smallest and largest t_G over all directions of the velocity error.

        The roots of det(M1 - t G) = a t^2 - b t + c; the discriminant is computed as a sum of
        squares, so that it is never negative and loses nothing when the roots are close.
        """
        G, M = self.G, self.symmetric
        A2, A1, _ = self.quadratic
        det = G[0, 0] * G[1, 1] - G[0, 1] ** 2
        middle = (M[0, 0] * G[1, 1] + M[1, 1] * G[0, 0] - 2.0 * M[0, 1] * G[0, 1]) / (2.0 * det)
        # terrain_search:roots.solvable: G11^2 D = (G11 A1 - 2 G12 A2)^2 + 4 det(G) A2^2
        root = math.hypot(G[0, 0] * A1 - 2.0 * G[0, 1] * A2, 2.0 * math.sqrt(det) * A2) / G[0, 0]
        return middle - root / (2.0 * det), middle + root / (2.0 * det)

    @property
    def quadratic(self) -> tuple[float, float, float]:
        """(A2, A1, A0) of terrain_search:12*, from four products instead of double sums."""
        G, M = self.G, self.symmetric
        return (
            float(M[0, 0] * G[0, 1] - M[0, 1] * G[0, 0]),  # terrain_search:12.Ax2*
            float(M[0, 0] * G[1, 1] - M[1, 1] * G[0, 0]),  # terrain_search:12.Ax1
            float(M[0, 1] * G[1, 1] - M[1, 1] * G[0, 1]),  # terrain_search:12.Ax0*
        )

    @property
    def mean_time(self) -> float:
        """Mean of t_G over a uniform direction: tr(G^-1/2 M1) / tr(G^1/2), terrain_search:mean.rotated."""
        G, M = self.G, self.symmetric
        root = math.sqrt(G[0, 0] * G[1, 1] - G[0, 1] ** 2)
        adjugate = np.array([[G[1, 1], -G[0, 1]], [-G[0, 1], G[0, 0]]])
        return float((np.sum(adjugate * M) + root * np.trace(M)) / (root * (np.trace(G) + 2.0 * root)))

    def time_of(self, direction: tuple[float, float]) -> float:
        """t_G for a velocity error along ``direction``: the Rayleigh quotient."""
        v = np.asarray(direction, dtype=float)
        return float(v @ self.M1 @ v / (v @ self.G @ v))


def information(gx: Array, gy: Array, times: Array, *, centred: bool = False) -> Information:
    """The sums G, M1 of slopes (n,), (n,) at times (n,); unknown slopes (NaN) are left out.

    centred : take off the means of g and of t g over the track, which an unknown constant height error takes
              away (terrain_search:offset.centre)
    """
    known = np.isfinite(gx) & np.isfinite(gy)
    g, times = np.stack([gx[known], gy[known]]), np.asarray(times, dtype=float)[known]
    moving = g * times
    if centred:
        g, moving = g - g.mean(axis=1, keepdims=True), moving - moving.mean(axis=1, keepdims=True)
    M1 = g @ moving.T
    return Information(g @ g.T, M1 if centred else 0.5 * (M1 + M1.T))


#: Weights of three neighbouring nodes for the slope at the first, the middle and the last of them.
STENCILS = np.array([[-1.5, 2.0, -0.5], [-0.5, 0.0, 0.5], [0.5, -2.0, 1.5]])


def slopes(terrain: TerrainMap, x: Array, y: Array) -> tuple[Array, Array]:
    """Slopes of the map along x and y at positions (n,): central differences at the nodes, bilinear between.

    At the border of the map the differences are one-sided and of second order where three nodes are
    there; next to voids the slope is NaN. Positions have to lie on the map.
    """
    u, w = terrain.cells(x, y)
    ny, nx = terrain.heights.shape
    c = np.clip(np.floor(u).astype(np.int64), 0, nx - 2)
    r = np.clip(np.floor(w).astype(np.int64), 0, ny - 2)
    f, g = u - c, w - r
    found = []
    for at, spacing in ((along_row, terrain.dx), (lambda H, r, c: along_row(H.T, c, r), terrain.dy)):
        low = blend(at(terrain.heights, r, c), at(terrain.heights, r, c + 1), f)
        high = blend(at(terrain.heights, r + 1, c), at(terrain.heights, r + 1, c + 1), f)
        found.append(blend(low, high, g) / spacing)
    return found[0], found[1]


def along_row(H: Array, r: Indices, c: Indices) -> Array:
    """Slope at nodes (r, c) along x, per cell."""
    if H.shape[1] == 2:
        return H[r, 1] - H[r, 0]
    first = np.clip(c - 1, 0, H.shape[1] - 3)
    weights = STENCILS[c - first]
    return weights[:, 0] * H[r, first] + weights[:, 1] * H[r, first + 1] + weights[:, 2] * H[r, first + 2]


def one_sided(terrain: TerrainMap, x: Array, y: Array) -> Information:
    """Sums of the slopes across the next cell and across the last one, both at once: zero only on flat ground.

    Central differences alone would call a map flat whose heights repeat every second node.
    """
    here = terrain.sample(x, y)[0]
    found = []
    for side in (1.0, -1.0):
        gx = (terrain.sample(x + side * terrain.dx, y)[0] - here) / terrain.dx
        gy = (terrain.sample(x, y + side * terrain.dy)[0] - here) / terrain.dy
        found.append(information(gx, gy, np.zeros(here.size)))
    return Information(found[0].G + found[1].G, found[0].M1)


def demand_estimable(info: Information) -> None:
    """NotEstimableError, with the direction, when the terrain under the track is flat along one."""
    values, vectors = np.linalg.eigh(info.G)
    if values[1] <= 0.0:
        raise NotEstimableError(
            "terrain: expected slopes under the track; got flat ground, where no position error shows; fly over relief"
        )
    if values[0] <= FLAT * values[1]:
        ex, ey = vectors[:, 0]
        raise NotEstimableError(
            f"terrain: expected slopes in two directions; got none along ({ex:.4f}, {ey:.4f}): a position "
            "error in this direction does not show; fly over other relief or turn"
        )
