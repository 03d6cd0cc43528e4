"""Statements that an attack left open: constants with room, corners of hypotheses, roots by other roots."""

from __future__ import annotations

from fractions import Fraction

import pytest

import navsym as nav
from navsym.prove.rooms import equations
from navsym.prove.rooms.goals import player
from navsym.prove.search import find_proof

VECTORS = {name: {"vector": 3} for name in "uvw"}


def decide(text, **given):
    names = {name: value for name, value in VECTORS.items() if name in text or name in str(given.get("given", ""))}
    return nav.prove(text, **{**names, **given})


@pytest.mark.parametrize(
    "text",
    [
        "dot(u, v) <= (1001/1000)*norm(u)*norm(v)",
        "norm(cross(u, v)) <= (1000000001/1000000000)*norm(u)*norm(v)",
        "sqrt(x**2 + y**2) <= 3/2*(abs(x) + abs(y))",
    ],
)
def test_a_bound_with_room_is_proved_as_the_sharp_one_is(text):
    assert decide(text).status == "PROVED"


@pytest.mark.parametrize(
    "text",
    [
        "dot(u, v) <= (999/1000)*norm(u)*norm(v)",
        "norm(u + v) <= (999999/1000000)*(norm(u) + norm(v))",
        "norm(u - w) <= (999/1000)*(norm(u - v) + norm(v - w))",
        "abs(dot(u, cross(v, w))) <= (999/1000)*norm(u)*norm(v)*norm(w)",
    ],
)
def test_a_bound_below_the_best_constant_is_refuted(text):
    assert decide(text).status == "REFUTED"


@pytest.mark.parametrize(("p", "q", "s"), [(2, Fraction(4, 5), 2), (5, 1, 5), (-1, Fraction(-3, 2), 3), (1, 1, 4)])
def test_a_linear_function_on_a_triangle_fails_at_the_corner_where_it_is_largest(p, q, s):
    most, given = max(0, p * s, q * s), ["x >= 0", "y >= 0", f"x + y <= {s}"]
    assert decide(f"({p})*x + ({q})*y <= {most - Fraction(1, 10**9)}", given=given).status == "REFUTED"
    assert decide(f"({p})*x + ({q})*y <= {most}", given=given).status == "PROVED"
    assert decide(f"({p})*x + ({q})*y < {most}", given=given).status == "REFUTED"


@pytest.mark.parametrize("square", [4, Fraction(9, 25), 1])
def test_points_on_a_sphere_of_rational_radius_are_known(square):
    given = ["dot(u, v) = 0", f"dot(u, u) = {square}"]
    text = f"dot(cross(u, cross(u, v)), v) = -({square})*dot(v, v)"
    assert decide(text, given=given).status == "PROVED"
    assert decide(f"{text} + 1/10**6", given=given).status == "REFUTED"


@pytest.mark.parametrize(
    "text",
    [
        "x/sqrt(2*(5 + sqrt(5))) = x*sqrt(5 - sqrt(5))/sqrt(40)",
        "sqrt(1 - (2*sqrt(2/7)*sin(x))**2) = sqrt(8*cos(x)**2 - 1)/sqrt(7)",
        "1/(sqrt(3*cos(x)**2 - sin(x)**2) + 1) = 1/(sqrt(4*cos(x)**2 - 1) + 1)",
    ],
)
def test_a_root_is_written_by_another_one(text):
    assert decide(text).status == "PROVED"
    assert decide(text.replace(" = ", " + x**2/10**9 = ")).status == "REFUTED"


def goal_of(term, relation="=", box=(), given=(), zeros=()):
    """A goal of the search, with real symbols."""
    terms = [player.parse(text) for text in (term, *given, *zeros)]
    names = set().union(*map(player.symbols_of, terms))
    ranges = {name: player.read_range(dict(box).get(name, [None, None, []])) for name in names}
    return player.Goal(terms[0], relation, ranges, (), tuple(terms[1 : 1 + len(given)]), tuple(terms[1 + len(given) :]))


@pytest.mark.parametrize(
    ("term", "zeros"),
    [("exp(x) - exp(a)*exp(b)", ["x - (a + b)"]), ("sin(x) - sin(a)*cos(b) - cos(a)*sin(b)", ["x - (a + b)"]),
     ("log(y) - 2*log(x)", ["y - x**2"]), ("sqrt(1 + c) - sqrt(1 + s**2)", ["s**2 - c"])],
)  # fmt: skip
def test_a_symbol_that_a_hypothesis_gives_is_eliminated(term, zeros):
    goal = goal_of(term, box={"x": ["0", None, ["open-low"]]} if "log" in term else {}, zeros=zeros)
    proof = find_proof(goal, rounds=((8, 200, 1),))
    assert proof is not None and proof["rule"] == "rewrite"
    assert find_proof(goal._replace(zeros=()), rounds=((8, 200, 1),)) is None


@pytest.mark.parametrize("text", ["2*atan(tanh(x/2)) = atan(sinh(x))", "atan(x) - asin(x/sqrt(1 + x**2)) = 0"])
def test_equal_slopes_and_one_value_prove_an_equation(text):
    verdict = decide(text)
    assert verdict.status == "PROVED"
    left, right = text.split(" = ")
    assert decide(f"{left} = {right} + 1/10**12").status == "REFUTED"


def test_slopes_are_compared_at_every_symbol_and_at_a_point_of_the_box():
    (proof, *_) = equations.by_gradient(goal_of("log(x*y) - log(y*x)", box={"x": ["2", "3", []]}), [])
    assert proof["rule"] == "derivative" and set(proof["point"]) == {"x", "y"}
    assert 2 <= Fraction(proof["point"]["x"]) <= 3
    assert not [*equations.by_gradient(goal_of("log(2) - log(2)"), [])]
    assert not [*equations.by_gradient(goal_of("x*y - y*x"), [])]  # its slopes are no simpler


FACTORED = [  # a claim, a hypothesis, and what makes the other factor of it no zero
    ("x = y", "x*z = y*z", {"z": "nonzero"}),
    ("x = y", "x*z*s = s*y*z", {"z": "nonzero", "s": "positive"}),
    ("x = y", "x**2 = y**2", {"x": "positive", "y": "positive"}),
    ("x = 1", "x*y - y + x*z - z = 0", {"y": ["1", "2"], "z": "nonnegative"}),
]


@pytest.mark.parametrize(("text", "hypothesis", "ranges"), FACTORED)
def test_a_factor_that_is_not_zero_falls_out_of_a_hypothesis_and_only_then(text, hypothesis, ranges):
    proved = nav.prove(text, given=[hypothesis], **ranges)
    assert proved.status == "PROVED" and proved.check().accepted
    assert nav.prove(text, given=[hypothesis]).status == "REFUTED"


def test_an_infinite_number_is_no_symbol_that_nobody_declared():
    for text in ("oo - oo = 0", "nan = nan", "inf = inf"):
        with pytest.raises(nav.NavsymError, match="write"):
            nav.prove(text)


def test_infinity_is_no_name_of_a_symbol_either():
    """As an end it is infinity, whatever is declared: limit(1/x, x, oo) = 0 would say nothing of the symbol."""
    for text in ("oo - oo = 0", "limit(1/x, x, oo) = oo - oo"):
        with pytest.raises(nav.NavsymError):
            nav.prove(text, oo=">0")
