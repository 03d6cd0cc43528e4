"""Forgeries by kind of trick: every one of them is false, or no certificate at all, and has to be refused.

:func:`tricks` yields (name, certificate); tests/checker/forgeries.py holds the single ones that fail at one check only.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from tests.checker.examples import (
    CONSTANT,
    EXPONENTIAL,
    GAP,
    MOVING,
    NONE,
    PARABOLA,
    POSITIVITY,
    RANGE,
    RANK,
    SLIVER,
    SLOPES,
    TOUCH,
    alone,
)
from tests.checker.forgeries import changed, identity

#: What is no number in a certificate, though other readers take some of it for one.
NO_NUMBERS: list[Any] = [
    "",
    " 1",
    "1 ",
    "+1",
    "--1",
    "1.",
    ".5",
    "1..2",
    "1,5",
    "1e5",
    "1E-3",
    "0x10",
    "1_000",
    "1/-2",
    "1//2",
    "1/2/3",
    "1/0",
    "nan",
    "inf",
    "-Infinity",
    "½",
    "١",
    "１",
    "1\n",
    "−1",
    "1+0",
    "pi",
    "10**2",
    "9" * 4001,
    1,
    0,
    0.5,
    True,
    None,
    [],
    {},
    ["1"],
]
#: Ends of a panel in a spelling that is not the agreed one, and what is no place.
ENDS: list[Any] = [["0.0"], ["00"], ["0/1"], ["1.0"], ["2/2"], ["-0"], "0", "1", 0, 1, [0], [1], [], None, ["0", "0"]]
#: False identities: branches, ranges of functions, 0/0, misprints far behind the point.
FALSE = [
    ("sqrt(x**2)", "x"),
    ("sqrt(x**4)", "-x**2"),
    ("(x**3)**(1/3)", "x"),
    ("(x**2)**(3/2)", "x**3"),
    ("abs(x)", "-x"),
    ("abs(x*y)", "x*abs(y)"),
    ("abs(x + y)", "abs(x) + abs(y)"),
    ("sqrt(x*y)", "sqrt(x)*sqrt(y) + 0*x + 1"),
    ("sqrt(x + y)", "sqrt(x) + sqrt(y)"),
    ("(-8)**(1/3)", "-2"),
    ("(-1)**(1/2)*(-1)**(1/2)", "1"),
    ("(-1)**(2/3)", "1"),
    ("(-4)**(1/2)", "2"),
    ("sqrt(2) + sqrt(3)", "sqrt(5)"),
    ("sqrt(2)*sqrt(3)", "sqrt(5)"),
    ("sqrt(8)", "4*sqrt(2)"),
    ("2**(1/3)*2**(1/2)", "2"),
    ("4**(1/4)", "2"),
    ("sqrt(7)", "7**(1/3)"),
    ("12**(1/2)", "3*sqrt(2)"),
    ("sqrt(5)", "4*cos(pi/5) + 1"),
    ("sqrt(3)", "2*sin(pi/6)"),
    ("sqrt(2)", "2*cos(3*pi/4)"),
    ("sqrt(2)", "141421/100000"),
    ("atan(tan(x))", "x"),
    ("asin(sin(x))", "x"),
    ("acos(cos(x))", "x"),
    ("log(x**2)", "2*log(x) + 1"),
    ("log(x*y)", "log(x)*log(y)"),
    ("log(exp(x))", "-x"),
    ("log(1)", "1"),
    ("atan(1)", "pi/3"),
    ("exp(log(x))", "-x"),
    ("exp(x)**2", "exp(x**2)"),
    ("exp(x*y)", "exp(x)*exp(y)"),
    ("exp(x)", "1 + x + x**2/2"),
    ("exp(-x)", "-exp(x)"),
    ("exp(x)*exp(-x)", "0"),
    ("exp(pi)", "pi**exp(0) + 20"),
    ("exp(1)", "2.718281828459045"),
    ("pi", "22/7"),
    ("pi", "3.14159265358979323846264338327950288419716939937510582097494459"),
    ("pi**2", "9.8696"),
    ("exp(pi*sqrt(163))", "262537412640768744"),
    ("sin(x)", "x - x**3/6"),
    ("sin(x)**2 - cos(x)**2", "1"),
    ("sin(x)**2 + cos(x)**2", f"1 + 1/{10**60}"),
    ("sin(x)**2 + cos(y)**2", "1"),
    ("sin(x + y)", "sin(x) + sin(y)"),
    ("sin(x + y)", "sin(x)*cos(y) - cos(x)*sin(y)"),
    ("cos(x + y)", "cos(x)*cos(y) + sin(x)*sin(y)"),
    ("sin(-x)", "sin(x)"),
    ("cos(-x)", "-cos(x)"),
    ("sin(x + 2*pi)", "-sin(x)"),
    ("sin(x + pi)", "sin(x)"),
    ("cos(x + pi/2)", "sin(x)"),
    ("sin(2*x)", "2*sin(x)"),
    ("cos(2*x)", "1 - sin(x)**2"),
    ("sin(3*x)", "3*sin(x) + 4*sin(x)**3"),
    ("tan(x)*cot(x)", "-1"),
    (f"sin(pi/2 + 1/{10**30})", "1"),
    ("sin(3)", "0"),
    ("cos(22/7)", "-1"),
    ("cos(pi/7)", "sin(5*pi/13)"),
    ("cos(2*pi/5) + cos(4*pi/5)", "1/2"),
    ("cos(pi/7) - cos(2*pi/7) + cos(3*pi/7)", "-1/2"),
    ("cos(pi/17)", "0.98297310"),
    ("cosh(x)**2 + sinh(x)**2", "1"),
    ("cosh(x)", "cos(x)"),
    ("tanh(x)", "sinh(x)*cosh(x)"),
    ("sinh(2*x)", "2*sinh(x)"),
    ("sin_1(x)", "sin(x)"),
    ("sin_3(x)*x**3", "sin(x) - x + x**3/6"),
    ("cos_1(x)*x", "cos(x) + 1"),
    ("exp_2(x)", "exp_3(x)*x"),
    ("exp_99(x)", "0"),
    ("1/x", "-1/x"),
    ("1/(x + y)", "1/x + 1/y"),
    ("x/(x + 1)", "1 - 1/x"),
    ("(x + y)**2", "x**2 + y**2"),
    ("x**2**3", "x**6 + x"),
    ("-x**2", "x**2"),
    ("x - y - T", "x - (y - T)"),
    ("x/y/T", "x/(y/T)"),
    ("2**-1", "-2"),
    ("x**0", "0"),
    ("0**0", "0"),
    ("0.1", "0.1000000000000000055511151231257827"),
    ("1/3", "0." + "3" * 200),
    ("lambda", "lambda*x"),
    ("a_1", "a_1*x"),
    ("(x + 1)**50", "(x + 1)**49*(x - 1)"),
    ("(1 + x)**12 - x**12", "(1 + x)**11"),
    # divisions by what vanishes for a reason
    *(
        (f"{k}/({zero})", f"{k + 1}/({zero})")
        for k, zero in enumerate(
            (
                "x - x",
                "0",
                "sin(x)**2 + cos(x)**2 - 1",
                "sqrt(2)**2 - 2",
                "cos(pi/3) - 1/2",
                "exp(x)*exp(-x) - 1",
                "abs(x)**2 - x**2",
                "sqrt(x)**2 - x",
                "(x + y)**2 - x**2 - 2*x*y - y**2",
                "1/x - 1/x",
                "sin(2*x) - 2*sin(x)*cos(x)",
                "tan(x)*cos(x) - sin(x)",
                "cos(pi/7) - cos(2*pi/7) + cos(3*pi/7) - 1/2",
                "8**(1/3) - 2",
                "1/(1 + 1/x) - x/(x + 1)",
                "sin(0)",
                "x**0 - 1",
                "cosh(x) - exp(x)/2 - exp(-x)/2",
                "sin_1(x)*x - sin(x)",
                "log(x) - log(x)",
            )
        )
    ),
]
#: No texts of the language.
NO_TEXTS: list[Any] = [
    "π",
    "x²",
    "ｘ",
    "x−y",
    "x\u00a0+ y",
    "x\u200b",
    "x·y",
    "√2",
    "x×y",
    "é",
    "x\ty",
    "x\ny",
    "x;y",
    "x,y",
    "x=y",
    "x==y",
    "x:=y",
    "x if y else x",
    "[x]",
    "{x}",
    "x[0]",
    "x.real",
    "x.__class__",
    "__import__(os)",
    "lambda: x",
    "None",
    "True",
    "x!",
    "x%y",
    "x//y",
    "x@y",
    "x^y",
    "x&y",
    "x|y",
    "x<<y",
    "~x",
    "'x'",
    '"x"',
    "f'x'",
    "\\x",
    "#x",
    "x#",
    "1j",
    "1e5",
    "0x1",
    "0b1",
    "1_0",
    "1__0",
    "1.2.3",
    "1..2",
    ".5",
    "5.",
    "2x",
    "2(x)",
    "x(2)",
    "(x)(y)",
    "x y",
    "sin x",
    "sin",
    "sin()",
    "sin(x, y)",
    "sin(x=y)",
    "sin(*x)",
    "sin(x)(y)",
    "pi(x)",
    "Sin(x)",
    "arcsin(x)",
    "ln(x)",
    "gamma(x)",
    "sin_(x)",
    "sin_100(x)",
    "sin_-1(x)",
    "sin_1_2(x)",
    "sinh_1(x)",
    "exp_1.5(x)",
    "x**(1/0)",
    "x**1000",
    "x**(-1000)",
    "x**(10**100)",
    "2**2**2**2**2",
    "(((",
    ")))",
    "()",
    "(x",
    "x)",
    "",
    " ",
    "+",
    "*x",
    "x*",
    "x**",
    "/x",
    "x+/y",
    "(" * 3000 + "x" + ")" * 3000,
    "-" * 30000 + "x",
    "sin(" * 300 + "x" + ")" * 299,
    "x" * 100001,
    5,
    0.5,
    None,
    True,
    [],
    {},
    ["x"],
]


def tricks() -> Iterator[tuple[str, Any]]:
    """All of them."""
    for left, right in FALSE:
        yield f"{left} = {right}", identity(left, right)
    for text in NO_TEXTS:
        yield f"text {str(text)[:30]!r}", identity(text, text)
        yield f"H {str(text)[:30]!r}", changed(GAP, ["panels", 0, "H", 1], text)
    for item, path in number_places():
        for bad in NO_NUMBERS:
            yield f"{item['kind']} {path} {str(bad)[:12]!r}", changed(item, path, bad)
    yield from optima()
    yield from boxes()
    yield from pieces()
    yield from algebra()
    yield from shapes()


def number_places() -> Iterator[tuple[dict[str, Any], list[Any]]]:
    """One place of each meaning where a number stands."""
    for path in (["dual", 0], ["support", 0, 1], ["lower"], ["upper"], ["from"], ["to"]):
        yield GAP, path
    one = ["pieces", 0]
    for path in (["from"], ["to"], ["basis", 0, 0], ["dual", 0, 0], ["contacts", 0, "weight", 0], ["radius", 0]):
        yield TOUCH, [*one, *path]
    yield PARABOLA, [*one, "contacts", 1, "at", 0]
    yield RANK, ["point", "a"]


def optima() -> Iterator[tuple[str, Any]]:
    """One problem, false proofs of it; and other problems with the same proof."""
    contacts = ["pieces", 0, "contacts"]
    for item in (TOUCH, PARABOLA):
        rows = item["pieces"][0]["contacts"]
        for k in range(len(rows)):
            w = rows[k]["weight"][0]
            turned = w[1:] if w[0] == "-" else f"-{w}"
            yield f"weight {k} turned", changed(item, [*contacts, k, "weight"], [turned])
            yield f"weight {k} zero", changed(item, [*contacts, k, "weight"], ["0"])
            yield f"weight {k} empty", changed(item, [*contacts, k, "weight"], [])
            less = changed(item, [*contacts, k], ...)
            yield f"contact {k} missing", changed(less, ["pieces", 0, "radius"], item["pieces"][0]["radius"][2:])
            more = changed(item, contacts, [*rows, rows[k]])
            radius = item["pieces"][0]["radius"]
            yield f"contact {k} twice", changed(more, ["pieces", 0, "radius"], radius + radius[:2])
            for at in ("0.25", "-0.5", "1.5", "0.999"):
                yield f"contact {k} moved", changed(item, [*contacts, k, "at"], [at])
        # Without inner contacts the system is linear, and a box of any size may be good.
        for size in ("1", "10", "1000", "9" * 50, "0", "-0.0001")[0 if item is PARABOLA else -2 :]:
            yield f"radius {size}", changed(item, ["pieces", 0, "radius"], [size] * len(item["pieces"][0]["radius"]))
        for k in range(len(item["functional"])):
            for x in ("0", "2", "-2", "0.9"):
                yield f"dual {k} {x}", changed(item, ["pieces", 0, "dual", k], [x])
    for item in (GAP, TOUCH, PARABOLA, CONSTANT):
        for path, values in (
            (["panels", 0, "sigma"], ("0", "-1", "1/2", "t", "sin(0)", "log(1)", "sqrt(-1)", "1/0", "2 - 5")),
            (["panels", 0, "from"], ("5", "-1", "t", "log(0)")),
            (["panels", 0, "to"], ("0", "-1", "1/0", "7", "tan(pi/2)")),
            (["lower"], ("1000", item["upper"])),
            (["upper"], ("-1000", item["lower"])),
            (["bits"], (0, -1, 52, 20001, "80", 80.0, True, None)),
            (["cells"], (-1, 10**9, "40", 1.0, False, None)),
            (["variable"], ("s", "pi", "", 1)),
            (["parameter"], ("t", "pi", 1, None)),
            (["panels"], ([], {}, None)),
            (["functional"], ([], {}, ["0"] * 5, ["1/0"] * len(item["functional"]))),
        ):
            for new in values:
                yield f"{item['kind']} {path} {new!r}", changed(item, path, new)
    for H in (
        "1/(t - 1/3)",
        "log(t - 1/2)",
        "tan(2*t)",
        "sqrt(t - 1/10)",
        "asin(5*t)",
        "1/t",
        "exp(1/(t - 1/7))",
        "exp_3(3*t)",
        "abs(t - 1/3)",
        "t + 1/100",
        "-5*t",
        "cos(40*t)",
        "2 - t + sin(90*t)/10",
        "2 - t + exp(-(100*(t - 1/3))**2)",
    ):
        yield f"constant {H}", changed(CONSTANT, ["panels", 0, "H"], [H])
    beside = {"measurement": 1, "from": "0", "to": "1", "sigma": "1", "H": [f"1 + 1/{10**20}"]}
    yield "a second panel", changed(CONSTANT, ["panels"], [*CONSTANT["panels"], beside])
    peak = {**beside, "H": [f"1 + 1/{10**20} - (t - 1/3)**2"]}
    yield "a peak elsewhere", changed(CONSTANT, ["panels"], [*CONSTANT["panels"], peak])
    yield "two supports at one place", changed(GAP, ["support"], [[0, "0.5"], [0, "1/2"]])
    for v in ("-0.0001", "1.0001", "2", "-1"):
        yield f"support {v}", changed(GAP, ["support", 1, 1], v)
    for ends in (("0.9", "1.1"), ("-1", "1"), ("1", "2"), ("0", "1")):
        yield f"sliver {ends}", {**SLIVER, "from": ends[0], "to": ends[1]}
    # A line through both signs: its contacts are right, and its dual leaves the band between two panels that touch.
    far = {"measurement": 1, "from": "2", "to": "3", "sigma": "1", "H": ["1", "t"]}
    yield "the panel behind", changed(TOUCH, ["panels"], [*TOUCH["panels"], far])
    yield (
        "unweighted contact",
        {
            "kind": "touch",
            "variable": "t",
            "functional": ["1"],
            "bits": 80,
            "cells": 20,
            "lower": "0.99",
            "upper": "1.01",
            **NONE,
            "panels": [{"measurement": 0, "from": "0", "to": "1", "sigma": "1", "H": ["4*(t - 1/2)**2"]}],
            **alone(["1"], [(0, "0", "1")], ["0.001"] * 3),
        },
    )


def boxes() -> Iterator[tuple[str, Any]]:
    """Boxes, bases and ends of a piece that are of another shape, or of none."""
    one = ["pieces", 0]
    for item in (TOUCH, PARABOLA, CONSTANT):
        (piece,), m = item["pieces"], len(item["functional"])
        radius, unit = piece["radius"], piece["basis"]
        for k in range(len(radius)):
            for bad in ("0", "-0.000001", "1/0", "nan", 1, None):
                yield f"radius {k} {bad}", changed(item, [*one, "radius", k], bad)
        for n in (0, m, len(radius) - 1, len(radius) + 1, 2 * len(radius)):
            yield f"{n} radii", changed(item, [*one, "radius"], [radius[0]] * n)
        for name, basis in (
            ("a row less", unit[1:]),
            ("a row more", [*unit, unit[0]]),
            ("a column less", [row[1:] for row in unit]),
            ("a column more", [[*row, "1"] for row in unit]),
            ("a row of zeros", [["0"] * m, *unit[1:]]),
            ("negative", [["-" + e for e in row] for row in unit]),
            ("no list", None),
            ("of numbers", [[1] * m] * m),
        ):
            yield f"basis {name}", changed(item, [*one, "basis"], basis)
        for k, row in enumerate(piece["contacts"]):
            for at in ENDS:
                if at != row["at"]:
                    yield f"contact {k} at {at}", changed(item, [*one, "contacts", k, "at"], at)
    for key in ("matrix", "solution"):
        rows = EXPONENTIAL[key]
        for name, other in (("more", [*rows, rows[0]]), ("less", rows[:1]), ("flat", rows[0]), ("none", [])):
            yield f"{key} {name}", changed(EXPONENTIAL, [key], other)
    more = {"matrix": [*EXPONENTIAL["matrix"], ["0", "0"]], "solution": [*EXPONENTIAL["solution"], ["0", "0"]]}
    yield "both with a row more", EXPONENTIAL | more


def pieces() -> Iterator[tuple[str, Any]]:
    """Ranges with holes, overlaps, other parameters, singular bases."""
    first, second = SLOPES["pieces"]
    for name, rows in (
        ("exchanged", [second, first]),
        ("one missing", [first]),
        ("the other missing", [second]),
        ("one twice", [first, first]),
        ("hole", [first, {**second, "from": f"1.01{'0' * 40}1"}]),
        ("overlap", [first, {**second, "from": "1.0099"}]),
        ("turned", [{**first, "from": "1.01", "to": "1"}, second]),
        ("none", []),
        ("no list", {}),
        ("longer", [first, second, second]),
        ("beyond", [first, {**second, "to": "1.03"}]),
    ):
        yield f"pieces {name}", {**SLOPES, "pieces": rows}
    for basis in (
        [],
        [[]],
        [["1", "0"]],
        [["1"], ["0"]],
        [["0", "0"], ["0", "0"]],
        [["1", "1"], ["1", "1"]],
        [["1", "2"], ["2", "4"]],
        [["1", "0"], ["0", "0"]],
        [["1", "0", "0"], ["0", "1", "0"]],
        [["1", "0"], ["0", "1"], ["0", "0"]],
        [["2", "0"], ["0", "1"]],
        [["1", "0"], ["0", "-1"]],
        [["0", "1"], ["1", "0"]],
        [["1", "1"], ["0", "1"]],
    ):
        yield f"basis {basis}", changed(SLOPES, ["pieces", 0, "basis"], basis)
    for ends in (("1", "1.03"), ("0.99", "1.02"), ("1.02", "1"), ("1", "1"), ("-1", "1.02"), ("0", "51/50")):
        yield f"range {ends}", {**SLOPES, "from": ends[0], "to": ends[1]}
    for to in ("T - 1", "T - 101/100", "2*T", "T**2 + 1", "1", "1/(T - 1)", "log(T - 1)", "-T", "tan(T*pi/2)"):
        yield f"range to {to}", changed(RANGE, ["panels", 0, "to"], to)
    for sigma in ("T - 1", "1 + T", "T - 51/50", "sin(100*T)", "0", "1/(T - 101/100)"):
        yield f"range sigma {sigma}", changed(RANGE, ["panels", 0, "sigma"], sigma)
    for p in ("1", "p", "-p**2", "p**2/(p - 1)", "p**2 + 1/100", "0"):
        yield f"moving functional {p}", changed(MOVING, ["functional"], [p])
    for H in ("p + 1 + t*p", "p + 1", "1/(p - 1)", "(p + 1 - t*p)*3/2", "-(p + 1 - t*p)", "p + 1 - t*p/(p - 1)"):
        yield f"moving H {H}", changed(MOVING, ["panels", 0, "H"], [H])
    for bounds in (("7.7", "8.1"), ("7.6", "7.9"), ("9", "10"), ("8.1", "7.6"), ("-8.1", "-7.6")):
        yield f"range bounds {bounds}", {**RANGE, "lower": bounds[0], "upper": bounds[1]}
    for k in range(3):
        yield f"curve {k} straightened", changed(RANGE, ["pieces", 0, "contacts", k, "weight"], ["2"])
        yield f"curve {k} bent", changed(RANGE, ["pieces", 0, "contacts", k, "weight", 2], "0.5")
    yield "a place that leaves", changed(RANGE, ["pieces", 0, "contacts", 1, "at"], ["0.5", "0.6"])
    yield "an end that moves", changed(RANGE, ["pieces", 0, "contacts", 0, "at"], ["0", "0"])


def algebra() -> Iterator[tuple[str, Any]]:
    """Exponentials, ranks and positive expressions that are none."""
    for X in (
        [["1", "0"], ["0", "1"]],
        [["cos(w*t)", "-sin(w*t)/w"], ["w*sin(w*t)", "cos(w*t)"]],
        [["1", "t"], ["-w**2*t", "1"]],
        [["cos(w*t)", "sin(w*t)"], ["-w*sin(w*t)", "w*cos(w*t)"]],
        [["cos(w*t)", "-w*sin(w*t)"], ["sin(w*t)/w", "cos(w*t)"]],
        [["cos(w*t) + t**2", "sin(w*t)/w"], ["-w*sin(w*t)", "cos(w*t)"]],
        [["cos(w*t)", "sin(w*t)/w"]],
        [[], []],
        [["1"], ["1"]],
        [["cos(w*t)", "sin(w*t)/t"], ["-w*sin(w*t)", "cos(w*t)"]],
        [["cos(w*t)", "sin(w*t)/(w - w)"], ["-w*sin(w*t)", "cos(w*t)"]],
        [["cos(w*t + pi)", "sin(w*t)/w"], ["-w*sin(w*t)", "cos(w*t)"]],
        [["asin(t)", "0"], ["0", "1"]],
    ):
        yield f"exponential {X}", changed(EXPONENTIAL, ["solution"], X)
    for A in (
        [["0", "1"], ["w**2", "0"]],
        [["0", "1"], ["-t", "0"]],
        [["0", "1"]],
        [],
        [["0"]],
        [["0", "1"], ["-w**2", "0/0"]],
    ):
        yield f"system {A}", changed(EXPONENTIAL, ["matrix"], A)
    for path, values in (
        (
            ["null"],
            ([["a", "b"]], [["0", "0"]], [["-b", "a"], ["b", "-a"]], [], [["-b"]], [["-b", "a", "0"]], [["1/0", "a"]]),
        ),
        (["rows"], ([0, 1], [2], [-1], ["0"], [True], [], [0.0])),
        (["rank"], (0, 2, -1, "1", True, 1.0)),
        (["point"], ({"a": "0", "b": "0"}, {"a": "1"}, {"a": "1", "b": "1", "c": "1"}, {}, [], None)),
        (
            ["matrix"],
            (
                [["a", "b"], ["2*a", "2*b + 1"]],
                [["a", "b"], ["a"]],
                [],
                [[]],
                [["a", "b"], ["2*a", "2*c"]],
                [["0", "0"]],
            ),
        ),
        (["symbols"], (["a"], ["a", "a", "b"], ["a", "b", "pi"], "ab", {"a": 1})),
    ):
        for new in values:
            yield f"rank {path} {new}", changed(RANK, path, new)
    twice = {
        **RANK,
        "matrix": [["a", "b", "0"], ["2*a", "2*b", "0"]],
        "rank": 2,
        "rows": [0, 0],
        "null": [["-b", "a", "0"]],
    }
    yield "one row taken twice", twice
    for text in (
        "0",
        "-1",
        "sin(x) - 1",
        "sin(x)**2",
        "x - x",
        "x - pi/2",
        "1/(x - 1)",
        "log(x)",
        "sqrt(x - 1)",
        "x**(1/2)",
        "tan(x)",
        "1/1000 - sin(x)/500",
        "1 - 1/x",
        "exp(-x) - 1/20",
        "y",
        "y + 1",
        "acos(y)",
        "(x - 1)**2 + y**2",
        "abs(y)",
        "exp_0(x)",
        "0**(-1)",
        "x/x",
        "1 + 1/(y - 1)**2",
    ):
        yield f"positivity {text}", changed(POSITIVITY, ["expression"], text)
    for box in (
        {},
        {"x": ["0", "pi"]},
        {"x": ["0"], "y": ["-1", "1"]},
        {"x": ["0", "9"], "y": ["-1", "1", "2"]},
        [],
        None,
        {"x": ["0", "1/0"], "y": ["-1", "1"]},
        {"x": ["0", "x"], "y": ["-1", "1"]},
        {"pi": ["0", "1"], "x": ["0", "1"], "y": ["0", "1"]},
        {"x": ["0", 1], "y": ["-1", "1"]},
        {"x": ["0", "pi"], "y": ["-1", "30"]},
    ):
        yield f"box {box}", changed(POSITIVITY, ["box"], box)


def shapes() -> Iterator[tuple[str, Any]]:
    """What is no certificate."""
    whole = (GAP, SLIVER, TOUCH, RANGE, RANK, EXPONENTIAL, POSITIVITY)
    for item in whole:
        for key in item:
            yield f"{item['kind']} without {key}", changed(item, [key], ...)
            for new in (None, [], {}, 0.5, [None], "", [[]]):
                if (key, new) != ("pieces", None) and not (key in ("symbols",) and new == []):
                    yield f"{item['kind']} {key} {new}", changed(item, [key], new)
        yield f"{item['kind']} with a note", {**item, "note": "true"}
        for kind in (
            "identity",
            "exponential",
            "rank",
            "positivity",
            "all",
            "gap",
            "touch",
            "",
            "GAP",
            ["gap"],
            {"gap": 1},
            None,
        ):
            if kind != item["kind"] and (item["kind"], kind) not in (("sliver", "gap"), ("range", "touch")):
                yield f"{item['kind']} called {kind}", {**item, "kind": kind}
    yield "one of many is false", {"kind": "all", "of": [GAP, changed(GAP, ["upper"], "0.5")]}
    for of in ([], None, {}, [None], [[]], ["gap"], [GAP, {}], GAP):
        yield f"all of {str(of)[:20]}", {"kind": "all", "of": of}
    yield from ((f"no object {item!r}", item) for item in (None, [], "gap", 1, 0.5, True))
