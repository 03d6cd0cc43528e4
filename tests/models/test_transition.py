"""A transition matrix is the one solution of X' = A X with X(0) = I: checked exactly, and in balls."""

import itertools

import flint
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from navsym.claims import PROVED, Equation
from navsym.core.errors import DomainError, NotFiniteError, ShapeError, TooLargeError
from navsym.models.linear import LinearModel
from navsym.models.transition.exponential import regressors, transition_matrix
from navsym.prove.ladder import decide

t, T, tau = sp.symbols("t T tau", positive=True)
w, v, g, R, earth = sp.symbols("w v g R Omega", positive=True)
a, b, c = sp.symbols("a b c", real=True)

SCHULER = [[0, 1, 0, 0], [0, 0, -g, 0], [0, 1 / R, 0, 1], [0, 0, 0, 0]]
FOUCAULT = [[0, 1, 0, 0], [-(w**2), 0, 0, 2 * earth], [0, 0, 0, 1], [0, -2 * earth, -(w**2), 0]]
COUPLED_INS = [  # velocities and tilts of two level channels, turned by the Earth
    [0, 2 * earth, 0, -g],
    [-2 * earth, 0, g, 0],
    [0, -1 / R, 0, earth],
    [1 / R, 0, -earth, 0],
]
LATITUDE = sp.Symbol("phi", real=True)
TURNING = [
    [0, earth * sp.sin(LATITUDE), -earth * sp.cos(LATITUDE)],
    [-earth * sp.sin(LATITUDE), 0, 0],
    [earth * sp.cos(LATITUDE), 0, 0],
]

