"""Certificates of ranks and drops: the checker grants what is listed, and nothing that is changed."""

from __future__ import annotations

import copy
import itertools
import time

import pytest
import sympy as sp

import navsym as nav
from navsym import checker
from navsym.cli.main import run
from navsym.models.linear import LinearModel
from navsym.observability import certificates, document
from navsym.observability.answer import observe_linear
from navsym.observability.certificates import LONG, NO_SHARES, Certifier, is_granted, list_nested, solve_near
from navsym.observability.points import search_points
from navsym.observability.ring import Ring

REAL = "real"


def couplings():
    F = [["0", "a", "0"], ["0", "0", "b"], ["0", "0", "0"]]
    return nav.observe(nav.Model("x y z", F=F, H=["x"], a=REAL, b=REAL))


def turning():
    F = [["0", "f", "k*t + c"], ["0", "0", "k"], ["0", "0", "0"]]
    return nav.observe(nav.Model("v tilt bias", F=F, H=["v"], f=REAL, r=REAL, k=REAL, c=REAL, rates={"f": "r"}))


def at_latitude():
    F = [["0", "w*sin(L)", "0"], ["-w*sin(L)", "0", "w*cos(L)"], ["0", "-w*cos(L)", "0"]]
    return nav.observe(nav.Model("n e d", F=F, H=["n"], w=REAL, L=REAL))


def on_a_cone():
    F = [["0", "x**2*(y**2 + w**2) - 1"], ["0", "0"]]
    return nav.observe(nav.Model("a b", F=F, H=["a"], x=REAL, y=REAL, w=REAL))


def two_rows():
    """Nothing moves, and two sensors with parallel rows show one number: three minors, no equation names a variable."""
    H, names = [["a1", "a2", "a3"], ["b1", "b2", "b3"]], "a1 a2 a3 b1 b2 b3"
    return nav.observe(nav.Model("x y z", F=[["0"] * 3] * 3, H=H, **dict.fromkeys(names.split(), REAL)))


def at_an_angle():
    """On a sin(p) = b the rank is smaller still where p is a multiple of a right angle."""
    H = [["a*sin(p) - b", "0"], ["0", "b*sin(2*p)"]]
    return nav.observe(nav.Model("x y", F=[["0"] * 2] * 2, H=H, a=REAL, b=REAL, p=REAL))


@pytest.mark.parametrize("answer_of", [couplings, turning, at_latitude, at_an_angle, on_a_cone, two_rows])
def test_every_rank_and_every_drop_that_lasts_is_granted(answer_of):
    answer = answer_of()
    lasting = [drop for drop in list_nested(answer.rank_drops) if drop.lasting]
    listed = answer.certificates()
    assert len(listed) == 1 + len(lasting) and all(map(is_granted, listed))
    data = answer.document()
    assert data["checked"] and all(drop["checked"] for drop in data["rank_drops"])
    for drop in (data["instant"] or {"rank_drops": []})["rank_drops"]:
        assert not drop["checked"]  # what holds in passing has no certificate yet


def test_the_certificate_says_the_model_and_the_condition():
    drop = next(drop for drop in couplings().certificates() if drop["statement"]["zeros"] == ["b"])
    assert drop["statement"]["F"] == [["0", "a", "0"], ["0", "0", "b"], ["0", "0", "0"]]
    assert (drop["statement"]["H"], drop["statement"]["rank"]) == ([["1", "0", "0"]], 2)


@pytest.mark.parametrize("answer_of", [couplings, turning, at_latitude, two_rows])
def test_no_other_rank_and_no_weaker_condition_is_granted(answer_of):
    parts = [part for item in answer_of().certificates() for part in item.get("of", [item])]
    for part in parts:
        for rank in range(len(part["statement"]["F"]) + 1):
            forged = copy.deepcopy(part)
            forged["statement"]["rank"] = rank
            assert is_granted(forged) == (rank == part["statement"]["rank"])
        for place, _ in enumerate(part["statement"]["zeros"]):
            forged = copy.deepcopy(part)
            del forged["statement"]["zeros"][place]
            forged["shares"] = [[*row[:place], *row[place + 1 :]] for row in forged["shares"]]
            assert not is_granted(forged)


