"""One coordinate: tracks that cross the true one, equations (9) and (10)."""

import sympy as sp

from navsym.claims import Bound, Equation, claims
from navsym_papers.terrain_search.model import SIZES, crossing_time, free_motion, misfit, n, slopes, speed, step, t

r = sp.Symbol("r", nonnegative=True)
u = sp.Symbol("q0", positive=True)
v = sp.Symbol("q1", real=True)
slope = sp.Symbol("q", positive=True)

alpha, beta, y, dV = sp.symbols("alpha beta y deltaV", real=True)
k, index = sp.symbols("k i", real=True)
dt = sp.Symbol("Deltat", positive=True)


def second_stage():
    x, tk, tG, fix, Vi = sp.symbols("x t_k t_G deltax Vi", real=True)
    DVx = sp.Symbol("DeltaVx", positive=True)
    return Equation(
        [x + fix + Vi * DVx * (tk - tG), x + fix],
        [x + free_motion(tk - tG, fix, Vi * DVx, 0)[0], x + free_motion(0, fix, Vi * DVx, 0)[0]],
    )


def second_stage_contains_the_first():
    fix, tk, tG = sp.symbols("deltax t_k t_G", real=True)
    return Equation(fix, free_motion(tk - tG, fix, sp.Integer(0), 0)[0])


def instant_as_printed():
    tG, start = sp.symbols("t_G t_0", positive=True)
    return Equation(tG, start + tG * dt)


def instant():
    start = sp.Symbol("t_0", positive=True)
    for size in SIZES:
        q = [slope for _, slope in slopes(size)]
        weight = sum(v * v for v in q)
        yield (
            start + dt * crossing_time([(0, v) for v in q], (0, 1)),
            sum((start + m * dt) * v * v for m, v in enumerate(q)) / weight,
        )


def angle_between_the_tracks():
    true, inertial = sp.Matrix([speed, 0]), sp.Matrix([speed, dV])
    return Equation(dV / speed, sp.Matrix.hstack(true, inertial).det() / true.dot(inertial))


def crossing_track():
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


def own_slopes(size):
    """Slopes across the track only."""
    return [sp.Symbol(f"q{m}", real=True) for m in range(size + 1)]


def weights_sum_to_one():
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


def crossing_is_not_before_the_start():
    numbers, weights = inner_crossing()
    return Bound(numbers, ">=", 0 * weights)


def crossing_is_not_after_the_end():
    numbers, weights = inner_crossing()
    return Bound(numbers, "<=", 3 * weights)


def sufficiency():
    for size in SIZES:
        q = own_slopes(size)
        parabola = misfit([(0, v) for v in q], (0, beta), t)
        curvature = sp.diff(sp.expand(parabola), t, 2)
        centre = crossing_time([(0, v) for v in q], (0, beta))
        yield curvature / 2 * (t - centre) ** 2, parabola - parabola.subs(t, centre)


def flat_across():
    flat = [(0, 0)] * 3
    numerator, denominator = (sum(m**power * q**2 for m, (_, q) in enumerate(flat)) for power in (1, 0))
    return Equation([sp.Integer(0)] * 3, [misfit(flat, (0, beta), t), sp.Integer(numerator), sp.Integer(denominator)])


