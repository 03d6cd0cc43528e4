"""``nav.locate``: the document of the verb, arrays and tables, and errors that name their place."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

import navsym as nav
from navsym.cli.main import run
from navsym.core.errors import NavsymError
from navsym.terrain import covariance, sequential
from navsym.terrain.heights import bilinear
from navsym.terrain.maps import metres_per_degree
from tests.frames import Frame

FILE = Path("examples/flight.json")


def test_the_document_is_the_one_of_the_verb(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["locate", str(FILE), "--method", "sequential", "--maps", "--offset-free", "--json"]) == 0
    found = nav.locate(FILE, "sequential", maps=True, offset_free=True)
    assert found.document() == json.loads(capsys.readouterr().out)
    assert "\n" not in repr(found) and "<table>" in found._repr_html_() and found.criterion_map.ndim == 2


def test_arrays_and_tables_go_in() -> None:
    document = json.loads(FILE.read_text())
    expected = nav.locate(document).document()
    document["map"]["heights"] = np.array(document["map"]["heights"])
    document["track"] = Frame(document["track"])
    assert nav.locate(document).document() == expected


@pytest.mark.parametrize(
    ("config", "options", "kind"),
    [
        (5, {}, "shape"),
        ({}, {}, "shape"),
        ("none.json", {}, "missing-file"),
        ({"map": 5}, {}, "shape"),
        ({"surplus": 1}, {}, "unknown-symbol"),
        (FILE, {"method": "best"}, "domain"),
        (FILE, {"method": 5}, "domain"),
    ],
)
def test_wrong_arguments_are_errors_with_kind_and_place(config, options, kind) -> None:
    with pytest.raises(NavsymError) as caught:
        nav.locate(config, **options)
    assert caught.value.kind == kind and caught.value.where


def test_a_wrong_method_is_named_as_the_caller_named_it(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(NavsymError, match="expected one of position, full, sequential, refined") as caught:
        nav.locate(FILE, "best")
    assert caught.value.where == "locate: method"
    assert run(["locate", str(FILE), "--method", "best"]) == 2
    assert "--method: expected one of" in capsys.readouterr().err


def border_flights() -> Iterator[tuple[dict, str]]:
    """Tracks along the border of a map, or to its corner, on grids whose spacing and origin no double holds."""
    generator = np.random.default_rng(0)
    for dx, x0, row, ends in product((0.1, 1 / 3, 7.7), (0.0, 5e5 + 0.1, -1e6 / 3), (0, 4), ((0, 6), (1, 6))):
        n = 6
        u, w = np.linspace(*ends, n), np.full(n, float(row))
        track = {"t": [float(k) for k in range(n)], "h": generator.normal(size=n).tolist()}
        yield (
            {
                "map": {"heights": generator.normal(size=(5, 7)).tolist(), "x0": x0, "y0": x0, "dx": dx, "dy": dx},
                "track": track | {"x": (x0 + u * dx).tolist(), "y": (x0 + w * dx).tolist()},
                "position": {"step": [dx, dx], "half_count": [1, 1]},
                "velocity": {"step": [dx / 3, dx / 7], "half_count": [0, 0]},
            },
            f"{dx} {x0} {row} {ends}",
        )


def test_a_track_on_the_border_is_on_the_map_and_every_method_says_the_same() -> None:
    """Rounding once took it off: the sequential method chose an infinite criterion, the others refused the track."""
    for config, words in border_flights():
        found = {method: nav.locate(config, method) for method in ("position", "full", "sequential")}
        assert {f.position_index for f in found.values()} == {found["full"].position_index}, words
        assert found["sequential"].criterion == found["position"].criterion == found["full"].criterion, words
        json.dumps(found["sequential"].document(), allow_nan=False)


def test_a_hypothesis_off_the_map_is_never_the_answer(monkeypatch, capsys: pytest.CaptureFixture[str]) -> None:
    outside = np.full((5, 5), np.inf)
    monkeypatch.setattr(sequential, "velocity_stage", lambda *_: outside)
    assert run(["locate", str(FILE), "--method", "sequential", "--json"]) == 2
    assert json.loads(capsys.readouterr().out)["error"]["kind"] == "outside-map"


def made_search(slope_y: float = 1.0, noise: float = 0.5, seed: int = 3) -> tuple[dict, np.ndarray]:
    """A search over hills that are ``slope_y`` times as steep along y, and its true correction at the last time."""
    rng = np.random.default_rng(seed)
    rows, columns = np.mgrid[0:60, 0:60] * 50.0
    heights = 80 * np.sin(columns / 310) + slope_y * 80 * np.cos(rows / 270 + 0.3) + slope_y * 9 * np.sin(rows / 97)
    t = np.arange(60.0)
    x, y, error = 700 + 20 * t, 900 + 13 * t + 90 * np.sin(t / 9), np.array([60.0, -40.0, 0.5, -0.4])
    true_x, true_y = x + error[0] + error[2] * t, y + error[1] + error[3] * t
    h = bilinear(heights, true_x / 50, true_y / 50)[0] + noise * rng.normal(size=60)
    steps = {
        "position": {"step": [20, 20], "half_count": [4, 4]},
        "velocity": {"step": [0.5, 0.5], "half_count": [1, 1]},
    }
    track = {"t": t, "x": x, "y": y, "h": h}
    place = {"heights": heights, "x0": 0, "y0": 0, "dx": 50, "dy": 50}
    return {"map": place, "track": track, **steps}, np.add(error, [59 * error[2], 59 * error[3], 0, 0])


def test_the_covariance_of_a_refined_fix_is_that_of_its_errors() -> None:
    """NEES of four unknowns over forty searches, against the 99.9 % band of the mean."""
    found = []
    for seed in range(40):
        document, truth = made_search(seed=seed)
        fix = nav.locate(document, "refined")
        error = np.concatenate(fix.correction) - truth
        found.append(error @ np.linalg.solve(fix.trust.covariance, error))
    low, high = chi2.ppf([0.0005, 0.9995], 4 * 40) / 40
    assert low < np.mean(found) < high
    assert 2 * np.mean(found) > high  # halved variances fall out of the band


def test_the_covariance_counts_that_height_differences_are_correlated() -> None:
    """Errors of 0.9 from row to row: taken as independent, their mean square is several times too large."""
    found, plain = [], []
    for seed in range(20):
        document, truth = made_search(noise=0.0, seed=seed)
        rng = np.random.default_rng(100 + seed)
        errors = rng.normal(size=60)
        for k in range(1, 60):
            errors[k] = 0.9 * errors[k - 1] + np.sqrt(1 - 0.81) * errors[k]
        document["track"]["h"] = np.add(document["track"]["h"], errors)
        fix = nav.locate(document, "refined")
        error = np.concatenate(fix.correction) - truth
        found.append(error @ np.linalg.solve(fix.trust.covariance, error) / 4)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(covariance, "CORRELATIONS", np.zeros(1))
            alone = nav.locate(document, "refined").trust.covariance
        plain.append(error @ np.linalg.solve(alone, error) / 4)
        assert any("correlated" in line for line in fix.remarks)
    assert np.mean(found) < 2.0 and np.mean(plain) > 2 * np.mean(found)


def test_the_weakest_direction_is_where_the_slopes_are_small() -> None:
    document = nav.locate(made_search(slope_y=0.02)[0], "refined").document()
    direction = np.array(document["weakest"]["direction"])
    assert direction[1] > 0.99 and document["weakest"]["sd"] > 10 * document["weakest"]["across"]
    assert any("weak along" in line or "nearly singular" in line for line in document["remarks"])
    steep = nav.locate(made_search()[0], "refined").document()
    assert not any("weak" in line or "singular" in line for line in steep["remarks"])


def test_latitudes_and_longitudes_are_positions_on_the_tile(tmp_path: Path) -> None:
    """The same track in degrees and in metres of the local frame gives the same fix, and the fix its latitude."""
    document, _ = made_search()
    degrees = {"x0": 10.0, "y0": 45.0, "dx": 1 / 1200, "dy": 1 / 1200}
    east, north = metres_per_degree(45.0 + 59 / 2400)
    track = dict(document["track"])
    np.savez(tmp_path / "tile.npz", elevation=document["map"]["heights"][::-1], **edges(degrees, 60))
    document["map"] = {"file": "tile.npz", "frame": "local"}
    cell = np.array([east, north]) / 1200
    track["x"], track["y"] = track["x"] * cell[0] / 50, track["y"] * cell[1] / 50
    plane = nav.locate({**document, "track": track}, "position", folder=tmp_path)
    where = {"t": track["t"], "lat": 45.0 + track["y"] / north, "lon": 10.0 + track["x"] / east, "h": track["h"]}
    earth = nav.locate({**document, "track": where}, "position", folder=tmp_path)
    assert abs(plane.x - earth.x) < 1e-6 and abs(plane.y - earth.y) < 1e-6
    assert abs(earth.document()["fix"]["latitude"] - (45.0 + earth.y / north)) < 1e-12
    with pytest.raises(NavsymError, match="expected x and y for a map in metres"):
        nav.locate({**made_search()[0], "track": where}, "position")


def edges(degrees: dict[str, float], n: int) -> dict[str, float]:
    """The outer edges of a tile of n by n cells, as matplotlib's sample has them."""
    half, size = degrees["dx"] / 2, n * degrees["dx"]
    corner = {"xmin": degrees["x0"] - half, "ymin": degrees["y0"] - half}
    return {
        **corner,
        "xmax": corner["xmin"] + size,
        "ymax": corner["ymin"] + size,
        "dx": degrees["dx"],
        "dy": degrees["dy"],
    }
