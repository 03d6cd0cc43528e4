"""The sums of slopes: twins, extremes and means against independent computations."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from navsym.core.errors import NotEstimableError
from navsym.terrain.centre import demand_estimable, information, slopes
from navsym.terrain.heights import TerrainMap
from tests.twins.terrain import quadratic_slowly

tracks = st.integers(3, 30).flatmap(
    lambda n: st.tuples(
        st.lists(st.floats(-2, 2).map(lambda v: round(v, 3)), min_size=n, max_size=n),
        st.lists(st.floats(-2, 2).map(lambda v: round(v, 3)), min_size=n, max_size=n),
    )
)


@given(tracks)
@settings(max_examples=80)
def test_the_double_sums_are_products_of_single_sums(track):
    gx, gy = map(np.array, track)
    info = information(gx, gy, np.arange(gx.size, dtype=float))
    scale = 1e-9 * (1 + gx.size**3)
    assert_allclose(info.quadratic, quadratic_slowly(gx, gy, np.arange(gx.size)), atol=scale)


@given(tracks)
@settings(max_examples=80)
def test_the_interval_is_the_range_of_the_eigenvalues_and_of_all_directions(track):
    gx, gy = map(np.array, track)
    info = information(gx, gy, np.arange(gx.size, dtype=float))
    assume(np.linalg.eigvalsh(info.G)[0] > 1e-3)
    low, high = info.interval
    assert_allclose(sorted(np.linalg.eigvals(info.centre).real), [low, high], atol=1e-6 * gx.size)
    angles = np.linspace(0, np.pi, 181)
    times = [info.time_of((np.cos(a), np.sin(a))) for a in angles]
    assert min(times) >= low - 1e-9 * gx.size and max(times) <= high + 1e-9 * gx.size
    assert low + 1e-9 >= 0 and high <= gx.size - 1 + 1e-9


@given(tracks)
@settings(max_examples=40)
def test_the_mean_time_is_the_mean_over_directions(track):
    gx, gy = map(np.array, track)
    info = information(gx, gy, np.arange(gx.size, dtype=float))
    values = np.linalg.eigvalsh(info.G)
    assume(values[0] >= max(1e-2 * values[1], 1e-9))
    # The trapezoidal rule converges geometrically for a periodic function.
    angles = np.arange(2000) * np.pi / 2000
    mean = np.mean([info.time_of((np.cos(a), np.sin(a))) for a in angles])
    assert_allclose(info.mean_time, mean, rtol=1e-9)


def test_where_the_quadratic_vanishes_the_quotient_is_extreme():
    generator = np.random.default_rng(0)
    info = information(generator.normal(size=30), generator.normal(size=30), np.arange(30.0))
    A2, A1, A0 = info.quadratic
    roots = np.roots([A2, A1, A0])
    assert_allclose(sorted(info.time_of((r, 1.0)) for r in roots), info.interval, rtol=1e-9)


def test_slopes_of_a_quadratic_surface_are_exact():
    rows, columns = np.mgrid[:20, :30]
    terrain = TerrainMap(3.0 * columns**2 - 2.0 * rows**2 + rows * columns, 0, 0, 2, 4)
    x, y = np.array([0.0, 7.3, 31.9, 58.0]), np.array([0.0, 11.1, 40.0, 76.0])
    u, w = x / 2, y / 4
    gx, gy = slopes(terrain, x, y)
    assert_allclose(gx, (6 * u + w) / 2, atol=1e-9)
    assert_allclose(gy, (-4 * w + u) / 4, atol=1e-9)


def test_unknown_slopes_are_left_out():
    full = information(np.array([1.0, 2.0, 3.0]), np.array([0.0, 1.0, 1.0]), np.array([0.0, 1.0, 2.0]))
    holed = information(
        np.array([1.0, 2.0, np.nan, 3.0]), np.array([0.0, 1.0, 5.0, 1.0]), np.array([0.0, 1.0, 9.0, 2.0])
    )
    assert_allclose(holed.G, full.G)
    assert_allclose(holed.M1, full.M1)


def test_one_slope_direction_is_not_estimable():
    with pytest.raises(NotEstimableError, match=r"none along \(-?0.4472, -?0.8944\)|none along"):
        demand_estimable(information(np.array([2.0, 4.0]), np.array([-1.0, -2.0]), np.array([0.0, 1.0])))
