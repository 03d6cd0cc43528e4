"""A function of doubles beside a formula: a certified bound holds at every double tried, and errors are seen."""

from __future__ import annotations

import ctypes
import ctypes.util
import math
from math import cos

import casadi as ca
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf

import navsym as nav


def sine_over_argument(x):
    return np.sin(x) / x


def gravity(latitude):
    """Somigliana's formula, with its constants as they are printed."""
    s = math.sin(latitude) ** 2
    return 9.7803253359 * (1 + 0.00193185265241 * s) / math.sqrt(1 - 0.00669437999014 * s)


def helper(x):
    return cos(x)


def product(y, x):
    return helper(x) * y + 0.1


GRAVITY = "9.7803253359*(1 + 0.00193185265241*sin(L)**2)/sqrt(1 - 0.00669437999014*sin(L)**2)"
CASES = {
    "numpy": (sine_over_argument, "sin(x)/x", {"x": ("1/1000", "3")}, lambda x: mp.sin(x) / x, 3e-15),
    "constants": (
        gravity,
        GRAVITY,
        {"L": ("-pi/2", "pi/2")},
        lambda L: (
            mpf("9.7803253359")
            * (1 + mpf("0.00193185265241") * mp.sin(L) ** 2)
            / mp.sqrt(1 - mpf("0.00669437999014") * mp.sin(L) ** 2)
        ),
        2e-14,
    ),
    "series": (lambda x: 1 - x**2 / 2 + x**4 / 24, "cos(x)", {"x": ("-1/2", "1/2")}, lambda x: mp.cos(x), 2.3e-5),
    "two names": (
        product,
        "cos(x)*y + 1/10",
        {"x": ("0", "1"), "y": ("-2", "2")},
        lambda x, y: mp.cos(x) * y + mpf(1) / 10,
        3e-15,
    ),
    "length": (
        lambda x, y: math.hypot(x, y) + np.hypot(x, 1.0),
        "sqrt(x**2 + y**2) + sqrt(1 + x**2)",
        {"x": ("-3", "3"), "y": ("1/2", "4")},
        lambda x, y: mp.hypot(x, y) + mp.hypot(x, 1),
        2e-14,
    ),
    "angles": (
        lambda d: np.rad2deg(math.atan(math.sin(math.radians(d)))),
        "atan(sin(d*pi/180))*180/pi",
        {"d": ("0", "90")},
        lambda d: mp.degrees(mp.atan(mp.sin(mp.radians(d)))),
        2e-13,
    ),
    "degrees": (
        lambda a: math.sin(a * (math.pi / 180)),
        "sin(a*pi/180)",
        {"a": ("0", "90")},
        lambda a: mp.sin(a * mp.pi / 180),
        3e-15,
    ),
}


@pytest.fixture(scope="module")
def found():
    return {name: nav.compare(f, text, **ranges) for name, (f, text, ranges, _, _) in CASES.items()}


@pytest.mark.parametrize("name", CASES)
def test_what_can_be_followed_is_certified_with_a_useful_bound(found, name):
    answer, expected = found[name], CASES[name][4]
    assert answer.how == "certified" and float(answer.bound) <= expected, answer
    assert 0 < float(answer.deviation) <= float(answer.bound)


@pytest.mark.parametrize("name", CASES)
@settings(max_examples=60)
@given(data=st.data())
def test_a_certified_bound_holds_at_every_double(found, name, data):
    function, _, ranges, reference, _ = CASES[name]
    with mp.workdps(50):
        ends = {n: [float(mp.mpf(1) * eval_end(end)) for end in pair] for n, pair in ranges.items()}
        point = {n: data.draw(st.floats(*pair)) for n, pair in ends.items()}
        values = list(point.values())
        value = function(**point) if name == "two names" else function(*values)
        exact = reference(**{n: mpf(x) for n, x in point.items()})
        assert abs(mpf(float(value)) - exact) <= mpf(found[name].bound)


