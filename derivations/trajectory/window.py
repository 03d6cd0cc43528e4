"""What the paper does not ask: the price of the order n when positions are noisy rather than adversarial.

A motion of degree d = n - 1 is measured during a window T in white noise of intensity q (1 m every 0.2 s: 0.2 m^2 s).
Whatever the algorithm, if it is unbiased for such motions its r-th derivative at the end of the window has at least
the variance

    q / T^(2r+1) * ((d + r + 1)! / (d - r)!)^2 / ((2r + 1) (r!)^2),

which least squares has (Gauss and Markov). It is the sum over Legendre's polynomials of their derivatives at the end.
"""

from math import factorial

import sympy as sp

from navsym.claims import CERTIFIED, Claim, Equation, claim
from navsym_papers.trajectory.scaling import N_f

T, q, D = sp.symbols("T q d", positive=True)
u = sp.Symbol("u", real=True)
LARGEST = 9
NAMES = ("position", "velocity", "acceleration", "jerk")


def least_variance(r: int, degree: int) -> sp.Expr:
    """The bound above for one degree."""
    product = sp.Rational(factorial(degree + r + 1), factorial(degree - r))
    return q * product**2 / ((2 * r + 1) * factorial(r) ** 2 * T ** (2 * r + 1))


def information(degree: int) -> sp.Matrix:
    """Information about the coefficients of age^k: integrals of age^(i + j) over the window, over q."""
    return sp.Matrix(degree + 1, degree + 1, lambda i, j: T ** (i + j + 1) / (q * (i + j + 1)))


def of_derivative(r: int, degree: int) -> sp.Expr:
    """Variance of the r-th derivative at age 0: cofactor over determinant, times (r!)^2.

    Taken at T = q = 1, where the matrix is a number; T and q come back with the powers that row and column r carry.
    """
    matrix = information(degree).subs({T: 1, q: 1})
    cofactor = matrix.minor(r, r, method="berkowitz")
    return factorial(r) ** 2 * cofactor / matrix.det(method="berkowitz") * q / T ** (2 * r + 1)


def price(r: int) -> Claim:
    """One derivative, all degrees up to ``LARGEST``."""

    def derive() -> Equation:
        degrees = range(max(r, 1), LARGEST + 1)
        return Equation([least_variance(r, d) for d in degrees], [of_derivative(r, d) for d in degrees])

    title = f"White noise, window T: least variance of the {NAMES[r]} at its end for motions of degree up to {LARGEST}."
    return claim(f"window.{NAMES[r]}", title, derive)


PRICES = tuple(price(r) for r in range(4))


@claim("window.scaling")
def powers_of_the_window():
    """Stretching the window stretches row and column k of the information by T^k (n = 5): T^-(2r+1) follows."""
    stretch = sp.diag(*(T**k for k in range(5)))
    return Equation(information(4), T / q * stretch * information(4).subs({T: 1, q: 1}) * stretch)


def falling(degree: sp.Expr, r: int) -> sp.Expr:
    """(degree + r)!/(degree - r)! as the product of its 2 r factors."""
    return sp.prod([degree + k for k in range(1 - r, r + 1)], start=sp.Integer(1))


@claim("window.every")
def one_degree_more():
    """For every degree: one degree more adds (2 d + 1) ((d + r)!/(d - r)!/r!)^2 to the variance, from zero (r to 3)."""
    for r in range(4):
        whole = falling(D, r) * (D + r + 1) / factorial(r)
        square = whole**2 / (2 * r + 1)
        yield (
            [(2 * D + 1) * (falling(D, r) / factorial(r)) ** 2, sp.Integer(0)],
            [square - square.subs(D, D - 1), square.subs(D, r - 1)],
        )


