"""Searches by a formula: every entry is found under other names and in another order, and nothing else matches."""

import re

import pytest

import navsym as nav
from navsym.book.search import is_formula, is_renamed, read_sides, write_form
from navsym.cli.main import run
from navsym.language.tree import list_names
from tests.sampling import thinned

SAMPLE = [entry for entry in list(nav.book.values())[::12] if not entry.document["claim"][0].get("given")]
EQUATIONS = [entry for entry in SAMPLE if "chain" not in entry.document["claim"][0]]


def form_of(text):
    (tree,) = read_sides(text)
    return write_form(tree)


def renamed(text):
    """The text with every name of it lengthened."""
    names = {name for side in read_sides(re.sub("[<>!]?=", "+", text)) for name in list_names(side)}
    return re.sub(r"(?<!\.)\b[A-Za-z]\w*", lambda mark: f"other_{mark[0]}" if mark[0] in names else mark[0], text)


@pytest.mark.parametrize("entry", thinned(([entry] for entry in EQUATIONS), 4), ids=lambda entry: entry.id)
def test_an_entry_is_found_first_under_other_names_with_its_sides_exchanged(entry):
    block = entry.document["claim"][0]
    if block.get("relation", "=") != "=" or "integral" in entry.statement or "sum(" in entry.statement:
        pytest.skip("bound variables and inequalities keep their order")
    text = renamed(f"{block['right']} = {block['left']}")
    assert is_formula(text)
    found = nav.book.search(text)
    assert entry in found[:8], text


@pytest.mark.parametrize(
    ("text", "other", "same"),
    [
        ("a + b*c", "z*y + x", True),
        ("a + b*c", "x + y*x", False),
        ("a - b", "x - y", True),
        ("a - b", "x + y", False),
        ("sqrt(x)", "y**(1/2)", True),
        ("x*x*y", "v**2*u", True),
        ("a/b", "b/a", True),
        ("a/(a + b)", "b/(a + b)", True),
        ("a/(a + b)", "c/(a + b)", False),
        ("sin(x)*cos(y)", "cos(a)*sin(b)", True),
        ("sin(x)*cos(x)", "cos(a)*sin(b)", False),
        ("A @ B", "Q @ P", True),
        ("A @ A.T", "P @ Q.T", False),
        ("u[1]", "v[2]", False),
        ("2*x", "3*x", False),
    ],
)
def test_forms_match_by_one_renaming_and_no_algebra(text, other, same):
    assert is_renamed(form_of(text), form_of(other)) is same


def test_terms_of_a_longer_sum_are_found():
    found = nav.book.search("1 - k**2*sin(x)**2")
    assert found and all("sin(" in entry.statement for entry in found)


def test_words_stay_words():
    assert [entry.id for entry in nav.book.search("melbourne")] == ["melbourne-wubbena"]
    assert not is_formula("time-of-flight")


@pytest.mark.parametrize("text", ["x +", "a = b = c", "((", "x", "sin()", "[1, 2"])
def test_what_is_no_formula_is_refused_with_its_place(text, capsys):
    assert run(["book", f" {text} + -" if text == "x" else text]) in (1, 2)
    assert "Traceback" not in capsys.readouterr().err
