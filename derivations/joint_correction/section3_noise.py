"""Section 3 beyond the paper: what the prescribed poles cost in noise, and which poles are best.

White noise of unit intensity in the measurements of one channel; the gains are those of ``3.2.gains`` and
``3.3.gains``, the links between the channels are neglected as the paper does. The steady covariance P of errors
e' = A e - K r solves A P + P A^T + K K^T = 0, a linear system with one solution where A is stable.
"""

from functools import cache

import sympy as sp

from navsym.claims import Equation, claim
from navsym_papers.joint_correction.section2_groups import mu, w2
from navsym_papers.joint_correction.section3_gains import VELOCITY_GAINS, lam, lam_h, position_block, velocity_block

l, h = lam, lam_h


@cache
def steady_covariance(A: sp.ImmutableMatrix, noise: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """The symmetric P with A P + P A^T + noise = 0, by elimination over rational functions."""
    n = A.rows
    places = [(i, j) for i in range(n) for j in range(i, n)]
    unknown = sp.symbols(f"P0:{len(places)}", real=True)
    entry = dict(zip(places, unknown, strict=True))
    P = sp.Matrix(n, n, lambda i, j: entry[min(i, j), max(i, j)])
    residual = A * P + P * A.T + noise
    rows = sp.Matrix([sp.expand(residual[place]) for place in places])
    field = sp.QQ.frac_field(*sorted(A.free_symbols | noise.free_symbols, key=str))
    matrix, right = (
        sp.polys.matrices.DomainMatrix.from_Matrix(part).convert_to(field)
        for part in (rows.jacobian(unknown), -rows.subs(dict.fromkeys(unknown, 0)))
    )
    solved = matrix.lu_solve(right).to_Matrix()
    return sp.ImmutableMatrix(P.subs(dict(zip(unknown, solved, strict=True))))


def velocity_errors() -> tuple[sp.Matrix, sp.Matrix]:
    """A and K of the errors of x_1, x_2, x_3."""
    return velocity_block(VELOCITY_GAINS), sp.Matrix(VELOCITY_GAINS)


def position_errors() -> tuple[sp.Matrix, sp.Matrix]:
    """A and K of the errors of y_1, y_2."""
    gains = (2 * h, h**2 - mu**2 * w2**2)
    return position_block(gains).applyfunc(sp.expand), sp.Matrix(gains)


def both_stages() -> tuple[sp.Matrix, sp.Matrix]:
    """A of the errors of x_1, x_2, x_3, y_1, y_2, and the noise that enters by sigma_1^c alone."""
    (first, gain), (second, _) = velocity_errors(), position_errors()
    A, noise = sp.zeros(5, 5), sp.zeros(5, 5)
    A[:3, :3], A[3:, 3:], noise[:3, :3] = first, second, gain * gain.T
    A[4, 0] = -1
    return A, noise


def covariance_of(A: sp.Matrix, noise: sp.Matrix) -> sp.ImmutableMatrix:
    return steady_covariance(sp.ImmutableMatrix(A), sp.ImmutableMatrix(noise))


@claim("3.noise.velocity")
def noise_of_the_velocity_stage():
    """Steady variances of x_1, x_2, x_3 under unit noise in sigma_1^c, in closed form for every l = lambda_c.

    (7 l^4 - 6 l^2 + 3)/(4 l), (3 l^8 - 18 l^6 + 36 l^4 - 6 l^2 + 1)/(16 l^3), l (3 l^4 - 2 l^2 + 3)/16.
    """
    A, K = velocity_errors()
    P = covariance_of(A, K * K.T)
    printed = [
        (7 * l**4 - 6 * l**2 + 3) / (4 * l),
        (3 * l**8 - 18 * l**6 + 36 * l**4 - 6 * l**2 + 1) / (16 * l**3),
        l * (3 * l**4 - 2 * l**2 + 3) / 16,
    ]
    return Equation(printed, list(P.diagonal()))


@claim("3.noise.position")
def noise_of_the_position_stage():
    """Steady variances of y_1, y_2 under unit noise in sigma_1^M, w = mu omega_2 and l = lambda_h.

    (4 l^4 + (l^2 - w^2)^2)/(4 l^3) and (4 w^4 + (l^2 - w^2)^2)/(4 l): 5 l/4 and l^3/4 for small w.
    """
    A, K = position_errors()
    P = covariance_of(A, K * K.T)
    rest = (h**2 - (mu * w2) ** 2) ** 2
    return Equation([(4 * h**4 + rest) / (4 * h**3), (4 * (mu * w2) ** 4 + rest) / (4 * h)], list(P.diagonal()))


@claim("3.noise.handed_on")
def noise_that_the_first_stage_hands_on():
    """What the noise of sigma_1^c alone leaves in y_1, y_2 by way of x_1: closed forms in c = lambda_c, h = lambda_h.

    That of y_1 is (c^5 + 7 c^4 h - 6 c^3 - 6 c^2 h + 9 c + 3 h)/(4 c h (c + h)^4). The noise of sigma_1^M is
    independent of it and adds what ``3.noise.position`` says.
    """
    A, noise = both_stages()
    P = covariance_of(A, noise)
    first = l**5 + 7 * l**4 * h - 6 * l**3 - 6 * l**2 * h + 9 * l + 3 * h
    second = 3 * l**6 + 13 * l**5 * h + 28 * l**4 * h**2 - 6 * l**4 - 30 * l**3 * h
    second += -24 * l**2 * h**2 + 7 * l**2 + 37 * l * h + 12 * h**2
    below = 4 * l * (l + h) ** 4
    return Equation([first / (h * below), 2 * first / below, second / below], [P[3, 3], P[3, 4], P[4, 4]])


drive, best, other = sp.symbols("d m lambda", positive=True)


def mean_square(decay: sp.Expr) -> sp.Expr:
    """Mean square error of y_1: unit noise, and a constant drive d of y_2' (3.bias.position); mu omega neglected."""
    A, K = position_errors()
    P = covariance_of(A.subs(mu, 0), (K * K.T).subs(mu, 0))
    bias = (A.subs(mu, 0).inv() * sp.Matrix([0, -drive]))[0]
    return (P[0, 0] + bias**2).subs(h, decay)


@claim("3.choice.lambda_h")
def best_decay_of_the_position_stage():
    """The best lambda_h against unit noise and a constant drive d of y_2' is m = (16 d^2/5)^(1/5), the only minimum.

    Any other l costs (5/(16 l^4)) (l - m)^2 (4 l^3 + 3 m l^2 + 2 m^2 l + m^3) more.
    """
    cost = sp.Rational(5, 16) / other**4 * (other - best) ** 2
    cost *= 4 * other**3 + 3 * best * other**2 + 2 * best**2 * other + best**3
    known = {drive: sp.sqrt(5 * best**5 / 16)}
    return Equation(cost, (mean_square(other) - mean_square(best)).subs(known))


@claim("3.choice.least")
def least_error_of_the_position_stage():
    """There the mean square error of y_1 is 25 m/16, four fifths of it noise and one fifth bias."""
    known = {drive: sp.sqrt(5 * best**5 / 16)}
    A, K = position_errors()
    noise = covariance_of(A.subs(mu, 0), (K * K.T).subs(mu, 0))[0, 0].subs(h, best)
    whole = mean_square(best).subs(known)
    return Equation([25 * best / 16, sp.Rational(4, 5)], [whole, noise / whole])


@claim("3.choice.lambda_c")
def decay_that_needs_no_first_gain():
    """At lambda_c = 1/sqrt(3) the gain K_1^c is zero, and a constant drive of x_3' leaves no error in x_2.

    At every other lambda_c it leaves (1 - 3 l^2)/l^3 of it (3.bias.velocity). The variance of x_2 is 4/(3 sqrt(3)).
    """
    A, K = velocity_errors()
    at = {l: 1 / sp.sqrt(3)}
    steady = (A.subs(at).inv() * sp.Matrix([0, 0, -drive]))[1]
    P = covariance_of(A, K * K.T)
    return Equation([sp.Integer(0), sp.Integer(0), 4 / (3 * sp.sqrt(3))], [K[0].subs(at), steady, P[1, 1].subs(at)])
