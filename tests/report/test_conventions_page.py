"""The page of conventions: the card, an entry and a point for each neighbour, and words of a file as words."""

from __future__ import annotations

import re
from dataclasses import replace

import navsym as nav
from navsym.cli.main import run
from navsym.report.conventions_page import conventions_page
from tests.conventions import models
from tests.report.hostile import HOSTILE


def test_the_page_shows_the_card_and_what_excludes_each_neighbour():
    answer = nav.conventions(models.sola_local())
    page = conventions_page(answer)
    assert "C_est = C (E + [p x])" in page
    assert answer.excluded and "<td>1, 2</td>" in page  # the other card of the pair has the same neighbour
    for exclusion in answer.excluded:
        assert exclusion.why.replace("'", "&#39;") in page


def test_a_page_without_a_card_shows_what_must_change():
    page = conventions_page(nav.conventions(models.lins_before()))
    assert "No card is right" in page and "attitude by attitude" in page and "change the sign" in page
    assert "Each is excluded at a point" in page and "Each card is proved" not in page


def test_a_title_is_a_word_and_no_markup():
    answer = nav.conventions(models.sola_local())
    harmless = re.findall(r"<(/?[a-z]+|!)", conventions_page(answer))
    for words in HOSTILE:
        assert re.findall(r"<(/?[a-z]+|!)", conventions_page(replace(answer, name=words))) == harmless


def test_the_verb_writes_the_page(tmp_path, capsys):
    page = tmp_path / "page.html"
    assert run(["conventions", "examples/conventions.toml", "--html", str(page)]) == 0
    assert "What excludes each neighbour" in page.read_text(encoding="utf-8")
    assert "neighbour" in capsys.readouterr().out
