"""Questions about public code: the page shows every mapping, and the clones give the verdicts that it says."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from navsym.language.tomlfile import read_toml
from tests.audit.reports import SPECS, ask, write_rows

CORPORA = os.environ.get("NAVSYM_CORPORA", "")
PAGE = (Path(__file__).parents[2] / "docs" / "audit_reports.md").read_text()


def test_the_page_shows_every_question():
    rows = [line for line in PAGE.splitlines() if any(f"| {verdict} |" in line for verdict in ("PROVED", "OPEN"))]
    assert len(rows) == sum(len(read_toml(spec)["question"]) for spec in SPECS) >= 10
    for spec in SPECS:
        head = read_toml(spec)["file"]
        assert f"| {head['repository']} | {head['commit']} | {head['path']} |" in PAGE


@pytest.mark.slow
@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.stem)
def test_the_verdicts_are_those_of_the_page(spec):
    answer = ask(spec, CORPORA)
    if answer is None:
        pytest.skip("no clone of the repository: set NAVSYM_CORPORA to a folder that holds it (docs/audit_reports.md)")
    assert all(row in PAGE for row in write_rows(spec, answer))
