"""Public bug fixes: the wrong version falls at the corrected entries, and the right one is proved."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.audit.fixes import FIXES, find_clone, run_fix

CORPORA = os.environ.get("NAVSYM_CORPORA", "")
#: What is left open, and why.
OPEN = {
    "betaflight-3": "the wrong version divides by a macro without parentheses",
    "PX4-ECL-12": "the right version needs the sign of a case",
}


def test_every_fix_stands_for_a_commit_of_its_own():
    assert len({(fix.repository, fix.commit) for fix in FIXES}) == len(FIXES) >= 40
    assert all(fix.entries and 'file = "' in fix.spec for fix in FIXES)


def test_the_table_shows_every_fix_and_what_is_open():
    table = (Path(__file__).parents[2] / "docs" / "audit_fixes.md").read_text()
    rows = [line.split(" | ") for line in table.splitlines() if line.startswith("| ") and line.count(" | ") == 11]
    shown = {(cells[0].removeprefix("| "), cells[1]): cells for cells in rows[2:]}
    assert {*shown} == {(fix.repository, fix.commit) for fix in FIXES}
    for fix in FIXES:
        before, after = shown[fix.repository, fix.commit][6], shown[fix.repository, fix.commit][10]
        assert ((before, after) != ("REFUTED", "PROVED")) == (fix.name in OPEN)
        assert fix.fault == shown[fix.repository, fix.commit][5]


def test_the_first_page_has_the_counts_of_the_table():
    words = " ".join((Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8").split())
    said = f"Of {len(FIXES)} corrections of public estimator code"
    assert said in words and f"it decides {len(FIXES) - len(OPEN)} at the entries" in words


@pytest.mark.slow
@pytest.mark.parametrize("fix", FIXES, ids=lambda fix: fix.name)
def test_the_corrected_entries_fall_before_and_hold_after(fix):
    clone = find_clone(fix, CORPORA)
    if clone is None:
        pytest.skip(f"no clone of {fix.repository}: set NAVSYM_CORPORA to a folder that holds it (docs/audit_fixes.md)")
    row = run_fix(fix, clone)
    assert (row.before, row.after) != ("PROVED", "PROVED") and row.after != "REFUTED"
    assert fix.name in OPEN or (row.before, row.located, row.after) == ("REFUTED", True, "PROVED")
