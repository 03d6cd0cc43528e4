"""The pages of the book: every entry stands once with its verdict, and every link has its place."""

import re

import pytest

import navsym as nav
from navsym.report.book_pages import book_pages, describe, words_of
from navsym.report.explain import WORDS
from navsym.report.page import MARKS, environment
from tests.report.test_page import Reading


@pytest.fixture(scope="module")
def made():
    return dict(book_pages(environment().get_template, {"marks": MARKS, "meanings": WORDS["meaning"]}))


def test_every_entry_and_every_misprint_stands_once_with_its_verdict(made):
    text = "".join(made.values())
    for entry in nav.book.values():
        assert text.count(f"<code>{entry.id}</code>") == 1, entry.id
    count = sum(1 + len(entry.misprints) for entry in nav.book.values())
    badges = sum(len(re.findall(r'class="badge', page)) for name, page in made.items() if name != "book.html")
    assert badges == count
    assert "REFUTED" in text


def test_tags_are_closed_anchors_are_used_once_and_links_lead_somewhere(made):
    for name, text in made.items():
        page = Reading(text)
        assert not page.crossed and not page.open, name
        ids = [a["id"] for _, a in page.elements if "id" in a]
        assert len(ids) == len(set(ids)), name
        for _, attributes in page.elements:
            target = attributes.get("href", "")
            file, _, anchor = target.partition("#")
            assert file in ("", "index.html", "trust.html", *made) or target == "data:,", target
            assert not anchor or anchor in ids, target


def test_formulas_are_set_in_type(made):
    text = "".join(made.values())
    assert text.count("<math") >= len(nav.book)
    assert 'class="plain"' not in text


@pytest.mark.parametrize(
    ("declaration", "words"),
    [
        ("real", "real"),
        (["0", "pi"], "0 to pi"),
        ({"vector": 3, "unit": "m"}, "vector 3, unit m"),
        ({"sign": "positive"}, "positive"),
        ({"matrix": [2, 2], "symmetric": True}, "matrix 2 x 2, symmetric"),
    ],
)
def test_declarations_are_said_in_words(declaration, words):
    assert describe(declaration) == words


def test_a_transpose_is_no_name():
    assert words_of("A.T @ [T, x].T = (B).T") == {"A", "T", "x", "B"}
