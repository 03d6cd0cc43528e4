"""Rules of judging a paper, held by every claim: kinds, slips and their causes, corrections, quantifiers, scopes."""

from __future__ import annotations

import json
import re
from dataclasses import replace
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
from tests.derivations.answered import ANSWERED
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


#: Rules that read every number of a paper take as long as all others.
SOME = [
    pytest.param(rule, marks=[pytest.mark.long] * (rule.__name__ == "numbers_of_no_statement"), id=rule.__name__)
    for rule in RULES
]


@pytest.mark.parametrize("rule", SOME)
@pytest.mark.parametrize("name", PAPERS)
def test_no_paper_breaks_a_rule(name, rule):
    paper, claims = read(name)
    answered = {one for one in ANSWERED.get(rule.__name__, {}) if one.startswith(f"{name}:")}
    assert {*rule(Judged(paper, claims, tuple(records(name))))} == answered


#: Rule, claim, and what its title or its scope said before it was mended, or would say too much.
SAID_TOO_MUCH = (
    ("ranges_narrower_than_the_title", "guaranteed_velocity:range.y1", {"scope": "all T in (0, 2*pi]"}),
    ("ranges_narrower_than_the_title", "guaranteed_velocity:4.11.nonzero-beyond", {"title": "det N, T <= 7."}),
    ("ranges_narrower_than_the_title", "guaranteed_velocity:range.y3.last", {"title": "y3, T >= pi/2: half of it."}),
    ("sizes_in_no_scope", "trajectory:window.legendre", {"scope": "numbers"}),
    ("sizes_in_no_scope", "terrain_search:acceleration", {"scope": "all real a"}),
    ("sizes_in_no_scope", "multistructure:accumulate.all", {"title": "Partial estimates added give (12) and (13)."}),
    (
        "words_that_nothing_shows",
        "multistructure:10.error.steady",
        {"title": "An error of 2 c/(1 - kappa) stays; from zero it never gets there."},
    ),
    ("numbers_of_no_statement", "trajectory:window.figures", {"title": "For 0.019 m/s n = 5 needs 183.5 s."}),
    ("numbers_under_a_general_title", "alpha_beta_filter:index-one", {"title": "The gains of the filter."}),
    (
        "figures_that_choose_alone",
        "trajectory:experiment.sigma_v.2",
        {"title": "|V| = 2 m/s: a stable gain gives 0.06 m/s on a straight course."},
    ),
)


@pytest.mark.parametrize(("rule", "name", "words"), SAID_TOO_MUCH)
def test_a_title_that_says_too_much_is_found(rule, name, words):
    (rule,) = [one for one in RULES if one.__name__ == rule]
    paper, claims = read(name.partition(":")[0])
    (claim,) = [one for one in claims if one.id == name]
    (record,) = [one for one in records(paper.module) if one.id == name]
    assert name not in rule(Judged(paper, (claim,), (record,)))
    assert name in rule(Judged(paper, (claim,), (replace(record, **words),)))


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
