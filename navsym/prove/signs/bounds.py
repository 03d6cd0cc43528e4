"""Inequalities over boxes: ball subdivision, exact products, monotonicity and contacts.

``prove_sign(f, box)`` shows that an expression is positive, or nonnegative, on a whole box:

* products by the signs of their factors, exactly;
* balls on an adaptively divided box, with a mean-value form where plain balls are too wide;
* monotone in one symbol: reduced to the end at which it is smallest;
* a zero at an end of the range, f(a) = f'(a) = … = 0, by the sign of the first derivative that
  does not vanish, on a neighbourhood, and by balls on the rest.

Every step is rigorous; what none of them settles comes back as unknown.
"""

from __future__ import annotations

from dataclasses import replace

import sympy as sp
from flint import arb, fmpq

from navsym.claims.statement import Box
from navsym.core.balls import DEFAULT_BITS, UnsupportedError, enclose, exact_ball, precision, tape
from navsym.prove.identities.cases import split_values
from navsym.prove.identities.normal_form import OutsideLanguageError
from navsym.prove.identities.transcendental import KINDS, least_principal_value
from navsym.prove.sampling.points import Range, ranges_of
from navsym.prove.signs.algebraic import algebraic_sign
from navsym.prove.signs.exact import (
    UNKNOWN,
    Limits,
    Sign,
    SignProof,
    angle_sign,
    constant_sign,
    is_entire,
    multilinear_sign,
    sum_of_bounded_terms,
    symbol_sign,
)
from navsym.prove.signs.one_variable import root_sign
from navsym.prove.signs.products import as_product
from navsym.prove.signs.slopes import (
    between_contacts,
    by_exponential,
    by_monotony,
    by_quotient,
    by_squares,
    by_sums,
    by_taylor,
    by_values,
    is_defined,
)
from navsym.prove.signs.subdivision import end_contact, subdivide

__all__ = ["Limits", "Sign", "SignProof", "prove_sign"]


MAX_DEPTH = 4

#: Effort of the polynomials at the top of a search, one level below, and further down.
ALGEBRA = (4000, 800, 200)

#: Balls for one derivative of a Taylor proof.
FEW = 64


def prove_sign(expression: sp.Expr, box: Box, wanted: Sign = Sign.NONNEGATIVE, budget: int = 4000) -> SignProof:
    """Prove that the expression is nonnegative (or positive) on the box, or return unknown."""
    expression = sp.sympify(expression, strict=True)
    limits = ranges_of(sorted(expression.free_symbols, key=str), box)
    try:
        proof = attempt(expression, limits, wanted, budget, 0)
        if proof.at_least(wanted) or not expression.has(sp.Abs):
            return proof
        spread = split_values(expression)
        return attempt(spread, limits, wanted, budget, 0) if spread != expression else proof
    except (UnsupportedError, OutsideLanguageError):
        return UNKNOWN


