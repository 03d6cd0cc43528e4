"""The solution (8), (14), and what the sequential estimate is when heights are linear near the fix.

Least squares over the track: with b0 = sum g z, b1 = sum k g z the joint solution (c, v) of (4) satisfies
G c + M1 v = b0, M1 c + M2 v = b1. The first stage finds c* = G^-1 b0, the second minimises over v alone.
"""

from fractions import Fraction

import sympy as sp

from navsym.claims import PROVED, Equation, claim, claims, fact, state
from navsym_papers.terrain_search.model import free_motion, inverse, slopes, symmetric

G, M1, M2 = symmetric("G"), symmetric("M"), symmetric("N")
b0 = sp.Matrix(sp.symbols("b01 b02", real=True))
b1 = sp.Matrix(sp.symbols("b11 b12", real=True))
v = sp.Matrix(sp.symbols("v_x v_y", real=True))
tG, tn = sp.symbols("t_G t_n", real=True)
fix_x, fix_y, Vi, Vj = sp.symbols("deltax deltay Vi Vj", real=True)
DVx, DVy, Dx, Dy = sp.symbols("DeltaVx DeltaVy Deltax Deltay", positive=True)


def at_the_end(fix, velocity):
    """Error at t_n of the motion (1) that passes through ``fix`` at t_G."""
    return free_motion(tn - tG, fix, velocity, 0)


CLAIMS_8 = claims(
    "8.x | The refined error along x at the last time.",
    lambda: Equation(fix_x + Vi * DVx * (tn - tG), at_the_end(fix_x, Vi * DVx)[0]),
    "8.y | The refined error along y at the last time, as printed. | undecidable: the first sign is a product: "
    "(14) and the formula for x beside it have a sum; by hand: 100 m and 2 m/s after 10 s are 120 m, the print has "
    "2000 m^2",
    lambda: Equation(fix_y * Vj * DVy * (tn - tG), at_the_end(fix_y, Vj * DVy)[0]),
    "8.y* | The refined error along y at the last time.",
    lambda: Equation(fix_y + Vj * DVy * (tn - tG), at_the_end(fix_y, Vj * DVy)[0]),
)


@claim("14.position | The corrected position at the last time.")
def final_position():
    x, y, i, j = sp.symbols("x y i j", real=True)
    return Equation(
        [x + Dx * i + DVx * Vi * (tn - tG), y + Dy * j + DVy * Vj * (tn - tG)],
        [x + at_the_end(Dx * i, DVx * Vi)[0], y + at_the_end(Dy * j, DVy * Vj)[0]],
    )


@claim("14.velocity | The corrected velocity at the last time.")
def final_velocity():
    Vx, Vy = sp.symbols("Vx Vy", real=True)
    return Equation(
        [Vx + DVx * Vi, Vy + DVy * Vj], [Vx + at_the_end(fix_x, DVx * Vi)[1], Vy + at_the_end(fix_y, DVy * Vj)[1]]
    )


def centre():
    """C = G^-1 M1."""
    return inverse(G) * M1


def schur():
    """S = M2 - M1 G^-1 M1: information on the velocity when the position is unknown."""
    return M2 - M1 * inverse(G) * M1


@claim("centre | A velocity error v moves the position fix by C v, C = G^-1 M1: the criterion is stationary there.")
def coarse_fix():
    c = sp.Matrix(sp.symbols("c_x c_y", real=True))
    criterion = (c.T * G * c - 2 * c.T * M1 * v)[0]  # sum (g'(c - k v))^2 up to what is free of c
    at_fix = dict(zip(c, centre() * v, strict=True))
    return Equation([sp.Integer(0)] * 2, [sp.diff(criterion, s).subs(at_fix, simultaneous=True) for s in c])


def sequential_normal(t):
    """Matrix and right side of the second stage when it turns about the instant t, true velocity v.

    Residual at k: g'((C - k) v + (k - t) w), w the hypothesis; C = G^-1 M1.
    """
    matrix = M2 - 2 * t * M1 + t**2 * G
    right = (M2 - M1 * centre() - t * (M1 - G * centre())) * v
    return matrix, right


