"""Positions on WGS-84 as numbers: Earth-fixed Cartesian coordinates and local East-North-Up axes.

Angles in radians, lengths in metres. Cartesian coordinates have no trouble at poles and at the 180th
meridian, which is why tracks are differentiated there and only the result is turned to East, North, Up.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Angles = NDArray[np.float64] | float

SEMI_MAJOR = 6378137.0
FLATTENING = 1 / 298.257223563
ECCENTRICITY_SQUARED = FLATTENING * (2 - FLATTENING)


def prime_vertical_radius(latitude: Angles) -> Array:
    """a / sqrt(1 - e^2 sin^2 phi), metres, shape of the input."""
    return SEMI_MAJOR / np.sqrt(1 - ECCENTRICITY_SQUARED * np.sin(latitude) ** 2)


def meridian_radius(latitude: Angles) -> Array:
    """a (1 - e^2) / (1 - e^2 sin^2 phi)^(3/2), metres: change of northing per radian of latitude."""
    return prime_vertical_radius(latitude) ** 3 * ((1 - ECCENTRICITY_SQUARED) / SEMI_MAJOR**2)


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


def geocentric(latitude: Angles, height: Angles) -> tuple[Array, Array]:
    """Geocentric latitude (radians) and radius (metres) of a geodetic latitude and height."""
    radius = prime_vertical_radius(latitude)
    axis = (radius + height) * np.cos(latitude)
    z = (radius * (1 - ECCENTRICITY_SQUARED) + height) * np.sin(latitude)
    return np.arctan2(z, axis), np.hypot(axis, z)