CLAIMS = claims(
    "6 | A hypothesis of (6) is the motion of (1) that passes through the coarse fix at t_G.",
    second_stage,
    "6.rest | With zero velocity (6) reads the map where (2) does at the coarse fix, so the second stage never "
    "fits worse.",
    second_stage_contains_the_first,
    "6.time | The instant of crossing in (6) is the t_G of (10). | paper: read as one and the same t_G: that of "
    "(10) counts measurements (the text calls it relative time), while (6), (8) and (14) subtract it from seconds, "
    "which is wrong at 2 Hz; by hand: measurement 100 is taken at 50 s",
    instant_as_printed,
    "6.time* | The instant of crossing is t_0 + t_G times the interval between measurements: the mean time.",
    instant,
    "9.angle | The angle between the inertial and the true track has the tangent deltaV / V.",
    angle_between_the_tracks,
    "9.family | The tracks of the search are y + alpha + tan(beta) k step with tan(beta) = deltaV / V.",
    lambda: Equation(y + alpha + dV / speed * k * step, y + free_motion(k * step / speed, alpha, dV, 0)[0]),
    "9.small | At a velocity error of at most a tenth of the speed angle and tangent differ by under 0.4 per cent.",
    lambda: Bound(r - sp.atan(r), "<=", r / 250, {r: (0, sp.Rational(1, 10))}),
    "9.crossing | A track of the family that meets the true one at measurement t is y + beta step (k - t).",
    crossing_track,
    "9 | Height on the crossing track, as printed. | paper: the bracket has the letter i where the measurement is "
    "k; the line above has k; by hand: k = 3, t = 1, i = 0 make 2 into -1",
    lambda: Equation(relief(y) + sp.diff(relief(y), y) * beta * step * (index - t), first_order()),
    "9* | Height on the crossing track to the first order in beta.",
    lambda: Equation(relief(y) + sp.diff(relief(y), y) * beta * step * (k - t), first_order()),
    "9.sum | The criterion near the true track, as printed. | paper: the bracket has i - t with i bound to "
    "nothing, under a sum over k; by hand: with t = 0 and slopes 1 the terms k^2 = 0, 1, 4 all become i^2",
    lambda: Equation(
        sum((slope * beta * step * (index - t)) ** 2 for slope in own_slopes(2)),
        misfit([(0, slope) for slope in own_slopes(2)], (0, beta), t),
    ),
    "9.sum* | The criterion near the true track is sum (h_y beta step (k - t))^2.",
    lambda: (
        (
            sum((slope * beta * step * (m - t)) ** 2 for m, slope in enumerate(own_slopes(size))),
            misfit([(0, slope) for slope in own_slopes(size)], (0, beta), t),
        )
        for size in SIZES
    ),
    "10 | t_G is the mean of the measurement numbers, weighted with the squared slopes.",
    lambda: (
        (sum(m * v**2 for m, v in enumerate(q)) / sum(v**2 for v in q), crossing_time([(0, v) for v in q], (0, beta)))
        for q in map(own_slopes, (1, 2, 3, 4))
    ),
    "10.weights | The weights omega are squared slopes over their sum: each is the share of one point, together one.",
    weights_sum_to_one,
    "10.after | t_G is not before the first measurement.",
    crossing_is_not_before_the_start,
    "10.before | t_G is not after the last measurement.",
    crossing_is_not_after_the_end,
    "10.minimum | The second derivative of the criterion in t is not negative.",
    lambda: Bound(sp.diff(sp.expand(misfit([(0, v) for v in own_slopes(2)], (0, beta), t)), t, 2), ">=", sp.Integer(0)),
    "10.sufficient | A second derivative >= 0 suffices here: I_n(t) exceeds I_n(t_G) by half of it times (t - "
    "t_G)^2, at every t.",
    sufficiency,
    "10.unique | With one slope that is not zero the second derivative is positive and t_G the only minimum.",
    lambda: Bound(sp.expand(sp.diff(misfit([(0, u), (0, v)], (0, 1), t), t, 2) / step**2), ">", sp.Integer(0)),
    "10.flat | On ground flat across the track (3 points) the criterion is zero at each t: (10) is 0/0 and names "
    "no instant.",
    flat_across,
    "10.equal.sum | The sum of 0…n is n (n + 1)/2: it starts at 0 and grows by n.",
    lambda: Equation(
        [(n * (n + 1) / 2).subs(n, 0), n * (n + 1) / 2 - (n * (n + 1) / 2).subs(n, n - 1)], [sp.Integer(0), n]
    ),
    "10.equal | With equal slopes t_G is the middle of the track, n/2.",
    lambda: Equation(
        [sp.Rational(size, 2) for size in range(1, 11)],
        [crossing_time([(0, slope)] * (size + 1), (0, 1)) for size in range(1, 11)],
    ),
    "10.informative | t_G may lie far from the middle: one steep last point among gentle ones puts it near the end.",
    lambda: Bound(crossing_time([(0, 1)] * 10 + [(0, 30)], (0, 1)), ">=", sp.Rational(9, 10) * 10),
)