def list_criteria(start: Fraction, velocity: Fraction) -> tuple[list[tuple], list[tuple]]:
    """(6) about t_G of (10), and (4), with every hypothesis: two measurements over slopes of one, grids -1, 0, 1."""
    grid, times = (-1, 0, 1), (0, 1)
    error = {k: start + velocity * k for k in times}
    joint = [(sum((e - i - w * k) ** 2 for k, e in error.items()), i, w) for i in grid for w in grid]
    coarse = min(grid, key=lambda i: sum((e - i) ** 2 for e in error.values()))
    turn = Fraction(sum(times), len(times))  # equal slopes
    second = [(sum((e - coarse - w * (k - turn)) ** 2 for k, e in error.items()), w) for w in grid]
    return second, joint


def say_least(values: list[Fraction], least: Fraction) -> list[dict]:
    """That no value is smaller, and one is equal."""
    product = "*".join(f"({value} - {least})" for value in values)
    return [*(state(str(value), ">=", str(least)) for value in values), state(product, "=", "0")]


CLAIMS_CROSSING = claims(
    "crossing.exists | The coarse track meets the true one at some t: the displacement C v - t v vanishes for t = "
    "t_G. | paper: in two dimensions C v is not along v in general, so that the two tracks are in one place at no "
    "instant, unless v is an eigenvector of C; by hand: C = diag(0, 1), v = (1, 1): (0, 1) - t (1, 1) never "
    "vanishes",
    lambda: Equation([sp.Integer(0)] * 2, list(centre() * v - ((v.T * M1 * v)[0] / (v.T * G * v)[0]) * v)),
    "crossing.exists* | At t_G the displacement C v - t_G v is orthogonal to v in the metric G: the tracks pass, "
    "not meet.",
    lambda: Equation(sp.Integer(0), (v.T * G * (centre() * v - ((v.T * M1 * v)[0] / (v.T * G * v)[0]) * v))[0]),
)


@claim("sequential.below")
def sequential_search_may_fit_better():
    """Least (6) may be below least (4) on one grid: here 0 and 1/2, since (6) turns about t_G, off the grid of (4)."""
    found = list_criteria(Fraction(1, 2), Fraction(1))
    printed = (Fraction(0), 1), (Fraction(1, 2), 0, 1)
    scope = "heights h(x) = x, n = 1, steps of one, errors 1/2 of the position and 1 of the velocity"
    pairs = zip(found, printed, strict=True)
    meaning = [text for of_all, (least, *_) in pairs for text in say_least([value for value, *_ in of_all], least)]
    return fact(printed, tuple(map(min, found)), "all hypotheses counted", PROVED, scope=scope, meaning=meaning)


@claim("sequential.shrinks")
def sequential_estimate():
    """The second stage of the paper solves (S + R) w = S v with R = (M1 - t G) G^-1 (M1 - t G)."""
    matrix, right = sequential_normal(tG)
    rest = M1 - tG * G
    printed = [*(schur() + rest * inverse(G) * rest), *(schur() * v)]
    return Equation(printed, [*matrix, *right])


@claim("sequential.shrinks.sign")
def what_is_added_is_not_negative():
    """x'Rx = (R0 x)' G^-1 (R0 x) with R0 = M1 - t G: nothing is added only where v is an eigenvector of C."""
    rest = M1 - tG * G
    x = (rest * v).T * inverse(G) * (rest * v)
    matrix, _ = sequential_normal(tG)
    return Equation(x[0], (v.T * (matrix - schur()) * v)[0])


def two_stages():
    """Position and velocity of the sequential search about the matrix C; b0, b1 hold errors and noise."""
    coarse = inverse(G) * b0
    velocity = inverse(schur()) * (b1 - M1 * coarse)
    return coarse - centre() * velocity, velocity


@claim("sequential.exact")
def two_stages_are_the_joint_solution():
    """Turning about C, the two stages solve the joint normal equations exactly, whatever the noise."""
    position, velocity = two_stages()
    return Equation([*b0, *b1], [*(G * position + M1 * velocity), *(M1 * position + M2 * velocity)])


