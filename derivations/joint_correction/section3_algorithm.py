"""Section 3, (3.1)-(3.3): common variables, the algorithm of joint correction, and its situations."""

from functools import cache

import sympy as sp

from navsym.claims import PROVED, Equation, Finding, claim, claims
from navsym.models.linear import LinearModel
from navsym.observability.chains import observe_jointly
from navsym_papers.joint_correction.inertial import FULL, joint_model
from navsym_papers.joint_correction.section1_systems import p, polynomial_of, say_ranks, seen_at_once
from navsym_papers.joint_correction.section2_groups import mu, position, rows, u3, velocity, w1, w2


@cache
def joint() -> LinearModel:
    """The joint model, derived once."""
    return joint_model()


x = sp.Matrix(sp.symbols("x1:7", real=True))  # estimates x_k°
y = dict(zip((1, 2, 5, 6), sp.symbols("y1 y2 y5 y6", real=True), strict=True))
sc1, sc2, sm1, sm2 = sp.symbols("sigma_c1 sigma_c2 sigma_M1 sigma_M2", real=True)
Kc = sp.symbols("Kc1:7", real=True)
Kh = dict(zip((1, 2, 5, 6), sp.symbols("Kh1 Kh2 Kh5 Kh6", real=True), strict=True))
true_y2 = sp.Symbol("y2_true", real=True)

# (3.1)


COMMON = claims(
    "3.1.x1y3 | x_1 = y_3: one variable of both groups.",
    lambda: Equation(velocity().meaning[0], position().meaning[2]),
    "3.1.x2y4 | x_2 = y_4: one variable of both groups.",
    lambda: Equation(velocity().meaning[1], position().meaning[3]),
    "3.1.x4y7 | x_4 = y_7: one variable of both groups.",
    lambda: Equation(velocity().meaning[3], position().meaning[6]),
    "3.1.x5y8 | x_5 = y_8: one variable of both groups.",
    lambda: Equation(velocity().meaning[4], position().meaning[7]),
)


@claim("3.1.overlap | The two groups have exactly four dimensions in common: those of (3.1).")
def overlap():
    first, second = functionals(velocity().meaning), functionals(position().meaning)
    from navsym_papers.joint_correction.section1_chains import rank_of

    both = sp.Matrix.vstack(first, second)
    shared = rank_of(first) + rank_of(second) - rank_of(both)
    method, scope = "exact ranks of the functionals and of their union", "16 error variables, all omega, u, mu"
    ranks = [(seen_at_once(rows), rank) for rows, rank in ((first, 6), (second, 8), (both, 10))]
    return say_ranks(4, Finding(shared, method, PROVED, scope=scope), ranks, ("4", "=", "6 + 8 - 10"))


def functionals(meaning: tuple[sp.Expr, ...]) -> sp.Matrix:
    return sp.Matrix([[sp.diff(m, state) for state in FULL] for m in meaning])


@claim("3.1.remaining")
def remaining_variables():
    """After velocity correction four variables remain for the position information: y_1, y_2, y_5, y_6."""
    found, model = observe_jointly(joint()), joint()
    method, scope = "fraction-free staircase: velocity first, then position", "joint model (2.8), (2.9)"
    finding = Finding((sum(found.staircase[:2]), sum(found.staircase[2:])), method, PROVED, scope=scope)
    first = LinearModel(model.F, None, model.H[:2, :])
    return say_ranks((6, 4), finding, [(first, 6), (model, 10)], ("4", "=", "10 - 6"))


@claim("3.1.fast | x_1, x_2 and x_4, x_5 move with the Schuler frequency; x_3 and x_6 stand still.")
def dynamic_errors_oscillate():
    F, _, _ = velocity().linear()
    return Equation(p**2 * (p**2 + 1) ** 2, polynomial_of(F))


@claim("3.1.slow | The remaining y_1, y_2, y_5, y_6 are slow: frequencies 0, 0 and mu (omega_1^2 + omega_2^2)^(1/2).")
def position_errors_are_slow():
    F, _, _ = position().linear()
    slow = F.extract([0, 1, 4, 5], [0, 1, 4, 5])
    return Equation(p**2 * (p**2 + mu**2 * (w1**2 + w2**2)), polynomial_of(slow))


# (3.2)

innovation_1 = sc1 - x[1] - x[2] - mu * u3 * x[3]
innovation_2 = sc2 - x[4] - x[5] + mu * u3 * x[0]
PRINTED_32 = (
    x[1] + Kc[0] * innovation_1,
    -x[0] + Kc[1] * innovation_1,
    Kc[2] * innovation_1,
    x[4] + Kc[3] * innovation_2,
    -x[3] + Kc[4] * innovation_2,
    Kc[5] * innovation_2,
)


