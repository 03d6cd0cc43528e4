"""nav.Guard at its edges: numbers without doubles, saved states, contradictions before the state is determined."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from scipy.optimize import linprog

import navsym as nav
from navsym.core.errors import InconsistentError
from navsym.guaranteed.streaming import guard as guard_module

GAP = Fraction(1, 10**12)
SIMPLE = nav.Model(states="b", F=[["0"]], H=["b"], sigma="1/2")
MOVING = {"states": "x v", "F": [["0", "1"], ["0", "0"]], "targets": {"q": "x"}}


@pytest.mark.parametrize("bad", [{"z": "1e400"}, {"z": 10**4000}, {"t": "1e400"}, {"t": "1e30"}, {"sigma": "1e-310"}])
def test_numbers_beyond_doubles_and_times_without_digits_are_refused_and_leave_no_trace(bad):
    guard, twin = nav.Guard(SIMPLE), nav.Guard(SIMPLE)
    assert guard.step(3, t=0) == twin.step(3, t=0)
    with pytest.raises(nav.NavsymError):
        guard.step(**{"z": 3, "t": 1} | bad)
    assert guard.save() == twin.save() and guard.step(3, t=2) == twin.step(3, t=2)


def test_an_interruption_leaves_no_trace(monkeypatch):
    guard, twin = nav.Guard(SIMPLE), nav.Guard(SIMPLE)
    assert guard.step(3, t=0) == twin.step(3, t=0)

    def interrupt(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(guard_module, "bounds_of", interrupt)
        guard.step(3, t=1)
    assert guard.save() == twin.save()


@pytest.mark.parametrize("times", [["0", "1", "1e6", "1e15", "1e21"], ["-1e21", "0", "1e-20"]])
def test_turns_are_known_to_all_digits_at_the_latest_times(times):
    guard = nav.Guard(nav.Model(states="x v", F=[["0", "1"], ["-1", "0"]], H=["x"], sigma="1", targets={"v": "v"}), "v")
    radius = [guard.step(0, t=t) for t in times][-1].radius
    assert 0 <= Fraction(radius.upper) - Fraction(radius.lower) <= GAP * Fraction(radius.upper)


@pytest.mark.parametrize("given", [np.array(2.5), np.array([2.5]), [2.5], 2.5, {"z1": 2.5}])
def test_values_and_bounds_are_given_in_the_same_ways(given):
    guard, twin = nav.Guard(SIMPLE), nav.Guard(SIMPLE)
    assert guard.step(given, t=0, sigma=given) == twin.step("5/2", t=0, sigma={"z1": "5/2"})
    with pytest.raises(nav.NavsymError) as refused:
        guard.step(given, t=1, sigma={"q": 1})
    assert refused.value.where == "Guard.step: sigma"


def test_a_guard_whose_support_has_left_the_memory_is_saved_and_goes_on():
    guard = nav.Guard(SIMPLE, memory=1)
    for k, z in enumerate([3, None]):
        guard.step(z, t=k)
    again = nav.Guard.load(guard.save())
    assert again.save() == guard.save() and again.step(2, t=2) == guard.step(2, t=2)


def test_two_equal_sensors_beside_a_gross_error_are_as_good_as_one():
    one = nav.Guard(nav.Model(**MOVING, H=["x"], sigma="1"), "q", outliers=1)
    two = nav.Guard(nav.Model(**MOVING, H=["x", "x"], sigma=["1", "1"]), "q", outliers=1)
    for k in range(5):
        a, b = one.step(0, t=k), two.step([0, 0], t=k)
        assert (a.value, a.radius) == (b.value, b.radius)
    wrong = nav.Guard(nav.Model(**MOVING, H=["x", "x"], sigma=["1", "1"]), "q", outliers=1)
    with pytest.raises(InconsistentError):
        for k, z in enumerate([0, 10, 0, 10, 0]):
            wrong.step([z, z], t=k)


def test_a_radius_of_zero_is_not_enclosed_from_above():
    """One state explains the data but for one epoch, so that nothing lies strictly inside."""
    model = nav.Model(**MOVING | {"targets": {"q": "x + v"}}, H=[["2", "-1"], ["2", "0"]], sigma=["1", "1"])
    guard = nav.Guard(model, "q", memory=3, outliers=1)
    guard.step({"z2": "-19/2"}, t="1/2")
    guard.step({"z1": -11, "z2": "-59/2"}, t="3/2")
    last = guard.step({"z1": -19, "z2": "-39/2"}, t="5/2")
    assert last.value == -12.75 and float(last.radius.lower) <= 0 <= float(last.radius.upper) < 1e-50


@pytest.mark.parametrize(
    ("H", "target", "epochs"),
    [
        (["x", "x"], "x", [[0, 10]]),  # two sensors of one thing
        (["x", "x"], "v", [[0, 10]]),  # beside a target that is not shown yet
        (["x", "v"], "x", [[None, 0], [None, 10]]),  # a velocity that does not move, without a position
        ([["1", "0"], ["0", "0"]], "x", [[0, 5]]),  # what shows nothing but its noise
        (["x", "x", "v"], "x", [[None, None, 0], [0, 2.5, None]]),
    ],
)
def test_contradictions_are_noticed_before_the_state_is_determined(H, target, epochs):
    def build():
        return nav.Guard(nav.Model(**MOVING | {"targets": {"q": target}}, H=H, sigma=["1"] * len(H)))

    guard, twin = build(), build()
    for k, z in enumerate(epochs[:-1]):
        assert guard.step(z, t=k) == twin.step(z, t=k)
    with pytest.raises(InconsistentError):
        guard.step(epochs[-1], t=len(epochs) - 1)
    assert guard.save() == twin.save()
    for k in range(len(epochs), len(epochs) + 3):  # it goes on with what is right
        assert guard.step([0] * len(H), t=k) == twin.step([0] * len(H), t=k)


def test_data_that_leave_no_room_inside_have_a_radius_from_both_sides():
    """Two readings of b are two bounds apart: b is 1 in every explanation, and c from -1 to 1."""
    model = nav.Model("b c", [["0", "0"], ["0", "0"]], ["b", "b", "c"], targets={"sum": "b + c"})
    guard = nav.Guard(model, outliers=1)
    last = [guard.step([0, 2, 0], t=k) for k in range(3)][-1]
    assert last.value == 1.0 and 1 - Fraction(1, 10**20) < Fraction(last.radius.lower) <= 1


def test_a_contradiction_by_a_part_of_1e26_is_excluded_with_a_certificate():
    guard = nav.Guard(nav.Model("b", [["0"]], ["2*b", "-1000000*b"]), outliers=1)
    guard.step([None, 2000000], t=0)
    last = guard.step([-3, "2000001.00000000000000000001"], t=1)
    assert last.excluded == (1.0,) and last.check().accepted


def test_a_contradiction_that_doubles_do_not_see_is_noticed_also_after_a_restart():
    """The readings differ by three bounds and are 4e16 of them."""
    guard = nav.Guard(nav.Model("b c", [["0", "0"], ["0", "0"]], ["b", "c"], targets={"b": "b"}))
    guard.step([44709930429851095, 0], t=0)
    for one in (guard, nav.Guard.load(guard.save())):
        one.step([44709930429851096, 0], t=1)
        with pytest.raises(InconsistentError):
            one.step([44709930429851098, None], t=2)


def test_what_is_no_contradiction_before_the_state_is_determined_is_taken():
    guard = nav.Guard(nav.Model(**MOVING, H=["x", "x", "v"], sigma=["1", "1", "1"]))
    for k, z in enumerate([0, 100]):
        assert abs(guard.step([z, z + 2, None], t=k).value - (z + 1)) <= 1.0  # the one state is z + 1


@pytest.mark.parametrize(
    ("readings", "outliers", "explained"),
    [
        ([0, 10], 1, True),
        ([0, 10, 20], 1, False),
        ([0, 10, 10], 1, True),
        ([0, 10, 20], 2, True),
        ([0, 9, 20, 30], 2, False),
    ],
)
def test_gross_errors_that_are_too_many_are_noticed_before_the_state_is_determined(readings, outliers, explained):
    guard = nav.Guard(nav.Model(**MOVING, H=["v", "x"], sigma=["1", "1"]), outliers=outliers)
    *before, last = [{"z1": z} for z in readings]
    for k, z in enumerate(before):
        assert guard.step(z, t=k).value is None
    if explained:
        assert guard.step(last, t=len(before)).value is None
    else:
        with pytest.raises(InconsistentError, match=f"but {outliers}"):
            guard.step(last, t=len(before))


def test_a_constant_beside_a_turn_contradicts_itself_before_the_state_is_determined():
    F = [["0", "1", "0"], ["-1", "0", "0"], ["0", "0", "0"]]
    guard = nav.Guard(nav.Model(states="x v u", F=F, H=["x", "u"], targets={"q": "v"}))
    guard.step([None, 0], t=0)
    with pytest.raises(InconsistentError, match="t = 0, 1"):
        guard.step([None, 10], t=1)


def radius_alone(model, times, at):
    """The radius from some epochs, by a guard that has seen no other."""
    guard = nav.Guard(model)
    for t in times:
        estimate = guard.step(0, t=t)
    assert estimate.t == at
    return Fraction(estimate.radius.lower), Fraction(estimate.radius.upper)


@pytest.mark.parametrize("memory", [None, 1, 2])
def test_a_gap_of_a_growing_system_stops_no_guard(memory):
    guard = nav.Guard(nav.Model(states="x", F=[["1"]], H=["x"]), memory=memory)
    for t in (0, 1, 800, 1600, 10**6, 10**20):
        estimate = guard.step(0, t=t)
        assert Fraction(estimate.radius.lower) <= 1 <= Fraction(estimate.radius.upper) and estimate.since is None
        assert guard.interval() is not None and nav.Guard.load(guard.save()).save() == guard.save()


def test_where_both_sides_of_a_gap_do_not_fit_doubles_the_horizon_begins_anew_and_says_so():
    model = nav.Model(states="x y", F=[["1", "0"], ["0", "-1"]], H=["x + y"], targets={"q": "y"})
    guard = nav.Guard(model)
    for t in (0, 1, 2, 1000, 1001, 1003):
        estimate = guard.step(0, t=t)
        assert estimate.since == (None if t < 1000 else 1000.0)
        assert (estimate.value is None) == (t in (0, 1000))
    low, high = radius_alone(model, (0, 1, 3), 3)
    assert low <= Fraction(estimate.radius.upper) and Fraction(estimate.radius.lower) <= high
    assert estimate.check() and estimate.document()["since"] == 1000.0 and "since 1000" in repr(estimate)
    loaded = nav.Guard.load(guard.save())
    assert loaded.step(0, t=1004) == guard.step(0, t=1004)


def test_radii_too_small_for_digits_are_enclosed_from_zero_and_targets_beyond_doubles_are_refused():
    falling, growing = (nav.Guard(nav.Model(states="x", F=[[f]], H=["x"])) for f in ("-1", "1"))
    falling.step(0, t=0), growing.step(3, t=0)
    assert falling.step(0, t=10**20).radius == nav.Number("0", "1e-1000")
    with pytest.raises(nav.NavsymError, match="range of doubles"):
        growing.step(None, t=800)
    assert growing.step(None, t=1).radius is not None


def range_over_sets(epochs, slope, target):
    """Ends of the target over states that keep all epochs but one at most, by HiGHS; None where it is unbounded.

    Also the epochs that every explanation leaves out. An epoch is a dict of rows (0: x, 1: y) and readings of bound 1.
    """
    now, low, high, sets = len(epochs) - 1, np.inf, -np.inf, []
    for out in (None, *range(len(epochs))):
        A, b = [[0.0, 0.0]], [0.0]
        for t, epoch in enumerate(epochs):
            for j, z in epoch.items() if t != out else ():
                row = [1.0, slope * (t - now)] if j == 0 else [0.0, 1.0]
                A += [row, [-e for e in row]]
                b += [1.0 + z, 1.0 - z]
        ends = [linprog(np.multiply(s, target), A, b, bounds=(None, None), method="highs") for s in (1, -1)]
        if any(e.status == 2 for e in ends) or linprog([0, 0], A, b, bounds=(None, None)).status == 2:
            continue
        sets.append(frozenset() if out is None else frozenset({out}))
        low, high = (min(low, ends[0].fun), max(high, -ends[1].fun)) if ends[0].status == 0 else (-np.inf, np.inf)
        if not np.isfinite(low):
            return None, frozenset()
    return (low, high) if sets else (), frozenset.intersection(*sets) if sets else None


@pytest.mark.parametrize("seed", range(60))
def test_a_target_that_is_seen_beside_an_unseen_state_has_the_range_of_all_sets_of_gross_errors(seed):
    rng = np.random.default_rng(seed)
    slope, target = int(rng.integers(2)), [[1, 0], [0, 1], [1, 1]][int(rng.integers(3))]
    F = [["0", str(slope)], ["0", "0"]]
    guard = nav.Guard(nav.Model(states="x y", F=F, H=["x", "y"], targets={"q": [str(e) for e in target]}), outliers=1)
    epochs = []
    for t in range(4):
        epochs.append({j: int(rng.choice([0, 1, 1, 2, 7])) for j in (0, 1) if rng.random() < 0.6})
        known, excluded = range_over_sets(epochs, slope, target)
        given = {f"z{j + 1}": z for j, z in epochs[-1].items()}
        if known == ():
            with pytest.raises(InconsistentError):
                guard.step(given, t=t)
            return
        estimate = guard.step(given, t=t)
        assert (estimate.value is None) == (known is None)
        if known is not None:
            low, high = known
            assert estimate.value == pytest.approx((low + high) / 2, abs=1e-9)
            assert float(estimate.radius.upper) == pytest.approx((high - low) / 2, abs=1e-9)
            assert set(estimate.excluded) == set(map(float, excluded))
            assert (estimate.certificate is not None) == bool(excluded) and (not excluded or estimate.check().accepted)


def test_a_state_with_measurements_that_contradict_each_other_gives_no_estimate():
    guard = nav.Guard(nav.Model(**MOVING, H=["x", "v"], sigma=["1", "1/2"]), memory=4)
    for t, z in enumerate([(0, 0), (1, None), (None, None), (2, 0), (3, 1)]):
        guard.step(list(z), t=t)
    document = guard.save()
    document["rows"][-1][1] = "1000"
    with pytest.raises(InconsistentError):
        nav.Guard.load(document).step([3, None], t=5)
