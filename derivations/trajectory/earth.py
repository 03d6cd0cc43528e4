"""Basic model notions: latitudes, radius, two trihedra, rates and velocity of the moving trihedron."""

from __future__ import annotations

import sympy as sp

from navsym.claims import REFUTED, Equation, claim
from navsym_papers.trajectory import ellipsoid

a = sp.Symbol("a", positive=True)  # semi-major axis
e = sp.Symbol("e", positive=True)  # eccentricity
h = sp.Symbol("h", nonnegative=True)  # height
phi_e, lambda_e = sp.symbols("phi_e lambda_e", real=True)  # geodetic latitude, longitude
phi = sp.Symbol("phi", real=True)  # geocentric latitude
xi = sp.symbols("xi1:4", real=True)  # a vector in the geocentric trihedron
V = sp.symbols("V1:4", real=True)  # East, North, Up speed

#: Away from the poles and from a point-like or flat Earth.
ELLIPSOID = {
    a: (sp.Integer(1), sp.Integer(10)),
    e: (sp.Rational(1, 100), sp.Rational(9, 10)),
    h: (sp.Integer(0), sp.Integer(10)),
    phi_e: (-sp.Rational(3, 2), sp.Rational(3, 2)),
}
LATITUDES = (-sp.Rational(3, 2), sp.Rational(3, 2))
ROOT = sp.sqrt(1 - e**2 * sp.sin(phi_e) ** 2)


# -- latitude, longitude, radius -------------------------------------------------------------------


@claim("earth.ellipse")
def reference_point_lies_on_the_ellipse():
    """The foot of the normal satisfies the equation of the meridian ellipse."""
    return Equation(printed=sp.Integer(1), derived=ellipsoid.ellipse_condition(phi_e, a, e), box=ELLIPSOID)


def geocentric_tangent():
    axis, z = ellipsoid.meridian_point(phi_e, h, a, e)
    return z / axis


@claim(
    "earth.tan_phi",
    expect=REFUTED,
    slip="scan",
    reason="the exponent of e is lost: at h = 0 the factor has to be 1 - e^2, as in the printed radius two lines "
    "below; by hand: for e = 0.082 the factor 0.918 stands for 0.9933",
)
def geocentric_latitude_printed():
    """Tangent of the geocentric latitude, as it came out of the scan."""
    printed = (1 - a * e / (a + h * ROOT)) * sp.tan(phi_e)
    return Equation(printed=printed, derived=geocentric_tangent(), box=ELLIPSOID)


@claim("earth.tan_phi*", corrects="earth.tan_phi")
def geocentric_latitude():
    """Tangent of the geocentric latitude."""
    printed = (1 - a * e**2 / (a + h * ROOT)) * sp.tan(phi_e)
    return Equation(printed=printed, derived=geocentric_tangent(), box=ELLIPSOID)


@claim("earth.r")
def geocentric_radius():
    """Distance from the centre of the Earth, squared; the printed root is the positive one."""
    inner = (a / ROOT + h) ** 2 * sp.cos(phi_e) ** 2 + (a * (1 - e**2) / ROOT + h) ** 2 * sp.sin(phi_e) ** 2
    axis, z = ellipsoid.meridian_point(phi_e, h, a, e)
    # Lengths are equal when their squares are; the root of the sum would hide the angle from the prover.
    return Equation(printed=inner, derived=axis**2 + z**2, box=ELLIPSOID)


# -- two trihedra ----------------------------------------------------------------------------------


def turned(row: int) -> sp.Expr:
    return (ellipsoid.trihedron_turn(phi_e, phi) * sp.Matrix(xi))[row]


@claim("earth.rotation.xi1")
def east_is_common():
    """East axes of the geodetic and the geocentric trihedron."""
    return Equation(printed=xi[0], derived=turned(0))


@claim("earth.rotation.xi2")
def geodetic_north():
    """North component in the geodetic trihedron."""
    printed = sp.cos(phi_e - phi) * xi[1] - sp.sin(phi_e - phi) * xi[2]
    return Equation(printed=printed, derived=turned(1))


@claim("earth.rotation.xi3")
def geodetic_up():
    """Component along the normal to the ellipsoid."""
    printed = sp.sin(phi_e - phi) * xi[1] + sp.cos(phi_e - phi) * xi[2]
    return Equation(printed=printed, derived=turned(2))


@claim("earth.rotation.orthogonal")
def rotation_is_orthogonal():
    """The transformation between the trihedra is orthogonal and keeps orientation."""
    turn = ellipsoid.trihedron_turn(phi_e, phi)
    return Equation(printed=[*sp.eye(3), sp.Integer(1)], derived=[*(turn * turn.T), turn.det()])


# -- rates and velocity ----------------------------------------------------------------------------

POSITION, MOVING, VELOCITY = ellipsoid.moving_position()
LATITUDE, RADIUS = MOVING["latitude"], MOVING["radius"]
RATES = [MOVING["latitude_rate"], MOVING["longitude_rate"], MOVING["radius_rate"]]
SHELL = {LATITUDE: LATITUDES, RADIUS: (sp.Integer(1), sp.Integer(10))}