def observer_row(k: int) -> sp.Expr:
    """Homogeneous part of (2.8) plus gain times innovation, from the derived group."""
    F, H, _ = velocity().linear()
    measured = (sc1, sc2)[k // 3] - (H * x)[k // 3]
    return (F * x)[k] + Kc[k] * measured


OBSERVER = rows(
    "3.2.x{0} | Estimate of x_{0}: the homogeneous equation (2.8) and the innovation of its channel.",
    *(dict(enumerate(PRINTED_32, 1)), lambda k: observer_row(k - 1)),
    kept=lambda side: side,  # with all of its terms
)

# (3.3)


def position_row(k: int) -> sp.Expr:
    """Homogeneous part of (2.9) with y_3, y_7 replaced by x_1, x_4 of (3.1), plus the innovation."""
    F, H, _ = position().linear()
    estimates = sp.Matrix([y[1], y[2], x[0], x[1], y[5], y[6], x[3], x[4]])
    channel = 0 if k < 4 else 1
    return (F * estimates)[k - 1] + Kh[k] * ((sm1, sm2)[channel] - (H * estimates)[channel])


POSITION_STAGE = claims(
    "3.3.y1 | Estimate of y_1, as printed: with y_2 itself on the right. | scan: the circle that marks an estimate is "
    "lost: y_2 is not known; the row of y_5 beside it has y_6 with the circle; by hand: y_2 = 1, all estimates 0 and "
    "K = 0: the estimator has no way to the rate 1 of the print",
    lambda: Equation(true_y2 + Kh[1] * (sm1 - y[1]), position_row(1)),
    "3.3.y1* | Estimate of y_1: y_2° and the innovation.",
    lambda: Equation(y[2] + Kh[1] * (sm1 - y[1]), position_row(1)),
    "3.3.y2 | Estimate of y_2: slow rotation, Schuler estimate x_1°, and the innovation.",
    lambda: Equation(mu**2 * w2 * (w1 * y[5] - w2 * y[1]) + Kh[2] * (sm1 - y[1]) - x[0], position_row(2)),
)
DOT = (
    "the dot of the derivative is lost on the left side: as printed the row is no differential equation, although "
    "the algorithm is one; rows y_1 and y_2 have theirs; by hand, in the row of y_5, K = 0 and y_6 = 1: the print says "
    "that y_5 is 1, not that it grows by 1 in a unit of time"
)


def assignment(k: int, right: sp.Expr) -> Equation:
    """The printed left side is y_k° itself, the algorithm's is its derivative."""
    return Equation(y[k] - right, sp.Symbol(f"dy{k}", real=True) - position_row(k))


RIGHT_5 = y[6] + Kh[5] * (sm2 - y[5])
RIGHT_6 = mu**2 * w1 * (w2 * y[1] - w1 * y[5]) + Kh[6] * (sm2 - y[5]) - x[3]


SECOND_CHANNEL = claims(
    f"3.3.y5 | Estimate of y_5, as printed: an equation for y_5° without a derivative. | scan: {DOT}",
    lambda: assignment(5, RIGHT_5),
    f"3.3.y6 | Estimate of y_6, as printed: an equation for y_6° without a derivative. | scan: {DOT}",
    lambda: assignment(6, RIGHT_6),
    "3.3.y5* | Derivative of y_5°: y_6° and the innovation.",
    lambda: Equation(RIGHT_5, position_row(5)),
    "3.3.y6* | Derivative of y_6°: slow rotation, Schuler estimate x_4°, and the innovation.",
    lambda: Equation(RIGHT_6, position_row(6)),
)


@claim("3.3.only_velocity | With the position gains zero on [t_0, t_1] position innovations enter nowhere.")
def position_gains_are_zero():
    # The dash before K_1^h does not matter: -K = 0 and K = 0 are one condition.
    zero = dict.fromkeys(Kh.values(), 0)
    derived = [sp.diff(position_row(k).subs(zero), s) for k in (1, 2, 5, 6) for s in (sm1, sm2)]
    derived += [sp.diff(observer_row(k), s) for k in range(6) for s in (sm1, sm2, *y.values())]
    return Equation([sp.Integer(0)] * len(derived), derived)


def joint_error_matrix(Kx: tuple[sp.Expr, ...] = Kc, Ky: dict[int, sp.Expr] = Kh) -> sp.Matrix:
    """Matrix of the errors of (3.2), (3.3) in x_1 … x_6, y_1, y_2, y_5, y_6, inhomogeneous terms left out."""
    model = joint()
    gains = sp.zeros(10, 4)
    for k in range(6):
        gains[k, k // 3] = Kx[k]
    for place, k in ((6, 1), (7, 2), (8, 5), (9, 6)):
        gains[place, 2 + (k > 4)] = Ky[k]
    return sp.Matrix(model.F - gains * model.H)


@claim("3.3.triangular")
def position_errors_do_not_disturb_the_velocity_stage():
    """Errors of (3.2) drive those of (3.3) through Delta x_1 and Delta x_4 only, and are never driven by them."""
    A = joint_error_matrix()
    printed = sp.zeros(4, 6)
    printed[1, 0] = printed[3, 3] = -1
    return Equation([*printed, *sp.zeros(6, 4)], [*A[6:, :6], *A[:6, 6:]])
