"""A new paper passes the generic tests from its first minute, and claims are added by formulas."""

from __future__ import annotations

import importlib.util
import json
import math

import pytest
from hypothesis import assume, given, reject, settings
from hypothesis import strategies as st

from navsym.claims import Equation
from navsym.cli.main import run
from navsym.core.errors import NavsymError
from navsym.language.printer import to_python
from navsym.language.scaffold import read_claim_side, side_source, split_numbers
from navsym.prove.ladder import decide
from navsym.verification.decide import decide_papers
from navsym.verification.papers import paper_module
from tests.attacks.campaigns.edits import spoil


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
    document = decide_papers([paper], jobs=1).document()
    assert [r["status"] for r in document["claims"]] == ["PROVED"]
    assert document["papers"][0] | {"definitions": 3, "missing": []} == document["papers"][0]
    assert all(not decide(spoil(claim.derive())).status.holds for claim in paper.claims)


def test_claims_are_added_with_the_verdict_that_was_found(folder, capsys):
    assert add(folder, "1", "--printed", "sin(w*t)**2/3 + 0.5", "--derived", "(1 - cos(2*w*t))/6 + 1/2") == 0
    assert add(folder, "2", "--printed", "a/3", "--derived", "a/4", "--reason", "a quarter is meant") == 0
    assert add(folder, "2*", "--printed", "a/4", "--derived", "a*(1/4)", "--corrects", "2") == 0
    document = decide_papers([loaded(folder / "sample_paper.py")], jobs=1).document()
    assert [(r["number"], r["status"], r["expect"]) for r in document["claims"]] == [
        ("1", "PROVED", "PROVED"),
        ("2", "REFUTED", "REFUTED"),
        ("2*", "PROVED", "PROVED"),
    ]
    paper = document["papers"][0]
    assert (paper["claimed"], paper["definitions"], paper["missing"]) == (2, 1, [])


def test_names_that_must_be_positive_are_asked_for_and_declared(folder, capsys):
    sides = ("--printed", "(R**3*g)**(1/3)", "--derived", "R*g**(1/3)")
    before = (folder / "sample_paper.py").read_text()
    assert add(folder, "1", *sides) == 2
    assert "add --positive R,g if they are" in capsys.readouterr().err
    assert (folder / "sample_paper.py").read_text() == before
    assert add(folder, "1", *sides, "--positive", "R,g") == 0
    assert add(folder, "2", "--printed", "sqrt(R**2)", "--derived", "R") == 0  # as the file declares it now
    document = decide_papers([loaded(folder / "sample_paper.py")], jobs=1).document()
    assert [r["status"] for r in document["claims"]] == ["PROVED", "PROVED"]
    assert add(folder, "3", "--printed", "R", "--derived", "R", "--positive", "R,q") == 2
    assert "got q" in capsys.readouterr().err


def test_a_printed_numeral_has_a_tolerance(folder, capsys):
    derived = ("--derived", "2*pi*sqrt(6371000/9.81)")
    assert add(folder, "1", "--printed", "5064", *derived) == 0
    assert "--tolerance" in capsys.readouterr().out
    assert add(folder, "2", "--printed", "5063.5", *derived, "--tolerance", "0.05") == 0
    document = decide_papers([loaded(folder / "sample_paper.py")], jobs=1).document()
    assert [r["status"] for r in document["claims"]] == ["REFUTED", "CERTIFIED"]
    assert add(folder, "3", "--printed", "1", "--derived", "1", "--tolerance", "0") == 2


def test_a_number_that_the_paper_does_not_have_is_told_apart(folder, capsys):
    assert add(folder, "9", "--printed", "1", "--derived", "1") == 0
    assert "9 is none of the numbered equations" in capsys.readouterr().out


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
    assert split_numbers("1-3, 4.a") == ("1", "2", "3", "4.a")
    assert split_numbers("1.9-1.11,2.1") == ("1.9", "1.10", "1.11", "2.1")


