"""(4.10) to (4.16): weights, guaranteed errors and estimates, in both channels."""

import sympy as sp

from navsym.claims import Bound, Claim, Equation, claim, claims
from navsym_papers.guaranteed_velocity import model
from navsym_papers.guaranteed_velocity.model import INSTANTS, STATED, N, T, alternating, optimum, sigma2, weights

# -- (4.10), (4.11) ---------------------------------------


PRINTED_N = sp.Matrix([[1, 1, 0], [sp.sin(T), sp.sin(T / 2), 0], [sp.cos(T) - 1, sp.cos(T / 2) - 1, 0]])


CLAIMS_4_11 = claims(
    "4.11.N | The matrix N, as printed. | undecidable: entry (1, 3): H(T) = (1, 0, 0); a zero column would make "
    "det N zero, and the printed one is right",
    lambda: Equation(PRINTED_N, N()),
    "4.11.N* | The matrix N with the last column (1, 0, 0).",
    lambda: Equation(PRINTED_N + sp.Matrix([[0, 0, 1], [0, 0, 0], [0, 0, 0]]), N()),
    "4.11.det | det N = 4 sin(T/2) sin^2(T/4).",
    lambda: Equation(4 * sp.sin(T / 2) * sp.sin(T / 4) ** 2, N().det()),
    "4.11.nonzero | det N is not zero for 0 < T <= pi/2.",
    lambda: Bound(N().det(), "!=", 0, STATED),
    "4.11.nonzero-beyond | det N is not zero for 0 < T <= 6, far beyond the stated range.",
    lambda: Bound(N().det(), "!=", 0, {T: (0, 6)}),
)


# -- (4.12) ---------------------------------------

SINE = sp.sin(T / 4) ** 2
PRINTED_WEIGHTS = (
    (sp.Integer(0), sp.Integer(0), sp.Integer(1)),
    (-1 / (2 * sp.sin(T / 2)), sp.cot(T / 4), -sp.sin(3 * T / 4) / (2 * sp.sin(T / 2) * sp.sin(T / 4))),
    (-1 / (4 * SINE), sp.cos(T / 2) / (2 * SINE), (1 - 2 * sp.cos(T / 2)) / (4 * SINE)),
)


CLAIMS_4_10 = claims(
    "4.10 | Phi_s = N^-1 e_s: with the printed weights (4.12) as columns of Phi, N Phi is the identity.",
    lambda: Equation(sp.eye(3), N() * sp.Matrix(PRINTED_WEIGHTS).T, STATED),
)


WEIGHTS = tuple(
    claim(
        f"4.12.Phi{s + 1}{j + 1} | Weight Phi_{s + 1}{j + 1} of the estimate of y{s + 1}.",
        derive=lambda s=s, j=j: Equation(PRINTED_WEIGHTS[s][j], weights(s)[j], STATED),
    )
    for s in range(3)
    for j in range(3)
)


# -- (4.13), (4.15): guaranteed errors ---------------------------------------

PRINTED_ERRORS = (sp.Integer(1), 2 * sp.cot(T / 4), sp.cos(T / 2) / SINE)


def dual_of(state: int) -> tuple[sp.Expr, ...]:
    """An optimal dual: (1, 0, 0) for y1, the alternating polynomial for y2 and y3."""
    return (sp.Integer(1), sp.Integer(0), sp.Integer(0)) if state == 0 else tuple(alternating())


def errors_with_sigma(sigma: sp.Symbol) -> Equation:
    """The printed errors with their factor sigma, against the objective of (2.7): sigma times sum |Phi_j|.

    The weights of y2 and y3 have the signs -, +, - on the stated range (4.8.signs); y1 has one weight.
    """
    signs = ((1, 1, 1), (-1, 1, -1), (-1, 1, -1))
    totals = [sum(sign * w for sign, w in zip(signs[s], weights(s), strict=True)) for s in range(3)]
    return Equation([error * sigma for error in PRINTED_ERRORS], [sigma * total for total in totals], STATED)


#: The printed error (for sigma = 1) is the optimum of (2.7), proved by weights and dual.
OPTIMAL_ERRORS = tuple(
    claim(
        f"4.13.y{s + 1} | Guaranteed error of y{s + 1}: optimal among all linear unbiased estimates.",
        derive=lambda s=s: optimum(s, dual_of(s), INSTANTS, weights(s), PRINTED_ERRORS[s]),
    )
    for s in range(3)
)


