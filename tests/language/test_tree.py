"""Trees: writing and reading are inverse, nothing evaluates, and what goes to the algebra means the same."""

from __future__ import annotations

import copy
import gc
import pickle
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction

import pytest
import sympy as sp
from flint import arb
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from navsym.core.balls import enclose, precision
from navsym.core.errors import (
    DomainError,
    DuplicateError,
    EmptyError,
    ExpressionSyntaxError,
    NavsymError,
    ShapeError,
    TooLargeError,
    UnknownSymbolError,
)
from navsym.language import tree as table
from navsym.language.algebra import from_sympy, to_sympy
from navsym.language.domains import enclose_tree, list_conditions, rational_value
from navsym.language.expression import parse, read_tree, symbol, to_text
from navsym.language.names import INVERSES
from navsym.language.polynomials import to_polynomial
from navsym.language.printer import LatexWriter, print_tree
from navsym.language.tree import (
    ARITY,
    MINUS_ONE,
    PI,
    Tree,
    build_call,
    build_inverse,
    build_number,
    build_power,
    build_product,
    build_sum,
    build_symbol,
    list_names,
    list_parts,
    replace,
)

x, y = build_symbol("x"), build_symbol("y")
SYMBOLS = {name: symbol(name) for name in ("x", "y")}

numbers = st.fractions(-9, 9, max_denominator=7).map(build_number)
leaves = st.one_of(st.sampled_from([x, y, PI, MINUS_ONE]), numbers, st.integers(-3, 12).map(build_number))


def grow(smaller):
    call = st.sampled_from([name for name in ARITY if name not in ("pi", "atan2", *INVERSES)])
    return st.one_of(
        st.lists(smaller, min_size=2, max_size=4).map(lambda parts: build_sum(*parts)),
        st.lists(smaller, min_size=2, max_size=4).map(lambda parts: build_product(*parts)),
        st.tuples(smaller, smaller).map(lambda pair: build_power(*pair)),
        smaller.map(build_inverse),
        st.tuples(call, smaller).map(lambda pair: build_call(*pair)),
        st.tuples(smaller, smaller).map(lambda pair: build_call("atan2", *pair)),
    )


trees = st.recursive(leaves, grow, max_leaves=14)


@settings(max_examples=600)
@given(trees)
def test_reading_undoes_printing(tree):
    assert read_tree(print_tree(tree)) is tree


@settings(max_examples=300)
@given(st.text(alphabet="xy019.+-*/() ,expsincoqrtalg", max_size=40))
def test_what_is_read_is_printed_and_read_the_same(text):
    try:
        tree = read_tree(text)
    except NavsymError:
        return
    assert read_tree(print_tree(tree)) is tree
    latex = LatexWriter().whole(tree)
    assert latex.count("{") == latex.count("}")


@settings(max_examples=300, deadline=None)
@given(trees, st.fractions(-3, 3, max_denominator=50), st.fractions(-3, 3, max_denominator=50))
def test_the_algebra_gets_what_the_tree_means(tree, at_x, at_y):
    """Wherever the tree has a value in balls, sympy has the same one."""
    try:
        expression = to_sympy(tree, SYMBOLS)
    except NavsymError:
        return
    point = {"x": at_x, "y": at_y}
    values = {name: arb(value.numerator) / value.denominator for name, value in point.items()}
    ball = enclose_tree(tree, values, 200)
    assume(ball.is_finite() and ball.rad() < 1e-30 and abs(ball) < 1e30)
    rationals = {SYMBOLS[name]: sp.Rational(value.numerator, value.denominator) for name, value in point.items()}
    value = expression.evalf(40, subs=rationals)
    assume(value.is_Float or value.is_Rational)
    with precision(200):
        assert abs(arb(str(value)) - ball) <= abs(ball) * 1e-25 + 1e-25


@settings(max_examples=300)
@given(trees, trees)
def test_a_part_is_replaced_everywhere_and_nothing_else_changes(tree, other):
    there = replace(tree, {x: other})
    assert (x in list_parts(tree)) <= (other in list_parts(there))
    assert (there is tree) == (other is x or x not in list_parts(tree))
    assert replace(replace(tree, {x: build_symbol("q")}), {build_symbol("q"): x}) is tree


