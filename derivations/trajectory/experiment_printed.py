"""Conditions of the numerical experiment, and the printed errors with their units."""

from fractions import Fraction
from itertools import pairwise

import flint
import sympy as sp

from navsym.claims import CERTIFIED, PROVED, Equation, Finding, Property, claim, claims, fact, state
from navsym_papers.trajectory.experiment.stability import exact

x = sp.Symbol("x", real=True)
antiderivative = sp.Symbol("x", real=True) ** 3 / 3 / (2 * sp.sqrt(3))

RADIUS = Fraction(6371000)
TAU = Fraction(1, 5)


# -- conditions of the experiment ----------------------------------------------------------------------


CLAIMS_EXPERIMENT = claims(
    "experiment.sigma | An error uniform on [-sqrt(3), sqrt(3)] m has a standard deviation of 1 m.",
    lambda: Equation(
        sp.Integer(1),
        (sp.Symbol("x", real=True) ** 3 / 3 / (2 * sp.sqrt(3))).subs(sp.Symbol("x", real=True), sp.sqrt(3))
        - (sp.Symbol("x", real=True) ** 3 / 3 / (2 * sp.sqrt(3))).subs(sp.Symbol("x", real=True), -sp.sqrt(3)),
    ),
)


@claim("experiment.parts | The three parts [0, 1000), [1000, 2080], (2080, 3600] cover the run once.")
def three_parts_fill_the_run():
    parts = ((0, True, 1000, False), (1000, True, 2080, True), (2080, False, 3600, True))
    meets = all(left[2] == right[0] and left[3] != right[1] for left, right in pairwise(parts))
    found = (parts[0][0], parts[-1][2], meets)
    first, second, third = (
        "where(t < 1000, 1, 0)",
        "where(t >= 1000, where(t <= 2080, 1, 0), 0)",
        "where(t > 2080, 1, 0)",
    )
    meaning = (state(f"{first} + {second} + {third}", "=", "1", {"t": ["0", "3600", []]}),)
    return fact((0, 3600, True), found, "ends of the parts", PROVED, meaning=meaning)


CLAIMS_EXPERIMENT_2 = claims(
    "experiment.heading | The printed heading leaves the straight course by a jump of 5 cos(80°) degrees at 1000 "
    "and 2080 s: three periods.",
    lambda: Equation(
        [5 * sp.cos(4 * sp.pi / 9)] * 2 + [3],
        [*[5 * sp.cos(2 * sp.pi * sp.Integer(t) / 360) for t in (1000, 2080)], sp.Rational(2080 - 1000, 360)],
    ),
)


@claim("experiment.stop | Tuning stops at 168.8 s, a whole number of steps of 0.2 s.")
def tuning_stops_at_a_step():
    steps = Fraction("168.8") / TAU
    return fact(
        True,
        steps.denominator == 1,
        "exact division",
        PROVED,
        evidence=f"{steps} steps",
        meaning=(state("168.8/0.2", "=", str(round(steps))),),
    )


# -- printed errors of position ------------------------------------------------------------------------


def agreement(angle: str, half_angle: str, length: str, half_length: str, unit: str) -> Property:
    """That two rounded figures can belong to one error."""
    per_unit = exact(RADIUS) * (flint.arb.pi() / 180 if unit == "degree" else 1)
    low, high = (str(Fraction(angle) + sign * Fraction(half_angle)) for sign in (-1, 1))
    bottom, top = (str(Fraction(length) + sign * Fraction(half_length)) for sign in (-1, 1))
    metres = f"{RADIUS}*pi/180" if unit == "degree" else str(RADIUS)
    meaning = (state(f"({low})*{metres}", "<=", top), state(f"({high})*{metres}", ">=", bottom))
    return Property(True, agree(angle, half_angle, length, half_length, per_unit), meaning)


def agree(angle: str, half_angle: str, length: str, half_length: str, per_unit: flint.arb) -> Finding:
    """Whether two rounded figures can belong to one error: the ranges meet after conversion to metres."""
    low = exact(Fraction(angle) - Fraction(half_angle)) * per_unit
    high = exact(Fraction(angle) + Fraction(half_angle)) * per_unit
    bottom, top = (exact(Fraction(length) + sign * Fraction(half_length)) for sign in (-1, 1))
    apart, meet = bool(low > top) or bool(high < bottom), bool(low <= top) and bool(high >= bottom)
    assert apart != meet, "the ranges touch within the precision of the balls"
    evidence = f"angle gives {low.str(4, radius=False)} to {high.str(4, radius=False)} m"
    return Finding(meet, "ball arithmetic", CERTIFIED, scope="rounding ranges of both figures", evidence=evidence)


#: Speed, printed angle, printed length and what the angle is in radians, half a unit of the length, what is wrong.
POSITION_ERRORS = (
    (
        *(100, "1.2e-8", "0.06", "0.08", "0.005"),
        "1.2e-8 degrees are 1.3 mm; the unit is the radian, and even then it is 0.08 m (111.2 km to a degree)",
    ),
    *(
        (speed, "2.2e-8", "0.1", "0.1", "0.05", "2.2e-8 degrees are 2.4 mm; the unit is the radian")
        for speed in (2, 300)
    ),
)
AGREEMENTS = tuple(
    claim(
        f"experiment.sigma_phi.{speed}{star}",
        f"|V| = {speed} m/s: {angle} {unit}s are {length} m.",
        lambda angle=angle, length=length, half=half, unit=unit: agreement(angle, "0.05e-8", length, half, unit),
        **more,
    )
    for speed, angle, printed, right, half, reason in POSITION_ERRORS
    for star, unit, length, more in (
        ("", "degree", printed, {"slip": "paper", "reason": reason}),
        ("*", "radian", right, {"expect": CERTIFIED}),
    )
)

#: Exponents of metre and second.
UNITS = {"m": (1, 0), "m/s": (1, -1), "m/s^2": (1, -2)}


def rate_has(printed: str, quantity: str) -> Property:
    """That the time derivative of a quantity has the printed unit.

    Where metres are divided by a and seconds by b, so do change d, the quotient of differences by t, and the printed.
    """
    (p, q), (P, Q) = UNITS[quantity], UNITS[printed]
    method = "unit of a time derivative, exponents of metre and second"
    symbols = {"a": ["1", None, ["open-low"]], "b": ["1", None, ["open-low"]], "t": ["0", None, ["open-low"]]}
    texts = f"a**{p}*b**({q})*d/(b*t)", f"a**{P}*b**({Q})*(d/t)"
    meaning = [state(texts[0], "=", texts[1], symbols | {"d": ["0", None, ["open-low"]]})]
    return fact((P, Q), (p, q - 1), method, PROVED, meaning=meaning)


CLAIMS_EXPERIMENT_3 = claims(
    "experiment.sigma_v.unit | The error of the speed V_2 at |V| = 100 m/s is a length, printed in metres. | "
    "paper: an error of V_2 is in m/s; the same figures for 2 and 300 m/s are printed with m/s",
    lambda: rate_has("m", "m"),
    "experiment.sigma_v.unit* | The error of a speed is in metres per second.",
    lambda: rate_has("m/s", "m"),
    "experiment.sigma_a.unit | The error of the acceleration dV_2/dt is in metres per second squared.",
    lambda: rate_has("m/s^2", "m/s"),
)
