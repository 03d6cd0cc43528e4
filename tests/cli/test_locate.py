"""``navsym locate``: the keys of the interfaces, the four methods, and every kind of bad input."""

from __future__ import annotations

import json
import random

import numpy as np
import pytest

from navsym.cli.main import run
from navsym.core.errors import NavsymError
from navsym.terrain.locate import SEARCHES, locate

KEYS = {
    "method",
    "position_index",
    "velocity_index",
    "criterion",
    "second_best",
    "unique",
    "t_G",
    "quadratic",
    "fix",
    "correction",
    "evaluated",
    "covariance",
    "weakest",
    "remarks",
}


def heights():
    rows, columns = np.mgrid[:60, :80]
    return 100 * np.sin(columns / 7) * np.cos(rows / 5) + 30 * np.sin(columns * rows / 200)


def surface(x, y):
    """Bilinear heights at (x, y), written out again so as not to lean on the package."""
    H, u, w = heights(), np.asarray(x) / 30, np.asarray(y) / 30
    c, r = u.astype(int), w.astype(int)
    f, g = u - c, w - r
    return (H[r, c] * (1 - f) + H[r, c + 1] * f) * (1 - g) + (H[r + 1, c] * (1 - f) + H[r + 1, c + 1] * f) * g


def config(**changes):
    t = np.arange(40.0)
    x, y = 600 + 25 * t, 500 + 15 * t
    h = surface(x + 60 + 1 * t, y - 30 - 2 * t)
    return {
        "map": {"heights": heights().tolist(), "x0": 0, "y0": 0, "dx": 30, "dy": 30},
        "track": {"t": t.tolist(), "x": x.tolist(), "y": y.tolist(), "h": h.tolist()},
        "position": {"step": [30, 30], "half_count": [4, 4]},
        "velocity": {"step": [1, 1], "half_count": [3, 3]},
        "interpolation": "bilinear",
        **changes,
    }


def call(tmp_path, capsys, document, *options):
    path = tmp_path / "config.json"
    path.write_text(document if isinstance(document, str) else json.dumps(document))
    status = run(["locate", str(path), "--json", *options])
    return status, json.loads(capsys.readouterr().out)


@pytest.mark.parametrize("method", SEARCHES)
def test_every_method_answers_with_the_keys_of_the_interface(tmp_path, capsys, method):
    status, answer = call(tmp_path, capsys, config(), "--method", method)
    assert status == 0 and set(answer) == KEYS and answer["method"] == method
    assert set(answer["fix"]) == {"x", "y", "vx", "vy"}
    assert set(answer["correction"]) == {"dx", "dy", "dvx", "dvy"}
    assert (answer["t_G"] is None) == (method != "sequential")


def test_the_full_search_finds_the_flight(tmp_path, capsys):
    _, answer = call(tmp_path, capsys, config())
    assert answer["position_index"] == [2, -1] and answer["velocity_index"] == [1, -2]
    assert answer["unique"] is True and answer["criterion"] < 1e-9 < answer["second_best"]
    assert answer["fix"] == pytest.approx({"x": 1674, "y": 977, "vx": 26, "vy": 13})
    assert answer["correction"] == pytest.approx({"dx": 99, "dy": -108, "dvx": 1, "dvy": -2})
    assert 0 < answer["evaluated"] <= 81 * 49


def test_a_hypothesis_without_others_on_the_map_is_not_called_unique(tmp_path, capsys):
    """Steps in another unit than the map carry all other hypotheses off it: nothing was compared."""
    far = {"step": [3e4, 3e4], "half_count": [4, 4]}
    steps = config(position=far, velocity={"step": [1e3, 1e3], "half_count": [1, 1]})
    status, answer = call(tmp_path, capsys, steps)
    assert status == 0 and answer["unique"] is None and answer["second_best"] is None
    assert any("nothing was compared" in remark for remark in locate(steps).remarks)


