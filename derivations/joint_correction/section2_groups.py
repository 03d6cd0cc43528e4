"""Section 2, (2.6)-(2.9): the two groups of observable variables, with bookkeeping of mu.

The derived sides are found by machine: the velocity information is split into its Schuler part
and its constant part at mu = 0, the position information is differentiated, and what has the
order mu^2 rho is dropped term by term (``navsym_papers.joint_correction.inertial``).
"""

from collections.abc import Callable
from functools import cache, partial
from itertools import pairwise
from typing import Any

import sympy as sp

from navsym.claims import PROVED, Claim, Equation, Finding, Property, claim, claims, fact, state
from navsym.language.expression import to_text
from navsym.observability.chains import observe_jointly
from navsym.observability.rank_drops import find_drops
from navsym_papers.joint_correction import inertial
from navsym_papers.joint_correction.inertial import ORDERS, W_C0, W_M0, Group, lowest_order, say_orders, truncate
from navsym_papers.joint_correction.kinematics import ALPHA, BETA, EPSILON
from navsym_papers.joint_correction.matrices import write_matrix
from navsym_papers.joint_correction.section1_systems import say_ranks

mu = inertial.MU
a1, a2 = ALPHA[:2]
b1, b2, b3 = BETA
pi1, pi2 = inertial.PI
v1, v2, v3 = inertial.NU
e1, e2 = EPSILON
w1, w2 = inertial.OMEGA[:2]
dw1, dw2 = inertial.OMEGA_RATE[:2]
u1, u2, u3 = inertial.EARTH
x1, x2, x3, x4, x5, x6 = inertial.X
y1, y2, y3, y4, y5, y6, y7, y8 = inertial.Y


@cache
def velocity() -> Group:
    return inertial.velocity_group()


@cache
def position() -> Group:
    return inertial.position_group()


def up_to_order(side: sp.Expr) -> sp.Expr:
    """A side without its terms of the order mu^2 rho, which the rows leave open; as it stands when it has none."""
    found = truncate(side, ORDERS, 2)
    return found.kept if found.dropped else side


def same(
    printed: sp.Expr, derived: Callable[[], sp.Expr], kept: Callable[[sp.Expr], sp.Expr] = up_to_order
) -> Callable[[], Equation]:
    """What is kept of a printed row and of the derived one, all but terms of the order mu^2 rho, is compared."""
    return lambda: Equation(kept(printed), kept(derived()))


def rows(
    heading: str, printed: dict[int, sp.Expr], derived: Callable[[int], sp.Expr], **more: Any
) -> tuple[Claim, ...]:
    """A claim for each printed row; the heading has its number for {0}."""
    return tuple(claim(heading.format(k), derive=same(row, partial(derived, k), **more)) for k, row in printed.items())


# (2.6) and (2.7): what the variables are

VELOCITY_MEANING = (
    a1 + e2,
    pi1 + v1,
    mu * (u2 * b3 - u3 * b2) + W_C0[0] - v1 + mu * u3 * e1,
    a2 - e1,
    pi2 + v2,
    mu * (u3 * b1 - u1 * b3) + W_C0[1] - v2 + mu * u3 * e2,
)
POSITION_MEANING = (
    a1 - b1 + W_M0[0],
    pi1 + mu * w2 * b3,
    a1 + e2,
    pi1 + v1,
    a2 - b2 + W_M0[1],
    pi2 - mu * w1 * b3,
    a2 - e1,
    pi2 + v2,
)

MEANINGS = (
    *rows(
        "2.6.x{0} | x_{0} as a combination of errors, from the spectral parts of sigma^c.",
        *(dict(enumerate(VELOCITY_MEANING, 1)), lambda k: velocity().meaning[k - 1]),
    ),
    *rows(
        "2.7.y{0} | y_{0} as a combination of errors, from sigma^M and its derivatives.",
        *(dict(enumerate(POSITION_MEANING, 1)), lambda k: position().meaning[k - 1]),
    ),
)