def test_nothing_is_evaluated():
    for text in (
        "1/(0*x)",
        "0**0",
        "log(0)",
        "sqrt(-1)",
        "acos(2)",
        "9**(9**9)",
        "x - x",
        "2 + 2",
        "1/0",
        "atan2(0, 0)",
    ):
        assert print_tree(read_tree(text)) == text
    assert replace(read_tree("1/x + log(x)"), {x: build_number(0)}) is read_tree("1/0 + log(0)")
    program = "import sys; from navsym.language.tree import *; build_sum(ONE, ONE); assert 'sympy' not in sys.modules"
    assert subprocess.run([sys.executable, "-c", program], check=False, timeout=60).returncode == 0


def test_conventions_of_reading():
    two_thirds = build_number(Fraction(2, 3))
    assert read_tree("2/3*x") is build_product(two_thirds, x)
    assert read_tree("x*2/3") is build_product(x, build_number(2), build_inverse(build_number(3)))
    assert read_tree("x - 2/3") is build_sum(x, build_number(Fraction(-2, 3)))
    assert read_tree("x - y*2") is build_sum(x, build_product(MINUS_ONE, y, build_number(2)))
    assert read_tree("1/x") is build_inverse(x) is read_tree("x**-1")
    assert read_tree("--x") is x and read_tree("x - -y") is read_tree("x + y")
    assert read_tree("(x + y) + x") is not read_tree("x + y + x")


def test_a_tree_is_one_and_stays_as_it_is():
    tree = read_tree("sin(x)**2 + cos(x)**2/3")
    assert copy.copy(tree) is tree and copy.deepcopy(tree) is tree
    assert pickle.loads(pickle.dumps(tree)) is tree
    assert tree == read_tree("sin(x)**2+cos(x)**2/3") and len({tree, read_tree(print_tree(tree))}) == 1
    for change in (lambda: setattr(tree, "head", "*"), lambda: setattr(tree, "other", 1)):
        with pytest.raises(AttributeError, match="build another one"):
            change()
    with pytest.raises(TypeError, match="build_sum"):
        Tree("+", (x, y))


def test_threads_build_the_same_parts():
    with ThreadPoolExecutor(4) as pool:
        built = list(pool.map(lambda k: build_sum(x, build_number(k % 50), build_symbol(f"t{k % 7}")), range(5000)))
    assert len({id(tree) for tree in built}) == len(set(built)) == 350


def test_depth_and_width_have_no_end_and_no_trace_is_left():
    gc.collect()
    before = len(table.TABLE)
    tree = build_symbol("deep")
    for k in range(30_000):
        tree = build_power(tree, x) if k % 2 else build_sum(tree, y)
    assert len(list_parts(tree)) == 30_003 and list_names(tree) == ["deep", "y", "x"]
    assert pickle.loads(pickle.dumps(tree)) is tree
    wide = build_sum(*(build_product(x, build_number(k)) for k in range(10_000)))
    assert len(wide.args) == 10_000 and replace(wide, {x: y}).args[7] is build_product(y, build_number(7))
    del tree, wide
    gc.collect()
    assert len(table.TABLE) <= before + 5


def test_parts_are_checked():
    with pytest.raises(ShapeError, match="expected 2 arguments of atan2; got 1"):
        build_call("atan2", x)
    for name in ("+", "number", "f(x)", ""):
        with pytest.raises(ExpressionSyntaxError, match="name of a function"):
            build_call(name, x)
    with pytest.raises(ExpressionSyntaxError, match=r"float 0\.1"):
        build_number(0.1)
    with pytest.raises(ExpressionSyntaxError, match="rename"):
        build_symbol("x;y")
    assert print_tree(build_call("determinant", x)) == "determinant(x)"
    with pytest.raises(ExpressionSyntaxError, match=r"got 'determinant'; rewrite"):
        to_sympy(build_call("determinant", x), SYMBOLS)
    with pytest.raises(UnknownSymbolError, match="'q'"):
        to_sympy(build_symbol("q"), SYMBOLS)


# Domains


