"""The guaranteed estimator: errors, degenerate unknowns, worst noise, and what other estimators reach."""

from __future__ import annotations

import json

import numpy as np
import pytest
import sympy as sp

from navsym import checker
from navsym.core.errors import DomainError, NavsymError, NotEstimableError, NotFiniteError, ShapeError
from navsym.guaranteed.problem import from_contents, from_regressors
from navsym.guaranteed.solver import solve
from navsym.models.modelfile import model_from

t = sp.Symbol("t", real=True)
VELOCITY = {
    "model": {
        "name": "velocity",
        "states": ["y1", "y2", "y3"],
        "F": [["0", "-1", "0"], ["0", "0", "1"], ["0", "-1", "0"]],
    },
    "parameters": {"T": ["0", "2*pi"]},
    "measurement": [{"name": "velocity", "h": ["1", "0", "0"], "sigma": "1"}],
    "interval": {"T": "T"},
}


def velocity(state, T="pi/2"):
    return from_contents(model_from(VELOCITY, "", {"T": T}), state)


def line(functional=(0, 1), sigma=(1,), interval=(0, 1)):
    return from_regressors([[1, t]] * len(sigma), functional, t, interval, sigma)


def test_the_velocity_problem_has_the_printed_error_at_a_quarter_period():
    solution = solve(velocity("y3"), digits=40)
    value = 2 + 2 * sp.sqrt(2)
    assert sp.Rational(solution.lower) < sp.Rational(str(value.evalf(60))) < sp.Rational(solution.upper)
    assert [point.at.lower[:6] for point in solution.support] == ["0", "0.7853", "1.5707"]
    assert solution.unique is True and solution.status == "CERTIFIED"


def test_the_document_has_the_keys_of_the_interface_and_a_certificate_that_checks():
    document = solve(velocity("y2"), digits=20).document()
    assert list(document) == ["target", "status", "value", "support", "dual", "unique", "certificate"]
    assert checker.check(checker.load(json.dumps(document["certificate"]))) == "touch"


def test_pieces_of_F_that_are_equal_give_the_solution_of_one_piece():
    pieces = dict(VELOCITY) | {"model": {"name": "p", "states": ["y1", "y2", "y3"]}}
    F = VELOCITY["model"]["F"]
    pieces["piece"] = [{"from": "0", "to": "1/2", "F": F}, {"from": "1/2", "to": "T", "F": F}]
    split = solve(from_contents(model_from(pieces, "", {"T": "3/2"}), "y3"), digits=15)
    whole = solve(velocity("y3", "3/2"), digits=15)
    assert float(split.lower) == pytest.approx(float(whole.lower), rel=1e-13)


def test_an_unknown_that_no_measurement_shows_is_named_by_a_null_direction():
    with pytest.raises(NotEstimableError, match=r"\[0, -2, 1\]"):
        solve(from_regressors([[1, t, 2 * t]], [0, 1, 1], t, (0, 1)))


def test_a_functional_of_dependent_unknowns_is_estimated_when_it_may_be():
    solution = solve(from_regressors([[1, t, 2 * t]], [0, 1, 2], t, (0, 1)), digits=20)
    assert float(solution.lower) == pytest.approx(2.0, rel=1e-15)
    with pytest.raises(NotEstimableError):
        solve(from_regressors([[0, t]], [1, 1], t, (0, 1)))


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: line(interval=(0, 0)), DomainError, "positive length"),
        (lambda: line(interval=(0, -1)), DomainError, "positive length"),
        (lambda: line(sigma=(0,)), DomainError, "positive noise"),
        (lambda: line(sigma=(-1,)), DomainError, "positive noise"),
        (lambda: line(functional=(0, sp.nan)), NotFiniteError, "finite"),
        (lambda: line(functional=(0, 0)), DomainError, "not zero"),
        (lambda: line(functional=(0, 0.5)), DomainError, "exact"),
        (lambda: line(functional=(1, 2, 3)), ShapeError, "rows of 3"),
        (lambda: line(functional=(0, sp.Symbol("a"))), DomainError, "--set a"),
        (lambda: solve(line(), digits=0), NavsymError, "digits"),
    ],
)
def test_bad_input_says_what_was_expected(make, error, words):
    with pytest.raises(error, match=words):
        make()


def test_several_measurements_share_the_work_by_their_noise():
    rows = [[1, t], [0, 1]]
    both = solve(from_regressors(rows, [1, 1], t, (0, 1), sigma=(1, 1)), digits=20)
    first = solve(from_regressors(rows[:1], [1, 1], t, (0, 1)), digits=20)
    assert float(both.upper) <= float(first.upper) * (1 + 1e-15)


