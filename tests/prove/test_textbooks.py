"""A hundred formulas of textbooks, drawn before any was tried: each holds, and each false variant is refuted."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

import navsym as nav

FORMULAS = tomllib.loads(Path(__file__).with_name("textbooks.toml").read_text(encoding="utf-8"))["formula"]
EACH = [pytest.param(f, id=f["id"], marks=() if k % 6 == 0 else pytest.mark.long) for k, f in enumerate(FORMULAS)]


def decide(formula, side):
    more = {key: formula[key] for key in ("given", "rates", "order", "tolerance") if key in formula}
    return nav.prove(formula[side], **more, **formula.get("symbols", {}))


def test_there_are_a_hundred_of_different_names():
    assert len({formula["id"] for formula in FORMULAS}) == len(FORMULAS) == 100


@pytest.mark.parametrize("formula", EACH)
def test_the_formula_holds(formula):
    verdict = decide(formula, "true")
    assert verdict.status in ("PROVED", "CERTIFIED")
    assert verdict.check()


@pytest.mark.parametrize("formula", EACH)
def test_the_false_variant_is_refuted(formula):
    assert decide(formula, "false").status == "REFUTED"
