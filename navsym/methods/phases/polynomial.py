"""Closed forms for monomials on [0, T]: shares of the interval, powers of T, and Lagrange's weights.

With contacts ``c_i T`` and ``omega(t) = prod (t - c_i)``, a rational polynomial, the weights that pick
coefficient k of every polynomial of the span are

    w_i = sum_{j > k} omega_j c_i**(j-k-1) / omega'(c_i) / T**k,

a polynomial in c_i with rational coefficients, whatever algebraic number c_i is.
"""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from navsym.methods.phases.family import Family, U

NEAR = sp.Rational(1, 10**35)


def is_monomial(family: Family) -> bool:
    """One measurement with the regressors 1, u, u**2, …."""
    return len(family.rows) == 1 and family.rows[0] == tuple(U**k for k in range(len(family.rows[0])))


def rational_near(x: sp.Expr, size: int = 10**7) -> sp.Rational | None:
    """The rational with a small denominator within 1e-35 of a number with many digits."""
    value = sp.Rational(str(sp.N(x, 70)))
    best = value.limit_denominator(size)
    return best if abs(best - value) < NEAR * max(1, abs(value)) else None


def monomial_weights(family: Family, places: Sequence[sp.Expr]) -> tuple[sp.Expr, ...] | None:
    """Weights of contacts ``c_i T``, as many as unknowns; None when omega is not rational."""
    T, m = family.parameter, len(family.functional)
    shares = [sp.expand(p / T) for p in places]
    if len(places) != m or any(c.free_symbols for c in shares):
        return None
    omega = recognised_product(shares)
    if omega is None:
        return None
    slope = [k * c for k, c in enumerate(omega)][1:]
    weights = []
    for c in shares:
        below = rational_near(sum(a * sp.N(c, 90) ** k for k, a in enumerate(slope)))
        if below is None:
            return None
        terms = [
            p * sum((omega[j] * c ** (j - k - 1) for j in range(k + 1, m + 1)), sp.S.Zero) / below / T**k
            for k, p in enumerate(family.functional)
            if p != 0
        ]
        weights.append(sp.expand(sum(terms, sp.S.Zero)))
    return tuple(weights)


def recognised_product(shares: Sequence[sp.Expr]) -> list[sp.Rational] | None:
    """Coefficients of ``prod (t - c_i)``, lowest first, when they are recognised as rational."""
    c = [sp.Integer(1)]
    for share in shares:
        value = sp.Rational(str(sp.N(share, 90)))
        shifted = [sp.S.Zero, *c]
        c = [a - value * b for a, b in zip(shifted, [*c, sp.S.Zero], strict=True)]
    found = [rational_near(a) for a in c]
    return None if any(a is None for a in found) else [a for a in found if a is not None]


def power_law_dual(
    family: Family, duals: Sequence[Sequence[sp.Rational]], lengths: Sequence[sp.Rational]
) -> tuple[sp.Expr, ...] | None:
    """Dual ``x_k = d_k / T**k`` with rational d_k, agreed on by all samples."""
    T, found = family.parameter, []
    for k in range(len(family.functional)):
        values = [rational_near(x[k] * t**k) for x, t in zip(duals, lengths, strict=True)]
        if values[0] is None or any(v != values[0] for v in values):
            return None
        found.append(values[0] / T**k)
    return tuple(found)