@pytest.mark.parametrize(
    ("text", "source"),
    [
        ("P*h/(h**2*P + R)", "P*h/(P*h**2 + R)"),
        ("-2*c*(a + b)/3", "-2*c*(a + b)/3"),
        ("1/(2*a)", "1/(2*a)"),
        ("sqrt(2)*sin(a/2)**2 - 1/3", "sp.sqrt(2)*sp.sin(a/2)**2 - sp.Rational(1, 3)"),
    ],
)
def test_source_of_a_formula_is_written_as_a_person_would(text, source):
    assert to_python(read_claim_side(text, "")) == source


def test_a_bare_number_is_exact_and_a_long_sum_has_a_line_for_each_term():
    assert (
        side_source(read_claim_side("2", "")) == "sp.Integer(2)"
        and side_source(read_claim_side("1/2", "")) == "sp.Rational(1, 2)"
    )
    lines = side_source(read_claim_side(" + ".join(f"a**{k}*sin({k}*b)" for k in range(2, 14)), "")).splitlines()
    assert len(lines) == 14 and max(map(len, lines)) < 100


FORMULAS = st.recursive(
    st.sampled_from(["a", "b", "2", "3", "1/3", "pi", "0.5"]),
    lambda inner: st.one_of(
        st.builds("({} {} {})".format, inner, st.sampled_from("+-*/"), inner),
        st.builds("({})**{}".format, inner, st.sampled_from(["2", "3", "(-1)", "(1/2)", "(-2)", "(-1/3)"])),
        st.builds("{}({})".format, st.sampled_from(["sin", "cos", "exp"]), inner),
    ),
    max_leaves=7,
)


@settings(max_examples=300, deadline=None)
@given(FORMULAS)
def test_source_of_any_formula_builds_the_same_expression(text):
    import sympy

    try:
        expression = read_claim_side(text, "")
    except NavsymError:
        reject()
    assume(expression.is_finite or expression.free_symbols)
    names = {name: sympy.Symbol(name, real=True) for name in "ab"}
    again = sympy.sympify(eval(side_source(expression), {"sp": sympy, **names}))
    assert not again.atoms(sympy.Float)
    assert again == expression or decide(Equation(again, expression)).status.holds


@given(st.sampled_from(["a/3", "a**2/7 - 1/3", "sin(a/2)**(-2)", "exp(-a)*sqrt(a)", "2**(-3)*a", "abs(a) + pi"]))
def test_source_of_a_formula_keeps_it_exact(text):
    import sympy

    expression = read_claim_side(text, "")
    source = to_python(expression)
    # The source is ours, made from a parsed formula; the test runs it as the new module would.
    again = eval(source, {"sp": sympy, "a": sympy.Symbol("a", real=True)})
    assert again == expression and not again.atoms(sympy.Float)
    assert math.isfinite(float(again.subs(sympy.Symbol("a", real=True), sympy.Rational(1, 3))))


@pytest.mark.parametrize(
    "title", ["a\\", 'It is "one".', 'ends in a quote"', "two  blanks \\n and {braces}", "\\N{DIGIT}", "x'"]
)
def test_a_title_is_written_as_it_was_given(folder, title):
    assert add(folder, "1", "--printed", "a", "--derived", "2*a", "--title", title, "--reason", title) == 0
    (record,) = [r for r in decide_papers([loaded(folder / "sample_paper.py")], jobs=1).document()["claims"]]
    assert record["title"] == title and record["reason"] == title
    words = ["new-paper", "other", "--title", title, "--equations", "1", "--folder", str(folder)]
    assert run(words) == 0 and loaded(folder / "other.py").paper.title == title


@pytest.mark.parametrize("title", ["one\ntwo", "\x1b[2J", "right\u202eleft", "\ud800"])
def test_a_title_of_more_than_one_printable_line_is_refused(folder, title, capsys):
    before = (folder / "sample_paper.py").read_text()
    assert add(folder, "1", "--printed", "a", "--derived", "a", "--title", title) == 2
    assert "--title: expected one printable line" in capsys.readouterr().err
    assert (folder / "sample_paper.py").read_text() == before


