"""The rules of proofs: what each accepts, and hostile certificates that lack one hypothesis of its theorem."""

from __future__ import annotations

import re
from collections import Counter

import pytest

from navsym import checker
from tests.checker.language import LANGUAGE_FAILS, LANGUAGE_STANDS, MEANINGLESS, NOWHERE_DEFINED, list_language
from tests.checker.proofs import FAILS, HOSTILE, STANDS, TRUE, UNIT, WITNESSES, X0, B, I, answer, prove, refute, state


@pytest.mark.parametrize(("rule", "statement", "witness", "proof"), TRUE, ids=lambda x: str(x)[:40])
def test_a_true_statement_is_accepted_by_the_rule(rule, statement, witness, proof):
    assert rule in str(proof)
    assert answer(checker, statement, prove(statement, witness, proof)) == "HOLDS"


@pytest.mark.parametrize(("rule", "statement", "witness", "proof", "why"), HOSTILE, ids=lambda x: str(x)[:40])
def test_a_proof_that_lacks_a_hypothesis_is_refused_for_it(rule, statement, witness, proof, why):
    assert rule in str(proof)
    assert re.search(why, answer(checker, statement, prove(statement, witness, proof)))


def test_every_rule_has_true_statements_and_hostile_certificates():
    assert {rule for rule, *_ in TRUE} == set(checker.RULES)
    assert {rule for rule, count in Counter(rule for rule, *_ in HOSTILE).items() if count >= 2} == set(checker.RULES)


@pytest.mark.parametrize(("statement", "witness", "proof", "why"), WITNESSES, ids=lambda x: str(x)[:40])
def test_a_malformed_statement_or_a_point_outside_is_no_witness(statement, witness, proof, why):
    assert re.search(why, answer(checker, statement, prove(statement, witness, proof)))


@pytest.mark.parametrize(("statement", "witness", "proofs", "is_true"), [*list_language()], ids=lambda x: str(x)[:60])
def test_the_whole_language_is_read_as_it_is_meant_and_its_false_variants_are_refused(
    statement, witness, proofs, is_true
):
    assert (answer(checker, statement, prove(statement, witness, *proofs)) == "HOLDS") is is_true


@pytest.mark.parametrize(("statement", "why"), MEANINGLESS, ids=lambda x: str(x)[:60])
def test_what_the_language_does_not_mean_is_refused(statement, why):
    assert re.search(why, answer(checker, statement, prove(statement, {}, I)))


@pytest.mark.parametrize(("statement", "witness", "proofs", "why"), NOWHERE_DEFINED, ids=lambda x: str(x)[:60])
def test_a_part_without_a_value_and_a_forgotten_case_are_seen(statement, witness, proofs, why):
    assert re.search(why, answer(checker, statement, prove(statement, witness, *proofs)))


@pytest.mark.parametrize(("statement", "point", "zero"), [*FAILS, *LANGUAGE_FAILS], ids=lambda x: str(x)[:40])
def test_a_point_where_a_statement_fails_refutes_it(statement, point, zero):
    assert answer(checker, statement, refute(statement, point, zero)) == "FAILS"


@pytest.mark.parametrize(("statement", "point", "zero", "why"), [*STANDS, *LANGUAGE_STANDS], ids=lambda x: str(x)[:40])
def test_a_statement_stands_at_a_point_where_it_holds_or_has_no_value(statement, point, zero, why):
    assert re.search(why, answer(checker, statement, refute(statement, point, zero)))


def test_a_certificate_grants_its_own_statement_only():
    statement, other = (state for _, state, *_ in TRUE[:2])
    item = prove(statement, TRUE[0][2], TRUE[0][3])
    assert checker.grant([statement], {"kind": "all", "of": [item]}) == "HOLDS"
    for asked, offered in (
        (other, item),
        ([statement, other], item),
        ([statement, other], {"kind": "all", "of": [item, item]}),
        (statement, {"kind": "all", "of": [item, item]}),
        (statement, {"kind": "all", "of": [{"kind": "all", "of": [item]}]}),
        (statement, {"kind": "identity", "statement": statement, "left": "1", "right": "1", "symbols": []}),
        (statement, refute(other, {"x": "0"})),
        (statement, [item]),
    ):
        with pytest.raises(checker.Refused):
            checker.grant(asked, offered)


@pytest.mark.parametrize(("tolerance", "expected"), [("3/4", "HOLDS"), ("1/4", "not shown"), ("-3/4", "not shown")])
def test_an_equation_with_a_tolerance_bounds_its_difference_on_both_sides(tolerance, expected):
    statement = state("x", "=", "1/2", tolerance=tolerance, x=UNIT)
    assert expected in answer(checker, statement, prove(statement, X0, B, B))
    for sign, proof in ((1, I), (-1, B)):
        one_sided = state("x", "=", str(sign), tolerance="1/2", x=UNIT)
        assert answer(checker, one_sided, prove(one_sided, X0, proof, proof)) != "HOLDS"
