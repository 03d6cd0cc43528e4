"""One-token mutants of the proven formulas: refuted with a point, or proved equal to the original.

A sample, each mutant built and decided like a claim. ``navsym campaign mutants`` tries all of them at points first.
"""

from __future__ import annotations

import random

import pytest
import sympy as sp

from navsym.claims import PROVED, REFUTED, Equation
from navsym.core.sandbox import Exhausted, run_many
from navsym.prove.equations import decide_equation, list_entries
from tests.attacks.campaigns.edits import list_mutants, sample_mutants
from tests.derivations.statements import claims

#: Paper, how many entries are changed, and in how many ways each; the first in every run, the others in the long ones.
SAMPLES = [
    ("guaranteed_velocity", 12, 4),
    *(
        pytest.param(*sample, marks=pytest.mark.long)
        for sample in (("guaranteed_velocity", 60, 4), ("joint_correction", 40, 2), ("trajectory", 40, 2))
    ),
]
BATCH = 10
SECONDS_OF_BATCH = 300


def proven_equations(name):
    for claim, statement in claims(name):
        if claim.expect == PROVED and isinstance(statement, Equation) and statement.tolerance is None:
            yield claim.id, statement


def sides(name):
    """(id, printed entry, derived entry, box) of every proven equation."""
    for identity, statement in proven_equations(name):
        for printed, derived in zip(list_entries(statement.printed), list_entries(statement.derived), strict=True):
            yield identity, printed, derived, statement.box


def cases(some_sides, most, source):
    """(id, mutant, printed entry, derived entry, box) for some of the mutants of every side."""
    for identity, printed, derived, box in some_sides:
        for mutant in sample_mutants(printed, most, source):
            yield identity, mutant, printed, derived, box


def judge(case):
    """'refuted', 'equal' or a description of what went wrong."""
    identity, mutant, printed, derived, box = case
    verdict = decide_equation(Equation(mutant, derived, box))
    if verdict.status == REFUTED:
        return "refuted" if verdict.counterexample is not None else f"{identity}: no point for {mutant}"
    same = decide_equation(Equation(mutant, printed, box))
    if verdict.status == PROVED and same.status == PROVED:
        return "equal"
    return f"{identity}: {mutant} is {verdict.status} against derived and {same.status} against printed"


@pytest.mark.long
@pytest.mark.parametrize(("name", "sampled", "most"), SAMPLES)
def test_a_sample_of_the_mutants_of_a_paper_falls(name, sampled, most):
    source = random.Random(1)
    everything = list(sides(name))
    chosen = list(cases(source.sample(everything, min(sampled, len(everything))), most, source))
    batches = [chosen[first : first + BATCH] for first in range(0, len(chosen), BATCH)]
    found = []
    for outcome in run_many(lambda batch: [judge(case) for case in batch], batches, 2, SECONDS_OF_BATCH):
        assert not isinstance(outcome.value, Exhausted), outcome.value
        found += outcome.value
    assert set(found) <= {"refuted", "equal"}, [words for words in found if " " in words]
    assert found.count("refuted") > 0.7 * len(chosen)


def test_a_sign_a_number_and_a_function_are_among_the_mutants():
    x = sp.Symbol("x", real=True)
    found = list_mutants(2 * sp.sin(x) ** 2 + 1)
    for expected in (2 * sp.sin(x) ** 2 - 1, 3 * sp.sin(x) ** 2 + 1, 2 * sp.cos(x) ** 2 + 1, 2 * sp.sin(x) ** 3 + 1):
        assert expected in found
