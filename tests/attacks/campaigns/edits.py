"""Spoiled statements and one-token mutants: what a check must be able to notice.

A statement that cannot fall proves nothing. ``spoil`` makes a statement wrong in its printed
side; ``list_edits`` lists every change of one token of a formula and ``list_mutants`` the formulas that come
of them, equivalent ones included; ``rearrange`` and ``widen`` change the order of entries and a range.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from navsym.claims.statement import Bound, Box, Equation, Optimum, Property, Statement
from navsym.prove.sampling.points import range_of

OPPOSITE = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "=": "!=", "!=": "="}


def spoil(statement: Statement) -> Statement:
    """The statement with its printed side changed so that it should not hold any more."""
    if isinstance(statement, Equation):
        step = 1 if statement.tolerance is None else 3 * sp.sympify(statement.tolerance, strict=True)
        return replace(statement, printed=shift(statement.printed, step))
    if isinstance(statement, Bound):
        return replace(statement, relation=OPPOSITE[statement.relation])
    if isinstance(statement, Optimum):
        return replace(statement, value=2 * sp.sympify(statement.value, strict=True))
    return Property(("spoiled", statement.printed), statement.derived)


def shift(side: Any, step: Any) -> Any:
    """The last entry of a side moved by ``step``."""
    if isinstance(side, sp.MatrixBase):
        entries = list(side)
        return type(side)(side.rows, side.cols, [*entries[:-1], entries[-1] + step])
    if isinstance(side, (tuple, list)):
        return (*side[:-1], side[-1] + step)
    return side + step


# -- one-token mutants -----------------------------------------------------------------------

SWAPS = {
    sp.sin: sp.cos,
    sp.cos: sp.sin,
    sp.tan: sp.cot,
    sp.cot: sp.tan,
    sp.sec: sp.csc,
    sp.csc: sp.sec,
    sp.sinh: sp.cosh,
    sp.cosh: sp.sinh,
    sp.exp: sp.cosh,
    sp.log: sp.exp,
    sp.asin: sp.atan,
    sp.acos: sp.asin,
}

#: Kinds of changes: of one token, of the order of entries, of a range.
TOKENS = ("sign", "number", "factor", "power", "function", "index", "dropped", "doubled")
KINDS = (*TOKENS, "transposed", "permuted", "range")

Path = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Edit:
    """One token changed: the place in the tree, the kind of change and what stands there instead."""

    path: Path
    kind: str
    replacement: sp.Basic


def list_edits(expression: sp.Basic) -> Iterator[Edit]:
    """Every change of one token, in a fixed order; what equals the original node is left out."""
    symbols = sorted(expression.free_symbols, key=str)
    yield from list_edits_below(expression, symbols, ())


def list_edits_below(node: sp.Basic, symbols: list[sp.Symbol], path: Path) -> Iterator[Edit]:
    for kind, replacement in change_root(node, symbols):
        if replacement != node:
            yield Edit(path, kind, replacement)
    for place, argument in enumerate(node.args):
        yield from list_edits_below(argument, symbols, (*path, place))


def apply_edit(expression: sp.Basic, edit: Edit) -> sp.Expr:
    """The formula with one token changed, as sympy builds it."""
    return replace_node(expression, edit.path, edit.replacement)


def replace_node(node: sp.Basic, path: Path, replacement: sp.Basic) -> Any:
    if not path:
        return replacement
    place, *rest = path
    changed = replace_node(node.args[place], tuple(rest), replacement)
    return node.func(*node.args[:place], changed, *node.args[place + 1 :])


def list_mutants(expression: sp.Expr) -> list[sp.Expr]:
    """All different formulas one token away, in a fixed order, without undefined and complex ones."""
    expression = sp.sympify(expression, strict=True)
    found = (apply_edit(expression, edit) for edit in list_edits(expression))
    return list(dict.fromkeys(mutant for mutant in found if mutant != expression and is_formula(mutant)))


def sample_mutants(expression: sp.Expr, most: int, source: random.Random) -> list[sp.Expr]:
    """At most so many different formulas one token away, drawn at random; only those drawn are built."""
    edits = list(list_edits(expression))
    source.shuffle(edits)
    mutants = (apply_edit(expression, edit) for edit in edits)
    kept = (mutant for mutant in mutants if mutant != expression and is_formula(mutant))
    found: dict[sp.Expr, None] = {}
    while len(found) < most and (mutant := next(kept, None)) is not None:
        found[mutant] = None
    return list(found)


def is_formula(mutant: sp.Basic) -> bool:
    """False for what sympy has evaluated to something undefined or complex."""
    return not mutant.has(sp.nan, sp.zoo, sp.oo, -sp.oo, sp.I)


def change_root(node: sp.Basic, symbols: list[sp.Symbol]) -> Iterator[tuple[str, sp.Basic]]:
    if isinstance(node, sp.Rational):
        yield from (("sign", -node), ("number", node + 1), ("number", node - 1), ("factor", 2 * node))
    elif isinstance(node, sp.Symbol):
        yield from (("sign", -node), ("factor", 2 * node))
        yield from (("index", other) for other in symbols if other != node)
    elif isinstance(node, (sp.Add, sp.Mul)):
        yield from change_members(node)
    elif isinstance(node, sp.Pow):
        yield from (("sign", -node), ("power", node.base), ("power", sp.Pow(node.base, node.exp + 1)))
    elif node.func in SWAPS:
        swap: Callable[..., sp.Expr] = SWAPS[node.func]
        yield from (("sign", -node), ("function", swap(*node.args)))


def change_members(node: sp.Add | sp.Mul) -> Iterator[tuple[str, sp.Basic]]:
    """A sum or product with one member negated, dropped or doubled."""
    for place, member in enumerate(node.args):
        rest = [*node.args[:place], *node.args[place + 1 :]]
        yield "sign", node.func(-member, *rest)
        yield "dropped", node.func(*rest)
        yield "doubled", node.func(member, member, *rest)


# -- the order of entries, and ranges ----------------------------------------------------------


def rearrange(side: Any) -> Iterator[tuple[str, list[int]]]:
    """Orders of the entries of a matrix or sequence, transposed or with two neighbours exchanged."""
    if isinstance(side, sp.MatrixBase):
        rows, columns = side.shape
        table = [[i * columns + j for j in range(columns)] for i in range(rows)]
        if rows == columns > 1:
            yield "transposed", [table[j][i] for i in range(rows) for j in range(columns)]
        for k in range(rows - 1):
            swapped = [*table[:k], table[k + 1], table[k], *table[k + 2 :]]
            yield "permuted", [place for row in swapped for place in row]
        for k in range(columns - 1):
            yield "permuted", [row[exchange(j, k)] for row in table for j in range(columns)]
    elif isinstance(side, (tuple, list)):
        for k in range(len(side) - 1):
            yield "permuted", [exchange(j, k) for j in range(len(side))]


def exchange(place: int, k: int) -> int:
    """Places k and k + 1 exchanged."""
    return {k: k + 1, k + 1: k}.get(place, place)


def widen(box: Box) -> Iterator[Box]:
    """The box with one end of one range moved out by the width of the range, where the symbol allows it."""
    for symbol, (lower, upper) in box.items():
        if lower is None or upper is None:
            continue
        low, high = (sp.sympify(end, strict=True) for end in (lower, upper))
        for ends in ((2 * low - high, high), (low, 2 * high - low)):
            wider = {**box, symbol: ends}
            if range_of(symbol, wider) != range_of(symbol, box):
                yield wider
