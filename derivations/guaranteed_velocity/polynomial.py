"""Section 4.1 up to (4.9): the generalised Chebyshev polynomial and its deviations."""

import sympy as sp

from navsym.claims import PROVED, Bound, Equation, Finding, Optimum, Property, claim, claims, fact, state
from navsym.language.expression import to_text
from navsym.prove.identities import vanishes_identically
from navsym.prove.signs import Sign, prove_sign
from navsym_papers.guaranteed_velocity.model import INSTANTS, STATED, H, T, alternating, optimum, tau, weights

U2_PRINTED = sp.sin(T / 4) ** 2 / sp.cos(T / 2)
U3_PRINTED = sp.tan(T / 2)
L1_PRINTED = sp.sin(T / 4) ** 2 / sp.cos(T / 2)
#: The range of validity that the paper states, in a statement.
RANGE = {"T": ["0", "pi/2", ["open-low"]]}


def deviation() -> sp.Expr:
    """L for y3: with the dual x normed to one, L = 1/x3."""
    return 1 / alternating()[2]


def coefficients() -> tuple[sp.Expr, sp.Expr]:
    """u2 and u3 of the polynomial H3 + u2 H1 + u3 H2, from the alternating dual."""
    x = alternating()
    return x[0] / x[2], x[1] / x[2]


def polynomial(u2: sp.Expr, u3: sp.Expr) -> sp.Expr:
    """S(tau) = H3 + u2 H1 + u3 H2."""
    vector = H()
    return vector[2] + u2 * vector[0] + u3 * vector[1]


# -- (4.1), (4.2) ---------------------------------------


def rotated() -> sp.Matrix:
    """(H3, H1, H2): the component to be estimated in front, the others in their order."""
    vector = H()
    return sp.Matrix([vector[2], vector[0], vector[1]])


#: Of determinant 1; that of an exchange is -1.
CYCLE = sp.Matrix([[0, 0, 1], [1, 0, 0], [0, 1, 0]])


CLAIMS_4_1 = claims(
    "4.1 | The permuted H, as printed. | paper: the third component inherits the sign of (1.9)",
    lambda: Equation([sp.cos(T - tau) - 1, 1, -sp.sin(T - tau)], list(rotated())),
    "4.1* | The permuted H.",
    lambda: Equation([sp.cos(T - tau) - 1, 1, sp.sin(T - tau)], list(rotated())),
    "4.1.order | (4.1) is the cyclic shift (H3, H1, H2), where remark 3.1 speaks of one exchange; nothing depends "
    "on it.",
    lambda: Equation([sp.cos(T - tau) - 1, 1, sp.sin(T - tau), 1], [*(CYCLE * H()), CYCLE.det()]),
)


@claim("4.2 | S(tau) = cos(T - tau) - 1 + u2 + u3 sin(T - tau), with the sine as in the derived H.")
def polynomial_to_be_minimised():
    u2, u3 = sp.symbols("u2 u3", real=True)
    printed = sp.cos(T - tau) - 1 + u2 + u3 * sp.sin(T - tau)
    return Equation(printed, polynomial(u2, u3))


# -- (4.3) to (4.6) ---------------------------------------


CLAIMS_4_3 = claims(
    "4.3.u2 | u2 as printed. | undecidable: the minus is lost: S(0) = u2 and S(T/2) = 1/cos(T/2) - 1 + u2 are "
    "opposite only for u2 < 0",
    lambda: Equation(U2_PRINTED, coefficients()[0], STATED),
    "4.3.u2* | u2 = -sin^2(T/4)/cos(T/2).",
    lambda: Equation(-U2_PRINTED, coefficients()[0], STATED),
    "4.3.u3 | u3 = tan(T/2).",
    lambda: Equation(U3_PRINTED, coefficients()[1], STATED),
)


@claim("4.3.unique | The equations of alternance have one solution: their determinant does not vanish for T <= pi/2.")
def alternance_determines_the_polynomial():
    u2, u3, L = sp.symbols("u2 u3 L", real=True)
    conditions = [polynomial(u2, u3).subs(tau, at) - sign * L for at, sign in zip(INSTANTS, (-1, 1, -1), strict=True)]
    matrix = sp.Matrix(conditions).jacobian([u2, u3, L])
    return Bound(matrix.det(), "!=", 0, STATED)


def least_deviation(u2: sp.Expr) -> Optimum:
    """That the polynomial with u2 and the printed u3 deviates least: its dual is optimal for y3."""
    dual = (u2 / L1_PRINTED, U3_PRINTED / L1_PRINTED, 1 / L1_PRINTED)
    return optimum(2, dual, INSTANTS, weights(2), 1 / L1_PRINTED)


def value_at(instant: sp.Expr) -> sp.Expr:
    return polynomial(*coefficients()).subs(tau, instant)


def instants_in_use() -> Finding:
    """Number of weights that have a sign on the stated range; the others have to vanish identically."""
    signs = [[proved_sign(w) for w in weights(index)] for index in range(3)]
    others = [w for index, row in enumerate(signs) for w, sign in zip(weights(index), row, strict=True) if not sign]
    counts = tuple(sum(map(abs, row)) for row in signs) if all(map(vanishes_identically, others)) else None
    return Finding(counts, "signs and normal forms of the weights", PROVED, "all T in (0, pi/2]")


