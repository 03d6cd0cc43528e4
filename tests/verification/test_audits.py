"""Questions about source code in a workspace: known to every verb, and decided again when a file changes."""

from __future__ import annotations

import json

import pytest

import navsym as nav
from navsym.core.errors import NavsymError
from navsym.verification import audits

SPEC = """\
[[code]]
name = "model"
file = "../code/turn.c"
function = "turn"

[[question]]
name = "slope"
title = "The gain is the derivative of the angle by the rate."
kind = "jacobian"
of = "model:angle[0]"
by = "model:rate"
is = "model:gain[0]"

[[question]]
name = "halved"
kind = "equal"
left = "model:gain[0]"
right = "dt/2"
expect = "REFUTED"
reason = "the mean of both ends was meant"
"""
CODE = """\
void turn(double rate, double dt, double angle[1], double gain[1])
{
    angle[0] = rate * dt;
    gain[0] = dt;
}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A workspace with one audit; its source lies in another folder."""
    root = tmp_path / "work"
    (root / "audits").mkdir(parents=True)
    (root / "code").mkdir()
    (root / "navsym.toml").write_text('[workspace]\naudits = ["audits/*.toml"]\n')
    (root / "audits" / "turn.toml").write_text(SPEC)
    (root / "code" / "turn.c").write_text(CODE)
    monkeypatch.chdir(root)
    return root


def test_every_question_is_a_claim_of_the_workspace(folder):
    assert [claim.id for claim in nav.claims()] == ["audits/turn.toml:slope", "audits/turn.toml:halved"]
    ledger = nav.verify()
    assert ledger.counts["PROVED"] == ledger.counts["REFUTED"] == 1 and not ledger.unexpected
    (record,) = nav.show("audits/turn.toml:halved")
    assert "turn.c:4" in record.evidence and record.certificate["kind"] == "counterexample"
    ledger.write()
    assert [r["id"] for r in json.loads((folder / "ledger.json").read_text())["claims"]] == [r.id for r in ledger]


def test_a_changed_source_is_decided_again(folder):
    before = nav.verify()["audits/turn.toml:slope"]
    (folder / "code" / "turn.c").write_text(CODE.replace("gain[0] = dt", "gain[0] = -dt"))
    after = nav.verify()["audits/turn.toml:slope"]
    assert (str(before.status), str(after.status)) == ("PROVED", "REFUTED")


def test_an_unchanged_source_is_not_read_again(folder, monkeypatch):
    first = audits.property_of_question(folder / "audits" / "turn.toml", "slope")
    monkeypatch.setattr(audits, "audit_specification", None)
    again = audits.property_of_question(folder / "audits" / "turn.toml", "slope")
    assert again.derived.value is True and again.derived.evidence == first.derived.evidence


def test_a_kept_verdict_with_a_forged_certificate_is_not_used(folder):
    path = folder / "audits" / "turn.toml"
    audits.property_of_question(path, "slope")
    with audits.open_store(audits.cache_file()) as store:
        ((key, text),) = store.connection.execute("SELECT key, value FROM results").fetchall()
        kept = json.loads(text)
        kept["certificates"][0]["statement"]["right"] = "-dt"
        store.put(key, kept)
    assert audits.read_kept(key) is None


def test_a_missing_source_leaves_the_question_open(folder):
    (folder / "code" / "turn.c").unlink()
    assert {str(record.status) for record in nav.verify()} == {"OPEN"}


def test_two_questions_of_one_name_are_refused(folder):
    (folder / "audits" / "turn.toml").write_text(SPEC.replace('"halved"', '"slope"'))
    with pytest.raises(NavsymError, match="slope"):
        nav.claims()
