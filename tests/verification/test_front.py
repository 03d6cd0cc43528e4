"""nav.verify, nav.show and nav.claims: typed answers, and advice for what is none."""

from __future__ import annotations

import pytest

import navsym as nav

STABLE = "alpha_beta_filter:12.stable"


@pytest.fixture(scope="module")
def ledger() -> nav.Ledger:
    return nav.verify("alpha_beta_filter", jobs=1)


def test_a_ledger_is_the_document_of_the_verb_with_types(ledger):
    document = ledger.document()
    assert list(document) == ["claims", "papers", "counts"] and len(document["claims"]) == len(ledger) == 19
    assert document["counts"] == ledger.counts and sum(ledger.counts.values()) == 19
    assert nav.Ledger.from_json(document).document() == document


def test_every_verdict_is_as_declared_and_in_the_stored_ledger(ledger):
    assert not ledger.unexpected and not ledger.missing and not ledger.changed


def test_certificates_of_a_ledger_are_accepted(ledger):
    assert nav.check(ledger).accepted


def test_a_claim_of_the_list_knows_its_formula_and_its_source():
    claim = nav.claims("alpha_beta_filter")[STABLE]
    assert claim.latex == r"4\,r" and claim.status == "PROVED"
    assert claim.id in str(claim.cite()).replace("\\", "")


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: nav.verify("alpha_beta_filte"), "did you mean alpha_beta_filter"),
        (lambda: nav.verify(seconds="soon"), "expected seconds as a number"),
        (lambda: nav.verify(jobs=0), "expected a whole number of jobs"),
        (lambda: nav.show("alpha_beta_filter"), "take one of"),
        (lambda: nav.cite(3), "expected"),
        (lambda: nav.explain(None), "expected"),
        (lambda: nav.claims(status="TRUE"), "expected one of PROVED"),
    ],
)
def test_a_wrong_argument_is_a_navsym_error_with_advice(call, words):
    with pytest.raises(nav.NavsymError, match=words):
        call()
