"""The adaptive filter: fast against slow, textbook identities, stability, the printed gain."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter
from numpy.testing import assert_allclose
from scipy.linalg import solve_discrete_are, solve_discrete_lyapunov

from navsym.core.balls import enclose
from navsym.core.errors import DomainError, NotFiniteError, ShapeError, TooLargeError
from navsym_papers.trajectory.experiment.courses import (
    PRINTED_GAIN,
    course,
    experiment,
    metric_model,
    scaling_changes_rounding,
)
from navsym_papers.trajectory.experiment.inversion import (
    CRITERIA,
    Start,
    SteppedModel,
    Tuning,
    adaptive_filter,
    first_stage_model,
    fixed_gain_filter,
    metric_scale,
    normalised_scale,
    scaled_model,
    steady_gain,
    windowed_filter,
)
from navsym_papers.trajectory.experiment.stability import gain_stability, harmonic_lag, stationary_covariance
from navsym_papers.trajectory.experiment.stability import metric_scale as metric_balls
from navsym_papers.trajectory.experiment.stability import normalised_scale as normalised_balls
from tests.benchmarks import trajectory as benchmark
from tests.twins.trajectory import adaptive_filter_slowly, one_filter, windowed_filter_slowly

rng = np.random.default_rng(5)
Z = np.cumsum(rng.normal(size=60)) + rng.normal(size=60)


def normalised(n, form="corrected"):
    return scaled_model(first_stage_model(n, form), normalised_scale(n))


def start(n, q=1e-3):
    return Start(np.zeros(n), 4 * np.eye(n), np.full(n, q))


@pytest.mark.parametrize("n", [2, 3, 4])
@pytest.mark.parametrize("form", ["printed", "corrected"])
@pytest.mark.parametrize("criterion", list(CRITERIA))
def test_all_candidates_in_one_pass_equal_one_at_a_time(n, form, criterion):
    tuning = Tuning(1.0, criterion=criterion, weights=(1.0, 0.2, 0.04), stop=35)
    fast = adaptive_filter(Z, normalised(n, form), start(n), tuning)
    slow = adaptive_filter_slowly(Z, normalised(n, form), start(n), tuning)
    for name in ("states", "gains", "diagonals", "values"):
        one, two = getattr(fast, name), getattr(slow, name)
        assert_allclose(one, two, rtol=1e-12, atol=1e-12 * np.abs(two).max(), err_msg=name)


def test_the_243_candidates_of_the_paper_in_one_pass_equal_one_at_a_time():
    tuning = Tuning(1.0, stop=12)
    for form in ("printed", "corrected"):
        first = Start(np.zeros(5), np.eye(5), np.full(5, 1e-6))
        fast = adaptive_filter(Z[:20], normalised(5, form), first, tuning)
        slow = adaptive_filter_slowly(Z[:20], normalised(5, form), first, tuning)
        assert_allclose(fast.states, slow.states, atol=1e-12 * np.abs(slow.states).max())
        assert_allclose(fast.diagonals, slow.diagonals, rtol=1e-12)


@pytest.mark.parametrize("n", [*(pytest.param(n, marks=pytest.mark.long) for n in (1, 2, 3)), 4])
def test_carried_candidates_equal_single_filters(n):
    fast = windowed_filter(Z, normalised(n), start(n), Tuning(1.0), window=8)
    slow = windowed_filter_slowly(Z, normalised(n), start(n), Tuning(1.0), window=8)
    for name in ("states", "gains", "diagonals", "values"):
        one, two = getattr(fast, name), getattr(slow, name)
        assert_allclose(one, two, rtol=1e-12, atol=1e-12 * np.abs(two).max(), err_msg=name)


def test_a_field_of_one_candidate_is_the_kalman_filter_of_another_program():
    model, q, P = normalised(3), np.full(3, 1e-3), 4 * np.eye(3)
    other = KalmanFilter(dim_x=3, dim_z=1)
    other.x, other.P, other.F, other.Q = np.zeros(3), P.copy(), model.Phi, np.diag(q)
    other.H, other.R = model.gain_row[None, :], np.array([[1.0]])
    for (y, matrix, _), z in zip(one_filter(Z, model, np.zeros(3), P, q, 1.0), Z, strict=True):
        other.predict()
        other.update(z)
        assert_allclose(y, other.x, atol=1e-10)
        assert_allclose(matrix, other.P, atol=1e-10)


def test_the_row_before_a_step_is_the_row_after_it_times_the_transition():
    for n in (2, 5, 8):
        model = normalised(n)
        assert_allclose(model.gain_row @ model.Phi, model.row, rtol=1e-12)


def test_the_corrected_criterion_of_one_step_sees_only_the_first_element():
    from navsym_papers.trajectory.algorithm import values_with_corrected_gain

    assert values_with_corrected_gain() == 3


def test_a_bank_never_does_worse_than_its_first_candidate():
    tuned = windowed_filter(Z, normalised(3), start(3), Tuning(1.0), window=60)
    fixed = one_filter(Z, normalised(3), np.zeros(3), 4 * np.eye(3), np.full(3, 1e-3), 1.0)
    assert tuned.values[-1] <= fixed[-1][2] + 1e-9


def test_the_steady_gain_solves_the_riccati_equation():
    model = scaled_model(first_stage_model(4), metric_scale(4, 0.2))
    Q = np.array([0.0, 0.0, 0.0, 1e-6])
    gain, corrected = steady_gain(model, 2.0, Q)
    ahead = solve_discrete_are(model.Phi.T, model.gain_row[:, None], np.diag(Q), np.array([[2.0]]))
    assert_allclose(gain, ahead @ model.gain_row / (model.gain_row @ ahead @ model.gain_row + 2.0), rtol=1e-6)
    assert_allclose(model.Phi @ corrected @ model.Phi.T + np.diag(Q), ahead, rtol=1e-5)


def test_a_polynomial_is_followed_exactly_by_any_gain_from_the_true_state():
    t = np.arange(1, 40) * 0.2
    states = fixed_gain_filter(
        1 + 2 * t - 0.3 * t**2,
        scaled_model(first_stage_model(3), metric_scale(3, 0.2)),
        np.array([0.4, 0.3, 0.1]),
        np.array([1.0, 2.0, -0.6]),
    )
    assert_allclose(states[:, 1], 2 - 0.6 * t, atol=1e-12)


# -- stability and noise of fixed gains ----------------------------------------------------------------

GAIN = tuple(Fraction(str(x)) for x in PRINTED_GAIN)
ROUNDING = tuple(map(Fraction, ("5e-5", "5e-6", "5e-7", "5e-9", "5e-10")))


def spectral_radius(gain, scale):
    model = scaled_model(first_stage_model(5), scale)
    return np.abs(np.linalg.eigvals(model.Phi - np.outer(gain, model.row))).max()


@pytest.mark.parametrize(
    "scale, balls, stable",
    [
        (normalised_scale(5), normalised_balls(5), False),
        (metric_scale(5, 0.2), metric_balls(5, Fraction(1, 5)), True),
        (np.ones(5), None, False),
    ],
)
def test_the_verdict_on_the_printed_gain_holds_at_the_corners_of_its_rounding_box(scale, balls, stable):
    assert gain_stability(GAIN, ROUNDING, balls).stable is stable
    for corner in np.ndindex(*(2,) * 5):
        gain = [float(g + (2 * c - 1) * w) for g, w, c in zip(GAIN, ROUNDING, corner, strict=True)]
        assert bool(spectral_radius(gain, scale) < 1) is stable


def test_a_box_with_both_kinds_of_gain_is_not_decided():
    assert gain_stability([Fraction(2), Fraction(1, 10)], [Fraction(3, 2), Fraction(1, 20)]).stable is None


@pytest.mark.parametrize("n", [1, 2, 3])
def test_routh_agrees_with_eigenvalues_for_random_gains(n):
    for _ in range(60):
        gain = [Fraction(int(x), 64) for x in rng.integers(-20, 100, n)]
        found = gain_stability(gain, [Fraction(0)] * n).stable
        model = first_stage_model(n)
        radius = np.abs(np.linalg.eigvals(model.Phi - np.outer([float(g) for g in gain], model.row))).max()
        if abs(radius - 1) > 1e-9:
            assert found is bool(radius < 1)


def test_the_stationary_covariance_is_that_of_lyapunovs_equation():
    gain = [Fraction(1, 2), Fraction(1, 5), Fraction(1, 50)]
    model = first_stage_model(3)
    k = np.array([float(g) for g in gain])
    C = model.Phi - np.outer(k, model.row)
    exact = np.array([[float(x) for x in row] for row in stationary_covariance(gain)])
    assert_allclose(exact, solve_discrete_lyapunov(C, np.outer(k, k)), rtol=1e-10)


def test_the_lag_of_a_harmonic_motion_is_that_of_a_long_run():
    gain, tau, period = [Fraction(1, 3), Fraction(1, 10), Fraction(1, 100)], Fraction(1, 5), Fraction(20)
    t = np.arange(1, 3001) * 0.2
    omega = 2 * np.pi / 20
    model = scaled_model(first_stage_model(3), metric_scale(3, 0.2))
    states = fixed_gain_filter(
        np.sin(omega * t), model, np.array([float(g) for g in gain]) * metric_scale(3, 0.2), np.zeros(3)
    )
    error = (states[:, 1] - omega * np.cos(omega * t))[-1000:]
    ratio = np.sqrt(2 * np.mean(error**2)) / omega
    assert abs(float(enclose(harmonic_lag(gain, tau, period, 2), bits=200).mid()) - ratio) < 1e-9


def poles(n):
    """Stable poles, from slow to fast, real and in pairs."""
    found = []
    while len(found) < n:
        size = 1 - 10 ** rng.uniform(-2, -0.01)
        pair = size * np.exp(1j * rng.uniform(0.01, 3.0))
        found += [pair, pair.conjugate()] if n - len(found) > 1 and rng.random() < 0.6 else [size]
    return found


def test_no_stable_gain_takes_less_noise_than_the_bound_at_any_angle():
    """The bound of experiment.together.100, against Lyapunov's equation and the answer S at random angles."""
    tight = []
    for _ in range(400):
        n = int(rng.integers(1, 5))
        chi = np.real(np.poly(poles(n)))
        model = first_stage_model(n)
        moments = np.array([model.row @ np.linalg.matrix_power(model.Phi - np.eye(n), k) for k in range(n)])
        gain = np.linalg.solve(moments, np.poly1d(chi)(np.poly1d([1, 1])).coeffs[1:])
        position = solve_discrete_lyapunov(model.Phi - np.outer(gain, model.row), np.outer(gain, gain))[0, 0]
        angle = 10 ** rng.uniform(-2.5, 0.4)
        zeta = np.exp(1j * angle)
        answer = abs((zeta - 1) ** n / np.polyval(chi, zeta))
        m = 1 + max(angle / np.pi * (2 * np.log(1 / answer) - 1), 0.0)
        assert position > (1 - 1 / m) * (1 - 1e-9)
        tight.append((1 - 1 / m) / position)
    assert max(tight) > 0.3


