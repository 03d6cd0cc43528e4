"""The verb ``limits``: what positions can guarantee, against closed forms and trials of rules."""

from __future__ import annotations

import json

import numpy as np
import pytest

from navsym.cli.main import run
from navsym.language.expression import parse, symbol
from navsym.trajectory.limits import FORMULAS, least_error, rule


def limits(capsys, *options):
    status = run(["limits", *options, "--json"])
    out = capsys.readouterr().out
    return status, json.loads(out)


def test_the_least_error_of_a_velocity_is_twice_the_root_of_noise_and_acceleration(capsys):
    status, found = limits(capsys, "--noise", "5", "--acceleration", "0.2")
    (velocity,) = found["limits"]
    assert status == 0 and velocity["least_error"] == pytest.approx(2.0, rel=1e-15)
    assert velocity["rule"]["ages"] == pytest.approx([0, 10], rel=1e-15)
    assert velocity["rule"]["error"] == pytest.approx(2.0, rel=1e-14) and found["sampled"] is None


def test_a_bounded_jerk_limits_velocity_and_acceleration(capsys):
    _, found = limits(capsys, "--noise", "3", "--jerk", "0.1")
    assert [part["derivative"] for part in found["limits"]] == ["velocity", "acceleration"]
    for part in found["limits"]:
        assert part["rule"]["error"] == pytest.approx(part["least_error"], rel=1e-13)


@pytest.mark.parametrize("derivative, order", FORMULAS)
def test_the_closed_forms_are_the_values(derivative, order):
    values = {"noise": 3, "acceleration": 2, "jerk": 2}
    symbols = {name: symbol(name, positive=True) for name in values}
    formula = parse(FORMULAS[derivative, order], symbols)
    value = float(formula.subs({symbols[name]: number for name, number in values.items()}))
    assert value == pytest.approx(least_error(3, 2, derivative, order), rel=1e-14)


def test_no_pair_of_the_positions_at_hand_guarantees_more_than_the_one_that_is_named(capsys):
    _, found = limits(capsys, "--noise", "5", "--acceleration", "0.5", "--step", "0.7")
    (best,) = found["sampled"]["limits"]
    every = [rule(np.array([0, k * 0.7]), 5, 0.5).error for k in range(1, 200)]
    assert best["rule"]["error"] == pytest.approx(min(every), rel=1e-14)
    assert best["rule"]["error"] >= found["limits"][0]["least_error"]


def test_a_short_memory_is_used_to_its_end(capsys):
    _, found = limits(capsys, "--noise", "5", "--acceleration", "0.5", "--step", "0.1", "--memory", "2")
    (best,) = found["sampled"]["limits"]
    assert found["sampled"]["positions"] == 21 and best["rule"]["ages"] == pytest.approx([0, 2])


def test_the_claims_that_prove_a_limit_stand_in_the_ledger(capsys):
    for bounded in ("--acceleration", "--jerk"):
        _, found = limits(capsys, "--noise", "1", bounded, "1")
        for claim in (claim for part in found["limits"] for claim in part["claims"]):
            assert run(["show", claim, "--json"]) == 0
            assert json.loads(capsys.readouterr().out)["status"] == "PROVED"


def test_people_read_the_error_and_the_ages(capsys):
    assert run(["limits", "--noise", "5", "--acceleration", "0.5", "--step", "1"]) == 0
    out = capsys.readouterr().out
    assert "3.16228 m/s" in out and "0; 6.32456" in out and "3.16667 m/s" in out


@pytest.mark.parametrize(
    "options, kind",
    [
        (["--noise", "5"], "domain"),
        (["--noise", "5", "--jerk", "1", "--acceleration", "1"], "domain"),
        (["--noise", "nan", "--jerk", "1"], "domain"),
        (["--noise", "-1", "--jerk", "1"], "domain"),
        (["--noise", "1", "--jerk", "inf"], "domain"),
        (["--noise", "1e300", "--acceleration", "1e-300"], "domain"),
        (["--noise", "1", "--jerk", "1", "--step", "0"], "domain"),
        (["--noise", "1", "--jerk", "1", "--step", "1", "--memory", "nan"], "domain"),
        (["--noise", "1", "--jerk", "1", "--memory", "1"], "domain"),
        (["--noise", "1", "--jerk", "1", "--step", "1", "--memory", "1"], "domain"),
        (["--noise", "1", "--jerk", "1", "--step", "1e-9"], "too-large"),
        (["--noise", "five", "--jerk", "1"], "syntax"),
    ],
)
def test_what_has_no_answer_is_refused_in_one_line(capsys, options, kind):
    status, found = limits(capsys, *options)
    assert status == 2 and found["error"]["kind"] == kind
    assert "\n" not in found["error"]["message"]
