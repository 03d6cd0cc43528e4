"""Statements with something beside them: tolerances of printed numerals, expressions that must exist, boxes."""

from __future__ import annotations

import random

from tests.attacks.evaluator import digits_of
from tests.attacks.schemes.values import NUMBERS, draw_tiny, nest
from tests.attacks.statements import Statement, family, truth_of_constants


@family("tolerances")
def make_tolerance(rng: random.Random) -> Statement:
    """A printed numeral with half a unit of its last digit, or a little less than its true distance."""
    if rng.random() < 0.5:
        text = nest(rng, rng.choice(NUMBERS), 2)
        value = digits_of(text, rng.choice((3, 6, 12, 25)))
        tolerance = f"{rng.choice((5, 5, 1))}e-{len(value.partition('.')[2]) + 1}"
        truth = truth_of_constants(f"abs({text} - ({value})) <= {tolerance}")
        return Statement(f"{text} = {value}", truth, {}, None if truth else {}, beside={"tolerance": tolerance})
    d, unit = draw_tiny(rng, 3, 25), {"x": ["0", "1"]}
    third = digits_of("1 - sin(1)", 12)
    text, tolerance, truth, at = rng.choice((
        (f"x = x + {d}", d, True, ""), (f"x = x + {d}", f"0.9*{d}", False, "0"),
        ("x = x + 1", f"1 - {d}*1e-9", False, "0"), ("x**2 = x", "1/4", True, ""),
        ("x**2 = x", f"1/4 - {d}", False, "1/2"), ("sin(x) = x", f"{third} + 1e-11", True, ""),
        ("exp(x) = 1 + x", "0.7", False, "1"),
        ("sin(x) = x", f"{third} - 1e-11", False, "1"), ("cos(x) = 1", "1 - cos(1)", True, ""),
        ("sqrt(x) = x", "1/4", True, ""),
        ("sqrt(x) = x", "0.2499999", False, "1/4"), ("exp(x) = 1 + x", "0.72", True, ""),
        ("abs(x - 1/2) = 1/4", "1/4", True, ""),
        (f"abs(x - 1/2) = 1/4 + {d}", "1/4", False, "1/2"), ("x*(1 - x) = 1/8", "1/8", True, ""),
    ))  # fmt: skip
    return Statement(text, truth, unit, None if truth else {"x": at}, beside={"tolerance": tolerance})


@family("existence")
def make_existence(rng: random.Random) -> Statement:
    """What a side condition of existence is enough for, and what it is not."""
    text, exists, truth, at = rng.choice((
        ("sqrt(x**2) = x", "sqrt(x)", True, ""), ("abs(x) = x", "log(x)", True, ""), ("x > 0", "log(x)", True, ""),
        ("x >= 0", "sqrt(x)", True, ""), ("x > 0", "sqrt(x)", False, "0"), ("x != 0", "1/x", True, ""),
        ("cos(x) < 1", "1/x", False, "2*pi"),
        ("cos(x) < 1", "1/(1 - cos(x))", True, ""), ("x >= 1", "log(x)", False, "1/2"),
        ("abs(x) <= 1", "asin(x)", True, ""),
        ("abs(x) < 1", "asin(x)", False, "1"), ("x**2 <= 1", "acos(x)", True, ""), ("x < 1", "log(1 - x)", True, ""),
        ("log(x*y) = log(x) + log(y)", "log(x) + log(y)", True, ""), ("sin(x) != 0", "cot(x)", True, ""),
        ("sin(x) != 0", "1/x", False, "pi"),
        ("sqrt(x - 1)*sqrt(x + 1) = sqrt(x**2 - 1)", "sqrt(x - 1)", True, ""), ("x = x", "log(x)", True, ""),
        ("x > 1", "log(log(x))", True, ""),
        ("x = x + 1e-20", "log(x)", False, "1"), ("abs(x)/x = 1", "log(x)", True, ""), ("x >= 0", "x**(1/3)", True, ""),
        ("cos(x) > 0", "sqrt(cos(x))", False, "pi/2"), ("cos(x) >= 0", "sqrt(cos(x))", True, ""),
        ("x > y", "1/(x - y)", False, "0"),
    ))  # fmt: skip
    witness = (
        None if truth else {name: at if name == "x" else "1" for name in ("x", "y") if name in text.replace("exp", "")}
    )
    return Statement(text, truth, {}, witness, beside={"exists": exists})


@family("boxes")
def make_box(rng: random.Random) -> Statement:
    """A range of this claim inside the declaration of its symbol."""
    d = draw_tiny(rng, 3, 30)
    text, declared, ends, truth, at = rng.choice((
        ("sin(x) <= x", "real", ("0", "pi"), True, ""), ("sin(x) <= x", "real", ("-1", "1"), False, "-1"),
        ("x**2 <= 2", "real", ("0", "sqrt(2)"), True, ""),
        (f"x**2 <= 2 - {d}", "real", ("0", "sqrt(2)"), False, "sqrt(2)"),
        ("log(x) <= 1", "positive", ("1", "exp(1)"), True, ""),
        ("log(x) < 1", "positive", ("1", "exp(1)"), False, "exp(1)"), ("cos(x) < 1", "nonzero", ("1", "6"), True, ""),
        ("cos(x) < 1", "nonzero", ("1", "7"), False, "2*pi"), ("x**2 >= x", ["0", "9"], ("1", "9"), True, ""),
        (f"x**2 >= x + {d}", ["0", "9"], ("1", "9"), False, "1"), ("abs(x) = x", "real", ("0", "5"), True, ""),
        ("abs(x) = x", "real", ("-1e-20", "5"), False, "-1e-20"),
        ("asin(sin(x)) = x", "real", ("-pi/2", "pi/2"), True, ""), ("acos(cos(x)) = x", "real", ("0", "pi"), True, ""),
        ("asin(sin(x)) = x", "real", ("0", "pi/2 + 1e-3"), False, "pi/2 + 1e-3"),
        ("sqrt(x**2) = x", "nonnegative", ("1", "2"), True, ""),
    ))  # fmt: skip
    return Statement(text, truth, {"x": declared}, None if truth else {"x": at}, beside={"box": {"x": ends}})