def test_the_rows_behind_the_bound_hold_for_a_harmonic_motion():
    """experiment.together.rows by the steady answer of one observer, as complex numbers."""
    gain, zeta = np.array([0.3, 0.05, 0.01, 0.002, 0.0003]), np.exp(0.05j)
    model = first_stage_model(5)
    y = np.linalg.solve(zeta * np.eye(5) - model.Phi + np.outer(gain, model.row), gain * zeta)
    nu = 1 - model.row @ y / zeta
    left = y[1] * (zeta + 1) / 2 - (zeta - 1) * (1 + y[2] / 6)
    assert abs(left + (zeta - 1 + gain[0] - zeta * (gain[1] / 2 - gain[2] / 6)) * nu) < 1e-12


# -- the experiment ------------------------------------------------------------------------------------


def test_courses_are_integrals_of_their_speeds_and_only_the_printed_one_jumps():
    jumps = {}
    for programme in ("printed", "consistent"):
        truth = course(100.0, programme)
        smooth = np.abs(np.diff(truth.speed) / 0.2 - (truth.acceleration[1:] + truth.acceleration[:-1]) / 2)
        jumps[programme] = np.abs(np.diff(truth.speed)).max()
        assert np.median(smooth) < 1e-6
        assert_allclose(truth.position[-1], np.trapezoid(truth.speed, truth.t), rtol=1e-5)
    assert jumps["printed"] > 1.0 > 0.05 > jumps["consistent"]