def attempt(expression: sp.Expr, limits: Limits, wanted: Sign, budget: int, depth: int) -> SignProof:
    """One level of the search; the cheap and exact ways come first."""
    if not expression.free_symbols:
        return constant_sign(expression)
    by_roots = root_sign(expression, limits)
    if by_roots is not None and not by_roots.at_least(wanted):
        return UNKNOWN
    if by_roots is not None and is_defined_on_box(expression, limits, budget, depth):
        return by_roots
    if is_negative_somewhere(expression, limits):
        return UNKNOWN

    def prove(simpler: sp.Expr, on: Limits, sign: Sign) -> SignProof:
        return attempt(simpler, on, sign, budget // 4, depth + 1)

    endless = any(limit.lower is None or limit.upper is None for limit in limits.values())
    # Balls settle most of what a bounded box holds; without an end they only settle what is simple.
    for first in (by_forms, by_polynomials, by_subdivision) if endless else (by_forms, by_subdivision, by_polynomials):
        proof = first(expression, limits, wanted, budget, depth)
        if proof.at_least(wanted):
            return proof
    if depth >= MAX_DEPTH:
        return UNKNOWN
    for way in (by_values, by_squares, by_sums):
        proof = way(expression, limits, wanted, prove)
        if proof.at_least(wanted):
            return proof
    for near_an_end in (end_contact, by_simple_taylor):
        proof = near_an_end(expression, limits, wanted, budget, depth)
        if proof.at_least(wanted):
            return proof
    for slower in (by_quotient, by_exponential, by_monotony, between_contacts):
        proof = slower(expression, limits, wanted, prove)
        if proof.at_least(wanted):
            return proof
    return UNKNOWN


def by_subdivision(expression: sp.Expr, limits: Limits, wanted: Sign, budget: int, depth: int) -> SignProof:
    return subdivide(expression, limits, wanted, budget)


def by_forms(expression: sp.Expr, limits: Limits, wanted: Sign, budget: int, depth: int) -> SignProof:
    """Products, ranges of angles, least values, corners: exact, and no box is divided."""
    product = as_product(expression) if depth <= 1 else None
    if product is not None:
        by_product = product_sign(product, limits, budget, depth)
        if by_product.at_least(wanted) and is_defined_on_box(expression, limits, budget, depth):
            return replace(by_product, reason=f"product form {product}")
    by_factors = product_sign(expression, limits, budget, depth)
    if by_factors.at_least(wanted):
        return by_factors
    for way in (angle_sign, sum_of_bounded_terms, multilinear_sign):
        by_range = way(expression, limits)
        if by_range.at_least(wanted):
            return by_range
    principal = principal_sign(expression)
    return principal if principal.at_least(wanted) and is_defined_on_box(expression, limits, budget, depth) else UNKNOWN


def principal_sign(expression: sp.Expr) -> SignProof:
    """Sign of a sum of inverse functions and multiples of pi by their principal values, wherever it exists."""
    least, left_out = least_principal_value(expression) if expression.has(*KINDS) else (sp.Integer(-1), False)
    if least < 0:
        return UNKNOWN
    sign = Sign.POSITIVE if least > 0 or left_out else Sign.NONNEGATIVE
    return SignProof(sign, "principal values of the inverse functions", exact=True)


def by_polynomials(expression: sp.Expr, limits: Limits, wanted: Sign, budget: int, depth: int) -> SignProof:
    """Exact as well, by the polynomials behind the expression."""
    proof = algebraic_sign(expression, limits, ALGEBRA[min(depth, 2)])
    return proof if proof.at_least(wanted) and is_defined_on_box(expression, limits, budget, depth) else UNKNOWN


def is_defined_on_box(expression: sp.Expr, limits: Limits, budget: int, depth: int) -> bool:
    """True when the expression is proved to be defined and continuous on the box."""
    return is_defined(expression, limits, lambda inside, on, sign: attempt(inside, on, sign, budget // 4, depth + 1))


def by_simple_taylor(expression: sp.Expr, limits: Limits, wanted: Sign, budget: int, depth: int) -> SignProof:
    """Derivatives at an end; their signs by exact ways and a few balls only."""

    def simple(simpler: sp.Expr, on: Limits, sign: Sign) -> SignProof:
        if not simpler.free_symbols:
            return constant_sign(simpler)
        if is_negative_somewhere(simpler, on):
            return UNKNOWN
        ways = (by_forms, by_polynomials, by_subdivision)
        proofs = (way(simpler, on, sign, FEW, MAX_DEPTH) for way in ways)
        return next((proof for proof in proofs if proof.at_least(sign)), UNKNOWN)

    return by_taylor(expression, limits, wanted, simple)


def is_negative_somewhere(expression: sp.Expr, limits: Limits) -> bool:
    """A look at a few inner points, to give up early on what is not true."""
    program = tape(expression)
    for share in (fmpq(1, 2), fmpq(1, 7), fmpq(12, 13)):
        with precision(DEFAULT_BITS):
            point = {symbol: inner_value(limit, share) for symbol, limit in limits.items()}
        if enclose(program, point) < 0:
            return True
    return False


def inner_value(limit: Range, share: fmpq) -> arb:
    """A point inside the range, up to rounding; only a guess is built on it."""
    lower = None if limit.lower is None else exact_ball(limit.lower).mid()
    upper = None if limit.upper is None else exact_ball(limit.upper).mid()
    if lower is not None and upper is not None:
        return arb(lower + (upper - lower) * share)
    stretched = arb(share / (1 - share))
    if lower is not None:
        return arb(lower + stretched)
    return arb(upper - stretched) if upper is not None else stretched - arb(2) / 3


def product_sign(expression: sp.Expr, limits: Limits, budget: int, depth: int) -> SignProof:
    """Sign of a product, a power or a symbol from its parts."""
    if isinstance(expression, sp.Symbol):
        return symbol_sign(limits[expression])
    if isinstance(expression, sp.Pow):
        return power_sign(expression, limits, budget, depth)
    if isinstance(expression, sp.Add):
        return sum_sign(expression, limits, budget, depth)
    if isinstance(expression, sp.Abs) and is_defined_on_box(expression, limits, budget, depth):
        return SignProof(Sign.NONNEGATIVE, "an absolute value", exact=True)
    if not isinstance(expression, sp.Mul):
        return UNKNOWN
    worst, negative, exact, boxes = Sign.POSITIVE, False, True, 0
    for factor in expression.args:
        proof, flipped = factor_sign(factor, limits, budget, depth)
        if proof.sign == Sign.UNKNOWN:
            return UNKNOWN
        negative ^= flipped
        worst, exact, boxes = min(worst, proof.sign), exact and proof.exact, boxes + proof.boxes
    if negative:
        return UNKNOWN
    return SignProof(worst, "sign of every factor", boxes, exact)


def sum_sign(expression: sp.Add, limits: Limits, budget: int, depth: int) -> SignProof:
    """A sum of nonnegative terms, of which one may be positive."""
    best, boxes, exact = Sign.NONNEGATIVE, 0, True
    for term in expression.args:
        own = {s: limits[s] for s in term.free_symbols}
        if not term.free_symbols:
            proof = constant_sign(term)
        elif isinstance(term, sp.Add):
            proof = UNKNOWN
        else:
            proof = product_sign(term, own, 64, min(depth + 1, MAX_DEPTH))
        if proof.sign == Sign.UNKNOWN:
            return UNKNOWN
        best, boxes, exact = max(best, proof.sign), boxes + proof.boxes, exact and proof.exact
    return SignProof(best, "sum of nonnegative terms", boxes, exact)


def factor_sign(factor: sp.Expr, limits: Limits, budget: int, depth: int) -> tuple[SignProof, bool]:
    """Sign of a factor or of its negative; true when it is the negative."""
    if depth >= MAX_DEPTH:
        return UNKNOWN, False
    own = {s: limits[s] for s in factor.free_symbols}
    proof = attempt(factor, own, Sign.NONNEGATIVE, budget // 4, depth + 1)
    if proof.sign != Sign.UNKNOWN:
        return proof, False
    return attempt(-factor, own, Sign.NONNEGATIVE, budget // 4, depth + 1), True


def power_sign(expression: sp.Pow, limits: Limits, budget: int, depth: int) -> SignProof:
    base, exponent = expression.args
    if not isinstance(exponent, sp.Rational):
        return UNKNOWN
    even = exponent.q == 1 and exponent.p % 2 == 0
    if even and exponent > 0 and is_entire(base):
        ways = [way(value, limits) for value in (base, -base) for way in (angle_sign, multilinear_sign)]
        best = max((way.sign for way in ways), default=Sign.UNKNOWN)
        return SignProof(max(best, Sign.NONNEGATIVE), "even power", exact=True)
    proof, flipped = factor_sign(base, limits, budget, depth)
    if exponent.q != 1 and (flipped or proof.sign == Sign.UNKNOWN):
        return UNKNOWN
    if exponent < 0 and proof.sign != Sign.POSITIVE:
        return UNKNOWN  # might divide by zero
    if proof.sign == Sign.UNKNOWN and not is_entire(base):
        return UNKNOWN  # tan(x)**2 is nonnegative only where it exists
    if even:
        strict = proof.sign == Sign.POSITIVE
        return SignProof(Sign.POSITIVE if strict else Sign.NONNEGATIVE, "even power", proof.boxes, proof.exact)
    return UNKNOWN if flipped else SignProof(proof.sign, "power of a signed base", proof.boxes, proof.exact)
