"""Two coordinates: t_G as a function of the direction, equations (11)-(13), and its extremes."""

import sympy as sp

from navsym.claims import PROVED, Claim, Equation, claim, claims, fact, state
from navsym.language.expression import to_text
from navsym_papers.terrain_search import model
from navsym_papers.terrain_search.model import SIZES, beta_x, beta_y, crossing_time, moment, slopes, speed, step, t

DIRECTION = (beta_x, beta_y)
#: The quadratic is decided on tracks of these sizes; every printed sum runs over pairs of points, so
#: that the identity for two points (size 1) already carries over to any number.
PAIRS = (1, 2)


def quotient(points, way=DIRECTION):
    """The printed right side of (11) without its factor step."""
    bx, by = way
    squares = [(p * bx + q * by) ** 2 for p, q in points]
    return sum(k * s for k, s in enumerate(squares)) / sum(squares)


CLAIMS_11 = claims(
    "11 | t_G for a velocity error in two directions, as printed. | paper: the numerator carries a factor Delta s "
    "that (10) and the range [0, n] exclude: it would be a length; by hand: two equal slopes make t_G = 1/2, the "
    "print half of 50 m",
    lambda: Equation(step * quotient(slopes(1)), crossing_time(slopes(1), DIRECTION)),
    "11* | t_G for a velocity error in two directions: a Rayleigh quotient.",
    lambda: Equation(
        [quotient(slopes(size)) for size in SIZES], [crossing_time(slopes(size), DIRECTION) for size in SIZES]
    ),
)


@claim(
    "11.beta",
    reason="the printed arctangents turn the direction a little; for small angles, as the paper has them, they agree",
)
def direction():
    """The direction in (11) is that of (deltaVx, deltaVy) / V; its length does not matter (2 and 3 measurements)."""
    u, v = sp.symbols("deltaVx deltaVy", positive=True)
    return Equation(
        [crossing_time(slopes(size), (u / speed, v / speed)) for size in PAIRS],
        [crossing_time(slopes(size), (u, v)) for size in PAIRS],
    )


@claim("11.several")
def crossing_depends_on_the_direction():
    """A single t_G for all directions need not exist: with slopes (1, 0), (0, 1) it is 0 in one and 1 in the other."""
    points = [(1, 0), (0, 1)]
    found = tuple(crossing_time(points, way) for way in ((1, 0), (0, 1)))
    return fact(
        True,
        found[0] != found[1],
        "exact example",
        PROVED,
        evidence=f"t_G = {found}",
        meaning=(*say_least(points, (1, 0), 0), *say_least(points, (0, 1), 1)),
    )


def say_least(points: list, way: tuple, crossing: int) -> tuple[dict, ...]:
    """That the criterion, over slopes of one and zero, is a square of t less one crossing: least there alone."""
    symbols = {step.name: ["0", None, ["open-low"]], t.name: [None, None, []]}
    return (state(to_text(model.misfit(points, way, t)), "=", f"({step}*({t} - {crossing}))**2", symbols),)


# Equations (12) and (13): the sums, entry by entry


def derivative(points, variable):
    return sp.diff(quotient(points), variable)


def numerator(points, variable, factor):
    """Coefficients of bx^2, bx by, by^2 in (d t_G / d beta) D^2 / (2 factor), D the sum of squares."""
    squares = sum((p * beta_x + q * beta_y) ** 2 for p, q in points)
    polynomial = sp.Poly(sp.cancel(derivative(points, variable) * squares**2 / (2 * factor)), beta_x, beta_y)
    return [polynomial.coeff_monomial(m) for m in (beta_x**2, beta_x * beta_y, beta_y**2)]


def from_x(size):
    """[A_x2, A_x1, A_x0], from the derivative of t_G by beta_x."""
    return numerator(slopes(size), beta_x, beta_y)


def from_y(size):
    """[A_y2, A_y1, A_y0], from the derivative of t_G by beta_y."""
    return numerator(slopes(size), beta_y, beta_x)


