"""Absolute values by cases: |u| is u or -u at every point, so what vanishes in all cases vanishes.

Roots of perfect squares are absolute values in disguise and are treated as such.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import sympy as sp

from navsym.core.balls import exact_ball
from navsym.core.errors import NavsymError
from navsym.prove.identities.normal_form import vanishes_identically
from navsym.prove.identities.transcendental import factor_exactly
from navsym.prove.sampling.points import Range

MOST_VALUES = 6


def vanishes_in_all_cases(expression: sp.Expr) -> bool:
    """True when the expression vanishes for every choice of signs of its absolute values."""
    try:
        expression = split_values(expression)
        return len(expression.atoms(sp.Abs)) <= MOST_VALUES and vanishes_in_every_case(expression, MOST_VALUES)
    except NavsymError:
        return False


def vanishes_in_every_case(expression: sp.Expr, left: int) -> bool:
    """The innermost absolute value first; new ones may come up when outer arguments change."""
    values = [node for node in expression.atoms(sp.Abs) if not node.args[0].has(sp.Abs)]
    if not values:
        return vanishes_identically(expression)
    if left == 0:
        return False
    value = min(values, key=sp.default_sort_key)
    cases = (expression.xreplace({value: sign * value.args[0]}) for sign in (1, -1))
    return all(vanishes_in_every_case(case, left - 1) for case in cases)


def split_values(expression: sp.Expr) -> sp.Expr:
    """|u v| as |u| |v|, with factors of opposite sign made the same."""
    for root in sorted(expression.atoms(sp.Pow), key=sp.default_sort_key):
        if root.exp == sp.S.Half and root.base.is_Add:
            expression = expression.xreplace({root: perfect_root(root.base)})
    for value in sorted(expression.atoms(sp.Abs), key=sp.default_sort_key):
        factors = [split_factor(factor) for factor in sp.Mul.make_args(factor_exactly(value.args[0]))]
        expression = expression.xreplace({value: sp.Mul(*factors)})
    return expression


def perfect_root(radicand: sp.Expr) -> sp.Expr:
    """sqrt(c u**2) = sqrt(c) |u| for a number c >= 0; the root as it was for anything else."""
    root = sp.Integer(1)
    for factor in sp.Mul.make_args(factor_exactly(radicand)):
        base, exponent = factor.as_base_exp()
        if factor.is_Rational and factor > 0:
            root *= sp.sqrt(factor)
        elif exponent.is_Integer and exponent.is_even:
            root *= sp.Abs(base) ** (exponent / 2)
        else:
            return sp.sqrt(radicand)
    return root


def split_factor(factor: sp.Expr) -> sp.Expr:
    base, exponent = factor.as_base_exp()
    if not exponent.is_Integer:
        base, exponent = factor, sp.Integer(1)
    value = sp.Abs(-base) if base.could_extract_minus_sign() else sp.Abs(base)
    return value**exponent


def half_range(limits: Mapping[sp.Symbol, Range], inside: sp.Expr, sign: int) -> Mapping[sp.Symbol, Range] | None:
    """The part of the box where a symbol has this sign (or is zero), None when there is none; the box for the rest."""
    if not isinstance(inside, sp.Symbol):
        return limits
    limit, zero = limits[inside], sp.Integer(0)
    if sign > 0:
        if limit.upper is not None and exact_ball(limit.upper) < 0:
            return None
        keep = limit.lower is not None and exact_ball(limit.lower) >= 0
        return {**limits, inside: limit if keep else replace(limit, lower=zero, open_lower=False)}
    if limit.lower is not None and exact_ball(limit.lower) > 0:
        return None
    keep = limit.upper is not None and exact_ball(limit.upper) <= 0
    return {**limits, inside: limit if keep else replace(limit, upper=zero)}
