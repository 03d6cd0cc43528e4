"""Certificates of the algebraic verdicts, as plain data that ``navsym check`` replays."""

from __future__ import annotations

from collections.abc import Mapping
from math import comb, prod
from typing import Any

import sympy as sp
from flint import arb, fmpq

from navsym.errors import NavsymError
from navsym.proof.balls import Tape, enclose, exact_ball, precision, tape
from navsym.proof.signs.known import Limits
from navsym.text.expression import to_text

BITS = 96
MOST_CELLS = 1000
MOST_TERMS = 10_000

#: What the checker knows at exact numbers only.
BENT = (sp.Abs, sp.asin, sp.acos, sp.atan2)

Cell = dict[sp.Symbol, tuple[fmpq, fmpq]]


def identity_certificate(left: sp.Expr, right: sp.Expr) -> Mapping[str, Any] | None:
    """``left = right`` in the language of files; None when a side lies outside it, or is too large for the checker."""
    if multiplied_out(left, right) > MOST_TERMS:
        return None
    symbols = sorted({s.name for s in left.free_symbols | right.free_symbols})
    try:
        return {"kind": "identity", "left": to_text(left), "right": to_text(right), "symbols": symbols}
    except NavsymError:
        return None


def multiplied_out(*sides: sp.Expr) -> int:
    """How many terms every term becomes when the checker multiplies by all sums that something is divided by."""
    powers: dict[sp.Expr, int] = {}
    for power in set().union(*(side.atoms(sp.Pow) for side in sides)):
        if power.base.is_Add and power.exp.is_Integer and power.exp < 0:
            powers[power.base] = max(powers.get(power.base, 0), -int(power.exp))
    return prod(comb(len(base.args) + power - 1, power) for base, power in powers.items())


def positivity_certificate(expression: sp.Expr, limits: Limits) -> Mapping[str, Any] | None:
    """``expression > 0`` on a closed bounded box, by halving alone; None where that does not show it."""
    ends = {s: (limits[s].lower, limits[s].upper) for s in sorted(expression.free_symbols, key=str)}
    if any(end is None for pair in ends.values() for end in pair) or expression.has(*BENT):
        return None
    try:
        cells = cells_needed(expression, ends)
        box = {s.name: [to_text(lower), to_text(upper)] for s, (lower, upper) in ends.items()}
        text = to_text(expression)
    except NavsymError:
        return None
    if cells is None:
        return None
    return {"kind": "positivity", "expression": text, "box": box, "bits": BITS, "cells": cells}


def cells_needed(expression: sp.Expr, ends: Mapping[sp.Symbol, tuple[Any, Any]]) -> int | None:
    """How many cells a halving of the unit cube looks at; None when they are too many."""
    powers = sorted(expression.atoms(sp.Pow), key=sp.default_sort_key)
    inside = [power.base for power in powers if not power.exp.is_Integer]  # a root of zero has no derivative
    programs, used = [tape(part) for part in (expression, *inside)], 0
    with precision(BITS):
        sides = {s: (exact_ball(lower, BITS), exact_ball(upper, BITS)) for s, (lower, upper) in ends.items()}
    pending: list[Cell] = [dict.fromkeys(ends, (fmpq(0), fmpq(1)))]
    while pending:
        cell, used = pending.pop(), used + 1
        if all(is_positive_on(program, cell, sides) for program in programs):
            continue
        if used > MOST_CELLS or not cell:
            return None
        widest = max(cell, key=lambda s: cell[s][1] - cell[s][0])
        low, high = cell[widest]
        middle = (low + high) / 2
        pending += [{**cell, widest: (low, middle)}, {**cell, widest: (middle, high)}]
    return used


def is_positive_on(program: Tape, cell: Cell, sides: Mapping[sp.Symbol, tuple[arb, arb]]) -> bool:
    with precision(BITS):
        values = {s: a + (b - a) * arb(cell[s][0]).union(arb(cell[s][1])) for s, (a, b) in sides.items()}
    return bool(enclose(program, values, BITS) > 0)
