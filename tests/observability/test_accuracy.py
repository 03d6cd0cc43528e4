"""How well a flight shows the state: against smoothers in fractions, closed forms, and numbers at forty digits."""

from __future__ import annotations

import copy
import json
import random
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp

import navsym as nav
from navsym import checker
from navsym.cli.main import run

t, w = sp.symbols("t w", real=True)
DOUBLE = {"F": [[0, 1], [0, 0]], "H": ["p"]}


def encloses(number, square) -> bool:
    """Whether the square of a deviation, an exact number, lies between the squares of its ends."""
    return Fraction(number.lower) ** 2 <= square <= Fraction(number.upper) ** 2


def deviations(accuracy):
    return {found.name: found.deviation for found in accuracy.targets}


def bound_of(Phi, H, T, sigma=1):
    """Exact covariance of the last state: Phi(t, 0) and h as matrices of sympy in t."""
    seen = H * Phi
    W = (seen.T * seen / sp.Integer(sigma) ** 2).applyfunc(lambda e: sp.integrate(sp.expand(e), (t, 0, T)))
    end = Phi.subs(t, T)
    return end * W.inv() * end.T


def smoothed_first_covariance(Phi, H, R, P0, count):
    """Covariance of the first state after all measurements: a Kalman filter and the sweep of Rauch, Tung, Striebel."""
    P, filtered, predicted = P0, [], []
    for _ in range(count):
        predicted.append(P)
        S = H * P * H.T + R
        P = P - P * H.T * S.inv() * H * P
        filtered.append(P)
        P = Phi * P * Phi.T
    smoothed = filtered[-1]
    for k in range(count - 2, -1, -1):
        gain = filtered[k] * Phi.T * predicted[k + 1].inv()
        smoothed = filtered[k] + gain * (smoothed - predicted[k + 1]) * gain.T
    return smoothed


@pytest.mark.parametrize("seed", range(4))
def test_the_information_is_that_of_a_kalman_smoother_without_its_prior(seed):
    source = random.Random(seed)
    n, steps = 2 + seed % 2, 4 + seed
    Phi = sp.eye(n) + sp.Matrix(n, n, lambda i, j: sp.Rational(source.randint(-3, 3), 4))
    if Phi.det() == 0:
        Phi += sp.eye(n)
    H = sp.Matrix(2, n, lambda i, j: source.randint(-2, 2))
    sigma = [sp.Rational(1, 2), sp.Integer(3)]
    P0 = sp.eye(n) * 7
    first = smoothed_first_covariance(Phi, H, sp.diag(*[s**2 for s in sigma]), P0, steps + 1)
    information = first.inv() - P0.inv()
    model = nav.Model([f"x{k}" for k in range(n)], Phi=Phi.tolist(), H=H.tolist(), sigma=sigma)
    found = deviations(nav.observe(model).accuracy(steps))
    covariance = Phi**steps * information.inv() * (Phi**steps).T
    assert all(encloses(found[f"x{k}"], Fraction(str(covariance[k, k]))) for k in range(n))
    assert all(number.digits >= 12 for number in found.values())


@pytest.mark.parametrize("T", ["1/3", "8", "500"])
def test_position_and_velocity_of_a_straight_track_have_their_textbook_deviations(T):
    found = deviations(nav.observe(nav.Model("p v", sigma=["1/2"], **DOUBLE)).accuracy(T))
    assert encloses(found["p"], 1 / Fraction(T)) and encloses(found["v"], 3 / Fraction(T) ** 3)


def test_a_model_in_time_has_the_deviations_of_its_integrals():
    Phi = sp.Matrix([[1, t**2 / 2], [0, 1]])
    covariance = bound_of(Phi, sp.Matrix([[1, 0]]), 3)
    found = deviations(nav.observe(nav.Model("p v", F=[[0, "t"], [0, 0]], H=["p"], interval=3)).accuracy())
    moved = nav.Model("p v", F=[[0, "f"], [0, 0]], H=["p"], f="real", rates={"f": "1"}, interval=3)
    again = deviations(nav.observe(moved).accuracy(start={"f": 0}))
    for k, name in enumerate("pv"):
        assert encloses(found[name], Fraction(str(covariance[k, k])))
        assert encloses(again[name], Fraction(str(covariance[k, k])))


def test_a_nonlinear_flight_has_the_deviations_of_its_sensitivities():
    # x' = -V x from x = 3 with V = 1
    Phi = sp.Matrix([[sp.exp(-t), -3 * t * sp.exp(-t)], [0, 1]])
    covariance = bound_of(Phi, sp.Matrix([[1, 0]]), 2, 1)
    answer = nav.observe(nav.Model("x V", dynamics=["-V*x", "0"], H=["x"]))
    found = deviations(answer.accuracy(2, start={"x": 3, "V": 1}))
    with mpmath.workdps(40):
        for k, name in enumerate("xV"):
            value = mpmath.sqrt(mpmath.mpf(sp.N(covariance[k, k], 40)))
            assert mpmath.mpf(found[name].lower) <= value <= mpmath.mpf(found[name].upper)


