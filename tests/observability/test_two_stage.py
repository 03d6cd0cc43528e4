"""Gains, error dynamics and steady errors, against characteristic polynomials and equations."""

from __future__ import annotations

import random

import numpy as np
import pytest
import sympy as sp

from navsym.core.errors import DomainError, ShapeError
from navsym.models.linear import LinearModel
from navsym.observability.chains import observe
from navsym.observability.splits import companion, general_blocks, split, two_stage_blocks, unit_row
from navsym.observability.two_stage.gains import (
    POLE,
    companion_gains,
    error_dynamics,
    gains_by_poles,
    hurwitz_minors,
    monic_coefficients,
    stability,
    steady_bias,
    steady_covariance,
)
from navsym.observability.two_stage.observer import (
    casadi_observer,
    closed_loop,
    error_covariance,
    exponential,
    observer,
    riccati_gain,
    run,
    run_slowly,
)

p = POLE
lam, nu = sp.symbols("lam nu", positive=True)
a, b = sp.symbols("a b", real=True)
OVERLAP = LinearModel([[0, 1, 0, 0], [0, 0, 1, 0], [a, b, 0, 0], [0, 0, 1, -1]], None, [[1, 0, 0, 0], [0, 0, 0, 1]])


def polynomial(matrix: sp.MatrixBase) -> sp.Expr:
    return sp.expand((p * sp.eye(matrix.rows) - matrix).det(method="berkowitz"))


@pytest.mark.parametrize("m", [1, 2, 3, 4, 5])
def test_gains_by_recursion_give_the_wanted_polynomial_for_every_theta(m):
    theta, wanted = sp.symbols(f"theta1:{m + 1}"), sp.symbols(f"c1:{m + 1}")
    gains = companion_gains(theta, wanted)
    error = companion(theta) - sp.Matrix(gains) * unit_row(m)
    assert polynomial(error) == sp.expand(p**m + sum(c * p ** (m - 1 - k) for k, c in enumerate(wanted)))


def test_both_stages_get_their_polynomials_and_the_whole_their_product():
    chosen = split(observe(OVERLAP))
    found = gains_by_poles(chosen, (p + lam) ** 3, p + nu)
    assert found.stable == (True, True)
    dynamics = error_dynamics(two_stage_blocks(chosen), found.K_x, found.K_z)
    assert polynomial(dynamics.A) == sp.expand((p + lam) ** 3 * (p + nu))
    assert dynamics.A[:3, 3:] == sp.zeros(3, 1)
    assert dynamics.coupling == two_stage_blocks(chosen).G_z1


def test_the_general_variant_adds_the_gain_to_the_coupling():
    found = observe(OVERLAP)
    blocks = general_blocks(OVERLAP, found, sp.Matrix([[1, 0, 0, 1]]))
    K_x, K_z = sp.symbols("k1:4"), sp.symbols("k4:5")
    coupling = error_dynamics(blocks, K_x, K_z).coupling
    assert all(sp.expand(x) == 0 for x in coupling - (blocks.G_z1 - K_z[0] * blocks.g_z1))
    assert coupling.has(K_z[0])


@pytest.mark.parametrize(
    ("text", "stable"),
    [
        ((p + 1) ** 3, True),
        (p**2 + 1, False),
        (p**2 - p + 1, False),
        ((p + lam) ** 2, True),
        ((p - lam) ** 2, False),
        (p * (p + 1), False),
        (p**2 + a * p + 1, None),
        (p**3 + p**2 + p + 1, False),
        ((p + lam) * (p + nu) ** 2, True),
    ],
)
def test_stability_is_decided_by_hurwitz_and_declared_signs(text, stable):
    degree = sp.degree(sp.expand(text), p)
    assert stability(monic_coefficients(sp.expand(text), degree)) is stable


def test_hurwitz_agrees_with_the_roots_of_random_polynomials():
    source = random.Random(3)
    for _ in range(60):
        values = [sp.Rational(source.randint(-4, 9), source.randint(1, 3)) for _ in range(source.randint(1, 5))]
        roots = np.roots([1.0, *map(float, values)])
        if np.abs(roots.real).min() < 1e-6:
            continue
        assert stability(values) is bool((roots.real < 0).all())


def test_minors_of_a_cubic_are_the_classical_ones():
    c1, c2, c3 = sp.symbols("c1:4")
    assert [sp.expand(m) for m in hurwitz_minors((c1, c2, c3))] == [
        c1,
        sp.expand(c1 * c2 - c3),
        sp.expand(c3 * (c1 * c2 - c3)),
    ]


def test_wrong_poles_are_refused():
    chosen = split(observe(OVERLAP))
    with pytest.raises(ShapeError, match="degree 3"):
        gains_by_poles(chosen, (p + lam) ** 2, p + nu)
    with pytest.raises(DomainError, match="left half-plane"):
        gains_by_poles(chosen, (p + lam) ** 3, p - 1)
    with pytest.raises(DomainError, match="polynomial in p"):
        gains_by_poles(chosen, (p + lam) ** 3, 1 / (p + nu))
    with pytest.raises(ShapeError, match="two polynomials"):
        gains_by_poles(chosen, (p + lam) ** 3, None)


def test_the_steady_covariance_solves_its_equation_and_the_bias_its_own():
    A = sp.Matrix([[-2 * lam, 1], [-(lam**2), 0]])
    Q = sp.Matrix([[4 * lam**2, 2 * lam**3], [2 * lam**3, lam**4 + 1]])
    P = steady_covariance(A, Q)
    assert all(sp.cancel(x) == 0 for x in A * P + P * A.T + Q)
    assert P == P.T
    assert all(sp.cancel(x) == 0 for x in A * steady_bias(A, sp.Matrix([1, a])) + sp.Matrix([1, a]))
    with pytest.raises(DomainError, match="determinant 0"):
        steady_covariance(sp.Matrix([[0, 1], [-1, 0]]), sp.eye(2))


