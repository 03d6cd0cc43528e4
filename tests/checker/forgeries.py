"""Every check of the checker with a certificate that fails only there, and what else it must accept or refuse.

:func:`discrepancies` runs all of it against any module that has the checker's three names: the checker
itself, a mutant of it.
"""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Iterator
from typing import Any

from flint import arb, arb_series, ctx

from tests.checker import calculus, proofs, words
from tests.checker.examples import (
    ALL,
    ALMOST,
    APART,
    AT_ONCE,
    BELOW_TEN,
    CELLS,
    CIRCLE,
    CONDITION,
    CONES,
    CONSTANT,
    DESIGN,
    DIGITS,
    EDGE,
    EXACT,
    EXCLUSION,
    EXPONENTIAL,
    FLAT,
    FLAT_LEFT,
    FOUR,
    GAP,
    GOOD,
    GROWING,
    IDENTITY,
    LEANING,
    LIMITED,
    LONELY,
    MANY,
    MOVING,
    NONE,
    PARABOLA,
    PIVOT,
    POSITIVITY,
    RANGE,
    RANK,
    REMAINDER,
    SCALED,
    SLIVER,
    SLOPES,
    STILL,
    TENFOLD,
    TIGHT,
    TOUCH,
    TWO,
    UNEVEN,
    WAVES,
    alone,
    remainder,
)
from tests.checker.texts import BROKEN, EQUAL, FUNCTIONS, OUTSIDE, SYMBOLS, UNEQUAL


def changed(item, path, value):
    """A copy with one entry replaced; the path is a list of keys and indices."""
    forged = copy.deepcopy(item)
    place = forged
    for key in path[:-1]:
        place = place[key]
    if value is ...:
        del place[path[-1]]
    else:
        place[path[-1]] = value
    return forged


def verdict(item, module) -> str:
    """Empty when accepted, else the reason."""
    try:
        module.check(module.load(json.dumps(item)))
    except module.Refused as why:
        return str(why)
    return ""


def judged(item, module) -> str:
    """As :func:`verdict`, for data that JSON has no text for."""
    try:
        module.check(item)
    except module.Refused as why:
        return str(why)
    return ""


