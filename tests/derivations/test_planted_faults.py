"""Signs flipped and indices shifted in the sources of papers: no claim that names the changed quantity stays silent.

Ten places of the shortest paper by default, 40 of the five papers in a long run, 200 in a slow one.
"""

from __future__ import annotations

import random

import pytest

from navsym.core.sandbox import run_many
from tests.derivations.planted import Outcome, plant, watch

FIVE = ("guaranteed_velocity", "joint_correction", "multistructure", "terrain_search", "trajectory")
SEED, SECONDS = 1, 150

#: Places where the change says the same, or reaches no claim that runs through them, with the reason.
SAME: dict[tuple[str, str], str] = {}


def outcomes(paper: str, count: int) -> list[Outcome]:
    """What faults at some places do, each planted in a process of its own; half of more places first."""
    seen = watch(paper)
    places = random.Random(SEED).sample(sorted(seen.names), count)
    found = [one.value for one in run_many(lambda place: plant(paper, place, seen), places, 1, SECONDS)]
    assert all(isinstance(one, Outcome) for one in found), found
    return found


def require_noticed(found: list[Outcome]) -> None:
    silent = [one for one in found if not one.moved and not one.fell]
    assert not [one for one in silent if (one.place[0].partition(".")[2], one.line) not in SAME]
    assert sum(bool(one.fell) for one in found) >= 0.7 * len(found), [one for one in found if not one.fell]


def test_a_fault_in_a_model_does_not_stay_silent():
    require_noticed(outcomes("alpha_beta_filter", 10))


@pytest.mark.long
@pytest.mark.parametrize("paper", FIVE)
def test_eight_faults_in_a_paper_do_not_stay_silent(paper):
    require_noticed(outcomes(paper, 8))


@pytest.mark.slow
@pytest.mark.parametrize("paper", FIVE)
def test_forty_faults_in_a_paper_do_not_stay_silent(paper):
    require_noticed(outcomes(paper, 40))
