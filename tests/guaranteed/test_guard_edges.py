"""nav.Guard at its edges: numbers without doubles, saved states, contradictions before the state is determined."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

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


def test_what_is_no_contradiction_before_the_state_is_determined_is_taken():
    guard = nav.Guard(nav.Model(**MOVING, H=["x", "x", "v"], sigma=["1", "1", "1"]))
    for k, z in enumerate([0, 100]):
        assert abs(guard.step([z, z + 2, None], t=k).value - (z + 1)) <= 1.0  # the one state is z + 1
