"""The Earth and motion over it: positions as numbers, polynomial motion as exact rows.

The coordinate x_1 of a polynomial motion obeys dx_1/dt = rho x_2, dx_2/dt = x_3, ..., dx_n/dt = 0: its speed is a
polynomial of degree n - 2.
"""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from navsym.core.arrays import Array
from navsym.core.errors import DomainError

# Positions on WGS-84 as numbers: Earth-fixed Cartesian coordinates and local East-North-Up axes.
#
# Angles in radians, lengths in metres. Cartesian coordinates have no trouble at poles and at the 180th
# meridian, which is why tracks are differentiated there and only the result is turned to East, North, Up.


Angles = NDArray[np.float64] | float

SEMI_MAJOR = 6378137.0
FLATTENING = 1 / 298.257223563
ECCENTRICITY_SQUARED = FLATTENING * (2 - FLATTENING)


def prime_vertical_radius(latitude: Angles) -> Array:
    """a / sqrt(1 - e^2 sin^2 phi), metres, shape of the input."""
    return SEMI_MAJOR / np.sqrt(1 - ECCENTRICITY_SQUARED * np.sin(latitude) ** 2)


def cartesian(latitude: Angles, longitude: Angles, height: Angles) -> Array:
    """Earth-fixed Cartesian position, (..., 3), metres."""
    radius = prime_vertical_radius(latitude)
    axis = (radius + height) * np.cos(latitude)
    z = (radius * (1 - ECCENTRICITY_SQUARED) + height) * np.sin(latitude)
    return np.stack(np.broadcast_arrays(axis * np.cos(longitude), axis * np.sin(longitude), z), axis=-1)


def local_axes(latitude: Angles, longitude: Angles) -> Array:
    """Rows East, North, Up (normal to the ellipsoid) in Earth-fixed axes, (..., 3, 3)."""
    sp, cp, sl, cl = np.sin(latitude), np.cos(latitude), np.sin(longitude), np.cos(longitude)
    zero = np.zeros(np.broadcast_shapes(np.shape(sp), np.shape(sl)))
    east = np.stack(np.broadcast_arrays(-sl, cl, zero), axis=-1)
    north = np.stack(np.broadcast_arrays(-sp * cl, -sp * sl, cp + zero), axis=-1)
    up = np.stack(np.broadcast_arrays(cp * cl, cp * sl, sp + zero), axis=-1)
    return np.stack((east, north, up), axis=-2)


def need_order(n: int) -> None:
    """DomainError below order one."""
    if n < 1:
        raise DomainError(f"n: expected an order of 1 or more; got {n}; choose a larger one")


def observability_rows(n: int, rho: Fraction, tau: Fraction) -> list[list[Fraction]]:
    """N_p as exact numbers: row i is h Phi^i = (1, rho i tau, ..., rho (i tau)^(n-1) / (n-1)!), i = 1..n."""
    need_order(n)
    scales = [rho * tau**j / math.factorial(j) for j in range(1, n)]
    return [[Fraction(1), *(s * i**j for j, s in enumerate(scales, 1))] for i in range(1, n + 1)]


def power_rows(n: int) -> list[list[Fraction]]:
    """N_f as exact numbers: entry i^(j-1), i, j = 1..n; the same for every rho and tau."""
    need_order(n)
    return [[Fraction(i) ** j for j in range(n)] for i in range(1, n + 1)]
