"""``navsym check`` on folders: no certificate becomes invisible."""

from __future__ import annotations

import json

from navsym.cli.main import run
from tests.checker.examples import ALL, GAP, GOOD, IDENTITY


def rows(capsys, *arguments):
    status = run(["check", *arguments, "--json"])
    return status, json.loads(capsys.readouterr().out)["checked"]


def test_a_certificate_that_lost_its_kind_is_rejected_and_not_skipped(tmp_path, capsys):
    for name, item in enumerate((IDENTITY, GAP, ALL)):
        lost = {key: value for key, value in item.items() if key != "kind"}
        (tmp_path / f"{name}.json").write_text(json.dumps(lost))
    (tmp_path / "vectors.json").write_text('{"inputs": [], "made_with": {}}')
    status, found = rows(capsys, str(tmp_path))
    assert status == 1 and [row["status"] for row in found] == ["REJECTED"] * 3


def test_every_kind_is_accepted_from_a_file_combined_ones_as_one(tmp_path, capsys):
    for name, item in enumerate(GOOD):
        (tmp_path / f"{name}.json").write_text(json.dumps(item))
    status, found = rows(capsys, str(tmp_path))
    assert status == 0 and len(found) == len(GOOD)
    assert {row["kind"] for row in found} >= {"all", "sliver", "range", "touch", "gap", "rank"}


def test_a_file_that_is_no_text_is_rejected_in_words(tmp_path, capsys):
    (tmp_path / "a.json").write_bytes(b"\xff\xfe{}")
    (tmp_path / "b.json").write_bytes(b'{"kind": "\xe9"}')
    (tmp_path / "c.json").write_bytes(b"")
    status, found = rows(capsys, str(tmp_path))
    assert status == 1 and [row["status"] for row in found] == ["REJECTED"] * 3
    assert all("expected" in row["why"] for row in found)


def test_a_certificate_inside_a_document_is_named_by_its_file_and_never_overlooked(tmp_path, capsys):
    (tmp_path / "answer.json").write_text(json.dumps({"value": 1.5, "certificate": GAP}))
    assert rows(capsys, str(tmp_path)) == rows(capsys, str(tmp_path / "answer.json"))
    status, found = rows(capsys, str(tmp_path))
    assert status == 0 and [row["path"] for row in found] == ["answer.json"]
    for forged in ({**GAP, "upper": "1/1000"}, {}, [], "gap", 7):
        (tmp_path / "answer.json").write_text(json.dumps({"value": 1.5, "rows": [{"certificate": forged}]}))
        status, found = rows(capsys, str(tmp_path))
        assert status == 1 and [row["status"] for row in found] == ["REJECTED"]
