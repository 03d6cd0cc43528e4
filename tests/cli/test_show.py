"""show, explain and cite speak about one claim, and refuse what is none with the way to the right one."""

from __future__ import annotations

import dataclasses
import json
import subprocess
import sys

import pytest

import navsym as nav
from navsym.cli.main import run

REMARK = "alpha_beta_filter:remark.critical"


def document(capsys, *words):
    status = run([*words, "--json"])
    return status, json.loads(capsys.readouterr().out)


def test_show_has_both_sides_and_the_verdict(capsys):
    status, record = document(capsys, "show", "alpha_beta_filter:12.stable")
    assert status == 0 and record["status"] == record["expect"] == "PROVED"
    assert record["printed"] == "4*r" and record["derived"] and record["scope"] == "all r in (0, 1]"


def test_show_prints_lines_for_people(capsys):
    assert run(["show", REMARK]) == 0
    text = capsys.readouterr().out
    assert text.startswith(f"{REMARK}  REFUTED\n") and "  at       r = 1/2" in text


def test_show_of_an_equation_in_parts_has_all_of_them(capsys):
    status, answer = document(capsys, "show", "alpha_beta_filter:12")
    assert status == 0 and {record["number"] for record in answer["claims"]} == {
        "12.characteristic",
        "12.other-root",
        "12.stable",
    }
    assert run(["show", "4.16"]) == 2 and "take guaranteed_velocity:4.16" in capsys.readouterr().err


def test_explain_works_the_counterexample_out_and_names_the_correction(capsys):
    status, told = document(capsys, "explain", REMARK)
    assert status == 0 and told["corrected_by"] == f"{REMARK}*"
    assert told["correction"]["title"].startswith("The discriminant is -(1 - r)^2")
    assert told["source"].startswith("derivations/alpha_beta_filter.py:")
    words = " ".join(step["words"] for step in told["steps"])
    assert "At r = 1/2" in words and "The printed side is 0, the derived side is -0.4375" in words


def test_explain_says_how_a_difference_vanished(capsys):
    assert run(["explain", "alpha_beta_filter:4"]) == 0
    text = capsys.readouterr().out
    assert "printed - derived is zero by exact algebra" in " ".join(text.split())
    assert "navsym check" in text


def test_cite_gives_bibtex_of_paper_and_verdict(capsys):
    status, cited = document(capsys, "cite", "alpha_beta_filter:8", "--fresh")
    assert status == 0 and cited["status"] == "PROVED"
    assert "@misc{kalata1984," in cited["bibtex"] and "alpha\\_beta\\_filter:8" in cited["bibtex"]


@pytest.mark.parametrize("verb", ["show", "explain", "cite"])
@pytest.mark.parametrize(
    ("wanted", "hint"),
    [
        ("alpha_beta_filter:remark", "alpha_beta_filter:remark.critical"),
        ("alpha_beta_filter", "alpha_beta_filter:4"),
        ("alpha_beta_filter:qqqqqqqq", "navsym list"),
        ("alpha_beta_filte:4", "did you mean alpha_beta_filter?"),
        ("", "name one of them"),
        ("<script>:1", "expected one of"),
    ],
)
def test_an_id_that_is_none_gets_advice(capsys, verb, wanted, hint):
    status, answer = document(capsys, verb, wanted)
    assert status == 2 and answer["error"]["kind"] == "domain" and hint in answer["error"]["message"]


def test_python_without_docstrings_is_refused_in_one_line():
    words = [sys.executable, "-OO", "-m", "navsym", "show", REMARK]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 3 and done.stderr.startswith("navsym: missing: expected Python with docstrings")
    assert len(done.stderr.splitlines()) == 1


def test_a_cited_refutation_names_what_stands_in_its_place(capsys):
    cited = document(capsys, "cite", "guaranteed_velocity:4.3.u2")[1]["bibtex"]
    assert "Corrected by guaranteed\\_velocity:4.3.u2*, PROVED: -sin(T/4)**2/cos(T/2)." in cited


def test_a_number_without_its_paper_is_answered_with_the_papers_that_have_it(capsys):
    assert run(["show", "4.3.u2"]) == 2
    assert "take guaranteed_velocity:4.3.u2" in capsys.readouterr().err
    assert run(["explain", "9", "--json"]) == 2
    assert "multistructure:9 or terrain_search:9" in capsys.readouterr().out


def test_the_words_of_a_claim_cannot_steer_a_terminal_or_feign_a_line(monkeypatch):
    from navsym.claims import Record
    from navsym.cli.show import as_text

    title = "good \x1b[2J\u202e\n  at       a = 1"
    record = nav.show(REMARK)[0]
    shown = as_text(dataclasses.replace(record, title=title))
    assert isinstance(record, Record) and "\x1b" not in shown and "\u202e" not in shown
    assert r"good \x1b[2J\u202e\n  at" in shown.splitlines()[1]
