"""The independent checker accepts what is true and refuses every forgery, each for its own reason."""

from __future__ import annotations

import copy
import json
import random

import pytest

from navsym.checker import Refused, check, load

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
# The slope for every T in [1, 1.01]: weights 1/T, dual 2 t/T - 1.
RANGE = {
    "kind": "range", "variable": "t", "functional": ["0", "1"], "bits": 90, "cells": 20,
    "panels": [{"measurement": 0, "from": "0", "to": "T", "sigma": "1", "H": ["1", "t"]}],
    "parameter": "T", "from": "1", "to": "1.01",
    "pieces": [{
        "from": "1", "to": "1.01", "basis": [["1", "0"], ["0", "1"]],
        "dual": [["-1"], ["1.99004975", "-0.009900745"]],
        "contacts": [
            {"panel": 0, "at": [], "end": "from", "sign": -1, "weight": ["-0.9950248756", "0.004950373"]},
            {"panel": 0, "at": [], "end": "to", "sign": 1, "weight": ["0.9950248756", "-0.004950373"]},
        ],
        "radius": ["0.001", "0.001", "0.001", "0.001"],
    }],
}  # fmt: skip
IDENTITY = {"kind": "identity", "left": "sin(2*a)", "right": "2*sin(a)*cos(a)", "symbols": ["a"]}
EXPONENTIAL = {
    "kind": "exponential", "matrix": [["0", "1"], ["-w**2", "0"]], "variable": "t", "symbols": ["w"],
    "solution": [["cos(w*t)", "sin(w*t)/w"], ["-w*sin(w*t)", "cos(w*t)"]],
}  # fmt: skip
RANK = {
    "kind": "rank", "matrix": [["a", "b"], ["2*a", "2*b"]], "symbols": ["a", "b"], "rank": 1,
    "point": {"a": "1", "b": "1/2"}, "rows": [0], "columns": [0], "null": [["-b", "a"]],
}  # fmt: skip
POSITIVITY = {
    "kind": "positivity", "expression": "2 - sin(x)*cos(y) - y/10", "box": {"x": ["0", "pi"], "y": ["-1", "1"]},
    "bits": 64, "cells": 60,
}  # fmt: skip
GOOD = [GAP, TOUCH, PARABOLA, RANGE, IDENTITY, EXPONENTIAL, RANK, POSITIVITY]


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


def verdict(item) -> str:
    """Empty when accepted, else the reason."""
    try:
        check(load(json.dumps(item)))
    except Refused as why:
        return str(why)
    return ""


@pytest.mark.parametrize("item", GOOD, ids=lambda item: item["kind"])
def test_a_true_certificate_is_accepted(item):
    assert verdict(item) == ""


