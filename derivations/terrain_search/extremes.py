"""The extremes of t_G: the two cases of the paper, the roots, the middle of the interval as a mean."""

import sympy as sp

from navsym.claims import OPEN, PROVED, UNDECIDED, Bound, Equation, claim, claims, fact, state
from navsym_papers.terrain_search.directions import quotient, say_least
from navsym_papers.terrain_search.model import beta_x, beta_y, crossing_time, inverse, moment, slopes, symmetric

u = sp.Symbol("u", real=True)

G, M = symmetric("G"), symmetric("M")
a, b = sp.symbols("a b", positive=True)


def form_sums(G, M):
    """(A2, A1, A0): coefficients of det[M v, G v], v = (beta_x, beta_y)."""
    v = sp.Matrix([beta_x, beta_y])
    polynomial = sp.Poly(sp.expand(sp.Matrix.hstack(M * v, G * v).det()), beta_x, beta_y)
    return [polynomial.coeff_monomial(m) for m in (beta_x**2, beta_x * beta_y, beta_y**2)]


@claim("case1.value")
def value_without_cross_track_error():
    """With beta_y = 0, t_G is one value, whatever beta_x: the mean weighted with the squared slopes along x."""
    for size in (1, 2, 3):
        p = [slope for slope, _ in slopes(size)]
        yield sum(k * s**2 for k, s in enumerate(p)) / sum(s**2 for s in p), crossing_time(slopes(size), (beta_x, 0))


def slope_at_the_axis(size):
    """d t_G / d beta_y at beta_y = 0."""
    return sp.cancel(sp.diff(quotient(slopes(size)), beta_y).subs(beta_y, 0))


CLAIMS_CASE1 = claims(
    "case1 | Read as a case of the solution: beta_y = 0 always solves the necessary conditions. | paper: read as a "
    "case of solving (12), (13), which is how it is introduced: at beta_y = 0 only the derivative by beta_x "
    "vanishes, and t_G is stationary there if and only if A_2 = 0; its value is right (case1.value); by hand: "
    "slopes (1, 0), (1, 1) at beta = (1, 0): the derivative is 1/2",
    lambda: Equation(sp.Integer(0), slope_at_the_axis(1)),
)


@claim("case1* | At beta_y = 0 the derivative of t_G by beta_y is -2 A_2 / (beta_x (sum h_x^2)^2).")
def axis():
    printed = []
    for size in (1, 2):
        points = slopes(size)
        A2 = form_sums(moment(points, 0), moment(points, 1))[0]
        printed.append(-2 * A2 / (beta_x * sum(p**2 for p, _ in points) ** 2))
    return Equation(printed, [slope_at_the_axis(size) for size in (1, 2)])


@claim("roots")
def roots_of_the_quadratic():
    """The printed roots are zeros of A_2 b^2 + A_1 b + A_0 when A_2 is not zero and the discriminant not negative."""
    A2, A1 = sp.Symbol("A2", real=True, nonzero=True), sp.Symbol("A1", real=True)
    root = sp.Symbol("r", nonnegative=True)
    A0 = (A1**2 - root**2) / (4 * A2)  # any A0 with the discriminant root^2
    zeros = [(-A1 + sign * root) / (2 * A2) for sign in (1, -1)]
    value = [A2 * b**2 + A1 * b + A0 for b in zeros]
    return Equation([sp.Integer(0)] * 2 + [root**2], [*value, A1**2 - 4 * A2 * A0])


@claim("roots.both | The directions (beta_x : beta_y) that solve it are two: here the axes, with t_G = 0 and 1.")
def two_directions():
    points, axes = [(1, 0), (0, 1)], ((1, 0), (0, 1))
    A2, A1, A0 = form_sums(moment(points, 0), moment(points, 1))
    found = (A2, A0, *(crossing_time(points, way) for way in axes))
    form, off_axes = f"{A2}*u**2 + {A1}*u*v + {A0}*v**2", {name: [None, None, ["nonzero"]] for name in "uv"}
    least = (text for crossing, way in enumerate(axes) for text in say_least(points, way, crossing))
    meaning = (state(str(A2), "=", "0"), state(str(A0), "=", "0"), state(form, "!=", "0", off_axes), *least)
    method = "A_2 and A_0, the form on the axes, and t_G there: slopes (1, 0) and (0, 1)"
    return fact((0, 0, 0, 1), tuple(map(int, found)), method, PROVED, meaning=meaning)