def test_an_attitude_on_its_manifold_is_granted():
    """The unit quaternion is a zero that the motion keeps; gravity leaves the heading open."""
    turn = [
        "(-q1*w1 - q2*w2 - q3*w3)/2",
        "(q0*w1 + q2*w3 - q3*w2)/2",
        "(q0*w2 - q1*w3 + q3*w1)/2",
        "(q0*w3 + q1*w2 - q2*w1)/2",
    ]
    gravity = ["2*(q1*q3 - q0*q2)", "2*(q2*q3 + q0*q1)", "q0**2 - q1**2 - q2**2 + q3**2"]
    unit = ["q0**2 + q1**2 + q2**2 + q3**2 = 1"]
    answer = nav.observe(nav.Model("q0 q1 q2 q3", dynamics=turn, H=gravity, relations=unit, w1=REAL, w2=REAL, w3=REAL))
    (granted,) = answer.certificates()
    assert (answer.rank, checker.check(granted)) == (3, "observability")
    assert len(granted["statement"]["zeros"]) == 1


def test_what_is_too_long_stands_as_unchecked():
    from tests.benchmarks.observability import navigation_errors

    model = navigation_errors()
    assert Certifier.of(model).certify(12, [[Certifier.of(model).motion.clock ** 9] * 15] * 3, [], range(3)) == LONG


def test_when_the_time_runs_out_the_answer_says_which_drops_have_no_certificate(monkeypatch):
    monkeypatch.setattr(document, "SECONDS", 0)
    data = couplings().document()
    assert data["checked"] and data["rank_drops"]
    assert {drop["unchecked"] for drop in data["rank_drops"]} == {document.NO_TIME}


@pytest.mark.slow
def test_a_minute_suffices_for_the_whole_answer_about_28_states():
    from tests.benchmarks.observability import satellite_and_odometer

    start = time.process_time()
    answer = observe_linear(satellite_and_odometer())
    data = answer.document()
    assert time.process_time() - start < 60
    assert answer.rank == 15 and data["proved"]
    assert any(drop["checked"] for drop in data["rank_drops"])
    assert all(drop["checked"] or drop["unchecked"] for drop in data["rank_drops"])


def test_what_must_not_vanish_may_move():
    """x' = m y shows y at the points with m != 0, and nothing is granted of the points with m = 0 by its reciprocal."""
    m, k = sp.symbols("m k", real=True)
    certifier = Certifier.of(LinearModel(sp.Matrix([[0, m], [0, 0]]), None, sp.Matrix([[1, 0]]), rates={m: k}))
    moving = certifier.motion.ring.context.gen(certifier.motion.ring.places[m])
    item = certifier.certify(2, [], [], [0], [moving])
    assert not isinstance(item, str) and item["statement"]["rates"].keys() == {"m", "tt"}
    (zero,) = item["statement"]["zeros"]
    assert sp.sympify(zero) == sp.Symbol("m") * sp.Symbol("tt") - 1
    assert certifier.certify(2, [], [moving], [0], [moving]) == NO_SHARES


@pytest.mark.parametrize("turn", range(3))
@pytest.mark.parametrize(
    "equations",
    [
        "f1*w3 + f1*n3 + f3*n1, f1*w2 + f1*n2 + f2*n1, f2*w2 + 2*f2*n2 + f3*w3 + 2*f3*n3, "
        "f2*w3 + f2*n3 - f3*w2 - f3*n2, w2**2 + 3*w2*n2 + w3**2 + 3*w3*n3 + 2*n2**2 + 2*n3**2, "
        "f1*f2*n2 + f1*f3*n3 - n1*f2**2 - n1*f3**2",
        "f1*w2 - f2*w1, f2*w3 - f3*w2, f3*w1 - f1*w3, w1**2 + w2**2 + w3**2 - 1",
        "f2, f3, w2*n2 + w3*n3 + n2**2 + n3**2, w1*n1 + 2*n1**2 + n2**2 + n3**2",
    ],
)
def test_a_point_is_found_where_some_equations_follow_from_others_or_ask_for_other_signs(equations, turn):
    zeros = [sp.sympify(text) for text in equations.split(",")]
    names = sorted(set().union(*(zero.free_symbols for zero in zeros)), key=str)
    found = solve_near(zeros, {x: sp.Rational(k + 2, 7) for k, x in enumerate(names)}, turn)
    assert all(sp.expand(zero.subs(found)) == 0 for zero in zeros)
    assert sum(value != 0 for value in found.values()) >= len(names) - 2


def test_drops_where_two_angles_differ_by_a_quarter_turn_are_granted():
    answer = nav.observe(nav.Model("x y", F=[["0", "cos(A - B)"], ["sin(A + B)", "0"]], H=["x"], A=REAL, B=REAL))
    certifier, joint = Certifier.of(answer.model), [drop for drop in answer.rank_drops if drop.subspace == "joint"]
    items = [certifier.certify_drop(drop) for drop in joint]
    assert len(items) == 2 and all(not isinstance(item, str) and checker.check(item) for item in items)


