"""Maps, tracks and grids: exact cells, flags instead of heights, and messages that help."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from navsym.core.errors import (
    DomainError,
    DuplicateError,
    EmptyError,
    NoDataError,
    NotFiniteError,
    OutsideMapError,
    ShapeError,
    TooLargeError,
)
from navsym.terrain.heights import NO_DATA, OFF_MAP, ON_MAP, TerrainMap
from navsym.terrain.track import Hypotheses, Profile

PLANE = TerrainMap([[0, 2, 4], [10, 12, 14], [20, 22, 24]], 100.0, 200.0, 5.0, 4.0)


@given(st.floats(0, 10), st.floats(0, 8))
def test_a_plane_is_interpolated_exactly(x, y):
    assert_allclose(PLANE.height(100 + x, 200 + y), 2 * x / 5 + 10 * y / 4, atol=1e-11)


def test_a_node_is_its_own_height_up_to_the_last_corner():
    for row in range(3):
        for column in range(3):
            assert PLANE.height(100 + 5 * column, 200 + 4 * row) == PLANE.heights[row, column]


def test_the_surface_is_continuous_across_cells():
    rough = TerrainMap(np.random.default_rng(0).normal(size=(6, 7)), 0, 0, 1, 1)
    for x in range(1, 6):
        left, right = rough.height(x - 1e-9, 2.3), rough.height(x + 1e-9, 2.3)
        assert abs(left - right) < 1e-7


def test_positions_off_the_map_have_a_flag_and_no_height():
    heights, flags = PLANE.sample([99.999, 105, 110.001, 105], [204, 199.9, 204, 204])
    assert_array_equal(flags, [OFF_MAP, OFF_MAP, OFF_MAP, ON_MAP])
    assert np.isnan(heights[:3]).all()


def test_a_void_is_never_blended_and_its_neighbours_on_nodes_keep_their_height():
    H = np.array([[1.0, 2.0, 3.0], [4.0, -32768.0, 6.0], [7.0, 8.0, 9.0]])
    holed = TerrainMap(H, 0, 0, 1, 1, nodata=-32768)
    heights, flags = holed.sample([1, 0.5, 1, 1.5, 0, 2, 2, 0.5], [1, 0.5, 0, 0, 1, 1, 2, 2])
    assert_array_equal(flags, [NO_DATA, NO_DATA, *[ON_MAP] * 6])
    assert_array_equal(heights[2:], [2, 2.5, 4, 6, 9, 7.5])
    with pytest.raises(NoDataError, match=r"void at \(1, 1\), point 0 \(1 of 1\)"):
        holed.height(1, 1)


def test_an_exchange_of_axes_is_suspected():
    wide = TerrainMap(np.zeros((3, 20)), 0, 0, 1, 1)
    with pytest.raises(OutsideMapError, match="x and y look exchanged"):
        wide.height([1.0, 2.0], [10.0, 15.0])


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"dx": -5.0}, DomainError, "positive spacing; got -5; reverse"),
        ({"dy": 0.0}, DomainError, "positive spacing"),
        ({"x0": float("nan")}, DomainError, "x0: expected a finite number"),
        ({"x0": "one"}, DomainError, "x0: expected a finite number"),
        ({"heights": [[1.0, float("nan")], [1.0, 1.0]]}, NotFiniteError, "got nan"),
        ({"heights": [[1.0, 2.0]]}, ShapeError, "2 x 2"),
        ({"heights": [[1.0, 2.0], [3.0]]}, ShapeError, "expected numbers"),
        ({"heights": [["a", "b"], ["c", "d"]]}, ShapeError, "expected numbers"),
        ({"heights": [[True, False], [True, True]]}, ShapeError, "expected numbers"),
        ({"heights": []}, EmptyError, "no entries"),
        ({"heights": [1.0, 2.0]}, ShapeError, r"expected shape \(any, any\)"),
        ({"heights": [[5, 5], [5, 5]], "nodata": 5}, NoDataError, "only voids"),
        ({"heights": [[1, 2], [-32768, 4]]}, NoDataError, r"got -32768 at \(1, 0\), a usual mark of none; .* nodata"),
    ],
)
def test_a_wrong_map_is_refused(changes, error, message):
    given_values = {"heights": [[1, 2], [3, 4]], "x0": 0, "y0": 0, "dx": 1, "dy": 1, "nodata": None}
    with pytest.raises(error, match=message):
        TerrainMap(**{**given_values, **changes})


def test_the_array_of_the_caller_stays_his():
    H = np.zeros((3, 3))
    terrain = TerrainMap(H, 0, 0, 1, 1)
    H[0, 0] = 7.0
    assert terrain.heights[0, 0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        terrain.heights[0, 0] = 1.0


@pytest.mark.parametrize(
    ("t", "error", "message"),
    [
        ([0, 1, 1], DuplicateError, "entries 1 and 2"),
        ([0, 2, 1], DomainError, "increasing"),
        ([0, 1], ShapeError, r"expected shape \(2,\)"),
        ([0, 1, float("inf")], NotFiniteError, "inf"),
        ([], EmptyError, "no entries"),
    ],
)
def test_a_wrong_track_is_refused(t, error, message):
    with pytest.raises(error, match=message):
        Profile(t, [0, 1, 2], [0, 1, 2], [5, 5, 5])


def test_a_grid_counts_its_hypotheses():
    grid = Hypotheses((50, 50), (20, 20), (1, 1), (5, 5))
    assert grid.counts == (41, 41, 11, 11) and grid.size == 41 * 41 * 11 * 11
    assert grid.position_only.size == 41 * 41


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (((0, 1), (1, 1)), DomainError, r"step\[0\]: expected a positive step"),
        (((1, 1), (-1, 1)), DomainError, r"half_count\[0\]"),
        (((1, 1), (1.5, 1)), DomainError, "integer"),
        (((1, 1), (True, 1)), DomainError, "finite number"),
        ((1, (1, 1)), ShapeError, "two entries"),
        (((1, 1), (9000, 9000)), TooLargeError, "18001 x 18001 x 1 x 1 = 324036001"),
    ],
)
def test_a_wrong_grid_is_refused(arguments, error, message):
    with pytest.raises(error, match=message):
        Hypotheses(*arguments)
