"""Two-stage estimators: gains in closed form, error dynamics, steady errors, all exact.

First stage  dx°/dt = G_x x° + K_x (sigma_1 - g_x x°)                          (joint_correction:1.6)
second stage dz°/dt = G_z1 x° + G_z2 z° + K_z (sigma_2 - g_z1 x° - g_z2 z°)    (joint_correction:1.11, 1.13)

and xi° = L^-1 (x°, z°) (joint_correction:1.12). The gains follow from the prescribed
characteristic polynomials without solving anything: in chain coordinates they are a recursion.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from navsym.core.errors import DomainError, ShapeError
from navsym.observability.linear import determinant, relation
from navsym.observability.ring import Poly, Ring
from navsym.observability.splits import Split, TwoStageBlocks, inverse

POLE = sp.Symbol("p", real=True)


# Gains


def companion_gains(theta: Sequence[sp.Expr], wanted: Sequence[sp.Expr]) -> tuple[sp.Expr, ...]:
    """The K with det(pE - Theta + K (1 0 ... 0)) = p^m + c_1 p^(m-1) + ... + c_m.

    theta  : last row of the companion matrix
    wanted : c_1 ... c_m

    K_r = c_r + sum over q < r of theta_{m+1-r+q} K_q with K_0 = 1: the coefficients are triangular in
    K with ones on the diagonal, so the gain exists and is the only one for all theta.
    """
    m = len(theta)
    if len(wanted) != m:
        raise ShapeError(
            f"poles: expected a polynomial of degree {m}; got degree {len(wanted)}; give one root per state"
        )
    gains: list[sp.Expr] = []
    for r in range(1, m + 1):
        known = [sp.Integer(1), *gains]
        gains.append(wanted[r - 1] + sum(theta[m - r + q] * known[q] for q in range(r)))
    ring = Ring.of([*theta, *wanted])
    return tuple(ring.expression(ring.quotient(sp.sympify(gain, strict=True))) for gain in gains)


def monic_coefficients(polynomial: sp.Expr, degree: int, variable: sp.Symbol = POLE) -> tuple[sp.Expr, ...]:
    """c_1 ... c_n of a polynomial in p divided by its leading coefficient.

    Raises ShapeError for a wrong degree and DomainError when it is no polynomial in p.
    """
    ring = Ring.of([polynomial, variable])
    quotient = ring.quotient(polynomial)
    place = ring.symbols.index(variable)
    if quotient.bottom.degrees()[place]:
        raise DomainError(f"poles: expected a polynomial in {variable}; got {polynomial}; remove the divisor")
    parts = by_power(quotient.top, place, ring)
    found = max(parts, default=0)
    if found != degree:
        raise ShapeError(
            f"poles: expected degree {degree}, one root per variable of the stage; got degree {found}; "
            f"change the polynomial"
        )
    zero = ring.constant(0)
    values = [ring.lowest(parts.get(k, zero), parts[degree]) for k in range(degree - 1, -1, -1)]
    return tuple(ring.expression(value) for value in values)


def by_power(polynomial: Poly, place: int, ring: Ring) -> dict[int, Poly]:
    """Coefficients of a polynomial by the power of one symbol."""
    parts: dict[int, dict[tuple[int, ...], int]] = {}
    for powers, coefficient in polynomial.to_dict().items():
        rest = tuple(0 if k == place else int(power) for k, power in enumerate(powers))
        parts.setdefault(int(powers[place]), {})[rest] = int(coefficient)
    return {power: ring.context.from_dict(terms) for power, terms in parts.items()}


def hurwitz_minors(coefficients: Sequence[sp.Expr]) -> tuple[sp.Expr, ...]:
    """Leading minors of Hurwitz' matrix of p^n + c_1 p^(n-1) + ... + c_n, all positive for a stable
    polynomial.
    """
    n = len(coefficients)
    known = [sp.Integer(1), *coefficients]
    entry = [
        [known[2 * (c + 1) - (r + 1)] if 0 <= 2 * (c + 1) - (r + 1) <= n else sp.Integer(0) for c in range(n)]
        for r in range(n)
    ]
    ring = Ring.of(coefficients)
    quotients = [[ring.quotient(sp.sympify(x, strict=True)) for x in row] for row in entry]
    bottom = ring.constant(1)
    for row in quotients:
        for q in row:
            bottom = bottom * ring.lowest(q.bottom, bottom).top
    scaled = [[q.top * ring.lowest(bottom, q.bottom).top for q in row] for row in quotients]
    minors = [determinant([row[: k + 1] for row in scaled[: k + 1]], ring) for k in range(n)]
    return tuple(ring.factored(ring.lowest(minor, bottom ** (k + 1))) for k, minor in enumerate(minors))


def stability(coefficients: Sequence[sp.Expr]) -> bool | None:
    """True when all roots lie in the open left half-plane, False when some do not, None when it depends.

    Symbols count with what they are declared to be; nothing else is guessed.
    """
    signs = [sign_of(value) for value in hurwitz_minors(coefficients)]
    if any(sign is not None and sign <= 0 for sign in signs):
        return False
    return True if all(sign == 1 for sign in signs) else None


def sign_of(value: sp.Expr) -> int | None:
    """Sign of a product of sums of monomials in symbols that are declared positive; None when not seen."""
    total = 1
    for factor in sp.Mul.make_args(value):
        base, exponent = factor.as_base_exp()
        if base.is_Add and isinstance(exponent, sp.Integer):
            signs = {term_sign(term) for term in base.args}
            sign = signs.pop() if len(signs) == 1 else None
        else:
            sign = term_sign(base)
        if sign == 0:
            return 0
        if sign is None:
            if isinstance(exponent, sp.Integer) and int(exponent) % 2 == 0 and base.is_Add:
                return None
            return None
        total *= sign ** int(exponent) if isinstance(exponent, sp.Integer) else sign
    return total


def term_sign(term: sp.Expr) -> int | None:
    """Sign of a monomial from the declarations of its symbols."""
    if term == 0:
        return 0
    if term.is_positive:
        return 1
    return -1 if term.is_negative else None


@dataclass(frozen=True, slots=True)
class StageGains:
    """Gains of both stages in chain coordinates; ``stable`` is None when it depends on parameters."""

    K_x: tuple[sp.Expr, ...]
    K_z: tuple[sp.Expr, ...]
    stable: tuple[bool | None, bool | None]


def gains_by_poles(chosen: Split, first: sp.Expr, second: sp.Expr | None, variable: sp.Symbol = POLE) -> StageGains:
    """Gains of the stages from their prescribed characteristic polynomials.

    The first polynomial has the degree m (also for the form u, v, w, whose first stage is (u, v)),
    the second the degree j. Raises ShapeError (degree) and DomainError (a root that is not on the left).
    """
    K_x, stable_x = stage_gains(chosen.theta, first, "first", variable)
    if second is None or chosen.j == 0:
        if second is not None and monic_coefficients(second, 0, variable):
            raise ShapeError(
                "poles: expected one polynomial; got two, but the first chain is the whole space; leave it out"
            )
        if second is None and chosen.j:
            raise ShapeError(
                f"poles: expected two polynomials, of degrees {chosen.m} and {chosen.j}; got one; add the second"
            )
        return StageGains(K_x, (), (stable_x, True))
    K_z, stable_z = stage_gains(chosen.link[chosen.i :], second, "second", variable)
    return StageGains(K_x, K_z, (stable_x, stable_z))


def stage_gains(
    theta: Sequence[sp.Expr], polynomial: sp.Expr, name: str, variable: sp.Symbol
) -> tuple[tuple[sp.Expr, ...], bool | None]:
    """Gain of one stage, and whether its polynomial is stable."""
    wanted = monic_coefficients(polynomial, len(theta), variable)
    stable = stability(wanted)
    if stable is False:
        raise DomainError(
            f"poles of the {name} stage: expected all roots in the open left half-plane; got {polynomial}; "
            "a stable factor is (p + lam) with lam > 0"
        )
    return companion_gains(theta, wanted), stable


# Error dynamics


@dataclass(frozen=True, slots=True, eq=False)
class ErrorDynamics:
    """d(e, f)/dt = A (e, f) + B_q (q_x, q_z) + B_r (r_1, r_2) for e = x - x°, f = z - z°.

    A is block triangular: e drives f through ``coupling``, f never drives e.
    """

    A: sp.ImmutableMatrix
    noise_of_measurements: sp.ImmutableMatrix
    stages: tuple[int, int]

    @property
    def coupling(self) -> sp.ImmutableMatrix:
        """(n - m, m): how the error of the first stage drives that of the second."""
        m = self.stages[0]
        return self.A[m:, :m]


def error_dynamics(blocks: TwoStageBlocks, K_x: Sequence[sp.Expr], K_z: Sequence[sp.Expr]) -> ErrorDynamics:
    """Error equations of the two stages, also for the variant (1.13).

    A = ((G_x - K_x g_x, 0), (G_z1 - K_z g_z1, G_z2 - K_z g_z2)); q enters as it enters x and z, the
    measurement errors through -K (joint_correction:1.11.error, 1.13.error).
    """
    m, rest = blocks.G_x.rows, blocks.G_z2.rows
    first, second = sp.Matrix(m, 1, list(K_x)), sp.Matrix(rest, 1, list(K_z))
    upper = sp.Matrix.hstack(blocks.G_x - first * blocks.g_x, sp.zeros(m, rest))
    lower = sp.Matrix.hstack(blocks.G_z1 - second * blocks.g_z1, blocks.G_z2 - second * blocks.g_z2)
    noise = sp.zeros(m + rest, 2)
    noise[:m, 0], noise[m:, 1] = -first, -second
    return ErrorDynamics(sp.ImmutableMatrix.vstack(upper, lower), sp.ImmutableMatrix(noise), (m, rest))


def steady_bias(A: sp.MatrixBase, constant: sp.MatrixBase) -> sp.ImmutableMatrix:
    """Steady error under a constant term: -A^-1 constant, exactly.

    Raises DomainError when A is singular for all parameters.
    """
    return sp.ImmutableMatrix(-inverse("A", sp.ImmutableMatrix(A)) * constant).applyfunc(sp.cancel)


def steady_covariance(A: sp.MatrixBase, intensity: sp.MatrixBase) -> sp.ImmutableMatrix:
    """P with A P + P A^T + intensity = 0, exactly and with symbols.

    A : (n, n) with no two eigenvalues that sum to zero, intensity : (n, n) symmetric.
    One linear equation for each entry on and above the diagonal, solved without fractions and
    checked. Raises DomainError when the equation is singular.
    """
    n = A.rows
    places = [(r, c) for r in range(n) for c in range(r, n)]
    number = {place: k for k, place in enumerate(places)} | {(c, r): k for k, (r, c) in enumerate(places)}
    rows = []
    for r, c in places:
        row = [sp.Integer(0)] * len(places)
        for k in range(n):
            row[number[k, c]] += A[r, k]
            row[number[r, k]] += A[c, k]
        rows.append([*row, -sp.sympify(intensity[r, c], strict=True)])
    values = solve_exactly(sp.Matrix(rows))
    return sp.ImmutableMatrix(n, n, lambda r, c: values[number[r, c]])


def solve_exactly(augmented: sp.Matrix) -> list[sp.Expr]:
    """Solution of a square linear system of rational functions; the last column is the right side."""
    ring = Ring.of(augmented)
    vectors = []
    for row in augmented.tolist():
        quotients = [ring.quotient(sp.sympify(x, strict=True)) for x in row]
        bottom = ring.constant(1)
        for q in quotients:
            bottom = bottom * ring.lowest(q.bottom, bottom).top
        vectors.append([q.top * ring.lowest(bottom, q.bottom).top for q in quotients])
    columns = [list(column) for column in zip(*vectors, strict=True)]
    if determinant(columns[:-1], ring) == 0:
        raise DomainError("expected a regular linear system; got determinant 0 for all parameters; change the gains")
    solution = relation(columns[:-1], columns[-1], ring)
    if solution is None:
        raise ArithmeticError("solve_exactly: the check of the solution failed")
    return [ring.expression(value) for value in solution]
