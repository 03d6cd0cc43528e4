"""Printed lines are read as an engineer reads them, and what readers take differently is refused where it stands."""

from __future__ import annotations

import pytest

import navsym as nav
from navsym.language.expression import read_tree
from tests.language.latex.readings import READ, REFUSED, SPELLINGS, SYMBOLS


def read(text):
    return nav.read(text, symbols=SYMBOLS, latex=SPELLINGS)


@pytest.mark.parametrize("latex", READ)
def test_a_line_is_read_as_expected(latex):
    (formula,) = read(f"{latex} = {latex}").formulas
    assert formula.why is None, formula.why
    assert (formula.left, formula.relation, formula.right) == (READ[latex], "=", READ[latex])


@pytest.mark.parametrize("latex", REFUSED)
def test_a_doubtful_line_is_refused_with_its_place_and_reason(latex):
    column, word = REFUSED[latex]
    formulas = read(f"{latex} = a").formulas
    assert [formula.status for formula in formulas] == ["REFUSED"], formulas[0]
    (formula,) = formulas
    assert formula.left is formula.right is formula.relation is None
    assert formula.trouble == (1, column), formula.why
    assert word in formula.why and formula.why.count("expected ") == 1 and "; got " in formula.why


def test_the_tables_are_long_enough():
    assert len(READ) >= 150 and len(REFUSED) >= 60


NOT_YET = ("@", "[", ".T", "dot(", "cross", "norm", "conj", "qmul", "dot_", "diff", "integral", "sum(", "product(",
           "det", "trace", "floor", "limit(", "where(",
           "min(", "max(", "sign(", "eye", "zeros", "inv", "skew", "expm")  # fmt: skip


def test_readings_of_scalars_are_written_in_the_language_of_files():
    texts = [text for text in READ.values() if not any(mark in text for mark in NOT_YET)]
    assert len(texts) > 90
    for text in texts:
        read_tree(text, set(SYMBOLS))
