"""The book: every entry is read and holds in numbers; a sample and all misprints are decided.

The slow tests decide all entries and their false variants.
"""

from __future__ import annotations

import copy
import json
import re
from collections import Counter
from dataclasses import replace

import pytest

import navsym as nav
from navsym.book.entries import KEPT, Entry, digest, read_chapter
from navsym.cli.main import run
from navsym.prove.claimfile import claims_from, decide_claim
from tests.book.numeric import holds_numerically

SAMPLE = list(nav.book)[::25]
MISPRINTS = [entry.id for entry in nav.book.values() if entry.misprints]
ZERO = r"0|zeros\(\w+, \w+\)|\[0(, 0)*\]"
FLIPPED = {"=": "!=", "<=": ">", ">=": "<", "<": ">=", ">": "<="}


def spoiled(entry: Entry) -> Entry:
    """The entry with a sign flipped: minus the right side, or the converse.

    The converse is that of the last relation of a chain, of an inequality, and of an equation with 0.
    """
    document = copy.deepcopy(dict(entry.document))
    block = document["claim"][0]
    if "chain" in block:
        front, relation, back = re.fullmatch("(.*) (=|<=|>=|<|>) (.*)", block["chain"]).groups()
        block["chain"] = f"{front} = -({back})" if relation == "=" else f"{front} {FLIPPED[relation]} {back}"
    elif block.get("relation", "=") == "=" and not re.fullmatch(ZERO, block["right"]):
        block["right"] = f"-({block['right']})"
    else:
        block["relation"] = FLIPPED[block.get("relation", "=")]
    return replace(entry, document=document)


def verdict_of(entry: Entry) -> nav.Verdict:
    """The verdict in this process."""
    return decide_claim(claims_from(dict(entry.document)).claims[0], seconds=10)


def test_every_entry_is_complete_and_readable():
    for entry in nav.book.values():
        claims = claims_from(dict(entry.document)).claims
        assert [claim.id for claim in claims] == [entry.id]
        assert all((entry.chapter, entry.title, entry.latex, entry.source))
        assert Counter(entry.latex)["{"] == Counter(entry.latex)["}"], entry.id
    assert len(nav.book) >= 1000


def test_the_kept_statuses_are_those_of_the_statements():
    kept = json.loads(KEPT.read_text(encoding="utf-8"))
    assert {name: row["statement"] for name, row in kept.items()} == {
        name: digest(entry.document) for name, entry in nav.book.items()
    }
    assert all(bool(row["certificate"]) == (row["status"] != "OPEN") for row in kept.values())
    statuses = Counter(row["status"] for row in kept.values())
    assert statuses["REFUTED"] == 0 and statuses["PROVED"] + statuses["CERTIFIED"] >= 0.9 * len(nav.book)


def test_the_kept_statuses_of_misprints_are_refutations_of_what_was_printed():
    kept = {
        name: row["misprints"]
        for name, row in json.loads(KEPT.read_text(encoding="utf-8")).items()
        if "misprints" in row
    }
    assert kept.keys() == set(MISPRINTS) and len(MISPRINTS) >= 30
    for name, rows in kept.items():
        assert [row["statement"] for row in rows] == [digest(printed.document) for printed in nav.book[name].misprints]
        assert {row["status"] for row in rows} == {"REFUTED"} and nav.book[name].status == nav.PROVED


def test_every_entry_holds_in_numbers_and_no_misprint_does():
    for entry in nav.book.values():
        assert holds_numerically(entry.document, seed=1), entry.id
        for printed in entry.misprints:
            assert holds_numerically(printed.document, seed=1) is False, entry.id


@pytest.mark.parametrize("name", MISPRINTS)
def test_a_misprint_is_refuted_and_its_source_names_where_it_was_corrected(name):
    for printed in nav.book[name].misprints:
        verdict = printed.prove(seconds=10)
        assert verdict.status == nav.REFUTED == printed.status and verdict.check().accepted
        assert re.search(r"correct|fixed|restored|removed|added|merged|errata|adjust", printed.source)
        assert re.search(r"github\.com|doi", printed.source)


