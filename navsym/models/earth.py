"""The Earth and motion over it: an ellipsoid in symbols, positions as numbers, polynomial motion as exact rows.

The coordinate x_1 of a polynomial motion obeys dx_1/dt = rho x_2, dx_2/dt = x_3, ..., dx_n/dt = 0: its speed is a
polynomial of degree n - 2.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from navsym.core.errors import DomainError

# The Earth as an ellipsoid of revolution, and how a trihedron moves over it: symbolic side.
#
# Everything starts from the meridian ellipse x^2/a^2 + z^2/b^2 = 1 with b^2 = a^2 (1 - e^2) and from the
# Cartesian position; latitudes, radii, rotations and rates are derived by differentiation and scalar products.
# Source of the subject: Andreev, Theory of Inertial Navigation; conventions: East, North, Up, right-handed.


def surface_root(latitude: Any, e: Any) -> sp.Expr:
    """sqrt(1 - e^2 sin^2 phi): semi-major axis over the prime-vertical radius, dimensionless."""
    return sp.sqrt(1 - e**2 * sp.sin(latitude) ** 2)


def meridian_point(latitude: Any, height: Any, a: Any, e: Any) -> sp.Matrix:
    """(distance from the axis, distance from the equator), (2, 1), at a geodetic latitude and height.

    The point of the ellipse whose outward normal is n = (cos phi, sin phi) is k (a^2 cos phi, b^2 sin phi):
    the gradient there, 2 k n, points along n. Being on the ellipse fixes k^2 (a^2 cos^2 + b^2 sin^2) = 1.
    """
    normal = outward_normal(latitude)
    k = 1 / (a * surface_root(latitude, e))
    on_ellipse = sp.Matrix([k * a**2 * normal[0], k * a**2 * (1 - e**2) * normal[1]])
    return on_ellipse + height * normal


def ellipse_condition(latitude: Any, a: Any, e: Any) -> sp.Expr:
    """x^2/a^2 + z^2/b^2 at :func:`meridian_point` of height zero; one when the point is on the ellipse."""
    x, z = meridian_point(latitude, 0, a, e)
    return x**2 / a**2 + z**2 / (a**2 * (1 - e**2))


def outward_normal(latitude: Any) -> sp.Matrix:
    """Unit vector at an angle from the equator in the meridian plane, (2, 1)."""
    return sp.Matrix([sp.cos(latitude), sp.sin(latitude)])


def northward(latitude: Any) -> sp.Matrix:
    """Unit vector towards north, at right angles to :func:`outward_normal`, (2, 1)."""
    return sp.Matrix([-sp.sin(latitude), sp.cos(latitude)])


def trihedron_turn(geodetic: Any, geocentric: Any) -> sp.Matrix:
    """Rotation (3, 3) from geocentric to geodetic East-North-Up, by scalar products of the axes.

    East is common; row and column 1 and 2 are North and Up.
    """
    new = (northward(geodetic), outward_normal(geodetic))
    old = (northward(geocentric), outward_normal(geocentric))
    block = sp.Matrix(2, 2, lambda i, j: sp.expand(new[i].dot(old[j])))
    return sp.diag(1, block)


def spherical_axes(latitude: Any, longitude: Any) -> sp.Matrix:
    """Rows East, North, Up of the geocentric trihedron in Earth-fixed axes, (3, 3)."""
    sin, cos = sp.sin, sp.cos
    return sp.Matrix(
        [
            [-sin(longitude), cos(longitude), 0],
            [-sin(latitude) * cos(longitude), -sin(latitude) * sin(longitude), cos(latitude)],
            [cos(latitude) * cos(longitude), cos(latitude) * sin(longitude), sin(latitude)],
        ]
    )  # fmt: skip


def spherical_position(latitude: Any, longitude: Any, radius: Any) -> sp.Matrix:
    """Earth-fixed Cartesian position, (3, 1)."""
    return radius * spherical_axes(latitude, longitude)[2, :].T


def moving_position() -> tuple[sp.Matrix, dict[str, sp.Symbol], sp.Matrix]:
    """Position, its symbols, and its velocity by the chain rule, resolved in East, North, Up.

    Symbols: latitude, longitude, radius, and their rates ``latitude_rate`` and so on.
    """
    names = ("latitude", "longitude", "radius")
    symbols = {name: sp.Symbol(name, real=True) for name in (*names, *(f"{x}_rate" for x in names))}
    position = spherical_position(*(symbols[x] for x in names))
    velocity = sp.zeros(3, 1)
    for x in names:
        velocity += position.diff(symbols[x]) * symbols[f"{x}_rate"]
    axes = spherical_axes(symbols["latitude"], symbols["longitude"])
    return position, symbols, axes * velocity


def angular_velocity(symbols: dict[str, sp.Symbol]) -> sp.Matrix:
    """Rate of turn of the geocentric trihedron relative to the Earth, on its own axes, (3, 1).

    For rows of axes M with dM/dt = -[omega x] M: the skew matrix is read off -(dM/dt) M^T.
    """
    latitude, longitude = symbols["latitude"], symbols["longitude"]
    axes = spherical_axes(latitude, longitude)
    rate = axes.diff(latitude) * symbols["latitude_rate"] + axes.diff(longitude) * symbols["longitude_rate"]
    skew = -rate * axes.T
    return sp.Matrix([skew[2, 1], skew[0, 2], skew[1, 0]])


def cross(omega: sp.Matrix, r: sp.Matrix) -> sp.Matrix:
    """sum over k, j of e_ikj omega_k r_j, (3, 1), written out with the Levi-Civita symbol."""
    return sp.Matrix(
        3, 1, lambda i, _: sum(sp.LeviCivita(i, k, j) * omega[k] * r[j] for k in range(3) for j in range(3))
    )


# Positions on WGS-84 as numbers: Earth-fixed Cartesian coordinates and local East-North-Up axes.
#
# Angles in radians, lengths in metres. Cartesian coordinates have no trouble at poles and at the 180th
# meridian, which is why tracks are differentiated there and only the result is turned to East, North, Up.


Array = NDArray[np.float64]
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


def pascal_rows(n: int) -> list[list[int]]:
    """Phi_f as exact numbers: the binomial coefficient (j-1 over i-1), i, j = 1..n."""
    need_order(n)
    return [[math.comb(j, i) for j in range(n)] for i in range(n)]
