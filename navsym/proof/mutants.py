"""Spoiled statements and one-token mutants: what a check must be able to notice.

A statement that cannot fall proves nothing. ``spoiled`` makes a statement wrong in its printed
side; ``mutants`` lists every formula one token away from a given one (sign, number, exponent,
function, symbol, dropped and doubled terms), equivalent ones included.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import sympy as sp

from navsym.claims.statement import Bound, Equation, Optimum, Property, Statement

OPPOSITE = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "=": "!=", "!=": "="}


def spoiled(statement: Statement) -> Statement:
    """The statement with its printed side changed so that it should not hold any more."""
    if isinstance(statement, Equation):
        step = 1 if statement.tolerance is None else 3 * sp.sympify(statement.tolerance, strict=True)
        return replace(statement, printed=shifted(statement.printed, step))
    if isinstance(statement, Bound):
        return replace(statement, relation=OPPOSITE[statement.relation])
    if isinstance(statement, Optimum):
        return replace(statement, value=2 * sp.sympify(statement.value, strict=True))
    return Property(("spoiled", statement.printed), statement.derived)


def shifted(side: Any, step: Any) -> Any:
    """The last entry of a side moved by ``step``."""
    if isinstance(side, sp.MatrixBase):
        entries = list(side)
        return type(side)(side.rows, side.cols, [*entries[:-1], entries[-1] + step])
    if isinstance(side, (tuple, list)):
        return (*side[:-1], side[-1] + step)
    return side + step


# -- one-token mutants -----------------------------------------------------------------------

SWAPS = {
    sp.sin: sp.cos, sp.cos: sp.sin, sp.tan: sp.cot, sp.cot: sp.tan, sp.sec: sp.csc, sp.csc: sp.sec,
    sp.sinh: sp.cosh, sp.cosh: sp.sinh, sp.exp: sp.cosh, sp.log: sp.exp, sp.asin: sp.atan, sp.acos: sp.asin,
}  # fmt: skip


def mutants(expression: sp.Expr) -> list[sp.Expr]:
    """All different formulas one token away, in a fixed order, without undefined and complex ones."""
    expression = sp.sympify(expression, strict=True)
    symbols = sorted(expression.free_symbols, key=str)
    found = (mutant for mutant in changed(expression, symbols) if mutant != expression)
    finite = (m for m in found if not m.has(sp.nan, sp.zoo, sp.oo, -sp.oo, sp.I))
    return list(dict.fromkeys(finite))


def changed(node: sp.Basic, symbols: list[sp.Symbol]) -> Iterator[sp.Expr]:
    """Mutants of a tree: of its root, then of each argument put back into the root."""
    yield from changed_root(node, symbols)
    for place, argument in enumerate(node.args):
        for mutant in changed(argument, symbols):
            yield node.func(*node.args[:place], mutant, *node.args[place + 1 :])


def changed_root(node: sp.Basic, symbols: list[sp.Symbol]) -> Iterator[sp.Expr]:
    if isinstance(node, sp.Rational):
        yield from (-node, node + 1, node - 1, 2 * node)
    elif isinstance(node, sp.Symbol):
        yield from (-node, 2 * node, *(other for other in symbols if other != node))
    elif isinstance(node, (sp.Add, sp.Mul)):
        yield from changed_list(node)
    elif isinstance(node, sp.Pow):
        yield from (-node, node.base, sp.Pow(node.base, node.exp + 1))
    elif node.func in SWAPS:
        swap: Callable[..., sp.Expr] = SWAPS[node.func]
        yield from (-node, swap(*node.args))


def changed_list(node: sp.Add | sp.Mul) -> Iterator[sp.Expr]:
    """A sum or product with one member negated, dropped or doubled."""
    for place, member in enumerate(node.args):
        rest = [*node.args[:place], *node.args[place + 1 :]]
        yield node.func(-member, *rest)
        yield node.func(*rest)
        yield node.func(member, member, *rest)