@claim("roots.values | (v'Gv) M1 v - (v'M1 v) G v = W (beta_y, -beta_x): where W = 0, v is an eigenvector of G^-1 M1.")
def a_root_is_an_eigenvector():
    v = sp.Matrix([beta_x, beta_y])
    A2, A1, A0 = form_sums(G, M)
    W = A2 * beta_x**2 + A1 * beta_x * beta_y + A0 * beta_y**2
    residual = (v.T * G * v)[0] * (M * v) - (v.T * M * v)[0] * (G * v)
    return Equation([W * beta_y, -W * beta_x], list(residual))


@claim("roots.range")
def every_value_lies_between_the_roots():
    """One root gives t_min, the other t_max: det(M1 - t_G G) = -(W / v'Gv)^2 is 0 at the roots, else negative."""
    v = sp.Matrix([beta_x, beta_y])
    A2, A1, A0 = form_sums(G, M)
    W = A2 * beta_x**2 + A1 * beta_x * beta_y + A0 * beta_y**2
    square = (v.T * G * v)[0]
    return Equation(-((W / square) ** 2), (M - (v.T * M * v)[0] / square * G).det())


@claim("roots.solvable")
def always_solvable():
    """The solvability that the paper tests always holds: G11^2 and G22^2 times the discriminant are sums of squares.

    The sums have det G >= 0 before one square (roots.gram); where G11 and G22 are both zero, all slopes are.
    """
    A2, A1, A0 = form_sums(G, M)
    ends = ((G[0, 0], A2), (G[1, 1], A0))
    squares = [(g * A1 - 2 * G[0, 1] * A) ** 2 + 4 * G.det() * A**2 for g, A in ends]
    return Equation(squares, [g**2 * (A1**2 - 4 * A2 * A0) for g, _ in ends])


@claim("roots.gram | det G is a sum of squares over pairs of points, so the discriminant is never negative.")
def information_is_not_negative():
    printed = []
    for size in (1, 2, 3):
        g = slopes(size)
        pairs = [(i, j) for i in range(size + 1) for j in range(i)]
        printed.append(sum((g[i][0] * g[j][1] - g[i][1] * g[j][0]) ** 2 for i, j in pairs))
    return Equation(printed, [moment(slopes(size), 0).det() for size in (1, 2, 3)])


@claim("flat | On terrain that slopes along one direction only, A_2 = A_1 = A_0 = 0: the quadratic says nothing.")
def slopes_of_one_direction():
    c = sp.Symbol("c", real=True)
    found = []
    for size in (1, 2, 3):
        points = [(p, c * p) for p, _ in slopes(size)]
        found += form_sums(moment(points, 0), moment(points, 1))
    return Equation([sp.Integer(0)] * len(found), found)


# The middle of the interval as a mean over directions


def mean_over_directions():
    """Mean over a uniform angle of t_G for G = diag(a^2, b^2).

    With u = tan(angle) it is 1/pi times the integral over the line of (m11 + 2 m12 u + m22 u^2) /
    ((a^2 + b^2 u^2)(1 + u^2)). The odd term gives zero; the even ones split into X/(1 + u^2) +
    Y/(a^2 + b^2 u^2), whose integrals are X pi and Y pi/(a b).
    """
    m11, m22, u = M[0, 0], M[1, 1], sp.Symbol("u")
    X = (m11 - m22) / (a**2 - b**2)
    Y = m11 - a**2 * X
    remainder = sp.expand(m11 + m22 * u**2 - sp.cancel(X * (a**2 + b**2 * u**2) + Y * (1 + u**2)))
    assert sp.cancel(remainder) == 0
    return X + Y / (a * b)


BOX = {a: (2, 3), b: (sp.Rational(1, 2), 1)}


@claim(
    "mean | The mean of t_G over a uniform direction is the middle of [t_min, t_max], half the trace of G^-1 M1. | "
    "paper: t_G is not spread evenly over [t_min, t_max] when the direction is uniform: the direction with the "
    "larger slopes counts for more; equal only when both slopes are equally strong; by hand: G = diag(4, 1), M1 = "
    "diag(4, 0): the middle of [0, 1] is 1/2, the mean 2/3"
)
def middle_as_printed():
    centre = inverse(sp.diag(a**2, b**2)) * M
    return Equation((centre[0, 0] + centre[1, 1]) / 2, mean_over_directions(), BOX)


