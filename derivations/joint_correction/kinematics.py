"""Error equations of a two-channel inertial system, from the kinematics of small rotations.

Three frames at the vehicle M: the ideal frame Mx with the vertical as third axis, the platform
Mz, and the frame Mu that the computer believes in. Small rotations: alpha turns Mx into Mz, beta
turns Mu into Mz, gamma = alpha - beta turns Mx into Mu. The frame Mx is free in azimuth: its
absolute angular rate is (omega_x1, omega_x2, 0). The Earth is a sphere of attraction with the
Schuler frequency omega_0, the height is known. Nothing here is copied from the paper: Poisson's
equation is linearised, Newton's equation is solved for the derivatives of the rate.

Kalenova, Morozov, Parusnikov, Shakot'ko 1979, section 2, states the results (2.1)-(2.5).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

#: Scale of everything small; results are coefficients of its first power.
SMALL = sp.Symbol("small", real=True)

RADIUS, CLIMB, SCHULER = sp.symbols("R climb omega_0", positive=True)
OMEGA_X = sp.Matrix([*sp.symbols("omega_x1 omega_x2", real=True), 0])
OMEGA_X_RATE = sp.Matrix([*sp.symbols("domega_x1 domega_x2", real=True), 0])
EARTH_X = sp.Matrix(sp.symbols("u_x1:4", real=True))
ALPHA = sp.Matrix(sp.symbols("alpha_1:4", real=True))
BETA = sp.Matrix(sp.symbols("beta_1:4", real=True))
DELTA_P = sp.Matrix([*sp.symbols("dp_1 dp_2", real=True)])
NU_X = sp.Matrix(sp.symbols("nu_x1:4", real=True))
EPSILON = sp.Matrix(sp.symbols("epsilon_1 epsilon_2", real=True))
W_C = sp.Matrix(sp.symbols("w_xc1 w_xc2", real=True))
W_M = sp.Matrix(sp.symbols("w_M1 w_M2", real=True))


def unskew(matrix: sp.Matrix) -> sp.Matrix:
    """The vector of a skew matrix; ArithmeticError when the matrix is not skew."""
    if any(sp.expand(x) != 0 for x in matrix + matrix.T):
        raise ArithmeticError("the matrix is not skew")
    return sp.Matrix([matrix[2, 1], matrix[0, 2], matrix[1, 0]]).applyfunc(sp.expand)


def first_order(value: sp.Matrix) -> sp.Matrix:
    """Coefficient of the first power of SMALL."""
    return value.applyfunc(lambda x: sp.expand(sp.diff(sp.expand(x), SMALL).subs(SMALL, 0)))


def rotation_rate(theta: sp.Matrix, excess: sp.Matrix, rate: sp.Matrix) -> sp.Matrix:
    """Derivative of the small rotation theta of a turned frame against a base frame.

    The base frame has the absolute rate ``rate`` in its own axes, the turned frame ``rate + excess``
    in its own. C = E - [theta x] takes components from base to turned axes and obeys Poisson's
    equation C' = C [rate x] - [(rate + excess) x] C; the terms of first order are
    theta' = excess + theta x rate.
    """
    C = sp.eye(3) - SMALL * theta.hat()
    right = C * rate.hat() - (rate + SMALL * excess).hat() * C
    return unskew(-first_order(right))


def specific_force(rate: sp.Matrix, rate_derivative: sp.Matrix, climb: sp.Expr = sp.S.Zero) -> sp.Matrix:
    """f = dV/dt - g in the axes of a frame whose third axis carries the position ``R e3``.

    V = R' + rate x R; the attraction is ``-omega_0^2 R`` and the climb R' is constant.
    """
    position, velocity_up = sp.Matrix([0, 0, RADIUS]), sp.Matrix([0, 0, climb])
    velocity = velocity_up + rate.cross(position)
    inside = rate_derivative.cross(position) + rate.cross(velocity_up)
    return (inside + rate.cross(velocity) + SCHULER**2 * position).applyfunc(sp.expand)


def mechanisation(force: sp.Matrix, rate: sp.Matrix, climb: sp.Expr = sp.S.Zero) -> sp.Matrix:
    """The rates that a computer integrates: :func:`specific_force` solved for omega_1', omega_2'."""
    return sp.Matrix([-(force[1] + 2 * climb * rate[0]) / RADIUS, (force[0] - 2 * climb * rate[1]) / RADIUS])


@dataclass(frozen=True, slots=True, eq=False)
class ErrorEquations:
    """Linear error equations with all their terms.

    rates    : derivative of every error variable (and of the Earth rate in the axes Mx)
    velocity : sigma^c, inertial minus measured relative velocity, as angular rates
    position : sigma^M, error of the computed vertical minus that of the measured one
    """

    rates: Mapping[sp.Symbol, sp.Expr]
    velocity: tuple[sp.Expr, sp.Expr]
    position: tuple[sp.Expr, sp.Expr]


def horizontal(v: sp.Matrix) -> sp.Matrix:
    """The first two components."""
    return v[:2, :]


def error_equations(climb: sp.Expr = sp.S.Zero) -> ErrorEquations:
    """Exact first-order error equations, in physical units.

    The gyroscopes give the platform rate with the error nu, the accelerometers the force with the
    error R omega_0^2 epsilon; dp is defined by alpha' = dp + nu in the horizontal axes.
    """
    excess = DELTA_P - horizontal(ALPHA.cross(OMEGA_X))  # error of the computed rate, from dp
    computed = sp.Matrix([*excess, 0])  # the third computed rate is exactly 0
    alpha_rate = rotation_rate(ALPHA, computed + NU_X, OMEGA_X)
    beta_rate = rotation_rate(BETA, NU_X, OMEGA_X)
    rates = {
        **dict(zip(ALPHA[:2], alpha_rate[:2], strict=True)),
        **dict(zip(DELTA_P, momentum_rate(computed, alpha_rate, climb), strict=True)),
        **dict(zip(BETA, beta_rate, strict=True)),
        **dict(zip(EARTH_X, EARTH_X.cross(OMEGA_X).applyfunc(sp.expand), strict=True)),
    }
    gamma = ALPHA - BETA
    return ErrorEquations(
        rates={symbol: sp.expand(rate) for symbol, rate in rates.items()},
        velocity=velocity_information(computed, climb),
        position=(gamma[0] + W_M[0], gamma[1] + W_M[1]),
    )


def momentum_rate(computed: sp.Matrix, alpha_rate: sp.Matrix, climb: sp.Expr) -> sp.Matrix:
    """Derivative of dp = (error of the computed rate + alpha x omega), horizontal part."""
    force = specific_force(OMEGA_X, OMEGA_X_RATE, climb)
    error = sp.Matrix([*EPSILON, 0]) * RADIUS * SCHULER**2
    measured = force + SMALL * (error - ALPHA.cross(force))  # axes of the platform
    rate = OMEGA_X + SMALL * computed
    excess_rate = first_order(mechanisation(measured, rate, climb))
    turning = alpha_rate.cross(OMEGA_X) + ALPHA.cross(OMEGA_X_RATE)
    return (excess_rate + horizontal(turning)).applyfunc(sp.expand)


def velocity_information(computed: sp.Matrix, climb: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """sigma^c: computed relative rate minus the one from a velocity measured in platform axes.

    The computer knows the Earth rate in its own axes, (E - [gamma x]) u; the velocity
    V = (omega - u) x R + R' is measured in the axes of the platform and given as a rate.
    """
    gamma = ALPHA - BETA
    inertial = computed + gamma.cross(EARTH_X)
    velocity = (OMEGA_X - EARTH_X).cross(sp.Matrix([0, 0, RADIUS])) + sp.Matrix([0, 0, climb])
    seen = velocity.cross(ALPHA)
    measured = sp.Matrix([-seen[1], seen[0]]) / RADIUS
    sigma = horizontal(inertial) - measured + W_C
    return sp.expand(sigma[0]), sp.expand(sigma[1])
