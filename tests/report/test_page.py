"""The pages say what the records say, need nothing from outside, and show hostile words as text."""

from __future__ import annotations

import re
from dataclasses import replace
from html.parser import HTMLParser
from xml.dom import minidom

import pytest

from navsym.claims.verdict import PROVED
from navsym.prove.grant import UNCHECKED
from navsym.report.page import certificates_by_file, slug, visible
from navsym.report.trust import backing_words
from navsym.verification.certificates import keep_outcome
from navsym.verification.ledger import may_be_the_copy, records_about, sort_records
from tests.report.hostile import ledger, site


class Reading(HTMLParser):
    """Elements, attributes and text of a page."""

    def __init__(self, text: str):
        super().__init__(convert_charrefs=True)
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.open: list[str] = []
        self.crossed: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag not in ("meta", "link", "input", "br", "wbr", "path", "circle"):
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.crossed.append(tag)

    def handle_data(self, data):
        self.words.append(data)

    @property
    def text(self):
        return "".join(self.words)


def pages(files):
    return {name: Reading(text) for name, text in files.items() if name.endswith(".html")}


def test_a_page_says_what_no_claim_judges_and_why(files, card):
    text = Reading(files["sample.html"]).text
    assert all(statement in text and why in text for statement, why in card.left_out.items())


def test_a_report_has_an_index_a_page_and_an_erratum_sheet_for_each_paper(files):
    assert {"index.html", "sample.html", "sample.erratum.html", "sample.erratum.tex", "verdicts.json"} <= set(files)
    assert "certificates/sample_1-" in " ".join(files)


def test_a_page_says_what_is_trusted_and_lists_what_has_no_certificate(card, records):
    plain = next(k for k, record in enumerate(records) if not record.certificate)
    bare = replace(records[plain], evidence=f"{records[plain].evidence}; {UNCHECKED}", status=PROVED)
    others = [record for record in records if record is not records[plain]]
    made = site(ledger([bare, *others], card))
    page = " ".join(re.sub("<[^>]*>", " ", made["trust.html"]).split())
    count = sum(len(certificates_by_file(record)) for record in others)
    listed = re.findall(r"(\w+) (\d+) [\d,]+ [\d,]+ ", page)
    assert sum(int(number) for _, number in listed) == count > 0
    assert "1 verdict is a computed fact" in page and bare.id in page
    said = " ".join(Reading(made["sample.html"]).text.split())
    assert "unchecked, the verdict rests on the code" in said
    backed = re.findall(
        r"([\w ]+), [\d,]+ bytes, accepted by the checker; Coq not asked; second checker not asked", said
    )
    assert {kind.strip() for kind in backed} == {record.certificate["kind"] for record in others if record.certificate}
    assert "every file below" in page and "trust.html" in made["index.html"]


def test_a_page_shows_what_others_said_of_this_very_certificate_and_nothing_else(card, records, tmp_path, monkeypatch):
    """Only what was kept under the certificate's own text counts: not for one that differs, nor by another judge."""
    monkeypatch.setenv("NAVSYM_CACHE", str(tmp_path))
    record = next(record for record in records if record.certificate)
    parts = [{"kind": "identity", "left": text} for text in ("x", "y", "z")]
    keep_outcome("ocaml", parts[0], {"status": "PROVED", "version": "abc"})
    keep_outcome("ocaml", parts[1], {"status": "FAILED", "version": "abc"})
    keep_outcome("coq", parts[0], {"status": "UNWRITTEN", "version": "8"})
    said = backing_words(replace(record, certificate={"kind": "all", "of": parts}))
    assert "; second checker (abc): not accepted 1 of 3, accepted 1 of 3" in said
    assert "; Coq (8): no words for it 1 of 3" in said
    said = backing_words(replace(record, certificate=parts[2]))
    assert said.endswith("; Coq not asked; second checker not asked")
    one = replace(record, certificate={"kind": "all", "of": parts})
    page = " ".join(Reading(site(ledger([one], card))["trust.html"]).text.split())
    assert "second checker (abc): not accepted 1 of 3, accepted 1 of 3" in page


def test_tags_are_closed_in_order_and_identifiers_are_used_once(files, hostile_files):
    for found in (files, hostile_files):
        for name, page in pages(found).items():
            assert not page.crossed and not page.open, name
            ids = [a["id"] for _, a in page.elements if "id" in a]
            assert len(ids) == len(set(ids)), name


def test_every_link_leads_to_a_file_or_an_anchor_that_exists(files, hostile_files):
    for found in (files, hostile_files):
        read = pages(found)
        anchors = {name: {a.get("id") for _, a in page.elements} for name, page in read.items()}
        for name, page in read.items():
            for tag, attributes in page.elements:
                href = attributes.get("href")
                if tag != "a" or href is None:
                    continue
                file, _, anchor = href.partition("#")
                assert (file or name) in found, (name, href)
                assert not anchor or anchor in anchors[file or name], (name, href)


def test_nothing_is_fetched_from_outside(files, hostile_files):
    for found in (files, hostile_files):
        for name, page in pages(found).items():
            for tag, attributes in page.elements:
                for key in ("src", "href", "action", "data", "srcset"):
                    value = attributes.get(key) or ""
                    assert not re.match(r"(?i)\s*(https?:|//|javascript:|file:)", value), (name, tag, value)


def test_the_page_of_a_paper_names_verdict_scope_counterexample_and_correction(files):
    text = Reading(files["sample.html"]).text
    wanted = ("REFUTED", "all real T", "T = pi/6", "should read (2*, PROVED)", "Slip of the paper", "0.500 s")
    for words in (*wanted, "identity"):
        assert words in " ".join(text.split()), words


