"""Section 2, (2.1)-(2.5): error equations and corrections from the kinematics of small rotations.

The derived sides come from ``navsym_papers.joint_correction.kinematics``: Poisson's equation linearised,
Newton's equation solved for the rates, the velocity seen in platform axes. Terms of order
mu^2 rho are dropped, and :func:`dropped_terms` says which.
"""

import re
from functools import cache

import sympy as sp

from navsym.claims import CERTIFIED, PROVED, Bound, Equation, claim, claims, fact, state
from navsym.language.expression import to_text
from navsym_papers.joint_correction import kinematics
from navsym_papers.joint_correction.inertial import PHYSICAL_ORDERS, monomial_order, say_orders, truncate

mu = sp.Symbol("mu", positive=True)
sine = sp.Symbol("s", real=True)

a1, a2, a3 = kinematics.ALPHA
b1, b2, b3 = kinematics.BETA
p1, p2 = kinematics.DELTA_P
v1, v2, v3 = kinematics.NU_X
e1, e2 = kinematics.EPSILON
w1, w2 = kinematics.OMEGA_X[:2]
u1, u2, u3 = kinematics.EARTH_X
w0 = kinematics.SCHULER


@cache
def equations() -> kinematics.ErrorEquations:
    return kinematics.error_equations()


def kept(symbol: sp.Symbol) -> sp.Expr:
    """The derivative of an error variable without its terms of order mu^2 rho."""
    return truncate(equations().rates[symbol], PHYSICAL_ORDERS, 2).kept


CLAIMS_2_1 = claims(
    "2.1 | The rates of alpha_1, alpha_2, dp_1, dp_2 up to terms of order mu^2 rho.",
    lambda: Equation(
        [p1 + v1, p2 + v2, -(w0**2) * (a1 + e2) - w2 * v3, -(w0**2) * (a2 - e1) + w1 * v3],
        [kept(symbol) for symbol in (a1, a2, p1, p2)],
    ),
    "2.1.dropped | (2.1) leaves out omega_x1 (omega_x1 alpha_1 + omega_x2 alpha_2) and its like, and nothing else.",
    lambda: Equation(
        [w1 * (w1 * a1 + w2 * a2), w2 * (w1 * a1 + w2 * a2)], [equations().rates[p] - kept(p) for p in (p1, p2)]
    ),
)


@claim("2.1.climb | A climb below 0.1 a max|omega| adds only terms of order mu^2 rho to (2.1) and (2.4).")
def climb_is_negligible():
    climbing = kinematics.error_equations(kinematics.CLIMB)
    values = [climbing.rates[p] - equations().rates[p] for p in (p1, p2)]
    values += [c - e for c, e in zip(climbing.velocity, equations().velocity, strict=True)]
    orders = tuple(truncate(sp.expand(value), PHYSICAL_ORDERS, 2).kept == 0 for value in values)
    method = "orders of all added terms, climb/(a omega_0) counted as mu^2"
    terms = [term for value in values for term in sp.Add.make_args(sp.expand(value)) if term != 0]
    meaning = [say_orders([(term, monomial_order(term, PHYSICAL_ORDERS)) for term in terms], PHYSICAL_ORDERS, 2)]
    scope = "linear in the errors, alpha_3 up to rho/mu"
    return fact((True,) * 4, orders, method, PROVED, scope=scope, meaning=meaning)


@claim("2.condition2.height")
def height_is_negligible():
    """A height of at most e^2 a changes omega_0^2, as 1/r^3, by less than 0.02: of the order mu^2 where mu is 0.1."""
    flattening = sp.Rational(10, 2983)
    eccentricity = 2 * flattening - flattening**2
    x = sp.Symbol("x", real=True)  # height over a
    return Bound(1 - (1 + x) ** -3, "<", sp.Rational(1, 50), {x: (0, eccentricity)})


def turn_of_the_computed_frame() -> sp.Matrix:
    """gamma' for a frame that turns with the computed rate, with gamma = alpha - beta put in."""
    from navsym_papers.joint_correction.kinematics import horizontal, rotation_rate

    gamma = sp.Matrix(sp.symbols("gamma_1:4", real=True))
    computed = sp.Matrix([*(kinematics.DELTA_P - horizontal(kinematics.ALPHA.cross(kinematics.OMEGA_X))), 0])
    return rotation_rate(gamma, computed, kinematics.OMEGA_X).subs(
        dict(zip(gamma, kinematics.ALPHA - kinematics.BETA, strict=True))
    )


# Assumptions of the section, with numbers

EARTH_RATE = sp.Rational(7292115, 10**11)  # 1/s
EARTH_RADIUS = sp.Integer(6378137)  # m
GRAVITY = sp.Rational(980665, 100000)  # m/s^2
SCHULER_RATE = sp.sqrt(GRAVITY / EARTH_RADIUS)  # 1/s