# The value at zero, seen as 2 t - t**2 on [0, 1/2]: its stationary point 1 is the place 2 of the panel.
STATIONARY = {
    "kind": "touch",
    "variable": "t",
    "functional": ["1"],
    "bits": 80,
    "cells": 40,
    "panels": [{"measurement": 0, "from": "0", "to": "1/2", "sigma": "1", "H": ["2*t - t**2"]}],
    **alone(["1"], [(0, "2", "1")], ["0.0001"] * 3),
    "lower": "0.999",
    "upper": "1.001",
    **NONE,
}
LINE = ["pieces", 0, "contacts", 0]
# The same to the left of its panel [3/2, 2].
LEFT = changed(changed(STATIONARY, ["panels", 0, "from"], "3/2"), ["panels", 0, "to"], "2")
# One number seen twice: the weights 2 and -1 satisfy the system of the optimum, and cost more than 1.
TWICE = {
    "kind": "touch",
    "variable": "t",
    "functional": ["0", "1"],
    "bits": 80,
    "cells": 40,
    "panels": [
        {"measurement": 0, "from": "0", "to": "1", "sigma": "1", "H": ["1 - 2*t", "1"]},
        {"measurement": 1, "from": "0", "to": "1", "sigma": "1", "H": ["1/2 - t/4", "1"]},
    ],
    **alone(["0", "1"], [(0, "0", "-1"), (1, "0", "2")], ["0.0001"] * 6),
    "lower": "0.999",
    "upper": "1.001",
    **NONE,
}
# The box of the first weight reaches from one sign to the other.
SIGNED = TWICE | alone(["0", "1"], [(0, "0", "0.1"), (1, "0", "2")], [*["5"] * 2, *["0.0001"] * 2, *["5"] * 2])
# A wave that touches the bound in the middle, bends down there, and rises above it towards both ends.
WAVE = STATIONARY | {
    "panels": [{"measurement": 0, "from": "0", "to": "1", "sigma": "1", "H": ["1 - (t - 1/2)**2/10 + (t - 1/2)**4"]}],
    **alone(["1"], [(0, "1/2", "1")], ["0.0001"] * 3),
}
# The same, bent down so far that it falls through the other bound.
DIP = changed(WAVE, ["panels", 0, "H"], ["1 - 10*(t - 1/2)**2"])
# Bent up a little more slowly than the wave; and a line at the start of the panel that turns and climbs over the bound.
SWELL = changed(WAVE, ["panels", 0, "H"], ["1 - (t - 1/2)**2/10 + 21/50*(t - 1/2)**4"])
CLIMB = WAVE | {
    "panels": [{"measurement": 0, "from": "0", "to": "1", "sigma": "1", "H": ["1 - t/10 + t**2/5"]}],
    **alone(["1"], [(0, "0", "1")], ["0.0001"] * 3),
}
# The contact stands a little farther from the stationary point than its radius.
SHIFTED = changed(WAVE, ["panels", 0, "H"], ["1 - (t - 1/2)**2"]) | alone(["1"], [(0, "0.50025", "1")], ["0.0002"] * 3)
# A kernel beyond the ball on which its series is summed, reached with a panel of length one.
BEYOND = EXACT | {"panels": [{"measurement": 0, "from": "1", "to": "2", "sigma": "1", "H": ["exp_2(t)"]}]}
# Powers about the middle of the panel: the last coefficients of Taylor's formula alone rise above the bound.
POWERS = [
    EXACT
    | {
        "cells": 5,
        "dual": ["1"],
        "panels": [{"measurement": 0, "from": "0", "to": "1", "sigma": "1", "H": [f"3/2*(2*t - 1)**{n}"]}],
    }
    for n in (13, 14, 15, 16)
]
# What has no value anywhere on the panel, p from 0 to 0. In series of balls each of them was 0 or 1: python-flint has 0
# for negative powers of a series without terms, and for its product with NaN.
NOWHERE = [
    "1/(0*t)",
    "5*(0*t)**(-1)*log(2 + t)",
    "1/((p - p)*t)",
    "sin(p*t)/(p*t)",
    "(0*t)**(-1/2)",
    "(0*t)*(0*t)**(-1)",
    "tan(pi/2*exp(0*t))*(t - t)",
    "0*log(t - 5)",
    "0*(t - 5)**(1/2)",
    "0/(t - 1/2)",
    "p*asin(t + 5)",
    "(t - t)*acos(t + 2)",
]
AT_ZERO = {"parameter": "p", "from": "0", "to": "0"}
UNSEEN = [
    (item | AT_ZERO, ["panels", 0, "H"], [f"{H[0]} + {text}", *H[1:]], why)
    for item, why in ((PARABOLA, "no value|division by zero"), (GAP, "not shown"))
    for H in (item["panels"][0]["H"],)
    for text in NOWHERE
]
# Three cells each: together they are more than the certificate announces.
REPEATED = TOUCH | {"cells": 0, "pieces": TOUCH["pieces"] * 67}
ONE = ["pieces", 0]
FORGERIES = [
    *UNSEEN,
    *((power, ["kind"], "gap", "not shown") for power in POWERS),
    (REPEATED, ["kind"], "touch", "not shown"),
    (EXPONENTIAL, ["solution"], [*EXPONENTIAL["solution"], ["0", "0"]], "square"),
    (WAVE, ["kind"], "touch", "not shown"),
    (SWELL, ["kind"], "touch", "not shown"),
    (CLIMB, ["kind"], "touch", "not shown"),
    (SHIFTED, ["kind"], "touch", "Newton"),
    (REMAINDER, ["expression"], remainder(37), "not shown"),
    (UNEVEN, ["kind"], "gap", "not shown"),
    (DIP, ["kind"], "touch", "not shown"),
    (BEYOND, ["kind"], "gap", "beyond 1"),
    (AT_ONCE, ["expression"], "exp_2(3/2) + x", "beyond 1"),
    (CELLS, ["bits"], 20001, "integer from"),
    (TIGHT, ["cells"], 209, "not shown"),
    (STATIONARY, ["kind"], "touch", "outside its panel"),
    (LEFT, [*LINE, "at"], ["-1"], "outside its panel"),
    (TWICE, ["kind"], "touch", "Newton"),
    (SIGNED, ["kind"], "touch", "wrong sign"),
    (TOUCH, ["parameter"], "", "expected names"),
    (STILL, ["shares", 4], ["0"], "a direction that is seen"),
    (STILL, ["shares", 4], ["r/r"], "division by zero"),
    (STILL, ["shares"], [["0"], ["0"], ["0"], ["0"]], "factors for every"),
    (STILL, ["point", "r"], "1", "zeros do not vanish"),
    (STILL, ["point"], {"r": "0"}, "point of all symbols"),
    (STILL, ["statement", "rank"], 1, "expected 2 entries"),
    (STILL, ["null"], [], "n - r vectors"),
    (STILL, ["null"], [["0", "1", "f"]], "a direction that is seen"),
    (STILL, ["free"], [0], "division by zero"),
    (STILL, ["free"], [3], "integer from"),
    (STILL, ["order"], 1, "smaller at the point"),
    (STILL, ["order"], 0, "integer from"),
    (STILL, ["order"], 101, "integer from"),
    (STILL, ["statement", "rates"], {"f": "r", "r": "1"}, "a direction that is seen, or zeros that do not stay"),
    (STILL, ["statement", "F", 0], ["0", "f"], "expected 3 entries"),
    (STILL, ["bits"], 52, "integer from"),
    (GROWING, ["point", "r"], "0", "smaller at the point"),
    (GROWING, ["statement", "rates"], {}, "smaller at the point"),
    (GROWING, ["statement", "H"], [["0", "0", "0"]], "smaller at the point"),
    (CIRCLE, ["point", "c"], "1/2", "zeros do not vanish"),
    (CIRCLE, ["null"], [["s", "c"]], "a direction that is seen"),
    (
        CIRCLE,
        ["statement", "rates"],
        {"c": "-w*s", "s": "2*w*c"},
        "a direction that is seen, or zeros that do not stay",
    ),
    (CIRCLE, ["statement", "H"], [["1", "0"]], "a direction that is seen"),
    (TWO, ["null", 1], ["0", "1", "1"], "not diagonal"),
    (TWO, ["free"], [1, 1], "division by zero"),
    (PIVOT, ["point", "a"], "0", "pivot that may be zero"),
    (PIVOT, ["statement", "H", 0, 0], "atan2(a, 1)", "atan2 in a series"),
    (PIVOT, ["statement", "H", 0, 0], "atan2(1, a)", "atan2 in a series"),
    (CONDITION, ["brackets", 0], "25.05", "largest"),
    (CONDITION, ["brackets", 1], "24.95", "largest"),
    (CONDITION, ["brackets", 2], "1.0005", "smallest"),
    (CONDITION, ["brackets", 1], "25", "may be 0"),
    (CONDITION, ["brackets", 2], "1", "may be 0"),
    (CONDITION, ["bits"], 52, "integer from"),
    (CONDITION, ["brackets", 2], "-1", "smallest"),
    (CONDITION, ["brackets", 3], "0.9995", "smallest"),
    (CONDITION, ["brackets"], ["24.9", "25.1", "0.999"], "4 entries"),
    (CONDITION, ["statement", "lower"], "5.05", "not shown to lie"),
    (CONDITION, ["statement", "upper"], "4.95", "not shown to lie"),
    (CONDITION, ["statement", "lower"], "-6", "two ends"),
    (CONDITION, ["statement", "lower"], "5.2", "two ends"),
    (CONDITION, ["statement", "unit"], 1, "largest"),
    (CONDITION, ["statement", "unit"], True, "integer from"),
    (CONDITION, ["outside"], 1, "not shown to lie"),
    (CONDITION, ["outside"], 2, "integer from"),
    (CONDITION, ["statement", "matrix", 0], ["1", "1"], "largest"),
    (CONDITION, ["statement", "matrix", 1], ["3"], "2 entries"),
    (CONDITION, ["statement", "matrix"], [], "integer from"),
    (CONDITION, ["statement", "matrix"], [["1"] * 201], "integer from"),
    (SCALED | {"outside": 0}, ["statement", "lower"], "1.4", "two ends|lie there"),
    (
        SCALED | {"outside": 0, "statement": SCALED["statement"] | {"upper": "9"}},
        ["statement", "lower"],
        "1.4",
        "not shown to lie",
    ),
    (CONDITION, ["statement", "matrix"], [["1", "1"], ["1", "1"]], "largest"),
    (CONDITION, ["statement", "matrix"], [["5", "5"], ["5", "5"]], "largest"),
    (CONDITION, ["statement", "matrix"], [["0", "0"], ["0", "5"]], "smallest"),
    (SCALED, ["outside"], 0, "not shown to lie"),
    (LEANING, ["brackets", 1], "44." + 20 * "9", "may be 0"),
    (LEANING, ["brackets", 2], "5." + 19 * "0" + "1", "may be 0"),
    (STILL, ["statement", "F"], [["0"] * 101] * 101, "integer from"),
    (TENFOLD, ["statement"], TENFOLD["statement"] | {"lower": "6", "upper": "7"}, "not shown to lie"),
    (BELOW_TEN, ["statement"], TENFOLD["statement"] | {"lower": "1", "upper": "6"}, "not shown to lie"),
    (BELOW_TEN, ["statement", "lower"], "5", "not shown to lie"),
    (SCALED, ["statement", "lower"], "1", "not shown to lie"),
    (SCALED, ["statement", "matrix", 0], ["0", "0"], "may be 0"),
    (RANK, ["rows"], ["0"], "integer from"),
    (IDENTITY, ["right"], "2*sin(a)*cos(a)*1.0000001", "the sides differ"),
    (IDENTITY, ["right"], "2*sin(a)*cos(b)", "unknown symbol b"),
    (IDENTITY, ["right"], "sin(2*a) + 0/(a - a)", "division by zero"),
    (IDENTITY, ["right"], "sin(2*a) + 0*sqrt(a - a)", "division by zero"),
    (IDENTITY, ["right"], "sin(2*a) + 0*sqrt(%s)" % (2**101), "root of a large number"),
    (IDENTITY, ["right"], f"sin(2*a) + 0*sqrt({2**60}/{3**40})", "root of a large number"),
    (IDENTITY, ["right"], "sin(2*a) + 0*a**1000000", "a large exponent"),
    (IDENTITY, ["right"], "sin(2*a) + 0*gamma(a)", "function gamma"),
    (IDENTITY, ["right"], "sin(2*a) + 0*sin_x(a)", "function sin_x"),
    (IDENTITY, ["right"], "sin(2*a) + 0*log_1(a)", "function log_1"),
    (IDENTITY, ["right"], "sin(2*a) + cos(pi/5041)", "roots of a high order"),
    (IDENTITY, ["right"], 5, "unexpected characters"),
    (IDENTITY, ["right"], "2*sin(a)*cos(a)#", "unexpected characters"),
    (IDENTITY, ["right"], "2*sin(a)*cos(a", r"not an expression: no \)"),
    (IDENTITY, ["right"], "sin(2*a) % 1", "unexpected characters"),
    (IDENTITY, ["right"], "sin(2*a) // 1", "not an expression"),
    (IDENTITY, ["kind"], "unheard-of", "known kind"),
    (IDENTITY, ["kind"], 3, "known kind"),
    (IDENTITY, ["symbols"], ["a", 1], "expected names"),
    (IDENTITY, ["symbols"], "a", "expected a list"),
    (IDENTITY, ["note"], "more", "exactly the keys"),
    (IDENTITY, ["left"], ..., "exactly the keys"),
    (ALL, ["of", 0, "right"], "sin(a)", "the sides differ"),
    (ALL, ["of", 1], 7, "known kind"),
    (ALL, ["of"], [], "entries"),
    (IDENTITY, ["symbols"], ["a", "a"], "given twice"),
    (IDENTITY, ["symbols"], ["a", "pi"], "or pi"),
    (EXPONENTIAL, ["solution", 0, 1], "sin(w*t)", "X' differs"),
    (EXPONENTIAL, ["solution"], [["2*cos(w*t)", "2*sin(w*t)/w"], ["-2*w*sin(w*t)", "2*cos(w*t)"]], "X\\(0\\) differs"),
    (EXPONENTIAL, ["variable"], "w", "given twice"),
    (EXPONENTIAL | {"matrix": [["0"]]}, ["solution"], [["1 + t"]], "X' differs"),
    (EXPONENTIAL, ["matrix"], [["0", "1", "0"], ["-w**2", "0"]], "expected 2 entries"),
    (RANK, ["null"], [["b", "a"]], "does not vanish"),
    (RANK, ["null"], [["0", "0"]], "may be dependent"),
    (RANK, ["point"], {"a": "0", "b": "0"}, "may be dependent"),
    (RANK, ["point"], {"a": "1"}, "point gives every symbol"),
    (RANK, ["point"], ["a"], "point gives every symbol"),
    (RANK, ["point", "a"], "1/0", "division by zero"),
    (RANK, ["point", "a"], "nan", "not a number"),
    (RANK, ["rank"], 2, "entries"),
    (RANK, ["rank"], -1, "integer from"),
    (RANK, ["rank"], True, "integer from"),
    (RANK, ["rows"], [2], "integer from"),
    (RANK, ["rows"], [], "expected 1 entries"),
    (EXCLUSION, ["most"], 2, "may explain"),
    (EXCLUSION, ["most"], 5, "integer from"),
    (EXCLUSION, ["most"], -1, "integer from"),
    (EXCLUSION, ["excluded"], ["3"], "may explain"),
    (EXCLUSION, ["excluded"], ["2", "0"], "may explain"),
    (EXCLUSION, ["contradictions"], [[0, 1, 2]], "may explain"),
    (EXCLUSION, ["contradictions"], [], "may explain"),
    (EXCLUSION, ["contradictions", 0], [0, 1, 3], "no contradiction"),
    (EXCLUSION, ["contradictions", 0], [0, 0, 2], "singular"),
    (EXCLUSION, ["contradictions", 0], [0, 1, 5], "integer from"),
    (EXCLUSION, ["contradictions", 0], [0, 1, -3], "integer from"),
    (EXCLUSION, ["contradictions", 0], [1, 2], "malformed"),
    (EXCLUSION, ["contradictions", 0], [0, 1, 3, 2], "malformed"),
    (EXCLUSION, ["rows", 0, "sigma"], "-0.001", "not negative"),
    (EXCLUSION, ["rows", 1, "sigma"], "25", "no contradiction"),
    (EXCLUSION, ["rows", 2, "sigma"], "47", "no contradiction"),
    (EXCLUSION, ["rows", 2, "epoch"], "5", "may explain"),
    (EXCLUSION, ["rows", 2, "z"], "5", "no contradiction"),  # as far away as the bounds allow, and no further
    (EXCLUSION, ["rows", 2, "z"], "-3", "no contradiction"),
    (EXCLUSION, ["rows", 2, "H"], ["1"], "malformed"),
    (EXCLUSION, ["rows", 2, "H"], ["1", "x"], "unknown symbol"),
    (WAVES, ["most"], 2, "may explain"),
    (WAVES, ["rows", 2, "z"], "1", "no contradiction"),
    (WAVES, ["bits"], 52, "integer from"),
    (APART, ["most"], 2, "may explain"),
    (APART, ["rows", 2, "H"], ["1", "1/10"], "may explain"),
    (APART, ["rows", 0, "H"], ["1", "cos(pi/2)"], "may explain"),  # a ball about zero is not zero
    (ALMOST, ["rows", 2, "z"], "4", "no contradiction"),
    (FOUR, ["cells"], 35, "more sets than announced"),
    (FOUR, ["contradictions"], FOUR["contradictions"][:4], "may explain"),
    (LIMITED, ["blocks", 2, "weights"], ["-1/8", "1/4"], "below zero"),
    (LIMITED, ["blocks", 2, "size"], [["1"], ["1"]], "below zero"),
    (LIMITED, ["dual", 2], "1/9", "leaves the noise"),
    (CONES, ["lower"], "1.0001", "above x.P"),
    (CONES, ["upper"], "0.9999", "cost more"),
    (CONES, ["functional"], ["1.1"], "do not carry"),
    (CONES, ["dual"], ["1.001"], "leaves the noise"),
    (CONES, ["dual"], [], "1 entries"),
    (CONES, ["blocks", 0, "size", 0], ["1", "1"], "positive definite"),
    (CONES, ["blocks", 0, "weights"], ["1"], "1 entries"),
    (CONES, ["blocks", 1, "size"], [["-1"]], "positive sizes"),
    (CONES, ["blocks", 2, "norm"], "l0", "a norm"),
    (CONES, ["bits"], 52, "integer from"),
    (DESIGN, ["upper"], "0.6666", "cost more"),
    (DESIGN, ["lower"], "0.6667", "above x.P"),
    (DESIGN, ["budget"], "1", "than the budget"),
    (DESIGN, ["costs"], {}, "has no cost"),
    (DESIGN, ["costs"], [], "malformed"),
    (DESIGN, ["costs", "b"], "-1", "negative cost"),
    (DESIGN, ["duals"], [], "may do better"),
    (DESIGN, ["duals", 0], ["-1", "1"], "may do better"),
    (DESIGN, ["rows", 0, "sigma"], "2", "cost more"),
    (DESIGN, ["rows", 2, "sigma"], "0", "noise bound"),
    (DESIGN, ["rows", 2, "sigma"], "1/4", "may do better"),
    (DESIGN, ["support"], [0, 6], "integer from"),
    (DESIGN, ["support"], [0, 0], "singular"),
    (DESIGN, ["support"], [3, 4], "at no row"),
    (DESIGN, ["support"], [0], "2 entries"),
    (LONELY, ["functional"], ["sin(1) - sin(1)", "sin(1)"], "at no row"),  # a ball about zero is not zero
    (LONELY, ["upper"], "0.999", "cost more"),
    (MANY, ["cells"], 35, "more selections"),
    (MANY, ["duals"], MANY["duals"][:4], "may do better"),
    (MANY, ["support"], [0, 22, 23, 24, 26], "integer from"),
    (POSITIVITY, ["expression"], "0.9 - sin(x)*cos(y)", "not shown"),
    (POSITIVITY, ["expression"], "1/(x - 1) + 5", "not shown"),
    (POSITIVITY, ["expression"], "1 + log(x - 1)**2", "not shown"),
    (POSITIVITY, ["expression"], "1 + exp_1(x)", "exp_1 beyond 1"),
    (POSITIVITY, ["expression"], "1 + x**1000", "a large exponent"),
    (POSITIVITY, ["box", "x"], ["0"], "entries"),
    (POSITIVITY, ["bits"], 52, "integer from"),
    (POSITIVITY, ["cells"], -1, "integer from"),
    (EXACT | {"cells": 50}, ["panels", 0, "H"], ["2"], "not shown"),
    (EXACT | {"cells": 50}, ["panels", 0, "H"], ["3*(2*t - 1)**15"], "not shown"),  # all of it stands in the remainder
    (GAP, ["dual"], ["-1.001", "1.001"], "not shown"),
    (GAP, ["dual"], ["-1", "1"], "not shown"),
    (GAP, ["lower"], "0.9991", "lower bound is above"),
    (GAP, ["upper"], "0.9999", "cost more"),
    (GAP, ["support"], [[0, "0"], [0, "1.5"]], "outside its panel"),
    (GAP, ["support"], [[0, "-0.5"], [0, "1"]], "outside its panel"),
    (GAP, ["support"], [[0, "0"], [0, "0"]], "singular"),
    (GAP, ["support"], [[0, "0"], [1, "1"]], "integer from"),
    (GAP, ["support"], [[0, "0"]], "expected 2 entries"),
    (GAP, ["panels", 0, "sigma"], "0", "positive"),
    (GAP, ["panels", 0, "to"], "0", "positive"),
    (GAP, ["panels", 0, "H"], ["1", "t", "t**2"], "expected 2 entries"),
    (GAP, ["panels", 0, "H"], ["1", "(t**8)/(t**7)"], "not shown"),
    (GAP, ["dual"], ["-0.999", "0.999", "0"], "entries"),
    (GAP, ["bits"], 10, "integer from"),
    (GAP, ["cells"], True, "integer from"),
    (SLIVER, ["to"], "1.2", "cost more"),
    (SLIVER, ["functional"], ["p - 1"], "lower bound is above"),
    (GAP, ["parameter"], "t", "given twice"),
    (GAP, ["kind"], "touch", "exactly the keys"),
    (GAP, ["end"], "1", "expected exactly the keys"),
    (GAP, ["upper"], ..., "expected exactly the keys"),
    (GAP, ["bits"], ..., "exactly the keys"),
    (GAP, ["self"], "1", "exactly the keys"),
    (SLIVER, ["parameter"], 1, "expected names"),
    (SLIVER, ["from"], "0", "positive"),
    (TOUCH, [*LINE, "weight"], ["0.5"], "Newton"),
    (TOUCH, [*LINE, "weight"], ["0"], "Newton"),
    (TOUCH, [*LINE, "weight"], [], "coefficients of every polynomial"),
    (TOUCH, [*LINE, "sign"], 1, "expected exactly the keys"),
    (TOUCH, [*LINE, "panel"], 1, "integer from"),
    (TOUCH, [*LINE, "panel"], -1, "integer from"),
    (TOUCH, [*LINE, "at"], [], "coefficients of every polynomial"),
    (TOUCH, [*LINE, "at"], ["0.0"], "Newton"),
    (TOUCH, [*ONE, "contacts"], [], "expected a contact"),
    (TOUCH, [*ONE, "radius"], ["0"] * 6, "Newton"),
    (TOUCH, [*ONE, "radius"], ["-1"] * 6, "singular|Newton"),
    (TOUCH, [*ONE, "radius"], ["0.000001"] * 5, "entries"),
    (TOUCH, [*ONE, "dual"], [["-1.1"], ["1"]], "Newton"),
    (TOUCH, [*ONE, "dual"], [["-1"]], "entries"),
    (TOUCH, ["upper"], "0.99999991", "not between the bounds"),
    (TOUCH, ["lower"], "1.00000001", "not between the bounds"),
    (TOUCH, ["to"], "1", "do not reach the end"),
    (TOUCH, ["from"], "-1", "leave a hole"),
    (TOUCH, ["pieces"], [], "do not reach the end"),
    (TOUCH, ["parameter"], "t", "given twice"),
    (TOUCH, ["parameter"], "pi", "given twice, or pi"),
    (TOUCH, ["variable"], "pi", "given twice, or pi"),
    (CONSTANT, ["panels", 0, "sigma"], "1", "Newton"),
    (CONSTANT, ["panels", 0, "H"], ["2 - 5*t"], "not shown"),
    (CONSTANT, ["panels", 0, "H"], ["2 + t"], "not shown"),
    (CONSTANT, ["panels", 0, "H"], ["2"], "not shown"),
    (PARABOLA, [*ONE, "contacts", 1, "at"], ["0.51"], "Newton"),
    # A little farther from the solution than the radius.
    (PARABOLA, [*ONE, "contacts", 1, "at"], ["0.50000012"], "Newton"),
    (PARABOLA, [*ONE, "contacts", 1, "at"], ["0.49999988"], "Newton"),
    (PARABOLA, [*ONE, "contacts", 0, "weight"], ["2.00000012"], "Newton"),
    (PARABOLA, [*ONE, "contacts", 1, "weight"], ["-4.00000012"], "Newton"),
    (PARABOLA, [*ONE, "contacts", 2, "weight"], ["1.99999988"], "Newton"),
    (PARABOLA, [*ONE, "dual"], [["1.00000012"], ["-8"], ["8"]], "Newton"),
    (PARABOLA, [*ONE, "dual"], [["1"], ["-8.00000012"], ["8"]], "Newton"),
    (PARABOLA, [*ONE, "dual"], [["1"], ["-8"], ["7.99999988"]], "Newton"),
    (changed(STATIONARY, ["panels", 0, "to"], "2/3"), [*LINE, "at"], ["1.5"], "outside its panel"),
    (changed(STATIONARY, ["panels", 0, "to"], "1"), [*LINE, "at"], ["1.00001"], "outside its panel"),
    (RANGE, ["to"], "1.03", "do not reach the end"),
    (RANGE, ["to"], "1.01", "do not reach the end"),
    (RANGE, ["from"], "0.99", "leave a hole"),
    (RANGE, ["pieces", 0, "to"], "0.99", "leave a hole"),
    (RANGE, ["pieces", 0, "basis"], [["1", "1", "0"], ["1", "1", "0"], ["0", "0", "1"]], "singular"),
    (RANGE, ["pieces", 0, "basis", 0, 0], "1.5", "Newton"),
    (RANGE, ["upper"], "7.9", "not between the bounds"),
    (RANGE, ["lower"], "7.8", "not between the bounds"),
    (RANGE, ["pieces", 0, "note"], "1", "expected exactly the keys"),
    (RANGE, ["panels", 0, "to"], "1.01", "Newton"),
    (RANGE, ["pieces", 0, "dual", 1, 1], "0.5", "Newton"),
    (MOVING, ["panels", 0, "sigma"], "1 + p/9", "Newton"),
    (MOVING, ["panels", 0, "from"], "p/100", "Newton"),
    (MOVING, ["panels", 0, "H"], ["p + 1 + t*(p - 1)"], "not shown"),
    (MOVING, ["functional"], ["p"], "Newton"),
    (MOVING, ["parameter"], "r", "unknown symbol p"),
    (MOVING, ["panels", 0, "to"], "p - 1", "positive"),
    (SLOPES, ["pieces", 0, "to"], "1.005", "leave a hole"),
    (SLOPES, ["pieces", 1, "from"], "1.005", "leave a hole"),
    (SLOPES, ["to"], "1.01", "do not reach the end"),
    (SLOPES, ["pieces", 1, "radius"], ["0.0001"] * 6, "Newton"),
    (FLAT, ["panels", 0, "H"], ["1 - (t - 1)/10 - (t - 1)**2/2"], "not shown"),
    (FLAT, ["panels", 0, "H"], ["1 + (t - 1)/10 - 8*(t - 1)**2"], "not shown"),
    (
        STATIONARY,
        ["panels", 0],
        {"measurement": 0, "from": "-3/2", "to": "1/4", "sigma": "1", "H": ["1 + (t - 2)**2/16"]},
        "outside its panel",
    ),
    (
        changed(STATIONARY, [*LINE, "at"], ["0.5"]),
        ["panels", 0],
        {"measurement": 0, "from": "0", "to": "4", "sigma": "1", "H": ["1 + (t - 2)**2/16"]},
        "not shown",
    ),
    (IDENTITY, ["right"], "sin(2*a) + 0/(1/a + 1/(a + 1) - (2*a + 1)/(a*(a + 1)))", "division by zero"),
    (IDENTITY, ["right"], "sin(2*a) + 0*sqrt(1/a + 1/(a + 1) - (2*a + 1)/(a*(a + 1)))", "division by zero"),
    (FLAT, [*LINE, "at"], ["0"], "Newton"),
    (FLAT_LEFT, ["panels", 1, "H"], ["t**2/2 - 1 - t/10"], "not shown"),
    (FLAT_LEFT, ["panels", 0, "H"], ["2*t - 1/4"], "not shown"),
    (FLAT_LEFT, ["panels", 0, "H"], ["-2*t + 1/4"], "not shown"),
    (EXACT, ["lower"], "0.5000000000000001", "lower bound is above"),
    (EXACT, ["upper"], "0.9999999999999999", "cost more"),
    (EXACT, ["bits"], 52, "integer from"),
    (EXACT, ["bits"], 20001, "integer from"),
    (EXACT, ["cells"], 20001, "integer from"),
    (EXACT | {"bits": 20000}, ["cells"], 2001, "integer from"),
    (DIGITS, ["cells"], 2001, "integer from"),
    (EXACT, ["cells"], -1, "integer from"),
    (EXACT | {"cells": 5}, ["dual"], ["2"], "not shown"),
    (EXACT | {"cells": 5}, ["dual"], ["-2"], "not shown"),
    (EXACT, ["support"], [[0, "1", "1"]], "expected 2 entries"),
    (EXACT, ["support"], [[-1, "1"]], "integer from"),
    (EDGE | {"cells": 100}, ["box", "x"], ["-0.01", "0.99"], "not shown"),
    (EDGE | {"cells": 100}, ["box", "x"], ["0.01", "1.01"], "not shown"),
    (EDGE | {"cells": 100}, ["box", "y"], ["-2.01", "2.99"], "not shown"),
    (EDGE | {"cells": 100}, ["box", "y"], ["-1.99", "3.01"], "not shown"),
    (EDGE, ["bits"], 20001, "integer from"),
    (EDGE, ["cells"], 20001, "integer from"),
    (CELLS, ["cells"], 13, "not shown"),
    (CELLS, ["box"], {}, "unknown symbol x"),
    (CELLS, ["expression"], "x - x", "not shown"),
    (CELLS, ["expression"], "1 + 2**1000", "a large exponent"),
    (IDENTITY, ["right"], "sin(2*a) + 0*a**1000", "a large exponent"),
    (IDENTITY, ["right"], "sin(2*a) + 0*a**(-1000)", "a large exponent"),
    (IDENTITY, ["right"], "sin(2*a) + 0*sin(a, a)", "expected sin of 1; got 2 arguments"),
    (IDENTITY, ["right"], "sin(2*a) + 0*atan2(a)", "expected atan2 of 2; got 1 arguments"),
    (IDENTITY, ["right"], "sin(2*a) + 0*(a - a)**(-1)", "division by zero"),
    (IDENTITY, ["right"], "sin(2*a) + ((1 + a)**31*(1 + exp(a))**31)**2", "too many terms"),
    (IDENTITY, ["right"], f"sin(2*a) + 0*sqrt({2**100})", "root of a large number"),
]


