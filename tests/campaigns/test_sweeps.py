"""Sweeps: the same bits whoever computes, resumed by what is missing, closed forms met."""

from __future__ import annotations

import json
from fractions import Fraction

import pytest

from navsym.cli.sweep import run_sweep
from navsym.errors import DomainError
from navsym.methods.sweep import Sweep, run_job, sweep_from


@pytest.fixture(autouse=True)
def own_store(monkeypatch, tmp_path):
    monkeypatch.setenv("NAVSYM_CACHE", str(tmp_path))


SMALL = Sweep("filter", jobs=4, seed=3, runs=4, steps=6)


def embedded(sweep, fresh=False):
    return run_sweep(sweep, workers=0, scheduler=None, fresh=fresh)


def test_a_job_depends_on_its_index_and_nothing_else():
    backwards = [run_job(SMALL, index) for index in reversed(range(4))][::-1]
    assert backwards == embedded(SMALL)["rows"]
    assert len({row["mse0"] for row in backwards}) == 4


@pytest.mark.slow
def test_two_processes_give_the_bits_of_one():
    alone = json.dumps(embedded(SMALL)["rows"])
    together = run_sweep(SMALL, workers=2, scheduler=None, fresh=True)
    assert json.dumps(together["rows"]) == alone


def test_a_second_run_computes_what_is_missing_only(monkeypatch):
    first = embedded(SMALL)
    monkeypatch.setattr("navsym.methods.sweep.run_job", lambda sweep, index: 1 / 0)
    second = embedded(SMALL)
    assert second["resumed"] == 4 and second["rows"] == first["rows"]


def test_the_guaranteed_slope_over_lengths_is_two_over_T():
    """The slope of a line on [0, T] has the guaranteed standard deviation 2/T."""
    document = embedded(Sweep("guaranteed", jobs=3, degree=1, start="1", end="2"))
    for row in document["rows"]:
        assert Fraction(row["lower"]) <= 2 / Fraction(row["T"]) <= Fraction(row["upper"])


@pytest.mark.parametrize(
    "document",
    [
        {"kind": "filter"},
        {"kind": "other", "jobs": 3},
        {"kind": "filter", "jobs": 0},
        {"kind": "filter", "jobs": True},
        {"kind": "filter", "jobs": 2, "seed": -1},
        {"kind": "guaranteed", "jobs": 2, "start": "2", "end": "1"},
        {"kind": "guaranteed", "jobs": 2, "start": "1e9999999"},
        {"kind": "filter", "jobs": 2, "surplus": 1},
        [1],
    ],
)
def test_a_configuration_that_is_none_is_refused(document):
    with pytest.raises(DomainError):
        sweep_from(document)
