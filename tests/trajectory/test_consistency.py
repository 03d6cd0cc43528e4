"""NIS, NEES and their bands, against quantiles and simulated errors; the reference's own faults are named."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.stats import chi2

import navsym as nav
from navsym.core.errors import NavsymError
from navsym.trajectory.consistency import band, compare, consistency_of, independent


@pytest.mark.parametrize("count", [10.0, 100.0, 3000.0])
def test_the_band_is_that_of_chi_squared(count: float) -> None:
    assert_allclose(band(count), chi2.ppf([0.025, 0.975], count) / count, rtol=0.02)


def correlated(seed: int, rows: int, kept: float) -> np.ndarray:
    """Normal errors (rows, 3) of variance one whose neighbours have the correlation ``kept``."""
    rng = np.random.default_rng(seed)
    out = rng.normal(size=(rows, 3))
    for k in range(1, rows):
        out[k] = kept * out[k - 1] + np.sqrt(1 - kept**2) * out[k]
    return out


def test_the_band_of_correlated_errors_holds_and_that_of_independent_ones_would_not() -> None:
    """Of two hundred series with true deviations, about 95 % lie in their bands; bands for all rows hold far fewer."""
    found = [consistency_of(correlated(seed, 400, 0.9)) for seed in range(200)]
    assert 0.88 <= np.mean([value.holds for value in found]) <= 0.99
    low, high = band(1200.0)
    assert np.mean([low <= value.mean <= high for value in found]) < 0.7
    halved = [consistency_of(2 * correlated(seed, 400, 0.9)) for seed in range(50)]
    assert not any(value.holds for value in halved)


def test_a_series_of_ar_1_is_worth_what_its_correlations_say() -> None:
    expected = 4000 * (1 - 0.8**2) / (1 + 0.8**2)
    assert_allclose(np.mean([independent(correlated(seed, 4000, 0.8)[:, 0]) for seed in range(8)]), expected, rtol=0.1)


def test_a_late_reference_is_named_and_its_own_deviations_count() -> None:
    t = np.arange(0.0, 200.0)
    speed = np.stack([np.sin(t / 7), np.cos(t / 9), 0 * t], axis=1)
    noise = np.random.default_rng(1).normal(size=(200, 3))
    late = np.column_stack([t + 0.4, speed])
    found = compare(t, speed + 0.01 * noise, np.full((200, 3), 0.01), late)
    assert found.lag.seconds == pytest.approx(0.4, abs=0.01) and found.lag.mean < 1.3 < found.mean
    rough = np.column_stack([t, speed + 0.05 * noise])
    plain = compare(t, speed, np.full((200, 3), 0.01), rough)
    assert plain.mean > 10 and plain.lag is None
    own = compare(t, speed, np.full((200, 3), 0.01), np.column_stack([rough, np.full((200, 3), 0.05)]))
    assert 0.8 < own.mean < 1.2 and own.lag is None


def test_the_deviation_of_a_shift_is_that_of_many_estimates() -> None:
    """Shifts off the grid, white and correlated errors: the error of a shift over its deviation has the variance 1."""
    t = np.arange(0.0, 300.0)
    for kept in (0.0, 0.8):
        scores = []
        for seed in range(60):
            late = np.random.default_rng(seed).uniform(-1.5, 1.5)
            late += np.copysign(0.3, late)
            speed = np.stack([8 * np.sin((t + k) / (5 + k)) for k in range(3)], axis=1)
            fine = np.arange(-10.0, 310.0, 0.1)
            truth = np.stack([8 * np.sin((fine - late + k) / (5 + k)) for k in range(3)], axis=1)
            errors = 0.2 * correlated(seed, len(t), kept)
            found = compare(t, speed + errors, np.full((len(t), 3), 0.2), np.column_stack([fine, truth]))
            scores.append((found.lag.seconds - late) / found.lag.sd)
        assert 0.6 < np.mean(np.square(scores)) < 1.6


@pytest.mark.parametrize("method", ["smoother", "filter"])
def test_deviations_of_few_rows_know_that_their_noise_is_hardly_known(method: str) -> None:
    """White errors of one metre on a line at 45 degrees: six rows gave a NEES of 2, and said nothing."""
    squares = []
    for seed in range(60):
        noise = np.random.default_rng(seed).normal(size=(6, 3)) / (6388838.3 * np.cos(np.pi / 4), 6367381.8, 1.0)
        east, north, up = (noise * (180 / np.pi, 180 / np.pi, 1.0)).T
        found = nav.track(np.column_stack([np.arange(6.0), 45 + north, 10 + east, 100 + up]), method=method)
        squares.append(np.mean((found.velocity / found.velocity_sd) ** 2))
    assert 0.3 < np.mean(squares) < 1.5
    assert any("6 rows for 3 states tell little" in line for line in found.warnings)


def test_one_row_left_out_is_one_row_and_a_short_track_hears_how_many_it_needs() -> None:
    rows = [(k, 45 + 1e-4 * k, 10.0, 100.0 + (400.0 if k == 15 else 0.0)) for k in range(40)]
    assert any(line.startswith("1 row was left out (outlier): line ") for line in nav.track(rows).warnings)
    for length, kind in ((1, "empty"), (3, "shape")):
        with pytest.raises(NavsymError, match="at least 4 rows for 3 states") as caught:
            nav.track(rows[:length])
        assert caught.value.kind == kind


def test_the_answer_has_nees_and_the_csv_all_rows(tmp_path: Path) -> None:
    drive = nav.track("examples/drive.csv", sigma=0.5)
    reference = tmp_path / "reference.csv"
    lines = [",".join(map(repr, [float(a), *v.tolist()])) for a, v in zip(drive.t, drive.velocity, strict=True)]
    reference.write_text("t,ve,vn,vu\n" + "\n".join(lines) + "\n", encoding="utf-8")
    found = nav.track("examples/drive.csv", sigma=0.5, reference=reference)
    assert found.nees.mean == pytest.approx(0.0, abs=1e-9) and found.document()["nees"]["rows"] == len(drive.t)
    assert found.document()["nis"]["band"][0] < 1 < found.document()["nis"]["band"][1]
    found.save(tmp_path / "out.csv")
    rows = list(csv.DictReader((tmp_path / "out.csv").read_text(encoding="utf-8").splitlines()))
    assert len(rows) == len(drive.t) and [row["row"] for row in rows] == list(drive.flags)
    assert_allclose([float(row["sd_vn"]) for row in rows], drive.velocity_sd[:, 1], rtol=0)
    again = nav.track("examples/drive.csv", sigma=0.5, reference=tmp_path / "out.csv")
    assert again.nees.mean == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("reference", "kind"),
    [
        ([[0, 1, 2]], "shape"),
        ([[1e6, 0, 0, 0], [2e6, 0, 0, 0]], "empty"),
        ([[1, 0, 0, 0], [0, 0, 0, 0]], "not-finite"),
        ([[0, 1e308, 0, 0], [60, 0, 0, 0]], "not-finite"),
        ("semicolons.csv", "syntax"),
        ("commas.csv", "shape"),
        ("none.csv", "missing-file"),
        (object(), "shape"),
    ],
)
def test_a_wrong_reference_is_an_error_with_kind_and_place(reference: object, kind: str, tmp_path: Path) -> None:
    """Decimal commas are refused whatever stands between the cells: no column takes the number of another."""
    (tmp_path / "semicolons.csv").write_text("t;ve;vn;vu\n0;1,5;0;0\n60;1,5;0;0\n", encoding="utf-8")
    (tmp_path / "commas.csv").write_text("t,ve,vn,vu\n0,1,5,0,5,0,5\n60,1,5,0,5,0,5\n", encoding="utf-8")
    if reference in ("semicolons.csv", "commas.csv"):
        reference = tmp_path / str(reference)
    with pytest.raises(NavsymError) as caught:
        nav.track("examples/drive.csv", sigma=0.5, order=2, reference=reference)
    assert caught.value.kind == kind and caught.value.where


def test_an_error_of_a_reference_in_memory_names_the_track_once() -> None:
    rows = [(k, 45 + 1e-4 * k, 10.0, 100.0) for k in range(20)]
    with pytest.raises(NavsymError) as caught:
        nav.track(rows, order=2, reference=[[0, 1, 2]])
    assert caught.value.where == "track: reference"
