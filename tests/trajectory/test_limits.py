"""What positions can guarantee: closed forms against linear programming, exhaustive search and a hostile signal."""

from itertools import combinations

import numpy as np
import pytest
import sympy as sp
from scipy.optimize import linprog

from navsym.core.errors import DomainError
from navsym.trajectory.limits import best_ages, best_rule, least_error, rule
from navsym_papers.trajectory import limits

QUESTIONS = ((1, 2), (1, 3), (2, 3))


def steered(order: int, steps: int, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Positions at all instants, and the state now, as linear functions of the first state and the steering."""
    F = np.array(
        [
            [step ** (j - i) / np.prod(np.arange(1, j - i + 1)) if j >= i else 0.0 for j in range(order)]
            for i in range(order)
        ]
    )
    G = np.array([step ** (order - i) / np.prod(np.arange(1, order - i + 1)) for i in range(order)])
    state = np.hstack([np.eye(order), np.zeros((order, steps))])
    rows = [state[0]]
    for k in range(steps):
        state = F @ state
        state[:, order + k] += G
        rows.append(state[0])
    return np.array(rows), state


@pytest.mark.parametrize(("derivative", "order"), QUESTIONS)
def test_the_least_error_is_that_of_the_worst_motion_found_by_linear_programming(derivative: int, order: int) -> None:
    noise, bound, steps = 1.3, 0.4, 240
    span = 2.5 * best_ages(noise, bound, order)[-1]
    positions, now = steered(order, steps, span / steps)
    free = [(None, None)] * order + [(-bound, bound)] * steps
    both = np.vstack([positions, -positions])
    worst = linprog(-now[derivative], A_ub=both, b_ub=np.full(len(both), noise), bounds=free)
    assert worst.status == 0
    assert -worst.fun == pytest.approx(least_error(noise, bound, derivative, order), rel=0.01)


@pytest.mark.parametrize(("derivative", "order"), QUESTIONS)
def test_the_rule_with_the_best_ages_reaches_the_least_error(derivative: int, order: int) -> None:
    found = rule(best_ages(0.7, 3.0, order), 0.7, 3.0, derivative)
    assert found.error == pytest.approx(least_error(0.7, 3.0, derivative, order), rel=1e-13)


@pytest.mark.parametrize("question", limits.QUESTIONS, ids=lambda q: q.name)
def test_the_function_and_the_claims_say_the_same(question: limits.Question) -> None:
    noise, bound = 0.3, 1.9
    exact = question.best.subs({limits.sigma: sp.Rational("0.3"), limits.M: sp.Rational("1.9")})
    assert least_error(noise, bound, question.derivative, question.order) == pytest.approx(float(exact), rel=1e-14)
    window = float(sp.solve(limits.bound(question.order) - sp.Rational("1.9"), limits.T)[0].subs(limits.sigma, "3/10"))
    ages = best_ages(noise, bound, question.order)
    claimed = [float(age.subs(limits.T, window)) for age in limits.ages(question.order)]
    np.testing.assert_allclose(ages, claimed, rtol=1e-13)
    weights = [float(w.subs(limits.T, window)) for w in limits.weights(question)]
    np.testing.assert_allclose(rule(ages, noise, bound, question.derivative).weights, weights, rtol=1e-12)


@pytest.mark.parametrize(("derivative", "order"), QUESTIONS)
def test_the_best_rule_of_irregular_samples_is_the_best_of_all_combinations(derivative: int, order: int) -> None:
    rng = np.random.default_rng(order + derivative)
    for _ in range(20):
        ages = np.concatenate([[0.0], np.cumsum(rng.exponential(0.6, size=18))])
        noise, bound = rng.uniform(0.1, 2.0), rng.uniform(0.05, 1.0)
        choices = combinations(range(1, 19), order - 1)
        least = min(rule(ages[[0, *rest]], noise, bound, derivative).error for rest in choices)
        found = best_rule(ages, noise, bound, derivative, order)
        assert least_error(noise, bound, derivative, order) <= found.error * (1 + 1e-12)
        assert found.error == pytest.approx(least, rel=1e-12)


@pytest.mark.parametrize(("derivative", "order"), QUESTIONS)
def test_random_motions_and_hostile_noise_stay_within_the_guarantee_and_one_motion_reaches_it(
    derivative: int, order: int
) -> None:
    rng, noise, bound = np.random.default_rng(5), 0.8, 0.5
    found = rule(best_ages(noise, bound, order), noise, bound, derivative)
    times = -found.ages
    hostile = -noise * np.sign(found.weights)
    worst = 0.0
    for rate in rng.uniform(0.01, 3.0, size=200):
        phase = rng.uniform(0, 2 * np.pi)
        wave = [bound / rate ** (order - k) * np.cos(rate * times + phase + k * np.pi / 2) for k in (0, derivative)]
        worst = max(worst, abs(wave[1][0] - found.weights @ (wave[0] + hostile)))
    assert worst <= found.error
    steady = bound * times**order / np.prod(np.arange(1, order + 1))
    error = abs(found.weights @ (steady + hostile))
    assert error == pytest.approx(found.error, rel=1e-12)


def test_what_has_no_closed_form_is_refused_with_a_sentence() -> None:
    for wrong in ((0.0, 1.0, 1, 2), (1.0, float("nan"), 1, 2), (1.0, 1.0, 2, 2), (1.0, 1.0, 1, 4)):
        with pytest.raises(DomainError, match=r"expected .*; got .*; "):
            least_error(*wrong)
    with pytest.raises(DomainError, match="wait for more"):
        best_rule(np.array([0.0]), 1.0, 1.0)
    with pytest.raises(DomainError, match="newest"):
        rule(np.array([0.5, 0.1]), 1.0, 1.0)
