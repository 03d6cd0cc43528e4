"""Rules of judging a paper, held by every claim: kinds, slips and their causes, corrections, quantifiers, scopes."""

from __future__ import annotations

import json
import re
from fnmatch import fnmatchcase
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
    equation_of,
    state,
)
from navsym.claims.paper import import_paper, papers_folder
from navsym.prove.grant import UNCHECKED
from navsym.prove.ladder import decide
from navsym.verification.ledger import Ledger, records_about
from tests.derivations.statements import PAPERS

#: Words of a title that say more than one example: their quantifier has to stand in the scope, or a range in the title.
QUANTIFIERS = re.compile(r"\b(every|always|in general|whatever|on average|inevitably|any|never)\b", re.IGNORECASE)
RANGE = re.compile(r"[\[(][^\])]*\d[^\])]*[\])]|n = \d|\d (to|and|or) \d")


@cache
def read(name):
    package = import_paper(name)
    return package.PAPER, claims_of(package)


@cache
def ledger():
    return Ledger.from_json(json.loads((papers_folder() / "verdicts.json").read_text(encoding="utf-8")))


def records(name):
    return [record for record in ledger() if record.paper == name]


@pytest.mark.parametrize("name", PAPERS)
def test_only_what_is_printed_can_be_a_slip(name):
    paper, claims = read(name)
    assert not [c.id for c in claims if c.slip and paper.kind_of(c.number) not in ("printed", "beside")]


@pytest.mark.parametrize("name", PAPERS)
def test_every_entry_of_a_card_names_a_claim(name):
    paper, claims = read(name)
    numbers = [claim.number.rstrip("*") for claim in claims]
    named = [*f"{paper.beside} {paper.remarks} {paper.beyond}".split(), *paper.causes, *paper.scopes]
    assert not [one for one in named if not any(fnmatchcase(number, one) for number in numbers)]


@pytest.mark.parametrize("name", PAPERS)
def test_a_cause_is_a_slip_that_is_counted_itself(name):
    paper, claims = read(name)
    slips = {claim.number for claim in claims if claim.slip and claim.expect == REFUTED}
    assert set(paper.causes) <= slips
    assert set(paper.causes.values()) <= slips - set(paper.causes)


@pytest.mark.parametrize("name", PAPERS)
def test_what_is_left_out_says_why(name):
    paper, _ = read(name)
    assert all(statement.strip() and why.strip() for statement, why in paper.left_out.items())


@pytest.mark.parametrize("name", PAPERS)
def test_a_correction_has_a_star_and_says_something_else(name):
    known = {record.id: record for record in records(name)}
    for record in known.values():
        if record.corrects:
            wrong = known[record.corrects]
            assert record.id == f"{wrong.id}*" and wrong.status == REFUTED, record.id
            assert (record.printed, record.derived) != (wrong.printed, wrong.derived), record.id


@pytest.mark.parametrize("name", PAPERS)
def test_a_quantifier_in_a_title_stands_in_the_scope(name):
    held = [record for record in records(name) if record.status.holds and QUANTIFIERS.search(record.title)]
    named = {r.id for r in held if r.scope.startswith("all ") or re.search(r"\d", r.scope) or RANGE.search(r.title)}
    assert not {record.id for record in held} - named


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


@pytest.mark.parametrize("name", PAPERS)
def test_a_verdict_without_a_certificate_says_why(name):
    bare = [record for record in records(name) if UNCHECKED in record.evidence]
    assert all(record.certificate is None for record in bare)
    assert not [record.id for record in bare if not re.search(re.escape(UNCHECKED) + r" \(\w.{10,}\)", record.evidence)]


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
