"""Honest certificates, one of every kind, which the tests forge."""

from __future__ import annotations

from math import factorial

VELOCITY = {"measurement": 0, "from": "0", "to": "2", "sigma": "1", "H": ["1", "t"]}
# A problem without a parameter names one that occurs nowhere, and goes from zero to zero.
NONE = {"parameter": "none", "from": "0", "to": "0"}


def unit(m):
    return [[str(int(i == j)) for i in range(m)] for j in range(m)]


def alone(dual, contacts, radius):
    """The pieces of a problem without a parameter."""
    rows = [{"panel": k, "at": [at], "weight": [w]} for k, at, w in contacts]
    solution = {"dual": [[x] for x in dual], "contacts": rows, "radius": radius}
    return {"pieces": [{"from": "0", "to": "0", "basis": unit(len(dual)), **solution}]}


# Slope of a line on [0, 2]: weights -1/2 and 1/2 at the ends, dual polynomial t - 1, optimum 1.
GAP = {
    "kind": "gap",
    "variable": "t",
    "panels": [VELOCITY],
    "functional": ["0", "1"],
    "bits": 80,
    "cells": 40,
    "dual": ["-0.999", "0.999"],
    "support": [[0, "0"], [0, "1"]],
    "lower": "0.9989",
    "upper": "1.0001",
    **NONE,
}
TOUCH = {
    "kind": "touch",
    "variable": "t",
    "panels": [VELOCITY],
    "functional": ["0", "1"],
    "bits": 80,
    "cells": 10,
    **alone(["-1", "1"], [(0, "0", "-0.5"), (0, "1", "0.5")], ["0.000001"] * 6),
    "lower": "0.9999999",
    "upper": "1.0000001",
    **NONE,
}
# Second coefficient on [0, 1]: contacts 0, 1/2, 1, optimum 8.
PARABOLA = {
    "kind": "touch",
    "variable": "t",
    "functional": ["0", "0", "1"],
    "bits": 90,
    "cells": 20,
    "panels": [{"measurement": 0, "from": "0", "to": "1", "sigma": "1", "H": ["1", "t", "t**2"]}],
    **alone(["1", "-8", "8"], [(0, "0", "2"), (0, "0.5", "-4"), (0, "1", "2")], ["0.0000001"] * 9),
    "lower": "7.99999",
    "upper": "8.00001",
    **NONE,
}
# The same from far away: Newton's step needs the direction of the contact, its length, and the weights that it moves.
COARSE = PARABOLA | {
    **alone(
        ["1", "-8", "8"],
        [(0, "0", "2"), (0, "0.501", "-4"), (0, "1", "2")],
        [*["0.0005"] * 3, "0.001", "0.0015", "0.001", *["0.001"] * 3],
    ),
    "lower": "7.99",
    "upper": "8.01",
}
# The second coefficient for every T in [1, 1.02]: contacts 0, T/2, T, weights 2, -4, 2 over T**2.
W1 = ["1.9605920988", "-0.038823605", "0.0005765882", "-0.000007611"]
W2 = ["-3.921184197", "0.0776472118", "-0.001153176", "0.0000152234"]
RANGE = {
    "kind": "range",
    "variable": "t",
    "functional": ["0", "0", "1"],
    "bits": 90,
    "cells": 20,
    "panels": [{"measurement": 0, "from": "0", "to": "T", "sigma": "1", "H": ["1", "t", "t**2"]}],
    "parameter": "T",
    "from": "1",
    "to": "1.02",
    "lower": "7.6",
    "upper": "8.1",
    "pieces": [
        {
            "from": "1",
            "to": "1.02",
            "basis": unit(3),
            "dual": [
                ["1"],
                ["-7.920792079", "0.0784236839", "-0.000776472", "0.0000076878"],
                ["7.8423683952", "-0.155294423", "0.0023063528", "-0.000030446"],
            ],
            "contacts": [
                {"panel": 0, "at": ["0"], "weight": W1},
                {"panel": 0, "at": ["0.5"], "weight": W2},
                {"panel": 0, "at": ["1"], "weight": W1},
            ],
            "radius": ["0.003"] * 9,
        }
    ],
}
# One number seen with noise bound 2 on [0, 1], and the number times p for p in [1, 1.1].
CONSTANT = {
    "kind": "touch",
    "variable": "t",
    "functional": ["1"],
    "bits": 80,
    "cells": 10,
    "panels": [{"measurement": 0, "from": "0", "to": "1", "sigma": "2", "H": ["2 - t"]}],
    **alone(["1"], [(0, "0", "1")], ["0.000001"] * 3),
    "lower": "0.99999",
    "upper": "1.00001",
    **NONE,
}
SLIVER = {
    "kind": "sliver",
    "variable": "t",
    "functional": ["p"],
    "bits": 80,
    "cells": 10,
    "parameter": "p",
    "from": "1",
    "to": "1.1",
    "panels": [{"measurement": 0, "from": "0", "to": "p", "sigma": "1", "H": ["1 - t/p"]}],
    "dual": ["0.999"],
    "support": [[0, "0"]],
    "lower": "0.998",
    "upper": "1.11",
}
# The line 1 + t - p t seen for p in [1, 1.02] with a noise bound that depends on p, on [0, p]: all of it at t = 0.
MOVING = {
    "kind": "range",
    "variable": "t",
    "functional": ["p**2"],
    "bits": 90,
    "cells": 20,
    "panels": [{"measurement": 0, "from": "0", "to": "p", "sigma": "1 + p/10", "H": ["p + 1 - t*p"]}],
    "parameter": "p",
    "from": "1",
    "to": "1.02",
    "lower": "0.54",
    "upper": "0.58",
    "pieces": [
        {
            "from": "1",
            "to": "1.02",
            "basis": [["1"]],
            "dual": [["0.547761194029850", "-0.00222766763198", "0.000011082923542"]],
            "contacts": [
                {"panel": 0, "at": ["0"], "weight": ["0.558771194029850", "0.008792332368010", "0.000021082923542"]}
            ],
            "radius": ["0.000001"] * 3,
        }
    ],
}
# The slope for every T in [1, 1.02] in two pieces, seen as (1, 1 + t).
SLOPES = {
    "kind": "range",
    "variable": "t",
    "functional": ["0", "1"],
    "bits": 90,
    "cells": 20,
    "panels": [{"measurement": 0, "from": "0", "to": "T", "sigma": "1", "H": ["1", "t"]}],
    "parameter": "T",
    "from": "1",
    "to": "51/50",
    "lower": "1.9",
    "upper": "2.1",
    "pieces": [
        {
            "from": ends[0],
            "to": ends[1],
            "basis": [["1", "0"], ["1", "1"]],
            "dual": [["-2.98019801980198", rise, "-0.00019411802958"], ["1.98019801980198", fall, "0.000194118029585"]],
            "contacts": [
                {"panel": 0, "at": ["0"], "weight": ["-0.99009900990099"]},
                {"panel": 0, "at": ["1"], "weight": ["0.99009900990099"]},
            ],
            "radius": ["0.05"] * 6,
        }
        for ends, rise, fall in ((("1", "1.01"), "0.01", "-0.01"), (("1.01", "51/50"), "0.01", "-0.01"))
    ],
}
# One number whose regressor is largest at an end of [0, 1], where its slope is nearly zero.
FLAT = {
    "kind": "touch",
    "variable": "t",
    "functional": ["1"],
    "bits": 400,
    "cells": 0,
    "panels": [{"measurement": 0, "from": "0", "to": "1", "sigma": "1", "H": ["1 + (t - 1)/10**45 - (t - 1)**2/2"]}],
    **alone(["1"], [(0, "1", "1")], ["0.000001"] * 3),
    "lower": "0.99999",
    "upper": "1.00001",
    **NONE,
}
# The same at the other end, of the other sign, beside a second panel that is not needed.
FLAT_LEFT = FLAT | {
    "panels": [
        {"measurement": 1, "from": "0", "to": "1", "sigma": "1", "H": ["t/2 - 1/4"]},
        {"measurement": 0, "from": "0", "to": "1", "sigma": "1", "H": ["t/10**45 + t**2/2 - 1"]},
    ],
    **alone(["1"], [(1, "0", "-1")], ["0.000001"] * 3),
}
# Bounds that are met exactly: the optimum 2 from below, the cost 2 from above.
EXACT = {
    "kind": "gap",
    "variable": "t",
    "functional": ["1"],
    "bits": 53,
    "cells": 20000,
    "dual": ["0.5"],
    "support": [[0, "1"]],
    "panels": [{"measurement": 0, "from": "0", "to": "1", "sigma": "1", "H": ["t"]}],
    "lower": "0.5",
    "upper": "1",
    **NONE,
}
# Positive on this box and no larger one.
EDGE = {
    "kind": "positivity",
    "expression": "x*(1 - x)*(y + 2)*(3 - y)",
    "bits": 53,
    "cells": 20000,
    "box": {"x": ["0.01", "0.99"], "y": ["-1.99", "2.99"]},
}
# As many cells as 14 announced ones allow: 255.
CELLS = {"kind": "positivity", "expression": "x - x + 1/65", "bits": 64, "cells": 14, "box": {"x": ["0", "1"]}}
IDENTITY = {"kind": "identity", "left": "sin(2*a)", "right": "2*sin(a)*cos(a)", "symbols": ["a"]}
EXPONENTIAL = {
    "kind": "exponential",
    "matrix": [["0", "1"], ["-w**2", "0"]],
    "variable": "t",
    "symbols": ["w"],
    "solution": [["cos(w*t)", "sin(w*t)/w"], ["-w*sin(w*t)", "cos(w*t)"]],
}
RANK = {
    "kind": "rank",
    "matrix": [["a", "b"], ["2*a", "2*b"]],
    "symbols": ["a", "b"],
    "rank": 1,
    "point": {"a": "1", "b": "1/2"},
    "rows": [0],
    "null": [["-b", "a"]],
}
POSITIVITY = {
    "kind": "positivity",
    "expression": "2 - sin(x)*cos(y) - y/10",
    "box": {"x": ["0", "pi"], "y": ["-1", "1"]},
    "bits": 64,
    "cells": 60,
}


