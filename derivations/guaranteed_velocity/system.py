"""Section 1: error equations of the two channels, the measurement, H(tau)."""

import sympy as sp

from navsym.claims import Bound, Equation, claim, claims
from navsym.models.linear import LinearModel, observability_matrix
from navsym.models.transition.exponential import regressors, transition_matrix
from navsym.prove.identities import vanishes_identically
from navsym_papers.guaranteed_velocity.model import CHANNEL, H, T, tau

lam = sp.Symbol("lambda", real=True)

alpha, velocity, bias, drift, azimuth = sp.symbols("alpha pi_ epsilon nu beta3", real=True)
earth_rate = sp.Symbol("U", positive=True)
g, a0, omega0 = sp.symbols("g a0 omega0", positive=True)
PRINTED_A = sp.Matrix([[0, -1, 0], [0, 0, 1], [0, -1, 0]])


def channel_rates(with_azimuth: bool) -> sp.Matrix:
    """Rates of y from the horizontal channel of an INS in dimensionless form.

    d(dV)/dt = -g (alpha - epsilon), d(alpha)/dt = dV/a0 + nu; with dV = pi omega0 a0,
    tau = omega0 t and omega0**2 = g/a0. Newtonmeter bias, drift and azimuth error are constant.
    """
    pi_rate = -g * (alpha - bias) / (omega0**2 * a0)
    alpha_rate = (velocity * omega0 * a0 / a0 + drift * omega0) / omega0
    pi_rate, alpha_rate = (rate.subs(g, omega0**2 * a0) for rate in (pi_rate, alpha_rate))
    azimuth_rate = sp.Integer(0)
    first = pi_rate + (earth_rate * azimuth_rate if with_azimuth else 0)
    return sp.Matrix([first, alpha_rate, pi_rate])


CLAIMS_1_1 = claims(
    "1.1 | With constant beta3, eps1, nu1: dy/dtau = A y in y1 = pi1 + U beta3, y2 = alpha1 - eps1, y3 = pi1 + nu1.",
    lambda: Equation(
        PRINTED_A * sp.Matrix([velocity + earth_rate * azimuth, alpha - bias, velocity + drift]),
        channel_rates(with_azimuth=True),
    ),
    "1.2 | With constant eps2 and nu2: the same equations in y4 = pi2, y5 = alpha2 - eps2, y6 = pi2 + nu2.",
    lambda: Equation(
        PRINTED_A * sp.Matrix([velocity, alpha - bias, velocity + drift]), channel_rates(with_azimuth=False)
    ),
)


@claim("1.3 | The matrix A, read off the rates of the three variables.")
def system_matrix():
    y = sp.Matrix([velocity, alpha - bias, velocity + drift])
    y1, y2, y3 = sp.symbols("y1 y2 y3", real=True)
    back = {velocity: y1, alpha: y2 + bias, drift: y3 - y1}
    assert all(vanishes_identically(e.subs(back) - v) for e, v in zip(y, (y1, y2, y3), strict=True))
    return Equation(PRINTED_A, channel_rates(False).subs(back).jacobian([y1, y2, y3]))


@claim("4.2.identity-of-channels")
def channels_share_the_regressors():
    """H(tau) of the longitudinal channel, derived from its own rates and z2 = y4 + w2, is that of the lateral one."""
    y4, y5, y6 = sp.symbols("y4 y5 y6", real=True)
    rates = channel_rates(False).subs({velocity: y4, alpha: y5 + bias, drift: y6 - y4})
    second = LinearModel(
        F=rates.jacobian([y4, y5, y6]).tolist(), H=[[1, 0, 0]], states=("y4", "y5", "y6"), measurements=("velocity",)
    )
    at_rest = rates.subs({y4: 0, y5: 0, y6: 0})  # of the constant errors nothing is left beside y
    return Equation((*H(), 0, 0, 0), (*regressors(second, T, tau).matrix, *at_rest))


QUARTER_PERIOD = (sp.pi / 2 * sp.sqrt(sp.Rational(6371000) / sp.Rational("9.81"))) / 60  # minutes


def second_measurement():
    """z2 - w2 by (1.7): H(tau)* q_II at tau = T, where q_II holds the states of the second channel."""
    return (H().subs(tau, T).T * sp.Matrix(sp.symbols("y4 y5 y6", real=True)))[0]


CLAIMS_1_3 = claims(
    "1.3.spectrum | A has the eigenvalues 0 and +-i: dimensionless time makes the Schuler frequency one.",
    lambda: Equation(lam * (lam**2 + 1), (lam * sp.eye(3) - sp.Matrix(CHANNEL.F)).det()),
    "1.quarter-period | T = pi/2 is about 20 minutes (the printed figure is read to ten minutes). | CERTIFIED",
    lambda: Equation(sp.Integer(20), QUARTER_PERIOD, tolerance=sp.Integer(5)),
    "1.quarter-period.minute | T = pi/2 is 21 minutes to the minute; the printed 20 stands behind a sign of "
    "approximation. | CERTIFIED",
    lambda: Equation(sp.Integer(21), QUARTER_PERIOD, tolerance=sp.Rational(1, 2)),
    "1.4.z2 | The measurement of the second channel, z2 - w2 = y2, as printed. | undecidable: y2 is the tilt of "
    "the other channel: z2 measures y4 = pi_2, as (1.7) and (4.16), y4 = z2(T), have it",
    lambda: Equation(sp.Symbol("y2", real=True), second_measurement()),
    "1.4.z2* | The measurement of the second channel picks its first state: z2 - w2 = y4.",
    lambda: Equation(sp.Symbol("y4", real=True), second_measurement()),
)


@claim("1.7 | z(tau) - w(tau) = H(tau)* q with q = y(T), for every solution of the system.")
def measurement_at_the_end():
    y0 = sp.Matrix(sp.symbols("y10 y20 y30", real=True))
    return Equation(
        (H().T * (transition_matrix(CHANNEL.F, T).matrix * y0))[0],
        (sp.Matrix(CHANNEL.H) * (transition_matrix(CHANNEL.F, tau).matrix * y0))[0],
    )


CLAIMS_1_8 = claims(
    "1.8 | exp(A*(tau - T)) h1, with the printed A, is H(tau): the measurement at tau in the state at T.",
    lambda: Equation(list(transition_matrix(PRINTED_A.T, tau - T).matrix * sp.Matrix([1, 0, 0])), list(H())),
    "1.9.H1 | First component of H(tau).",
    lambda: Equation(sp.Integer(1), H()[0]),
    "1.9.H2 | Second component of H(tau), as printed. | paper: with the A of (1.3) the sign is +; (4.2) and the "
    "matrix N of (4.11) use +sin(T - tau) as well",
    lambda: Equation(-sp.sin(T - tau), H()[1]),
    "1.9.H2* | Second component of H(tau).",
    lambda: Equation(sp.sin(T - tau), H()[1]),
    "1.9.H3 | Third component of H(tau).",
    lambda: Equation(sp.cos(T - tau) - 1, H()[2]),
    "1.9.root-cause | The printed (1.9) is exp(A*(T - tau)) h1: (1.8) with the other sign of its argument.",
    lambda: Equation(
        sp.Matrix([1, -sp.sin(T - tau), sp.cos(T - tau) - 1]),
        transition_matrix(sp.Matrix(CHANNEL.F).T, T - tau).matrix * sp.Matrix([1, 0, 0]),
    ),
    "1.observable | The pair (A, h1) is observable: h1, A* h1, A*^2 h1 are independent.",
    lambda: Bound(observability_matrix(CHANNEL).det(), "!=", 0),
)
