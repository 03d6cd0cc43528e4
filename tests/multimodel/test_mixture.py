"""Mixtures: second moments, twins, and what one pass costs in digits."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from navsym.multimodel import kalman as mixture
from tests.twins import mixture as twins


@st.composite
def mixtures(draw):
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    k, n = draw(st.integers(1, 6)), draw(st.integers(1, 4))
    weights = rng.random(k) + 1e-3
    factors = rng.standard_normal((k, n, n))
    return weights / weights.sum(), 3.0 * rng.standard_normal((k, n)), factors @ np.swapaxes(factors, 1, 2)


@settings(max_examples=60, deadline=None)
@given(mixtures())
def test_merging_keeps_the_second_moment(drawn):
    weights, means, covariances = drawn
    mean, covariance = twins.merge(*drawn)
    parts = zip(weights, means, covariances, strict=True)
    second = sum(w * (P + np.outer(x, x)) for w, x, P in parts)
    assert_allclose(covariance + np.outer(mean, mean), second, atol=1e-11)


@settings(max_examples=60, deadline=None)
@given(mixtures())
def test_every_way_to_merge_agrees(drawn):
    mean, covariance = twins.merge(*drawn)
    for twin in (twins.merge_slowly, twins.merge_in_one_pass):
        other = twin(*drawn)
        assert_allclose(other[0], mean, atol=1e-12)
        assert_allclose(other[1], covariance, atol=1e-11)


def test_one_pass_keeps_the_digits_that_second_moments_lose():
    means = 1e8 + np.array([[0.0], [1.0], [3.0]])
    weights, covariances = np.array([0.2, 0.3, 0.5]), np.full((3, 1, 1), 1e-4)
    centred = twins.merge(weights, means - 1e8, covariances)[1]
    assert_allclose(twins.merge_in_one_pass(weights, means, covariances)[1], centred, rtol=1e-7)
    lost = twins.merge_by_second_moments(weights, means, covariances)[1]
    assert abs(lost - centred) > 0.05 * centred


def test_merging_groups_is_merging_each():
    rng = np.random.default_rng(1)
    means, factors = rng.standard_normal((5, 3)), rng.standard_normal((5, 3, 3))
    covariances = factors @ np.swapaxes(factors, 1, 2)
    weights = rng.random((4, 5))
    weights /= weights.sum(axis=1, keepdims=True)
    mean, covariance = mixture.merge_groups(weights, means, covariances)
    for row, x, P in zip(weights, mean, covariance, strict=True):
        expected = twins.merge(row, means, covariances)
        assert_allclose(x, expected[0], atol=1e-13)
        assert_allclose(P, expected[1], atol=1e-12)


def test_weights_far_below_the_smallest_double_keep_their_ratio():
    weights, total = mixture.normalise(np.array([-5000.0, -5000.0 + np.log(3.0)]))
    assert_allclose(weights, [0.25, 0.75], rtol=1e-12)
    assert_allclose(total, -5000.0 + np.log(4.0), rtol=1e-15)


def test_no_weight_at_all_is_said_and_not_nan():
    weights, total = mixture.normalise(np.array([-np.inf, -np.inf]))
    assert total == -np.inf
    assert weights.tolist() == [0.0, 0.0]


@pytest.mark.parametrize("log_weight", [-np.inf, -1e4])
def test_adding_nothing_changes_nothing(log_weight):
    sums = twins.accumulate(twins.nothing(2), 0.0, np.ones(2), np.eye(2))
    more = twins.accumulate(sums, log_weight, np.full(2, 9.0), np.eye(2))
    assert_allclose(more.mean, sums.mean, atol=1e-15)
    assert_allclose(more.covariance, sums.covariance, atol=1e-15)