def measured(*rows):
    """Measurements (epoch, H, z) with a bound of 1."""
    return [{"epoch": e, "H": H.split(), "z": z, "sigma": "1"} for e, H, z in rows]


# A line through 0 that misses 50 at epoch 2.
EXCLUSION = {
    "kind": "exclusion",
    "rows": measured(
        ("0", "1 0", "0"), ("1", "1 1", "0.5"), ("2", "1 2", "50"), ("3", "1 3", "1/2"), ("4", "1 4", "0")
    ),
    "most": 1,
    "excluded": ["2"],
    "contradictions": [[0, 1, 2], [3, 4, 2]],
    "bits": 64,
    "cells": 0,
}
WAVES = EXCLUSION | {"rows": measured(*((str(k), f"cos({k}/5) sin({k}/5)", "50" if k == 2 else "0") for k in range(5)))}
# The row of epoch 1 has weight zero in the first contradiction, and that of epoch 0 in the second.
APART = EXCLUSION | {
    "rows": measured(("0", "1 0", "0"), ("1", "0 1", "0"), ("2", "1 0", "-50"), ("2", "0 1", "50")),
    "contradictions": [[0, 1, 2], [0, 1, 3]],
}
ALMOST = EXCLUSION | {"rows": measured(*((str(k), f"1 {k}", "4.001" if k == 2 else "0") for k in range(5)))}
NONE_GROSS = EXCLUSION | {"most": 0}
SURE = APART | {"rows": [row | {"sigma": "0"} for row in APART["rows"]]}
# Four gross errors and five contradictions without a common epoch but one: 1 + 4 + 16 + 64 + 256 sets are looked at.
UNITS = ("1 0 0 0", "0 1 0 0", "0 0 1 0", "0 0 0 1")
FOUR = EXCLUSION | {
    "rows": measured(*((str(k), UNITS[k % 4], "0") for k in range(20)), ("20", "1 1 1 1", "9")),
    "contradictions": [[4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3, 20] for k in range(5)],
    "excluded": ["20"],
    "most": 4,
    "cells": 36,
}
# Vector measurements with a bound of each norm; the dual is 1 on the first.
CONES = {
    "kind": "cones",
    "functional": ["1"],
    "dual": ["1"],
    "lower": "1",
    "upper": "1.0001",
    "bits": 64,
    "blocks": [
        {"H": [["3/5"], ["4/5"]], "norm": "l2", "size": [["1", "0"], ["0", "1"]], "weights": ["3/5", "4/5"]},
        {"H": [["1/2"]], "norm": "linf", "size": [["1"]], "weights": ["0"]},
        {"H": [["1/4"], ["1/4"]], "norm": "l1", "size": [["1"], ["1"]], "weights": ["0", "0"]},
    ],
}
# The weight of the first at least 1/2, both together at most 1: what is left of the two is 0 and 1/4.
LIMITED = CONES | {
    "functional": ["1", "1/2", "1"],
    "dual": ["1/2", "1/2", "0"],
    "lower": "3/4",
    "upper": "3/4",
    "blocks": [
        {"H": [["1", "1", "1"]], "norm": "linf", "size": [["1"]], "weights": ["1/2"]},
        {"H": [["2", "0", "1"]], "norm": "linf", "size": [["1"]], "weights": ["1/4"]},
        {"H": [["0", "-1", "0"], ["0", "0", "1"]], "norm": "nonpositive", "size": [], "weights": ["0", "1/4"]},
    ],
}
# Two of four positions, each at the price of 1: a slope is best known from the ends.
DESIGN = {
    "kind": "design",
    "functional": ["0", "1"],
    "support": [0, 3],
    "lower": "0.6666",
    "upper": "0.6667",
    "bits": 64,
    "cells": 0,
    "budget": "2",
    "costs": {"a": "1", "b": "1", "c": "1", "d": "1"},
    "duals": [["-0.9999", "0.66663"]],
    "rows": [{"H": ["1", str(k)], "sigma": "1", "needs": [name]} for k, name in enumerate("abcd")],
}
# A sine at an irrational place needs one row only, and the unit vector has a weight that is exactly zero.
LONELY = DESIGN | {
    "functional": ["0", "sin(1)"],
    "support": [1, 2],
    "lower": "0.99",
    "upper": "1.01",
    "duals": [["0", "1.18"]],
    "rows": [{"H": ["1", "0"], "sigma": "1", "needs": ["a"]}, {"H": ["0", "sin(1)"], "sigma": "1", "needs": ["b"]}],
}
# One row at the price of 4 does it, or five rows with one of each kind: 1 + 4 + 16 + 64 + 256 purchases are looked at.
MANY = DESIGN | {
    "functional": ["1"] * 5,
    "support": [0, 21, 22, 23, 24],
    "lower": "1",
    "upper": "1",
    "cells": 36,
    "budget": "4",
    "costs": {"all": "4"} | {f"{kind}{k}": "1" for kind in "abcde" for k in range(4)},
    "duals": [[str(int(i == j)) for i in range(5)] for j in range(5)],
    "rows": [{"H": ["1"] * 5, "sigma": "1", "needs": ["all"]}]
    + [
        {"H": [str(2 * (i == j)) for i in range(5)], "sigma": "1", "needs": [f"{kind}{k}"]}
        for j, kind in enumerate("abcde")
        for k in range(4)
    ],
}
# One row; and a dual that is a little off inside its box, as the bounds are not.
ROW = RANK | {"matrix": [["a", "b"]]}
OFFSET = (
    CONSTANT
    | alone(["1.0000003"], [(0, "0", "1.0000002")], ["0.000001"] * 3)
    | {"lower": "0.99999999", "upper": "1.00000001"}
)
DIGITS = CELLS | {"bits": 20000, "cells": 2000}
# Announced work: none, and as much as a precision of a thousand bits allows.
AT_ONCE = CELLS | {"expression": "x + 1", "cells": 0}
NO_CELLS, MANY_CELLS = GAP | {"cells": 0}, GAP | {"bits": 1000, "cells": 15000}
# A wave that comes near its bound so often that one announced cell less is too few.
TIGHT = EXACT | {
    "bits": 64,
    "cells": 210,
    "dual": ["99/100"],
    "support": [[0, "1/97"]],
    "upper": "1000",
    "panels": [{"measurement": 0, "from": "0", "to": "10", "sigma": "1", "H": ["sin(20*t)"]}],
}
# With three panels more the cells are 4 cells + 200 to the last; with four there is one too many.
MORE = [{"measurement": k, "from": "0", "to": "1", "sigma": "1", "H": ["t/9"]} for k in (1, 2, 3, 4)]
EVEN, UNEVEN = (TIGHT | {"panels": [*TIGHT["panels"], *MORE[:n]]} for n in (3, 4))


