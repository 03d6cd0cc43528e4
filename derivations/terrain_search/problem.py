"""Statement of the problem: hypotheses, criteria (2) and (4), the bias of the position-only search."""

from itertools import product

import sympy as sp

from navsym.claims import Bound, Equation, claim, claims
from navsym_papers.terrain_search.model import SIZES, free_motion, inverse, moment, n, slopes

instant = sp.Symbol("t", real=True)

i, j, Vi, Vj = sp.symbols("i j Vi Vj", real=True)
Dx, Dy, DVx, DVy, T = sp.symbols("Deltax Deltay DeltaVx DeltaVy T", positive=True)
x, y, tk, t0, dVx, dVy = sp.symbols("x y t_k t_0 deltaVx deltaVy", real=True)


def count_of(first, last):
    """Number of terms of a sum from first to last."""
    return sp.summation(1, (sp.Symbol("k"), first, last))


CLAIMS_GRID = claims(
    "grid.count | Indices from -N to N are 2N + 1 hypotheses.",
    lambda: Equation(
        [2 * sp.Integer(N) + 1 for N in range(21)], [sp.Integer(len(range(-N, N + 1))) for N in range(21)]
    ),
    "2.count | The criterion sums n measurements. | paper: the text makes n measurements, k = 1…n, while the sums "
    "(2), (4), (6) run over k = 0…n; by hand: n = 2 makes three terms",
    lambda: Equation(n, count_of(0, n)),
    "2.count* | The criterion sums n + 1 measurements.",
    lambda: Equation(n + 1, count_of(0, n)),
)


@claim("1.height")
def height_error_of_the_model():
    """The height error b of (1) adds (n + 1) b^2 to (2), the same for all hypotheses, and 2 b sum d, which is not."""
    b = sp.Symbol("deltaH", real=True)
    for size in (1, 2, 3):
        d = sp.symbols(f"d0:{size + 1}", real=True)
        yield 2 * b * sum(d) + (size + 1) * b**2, sum((each + b) ** 2 for each in d) - sum(each**2 for each in d)


@claim("2.cost | The position search evaluates Mx My hypotheses.")
def position_cost():
    sizes = [(a, b) for a in range(4) for b in range(4)]
    pairs = [[(u, v) for u in range(-a, a + 1) for v in range(-b, b + 1)] for a, b in sizes]
    return Equation([(2 * sp.Integer(a) + 1) * (2 * b + 1) for a, b in sizes], [sp.Integer(len(p)) for p in pairs])


@claim("4 | A hypothesis of (4) is a motion of the model (1) without accelerations, and (2) when Vi = Vj = 0.")
def joint_hypothesis():
    tau = tk - t0
    moved = [free_motion(tau, a, v, 0)[0] for a, v in ((i * Dx, Vi * DVx), (j * Dy, Vj * DVy))]
    printed = [x + i * Dx + Vi * DVx * tau, y + j * Dy + Vj * DVy * tau]
    return Equation(
        [*printed, *[p.subs({Vi: 0, Vj: 0}) for p in printed]], [x + moved[0], y + moved[1], x + i * Dx, y + j * Dy]
    )


@claim("bias.mean | Over terrain that is as likely in either direction, the fix is off by deltaV T/2 on average.")
def bias_on_average():
    velocity = sp.Matrix([dVx, dVy])
    means = []
    for size in SIZES[:2]:
        points = slopes(size)
        both = [inverse(moment(track, 0)) * moment(track, 1) for track in (points, points[::-1])]
        means += list((both[0] + both[1]) / 2 * (T / size) * velocity)
    return Equation([dVx * T / 2, dVy * T / 2] * len(SIZES[:2]), means)


@claim("bias.mirror")
def bias_of_a_mirrored_profile():
    """On a track whose slopes are the same read from either end the bias is deltaV T/2 in every flight."""
    (a, b), (c, d), (e, f) = slopes(2)
    biases = []
    for points in ([(a, b), (c, d), (a, b)], [(a, b), (c, d), (e, f), (c, d), (a, b)]):
        times = T / (len(points) - 1)
        biases += list(inverse(moment(points, 0)) * moment(points, 1) * times * sp.Matrix([dVx, dVy]))
    return Equation([dVx * T / 2, dVy * T / 2] * 2, biases)


CLAIMS_BIAS = claims(
    "bias.200 | With 5 m/s on an axis the bias reaches 200 m, here after the 1000 s of the paper's run.",
    lambda: Bound(sp.Integer(200), "<=", mean_fix(sp.S.Zero, sp.S.Zero, sp.Integer(5)).subs(T, 1000)),
)


@claim("bias.units | Against the position at the end of the interval the same bias has the opposite sign.")
def bias_at_the_end():
    start, velocity = sp.symbols("deltax0 deltaV", real=True)
    fix = start + velocity * T / 2
    return Equation(-velocity * T / 2, fix - free_motion(T, start, velocity, 0)[0])


def mean_fix(at: sp.Expr, start: sp.Expr, velocity: sp.Expr) -> sp.Expr:
    """Mean error of the position search, its fix taken for the error of the inertial system at the instant ``at``."""
    points = slopes(1)
    both = [inverse(moment(track, 0)) * moment(track, 1) for track in (points, points[::-1])]
    displaced = sp.cancel(((both[0] + both[1]) / 2)[0, 0]) * T * velocity
    return start + displaced - free_motion(at, start, velocity, 0)[0]


CLAIMS_BIAS_2 = claims(
    "bias.only_way | On average the fix of the position search is right at T/2, and off by deltaV (T/2 - t) at "
    "another instant t.",
    lambda: Equation([sp.Integer(0), dVx * (T / 2 - instant)], [mean_fix(T / 2, x, dVx), mean_fix(instant, x, dVx)]),
    "velocity.grid | A range of 5 m/s on either side in steps of 1 m/s is 11 hypotheses on an axis.",
    lambda: Equation(sp.Integer(11), sp.Integer(len(range(-5, 6)))),
)


@claim("velocity.cost")
def growth_of_the_cost():
    """The joint search evaluates MVx MVy times as many hypotheses as the position search (N = 1, 2; NV to 2)."""
    for place, vx, vy in product((1, 2), range(3), range(3)):
        axes = [range(-half, half + 1) for half in (place, place, vx, vy)]
        joint, position = (len(list(product(*parts))) for parts in (axes, axes[:2]))
        yield (2 * sp.Integer(vx) + 1) * (2 * vy + 1), sp.Rational(joint, position)


CLAIMS_VELOCITY = claims(
    "velocity.orders | With 11 by 11 velocities the cost grows by more than two orders of magnitude.",
    lambda: Bound(sp.Integer(len(range(-5, 6)) ** 2), ">", sp.Integer(10) ** 2),
)
