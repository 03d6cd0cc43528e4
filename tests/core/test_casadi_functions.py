"""casadi functions agree with balls, and keep their digits where a difference would lose them."""

import flint
import numpy as np
import pytest
import sympy as sp
from numpy.testing import assert_allclose

from navsym.core.casadi_functions import casadi_function
from navsym.core.errors import DomainError, NotFiniteError, ShapeError, UnknownSymbolError
from navsym.models.linear import LinearModel
from navsym.models.transition.exponential import regressors

x, y, T, tau, w = sp.symbols("x y T tau w", positive=True)

EXPRESSIONS = [
    sp.Rational(1, 3) * x**2 - y / 7 + sp.pi,
    sp.sin(x) * sp.cos(y) + sp.tan(x * y) - sp.cot(x) + sp.sec(y) - sp.csc(x),
    sp.exp(-x * y) * sp.cosh(x) - sp.sinh(y) / sp.tanh(x + y),
    sp.sqrt(x**2 + y**2) / x ** sp.Rational(3, 2) - x**-3 + y ** sp.Rational(-1, 2),
    sp.log(x + y) + sp.atan(x / y) + sp.atan2(x, -y) + sp.asin(x / 4) - sp.acos(y / 4),
    sp.Abs(x - y) ** sp.Rational(1, 3) + x**y + sp.E**2,
    (1 - sp.cos(x)) / x**2 + y * sp.exp(x) - y + 3 * sp.cosh(x) - 3,
]


@pytest.mark.parametrize("expression", EXPRESSIONS, ids=str)
def test_values_agree_with_forty_digits_to_the_last_places(expression):
    function = casadi_function("f", [x, y], expression)
    for a, b in ((sp.Rational(3, 8), sp.Rational(5, 4)), (sp.Rational(7, 4), sp.Rational(1, 2))):
        exact = float(expression.subs({x: a, y: b}).evalf(40))
        assert_allclose(float(function(float(a), float(b))), exact, rtol=4e-15)


def test_one_minus_cosine_keeps_its_digits():
    function = casadi_function("f", [w], (1 - sp.cos(w)) / w**2)
    for small in (1e-3, 1e-9, 1e-100):
        ball = 2 * (flint.arb(small) / 2).sin() ** 2 / flint.arb(small) ** 2
        assert_allclose(float(function(small)), float(ball), rtol=4e-16)
    naive = sp.lambdify(w, (1 - sp.cos(w)) / w**2, "numpy")
    assert naive(1e-9) == 0.0  # the trap that this walk avoids


@pytest.mark.parametrize(("f", "half"), [(sp.exp, 1.0), (sp.cosh, 5e-11)])
def test_other_functions_with_value_one_at_zero_keep_theirs(f, half):
    function = casadi_function("f", [x, y], y * f(x) - y)
    assert_allclose(float(function(1e-10, 2.0)) / 2e-10, half, rtol=1e-9)


def test_the_derived_regressors_on_a_grid_have_one_column_per_instant():
    model = LinearModel([[0, -1, 0], [0, 0, 1], [0, -1, 0]], H=[[1, 0, 0]])
    H = casadi_function("H", [tau, T], regressors(model, T, tau).matrix.T)
    grid = np.linspace(0.0, 1.5, 7)
    values = np.array(H(grid[None], np.full((1, 7), 1.5))).reshape(-1, 7)
    assert values.shape == (3, 7)
    assert_allclose(values, [np.ones(7), np.sin(1.5 - grid), np.cos(1.5 - grid) - 1], atol=2e-16)
    assert_allclose(values[2], -2 * np.sin((1.5 - grid) / 2) ** 2, rtol=1e-15)


def test_a_matrix_keeps_its_shape_and_its_zeros():
    matrix = sp.Matrix([[0, x, 1], [y, 0, 0]])
    assert_allclose(np.array(casadi_function("M", [x, y], matrix)(2.0, 3.0)), [[0, 2, 1], [3, 0, 0]])


def test_names_of_the_user_never_reach_the_engine():
    hostile = sp.Symbol("__import__('os').system('true')")
    assert float(casadi_function("f", [hostile], hostile**2)(3.0)) == 9.0
    for name in ("f; system(1)", "", "1f", "f__g", "f-1"):
        with pytest.raises(DomainError, match="expected letters"):
            casadi_function(name, [x], x)


@pytest.mark.parametrize(
    ("expression", "error", "message"),
    [
        (x + y, UnknownSymbolError, "got y"),
        (sp.gamma(x), DomainError, "gamma"),
        (sp.Float("0.1") * x, DomainError, "Float"),
        (x + 10**400, NotFiniteError, "rescale"),
        (sp.oo * x, DomainError, "Infinity"),
        (sp.I * x, DomainError, "ImaginaryUnit"),
    ],
)
def test_what_has_no_double_value_is_refused(expression, error, message):
    with pytest.raises(error, match=message):
        casadi_function("f", [x], expression)


def test_arguments_are_different_and_present():
    with pytest.raises(DomainError, match="twice"):
        casadi_function("f", [x, x], x)
    with pytest.raises(ShapeError, match="at least one"):
        casadi_function("f", [[]], sp.Integer(1))