def rates_from_velocity() -> list[sp.Expr]:
    """Latitude, longitude and radius rate as functions of the speeds V: the inverse of d V / d rates.

    Each speed contains one rate only, so the Jacobian has one entry in each row.
    """
    jacobian = sp.Matrix([sp.trigsimp(x) for x in VELOCITY.jacobian(RATES)]).reshape(3, 3)
    return list(jacobian.inv() * sp.Matrix(V))


@claim("kinematics.omega")
def angular_velocity_of_the_trihedron():
    """Angular velocity of the geocentric trihedron relative to the Earth, on its own axes."""
    printed = [-RATES[0], RATES[1] * sp.cos(LATITUDE), RATES[1] * sp.sin(LATITUDE)]
    return Equation(printed=printed, derived=list(ellipsoid.angular_velocity(MOVING)))


@claim("kinematics.position")
def position_on_own_axes():
    """The position vector on the axes of the trihedron is (0, 0, r)."""
    axes = ellipsoid.spherical_axes(LATITUDE, MOVING["longitude"])
    return Equation(printed=[sp.Integer(0), sp.Integer(0), RADIUS], derived=list(axes * POSITION))


def rotation_part() -> sp.Matrix:
    omega = sp.Matrix([-RATES[0], RATES[1] * sp.cos(LATITUDE), RATES[1] * sp.sin(LATITUDE)])
    return ellipsoid.cross(omega, sp.Matrix([0, 0, RADIUS]))


@claim(
    "kinematics.velocity",
    expect=REFUTED,
    slip="scan",
    reason="'= r_i' stands for '+ dr_i/dt': as printed the vertical speed vanishes, while dr/dt = V_3",
)
def velocity_printed():
    """Velocity as omega x r alone, as it came out of the scan."""
    return Equation(printed=list(rotation_part()), derived=list(VELOCITY))


@claim("kinematics.velocity*", corrects="kinematics.velocity")
def velocity():
    """Velocity relative to the Earth: omega x r plus the rate of (0, 0, r)."""
    return Equation(printed=list(rotation_part() + sp.Matrix([0, 0, RATES[2]])), derived=list(VELOCITY))


@claim("kinematics.phi_rate")
def latitude_rate():
    """Rate of latitude: northern speed over radius."""
    return Equation(printed=V[1] / RADIUS, derived=rates_from_velocity()[0], box=SHELL)


@claim(
    "kinematics.lambda_rate",
    expect=REFUTED,
    slip="scan",
    reason="cos phi is to the power -1; the lost exponent reappears as the stray minus sign of the printed rho^(2), "
    "and kinematics.omega with V = omega x r gives V_1 = r cos(phi) d lambda/dt; by hand: at 60 degrees the "
    "meridians pass twice as fast as at the equator, not half as fast",
)
def longitude_rate_printed():
    """Rate of longitude with the cosine as a factor, as it came out of the scan."""
    return Equation(printed=V[0] / RADIUS * sp.cos(LATITUDE), derived=rates_from_velocity()[1], box=SHELL)


@claim("kinematics.lambda_rate*", corrects="kinematics.lambda_rate")
def longitude_rate():
    """Rate of longitude: eastern speed over the radius of the parallel."""
    return Equation(printed=V[0] / (RADIUS * sp.cos(LATITUDE)), derived=rates_from_velocity()[1], box=SHELL)


@claim("kinematics.r_rate")
def radius_rate():
    """Rate of the radius: vertical speed."""
    return Equation(printed=V[2], derived=rates_from_velocity()[2], box=SHELL)


# -- the factor rho of each channel ------------------------------------------------------------------


def channel_factor(rate: int, speed: int) -> sp.Expr:
    """rho of a channel: how the rate of the coordinate depends on its speed."""
    return sp.diff(rates_from_velocity()[rate], V[speed])


@claim("1.rho1")
def latitude_factor():
    """rho of the latitude channel, driven by the northern speed."""
    return Equation(printed=1 / RADIUS, derived=channel_factor(0, 1), box=SHELL)


@claim(
    "1.rho2",
    expect=REFUTED,
    slip="scan",
    reason="the exponent -1 of cos phi was read as a minus sign of the numerator: the printed rate of longitude, "
    "two paragraphs above, has no such sign; by hand: -1/r at the equator, for a speed to the east",
)
def longitude_factor_printed():
    """rho of the longitude channel, as it came out of the scan."""
    return Equation(printed=-1 / RADIUS * sp.cos(LATITUDE), derived=channel_factor(1, 0), box=SHELL)


@claim("1.rho2*", corrects="1.rho2")
def longitude_factor():
    """rho of the longitude channel, driven by the eastern speed."""
    return Equation(printed=1 / (RADIUS * sp.cos(LATITUDE)), derived=channel_factor(1, 0), box=SHELL)


@claim("1.rho3")
def radius_factor():
    """rho of the radius channel, driven by the vertical speed."""
    return Equation(printed=sp.Integer(1), derived=channel_factor(2, 2), box=SHELL)
