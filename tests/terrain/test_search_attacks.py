"""The bounded search where it should break: flat and equal ground, huge and tiny heights, one of everything, voids.

Reference: the dense search in double precision; and, for uniqueness, fractions.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from navsym.core.errors import NavsymError, NotEstimableError
from navsym.terrain.heights import TerrainMap
from navsym.terrain.search import exact_criterion, prepare, search_full, search_position
from navsym.terrain.track import Hypotheses, Profile

GRID = Hypotheses((30, 30), (3, 3), (1, 1), (2, 2))


def rough(seed=0, shape=(60, 70), scale=100.0, base=0.0):
    return base + scale * np.random.default_rng(seed).normal(size=shape)


def straight(terrain, n=30, shift=(30.0, -60.0), velocity=(1.0, 0.0), noise=0.0, seed=1):
    t = np.arange(n, dtype=float)
    x, y = 700 + 10.0 * t, 650 + 7.0 * t
    h = terrain.height(x + shift[0] + velocity[0] * t, y + shift[1] + velocity[1] * t)
    return Profile(t, x, y, h + noise * np.random.default_rng(seed).normal(size=n))


def both(terrain, track, grid=GRID, **options):
    return [search_full(terrain, track, grid, dense=dense, **options) for dense in (False, True)]


def assert_equal(quick, dense):
    assert (quick.index, quick.criterion, quick.second_best, quick.unique) == (
        dense.index,
        dense.criterion,
        dense.second_best,
        dense.unique,
    )


@pytest.mark.parametrize("offset_free", [False, True])
@pytest.mark.parametrize("height", [0.0, 3.0, -417.25, 1e6, 1e-6])
def test_ground_of_one_height_is_a_tie_of_all_and_proved_so(height, offset_free):
    terrain = TerrainMap(np.full((60, 70), height), 0, 0, 30, 30)
    for measured in (height, height + 7.0):
        track = Profile(np.arange(20.0), 700 + np.arange(20.0), np.full(20, 650.0), np.full(20, measured))
        quick, dense = both(terrain, track, offset_free=offset_free)
        assert_equal(quick, dense)
        assert quick.index == (-3, -3, -2, -2) and quick.criterion == quick.second_best
        assert quick.unique is False


@pytest.mark.parametrize("scale", [1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e12])
@pytest.mark.parametrize("offset_free", [False, True])
def test_heights_of_every_size_give_the_dense_answer(scale, offset_free):
    terrain = TerrainMap(rough(scale=scale), 0, 0, 30, 30)
    for seed in range(4):
        quick, dense = both(terrain, straight(terrain, noise=0.3 * scale, seed=seed), offset_free=offset_free)
        assert_equal(quick, dense)
        assert quick.unique is True


@pytest.mark.parametrize("base", [1e3, 1e6, 1e9, 1e12])
@pytest.mark.parametrize("offset_free", [False, True])
def test_relief_on_a_high_plateau_where_single_precision_sees_none(base, offset_free):
    """At a base of 1e9 and above, single precision cannot tell the relief at all: everything must survive."""
    terrain = TerrainMap(rough(scale=1.0, base=base), 0, 0, 30, 30)
    for seed in range(3):
        quick, dense = both(terrain, straight(terrain, noise=0.1, seed=seed), offset_free=offset_free)
        assert_equal(quick, dense)


def test_beyond_the_usual_heights_the_dense_search_answers():
    terrain = TerrainMap(rough(scale=1e-13), 0, 0, 30, 30)
    assert_equal(*both(terrain, straight(terrain)))


def test_ties_that_rounding_hides_are_settled_by_fractions():
    """A map that repeats: two hypotheses see the same heights, at positions that round differently."""
    row = np.random.default_rng(3).normal(size=7)
    terrain = TerrainMap(np.tile(row, (60, 10)), 0, 0, 0.1, 0.1)
    t = np.arange(12, dtype=float)
    track = Profile(t, 2.03 + 0.01 * t, np.full(12, 2.0), terrain.height(2.03 + 0.01 * t, np.full(12, 2.0)))
    grid = Hypotheses((0.7, 0.1), (1, 0), (0.01, 0.01), (1, 0))
    quick, dense = both(terrain, track, grid)
    assert (quick.index, quick.criterion, quick.second_best) == (dense.index, dense.criterion, dense.second_best)
    prepared = prepare(terrain, track, grid)
    exact = [exact_criterion(prepared, (i, 0, 0, 0)) for i in (-1, 0, 1)]
    assert quick.unique is (None if len(set(exact)) == 3 else False)
    assert max(float(q) for q in exact) < 1e-20


@pytest.mark.long
@pytest.mark.parametrize("kind", ["rounded", "integers", "steps"])
def test_unique_is_never_claimed_for_a_tie_nor_a_tie_for_a_difference(kind):
    for seed in range(30):
        generator = np.random.default_rng(seed)
        H = generator.integers(0, 3, (40, 40)).astype(float)
        if kind == "rounded":
            H *= 0.1
        elif kind == "steps":
            H = np.tile(H[:4, :4], (10, 10))
        terrain = TerrainMap(H, 0, 0, 1, 1)
        t = np.arange(6, dtype=float)
        x, y = generator.integers(14, 24, 6).astype(float), generator.integers(14, 24, 6).astype(float)
        track = Profile(t, x, y, terrain.height(x + 1, y - 1))
        quick, dense = both(terrain, track, Hypotheses((1, 1), (2, 2), (1, 1), (1, 1)))
        assert_equal(quick, dense)
        prepared = prepare(terrain, track, Hypotheses((1, 1), (2, 2), (1, 1), (1, 1)))
        span = [(i, j, v, w) for i in range(-2, 3) for j in range(-2, 3) for v in (-1, 0, 1) for w in (-1, 0, 1)]
        exact = sorted(
            exact_criterion(prepared, index)
            for index in span
            if all(0 <= x[k] + index[0] + index[2] * k <= 39 for k in range(6))
            and all(0 <= y[k] + index[1] + index[3] * k <= 39 for k in range(6))
        )
        if exact[0] == exact[1]:
            assert quick.unique is not True
        else:
            assert quick.unique is not False


def test_one_of_everything():
    terrain = TerrainMap(rough(shape=(2, 2)), 0, 0, 30, 30)
    t = np.arange(5, dtype=float)
    track = Profile(t, 3 + 5 * t, 20 - 3 * t, np.zeros(5))
    alone = Hypotheses((30, 30), (0, 0), (1, 1), (0, 0))
    quick, dense = both(terrain, track, alone)
    assert_equal(quick, dense)
    assert quick.index == (0, 0, 0, 0) and math.isinf(quick.second_best) and quick.unique is True
    for n in (1, 2, 3):
        with pytest.raises(NotEstimableError):
            search_full(terrain, Profile(t[:n], t[:n], t[:n], t[:n]), GRID)
    with pytest.raises(NotEstimableError):
        search_position(terrain, Profile(t[:1], t[:1], t[:1], t[:1]), GRID)
    few = Profile(t[:2], t[:2] + 3, t[:2] + 3, np.zeros(2))
    assert search_position(terrain, few, GRID).index == search_position(terrain, few, GRID, dense=True).index


@pytest.mark.parametrize("offset_free", [False, True])
@pytest.mark.parametrize("void", [float("nan"), -9999.0, 0.0])
def test_voids_and_borders_give_the_dense_answer_and_are_never_chosen(void, offset_free):
    for seed in range(12):
        generator = np.random.default_rng(seed)
        H = rough(seed, shape=(45, 45))
        holes = generator.random(H.shape) < 0.01
        H[holes] = void
        terrain = TerrainMap(H, 0, 0, 30, 30, nodata=void)
        t = np.arange(20, dtype=float)
        x, y = 560 + 8.0 * t + 30 * generator.integers(-9, 9), 620 + 5.0 * t
        track = Profile(t, x, y, 100 * generator.normal(size=20))
        try:
            quick, dense = both(terrain, track, offset_free=offset_free)
        except NavsymError as error:
            assert error.kind == "nodata"
            continue
        assert_equal(quick, dense)
        i, j, v, w = quick.index
        seen = terrain.sample(x + 30 * i + v * t, y + 30 * j + w * t)[1]
        assert not seen.any()


def test_nan_among_heights_is_refused_unless_it_means_none():
    H = rough(shape=(10, 10))
    H[3, 3] = np.nan
    with pytest.raises(NavsymError) as caught:
        TerrainMap(H, 0, 0, 30, 30)
    assert caught.value.kind == "not-finite"