def eval_end(text):
    """An end of a range of these cases."""
    return {"pi/2": mp.pi / 2, "-pi/2": -mp.pi / 2, "1/2": mpf(0.5), "-1/2": mpf(-0.5), "1/1000": mpf(1) / 1000}.get(
        text
    ) or mpf(text)


def test_a_wrong_formula_has_a_bound_as_large_as_its_error_and_the_point_that_shows_it():
    answer = nav.compare(product, "cos(x)*y + 1/8", x=("0", "1"), y=("-2", "2"))
    assert answer.how == "certified" and 0.025 <= float(answer.deviation) <= float(answer.bound) < 0.04
    swapped = nav.compare(lambda a, b: a - b, "b - a", b=("0", "1"), a=("0", "2"))
    assert float(swapped.bound) >= 3.99 and set(swapped.worst) == {"a", "b"}


@pytest.mark.parametrize(
    ("fault", "largest"),
    [(lambda x: 1e-9 * x, 3e-9), (lambda x: -2e-12, 2e-12), (lambda x: 1e-6 * x * (3 - x), 2.25e-6)],
)
@pytest.mark.parametrize(
    ("function", "formula"),
    [
        (lambda x: math.sin(x) * math.exp(-x), "sin(x)*exp(-x)"),
        (lambda x: 1 / (1 + x * x), "1/(1 + x**2)"),
        (lambda x: math.sin(x) * math.cos(x), "sin(2*x)/2"),
    ],
)
def test_the_bound_of_a_function_of_one_number_is_near_its_fault_however_small(function, formula, fault, largest):
    answer = nav.compare(lambda x: function(x) + fault(x), formula, x=("0", "3"))
    assert answer.how == "certified"
    assert largest * (1 - 1e-6) <= float(answer.bound) <= 1.1 * largest


@pytest.mark.parametrize(
    ("function", "formula", "ranges", "largest", "slack"),
    [
        (lambda x, y: math.sin(x) * math.exp(-y) + 1e-9 * x, "sin(x)*exp(-y)", {"x": (0, 1), "y": (0, 1)}, 1e-9, 1.1),
        (
            lambda a, b, c, d: a * b - c * d + 1e-9 * a * b * c * d,
            "a*b - c*d",
            dict.fromkeys("abcd", (0, 1)),
            1e-9,
            1.1,
        ),
        (lambda x, y, z: math.sin(x * y) * z + 1e-7 * z, "z*sin(x*y)", dict.fromkeys("xyz", (0, 1)), 1e-7, 1.1),
        (lambda x, y: abs(x) * y + 1e-3, "abs(x)*y", {"x": (-1, 2), "y": (-1, 1)}, 1e-3, 200),
        (lambda x, y: math.atan2(y, x), "0*x + 0*y", {"x": (1, 2), "y": (-1, 1)}, math.pi / 4, 1.2),
        (lambda x, y: math.atan2(y, x) + 0 * x, "atan2(y, 2*x)", {"x": (1, 2), "y": (-1, 1)}, 0.3217, 1.5),
        (lambda x: math.atan2(x, 1.0) + x, "x", {"x": (0, 1)}, math.pi / 4, 1.2),
    ],
)
def test_the_bound_of_several_numbers_is_near_the_fault_and_never_below_it(function, formula, ranges, largest, slack):
    """What both have in common cancels where there are derivatives; a kink or an angle of two numbers costs slack."""
    answer = nav.compare(function, formula, **ranges)
    assert answer.how == "certified" and float(answer.bound) >= float(answer.deviation) >= largest * (1 - 1e-3)
    assert float(answer.bound) <= slack * largest


