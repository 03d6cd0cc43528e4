"""The experiment in small: repeatable, resumable, and with errors in proper units."""

from __future__ import annotations

import json
import math
import os

import numpy as np
import pytest
from numpy.testing import assert_allclose

from navsym.core.errors import DomainError
from navsym_papers.terrain_search.experiment.flights import Setting, course, errors_over, fly, sample_terrain
from navsym_papers.terrain_search.experiment.study import ALGORITHMS, experiment, grounds, read_journal, study
from navsym_papers.terrain_search.experiment.table import as_table, judged, rms_interval

SMALL = Setting(measurements=120, speed=60.0, drift=1.0)


@pytest.fixture(scope="module")
def ground():
    return sample_terrain()


def without_times(document):
    return [{k: v for k, v in row.items() if k != "seconds"} for row in document["rows"]]


def test_the_same_seed_gives_the_same_table(ground):
    first, second = (experiment(ground, settings=[SMALL], tracks=2, runs=1, seed=3) for _ in range(2))
    assert without_times(first) == without_times(second)
    assert [row["algorithm"] for row in first["rows"]] == list(ALGORITHMS)


def test_an_interrupted_run_goes_on_where_it_stopped(ground, tmp_path):
    journal = tmp_path / "runs.jsonl"
    whole = experiment(ground, settings=[SMALL], tracks=2, runs=2, journal=journal)
    lines = journal.read_text().splitlines()
    journal.write_text("\n".join(lines[:2]) + "\n" + lines[2][:40])
    assert len(read_journal(journal)) == 2
    seen = []
    again = experiment(
        ground, settings=[SMALL], tracks=2, runs=2, journal=journal, progress=lambda k, n: seen.append((k, n))
    )
    assert without_times(again) == without_times(whole)
    assert seen == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert len(read_journal(journal)) >= 3
    other = experiment(ground, settings=[SMALL], tracks=2, runs=2, seed=9, journal=journal)
    assert without_times(other) != without_times(whole)


def test_without_noise_and_errors_on_the_grid_the_joint_search_is_exact(ground):
    quiet = Setting(measurements=120, speed=60.0, shift=1e-9, drift=1e-9, altimeter=1e-12)
    rows = {r["algorithm"]: r for r in experiment(ground, settings=[quiet], tracks=1, runs=1)["rows"]}
    assert rows["full"]["rms_position"] < 1e-6 and rows["full"]["rms_velocity"] < 1e-6


def test_the_position_search_is_off_by_about_half_the_drift(ground):
    """terrain_search:bias.mean, within a factor: |deltaV| T/2 in the mean over terrain."""
    drifting = Setting(measurements=240, speed=60.0, drift=2.0)
    rows = {r["algorithm"]: r for r in experiment(ground, settings=[drifting], tracks=3, runs=4)["rows"]}
    expected = 2.0 * math.sqrt(2 / 3) * 120 / 2
    assert 0.4 * expected < rows["position"]["rms_position"] < 2.0 * expected
    assert rows["full, refined"]["rms_position"] < rows["full"]["rms_position"]


def test_accelerometer_errors_are_integrated_twice():
    times = np.arange(2001) / 2.0
    setting = Setting(shift=1e-12, drift=1e-12, accelerometers=True, variance=1e-30)
    position, velocity = errors_over(times, setting, np.random.default_rng(0))
    assert_allclose(velocity[-1], [1.0, 1.0], rtol=1e-9)
    assert_allclose(position[-1], [500.0, 500.0], rtol=1e-9)


def test_the_altimeter_noise_is_relative_to_the_height_above_ground(ground):
    start, heading = course(ground, SMALL, 0, 1)
    setting = Setting(measurements=120, speed=60.0, shift=1e-9, drift=1e-9)
    flight = fly(ground, start, heading, setting, np.random.default_rng(2))
    error = flight.track.h - ground.height(flight.track.x, flight.track.y)
    assert 9.0 < error.std() < 15.0


def test_a_track_longer_than_the_map_is_refused(ground):
    with pytest.raises(DomainError, match="room for a track"):
        experiment(ground, settings=[Setting(speed=400.0)], tracks=1, runs=1)


def test_the_study_of_the_command_line_has_a_table_and_a_verdict_for_every_printed_error(monkeypatch):
    monkeypatch.delenv("NAVSYM_DATA", raising=False)
    monkeypatch.setenv("NAVSYM_CACHE", "/nowhere")
    seen = []
    document = study(runs=1, steps=60, seed=2, progress=lambda k, n: seen.append((k, n)))
    headings, rows = as_table(document)
    assert len(rows) == 4 * len(ALGORITHMS) and all(len(row) == len(headings) for row in rows)
    assert seen[-1] == (20, 20) and document["remarks"]
    assert len(document["verdicts"]) == 4 * 5
    for verdict in document["verdicts"]:
        assert verdict["status"] in ("CONFIRMED", "OPEN") and "95 % interval" in verdict["evidence"]
        assert "simulated altimeter" in verdict["scope"]
    json.dumps(document, allow_nan=False)


def test_a_wide_interval_confirms_nothing_and_a_miss_refutes_nothing():
    row = {"flights": 100, "ground": "one map", "measurements": 9, "speed": 1.0, "drift": 1.0, "accelerometers": False}
    assert str(judged(92.7, 90.0, [80.0, 100.0], "m", row).status) == "CONFIRMED"
    wide, off = judged(92.7, 90.0, [0.0, 150.0], "m", row), judged(92.7, 50.0, [40.0, 60.0], "m", row)
    assert str(wide.status) == str(off.status) == "OPEN"
    assert "too wide" in wide.evidence and "not published" in off.evidence
    assert str(judged(92.7, 90.0, None, "m", row).status) == "OPEN"


def test_with_the_tile_at_hand_the_study_flies_over_one_product_and_matches_the_other():
    if not os.environ.get("NAVSYM_DATA"):
        pytest.skip("the elevation tile is not here: set NAVSYM_DATA")
    (_, sample, same), (name, matched, flown) = grounds()
    assert same is sample and matched is not flown and "NASADEM flown" in name
    document = study(runs=1, steps=60)
    assert {row["ground"] for row in document["rows"]} == {"matplotlib's Jacksboro sample", name}
    assert document["flights"] == 40 and not document["remarks"]


def test_the_interval_covers_the_rms_of_correlated_flights_as_often_as_it_says():
    generator, covered = np.random.default_rng(4), 0
    tracks = np.repeat(np.arange(8), 10)
    for _ in range(400):
        scale = generator.gamma(4.0, 0.25, 8)  # mean square of a track, mean one
        errors = np.sqrt(scale[tracks]) * generator.normal(size=80)
        low, high = rms_interval(errors, tracks)
        covered += low <= 1.0 <= high
    assert 0.88 < covered / 400 < 0.99
    assert rms_interval(errors, np.zeros(80)) is None


def test_the_rows_are_plain_data(ground):
    json.dumps(experiment(ground, settings=[SMALL], tracks=1, runs=1), allow_nan=False)
