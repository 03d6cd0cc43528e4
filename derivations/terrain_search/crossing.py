"""One coordinate: tracks that cross the true one, equations (9) and (10)."""

import sympy as sp

from navsym.claims import Bound, Equation, claim
from navsym_papers.terrain_search.model import SIZES, crossing_time, free_motion, misfit, n, slopes, speed, step, t

alpha, beta, y, dV = sp.symbols("alpha beta y deltaV", real=True)
k, index = sp.symbols("k i", real=True)
dt = sp.Symbol("Deltat", positive=True)


@claim("6")
def second_stage():
    """A hypothesis of (6) is the motion of (1) that passes through the coarse fix at t_G."""
    x, tk, tG, fix, Vi = sp.symbols("x t_k t_G deltax Vi", real=True)
    DVx = sp.Symbol("DeltaVx", positive=True)
    return Equation(
        [x + fix + Vi * DVx * (tk - tG), x + fix],
        [x + free_motion(tk - tG, fix, Vi * DVx, 0)[0], x + free_motion(0, fix, Vi * DVx, 0)[0]],
    )


@claim("6.rest")
def second_stage_contains_the_first():
    """With zero velocity (6) reads the map where (2) does at the coarse fix, so the second stage never fits worse."""
    fix, tk, tG = sp.symbols("deltax t_k t_G", real=True)
    return Equation(fix, free_motion(tk - tG, fix, sp.Integer(0), 0)[0])


@claim(
    "6.time",
    slip="paper",
    reason="read as one and the same t_G: that of (10) counts measurements (the text calls it relative time), while "
    "(6), (8) and (14) subtract it from seconds, which is wrong at 2 Hz; by hand: measurement 100 is taken at 50 s",
)
def instant_as_printed():
    """The instant of crossing in (6) is the t_G of (10)."""
    tG, start = sp.symbols("t_G t_0", positive=True)
    return Equation(tG, start + tG * dt)


@claim("6.time*")
def instant():
    """The instant of crossing is t_0 + t_G times the interval between measurements: the mean time."""
    start = sp.Symbol("t_0", positive=True)
    for size in SIZES:
        q = [slope for _, slope in slopes(size)]
        weight = sum(v * v for v in q)
        yield (
            start + dt * crossing_time([(0, v) for v in q], (0, 1)),
            sum((start + m * dt) * v * v for m, v in enumerate(q)) / weight,
        )


@claim("9.angle")
def angle_between_the_tracks():
    """The angle between the inertial and the true track has the tangent deltaV / V."""
    true, inertial = sp.Matrix([speed, 0]), sp.Matrix([speed, dV])
    return Equation(dV / speed, sp.Matrix.hstack(true, inertial).det() / true.dot(inertial))


family = claim(
    "9.family",
    "The tracks of the search are y + alpha + tan(beta) k step with tan(beta) = deltaV / V.",
    lambda: Equation(y + alpha + dV / speed * k * step, y + free_motion(k * step / speed, alpha, dV, 0)[0]),
)


@claim("9.small")
def the_angle_is_close_to_its_tangent():
    """At a velocity error of at most a tenth of the speed angle and tangent differ by under 0.4 per cent."""
    r = sp.Symbol("r", nonnegative=True)
    return Bound(r - sp.atan(r), "<=", r / 250, {r: (0, sp.Rational(1, 10))})


@claim("9.crossing")
def crossing_track():
    """A track of the family that meets the true one at measurement t is y + beta step (k - t)."""
    offset = sp.Symbol("a", real=True)
    # alpha is fixed by the demand that the displacement vanish at k = t: a linear equation in alpha.
    displacement = offset + beta * t * step
    return Equation(
        y + beta * step * (k - t), y + (-displacement.subs(offset, 0) / sp.diff(displacement, offset)) + beta * k * step
    )


def relief(position):
    """A height profile across the track with free coefficients."""
    return sum(sp.Symbol(f"a{m}", real=True) * position**m for m in range(4))


def first_order():
    """Height on the crossing track to the first order in beta."""
    displaced = relief(y + beta * step * (k - t))
    return relief(y) + beta * sp.diff(displaced, beta).subs(beta, 0)


height_as_printed = claim(
    "9",
    "Height on the crossing track, as printed.",
    lambda: Equation(relief(y) + sp.diff(relief(y), y) * beta * step * (index - t), first_order()),
    slip="paper",
    reason="the bracket has the letter i where the measurement is k; the line above has k; by hand: k = 3, t = 1, i "
    "= 0 make 2 into -1",
)
height = claim(
    "9*",
    "Height on the crossing track to the first order in beta.",
    lambda: Equation(relief(y) + sp.diff(relief(y), y) * beta * step * (k - t), first_order()),
)


def own_slopes(size):
    """Slopes across the track only."""
    return [sp.Symbol(f"q{m}", real=True) for m in range(size + 1)]


