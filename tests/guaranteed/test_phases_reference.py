"""Regimes against linear programs on fine grids: values everywhere, and no boundary that does not exist."""

from __future__ import annotations

import random
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp
from flint import fmpq
from scipy.optimize import linprog

from navsym.core.exact import from_decimal
from navsym.guaranteed.phases import budget as limits
from navsym.guaranteed.phases.boundaries import unlocated_boundary
from navsym.guaranteed.phases.driver import bracket_boundary, find_phases
from navsym.guaranteed.phases.family import family_of
from navsym.models.modelfile import model_from
from tests.guaranteed.test_phases_limit import Clock

s, T = sp.Symbol("s"), sp.Symbol("T")
#: Points of the grid of a linear program; its optimum exceeds that of the interval by a part of the step squared.
POINTS, SLACK = 801, 1e-4

OSCILLATOR = {
    "model": {
        "name": "driven oscillator",
        "states": ["x0", "x1", "x2"],
        "F": [["0", "1", "0"], ["-1", "0", "1"], ["0", "0", "0"]],
    },
    "measurement": [{"name": "z", "h": ["1", "0", "0"], "sigma": "1"}],
    "interval": {"T": "T"},
    "parameters": {"T": ["0", "10"]},
    "targets": {"c": ["0", "0", "1"]},
}
RAMP = {
    "model": {"name": "ramp", "states": ["x", "v"], "F": [["0", "1"], ["0", "0"]]},
    "measurement": [
        {"name": "position", "h": ["1", "0"], "sigma": "1"},
        {"name": "velocity", "h": ["0", "1"], "sigma": "1/2"},
    ],
    "interval": {"T": "T"},
    "parameters": {"T": ["0", "10"]},
    "targets": {"c": ["1", "2"]},
}


def basis(H, target, sigma):
    return {
        "basis": {"variable": "s", "H": H, "interval": ["0", "T"], "sigma": sigma},
        "parameters": {"T": ["0", "20"]},
        "targets": {"c": target},
    }


def least_cost(rows, functional, sigma, length):
    """Least ``sum sigma |w|`` with ``sum w H = P`` on a grid of [0, length], from the definition."""
    grid = np.linspace(0.0, length, POINTS)
    columns = np.hstack([[np.broadcast_to(sp.lambdify(s, sp.sympify(h))(grid), POINTS) for h in row] for row in rows])
    cost = np.repeat([float(sp.Rational(b)) for b in sigma], POINTS)
    target = [float(sp.Rational(p)) for p in functional]
    answer = linprog(np.r_[cost, cost], A_eq=np.hstack([columns, -columns]), b_eq=target, method="highs")
    assert answer.success
    return answer.fun


#: Documents, the same regressors by the time s before the end or in the basis, bounds, target, range, boundaries.
CASES = {
    "a flat dual of a driven oscillator": (
        OSCILLATOR, [["cos(s)", "-sin(s)", "1-cos(s)"]], ["1"], ["0", "0", "1"], ("1/2", "8"), ["pi"],
    ),
    "velocities anywhere are as good": (
        RAMP, [["1", "-s"], ["0", "1"]], ["1", "1/2"], ["1", "2"], ("1/10", "10"), ["4"],
    ),
    "a flat dual of the second measurement": (
        basis([["1", "s"], ["s", "1"]], ["1", "2"], ["1", "1"]),
        [["1", "s"], ["s", "1"]], ["1", "1"], ["1", "2"], ("1/10", "10"), ["1/2", "1", "2"],
    ),
    "a constant and a cosine": (
        basis(["cos(s)", "1"], ["1", "-2"], ["1"]), [["cos(s)", "1"]], ["1"], ["1", "-2"], ("1/2", "6"), ["2*pi/3"],
    ),
    "one estimator for all lengths": (
        basis([["1", "s**2"], ["1", "cos(s)"]], ["2", "1"], ["1/2", "1/2"]),
        [["1", "s**2"], ["1", "cos(s)"]], ["1/2", "1/2"], ["2", "1"], ("1/10", "3"), [],
    ),
}  # fmt: skip


#: The first and the last but one take several times as long as all the others together.
IN_EVERY_RUN = [
    pytest.param(case, marks=[pytest.mark.long] if "cosine" in case or "driven" in case else []) for case in CASES
]


@pytest.mark.long
@pytest.mark.parametrize("case", IN_EVERY_RUN)
def test_where_many_estimators_are_optimal_boundaries_are_those_of_the_value_and_no_others(case):
    document, rows, sigma, target, ends, boundaries = CASES[case]
    answer = find_phases(family_of(model_from(document), "c", "T"), *map(sp.sympify, ends))
    assert [b["at"] for b in answer.document()["boundaries"]] == boundaries
    assert answer.uncovered == () and {str(r.status) for r in answer.regimes} == {"PROVED"}
    for before, after in zip(answer.regimes, answer.regimes[1:], strict=False):
        assert before.upper == after.lower and before.dual != after.dual
    rng = random.Random(case)
    for _ in range(12):
        length = rng.uniform(*(float(sp.Rational(end)) for end in ends))
        (regime,) = (r for r in answer.regimes if r.lower < length < r.upper)
        value = float(regime.value.subs(answer.family.parameter, length))
        assert value * (1 - 1e-9) <= least_cost(rows, target, sigma, length) <= value * (1 + SLACK)


def number(text):
    return sp.sympify(text, rational=True)


@pytest.mark.parametrize("seconds", [7.0, 11.0])
def test_what_is_uncovered_lies_in_no_regime_that_is_certified(monkeypatch, seconds):
    monkeypatch.setattr(limits, "processor_seconds", Clock(0.06))
    document = basis(["1", "s", "exp(-s)"], ["0", "0", "1"], ["1"])
    answer = find_phases(family_of(model_from(document), "c", "T"), sp.Rational(1, 2), sp.Integer(3), seconds=seconds)
    assert answer.uncovered and any(regime.unique for regime in answer.regimes)
    holes = [tuple(map(number, pair)) for pair in answer.document()["uncovered"]]
    for row in answer.document()["regimes"]:
        a, b = number(row["from"]), number(row["to"])
        assert row["status"] == "OPEN" or all(b - p < 1e-30 or q - a < 1e-30 for p, q in holes)
        if row["unique"]:
            start, end = map(sp.Rational, row["unique_between"])
            assert a - start < 1e-30 and end - b < 1e-30


def test_a_boundary_that_is_not_proved_has_a_width():
    before, after = SimpleNamespace(held=(fmpq(1), fmpq(5, 2))), SimpleNamespace(held=(fmpq(5, 2), fmpq(4)))
    found = bracket_boundary(unlocated_boundary(sp.Rational(5, 2)), before, after)
    assert from_decimal(found.lower) < fmpq(5, 2) < from_decimal(found.upper)