def test_a_function_of_casadi_is_followed_by_its_own_list():
    x = ca.SX.sym("x")
    answer = nav.compare(ca.Function("f", [x], [x**2 * ca.sin(x) / (2 * x)]), "x*sin(x)/2", x=("1/10", "2"))
    assert answer.how == "certified" and float(answer.bound) < 1e-14
    two = ca.Function("g", [x], [ca.if_else(x > 1, x, 1)])
    assert nav.compare(two, "x", x=("0", "2")).how == "sampled"


def test_a_compiled_function_is_sampled_and_says_so():
    library = ctypes.util.find_library("m")
    if library is None:
        pytest.skip("no library of mathematics is found on this machine")
    sine = ctypes.CDLL(library).sin
    sine.restype, sine.argtypes = ctypes.c_double, [ctypes.c_double]
    answer = nav.compare(sine, "sin(x)", x=("0", "3"))
    assert answer.how == "sampled" and answer.evidence.startswith("not certified: ") and answer.points > 100
    assert float(answer.bound) < 3e-16


def other_when_traced(x):
    """Says one thing to a double and another to anything else."""
    return x * 2 if type(x) is float else x * 3


@pytest.mark.parametrize(
    ("function", "formula", "why"),
    [
        (lambda x: x if x > 1 else 1.0, "x", "a comparison"),
        (lambda x: float(x), "x", "a conversion"),
        (lambda x: np.float32(2) * x, "2*x", "no double: float32"),
        (lambda x: np.interp(x, [0.0, 2.0], [0.0, 2.0]), "x", "not certified"),
        (other_when_traced, "2*x", "something else"),
        (lambda x: math.gamma(x + 1), "x", "the function gamma"),
    ],
)
def test_what_cannot_be_followed_is_sampled_with_the_reason(function, formula, why):
    answer = nav.compare(function, formula, x=("0", "2"), points=60)
    assert answer.how == "sampled" and why in answer.evidence, answer.evidence


def test_a_point_at_which_only_the_function_has_no_value_is_the_worst_one():
    answer = nav.compare(lambda x: x / x, "1 + 0*x", x=("0", "1"))
    assert answer.how == "sampled" and answer.bound is None and dict(answer.worst) == {"x": "0.0"}
    pole = nav.compare(lambda x: math.sin(x) / x, "sin(x)/x", x=("0", "1"))  # the formula has no value there either
    assert pole.how == "sampled" and float(pole.bound) < 1e-15 and "no finite bound" in pole.evidence


@pytest.mark.parametrize(
    ("formula", "ranges", "kind"),
    [
        ("sin(x)/x", {}, "empty"),
        ("sin(x)/x", {"x": "0"}, "shape"),
        ("sin(x)/x", {"x": ("0", "oo")}, None),
        ("sin(x)/x", {"x": ("1", "0")}, "domain"),
        ("sin(x)/y", {"x": ("0", "1")}, "unknown-symbol"),
        ("sin(x)", {"x": ("0", "1"), "y": ("0", "1")}, "unknown-symbol"),
        ("sin(x", {"x": ("0", "1")}, "syntax"),
        ("sqrt(-1 - x)", {"x": ("0", "1")}, None),
        ("sin(x)", {"x": (0.5, 1)}, "domain"),
    ],
)
def test_bad_input_is_refused(formula, ranges, kind):
    with pytest.raises(nav.NavsymError, match=r"expected .*; got .*; ") as caught:
        nav.compare(math.sin, formula, **ranges)
    assert kind is None or caught.value.kind == kind


def test_what_cannot_be_called_is_refused():
    with pytest.raises(nav.NavsymError, match="expected a function of numbers; got int; give a callable"):
        nav.compare(3, "x", x=("0", "1"))


def test_a_formula_of_sympy_is_compared_like_its_text():
    x = sp.Symbol("x", real=True)
    found = [nav.compare(math.sin, side, x=("0", "1"), points=5) for side in (sp.sin(x), "sin(x)")]
    assert found[0].how == "certified" and found[0].document() == found[1].document()
    assert nav.compare(lambda x: x, x, x=("0", "1"), points=5).bound == "0"