def test_marks_say_the_verdict_without_colour(files):
    index = Reading(files["index.html"])
    cells = " ".join(index.text.split())
    for words in ("1 ✓ proved", "2 ✗ refuted", "3 ◎ certified", "4 ? open", "5 · definition", "6 ! missing"):
        assert words in cells, words


def test_damage_of_the_copy_is_not_counted_against_the_paper(files):
    index, page = (" ".join(Reading(files[name]).text.split()) for name in ("index.html", "sample.html"))
    assert "7 copy copy" in index and "7 ✗" not in index
    assert "1 correction, 1 of the copy" in index
    assert "1 of the refuted may be damage of the copy" in page


def test_a_paper_that_slips_and_whose_copy_is_damaged_counts_as_the_paper_s(records):
    mixed = [replace(record, number=f"9.{record.number}") for record in records if record.number in ("2", "7")]
    for order in (mixed, mixed[::-1]):
        assert not may_be_the_copy(records_about("9", ("9",), order)[0])
    assert may_be_the_copy(records_about("9", ("9",), [r for r in mixed if r.slip == "scan"])[0])


def test_scopes_assumptions_and_truth_values_are_said_in_words(files):
    page = " ".join(Reading(files["sample.html"]).text.split())
    truth = ("it holds in all 3 cases", "case 1: it holds; case 2: it does not hold")
    for words in ("all T > 0, real w", "w ≠ 0", *truth):
        assert words in page, words


def test_a_refuted_formula_is_drawn_and_the_drawing_has_words(files):
    drawings = [a for tag, a in Reading(files["sample.html"]).elements if tag == "svg"]
    assert len(drawings) == 1
    assert drawings[0]["role"] == "img" and "T = 0.5236 they are -0.5 and 0.5" in drawings[0]["aria-label"]


def test_formulas_are_wellformed_mathml_with_their_latex_beside_them(files):
    found = re.findall(r"<math .*?</math>", files["sample.html"], re.S)
    assert len(found) >= 10
    for formula in found:
        minidom.parseString(formula)
    assert r"\sin\left( 2\,T \right)" in files["sample.html"]


def test_the_erratum_sheet_alone_is_enough_to_correct_the_paper(files):
    text = " ".join(Reading(files["sample.erratum.html"]).text.split())
    for words in ("equation (2)", "printed", "should read", "The sine without a sign.", "The sign is lost.", "-0.5"):
        assert words in text, words
    tex = files["sample.erratum.tex"]
    assert r"\[  - \sin\left( T \right) \]" in tex and r"\[ \sin\left( T \right) \]" in tex
    assert tex.count(r"\begin{enumerate}") == tex.count(r"\end{enumerate}") == 2  # the paper, its copy


def test_hostile_words_are_shown_as_text(hostile_files, hostile_words):
    page = Reading(hostile_files["sample.html"])
    text = page.text
    for words in hostile_words:
        assert visible(words) in text, words


def test_hostile_words_make_no_element_attribute_or_file(hostile_files, hostile_words):
    assert len(hostile_words) == 40
    for name, page in pages(hostile_files).items():
        tags = [tag for tag, _ in page.elements]
        assert tags.count("script") == (name not in ("index.html", "trust.html")), name
        assert not {"iframe", "img", "base", "object", "embed", "animate"} & set(tags), name
        assert not [a for _, attributes in page.elements for a in attributes if a.startswith("on")], name
        assert "49" not in re.findall(r"title[^<]*\b(49)\b", page.text)
    for name in hostile_files:
        assert re.fullmatch(r"(certificates/)?[A-Za-z0-9_][A-Za-z0-9_.-]*", name), name


def test_hostile_words_do_not_command_latex(hostile_files, card, records):
    tex = hostile_files["sample.erratum.tex"]
    assert r"\input" not in tex and "\x00" not in tex
    wild = [replace(records[1], reason=r"\input{/etc/passwd} $x$ % & # _ ^ ~", title=r"\write18{ls}")]
    tex = site(ledger(wild, card))["sample.erratum.tex"]
    assert r"\input" not in tex and r"\write18" not in tex and r"\textbackslash{}input" in tex


@pytest.mark.parametrize("name", ["", "a", "a/b", "../x", "ä", "a" * 300, "sample:4.3.u2*", "sample:4.3.u2"])
def test_file_names_are_plain_and_different_names_stay_different(name):
    assert re.fullmatch(r"[A-Za-z0-9_.-]*", slug(name)) and len(slug(name)) < 100
    assert ".." not in slug(name)[:2] and slug(name) != slug(name + "*")


def test_braces_of_latex_are_balanced_whatever_the_words(files, hostile_files):
    for found in (files, hostile_files):
        tex = re.sub(r"\\[{}\\]", "", found["sample.erratum.tex"])
        assert tex.count("{") == tex.count("}")
        assert tex.count(r"\left") == tex.count(r"\right")


def test_the_ledger_is_enough_for_the_pages(records, card):
    found = site(ledger([replace(record, certificate=None, seconds=0.0) for record in records], card))
    assert found["sample.html"].count("<article") == len(records)
    assert not [name for name in found if name.startswith("certificates/")]


def test_a_refuted_card_shows_what_should_stand_there_and_what_that_is_worth(files):
    card = re.search(r'<article class="claim refuted".*?</article>', files["sample.html"], re.S)
    assert card is not None and "should read" in card[0] and "PROVED" in card[0]
    assert card[0].count("derived from the model") == 0  # the correction is what was derived


def test_claims_of_the_ledger_for_people_stand_in_the_order_of_the_paper(records, card):
    assert [r.number for r in sort_records(card, records[::-1])] == ["1", "2*", "2", "3", "4", "7*", "7", "short-name"]
