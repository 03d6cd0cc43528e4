"""One-token mutants of the proven formulas: refuted with a point, or proved equal to the original."""

from __future__ import annotations

import importlib
import random

import pytest
import sympy as sp

from navsym.claims import PROVED, REFUTED, Equation, claims_of
from navsym.proof.equations import decide_equation, entries
from navsym.proof.mutants import mutants
from navsym.proof.sandbox import Exhausted, run_many


def proven_equations(name):
    for claim in claims_of(importlib.import_module(f"derivations.{name}")):
        if claim.expect == PROVED:
            statement = claim.derive()
            if isinstance(statement, Equation) and statement.tolerance is None:
                yield claim.id, statement


def sides(name):
    """(id, printed entry, derived entry, box) of every proven equation."""
    for identity, statement in proven_equations(name):
        for printed, derived in zip(entries(statement.printed), entries(statement.derived), strict=True):
            yield identity, printed, derived, statement.box


def cases(some_sides, most=None, source=None):
    """(id, mutant, printed entry, derived entry, box): all mutants of the sides, or a sample of each."""
    for identity, printed, derived, box in some_sides:
        found = mutants(printed)
        if most is not None and len(found) > most:
            found = source.sample(found, most)
        yield from ((identity, mutant, printed, derived, box) for mutant in found)


def judge(case):
    """'refuted', 'equal' or a description of what went wrong."""
    identity, mutant, printed, derived, box = case
    against_derived = decide_equation(Equation(mutant, derived, box))
    if against_derived.status == REFUTED:
        return (
            "refuted" if against_derived.counterexample is not None else f"{identity}: no point for {mutant}"
        )
    same = decide_equation(Equation(mutant, printed, box))
    if against_derived.status == PROVED and same.status == PROVED:
        return "equal"
    return (
        f"{identity}: {mutant} is {against_derived.status} against derived and {same.status} against printed"
    )


def run(chosen):
    found = {"refuted": 0, "equal": 0}
    wrong = []
    batches = [chosen[i : i + 40] for i in range(0, len(chosen), 40)]
    for outcome in run_many(lambda batch: [judge(case) for case in batch], batches, jobs=2, seconds=300):
        assert not isinstance(outcome.value, Exhausted), outcome.value
        for result in outcome.value:
            if result in found:
                found[result] += 1
            else:
                wrong.append(result)
    return found, wrong


def test_mutants_of_the_guaranteed_velocity_formulas_fall():
    source = random.Random(1)
    some = source.sample(list(sides("guaranteed_velocity")), 60)
    found, wrong = run(list(cases(some, 4, source)))
    assert not wrong
    assert found["refuted"] > 100


@pytest.mark.slow
def test_all_mutants_of_the_guaranteed_velocity_formulas_fall():
    found, wrong = run(list(cases(sides("guaranteed_velocity"))))
    print(found)
    assert not wrong
    assert found["refuted"] + found["equal"] >= 1000


def test_a_sign_a_number_and_a_function_are_among_the_mutants():
    x = sp.Symbol("x", real=True)
    found = mutants(2 * sp.sin(x) ** 2 + 1)
    for expected in (
        2 * sp.sin(x) ** 2 - 1,
        3 * sp.sin(x) ** 2 + 1,
        2 * sp.cos(x) ** 2 + 1,
        2 * sp.sin(x) ** 3 + 1,
    ):
        assert expected in found
