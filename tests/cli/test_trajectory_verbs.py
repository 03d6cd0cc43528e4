"""The verbs ``track`` and ``condition``: keys, exact answers, bad input."""

from __future__ import annotations

import json
from fractions import Fraction

import pytest

from navsym.cli.main import run

TRACK = "t,lat,lon,height\n" + "".join(
    f"{k},{45 + k * 1e-4:.7f},{10 + (k % 3) * 1e-7:.7f},{100 + k % 2}\n" for k in range(40)
)


def answer(capsys, *arguments):
    status = run([*arguments, "--json"])
    out = capsys.readouterr().out
    return status, json.loads(out)


def test_condition_answers_with_enclosures_and_doubles(capsys):
    status, found = answer(capsys, "condition", "--n", "20", "--tau", "0.2", "--rho", "1/6371000", "--digits", "30")
    assert status == 0
    for name, start in (("N_p", "3663853839"), ("N_pN", "3166136464"), ("N_f", "1801977022"), ("N_s", "3166136464")):
        part = found[name]
        assert part["lower"].startswith(start)
        width = Fraction(part["upper"]) / Fraction(part["lower"]) - 1
        assert 0 <= width < Fraction(1, 10**28)
        assert isinstance(part["double"], float)
    assert found["tau"] == "1/5" and any("N_f" in line for line in found["warnings"])


def test_condition_speaks_to_people(capsys):
    assert run(["condition", "--n", "3"]) == 0
    assert "39.0077" in capsys.readouterr().out


@pytest.mark.parametrize(
    "arguments, kind",
    [
        (["--n", "0"], "domain"),
        (["--n", "5", "--tau", "-1"], "domain"),
        (["--n", "121"], "too-large"),
        (["--n", "5", "--digits", "0"], "domain"),
        (["--n", "5", "--tau", "0"], "domain"),
        (["--n", "5", "--rho", "1/0"], "syntax"),
        (["--n", "5", "--tau", "__import__"], "syntax"),
        (["--n", "5", "--tau", "1e999"], "too-large"),
        (["--n", "5", "--digits", "100000"], "too-large"),
    ],
)
def test_condition_refuses_bad_requests(capsys, arguments, kind):
    status, found = answer(capsys, "condition", *arguments)
    assert status == 2 and found["error"]["kind"] == kind and found["error"]["where"]


def test_track_answers_with_velocity_acceleration_and_deviations(capsys, tmp_path):
    path = tmp_path / "track.csv"
    path.write_text(TRACK)
    status, found = answer(capsys, "track", str(path))
    assert status == 0
    assert found["rows"] == 40 and found["axes"] == ["east", "north", "up"]
    for name in ("velocity", "velocity_sd", "acceleration", "acceleration_sd"):
        assert len(found[name]) == 40 and len(found[name][0]) == 3
    assert abs(found["velocity"][20][1] - 11.1) < 0.1
    assert set(found["gains"]) == {"east", "north", "up"}


@pytest.mark.parametrize("method", ["differences", "window", "filter", "guaranteed"])
def test_every_method_answers(capsys, tmp_path, method):
    path = tmp_path / "track.csv"
    path.write_text(TRACK)
    status, found = answer(capsys, "track", str(path), "--method", method, "--order", "2")
    assert status == 0 and found["method"] == method
    assert abs(found["velocity"][20][1] - 11.1) < 0.3


@pytest.mark.parametrize("method", ["differences", "window", "filter", "smoother", "guaranteed"])
def test_two_states_estimate_no_acceleration_and_say_so(capsys, tmp_path, method):
    """Its place once held 0 with the standard deviation 0."""
    path = tmp_path / "track.csv"
    path.write_text(TRACK)
    words = ("track", str(path), "--method", method, "--order", "2")
    _, found = answer(capsys, *words)
    assert found["acceleration"] is None and found["acceleration_sd"] is None
    assert any("acceleration is not" in line for line in found["warnings"])
    run(list(words))
    printed = capsys.readouterr()
    assert "vE, m/s" in printed.out and "aE" not in printed.out and "acceleration is not" in printed.err


def test_a_window_asks_for_the_sliding_window(capsys, tmp_path):
    path = tmp_path / "track.csv"
    path.write_text(TRACK)
    _, found = answer(capsys, "track", str(path), "--window", "9")
    assert found["method"] == "window" and found["window"] == 9.0


@pytest.mark.parametrize(
    "text, extra, kind",
    [
        ("", [], "empty"),
        ("t,lat,lon,height\n0,45,10,1\n1,45,10,1\n", [], "shape"),
        (TRACK + "39,45,10,100\n", [], "duplicate"),
        (TRACK + "40,nan,10,100\n", [], "not-finite"),
        (TRACK + "1e300,45,10,100\n", [], "domain"),
        ("t,lat,lon,h\n" + "".join(f"{i}e-300,45,10,100\n" for i in range(9)), [], "domain"),
        (TRACK + "40,99,10,100\n", [], "domain"),
        (TRACK, ["--order", "77"], "domain"),
        (TRACK, ["--method", "magic"], "domain"),
        (TRACK, ["--window", "0"], "domain"),
        (TRACK, ["--sigma", "-1"], "domain"),
        (TRACK, ["--method", "filter", "--window", "3"], "domain"),
        (TRACK, ["--policy", "maybe"], "domain"),
    ],
)
def test_track_refuses_bad_input(capsys, tmp_path, text, extra, kind):
    path = tmp_path / "track.csv"
    path.write_text(text)
    status, found = answer(capsys, "track", str(path), *extra)
    assert status == 2 and found["error"]["kind"] == kind
    assert "expected" in found["error"]["message"] and "got" in found["error"]["message"]
    assert found["error"]["where"]


def test_repairs_are_listed(capsys, tmp_path):
    path = tmp_path / "track.csv"
    path.write_text(TRACK + "39,45,10,100\n40,nan,10,100\n")
    status, found = answer(capsys, "track", str(path), "--policy", "repair")
    assert status == 0 and len(found["repairs"]) == 2 and found["rows"] == 40
