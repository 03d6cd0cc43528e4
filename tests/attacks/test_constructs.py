"""Random statements on each construct of the language: no verdict is wrong, and most are decided."""

from __future__ import annotations

from collections import Counter

import pytest

from tests.attacks.constructs import SCHEMES, Construct, make_construct, outcome_of

SEED = 20
NAMES = sorted(SCHEMES)


def judge(numbers: range) -> tuple[Counter[str], list[str]]:
    """Outcomes, and what is wrong."""
    counts, faults = Counter[str](), []
    for number in numbers:
        name, statement = make_construct(number, SEED)
        found, why = outcome_of(statement)
        counts[found] += 1
        if found in ("wrong", "false confirmed"):
            faults.append(f"{name}: {statement.text} with {statement.given}, {statement.truth}: {why}")
    return counts, faults


@pytest.mark.parametrize("place", range(len(NAMES)), ids=NAMES)
def test_no_verdict_on_a_construct_is_wrong(place):
    counts, faults = judge(range(place, 2 * len(NAMES), len(NAMES)))
    assert not faults
    assert counts["decided"]


@pytest.mark.long
@pytest.mark.parametrize("place", range(len(NAMES)), ids=NAMES)
def test_no_verdict_of_forty_on_a_construct_is_wrong(place):
    counts, faults = judge(range(place + 2 * len(NAMES), 42 * len(NAMES), len(NAMES)))
    assert not faults
    assert counts["decided"] >= 30


def test_true_and_false_statements_take_turns():
    truths = [make_construct(number, SEED)[1].truth for number in range(30 * len(NAMES))]
    assert 0.3 < sum(truths) / len(truths) < 0.8


def test_a_wrong_verdict_is_noticed():
    assert outcome_of(Construct("dot(u, v) = dot(v, u)", False, {n: {"vector": 3} for n in "uv"}))[0] == "wrong"
    assert outcome_of(Construct("sum(k, k, 1, n) = n**2", True, {"n": {"integer": ["1", "oo"]}}))[0] == "wrong"
