"""Section 3, gains in closed form, the coupled system, its exact range of stability, its true decay.

The paper chooses the gains "neglecting the links between the subsystems". Here the links are put
back: kappa = mu u_3 couples the two velocity channels, c = mu^2 omega_1 omega_2 the two position
channels.
"""

import sympy as sp
from flint import arb, ctx, fmpq, fmpq_poly

from navsym.claims import PROVED, Equation, claims, fact, state
from navsym_papers.joint_correction.inertial import EARTH, MU
from navsym_papers.joint_correction.matrices import exact_inverse, to_lowest_terms
from navsym_papers.joint_correction.section1_systems import coefficients_of_polynomial, p, polynomial_of
from navsym_papers.joint_correction.section2_groups import mu, position, velocity, w1, w2
from navsym_papers.joint_correction.section3_algorithm import joint_error_matrix
from navsym_papers.trajectory.hurwitz import say_signs

d = sp.Symbol("d", real=True)

lam, lam_h = sp.symbols("lambda_c lambda_h", positive=True)
kappa, omega = sp.symbols("kappa omega", real=True)

#: K_1, K_2, K_3 (and K_4, K_5, K_6) for (p + lambda_c)^3.
VELOCITY_GAINS = (1 - 3 * lam**2, 3 * lam - lam**3, lam**3)
#: Position gains that leave the small terms as they are, and none.
PLAIN, NO_POSITION = {1: 2 * lam_h, 2: lam_h**2, 5: 2 * lam_h, 6: lam_h**2}, dict.fromkeys((1, 2, 5, 6), sp.Integer(0))


def velocity_block(gains: tuple[sp.Expr, ...], channel: int = 0) -> sp.Matrix:
    """Errors of one channel of (3.2) with the link mu u_3 neglected."""
    F, H, _ = velocity().linear()
    places = range(3 * channel, 3 * channel + 3)
    return F.extract(places, places) - sp.Matrix(gains) * H.extract([channel], places).subs(EARTH[2], 0)


def position_block(gains: tuple[sp.Expr, sp.Expr], channel: int = 0) -> sp.Matrix:
    """Errors of one channel of (3.3) with the link to the other channel neglected."""
    F, H, _ = position().linear()
    places = [4 * channel, 4 * channel + 1]
    return F.extract(places, places) - sp.Matrix(gains) * H.extract([channel], places)


def velocity_gains_are_unique():
    K = sp.symbols("K1:4", real=True)
    values = sp.Matrix(coefficients_of_polynomial(velocity_block(K))[1:])
    slopes, wanted = values.jacobian(K), sp.Matrix([3 * lam, 3 * lam**2, lam**3])
    rest = slopes * sp.Matrix(VELOCITY_GAINS) + values.subs(dict.fromkeys(K, 0)) - wanted
    return Equation([sp.Integer(1), *[sp.Integer(0)] * 3], [slopes.det() ** 2, *rest.applyfunc(sp.expand)])


def position_gains_are_unique():
    K = sp.symbols("K1:3", real=True)
    return Equation(sp.Integer(1), sp.Matrix(coefficients_of_polynomial(position_block(K))[1:]).jacobian(K).det())


# The coupled velocity stage


def coupled_errors(Ky: dict[int, sp.Expr]) -> sp.Matrix:
    """All ten errors with the gains of 3.2.gains and position gains, kappa = mu u_3."""
    return joint_error_matrix((*VELOCITY_GAINS, *VELOCITY_GAINS), Ky).subs(EARTH[2], kappa / MU).applyfunc(sp.expand)


def coupled_velocity_block() -> sp.Matrix:
    """Errors of (3.2), all six, with kappa = mu u_3."""
    return coupled_errors(NO_POSITION)[:6, :6]


def link_polynomial(variable: sp.Expr) -> sp.Expr:
    """p ((1 - 3 lambda^2) p + 3 lambda - lambda^3): transfer of the innovation to x_1 times its denominator."""
    return variable * ((1 - 3 * lam**2) * variable + 3 * lam - lam**3)


def crossing() -> tuple[sp.Expr, sp.Expr]:
    """Real and imaginary part of (lambda + i omega)^3 + i kappa link(i omega) = 0.

    The polynomial of the six errors is the product of this factor and of the one with -kappa.
    """
    value = sp.expand((lam + sp.I * omega) ** 3 + sp.I * kappa * link_polynomial(sp.I * omega))
    real = sp.expand((value + sp.conjugate(value)) / 2)
    imaginary = sp.expand((value - sp.conjugate(value)) / (2 * sp.I))
    return real, imaginary


