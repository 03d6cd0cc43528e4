"""What the paper does not have: the solution for every T, and when it is the only one.

The paper states its formulas for T <= pi/2. They hold further, each to its own bound, which is
where a weight changes sign: y1 for every T, y2 up to 4 pi/3, y3 up to 2 pi/3. Beyond these
bounds two instants are enough; from 3 pi/2 (y2) and pi (y3) on they are half a period apart, and the value is one.
"""

from typing import Any

import sympy as sp

from navsym.claims import Bound, Claim, Equation, Optimum, claim, claims
from navsym.models.linear import LinearModel
from navsym.models.transition.exponential import regressors
from navsym_papers.guaranteed_velocity.model import INSTANTS, H, T, alternating, optimum, tau, weights

Y1, Y2, Y3 = range(3)
ONE, HALF = sp.Integer(1), (sp.Rational(1, 2), -sp.Rational(1, 2))
SIN, COS = sp.sin(T), sp.cos(T)
#: The errors of y2 and y3 on three instants.
ALTERNATING = {Y2: 2 * sp.cot(T / 4), Y3: sp.cos(T / 2) / sp.sin(T / 4) ** 2}
#: The duals of y2 for 4 pi/3 <= T <= 3 pi/2 and of y3 for 2 pi/3 <= T <= pi.
DUALS = {
    Y2: (1 - 1 / SIN**2 + COS / SIN**2, -1 / SIN, COS / SIN**2),
    Y3: (-1 / COS - sp.tan(T) ** 2, SIN / COS**2, -1 / COS),
}


# -- how far the printed formulas hold ---------------------------------------


def regime(heading: str, lower: Any, upper: Any, state: int, *solution: Any) -> Claim:
    """That a dual, its times, weights and value are optimal between two T: those of three instants if none is given."""

    def derive() -> Optimum:
        alternance = tuple(alternating()), INSTANTS, weights(state), ALTERNATING.get(state)
        return optimum(state, *(solution or alternance), {T: (sp.sympify(lower), upper)})

    return claim(heading, derive=derive)


SHARP = "REFUTED: a test of sharpness: at the end of this range a weight has the wrong sign"
REGIMES = (
    regime(
        "range.y1 | y1: the last measurement alone is optimal for every T.",
        *(0, None, Y1, (1, 0, 0), (T,), (ONE,), ONE),
    ),
    regime(
        "range.y2 | y2: the printed weights and error 2 cot(T/4) are optimal up to T = 4 pi/3, not only to pi/2.",
        *(0, 4 * sp.pi / 3, Y2),
    ),
    regime(
        "range.y3 | y3: the printed weights and error cos(T/2)/sin^2(T/4) are optimal up to T = 2 pi/3.",
        *(0, 2 * sp.pi / 3, Y3),
    ),
    regime(f"range.y2.end | y2: the printed solution is optimal up to T = 3 pi/2. | {SHARP}", 0, 3 * sp.pi / 2, Y2),
    regime(
        "range.y2.end* | y2, 4 pi/3 <= T <= 3 pi/2: two instants, 2(T - pi) and 0, and the error -1/sin T.",
        *(4 * sp.pi / 3, 3 * sp.pi / 2, Y2, DUALS[Y2]),
        *((2 * T - 2 * sp.pi, sp.Integer(0)), (-1 / (2 * SIN), 1 / (2 * SIN)), -1 / SIN),
    ),
    regime(
        "range.y2.last | y2, every T >= 3 pi/2: half the difference of two measurements half a period apart, error 1.",
        *(3 * sp.pi / 2, None, Y2, (0, 1, 0), (T - sp.pi / 2, T - 3 * sp.pi / 2), HALF, ONE),
    ),
    regime(f"range.y3.end | y3: the printed solution is optimal up to T = 3 pi/4. | {SHARP}", 0, 3 * sp.pi / 4, Y3),
    regime(
        "range.y3.end* | y3, 2 pi/3 <= T <= pi: two instants, 2 T - pi and 0, and the error -1/cos T.",
        *(2 * sp.pi / 3, sp.pi, Y3, DUALS[Y3]),
        *((2 * T - sp.pi, sp.Integer(0)), (-1 / (2 * COS), 1 / (2 * COS)), -1 / COS),
    ),
    regime(
        "range.y3.last | y3, every T >= pi: half the difference of two measurements half a period apart, error 1.",
        *(sp.pi, None, Y3, (1, 0, 1), (T, T - sp.pi), HALF, ONE),
    ),
)


