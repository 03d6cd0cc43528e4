"""The model: errors of the inertial system (1), slopes under the track, and the sums made of them."""

import sympy as sp

#: Track sizes for which identities with free slopes are proved; a sum over pairs needs two points only.
SIZES = (1, 2, 3)

t, step, speed = sp.symbols("t Deltas V", positive=True)
beta_x, beta_y = sp.symbols("beta_x beta_y", real=True)
n = sp.Symbol("n", positive=True, integer=True)


def slopes(size: int) -> list[tuple[sp.Symbol, sp.Symbol]]:
    """Free slopes (dh/dx, dh/dy) of the map at the measurements 0…size."""
    return [(sp.Symbol(f"p{k}", real=True), sp.Symbol(f"q{k}", real=True)) for k in range(size + 1)]


def moment(points: list, power: int) -> sp.Matrix:
    """sum k^power g_k g_k' (2, 2)."""
    total = sp.zeros(2, 2)
    for k, (p, q) in enumerate(points):
        total += sp.Integer(k) ** power * sp.Matrix([[p * p, p * q], [p * q, q * q]])
    return total


def misfit(points: list, direction: tuple, crossing: sp.Expr) -> sp.Expr:
    """Criterion (2), heights linear in the displacement, of a track that crosses the true one.

    At measurement k the two tracks are (k - crossing) step direction apart.
    """
    bx, by = direction
    return sum(((p * bx + q * by) * step * (k - crossing)) ** 2 for k, (p, q) in enumerate(points))


def stationary(quadratic: sp.Expr, variable: sp.Symbol) -> sp.Expr:
    """The zero of the derivative of a quadratic polynomial."""
    return -sp.diff(quadratic, variable).subs(variable, 0) / sp.diff(quadratic, variable, 2)


def crossing_time(points: list, direction: tuple) -> sp.Expr:
    """t_G: the crossing at which the criterion is smallest."""
    return sp.cancel(stationary(sp.expand(misfit(points, direction, t)), t))


def free_motion(time: sp.Expr, start: sp.Expr, velocity: sp.Expr, acceleration: sp.Expr) -> sp.Matrix:
    """Errors (position, velocity, acceleration) after ``time`` by (1) with a constant acceleration.

    exp(F time) of the nilpotent F, whose series ends after the square.
    """
    F = sp.Matrix([[0, 1, 0], [0, 0, 1], [0, 0, 0]])
    Phi = sp.eye(3) + F * time + F * F * time**2 / 2
    return Phi * sp.Matrix([start, velocity, acceleration])


def symmetric(name: str) -> sp.Matrix:
    """A symmetric (2, 2) matrix of free symbols."""
    a, b, c = (sp.Symbol(f"{name}{ij}", real=True) for ij in ("11", "12", "22"))
    return sp.Matrix([[a, b], [b, c]])


def inverse(matrix: sp.Matrix) -> sp.Matrix:
    """Inverse (2, 2) by the adjugate."""
    (a, b), (c, d) = matrix.tolist()
    return sp.Matrix([[d, -b], [-c, a]]) / (a * d - b * c)
