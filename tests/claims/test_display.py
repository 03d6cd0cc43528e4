"""Notebooks show models, claims, statements, verdicts and solutions; what is shown is escaped."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
import sympy as sp

from navsym.claims import PROVED, REFUTED, Bound, Equation, Finding, Optimum, Property, Verdict, claims_of
from navsym.claims.display import latex_of
from navsym.core.numbers import Number
from navsym.guaranteed.phases.driver import find_phases
from navsym.guaranteed.phases.family import family_of
from navsym.guaranteed.problem import from_contents
from navsym.guaranteed.solver import solve
from navsym.models.modelfile import linear_model, model_from
from navsym.observability.answer import observe_linear
from navsym.report.formula.latex import mathml
from navsym_papers import alpha_beta_filter

T, t = sp.Symbol("T", positive=True), sp.Symbol("t", real=True)
MODEL = {
    "model": {"name": "line", "states": ["place", "speed"], "F": [["0", "1"], ["0", "0"]]},
    "parameters": {"T": ["1", "2"]},
    "measurement": [{"name": "position", "h": ["1", "0"], "sigma": "1"}],
    "interval": {"T": "T"},
    "targets": {"speed": ["0", "1"]},
}


@pytest.fixture(scope="module")
def file():
    return model_from(MODEL)


def test_importing_the_nouns_loads_no_engine_and_no_report():
    code = "import sys, navsym.claims; print([m for m in ('sympy', 'navsym.report.page', 'numpy') if m in sys.modules])"
    root = Path(__file__).parents[1]
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=True, timeout=120)
    assert done.stdout.strip() == "[]"


def test_a_model_shows_its_equations_with_named_states(file):
    shown = linear_model(file)._repr_latex_()
    assert shown.startswith(r"$\displaystyle \frac{d}{d") and r"\text{speed}" in shown and shown.endswith("$")
    assert r"\text{place} \\ \text{speed}" in shown and "<mtext>speed</mtext>" in mathml(shown.strip("$"))
    assert "0 & 1" in file._repr_latex_()


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        (Equation(2 * T, T + T), r"2 T \overset{?}{=} 2 T"),
        (Equation(sp.Rational(46, 10), T, tolerance=sp.Rational(1, 20)), r"\pm \frac{1}{20}"),
        (Bound(T, "<=", sp.Integer(3)), r"T \overset{?}{\le} 3"),
        (Property("best", Finding("worst", "by reading", PROVED)), r"\text{best} \overset{?}{=} \text{worst}"),
        (Optimum((1, t), (0, 1), t, (0, T), (1, 2 / T), (0, T), (-1 / T, 1 / T), 2 / T), r"\text{value } \frac{2}{T}"),
    ],
)
def test_a_statement_shows_both_sides_as_a_question(statement, words):
    assert words in statement._repr_latex_()


def test_a_claim_shows_itself_without_being_derived():
    first = claims_of(alpha_beta_filter)[0]
    shown = first._repr_html_()
    assert first.id in shown and "declared" in shown


def test_a_verdict_shows_its_mark_counterexample_and_assumptions_and_escapes_words():
    point = {"counterexample": {"T": "1"}, "difference": Number("2", "2")}
    verdict = Verdict(REFUTED, "<b>exact</b> point", "all real T", ("T != 0",), **point)
    shown = verdict._repr_html_()
    assert "✗ REFUTED" in shown and "at T = 1: left - right = 2" in shown and "assuming T != 0" in shown
    assert "<b>exact" not in shown


def test_solutions_show_tables(file):
    solution = solve(from_contents(model_from(MODEL, values={"T": "2"})), digits=10)._repr_html_()
    assert solution.count("<tr>") == 3 and "position" in solution and "speed" in solution
    answer = find_phases(family_of(file, "speed", "T"), sp.Integer(1), sp.Integer(2))._repr_html_()
    assert r"\frac{2}{T}" in answer and "✓ PROVED" in answer
    seen = observe_linear(linear_model(file))._repr_html_()
    assert "<b>observable</b>: 2 of 2" in seen


def test_words_inside_formulas_cannot_command_latex():
    assert latex_of(r"\input{x} $ #") == r"\text{ input x     }"
    assert not re.search(r"[<>]", latex_of((sp.Symbol("x"), 2)))


@pytest.mark.long
def test_what_is_no_verdict_shows_itself_as_a_table_too():
    import navsym as nav

    found = nav.book.search("skew-is-cross")
    shown = [nav.doctor(), nav.diff("sin(2*a)", "2*sin(a)*cos(a)"), found, found[0], nav.book, nav.atlas]
    for answer in [*shown, nav.atlas["INS: rest: position"]]:
        heads, rows = answer.table()
        assert answer._repr_html_().count("<tr>") == len(list(rows)) + 1 and heads
    assert "cross(u, v)" in found._repr_html_() and "EQUAL" in shown[1]._repr_html_()
