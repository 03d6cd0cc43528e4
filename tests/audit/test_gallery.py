"""Every published fault of the gallery is found at its entry and mended, and every corrected version is proved."""

from __future__ import annotations

import functools
import re
from pathlib import Path

import pytest

import navsym as nav

GALLERY = Path(__file__).resolve().parents[2] / "examples" / "audit" / "gallery"
SPECS = sorted(GALLERY.glob("*.toml"))
#: Faults that no change of one right side mends.
WITHOUT = {"mirrored_matrix"}


@functools.cache
def audit_once(spec):
    """The audit of a specification, kept for both tests."""
    return nav.audit(spec)


@pytest.mark.parametrize("spec", SPECS, ids=lambda path: path.stem)
def test_a_fault_is_refuted_where_it_stands_and_its_correction_is_proved(spec):
    audit = audit_once(spec)
    before, after = audit["before"], audit["after"]
    assert before.status == nav.REFUTED and after.status == nav.PROVED
    wrong = [entry for entry in before.entries if entry.status == nav.REFUTED]
    assert all(
        entry.counterexample is not None and entry.values and entry.values[0] != entry.values[1] for entry in wrong
    )
    if spec.stem not in WITHOUT:
        assert all(entry.suggestion for entry in wrong)
    assert audit.files[0].refused == ()
    assert {item.status for item in nav.check(audit)} == {"ACCEPTED"}


@pytest.mark.parametrize("spec", [s for s in SPECS if s.stem not in WITHOUT], ids=lambda path: path.stem)
def test_a_source_with_the_suggestion_written_in_is_proved_at_that_entry(spec, tmp_path):
    question = audit_once(spec)["before"]
    entry = next(entry for entry in question.entries if entry.suggestion)
    source = Path(entry.file)
    text = source.read_text()
    sides = list(right_sides(text, source.suffix))
    start, end = max((side for side in sides if text[: side[0]].count("\n") < entry.line), key=lambda side: side[0])
    if entry.suggestion.startswith("product("):
        start, end = call_at(text, entry.line)
    candidates = [text[:a] + entry.suggestion + text[b:] for a, b in {(start, end), *near(sides, text, entry.line)}]
    verdicts = set()
    for candidate in candidates:
        (tmp_path / source.name).write_text(candidate)
        (tmp_path / spec.name).write_text(spec.read_text())
        again = nav.audit(tmp_path / spec.name)["before"]
        verdicts |= {e.status for e in again.entries if e.entry == entry.entry}
    assert nav.PROVED in verdicts


def right_sides(text, end):
    """Where right sides begin and end in a source, by its brackets and line ends."""
    for found in re.finditer(r"(?<![=<>!])=(?!=)\s*|return\s+", text):
        depth, at = 0, found.end()
        while at < len(text):
            depth += (text[at] in "([{") - (text[at] in ")]}")
            if depth < 0 or (depth == 0 and (text[at] == ";" or (end == ".py" and text[at] == "\n"))):
                break
            at += 1
        yield found.end(), at


def near(sides, text, line):
    """The right sides that begin on a line."""
    return [side for side in sides if text[: side[0]].count("\n") + 1 == line]


def call_at(text, line):
    """The call of a product on a line."""
    start = text.index("product(", sum(len(row) + 1 for row in text.split("\n")[: line - 1]))
    return start, text.index(";", start)