def degree(expression: sp.Expr) -> sp.Expr:
    """Power of 1/s of an expression in rates (1/s) and their derivatives, from f(2 omega)/f(omega)."""
    doubled = {w1: 2 * w1, w2: 2 * w2, **{rate: 4 * rate for rate in kinematics.OMEGA_X_RATE[:2]}}
    ratio = sp.cancel((expression**2).subs(doubled, simultaneous=True) / expression**2)
    return sp.Rational(int(ratio).bit_length() - 1, 2)


RATE = sp.sqrt(w1**2 + w2**2)
TURN = sum(sp.diff(RATE, w) * dw for w, dw in zip((w1, w2), kinematics.OMEGA_X_RATE[:2], strict=True))


def say_units(left: sp.Expr, right: sp.Expr) -> tuple[dict]:
    """Both sides, squared, change by one factor where seconds are divided by k: their units have one power of 1/s."""
    powers = {w1.name: 1, w2.name: 1, **{rate.name: 2 for rate in kinematics.OMEGA_X_RATE[:2]}}
    texts = [to_text(sp.cancel(side**2)) for side in (left, right)]
    scaled = [re.sub(r"\b[A-Za-z]\w*", lambda name: f"({name[0]}*k**{powers[name[0]]})", text) for text in texts]
    symbols = {name: ["0", None, ["open-low"]] for name in sorted(powers) if any(name in text for text in texts)}
    sides = [f"({new})/({old})" for new, old in zip(scaled, texts, strict=True)]
    return (state(sides[0], "=", sides[1], symbols | {"k": ["1", None, ["open-low"]]}),)


def squared_rate(speed: sp.Expr, course: sp.Expr, place: sp.Expr) -> sp.Expr:
    """omega^2 of :func:`stationarity`."""
    return speed**2 + 2 * speed * course + course**2 + (1 - course**2) * place


