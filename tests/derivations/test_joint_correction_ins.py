"""The experiment: flight, situations, exact covariance against drawn runs, and what the paper says of it."""

from __future__ import annotations

import numpy as np
import pytest

from navsym.core.errors import DomainError
from navsym_papers.joint_correction.experiment.flight import EARTH_RADIUS, EARTH_RATE, SCHULER_RATE, great_circle
from navsym_papers.joint_correction.experiment.ins import (
    Errors,
    Situation,
    along,
    chain_matrix,
    compare,
    decoupled,
    gains,
    kalman_deviations,
    monte_carlo,
    plan,
    position_error,
    standard_deviations,
    steps_of,
)

V, P, B, N = Situation.VELOCITY, Situation.POSITION, Situation.BOTH, Situation.NEITHER
STEP = 20.0


@pytest.fixture(scope="module")
def flight():
    return great_circle(duration=7200.0, step=STEP)


def test_the_flight_obeys_its_kinematics(flight):
    dtau = flight.tau[1]
    middle = slice(1, -1)
    assert np.abs((flight.omega[2:] - flight.omega[:-2]) / (2 * dtau) - flight.omega_rate[middle]).max() < 1e-6
    omega = np.hstack([flight.omega, np.zeros((len(flight.tau), 1))])
    turning = -np.cross(omega, flight.u)
    assert np.abs((flight.u[2:] - flight.u[:-2]) / (2 * dtau) - turning[middle]).max() < 1e-6
    length = np.linalg.norm(flight.u, axis=1) * SCHULER_RATE
    assert np.abs(length - EARTH_RATE).max() < 1e-12
    assert flight.mu < 0.1


def test_an_eastward_start_has_the_rates_of_the_textbook():
    flight = great_circle(latitude=np.pi / 4, heading=np.pi / 2, duration=100.0, step=10.0)
    horizontal = EARTH_RATE * np.cos(np.pi / 4) + 250.0 / EARTH_RADIUS
    assert np.allclose(flight.omega[0] * SCHULER_RATE, [0.0, horizontal], atol=1e-15)
    assert np.allclose(flight.u[0] * SCHULER_RATE, EARTH_RATE * np.array([0.0, np.sqrt(0.5), np.sqrt(0.5)]), atol=1e-15)


def test_gains_place_the_poles_of_every_situation(flight):
    matrices = along(flight)
    F, H = matrices.A[0].copy(), matrices.C[0].copy()
    H[0, 3] = H[1, 0] = 0.0  # without the link between the channels
    F[7, [6, 8]] = F[9, [6, 8]] = 0.0  # and without mu^2
    for situation, wanted in ((V, [-2.0] * 6), (B, [-3.0] * 4 + [-2.0] * 6), (P, [-3.0] * 8)):
        poles = np.linalg.eigvals(F - gains(situation, 2.0, 3.0) @ H)
        moving = np.sort_complex(poles[np.abs(poles) > 1e-3])
        assert len(moving) == len(wanted)
        assert np.abs(np.sort(moving.real) - np.sort(wanted)).max() < 5e-3
    assert not gains(N, 2.0, 3.0).any()


def test_decoupled_gains_have_their_poles_in_spite_of_the_link(flight):
    matrices = along(flight)
    A, C = matrices.A[0][:6, :6], matrices.C[0]
    K = gains(V, 2.0, 3.0)
    plain = np.linalg.eigvals(A - K[:6, :2] @ C[:2, :6])
    free = np.linalg.eigvals(A - decoupled(K, C)[:6, :2] @ C[:2, :6])
    assert np.abs(free + 2.0).max() < 2e-2  # a sixfold root is hard on the eigenvalues
    assert plain.real.max() > -1.5
    assert np.allclose(chain_matrix(0.3)[0], C[0, :6] * [1, 1, 1, 0, 1, 1] + [0, 0, 0, 0.3, 0, 0])


@pytest.mark.long
def test_drawn_runs_agree_with_the_propagated_covariance_through_all_situations(flight):
    errors = Errors()
    chosen = plan([(V, 40), (B, 20), (V, 10), (N, 10), (P, 20)], STEP)
    steps = steps_of(flight, chosen, errors)
    exact = standard_deviations(steps, errors)
    drawn = monte_carlo(steps, errors, 3000, seed=4)
    assert np.abs(drawn / exact - 1.0).max() < 5.0 / np.sqrt(2 * 3000)


def test_monte_carlo_repeats_itself_for_a_seed(flight):
    errors, chosen = Errors(), plan([(V, 5), (B, 5)], STEP)
    steps = steps_of(flight, chosen, errors)
    assert np.array_equal(monte_carlo(steps, errors, 10, seed=1), monte_carlo(steps, errors, 10, seed=1))


def test_no_estimator_beats_the_kalman_filter(flight):
    errors = Errors()
    for phases in ([(V, 60), (B, 30)], [(P, 60)], [(B, 20), (N, 20), (V, 20)]):
        chosen = plan(phases, STEP)
        bound = kalman_deviations(flight, chosen, errors)
        found = standard_deviations(steps_of(flight, chosen, errors), errors)
        # Inside its first step the algorithm sees the signal move under a noise that is held.
        assert (found[3:] >= bound[3:] * (1 - 1e-3)).all()


def test_preestimation_helps_and_the_joint_session_is_short(flight):
    rows = compare(flight, Errors(), before=60.0, minutes=(5.0, 10.0, 20.0, 30.0)).rows
    two, late = rows["two stages"], rows["two stages, not pre-estimated"]
    assert all(a < b for a, b in zip(two, late, strict=True))
    assert two[-1] < 20.0
    assert rows["Kalman filter, full model"][-1] < two[-1]


def test_position_errors_do_not_grow_faster_than_the_velocity_error_after_the_session(flight):
    errors = Errors()
    chosen = plan([(V, 40), (B, 30), (V, 30)], STEP)
    curve = position_error(standard_deviations(steps_of(flight, chosen, errors), errors))
    ends = [round(m * 60 / STEP) for m in (70, 100)]
    assert curve[ends[0]] < curve[ends[1]] < curve[ends[0]] + 2.0 * 1800.0


def test_a_flight_that_does_not_move_is_refused():
    with pytest.raises(DomainError, match="positive"):
        great_circle(speed=0.0)


def test_no_situation_of_the_last_paragraph_beats_the_kalman_filter_of_the_full_model():
    from navsym_papers.joint_correction.experiment.study import SITUATIONS, situations

    rows = situations(great_circle(duration=6600.0, step=20.0))
    pairs = list(zip(rows[::2], rows[1::2], strict=True))
    assert [ours["situation"] for ours, _ in pairs] == [str(situation) for situation, _ in SITUATIONS]
    for ours, bound in pairs:
        assert bound["position_m"] <= ours["position_m"] * (1 + 1e-6)
        assert bound["velocity_error_mps"] <= ours["velocity_error_mps"] * (1 + 1e-6)
    by_name = {ours["situation"]: ours["position_m"] for ours, _ in pairs}
    assert by_name["position"] < by_name["neither"]
