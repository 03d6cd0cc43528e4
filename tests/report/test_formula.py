"""Formulas are set in type as they stand; what is not a formula is left alone."""

from __future__ import annotations

import operator
from xml.dom import minidom

import pytest
from hypothesis import given
from hypothesis import strategies as st

from navsym.report.formula.reader import read_formula
from navsym.report.formula.sides import coordinates, latex, mathml, only_truth
from navsym.report.names import latex_escape, split_name

LATEX = [
    ("a - (b - c)", "a - \\left( b - c \\right)"),
    ("-(a + b)*c", " - \\left( a + b \\right)\\,c"),
    ("a/b", "\\frac{a}{b}"),
    ("sin(T/4)**2", "\\sin^{2}\\left( T/4 \\right)"),
    ("sin(T - tau/2)", "\\sin\\left( T - \\tau /2 \\right)"),
    ("sin(T/2*x)", "\\sin\\left( \\dfrac{T}{2}\\,x \\right)"),
    ("exp(-t/(2*a))", "e^{ - \\frac{t}{2\\,a}}"),
    ("(a/(b + c))/d", "\\frac{\\dfrac{a}{b + c}}{d}"),
    ("(T/2)**2/b", "\\frac{\\left( \\dfrac{T}{2} \\right)^{2}}{b}"),
    ("[[1/2, a/(2*b)], [0, 1]]", "\\begin{bmatrix} 1/2 & \\dfrac{a}{2\\,b} \\\\[1ex] 0 & 1 \\end{bmatrix}"),
    ("2**(-n)", "2^{ - n}"),
    ("(-2)**2", "\\left(  - 2 \\right)^{2}"),
    ("sqrt(x + 1)", "\\sqrt{x + 1}"),
    ("theta2_11", "\\theta _{2,11}"),
    ("20 +- 1/2", "20 \\pm \\frac{1}{2}"),
    ("det != 0", "\\mathrm{det} \\ne 0"),
    ("6.37e+07", "6.37 \\cdot 10^{7}"),
    ("2*3", "2 \\cdot 3"),
    ("pi*pi_", "\\pi  \\cdot \\pi \\_"),
    ("dphi_1 - deta", "\\mathrm{d}\\varphi_{1} - \\mathrm{deta}"),
    ("DeltaV*t_G", "\\Delta V \\cdot t_{G}"),
]


@pytest.mark.parametrize(("text", "expected"), LATEX)
def test_brackets_stand_where_they_are_needed(text, expected):
    assert latex(text) == expected


@pytest.mark.parametrize("text", ["gain not printed", "", "a b", "(", "a +", "f(", "<b>", "x;", "((" * 60, "α", "a..b"])
def test_words_are_no_formula(text):
    assert mathml(text) is None and latex(text) is None


@given(st.text(alphabet="ab1+-*/(),.[]=<>; '", max_size=30))
def test_whatever_is_read_is_wellformed(text):
    found = mathml(text)
    assert (found is None) == (latex(text) is None)
    if found is not None:
        minidom.parseString(f"<p>{found}</p>")


@given(st.integers(-9, 9), st.integers(1, 9), st.integers(-3, 3))
def test_the_tree_means_what_the_text_means(a, b, c):
    point = {"a": float(a), "b": float(b), "c": float(c)}
    for text, expected in [
        ("a - b - c", a - b - c),
        ("a/b*c", a / b * c),
        ("-a**2 + b", -(a**2) + b),
        ("2**c", 2.0**c),
        ("-a*b - -c", -a * b + c),
        ("a - (b - c)*2", a - (b - c) * 2),
        ("a/b/2", a / b / 2),
    ]:
        node = read_formula(text)
        assert node is not None and value(node, point) == pytest.approx(expected)


def value(node, point):
    """What a tree means, in doubles."""
    parts = [value(part, point) for part in node.parts]
    leaves = {"number": lambda: float(node.text), "name": lambda: point[node.text], "minus": lambda: -parts[0]}
    pairs = {"sum": operator.add, "difference": operator.sub, "product": operator.mul, "quotient": operator.truediv}
    return leaves[node.kind]() if node.kind in leaves else (pairs | {"power": operator.pow})[node.kind](*parts)


def test_names_are_split_into_stem_and_indices():
    assert [split_name(n) for n in ("y1", "theta2_11", "zT", "sigma", "u", "omega_0")] == [
        ("y", "1"),
        ("theta", "2,11"),
        ("z", "T"),
        ("sigma", ""),
        ("u", ""),
        ("omega", "0"),
    ]


def test_words_cannot_command_latex():
    assert latex_escape(r"\input{x} $y$ 50%") == r"\textbackslash{}input\{x\} \$y\$ 50\%"


def test_brackets_grow_around_fractions_only_and_functions_keep_their_distance():
    assert mathml("cos(T)").count('stretchy="false"') == 2
    assert mathml("cos(T/2)").count('stretchy="false"') == 2
    assert "stretchy" not in mathml("cos(T/(2*a))")
    assert '<mo lspace="0.17em">' in mathml("2*cos(T)") and "lspace" not in mathml("2*T")


def test_a_quotient_inside_something_keeps_its_size_or_goes_in_one_line():
    assert mathml("a/b").count("<mfrac") == 1 and "scriptlevel" not in mathml("a/b")
    assert mathml("(a/(b + 1))/c").count('scriptlevel="0"') == 1  # the inner one
    assert "<mfrac" not in mathml("sin(T/4)") and "scriptlevel" not in mathml("x**(a/(b + 1))")


def test_a_point_is_one_equation_for_each_coordinate():
    point = coordinates({"Deltat": "1", "V": "sqrt(2)", "T": "pi/4"})
    assert [part.latex for part in point] == [r"\Delta t = 1", r"V = \sqrt{2}", r"T = \pi /4"]
    assert coordinates(None) == ()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("True", True),
        ("(False, True, True)", True),
        ("[True, False]", True),
        ("Truth", False),
        ("T", False),
        ("", False),
    ],
)
def test_what_only_says_yes_or_no_is_told_from_a_formula(text, expected):
    assert only_truth(text) is expected
