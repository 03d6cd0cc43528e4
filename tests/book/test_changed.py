"""Entries of the book with one token changed: a verdict never contradicts numbers, and most changes are refuted."""

from __future__ import annotations

import random
from collections import Counter

import navsym as nav
from tests.book.changed import change_entry, judge


def test_no_verdict_on_a_changed_entry_contradicts_numbers():
    rng, entries = random.Random(20), list(nav.book.values())
    counts = Counter(judge(change_entry(rng.choice(entries), rng), number) for number in range(40))
    assert not counts["wrong"] and counts["REFUTED"] >= 20, counts


def test_a_verdict_that_contradicts_numbers_is_noticed(monkeypatch):
    monkeypatch.setattr("tests.book.changed.holds_numerically", lambda document, seed: False)
    assert judge(dict(nav.book["bac-cab"].document), 0) == "wrong"