@claim("window.legendre")
def derivatives_at_the_end():
    """What a degree adds is Legendre's polynomial: its r-th derivative at 1 is (d + r)!/((d - r)! 2^r r!).

    Over the window it has the square integral T/(2 d + 1) and its r-th derivative the factor (2/T)^r; r to 3, d to 9.
    """
    for d in range(LARGEST + 1):
        polynomial = sp.expand(sp.legendre(d, u))
        square = sp.Poly(polynomial**2, u).integrate()
        yield sp.Rational(2, 2 * d + 1), square.eval(1) - square.eval(-1)
        for r in range(min(d, 3) + 1):
            yield (
                sp.Rational(factorial(d + r), factorial(d - r) * 2**r * factorial(r)),
                sp.diff(polynomial, u, r).subs(u, 1),
            )


@claim("window.order")
def price_of_the_order():
    """n = 5 knows the speed 20 times worse than n = 2 in the same window, and needs one 7.4 times longer.

    (The cube root of 400.) n = 3 and n = 4 are 4 and 10 times worse.
    """
    speed = [least_variance(1, d) for d in (1, 2, 3, 4)]
    return Equation(
        [16, 100, 400, of_derivative(1, 1)],
        [*(v / speed[0] for v in speed[1:]), of_derivative(1, 4).subs(T, sp.cbrt(400) * T)],
    )


# The yawing has a period of 360 s: the first window is more than a third of it.
windows_of_the_printed_errors = claim(
    "window.figures",
    "1 m every 0.2 s as white noise: for 0.019 m/s n = 5 needs 138.5 s of straight course, for 0.09 m/s 49.1 s.",
    lambda: Equation(
        [sp.Rational("138.5"), sp.Rational("49.1"), sp.Integer(960)],
        [
            *[sp.cbrt(4800 * sp.Rational("0.2") / sp.Rational(v) ** 2) for v in ("0.019", "0.09")],
            *[of_derivative(1, 4).subs({q: sp.Rational("0.2"), T: sp.Integer(1)})],
        ],
        tolerance=sp.Rational(1, 20),
    ),
    expect=CERTIFIED,
)


s = sp.Symbol("s", positive=True)  # rho tau


@claim("table.n2.closed")
def closed_form_for_two_states():
    """n = 2: mu(N_s) = 3 + sqrt(10), mu(N_f) = (7 + 3 sqrt(5))/2, exactly.

    mu + 1/mu of a (2, 2) matrix is its sum of squares over the size of its determinant; that mu - 1/mu is the positive
    root of its square less four chooses mu above one.
    """
    plain = N_f(2)
    lengths = [plain[:, k].dot(plain[:, k]) for k in range(2)]
    squares = [sum(lengths) / sp.Abs(plain.det()), 2 / sp.sqrt(plain.det() ** 2 / (lengths[0] * lengths[1]))]
    found = [(7 + 3 * sp.sqrt(5)) / 2, 3 + sp.sqrt(10)]
    above_one = [sp.sqrt(total**2 - 4) for total in squares]
    return Equation([mu + s / mu for s in (1, -1) for mu in found], [*squares, *above_one])


@claim("table.n2.best")
def normalisation_is_optimal_for_two_states():
    """n = 2: no scaling beats unit columns: at rho tau = s, mu + 1/mu exceeds 2 sqrt(10) by (sqrt(2) - sqrt(5) s)^2/s.

    Equal at s = sqrt(2/5): a step of 0.63 s in the radius channel, of four million seconds in that of latitude.
    """
    rows = sp.Matrix([[1, s], [1, 2 * s]])
    return Equation(
        2 * sp.sqrt(10) + (sp.sqrt(2) - sp.sqrt(5) * s) ** 2 / s,
        sum(entry**2 for entry in rows) / sp.sqrt(sp.expand(rows.det()) ** 2),
    )


@claim("6.Nf.determinant")
def determinant_of_the_first_stage():
    """det N_f = 1! 2! ... (n - 1)!: every order is solvable in exact arithmetic (n to 10)."""
    for n in range(2, 11):
        yield sp.prod([sp.Integer(factorial(k)) for k in range(1, n)]), N_f(n).det(method="berkowitz")
