"""Rules of judging a paper, held by every claim: kinds, slips and their causes, corrections, quantifiers, scopes."""

from __future__ import annotations

import json
import re
from functools import cache

import pytest

from navsym.claims import (
    CERTIFIED,
    CONFIRMED,
    OPEN,
    REFUTED,
    UNDECIDED,
    Finding,
    Property,
    claims_of,
    compare_equations,
    equation_of,
    state,
)
from navsym.claims.paper import import_paper, papers_folder
from navsym.prove.ladder import decide
from navsym.verification.ledger import Ledger, records_about
from tests.derivations.rules import RULES, Judged
from tests.derivations.statements import PAPERS


@cache
def read(name):
    package = import_paper(name)
    return package.PAPER, claims_of(package)


@cache
def ledger():
    return Ledger.from_json(json.loads((papers_folder() / "verdicts.json").read_text(encoding="utf-8")))


def records(name):
    return [record for record in ledger() if record.paper == name]


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
@pytest.mark.parametrize("name", PAPERS)
def test_no_paper_breaks_a_rule(name, rule):
    paper, claims = read(name)
    assert not rule(Judged(paper, claims, tuple(records(name))))


@pytest.mark.parametrize("name", PAPERS)
def test_the_ledger_holds_titles_kinds_and_causes_of_the_sources(name):
    paper, claims = read(name)
    stored = {r.number: (r.title, r.kind, r.cause, r.slip, r.reason) for r in records(name)}
    causes = {number: f"{name}:{cause}" for number, cause in paper.causes.items()}
    assert stored == {
        c.number: (c.title, paper.kind_of(c.number), causes.get(c.number), c.slip, c.reason) for c in claims
    }


@pytest.mark.parametrize("name", PAPERS)
def test_an_equation_has_the_colour_of_its_own_formula(name):
    """Not of a sentence or a remark beside it, and not of a slip that another claim counts."""
    paper, _ = read(name)
    for equation in paper.equations:
        for record in records_about(equation, paper.equations, records(name)):
            assert record.kind == "printed" and record.cause is None
            assert equation_of(record.number, paper.equations) == equation


def test_a_sentence_beside_a_definition_claims_no_formula():
    assert compare_equations(*read("multistructure")).definitions == ("1", "2", "4", "6")


@pytest.mark.parametrize("value", [UNDECIDED, None, (True, UNDECIDED)])
@pytest.mark.parametrize("printed", [True, UNDECIDED, "best"])
def test_an_undecided_finding_is_open_whatever_is_printed(value, printed):
    assert decide(Property(printed, Finding(value, "a method that gave up", CERTIFIED))).status == OPEN


def test_a_finding_says_how_strongly_it_was_decided():
    with pytest.raises(TypeError, match="status"):
        Finding(True, "a method")


def test_a_run_confirms_and_never_refutes():
    assert decide(Property(True, Finding(True, "a run", CONFIRMED))).status == CONFIRMED
    assert decide(Property(True, Finding(False, "a run", CONFIRMED))).status == OPEN


def test_what_a_fact_means_has_the_last_word():
    """A fact that was found, and a meaning that is false, are OPEN; and so is a refutation of what is true."""
    true, false = (state(count, "=", "product(3, k, 1, 5)") for count in ("243", "242"))

    def judge(printed, found, *meaning):
        return decide(Property(printed, Finding(found, "a count", CERTIFIED), meaning))

    granted = judge(243, 243, true)
    assert granted.status == CERTIFIED and granted.certificate["statement"] == true
    assert judge(243, 243, false).status == judge(243, 243, true, false).status == OPEN
    refuted = judge(242, 243, true, false)
    assert refuted.status == REFUTED and refuted.certificate["statement"] == false
    assert judge(242, 243, true).status == OPEN


@pytest.mark.parametrize("speed", ["2", "300"])
def test_the_figures_of_one_sentence_are_decided_for_one_gain(speed):
    """Straight course, yawing and position of one speed; that some gain gives all three is OPEN."""
    found = {record.number: record for record in records("trajectory")}
    title = found[f"experiment.sigma_v.{speed}"].title
    assert "a stable gain" in title and len(re.findall(r"\b0\.\d+", title)) == 4
    assert found["experiment.together"].status == OPEN
