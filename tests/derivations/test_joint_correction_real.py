"""The recorded flight, and a made one of the same kind that is always at hand."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from navsym.core.errors import DomainError, EmptyError, NotFiniteError, ShapeError, UnknownSymbolError
from navsym.observability.chains import observe_jointly
from navsym.observability.splits import choose_split
from navsym_papers.joint_correction.experiment.flight import EARTH_RADIUS
from navsym_papers.joint_correction.experiment.real import (
    FIELDS,
    aiding_model,
    aiding_observer,
    kalman_estimates,
    outage_errors,
    reckon,
    two_stage_estimates,
)


def made_record(seconds: int = 240, bias: float = 0.02) -> dict[str, np.ndarray]:
    """A straight level flight to the north with a constant accelerometer error, GPS once a second."""
    count = 50 * seconds
    t = np.arange(count) / 50.0
    fix = np.floor(t)
    north = 20.0 * fix
    return {
        "time": t,
        "ax": np.full(count, bias),
        "ay": np.zeros(count),
        "az": np.full(count, -9.8),
        "phi": np.zeros(count),
        "theta": np.zeros(count),
        "psi": np.full(count, 1e-12),
        "vn": np.full(count, 20.0),
        "ve": np.zeros(count),
        "lat": 45.0 + np.degrees(north / EARTH_RADIUS),
        "lon": np.full(count, -93.0),
        "GPS_TOW": 1000.0 + fix,
    }


def test_the_split_of_the_aiding_model_is_that_of_the_paper():
    chosen = choose_split(observe_jointly(aiding_model()))
    assert (chosen.i, chosen.j) == (2, 1)
    poles = np.linalg.eigvals(
        aiding_observer(0.2, 0.5).G_x - np.outer(aiding_observer(0.2, 0.5).K_x, aiding_observer(0.2, 0.5).g_x)
    )
    assert np.allclose(poles, [-0.2, -0.2], atol=1e-6)


def test_reckoning_a_biased_accelerometer_drifts_with_the_square_of_time():
    aided = reckon(made_record())
    t = aided.t - aided.t[0]
    assert np.abs(aided.velocity[:, 0] - 0.02 * t).max() < 1e-3
    assert np.abs(aided.position[:, 0] - 0.01 * t**2).max() < 0.05 * t.max() / 10


def test_both_estimators_find_a_constant_bias():
    aided = reckon(made_record())
    for estimates in (two_stage_estimates(aided, 0), kalman_estimates(aided, 0)):
        assert abs(estimates[-1, 2] - 0.02) < 2e-3
        assert abs(estimates[-1, 0] - aided.position[-1, 0]) < 0.3


def test_one_bad_entry_is_named_and_does_not_spoil_the_flight_in_silence():
    """A force of NaN once made every later reckoning NaN, and times that went back were integrated backwards."""
    spoilt = made_record()
    spoilt["ax"][700] = np.nan
    with pytest.raises(NotFiniteError, match=r"ax: expected finite numbers; got nan at index \(700,\)"):
        reckon(spoilt)
    reversed_times = made_record()
    reversed_times["time"] = reversed_times["time"][::-1]
    with pytest.raises(DomainError, match="time: expected no time before the one above it"):
        reckon(reversed_times)
    short = made_record()
    short["ve"] = short["ve"][:-1]
    with pytest.raises(ShapeError, match="ve: expected shape"):
        reckon(short)


def test_a_flight_across_the_date_line_is_any_other_flight():
    here, there = made_record(), made_record()
    east = np.arange(len(here["lon"])) * 1e-7
    here["lon"], there["lon"] = 10.0 + east, (179.9999 + east + 180.0) % 360.0 - 180.0
    assert np.allclose(reckon(here).position, reckon(there).position, atol=1e-3)


def test_missing_columns_and_missing_fixes_are_named():
    record = made_record(10)
    with pytest.raises(UnknownSymbolError, match="psi"):
        reckon({k: v for k, v in record.items() if k != "psi"})
    with pytest.raises(EmptyError, match="GPS fixes"):
        reckon({**record, "GPS_TOW": np.zeros_like(record["time"])})


def recorded() -> dict[str, np.ndarray]:
    """The real flight, when NAVSYM_DATA points to a copy."""
    folder = os.environ.get("NAVSYM_DATA")
    path = Path(folder or "") / "gnss_ins" / "umn_thor_flight75.mat"
    if not folder or not path.exists():
        pytest.skip("the recorded flight is not here: set NAVSYM_DATA to a folder with gnss_ins/umn_thor_flight75.mat")
    from scipy.io import loadmat

    flight = loadmat(path)["flight_data"][0, 0]
    return {name: flight[name].ravel() for name in FIELDS}


def test_two_stages_stay_within_a_quarter_of_the_kalman_filter_on_the_real_flight():
    aided = reckon(recorded())
    two = tuple(two_stage_estimates(aided, axis, 0.3, 0.3) for axis in (0, 1))
    kalman = tuple(kalman_estimates(aided, axis) for axis in (0, 1))
    for horizon in (1, 5, 10):
        ours, theirs = (np.sqrt((outage_errors(aided, e, horizon) ** 2).mean()) for e in (two, kalman))
        assert ours < 1.25 * theirs, horizon