VALUES = {a: -1, b: sp.Rational(-1, 2), lam: 2, nu: 3}


def running() -> object:
    chosen = split(observe(OVERLAP))
    found = gains_by_poles(chosen, (p + lam) ** 3, p + nu)
    return observer(two_stage_blocks(chosen), found.K_x, found.K_z, VALUES)


def test_the_fast_run_equals_two_stages_integrated_one_after_the_other():
    sigma = np.random.default_rng(1).normal(size=(6, 2))
    assert np.abs(run(running(), sigma, 0.2) - run_slowly(running(), sigma, 0.2)).max() < 1e-9


def test_an_undisturbed_estimate_converges_to_the_state():
    F = np.array(OVERLAP.F.subs(VALUES), dtype=float)
    H = np.array(OVERLAP.H, dtype=float)
    step, count = 0.002, 6000
    Phi, state, truth = exponential(F * step), np.array([1.0, -1.0, 0.5, 2.0]), []
    for _ in range(count):
        middle = exponential(F * step / 2) @ state
        state = Phi @ state
        truth.append((H @ middle, state))
    estimate = run(running(), np.array([s for s, _ in truth]), step)
    scale = np.linalg.norm(truth[-1][1])
    assert np.linalg.norm(estimate[-1] - truth[-1][1]) < 1e-5 * max(scale, 1.0)


def test_casadi_and_numpy_agree_to_1e_12():
    chosen = split(observe(OVERLAP))
    found = gains_by_poles(chosen, (p + lam) ** 3, p + nu)
    blocks = two_stage_blocks(chosen)
    function = casadi_observer(blocks, found.K_x, found.K_z, [a, b, lam, nu])
    A, B = closed_loop(running())
    source = np.random.default_rng(2)
    for _ in range(20):
        state, sigma = source.normal(size=4), source.normal(size=2)
        value = np.array(function(state, sigma, *(float(VALUES[s]) for s in (a, b, lam, nu)))).ravel()
        assert np.abs(value - (A @ state + B @ sigma)).max() < 1e-12 * max(1.0, np.abs(value).max())


def test_the_exponential_is_that_of_a_rotation_and_of_a_nilpotent_matrix():
    angle = 7.0
    c, s = np.cos(angle), np.sin(angle)
    assert np.abs(exponential(np.array([[0.0, angle], [-angle, 0.0]])) - [[c, s], [-s, c]]).max() < 1e-13
    assert np.array_equal(exponential(np.array([[0.0, 5.0], [0.0, 0.0]])), [[1.0, 5.0], [0.0, 1.0]])


def test_the_propagated_covariance_reaches_the_exact_steady_one():
    A = sp.Matrix([[-2 * lam, 1], [-(lam**2), 0]]).subs(lam, 1)
    Q = sp.Matrix([[2, 0], [0, 1]])
    exact = np.array(steady_covariance(A, Q), dtype=float)
    found = error_covariance(np.array(A, dtype=float), np.array(Q, dtype=float), np.zeros((2, 2)), 0.5, 200)
    assert np.abs(found[-1] - exact).max() < 1e-10


@pytest.mark.parametrize("step", [0.1, 10.0, 100.0, 1e4, 1e9])
def test_a_covariance_over_many_time_constants_is_the_steady_one(step):
    """Van Loan's exponential once held exp(100) for a step of a hundred time constants: variances of -1e28."""
    A, intensity = np.array([[-1.0, 0.0], [1.0, -0.01]]), np.eye(2)
    steady = np.array([[0.5, 0.5 / 1.01], [0.5 / 1.01, 50.0 + 50.0 / 1.01]])
    Phi = np.array([[np.exp(-step), 0.0], [(np.exp(-0.01 * step) - np.exp(-step)) / 0.99, np.exp(-0.01 * step)]])
    found = error_covariance(A, intensity, np.eye(2), step, 1)[-1]
    np.testing.assert_allclose(found, steady + Phi @ (np.eye(2) - steady) @ Phi.T, rtol=1e-10)


@pytest.mark.parametrize("step", [0.0, -1.0, np.nan, np.inf])
def test_a_step_that_is_no_duration_is_refused(step):
    with pytest.raises(DomainError, match="step: expected a positive number"):
        error_covariance(-np.eye(1), np.eye(1), np.eye(1), step, 1)


def test_the_riccati_gain_solves_its_equation_and_stabilises():
    G, g, Q = np.array([[0.0, 1.0], [-1.0, 0.0]]), np.array([0.0, 1.0]), np.diag([0.3, 1.0])
    K, P = riccati_gain(G, g, Q, 0.5)
    assert np.abs(G @ P + P @ G.T + Q - np.outer(P @ g, g @ P) / 0.5).max() < 1e-12
    assert np.linalg.eigvals(G - np.outer(K, g)).real.max() < 0
    with pytest.raises(DomainError, match="steady state"):
        riccati_gain(G, g, np.zeros((2, 2)), 0.5)


def test_a_symbol_without_a_value_is_named():
    chosen = split(observe(OVERLAP))
    found = gains_by_poles(chosen, (p + lam) ** 3, p + nu)
    with pytest.raises(DomainError, match="nu"):
        observer(two_stage_blocks(chosen), found.K_x, found.K_z, {a: 1, b: 1, lam: 1})
