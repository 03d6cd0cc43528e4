"""Campaigns that are tables of cases: batch by batch, kept, and resumed after a kill."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from navsym.core.errors import NavsymError
from navsym.core.store import Store
from tests.attacks.campaigns import cases
from tests.attacks.campaigns.batches import run_campaign

SOURCE = """
import pytest

@pytest.mark.parametrize("word", ["a | b", "c[d]", "e"])
def test_words(word):
    assert word != "e"

def test_nothing():
    pytest.skip("nothing")
"""


@pytest.fixture
def table(tmp_path):
    (tmp_path / "pyproject.toml").write_text('[tool.pytest.ini_options]\nmarkers = ["slow: long"]\n')
    (tmp_path / "test_table.py").write_text(SOURCE)
    return tmp_path


@pytest.mark.long
def test_every_case_is_counted_once_and_what_fails_is_named(table):
    batches = cases.make_batches(table, "test_table.py", 3)
    assert [len(batch.items[1]) for batch in batches] == [3, 1]
    document = run_campaign("c", batches, cases.judge)
    assert document["counts"] == {"failed": 1, "passed": 2, "skipped": 1}
    assert document["wrong"] == ["test_words[e]"] and document["open"] == ["test_nothing"]


@pytest.mark.slow
def test_a_stopped_campaign_goes_on_and_changed_cases_are_run_again(table, tmp_path):
    store, batches = Store(tmp_path / "s.sqlite"), cases.make_batches(table, "test_table.py", 3)
    run_campaign("c", batches[:1], cases.judge, store=store)  # stopped after the first batch
    whole = run_campaign("c", batches, cases.judge, store=store)
    assert whole["resumed"] == 1 and sum(whole["counts"].values()) == 4
    (table / "test_table.py").write_text(SOURCE + "\n\n# harder\n")
    again = run_campaign("c", cases.make_batches(table, "test_table.py", 3), cases.judge, store=store)
    assert again["resumed"] == 0


def test_a_folder_without_cases_is_said(table):
    (table / "empty").mkdir()
    with pytest.raises(NavsymError, match="expected cases in empty"):
        cases.make_batches(table, "empty", 3)


ENDLESS = """
import os, time
def test_endless(request):
    (request.config.rootpath / "running").write_text(str(os.getpid()))
    time.sleep(600)
"""


@pytest.mark.slow
def test_a_batch_that_is_given_up_leaves_nothing_running(table):
    (table / "test_table.py").write_text(ENDLESS)
    found = run_campaign("c", cases.make_batches(table, "test_table.py", 3), cases.judge, seconds=30)
    assert "more than 30 s" in found["stopped"][0]
    number = int((table / "running").read_text())
    for _ in range(50):  # until the kernel has ended it
        if not Path(f"/proc/{number}").exists():
            return
        time.sleep(0.1)
    pytest.fail(f"pytest is still running as {number}")