def test_more_points_than_anyone_waits_for_are_refused():
    with pytest.raises(nav.NavsymError, match=r"expected 2 to 1000000 points; got .* of 1329 bits"):
        nav.compare(math.sin, "sin(x)", points=10**400, x=("0", "1"))


def test_the_answer_is_plain_data():
    document = nav.compare(sine_over_argument, "sin(x)/x", x=("1", "2"), points=10).document()
    assert set(document) == {"how", "bound", "worst", "deviation", "evidence", "points"} and document["points"] == 10


@pytest.mark.parametrize(
    ("function", "formula", "double"),
    [
        (lambda y: math.atan2((y + 0.1) - 0.1, -1.0), "atan2(y, -1)", -1e-300),
        (lambda y: math.atan2(-y, -1.0), "atan2(-y, -1)", 0.0),
        (lambda y: math.atan2(y, -1.0), "atan2(y, -1)", -0.0),
    ],
)
def test_a_bound_across_the_cut_of_an_angle_has_a_turn(function, formula, double):
    """Rounding moves an angle across the cut; so does the sign of a zero. No sample meets these doubles."""
    answer = nav.compare(function, formula, y=("-1", "2"))
    exact = math.atan2(double + 0.0, -1.0)
    assert answer.how == "sampled" or float(answer.bound) >= abs(function(double) - exact) > 6


def other_for_doubles(x):
    return 7.0 if isinstance(x, float) and abs(x - 1.2345) < 1e-4 else x * x


def other_where_it_counts_as_number(x):
    return 7.0 if np.isscalar(x) and abs(x - 1.2345) < 1e-4 else x * x


def other_with_the_methods_of_doubles(x):
    return 7.0 if hasattr(x, "is_integer") and abs(x - 1.2345) < 1e-4 else x * x


def other_behind_a_caught_error(x):
    try:
        if abs(x - 1.2345) < 1e-4:
            return 7.0
    except Exception:  # as careless code has it
        pass
    return x * x


def other_by_a_division_with_rest(x):
    try:
        return x * x + ((x - 1.2345) ** 2 + 1 - 1e-8) // 1 - 1
    except TypeError:
        return x * x - 1


@pytest.mark.parametrize(
    "function",
    [
        other_for_doubles,
        other_where_it_counts_as_number,
        other_with_the_methods_of_doubles,
        other_behind_a_caught_error,
        other_by_a_division_with_rest,
    ],
)
def test_a_branch_that_few_doubles_take_is_never_certified(function):
    assert nav.compare(function, "x**2", x=("0", "2")).how == "sampled"


def test_only_doubles_within_the_ends_count():
    """The double 0.1 is above 1/10, where this formula has a slope that the proof did not cover."""
    answer = nav.compare(lambda x: 0 * x, "1000000*(abs(x - 1/10) + x - 1/10)", x=("0", "1/10"))
    assert answer.how == "certified" and float(answer.deviation) < 1e-40
    with pytest.raises(nav.NavsymError, match="a double between"):
        nav.compare(lambda x: x, "x", x=("1/3", "1/3 + 1/10**30"))


def test_the_larger_of_two_numbers_is_followed():
    answer = nav.compare(lambda x: np.maximum(x, 0.5) - np.minimum(x, 0.5), "abs(x - 1/2)", x=("0", "1"))
    assert answer.how == "certified" and float(answer.bound) < 1e-15


def test_a_trace_too_deep_to_be_read_is_sampled_and_cases_in_a_formula_are_refused():
    deep = nav.compare(lambda x: sum([0.1 * x] * 100), "10*x", x=("0", "1"))
    assert deep.how == "sampled" and "levels" in deep.evidence
    with pytest.raises(nav.NavsymError, match="expected operations and elementary functions"):
        nav.compare(lambda x: x, "where(x > 1/2, x, 1)", x=("0", "1"))
