"""Another implementation of the exact kinds, in plain fractions, is of the checker's opinion."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from navsym import checker
from tests.checker import second
from tests.checker.examples import EXPONENTIAL, RANK
from tests.checker.forgeries import EQUAL, FORGERIES, UNEQUAL, changed, identity, verdict

EXACT_KINDS = ("identity", "exponential", "rank")
SEEDS = range(4)
LEDGER = Path(__file__).resolve().parents[2] / "derivations" / "verdicts.json"


def opinion(item) -> bool | None:
    """True or False at random points of several seeds; None outside its language."""
    try:
        return all(second.accepted(item, seed) for seed in SEEDS)
    except second.OutsideError:
        return None


@pytest.mark.parametrize("pair", [*EQUAL, *UNEQUAL], ids=lambda pair: " = ".join(pair)[:40])
def test_both_are_of_one_opinion_on_school_identities(pair):
    if "499999" in pair[0] or "1/3" in pair[0]:
        pytest.skip("a large power; a cube root beside a square root")
    second_opinion = opinion(identity(*pair))
    assert second_opinion in (None, verdict(identity(*pair), checker) == "")


@pytest.mark.parametrize("item", [EXPONENTIAL, RANK], ids=lambda item: item["kind"])
def test_both_accept_an_exponential_and_a_rank(item):
    assert opinion(item) and verdict(item, checker) == ""


def test_both_refuse_what_is_false_in_an_exact_kind():
    wrong = ("the sides differ", "X' differs", "X\\(0\\) differs", "does not vanish")
    forged = [changed(item, path, new) for item, path, new, why in FORGERIES if why in wrong]
    exact = [item for item in forged if item["kind"] in EXACT_KINDS]
    assert len(exact) >= 4
    assert not [item for item in exact if opinion(item) is not False]


def mistaken(text: str) -> str:
    """The text with its first sign, function or digit changed into another."""
    for old, new in (("sin(", "cos("), ("exp(-", "exp(2*-"), (" + ", " - "), (" - ", " + "), ("*", "*2*")):
        if old in text:
            return text.replace(old, new, 1)
    return f"{text} + 1"


@pytest.mark.slow
def test_both_are_of_one_opinion_on_what_the_ledger_proves_and_on_one_mistake_in_each():
    """Scalar equations of the ledger of up to 200 characters, as printed and derived, and with one mistake."""
    proved = [r for r in json.loads(LEDGER.read_text(encoding="utf-8"))["claims"] if r["status"] == "PROVED"]
    short = [r for r in proved if r["derived"] and len(r["printed"] + r["derived"]) < 200]
    judged = 0
    for record in short:
        for left in (record["printed"], mistaken(record["printed"])):
            item = {"kind": "identity", "left": left, "right": record["derived"], "symbols": names(record)}
            answer = verdict(item, checker)
            if answer in ("", "the sides differ"):
                second_opinion = opinion(item)
                judged += second_opinion is not None
                assert second_opinion in (None, answer == ""), item
    assert judged > 50


def names(record) -> list[str]:
    found = set(re.findall(r"[A-Za-z]\w*", record["printed"] + " " + record["derived"]))
    return sorted(found - {"pi", "sin", "cos", "tan", "cot", "exp", "sqrt", "log", "abs"})