def coupled_polynomial_factors():
    first, second = (p + lam) ** 3, kappa * link_polynomial(p)
    product = sp.expand((first + sp.I * second) * (first - sp.I * second))
    return Equation(product, polynomial_of(coupled_velocity_block()))


def poles_cross_the_axis_at_one():
    real, imaginary = crossing()
    combination = real * omega * (1 - 3 * lam**2) - imaginary * (3 * lam - lam**3)
    return Equation([8 * lam**3 * omega * (omega**2 - 1), lam**3], [sp.expand(combination), real.subs(omega, 0)])


def poles_cross_at_kappa_one():
    # At omega = 1 (-1) both parts carry the factor 1 + kappa (1 - kappa); the other factors, 3 l - l^3 and 1 - 3 l^2,
    # have no common zero.
    real, imaginary = crossing()
    for side in (1, -1):
        factor = 1 + side * kappa
        yield (
            [-(3 * lam - lam**3) * factor, -side * (1 - 3 * lam**2) * factor],
            [real.subs(omega, side), imaginary.subs(omega, side)],
        )


#: Values of kappa inside and outside, and which of a0, D_1 ... D_5, a6 (Hurwitz) are negative there for lambda = 1.
REGIONS = ((sp.Integer(0), ()), (sp.Rational(1, 2), ()), (sp.Integer(2), (3, 4, 5)))


def coupled_system_is_stable_inside():
    # The gains are those of 3.2.gains. No pole meets the imaginary axis for kappa other than 1 and -1
    # (3.coupled.crossing), so the number of poles on the right is constant on {lambda > 0, |kappa| < 1} and on {kappa
    # > 1}; it is counted at one point of each. At kappa = 1 there is a pole on the axis.
    counts = tuple(poles_on_the_right(sp.Integer(1), value) for value, _ in REGIONS)
    rates = ", ".join(str(sp.Float(decay_rate(sp.Integer(1), value), 6)) for value, _ in REGIONS)
    return fact(
        (0, 0, 2, True),
        (*counts, sp.resultant(3 * lam - lam**3, 1 - 3 * lam**2, lam) != 0),
        "no crossing of the axis, balls around the poles at one point of every region",
        PROVED,
        scope="all lambda_c > 0, all real kappa",
        evidence=f"poles on the right at lambda = 1, kappa = 0, 1/2, 2: {counts}, decay rates {rates}; "
        "the parts have no common zero",
        unsaid="roots of a polynomial with free coefficients are counted by regions",
        meaning=[*say_no_common_zero(), *(part for value, turned in REGIONS for part in say_poles(value, turned))],
    )


def say_no_common_zero() -> list[dict]:
    """3 l - l^3 and 1 - 3 l^2 with cofactors whose sum of products is 1."""
    first, second = 3 * lam - lam**3, 1 - 3 * lam**2
    a, b, one = sp.gcdex(first, second, lam)
    text = f"({a / one})*({first}) + ({b / one})*({second})"
    return [state(text, "=", "1", {"lambda_c": [None, None, []]})]


def say_poles(kappa_value: sp.Expr, negative: tuple[int, ...]) -> list[dict]:
    """The polynomial of the six errors at lambda = 1, and the signs of Hurwitz's determinants, a few negative."""
    closed = (p + 1) ** 6 + kappa_value**2 * link_polynomial(p).subs(lam, 1) ** 2
    coefficients = [str(c) for c in errors_polynomial(sp.Integer(1), kappa_value).all_coeffs()]
    written = " + ".join(f"{c}*p**{6 - k}" if k < 6 else c for k, c in enumerate(coefficients))
    return [state(str(closed), "=", written, {"p": [None, None, []]}), *say_signs(coefficients, None, negative)]


def errors_polynomial(lambda_value: sp.Expr, kappa_value: sp.Expr) -> sp.Poly:
    """Characteristic polynomial of the coupled errors at a point."""
    return sp.Poly(polynomial_of(coupled_velocity_block().subs({lam: lambda_value, kappa: kappa_value})), p)


