"""Data sets are named with source and checksum, and only a file with that checksum is used."""

from __future__ import annotations

import hashlib
import json

import pytest

from navsym.cli.main import run
from navsym.core import datasets


@pytest.fixture
def own(monkeypatch, tmp_path):
    """A data set of our own with a local copy and an empty cache."""
    content = b"t,x\n0,1\n"
    data = datasets.Dataset(
        "own",
        "a/own.csv",
        "a sample",
        "nobody/nothing",
        "0" * 12,
        "own.csv",
        hashlib.sha256(content).hexdigest(),
        "none",
    )
    monkeypatch.setattr(datasets, "DATASETS", {"own": data})
    monkeypatch.setenv("NAVSYM_DATA", str(tmp_path / "copy"))
    monkeypatch.setenv("NAVSYM_CACHE", str(tmp_path / "cache"))
    (tmp_path / "copy" / "a").mkdir(parents=True)
    (tmp_path / "copy" / "a" / "own.csv").write_bytes(content)
    return tmp_path


def answer(capsys, *words):
    status = run(["data", *words, "--json"])
    return status, json.loads(capsys.readouterr().out)


def test_every_set_has_source_commit_licence_and_checksum():
    for data in datasets.DATASETS.values():
        assert len(data.sha256) == 64 and len(data.commit) == 12 and data.licence and "/" in data.repository
        assert data.address.startswith("https://") and data.commit in data.address
    assert len({data.path for data in datasets.DATASETS.values()}) == len(datasets.DATASETS) == 8


def test_a_local_copy_is_found_and_cited(own, capsys):
    status, found = answer(capsys, "get", "own")
    assert status == 0 and found["datasets"][0]["path"] == str(own / "copy" / "a" / "own.csv")
    assert "nobody/nothing at commit 000000000000" in found["datasets"][0]["citation"]
    assert answer(capsys, "list")[1]["datasets"][0]["here"]


def test_another_file_of_that_name_is_refused(own, capsys):
    (own / "copy" / "a" / "own.csv").write_bytes(b"something else")
    status, found = answer(capsys, "get", "own")
    assert status == 2 and found["error"]["kind"] == "checksum"
    (row,) = answer(capsys, "list")[1]["datasets"]
    assert row["here"] is None and "sha256" in row["trouble"]


def test_without_copy_and_network_the_message_says_what_to_do(own, capsys, monkeypatch):
    pooch = pytest.importorskip("pooch")

    def refuse(*_, **__):
        raise OSError("no network")

    monkeypatch.setattr(pooch, "retrieve", refuse)
    (own / "copy" / "a" / "own.csv").unlink()
    status, found = answer(capsys, "get", "own")
    assert status == 3 and found["error"]["kind"] == "missing" and "NAVSYM_DATA" in found["error"]["message"]


def test_words_that_are_no_request_are_refused(capsys):
    assert answer(capsys, "get", "nothing")[0] == 2
    assert answer(capsys, "get")[1]["error"]["kind"] == "empty"
    assert answer(capsys, "delete")[1]["error"]["kind"] == "syntax"


def test_the_recorded_files_can_be_had_where_a_copy_is_named(capsys):
    import os

    if not os.environ.get("NAVSYM_DATA"):
        pytest.skip("NAVSYM_DATA names no folder with the recorded files")
    assert answer(capsys, "get", "pyins", "geodtest")[0] == 0