# (2.8): the velocity group

earth_drift = u1 * b2 - u2 * b1
VELOCITY_ROWS = (x2, -x1 - mu * w2 * v3, -(mu**2) * w2 * earth_drift + mu * (u2 * v3 - u3 * v2), x5, -x4 + mu * w1 * v3)

RATES_X = rows(
    "2.8.x{0} | Derivative of x_{0} up to terms of order mu^2 rho.",
    *(dict(enumerate(VELOCITY_ROWS, 1)), lambda k: velocity().rates[k - 1]),
)
CLAIMS_2_8 = claims(
    "2.8.x6 | Derivative of x_6, as printed. | undecidable: sign of the last bracket: x_6 contains -u_1 beta_3 and "
    "u_3 beta_1, whose drifts give -u_1 nu_3 + u_3 nu_1; the row of x_3 turned by 90 degrees gives the same; by "
    "hand: u_1 = nu_3 = 1, all others 0: beta_3 grows at 1 and x_6 = -mu beta_3 at -mu, the print has mu",
    same(mu**2 * w1 * earth_drift + mu * (u1 * v3 - u3 * v1), lambda: velocity().rates[5]),
    "2.8.x6* | Derivative of x_6 up to terms of order mu^2 rho.",
    same(mu**2 * w1 * earth_drift - mu * (u1 * v3 - u3 * v1), lambda: velocity().rates[5]),
    "2.8.sigma1 | sigma_1^c in the variables of the group, without noise.",
    same(x2 + x3 + mu * u3 * x4, lambda: velocity().outputs[0]),
    "2.8.sigma2 | sigma_2^c in the variables of the group, without noise.",
    same(x5 + x6 - mu * u3 * x1, lambda: velocity().outputs[1]),
)

# (2.9): the position group

#: y_2 and y_6 are the derivatives of y_1 and y_5: (2.7) says what they are, the kinematics what they have to be.
POSITION_ROWS = {3: y4, 4: -y3 - mu * w2 * v3, 7: y8, 8: -y7 + mu * w1 * v3}
DOT = (
    "the dot over omega is lost: beta_3 enters through the derivative of omega only (mu omega nu_3 cancels); as "
    "printed the term has the order rho, against the paper's own remark that the inhomogeneous terms have the order "
    "mu; by hand: constant omega, beta_3 = 1, all others 0: y_2 and y_6 stand still, the print has mu omega_2 and "
    "-mu omega_1"
)


def turn_rate(angle: sp.Symbol, turn: sp.Symbol) -> sp.Expr:
    """Of the difference of two angles, from the kinematics."""
    return sp.expand(inertial.dimensionless().rates[angle] - inertial.dimensionless().rates[turn])


DERIVATIVES_Y = claims(
    "2.9.y1 | Derivative of y_1: y_2 as (2.7) prints it is the rate of alpha_1 - beta_1.",
    same(POSITION_MEANING[1], lambda: turn_rate(a1, b1)),
    "2.9.y5 | Derivative of y_5: y_6 as (2.7) prints it is the rate of alpha_2 - beta_2.",
    same(POSITION_MEANING[5], lambda: turn_rate(a2, b2)),
)
RATES_Y = rows(
    "2.9.y{0} | Derivative of y_{0} up to terms of order mu^2 rho.", POSITION_ROWS, lambda k: position().rates[k - 1]
)
SLOW_2, SLOW_6 = (w1 * y5 - w2 * y1) * w2, (w2 * y1 - w1 * y5) * w1
CLAIMS_2_9 = claims(
    f"2.9.y2 | Derivative of y_2, as printed. | scan: {DOT}",
    same(-y3 + mu**2 * SLOW_2 + mu * w2 * b3, lambda: position().rates[1]),
    "2.9.y2* | Derivative of y_2 up to terms of order mu^2 rho.",
    same(-y3 + mu**2 * SLOW_2 + mu * dw2 * b3, lambda: position().rates[1]),
    f"2.9.y6 | Derivative of y_6, as printed. | scan: {DOT}",
    same(-y7 + mu**2 * SLOW_6 - mu * w1 * b3, lambda: position().rates[5]),
    "2.9.y6* | Derivative of y_6 up to terms of order mu^2 rho.",
    same(-y7 + mu**2 * SLOW_6 - mu * dw1 * b3, lambda: position().rates[5]),
    "2.9.sigma1 | sigma_1^M in the variables of the group, without noise.",
    same(y1, lambda: position().outputs[0]),
    "2.9.sigma2 | sigma_2^M in the variables of the group, without noise.",
    same(y5, lambda: position().outputs[1]),
)


