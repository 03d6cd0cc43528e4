"""Honest certificates, one of every kind, which the tests forge."""

from __future__ import annotations

VELOCITY = {"measurement": 0, "from": "0", "to": "2", "sigma": "1", "H": ["1", "t"]}
# Slope of a line on [0, 2]: weights -1/2 and 1/2 at the ends, dual polynomial t - 1, optimum 1.
GAP = {
    "kind": "gap", "variable": "t", "panels": [VELOCITY], "functional": ["0", "1"], "bits": 80, "cells": 40,
    "dual": ["-0.999", "0.999"], "support": [[0, "0"], [0, "1"]], "lower": "0.9989", "upper": "1.0001",
}  # fmt: skip
TOUCH = {
    "kind": "touch", "variable": "t", "panels": [VELOCITY], "functional": ["0", "1"], "bits": 80, "cells": 10,
    "dual": [["-1"], ["1"]],
    "contacts": [
        {"panel": 0, "at": [], "end": "from", "sign": -1, "weight": ["-0.5"]},
        {"panel": 0, "at": [], "end": "to", "sign": 1, "weight": ["0.5"]},
    ],
    "radius": ["0.000001"] * 4, "lower": "0.9999999", "upper": "1.0000001",
}  # fmt: skip
# Second coefficient on [0, 1]: contacts 0, 1/2, 1, optimum 8.
PARABOLA = {
    "kind": "touch", "variable": "t", "functional": ["0", "0", "1"], "bits": 90, "cells": 20,
    "panels": [{"measurement": 0, "from": "0", "to": "1", "sigma": "1", "H": ["1", "t", "t**2"]}],
    "dual": [["1"], ["-8"], ["8"]],
    "contacts": [
        {"panel": 0, "at": [], "end": "from", "sign": 1, "weight": ["2"]},
        {"panel": 0, "at": ["0.5"], "end": "no", "sign": -1, "weight": ["-4"]},
        {"panel": 0, "at": [], "end": "to", "sign": 1, "weight": ["2"]},
    ],
    "radius": ["0.0000001"] * 7, "lower": "7.99999", "upper": "8.00001",
}  # fmt: skip
# The second coefficient for every T in [1, 1.02]: contacts 0, T/2, T, weights 2, -4, 2 over T**2.
W1 = ["1.9605920988", "-0.038823605", "0.0005765882", "-0.000007611"]
W2 = ["-3.921184197", "0.0776472118", "-0.001153176", "0.0000152234"]
RANGE = {
    "kind": "range", "variable": "t", "functional": ["0", "0", "1"], "bits": 90, "cells": 20,
    "panels": [{"measurement": 0, "from": "0", "to": "T", "sigma": "1", "H": ["1", "t", "t**2"]}],
    "parameter": "T", "from": "1", "to": "1.02",
    "pieces": [{
        "from": "1", "to": "1.02", "basis": [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]],
        "dual": [
            ["1"],
            ["-7.920792079", "0.0784236839", "-0.000776472", "0.0000076878"],
            ["7.8423683952", "-0.155294423", "0.0023063528", "-0.000030446"],
        ],
        "contacts": [
            {"panel": 0, "at": [], "end": "from", "sign": 1, "weight": W1},
            {"panel": 0, "at": ["0.5"], "end": "no", "sign": -1, "weight": W2},
            {"panel": 0, "at": [], "end": "to", "sign": 1, "weight": W1},
        ],
        "radius": ["0.003"] * 7,
    }],
}  # fmt: skip
# One number seen with noise bound 2 on [0, 1], and the number times p for p in [1, 1.1].
CONSTANT = {
    "kind": "touch", "variable": "t", "functional": ["1"], "bits": 80, "cells": 10,
    "panels": [{"measurement": 0, "from": "0", "to": "1", "sigma": "2", "H": ["2 - t"]}],
    "dual": [["1"]], "contacts": [{"panel": 0, "at": [], "end": "from", "sign": 1, "weight": ["1"]}],
    "radius": ["0.000001"] * 2, "lower": "0.99999", "upper": "1.00001",
}  # fmt: skip
SLIVER = {
    "kind": "sliver", "variable": "t", "functional": ["p"], "bits": 80, "cells": 10, "parameter": "p", "from": "1",
    "to": "1.1", "panels": [{"measurement": 0, "from": "0", "to": "p", "sigma": "1", "H": ["1 - t/p"]}],
    "dual": ["0.999"], "support": [[0, "0"]], "lower": "0.998", "upper": "1.11",
}  # fmt: skip
IDENTITY = {"kind": "identity", "left": "sin(2*a)", "right": "2*sin(a)*cos(a)", "symbols": ["a"]}
EXPONENTIAL = {
    "kind": "exponential", "matrix": [["0", "1"], ["-w**2", "0"]], "variable": "t", "symbols": ["w"],
    "solution": [["cos(w*t)", "sin(w*t)/w"], ["-w*sin(w*t)", "cos(w*t)"]],
}  # fmt: skip
RANK = {
    "kind": "rank", "matrix": [["a", "b"], ["2*a", "2*b"]], "symbols": ["a", "b"], "rank": 1,
    "point": {"a": "1", "b": "1/2"}, "rows": [0], "null": [["-b", "a"]],
}  # fmt: skip
POSITIVITY = {
    "kind": "positivity", "expression": "2 - sin(x)*cos(y) - y/10", "box": {"x": ["0", "pi"], "y": ["-1", "1"]},
    "bits": 64, "cells": 60,
}  # fmt: skip
ALL = {"kind": "all", "of": [IDENTITY, RANK]}
GOOD = [GAP, TOUCH, PARABOLA, RANGE, CONSTANT, SLIVER, IDENTITY, EXPONENTIAL, RANK, POSITIVITY, ALL]