@claim("sequential.second")
def second_stage_about_the_centre():
    """With C in the place of t_G the matrix of the second stage is S and its right side b1 - M1 c*."""
    t = centre()
    matrix = M2 - t.T * M1 - M1 * t + t.T * G * t  # sum (k - C)' g g' (k - C)
    return Equation(
        [*schur(), *(b1 - M1 * inverse(G) * b0)], [*matrix, *((b1 - t.T * b0) - (M1 - t.T * G) * (inverse(G) * b0))]
    )


@claim("14.centre | The position at t_n is the coarse fix plus (t_n - C) v: the correction that costs nothing.")
def final_position_from_the_centre():
    position, velocity = two_stages()
    coarse = inverse(G) * b0
    printed = coarse + (tn * sp.eye(2) - centre()) * velocity
    return Equation(list(printed), list(position + tn * velocity))


@claim("acceleration | On even terrain a constant acceleration a leaves errors a n (n - 1)/12 and a n/2 at the end.")
def constant_acceleration():
    a = sp.Symbol("a", real=True)
    sizes = range(2, 8)
    return Equation(
        [error for n in sizes for error in (a * n * (n - 1) / sp.Integer(12), a * n / sp.Integer(2))],
        [error for n in sizes for error in line_fit_errors(a, n)],
    )


def line_fit_errors(a, n):
    """Errors at the end, in position and velocity, of the line fitted to a k^2/2, k = 0…n."""
    truth = [free_motion(sp.Integer(k), 0, 0, a)[0] for k in range(n + 1)]
    sums = [sum(sp.Integer(k) ** m for k in range(n + 1)) for m in range(3)]
    rights = [sum(truth), sum(k * y for k, y in enumerate(truth))]
    offset, slope = inverse(sp.Matrix([[sums[0], sums[1]], [sums[1], sums[2]]])) * sp.Matrix(rights)
    end = free_motion(sp.Integer(n), 0, 0, a)
    return [sp.expand(end[0] - offset - slope * n), sp.expand(end[1] - slope)]


@claim("offset.centre")
def coarse_fix_with_an_unknown_height():
    """With an unknown constant height error the fix moves by C v, C = G^-1 M1 of slopes less their means."""
    c = sp.Matrix(sp.symbols("c_x c_y", real=True))
    height = sp.Symbol("b", real=True)
    derived = []
    for size in (2, 3):
        g = [sp.Matrix(pair) for pair in slopes(size)]
        criterion = sum(((s.T * (c - k * v))[0] - height) ** 2 for k, s in enumerate(g))
        mean = sum(g, sp.zeros(2, 1)) / len(g)
        moving = sum((k * s for k, s in enumerate(g)), sp.zeros(2, 1)) / len(g)
        G0 = sum(((s - mean) * (s - mean).T for s in g), sp.zeros(2, 2))
        M0 = sum(((s - mean) * (k * s - moving).T for k, s in enumerate(g)), sp.zeros(2, 2))
        fix = inverse(G0) * M0 * v
        at_fix = {**dict(zip(c, fix, strict=True)), height: (mean.T * fix)[0] - (moving.T * v)[0]}
        derived += [sp.diff(criterion, s).subs(at_fix, simultaneous=True) for s in (*c, height)]
    return Equation([sp.Integer(0)] * len(derived), derived)


@claim("offset.groups")
def groups_about_their_own_means():
    """Squares about the means of groups are at most those about the whole mean: what bounding without offset rests on.

    For groups of m and n measurements with means a and b the difference is m n (a - b)^2 / (m + n).
    """
    m, n = sp.symbols("m n", positive=True)
    a, b, S = sp.symbols("a b S", real=True)
    whole = (m * a + n * b) / (m + n)
    # sum (d - c)^2 over a group is its squares about its mean plus m (mean - c)^2; S: both squares about own means.
    return Equation(S + m * n * (a - b) ** 2 / (m + n), S + m * (a - whole) ** 2 + n * (b - whole) ** 2)


@claim("offset | Without the mean of its differences the criterion is free of a constant height error.")
def constant_height_error():
    height = sp.Symbol("b", real=True)
    d = sp.symbols("d0:4", real=True)
    mean = sum(d) / 4
    shifted = [x + height for x in d]
    return Equation(sum((x - mean) ** 2 for x in d), sum((x - sum(shifted) / 4) ** 2 for x in shifted))