#: Words of new-claim beside the number, and the verdict that is known from elsewhere.
WORDED = [
    (["--formula", "sin(a) <= a", "--range", "a=0,pi"], "PROVED"),
    (["--formula", "sin(a) <= a", "--range", "a=-pi,0"], "REFUTED"),
    (["--printed", r"\frac{1}{2}\sin 2a", "--derived", "sin(a)*cos(a)"], "PROVED"),
    (["--formula", r"\frac{1}{2}\sin 2a = \sin a"], "REFUTED"),
    (["--formula", "0 < exp(-s) <= 1", "--range", "s=0,oo"], "PROVED"),
    (["--printed", "a/a", "--derived", "1"], "PROVED"),
    (["--printed", "[[0, -w], [w, 0]] @ [[0, -w], [w, 0]]", "--derived", "-w**2*eye(2)"], "PROVED"),
    (["--printed", "[[0, -w], [w, 0]] @ [[0, -w], [w, 0]]", "--derived", "w**2*eye(2)"], "REFUTED"),
    (["--printed", "integral(s*exp(-s), s, 0, T)", "--derived", "1 - (1 + T)*exp(-T)", "--positive", "T"], "PROVED"),
    (
        [
            *("--formula", "dot(u, v) <= 1", "--given", "dot(u, u) = 1", "--given", "dot(v, v) = 1"),
            *("--declare", "u={ vector = 3 }", "--declare", "v={ vector = 3 }"),
        ],
        "PROVED",
    ),
    (["--formula", "norm(u) >= 1", "--declare", "u={ vector = 2 }"], "REFUTED"),
    (["--formula", "lambda + 1 > lambda", "--declare", "lambda=positive"], "PROVED"),
    (["--formula", "x**2 = 2*x", "--declare", 'x=["0", "1"]'], "REFUTED"),
]


@pytest.mark.parametrize(("words", "status"), WORDED)
def test_a_claim_in_the_words_of_files_has_the_same_verdict_when_its_module_is_read_again(
    folder, capsys, words, status
):
    assert add(folder, "1", *words, "--title", "A formula.", "--json") == 0
    assert json.loads(capsys.readouterr().out)["status"] == status
    (record,) = decide_papers([loaded(folder / "sample_paper.py")], jobs=1).document()["claims"]
    assert (record["status"], record["expect"]) == (status, status)
    assert "True" not in record["printed"] and (status == "PROVED" or record["counterexample"])


def test_names_of_the_module_keep_their_declaration_in_words(folder, capsys):
    assert add(folder, "1", "--printed", "sqrt(R**2)", "--derived", "R", "--positive", "R") == 0
    assert add(folder, "2", "--printed", "sqrt(R**2)", "--relation", ">=", "--derived", "R/2") == 0
    assert 'R="positive"' in (folder / "sample_paper.py").read_text()


@pytest.mark.parametrize(
    "words",
    [
        ["--formula", "x = y", "--declare", "z) + open('y'=positive"],
        ["--formula", "x = given", "--declare", "given=positive"],
        ["--formula", "x = x", "--printed", "x"],
        ["--formula", "x = x", "--relation", "<="],
        ["--printed", "x"],
        ["--formula", "x"],
        ["--formula", r"\frac{1"],
        ["--formula", "x = x", "--declare", "x={ vector ="],
        ["--formula", "x = x", "--declare", "y=positive"],
        ["--formula", "x = x", "--range", "x=3,1"],
        ["--formula", "x = x\n+ 1"],
        ["--formula", "__import__('os') = 1"],
        ["--formula", "x @ y = 1"],
    ],
)
def test_words_that_are_no_formula_are_refused_and_the_file_stays(folder, capsys, words):
    before = (folder / "sample_paper.py").read_text()
    assert add(folder, "1", *words) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert (folder / "sample_paper.py").read_text() == before


@given(st.text(max_size=30), st.text(max_size=10))
def test_any_text_becomes_the_same_text_in_source(text, name):
    from navsym.language.scaffold import quote_formula, write_plain

    assert eval(quote_formula(text)) == text
    assert eval(write_plain({name: [text, {"vector": 3}]})) == {name: [text, {"vector": 3}]}
