"""Ten thousand damaged files in every test run, a million by ``navsym campaign parser``."""

from __future__ import annotations

import pytest

from tests.attacks.campaigns.parser import MEGABYTES, OUTCOMES, SLOW, answer, judge, make_batches
from tests.attacks.campaigns.readers import BOMBS, READERS, matlab_header

REFUSED_AS_THEY_ARE = {"track.mat", "map.hgt"}  # no track of ours; a tile cut short


@pytest.mark.parametrize("name", READERS)
def test_the_honest_file_is_read_before_it_is_damaged(name):
    read, honest = READERS[name]
    outcome = answer(read, honest)
    assert outcome == ("refused" if name in REFUSED_AS_THEY_ARE else "read") or (name, outcome) == (
        "map.tif",
        "missing",
    )


@pytest.mark.parametrize("name", READERS)
def test_damaged_files_are_read_or_refused_and_soon(name):
    found = judge((name, 580, 11))
    assert not found["wrong"], found["wrong"][:2]
    assert sum(found["counts"].values()) == 580 and set(found["counts"]) <= set(OUTCOMES)
    assert found["kept"][0]["slowest"] < SLOW


def test_files_made_to_exhaust_do_not():
    found = judge(("bombs", len(BOMBS), 0))
    assert not found["wrong"], found["wrong"]
    assert found["kept"][0]["peak"] < 2 * MEGABYTES


def test_every_reader_has_its_turn_in_a_campaign():
    assert {batch.items[0] for batch in make_batches(2000 * len(READERS))} == {*READERS, "bombs"}


def test_a_file_of_another_program_is_refused_by_name():
    assert answer(READERS["track.mat"][0], matlab_header()) == "refused"
