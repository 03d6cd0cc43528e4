"""Modes of navigation errors: the Schuler channel with a drift that jumps and a measurement that degrades.

A horizontal channel of an inertial system: velocity error v, tilt phi, gyro drift eps,
``dv/dt = g phi``, ``dphi/dt = -v / R + eps``, ``deps/dt = noise``; an external velocity shows v. Equation (3)
of the multi-structure paper with three modes for (4) and (6). Everything is in SI units and radians.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating[Any]]

GRAVITY = 9.81
EARTH_RADIUS = 6.371e6
DEGREE_PER_HOUR = np.pi / 180.0 / 3600.0
MODES = ("nominal", "drift jump", "degraded measurement")


@dataclass(frozen=True, slots=True)
class SchulerChannel:
    """Numbers of the channel; standard deviations, and probabilities per step.

    tau             : s       step
    velocity_noise  : m/s     of the external velocity, nominal
    acceleration    : m/s     growth of the velocity error per step
    drift_walk      : rad/s   growth of the drift per step, nominal
    drift_jump      : rad/s   the same in the jump mode
    degradation     : factor of the measurement noise in the degraded mode
    jump, degrade, recover : probabilities of leaving nominal for each other mode, and of coming back
    """

    tau: float = 120.0
    velocity_noise: float = 0.1
    acceleration: float = 0.02
    drift_walk: float = 0.005 * DEGREE_PER_HOUR
    drift_jump: float = 3.0 * DEGREE_PER_HOUR
    degradation: float = 10.0
    jump: float = 0.05
    degrade: float = 0.05
    recover: float = 0.5

    def transition(self) -> Array:
        """exp(A tau) (3, 3) in closed form, with w = sqrt(g / R): waves of v and phi, and a drift that stays."""
        w = np.sqrt(GRAVITY / EARTH_RADIUS)
        s, c = np.sin(w * self.tau), np.cos(w * self.tau)
        half = np.sin(0.5 * w * self.tau)
        return np.array(
            [[c, GRAVITY / w * s, 2.0 * EARTH_RADIUS * half * half], [-w / GRAVITY * s, c, s / w], [0.0, 0.0, 1.0]]
        )

    def models(self) -> list[dict[str, Array]]:
        """F, Q, H, R of the modes in the order of :data:`MODES`."""
        calm = np.diag([self.acceleration**2, 1e-12, self.drift_walk**2])
        jump = np.diag([self.acceleration**2, 1e-12, self.drift_jump**2])
        good, bad = self.velocity_noise**2, (self.degradation * self.velocity_noise) ** 2
        H = np.array([[1.0, 0.0, 0.0]])
        return [
            {"F": self.transition(), "Q": Q, "H": H, "R": np.array([[R]])}
            for Q, R in ((calm, good), (jump, good), (calm, bad))
        ]

    def mode_transition(self) -> Array:
        """Rows = from: a jump lasts one step on average, a degraded measurement 1 / recover steps."""
        stay = 1.0 - self.jump - self.degrade
        return np.array(
            [
                [stay, self.jump, self.degrade],
                [1.0 - self.jump, self.jump, 0.0],
                [self.recover, 0.0, 1.0 - self.recover],
            ]
        )

    def start(self) -> dict[str, Array]:
        """Mean, covariance and mode probabilities at step 0."""
        deviations = np.array([0.5, 2e-4, 0.02 * DEGREE_PER_HOUR])
        return {"mean": np.zeros(3), "covariance": np.diag(deviations**2), "probabilities": np.array([0.9, 0.05, 0.05])}