def test_a_turn_of_rates_has_the_deviations_of_forty_digits():
    model = nav.Model("v tilt bias", F=[[0, "sin(3*t)", 1], [0, 0, "t"], [0, 0, 0]], H=["v"], interval=4)
    found = deviations(nav.observe(model).accuracy())
    with mpmath.workdps(40):
        a = lambda s: (1 - mpmath.cos(3 * s)) / 3  # noqa: E731
        inner = lambda u: -(u**2) * mpmath.cos(3 * u) / 3 + 2 * u * mpmath.sin(3 * u) / 9 + 2 * mpmath.cos(3 * u) / 27  # noqa: E731
        b = lambda s: s + (inner(s) - inner(0)) / 2  # noqa: E731
        rows = lambda s: [mpmath.mpf(1), a(s), b(s)]  # noqa: E731
        places = [mpmath.mpf(k) / 2 for k in range(9)]
        W = mpmath.matrix(3, 3)
        for i in range(3):
            for j in range(i, 3):
                W[i, j] = W[j, i] = mpmath.quad(lambda s, i=i, j=j: rows(s)[i] * rows(s)[j], places)
        end = mpmath.matrix([rows(mpmath.mpf(4)), [0, 1, 8], [0, 0, 1]])
        covariance = end * W**-1 * end.T
        for k, name in enumerate(("v", "tilt", "bias")):
            value = mpmath.sqrt(covariance[k, k])
            assert mpmath.mpf(found[name].lower) * (1 - mpmath.mpf("1e-20")) <= value
            assert value <= mpmath.mpf(found[name].upper) * (1 + mpmath.mpf("1e-20"))


def leg(force):
    return [["0", force, "1"], ["0", "0", "0"], ["0", "0", "0"]]


def test_legs_are_carried_into_each_other():
    pieces = [("0", "2", leg("0")), ("2", "5", leg("3"))]
    found = deviations(nav.observe(nav.Model("v tilt bias", pieces=pieces, H=["v"], interval=5)).accuracy())
    whole = sp.zeros(3, 3)
    for start, end, force in ((0, 2, 0), (2, 5, 3)):
        row = sp.Matrix([[1, force * (t - start), t]])
        whole += (row.T * row).applyfunc(lambda e, s=start, u=end: sp.integrate(sp.expand(e), (t, s, u)))
    end = sp.Matrix([[1, 9, 5], [0, 1, 0], [0, 0, 1]])
    covariance = end * whole.inv() * end.T
    names = ("v", "tilt", "bias")
    assert all(encloses(found[name], Fraction(str(covariance[k, k]))) for k, name in enumerate(names))


def test_samples_add_up_where_the_model_moves_and_over_the_seam_of_two_legs():
    moving = nav.Model("p v", F=[[0, "t"], [0, 0]], H=["p"], sigma=["2"], interval="7/2")
    found = deviations(nav.observe(moving).accuracy(every="1/2"))
    W = sp.zeros(2, 2)
    for k in range(8):
        row = sp.Matrix([[1, sp.Rational(k, 2) ** 2 / 2]])
        W += row.T * row / 4
    end = sp.Matrix([[1, sp.Rational(49, 8)], [0, 1]])
    covariance = end * W.inv() * end.T
    assert all(encloses(found[name], Fraction(str(covariance[k, k]))) for k, name in enumerate("pv"))
    legs = nav.Model("v q b", pieces=[("0", "3/4", leg("0")), ("3/4", "2", leg("3"))], H=["v"], interval=2)
    found = deviations(nav.observe(legs).accuracy(every="1/2"))
    rows = [[1, 3 * max(Fraction(0), t - Fraction(3, 4)), t] for t in (Fraction(k, 2) for k in range(5))]
    rows = sp.Matrix([[sp.Rational(str(x)) for x in row] for row in rows])
    end = sp.Matrix([[1, sp.Rational(15, 4), 2], [0, 1, 0], [0, 0, 1]])
    covariance = end * (rows.T * rows).inv() * end.T
    assert all(encloses(found[name], Fraction(str(covariance[k, k]))) for k, name in enumerate("vqb"))


def test_a_direction_that_turns_with_the_time_is_never_called_certified():
    # (0, 1, t) is never shown: what is known of b and c is t b - c
    F = [[0, "t", -1], [0, 0, 0], [0, 1, 0]]
    targets = {"a": "a", "mix": "3*b - c", "b": "b"}
    answer = nav.observe(nav.Model("a b c", F=F, H=["a"], interval=3, targets=targets))
    assert answer.unobservable == ("(b, c) = (1, t)",)
    assert [target.status for target in answer.accuracy().targets] == ["certified", "open", "unobservable"]


def test_what_is_never_shown_is_said_and_the_rest_is_enclosed():
    targets = {"v": "v", "sum": "4*tilt + bias", "tilt": "tilt"}
    model = nav.Model("v tilt bias", F=leg("4"), H=["v"], interval=5, targets=targets)
    found = nav.observe(model).accuracy()
    assert [target.status for target in found.targets] == ["certified", "certified", "unobservable"]
    assert encloses(deviations(found)["sum"], Fraction(12, 5**3))
    assert found.deviation is None and "unobservable" in repr(found)


