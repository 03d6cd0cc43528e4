"""What the gate lets through and what it says when it does not."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from navsym.core.arrays import as_array, as_covariance, as_positive, as_probabilities, as_transition
from navsym.core.errors import DomainError, EmptyError, NotFiniteError, ShapeError


def test_the_copy_is_read_only_and_the_callers_array_stays_the_callers():
    mine = np.array([1.0, 2.0])
    theirs = as_array("x", mine, (2,), "one per state")
    mine[0] = 7.0
    assert_array_equal(theirs, [1.0, 2.0])
    with pytest.raises(ValueError, match="read-only"):
        theirs[0] = 3.0
    assert mine.flags.writeable


def test_a_wrong_shape_is_named_with_what_was_expected():
    message = "bounds: expected shape (101,), one entry per measurement; got (100,)"
    with pytest.raises(ShapeError, match=re.escape(message)):
        as_array("bounds", np.ones(100), (101,), "one entry per measurement")


def test_a_size_that_is_not_prescribed_is_free():
    assert as_array("z", np.ones((5, 2)), (None, 2), "steps by measurements").shape == (5, 2)
    with pytest.raises(ShapeError, match=r"\(any, 2\)"):
        as_array("z", np.ones((5, 3)), (None, 2), "steps by measurements")


@pytest.mark.parametrize("value", [[[1.0], [1.0, 2.0]], "abc", [["a"]], [object()], [1j], None, {"a": 1}])
def test_what_is_not_an_array_of_numbers_is_a_shape_error_or_not_finite(value):
    with pytest.raises((ShapeError, NotFiniteError), match=r"^x: expected"):
        as_array("x", value, (1,), "one")


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), -float("inf")])
def test_a_number_that_is_not_finite_is_shown_with_its_place(bad):
    with pytest.raises(NotFiniteError, match=r"index \(1, 0\)"):
        as_array("P", [[1.0, 2.0], [bad, 3.0]], (2, 2), "states by states")


def test_an_integer_beyond_double_precision_is_not_finite():
    with pytest.raises(NotFiniteError, match="larger"):
        as_array("x", [10**400], (1,), "one")


def test_no_entries_are_an_error_of_their_own():
    with pytest.raises(EmptyError, match="no entries"):
        as_array("z", [], (None,), "one per step")


def test_bounds_must_be_positive():
    with pytest.raises(DomainError, match="positive"):
        as_positive("sigma", [1.0, 0.0], (2,), "a bound of a standard deviation")


@given(st.integers(1, 5), st.integers(0, 2**32 - 1))
def test_every_gram_matrix_is_a_covariance(n, seed):
    A = np.random.default_rng(seed).normal(size=(n, n))
    P = as_covariance("P", A @ A.T, n)
    assert_array_equal(P, P.T)
    assert not P.flags.writeable


def test_zero_is_a_covariance():
    assert_array_equal(as_covariance("P", np.zeros((2, 2)), 2), np.zeros((2, 2)))


def test_an_indefinite_or_skew_matrix_is_no_covariance():
    with pytest.raises(DomainError, match="eigenvalue -1"):
        as_covariance("P", np.diag([1.0, -1.0]), 2)
    with pytest.raises(DomainError, match=r"\[0, 1\] = 1.0 against \[1, 0\] = 0.0"):
        as_covariance("P", [[1.0, 1.0], [0.0, 1.0]], 2)
    with pytest.raises(ShapeError, match="square"):
        as_covariance("P", np.ones((2, 3)), None)


def test_probabilities_sum_to_one():
    assert_allclose(as_probabilities("p", [0.25, 0.75]).sum(), 1.0, rtol=0, atol=1e-16)
    with pytest.raises(DomainError, match=r"row 0 sums to 0\.9"):
        as_probabilities("p", [0.5, 0.4])
    with pytest.raises(DomainError, match="negative"):
        as_probabilities("p", [1.5, -0.5])


def test_rows_of_a_mode_transition_mean_from():
    M = as_transition("mode_transition", [[0.9, 0.1], [0.3, 0.7]])
    assert_allclose(M.sum(axis=1), 1.0, atol=1e-15)
    with pytest.raises(DomainError, match=r"row 1 sums to 0\.8"):
        as_transition("mode_transition", np.array([[0.9, 0.1], [0.3, 0.7]]).T)
    with pytest.raises(ShapeError, match="square"):
        as_transition("mode_transition", [[0.5, 0.5]])


@pytest.mark.parametrize("scale", [1e-30, 1.0, 1e30])
def test_a_covariance_is_judged_in_units_of_each_of_its_states(scale):
    with pytest.raises(DomainError, match=r"P: .*eigenvalue -5.*\[1, 1\] = -5"):
        as_covariance("P", [[1e10, 0.0], [0.0, -5.0]], 2)
    for wrong, words in (
        ([[1e10 * scale, 0.0], [0.0, -1e-20]], r"\[1, 1\] = -1e-20"),
        ([[1e10, 1e-3], [1e-3, 1e-18]], "eigenvalue"),
        ([[1e10, 1.0], [0.0, 1.0]], r"\[0, 1\] = 1.0 against \[1, 0\] = 0.0"),
        ([[1.0, 1e-3], [1e-3, 0.0]], "eigenvalue"),
    ):
        with pytest.raises(DomainError, match=words):
            as_covariance("P", wrong, 2)


@given(st.integers(1, 5), st.integers(0, 2**32 - 1))
def test_a_change_of_units_keeps_a_covariance_one(n, seed):
    rng = np.random.default_rng(seed)
    A, unit = rng.normal(size=(n, n)), 10.0 ** rng.integers(-100, 100, n)
    as_covariance("P", A @ A.T * unit * unit[:, None], n)