FORGERIES = [
    (IDENTITY, ["right"], "2*sin(a)*cos(a)*1.0000001", "the sides differ"),
    (IDENTITY, ["right"], "2*sin(a)*cos(b)", "unknown name"),
    (IDENTITY, ["right"], "sin(2*a) + 0/(a - a)", "division by zero"),
    (IDENTITY, ["kind"], "unheard-of", "known kind"),
    (IDENTITY, ["symbols"], ["a", 1], "expected names"),
    (IDENTITY, ["note"], "more", "expected exactly the keys"),
    (IDENTITY, ["left"], ..., "expected exactly the keys"),
    (EXPONENTIAL, ["solution", 0, 1], "sin(w*t)", "X' differs"),
    (EXPONENTIAL, ["solution"], [["2*cos(w*t)", "2*sin(w*t)/w"], ["-2*w*sin(w*t)", "2*cos(w*t)"]], "X\\(0\\) differs"),
    (EXPONENTIAL, ["variable"], "w", "not a symbol"),
    (RANK, ["null"], [["b", "a"]], "does not vanish"),
    (RANK, ["null"], [["0", "0"]], "may be dependent"),
    (RANK, ["point"], {"a": "0", "b": "1/2"}, "minor may vanish"),
    (RANK, ["point"], {"a": "1"}, "point gives every symbol"),
    (RANK, ["rank"], 2, "entries"),
    (POSITIVITY, ["expression"], "0.9 - sin(x)*cos(y)", "not shown to be positive"),
    (POSITIVITY, ["box", "x"], ["0"], "entries"),
    (GAP, ["dual"], ["-1.001", "1.001"], "is not shown"),
    (GAP, ["lower"], "0.9991", "lower bound is above"),
    (GAP, ["upper"], "0.9999", "cost more"),
    (GAP, ["support"], [[0, "0"], [0, "1.5"]], "outside its panel"),
    (GAP, ["support"], [[0, "0"], [0, "0"]], "singular"),
    (GAP, ["panels", 0, "sigma"], "0", "positive"),
    (GAP, ["panels", 0, "to"], "0", "positive"),
    (GAP, ["panels", 0, "H"], ["1", "t", "t**2"], "one regressor for each"),
    (GAP, ["dual"], ["-0.999", "0.999", "0"], "entries"),
    (GAP, ["bits"], 10, "integer from"),
    (GAP, ["cells"], True, "integer from"),
    (TOUCH, ["contacts", 0, "sign"], 1, "Krawczyk"),
    (TOUCH, ["contacts", 0, "sign"], 2, "end and sign"),
    (TOUCH, ["contacts", 0, "end"], "start", "end and sign"),
    (TOUCH, ["radius"], ["0"] * 4, "radius"),
    (TOUCH, ["radius"], ["0.000001"] * 3, "entries"),
    (TOUCH, ["dual"], [["-1.1"], ["1"]], "Krawczyk"),
    (TOUCH, ["upper"], "0.99999991", "not between the bounds"),
    (PARABOLA, ["contacts", 1, "at"], ["0.51"], "Krawczyk"),
    (RANGE, ["to"], "1.02", "do not reach the end"),
    (RANGE, ["from"], "0.99", "leave a hole"),
    (RANGE, ["pieces", 0, "basis"], [["1", "1"], ["1", "1"]], "singular basis"),
    (RANGE, ["panels", 0, "to"], "1.01", "ends at the parameter"),
    (RANGE, ["pieces", 0, "dual"], [["-1"], ["1.99004975", "0.009900745"]], "Krawczyk"),
]  # fmt: skip


@pytest.mark.parametrize(("item", "path", "value", "why"), FORGERIES, ids=lambda x: str(x)[:24])
def test_each_forgery_is_refused_for_its_own_reason(item, path, value, why):
    import re

    assert re.search(why, verdict(changed(item, path, value)))


def test_a_contact_outside_the_interval_is_refused():
    """The same parabola on [0, 0.4]: the optimality system still has its solution at 1/2, outside."""
    item = changed(PARABOLA, ["panels", 0, "to"], "0.4")
    forged = changed(item, ["dual"], [["1"], ["-8"], ["8"]])
    forged["contacts"] = [
        {"panel": 0, "at": [], "end": "from", "sign": 1, "weight": ["2"]},
        {"panel": 0, "at": ["1.25"], "end": "no", "sign": -1, "weight": ["-4"]},
        {"panel": 0, "at": ["0"], "end": "no", "sign": 1, "weight": ["2"]},
    ]
    assert verdict(forged)


def test_an_extra_contact_with_a_weight_of_the_wrong_sign_is_refused():
    """T = 0.8 for the functional of the value at zero: the alternating solution has a wrong sign."""
    item = copy.deepcopy(PARABOLA)
    item["functional"] = ["1", "0", "0"]
    item["contacts"][0]["weight"], item["contacts"][1]["weight"], item["contacts"][2]["weight"] = (
        ["1"],
        ["-1"],
        ["1"],
    )
    assert verdict(item)


