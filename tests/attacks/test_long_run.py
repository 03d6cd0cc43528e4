"""The schemes of the long attack: their truths are true, and no verdict on them is wrong."""

from __future__ import annotations

import json
from fractions import Fraction

import pytest

from tests.attacks import matrix_schemes
from tests.attacks.constructs import SCHEMES as BEFORE
from tests.attacks.constructs import Construct
from tests.attacks.long_run import SCHEMES, decide_here, draw, make_table, outcome_here, run

SEED = 2026
NAMES = sorted(set(SCHEMES) - set(BEFORE))


def judge(name, numbers):
    """How many statements are decided; none may be wrong, or confirmed and false."""
    decided = 0
    for number in numbers:
        statement = draw(name, SEED, number)
        found, why = outcome_here(statement)
        assert found not in ("wrong", "false confirmed"), (statement, why)
        decided += found == "decided"
    return decided


@pytest.mark.parametrize("name", NAMES)
def test_no_verdict_on_a_scheme_is_wrong(name):
    assert judge(name, range(2)) >= 1


@pytest.mark.long
@pytest.mark.parametrize("name", NAMES)
def test_no_verdict_of_forty_on_a_scheme_is_wrong(name):
    assert judge(name, range(2, 42)) >= 14


def test_every_scheme_draws_true_and_false_statements():
    for name in NAMES:
        assert 3 <= sum(draw(name, SEED, number).truth for number in range(40)) <= 37, name


def test_a_wrong_verdict_and_a_late_one_are_noticed():
    given = {"A": {"matrix": ["n", "n"]}, "B": {"matrix": ["n", "n"]}}
    assert outcome_here(Construct("A @ B = B @ A", True, given))[0] == "wrong"
    assert outcome_here(Construct("trace(A @ B) = trace(B @ A)", False, given))[0] == "wrong"
    assert outcome_here(Construct("cos(x) + cos(sqrt(2)*x) > -2", True, {"x": "real"}), 0.05) == ("open", "time")


def test_a_point_without_a_value_is_passed_over():
    """A number beside a case has a root with no value at a point; the search went no further before."""
    statement = Construct("min(min(z, x), abs(x)) = min(abs(x), min(z, x))", True, {"x": "real", "z": "real"})
    assert str(decide_here(statement).status) == "PROVED"


def test_values_of_the_trees_are_those_of_the_theory():
    numbers = [[Fraction(k)] for k in (1, 2, 3, 4)]
    square = matrix_schemes.dot(numbers, numbers)
    turn = matrix_schemes.rot(numbers)
    product = matrix_schemes.times(turn, matrix_schemes.flip(turn))
    assert product == [[square**2 if i == j else 0 for j in range(3)] for i in range(3)]
    assert matrix_schemes.determinant(turn) == square**3
    one = matrix_schemes.times(turn, matrix_schemes.inverse(turn))
    assert one == matrix_schemes.unit(3)


def test_a_run_writes_its_counts_and_they_add_up(tmp_path):
    schemes = {name: SCHEMES[name] for name in ("any_size", "independent_moments")}
    for seed in (1, 2):
        run(seed, 0.5, tmp_path / f"{seed}.log", schemes)
    logs = sorted(tmp_path.iterdir())
    counts = [json.loads(path.read_text(encoding="utf-8").splitlines()[-1])["counts"] for path in logs]
    asked = sum(sum(outcomes.values()) for one in counts for outcomes in one.values())
    last = make_table(logs).splitlines()[-1]
    assert last.startswith(f"| all | {asked} |") and asked > 0