def stationarity(speed: sp.Expr, course: sp.Expr, place: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Both sides, squared and freed of the divisor, of the stationarity condition on a great circle.

    In units of the Earth rate: speed = v/(Omega R); course = cos(latitude) sin(heading), constant on the
    circle (Clairaut); cos^2(latitude) = course^2 + (1 - course^2) place with 0 <= place <= 1. Then
    omega^2 = speed^2 + 2 speed course + cos^2(latitude), and its largest value is at the equator.
    """
    largest = squared_rate(speed, course, sp.S.One)
    left = (1 - course**2) ** 2 * place * (1 - place) * speed**2
    return left, largest**2 * squared_rate(speed, course, place)


CLAIMS_2_2 = claims(
    "2.2.beta1 | beta_1' = -omega_x2 beta_3 + nu_x1.",
    lambda: Equation(-w2 * b3 + v1, equations().rates[b1]),
    "2.2.beta2 | beta_2' = omega_x1 beta_3 + nu_x2.",
    lambda: Equation(w1 * b3 + v2, equations().rates[b2]),
    "2.2.beta3 | beta_3' = omega_x2 beta_1 - omega_x2 beta_2 + nu_x3, as printed. | undecidable: index 2 for 1 in "
    "the second term: beta x omega has -omega_x1 beta_2, and the paper's own (2.8) for x_3 follows only with "
    "omega_x1; by hand: omega_x1 = beta_2 = 1, all others 0: the platform turns at -1, the print has 0",
    lambda: Equation(w2 * b1 - w2 * b2 + v3, equations().rates[b3]),
    "2.2.beta3* | beta_3' = omega_x2 beta_1 - omega_x1 beta_2 + nu_x3.",
    lambda: Equation(w2 * b1 - w1 * b2 + v3, equations().rates[b3]),
    "2.3 | gamma = alpha - beta is the turn from Mx to Mu: Poisson's equation gives the derivatives of gamma_1, "
    "gamma_2.",
    lambda: Equation(
        [equations().rates[a] - equations().rates[b] for a, b in ((a1, b1), (a2, b2))],
        list(turn_of_the_computed_frame()[:2]),
    ),
    "2.4 | The velocity correction sigma_x1^c, sigma_x2^c.",
    lambda: Equation(
        [p1 + u3 * a2 + u2 * b3 - u3 * b2 + kinematics.W_C[0], p2 - u3 * a1 + u3 * b1 - u1 * b3 + kinematics.W_C[1]],
        equations().velocity,
    ),
    # Both sides have one unit.
    "2.assumption1.units | (omega_x1^2 + omega_x2^2)^(1/2) < max(omega_x1^2 + omega_x2^2), as printed. | scan: a "
    "rate (1/s) is compared with a squared rate (1/s^2); the dot of the derivative over the root is lost, as are "
    "the dots in (2.9) and (3.3); by hand: in minutes the left side is 60 times larger, the right one 3600 times",
    lambda: fact(
        degree(RATE**2),
        degree(RATE),
        "powers of 1/s on the right and on the left side",
        PROVED,
        meaning=say_units(RATE, RATE**2),
    ),
    "2.assumption1.units* | |d/dt (omega_x1^2 + omega_x2^2)^(1/2)| < max(omega_x1^2 + omega_x2^2): both sides in "
    "1/s^2.",
    lambda: fact(
        degree(RATE**2),
        degree(TURN),
        "powers of 1/s on the right and on the left side",
        PROVED,
        meaning=say_units(TURN, RATE**2),
    ),
)


@claim("2.assumption1.orthodrome", expect=CERTIFIED)
def great_circles_are_stationary():
    """In particular it holds on a great circle at constant speed (any course, up to 250 m/s over the ground).

    Read with the derivative on the left (2.assumption1.units*), for the aeroplanes that the paper has in mind.
    (1 - c^2) s^2 < (s^2 + 2 s c + 1)^2 is sufficient: the left side of :func:`stationarity` is at most
    (1 - c^2)^2 place s^2 and its right side at least (s^2 + 2 s c + 1)^2 (1 - c^2) place.
    """
    s, course = sp.symbols("s c", real=True)
    return Bound(
        (1 - course**2) * s**2, "<", (s**2 + 2 * s * course + 1) ** 2, {s: (0, sp.Rational(54, 100)), course: (-1, 1)}
    )


@claim("2.assumption1.orthodrome.limit")
def where_great_circles_are_not_stationary():
    """Not at every speed: westward at 419 m/s, near that of the ground below, the same condition fails."""
    point = (sp.Rational(9, 10), sp.Rational(-99, 100), sp.Rational(1, 2))
    left, right = stationarity(*point)
    scope = "speed 0.9 Omega R = 419 m/s, course constant -0.99"
    place = sp.Symbol("place", real=True)
    sides = [to_text(squared_rate(*point[:2], where)) for where in (place, sp.S.One)]
    meaning = [state(str(left), ">=", str(right)), state(sides[0], "<=", sides[1], {"place": ["0", "1", []]})]
    return fact(False, bool(left < right), "exact values at one flight", PROVED, scope=scope, meaning=meaning)


@claim("2.assumption1.orthodrome.much", expect=CERTIFIED)
def great_circles_are_not_always_much_below():
    """Read with <<: at 250 m/s, course constant -0.538, a thousandth beside the vertex, left over right is 0.637."""
    left, right = stationarity(250 / (EARTH_RATE * EARTH_RADIUS), sp.Rational(-538, 1000), sp.Rational(1, 1000))
    return Equation(sp.Rational(637, 1000), sp.sqrt(left / right), tolerance=sp.Rational(1, 2000))


@claim("2.scale.mu | mu <= 0.1 for every latitude and heading up to 250 m/s. | CERTIFIED")
def mu_is_small():
    v, sine, cosine = sp.symbols("v s c", real=True)
    square = v**2 / EARTH_RADIUS**2 + 2 * v * sine * EARTH_RATE * cosine / EARTH_RADIUS + EARTH_RATE**2 * cosine**2
    return Bound(
        square * EARTH_RADIUS / GRAVITY, "<=", sp.Rational(1, 100), {v: (0, 250), sine: (-1, 1), cosine: (0, 1)}
    )


CLAIMS_2 = claims(
    "2.scale.tau_low | Thirty minutes are more than one in dimensionless time.",
    lambda: Bound(sp.Integer(1), "<", 1800 * SCHULER_RATE),
    "2.scale.tau_high | Thirty minutes are less than three in dimensionless time.",
    lambda: Bound(sp.Integer(3), ">", 1800 * SCHULER_RATE),
    "2.scale.period | tau_h <= 3 is at most a twentieth of the period 2 pi/mu of the motion, for mu from 0.001 to "
    "0.1. | CERTIFIED",
    lambda: Bound(sp.Integer(60), "<", 2 * sp.pi / mu, {mu: (sp.Rational(1, 1000), sp.Rational(1, 10))}),
    "2.scale.earth | u = Omega/(mu omega_0), mu the largest rate over all headings, is in (1/2, 1) at 45 degrees "
    "and 250 m/s.",
    lambda: Bound(
        (EARTH_RATE / (EARTH_RATE * sp.sqrt(2) / 2 + sp.Rational(250, EARTH_RADIUS)) - sp.Rational(1, 2))
        * (1 - EARTH_RATE / (EARTH_RATE * sp.sqrt(2) / 2 + sp.Rational(250, EARTH_RADIUS))),
        ">",
        0,
    ),
    "2.scale.mu_u3 | |mu u_3| = Omega |sin(latitude)|/omega_0 is at most 0.06, far from 1, where (2.8) breaks.",
    lambda: Bound(sine**2 * EARTH_RATE**2 * EARTH_RADIUS / GRAVITY, "<=", sp.Rational(6, 100) ** 2, {sine: (-1, 1)}),
)
