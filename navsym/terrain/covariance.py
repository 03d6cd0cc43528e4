"""How far a fix can be trusted: its covariance, its weakest direction, and geometry that is nearly singular.

With the slopes g_k of the bilinear map under the corrected track and the times s_k = t_k - t_n before the last one,
a row of the Jacobian of the heights is (g_k, s_k g_k[, 1]) on position, velocity and height error at the last time, and

    covariance = s^2 (J^T J)^-1 J^T K J (J^T J)^-1 + step^2 / 12 on each axis of the grid,

K being the correlations of the height differences, rho^|i-j|, and s^2 their variance, from their sum of squares, the
criterion. What rho is, their restricted likelihood says (Patterson, Thompson 1971), over which the product is averaged.
A hypothesis of a grid is off by an error spread evenly over its step; the minimum between the grid points is not.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from navsym.terrain.heights import Array, TerrainMap
from navsym.terrain.refine import jacobian
from navsym.terrain.track import Hypotheses, Profile

#: Condition of the normalised Jacobian beyond which the geometry is nearly singular, and beyond which nothing is said.
NEARLY, SINGULAR = 1e3, 1e7
#: Correlations of neighbouring height differences that are weighed, and the one from which on a remark is due.
CORRELATIONS, CORRELATED = np.linspace(0.0, 0.98, 50), 0.5
#: With fewer heights to spare nothing is known of their correlation.
ENOUGH_TO_SPARE = 8
#: The weakest deviation beyond so many strongest ones is worth a remark.
LOPSIDED = 30.0


@dataclass(frozen=True, slots=True, eq=False)
class Trust:
    """What the slopes under a fix say of it.

    covariance : of (x, y) or (x, y, vx, vy) at the last time in units of the map; None where it is not determined
    direction  : (2,) unit vector along which the position is known worst, None without a covariance
    weakest, strongest : standard deviations of the position along it and across it
    remarks    : sentences
    """

    covariance: Array | None
    direction: Array | None = None
    weakest: float | None = None
    strongest: float | None = None
    remarks: tuple[str, ...] = ()


def trust_of(
    terrain: TerrainMap,
    track: Profile,
    at: tuple[Array, Array],
    *,
    velocity: bool,
    offset: bool,
    grid: Hypotheses | None,
    metres: tuple[float, float] = (1.0, 1.0),
) -> Trust:
    """Covariance of a fix and what is weak in it.

    at       : x, y (n,) of the corrected track
    velocity : whether velocities were sought; offset: whether the height error was estimated, too
    grid     : the grid that the fix is a point of, None for a minimum between its points
    metres   : metres of a unit of the map along x and y, for the direction
    """
    J = jacobian(terrain, *at, track.elapsed - track.elapsed[-1], velocity=velocity, offset=offset)
    spare = len(J) - J.shape[1]
    if spare < 1:
        return Trust(None, remarks=(f"no covariance: {len(J)} heights for {J.shape[1]} unknowns leave no residual",))
    lengths = np.sqrt((J**2).sum(axis=0))
    if not (lengths > 0.0).all():
        return Trust(None, remarks=("no covariance: the slopes under the fix do not show every unknown",))
    _, values, rotation = np.linalg.svd(J / lengths, full_matrices=False)
    if values[-1] * SINGULAR <= values[0]:
        return Trust(None, remarks=(f"no covariance: the geometry is singular {along(rotation[-1] / lengths)}",))
    solved = rotation.T / values**2 @ rotation / lengths[:, None]
    count = 4 if velocity else 2
    residual = track.h - terrain.height(*at)
    product, rho = height_spread(J / lengths, residual - residual.mean() if offset else residual)
    covariance = (solved @ product @ solved.T)[:count, :count]
    if grid is not None:
        covariance = covariance + rounding(grid, float(track.elapsed[-1]) if velocity else 0.0, count)
    found = described(covariance, values[0] / values[-1], rotation[-1] / lengths, metres)
    if rho < CORRELATED:
        return found
    told = f"the height differences are correlated, {rho:.2f} from row to row, which the deviations count"
    return replace(found, remarks=(*found.remarks, told))


def height_spread(J: Array, residual: Array) -> tuple[Array, float]:
    """s^2 J^T K J (p, p), averaged over the correlation of neighbouring residuals (n,), and its mean."""
    (n, p), hat = J.shape, np.linalg.pinv(J.T @ J)
    rhos = CORRELATIONS if n - p >= ENOUGH_TO_SPARE else np.zeros(1)
    past, half = np.zeros((len(rhos), p)), np.zeros((len(rhos), p, p))
    for row in J:
        past = rhos[:, None] * past + row
        half += row[:, None] * past[:, None, :]
    logs, products = [], []
    for rho, product in zip(rhos.tolist(), half + half.transpose(0, 2, 1) - J.T @ J, strict=True):
        white = np.column_stack([J, residual])
        white[1:] = (white[1:] - rho * white[:-1]) / math.sqrt(1.0 - rho**2)
        R = np.abs(np.diag(np.linalg.qr(white, mode="r")))
        lost = (n - 1) * math.log(1.0 - rho**2) + 2.0 * np.log(R[:p]).sum() + 2.0 * (n - p) * math.log(R[p] + 1e-300)
        logs.append(-0.5 * lost)
        products.append(product * float(residual @ residual) / (n - float(np.trace(product @ hat))))
    weights = np.exp(np.array(logs) - max(logs))
    weights /= weights.sum()
    return np.tensordot(weights, products, axes=1), float(weights @ rhos)


def rounding(grid: Hypotheses, elapsed: float, count: int) -> Array:
    """Covariance (count, count) at the last time of errors spread evenly over the steps of a grid."""
    place = np.diag(np.square(grid.step)) / 12.0
    speed = np.diag(np.square(grid.velocity_step)) / 12.0
    if count == 2:
        return place
    return np.block([[place + elapsed**2 * speed, elapsed * speed], [elapsed * speed, speed]])


def described(covariance: Array, condition: float, dark: Array, metres: tuple[float, float]) -> Trust:
    """The covariance with its weakest direction in metres, and remarks on geometry.

    dark : the combination of unknowns that the heights show least
    """
    scale = np.asarray(metres)
    values, vectors = np.linalg.eigh(covariance[:2, :2] * scale[:, None] * scale)
    weakest, strongest = (math.sqrt(max(float(v), 0.0)) for v in values[::-1])
    direction = vectors[:, 1] * (1.0 if vectors[np.abs(vectors[:, 1]).argmax(), 1] > 0 else -1.0)
    remarks = []
    if condition > NEARLY:
        remarks.append(f"the geometry is nearly singular, condition {condition:.2g}, {along(dark)}")
    if weakest > LOPSIDED * strongest:
        where = ", ".join(f"{v:.3f}" for v in direction)
        remarks.append(f"the fix is weak along ({where}): deviation {weakest:.3g} there, {strongest:.3g} across")
    return Trust(covariance, direction, weakest, strongest, tuple(remarks))


def along(direction: Array) -> str:
    """Words for a combination of unknowns."""
    unit = direction / np.abs(direction).max()
    names = ("x", "y", "vx", "vy", "height error") if len(unit) > 3 else ("x", "y", "height error")
    return "along " + ", ".join(f"{name} {v:.3g}" for name, v in zip(names, unit, strict=False))