def test_branches_of_roots_are_all_tried():
    false = {"kind": "identity", "left": "sqrt(x**2)", "right": "x", "symbols": ["x"]}
    assert all(verdict(false) for _ in range(40))
    true = {"kind": "identity", "left": "1/(sqrt(x) + 1)", "right": "(sqrt(x) - 1)/(x - 1)", "symbols": ["x"]}
    assert verdict(true) == ""


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("cos(pi/12)", "(sqrt(6) + sqrt(2))/4"),
        ("cos(pi/5)", "(1 + sqrt(5))/4"),
        ("tan(T/4)", "(1 - cos(T/2))/sin(T/2)"),
        ("cosh(x)**2 - sinh(x)**2", "1"),
        ("exp(x + y)", "exp(x)*exp(y)"),
        ("lambda*x", "x*lambda"),
        ("0.5*x", "x/2"),
        ("sin(x + pi/2)", "cos(x)"),
    ],
)
def test_identities_of_school_are_accepted(left, right):
    symbols = ["T", "x", "y", "lambda"]
    assert verdict({"kind": "identity", "left": left, "right": right, "symbols": symbols}) == ""


@pytest.mark.parametrize(
    "text",
    [
        "1e5",
        "0x10",
        "1_0",
        "__import__",
        "x.y",
        "x[0]",
        "lambda: 1",
        "x if y else z",
        "x;y",
        "'a'",
        "x**y",
        "f(x, y)",
        "",
        "((",
        "х",
    ],
)
def test_anything_outside_the_language_is_refused(text):
    assert verdict({"kind": "identity", "left": text, "right": text, "symbols": ["x", "y"]})


@pytest.mark.parametrize(
    "text",
    [
        '{"kind": "gap", "kind": "gap"}',
        '{"bits": 1.5}',
        '{"bits": NaN}',
        '{"bits": Infinity}',
        "[1,",
        "[" * 100000,
    ],
)
def test_floats_duplicates_and_broken_json_are_refused(text):
    with pytest.raises(Refused):
        check(load(text))


def alterations(item, rng):
    """One random change of a number, a sign, a name or a list, at any depth."""
    forged = copy.deepcopy(item)
    places = []

    def walk(node, path):
        children = node.items() if isinstance(node, dict) else enumerate(node)
        for key, child in children:
            places.append((*path, key))
            if isinstance(child, dict | list):
                walk(child, (*path, key))

    walk(forged, ())
    path = rng.choice([p for p in places if p[-1] not in ("cells", "bits", "measurement", "radius")])
    node = forged
    for key in path[:-1]:
        node = node[key]
    old = node[path[-1]]
    if isinstance(old, str) and old.replace(".", "").replace("-", "").isdigit():
        node[path[-1]] = rng.choice(
            [old + "1" if "." in old else old + ".1", "-" + old if old[0] != "-" else old[1:], "7"]
        )
    elif isinstance(old, int):
        node[path[-1]] = rng.choice([-old - 1, old + 1, "1", 0.5])
    elif isinstance(old, str):
        node[path[-1]] = rng.choice([old + "*2", "no", "1/0", ""])
    else:
        node[path[-1]] = rng.choice([[], {}, None, "1"])
    return forged, path, old, node[path[-1]]


def harmless(path, old, new) -> bool:
    """Changes that leave the statement true: bounds made wider, another label, a hint moved within its box."""
    return (
        old == new or path[-1] in ("lower", "upper", "variable", "kind") or "radius" in path or "null" in path
    )


def test_random_alterations_do_not_pass():
    rng = random.Random(3)
    passed = []
    for _ in range(400):
        item = rng.choice([GAP, TOUCH, PARABOLA, RANGE, EXPONENTIAL])
        forged, path, old, new = alterations(item, rng)
        if not harmless(path, old, new) and verdict(forged) == "":
            passed.append((item["kind"], path, old, new))
    # A digit appended far behind stays inside the box that is proved: the certificate is still true.
    assert [p for p in passed if not still_true(p)] == []


def still_true(case) -> bool:
    kind, path, old, new = case
    try:
        size = abs(float(new) - float(old))
    except (TypeError, ValueError):
        return False
    return size < 0.01 * max(1.0, abs(float(old))) or (kind == "gap" and path[0] in ("support", "dual"))
