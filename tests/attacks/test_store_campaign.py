"""Killed writers and troubled disks, in small; in full by ``navsym campaign kills`` and ``campaign disk``."""

from __future__ import annotations

import importlib
import json
import sys

import pytest

from navsym.cli.main import run
from navsym.core.store import Store, StoreError
from tests.attacks.campaigns import disks, kills
from tests.attacks.campaigns.batches import Batch, run_campaign


def test_four_writers_killed_lose_nothing_that_was_acknowledged():
    found = kills.judge(("writers", 3, 5))
    assert not found["wrong"]
    assert found["counts"]["kills"] == 12 and found["counts"]["acknowledged"] > 0  # how many, the disk decides


LONG = {"file size limit under a sweep": pytest.mark.long}
TROUBLES = [pytest.param(name, marks=LONG.get(name, ())) for name in disks.TROUBLES if name != "full disk"]


@pytest.mark.parametrize("trouble", TROUBLES)
def test_trouble_is_said_and_old_results_are_intact(trouble):
    assert not disks.judge(trouble)["wrong"]


def test_a_module_that_is_imported_without_room_is_not_left_by_half_for_others(tmp_path, monkeypatch):
    (tmp_path / "long_module.py").write_text(f"TEXT = {'word ' * 200!r}\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr("sys.dont_write_bytecode", False)
    monkeypatch.setattr("sys.pycache_prefix", None)
    with disks.limit_file_size(512):
        importlib.import_module("long_module")
    assert not list(tmp_path.rglob("*.pyc"))
    monkeypatch.delitem(sys.modules, "long_module")
    importlib.import_module("long_module")
    assert list(tmp_path.rglob("*.pyc"))


@pytest.mark.slow
def test_a_full_disk_is_said_and_every_lost_verdict_named():
    assert not disks.judge("full disk")["wrong"]


def test_a_lost_result_is_noticed(tmp_path):
    store = Store(tmp_path / "s.sqlite")
    store.put("0-1", {"item": 1})
    (tmp_path / "acknowledged-0").write_text("0-1\n0-2\n")
    (tmp_path / "done-0").write_text("0-1\n0-1\n0-1\n0-2\n")
    _, wrong = kills.balance(tmp_path, 1, 1)
    assert len(wrong) == 2 and wrong[0] == "lost: 0-2" and "2 repeated" in wrong[1]


def test_results_that_the_store_does_not_take_are_counted_and_named(tmp_path, monkeypatch):
    def full(self, key, value):
        raise StoreError("expected a store that can be written; got database or disk is full")

    store = Store(tmp_path / "s.sqlite")
    monkeypatch.setattr(Store, "put", full)
    judge = lambda item: {"counts": {"seen": 1}, "wrong": [], "open": [], "kept": []}  # noqa: E731
    document = run_campaign("c", [Batch("one", 1), Batch("two", 2)], judge, store=store)
    assert document["counts"] == {"seen": 2} and sorted(document["unsaved"]) == ["one", "two"]


def test_verify_says_which_verdicts_were_not_kept(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("NAVSYM_CACHE", str(tmp_path))
    (tmp_path / "results.sqlite").write_bytes(b"something else" * 500)
    assert run(["verify", "alpha_beta_filter", "--fresh", "--json"]) == 3
    captured = capsys.readouterr()
    assert len(json.loads(captured.out)["unsaved"]) > 10 and "not kept" in captured.err


def test_the_campaign_prints_its_row(monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("NAVSYM_CACHE", str(tmp_path))
    monkeypatch.setattr("sys.argv", ["navsym", "campaign", "kills", "--inputs", "4", "--markdown"])
    assert run(["campaign", "kills", "--inputs", "4", "--markdown"]) == 0
    row = capsys.readouterr().out
    assert row.startswith("| writers of the store") and "`navsym campaign kills --inputs 4`" in row
    assert kills.WRITERS == 4 and "0 wrong" in row