def test_the_printed_sequential_search_follows_equation_14(tmp_path, capsys):
    _, answer = call(tmp_path, capsys, config(), "--method", "sequential")
    (i, j), (Vi, Vj), t_G = answer["position_index"], answer["velocity_index"], answer["t_G"]
    assert 0 <= t_G["min"] <= t_G["mid"] <= t_G["max"] <= 39
    assert t_G["mid"] == pytest.approx((t_G["min"] + t_G["max"]) / 2)
    assert answer["correction"]["dx"] == pytest.approx(30 * i + Vi * (39 - t_G["mid"]))
    assert answer["correction"]["dy"] == pytest.approx(30 * j + Vj * (39 - t_G["mid"]))
    assert answer["evaluated"] == 81 + 49


@pytest.mark.parametrize("method", SEARCHES)
def test_an_unknown_height_error_is_estimated_and_does_not_move_the_fix(tmp_path, capsys, method):
    document = config()
    _, flat_answer = call(tmp_path, capsys, document, "--method", method, "--offset-free")
    document["track"]["h"] = [h + 500.0 for h in document["track"]["h"]]
    status, answer = call(tmp_path, capsys, document, "--method", method, "--offset-free", "--maps")
    assert status == 0 and set(answer) == {*KEYS, "height_offset", "criterion_map"}
    assert answer["position_index"] == flat_answer["position_index"]
    assert answer["velocity_index"] == flat_answer["velocity_index"]
    assert answer["height_offset"] == pytest.approx(flat_answer["height_offset"] + 500.0)
    if method in ("full", "refined"):
        assert answer["position_index"] == [2, -1] and answer["height_offset"] == pytest.approx(500.0)
    plain = call(tmp_path, capsys, document, "--method", method)[1]
    assert plain["criterion"] > answer["criterion"]


def test_the_criterion_map_has_a_row_for_every_j(tmp_path, capsys):
    document = config(position={"step": [30, 30], "half_count": [4, 2]})
    _, answer = call(tmp_path, capsys, document, "--method", "position", "--maps")
    surface_map = np.array(answer["criterion_map"], dtype=float)
    assert surface_map.shape == (5, 9)
    i, j = answer["position_index"]
    assert surface_map[j + 2, i + 4] == answer["criterion"] == surface_map.min()


def test_inadmissible_hypotheses_are_null_in_the_criterion_map(tmp_path, capsys):
    document = config()
    document["track"]["x"] = [x - 580 for x in document["track"]["x"]]
    _, answer = call(tmp_path, capsys, document, "--method", "position", "--maps")
    assert all(row[0] is None for row in answer["criterion_map"])
    assert all(row[4] is not None for row in answer["criterion_map"])


def test_maps_and_tracks_come_from_files_beside_the_configuration(tmp_path, capsys):
    document = config()
    np.savez(tmp_path / "m.npz", heights=heights(), x0=0.0, y0=0.0, dx=30.0, dy=30.0)
    lines = zip(*(document["track"][name] for name in "txyh"), strict=True)
    (tmp_path / "track.csv").write_text("t,x,y,h\n" + "\n".join(",".join(map(repr, row)) for row in lines))
    _, from_numbers = call(tmp_path, capsys, document)
    document |= {"map": {"file": "m.npz"}, "track": {"file": "track.csv"}}
    _, from_files = call(tmp_path, capsys, document)
    assert from_files == from_numbers


def test_people_get_a_table(tmp_path, capsys):
    path = tmp_path / "config.json"
    path.write_text(json.dumps(config()))
    assert run(["locate", str(path)]) == 0
    out = capsys.readouterr().out
    assert "hypothesis [2, -1], [1, -2]" in out and "1674.000" in out


def spoil(section, key, value):
    def change(document):
        document[section][key] = value

    return change


def drop(section):
    def change(document):
        del document[section]

    return change


def swap(document):
    track = document["track"]
    track["x"], track["y"] = track["y"], [x + 900 for x in track["x"]]


def partly_off(document):
    document["track"]["x"][-1] = 1e5


