"""Designs: against the enumeration of every purchase by a linear programme, by hand, and with forged certificates."""

from __future__ import annotations

import copy
import json
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest

import navsym as nav
from navsym import checker
from navsym.cli.main import run
from tests.guaranteed.streams import random_model

LINE = {"states": "x v", "F": [["0", "1"], ["0", "0"]], "H": ["x", "v"], "targets": {"v": "v", "start": "x - 4*v"}}
SCHULER = {
    "states": "y1 y2 y3",
    "F": [["0", "-1", "0"], ["0", "0", "1"], ["0", "-1", "0"]],
    "H": ["y1", "y2"],
    "sigma": ["1", "1/2"],
    "targets": {"drift": "y3"},
}


def offer_of(rng, p):
    """Instants, what they cost, sensors with costs or grades, and a budget."""
    times = sorted({Fraction(int(k), 4) for k in rng.integers(0, 12, 4)})
    sensors = {f"z{j + 1}": int(rng.integers(0, 3)) for j in range(p)}
    sensors["z1"] = [(Fraction(int(rng.integers(1, 5)), 2), int(rng.integers(0, 2))), ("1/4", 3)]
    return times, int(rng.integers(0, 3)), sensors, int(rng.integers(3, 9))


def enumerated(plain, sigma, times, instant, sensors, budget):
    """The least error of every purchase within the budget, by HiGHS; None where none shows the target."""
    prices = {t: instant for t in times}
    grades = []
    for j, (name, offer) in enumerate(sensors.items()):
        for bound, cost in offer if isinstance(offer, list) else [(sigma[j], offer)]:
            grades.append((j, float(Fraction(bound))))
            prices[name, bound] = cost
    items, best = list(prices), None
    sensor_items = [item for item in items if isinstance(item, tuple)]
    for size in range(len(items) + 1):
        for bought in combinations(items, size):
            if sum(prices[i] for i in bought) > budget:
                continue
            plain.rows = [
                (0, float(t), j, 0.0, bound)
                for t in times if t in bought
                for item, (j, bound) in zip(sensor_items, grades, strict=True) if item in bought
            ]  # fmt: skip
            value = plain.radius(float(times[-1]))
            best = value if best is None or (value is not None and value < best) else best
    return best


def check_against_enumeration(seeds):
    """How many random designs were compared."""
    compared = 0
    for seed in seeds:
        rng = np.random.default_rng(seed)
        model, plain, sigma = random_model(
            rng, int(rng.integers(1, 4 if seed % 4 == 0 else 3)), int(rng.integers(1, 3))
        )
        times, instant, sensors, budget = offer_of(rng, len(sigma))
        best = enumerated(plain, sigma, times, instant, sensors, budget)
        try:
            found = nav.design(model, times=times, budget=budget, instant=instant, sensors=sensors)
        except nav.NavsymError as error:
            without_formula = "has a formula" in str(error)  # of exp(F t): there is no certificate
            assert without_formula or (error.kind == "not-estimable" and best is None), seed
            continue
        assert found.check() and Fraction(found.cost) <= budget
        assert float(found.value.lower) <= best * (1 + 1e-7) + 1e-9, seed
        if str(found.status) == "CERTIFIED":
            compared += 1
            assert best == pytest.approx(float(found.value.upper), rel=1e-7, abs=1e-9), seed
            assert Fraction(found.value.upper) - Fraction(found.value.lower) <= Fraction(found.value.upper) / 10**12
    return compared


@pytest.mark.long
def test_the_design_is_the_best_of_all_purchases_that_a_linear_programme_finds():
    assert check_against_enumeration(range(8)) >= 4


@pytest.mark.slow
def test_two_hundred_designs_are_the_best_of_all_purchases():
    assert check_against_enumeration(range(100, 300)) >= 100


def test_a_design_with_a_sum_of_errors_is_the_best_of_all_purchases_and_members_may_be_left_out():
    """Every purchase within the budget is solved by itself, its members bounded together as far as they are bought."""
    rng, compared = np.random.default_rng(6), 0
    for _ in range(6):
        both = [{"measurements": "z1 z2", "norm": "l1"}]
        P = [int(rng.integers(-3, 4)), int(rng.integers(1, 4))]
        model = nav.Model(**LINE | {"targets": {"goal": P}}, sigma=["1", "2"], blocks=both)
        instant = int(rng.integers(1, 3))
        prices = {f"t = {k}": instant for k in range(3)}
        offers = {("z1", "1"): 1, ("z2", "2"): int(rng.integers(1, 3)), ("z2", "1/2"): 4}
        budget, best = int(rng.integers(4, 9)), None
        for size in range(7):
            for bought in combinations([*prices, *offers], size):
                if sum((prices | offers)[i] for i in bought) > budget:
                    continue
                blocks = []
                for k in range(3):
                    grades = [[g for g in bought if g[0] == name] for name in ("z1", "z2")]
                    if f"t = {k}" not in bought or not any(grades):
                        continue
                    pairs = [(a, b) for a in grades[0] or [None] for b in grades[1] or [None]]
                    for pair in pairs:
                        rows = [([1, k - 2] if g[0] == "z1" else [0, 1], g[1]) for g in pair if g]
                        blocks.append(nav.Block([h for h, _ in rows], [s for _, s in rows], "l1"))
                try:
                    value = float(nav.solve_blocks(blocks, P).value) if blocks else None
                except nav.NavsymError:
                    continue
                best = value if best is None or (value is not None and value < best) else best
        sensors = {"z1": [("1", 1)], "z2": [(s, c) for (name, s), c in offers.items() if name == "z2"]}
        if best is not None:
            found = nav.design(model, times=range(3), budget=budget, instant=instant, sensors=sensors)
            assert float(found.value) == pytest.approx(best, rel=1e-9) and found.check().accepted
            compared += "sigma" in str(found)
    assert compared >= 1


