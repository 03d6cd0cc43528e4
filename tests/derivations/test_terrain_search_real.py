"""Real elevation: fly over one product, match on another. The altimeter is simulated."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from navsym.terrain.search import search_full
from navsym_papers.terrain_search.experiment.flights import Setting, course, fly, terrain_from
from navsym_papers.terrain_search.experiment.study import GRID, experiment


def product(name):
    """One of the two products of the same tile, when NAVSYM_DATA points to a copy."""
    path = Path(os.environ.get("NAVSYM_DATA", "")) / "dem" / name
    if not os.environ.get("NAVSYM_DATA") or not path.is_file():
        pytest.skip(f"the elevation tile is not here: set NAVSYM_DATA to a folder with dem/{name}")
    return terrain_from(path)


@pytest.fixture(scope="module")
def tiles():
    return product("N44W072_srtm3.hgt"), product("N44W072_nasadem3.hgt")


def test_the_two_products_differ_as_their_description_says(tiles):
    srtm, nasadem = tiles
    difference = srtm.heights - nasadem.heights
    assert abs(abs(difference.mean()) - 4.15) < 0.01
    assert abs(difference.std() - 7.37) < 0.01
    assert np.abs(difference).max() == 92


def test_the_bounded_search_equals_the_dense_search_on_real_relief(tiles):
    srtm, nasadem = tiles
    setting = Setting(measurements=300, speed=70.0)
    for seed in range(3):
        start, heading = course(nasadem, setting, seed, 1)
        track = fly(nasadem, start, heading, setting, np.random.default_rng(seed)).track
        quick, dense = (search_full(srtm, track, GRID, dense=d) for d in (False, True))
        assert (quick.index, quick.criterion, quick.second_best) == (dense.index, dense.criterion, dense.second_best)
        assert quick.share < 0.2


def test_flying_over_one_product_and_matching_on_the_other_works(tiles):
    srtm, nasadem = tiles
    rows = experiment(srtm, nasadem, settings=[Setting(drift=1.0)], tracks=2, runs=2)["rows"]
    found = {row["algorithm"]: row for row in rows}
    assert found["full, refined"]["rms_position"] < 100.0
    assert found["full"]["false_fixes"] == 0