def poles(lambda_value: sp.Expr, kappa_value: sp.Expr) -> list[tuple[arb, int]]:
    """Real parts of the poles of the coupled errors, with multiplicities: balls of 200 bits around the exact roots."""
    coefficients = errors_polynomial(lambda_value, kappa_value).all_coeffs()[::-1]
    with ctx.workprec(200):
        found = fmpq_poly([fmpq(int(c.p), int(c.q)) for c in coefficients]).complex_roots()
        return [(root.real, count) for root, count in found]


def poles_on_the_right(lambda_value: sp.Expr, kappa_value: sp.Expr) -> int:
    """How many poles of the coupled errors lie right of the imaginary axis; none may lie on it."""
    found = poles(lambda_value, kappa_value)
    if not all(real > 0 or real < 0 for real, _ in found):
        raise ArithmeticError("a ball meets the imaginary axis here; choose another point")
    return sum(count for real, count in found if real > 0)


def decay_rate(lambda_value: sp.Rational, kappa_value: sp.Rational) -> sp.Rational:
    """Decay rate, minus the largest real part of the poles: 20 digits of its ball."""
    largest = max((real for real, _ in poles(lambda_value, kappa_value)), key=lambda ball: float(ball.mid()))
    return -sp.Rational(largest.mid().str(20, radius=False))


def link_removed_by_the_split():
    # The gains are L^-1 L_0 K, with L of the chains and L_0 = L at kappa = 0. In chain coordinates the errors have
    # then the same matrix for every kappa, and at kappa = 0 it has the polynomial (p + lambda_c)^6.
    F, H, _ = velocity().linear()
    H = H.subs(EARTH[2], kappa / MU)
    L = sp.ImmutableMatrix.vstack(*(H[row, :] * F**power for row in (0, 1) for power in (0, 1, 2)))
    L_0 = L.subs(kappa, 0)
    back, back_0 = exact_inverse("L", L), exact_inverse("L_0", L_0)
    K = sp.zeros(6, 2)
    K[:3, 0] = K[3:, 1] = sp.Matrix(VELOCITY_GAINS)
    free = F - K * H.subs(kappa, 0)
    repaired = L * (F - to_lowest_terms(back * L_0 * K) * H) * back
    return Equation(
        [(p + lam) ** 6, *(L_0 * free * back_0)],
        [polynomial_of(free), *to_lowest_terms(sp.Matrix(repaired))],
        nonzero=(1 - kappa**2,),
    )


# The coupled position stage


def coupled_position_block(second: tuple[sp.Expr, sp.Expr]) -> sp.Matrix:
    gains = {1: 2 * lam_h, 2: second[0], 5: 2 * lam_h, 6: second[1]}
    return joint_error_matrix(Ky=gains)[6:, 6:]


# What the inhomogeneous terms do


def steady_error_of_the_velocity_stage():
    d2, d3 = sp.symbols("d_2 d_3", real=True)
    steady = sp.Matrix([d2 + d3 - 3 * d3 / lam**2, (1 - 3 * lam**2) * d3 / lam**3, 3 * d3 / lam])
    return Equation([sp.Integer(0), -d2, -d3], list(velocity_block(VELOCITY_GAINS) * steady))


# Pre-estimation and the situations of the last paragraph


def preestimation_frees_the_position_stage():
    t = sp.Symbol("t", positive=True)
    start = sp.Matrix(sp.symbols("e_1 e_2", real=True))
    A = position_block((2 * lam_h, lam_h**2 - mu**2 * w2**2))
    solution = sp.exp(-lam_h * t) * (sp.eye(2) + t * (A + lam_h * sp.eye(2))) * start
    return Equation(solution.diff(t), A * solution)


def transient_driven_by_the_velocity_stage():
    A = position_block((2 * lam_h, lam_h**2 - mu**2 * w2**2))
    return Equation(
        [sp.Integer(-1), (p + lam_h) ** 2],
        [((p * sp.eye(2) - A).adjugate() * sp.Matrix([0, -1]))[0], (p * sp.eye(2) - A).det()],
    )


def position_only_block(gains: tuple[sp.Expr, ...]) -> sp.Matrix:
    """Errors of y_1, y_2, x_1, x_2 with all four corrected by sigma_1^M; mu^2 neglected."""
    F, H, _ = position().linear()
    return F.extract(range(4), range(4)).subs(MU, 0) - sp.Matrix(gains) * H.extract([0], range(4))