CLAIMS_4_13 = claims(
    "4.13.sigma | d_opt of y1, y2, y3 is sigma1 times the sum of the moduli of its weights.",
    lambda: errors_with_sigma(model.sigma1),
    "4.15 | d_opt of y4, y5, y6 is sigma2 times the sum of the moduli of the same weights.",
    lambda: errors_with_sigma(sigma2),
)


# -- (4.14), (4.16): estimates ---------------------------------------

z0, zm, zT = sp.symbols("z0 zm zT", real=True)


def derived_estimate(state: int) -> sp.Expr:
    """sum Phi_j z(tau_j) with the derived weights."""
    return sum((w * z for w, z in zip(weights(state), (z0, zm, zT), strict=True)), sp.Integer(0))


def estimate_of_tilt(first: sp.Expr) -> sp.Expr:
    """The printed estimate of y2 (y5) with a given first coefficient."""
    last = sp.sin(3 * T / 4) / (2 * sp.sin(T / 2) * sp.sin(T / 4))
    return -first * z0 + sp.cot(T / 4) * zm - last * zT


PRINTED_FIRST = 1 / (2 * sp.sin(T / 2) ** 2)
TRUE_FIRST = 1 / (2 * sp.sin(T / 2))
PRINTED_DRIFT = (-z0 + 2 * sp.cos(T / 2) * zm + (1 - 2 * sp.cos(T / 2)) * zT) / (4 * SINE)


def estimates(equation: str, velocity: int, tilt: int) -> tuple[Claim, ...]:
    """The estimates of velocity and tilt of one channel, the second as printed and as it should read."""
    return claims(
        f"{equation}.y{velocity} | The estimate of y{velocity} is the last measurement.",
        lambda: Equation(zT, derived_estimate(0), STATED),
        f"{equation}.y{tilt} | The estimate of y{tilt}, as printed. | paper: sin^2(T/2) stands for sin(T/2): Phi_21 of "
        "(4.12) is right, and the estimate as printed is biased",
        lambda: Equation(estimate_of_tilt(PRINTED_FIRST), derived_estimate(1), STATED),
        f"{equation}.y{tilt}* | The estimate of y{tilt} with the first coefficient -1/(2 sin(T/2)).",
        lambda: Equation(estimate_of_tilt(TRUE_FIRST), derived_estimate(1), STATED),
    )


lateral_estimates = estimates("4.14", 1, 2)


CLAIMS_4_14 = claims("4.14.y3 | The estimate of y3.", lambda: Equation(PRINTED_DRIFT, derived_estimate(2), STATED))


longitudinal_estimates = estimates("4.16", 4, 5)


def bias_of_printed_tilt(state: int) -> sp.Expr:
    """Coefficient of y_state in the printed estimate of y2 when nothing is noisy."""
    vector = [model.H(at)[state] for at in INSTANTS]
    return estimate_of_tilt(PRINTED_FIRST).subs(dict(zip((z0, zm, zT), vector, strict=True)), simultaneous=True)


CLAIMS_4_16 = claims(
    "4.16.y6 | The estimate of y6 with the brackets as they stand. | undecidable: (4.14) has the bracket that is "
    "missing here after 2 cos(T/2): read as it stands, 1 is not multiplied by z",
    lambda: Equation(
        (-z0 + 2 * sp.cos(T / 2) * zm + (1 - 2 * sp.cos(T / 2) * zT)) / (4 * SINE), derived_estimate(2), STATED
    ),
    "4.16.y6* | The estimate of y6 with the bracket closed before the measurement.",
    lambda: Equation(PRINTED_DRIFT, derived_estimate(2), STATED),
    "4.14.y2.bias | What the slip costs: a velocity error y1 enters the printed estimate of y2 with this factor.",
    lambda: Equation((sp.sin(T / 2) - 1) / (2 * sp.sin(T / 2) ** 2), bias_of_printed_tilt(0), STATED),
)


@claim("4.scale")
def dimensional_variables():
    """In dimensional variables the estimates of y1 and y3 and every error are multiplied by the scale factor.

    The functional k e_s has the weights ``N^-1 (k e_s)`` and the value ``x . (k e_s)`` of the same dual.
    """
    k, readings = sp.Symbol("k", positive=True), sp.Matrix([z0, zm, zT])
    scaled = [sp.Matrix(3, 1, lambda i, _, s=s: k * int(i == s)) for s in range(3)]
    estimates = [(N().adjugate() * scaled[s] / N().det()).dot(readings) for s in (0, 2)]
    errors = [sp.Matrix(dual_of(s)).dot(scaled[s]) for s in range(3)]
    printed = (k * zT, k * PRINTED_DRIFT, *(k * error for error in PRINTED_ERRORS))
    return Equation(printed, (*estimates, *errors), STATED)