def signed_bounds(estimator):
    """``sigma sgn(weight)`` on the support: times one standard normal number, the noise that reaches the deviation."""
    problem = estimator.problem
    bounds = [float(problem.sigma[problem.measurements.index(point.measurement)]) for point in estimator.support]
    return np.copysign(bounds, [float(weight) for weight in estimator.weights])


def search_correlations(loads, tries, seed):
    """The largest deviation that random correlations U U^T, rows of unit length, produce; the best is shaken."""
    random = np.random.default_rng(seed)
    best, best_U = 0.0, random.standard_normal((loads.size, loads.size))
    for k in range(tries):
        fresh = random.standard_normal(best_U.shape)
        U = fresh if k % 3 == 0 else best_U + 0.3 * fresh
        U = U / np.linalg.norm(U, axis=1, keepdims=True)
        deviation = float(np.linalg.norm(loads @ U))
        best, best_U = (deviation, U) if deviation > best else (best, best_U)
    return best


def test_the_worst_noise_reaches_the_guaranteed_deviation():
    solution = solve(velocity("y3"), digits=15)
    noise = np.random.default_rng(1).standard_normal(200_000)[:, None] * signed_bounds(solution)
    errors = noise @ np.array([float(weight) for weight in solution.weights])
    assert np.std(errors) == pytest.approx(float(solution.value), rel=0.01)
    assert sum(abs(float(weight)) for weight in solution.weights) == pytest.approx(float(solution.value), rel=1e-12)


def test_no_correlation_that_a_search_tries_exceeds_the_guaranteed_deviation():
    solution = solve(velocity("y2"), digits=15)
    loads = np.array([float(weight) for weight in solution.weights]) * np.abs(signed_bounds(solution))
    found = search_correlations(loads, 3000, seed=2)
    value = float(solution.value)
    assert 0.9 * value < found <= value * (1 + 1e-12)


def test_least_squares_and_the_white_noise_filter_are_worse_under_their_own_worst_correlation():
    solution = solve(velocity("y3"), digits=15)
    beside = solution.compare(solvers=("casadi:highs",))
    assert beside.least_squares > 1.3 * float(solution.value)
    assert beside.kalman_white_noise == pytest.approx(beside.least_squares, rel=1e-9)
    assert abs(beside.solvers[0].relative_error) < 1e-6


def test_the_constant_is_best_estimated_by_least_squares_with_error_one():
    """For one constant unknown every nonnegative weighting is optimal: least squares loses nothing."""
    solution = solve(from_regressors([[1]], [1], t, (0, 1)), digits=15)
    assert solution.compare(solvers=()).least_squares == pytest.approx(1.0, rel=1e-12)


R, e, sin, cos = sp.Rational, sp.exp, sp.sin, sp.cos
HARD = {
    "the functional is a value of the regressors inside": ([1, t, t + t**3 / 10**6], sp.pi, R(1, 3)),
    "the functional is a value of the regressors at the end": (
        [e(-t / 2) * cos(2 * t), t * sin(3 * t), t * sin(6 * t), cos(t / 4) - 1, cos(t), t * e(-t / 4)],
        R(9, 10),
        R(9, 10),
    ),
    "several estimators are optimal and the first contacts lead astray": (
        [
            t * e(t / 4),
            sin(4 * t),
            t * sin(11 * t / 2),
            cos(11 * t / 2),
            e(-3 * t / 2) * cos(9 * t / 2),
            sin(3 * t / 4),
        ],
        R(32, 5),
        [0, 0, 0, 1, 0, 0],
    ),
    "the dual is unique, its other contacts carry no weight": ([cos(6 * t / 5), t**4, e(t / 8)], R(27, 5), 0),
    "contacts without weight lie where no grid point is": ([sin(t / 5), cos(7 * t / 4) - 1, cos(t)], 7, 0),
    "the same with a dual of no round numbers": (
        [
            cos(6 * t / 5) + sp.sqrt(2) * t**4 / 100,
            sp.pi * cos(6 * t / 5) / 7 + t**4 / 50,
            sp.sqrt(3) * t**4 / 200 + e(t / 8),
        ],
        R(27, 5),
        0,
    ),
    "regressors vanish together at the start": ([t * sin(5 * t), t**5, cos(t) - 1], R(83, 10), R(83, 20)),
}


@pytest.mark.parametrize("case", HARD)
def test_degenerate_problems_have_their_certificate(case):
    functions, end, wanted = HARD[case]
    functional = wanted if isinstance(wanted, list) else [sp.sympify(h).subs(t, wanted) for h in functions]
    found = solve(from_regressors([functions], functional, t, (0, end), (1,)), digits=20)
    assert found.status == "CERTIFIED" and found.width <= 1e-20
    checker.check(checker.load(json.dumps(found.document()["certificate"])))
