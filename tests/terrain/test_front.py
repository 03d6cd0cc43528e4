"""``nav.locate``: the document of the verb, arrays and tables, and errors that name their place."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np
import pytest

import navsym as nav
from navsym.cli.main import run
from navsym.core.errors import NavsymError
from navsym.terrain import sequential
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
