"""The flight of the experiment: rates of the ideal frame and of the Earth along a great circle.

A vehicle moves at constant speed on a great circle of the rotating spherical Earth. The frame Mx
carries its third axis along the vertical and does not turn about it (free in azimuth).
"""

from dataclasses import dataclass

import numpy as np

from navsym.core.arrays import Array, freeze
from navsym.core.errors import DomainError

EARTH_RATE = 7.292115e-5  # 1/s
EARTH_RADIUS = 6378137.0  # m
GRAVITY = 9.80665  # m/s^2
SCHULER_RATE = float(np.sqrt(GRAVITY / EARTH_RADIUS))  # 1/s


@dataclass(frozen=True, slots=True, eq=False)
class Flight:
    """Dimensionless rates at N + 1 instants: in units of omega_0, so that mu is contained in them.

    tau   : (N + 1,) dimensionless time
    omega : (N + 1, 2) horizontal absolute rates of Mx;  omega_rate : their derivatives by tau
    u     : (N + 1, 3) rate of the Earth in the axes Mx
    """

    tau: Array
    omega: Array
    omega_rate: Array
    u: Array

    @property
    def mu(self) -> float:
        """Largest horizontal rate, the small parameter."""
        return float(np.linalg.norm(self.omega, axis=1).max())


def great_circle(
    speed: float = 250.0,
    latitude: float = np.pi / 4,
    heading: float = np.pi / 3,
    duration: float = 10800.0,
    step: float = 5.0,
) -> Flight:
    """Rates along a great circle.

    speed in m/s over the ground, latitude and heading in radians at the start, times in seconds.
    Raises DomainError when the speed or the times are not positive.
    """
    if not (speed > 0.0 and duration > 0.0 and step > 0.0):
        raise DomainError("expected a positive speed, duration and step; got zero or less; change them")
    count = round(duration / step)
    t: Array = np.arange(count + 1, dtype=np.float64) * step
    vertical, velocity, acceleration = vertical_motion(speed, latitude, heading, t)
    omega_inertial = np.cross(vertical, velocity)  # no part along the vertical
    rate_inertial = np.cross(vertical, acceleration)
    axes = transported_axes(vertical, omega_inertial, step)
    omega = np.einsum("nij,nj->ni", axes, omega_inertial)[:, :2]
    omega_rate = np.einsum("nij,nj->ni", axes, rate_inertial)[:, :2]  # omega x omega = 0
    earth = np.einsum("nij,j->ni", axes, np.array([0.0, 0.0, EARTH_RATE]))
    w0 = SCHULER_RATE
    return Flight(freeze(t * w0), freeze(omega / w0), freeze(omega_rate / w0**2), freeze(earth / w0))


def vertical_motion(speed: float, latitude: float, heading: float, t: Array) -> tuple[Array, Array, Array]:
    """Unit vertical in inertial axes with its first two derivatives, each (N + 1, 3)."""
    up = np.array([np.cos(latitude), 0.0, np.sin(latitude)])
    north = np.array([-np.sin(latitude), 0.0, np.cos(latitude)])
    ahead = np.cos(heading) * north + np.sin(heading) * np.array([0.0, 1.0, 0.0])
    rate = speed / EARTH_RADIUS
    angle = rate * t[:, None]
    place = np.cos(angle) * up + np.sin(angle) * ahead  # in axes of the Earth
    motion = rate * (np.cos(angle) * ahead - np.sin(angle) * up)
    earth = np.array([0.0, 0.0, EARTH_RATE])
    velocity = motion + np.cross(earth, place)
    acceleration = -(rate**2) * place + 2 * np.cross(earth, motion) + np.cross(earth, np.cross(earth, place))
    c, s = np.cos(EARTH_RATE * t), np.sin(EARTH_RATE * t)
    zero, one = np.zeros_like(t), np.ones_like(t)
    turn = np.array([[c, -s, zero], [s, c, zero], [zero, zero, one]]).transpose(2, 0, 1)
    return tuple(np.einsum("nij,nj->ni", turn, v) for v in (place, velocity, acceleration))  # type: ignore[return-value]


def transported_axes(vertical: Array, omega: Array, step: float) -> Array:
    """Rows e1, e2, e3 of Mx in inertial axes: carried along without turning about the vertical."""
    axes = np.empty((len(vertical), 3, 3))
    first = np.cross([0.0, 0.0, 1.0], vertical[0])
    first = first / np.linalg.norm(first)  # east at the start
    for k, up in enumerate(vertical):
        if k:
            middle = (omega[k - 1] + omega[k]) / 2 * step
            first = first + np.cross(middle, first) + np.cross(middle, np.cross(middle, first)) / 2
            first = first - (first @ up) * up
            first = first / np.linalg.norm(first)
        axes[k] = first, np.cross(up, first), up
    return axes