def double_sum(size, term):
    """sum_i i sum_j term((p_i, q_i), (p_j, q_j), i, j)."""
    g = slopes(size)
    pairs = [(i, j) for i in range(size + 1) for j in range(size + 1)]
    return sp.expand(sum(i * term(g[i], g[j], i, j) for i, j in pairs))


def mixed(i, j):
    """The slope dh/dx that the print puts at (x_i, y_j): on the track for i = j only."""
    return sp.Symbol(f"p{i}", real=True) if i == j else sp.Symbol(f"p{i}_{j}", real=True)


PRINTED = {
    "Ax2": lambda a, b, i, j: a[0] * b[0] * (a[0] * b[1] - a[1] * mixed(i, j)),
    "Ax1": lambda a, b, i, j: (a[0] * b[1]) ** 2 - (a[1] * b[0]) ** 2,
    "Ax0": lambda a, b, i, j: a[1] * b[1] * (a[0] * b[1] - b[1] * b[1]),
    "Ay2": lambda a, b, i, j: a[0] * b[0] * (a[1] * b[0] - a[0] * b[1]),
    "Ay1": lambda a, b, i, j: (a[1] * b[0]) ** 2 - (a[0] * b[1]) ** 2,
    "Ay0": lambda a, b, i, j: a[1] * b[1] * (a[1] * b[1] - b[1] * b[1]),
    # With the second product of the last bracket as the derivation has it.
    "Ax2*": lambda a, b, i, j: a[0] * b[0] * (a[0] * b[1] - a[1] * b[0]),
    "Ax0*": lambda a, b, i, j: a[1] * b[1] * (a[0] * b[1] - a[1] * b[0]),
    "Ay0*": lambda a, b, i, j: a[1] * b[1] * (a[1] * b[0] - a[0] * b[1]),
}


def printed_sums(name):
    return [double_sum(size, PRINTED[name]) for size in PAIRS]


def sums(number: str, reason: str = "") -> tuple[Claim, ...]:
    """A sum against the derivative of t_G by its angle: as printed and, where that is wrong, as it should read."""
    name, place = number[3:], 2 - int(number[-1])
    derive, title = from_x if name[1] == "x" else from_y, f"The sum A_{name[1:]}"

    def stated(which: str):
        return lambda: Equation(printed_sums(which), [derive(size)[place] for size in PAIRS])

    if not reason:
        return (claim(number, f"{title}.", stated(name)),)
    printed = claim(number, f"{title}, as printed.", stated(name), slip="undecidable", reason=reason)
    return printed, claim(f"{number}*", f"{title}.", stated(f"{name}*"))


SUMS = (
    *sums(
        "12.Ax2",
        "the last factor reads h(x_i, y_j)/dx: a del is lost and the point is off the track; A_y2, its negative, has "
        "dh(x_j, y_j)/dx",
    ),
    *sums("12.Ax1"),
    *sums(
        "12.Ax0",
        "the last product is (dh_j/dy)(dh_j/dy) where the derivative of (11) gives (dh_i/dy)(dh_j/dx); by hand: "
        "slopes (0, 1), (1, 1) make it 1, the print 0",
    ),
    *sums("13.Ay2"),
    *sums("13.Ay1"),
    *sums(
        "13.Ay0",
        "the bracket is (dh_i/dy)(dh_j/dy) - (dh_j/dy)^2, without any slope along x; the derivative of (11) "
        "gives (dh_i/dy)(dh_j/dx) - (dh_i/dx)(dh_j/dy); by hand: slopes (0, 1), (1, 1) make it -1, the print 0",
    ),
)


