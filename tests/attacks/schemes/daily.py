"""Formulas of navigation, orbits and statistics: true bounds with their case of equality, and falser neighbours."""

from __future__ import annotations

import random

from tests.attacks.schemes.values import draw_tiny
from tests.attacks.statements import Statement, family

ANGLE, HALF = ["-pi", "pi"], ["-pi/2", "pi/2"]


@family("latitudes and distances")
def make_latitude(rng: random.Random) -> Statement:
    """Geocentric against geodetic latitude, haversines, cosines of sides, ranges and their rates."""
    k, d = rng.choice(("0.99330562", "298/300", "1/2", "9/10")), draw_tiny(rng, 3, 20)
    latitude, apart = {"L": ["0", "3/2"]}, f"L - atan({k}*tan(L))"
    most, at = f"asin((1 - {k})/(1 + {k}))", {"L": f"atan(1/sqrt({k}))"}
    sides = {"a": HALF, "b": HALF, "l": ANGLE}
    haversine = "sin((a - b)/2)**2 + cos(a)*cos(b)*sin(l/2)**2"
    cosine = "sin(a)*sin(b) + cos(a)*cos(b)*cos(l)"
    rate = "abs(x*u + y*v)/sqrt(x**2 + y**2)"
    return rng.choice((
        Statement(f"{apart} >= 0", True, latitude), Statement(f"{apart} <= {most}", True, latitude),
        Statement(f"{apart} < {most} + {d}", True, latitude), Statement(f"{apart} <= {most} - {d}", False, latitude,
        at),
        Statement(f"{apart} < {most}", False, latitude, at), Statement(f"{cosine} = 1 - 2*({haversine})", True, sides),
        Statement(f"acos({cosine}) = 2*asin(sqrt({haversine}))", True, sides),
        Statement(f"{haversine} <= 1", True, sides), Statement(f"{haversine} < 1", False, sides,
        {"a": "0", "b": "0", "l": "pi"}),
        Statement("2*asin(sqrt(sin(s/2)**2)) = s", True, {"s": ["0", "pi"]}),
        Statement("2*asin(sqrt(sin(s/2)**2)) = s", False, {"s": ["0", "4"]}, {"s": "4"}),
        Statement(f"{rate} <= sqrt(u**2 + v**2)", True), Statement(f"{rate} < sqrt(u**2 + v**2)", False, {},
        dict.fromkeys("xyuv", "1")),
        Statement(f"{rate} <= sqrt(u**2 + v**2) - {d}", False, {}, {"x": "1", "y": "0", "u": "1", "v": "0"}),
        Statement("(1/x + 1/y)*(x + y) >= 4", True, {"x": "positive", "y": "positive"}),
        Statement(f"(1/x + 1/y)*(x + y) >= 4 + {d}", False, {"x": "positive", "y": "positive"}, {"x": "1", "y": "1"}),
        Statement("sin(l)*cos(a) <= cos(a)", True, {"l": ANGLE, "a": HALF}),
        Statement("abs(atan2(y, x)) <= pi", True), Statement("atan2(y, x) < pi", False, {}, {"x": "-1", "y": "0"}),
        Statement("atan2(y, x) > -pi", True), Statement("cos(atan2(y, x)) = x/sqrt(x**2 + y**2)", True),
    ))  # fmt: skip


@family("anomalies and towers")
def make_tower(rng: random.Random) -> Statement:
    """Anomalies of an orbit, the Gudermann and Gumbel functions, and towers of exponentials with small differences."""
    d = draw_tiny(rng, 3, 30)
    orbit = {"c": ["0", "9/10"], "M": ["-3", "3"]}
    anomaly = "2*atan(sqrt((1 + c)/(1 - c))*tan(M/2))"
    return rng.choice((
        Statement(f"cos({anomaly}) = (cos(M) - c)/(1 - c*cos(M))", True, orbit),
        Statement(f"cos({anomaly}) = (cos(M) - c)/(1 - c*cos(M)) + {d}*c", False, orbit, {"c": "1/2", "M": "1"}),
        Statement(f"{anomaly} >= M", True, {"c": ["0", "9/10"], "M": ["0", "3"]}),
        Statement(f"{anomaly} > M", False, {"c": ["0", "9/10"], "M": ["0", "3"]}, {"c": "0", "M": "1"}),
        Statement("M - c*sin(M) >= 0", True, {"c": ["0", "1"], "M": ["0", "4"]}),
        Statement("2*atan(exp(x)) - pi/2 = atan(sinh(x))", True), Statement("2*atan(tanh(x/2)) = asin(tanh(x))", True),
        Statement(f"2*atan(exp(x)) - pi/2 = atan(sinh(x)) + {d}", False, {}, {"x": "1"}),
        Statement("abs(atan(sinh(x))) < pi/2", True), Statement(f"atan(sinh(x)) < pi/2 - {d}", False, {}, {"x": "100"}),
        Statement("exp(-exp(-x)) < 1", True), Statement("exp(-exp(-x)) > 0", True),
        Statement(f"exp(-exp(-x)) < 1 - {d}", False, {}, {"x": "100"}),
        Statement(f"exp(-exp(-x)) > {d}", False, {}, {"x": "-10"}), Statement(f"exp(exp(x + {d})) > exp(exp(x))", True),
        Statement(f"exp(exp(x)) - exp(exp(x) - {d}) > 0", True), Statement("log(1 + exp(x)) > x", True),
        Statement(f"log(1 + exp(x)) > x + {d}", False, {}, {"x": "100"}), Statement("exp(exp(x)) > 1 + exp(x)", True),
        Statement("exp(-exp(-x))*exp(-x) <= exp(-1)", True), Statement(f"exp(-exp(-x))*exp(-x) <= exp(-1) - {d}",
        False, {}, {"x": "0"}),
        Statement("exp(-exp(-x))*exp(-x) < exp(-1)", False, {}, {"x": "0"}),
        Statement("log(log(exp(exp(x)))) = x", True),
        Statement("exp(exp(x)) >= exp(1)*exp(x)", True), Statement("exp(exp(x)) > exp(1)*exp(x)", False, {},
        {"x": "0"}),
    ))  # fmt: skip
