"""The files of examples/ run as they stand, and their answers are those that the documentation tells."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from navsym.cli.main import run

EXAMPLES = Path(__file__).parents[2] / "examples"


def answer(capsys, *words):
    assert run([*words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_the_jumps_of_the_example_are_found_and_nothing_else(capsys):
    found = answer(capsys, "filter", str(EXAMPLES / "switching.json"))
    likelier = [max(range(2), key=row.__getitem__) for row in found["probabilities"]]
    assert [step for step, mode in enumerate(likelier, start=1) if mode == 1] == [12, 13, 14]


@pytest.mark.parametrize(("method", "metres"), [("full", 0.0), ("position", 0.0), ("sequential", 50.0)])
def test_the_profile_of_the_example_brings_the_track_back(capsys, method, metres):
    found = answer(capsys, "locate", str(EXAMPLES / "flight.json"), "--method", method)
    correction = (found["correction"]["dx"], found["correction"]["dy"])
    assert correction == pytest.approx((200.0, -100.0), abs=metres)  # one step of the grid
    assert found["unique"] is True


@pytest.mark.long
def test_the_speed_of_the_example_is_twelve_metres_a_second(capsys):
    found = answer(capsys, "track", str(EXAMPLES / "drive.csv"))
    east, north, _ = found["velocity"][len(found["velocity"]) // 3]
    assert abs((east**2 + north**2) ** 0.5 - 12.0) < 0.5