# The parameter of :data:`FUNCTIONS`.
PARTS = arb(3) / 2, arb(-5) / 1000, arb(7) / 10**6


def identity(left: str, right: str) -> dict[str, Any]:
    return {"kind": "identity", "left": left, "right": right, "symbols": SYMBOLS}


def judge_page(module: Any) -> Iterator[str]:
    """The examples of docs/certificates.md, and limits of functions of what falls."""
    from tests.checker.test_certificates_page import FORGED, HONEST, put

    yield from (f"refused: {item}" for item in HONEST if verdict(item, module) != "")
    for item, row in FORGED:
        if not re.search(row["refused"], verdict(put(item, row["at"], row["put"]), module) or "accepted"):
            yield f"not refused for {row['refused']}: {row}"
    for text, value, other in (("atan(-2*x)", "-pi/2", "pi/2"), ("tanh(1 - x)", "-1", "1"), ("exp(2 - x)", "0", "1")):
        claim = {"left": f"limit({text}, x, oo)", "relation": "=", "symbols": {}, "exists": [], "tolerance": None}
        limit = {
            "kind": "proof",
            "bits": 128,
            "witness": {},
            "proofs": [{"rule": "identity"}],
            "answers": [{"signs": []}],
        }
        for right, good in ((value, True), (other, False)):
            if (verdict(limit | {"statement": claim | {"right": right}}, module) == "") != good:
                yield f"{text} to {right}: expected {good}"


