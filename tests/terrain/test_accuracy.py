"""Accuracy and ambiguity maps against simulated fixes and against terrain with known answers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from navsym.core.errors import DomainError
from navsym.terrain.heights import TerrainMap
from navsym.terrain.search import search_position
from navsym.terrain.track import Hypotheses, Profile
from navsym_papers.terrain_search.experiment.accuracy import accuracy_map, false_fix_bound


def relief(rough=3.0):
    rows, columns = np.mgrid[:90, :100]
    H = 40 * np.sin(columns / 6.0) + 40 * np.cos(rows / 5.0) + 20 * np.sin(rows * columns / 300.0)
    return TerrainMap(H + np.random.default_rng(0).normal(0, rough, H.shape), 0, 0, 10, 10)


def test_on_a_ridge_the_weak_direction_runs_along_it_and_the_risk_is_certain():
    ridge = TerrainMap(np.tile(10 * np.sin(np.arange(100) / 4.0), (90, 1)), 0, 0, 10, 10)
    found = accuracy_map(ridge, 200.0, 0.3, 1.0, places=(5, 5))
    inside = np.isfinite(found.strong)
    assert inside.any() and np.isinf(found.weak[inside]).all()
    assert_allclose(found.direction[inside], math.pi / 2, atol=1e-9)
    assert (found.risk[inside] == 1.0).all()


def test_twice_the_noise_doubles_the_deviation_and_raises_the_risk():
    terrain = relief()
    quiet, loud = (accuracy_map(terrain, 300.0, 0.0, s, places=(6, 6)) for s in (2.0, 4.0))
    inside = np.isfinite(quiet.weak)
    assert_allclose(loud.weak[inside], 2 * quiet.weak[inside], rtol=1e-12)
    assert (loud.risk[inside] >= quiet.risk[inside]).all()


def test_a_longer_profile_about_the_same_middle_is_less_ambiguous():
    terrain = relief()
    short, long = (accuracy_map(terrain, s, 0.0, 5.0, points=int(s / 5), places=(6, 6)) for s in (100.0, 400.0))
    inside = np.isfinite(short.risk) & np.isfinite(long.risk)
    assert inside.any() and long.risk[inside].mean() <= short.risk[inside].mean()


def test_the_bound_covers_the_false_fixes_of_a_simulation():
    terrain = relief(1.0)
    sigma, points = 14.0, 20
    grid = Hypotheses((10, 10), (10, 10))
    found = accuracy_map(terrain, 80.0, 0.0, sigma, points=points, rivals=grid, places=(1, 1), exclusion=35.0)
    cx, cy = found.x[0], found.y[0]
    x, y = cx + 80.0 * (np.arange(points) / (points - 1) - 0.5), np.full(points, cy)
    heights = terrain.height(x, y)
    generator, false = np.random.default_rng(1), 0
    for _ in range(300):
        track = Profile(np.arange(points), x, y, heights + generator.normal(0, sigma, points))
        i, j = search_position(terrain, track, grid).index[:2]
        false += math.hypot(10 * i, 10 * j) >= 35.0
    assert 0.02 < false / 300 <= found.risk[0, 0]


def test_one_rival_has_the_probability_of_the_normal_distribution():
    assert_allclose(false_fix_bound(np.array([4.0, np.inf]), 1.0), 0.15865525393145707, rtol=1e-12)
    assert false_fix_bound(np.zeros(5), 1.0) == 1.0


def test_nonsense_is_refused():
    with pytest.raises(DomainError, match="positive"):
        accuracy_map(relief(), -1.0, 0.0, 1.0)