# Statements in words about (2.8) and (2.9)


@claim("2.8.neglected")
def neglected_terms():
    """What (2.8) and (2.9) leave out has the order mu^2 rho exactly: nothing is lower, nothing higher."""
    dropped = [term for group in (velocity(), position()) for row_ in group.dropped for term in row_]
    orders = {term.order for term in dropped}
    method = "bookkeeping of every monomial"
    scope = "alpha, pi, epsilon, nu, w of order rho; beta, gamma of order rho/mu; d omega/d tau of order mu"
    evidence = f"{len(dropped)} terms, listed by the model"
    meaning = [say_orders([(term.term, 2) for term in dropped], ORDERS)]
    return fact((2,), tuple(sorted(orders)), method, PROVED, scope=scope, evidence=evidence, meaning=meaning)


@claim("2.8.inhomogeneous")
def inhomogeneous_terms():
    """(2.8) and (2.9) are inhomogeneous, and all terms that make them so have the order mu (times rho)."""
    forcing = [term for group in (velocity(), position()) for term in group.linear()[2]]
    orders = {lowest_order(term, ORDERS) for term in forcing if term != 0}
    found = tuple(sorted(orders)) if {truncate(term, ORDERS, 2).dropped for term in forcing} == {()} else None
    method = "bookkeeping of every monomial"
    meaning = [say_order_one(*(term for term in forcing if term != 0))]
    return fact((1,), found, method, PROVED, scope="orders as declared in 2.8.neglected", meaning=meaning)


def say_order_one(*forcing: sp.Expr) -> dict:
    """That all monomials have the order mu."""
    return say_orders([(term, 1) for value in forcing for term in sp.Add.make_args(sp.expand(value))], ORDERS)


def order_one(term: sp.Expr) -> Property:
    """That a term has the order mu."""
    return fact(1, lowest_order(term, ORDERS), "bookkeeping of every monomial", PROVED, meaning=[say_order_one(term)])


INHOMOGENEOUS = claims(
    "2.9.inhomogeneous_printed | The printed inhomogeneous term mu omega_2 beta_3 of y_2 has the order mu (times rho). "
    f"| scan: {DOT}",
    lambda: order_one(mu * w2 * b3),
)


def rank_and_drops(group: Group) -> tuple[int, tuple[str, ...]]:
    found = observe_jointly(group.model(("first", "second")))
    drops = find_drops(found).drops
    conditions = tuple(d.condition for d in drops if d.subspace == "joint" and d.complete)
    return found.joint_dimension, conditions


