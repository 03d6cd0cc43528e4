"""Two-stage estimators: gains in closed form, exact.

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
from navsym.core.rational_functions import cancel_fraction, clear_denominators, powers_apart
from navsym.observability.chains import JointObservability, chain_rows, need_observable
from navsym.observability.linear import Matrix, determinant, linear_relation
from navsym.observability.ring import Poly, Ring
from navsym.observability.splits import Split

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


# One stage for each measurement


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """One stage of an estimator: what a measurement shows beside those before it, in chain coordinates.

    rows      : (k, n) of L, the first k vectors of the chain; y = rows x, and the measurement is y_1
    companion : last row of dy/dt = Theta y, k coefficients;  drive : the same for the coordinates of earlier stages
    K, stable : gain for the wanted polynomial, none without one
    """

    measurement: str
    rows: sp.ImmutableMatrix
    companion: tuple[sp.Expr, ...]
    drive: tuple[sp.Expr, ...]
    K: tuple[sp.Expr, ...] = ()
    stable: bool | None = None


def list_stages(found: JointObservability, poles: Sequence[sp.Expr] = ()) -> tuple[Stage, ...]:
    """The stages of any number of measurements of a constant model, in their order; redundant ones have none.

    With the staircase as basis the next vector of a chain depends on this chain and on earlier ones only, so that the
    error of a stage feels those of earlier stages only: the characteristic polynomial is the product of the stages'.

    poles : one polynomial for each stage; raises ShapeError for other numbers and degrees, DomainError for roots that
            are not on the left, and UnobservableError
    """
    need_observable(found)
    chains, ring = found.chains, found.chains.ring
    taken = [(chain, count) for chain, count in zip(chains.chains, found.staircase, strict=True) if count]
    if poles and len(poles) != len(taken):
        degrees = ", ".join(str(count) for _, count in taken)
        message = f"expected {len(taken)} polynomials, of degrees {degrees}; got {len(poles)}; give one per stage"
        raise ShapeError(message, where="observe: poles")
    basis: Matrix = []
    scales, stages = list[Poly](), list[Stage]()
    for place, (chain, count) in enumerate(taken):
        *own, following = chains.first(chain, count + 1)
        basis += own
        scales += [chain.bottom * chain.clock**r for r in range(count)]
        values = linear_relation(basis, following, ring)
        if values is None:
            raise ArithmeticError("stages: the next vector lies outside of the basis")
        last = chain.bottom * chain.clock**count
        entries = [
            ring.expression(cancel_fraction(value.top * scale, value.bottom * last))
            for value, scale in zip(values, scales, strict=True)
        ]
        drive, companion = tuple(entries[:-count]), tuple(entries[-count:])
        K, stable = stage_gains(companion, poles[place], f"{place + 1}.", POLE) if poles else ((), None)
        stages.append(Stage(chain.name, chain_rows(own, chain, ring), companion, drive, K, stable))
    return tuple(stages)