def discrepancies(module: Any) -> Iterator[str]:
    """What a module with the checker's names answers otherwise than it must."""
    yield from proofs.discrepancies(module)
    yield from words.discrepancies(module)
    yield from calculus.discrepancies(module)
    yield from (f"refused: {item}" for item in GOOD if verdict(item, module) != "")
    for item, path, value, why in FORGERIES:
        if not re.search(why, verdict(changed(item, path, value), module) or "accepted"):
            yield f"not refused for {why}: {path} {value}"
    yield from (f"refused: {pair}" for pair in EQUAL if verdict(identity(*pair), module) != "")
    yield from (f"accepted: {pair}" for pair in UNEQUAL if verdict(identity(*pair), module) != "the sides differ")
    yield from (f"accepted: {text}" for text in OUTSIDE if verdict(identity(text, text), module) == "")
    yield from list_others(module)
    yield from judge_page(module)
    from tests.checker.adversary import tricks  # it is made of what stands here

    yield from (f"accepted: {name}" for name, item in tricks() if judged(item, module) == "")


def list_others(module: Any) -> Iterator[str]:
    """What is no question to the checker: texts that are no JSON, and functions of a parameter."""
    yield from (f"read: {text[:30]}" for text in BROKEN if readable(text, module))
    yield from (f"enclosed: {text}" for text, series in FUNCTIONS if not enclosed(text, series, module))
    yield from words.list_assumed(module)


def enclosed(text: str, series: Any, module: Any) -> bool:
    """A function of a parameter lies in its jets of three parts and of two, which are narrow, at s = -1, 0 and 1."""
    before, ctx.cap = ctx.cap, 3
    try:
        exact = series(arb_series(list(PARTS)))
        for parts, width in ((PARTS, 2e-6), (PARTS[:2], 2e-4)):
            jet = [arb(c) for c in module.evaluate(module.parse(text), {"p": module.Jet(*parts)}, arb).parts]
            ends = [(at(jet, s), series(arb_series([at(parts, s)]))[0]) for s in (-1, 1)]
            near = [(c, exact[k]) for k, c in enumerate(jet)]
            if not all(x.overlaps(y) for x, y in (*ends, *near)):
                return False
            if max(c.rad() for c in jet[:-1]) > 1e-13 or jet[-1].rad() > width:
                return False
        return True
    finally:
        ctx.cap = before


def at(parts: Any, s: int) -> Any:
    return sum((c * s**k for k, c in enumerate(parts)), arb(0))


def readable(text: str, module: Any) -> bool:
    try:
        module.load(text)
    except module.Refused:
        return False
    return True
