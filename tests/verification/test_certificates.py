"""What is kept costs time and nothing else: damaged, foreign, forged or slow, it never makes a verdict."""

from __future__ import annotations

import contextlib
import json
import multiprocessing
import signal
import sqlite3
import time

import pytest

import navsym as nav
from navsym.checker import Refused
from navsym.cli.main import run
from navsym.verification import certificates, decide
from navsym.verification.ledger import lock_folder

DAMAGED = {
    "cut": lambda text: text[: len(text) // 2],
    "empty": lambda text: "",
    "null": lambda text: "null",
    "a list": lambda text: "[1, 2]",
    "numbers for texts": lambda text: text.replace('"PROVED"', "7"),
    "an unknown status": lambda text: text.replace('"PROVED"', '"SURE"'),
    "nothing in it": lambda text: "{}",
    "null in it": lambda text: json.dumps(dict.fromkeys(json.loads(text))),
    "bytes that are no text": lambda text: "\0" + text,
}


@pytest.fixture
def tiny(papers):
    """A paper with its files written, and an empty store."""
    papers.add("tiny")
    papers.verify().write()
    for file in (papers.folder.parent / "cache").iterdir():
        file.unlink()
    return papers


@pytest.fixture
def searches(monkeypatch, tmp_path):
    """Counts what is searched, in the children too."""
    count, first = tmp_path / "searched", decide.decide

    def search(statement, **limits):
        with count.open("a") as file:
            file.write("x")
        return first(statement, **limits)

    monkeypatch.setattr(decide, "decide", search)
    monkeypatch.setattr(decide, "warm_up", lambda: None)
    return lambda: len(count.read_text()) if count.exists() else 0


def entry_of(papers):
    """The only entry of the certificates, with its key."""
    ((key, entry),) = json.loads((papers.folder / "certificates.json").read_text()).items()
    return key, entry


def change_entry(papers, **changes):
    """Alter the only entry of the certificates."""
    key, entry = entry_of(papers)
    papers.write("certificates.json", json.dumps({key: entry | changes}))


def test_a_fresh_clone_checks_and_does_not_search(tiny, searches):
    assert tiny.status() == "PROVED" and searches() == 0
    assert tiny.status(fresh=True) == "PROVED" and searches() == 1


def test_the_users_store_has_what_the_papers_file_has_not(tiny, searches):
    (tiny.folder / "certificates.json").unlink()
    assert [tiny.status(), tiny.status()] == ["PROVED"] * 2 and searches() == 1


def test_a_title_an_id_and_what_is_expected_are_no_part_of_the_key(tiny, searches):
    text = (tiny.folder / "tiny.py").read_text()
    tiny.write("tiny.py", text.replace('"1"', '"2", expect="REFUTED"').replace("The first.", "Another title."))
    (record,) = tiny.verify()
    assert (record.number, record.title, record.expect, record.status) == ("2", "Another title.", "REFUTED", "PROVED")
    assert searches() == 0


def test_what_a_kept_verdict_says_is_that_of_the_search(tiny):
    (kept,), (new,) = tiny.verify(), tiny.verify(fresh=True)
    assert kept.to_json() | {"seconds": 0} == new.to_json() | {"seconds": 0}


@pytest.mark.parametrize("damage", DAMAGED)
def test_damaged_certificates_are_searched_again(tiny, searches, damage):
    path = tiny.folder / "certificates.json"
    path.write_text(DAMAGED[damage](path.read_text()), encoding="utf-8")
    assert tiny.status() == "PROVED" and searches() == 1


@pytest.mark.parametrize(
    "changes",
    [
        {"status": "REFUTED"},
        {"status": "OPEN"},
        {"certificate": None},
        {"certificate": {"kind": "all", "of": []}},
        {"certificate": {"kind": "identity", "left": "x + x", "right": "2*x", "symbols": ["x"]}},
        {"certificate": [1]},
        {"assumptions": "x"},
        {"counterexample": {"x": 5}},
        {"difference": [1]},
    ],
    ids=lambda changes: next(iter(changes)),
)
def test_a_forged_entry_is_searched_again(tiny, searches, changes):
    change_entry(tiny, **changes)
    assert tiny.status() == "PROVED" and searches() == 1


def test_the_certificate_of_another_statement_grants_nothing(tiny, searches):
    _, good = entry_of(tiny)
    tiny.add("tiny", two="3")
    (record,) = tiny.verify()
    tiny.write("certificates.json", json.dumps({record.statement: good}))
    (tiny.folder.parent / "cache" / "results.sqlite").unlink()
    assert tiny.status() == "REFUTED" and searches() == 2


def test_a_refutation_at_another_point_than_its_certificate_is_searched_again(papers, searches):
    papers.add("tiny", two="3")
    papers.verify().write()
    (papers.folder.parent / "cache" / "results.sqlite").unlink()
    assert papers.status() == "REFUTED" and searches() == 1
    change_entry(papers, counterexample={"x": "12345"})
    (record,) = papers.verify()
    assert record.status == "REFUTED" and record.counterexample != {"x": "12345"} and searches() == 2


def test_a_check_that_takes_long_leaves_time_for_the_search(tiny, searches, monkeypatch, tmp_path):
    """The clock of the check is set to a third, and what it does at its end is done at once: nobody waits for it."""

    def check_for_ever(texts, certificate):
        (tmp_path / "left").write_text(str(signal.getitimer(signal.ITIMER_PROF)[0]))
        while True:
            signal.raise_signal(signal.SIGPROF)

    monkeypatch.setattr(certificates, "grant", check_for_ever)
    assert tiny.status(seconds=90) == "PROVED" and searches() == 1
    assert 0 < float((tmp_path / "left").read_text()) < 31  # a third, up to a tick of the clock


def test_the_clock_of_a_check_ends_it():
    with pytest.raises(Refused, match="more than"), certificates.limited_time(0.01):
        while True:
            time.process_time()
    assert signal.getitimer(signal.ITIMER_PROF) == (0.0, 0.0)


def test_a_property_is_computed_every_time_and_not_kept(papers, searches):
    facts = "from navsym.claims import PROVED, Finding, Property\n"
    papers.add("tiny", facts, statement="Property(3, Finding(3, 'counting', PROVED))")
    papers.verify().write()
    assert json.loads((papers.folder / "certificates.json").read_text()) == {}
    assert papers.status() == "PROVED" and searches() == 2


def test_what_a_store_of_others_cannot_keep_is_named(papers, capsys):
    papers.add("tiny")
    store = papers.folder.parent / "cache" / "results.sqlite"
    store.parent.mkdir()
    with contextlib.closing(sqlite3.connect(store)) as connection:
        connection.execute("create table results (a, b)")
        connection.commit()
    papers.forget()
    assert run(["verify", "--json", "--jobs", "1"]) == 3
    document = json.loads(capsys.readouterr().out)
    assert document["unsaved"] == ["tiny:1"] and document["counts"]["PROVED"] == 1


# The ledger


@pytest.mark.parametrize("damage", DAMAGED)
def test_a_damaged_ledger_is_an_error_for_readers_and_costs_verify_nothing(tiny, capsys, damage):
    path = tiny.folder / "verdicts.json"
    text = path.read_text()
    path.write_text(DAMAGED[damage](text), encoding="utf-8")
    for words in (["list", "--json"], ["cite", "tiny:1", "--json"], ["report", "--from", str(path), "--json"]):
        tiny.forget()
        assert run(words) == 2, words
        error = json.loads(capsys.readouterr().out)["error"]
        assert "verdicts.json" in error["where"] and error["kind"] != "internal"
        assert "expected" in error["message"]
    tiny.forget()
    assert run(["verify", "--jobs", "1"]) == 0
    assert "1 PROVED" in capsys.readouterr().out
    tiny.forget()
    assert run(["verify", "--jobs", "1", "--write"]) == 0
    assert path.read_text() == text


def test_a_damaged_ledger_is_not_written_over_when_it_has_more_papers(tiny, capsys):
    tiny.add("other")
    tiny.verify().write()
    tiny.write("verdicts.json", "{")
    tiny.forget()
    assert run(["verify", "tiny", "--jobs", "1", "--write"]) == 3
    told = capsys.readouterr()
    assert "1 PROVED" in told.out and "the ledger is not written" in told.err
    assert (tiny.folder / "verdicts.json").read_text() == "{"


def test_list_shows_declarations_where_the_text_has_changed_since(tiny, capsys):
    tiny.forget()
    (shown,) = nav.claims()
    assert shown.record is not None and shown.record.statement
    tiny.add("tiny", two="3")
    tiny.forget()
    assert run(["list", "--json"]) == 0
    told = capsys.readouterr()
    (claim,) = json.loads(told.out)["claims"]
    assert claim["decided"] is False and "tiny has changed" in told.err


def test_a_report_from_a_ledger_decides_what_has_changed_since(tiny, tmp_path):
    tiny.add("tiny", two="3")
    tiny.forget()
    said = []
    site = nav.report(out=tmp_path / "pages", source=tiny.folder / "verdicts.json", jobs=1, remark=said.append)
    assert site.ledger.counts["REFUTED"] == 1 and "tiny has changed" in said[0]


def test_several_writers_at_once_lose_nothing(papers):
    names = ["one", "other", "third"]
    for name in names:
        papers.add(name)
    ledgers = [papers.verify(name) for name in names]
    papers.forget()
    fork = multiprocessing.get_context("fork")
    for _ in range(5):
        (papers.folder / "verdicts.json").unlink(missing_ok=True)
        writers = [fork.Process(target=ledger.write) for ledger in ledgers]
        for writer in writers:
            writer.start()
        for writer in writers:
            writer.join()
        stored = json.loads((papers.folder / "verdicts.json").read_text())
        assert [paper["module"] for paper in stored["papers"]] == names
        assert len(json.loads((papers.folder / "certificates.json").read_text())) == 1  # they say the same


def test_a_writer_waits_for_another(papers):
    papers.add("tiny")
    ledger = papers.verify()
    writer = multiprocessing.get_context("fork").Process(target=ledger.write)
    with lock_folder(papers.folder):
        writer.start()
        writer.join(1)
        assert writer.is_alive() and not (papers.folder / "verdicts.json").exists()
    writer.join()
    assert (papers.folder / "verdicts.json").exists()


def test_the_key_does_not_depend_on_the_process(papers):
    papers.add("tiny", statement="Equation(sp.expand((x + 1)**4), (1 + x)**4)")
    assert len({papers.verify()["tiny:1"].statement for _ in range(2)}) == 1


def test_equal_statements_of_two_papers_have_scopes_of_their_own(papers):
    papers.add("sized")
    papers.add("plain")
    text = (papers.folder / "sized.py").read_text()
    papers.write("sized.py", text.replace("equations=()", 'equations=(), scopes={"1": "n = 8"}'))
    scopes = {name: papers.verify(name).claims[0].scope for name in ("sized", "plain", "sized")}
    assert scopes == {"sized": "all real x; n = 8", "plain": "all real x"}