def velocity_after_a_position_session():
    # Their rates start with -K_1 d and -K_2 d; all three errors then decay as exp(-lambda_c t) times a polynomial.
    t, d = sp.Symbol("t", positive=True), sp.Symbol("d", real=True)
    A, start = velocity_block(VELOCITY_GAINS), sp.Matrix([0, 0, d])
    shifted = A + lam * sp.eye(3)
    solution = sp.exp(-lam * t) * (sp.eye(3) + t * shifted + t**2 * shifted**2 / 2) * start
    first = [-VELOCITY_GAINS[0] * d, -VELOCITY_GAINS[1] * d]
    return Equation([*solution.diff(t), *start, *first], [*(A * solution), *solution.subs(t, 0), *(A * start)[:2]])


CLAIMS = claims(
    "3.2.gains | Gains 1 - 3 l^2, 3 l - l^3, l^3 with l = lambda_c give (p + lambda_c)^3 in both channels.",
    lambda: Equation(
        [(p + lam) ** 3] * 2, [polynomial_of(velocity_block(VELOCITY_GAINS, channel)) for channel in (0, 1)]
    ),
    "3.2.gains_unique | These gains are the only ones: the coefficients are affine in K with determinant 1 or -1.",
    velocity_gains_are_unique,
    # K_6^h has omega_1 in the place of omega_2.
    "3.3.gains | K_1^h = 2 lambda_h and K_2^h = lambda_h^2 - mu^2 omega_2^2 give (p + lambda_h)^2 exactly.",
    lambda: Equation(
        [(p + lam_h) ** 2] * 2,
        [
            polynomial_of(position_block((2 * lam_h, lam_h**2 - mu**2 * w**2), channel))
            for channel, w in ((0, w2), (1, w1))
        ],
    ),
    "3.3.gains_unique | The matrix of the affine map from K^h to the coefficients has determinant 1: no other "
    "gains do it.",
    position_gains_are_unique,
    # kappa = mu u_3 and l = lambda_c.
    "3.coupled.characteristic | With the link the six errors have (p + l)^6 + kappa^2 p^2 ((1 - 3 l^2) p + 3 l - "
    "l^3)^2.",
    lambda: Equation((p + lam) ** 6 + kappa**2 * link_polynomial(p) ** 2, polynomial_of(coupled_velocity_block())),
    "3.coupled.without_link | Without the link, kappa = 0, the six errors have (p + lambda_c)^6, as the choice of "
    "gains intends.",
    lambda: Equation((p + lam) ** 6, polynomial_of(coupled_velocity_block().subs(kappa, 0))),
    "3.coupled.factors | The polynomial of the six errors is ((p + l)^3)^2 + (kappa link)^2, l = lambda_c, and so "
    "factors over i.",
    coupled_polynomial_factors,
    "3.coupled.crossing | A pole i omega on the axis has omega = 1 or -1: 8 lambda_c^3 omega (omega^2 - 1) = 0, "
    "and 0 is no pole.",
    poles_cross_the_axis_at_one,
    "3.coupled.crossing_value | A pole on the imaginary axis needs kappa = 1 or -1.",
    poles_cross_at_kappa_one,
    "3.coupled.stable | The errors of (3.2) decay for every lambda_c > 0 exactly when |mu u_3| < 1.",
    coupled_system_is_stable_inside,
    "3.coupled.decay | lambda_c = 1, mu u_3 = 1/20 (latitude near 58 degrees): the true decay rate is 0.577 "
    "instead of 1. | CERTIFIED",
    lambda: Equation(
        sp.Rational(577, 1000), decay_rate(sp.Integer(1), sp.Rational(1, 20)), tolerance=sp.Rational(1, 2000)
    ),
    # To leading order, l = lambda_c; this is minus the link polynomial at p = -l, times i kappa.
    "3.coupled.small_link | For a small link the six poles leave -lambda_c by the cube roots of 2 i kappa l^2 (1 + "
    "l^2) and of its negative.",
    lambda: Equation(-2 * lam**2 * (1 + lam**2), sp.expand(link_polynomial(p).subs(p, -lam))),
    "3.coupled.repaired | The two-stage split of section 1 removes the link: (p + lambda_c)^6 for every kappa^2 != 1.",
    link_removed_by_the_split,
    # Stable only for l = lambda_h > mu |omega_1 omega_2|^(1/2); the decay rate is
    # lambda_h - mu |omega_1 omega_2|^(1/2).
    "3.coupled.position | With gains that cancel mu^2 omega^2 the link leaves (p + l)^4 - mu^4 omega_1^2 omega_2^2.",
    lambda: Equation(
        (p + lam_h) ** 4 - mu**4 * w1**2 * w2**2,
        polynomial_of(coupled_position_block((lam_h**2 - mu**2 * w2**2, lam_h**2 - mu**2 * w1**2))),
    ),
    # Its polynomial is (p + lambda_h)^2 ((p + lambda_h)^2 + mu^2 (omega_1^2 + omega_2^2)): always stable.
    "3.coupled.position_plain | With K_2^h = K_6^h = lambda_h^2 the coupled position stage decays with lambda_h "
    "exactly.",
    lambda: Equation(
        (p + lam_h) ** 2 * ((p + lam_h) ** 2 + mu**2 * (w1**2 + w2**2)),
        polynomial_of(coupled_position_block((lam_h**2, lam_h**2))),
    ),
    "3.coupled.whole | The ten errors have the product of the polynomials of both stages.",
    lambda: Equation(
        ((p + lam) ** 6 + kappa**2 * link_polynomial(p) ** 2)
        * ((p + lam_h) ** 2 * ((p + lam_h) ** 2 + mu**2 * (w1**2 + w2**2))),
        polynomial_of(coupled_errors(PLAIN)),
    ),
    "3.bias.velocity | Constant d_2 in x_2', d_3 in x_3' leave d_2 + d_3 - 3 d_3/l^2, (1 - 3 l^2) d_3/l^3, 3 d_3/l "
    "(l = lambda_c).",
    steady_error_of_the_velocity_stage,
    # d gathers the steady error of x_1° and the terms left out.
    "3.bias.position | A constant drive -d of y_2' leaves Delta y_1 = -d/lambda_h^2, Delta y_2 = -2 d/lambda_h.",
    lambda: Equation(
        [sp.Integer(0), sp.Symbol("d", real=True)],
        list(
            position_block((2 * lam_h, lam_h**2 - mu**2 * w2**2))
            * sp.Matrix([-sp.Symbol("d", real=True) / lam_h**2, -2 * sp.Symbol("d", real=True) / lam_h])
        ),
    ),
    "3.preestimation.exact | With exact x_1° the errors of y_1, y_2 obey (p + lambda_h)^2 alone: two variables "
    "instead of four.",
    preestimation_frees_the_position_stage,
    "3.preestimation.transient | Without it an error of the velocity stage drives y: Delta y_1 is -1/(p + "
    "lambda_h)^2 of Delta x_1.",
    transient_driven_by_the_velocity_stage,
    # They are 4 l, 6 l^2 - 1, 4 l - 4 l^3, 6 l^2 - l^4 - 1 with l = lambda_h.
    "3.situations.position_only | Only position, mu^2 left out: four gains in closed form give (p + lambda_h)^4 on "
    "y_1, y_2, x_1, x_2.",
    lambda: Equation(
        (p + lam_h) ** 4,
        polynomial_of(
            position_only_block((4 * lam_h, 6 * lam_h**2 - 1, 4 * lam_h - 4 * lam_h**3, 6 * lam_h**2 - lam_h**4 - 1))
        ),
    ),
    "3.situations.zeroing | Only position with K^c = 0: the polynomial keeps the factor p^2 (p^2 + 1)^2, the "
    "Schuler errors are undamped.",
    lambda: Equation(
        p**2 * (p**2 + 1) ** 2 * ((p + lam_h) ** 2 * ((p + lam_h) ** 2 + mu**2 * (w1**2 + w2**2))),
        polynomial_of(joint_error_matrix((sp.Integer(0),) * 6, PLAIN)),
    ),
    "3.situations.neither | Neither information: all gains are zero and the estimates are carried along.",
    lambda: Equation(
        p**4 * (p**2 + 1) ** 2 * (p**2 + mu**2 * (w1**2 + w2**2)),
        polynomial_of(joint_error_matrix((sp.Integer(0),) * 6, NO_POSITION)),
    ),
    "3.situations.velocity_after_joint | Only velocity after a joint session (K^h = 0): x keeps its poles, y is "
    "carried along undamped.",
    lambda: Equation(
        ((p + lam) ** 6 + kappa**2 * link_polynomial(p) ** 2) * p**2 * (p**2 + mu**2 * (w1**2 + w2**2)),
        polynomial_of(coupled_errors(NO_POSITION)),
    ),
    "3.situations.velocity_after_position | Only velocity after position alone: x_1 and x_2 are known, and the "
    "unknown d of x_3 disturbs them at first.",
    velocity_after_a_position_session,
)