@pytest.mark.parametrize("name", SAMPLE)
def test_a_sample_is_proved_again_and_its_false_variants_are_not(name):
    entry = nav.book[name]
    verdict = verdict_of(entry)
    assert verdict.status == entry.status and verdict.holds and verdict.check().accepted
    assert not verdict_of(spoiled(entry)).holds


@pytest.mark.slow
@pytest.mark.parametrize("name", nav.book)
def test_every_entry_has_the_status_that_is_kept_and_its_false_variant_is_not_proved(name):
    entry = nav.book[name]
    assert str(verdict_of(entry).status) == nav.book.kept[name]["status"]
    assert not verdict_of(spoiled(entry)).holds


def test_a_statement_that_has_changed_is_decided_and_not_believed():
    entry = nav.book["bac-cab"]
    assert spoiled(entry).status == nav.REFUTED and entry.status == nav.PROVED


def test_an_entry_shows_what_it_states():
    entry = nav.book["rodrigues-trace"]
    assert entry.statement.endswith("= 1 + 2*cos(a), dot(u, u) = 1")
    assert repr(entry).startswith("<PROVED: rodrigues-trace; ")


def test_search_wants_all_words_in_any_order():
    found = {entry.id for entry in nav.book.search("RATE transport")}
    assert "transport-rate" in found and "bac-cab" not in found
    assert len(nav.book.search()) == len(nav.book)


def test_an_unknown_id_names_a_near_one():
    with pytest.raises(nav.NavsymError, match="did you mean transport-rate"):
        nav.book["transport-rat"]
    assert "transport-rat" not in nav.book


def test_the_verb_prints_one_document(capsys):
    assert run(["book", "transport-rate", "--json"]) == 0
    (entry,) = [e for e in json.loads(capsys.readouterr().out)["entries"] if e["id"] == "transport-rate"]
    assert set(entry) == {"id", "chapter", "title", "latex", "status", "source", "misprints"}
    assert entry["status"] == "PROVED" and entry["misprints"] == []


def test_the_verb_shows_a_misprint_with_its_verdict_and_source(capsys):
    assert run(["book", "rotation-about-x-orthogonal"]) == 0
    assert "misprint REFUTED: " in (shown := capsys.readouterr().out) and "vslam-handbook issue 3" in shown
    assert run(["book", "rotation-about-x-orthogonal", "--json"]) == 0
    (entry,) = json.loads(capsys.readouterr().out)["entries"]
    assert [set(printed) for printed in entry["misprints"]] == [{"source", "printed"}]


def test_a_search_without_entries_ends_with_status_one(capsys):
    assert run(["book", "zzz", "--json"]) == 1
    assert json.loads(capsys.readouterr().out) == {"entries": []}


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ('[chapter]\ntitle = "x"\nsource = "y"\n[[entry]]\nid = "a"\ntitle = "b"\n', "latex"),
        ('[chapter]\ntitle = "x"\nsource = "y"\n[[entry]]\nid = "a"\ntitel = "b"\n', "titel"),
        ("[symbols]\n", "chapter"),
        (
            '[chapter]\ntitle = "x"\nsource = "y"\n[symbols]\nx = "real"\n[[entry]]\n'
            'id = "a"\ntitle = "b"\nlatex = "x"\n'
            'left = "x"\nright = "x"\n[[entry.misprint]]\nlatex = "x"\nright = "2"\n',
            "source",
        ),
    ],
)
def test_a_chapter_that_lacks_something_is_refused(tmp_path, text, what):
    path = tmp_path / "x.toml"
    path.write_text(text)
    with pytest.raises(nav.NavsymError, match=what):
        read_chapter(path)
