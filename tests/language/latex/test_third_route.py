"""Readings have the value that a third reader gives their LaTeX; changed readings have another one."""

from __future__ import annotations

import random

import numpy as np
import pytest

import navsym as nav
from tests.language.latex.printed_trees import SYMBOLS as RANDOM_SYMBOLS
from tests.language.latex.printed_trees import Printer
from tests.language.latex.readings import READ, SPELLINGS, SYMBOLS
from tests.language.latex.third_reader import Third
from tests.language.latex.third_values import draw_values, evaluate


def agree(latex, text, symbols, spellings):
    """True when the LaTeX and its reading have one value."""
    values = draw_values(symbols)
    one, other = Third(symbols, spellings, values).whole(latex), evaluate(text, values)
    return np.shape(one) == np.shape(other) and np.allclose(one, other)


def test_every_line_of_the_table_has_the_value_of_its_reading():
    assert [latex for latex, text in READ.items() if not agree(latex, text, SYMBOLS, SPELLINGS)] == []


SPOILED = [
    (r"a + b c", "(a + b)*c"), (r"\frac{a}{b} c", "a/(b*c)"), ("-a^2", "(-a)**2"), ("P H^T", "P @ H"),
    ("u^T v", "dot(u, w)"),
    (r"u \times v", "cross(v, u)"), (r"q \otimes p", "qmul(p, q)"), (r"\sin 2a", "sin(2)*a"), (r"\dot{x}", "x"),
    (r"\sum_{k=1}^n a k + b", "sum(a*k + b, k, 1, n)"), (r"\int_0^t a\, d\tau", "integral(a, tau, t, 0)"),
    (r"\begin{bmatrix} a & b \\ c & 1 \end{bmatrix}", "[[a, c], [b, 1]]"), ("v_2", "v[3]"), ("q^{-1}", "q"),
    (r"\begin{cases} a & x > 0 \\ b & \text{otherwise} \end{cases}", "where(x >= 0, a, b)"),
    (r"\lim_{a \to 0} b", "limit(b, a, 1)"), (r"\Delta t a", "Delta*t*a"), ("e'^2", "ep"), ("C_b^n v", "C @ v"),
]  # fmt: skip


@pytest.mark.parametrize(("latex", "text"), SPOILED)
def test_a_wrong_reading_has_another_value(latex, text):
    (formula,) = nav.read(f"{latex} = {latex}", symbols=SYMBOLS, latex=SPELLINGS).formulas
    assert agree(latex, formula.left, SYMBOLS, SPELLINGS)
    assert not agree(latex, text, SYMBOLS, SPELLINGS)


def test_random_formulas_have_the_value_of_the_third_reader():
    for seed in range(10_000, 10_200):
        source = random.Random(seed)
        latex = Printer(source).draw(source.choice(["scalar", "vector", "matrix"]), source.choice([1, 2, 3])).latex
        (formula,) = nav.read(f"{latex} = {latex}", symbols=RANDOM_SYMBOLS).formulas
        assert agree(latex, formula.left, RANDOM_SYMBOLS, {"t_1": "t_1"}), (latex, formula.left)
