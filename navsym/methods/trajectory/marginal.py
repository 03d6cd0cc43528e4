"""Standard deviations that know that the noise of a track was only estimated.

The noise parameters (logarithms of scale and density) have the information ½ d²cost, cost = -2 log likelihood,
at their maximum-likelihood values. With weights w_i at points around them that have this covariance,

    mean = sum w_i m_i,    variance = sum w_i (P_i + (m_i - mean)^2),

m_i, P_i the estimate and its variance for the noise of the point: the law of total variance with Laplace's
posterior. Taking the most likely noise for the true one leaves the second term out and is optimistic.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from navsym.methods.trajectory.tracks import Fit, Noise, Rows, Track
from navsym.numeric.arrays import Array, frozen

#: Step of the second differences and largest standard deviation, in powers of ten.
STEP, WIDEST = 0.15, 0.3
#: Distance of the outer points in standard deviations; weights are then exact for polynomials of degree three.
REACH = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class NoisePoint:
    """Noise parameters with a weight; the weights of all points sum to one."""

    weight: float
    noise: Noise


def noise_points(
    track: Track, order: int, use: Rows, noise: Noise, *, gate: float = 0.0, fixed_scale: bool = False
) -> list[NoisePoint]:
    """Points around the most likely noise with the covariance of its estimate; the first is the noise itself.

    East and North share one pair of parameters, Up has its own; point k moves both.
    """
    roots = [
        covariance_root(Fit(track, order, use, channels, gate, fixed_scale), noise, channels[0])
        for channels in ((0, 1), (2,))
    ]
    axes = 1 if fixed_scale else 2
    points = [NoisePoint(1.0 - axes / REACH, noise)]
    for axis in range(axes):
        for sign in (-1.0, 1.0):
            moves = [10.0 ** (sign * np.sqrt(REACH) * root[:, axis]) for root in roots]
            factors = np.array([moves[0], moves[0], moves[1]]).T
            moved = Noise(frozen(noise.scale * factors[0]), frozen(noise.density * factors[1]))
            points.append(NoisePoint(1.0 / (2.0 * REACH), moved))
    return points


def covariance_root(fit: Fit, noise: Noise, channel: int) -> Array:
    """(2, 2): columns whose squares sum to the covariance of (log10 scale, log10 density).

    With a fixed scale the only column is the first one, along the density. Directions that the track says
    nothing about are capped.
    """
    x, y = (float(np.log10(value[channel])) for value in (noise.scale, noise.density))
    if fit.fixed_scale:
        below, middle, above = (fit.cost(x, y + d * STEP) for d in (-1, 0, 1))
        spread = deviation((below - 2 * middle + above) / (2 * STEP**2))
        return np.array([[0.0, 0.0], [spread, 0.0]])
    cost = {(i, j): fit.cost(x + i * STEP, y + j * STEP) for i in (-1, 0, 1) for j in (-1, 0, 1)}
    both = (cost[1, 1] - cost[1, -1] - cost[-1, 1] + cost[-1, -1]) / 4
    second = [cost[1, 0] - 2 * cost[0, 0] + cost[-1, 0], cost[0, 1] - 2 * cost[0, 0] + cost[0, -1]]
    information = np.array([[second[0], both], [both, second[1]]]) / (2 * STEP**2)
    values, vectors = np.linalg.eigh(information)
    return vectors * np.array([deviation(float(value)) for value in values])


def deviation(information: float) -> float:
    """Standard deviation for an information, capped where there is none."""
    return min(WIDEST, 1.0 / np.sqrt(information)) if information > 1.0 / WIDEST**2 else WIDEST