CLAIMS_4_4 = claims(
    "4.4 | S0 with the printed u2, u3 deviates least from zero: optimal for y3, as printed. | undecidable: with "
    "the printed u2 the polynomial leaves the band [-L1, L1]; the sign of u2 is the only cause",
    lambda: least_deviation(U2_PRINTED),
    "4.4* | S0 with u2 = -sin^2(T/4)/cos(T/2), u3 = tan(T/2) deviates least from zero: optimal for y3.",
    lambda: least_deviation(-U2_PRINTED),
    "4.4.closed-form | S0(tau) = (2 cos(tau - T/2) - 1 - cos(T/2)) / (2 cos(T/2)): what the graphs of the paper show.",
    lambda: Equation(
        (2 * sp.cos(tau - T / 2) - 1 - sp.cos(T / 2)) / (2 * sp.cos(T / 2)), polynomial(*coefficients()), STATED
    ),
    "4.5 | The largest deviation L1 = sin^2(T/4)/cos(T/2).",
    lambda: Equation(L1_PRINTED, deviation(), STATED),
    "4.5.positive | L1 is positive on the stated range, so that the bars of modulus in (4.5) may be dropped.",
    lambda: Bound(L1_PRINTED, ">", 0, STATED),
    "4.6 | S0 takes the values -L1, +L1, -L1 at tau = 0, T/2, T.",
    lambda: Equation([-L1_PRINTED, L1_PRINTED, -L1_PRINTED], [value_at(at) for at in INSTANTS], STATED),
    "4.6.stationary | The slope of S0 vanishes at tau = T/2: an inner extremum.",
    lambda: Equation(sp.Integer(0), sp.diff(polynomial(*coefficients()), tau).subs(tau, T / 2), STATED),
    "4.6.same-instants | The contacts (4.6) serve y1 as well: its dual is that of y3 with the other sign (y2 and "
    "y3: 4.13).",
    lambda: optimum(0, tuple(-alternating()), INSTANTS, weights(0), sp.Integer(1)),
    "4.6.weights | Of the weights at (4.6) one is not zero for y1, all three for y2 and y3, as (4.12) prints.",
    lambda: Property(
        printed=(1, 3, 3),
        derived=instants_in_use(),
        meaning=tuple(
            state(to_text(w), sign, "0", RANGE)
            for index, signs in enumerate(("==>", "<><", "<><"))
            for w, sign in zip(weights(index), signs, strict=True)
        ),
    ),
)


# -- (4.7) to (4.9) ---------------------------------------


@claim("4.7 | Three impulses at 0, T/2, T with the weights of (4.12) are optimal for y3.")
def three_impulses_solve_the_problem():
    sine = sp.sin(T / 4) ** 2
    printed = (-1 / (4 * sine), sp.cos(T / 2) / (2 * sine), (1 - 2 * sp.cos(T / 2)) / (4 * sine))
    x = alternating()
    return optimum(2, tuple(x), INSTANTS, printed, x[2])


def optimal_deviation(state: int) -> sp.Expr:
    """1 / sum |Phi_j| for y1 or y2: the deviation that (3.6) assigns to the optimal weights."""
    if state == 0:
        return 1 / sum((w for w in weights(0)), sp.Integer(0))  # one weight, equal to one
    first, middle, last = weights(state)
    return 1 / (-first + middle - last)  # signs -, +, - on the stated range


CLAIMS_4_8 = claims(
    "4.8.L2 | L2 = |u2|/L1 (true because both are equal).",
    lambda: Equation(-coefficients()[0] / deviation(), optimal_deviation(0), STATED),
    "4.8.L3 | L3 = |u3|/L1, as printed. | undecidable: the exponent -1 of L_s is lost: (3.4) gives 1/L_s = "
    "|u_s|/L1, and (4.9) was computed from that",
    lambda: Equation(coefficients()[1] / deviation(), optimal_deviation(1), STATED),
    "4.8.L3* | L3 = L1/|u3|.",
    lambda: Equation(deviation() / coefficients()[1], optimal_deviation(1), STATED),
)


@claim("4.8.signs")
def signs_of_the_weights():
    """The weights of y2 alternate -, +, - on the stated range, so that 1/L3 is -Phi_21 + Phi_22 - Phi_23."""
    found = tuple(proved_sign(weight) for weight in weights(1))
    meaning = tuple(state(to_text(weight), sign, "0", RANGE) for weight, sign in zip(weights(1), "<><", strict=True))
    return fact((-1, 1, -1), found, "signs of the product forms", PROVED, scope="T in (0, pi/2]", meaning=meaning)


def proved_sign(weight: sp.Expr) -> int:
    """+1 or -1 when that sign is proved on the stated range, otherwise 0."""
    for sign in (1, -1):
        if prove_sign(sign * weight, STATED, Sign.POSITIVE).at_least(Sign.POSITIVE):
            return sign
    return 0


CLAIMS_4_9 = claims(
    "4.9.L2 | The second deviation L2 is 1.",
    lambda: Equation(sp.Integer(1), optimal_deviation(0), STATED),
    "4.9.L3 | The third deviation L3 is tan(T/4)/2.",
    lambda: Equation(sp.tan(T / 4) / 2, optimal_deviation(1), STATED),
)
