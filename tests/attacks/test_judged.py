"""Random statements at edges, steps and extremes: no verdict is wrong, and what is called true holds."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest

from tests.attacks import judged
from tests.attacks.constructs import make_construct, outcome_of
from tests.attacks.evaluator import judge_text

SEED = 4712
NAMES = sorted(judged.SCHEMES)


def list_faults(numbers):
    """What is decided wrongly, or CONFIRMED though it is false."""
    faults = []
    for number in numbers:
        name, statement = make_construct(number, SEED, judged.SCHEMES)
        found, why = outcome_of(statement)
        if found in ("wrong", "false confirmed"):
            faults.append(f"{name}: {statement.text} with {statement.given}, {statement.truth}: {why}")
    return faults


@pytest.mark.long
def test_no_verdict_at_an_edge_is_wrong():
    assert list_faults(range(len(NAMES))) == []


@pytest.mark.long
def test_no_verdict_of_twenty_at_every_edge_is_wrong():
    assert list_faults(range(len(NAMES), 21 * len(NAMES))) == []


def test_true_and_false_statements_take_turns():
    truths = [make_construct(number, SEED, judged.SCHEMES)[1].truth for number in range(30 * len(NAMES))]
    assert 0.3 < sum(truths) / len(truths) < 0.8


@pytest.mark.parametrize("name", ["branches", "edges", "extremes"])
def test_what_is_called_true_holds_at_random_points(name):
    rng = random.Random(name)
    counts = {"holds": 0, "fails": 0}
    for number in range(60):
        statement = judged.SCHEMES[name](random.Random(f"{name} {number}"))
        if not statement.truth or "max(" in statement.text:
            continue
        limits = statement.given["x"]
        for _ in range(4):
            share = Fraction(rng.randint(0, 1000), 1000)
            x = (
                f"({share - Fraction(1, 2)})*100"
                if limits == "real"
                else f"({limits[0]})*(1 - {share}) + ({limits[1]})*{share}"
            )
            outcome = judge_text(statement.text, {"x": x})
            counts[outcome] = counts.get(outcome, 0) + 1
    assert counts["fails"] == 0
    assert counts["holds"] + counts.get("unknown", 0) > 30  # equal sides are no disjoint balls
