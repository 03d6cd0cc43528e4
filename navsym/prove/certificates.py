"""Certificates of the algebraic verdicts, as plain data that ``navsym check`` replays."""

from __future__ import annotations

from collections.abc import Mapping
from math import comb, prod
from typing import Any

import sympy as sp

from navsym.core.errors import NavsymError
from navsym.language.expression import to_text

MOST_TERMS = 10_000


def identity_certificate(left: sp.Expr, right: sp.Expr) -> Mapping[str, Any] | None:
    """``left = right`` in the language of files; None when a side lies outside it, or is too large for the checker."""
    if count_terms(left, right) > MOST_TERMS:
        return None
    symbols = sorted({s.name for s in left.free_symbols | right.free_symbols})
    try:
        return {"kind": "identity", "left": to_text(left), "right": to_text(right), "symbols": symbols}
    except NavsymError:
        return None


def count_terms(*sides: sp.Expr) -> int:
    """How many terms every term becomes when the checker multiplies by all sums that something is divided by."""
    powers: dict[sp.Expr, int] = {}
    for power in set().union(*(side.atoms(sp.Pow) for side in sides)):
        if power.base.is_Add and power.exp.is_Integer and power.exp < 0:
            powers[power.base] = max(powers.get(power.base, 0), -int(power.exp))
    return prod(comb(len(base.args) + power - 1, power) for base, power in powers.items())