def flat(document):
    document["map"]["heights"] = np.full((60, 80), 3.0).tolist()


def ridge(document):
    document["map"]["heights"] = np.tile(np.sin(np.arange(80.0)), (60, 1)).tolist()


def holed(document):
    document["map"]["heights"][17][21] = -9999
    document["map"]["nodata"] = -9999


BAD = {
    "outside-map": [spoil("map", "x0", 1e6), swap, partly_off],
    "nodata": [holed],
    "not-estimable": [flat, ridge, lambda d: d.update(track={k: v[:3] for k, v in d["track"].items()})],
    "domain": [
        spoil("map", "dx", -30),
        spoil("map", "dy", 0),
        spoil("position", "step", [30, -30]),
        spoil("position", "half_count", [-1, 2]),
        lambda d: d.update(interpolation="cubic"),
        spoil("track", "t", list(range(39, -1, -1))),
        lambda d: d.update(map={"file": "map.xyz"}),
    ],
    "duplicate": [spoil("track", "t", [0, 0, *range(1, 39)])],
    "shape": [
        spoil("track", "h", [1.0] * 39),
        drop("map"),
        drop("track"),
        drop("position"),
        drop("velocity"),
        spoil("map", "heights", [[1, 2], [3]]),
        spoil("map", "heights", "x"),
        spoil("position", "step", 30),
        spoil("map", "heights", [[1, "a"], [3, 4]]),
    ],
    "empty": [lambda d: d["map"].pop("dx"), lambda d: d["track"].pop("h"), spoil("track", "t", [])],
    "too-large": [spoil("position", "half_count", [100000, 100000])],
    "missing-file": [lambda d: d.update(map={"file": "gone.npz"}), lambda d: d.update(track={"file": "gone.csv"})],
}


@pytest.mark.parametrize(("kind", "change"), [(kind, change) for kind, changes in BAD.items() for change in changes])
def test_bad_input_is_one_document_of_its_kind(tmp_path, capsys, kind, change):
    document = config()
    change(document)
    status, answer = call(tmp_path, capsys, document)
    assert status == 2 and list(answer) == ["error"]
    error = answer["error"]
    assert error["kind"] == kind, error
    assert "config.json" in error["where"] and "expected" in error["message"] and "got" in error["message"]


def put(*path, value=1):
    def change(document):
        for key in path[:-1]:
            document = document[key]
        document[path[-1]] = value

    return change


@pytest.mark.parametrize(
    ("change", "where", "known"),
    [
        (put("velocty"), "velocty", "map, track, position, velocity, interpolation"),
        (put("map", "x_0"), "map.x_0", "heights, x0, y0, dx, dy, nodata"),
        (put("map", "file", value="x.npz"), "map.heights", "file, nodata, frame"),
        (put("map", "frame", value="local"), "map.frame", "heights, x0"),
        (put("track", "height"), "track.height", "t, x, y, h"),
        (put("track", "file", value="track.csv"), "track.t", "the keys file"),
        (put("position", "halfcount", value=[1, 1]), "position.halfcount", "step, half_count"),
        (put("velocity", "steps"), "velocity.steps", "did you mean 'step'"),
    ],
)
def test_a_key_that_would_be_ignored_is_refused_with_the_known_ones(tmp_path, capsys, change, where, known):
    document = config()
    change(document)
    status, answer = call(tmp_path, capsys, document)
    error = answer["error"]
    assert (status, error["kind"]) == (2, "unknown-symbol")
    assert error["where"] == f"{tmp_path}/config.json: {where}" and known in error["message"]


def test_nodata_that_no_double_holds_is_refused():
    with pytest.raises(NavsymError, match=r"nodata: expected a number; got 'int of 1329 bits'"):
        locate(config(map={**config()["map"], "nodata": 10**400}))


def test_nan_in_the_file_and_a_wrong_method_are_refused(tmp_path, capsys):
    text = json.dumps(config()).replace('"y": [500.0', '"y": [NaN')
    status, answer = call(tmp_path, capsys, text)
    assert status == 2 and answer["error"]["kind"] == "not-finite"
    status, answer = call(tmp_path, capsys, config(), "--method", "best")
    assert status == 2 and answer["error"]["kind"] == "domain"