def ask(H, rank, columns, zeros):
    """A certificate for constant states."""
    certifier = Certifier.of(LinearModel(sp.zeros(H.cols), None, H, time=sp.Dummy("still", real=True)))
    ring = certifier.motion.ring
    written = [[ring.quotient(sp.sympify(x)).top for x in column] for column in columns]
    return certifier.certify(rank, written, [ring.quotient(zero).top for zero in zeros], range(H.rows))


def test_a_direction_is_not_measured_in_a_place_where_it_vanishes_with_the_zeros():
    a, b = sp.symbols("a b", real=True)
    item = ask(sp.Matrix([[b, a]]), 1, [[-a, b]], [a])
    assert item["free"] == [1] and checker.check(item)


def test_points_are_whole_numbers_where_the_roots_of_fractions_are_too_long_for_the_checker():
    names = "p1 p2 p3 q1 q2 q3 r1 r2 r3"
    p, u, q, r, v, s, x, w, y = sp.symbols(names, real=True)
    circle = (p**2 + q**2) * (r * y - s * x) + (p * s - q * r) * (x**2 + y**2) - (r**2 + s**2) * (p * y - q * x)
    item = ask(sp.Matrix([[circle + u - v, v - w]]), 0, [[1, 0], [0, 1]], [u - v, v - w, sp.expand(circle)])
    assert checker.check(item) and all("/" not in item["point"][name] for name in ("p2", "q2", "r2"))


@pytest.mark.parametrize(
    "equation",
    [
        "x**2 + y**2 - 3*z**2",
        "40*x**8 + 112*x**6*y**2 + 96*x**4*y**4 + 16*x**2*y**6 - 8*y**8 + 72*x**7*y*z + 108*x**5*y**3*z - 36*x*y**7*z"
        "- 27*x**6*y**2*z**2 - 81*x**4*y**4*z**2 - 54*x**2*y**6*z**2 - 81*x**5*y**3*z**3 - 81*x**3*y**5*z**3"
        "- 81*x**4*y**4*z**4",
    ],
)
def test_points_may_be_multiples_of_square_roots(equation):
    ring = Ring.of(sp.symbols("x y z", real=True))
    zero = sp.sympify(equation, locals={str(s): s for s in ring.symbols})
    points = [*itertools.islice(search_points([ring.quotient(zero).top], ring), 2)]
    assert len(points) == 2 and all(sp.expand(zero.subs(point)) == 0 for point in points)
    assert not any(all(value.is_Rational for value in point.values()) for point in points)


def test_a_circle_without_rational_points_has_a_certificate():
    x, y = sp.symbols("x y", real=True)
    assert checker.check(ask(sp.Matrix([[x**2 + y**2 - 3, 0]]), 0, [[1, 0], [0, 1]], [x**2 + y**2 - 3]))


def test_a_direction_that_has_a_factor_in_common_where_the_condition_holds_is_written_without_it(monkeypatch):
    monkeypatch.setattr(certificates, "COLUMN_TERMS", (40, 40))
    a, b = sp.symbols("a b", real=True)
    long = sp.expand((a + b + 1) ** 5)
    item = ask(sp.Matrix([[a, b]]), 1, [[long * a, -long * b]], [a - b])
    assert item["null"] in ([["1", "-1"]], [["-1", "1"]]) and checker.check(item)


def test_what_the_checker_does_not_grant_is_printed_with_its_reason(tmp_path, capsys):
    F = [["0", "f", "1"], ["0", "0", "0"], ["0", "0", "0"]]
    model = nav.Model("v tilt bias", F=F, H=["v"], f=REAL, r=REAL, s=REAL, rates={"f": "r", "r": "s"})
    model.save(tmp_path / "moving.toml")
    answer = nav.observe(model)
    passing = answer.document()["instant"]["rank_drops"]
    assert passing and {drop["unchecked"] for drop in passing} == {"it holds in passing"}
    assert "unchecked: it holds in passing" in answer.page() and "granted by the checker" in answer.latex()
    assert run(["observe", str(tmp_path / "moving.toml")]) == 0
    assert "unchecked: it holds in passing" in " ".join(capsys.readouterr().out.split())
    legs = nav.Model(
        "v tilt", pieces=[("0", "1", [["0", "f"], ["0", "0"]]), ("1", "2", [["0", "1"], ["0", "0"]])], H=["v"], f=REAL
    )
    assert nav.observe(legs).document()["checked"]
