"""A side without a value spoils its own claim only, when the reader is asked to go on."""

from __future__ import annotations

import json

import pytest

from navsym.cli.main import run
from navsym.core.errors import DomainError, EmptyError
from navsym.prove.claimfile import claims_from, decide_claims

GOOD = {"id": "good", "left": "a + a", "right": "2*a"}
POLE = {"id": "pole", "left": "1/0", "right": "a"}
ROOT = {"id": "root", "left": "a", "right": "(-8)**(1/3)"}


def document(*claims):
    return {"symbols": {"a": "real"}, "claim": list(claims)}


def test_without_being_asked_the_whole_file_is_refused():
    with pytest.raises(DomainError):
        claims_from(document(GOOD, POLE), "f")


def test_the_other_claims_are_decided_and_the_error_stands_in_its_place():
    found = decide_claims(claims_from(document(ROOT, GOOD, POLE), "f", go_on=True)).document()
    assert [claim["id"] for claim in found["claims"]] == ["root", "good", "pole"]
    assert [claim["status"] for claim in found["claims"]] == ["OPEN", "PROVED", "OPEN"]
    assert found["error"] == found["claims"][0]["error"]
    assert found["error"]["kind"] == "domain" and found["error"]["where"].startswith("f: claim[0].right")


def test_a_file_of_nothing_else_is_refused():
    with pytest.raises(DomainError):
        claims_from(document(POLE), "f", go_on=True)


@pytest.mark.parametrize(
    "wrong",
    [{"id": "open", "left": "(a", "right": "a"}, {"id": "typo", "left": "a"}, {"id": "key", "left": "a", "rihgt": "a"}],
)
def test_what_is_wrong_in_any_other_way_spoils_its_own_claim_only(wrong):
    found = decide_claims(claims_from(document(GOOD, wrong), "f", go_on=True)).document()
    assert [(claim["id"], claim["status"]) for claim in found["claims"]] == [("good", "PROVED"), (wrong["id"], "OPEN")]
    assert found["error"]["where"].startswith("f: claim[1]")


def test_a_claim_without_a_label_refuses_the_file():
    with pytest.raises(EmptyError):
        claims_from(document(GOOD, {"left": "a", "right": "a"}), "f", go_on=True)


def test_the_verb_answers_with_verdicts_an_error_and_status_two(tmp_path, capsys):
    path = tmp_path / "formulas.toml"
    lines = ([f'{key} = "{value}"' for key, value in claim.items()] for claim in (POLE, GOOD))
    blocks = "".join("\n".join(["[[claim]]", *claim, ""]) for claim in lines)
    path.write_text(f'[symbols]\na = "real"\n{blocks}')
    assert run(["prove", str(path), "--json"]) == 2
    answer = json.loads(capsys.readouterr().out)
    assert answer["error"]["kind"] == "domain"
    assert [claim["status"] for claim in answer["claims"]] == ["OPEN", "PROVED"]


def test_the_scope_names_symbols_that_the_algebra_has_cancelled():
    (claim,) = decide_claims(claims_from(document({"id": "one", "left": "a/a", "right": "1"}), "f")).document()[
        "claims"
    ]
    assert claim["scope"] == "all real a" and claim["assumptions"] == ["a != 0"]
