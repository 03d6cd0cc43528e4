"""Sums of logarithms by what they are logarithms of: c log u + d log v + w >= 0 says u**c v**d exp(w) >= 1."""

from __future__ import annotations

from dataclasses import replace
from math import lcm

import sympy as sp

from navsym.proof.signs.known import UNKNOWN, Limits, Sign, SignProof
from navsym.proof.signs.slopes import Prove, is_defined, own

MOST_POWERS = 12


def by_exponential(expression: sp.Expr, limits: Limits, wanted: Sign, prove: Prove) -> SignProof:
    """The exponential of a multiple of the sum, with what has negative powers on the other side."""
    split = logarithms_of(expression)
    if split is None or not is_defined(expression, limits, prove):
        return UNKNOWN
    powers, rest = split
    above = sp.Mul(*(u**p for u, p in powers.items() if p > 0)) * sp.exp(rest)
    below = sp.Mul(*(u**-p for u, p in powers.items() if p < 0))
    difference = sp.expand(above - below)
    proof = prove(difference, own(limits, difference), wanted)
    return replace(proof, reason=f"{above} against {below}: {proof.reason}") if proof.at_least(wanted) else UNKNOWN


def logarithms_of(expression: sp.Expr) -> tuple[dict[sp.Expr, int], sp.Expr] | None:
    """Arguments with whole coefficients, and the rest, of a multiple of the sum; None where that is no such sum."""
    shares: dict[sp.Expr, sp.Rational] = {}
    rest = sp.Integer(0)
    for term in sp.Add.make_args(sp.expand_mul(expression)):
        share, inner = term.as_coeff_Mul()
        if isinstance(inner, sp.log):
            shares[inner.args[0]] = shares.get(inner.args[0], sp.Integer(0)) + share
        else:
            rest += term
    if not shares or rest.has(sp.log) or not all(share.is_Rational for share in shares.values()):
        return None
    n = lcm(*(int(share.q) for share in shares.values()))
    powers = {u: int(share * n) for u, share in shares.items()}
    return (powers, n * rest) if sum(map(abs, powers.values())) <= MOST_POWERS else None
