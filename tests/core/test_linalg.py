"""Identities of the small linear algebra."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.linalg import inv
from numpy.testing import assert_allclose

from navsym.core.errors import DomainError
from navsym.core.linalg import (
    condition_number,
    gain,
    gaussian_log_density,
    joseph,
    log_determinant,
    mahalanobis,
    symmetrise,
)


def gram(seed, n):
    A = np.random.default_rng(seed).normal(size=(n, n + 2))
    return A @ A.T


@given(st.integers(0, 10**6), st.integers(1, 6))
def test_correction_adds_information(seed, n):
    P, H, R = gram(seed, n), np.ones((1, n)), np.array([[0.5]])
    K, _ = gain(P, H, R)
    corrected = joseph(P, K, H, R)
    assert_allclose(corrected @ (inv(P) + H.T @ inv(R) @ H), np.eye(n), atol=1e-6)


def test_joseph_holds_for_a_gain_that_is_not_optimal_and_is_worse_there():
    P, H, R = np.diag([4.0, 1.0]), np.array([[1.0, 2.0]]), np.array([[0.5]])
    K, S = gain(P, H, R)
    best, other = joseph(P, K, H, R), joseph(P, 0.7 * K, H, R)
    assert_allclose(best, P - K @ S @ K.T, rtol=1e-14)
    assert np.linalg.eigvalsh(other - best).min() > -1e-14


@given(st.integers(0, 10**6), st.integers(1, 6))
def test_the_log_determinant_is_that_of_the_eigenvalues(seed, n):
    P = gram(seed, n)
    assert_allclose(log_determinant("P", P), np.log(np.linalg.eigvalsh(P)).sum(), atol=1e-8)


def test_the_log_determinant_does_not_overflow():
    assert_allclose(log_determinant("P", 1e10 * np.eye(40)), 400 * np.log(10.0), rtol=1e-14)


def test_the_density_of_one_number_is_the_bell_curve():
    v, S = np.array([0.3]), np.array([[0.04]])
    expected = np.log(np.exp(-0.5 * 0.09 / 0.04) / np.sqrt(2 * np.pi * 0.04))
    assert_allclose(gaussian_log_density("S", v, S), expected, rtol=1e-14)
    assert_allclose(mahalanobis("S", v, S), 0.09 / 0.04, rtol=1e-14)


def test_an_indefinite_matrix_is_refused_by_name():
    with pytest.raises(DomainError, match="S: expected a positive definite matrix; got the eigenvalue -1"):
        log_determinant("S", np.diag([1.0, -1.0]))


def test_symmetrise_works_on_stacks_and_the_condition_number_of_a_singular_matrix_is_infinite():
    stack = np.arange(8.0).reshape(2, 2, 2)
    assert_allclose(symmetrise(stack)[1], [[4.0, 5.5], [5.5, 7.0]])
    assert_allclose(condition_number(np.diag([8.0, 2.0])), 4.0)
    assert condition_number(np.zeros((2, 2))) == float("inf")