def test_a_demand_is_met_between_the_two_times():
    model = nav.Model("p v", interval=50, **DOUBLE)
    (_, v) = nav.observe(model).accuracy(demands={"v": "1/100"}).targets
    exact = (12 * 10**4) ** (1 / 3)
    assert Fraction(v.before) <= Fraction(exact) + Fraction(1, 10**9) and float(Fraction(v.reached)) >= exact - 1e-9
    assert Fraction(v.reached) - Fraction(v.before) < Fraction(1, 10**5)
    (_, v) = nav.observe(model).accuracy(demands={"v": "1/1000"}).targets
    assert v.reached is None and Fraction(v.before) == 50
    steps = nav.Model("p v", Phi=[[1, 1], [0, 1]], H=["p"])
    (_, v) = nav.observe(steps).accuracy(40, demands={"v": "1/10"}).targets
    variance = lambda N: Fraction(12, N * (N + 1) * (N + 2))  # noqa: E731  # of a slope from N + 1 samples
    assert variance(int(v.reached)) <= Fraction(1, 100) < variance(int(v.before))
    assert int(v.reached) == int(v.before) + 1


def test_the_weakest_direction_is_the_largest_eigenvector_in_the_units_of_the_states():
    model = nav.Model("p v", interval=8, **DOUBLE)
    T, units = 8, np.array([1.0, 0.01])
    covariance = np.array([[4 / T, 6 / T**2], [6 / T**2, 12 / T**3]]) / np.outer(units, units)
    sizes, vectors = np.linalg.eigh(covariance)
    found = nav.observe(model).accuracy(scales={"v": "1/100"})
    assert float(found.deviation) == pytest.approx(sizes[-1] ** 0.5, rel=1e-12)
    direction = np.array([found.weakest["p"], found.weakest["v"]])
    assert abs(direction @ vectors[:, -1]) == pytest.approx(1, abs=1e-12)
    assert found.history[-1][3] == pytest.approx(sizes[-1] ** 0.5, rel=1e-9)
    assert len(nav.plot(found).axes) == 2


def test_each_certificate_is_granted_and_falls_when_it_is_spoiled():
    found = nav.observe(nav.Model("p v", interval=8, **DOUBLE)).accuracy()
    assert "all ACCEPTED" in repr(found.check())
    listed = found.certificates()
    assert [checker.check(item) for item in listed] == ["all", "all"]
    for item in listed:
        for place in (0, 1):
            spoiled = copy.deepcopy(item)
            spoiled["of"][place]["lower"] = str(Fraction(spoiled["of"][place]["lower"]) * Fraction(101, 100))
            with pytest.raises(checker.Refused):
                checker.check(spoiled)
            spoiled = copy.deepcopy(item)
            spoiled["of"][place]["blocks"][0]["H"][0][0] = "7"
            with pytest.raises(checker.Refused):
                checker.check(spoiled)


@pytest.mark.parametrize(
    ("model", "arguments", "words"),
    [
        ({}, {}, "expected the length of the flight; got no interval"),
        ({}, {"T": -1}, "expected a positive fraction"),
        ({}, {"T": "pi"}, "expected a positive fraction"),
        ({}, {"T": 1, "demands": {"q": 1}}, "expected a name of the model"),
        ({}, {"T": 1, "every": "1/1000000"}, "at most 20000 samples"),
        ({"F": [[0, "a"], [0, 0]], "a": "real"}, {"T": 1}, "expected a value of a"),
        ({"F": [[0, "a"], [0, 0]], "a": "real", "rates": {"a": "1"}}, {"T": 1}, "expected a start of a"),
        ({"F": [[0, "1/(t - 1)"], [0, 0]]}, {"T": 2}, "analytic along the flight"),
        ({"inputs": {"u": ["0", "1"]}}, {"T": 1}, "without inputs"),
    ],
)
def test_what_is_no_flight_is_refused_in_words(model, arguments, words):
    answer = nav.observe(nav.Model("p v", **{**DOUBLE, **model}))
    with pytest.raises(nav.NavsymError, match=words):
        answer.accuracy(**arguments)


def test_the_command_prints_the_deviations_and_one_document(tmp_path, capsys):
    path = tmp_path / "track.toml"
    nav.Model("p v", interval=8, **DOUBLE).save(path)
    assert run(["observe", str(path), "--demand", "v = 1/5", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)["accuracy"]
    assert [target["status"] for target in data["targets"]] == ["certified", "certified"]
    assert data["targets"][1]["demand"] == "0.2" and float(Fraction(data["targets"][1]["reached"])) < 8
    assert run(["observe", str(path), "--accuracy", "--every", "1"]) == 0
    shown = capsys.readouterr().out
    assert "least standard deviation" in shown and "weakest direction" in shown
    assert run(["observe", str(path), "--until", "x", "--json"]) == 2
    assert set(json.loads(capsys.readouterr().out)) == {"error"}
