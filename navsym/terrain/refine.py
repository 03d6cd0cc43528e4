"""From the best grid point to the minimum between the grid points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from navsym.core.arrays import Array
from navsym.core.errors import NotEstimableError
from navsym.terrain.heights import ON_MAP, TerrainMap, demand_heights
from navsym.terrain.search import need
from navsym.terrain.track import Profile

#: Largest number of Gauss-Newton steps, and the step (in cells) below which they end.
STEPS, ENOUGH = 60, 1e-7


@dataclass(frozen=True, slots=True, eq=False)
class Refined:
    """A correction off the grid.

    position  : (2,) correction at the first measurement ; velocity : (2,) ; offset : height error, m
    criterion : sum of squared residuals there
    """

    position: Array
    velocity: Array
    offset: float
    criterion: float


def refine(
    terrain: TerrainMap,
    track: Profile,
    position: tuple[float, float],
    velocity: tuple[float, float],
    *,
    offset: bool = False,
) -> Refined:
    """Levenberg-damped Gauss-Newton on the bilinear surface, from a grid fix.

    Minimises ``sum (h_k - H(x_k + px + vx tau_k, y_k + py + vy tau_k) - b)^2`` with b = 0 unless ``offset``;
    a step is taken only if it lowers the sum, so the result is never worse than the start.
    Raises NotEstimableError when the slopes there do not determine the unknowns.
    """
    need(track, 6 if offset else 5, "the unknowns and their covariance")
    q = np.array([*position, *velocity, 0.0])[: 5 if offset else 4].astype(float)
    residual, J = linearised(terrain, track, q)
    if offset:
        q[4] = residual.mean()
        residual = residual - q[4]
    scale = np.array([terrain.dx, terrain.dy, *np.array([terrain.dx, terrain.dy]) / track.elapsed[-1], 1.0])
    scale = scale[: q.size]
    damping, taken = 1e-6, np.inf
    for _ in range(STEPS):
        if taken <= ENOUGH or damping >= 1e12:
            break
        step = damped_step(J * scale, residual, damping) * scale
        tried = evaluated(terrain, track, q + step)
        if tried is not None and tried[0] @ tried[0] <= residual @ residual:
            q, taken, damping = q + step, float(np.abs(step / scale).max()), damping * 0.2
            residual, J = tried
        else:
            damping *= 8.0
    demand_determined(J * scale, scale)
    return Refined(q[:2], q[2:4], float(q[4]) if offset else 0.0, float(residual @ residual))


def linearised(terrain: TerrainMap, track: Profile, q: Array) -> tuple[Array, Array]:
    """Residuals (n,) and the Jacobian (n, p) of the mapped profile; errors of the map raise."""
    x, y = moved(track, q)
    heights, flags = terrain.sample(x, y)
    demand_heights(terrain, x, y, flags)
    J = jacobian(terrain, x, y, track.elapsed, velocity=True, offset=q.size == 5)
    return track.h - heights - (q[4] if q.size == 5 else 0.0), J


def jacobian(terrain: TerrainMap, x: Array, y: Array, times: Array, *, velocity: bool, offset: bool) -> Array:
    """(n, p): heights along x, y by position and velocity at the time 0 of ``times`` (n,), and by height error."""
    gx, gy = cell_slopes(terrain, x, y)
    columns = [gx, gy, *([gx * times, gy * times] if velocity else []), *([np.ones_like(gx)] if offset else [])]
    return np.stack(columns, axis=1)


def evaluated(terrain: TerrainMap, track: Profile, q: Array) -> tuple[Array, Array] | None:
    """Like :func:`linearised`, None where the track would leave the map."""
    x, y = moved(track, q)
    return linearised(terrain, track, q) if (terrain.sample(x, y)[1] == ON_MAP).all() else None


def moved(track: Profile, q: Array) -> tuple[Array, Array]:
    """x and y (n,) of the track under the correction q: two of position, two of velocity; an offset is not used."""
    tau = track.elapsed
    return track.x + (q[0] + q[2] * tau), track.y + (q[1] + q[3] * tau)


def cell_slopes(terrain: TerrainMap, x: Array, y: Array) -> tuple[Array, Array]:
    """Slopes of the bilinear surface itself, constant along one axis within a cell."""
    H = terrain.heights
    u, w = terrain.cells(x, y)
    c = np.clip(np.floor(u).astype(np.int64), 0, H.shape[1] - 2)
    r = np.clip(np.floor(w).astype(np.int64), 0, H.shape[0] - 2)
    f, g = u - c, w - r
    along_x = (H[r, c + 1] - H[r, c]) * (1 - g) + (H[r + 1, c + 1] - H[r + 1, c]) * g
    along_y = (H[r + 1, c] - H[r, c]) * (1 - f) + (H[r + 1, c + 1] - H[r, c + 1]) * f
    return np.nan_to_num(along_x) / terrain.dx, np.nan_to_num(along_y) / terrain.dy


def damped_step(J: Array, residual: Array, damping: float) -> Array:
    """Minimiser of |J s - r|^2 + damping |D s|^2, with D the lengths of the columns.

    By the normal equations of columns of unit length: five by five at the most, and well scaled.
    """
    lengths = np.sqrt(np.einsum("ij,ij->j", J, J)) + 1e-300
    unit = J / lengths
    matrix = np.einsum("ij,ik->jk", unit, unit) + (damping + 1e-15) * np.eye(J.shape[1])
    step: Array = np.linalg.solve(matrix, np.einsum("ij,i->j", unit, residual)) / lengths
    return step


def demand_determined(J: Array, scale: Array) -> None:
    """NotEstimableError for a singular Jacobian, with the direction in the units of the unknowns."""
    values, vectors = np.linalg.eigh(np.einsum("ij,ik->jk", J, J))
    if values[0] <= 1e-14 * values[-1]:
        direction = ", ".join(f"{v:.3g}" for v in vectors[:, 0] * scale)
        raise NotEstimableError(
            f"terrain: expected slopes that determine x, y, vx, vy; got none along ({direction}); "
            "fly longer or over other relief"
        )