@claim("12.linear | The double sums are differences of products of single sums: six numbers, O(n) operations.")
def sums_in_one_pass():
    for size in SIZES:
        G0, G1 = moment(slopes(size), 0), moment(slopes(size), 1)
        yield (
            [
                sp.expand(G1[0, 0] * G0[0, 1] - G1[0, 1] * G0[0, 0]),
                sp.expand(G1[0, 0] * G0[1, 1] - G1[1, 1] * G0[0, 0]),
                sp.expand(G1[0, 1] * G0[1, 1] - G1[1, 1] * G0[0, 1]),
            ],
            [double_sum(size, PRINTED[name]) for name in ("Ax2*", "Ax1", "Ax0*")],
        )


@claim("12.linear.any")
def sums_in_one_pass_for_any_track():
    """For any number of measurements: every term of the double sums is a difference of products of two single terms."""
    i = sp.Symbol("i", real=True)
    p, q, u, w = sp.symbols("p_i q_i p_j q_j", real=True)
    printed = [
        (i * p * p) * (u * w) - (i * p * q) * (u * u),
        (i * p * p) * (w * w) - (i * q * q) * (u * u),
        (i * p * q) * (w * w) - (i * q * q) * (u * w),
    ]
    terms = [PRINTED[name]((p, q), (u, w), 0, 0) for name in ("Ax2*", "Ax1", "Ax0*")]
    return Equation(printed, [i * term for term in terms])


def derivatives(number, names, variable, other, sign):
    """The derivative of t_G by one angle as the quadratic form of three sums: as printed, and with its factor."""

    def form(size):
        a2, a1, a0 = (double_sum(size, PRINTED[name]) for name in names)
        return a2 * beta_x**2 + a1 * beta_x * beta_y + a0 * beta_y**2

    def scaled(size):
        return 2 * other / sum((p * beta_x + q * beta_y) ** 2 for p, q in slopes(size)) ** 2 * form(size)

    return (
        claim(
            number,
            f"The derivative of t_G by {variable} is the quadratic form itself.",
            lambda: Equation(form(1), derivative(slopes(1), variable)),
            slip="paper",
            reason=f"the derivative is the quadratic form times 2 {other} / D^2; only the equation '= 0' survives "
            f"without the factor, and it also vanishes at {other} = 0; by hand: slopes (1, 0), (0, 1) at beta = (1, "
            f"1): the derivative is {sign}1/2, the form {sign}1",
        ),
        claim(
            f"{number}*",
            f"The derivative of t_G by {variable} is the quadratic form times 2 {other} / D^2, D the sum of squares.",
            lambda: Equation([scaled(s) for s in PAIRS], [derivative(slopes(s), variable) for s in PAIRS]),
        ),
    )


derivatives_by_x = derivatives("12", ("Ax2*", "Ax1", "Ax0*"), beta_x, beta_y, "-")
derivatives_by_y = derivatives("13", ("Ay2", "Ay1", "Ay0*"), beta_y, beta_x, "")


CLAIMS_13 = claims(
    "13.sign | A_x2 = -A_y2 and A_x1 = -A_y1.",
    lambda: Equation(
        [-a for name in ("Ay2", "Ay1") for a in printed_sums(name)], [from_x(s)[k] for k in (0, 1) for s in PAIRS]
    ),
    "13.sign0 | A_x0 = -A_y0, with A_y0 as printed. | undecidable: with A_y0 as printed the two sums are not "
    "opposite: both brackets are misprinted, differently; by hand: slopes (0, 1), (1, 1) make A_x0 = 1 and the "
    "printed A_y0 = 0",
    lambda: Equation([-a for a in printed_sums("Ay0")], [from_x(size)[2] for size in PAIRS]),
    "13.sign0* | A_x0 = -A_y0, with both sums as the derivatives give them.",
    lambda: Equation([-a for a in printed_sums("Ay0*")], [from_x(size)[2] for size in PAIRS]),
    "13.same | Both conditions are one equation: beta_x d/dbeta_x and -beta_y d/dbeta_y of t_G are equal.",
    lambda: Equation(
        [-beta_y * derivative(slopes(size), beta_y) for size in SIZES],
        [beta_x * derivative(slopes(size), beta_x) for size in SIZES],
    ),
)
