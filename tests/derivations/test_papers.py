"""Every claim of every paper, found by listing the folder: verdicts, coverage, corrections, ledger."""

from __future__ import annotations

import json
from fractions import Fraction

import pytest
import sympy as sp
from flint import fmpq_poly

from navsym.checker import Refused, check, load
from navsym.claims import PROVED, REFUTED, Equation, Finding, Property
from navsym.claims.paper import papers_folder
from navsym.prove.grant import UNCHECKED
from navsym.prove.ladder import decide
from navsym.verification.certificates import Certificates
from navsym.verification.decide import decide_papers
from tests.derivations.statements import PAPERS, module, part_of

HOLDS = {"PROVED", "CERTIFIED"}
FOUND = Finding(True, "found", PROVED)


@pytest.fixture(scope="module", params=PAPERS)
def document(request):
    """The claims of a paper, decided with the certificates beside the ledger, which the checker grants again."""
    kept = Certificates(fresh=False, remark=pytest.fail)
    try:
        return decide_papers([module(request.param)], jobs=1, kept=kept).document()
    finally:
        kept.close()


def stored_statuses(paper):
    """Statuses of the ledger by claim id."""
    stored = json.loads((papers_folder() / "verdicts.json").read_text(encoding="utf-8"))["claims"]
    return {r["id"]: r["status"] for r in stored if r["paper"] == paper}


@pytest.mark.long
@pytest.mark.parametrize("paper", PAPERS)
def test_a_search_without_certificates_comes_to_the_same_verdicts(paper):
    found = decide_papers([module(paper)], jobs=1).claims
    assert {record.id: str(record.status) for record in found} == stored_statuses(paper)


def test_every_verdict_is_the_one_that_its_source_declares(document):
    wrong = [
        (r["id"], r["status"], r["expect"], r["evidence"]) for r in document["claims"] if r["status"] != r["expect"]
    ]
    assert not wrong


def test_every_numbered_equation_is_claimed_or_listed_as_a_definition(document):
    assert [paper["missing"] for paper in document["papers"]] == [[]]


def test_every_refuted_equation_has_a_correction_that_holds(document):
    corrected = {r["corrects"] for r in document["claims"] if r["status"] in HOLDS}
    assert not [r["id"] for r in document["claims"] if r["status"] == "REFUTED" and r["id"] not in corrected]


def test_every_refuted_claim_says_what_is_wrong(document):
    assert not [r["id"] for r in document["claims"] if r["status"] == "REFUTED" and not r["reason"]]


def test_every_open_claim_says_what_was_tried(document):
    assert not [r["id"] for r in document["claims"] if r["status"] == "OPEN" and not r["evidence"]]


def test_what_does_not_rest_on_proof_says_so(document):
    """CONFIRMED is a sampled verdict: its evidence counts the points or the trials."""
    confirmed = [r for r in document["claims"] if r["status"] == "CONFIRMED"]
    assert not [r["id"] for r in confirmed if not any(ch.isdigit() for ch in r["evidence"] + r["scope"])]


def test_all_verdicts_but_one_are_granted_by_the_checker(document):
    """Jensen's formula, of all gains at once, has no words in the language of statements."""
    unchecked = {r["id"] for r in document["claims"] if UNCHECKED in r["evidence"]}
    assert unchecked <= {"trajectory:experiment.together.100"}


def test_a_false_count_or_bound_in_the_place_of_a_true_one_is_not_granted():
    from navsym_papers.multistructure import interval, polygaussian, pulsating
    from navsym_papers.trajectory import algorithm, gain

    truth = pulsating.say_sequences(2, 3, 8), polygaussian.say_walks(3, 2), *interval.mean_of(fmpq_poly([0, 0, 1])).said
    truth += (algorithm.counted({Fraction(1, 3), Fraction(1, 2)})[2],)
    ends = gain.say_yawing("0.06", 3).meaning
    for text in (*truth, *ends):
        assert decide(Property(True, FOUND, (text,))).status.holds
    lies = [{**text, "right": "9"} for text in truth[:2]]
    lies += [{**text, "right": "1/100"} for text in (*truth[2:4], ends[0])]
    lies.append({**truth[4], "left": "sqrt(1/3 - 1/2)"})
    for text in lies:
        assert not decide(Property(True, FOUND, (text,))).status.holds, text


def test_matrices_of_different_sizes_are_refuted_by_their_sizes():
    verdict = decide(Equation(sp.Matrix([[1, 0, 0]]), sp.Matrix([[1, 0]])))
    assert verdict.status == REFUTED
    assert verdict.certificate["statement"]["left"] == "3"


def test_the_ledger_holds_these_verdicts(document):
    fresh = {r["id"]: r["status"] for r in document["claims"]}
    assert fresh == stored_statuses(document["papers"][0]["module"])


def plain_certificates(certificate):
    """The parts of a certificate that joins several, each as a file would hold it."""
    if certificate is None:
        return
    if certificate["kind"] == "all":
        for part in certificate["of"]:
            yield from plain_certificates(part)
    else:
        yield load(json.dumps(dict(certificate)))


@pytest.mark.parametrize("part", ["a dozen", pytest.param("the others", marks=pytest.mark.long)])
def test_the_independent_checker_accepts_every_certificate(document, part):
    """As files would hold them; the statements of all of them were granted for the verdicts above."""
    refused = []
    for record in part_of(document["claims"], part):
        for certificate in plain_certificates(record["certificate"]):
            try:
                check(certificate)
            except Refused as error:
                refused.append((record["id"], str(error)))
    assert not refused


@pytest.mark.parametrize("name", PAPERS)
def test_titles_are_sentences_and_refuted_claims_are_declared_as_such(name):
    for claim in module(name).claims:
        assert len(claim.title) > 10, claim.id
        assert (claim.slip is None) or claim.expect == REFUTED, claim.id
