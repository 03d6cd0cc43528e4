"""The INS error model against integrated motion, and the bookkeeping of mu."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from navsym_papers.joint_correction import kinematics as kin
from navsym_papers.joint_correction.inertial import (
    FULL,
    MU,
    ORDERS,
    derivative,
    dimensionless,
    full_model,
    joint_model,
    lowest_order,
    monomial_order,
    pick_order,
    position_group,
    truncate,
    velocity_group,
)


def rotation(vector: np.ndarray) -> np.ndarray:
    """Base to turned axes for the rotation vector, exactly (Rodrigues)."""
    angle = np.linalg.norm(vector)
    if angle == 0:
        return np.eye(3)
    S = np.array([[0, -vector[2], vector[1]], [vector[2], 0, -vector[0]], [-vector[1], vector[0], 0]])
    return np.eye(3) - np.sin(angle) / angle * S + (1 - np.cos(angle)) / angle**2 * S @ S


def test_the_rate_of_a_small_rotation_is_that_of_two_turning_frames():
    source = np.random.default_rng(0)
    rate, excess, theta = source.normal(size=3), 1e-6 * source.normal(size=3), 1e-6 * source.normal(size=3)
    h = 1e-4
    base, turned = rotation(rate * h), rotation((rate + excess) * h)
    after = turned @ rotation(theta) @ base.T
    vector = -np.array([after[2, 1] - after[1, 2], after[0, 2] - after[2, 0], after[1, 0] - after[0, 1]]) / 2
    symbols = sp.Matrix(sp.symbols("a1:4")), sp.Matrix(sp.symbols("b1:4")), sp.Matrix(sp.symbols("c1:4"))
    formula = kin.rotation_rate(*symbols)
    values = {
        s: v
        for group, given in zip(symbols, (theta, excess, rate), strict=True)
        for s, v in zip(group, given, strict=True)
    }
    expected = np.array([float(x.subs(values)) for x in formula])
    assert np.abs((vector - theta) / h - expected).max() < 2e-4 * np.abs(expected).max()


def test_specific_force_and_mechanisation_invert_each_other():
    rate, change = kin.OMEGA_X, kin.OMEGA_X_RATE
    force = kin.specific_force(rate, change, kin.CLIMB)
    back = kin.mechanisation(force, rate, kin.CLIMB)
    assert [sp.expand(x) for x in back - change[:2, :]] == [0, 0]


def test_gravity_alone_is_the_force_at_rest():
    zero = sp.zeros(3, 1)
    assert list(kin.specific_force(zero, zero)) == [0, 0, kin.RADIUS * kin.SCHULER**2]


def test_error_equations_follow_two_nonlinear_computers():
    """An exact run of sensors, platform and computer against one without errors, over a short time."""
    R, w0, h, steps = 6378137.0, 1.24e-3, 0.01, 100
    omega, change = np.array([3e-5, -6e-5, 0.0]), np.array([2e-9, 1e-9, 0.0])
    alpha, dp = 1e-5 * np.array([1.0, -2.0, 3.0]), 1e-8 * np.array([1.0, 2.0])
    nu, eps = 1e-9 * np.array([1.0, -2.0, 1.5]), 1e-6 * np.array([1.0, -1.0])
    delta = np.array([dp[0] + alpha[2] * omega[1], dp[1] - alpha[2] * omega[0]])
    computed = omega[:2] + delta
    C, true = rotation(alpha), omega.copy()
    for _ in range(steps):
        f = np.array([R * change[1], -R * change[0], R * w0**2 - R * (true[0] ** 2 + true[1] ** 2)])
        measured = C @ f + np.array([eps[0], eps[1], 0.0]) * R * w0**2
        C = rotation((np.array([*computed, 0.0]) + nu) * h) @ C @ rotation(true * h).T
        computed = computed + h * np.array([-measured[1] / R, measured[0] / R])
        true = true + h * change
    after = -np.array([C[2, 1] - C[1, 2], C[0, 2] - C[2, 0], C[1, 0] - C[0, 1]]) / 2
    dp_after = computed - true[:2] + np.array([-after[2] * true[1], after[2] * true[0]])
    values = {
        kin.SCHULER: w0,
        **dict(zip(kin.ALPHA, alpha, strict=True)),
        **dict(zip(kin.DELTA_P, dp, strict=True)),
        **dict(zip(kin.NU_X, nu, strict=True)),
        **dict(zip(kin.EPSILON, eps, strict=True)),
        **dict(zip(kin.OMEGA_X[:2], omega[:2], strict=True)),
    }
    rates = kin.error_equations().rates
    for k in range(2):
        expected = float(rates[kin.DELTA_P[k]].subs(values))
        assert abs((dp_after[k] - dp[k]) / (h * steps) - expected) < 3e-3 * abs(expected)
        expected = float(rates[kin.ALPHA[k]].subs(values))
        assert abs((after[k] - alpha[k]) / (h * steps) - expected) < 3e-3 * abs(expected)


def test_the_earth_rate_turns_with_the_frame_and_keeps_its_length():
    rates = dimensionless().rates
    u = sp.symbols("u_1:4", real=True)
    assert derivative(sum(x**2 for x in u), rates) == 0


def test_orders_are_sums_over_factors():
    a, b = sp.symbols("a b")
    orders = {MU: 1, a: -1}
    assert monomial_order(3 * MU**2 * a * b, orders) == 1
    kept = truncate(MU * a + MU**3 * b + b, orders, 2)
    assert kept.kept == MU * a + b
    assert [(d.term, d.order) for d in kept.dropped] == [(MU**3 * b, 3)]
    assert pick_order(MU * a + b + MU, orders, 0) == MU * a + b
    assert lowest_order(MU * b, orders) == 1
    assert lowest_order(sp.Integer(0), orders) is None


@pytest.mark.parametrize("group", [velocity_group(), position_group()])
def test_kept_and_dropped_terms_add_up_to_the_full_derivative(group):
    equations = dimensionless()
    meaning = dict(zip(group.variables, group.meaning, strict=True))
    for value, rate, dropped in zip(group.meaning, group.rates, group.dropped, strict=True):
        total = rate + sum((d.term for d in dropped), sp.Integer(0))
        assert sp.expand(total.subs(meaning) - derivative(value, equations.rates)) == 0
        assert all(d.order >= 2 for d in dropped)


@pytest.mark.parametrize("group", [velocity_group(), position_group()])
def test_outputs_are_exact_in_the_variables_of_the_group(group):
    equations = dimensionless()
    meaning = dict(zip(group.variables, group.meaning, strict=True))
    outputs = equations.velocity if len(group.variables) == 6 else equations.position
    for output, value in zip(group.outputs, outputs, strict=True):
        assert sp.expand(output.subs(meaning) - value) == 0


def test_the_linear_part_and_the_forcing_add_up():
    group = position_group()
    F, _, forcing = group.linear()
    total = F * sp.Matrix(group.variables) + sp.Matrix(forcing)
    assert [sp.expand(t - r) for t, r in zip(total, group.rates, strict=True)] == [0] * 8
    assert {lowest_order(f, ORDERS) for f in forcing if f != 0} == {1}


def test_models_have_the_sizes_that_they_say():
    assert joint_model().size == 10
    full = full_model()
    assert (full.size, full.H.rows) == (len(FULL), 4) == (16, 4)
    leading = full_model(order=1)
    assert MU not in leading.F.free_symbols