def test_a_velocity_is_best_known_from_the_two_ends_and_the_slopes_say_so():
    """Two positions of bound 1, four seconds apart, give a velocity with 2/4; it grows when they come closer."""
    found = nav.design(nav.Model(**LINE), "v", times=range(5), budget=2, sensors={"z1": 0})
    first, last = found.points
    assert (first.at, last.at, found.cost, str(found.status)) == ("0", "4", "2", "CERTIFIED")
    assert (first.slope, last.slope) == pytest.approx((1 / 8, -1 / 8)) and first.share == pytest.approx(1 / 2)


def test_sensitivities_are_those_of_the_optimum_of_moved_instants_and_bounds():
    times = ["1/5", "1", "2", "13/5", "4"]
    model = nav.Model(**SCHULER)
    found = nav.design(model, times=times, budget=3, sensors={"z1": 0})
    chosen, small = [p.at for p in found.points], Fraction(1, 10**6)

    def value(k, by, sigma):
        moved = [Fraction(t) + by * (i == k) for i, t in enumerate(chosen)]
        other = nav.Model(**SCHULER | {"H": ["y1", "y1"], "sigma": ["1", sigma]})
        guard = nav.Guard(other, memory=None, bound="variance")
        for i, t in enumerate(moved):
            last = guard.step([None, 0] if i == k and sigma != "1" else [0, None], t=t)
        return float(last.radius.upper)

    assert chosen[-1] == "4"  # the estimate is at the last instant, which must not move here
    base = float(found.value.upper)
    for k, point in enumerate(found.points):
        assert (value(k, 0, "1.000001") - base) * 1e6 == pytest.approx(abs(point.weight), rel=1e-3)
        if k < 2:
            slope = (value(k, small, "1") - value(k, -small, "1")) / float(2 * small)
            assert slope == pytest.approx(point.slope, rel=1e-4, abs=1e-7)


def test_fewer_measurements_than_unknowns_may_show_the_target_and_weights_of_zero_are_exact():
    found = nav.design(nav.Model(**SCHULER), times=range(5), budget=4, sensors={"z1": 9, "z2": 2})
    assert len(found.points) == 2 and found.points[0].slope is None and found.check()


@pytest.mark.parametrize("digits", [3, 20, 40])
def test_the_two_bounds_agree_to_the_digits_that_are_asked_for(digits):
    found = nav.design(nav.Model(**SCHULER), times=range(6), budget=4, sensors={"z1": 0}, digits=digits)
    lower, upper = (Fraction(end) for end in (found.value.lower, found.value.upper))
    assert 0 < upper - lower <= upper / 10**digits and str(found.status) == "CERTIFIED" and found.check()
    assert Fraction(found.value.upper) - Fraction(found.value.lower) > upper / 10 ** (digits + 3)  # no more is proved


def test_the_comparison_is_that_of_all_measurements_that_are_bought():
    """Least squares by the pseudoinverse; no solver, and no other estimator, is better than the design."""
    model = nav.Model(**SCHULER)
    found = nav.design(model, times=range(7), budget=9, sensors={"z1": 1, "z2": 1})
    beside, rows = found.compare(), []
    for item in found.bought:
        if item.startswith("t = "):
            t = float(Fraction(item[4:])) - 6
            back = [[1, -np.sin(t), np.cos(t) - 1], [0, np.cos(t), np.sin(t)], [0, -np.sin(t), np.cos(t)]]
            rows += [(back[k], [1, 0.5][k]) for k in range(2) if f"z{k + 1}" in found.bought]
    H, sigma = np.array([row for row, _ in rows]), np.array([bound for _, bound in rows])
    for trust, value in ((1 + 0 * sigma, beside.least_squares), (sigma, beside.kalman_white_noise)):
        weights = np.linalg.pinv(H / trust[:, None])[2] / trust
        assert value == pytest.approx(np.abs(weights) @ sigma, rel=1e-9) and value > float(found.value.lower)
    best = {answer.solver: answer.value for answer in beside.solvers}
    assert best["casadi:highs"] == pytest.approx(float(found.value.upper), rel=1e-9) and len(best) == 5


def test_a_budget_that_shows_nothing_is_an_error_that_says_so():
    with pytest.raises(nav.NavsymError, match="raise the budget") as caught:
        nav.design(nav.Model(**LINE), "v", times=range(4), budget=1, sensors={"z1": 0})
    assert caught.value.kind == "not-estimable"


