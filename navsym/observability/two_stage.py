"""Two-stage estimators: gains in closed form, exact, and observers with numbers that run.

First stage  dx°/dt = G_x x° + K_x (sigma_1 - g_x x°)                          (joint_correction:1.6)
second stage dz°/dt = G_z1 x° + G_z2 z° + K_z (sigma_2 - g_z1 x° - g_z2 z°)    (joint_correction:1.11, 1.13)

and xi° = L^-1 (x°, z°) (joint_correction:1.12). The gains follow from the prescribed
characteristic polynomials without solving anything: in chain coordinates they are a recursion.
The observer is linear, so that a step with a measurement held over it is a matrix product.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from navsym.core.arrays import Array, as_array, freeze
from navsym.core.errors import DomainError, ShapeError
from navsym.core.rational_functions import cancel_fraction, clear_denominators, powers_apart
from navsym.observability.linear import determinant
from navsym.observability.ring import Ring
from navsym.observability.splits import Split, TwoStageBlocks

#: Variable of characteristic polynomials.
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
    parts = {power: part for (power,), part in powers_apart(quotient.top, place).items()}
    found = max(parts, default=0)
    if found != degree:
        raise ShapeError(
            f"poles: expected degree {degree}, one root per variable of the stage; got degree {found}; "
            f"change the polynomial"
        )
    zero = ring.constant(0)
    values = [cancel_fraction(parts.get(k, zero), parts[degree]) for k in range(degree - 1, -1, -1)]
    return tuple(ring.expression(value) for value in values)


def hurwitz_minors(coefficients: Sequence[sp.Expr]) -> tuple[sp.Expr, ...]:
    """Leading minors of Hurwitz' matrix of p^n + c_1 p^(n-1) + ... + c_n; all positive for a stable polynomial."""
    n = len(coefficients)
    known = [sp.Integer(1), *coefficients]
    entry = [
        [known[2 * (c + 1) - (r + 1)] if 0 <= 2 * (c + 1) - (r + 1) <= n else sp.Integer(0) for c in range(n)]
        for r in range(n)
    ]
    ring = Ring.of(coefficients)
    quotients = [[ring.quotient(sp.sympify(x, strict=True)) for x in row] for row in entry]
    scaled, bottom = clear_denominators(quotients, ring.constant(1))
    minors = [determinant([row[: k + 1] for row in scaled[: k + 1]], ring) for k in range(n)]
    return tuple(ring.factored(cancel_fraction(minor, bottom ** (k + 1))) for k, minor in enumerate(minors))


def stability(coefficients: Sequence[sp.Expr]) -> bool | None:
    """True when all roots lie in the open left half-plane, False when some do not, None when it depends.

    Symbols count with what they are declared to be; nothing else is guessed.
    """
    signs = [sign_by_declarations(value) for value in hurwitz_minors(coefficients)]
    if any(sign is not None and sign <= 0 for sign in signs):
        return False
    return True if all(sign == 1 for sign in signs) else None


def sign_by_declarations(value: sp.Expr) -> int | None:
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


# Observers with numbers


@dataclass(frozen=True, slots=True, eq=False)
class TwoStageObserver:
    """Matrices of (1.6), (1.11)-(1.13) as numbers; the variant (1.13) has g_z1 different from zero.

    L : (n, n), (x, z) = L xi;  rows g are vectors; gains K_x (m,), K_z (n - m,)
    """

    L: Array
    G_x: Array
    g_x: Array
    K_x: Array
    G_z1: Array
    G_z2: Array
    g_z1: Array
    g_z2: Array
    K_z: Array

    def __post_init__(self) -> None:
        m, rest = np.shape(self.G_x)[0], np.shape(self.G_z2)[0]
        shapes = {
            "L": (m + rest, m + rest),
            "G_x": (m, m),
            "g_x": (m,),
            "K_x": (m,),
            "G_z1": (rest, m),
            "G_z2": (rest, rest),
            "g_z1": (m,),
            "g_z2": (rest,),
            "K_z": (rest,),
        }
        for name, shape in shapes.items():
            value = getattr(self, name)
            array = freeze(np.zeros(shape)) if 0 in shape else as_array(name, value, shape, "blocks of the observer")
            object.__setattr__(self, name, array)

    @property
    def stages(self) -> tuple[int, int]:
        """Number of variables of the first and of the second stage."""
        return len(self.K_x), len(self.K_z)


def observer_of(
    blocks: TwoStageBlocks, K_x: Sequence[Any], K_z: Sequence[Any], values: Mapping[sp.Symbol, Any] | None = None
) -> TwoStageObserver:
    """The observer of symbolic blocks and gains with numbers for all symbols.

    Raises DomainError when a symbol has no value.
    """
    values = values or {}
    return TwoStageObserver(
        L=rounded_entries(blocks.L, values),
        G_x=rounded_entries(blocks.G_x, values),
        g_x=rounded_entries(blocks.g_x, values)[0],
        K_x=rounded_entries(sp.Matrix(len(K_x), 1, list(K_x)), values)[:, 0],
        G_z1=rounded_entries(blocks.G_z1, values),
        G_z2=rounded_entries(blocks.G_z2, values),
        g_z1=rounded_entries(blocks.g_z1, values)[0],
        g_z2=rounded_entries(blocks.g_z2, values)[0],
        K_z=rounded_entries(sp.Matrix(len(K_z), 1, list(K_z)), values)[:, 0],
    )


def rounded_entries(matrix: sp.MatrixBase, values: Mapping[sp.Symbol, Any]) -> Array:
    """Entries as floats, each rounded once from its exact value."""
    exact = sp.Matrix(matrix).subs(dict(values))
    if exact.free_symbols:
        names = ", ".join(sorted(map(str, exact.free_symbols)))
        raise DomainError(f"expected a number for every symbol; got none for {names}; give their values")
    return np.array([[float(entry) for entry in row] for row in exact.tolist()], dtype=float).reshape(exact.shape)


def observer_loop(found: TwoStageObserver) -> tuple[Array, Array]:
    """(A, B) with d(x°, z°)/dt = A (x°, z°) + B (sigma_1, sigma_2); A is also the matrix of the errors."""
    m, rest = found.stages
    A, B = np.zeros((m + rest, m + rest)), np.zeros((m + rest, 2))
    A[:m, :m] = found.G_x - np.outer(found.K_x, found.g_x)
    A[m:, :m] = found.G_z1 - np.outer(found.K_z, found.g_z1)
    A[m:, m:] = found.G_z2 - np.outer(found.K_z, found.g_z2)
    B[:m, 0], B[m:, 1] = found.K_x, found.K_z
    return A, B


def hold_measurements(A: Array, B: Array, step: float) -> tuple[Array, Array]:
    """(Phi, Gamma) of one step with constant input: the exponential of ((A, B), (0, 0)) step."""
    from scipy.linalg import expm

    n, q = A.shape[0], B.shape[1]
    block = np.zeros((n + q, n + q))
    block[:n, :n], block[:n, n:] = A * step, B * step
    whole = expm(block)
    return whole[:n, :n], whole[:n, n:]
