"""TRUST.md and the page of the attacks: the table of the trusted base is true, files exist, commands are commands."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from navsym.cli.campaign import NAMES
from tests.attacks.campaigns.readers import READERS

ROOT = Path(__file__).resolve().parents[2]
TRUST, PAGE = ((ROOT / name).read_text(encoding="utf-8") for name in ("TRUST.md", "docs/attacks.md"))
BASE = re.findall(r"^\|[^|`]*`(navsym/[^`]+)` \| ([\d,]+) \|$", TRUST, flags=re.M)


def sources(place):
    """The files that a cell of the table names: a folder, a file, or several as ``{a,b}.py``."""
    head, _, tail = place.partition("{")
    inside, _, end = tail.partition("}")
    for path in [ROOT / f"{head}{name}{end}" for name in inside.split(",")]:
        yield from sorted(path.rglob("*.py")) if path.is_dir() else [path]


@pytest.mark.parametrize(("place", "said"), BASE)
def test_the_trusted_base_has_the_lines_that_the_page_says(place, said):
    lines = sum(len(path.read_text(encoding="utf-8").splitlines()) for path in sources(place))
    assert abs(lines - int(said.replace(",", ""))) <= 0.1 * lines, f"{place} has {lines} lines: correct TRUST.md"


def test_what_is_trusted_is_one_page():
    assert len(TRUST.splitlines()) <= 90


def test_the_table_of_the_base_is_read():
    assert len(BASE) == 5 and any(place == "navsym/checker.py" for place, _ in BASE)


def test_every_campaign_has_its_figure_and_every_command_names_one():
    commands = [shlex.split(line) for line in re.findall(r"`navsym (campaign [a-z-]+[^`]*)`", PAGE)]
    assert set(NAMES) - {"checker-mutants"} == {words[1] for words in commands}
    assert "python tests/checker/mutants.py" in PAGE
    rows = [line for line in PAGE.splitlines() if line.startswith("| ") and re.search(r"\| \d{4}-\d\d-\d\d \|$", line)]
    assert all(line.count("|") == 5 for line in rows) and len(rows) >= len(NAMES)


def test_every_file_that_the_pages_name_exists():
    named = re.findall(r"(?<![\w/])((?:navsym|tests|docs)/[\w/.-]*\w)(?![\w{*])", TRUST + PAGE)
    assert len(named) > 20
    assert not [name for name in named if not (ROOT / name).exists() and not (ROOT / f"{name}.py").exists()]


def test_the_readers_are_as_many_as_the_page_says():
    assert len(READERS) == 18 and "Eighteen readers" in PAGE
