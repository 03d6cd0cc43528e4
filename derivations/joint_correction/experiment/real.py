"""Velocity and position aiding of a recorded flight: two stages against the Kalman filter.

The horizontal specific force, turned by the recorded attitude, is integrated twice. The error of
this reckoning obeys, per axis, dr/dt = v, dv/dt = b, db/dt = noise, where b gathers tilt and
accelerometer errors. GPS velocity observes (v, b), GPS position completes the basis with r: the
two-stage split with m = 2, n = 3, found by the general method and not by hand.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
import sympy as sp

from navsym.core.arrays import Array, as_array, freeze
from navsym.core.errors import DomainError, EmptyError, UnknownSymbolError
from navsym.models.linear import LinearModel
from navsym.observability.chains import observe_jointly
from navsym.observability.splits import choose_split
from navsym.observability.two_stage import POLE, gains_by_poles
from navsym_papers.joint_correction.experiment.flight import EARTH_RADIUS
from navsym_papers.joint_correction.experiment.observer import (
    TwoStageObserver,
    hold_measurements,
    observer_of,
    two_stage_blocks,
)
from navsym_papers.joint_correction.experiment.observer import observer_loop as loop_of

FIELDS = ("time", "ax", "ay", "az", "phi", "theta", "psi", "vn", "ve", "lat", "lon", "GPS_TOW")


@dataclass(frozen=True, slots=True, eq=False)
class Aided:
    """Reckoning minus GPS at N fixes: t (N,), velocity (N, 2) and position (N, 2), axes north and east.

    gps : (N, 2) positions of the fixes in metres from the first
    """

    t: Array
    velocity: Array
    position: Array
    gps: Array


def aiding_model() -> LinearModel:
    """dr/dt = v, dv/dt = b, db/dt = 0; velocity first, then position."""
    return LinearModel(
        [[0, 1, 0], [0, 0, 1], [0, 0, 0]],
        None,
        [[0, 1, 0], [1, 0, 0]],
        ("r", "v", "b"),
        measurements=("velocity", "position"),
    )


def reckon(record: Mapping[str, Array]) -> Aided:
    """Integrate the recorded forces and subtract GPS at every new fix.

    record : columns of :data:`FIELDS`, angles in radians but lat, lon in degrees. Raises UnknownSymbolError (a
    missing column), ShapeError, NotFiniteError (one such force would spoil all that follows), DomainError (a time
    that goes back) and EmptyError (no fixes).
    """
    columns = columns_of(record)
    usable = (np.abs(columns["lat"]) > 0) & (columns["psi"] != 0)
    fixes = np.flatnonzero(usable & (np.diff(columns["GPS_TOW"], prepend=columns["GPS_TOW"][0]) > 0))
    if len(fixes) < 2:
        raise EmptyError(f"expected GPS fixes with an attitude; got {len(fixes)}; choose another record")
    start = fixes[0]
    t = columns["time"][start:]
    force = horizontal_force(columns)[start:]
    dt = np.diff(t, prepend=t[0])[:, None]
    gps_velocity = np.column_stack([columns["vn"], columns["ve"]])[fixes]
    gps = metres(columns["lat"][fixes], columns["lon"][fixes])
    velocity = gps_velocity[0] + np.cumsum(force * dt, axis=0)
    position = np.cumsum(velocity * dt, axis=0)
    places = fixes - start
    return Aided(
        freeze(t[places]), freeze(velocity[places] - gps_velocity), freeze(position[places] - gps), freeze(gps)
    )


def columns_of(record: Mapping[str, Array]) -> dict[str, Array]:
    """The columns of :data:`FIELDS`, checked: equally long, finite, with times that never go back."""
    for name in FIELDS:
        if name not in record:
            raise UnknownSymbolError(f"expected a column {name}; got none; record it")
    size = np.size(record["time"])
    columns = {name: as_array(name, np.ravel(record[name]), (size,), "one entry per row") for name in FIELDS}
    back = np.flatnonzero(np.diff(columns["time"]) < 0)
    if back.size:
        raise DomainError(f"time: expected no time before the one above it; got row {back[0] + 1}; sort the rows")
    return columns


def horizontal_force(columns: Mapping[str, Array]) -> Array:
    """(N, 2) north and east components of the specific force, from roll, pitch and yaw."""
    phi, theta, psi = columns["phi"], columns["theta"], columns["psi"]
    ax, ay, az = columns["ax"], columns["ay"], columns["az"]
    ahead = ax * np.cos(theta) + (ay * np.sin(phi) + az * np.cos(phi)) * np.sin(theta)
    aside = ay * np.cos(phi) - az * np.sin(phi)
    return np.column_stack([ahead * np.cos(psi) - aside * np.sin(psi), ahead * np.sin(psi) + aside * np.cos(psi)])


def metres(latitude: Array, longitude: Array) -> Array:
    """North and east from the first point on a sphere, degrees in, metres out; across the 180th meridian as well."""
    first = np.radians(latitude[0])
    north = np.radians(latitude - latitude[0]) * EARTH_RADIUS
    turned = np.remainder(longitude - longitude[0] + 180.0, 360.0) - 180.0
    return np.column_stack([north, np.radians(turned) * EARTH_RADIUS * np.cos(first)])


@cache
def aiding_observer(rate_x: float, rate_z: float) -> TwoStageObserver:
    """Observer with the poles (p + rate_x)^2 and (p + rate_z), rates in 1/s."""
    first, second = sp.symbols("lam_x lam_z", positive=True)
    chosen = choose_split(observe_jointly(aiding_model()))
    found = gains_by_poles(chosen, (POLE + first) ** 2, POLE + second)
    values = {first: sp.Rational(str(rate_x)), second: sp.Rational(str(rate_z))}
    return observer_of(two_stage_blocks(chosen), found.K_x, found.K_z, values)


def two_stage_estimates(
    aided: Aided, axis: int, rate_x: float = 0.2, rate_z: float = 0.2, start: float = 60.0
) -> Array:
    """(N, 3) estimates of (r, v, b) after every fix; position is used from ``start`` seconds on.

    Between two fixes the mean of both is held: held alone, a fix lags half a second behind a reckoning
    that drifts by metres per second. Until the start the second stage is carried along without
    gain, and at the start it takes the first position as it is.
    """
    found = aiding_observer(rate_x, rate_z)
    A, B = loop_of(found)
    without = A.copy()
    without[2, 2] = found.G_z2[0, 0]
    back = np.linalg.inv(found.L)
    state, used = np.zeros(3), False
    measured = np.column_stack([aided.velocity[:, axis], aided.position[:, axis]])
    estimates = [back @ state]
    for k in range(1, len(aided.t)):
        step = float(aided.t[k] - aided.t[k - 1])
        position = aided.t[k] - aided.t[0] >= start
        if position and not used:
            state[2], used = aided.position[k - 1, axis], True
        sigma = (measured[k - 1] + measured[k]) / 2
        Phi, Gamma = hold_measurements(A if position else without, B if position else B * [1.0, 0.0], step)
        state = Phi @ state + Gamma @ sigma
        estimates.append(back @ state)
    return np.array(estimates)


@dataclass(frozen=True, slots=True)
class Tuning:
    """Deviations of GPS velocity (m/s) and position (m), and intensities of the noise in dv/dt and db/dt."""

    velocity: float = 0.3
    position: float = 2.5
    force: float = 0.05
    drift: float = 0.002


def kalman_estimates(aided: Aided, axis: int, tuning: Tuning | None = None, start: float = 60.0) -> Array:
    """(N, 3) estimates of (r, v, b) by the Kalman filter of the same model; position from ``start`` on."""
    tuning = tuning or Tuning()
    mean, P = np.zeros(3), np.diag([100.0, 1.0, 0.5]) ** 2
    F = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
    estimates = [mean]
    for k in range(1, len(aided.t)):
        step = float(aided.t[k] - aided.t[k - 1])
        Phi = np.eye(3) + F * step + F @ F * step**2 / 2
        mean, P = Phi @ mean, Phi @ P @ Phi.T + np.diag([0.0, tuning.force, tuning.drift]) * step
        observed = [(np.array([0.0, 1.0, 0.0]), aided.velocity[k, axis], tuning.velocity)]
        if aided.t[k] - aided.t[0] >= start:
            observed.append((np.array([1.0, 0.0, 0.0]), aided.position[k, axis], tuning.position))
        for h, value, sigma in observed:
            gain = P @ h / (h @ P @ h + sigma**2)
            mean = mean + gain * (value - h @ mean)
            keep = np.eye(3) - np.outer(gain, h)
            P = keep @ P @ keep.T + np.outer(gain, gain) * sigma**2
        estimates.append(mean)
    return np.array(estimates)


def outage_errors(aided: Aided, estimates: tuple[Array, Array], horizon: int, start: float = 120.0) -> Array:
    """(K,) metres: error of the position predicted ``horizon`` fixes ahead without GPS, against GPS.

    The estimated error (r, v, b) of the reckoning is carried on by its own model; GPS at the end is the
    judge.
    """
    found = []
    for k in np.flatnonzero(aided.t - aided.t[0] >= start):
        if k + horizon >= len(aided.t):
            break
        step = float(aided.t[k + horizon] - aided.t[k])
        predicted = [e[k] @ np.array([1.0, step, step**2 / 2]) for e in estimates]
        found.append(np.hypot(*(aided.position[k + horizon] - predicted)))
    return np.array(found)