def test_the_rerun_contradicts_the_printed_yawing_error_of_the_printed_gain():
    rows = [r for r in experiment(runs=1) if r["algorithm"] == "printed gain"]
    at_100 = [r for r in rows if r["speed"] == 100]
    assert all(r["obtained"]["speed_yawing"] > 0.8 for r in at_100)
    assert all(0.012 < r["obtained"]["speed_straight"] < 0.022 for r in rows)
    assert all(0.2 < r["obtained"]["position_straight"] < 0.27 for r in rows)


def test_the_printed_gain_is_metric():
    assert spectral_radius(np.array(PRINTED_GAIN), metric_scale(5, 0.2)) < 1
    assert metric_model().order == 5


def test_scaling_by_powers_of_two_changes_no_bit_of_a_filter():
    assert not scaling_changes_rounding(n=4, steps=300)


# -- bad input -----------------------------------------------------------------------------------------


def test_bad_requests_say_what_is_wrong():
    model = normalised(3)
    with pytest.raises(DomainError, match="criterion"):
        Tuning(1.0, criterion="best")
    with pytest.raises(DomainError, match="R: expected a positive"):
        Tuning(0.0)
    with pytest.raises(DomainError, match="step"):
        Tuning(1.0, step=1.0)
    with pytest.raises(NotFiniteError, match="z"):
        adaptive_filter(np.array([1.0, np.nan]), model, start(3), Tuning(1.0))
    with pytest.raises(DomainError, match="start: expected 3"):
        adaptive_filter(Z, model, start(2), Tuning(1.0))
    with pytest.raises(DomainError, match="Q: expected no negative"):
        Start(np.zeros(2), np.eye(2), np.array([1.0, -1.0]))
    with pytest.raises(DomainError, match="corrected form"):
        windowed_filter(Z, normalised(3, "printed"), start(3), Tuning(1.0))
    with pytest.raises(TooLargeError, match="candidates"):
        adaptive_filter(Z, normalised(10), start(10), Tuning(1.0))
    with pytest.raises(DomainError, match="upper triangle"):
        SteppedModel(np.ones((2, 2)), np.ones(2), np.ones(2))
    with pytest.raises(ShapeError, match="row"):
        SteppedModel(np.eye(2), np.ones(3), np.ones(2))


def test_the_benchmark_runs(capsys):
    benchmark.main(["--quick"])
    assert "mpmath" in capsys.readouterr().out
