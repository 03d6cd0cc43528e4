"""The Earth as an ellipsoid of revolution in symbols, and how a trihedron moves over it.

Everything starts from the meridian ellipse x^2/a^2 + z^2/b^2 = 1 with b^2 = a^2 (1 - e^2) and from the Cartesian
position; latitudes, radii, rotations and rates are derived by differentiation and scalar products. Source of the
subject: Andreev, Theory of Inertial Navigation. Conventions: East, North, Up, right-handed.
"""

from typing import Any

import sympy as sp


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
            [cos(latitude) * cos(longitude), cos(latitude) * sin(longitude), sin(latitude)]
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