EXAMPLES = {
    "zero": [[0, 0], [0, 0]],
    "number": [[a]],
    "nilpotent": [[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [0, 0, 0, 0]],
    "oscillator": [[0, 1], [-(w**2), 0]],
    "undeclared sign": [[0, 1], [-a, -b]],
    "unstable": [[0, 1], [w**2, 0]],
    "gauss-markov": [[0, 1, 0], [0, 0, 1], [0, 0, -1 / R]],
    "repeated exponent": [[a, 1, 0], [0, a, 1], [0, 0, a]],
    "two markov": [[-a, 1], [0, -b]],
    "paper": [[0, -1, 0], [0, 0, 1], [0, -1, 0]],
    "schuler": SCHULER,
    "double oscillator": [[0, 1, 0, 0], [-(w**2), 0, 1, 0], [0, 0, 0, 1], [0, 0, -(w**2), 0]],
    "driven oscillator": [[0, 1, 0, 0], [-(w**2), 0, 1, 0], [0, 0, 0, 1], [0, 0, -(v**2), 0]],
    "triple oscillator": sp.Matrix(
        6,
        6,
        lambda i, j: {
            (0, 1): 1,
            (1, 0): -(w**2),
            (1, 2): 1,
            (2, 3): 1,
            (3, 2): -(w**2),
            (3, 4): 1,
            (4, 5): 1,
            (5, 4): -(w**2),
        }.get((i, j), 0),
    ),
    "damped twice": [[0, 1, 0, 0], [-2, -2, 1, 0], [0, 0, 0, 1], [0, 0, -2, -2]],
    "foucault": FOUCAULT,
    "coupled ins": COUPLED_INS,
    "turning": TURNING,
    "quarter turn": [[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [-1, 0, 0, 0]],
    "damped waves": [[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [-(w**4), 0, 0, 0]],
    "beam": [[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [w**4, 0, 0, 0]],
    "two unequal": [[0, 1, 0, 0], [-2, 0, 1, 0], [0, 0, 0, 1], [1, 0, -3, 0]],
    "saddle": [[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [3, 0, 1, 0]],
    "two exponents": [[0, 1, 0, 0], [2, 0, 1, 0], [0, 0, 0, 1], [1, 0, 3, 0]],
    "shifted quartic": [[1, 1, 0, 0], [-2, 1, 1, 0], [0, 0, 1, 1], [1, 0, -3, 1]],
    "surds": [[0, sp.sqrt(2)], [sp.sqrt(3), 1]],
    "roots of parameters": [[0, sp.sqrt(g / R)], [-sp.sqrt(g / R), 0]],
}


def exactly_zero(expression):
    """Zero as a rational function of its waves, exponentials and surds; no sympy decision but expand."""
    waves = expression.atoms(sp.sin, sp.cos, sp.sinh, sp.cosh, sp.exp)
    names = {wave: sp.Dummy() for wave in sorted(waves, key=sp.default_sort_key) if wave.has(t)}
    numerator, _ = sp.fraction(sp.together(sp.expand(expression.xreplace(names))))
    numerator = sp.expand(sp.expand(numerator).subs(sp.sin(LATITUDE) ** 2, 1 - sp.cos(LATITUDE) ** 2))
    return numerator == 0


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_closed_form_solves_its_differential_equation(name):
    A = sp.Matrix(EXAMPLES[name])
    X = transition_matrix(A, t).matrix
    assert all(exactly_zero(entry) for entry in X.diff(t) - A * X)
    assert all(exactly_zero(entry) for entry in X.subs(t, 0) - sp.eye(A.rows))


@pytest.mark.parametrize("name", ["schuler", "undeclared sign", "damped waves", "coupled ins"])
def test_the_ladder_proves_the_closed_form(name):
    A = sp.Matrix(EXAMPLES[name])
    X = transition_matrix(A, t).matrix
    assert decide(Equation(X.diff(t), A * X)).status is PROVED
    assert decide(Equation(X.subs(t, 0), sp.eye(A.rows))).status is PROVED


def ball_exponential(A, time, values):
    """exp(A time) in balls of 200 bits, without any of our formulas."""
    flint.ctx.prec = 200
    try:
        numbers = [
            flint.acb(flint.fmpq(int(x.p), int(x.q))) if x.is_Rational else flint.acb(str(x.evalf(50)))
            for x in (sp.sympify(entry).subs(values) * time for entry in A)
        ]
        n = A.rows
        return [[complex(x) for x in row] for row in flint.acb_mat(n, n, numbers).exp().tolist()]
    finally:
        flint.ctx.prec = 53


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_closed_form_agrees_with_the_exponential_in_balls(name):
    A = sp.Matrix(EXAMPLES[name])
    symbols = sorted(A.free_symbols, key=str)
    numbers = sp.Rational(3, 2), sp.Rational(2, 3), sp.Rational(1, 5)
    points = itertools.islice(itertools.permutations(numbers), 2)
    for point in points:
        values, time = dict(zip(symbols, point, strict=False)), sp.Rational(7, 5)
        X = transition_matrix(A, t).matrix.subs(values).subs(t, time).evalf(25)
        expected = ball_exponential(A, time, values)
        for i, j in itertools.product(range(A.rows), repeat=2):
            assert abs(complex(X[i, j]) - expected[i][j]) < 1e-13 * max(1.0, abs(expected[i][j])), (i, j)


def test_roots_without_closed_form_are_summed_and_still_solve_the_equation():
    A = sp.Matrix([[0, 1, 0], [0, 0, 1], [-1, -a, 0]])
    transition = transition_matrix(A, t)
    assert transition.factors[0][2] == "sum over roots"
    X = transition.matrix.subs(a, 2).subs(t, sp.Rational(1, 2)).doit().evalf(20)
    expected = ball_exponential(A, sp.Rational(1, 2), {a: 2})
    assert len(transition.matrix.atoms(sp.RootSum)) == 3
    assert all(abs(complex(X[i, j]) - expected[i][j]) < 1e-13 for i in range(3) for j in range(3))


@pytest.mark.long
@settings(max_examples=10, deadline=None)
@given(st.lists(st.integers(-3, 3), min_size=9, max_size=9))
def test_any_integer_matrix_has_its_exponential(entries):
    A = sp.Matrix(3, 3, entries)
    X = transition_matrix(A, t).matrix.subs(t, sp.Rational(1, 3)).doit().evalf(20)
    expected = ball_exponential(A, sp.Rational(1, 3), {})
    for i, j in itertools.product(range(3), repeat=2):
        assert abs(complex(X[i, j]) - expected[i][j]) < 1e-11 * max(1.0, abs(expected[i][j]))


def test_the_schuler_channel_is_written_as_a_textbook_writes_it():
    X = transition_matrix(SCHULER, t).matrix
    rate = sp.sqrt(g) / sp.sqrt(R)
    assert X[1, 1] == sp.cos(rate * t)
    assert X[0, 3] == -R * t + R * sp.sin(rate * t) / rate
    assert X[0, 2] == R * sp.cos(rate * t) - R


def test_the_foucault_pendulum_turns_with_the_earth():
    transition = transition_matrix(FOUCAULT, t)
    sigma = sp.sqrt(w**2 + earth**2)
    expected = sp.cos(earth * t) * sp.cos(sigma * t) + earth / sigma * sp.sin(earth * t) * sp.sin(sigma * t)
    assert exactly_zero(transition.matrix[0, 0] - expected)
    assert transition.factors[0][2] == "two frequencies"
    assert transition.assumptions == ()


def test_the_generic_formula_says_that_it_excludes_the_limit_and_substitution_reaches_it():
    q = sp.Symbol("q", real=True)
    A = [[0, 1], [-(q**2), 0]]
    assert transition_matrix(A, t).assumptions == (sp.Ne(q, 0),)
    limit = transition_matrix(A, t, where={q: 0})
    assert (limit.matrix, limit.assumptions) == (sp.ImmutableMatrix([[1, t], [0, 1]]), ())


def test_an_undeclared_sign_is_stated_as_an_assumption():
    assert transition_matrix([[0, 1], [-a, -b]], t).assumptions == (4 * a - b**2 > 0,)
    hyperbolic = transition_matrix([[0, 1], [-a, -b]], t, where={a: -(w**2)})
    assert (hyperbolic.factors[0][2], hyperbolic.assumptions) == ("hyperbolic", ())


def test_equal_rates_are_excluded_only_where_the_formula_divides_by_their_difference():
    assert sp.Ne(a - b, 0) in transition_matrix([[-a, 1], [0, -b]], t).assumptions
    assert transition_matrix([[-a, 0], [0, -b]], t).assumptions == ()


@pytest.mark.parametrize(
    ("A", "time", "error", "message"),
    [
        ([[0, 1]], t, ShapeError, "square|shape"),
        ([[0, t], [0, 0]], t, DomainError, "constant"),
        ([[0, t], [0, 0]], T - t, DomainError, "constant"),
        ([[sp.I]], t, DomainError, "real"),
        ([[sp.sqrt(-1 - w) * 0 + sp.I * w]], t, DomainError, "real"),
        (sp.eye(17), t, TooLargeError, "16 states"),
        ([[0, 1], [-1, 0]], 0.5, DomainError, "exact"),
        ([[1 / (a - a + w - w + 1) * sp.oo]], t, NotFiniteError, "finite"),
    ],
)
def test_what_has_no_closed_form_is_refused_in_words(A, time, error, message):
    with pytest.raises(error, match=message):
        transition_matrix(A, time)


def test_a_dense_matrix_of_symbols_is_refused_before_it_takes_all_memory():
    with pytest.raises(TooLargeError, match="4000 terms"):
        transition_matrix(sp.Matrix(9, 9, sp.symbols("a0:81")), t)


def test_a_repeated_factor_of_high_degree_is_refused_with_advice():
    block = sp.Matrix([[0, 1, 0], [0, 0, 1], [-1, -1, 0]])
    A = sp.zeros(6)
    A[:3, :3], A[3:, 3:], A[2, 3] = block, block, 1
    with pytest.raises(DomainError, match="split the system"):
        transition_matrix(A, t)


def test_constants_that_hide_an_identity_never_give_a_wrong_matrix():
    s, k = sp.sin(LATITUDE), sp.cos(LATITUDE)
    A = sp.Matrix([[s**2 + k**2, 1], [0, 1]])  # a double eigenvalue in disguise
    X = transition_matrix(A, t).matrix
    assert all(exactly_zero(entry) for entry in X.diff(t) - sp.Matrix([[1, 1], [0, 1]]) * X)
    disguised = sp.Matrix([[sp.sqrt(2) * (sp.sqrt(3) + 1), 1], [0, sp.sqrt(6) + sp.sqrt(2)]])
    with pytest.raises(DomainError, match="identity hidden"):
        transition_matrix(disguised, t)


def test_the_measurement_brought_to_the_end_of_the_interval():
    model = LinearModel(EXAMPLES["paper"], H=[[1, 0, 0]])
    H = regressors(model, T, tau)
    assert H.matrix == sp.ImmutableMatrix([[1, sp.sin(T - tau), sp.cos(T - tau) - 1]])
    assert H.assumptions == ()


@pytest.mark.parametrize("name", ["schuler", "undeclared sign", "gauss-markov", "foucault"])
def test_regressors_undo_the_motion(name):
    A = sp.Matrix(EXAMPLES[name])
    model = LinearModel(A, H=[[1, *[0] * (A.rows - 1)], [*[0] * (A.rows - 1), 1]])
    H = regressors(model, T, tau).matrix
    assert all(exactly_zero((entry).subs(T, t + tau)) for entry in H.diff(tau) - H * A)  # H' = H F along tau
    assert all(exactly_zero(entry) for entry in H.subs(tau, T) - model.H)


def test_a_measurement_row_may_vary_but_the_motion_may_not():
    model = LinearModel([[0, 1], [0, 0]], H=[[sp.Symbol("s"), 0]], time=sp.Symbol("s"))
    expected = sp.Matrix([[tau, tau * (tau - T)]])
    assert (regressors(model, T, tau).matrix - expected).applyfunc(sp.expand) == sp.zeros(1, 2)
    with pytest.raises(DomainError, match="in pieces"):
        regressors(LinearModel([[0, t], [0, 0]], H=[[1, 0]], time=t), T, tau)


def test_two_steps_are_one_step_of_twice_the_length():
    step = sp.Symbol("h", positive=True)
    F = sp.Matrix([[0, 1, 0], [0, 0, 1], [0, 0, 0]])
    one, two = (transition_matrix(F, k * step).matrix for k in (1, 2))
    assert (one * one - two).applyfunc(sp.expand) == sp.zeros(3)
