"""The Kalman step against information form, Joseph, and a batch least-squares solution."""

import numpy as np
import pytest
from numpy.linalg import inv
from numpy.testing import assert_allclose

from navsym.multimodel import kalman


def random_spd(rng, n):
    A = rng.standard_normal((n, n))
    return A @ A.T + 0.1 * np.eye(n)


def test_correction_adds_information():
    P, H, R = np.diag([4.0, 1.0]), np.array([[1.0, 2.0]]), np.array([[0.5]])
    _, corrected, _ = kalman.correct(np.zeros(2), P, np.array([1.0]), H, R)
    assert_allclose(inv(corrected), inv(P) + H.T @ inv(R) @ H, rtol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_a_filter_without_process_noise_is_least_squares(seed):
    rng = np.random.default_rng(seed)
    prior, H = random_spd(rng, 3), rng.standard_normal((6, 2, 3))
    R, z = random_spd(rng, 2), rng.standard_normal((6, 2))
    mean, P = np.zeros(3), prior
    for rows, values in zip(H, z, strict=True):
        mean, P, _ = kalman.correct(mean, P, values, rows, R)
    information = inv(prior) + sum(rows.T @ inv(R) @ rows for rows in H)
    projected = sum(rows.T @ inv(R) @ values for rows, values in zip(H, z, strict=True))
    assert_allclose(P, inv(information), rtol=1e-10)
    assert_allclose(mean, inv(information) @ projected, rtol=1e-9, atol=1e-12)


def test_the_log_likelihood_is_that_of_the_joint_gaussian():
    rng = np.random.default_rng(3)
    P, H, R, m = random_spd(rng, 3), rng.standard_normal((2, 3)), random_spd(rng, 2), rng.standard_normal(3)
    z = rng.standard_normal(2)
    _, _, found = kalman.correct(m, P, z, H, R)
    S, v = H @ P @ H.T + R, z - H @ m
    assert_allclose(found, -0.5 * (v @ inv(S) @ v + np.log(np.linalg.det(2 * np.pi * S))), rtol=1e-12)


def test_a_stack_is_its_members_one_by_one():
    rng = np.random.default_rng(4)
    means, Ps = rng.standard_normal((4, 3)), np.stack([random_spd(rng, 3) for _ in range(4)])
    F, Q = rng.standard_normal((4, 3, 3)), np.stack([random_spd(rng, 3) for _ in range(4)])
    H, R = rng.standard_normal((4, 2, 3)), np.stack([random_spd(rng, 2) for _ in range(4)])
    z = rng.standard_normal(2)
    together = kalman.correct(*kalman.predict(means, Ps, F, Q), z, H, R)
    for i in range(4):
        alone = kalman.correct(*kalman.predict(means[i], Ps[i], F[i], Q[i]), z, H[i], R[i])
        for whole, part in zip(together, alone, strict=True):
            assert_allclose(whole[i], part, rtol=1e-12, atol=1e-13)


def test_josephs_form_stays_positive_where_the_short_form_does_not():
    P, H, R = np.diag([1e8, 1e-8]), np.array([[1.0, 1e-3]]), np.array([[1e-9]])
    mean = np.zeros(2)
    for _ in range(20):
        mean, P, _ = kalman.correct(mean, P, np.array([0.0]), H, R)
        assert np.linalg.eigvalsh(P)[0] >= 0.0


def test_a_perfect_measurement_of_a_known_state_leaves_it_and_is_impossible():
    nothing = np.zeros((1, 1))
    mean, P, log_likelihood = kalman.correct(np.zeros(1), nothing, np.ones(1), np.eye(1), nothing)
    assert (mean[0], P[0, 0], log_likelihood) == (0.0, 0.0, -np.inf)


def test_an_innovation_too_large_to_square_is_impossible_and_not_nan():
    mean, P, log_likelihood = kalman.correct(np.zeros(1), np.eye(1), np.array([1e200]), np.eye(1), np.eye(1))
    assert log_likelihood == -np.inf
    assert np.isfinite(mean).all() and np.isfinite(P).all()


def test_a_covariance_whose_eigenvalues_are_positive_but_which_has_no_factor_is_singular_and_no_traceback():
    delta = 1e-8
    for seed in range(40):
        a, b = np.random.default_rng(seed).uniform(0.5, 1.5, 2)
        H = np.array([[a, b], [a, b + delta]])
        x, P, ll = kalman.correct(
            np.zeros((2, 2)),
            np.eye(2),
            np.ones(2),
            np.stack([H, np.eye(2)]),
            np.stack([delta**2 * np.eye(2), np.eye(2)]),
        )
        assert np.isfinite(x).all() and np.isfinite(P).all() and np.isfinite(ll[1]) and not np.isnan(ll[0])


def test_rotated_scalars_say_the_same_as_the_vector():
    rng = np.random.default_rng(5)
    P, H, R, z = random_spd(rng, 3), rng.standard_normal((3, 3)), random_spd(rng, 3), rng.standard_normal(3)
    whole = kalman.correct(np.zeros(3), P, z, H, R)
    mean, covariance, total = np.zeros(3), P, 0.0
    rows, variances, rotation = kalman.independent_scalars(H, R)
    for value, row, variance in zip(rotation @ z, rows, variances, strict=True):
        mean, covariance, part = kalman.correct(mean, covariance, np.array([value]), row[None], np.array([[variance]]))
        total += part
    assert_allclose(mean, whole[0], rtol=1e-10)
    assert_allclose(covariance, whole[1], rtol=1e-9, atol=1e-12)
    assert_allclose(total, whole[2], rtol=1e-12)
