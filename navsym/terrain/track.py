"""Tracks over a map and grids of hypotheses about their errors."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from navsym.core.errors import DomainError, DuplicateError, TooLargeError
from navsym.terrain.heights import SMALLEST, Array, count, pair, put, step, vector

#: Largest number of hypotheses whose criteria are kept at once (half a GB of doubles).
MOST_HYPOTHESES = 2**26


@dataclass(frozen=True, slots=True, eq=False)
class Profile:
    """What the aircraft recorded: the inertial positions and the terrain heights measured there.

    t    : (n,) seconds, strictly increasing
    x, y : (n,) inertial positions, in the unit of the map
    h    : (n,) measured terrain heights, metres: absolute altitude minus height above ground
    """

    t: Array
    x: Array
    y: Array
    h: Array

    def __post_init__(self) -> None:
        put(self, "t", vector("t", self.t, None, "one time per measurement"))
        for name in ("x", "y", "h"):
            put(self, name, vector(name, getattr(self, name), self.t.size, "one entry per time"))
        steps = np.diff(self.t)
        if (steps == 0.0).any():
            k = int(np.flatnonzero(steps == 0.0)[0])
            raise DuplicateError(f"t: expected distinct times; got {self.t[k]:g} at entries {k} and {k + 1}; drop one")
        if (np.abs(steps) < SMALLEST).any():
            raise DomainError(f"t: expected times at least {SMALLEST:g} s apart; got closer ones; check the unit")
        if (steps < 0.0).any():
            k = int(np.flatnonzero(steps < 0.0)[0])
            raise DomainError(
                f"t: expected increasing times; got {self.t[k + 1]:g} after {self.t[k]:g} at entry {k + 1}; sort them"
            )

    @property
    def elapsed(self) -> Array:
        """(n,) time since the first measurement, t0 of the paper."""
        return self.t - self.t[0]

    @property
    def final_velocity(self) -> tuple[float, float]:
        """Inertial velocity at the last time: the difference quotient of the last two positions."""
        if self.t.size < 2:
            return 0.0, 0.0
        step = self.t[-1] - self.t[-2]
        return float((self.x[-1] - self.x[-2]) / step), float((self.y[-1] - self.y[-2]) / step)


@dataclass(frozen=True, slots=True, eq=False)
class Hypotheses:
    """The grid of corrections: ``(i Dx, j Dy)`` in position, ``(Vi DVx, Vj DVy)`` in velocity.

    step, velocity_step             : pairs of positive numbers, in map units and map units per second
    half_count, velocity_half_count : pairs of integers N >= 0; each index runs from -N to N
    """

    step: tuple[float, float]
    half_count: tuple[int, int]
    velocity_step: tuple[float, float] = (1.0, 1.0)
    velocity_half_count: tuple[int, int] = (0, 0)

    def __post_init__(self) -> None:
        for name in ("step", "velocity_step"):
            values = pair(name, getattr(self, name))
            put(self, name, tuple(step(f"{name}[{k}]", v) for k, v in enumerate(values)))
        for name in ("half_count", "velocity_half_count"):
            values = pair(name, getattr(self, name))
            put(self, name, tuple(count(f"{name}[{k}]", v) for k, v in enumerate(values)))
        if self.size > MOST_HYPOTHESES:
            raise TooLargeError(
                f"hypotheses: expected at most {MOST_HYPOTHESES} of them; got "
                f"{' x '.join(map(str, self.counts))} = {self.size}; use fewer or larger steps"
            )

    @property
    def counts(self) -> tuple[int, int, int, int]:
        """(Mx, My, Mvx, Mvy) with M = 2 N + 1."""
        a, b, c, d = (2 * n + 1 for n in (*self.half_count, *self.velocity_half_count))
        return a, b, c, d

    @property
    def size(self) -> int:
        """Number of hypotheses, Mx My Mvx Mvy."""
        return math.prod(self.counts)

    @property
    def position_only(self) -> Hypotheses:
        """The same positions without velocity errors."""
        return Hypotheses(self.step, self.half_count, self.velocity_step, (0, 0))
