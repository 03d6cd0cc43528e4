"""A number in the place of a part: what it makes provable, and that its range encloses what the part takes."""

import itertools

import pytest
from flint import arb, fmpq

import navsym as nav
from navsym.prove.rooms.goals import ball_of, player, simple_point
from navsym.prove.rooms.letters import find_span

LINE, UNIT = {}, ("0", "1")
STATEMENTS = [
    # true, false beside it, ranges
    ("(1 - h/44330.77)**4.25588 <= 1", "(1 - h/44330.77)**4.25588 < 1", {"h": ("0", "11000")}),
    (
        "((1 - h/44330)**5.25588)**(1/5.25588) = 1 - h/44330",
        "((1 - h/44330)**5.25588)**(1/5.25587) = 1 - h/44330",
        {"h": ("0", "8000")},
    ),
    ("(x*y)**1.256 = x**1.256*y**1.256", "(x*y)**1.256 = x**1.256*y**1.255", {"x": "positive", "y": "positive"}),
    ("exp(-exp(-x)) < 1", "exp(-exp(-x)) < 1 - 1e-9", LINE),
    ("1 - tanh(1e20*(x - sqrt(2)/3))**2 <= 1 + 1e-6", "1 - tanh(1e20*(x - 1/3))**2 <= 1 - 1e-6", {"x": UNIT}),
    ("exp(-1e12*(x - pi/7)**2) < 1 + 1e-6", "exp(-1e12*(x - 3/7)**2) < 1 - 1e-6", LINE),
    ("exp(a + b + c + d) >= 1 + a + b + c + d", "exp(a + b + c + d) >= 1 + a + b + c + d + 1e-9", LINE),
    (
        "abs(a - sqrt(2) + (b - 1000)) < abs(a - sqrt(2)) + abs(b - 1000) + 4e-26",
        "abs(a - sqrt(2) + (b - 1000)) < abs(a - sqrt(2)) + abs(b - 1000) - 1e-6",
        LINE,
    ),
    ("asin(sqrt(x)) >= sqrt(x)", "asin(sqrt(x)) >= sqrt(x) + 1e-9", {"x": UNIT}),
    ("atan((x - 1e6)**2) + sqrt(abs(y - pi)) > -8e-25", "atan((x - 1)**2) + sqrt(abs(y - 1)) > 8e-25", LINE),
]  # fmt: skip
TAILS = [
    ("x*exp(-x) <= 37/100", "x*exp(-x) <= 36/100", LINE),
    ("x**2*exp(-x) <= 0.5414", "x**2*exp(-x) <= 0.5413", {"x": "nonnegative"}),
]
SUMS = [
    ("exp(a) + exp(b) + exp(c) >= 3 + a + b + c", "exp(a) + exp(b) + exp(c) >= 4 + a + b + c", LINE),
    (
        "a**2 + b**2 + c**2 + d**2 + p**2 + q**2 <= a + b + c + d + p + q",
        "a**2 + b**2 + c**2 + d**2 + p**2 + 2*q**2 <= a + b + c + d + p + q",
        dict.fromkeys("abcdpq", UNIT),
    ),
    (
        "(a + b + c + d + p + q)**2 <= 6*(a**2 + b**2 + c**2 + d**2 + p**2 + q**2)",
        "(a + b + c + d + p + q)**2 <= 5.9*(a**2 + b**2 + c**2 + d**2 + p**2 + q**2)",
        LINE,
    ),
]
QUOTIENTS = [
    ("(1 - cos(x))/x**2 <= 1/2", "(1 - cos(x))/x**2 <= 0.499999", LINE),
    ("(x - sin(x))/x**3 <= 1/6", "(x - sin(x))/x**3 <= 0.166666", LINE),
    ("sin(w*T)/(w*T) <= 1", "sin(w*T)/(w*T) <= 0.999999", LINE),
]
SMALL = [
    ("sqrt(1 - cos(3e-14)) != 0", "sqrt(1 - cos(3e-14)) = 0"),
    ("sqrt(1 - cos(2e-65)) > 0", "sqrt(1 - cos(2e-65)) > 1e-60"),
    ("abs(asin(1) - asin(1 - 2e-29)) > 0", "abs(asin(1) - asin(1 - 2e-29)) > 1e-13"),
]
EVERYTHING = [*STATEMENTS, *TAILS, *SUMS, *QUOTIENTS, *((*row, LINE) for row in SMALL)]


@pytest.mark.parametrize(("true", "false", "given"), EVERYTHING)
def test_what_holds_is_proved_and_what_fails_beside_it_is_refuted(true, false, given):
    verdict = nav.prove(true, **given)
    assert verdict.status in (nav.PROVED, nav.CERTIFIED), verdict.evidence
    assert nav.prove(false, **given).status == nav.REFUTED


PARTS = [
    "1 - h/44330", "exp(-x)", "(x - 3)**2", "-exp(-exp(x))", "sqrt(x)", "tanh(3*x - 1)**2", "abs(x + y) + 2*z",
    "log(x)", "cosh(x - 1)", "3 - 2*x**3", "atan(x**2)", "sin(x)**2", "asin(x)", "(2 - x)**(5/2)", "exp(x + 2*y) - z",
]  # fmt: skip
RANGES = [
    (None, None, []),
    ("0", None, ["open-low"]),
    ("-1", "1/2", []),
    ("1/3", "pi", ["open-high"]),
    (None, "-2", []),
]


def test_a_span_encloses_all_values_of_its_part():
    compared = 0
    for text, limits in itertools.product(PARTS, RANGES):
        term = player.parse(text)
        box = {name: player.read_range([*limits]) for name in sorted(player.symbols_of(term))}
        span = find_span(term, box)
        for k in range(6) if span is not None else ():
            place = {name: fmpq(simple_point(limit, (k + i) % 6)) for i, (name, limit) in enumerate(box.items())}
            value = ball_of(term, {name: player.Jet(arb(q)) for name, q in place.items()})
            if value.is_finite():
                compared += 1
                assert span.low is None or not value < player.value_of(span.low, {}), (text, limits, place)
                assert span.high is None or not value > player.value_of(span.high, {}), (text, limits, place)
    assert compared > 200
