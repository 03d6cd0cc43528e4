"""Equations (1)-(3): what sensor errors do to a reckoned position, and which errors grow."""

import re

import sympy as sp

from navsym.claims import PROVED, Bound, Equation, Finding, Property, claim, claims, fact, state
from navsym.language.expression import to_text
from navsym_papers.multistructure import model

RECKONING = model.dead_reckoning()
S = RECKONING.right_side()
scale = sp.Symbol("epsilon", real=True)
#: Unit speed on the unit sphere.
UNIT = {model.vy: 1, model.vx: 0, model.height: 0, model.radius: 1}
#: The whole sphere but the poles, at heights above its centre.
SPHERE = {model.latitude: (sp.Rational(-3, 2), sp.Rational(3, 2)), model.height: (0, None)}


@claim("1.nonlinear | The errors of reckoned coordinates depend on the sensor errors in a nonlinear way.")
def nonlinear():
    point = UNIT | {model.latitude: 0, model.heading: 0}
    at_rest = dict.fromkeys((*RECKONING.errors, *RECKONING.sensor_errors), 0)
    curvature = S.diff(model.d_heading, 2).subs(at_rest)[0].subs(point)
    scope, evidence = "course and log on a sphere", f"d2S/dK2 = {curvature} at the equator, heading north at unit speed"
    found = Finding(bool(curvature != 0), "second derivative at an exact point", PROVED, scope=scope, evidence=evidence)
    return Property(True, found, (changes_at(S[0], model.d_heading, 2, at_rest | point),))


def changes_at(formula: sp.Expr, variable: sp.Symbol, order: int, point: dict) -> dict:
    """That a derivative is not zero at a point, in the words of the checker."""
    ranges = {symbol: [to_text(sp.sympify(value))] * 2 + [[]] for symbol, value in point.items()}
    symbols = {symbol.name: ranges[symbol] for symbol in {*formula.free_symbols, variable}}
    return state(f"diff({to_text(formula)}, {variable.name}, {order})", "!=", "0", symbols)


@claim("1.arguments")
def arguments_corrected():
    """(1): S is a function of coordinates, their errors, sensor errors and readings, and of nothing else."""
    known = {*RECKONING.reckoned, *RECKONING.errors, *RECKONING.sensor_errors, *RECKONING.readings, model.radius}
    method, scope = "free symbols of the derived right side", "course and log on a sphere"
    symbols = {s.name: [None, None, []] for s in {*S.free_symbols, sp.Symbol("z")}}
    # z is anything else
    meaning = [state(f"diff({to_text(rate)}, z)", "=", "0", symbols) for rate in S]
    return fact(True, S.free_symbols <= known, method, PROVED, scope=scope, meaning=meaning)


@claim("3 | (3), latitudes to 1.5 rad: with S1, S2 differentiated by hand, S1 dpsi + S2 d is the linear part of S.")
def linearised():
    errors = (*RECKONING.errors, *RECKONING.sensor_errors)
    along = S.subs({e: scale * e for e in errors}, simultaneous=True)
    k, p, v, u, r = model.heading, model.latitude, model.vy, model.vx, model.radius + model.height
    north, east = v * sp.cos(k) - u * sp.sin(k), v * sp.sin(k) + u * sp.cos(k)
    by_hand = sp.Matrix(
        [
            [0, 0, sp.cos(k) / r, -sp.sin(k) / r, -east / r, -north / r**2],
            [
                east * sp.sin(p) / (r * sp.cos(p) ** 2),
                0,
                sp.sin(k) / (r * sp.cos(p)),
                sp.cos(k) / (r * sp.cos(p)),
                north / (r * sp.cos(p)),
                -east / (r**2 * sp.cos(p)),
            ],
        ]
    )
    return Equation(by_hand * sp.Matrix(errors), along.diff(scale).subs(scale, 0), SPHERE)


