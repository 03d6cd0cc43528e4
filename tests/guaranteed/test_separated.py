"""Stiff models: regressors that share a huge part are separated exactly, and the optimum is certified."""

from __future__ import annotations

import json

import numpy as np
import pytest
import sympy as sp
from flint import fmpq
from scipy.optimize import linprog

from navsym import checker
from navsym.claims import PROVED, Equation
from navsym.guaranteed.problem import from_contents, from_regressors
from navsym.guaranteed.separation import separate_regressors
from navsym.guaranteed.solver import solve
from navsym.models.modelfile import model_from
from navsym.prove.ladder import decide

t = sp.Symbol("t", real=True)
TWO = [["-1000", "1"], ["0", "-1"]]
THREE = [["-1000", "0", "1"], ["0", "-1", "0"], ["0", "0", "0"]]


def stiff(F, h, target, T="1"):
    document = {
        "model": {"states": [f"x{k}" for k in range(len(h))], "F": F},
        "measurement": [{"name": "z", "h": h, "sigma": "1"}],
        "interval": {"T": T},
        "targets": {"c": target},
    }
    return from_contents(model_from(document))


def by_grid(functions, right, end):
    """The optimum for functions without their huge factors, on a grid that is fine next to 0."""
    places = np.r_[0.0, np.geomspace(1e-6, end, 6000)]
    H = np.array([f(places) for f in functions])
    return linprog(np.ones(2 * H.shape[1]), A_eq=np.hstack([H, -H]), b_eq=right).fun


def checked(solution):
    return checker.check(checker.load(json.dumps(dict(solution.certificate))))


@pytest.mark.parametrize(("target", "times"), [(["1", "0"], 1), pytest.param(["0", "1"], 999, marks=pytest.mark.long)])
def test_rates_of_1000_and_1_are_certified(target, times):
    """H = (E, (g - E)/999) with E = exp(1000 (1 - t)) and g = exp(1 - t): sum w g is 1, or 999, sum w E nothing."""
    solution = solve(stiff(TWO, ["1", "0"], target), digits=30)
    assert solution.status == "CERTIFIED" and solution.width < 1e-30 and checked(solution) == "touch"
    grid = by_grid([lambda s: np.exp(-1000 * s), lambda s: np.exp(1 - s)], [0, 1], 1)
    assert float(solution.value) == pytest.approx(times * grid, rel=1e-5)


@pytest.mark.parametrize(
    ("target", "right"), [(["1", "0", "0"], [0, 0, 1]), (["0", "1", "0"], [0, 1, 0]), (["0", "0", "1"], [0, 0, 1000])]
)
def test_rates_of_1000_1_and_0_over_two_units_are_certified(target, right):
    """H = (E, g, (1 - E)/1000): sum w E is nothing beside what a double holds."""
    solution = solve(stiff(THREE, ["1", "1", "0"], target, "2"), digits=30)
    assert solution.status == "CERTIFIED" and solution.width < 1e-30 and checked(solution) == "touch"
    grid = by_grid([lambda s: np.exp(-1000 * s), lambda s: np.exp(2 - s), np.ones_like], right, 2)
    assert float(solution.value) == pytest.approx(grid, rel=1e-5)


def test_the_separated_problem_is_the_same_one_in_other_unknowns():
    exact = stiff(TWO, ["1", "0"], ["0", "1"]).exact()
    other = separate_regressors(exact)
    M = other.matrix
    rational = lambda x: sp.Rational(int(fmpq(x).p), int(fmpq(x).q))  # noqa: E731
    for i in range(2):
        mixed = sum((rational(M[i, j]) * exact.panels[0].functions[j] for j in range(2)), sp.S.Zero)
        assert decide(Equation(mixed, other.problem.panels[0].functions[i])).status is PROVED
        assert other.problem.functional[i] == sum(rational(M[i, j]) * exact.functional[j] for j in range(2))
    assert M.det() != 0


def test_coefficients_that_are_not_rational_are_left_as_they_are():
    exact = from_regressors([[1, sp.sqrt(2) * t]], [0, 1], t, (0, 1)).exact()
    assert separate_regressors(exact) is None
