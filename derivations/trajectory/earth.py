"""Basic model notions: latitudes, radius, two trihedra, rates and velocity of the moving trihedron."""

import sympy as sp

from navsym.claims import Equation, claim, claims
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


def geocentric_tangent():
    axis, z = ellipsoid.meridian_point(phi_e, h, a, e)
    return z / axis


CLAIMS_EARTH = claims(
    "earth.ellipse | The foot of the normal is on the meridian ellipse, e from 0.01 to 0.9, latitudes to 1.5 rad.",
    lambda: Equation(sp.Integer(1), ellipsoid.ellipse_condition(phi_e, a, e), ELLIPSOID),
    "earth.tan_phi | Tangent of the geocentric latitude, as printed. | undecidable: the exponent of e is lost: at "
    "h = 0 the factor has to be 1 - e^2, as in the printed radius two lines below; by hand: for e = 0.082 the "
    "factor 0.918 stands for 0.9933",
    lambda: Equation((1 - a * e / (a + h * ROOT)) * sp.tan(phi_e), geocentric_tangent(), ELLIPSOID),
    "earth.tan_phi* | Tangent of the geocentric latitude, to 1.5 rad; e from 0.01 to 0.9, a from 1 to 10, h to 10.",
    lambda: Equation((1 - a * e**2 / (a + h * ROOT)) * sp.tan(phi_e), geocentric_tangent(), ELLIPSOID),
)


@claim(
    "earth.r | Distance from the centre, squared: latitudes to 1.5 rad, e from 0.01 to 0.9, a from 1 to 10, h to 10."
)
def geocentric_radius():
    inner = (a / ROOT + h) ** 2 * sp.cos(phi_e) ** 2 + (a * (1 - e**2) / ROOT + h) ** 2 * sp.sin(phi_e) ** 2
    axis, z = ellipsoid.meridian_point(phi_e, h, a, e)
    # Lengths are equal when their squares are; the root of the sum would hide the angle from the prover.
    return Equation(inner, axis**2 + z**2, ELLIPSOID)


# -- two trihedra ----------------------------------------------------------------------------------


def turned(row: int) -> sp.Expr:
    return (ellipsoid.trihedron_turn(phi_e, phi) * sp.Matrix(xi))[row]


CLAIMS_EARTH_2 = claims(
    "earth.rotation.xi1 | East axes of the geodetic and the geocentric trihedron.",
    lambda: Equation(xi[0], turned(0)),
    "earth.rotation.xi2 | North component in the geodetic trihedron.",
    lambda: Equation(sp.cos(phi_e - phi) * xi[1] - sp.sin(phi_e - phi) * xi[2], turned(1)),
    "earth.rotation.xi3 | Component along the normal to the ellipsoid.",
    lambda: Equation(sp.sin(phi_e - phi) * xi[1] + sp.cos(phi_e - phi) * xi[2], turned(2)),
)


@claim("earth.rotation.orthogonal | The transformation between the trihedra is orthogonal and keeps orientation.")
def rotation_is_orthogonal():
    turn = ellipsoid.trihedron_turn(phi_e, phi)
    return Equation([*sp.eye(3), sp.Integer(1)], [*(turn * turn.T), turn.det()])


# -- rates and velocity ----------------------------------------------------------------------------

POSITION, MOVING, VELOCITY = ellipsoid.moving_position()
LATITUDE, RADIUS = MOVING["latitude"], MOVING["radius"]
RATES = [MOVING["latitude_rate"], MOVING["longitude_rate"], MOVING["radius_rate"]]
OMEGA = sp.Matrix([-RATES[0], RATES[1] * sp.cos(LATITUDE), RATES[1] * sp.sin(LATITUDE)])
SHELL = {LATITUDE: LATITUDES, RADIUS: (sp.Integer(1), sp.Integer(10))}


