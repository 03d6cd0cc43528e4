"""The benchmark and the campaign run on tiny sizes; times are never asserted."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from navsym.core.errors import DomainError
from navsym.guaranteed.phases.family import Family, U
from tests.benchmarks import guaranteed, guaranteed_campaign, guard
from tests.benchmarks.lengths import values_for_lengths


def velocity(state):
    rows = ((sp.Integer(1), sp.sin(U), sp.cos(U) - 1),)
    functional = tuple(sp.Integer(int(k == state)) for k in range(3))
    return Family(rows, functional, (sp.Integer(1),), sp.Symbol("T", positive=True), True, ("z",), "y")


def test_the_benchmark_prints_ratios(capsys):
    guaranteed.main(count=100, rounds=1, lengths=10)
    assert capsys.readouterr().out.count("cvxpy/this") == 22


def test_an_epoch_of_the_guard_has_the_value_of_general_solvers(capsys):
    guard.main(count=80, every=20, rounds=1, cases=[(3, 16, 0.1)])
    shown = capsys.readouterr().out
    assert shown.count("times)") == 3 and float(shown.split()[-1]) < 1e-6


def test_a_small_campaign_has_no_contradiction_and_goes_on_where_it_stopped(tmp_path, capsys):
    out = tmp_path / "records.jsonl"
    campaign = guaranteed_campaign.main
    campaign(problems=3, alterations=6, seed=5, out=out)
    first = out.read_text()
    done, forged = campaign(problems=6, alterations=12, seed=5, out=out)
    assert out.read_text().startswith(first) and len(done) == 6 and len(forged) == 12
    assert all(r["width"] <= 1e-12 and r["accepted"] and not r["grid_below"] for r in done.values())
    assert not any(r.get("accepted") for r in forged.values())
    assert "certified at 1e-12" in capsys.readouterr().out


@pytest.mark.parametrize(("state", "lower", "upper"), [(2, 0.05, 2.0), (1, 0.05, 4.1)])
def test_many_lengths_at_once_follow_the_closed_form(state, lower, upper):
    T = np.random.default_rng(1).uniform(lower, upper, 60)
    exact = 2 / np.tan(T / 4) if state == 1 else np.cos(T / 2) / np.sin(T / 4) ** 2
    assert np.allclose(values_for_lengths(velocity(state), T), exact, rtol=1e-9)


def test_lengths_that_are_none_are_refused():
    for bad in ([], [1.0, 0.0], [np.nan]):
        with pytest.raises(DomainError, match="positive finite"):
            values_for_lengths(velocity(1), bad)