# -- the errors meet where the regimes meet ---------------------------------------


MEETINGS: tuple[Claim, ...] = tuple(
    claim(
        f"range.{state}.meets.{place}",
        f"The errors of {state} on both sides of T = {at} agree there.",
        lambda left=left, right=right, at=at: Equation(left.subs(T, at), right.subs(T, at)),
    )
    for state, place, left, right, at in (
        ("y2", "1", ALTERNATING[Y2], -1 / SIN, 4 * sp.pi / 3),
        ("y2", "2", -1 / SIN, ONE, 3 * sp.pi / 2),
        ("y3", "1", ALTERNATING[Y3], -1 / COS, 2 * sp.pi / 3),
        ("y3", "2", -1 / COS, ONE, sp.pi),
    )
)


# -- uniqueness ---------------------------------------

v = sp.Symbol("v", positive=True)  # position inside a half interval, 0 < v <= 1
UNIQUE_BOX = {T: (0, 4 * sp.pi / 3), v: (0, 1)}


def dual_polynomial(at: sp.Expr) -> sp.Expr:
    return (alternating().T * H(at))[0]


s = sp.Symbol("s", nonnegative=True)  # T - tau, how long before the end


def contacts(dual: tuple, below: sp.Expr, above: sp.Expr) -> Equation:
    """1 - x.H and 1 + x.H at T - s beside their closed forms: the contacts are the zeros."""
    value = (sp.Matrix([dual]) * H(T - s))[0]
    return Equation([below, above], [1 - value, 1 + value])


CLAIMS_UNIQUE = claims(
    "unique.upper-bound | 1 - x.H > 0 at T/2 - v T/2, 0 < v <= 1, T <= 4 pi/3: by unique.symmetric it touches +1 "
    "at T/2 only.",
    lambda: Bound(1 - dual_polynomial(T / 2 - v * T / 2), ">", 0, UNIQUE_BOX),
    "unique.symmetric | x.H is symmetric about T/2 (T <= 4 pi/3), so that one half decides for both.",
    lambda: Equation(dual_polynomial(T - tau), dual_polynomial(tau), {T: (0, 4 * sp.pi / 3)}),
    # Every optimal weight function lives on the contacts of an optimal dual; with three contacts and det N != 0 there
    # is one for y2 (T <= 4 pi/3) and y3 (T <= 2 pi/3). This is the argument that the paper leaves to (4.11).
    "unique.lower-bound | 1 + x.H > 0 at v T/2, 0 < v <= 1, T <= 4 pi/3: by unique.symmetric it touches -1 at 0 "
    "and T only.",
    lambda: Bound(1 + dual_polynomial(v * T / 2), ">", 0, UNIQUE_BOX),
    # Every optimal weight function lives on the contacts of every optimal dual: unique for T < 2 pi. For T <= 4 pi/3
    # the argument from (4.11) serves as well: the dual of 4.6.same-instants has three contacts.
    "range.y1.contacts | y1, every T: 1 - x.H = sin^2(s/2), s = T - tau, for the dual (1, 0, 1/2): for T < 2 pi "
    "one contact.",
    lambda: contacts((1, 0, sp.Rational(1, 2)), sp.sin(s / 2) ** 2, 1 + sp.cos(s / 2) ** 2),
)


other_dual_of_velocity = regime(
    "range.y1.other_dual | y1, every T: the dual (1, 0, 1/2) is feasible and has the value 1.",
    *(0, None, Y1, (1, 0, sp.Rational(1, 2)), (T,), (ONE,), ONE),
)


