"""One-token mutants of the proven formulas of the papers on joint correction and on trajectories."""

from __future__ import annotations

import importlib.util
import random
from pathlib import Path

import pytest

PAPERS = ("joint_correction", "trajectory")
PLACE = Path(__file__).with_name("test_mutants.py")
SPEC = importlib.util.spec_from_file_location("mutants_of_claims", PLACE)
MUTANTS = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(MUTANTS)
cases, run, sides = MUTANTS.cases, MUTANTS.run, MUTANTS.sides


@pytest.mark.parametrize("name", PAPERS)
def test_a_sample_of_the_mutants_falls(name):
    source = random.Random(4)
    everything = list(sides(name))
    some = source.sample(everything, min(40, len(everything)))
    found, wrong = run(list(cases(some, 2, source)))
    assert not wrong
    assert found["refuted"] > 30


@pytest.mark.slow
@pytest.mark.parametrize("name", PAPERS)
def test_every_mutant_falls(name):
    found, wrong = run(list(cases(sides(name))))
    print(name, found)
    assert not wrong
