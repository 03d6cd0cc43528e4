"""Searches over a map: what they find, when they refuse, and what the sequential estimate is."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from navsym.core.errors import NoDataError, NotEstimableError, OutsideMapError
from navsym.terrain.heights import TerrainMap
from navsym.terrain.refine import refine
from navsym.terrain.search import criteria, exact_criterion, prepare, search_full, search_position
from navsym.terrain.sequential import search_sequential
from navsym.terrain.track import Hypotheses, Profile

GRID = Hypotheses((30, 30), (4, 4), (1, 1), (3, 3))


def relief(seed=0, shape=(70, 80), spacing=30.0):
    """A smooth random surface with some roughness."""
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    H = 150 * np.sin(columns / 6.3) * np.cos(rows / 5.1) + 60 * np.sin((rows * columns) / 170.0)
    return TerrainMap(H + np.random.default_rng(seed).normal(0, 2, shape), 0, 0, spacing, spacing)


def flight(terrain, shift=(60.0, -30.0), velocity=(1.0, -2.0), noise=0.0, n=41, seed=1):
    """A track whose inertial positions lack ``shift`` and ``velocity``."""
    t = np.arange(n, dtype=float)
    x, y = 700 + 25 * t, 600 + 15 * t
    h = terrain.height(x + shift[0] + velocity[0] * t, y + shift[1] + velocity[1] * t)
    return Profile(t, x, y, h + noise * np.random.default_rng(seed).normal(size=n))


def test_the_true_hypothesis_is_found_and_unique():
    terrain = relief()
    found = search_full(terrain, flight(terrain, noise=1.0), GRID)
    assert found.index == (2, -1, 1, -2) and found.unique is True
    assert found.criterion < found.second_best


def test_bounding_returns_what_the_dense_search_returns():
    terrain = relief()
    for seed in range(6):
        track = flight(terrain, noise=20.0, seed=seed)
        quick, dense = (search_full(terrain, track, GRID, dense=d) for d in (False, True))
        assert (quick.index, quick.criterion, quick.second_best) == (dense.index, dense.criterion, dense.second_best)


def test_two_threads_add_up_the_same():
    terrain = relief()
    prepared = prepare(terrain, flight(terrain), GRID)
    assert_array_equal(criteria(prepared, threads=2), criteria(prepared))


def test_the_criterion_is_the_sum_of_squares_of_the_paper():
    terrain = relief()
    track = flight(terrain, noise=5.0)
    values = criteria(prepare(terrain, track, GRID))
    i, j, Vi, Vj = 1, -2, 3, -1
    mapped = terrain.height(track.x + 30 * i + Vi * track.t, track.y + 30 * j + Vj * track.t)
    assert_allclose(values[Vi + 3, Vj + 3, j + 4, i + 4], ((track.h - mapped) ** 2).sum(), rtol=1e-12)


def test_the_rational_criterion_is_the_double_one_up_to_rounding():
    terrain = relief()
    prepared = prepare(terrain, flight(terrain, noise=5.0), GRID)
    exact = exact_criterion(prepared, (1, -2, 3, -1))
    assert isinstance(exact, Fraction)
    assert_allclose(float(exact), criteria(prepared)[6, 2, 2, 5], rtol=1e-12)


def test_a_periodic_terrain_has_two_best_positions_and_says_so():
    H = np.tile(np.array([[0.0, 5.0, 1.0, 3.0], [2.0, 9.0, 4.0, 7.0], [8.0, 0.0, 6.0, 2.0]]), (8, 9))
    terrain = TerrainMap(H, 0, 0, 1, 1)
    t = np.arange(6.0)
    track = Profile(t, 10 + t, 9 + 0 * t, terrain.height(10 + t, 9 + 0 * t))
    found = search_position(terrain, track, Hypotheses((1, 1), (5, 0)))
    assert found.criterion == found.second_best == 0.0 and found.unique is False
    assert found.index[0] == -4


def test_hypotheses_that_leave_the_map_are_never_chosen():
    terrain = relief()
    track = flight(terrain)
    near = Profile(track.t, track.x - 690, track.y, track.h)
    found = search_position(terrain, near, GRID, dense=True)
    values = found.criteria[0, 0]
    assert np.isinf(values[:, :4]).all() and np.isfinite(values[:, 4:]).all()
    assert np.isfinite(found.criterion)


def test_a_void_under_a_hypothesis_excludes_it_and_under_the_track_is_an_error():
    terrain = relief()
    H = np.array(terrain.heights)
    track = flight(terrain)
    row, column = int((track.y[20] + 90) / 30), int((track.x[20] + 30) / 30)
    H[row, column] = -9999
    holed = TerrainMap(H, 0, 0, 30, 30, nodata=-9999)
    values = search_position(holed, track, GRID, dense=True).criteria[0, 0]
    assert np.isinf(values).any() and np.isfinite(values[4, 4])
    H[int(track.y[20] / 30), int(track.x[20] / 30)] = -9999
    with pytest.raises(NoDataError):
        search_position(TerrainMap(H, 0, 0, 30, 30, nodata=-9999), track, GRID)


def test_a_track_off_the_map_is_refused():
    terrain = relief()
    track = flight(terrain)
    with pytest.raises(OutsideMapError, match="41 of 41 off the map"):
        search_full(terrain, Profile(track.t, track.x - 1e5, track.y, track.h), GRID)


@pytest.mark.parametrize(("search", "least"), [(search_position, 2), (search_full, 4), (search_sequential, 4)])
def test_too_few_measurements_are_refused(search, least):
    terrain = relief()
    track = flight(terrain, n=least - 1)
    with pytest.raises(NotEstimableError, match=f"at least {least}"):
        search(terrain, track, GRID)


def test_flat_ground_is_not_estimable_and_a_ridge_names_its_direction():
    t = np.arange(20.0)
    for H, message in (
        (np.full((40, 50), 7.0), "flat ground"),
        (np.tile(np.sin(np.arange(50.0)), (40, 1)), r"none along \(-?0.0000, -?1.0000\)"),
        (np.add.outer(np.arange(40.0), np.arange(50.0)) ** 2, r"along \(-?0.7071, -?0.7071\)"),
    ):
        terrain = TerrainMap(H, 0, 0, 1, 1)
        track = Profile(t, 10 + t, 10 + 0.5 * t, terrain.height(10 + t, 10 + 0.5 * t))
        with pytest.raises(NotEstimableError, match=message):
            search_sequential(terrain, track, Hypotheses((1, 1), (2, 2), (0.1, 0.1), (1, 1)))


def test_a_constant_height_error_does_not_move_the_offset_free_fix():
    terrain = relief()
    track = flight(terrain, noise=1.0)
    raised = Profile(track.t, track.x, track.y, track.h + 80.0)
    assert search_full(terrain, raised, GRID).index != (2, -1, 1, -2)
    assert search_full(terrain, raised, GRID, offset_free=True).index == (2, -1, 1, -2)


# The sequential search


def ridges_across_then_along():
    """Ridges that show x in the first half of the map and y in the second."""
    rows, columns = np.mgrid[:80, :160]
    H = np.where(columns < 80, 100 * np.sin(columns / 4.0), 100 * np.sin(rows / 4.0))
    return TerrainMap(H + 2 * np.sin((rows + columns) / 5.0), 0, 0, 100, 100)


def test_an_instant_shrinks_the_velocity_and_the_matrix_centre_does_not():
    """terrain_search:sequential.shrinks and :sequential.exact, seen in numbers."""
    terrain = ridges_across_then_along()
    grid = Hypotheses((2, 2), (20, 20), (0.05, 0.05), (20, 20))
    t = np.arange(120.0)
    x, y = 1500 + 105 * t, 2000 + 33 * t
    for velocity in ((0.4, 0.3), (-0.3, 0.4)):
        h = terrain.height(x + 3 + velocity[0] * t, y - 4 + velocity[1] * t)
        track = Profile(t, x, y, h)
        printed, exact = (search_sequential(terrain, track, grid, improved=how) for how in (False, True))
        assert_allclose(exact.velocity, velocity, atol=0.051)
        assert np.linalg.norm(printed.velocity) < 0.8 * np.linalg.norm(velocity)
        assert printed.t_G[1] - printed.t_G[0] > 40


def test_the_printed_solution_is_the_formula_of_the_paper():
    terrain = relief()
    track = flight(terrain, noise=1.0)
    found = search_sequential(terrain, track, GRID)
    i, j, Vi, Vj = found.index
    low, high, middle = found.t_G
    assert low <= middle <= high and low >= 0 and high <= 40
    assert_allclose(found.shift, [30 * i + Vi * (40 - middle), 30 * j + Vj * (40 - middle)], rtol=1e-12)
    assert_array_equal(found.velocity, [Vi, Vj])
    assert found.evaluated == 81 + 49


def test_refinement_reaches_the_true_correction_between_grid_points():
    terrain = relief()
    track = flight(terrain, shift=(47.0, -38.0), velocity=(0.7, -1.6))
    start = search_full(terrain, track, GRID)
    fine = refine(terrain, track, (30.0 * start.index[0], 30.0 * start.index[1]), start.index[2:])
    assert fine.criterion < 1e-6
    assert_allclose([*fine.position, *fine.velocity], [47, -38, 0.7, -1.6], atol=1e-4)


def test_a_height_offset_is_estimated_on_request():
    terrain = relief()
    track = flight(terrain)
    raised = Profile(track.t, track.x, track.y, track.h + 25.0)
    fine = refine(terrain, raised, (60.0, -30.0), (1.0, -2.0), offset=True)
    assert_allclose(fine.offset, 25.0, atol=1e-3)