@claim("3.time | (3): S1 and S2 depend on the coordinates, hence on time.")
def unsteady():
    S1, S2 = RECKONING.linear_parts()
    point = UNIT | {model.latitude: sp.pi / 4, model.heading: sp.pi / 2}
    # at one radian, a rational point
    rational = point | {model.latitude: 1, model.heading: 1}
    meaning = tuple(changes_at(part[1, 0], model.latitude, 1, rational) for part in (S1, S2))
    slopes = [S1.diff(model.latitude)[1, 0].subs(point), S2.diff(model.latitude)[1, 0].subs(point)]
    method = "derivative by latitude at an exact point"
    scope = "course and log on a sphere"
    evidence = f"dS1/dphi = {slopes[0]}, dS2/dphi = {slopes[1]} at 45 degrees, heading east"
    return fact(
        True, all(bool(slope != 0) for slope in slopes), method, PROVED, scope=scope, evidence=evidence, meaning=meaning
    )


@claim(
    "2.form | (2), to 1.5 rad of latitude: that error obeys (2); to first order the other adds only a latitude term."
)
def feedback():
    S1, S2 = RECKONING.linear_parts()
    sensors = S2 * sp.Matrix(RECKONING.sensor_errors)
    east = model.vy * sp.sin(model.heading) + model.vx * sp.cos(model.heading)
    lever = east * sp.tan(model.latitude) / ((model.radius + model.height) * sp.cos(model.latitude))
    linear = S1 * sp.Matrix(RECKONING.errors) + sensors
    return Equation(
        [S[0].subs(dict.fromkeys(RECKONING.errors, 0)), sensors[1] + lever * model.d_latitude],
        [S[0], linear[1]],
        SPHERE,
    )


def discretised(S1, step):
    """exp(S1 step): the series ends where a power of S1 vanishes, which is checked."""
    if any(entry != 0 for entry in S1 * S1):
        raise ValueError("S1 is not nilpotent of order two")
    return sp.eye(S1.rows) + S1 * step


tau = sp.Symbol("tau", positive=True)


f, df, tilt = sp.symbols("f Deltaf beta", real=True)
gravity = sp.Symbol("g", positive=True)


def inertial_rate():
    """Rate of the velocity error of one horizontal axis: the reading taken as it is, less what truly accelerates.

    A platform tilted by beta carries an accelerometer that reads f = a cos(beta) + g sin(beta) + df.
    """
    true = (f - df - gravity * sp.sin(tilt)) / sp.cos(tilt)
    return f - true


FREE = [None, None, []]


CLAIMS_4 = claims(
    "4.type | (4): the models that (4) switches between are of type (2) (course and log, one step). | undecidable: "
    "below (5) the models of (4) are said to be of type (2), but (2) without position errors on the right gives "
    "the identity for their block of A; it is (3) that (4) samples; by hand: due east at 45 degrees with v tau = R "
    "the entry below the diagonal is sqrt(2), not 0",
    lambda: Equation(sp.eye(2), discretised(RECKONING.linear_parts()[0], tau), SPHERE),
    "4.type* | (4), to 1.5 rad of latitude: its models are of type (3): A = exp(S1 tau) for the position errors.",
    lambda: Equation(
        sp.Matrix(
            [
                [1, 0],
                [
                    (
                        (model.vy * sp.sin(model.heading) + model.vx * sp.cos(model.heading))
                        * sp.tan(model.latitude)
                        / ((model.radius + model.height) * sp.cos(model.latitude))
                    )
                    * tau,
                    1,
                ],
            ]
        ),
        discretised(RECKONING.linear_parts()[0], tau),
        SPHERE,
    ),
)


@claim("1.inertial")
def inertial_is_nonlinear():
    """Below (1): one axis of an inertial system obeys an equation of type (1), nonlinear in tilt, 0 without errors."""
    rate = inertial_rate()
    at_rest = {tilt: 0, df: 0}
    level = re.sub(rf"\b({tilt}|{df})\b", "0", to_text(rate))
    curvature = rate.diff(tilt, 2).subs(at_rest).subs({f: 1, gravity: 10})
    return fact(
        (0, True),
        (int(rate.subs(at_rest)), bool(curvature != 0)),
        "value, second derivative at a point",
        PROVED,
        scope="one horizontal axis, a tilted platform",
        evidence=f"d2S/dbeta2 = {curvature} at f = 1",
        meaning=(
            state(level, "=", "0", {s.name: FREE for s in (f, gravity)}),
            changes_at(rate, tilt, 2, {tilt: 0, df: 0, f: 1, gravity: 10}),
        ),
    )


