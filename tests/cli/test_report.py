"""The verb report: pages from a fresh run or from a document, whole or not at all."""

from __future__ import annotations

import json

import pytest

from navsym.cli.main import run
from navsym.report import site


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("site") / "new" / "folder"
    assert run(["report", "alpha_beta_filter", "--out", str(out), "--jobs", "1"]) == 0
    return out


def test_the_pages_of_a_fresh_run(folder, capsys):
    names = {path.name for path in folder.iterdir()}
    assert {"index.html", "alpha_beta_filter.html", "alpha_beta_filter.erratum.html", "certificates"} <= names
    page = (folder / "alpha_beta_filter.html").read_text(encoding="utf-8")
    assert page.count("<article") == 19 and page.count("<svg") == 1


def test_every_certificate_of_the_report_is_accepted_by_the_checker(folder, capsys):
    assert run(["check", str(folder / "certificates"), "--json"]) == 0
    checked = json.loads(capsys.readouterr().out)["checked"]
    assert len(checked) >= 15 and {row["status"] for row in checked} == {"ACCEPTED"}


def test_a_document_of_verify_gives_the_same_page(folder, tmp_path, capsys):
    out = tmp_path / "again"
    assert run(["report", "--from", str(folder / "verdicts.json"), "--out", str(out), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["counts"]["REFUTED"] == 1 and "index.html" in result["pages"]
    name = "alpha_beta_filter.html"
    assert (out / name).read_text() == (folder / name).read_text()


def test_a_status_of_one_names_the_claim_and_what_helps(folder, tmp_path, capsys):
    document = json.loads((folder / "verdicts.json").read_text(encoding="utf-8"))
    document["claims"][3] |= {"status": "OPEN", "method": "none", "evidence": "not decided: more than 90 s"}
    (tmp_path / "late.json").write_text(json.dumps(document), encoding="utf-8")
    assert run(["report", "--from", str(tmp_path / "late.json"), "--out", str(tmp_path / "out")]) == 1
    told = capsys.readouterr().out
    name = document["claims"][3]["id"]
    assert f"not as declared: {name} is OPEN, declared PROVED: not decided: more than 90 s" in told
    assert "--seconds" in told and "--jobs 1" in told


@pytest.mark.parametrize(
    ("content", "kind"),
    [("{}", "shape"), ("[", "syntax"), ('{"claims": [1], "papers": [], "counts": {}}', "shape"), ("NaN", "not-finite")],
)
def test_a_document_that_is_none_is_refused(tmp_path, capsys, content, kind):
    path = tmp_path / "document.json"
    path.write_text(content)
    assert run(["report", "--from", str(path), "--out", str(tmp_path / "x"), "--json"]) == 2
    assert json.loads(capsys.readouterr().out)["error"]["kind"] == kind
    assert not (tmp_path / "x").exists()


def test_a_folder_that_cannot_be_made_is_named(folder, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    words = ["report", "--from", str(folder / "verdicts.json"), "--out", str(tmp_path / "file" / "x"), "--json"]
    assert run(words) == 2
    assert json.loads(capsys.readouterr().out)["error"]["kind"] == "output"


def test_a_folder_that_cannot_be_made_is_found_before_anything_is_decided(capsys, monkeypatch):
    monkeypatch.setattr(site, "verify", lambda *_, **__: pytest.fail("decided first"))
    assert run(["report", "alpha_beta_filter", "--out", "/dev/null", "--json"]) == 2
    assert json.loads(capsys.readouterr().out)["error"]["kind"] == "output"