@pytest.mark.parametrize(
    ("options", "kind"),
    [
        ({}, "empty"),
        ({"times": []}, "domain"),
        ({"times": range(3), "instant": -1}, "domain"),
        ({"times": range(3), "sensors": {"z9": 1}}, "unknown-symbol"),
        ({"times": range(3), "sensors": {"z1": [1, 2]}}, "domain"),
        ({"times": range(3), "sensors": {"z1": [("0", 2)]}}, "domain"),
        ({"times": ["now"]}, "syntax"),
        ({"times": 3}, "domain"),
        ({"times": "0, 1"}, "domain"),
        ({"times": [0, "1/2", 0.5]}, "duplicate"),
        ({"times": range(3), "sensors": {"z1": [("1/2", 1), ("0.5", 2)]}}, "duplicate"),
        ({"times": range(3), "sensors": ["z1"]}, "domain"),
        ({"times": range(900)}, "too-large"),
        ({"times": range(3), "digits": 41}, "domain"),
        ({"times": range(3), "digits": "7"}, "domain"),
    ],
)
def test_what_is_no_design_is_an_error_of_one_line(options, kind):
    with pytest.raises(nav.NavsymError) as caught:
        nav.design(nav.Model(**LINE), "v", budget=3, **options)
    assert caught.value.kind == kind and "\n" not in str(caught.value) and str(caught.value).count(";") >= 2


def forged(document, rng):
    """The certificate with one false thing in it."""
    changed, what = copy.deepcopy(document), int(rng.integers(7))
    small = Fraction(1, 10**9)
    if what == 0:
        changed["lower"] = str(Fraction(document["upper"]) * (1 + small))
    elif what == 1:
        changed["upper"] = str(Fraction(document["lower"]) * (1 - small))
    elif what == 2:
        changed["duals"] = [[str(Fraction(e) * (1 - small)) for e in x] for x in document["duals"]]
    elif what == 3:
        del changed["duals"][int(rng.integers(len(changed["duals"])))]
    elif what == 4:
        changed["budget"] = "-1"
    elif what == 5:
        changed["rows"][0]["needs"] = ["nothing"]
    else:
        changed["support"][0] = changed["support"][-1]
    return changed


def forge(count, rng):
    """How many forged certificates were refused."""
    model = nav.Model(**SCHULER)
    sensors = {"z1": 1, "z2": [("1/2", 2), ("1/5", 4)]}
    true = [dict(nav.design(model, times=[f"{k}/2" for k in range(8)], budget=b, sensors=sensors).certificate)
            for b in (4, 5, 6)]  # fmt: skip
    for _ in range(count):
        with pytest.raises(checker.Refused):
            checker.check(checker.load(json.dumps(forged(true[int(rng.integers(3))], rng))))


def test_changed_certificates_are_refused():
    forge(60, np.random.default_rng(3))


@pytest.mark.slow
def test_thousands_of_changed_certificates_are_refused():
    forge(5000, np.random.default_rng(4))


def test_the_command_designs_from_the_table_of_the_file(capsys):
    command = ["solve", "examples/guard.toml", "--target", "range", "--design", "--digits", "12", "--compare"]
    assert run(command) == 0
    shown = capsys.readouterr().out
    assert "needs t = 10, fix: cost 3" in shown and "least squares" in shown
    assert run([*command, "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["compare"]["solvers"]) == 5


@pytest.mark.parametrize("bound", ["10", "1e3", "1e6", "1e12"])
def test_the_best_selection_may_be_far_above_the_error_of_all_rows(bound):
    model = nav.Model(states="x v", F=[["0", "1"], ["0", "0"]], H=["x", "v"], sigma=["1", bound], targets={"q": "v"})
    found = nav.design(model, times=range(3), budget=1)
    assert Fraction(found.value.lower) <= Fraction(bound) <= Fraction(found.value.upper) and found.check()
    assert str(found.status) == "CERTIFIED" and found.points[0].measurement == "z2"


@pytest.mark.parametrize("span", ["1e-20", "1e-9", "1e12", "1e100"])
def test_times_of_any_scale_have_their_design(span):
    model = nav.Model(states="x v", F=[["0", "1"], ["0", "0"]], H=["x"], targets={"q": "v"})
    found = nav.design(model, times=[0, span], budget=2)
    assert Fraction(found.value.lower) <= 2 / Fraction(span) <= Fraction(found.value.upper) and found.check()


def test_a_design_that_stays_open_has_a_lower_bound_that_holds():
    """All three instants are needed, and the weights are the only ones: rounded numbers keep no bound by themselves."""
    F = [["0", "-1e-6", "0"], ["0", "0", "-1e-6"], ["0"] * 3]
    model = nav.Model("x y z", F, ["x + 2e8*y + z"], "3", targets={"g": "x + y - z"})
    found = nav.design(model, times=["0", "1", "2"], budget=3)
    assert Fraction(found.value.lower) <= 479999997600002375999988000003 <= Fraction(found.value.upper)
    assert found.check().accepted