def test_feet_for_metres_are_suspected(tmp_path, capsys):
    document = config()
    document["map"]["heights"] = (heights() + 500).tolist()
    document["track"]["h"] = [(h + 500) / 0.3048 for h in document["track"]["h"]]
    path = tmp_path / "config.json"
    path.write_text(json.dumps(document))
    assert run(["locate", str(path), "--json"]) == 0
    captured = capsys.readouterr()
    assert "feet" in captured.err and any("feet" in remark for remark in json.loads(captured.out)["remarks"])


def test_a_gross_height_is_named_and_feet_are_not_suspected_for_it():
    document = config()
    document["track"]["h"] = [h + (9000.0 if k == 2 else 0.0) for k, h in enumerate(document["track"]["h"])]
    (named,) = (remark for remark in locate(document).remarks if "gross error" in remark)
    assert f"at t = {document['track']['t'][2]:g} departs" in named
    assert not any("gross" in remark or "feet" in remark for remark in locate(config()).remarks)


def test_the_edge_of_the_grid_is_remarked():
    found = locate(config(position={"step": [30, 30], "half_count": [1, 4]}))
    assert any("edge of the grid" in remark for remark in found.remarks)


@pytest.mark.parametrize("method", ["position", "full"])
def test_heights_that_repeat_every_second_node_are_not_flat(method):
    """Central differences are zero at every node; the criterion tells the hypotheses apart, with ties."""
    heights_of_two = np.tile([[0.0, 10.0], [5.0, 20.0]], (20, 20))
    x, y = 500.0 + 50.0 * np.arange(8), np.full(8, 400.0)
    document = {
        "map": {"heights": heights_of_two.tolist(), "x0": 0, "y0": 0, "dx": 50, "dy": 40},
        "track": {"t": list(range(8)), "x": x.tolist(), "y": y.tolist(), "h": [0.0, 10.0] * 4},
        "position": {"step": [50, 40], "half_count": [3, 3]},
        "velocity": {"step": [1, 1], "half_count": [0, 0]},
    }
    answer = locate(document, method).document()
    assert answer["criterion"] == answer["second_best"] == 0.0 and answer["unique"] is False


def test_the_flat_direction_is_named():
    document = config()
    ridge(document)
    with pytest.raises(Exception, match=r"along \(-?0.0000, -?1.0000\)"):
        locate(document)


ABSURD = [None, True, "30", -1, 0, 1e-320, 1e308, -1e155, 10**400, [], {}, [1], [[1]], [1e308, 1], ["1", 2], 2**63]


def places(value, path=()):
    """Paths to some of the values inside a document."""
    items = value.items() if isinstance(value, dict) else []
    if isinstance(value, list) and value and len(path) < 4:
        items = [(k, value[k]) for k in {0, len(value) - 1}]
    for key, inner in items:
        yield (*path, key)
        yield from places(inner, (*path, key))


def test_absurd_values_anywhere_are_refused_or_harmless():
    small = config(position={"step": [30, 30], "half_count": [1, 1]})
    small["velocity"]["half_count"] = [1, 1]
    small["map"]["heights"] = [row[:45] for row in small["map"]["heights"][:40]]
    small["track"] = {name: values[:12] for name, values in small["track"].items()}
    generator, text = random.Random(0), json.dumps(small)
    everywhere = list(places(small))
    for _ in range(600):
        document, path = json.loads(text), generator.choice(everywhere)
        inner = document
        for key in path[:-1]:
            inner = inner[key]
        inner[path[-1]] = generator.choice(ABSURD)
        try:
            answer = locate(document, generator.choice([*SEARCHES]), maps=True).document()
        except NavsymError as error:
            assert "expected" in error.message and "got" in error.message
        else:
            json.dumps(answer, allow_nan=False)
