"""A record is its entry in the ledger and in the document of ``navsym verify``, and nothing is lost on the way."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from navsym.claims import REFUTED, Status
from navsym.claims.record import Record
from navsym.core.numbers import Number

LEDGER = Path(__file__).parents[2] / "derivations" / "verdicts.json"


@pytest.fixture(scope="module")
def entries():
    return json.loads(LEDGER.read_text(encoding="utf-8"))["claims"]


def test_every_entry_of_the_ledger_comes_back(entries):
    for entry in entries:
        again = Record.from_json(entry).ledger_json()
        assert again == entry and list(again) == list(entry)


def test_every_entry_of_the_document_comes_back(entries):
    for entry in entries:
        whole = {key: value for key, value in entry.items() if key != "statement"}  # which is in ledgers only
        whole |= {"certificate": {"kind": "identity"}, "seconds": 0.25}
        again = Record.from_json(whole).to_json()
        assert again == whole and list(again) == list(whole)


def test_a_record_has_typed_values(entries):
    record = next(Record.from_json(entry) for entry in entries if entry["difference"] and entry["counterexample"])
    assert isinstance(record.status, Status) and record.status == REFUTED and record.is_expected
    assert isinstance(record.difference, Number) and isinstance(record.assumptions, tuple)
    assert " = " in record.point_text
