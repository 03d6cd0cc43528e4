"""The fewest further measurements: known answers, an independent exact route on random systems, and bad input."""

from itertools import combinations

import numpy as np
import pytest
import sympy as sp

from navsym.core.errors import EmptyError, ShapeError, TooLargeError
from navsym.models.linear import LinearModel
from navsym.observability.sensors import restore_observability


def rank_slowly(F: sp.Matrix, rows: sp.Matrix) -> int:
    """Rank of the observability matrix in fractions."""
    return sp.Matrix.vstack(*(rows * F**k for k in range(F.rows))).rank()


def test_two_unseen_constants_need_two_measurements_whatever_they_are() -> None:
    """Position measured; a bias of each of two other channels is never seen."""
    F = [[0, 1, 0, 0], *([[0, 0, 0, 0]] * 3)]
    model = LinearModel(F, None, [[1, 0, 0, 0]], ("x", "v", "b", "c"))
    answer = restore_observability(model)
    assert (answer.unobservable, answer.needed, answer.sets, answer.proved) == (2, 2, (("b", "c"),), True)


def test_one_measurement_shows_two_hidden_states_that_move_apart() -> None:
    a = sp.Symbol("a")
    model = LinearModel([[0, 0, 0], [0, a, 0], [0, 0, 2 * a]], None, [[1, 0, 0]], ("x", "u", "w"))
    both = restore_observability(model, {"sum": [0, 1, 1], "u": [0, 1, 0], "w": [0, 0, 1]})
    assert (both.unobservable, both.needed, both.sets, both.proved) == (2, 0, (("sum",),), True)
    states = restore_observability(model)
    assert states.sets == (("u", "w"),)
    assert states.proved


def test_a_coupling_of_1e_15_is_seen_and_an_observable_model_needs_nothing() -> None:
    model = LinearModel([[0, sp.Rational(1, 10**15)], [0, 0]], None, [[1, 0]])
    answer = restore_observability(model)
    assert (answer.unobservable, answer.fewest, answer.proved) == (0, 0, True)


def test_candidates_that_are_all_too_little_are_called_so_with_proof() -> None:
    model = LinearModel([[0, 0, 0]] * 3, None, [[1, 0, 0]], ("x", "y", "z"))
    answer = restore_observability(model, {"y": [0, 1, 0], "again": [0, 2, 0], "x": [1, 0, 0]})
    assert (answer.needed, answer.fewest, answer.proved) == (2, None, True)


def test_random_systems_agree_with_every_combination_in_fractions() -> None:
    rng = np.random.default_rng(11)
    for _ in range(25):
        n = int(rng.integers(2, 5))
        F = sp.Matrix(rng.integers(-1, 2, (n, n)) * (rng.random((n, n)) < 0.4))
        H = sp.zeros(1, n)
        H[int(rng.integers(n))] = 1
        answer = restore_observability(LinearModel(F, None, H))
        assert answer.unobservable == n - rank_slowly(F, H)
        names = [f"x{i + 1}" for i in range(n)]
        for size in range(n + 1):
            good = tuple(
                tuple(names[i] for i in places)
                for places in combinations(range(n), size)
                if rank_slowly(F, sp.Matrix.vstack(H, sp.eye(n).extract(list(places), list(range(n))))) == n
            )
            if good:
                break
        assert answer.sets == good
        assert answer.proved
        assert answer.needed <= size


def test_candidates_that_cannot_be_measured_are_refused_with_a_sentence() -> None:
    model = LinearModel([[0, 1], [0, 0]], None, [[0, 1]])
    with pytest.raises(ShapeError, match=r"short: expected 2 entries.*got 1"):
        restore_observability(model, {"short": [1]})
    with pytest.raises(EmptyError, match="got none"):
        restore_observability(model, {})
    with pytest.raises(TooLargeError, match="fewer candidates"):
        restore_observability(
            LinearModel(sp.zeros(24), None, [[1] * 24]), {f"c{k}": [k**i for i in range(24)] for k in range(30)}
        )
