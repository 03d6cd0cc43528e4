"""Signs flipped and indices shifted in the sources of papers: no claim that names the changed quantity stays silent.

Ten places of the shortest paper by default, 60 of the five papers in a long run, 200 in a slow one.
"""

from __future__ import annotations

from collections import Counter
from hashlib import sha256

import pytest

from navsym.core.sandbox import run_many
from tests.derivations.planted import Outcome, Place, Watched, plant, watch

FIVE = ("guaranteed_velocity", "joint_correction", "multistructure", "terrain_search", "trajectory")
SECONDS = 150

#: Claims that a fault leaves as they are, with the reason: the changed formula says the same there.
SAME: dict[tuple[str, str], str] = {
    (
        "guaranteed_velocity:1.3.spectrum",
        "lam * sp.eye(3) - sp.Matrix(CHANNEL.F) -> lam * sp.eye(3) + sp.Matrix(CHANNEL.F)",
    ): "lambda^3 + lambda is odd: F and -F have the same spectrum",
    (
        "guaranteed_velocity:range.y2.end.contacts",
        "(3 * T + s) / 2 - 2 * sp.pi -> (3 * T + s) / 2 + 2 * sp.pi",
    ): "a sine two whole turns further on is the same",
    ("guaranteed_velocity:3.3.min", "h1 + names[2] * h2 -> h1 - names[2] * h2"): "it asks which names occur",
    (
        "guaranteed_velocity:3.3.min",
        "h1 + names[2] * h2 + names[3] * h3 -> h1 + names[2] * h2 - names[3] * h3",
    ): "it asks which names occur",
    ("terrain_search:6.rest", "tk - tG -> tk + tG"): "without a velocity the time since the fix moves nothing",
    ("guaranteed_velocity:range.y3.end.contacts", "(3 * T + s) / 2 - sp.pi -> (3 * T + s) / 2 + sp.pi"): (
        "a sine a whole turn further on is the same"
    ),
    ("joint_correction:1.13.separate", "b['Gx'] - b['Kx'] * b['gx'] -> b['Gx'] + b['Kx'] * b['gx']"): (
        "it asks which names occur"
    ),
    ("joint_correction:1.6.gain_unique", "G - K * row -> G + K * row"): "what is unique in -K is so in K",
    ("joint_correction:3.3.y1", "x[1]: 1 -> 0"): "none of the four rows holds y_4, for which x_2 stands",
    (
        "trajectory:algorithm.J.still",
        "ahead + gain * (measured - ahead[0]) -> ahead - gain * (measured - ahead[0])",
    ): "changes enter J squared, and the prediction changes neither speed nor acceleration",
    ("multistructure:near.cumulant", "-mean -> mean"): "only its second and fourth powers enter",
    ("terrain_search:sequential.below", "-1 -> 1"): "the best hypotheses lie at 0 and 1",
    ("terrain_search:offset", "x + height -> x - height"): "a constant error of either sign",
    ("multistructure:12", "self.past[0]: 0 -> 1"): "every mode has as many values of the state",
    ("terrain_search:interval.whole", "-1 -> 1"): "two slopes of different directions serve as well",
    **{
        ("trajectory:table.curse.first", end): "the ends of an enclosure rise alike; the proof compares its own"
        for end in ("a[1]: 1 -> 0", "b[0]: 0 -> 1")
    },
}


def draw(seen: Watched, count: int) -> list[Place]:
    """Places by the digest of their line: whatever else of a paper is edited, the same faults are planted."""
    drawn, times = {}, Counter()
    for place in sorted(seen.names):
        times[line := seen.lines[place]] += 1
        drawn[place] = sha256(f"{line} {times[line]}".encode()).digest()
    return sorted(drawn, key=drawn.__getitem__)[:count]


def outcomes(paper: str, count: int) -> list[Outcome]:
    """What faults at some places do, each planted in a process of its own."""
    seen = watch(paper)
    places = draw(seen, count)
    found = [one.value for one in run_many(lambda place: plant(paper, place, seen), places, 1, SECONDS)]
    assert all(isinstance(one, Outcome) for one in found), found
    return found


def require_noticed(found: list[Outcome]) -> None:
    silent = [one for one in found if not one.moved and not one.fell]
    assert not [one for one in silent if (f"{one.place[0].split('.')[1]}:{one.silent[0]}", one.line) not in SAME]
    assert sum(bool(one.fell) for one in found) >= 0.6 * len(found), [one for one in found if not one.fell]


def test_a_fault_in_a_model_does_not_stay_silent():
    require_noticed(outcomes("alpha_beta_filter", 10))


def test_a_fault_that_a_paper_refuses_on_import_does_not_stay_silent():
    place = ("navsym_papers.trajectory.model", 1)
    seen = Watched({place: {"import": None}}, {place: "n + 1 -> n - 1"})
    assert plant("trajectory", place, seen).fell == "the whole paper"


@pytest.mark.long
@pytest.mark.parametrize("paper", FIVE)
def test_twelve_faults_in_a_paper_do_not_stay_silent(paper):
    require_noticed(outcomes(paper, 12))


@pytest.mark.slow
@pytest.mark.parametrize("paper", FIVE)
def test_forty_faults_in_a_paper_do_not_stay_silent(paper):
    require_noticed(outcomes(paper, 40))
