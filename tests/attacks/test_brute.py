"""Condition numbers, designs and tracks are those of brute force; a proof proves no false twin of its statement."""

from __future__ import annotations

import random

import pytest

from tests.attacks import brute, false_twins

SEED = 18


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.long] * (n == "track")) for n in brute.VERBS])
def test_answers_are_those_of_brute_force(name: str) -> None:
    assert brute.list_faults(name, range(2), SEED) == []


@pytest.mark.long
@pytest.mark.parametrize("name", brute.VERBS)
def test_a_hundred_answers_of_each_verb_are_those_of_brute_force(name: str) -> None:
    assert brute.list_faults(name, range(2, 102), SEED) == []


def test_a_proof_proves_no_false_twin_of_its_statement() -> None:
    certified = false_twins.certify_twins(false_twins.TWINS[::8])
    number, taken = false_twins.list_accepted(false_twins.forge(certified, random.Random(SEED), 1))
    assert number > 50 and taken == []


@pytest.mark.long
def test_of_thousands_of_forgeries_below_false_twins_none_is_accepted() -> None:
    certified = false_twins.certify_twins(false_twins.TWINS)
    number, taken = false_twins.list_accepted(false_twins.forge(certified, random.Random(SEED), 25))
    assert number > 4000 and taken == []
