"""Random formulas printed in several styles are read back with the same value, computed by numpy."""

from __future__ import annotations

import random

import numpy as np
import pytest

import navsym as nav
from tests.language.latex.printed_trees import FUNCTIONS, SYMBOLS, VALUES, Printer


def evaluate(text):
    """The value of a text of our own, by Python's arithmetic on arrays."""
    return eval(text, {"__builtins__": {}}, {**VALUES, **FUNCTIONS})


def read_back(seeds):
    """The seeds of formulas that are refused, with the reasons; the others have their value."""
    refused = {}
    for seed in seeds:
        source = random.Random(seed)
        kind = source.choice(["scalar", "scalar", "vector", "matrix"])
        part = Printer(source).draw(kind, source.choice([1, 2, 3, 4]))
        (formula,) = nav.read(f"{part.latex} = {part.latex}", symbols=SYMBOLS).formulas
        if formula.status != "READ":
            refused[seed] = f"{part.latex}: {formula.why}"
            continue
        value = np.asarray(evaluate(formula.left), dtype=float)
        assert value.shape == np.shape(part.value), (part.latex, formula.left)
        np.testing.assert_allclose(value, part.value, rtol=1e-9, atol=1e-9, err_msg=part.latex)
    return refused


def test_random_formulas_keep_their_value():
    assert read_back(range(400)) == {}


@pytest.mark.long
def test_two_thousand_random_formulas_keep_their_value():
    assert read_back(range(1_000, 3_000)) == {}