def sensor_part() -> sp.Matrix:
    """S2 of (3), (2, 4)."""
    return RECKONING.linear_parts()[1]


CLAIMS_3 = claims(
    "3.inertial | (3) for one inertial axis: the velocity error grows with the accelerometer error plus g times "
    "the tilt.",
    lambda: Equation(df + gravity * tilt, sum(inertial_rate().diff(s).subs({tilt: 0, df: 0}) * s for s in (tilt, df))),
)


@claim(
    "2.growth.every | Below (2), for every course: after a turn at constant rate a constant sensor error is left in "
    "the latitude. | paper: true on straight courses; on a circle the rate turns with the course, its mean is zero, "
    "the error of the latitude comes back; by hand: the integral of cos over a whole turn is 0"
)
def every_sensor_error_grows_on_every_course():
    rates = sensor_part().row(0).subs(UNIT)
    over_turn = [sp.integrate(rate, (model.heading, 0, 2 * sp.pi)) for rate in rates]
    return Bound(sum(value**2 for value in over_turn), ">", sp.Integer(0))


@claim("2.growth.every*")
def every_sensor_error_grows_on_a_straight_course():
    """Below (2): on a straight course at the speed v sensor errors displace at 1, 1, v and v/(R + h) times them.

    These are the sensors in the order of (1). What displaces is (R + h) (dphi, cos(phi) dlambda), from zero.
    """
    r, v, S2 = model.radius + model.height, sp.sqrt(model.vy**2 + model.vx**2), sensor_part()
    north, east = r * S2.row(0), r * sp.cos(model.latitude) * S2.row(1)
    return Equation([1, 1, v**2, v**2 / r**2], [a**2 + b**2 for a, b in zip(north, east, strict=True)], SPHERE)


t, drift = sp.symbols("t epsilon_p", real=True)
rate = sp.Symbol("Omega", positive=True)


@claim("2.growth | (2), due north: a constant error of the speed lets the latitude error grow in proportion to time.")
def growth():
    north = {model.d_heading: 0, model.d_height: 0, model.d_vx: 0, model.heading: 0, model.vx: 0}
    printed = model.d_vy * t / (model.radius + model.height)
    return Equation([printed.diff(t), printed.subs(t, 0)], [S[0].subs(north), 0], SPHERE)


def platform():
    """Misalignment of a platform with constant drifts, from zero, axis 0 along the Earth's axis.

    d psi/dt = A psi + d with A = -Omega x; since A^3 = -Omega^2 A the exponential ends after A^2 and
    psi = (t + (1 - cos Omega t)/Omega^2 A + (Omega t - sin Omega t)/Omega^3 A^2) d.
    """
    A = sp.Matrix([[0, 0, 0], [0, 0, rate], [0, -rate, 0]])
    drifts = sp.Matrix([drift, *sp.symbols("epsilon_1 epsilon_2", real=True)])
    phase = rate * t
    integral = t * sp.eye(3) + (1 - sp.cos(phase)) / rate**2 * A + (phase - sp.sin(phase)) / rate**3 * A * A
    return A, integral * drifts, drifts


@claim("2.drift.equation")
def drift_equation():
    """Misalignment under constant drift: the closed form solves d psi/dt = -Omega x psi + drift from zero."""
    A, psi, drifts = platform()
    return Equation([*(A * psi + drifts), 0, 0, 0], [*psi.diff(t), *psi.subs(t, 0)])


@claim("2.drift.polar")
def drift_about_the_axis():
    """Gyro drift about the Earth's axis accumulates: the misalignment about it grows in proportion to time."""
    _, psi, _ = platform()
    return Equation(drift * t, psi[0])


@claim("2.drift.across")
def drift_across_the_axis():
    """Gyro drift across the Earth's axis does not accumulate: (2 drift/Omega) |sin(Omega t/2)| at all times."""
    _, psi, drifts = platform()
    across = drifts[1] ** 2 + drifts[2] ** 2
    return Equation(4 * across * sp.sin(rate * t / 2) ** 2 / rate**2, psi[1] ** 2 + psi[2] ** 2)
