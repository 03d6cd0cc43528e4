"""Simulated flights over a height map: straight, at a constant absolute altitude, with errors of the inertial system.

**The altimeter is simulated**: the height above ground is read from one map with a relative error and compared with
another map, or the same one.
"""

import importlib.util
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import DomainError, MissingEngineError
from navsym.terrain.heights import ON_MAP, TerrainMap
from navsym.terrain.maps import local_frame, read_map
from navsym.terrain.track import Profile

Array = NDArray[np.float64]

#: Measurements per second, as in the paper.
RATE = 2.0


@dataclass(frozen=True, slots=True)
class Setting:
    """What is varied between experiments.

    measurements   : number of them, at 2 Hz ; speed : m/s over ground ; clearance : m above the mean ground
    shift, drift   : initial position (m) and velocity errors (m/s) are uniform in -shift…shift, -drift…drift
    altimeter      : relative standard deviation of the height above ground
    accelerometers : whether accelerometer errors are added, mean and variance as printed
    """

    measurements: int = 1000
    speed: float = 40.0
    clearance: float = 800.0
    shift: float = 800.0
    drift: float = 4.0
    altimeter: float = 0.015
    accelerometers: bool = False
    mean: float = 0.001
    variance: float = 0.005


@dataclass(frozen=True, slots=True, eq=False)
class Flight:
    """A recorded track and the correction that would have been right at its end."""

    track: Profile
    shift: Array
    velocity: Array


def sample_terrain() -> TerrainMap:
    """The elevation sample that comes with matplotlib, in local metres; raises MissingEngineError without it."""
    spec = importlib.util.find_spec("matplotlib")
    if spec is None or spec.origin is None:
        raise MissingEngineError("expected matplotlib for its elevation sample; got none; install navsym in full")
    name = "mpl-data/sample_data/jacksboro_fault_dem.npz"
    return terrain_from(Path(spec.origin).parent / name)


def terrain_from(path: str | Path) -> TerrainMap:
    """A map file as a map in local metres."""
    raster = local_frame(read_map(path))
    return TerrainMap(raster.heights, raster.x0, raster.y0, raster.dx, raster.dy, nodata=raster.nodata)


def errors_over(times: Array, setting: Setting, generator: np.random.Generator) -> tuple[Array, Array]:
    """Corrections (n, 2) of position and velocity over time: model (1), integrated sample by sample."""
    shift = generator.uniform(-setting.shift, setting.shift, 2)
    drift = generator.uniform(-setting.drift, setting.drift, 2)
    noise = generator.normal(setting.mean, math.sqrt(setting.variance), (times.size - 1, 2))
    steps = np.diff(times)[:, None] * (noise if setting.accelerometers else 0.0 * noise)
    velocity = drift + np.vstack([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    # Exact for an acceleration that is constant between samples.
    moved = 0.5 * (velocity[1:] + velocity[:-1]) * np.diff(times)[:, None]
    return shift + np.vstack([np.zeros((1, 2)), np.cumsum(moved, axis=0)]), velocity


def fly(ground: TerrainMap, start: Array, heading: float, setting: Setting, generator: np.random.Generator) -> Flight:
    """One flight over ``ground``: straight, at a constant absolute altitude.

    start : (2,) position in the middle of the track ; heading : of the way, radians from the x axis
    """
    t = np.arange(setting.measurements) / RATE
    way = setting.speed * (t - 0.5 * t[-1])
    truth = start + way[:, None] * np.array([math.cos(heading), math.sin(heading)])
    position, velocity = errors_over(t, setting, generator)
    heights = ground.height(truth[:, 0], truth[:, 1])
    altitude = heights.mean() + setting.clearance
    above = altitude - heights
    measured = altitude - above * (1.0 + setting.altimeter * generator.normal(size=t.size))
    inertial = truth - position
    return Flight(Profile(t, inertial[:, 0], inertial[:, 1], measured), position[-1], velocity[-1])


def course(ground: TerrainMap, setting: Setting, k: int, seed: int) -> tuple[Array, float]:
    """Middle (2,) in metres and heading in radians of track k: random, with room for all hypotheses inside the map.

    Raises DomainError when the map is too small for that.
    """
    generator = np.random.default_rng([seed, 3, k])
    left, right, bottom, top = ground.extent
    length = setting.speed * (setting.measurements - 1) / RATE
    # Room for the errors at the end and for the hypotheses about them.
    room = setting.shift + (setting.drift + 1.5) * (setting.measurements / RATE) + 200.0
    for _ in range(1000):
        heading = generator.uniform(0.0, 2.0 * math.pi)
        middle = np.array([generator.uniform(left, right), generator.uniform(bottom, top)])
        half = 0.5 * length * np.array([math.cos(heading), math.sin(heading)])
        ends = np.array([middle - half, middle + half])
        inside = (ends[:, 0] - room > left) & (ends[:, 0] + room < right)
        inside &= (ends[:, 1] - room > bottom) & (ends[:, 1] + room < top)
        if inside.all() and (ground.sample(*between(ends))[1] == ON_MAP).all():
            return middle, heading
    raise DomainError(
        f"ground: expected room for a track of {length / 1000:.1f} km and its hypotheses; got a map of "
        f"{(right - left) / 1000:.1f} by {(top - bottom) / 1000:.1f} km; fly slower or shorter"
    )


def between(ends: Array) -> tuple[Array, Array]:
    """Points along the straight line from ends[0] to ends[1]."""
    share = np.linspace(0.0, 1.0, 200)
    x, y = (ends[0, k] + share * (ends[1, k] - ends[0, k]) for k in (0, 1))
    return x, y
