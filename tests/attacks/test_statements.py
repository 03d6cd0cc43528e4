"""Statements of known truth: the truth is checked without the prover, and the prover by the truth."""

from __future__ import annotations

import random

import pytest

import navsym as nav
from tests.attacks.campaigns import statements as campaign
from tests.attacks.evaluator import digits_of, judge_text
from tests.attacks.schemes.files import draw_statements, write_file
from tests.attacks.statements import Statement, all_schemes, attack, contradiction, judge, make_statement
from tests.attacks.trees import derivative, read, write

SEED = 18
MANY = 2_000
SECONDS = 2.0  # of processor time, for one statement
FAMILIES = tuple(all_schemes())


def fault_of_truth(statement: Statement) -> str:
    """Where the evaluator contradicts the known truth; empty when it does not."""
    if statement.truth is True:
        return contradiction(statement, ["in words"])
    if statement.truth is False and statement.witness is not None:
        found = statement.judge_at(statement.witness)
        return "" if found in ("fails", "unknown") else f"{found} at {statement.witness}"
    return ""


def test_the_known_truth_stands_against_the_evaluator():
    faults = {}
    for number in range(4 * len(all_schemes())):
        statement = make_statement(number, SEED)
        if why := fault_of_truth(statement):
            faults[statement.text] = why
    assert not faults


@pytest.mark.long
def test_the_known_truth_of_two_thousand_statements():
    assert not {s.text: why for s in (make_statement(k, SEED) for k in range(MANY)) if (why := fault_of_truth(s))}


def test_a_number_and_a_seed_give_one_statement():
    assert make_statement(7, SEED) == make_statement(7, SEED) != make_statement(7, SEED + 1)


@pytest.mark.parametrize(
    "text", ["-x**2", "a - (b - c)", "a/(b*c)", "2 - (-3)", "a**(-b)", "a**b**c", "(-2)**x", "a*(-b)"]
)
def test_what_is_written_is_read_again(text):
    assert read(write(read(text))) == read(text)


def test_values_agree_with_printed_ones():
    assert digits_of("acos(1 - 1e-20) - 1e-10", 12) == "0.0000000000414213562373"
    assert digits_of("(1 - 1000/44330.77)**5.25588", 12) == "0.886992970356"
    assert judge_text("cos(x) < 1", {"x": "1"}) == "holds" and judge_text("log(x) = 1", {"x": "0"}) == "undefined"


def test_a_derivative_is_the_slope():
    slope = write(derivative(read("x**2*sin(x)/sqrt(1 + x) + atan2(x, 2) + x**x"), "x"))
    quotient = "((x + h)**2*sin(x + h)/sqrt(1 + x + h) + atan2(x + h, 2) + (x + h)**(x + h)" + (
        " - (x**2*sin(x)/sqrt(1 + x) + atan2(x, 2) + x**x))/h"
    )
    assert judge_text(f"abs({slope} - {quotient}) < 1e-12", {"x": "0.7", "h": "1e-14"}) == "holds"


def judge_some(numbers: range) -> list[str]:
    """What is wrong with the verdicts of these statements, false CONFIRMED ones included where they are excluded."""
    faults = []
    for number in numbers:
        statement = make_statement(number, SEED)
        found = attack(statement, SECONDS)
        if found.outcome in ("wrong", "false confirmed"):
            faults.append(f"{found.status}: {statement.text} with {statement.symbols}: {found.why}")
    return faults


@pytest.mark.parametrize("place", range(len(FAMILIES)), ids=FAMILIES)
def test_no_verdict_is_wrong(place):
    assert judge_some(range(place, len(FAMILIES), len(FAMILIES))) == []


@pytest.mark.long
@pytest.mark.parametrize("place", range(len(FAMILIES)), ids=FAMILIES)
def test_no_verdict_of_two_thousand_is_wrong(place):
    assert judge_some(range(place + len(FAMILIES), MANY, len(FAMILIES))) == []


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
def test_no_verdict_of_an_odd_file_is_wrong(seed, tmp_path):
    rng = random.Random(seed)
    statements = draw_statements(rng, 6)
    write_file(tmp_path / "odd.toml", statements, rng)
    verdicts = nav.prove(tmp_path / "odd.toml", seconds=SECONDS)
    found = {s.text: judge(s, v) for s, v in zip(statements, verdicts, strict=True)}
    assert not {text: said for text, said in found.items() if said.outcome == "wrong"}


def test_a_wrong_verdict_of_each_kind_is_noticed():
    true, false = Statement("x**2 >= 0", True), Statement("x > 0", False, {"x": ["-1", "1"]}, {"x": "-1"})
    partial = Statement("log(x) - log(x) = 0", True)
    said = {
        "a false proof": judge(false, verdict("PROVED")),
        "a true statement refuted": judge(true, verdict("REFUTED", {"x": "1"})),
        "a point outside": judge(false, verdict("REFUTED", {"x": "-2"})),
        "a point where it holds": judge(false, verdict("REFUTED", {"x": "1/2"})),
        "a missing assumption": judge(partial, verdict("PROVED")),
        "a forged certificate": judge(true, verdict("PROVED", certificate={"kind": "identity"})),
        "the proof of another statement": judge(Statement("x**2 >= 1 - 1", True), nav.prove("x**2 >= 0")),
    }
    assert {name: one.outcome for name, one in said.items()} == dict.fromkeys(said, "wrong")
    assert judge(false, verdict("CONFIRMED")).outcome == "false confirmed"
    assert judge(partial, verdict("PROVED", assumptions=("x > 0",))).outcome == "decided"
    assert judge(false, verdict("REFUTED", {"x": "-1/2"})).outcome == "decided"


def verdict(status: str, counterexample=None, certificate=None, assumptions=()) -> nav.Verdict:
    """A verdict as the prover would give it."""
    return nav.Verdict(
        nav.Status(status), "test", counterexample=counterexample, certificate=certificate, assumptions=assumptions
    )


def test_the_campaign_counts_by_family():
    document = campaign.judge(("statements", 3, 5 * 10**6))
    assert sum(n for name, n in document["counts"].items() if not name.startswith("kind ")) == 3
    table = campaign.make_table(document["counts"])
    assert table.splitlines()[-1].startswith("| all |") and len(table.splitlines()) == 6
