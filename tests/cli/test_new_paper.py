"""A new paper passes the generic tests from its first minute, and claims are added by formulas."""

from __future__ import annotations

import importlib.util
import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from navsym.cli.main import run
from navsym.methods.verification import paper_module, verify
from navsym.proof.ladder import decide
from navsym.proof.mutants import spoiled
from navsym.text.scaffold import equation_numbers, exact_source, read


def loaded(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return paper_module(module)


@pytest.fixture
def folder(tmp_path):
    words = ["new-paper", "sample_paper", "--title", 'A "sample"', "--author", "A. B", "--year", "1923"]
    assert run([*words, "--equations", "1-3", "--folder", str(tmp_path)]) == 0
    return tmp_path


def add(folder, *words):
    return run(["new-claim", "sample_paper", *words, "--folder", str(folder)])


def test_a_new_paper_passes_the_generic_tests(folder):
    paper = loaded(folder / "sample_paper.py")
    document = verify([paper], jobs=1)
    assert [r["status"] for r in document["claims"]] == ["PROVED"]
    assert document["papers"][0] | {"definitions": 3, "missing": []} == document["papers"][0]
    assert all(not decide(spoiled(claim.derive())).status.holds for claim in paper.claims)


def test_claims_are_added_with_the_verdict_that_was_found(folder, capsys):
    assert add(folder, "1", "--printed", "sin(w*t)**2/3 + 0.5", "--derived", "(1 - cos(2*w*t))/6 + 1/2") == 0
    assert add(folder, "2", "--printed", "a/3", "--derived", "a/4", "--reason", "a quarter is meant") == 0
    assert add(folder, "2*", "--printed", "a/4", "--derived", "a*(1/4)", "--corrects", "2") == 0
    document = verify([loaded(folder / "sample_paper.py")], jobs=1)
    assert [(r["number"], r["status"], r["expect"]) for r in document["claims"]][1:] == [
        ("1", "PROVED", "PROVED"), ("2", "REFUTED", "REFUTED"), ("2*", "PROVED", "PROVED"),
    ]  # fmt: skip
    assert document["papers"][0]["claimed"] == 2


@pytest.mark.parametrize(
    "words",
    [
        ("1", "--printed", "__import__('os')", "--derived", "1"),
        ("1", "--printed", "lambda", "--derived", "1"),
        ('1"); import os #', "--printed", "1", "--derived", "1"),
        ("example", "--printed", "1", "--derived", "1"),
        ("1", "--printed", "", "--derived", "1"),
    ],
)
def test_what_is_no_formula_or_number_is_refused_and_the_file_stays(folder, capsys, words):
    before = (folder / "sample_paper.py").read_text()
    assert add(folder, *words) == 2
    assert (folder / "sample_paper.py").read_text() == before


def test_quotes_and_backslashes_in_words_stay_words(tmp_path):
    title = 'x""" + open("y") + """\\'
    assert run(["new-paper", "wild_paper", "--title", title, "--folder", str(tmp_path)]) == 0
    assert loaded(tmp_path / "wild_paper.py").paper.title == title


@pytest.mark.parametrize("name", ["Upper", "a-b", "../x", "class", "", "1a", "sample_paper"])
def test_names_that_are_no_new_module_are_refused(folder, capsys, name):
    assert run(["new-paper", name, "--folder", str(folder), "--json"]) == 2
    assert "error" in json.loads(capsys.readouterr().out)


def test_lists_of_equation_numbers():
    assert equation_numbers("1-3, 4.a") == ("1", "2", "3", "4.a")
    assert equation_numbers("1.9-1.11,2.1") == ("1.9", "1.10", "1.11", "2.1")


@given(st.sampled_from(["a/3", "a**2/7 - 1/3", "sin(a/2)**(-2)", "exp(-a)*sqrt(a)", "2**(-3)*a", "abs(a) + pi"]))
def test_source_of_a_formula_keeps_it_exact(text):
    import sympy

    expression = read(text, "")
    source = exact_source(expression)
    # The source is ours, made from a parsed formula; the test runs it as the new module would.
    again = eval(source, {"sp": sympy, "a": sympy.Symbol("a", real=True)})
    assert again == expression and not again.atoms(sympy.Float)
    assert math.isfinite(float(again.subs(sympy.Symbol("a", real=True), sympy.Rational(1, 3))))