def remainder(tenths):
    """exp_0(-1) - exp(-1) and so many tenths of 1/60!: the series of the kernel is cut at that size."""
    return f"0*x + exp_0(0 - 1) - exp(0 - 1) + {tenths}/{10 * factorial(60)}"


REMAINDER = {"kind": "positivity", "expression": remainder(43), "bits": 400, "cells": 0, "box": {"x": ["0", "1"]}}
KERNEL = AT_ONCE | {"expression": "exp_2(1) + x"}
NOTHING = {
    "kind": "rank",
    "matrix": [["a - a", "0"]],
    "symbols": ["a"],
    "rank": 0,
    "point": {"a": "1"},
    "rows": [],
    "null": [["1", "0"], ["0", "1"]],
}
# A chain of integrators: entries of the solution that do not move.
CHAIN = EXPONENTIAL | {"matrix": [["0", "1"], ["0", "0"]], "symbols": [], "solution": [["1", "t"], ["0", "1"]]}
# As many panels as cells are allowed, and each is seen to be good at once.
FULL = EXACT | {
    "cells": 0,
    "dual": ["0.999"],
    "lower": "0.9",
    "upper": "1.1",
    "panels": [{"measurement": 0, "from": "0", "to": "1", "sigma": "1", "H": ["(2*t - 1)**14"]}] * 199,
}
# As many as are allowed; the one with the contact is good at once by Taylor's formula, its last term in its place.
LAST = (
    CONSTANT
    | {
        "cells": 0,
        "panels": [
            {"measurement": 0, "from": "0", "to": "1", "sigma": "1", "H": ["1 + 3/2*(t - 1) + 3/50*(t - 1)**15"]},
            *[{"measurement": 1, "from": "0", "to": "1", "sigma": "1", "H": ["t/9"]}] * 199,
        ],
    }
    | alone(["1"], [(0, "1", "1")], ["0.000001"] * 3)
)
# A root of what vanishes identically is zero.
ROOT_OF_ZERO = GAP | {"panels": [VELOCITY | {"H": ["1 + sqrt(0*t)", "t"]}]}
ALL = {"kind": "all", "of": [IDENTITY, RANK]}
# Singular values of [[1, 0], [0, 3], [0, 4]]: 1 and 5; with unit columns both are 1.
CONDITION = {
    "kind": "condition",
    "statement": {"matrix": [["1", "0"], ["0", "3"], ["0", "4"]], "unit": 0, "lower": "4.9", "upper": "5.1"},
    "outside": 0,
    "brackets": ["24.9", "25.1", "0.999", "1.001"],
    "bits": 64,
}
SCALED = CONDITION | {
    "statement": CONDITION["statement"] | {"unit": 1, "lower": "4.9", "upper": "5.1"},
    "outside": 1,
    "brackets": ["0.99", "1.01", "0.999", "1.001"],
}
# Ten times as long: singular values 10 and 50, whose quotient is below ten.
TENFOLD = CONDITION | {
    "statement": CONDITION["statement"] | {"matrix": [["10", "0"], ["0", "30"], ["0", "40"]]},
    "brackets": ["2490", "2510", "99.9", "100.1"],
}
# Singular values whose squares are 45 and 5: near them a pivot may have either sign.
LEANING = CONDITION | {
    "statement": {"matrix": [["3", "0"], ["4", "5"]], "unit": 0, "lower": "2.9", "upper": "3.1"},
    "brackets": ["44.9", "45.1", "4.9", "5.1"],
}
BELOW_TEN = TENFOLD | {"outside": 1, "statement": TENFOLD["statement"] | {"lower": "10", "upper": "12"}}
# A velocity with tilt and bias under a force f that grows at the rate r: where r = 0 stays, (0, 1, -f) is not seen.
STILL = {
    "kind": "observability",
    "statement": {
        "F": [["0", "f", "1"], ["0", "0", "0"], ["0", "0", "0"]],
        "H": [["1", "0", "0"]],
        "rates": {"f": "r"},
        "zeros": ["r"],
        "rank": 2,
    },
    "point": {"f": "2", "r": "0"},
    "order": 3,
    "free": [1],
    "null": [["0", "1", "-f"]],
    "shares": [["0"], ["0"], ["0"], ["0"], ["1"]],
    "bits": 128,
}
GROWING = STILL | {
    "statement": STILL["statement"] | {"zeros": [], "rank": 3},
    "point": {"f": "2", "r": "3"},
    "free": [],
    "null": [],
    "shares": [],
}
# On the unit circle, which the motion keeps, its angle is seen; the radius is not where the circle is not said.
CIRCLE = {
    "kind": "observability",
    "statement": {
        "F": [["0", "-w"], ["w", "0"]],
        "H": [["c", "s"]],
        "rates": {"c": "-w*s", "s": "w*c"},
        "zeros": ["c**2 + s**2 - 1"],
        "rank": 1,
    },
    "point": {"c": "3/5", "s": "4/5", "w": "2"},
    "order": 2,
    "free": [1],
    "null": [["-s", "c"]],
    "shares": [["0"], ["0"], ["0"], ["0"]],
    "bits": 128,
}
PLAIN = {"kind": "observability", "order": 1, "shares": [], "bits": 53}
TWO = PLAIN | {
    "statement": {"F": [["0"] * 3] * 3, "H": [["1", "0", "0"]], "rates": {}, "zeros": [], "rank": 1},
    "point": {},
    "free": [1, 2],
    "null": [["0", "1", "0"], ["0", "0", "1"]],
}
PIVOT = PLAIN | {
    "statement": {"F": [["0", "0"]] * 2, "H": [["1", "0"]], "rates": {}, "zeros": [], "rank": 1},
    "point": {"a": "1"},
    "free": [1],
    "null": [["0", "a"]],
}
# A direction whose length grows: M is the rate of its logarithm.
DRIVEN = PIVOT | {"statement": PIVOT["statement"] | {"rates": {"a": "2*a"}}, "point": {"a": "3"}}
# Two columns that almost point in one direction: the small singular value comes from an elimination.
ALIKE = {
    "kind": "condition",
    "bits": 256,
    "outside": 0,
    "brackets": [
        "19999999999981109/10000000000000000",
        "20000000000021109/10000000000000000",
        "12318413951960607/1000000000000000000000000000000",
        "3079603487996311/250000000000000000000000000000",
    ],
    "statement": {
        "matrix": [["1", "1/6371000"], ["1", "1/3185500"]],
        "unit": 0,
        "lower": "1274199987/100",
        "upper": "1274200013/100",
    },
}
GOOD = [
    ALIKE,
    CONDITION,
    SCALED,
    TENFOLD,
    BELOW_TEN,
    LEANING,
    DRIVEN,
    STILL,
    GROWING,
    CIRCLE,
    TWO,
    PIVOT,
    IDENTITY,
    ROW,
    OFFSET,
    DIGITS,
    EXPONENTIAL,
    RANK,
    EXCLUSION,
    WAVES,
    APART,
    ALMOST,
    NONE_GROSS,
    SURE,
    FOUR,
    CONES,
    LIMITED,
    DESIGN,
    LONELY,
    MANY,
    POSITIVITY,
    EDGE,
    CELLS,
    ALL,
    CHAIN,
    FULL,
    TIGHT,
    EVEN,
    REMAINDER,
    KERNEL,
    NOTHING,
    AT_ONCE,
    NO_CELLS,
    MANY_CELLS,
    GAP,
    ROOT_OF_ZERO,
    EXACT,
    SLIVER,
    TOUCH,
    PARABOLA,
    COARSE,
    CONSTANT,
    FLAT,
    LAST,
    FLAT_LEFT,
    RANGE,
    MOVING,
    SLOPES,
]
