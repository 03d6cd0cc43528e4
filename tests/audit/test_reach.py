"""How much of public files is read: the table shows every mapping, and ten files in five languages are read to 95 %."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from navsym.language.tomlfile import read_toml
from tests.audit.reach import GRAMMARS, HERE, measure_reach

CORPORA = os.environ.get("NAVSYM_CORPORA", "")
SPECS = sorted(HERE.glob("*.toml"))
PAGE = Path(__file__).parents[2] / "docs" / "audit_reach.md"


def read_rows(text):
    """The cells of each row of the tables."""
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines() if line.startswith("| ")]
    return [row for row in rows if row[4].isdigit()]


def test_the_page_shows_every_mapping_and_its_shares_add_up():
    rows = read_rows(PAGE.read_text())
    heads = [read_toml(spec)["file"] for spec in SPECS]
    assert {tuple(row[:3]) for row in rows} == {(head["repository"], head["commit"], head["path"]) for head in heads}
    ten = rows[:10]
    assert {row[3] for row in ten} == {*GRAMMARS.values()}
    read, assignments = (sum(int(row[k]) for row in ten) for k in (5, 4))
    assert read / assignments >= 0.95 and f"{read} of {assignments} assignments" in PAGE.read_text()
    assert all(row[7] or row[4] == row[5] for row in rows)  # what is not read has a reason


@pytest.mark.slow
@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.stem)
def test_at_least_what_the_page_says_is_read(spec):
    reach = measure_reach(spec, CORPORA)
    if reach is None:
        pytest.skip("no clone of the repository: set NAVSYM_CORPORA to a folder that holds it (docs/audit_reach.md)")
    shown = next(row for row in read_rows(PAGE.read_text()) if row[0] == reach.repository and row[2] == reach.path)
    assert reach.assignments == int(shown[4]) and reach.read >= int(shown[5])
