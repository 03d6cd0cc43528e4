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


def test_a_declared_d_is_no_sign_of_a_derivative():
    known = dict.fromkeys("dxty", "real")
    for latex in (r"\frac{d}{dt}(x y) = 0", r"\frac{d^2 x}{dt^2} = y", r"\frac{dx}{dt} = y"):
        (formula,) = nav.read(latex, symbols=known).formulas
        assert formula.status == "REFUSED" and "is d a name or a derivative?" in formula.why
    assert nav.read(r"\frac{\mathrm{d}x}{\mathrm{d}t} = d", symbols=known).formulas[0].left == "diff(x, t)"
    assert nav.read(r"\frac{d}{x} = y", symbols=known).formulas[0].left == "d/x"


def test_the_unit_matrix_has_the_size_that_its_neighbours_give_it():
    known = {"C": {"rotation": "b to n"}, "w": {"vector": 3}, "a": "real", "K": {"matrix": ["n", "m"]}}
    known |= {"H": {"matrix": ["m", "n"]}, "P": {"matrix": ["n", "n"]}}
    lines = {
        r"(\mathbf{I} - {\bf KH}) P": "(eye(n) - K @ H) @ P", r"C C^T - \mathbf I": "C @ C.T - eye(3)",
        r"\mathbf{I} w": "eye(3) @ w", r"w^T \mathbf{I}": "w.T @ eye(3)", r"a \mathbf{I} + C": "a*eye(3) + C",
    }  # fmt: skip
    for latex, text in lines.items():
        (formula,) = nav.read(f"{latex} = {latex}", symbols=known, latex={"eye": r"\mathbf{I}"}).formulas
        assert (formula.left, formula.right) == (text, text), formula.why
    for latex in (
        r"\operatorname{tr} \mathbf{I} = a",
        r"\mathbf{I}^{-1} = \mathbf{I}",
        r"\mathbf{I} + \mathbf{I} = \mathbf{I}",
    ):
        (formula,) = nav.read(latex, symbols=known, latex={"eye": r"\mathbf{I}"}).formulas
        assert formula.status == "REFUSED" and "write its size below it" in formula.why
    (formula,) = nav.read(r"C C^T = \mathbf{I}", symbols=known).formulas
    assert "eye = '\\mathbf{I}' in [latex]" in formula.why


MOVING = {"f": {"function": "t"}, "A": {"matrix": [2, 2], "function": "t"}, "u": {"vector": 3, "function": "t"}}
MOVING |= dict.fromkeys("abmtxy", "real") | {"i": {"integer": ["1", "oo"]}}


@pytest.mark.parametrize(
    ("latex", "text"),
    [
        ("f(t)^2", "f**2"),
        ("a f(t)^2 x", "a*f**2*x"),
        (r"\dot{f}(t)^2", "dot_(f)**2"),
        (r"A(t)^{-1}", "inv(A)"),
        ("u(t)^T u(t)", "dot(u, u)"),
        ("f(a + b)", "f*(a + b)"),
        ("f(t)(a + b)", "f*(a + b)"),
    ],
)
def test_a_power_behind_the_value_of_a_function_is_the_power_of_the_value(latex, text):
    (formula,) = nav.read(f"{latex} = {latex}", symbols=MOVING).formulas
    assert (formula.left, formula.right) == (text, text), formula.why


@pytest.mark.parametrize("latex", ["a(x)^2", "f(t + a)", "f(2t)", r"f(t - \frac{a}{b})"])
def test_a_power_behind_what_may_be_a_value_is_asked_about(latex):
    (formula,) = nav.read(f"y = {latex}", symbols=MOVING).formulas
    assert formula.status == "REFUSED" and "a product or a function?" in formula.why


@pytest.mark.parametrize(
    ("latex", "question"),
    [
        (r"9.81\,\text{m}", "is m a name or a unit?"),
        (r"2\mathrm{m} x", "is m a name or a unit?"),
        (r"e^{\mathrm{i} x}", "is i a name or the imaginary unit?"),
        ("3{,}14 x", "a decimal comma, or thousands?"),
    ],
)
def test_units_and_commas_of_numbers_are_asked_about(latex, question):
    (formula,) = nav.read(f"y = {latex}", symbols=MOVING).formulas
    assert formula.status == "REFUSED" and question in formula.why


def test_an_upright_name_of_the_table_may_stand_behind_a_number():
    (formula,) = nav.read(r"y = 3\,\mathrm{m}", symbols=MOVING, latex={"m": r"\mathrm{m}"}).formulas
    assert formula.text == "y = 3*m"


def test_a_display_without_its_equation_is_read():
    for name in ("aligned", "gathered", "split", "align"):
        formulas = nav.read(rf"\begin{{{name}}} a &= b \\ c &= a \end{{{name}}}", symbols=dict.fromkeys("abc", "real"))
        assert [f.text for f in formulas.formulas] == ["a = b", "c = a"]


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
