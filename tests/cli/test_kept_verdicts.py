"""Verdicts are kept for the code that gave them: of sources that change meanwhile nobody knows which version ran."""

from __future__ import annotations

import contextlib
import json
import sqlite3

import pytest

from navsym.claims import Record
from navsym.cli.main import run
from navsym.verification import decide, verdict_store
from navsym.verification.papers import load_papers


@pytest.fixture(autouse=True)
def own_store(monkeypatch, tmp_path):
    monkeypatch.setenv("NAVSYM_CACHE", str(tmp_path))


def claims(capsys, *options):
    status = run(["verify", "alpha_beta_filter", "--json", "--jobs", "1", *options])
    return status, json.loads(capsys.readouterr().out)


def test_verdicts_of_sources_that_changed_while_they_were_imported_are_named_and_not_kept(monkeypatch, capsys):
    monkeypatch.setattr(decide, "sources", lambda: (("ladder.py", 1, 1),))
    status, document = claims(capsys)
    assert status == 3 and len(document["unsaved"]) == len(document["claims"])


def test_a_source_that_is_imported_later_must_stay_as_it_was(monkeypatch):
    chosen, said = load_papers(["alpha_beta_filter"]), []
    before = (*verdict_store.sources(), ("not_imported_yet.py", 1, 1))
    monkeypatch.setattr(verdict_store, "sources", lambda: before)
    store = verdict_store.VerdictStore(chosen, False, before, said.append)
    plain = dict.fromkeys(Record.__dataclass_fields__, "") | {"status": "PROVED", "expect": "PROVED", "assumptions": []}
    plain |= {"id": chosen[0].claims[0].id, "method": "identity", "counterexample": None, "difference": None}
    record = Record.from_json(plain)
    store.keep(record)
    assert not store.lost
    monkeypatch.setattr(verdict_store, "sources", lambda: (*before[:-1], ("not_imported_yet.py", 2, 1)))
    store.keep(record)
    assert store.lost == [record.id]
    store.close()
    assert any("stay as they are" in sentence for sentence in said)


def test_a_second_run_takes_every_verdict_from_the_store(monkeypatch, capsys):
    for module in (decide, verdict_store):
        monkeypatch.setattr(module, "sources", tuple)  # whoever works on the sources just now does not matter here
    monkeypatch.setattr("navsym.verification.fingerprints.rooms_digest", lambda: "the same")
    first = claims(capsys)
    monkeypatch.setattr(decide, "record_of", None)  # nothing is decided any more
    assert claims(capsys) == first


def test_what_a_store_of_others_cannot_keep_is_named_once(tmp_path, capsys):
    with contextlib.closing(sqlite3.connect(tmp_path / "results.sqlite")) as connection:
        connection.execute("create table results (a, b)")
        connection.commit()
    status, document = claims(capsys)
    assert status == 3 and sorted(document["unsaved"]) == sorted(claim["id"] for claim in document["claims"])