@pytest.mark.parametrize(
    ("text", "conditions"),
    [
        ("x/y + 1/(x - y)", ["y != 0", "x - y != 0"]),
        ("x/2 + 3/(4)*y", []),
        ("1/0 + x/(1 - 1)", ["0 != 0", "1 - 1 != 0"]),
        ("sqrt(x) + x**(1/3) + x**1.5", ["x >= 0"]),
        ("1/sqrt(x) + y**(-1/2)", ["x >= 0", "sqrt(x) != 0", "y != 0", "y >= 0"]),
        ("log(x) + y**x + y**pi + x**(1 - pi)", ["x > 0", "y > 0", "y >= 0", "x != 0", "x >= 0"]),
        ("x**2**3 + y**((1 + 1)/2) + x**(2 - 4)", ["x != 0"]),
        ("x**0 + 0**(2 - 2)", ["x != 0", "0 != 0"]),
        ("asin(x) + acos(2*y)", ["1 - x**2 >= 0", "1 - (2*y)**2 >= 0"]),
        ("tan(x) + sec(x) + cot(y) + csc(2*y)", ["cos(x) != 0", "sin(y) != 0", "sin(2*y) != 0"]),
        ("atan2(y, 1/x)", ["x != 0", "y**2 + (1/x)**2 != 0"]),
        ("exp(log(sqrt(x)))", ["x >= 0", "sqrt(x) > 0"]),
        ("2**x + sqrt(2) + log(3) + log(0) + (-8)**(1/3)", ["0 > 0", "-8 >= 0"]),
    ],
)
def test_conditions_stand_in_the_order_of_writing_each_once(text, conditions):
    assert [f"{print_tree(part)} {relation}" for part, relation in list_conditions(read_tree(text))] == conditions


LARGE = ("exp", "sinh", "cosh", "tanh", "**")  # what may leave every range of exponents


@settings(max_examples=400)
@given(trees, st.fractions(-2, 2, max_denominator=9), st.fractions(-2, 2, max_denominator=9))
def test_a_tree_has_a_value_where_its_conditions_hold(tree, at_x, at_y):
    values = {"x": arb(at_x.numerator) / at_x.denominator, "y": arb(at_y.numerator) / at_y.denominator}
    tests = {"!= 0": lambda ball: ball != 0, ">= 0": lambda ball: ball >= 0, "> 0": lambda ball: ball > 0}
    held = [tests[relation](enclose_tree(part, values, 300)) for part, relation in list_conditions(tree)]
    ball = enclose_tree(tree, values, 300)
    assume(
        all(held) and "exp" not in print_tree(tree) and "h(" not in print_tree(tree) and "**" not in print_tree(tree)
    )
    assert ball.is_finite()


def test_exact_values_are_bounded():
    assert rational_value(read_tree("2**10/3 - 1/(6)")) == Fraction(2047, 6)
    for text in ("x", "sqrt(4)", "0**0", "1/0", "9**9**9", "2**(1/2)", "pi"):
        assert rational_value(read_tree(text)) is None


# To and from the algebra


def test_two_symbols_of_one_name_are_refused_by_both_names():
    mixed = sp.Symbol("x", real=True) ** 2 - sp.Symbol("x") ** 2
    with pytest.raises(DuplicateError, match=r"Symbol\('x'\) and Symbol\('x', real=True\)"):
        from_sympy(mixed)


@pytest.mark.parametrize(
    ("outside", "error", "words"),
    [
        (sp.Float("0.1"), DomainError, 'the float 0.1; write "1/10" or "0.1"'),
        (sp.Symbol("x") * sp.Float(2) + 1, DomainError, "the float 2.0"),
        (sp.sin(sp.Float(0.5, 3), evaluate=False), DomainError, '"1/2"'),
        (sp.gamma(sp.Symbol("x")), ExpressionSyntaxError, "gamma"),
        (sp.zeta(3), ExpressionSyntaxError, "zeta"),
        (sp.I + 1, ExpressionSyntaxError, "ImaginaryUnit"),
        (sp.Symbol("x") < 1, ExpressionSyntaxError, "StrictLessThan"),
        (sp.Matrix([1]), ExpressionSyntaxError, "Matrix"),
        ("x", ExpressionSyntaxError, "str"),
        (sp.Integer(7) ** 10**4, TooLargeError, "bits"),
    ],
)
def test_what_the_language_does_not_have_is_refused_by_its_name(outside, error, words):
    with pytest.raises(error, match=words):
        from_sympy(outside)


def test_an_expression_of_the_algebra_nested_deeply_comes_in():
    expression = sp.Symbol("x", real=True)
    for _ in range(200):
        expression = sp.sin(expression, evaluate=False)
    assert to_text(expression).count("sin(") == 200