def say_observable(group: Group, rank: int, unseen: tuple[sp.Expr, ...]) -> list[dict]:
    """That sums of H F^k from the left are d eye(n), and that F keeps vectors N, H N = 0, at unseen values of mu u_3.

    Each H F^k is the one before times F. The rank is n where the determinant d is not zero; it drops where such
    vectors exist.
    """
    F, H = map(sp.Matrix, group.linear()[:2])
    powers = [(H * F**k).applyfunc(sp.expand) for k in range(rank // H.rows)]
    seen = sp.Matrix.vstack(*powers)
    shares = seen.adjugate().applyfunc(sp.expand)
    F_text, rows, d = write_matrix(F), [*map(write_matrix, powers)], to_text(sp.factor(seen.det()))
    parts = [f"{write_matrix(shares[:, k * H.rows : (k + 1) * H.rows])} @ {row}" for k, row in enumerate(rows)]
    symbols = {s.name: [None, None, []] for s in sorted(F.free_symbols | H.free_symbols, key=str)}
    said = [state(f"{row} @ {F_text}", "=", after, symbols) for row, after in pairwise(rows)]
    said.append(state(" + ".join(parts), "=", f"({d})*eye({rank})", symbols))
    for value in unseen:
        there = {u3: value / mu}
        N = sp.Matrix.hstack(*seen.subs(there).nullspace())
        M = (N.T * N).inv() * N.T * F * N
        other = {"mu": ["0", None, ["open-low"]]}
        said.append(
            state(f"{write_matrix(H.subs(there))} @ {write_matrix(N)}", "=", f"zeros({H.rows}, {N.cols})", other)
        )
        said.append(state(f"{F_text} @ {write_matrix(N)}", "=", f"{write_matrix(N)} @ {write_matrix(M)}"))
        said.append(state(to_text(sum(x**2 for x in N)), ">", "0"))
    return said


def leading_rank(measurements: tuple[int, ...], printed: int, scope: str) -> Property:
    """Rank of the chains of the 16-state model when mu -> 0 with B = mu beta_3 kept of order one.

    The slow angles are rescaled, beta = B/mu for the third; beta_1, beta_2 enter the position at order
    one as they are.
    """
    from navsym.models.linear import LinearModel

    model = inertial.full_model()
    place = {symbol: k for k, symbol in enumerate(inertial.FULL)}
    scale = sp.eye(16)
    velocity_only = measurements == (0, 1)
    for symbol in BETA if velocity_only else BETA[2:]:
        scale[place[symbol], place[symbol]] = mu
    F = (scale * model.F * scale.inv()).applyfunc(sp.expand).subs(mu, 0)
    H = (model.H * scale.inv()).applyfunc(sp.expand).subs(mu, 0)
    leading = LinearModel(F, None, sp.Matrix([H[k, :] for k in measurements]))
    rank = observe_jointly(leading).joint_dimension
    finding = Finding(rank, "exact rank of the leading-order model", PROVED, scope=scope)
    return say_ranks(printed, finding, [(leading, printed)])


CLAIMS = claims(
    "2.9.inhomogeneous_printed* | With the derivative of omega the inhomogeneous term of y_2 has the order mu "
    "(times rho).",
    lambda: order_one(position().linear()[2][1]),
    "2.8.observable | x_1 ... x_6 are observable by velocity information, except where mu u_3 = 1 or -1.",
    lambda: fact(
        (6, ("mu*u_3 + 1 = 0", "mu*u_3 - 1 = 0")),
        rank_and_drops(velocity()),
        "fraction-free rank, all split determinants",
        PROVED,
        scope="homogeneous part of (2.8)",
        meaning=say_observable(velocity(), 6, (sp.Integer(-1), sp.Integer(1))),
    ),
    "2.9.observable | y_1 ... y_8 are observable by position information, for all mu, omega_1, omega_2.",
    lambda: fact(
        (8, ()),
        rank_and_drops(position()),
        "fraction-free rank, a split determinant that is a number",
        PROVED,
        scope="homogeneous part of (2.9)",
        meaning=say_observable(position(), 8, ()),
    ),
    # mu -> 0 in the motion, mu beta is kept; u_1, u_2, u_3 are arbitrary.
    "2.6.span | Velocity information observes exactly six combinations at leading order.",
    lambda: leading_rank((0, 1), 6, "mu = 0 in the motion, mu beta of order rho; u_1, u_2, u_3 arbitrary"),
    # mu -> 0 in the motion, the drift mu beta_3 is kept.
    "2.7.span | Position information observes exactly eight combinations at leading order.",
    lambda: leading_rank((2, 3), 8, "mu = 0 in the motion, mu beta of order rho; omega_1, omega_2 arbitrary"),
)