def rates_from_velocity() -> list[sp.Expr]:
    """Latitude, longitude and radius rate as functions of the speeds V: the inverse of d V / d rates.

    Each speed contains one rate only, so the Jacobian has one entry in each row.
    """
    jacobian = sp.Matrix([sp.trigsimp(x) for x in VELOCITY.jacobian(RATES)]).reshape(3, 3)
    return list(jacobian.inv() * sp.Matrix(V))


def rotation_part() -> sp.Matrix:
    """e_ikj omega_k r_j."""
    return OMEGA.cross(sp.Matrix([0, 0, RADIUS]))


CLAIMS_KINEMATICS = claims(
    "kinematics.omega | Angular velocity of the geocentric trihedron relative to the Earth, on its own axes.",
    lambda: Equation(list(OMEGA), list(ellipsoid.angular_velocity(MOVING))),
    "kinematics.position | The position vector on the axes of the trihedron is (0, 0, r).",
    lambda: Equation(
        [sp.Integer(0), sp.Integer(0), RADIUS], list(ellipsoid.spherical_axes(LATITUDE, MOVING["longitude"]) * POSITION)
    ),
    "kinematics.velocity | Velocity as omega x r alone, as it came out of the scan. | scan: '= r_i' stands for '+ "
    "dr_i/dt': as printed the vertical speed vanishes, while dr/dt = V_3",
    lambda: Equation(list(rotation_part()), list(VELOCITY)),
    "kinematics.velocity* | Velocity relative to the Earth: omega x r plus the rate of (0, 0, r).",
    lambda: Equation(list(rotation_part() + sp.Matrix([0, 0, RATES[2]])), list(VELOCITY)),
    "kinematics.phi_rate | Rate of latitude: northern speed over radius, from 1 to 10 in any unit.",
    lambda: Equation(V[1] / RADIUS, rates_from_velocity()[0], SHELL),
    "kinematics.lambda_rate | Rate of longitude with the cosine as a factor, as it came out of the scan. | scan: "
    "cos phi is to the power -1; the lost exponent reappears as the stray minus sign of the printed rho^(2), and "
    "kinematics.omega with V = omega x r gives V_1 = r cos(phi) d lambda/dt; by hand: at 60 degrees the meridians "
    "pass twice as fast as at the equator, not half as fast",
    lambda: Equation(V[0] / RADIUS * sp.cos(LATITUDE), rates_from_velocity()[1], SHELL),
    "kinematics.lambda_rate* | Rate of longitude: eastern speed over r cos(phi), r from 1 to 10, latitudes to 1.5 rad.",
    lambda: Equation(V[0] / (RADIUS * sp.cos(LATITUDE)), rates_from_velocity()[1], SHELL),
    "kinematics.r_rate | Rate of the radius: vertical speed.",
    lambda: Equation(V[2], rates_from_velocity()[2], SHELL),
)


# -- the factor rho of each channel ------------------------------------------------------------------


def channel_factor(rate: int, speed: int) -> sp.Expr:
    """rho of a channel: how the rate of the coordinate depends on its speed."""
    return sp.diff(rates_from_velocity()[rate], V[speed])


CLAIMS_1 = claims(
    "1.rho1 | rho of the latitude channel, driven by the northern speed; radius from 1 to 10 in any unit.",
    lambda: Equation(1 / RADIUS, channel_factor(0, 1), SHELL),
    "1.rho2 | rho of the longitude channel, as it came out of the scan. | scan: the exponent -1 of cos phi was "
    "read as a minus sign of the numerator: the printed rate of longitude, two paragraphs above, has no such sign; "
    "by hand: -1/r at the equator, for a speed to the east",
    lambda: Equation(-1 / RADIUS * sp.cos(LATITUDE), channel_factor(1, 0), SHELL),
    "1.rho2* | rho of the longitude channel, driven by the eastern speed; radius from 1 to 10, latitudes to 1.5 rad.",
    lambda: Equation(1 / (RADIUS * sp.cos(LATITUDE)), channel_factor(1, 0), SHELL),
    "1.rho3 | rho of the radius channel, driven by the vertical speed.",
    lambda: Equation(sp.Integer(1), channel_factor(2, 2), SHELL),
)