CLAIMS_MEAN = claims(
    "mean* | The mean of t_G over a uniform direction is tr(G^-1/2 M1) / tr(G^1/2).",
    lambda: Equation(
        (inverse(sp.diag(a, b)) * M).trace() / sp.diag(a, b).trace(), mean_over_directions(), nonzero=(a - b,)
    ),
)


@claim("mean.rotated | In any axes it is (tr(adj(G) M1) + s tr M1) / (s (tr G + 2 s)), s = sqrt(det G).")
def mean_in_any_axes():
    angle = sp.Symbol("phi", real=True)
    R = sp.Matrix([[sp.cos(angle), -sp.sin(angle)], [sp.sin(angle), sp.cos(angle)]])
    turned, moments = R * sp.diag(a**2, b**2) * R.T, R * M * R.T
    s = a * b  # the determinant does not change
    adjugate = sp.Matrix([[turned[1, 1], -turned[0, 1]], [-turned[1, 0], turned[0, 0]]])
    printed = ((adjugate * moments).trace() + s * moments.trace()) / (s * (turned.trace() + 2 * s))
    return Equation(printed, (M[0, 0] / a + M[1, 1] / b) / (a + b))


CLAIMS_MEAN_2 = claims(
    "mean.primitives | The two integrals of the mean: primitives arctan(u) and arctan(b u / a) / (a b).",
    lambda: Equation(
        [sp.diff(sp.atan(u), u), sp.diff(sp.atan(b * u / a) / (a * b), u)], [1 / (1 + u**2), 1 / (a**2 + b**2 * u**2)]
    ),
)


@claim("middle.trace | The roots of det(M1 - t G) add up to tr(G^-1 M1); their difference squared is D / det(G)^2.")
def middle_is_half_the_trace():
    t = sp.Symbol("t", real=True)
    quadratic = sp.Poly(sp.expand((M - t * G).det()), t)
    c2, c1, c0 = quadratic.all_coeffs()
    A2, A1, A0 = form_sums(G, M)
    return Equation(
        [(inverse(G) * M).trace(), (A1**2 - 4 * A2 * A0) / G.det() ** 2], [-c1 / c2, (c1**2 - 4 * c2 * c0) / c2**2]
    )


def width_of_an_example():
    """Width over n for one slope along (1, 2) at the start and one across it at the end."""
    points = [(1, 2), *[(0, 0)] * 9, (2, -1)]
    A2, A1, A0 = form_sums(moment(points, 0), moment(points, 1))
    return sp.sqrt(A1**2 - 4 * A2 * A0) / moment(points, 0).det() / 10


CLAIMS_INTERVAL = claims(
    "interval.tenth | In the experiment of figure 4 the interval [t_min, t_max] is at most a tenth of the track. | "
    "OPEN",
    lambda: fact(
        True,
        UNDECIDED,
        "reading",
        OPEN,
        evidence="neither figure 4 nor the terrain of figure 3 is in the text: the interval cannot be computed again",
    ),
    "interval.whole | On other terrain the interval [t_min, t_max] may be the whole track. | note: the tenth of "
    "the track is printed for figure 4 only; where the terrain slopes one way in one part of the track and across "
    "it in the other, [t_min, t_max] is the whole track",
    lambda: Equation(sp.Integer(1), width_of_an_example()),
)


@claim("interval.accuracy")
def accuracy_of_the_middle():
    """If the interval is at most a tenth of the track, its middle is within a twentieth of every t_G in it."""
    length, rest = sp.symbols("L e", nonnegative=True)
    share = sp.Symbol("s", nonnegative=True)
    # t_G = t_min + s L, s in [0, 1]; the track is 10 L + e long. The other side is the same with 1 - s for s.
    return Bound(
        length * share - length / 2,
        "<=",
        (10 * length + rest) / 20,
        {share: (0, 1), length: (0, None), rest: (0, None)},
    )


@claim("interval.half")
def distance_from_the_middle():
    """Half the interval bounds the error of its middle: width^2/4 - (t_G - middle)^2 = (W/D)^2 / det G."""
    v = sp.Matrix([beta_x, beta_y])
    A2, A1, A0 = form_sums(G, M)
    W = A2 * beta_x**2 + A1 * beta_x * beta_y + A0 * beta_y**2
    square = (v.T * G * v)[0]
    middle = (inverse(G) * M).trace() / 2
    quarter = (A1**2 - 4 * A2 * A0) / G.det() ** 2 / 4
    return Equation((W / square) ** 2 / G.det(), quarter - ((v.T * M * v)[0] / square - middle) ** 2)