def test_the_algebra_says_what_it_refuses_without_a_text():
    for text, words in (("1/(x - x)", "nonzero divisor"), ("9**9**9", "exponent"), ("log(-2)", "finite real value")):
        with pytest.raises(NavsymError, match=words):
            to_sympy(read_tree(text), SYMBOLS)
    with pytest.raises(DomainError, match="zero to the power zero"):
        parse("0**0 + x", SYMBOLS)


# Polynomials

a_sum = st.lists(st.tuples(st.integers(-9, 9), st.integers(0, 4), st.integers(0, 3)), min_size=1, max_size=6)


@settings(max_examples=150, deadline=None)
@given(a_sum, a_sum, st.integers(0, 3))
def test_polynomials_are_those_of_the_algebra(first, second, power):
    def text(terms):
        return " + ".join(f"({c}/3)*x**{i}*y**{j}" for c, i, j in terms)

    whole = f"({text(first)})**{power + 1} - 2*({text(second)})*x*(y - 1/2) + {text(first)}"
    found = to_polynomial(read_tree(whole), ["x", "y"])
    wanted = sp.Poly(to_sympy(read_tree(whole), SYMBOLS), *SYMBOLS.values())
    there = {tuple(int(e) for e in key): Fraction(int(c.p), int(c.q)) for key, c in found.to_dict().items()}
    assert there == {key: Fraction(int(c.p), int(c.q)) for key, c in wanted.as_dict().items() if c}


@pytest.mark.parametrize(
    "text", ["1/x", "sqrt(x)", "x**(1/2)", "x**y", "pi*x", "x**(0*1)", "0**0", "(x - x)**0", "x + 1/0"]
)
def test_what_is_no_polynomial_is_refused(text):
    with pytest.raises(DomainError, match="expected a polynomial"):
        to_polynomial(read_tree(text))


def test_powers_of_polynomials_are_bounded():
    for text in ("(x + y + 1)**9999", "(x**99999)**99999", "(3*x)**99999999999"):
        with pytest.raises(TooLargeError):
            to_polynomial(read_tree(text))
    assert str(to_polynomial(read_tree("(2*x)**3/(4) + 2**(-1)"))) == "2*x^3 + 1/2"


# Speed and hostile texts


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("1" * 1_500_000, TooLargeError),
        ("x" * 1_500_000, UnknownSymbolError),
        ("x+" * 1_200_000, TooLargeError),
        ("(" * 500_000, TooLargeError),
        ("-" * 500_000, ExpressionSyntaxError),
        ("x**" * 300_000 + "x", TooLargeError),
        ("1e" * 300_000, ExpressionSyntaxError),
        ("sin(" * 200_000, TooLargeError),
        ("x*" * 300_000 + "x", TooLargeError),
        ("x " * 300_000, ExpressionSyntaxError),
        (" " * 1_000_000, EmptyError),
        ("\x00" * 300_000, ExpressionSyntaxError),
        ("1.5.2" + "1" * 300_000, ExpressionSyntaxError),
    ],
)
def test_hostile_texts_end_soon_with_an_error(text, error):
    started = time.process_time()
    with pytest.raises(error) as caught:
        read_tree(text, {"x"})
    assert len(caught.value.message) < 400
    assert time.process_time() - started < 10


@pytest.mark.parametrize(
    "text",
    [
        "101325*(1 - x/44330.77)**5.25588",
        "44330.77*(1 - ((x + 9)/101325)**0.190263)",
        "((x + 9)/101325)**(1/5.25588)",
        "1.0829**5.25588 + 75**(1/131397) + (8/27)**0.123457",
        "(24*(9 + x))**0.123457/(x + 9)**-1.5",
    ],
)
def test_decimal_exponents_are_read_exactly_and_soon(text):
    started = time.process_time()
    expression = parse(text, SYMBOLS)
    assert time.process_time() - started < 2
    assert len(to_text(expression)) < 400
    ball = enclose_tree(read_tree(text), {"x": arb(2)}, 120)
    assert ball.overlaps(enclose(expression, {SYMBOLS["x"]: arb(2)}, 120)) and ball.rad() < 1e-20


def test_exponents_with_too_many_digits_are_refused():
    with pytest.raises(TooLargeError, match="denominator of at most 1000000"):
        parse("x**0.1234567", SYMBOLS)