CLAIMS_RANGE = claims(
    # The last sine has an argument between 0 and pi. Contacts at 2(T - pi) and 0 make the estimate unique.
    "range.y2.end.contacts | y2, 4 pi/3 <= T <= 3 pi/2: zeros s = 2 pi - T of 1 - x.H and s = T of 1 + x.H (s = 0 "
    "too at T = 4 pi/3).",
    lambda: contacts(
        DUALS[Y2],
        2 / sp.sin(T) ** 2 * sp.sin((T + s) / 2) ** 2,
        2 / sp.sin(T) ** 2 * sp.sin((T - s) / 2) * sp.sin((3 * T + s) / 2 - 2 * sp.pi),
    ),
)


@claim("range.y2.last.contacts")
def tilt_touches_half_a_period_apart():
    """y2, T >= 3 pi/2: x.H = sin s touches at s = pi/2 and 3 pi/2; no other s < 5 pi/2: unique for T < 5 pi/2."""
    below, above = 2 * sp.sin(s / 2 - sp.pi / 4) ** 2, 2 * sp.cos(s / 2 - sp.pi / 4) ** 2
    return contacts((0, 1, 0), below, above)


CLAIMS_RANGE_2 = claims(
    # The last sine has an argument between 0 and pi. Contacts at 2 T - pi and 0 make the estimate unique.
    "range.y3.end.contacts | y3, 2 pi/3 <= T <= pi: zeros s = pi - T of 1 - x.H and s = T of 1 + x.H (s = 0 too at "
    "T = 2 pi/3).",
    lambda: contacts(
        DUALS[Y3],
        2 / sp.cos(T) ** 2 * sp.cos((T + s) / 2) ** 2,
        2 / sp.cos(T) ** 2 * sp.sin((T - s) / 2) * sp.sin((3 * T + s) / 2 - sp.pi),
    ),
    "range.y3.last.contacts | y3, T >= pi: x.H = cos s touches at s = 0 and pi; no other s below 2 pi, so unique "
    "for T < 2 pi.",
    lambda: contacts((1, 0, 1), 2 * sp.sin(s / 2) ** 2, 2 * sp.cos(s / 2) ** 2),
)


#: H repeats after 2 pi, so that one time of the last regime may move back by a period as soon as it lies in [0, T].
TWINS: tuple[Claim, ...] = tuple(
    regime(
        f"range.y{state + 1}.twin | y{state + 1}, T >= {start}: other times give the same error: no longer unique.",
        *(start, None, state, dual, times, weights_, ONE),
    )
    for state, dual, times, weights_, start in (
        (Y1, (1, 0, 0), (T - 2 * sp.pi,), (ONE,), 2 * sp.pi),
        (Y2, (0, 1, 0), (T - 5 * sp.pi / 2, T - 3 * sp.pi / 2), HALF, 5 * sp.pi / 2),
        (Y3, (1, 0, 1), (T - 2 * sp.pi, T - sp.pi), HALF, 2 * sp.pi),
    )
)


# -- position correction ---------------------------------------

#: Position error before the three states of a channel; z = y0 + w.
POSITION = LinearModel(
    F=[[0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1], [0, 0, -1, 0]],
    H=[[1, 0, 0, 0]],
    states=("y0", "y1", "y2", "y3"),
    measurements=("position",),
)


@claim("position.y2")
def tilt_from_positions():
    """Position correction, y2, T >= 2 pi: l = 3 times serve m = 4 states, where [9] is quoted with l = m."""
    quarter = sp.Rational(1, 4)
    return Optimum(
        regressors=tuple(regressors(POSITION, T, tau).matrix),
        functional=(0, 0, 1, 0),
        variable=tau,
        interval=(sp.Integer(0), T),
        dual=(1, 0, 1, 0),
        support=(T, T - sp.pi, T - 2 * sp.pi),
        weights=(quarter, -2 * quarter, quarter),
        value=sp.Integer(1),
        box={T: (2 * sp.pi, None)},
    )