@claim(
    "9.sum",
    slip="paper",
    reason="the bracket has i - t with i bound to nothing, under a sum over k; by hand: with t = 0 and slopes 1 the "
    "terms k^2 = 0, 1, 4 all become i^2",
)
def criterion_as_printed():
    """The criterion near the true track, as printed."""
    q = own_slopes(2)
    return Equation(
        sum((slope * beta * step * (index - t)) ** 2 for slope in q), misfit([(0, slope) for slope in q], (0, beta), t)
    )


@claim("9.sum*")
def criterion():
    """The criterion near the true track is sum (h_y beta step (k - t))^2."""
    for size in SIZES:
        q = own_slopes(size)
        yield (
            sum((slope * beta * step * (m - t)) ** 2 for m, slope in enumerate(q)),
            misfit([(0, slope) for slope in q], (0, beta), t),
        )


@claim("10")
def crossing():
    """t_G is the mean of the measurement numbers, weighted with the squared slopes."""
    for q in map(own_slopes, (1, 2, 3, 4)):
        yield (
            sum(m * v**2 for m, v in enumerate(q)) / sum(v**2 for v in q),
            crossing_time([(0, v) for v in q], (0, beta)),
        )


@claim("10.weights")
def weights_sum_to_one():
    """The weights omega are squared slopes over their sum: each is the share of one point, together one."""
    q = own_slopes(3)
    shift = sp.Symbol("s", real=True)
    # If the weights sum to one, numbering the measurements from s instead of 0 moves t_G by s.
    return Equation(
        [sp.Integer(1)], [sp.diff(sum((m + shift) * v**2 for m, v in enumerate(q)) / sum(v**2 for v in q), shift)]
    )


def inner_crossing():
    """t_G of a track of four points with squared slopes u0…u3, as numerator and denominator."""
    u = [sp.Symbol(f"u{m}", positive=True) for m in range(4)]
    return sum(m * w for m, w in enumerate(u)), sum(u)


@claim("10.after")
def crossing_is_not_before_the_start():
    """t_G is not before the first measurement."""
    numbers, weights = inner_crossing()
    return Bound(numbers, ">=", 0 * weights)


@claim("10.before")
def crossing_is_not_after_the_end():
    """t_G is not after the last measurement."""
    numbers, weights = inner_crossing()
    return Bound(numbers, "<=", 3 * weights)


@claim("10.minimum")
def second_order_condition():
    """The second derivative of the criterion in t is not negative."""
    q = own_slopes(2)
    return Bound(sp.diff(sp.expand(misfit([(0, v) for v in q], (0, beta), t)), t, 2), ">=", sp.Integer(0))


@claim("10.sufficient")
def sufficiency():
    """A second derivative >= 0 suffices here: I_n(t) exceeds I_n(t_G) by half of it times (t - t_G)^2, at every t."""
    for size in SIZES:
        q = own_slopes(size)
        parabola = misfit([(0, v) for v in q], (0, beta), t)
        curvature = sp.diff(sp.expand(parabola), t, 2)
        centre = crossing_time([(0, v) for v in q], (0, beta))
        yield curvature / 2 * (t - centre) ** 2, parabola - parabola.subs(t, centre)


@claim("10.unique")
def uniqueness():
    """With one slope that is not zero the second derivative is positive and t_G the only minimum."""
    u, v = sp.Symbol("q0", positive=True), sp.Symbol("q1", real=True)
    return Bound(sp.expand(sp.diff(misfit([(0, u), (0, v)], (0, 1), t), t, 2) / step**2), ">", sp.Integer(0))


@claim("10.flat")
def flat_across():
    """On ground flat across the track (3 points) the criterion is zero at each t: (10) is 0/0 and names no instant."""
    flat = [(0, 0)] * 3
    numerator, denominator = (sum(m**power * q**2 for m, (_, q) in enumerate(flat)) for power in (1, 0))
    return Equation([sp.Integer(0)] * 3, [misfit(flat, (0, beta), t), sp.Integer(numerator), sp.Integer(denominator)])


@claim("10.equal.sum")
def sum_of_numbers():
    """The sum of 0…n is n (n + 1)/2: it starts at 0 and grows by n."""
    printed = n * (n + 1) / 2
    return Equation([printed.subs(n, 0), printed - printed.subs(n, n - 1)], [sp.Integer(0), n])


@claim("10.equal")
def equal_slopes():
    """With equal slopes t_G is the middle of the track, n/2."""
    slope = sp.Symbol("q", positive=True)
    sizes = range(1, 11)
    return Equation(
        [sp.Rational(size, 2) for size in sizes], [crossing_time([(0, slope)] * (size + 1), (0, 1)) for size in sizes]
    )


informative_end = claim(
    "10.informative",
    "t_G may lie far from the middle: one steep last point among gentle ones puts it near the end.",
    lambda: Bound(crossing_time([(0, 1)] * 10 + [(0, 30)], (0, 1)), ">=", sp.Rational(9, 10) * 10),
)
