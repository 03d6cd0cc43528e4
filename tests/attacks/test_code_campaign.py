"""One-token mutants of code in four languages: a few here, thousands by ``python -m tests.attacks.campaigns.code``."""

from __future__ import annotations

import pytest

from tests.attacks.campaigns.code import (
    Subject,
    compute,
    is_same,
    judge,
    lacking_tool,
    list_mutants,
    list_subjects,
    make_batches,
)

SUM = Subject(
    "sum", "double f(double a, const double v[2], double y[1])\n{\n    y[0] = a + v[1];\n    return a;\n}\n", "f"
)


def test_a_subject_knows_its_parameters_and_every_token_has_its_turn():
    assert SUM.parameters() == [("a", None, False), ("v", (2,), False), ("y", (1,), True)] and SUM.outputs() == [
        "y",
        "return",
    ]
    mutants = list_mutants(SUM)
    assert len({*mutants}) == len(mutants) > 10 and SUM.text not in mutants
    assert any("a - v[1]" in mutant for mutant in mutants) and any("v[0]" in mutant for mutant in mutants)


def test_a_batch_repeats_no_mutant_of_another():
    batches = make_batches(500, seed=3)
    assert len({batch.name for batch in batches}) == len(batches) == 5


def test_only_numbers_are_compared():
    assert is_same([1.0], [1.0]) and not is_same([1.0], [1.1]) and is_same([1.0], [float("nan")]) is None


@pytest.mark.parametrize(
    ("name", "language"),
    [("gravity_sign.after", "c"), ("horizontal_field.before", "c"), ("process_noise.after", "python"),
     ("coriolis.after", "matlab"), ("normal_gravity.after", "rust")],
)  # fmt: skip
def test_no_mutant_is_proved_equal_that_computes_something_else(name, language):
    if why := lacking_tool(language):
        pytest.skip(why)
    assert name in {subject.name for subject in list_subjects()}
    found = judge((name, 0, 10, 1))
    assert not found["wrong"] and found["counts"].get("REFUTED and another", 0) >= 3


@pytest.mark.skipif(lacking_tool("c") != "", reason="needs gcc")
def test_what_the_compiler_refuses_and_what_never_ends_computes_nothing_and_the_others_do():
    texts = [SUM.text, SUM.text.replace("v[1]", "w[1]"), SUM.text.replace("return a", "for (;;) {} return a"),
             SUM.text.replace("v[1]", "g(1)"), SUM.text.replace("+", "-")]  # fmt: skip
    first, *others, last = compute(texts, SUM, 1)
    assert others == [None, None, None] and is_same(first, first) and is_same(first, last) is False
