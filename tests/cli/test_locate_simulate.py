"""``navsym simulate terrain_search``: one document, progress beside it, and a run that goes on."""

from __future__ import annotations

import json

from navsym.cli.main import run


def test_an_experiment_prints_one_document_and_goes_on_from_its_journal(tmp_path, capsys, monkeypatch):
    monkeypatch.delenv("NAVSYM_DATA", raising=False)
    monkeypatch.setenv("NAVSYM_CACHE", str(tmp_path / "none"))
    monkeypatch.setenv("NAVSYM_PROGRESS", "1")
    monkeypatch.setattr("navsym.cli._progress.PATIENCE", 0.0)  # a fast machine would say nothing
    monkeypatch.setattr("navsym.cli._progress.BETWEEN_REMARKS", 0.0)
    journal = tmp_path / "runs.jsonl"
    words = ["simulate", "terrain_search", "--runs", "1", "--steps", "60", "--journal", str(journal), "--json"]
    assert run(words) == 0
    first = capsys.readouterr()
    document = json.loads(first.out)
    assert set(document) == {"experiment", "rows", "printed", "verdicts", "flights", "remarks"}
    assert document["flights"] == 20
    assert "of 20 runs" in first.err
    size = journal.stat().st_size
    assert run(words) == 0
    assert json.loads(capsys.readouterr().out) == document
    assert journal.stat().st_size == size
