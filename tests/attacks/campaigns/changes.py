"""Mutants of a statement refuted at exact points by balls, before anything is proved.

Each kind of statement has a table of its values at exact points of the box. A mutant falls at the
first point at which both sides have a value and the ball excludes what is asserted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp
from flint import arb

from navsym.claims import Bound, Box, Equation, Optimum
from navsym.core.balls import UnsupportedError
from navsym.prove.equations import EXCLUDES, list_entries
from navsym.prove.sampling.points import Point, draw_points
from tests.attacks.campaigns.edited_values import Values, values_at
from tests.attacks.campaigns.edits import Edit, apply_edit, list_edits, rearrange, widen

POINTS = 32
GRID = 16

Assertion = Equation | Bound | Optimum
FIELDS = ("dual", "support", "weights", "value")


@dataclass(frozen=True, slots=True, eq=False)
class Change:
    """One way of spoiling a statement.

    part  : number of the entry of the printed side, in the order of :func:`printed_parts`
    edit  : one token of that entry, or
    order : another order of the entries, or
    box   : a wider box
    """

    kind: str
    part: int = 0
    edit: Edit | None = None
    order: tuple[int, ...] | None = None
    box: Box | None = None


def printed_parts(statement: Assertion) -> list[sp.Expr]:
    """The printed formulas of a statement."""
    if isinstance(statement, Optimum):
        return [part for name in FIELDS for part in list_entries(getattr(statement, name))]
    return list_entries(statement.printed)


def changes(statement: Assertion) -> Iterator[Change]:
    """Every one-token change of every printed formula, every rearrangement, every wider range."""
    for part, formula in enumerate(printed_parts(statement)):
        for edit in list_edits(formula):
            yield Change(edit.kind, part, edit)
    if isinstance(statement, Equation):
        for kind, order in rearrange(statement.printed):
            if any(
                list_entries(statement.printed)[k] != list_entries(statement.printed)[p] for k, p in enumerate(order)
            ):
                yield Change(kind, order=tuple(order))
    for box in widen(statement.box):
        yield Change("range", box=box)


def replace_parts(statement: Assertion, parts: Sequence[sp.Expr]) -> Assertion:
    """The statement with other printed formulas."""
    if isinstance(statement, Optimum):
        fields: dict[str, Any] = {}
        rest = list(parts)
        for name in FIELDS:
            whole = getattr(statement, name)
            count = len(list_entries(whole))
            fields[name] = tuple(rest[:count]) if isinstance(whole, (tuple, list)) else rest[0]
            rest = rest[count:]
        return replace(statement, **fields)
    if isinstance(statement.printed, sp.MatrixBase):
        return replace(statement, printed=sp.Matrix(*statement.printed.shape, list(parts)))
    several = isinstance(statement.printed, (tuple, list))
    return replace(statement, printed=tuple(parts) if several else parts[0])


def apply_change(statement: Assertion, change: Change) -> Assertion:
    """The statement with the change made, as sympy builds it; of an equation only the entry that changed."""
    if isinstance(statement, Equation) and change.edit is not None:
        old, derived = printed_parts(statement)[change.part], derived_parts(statement)[change.part]
        return replace(statement, printed=apply_edit(old, change.edit), derived=derived)
    if change.box is not None:
        return replace(statement, box=change.box)
    parts = printed_parts(statement)
    if change.order is not None:
        return replace_parts(statement, [parts[place] for place in change.order])
    assert change.edit is not None
    parts[change.part] = apply_edit(parts[change.part], change.edit)
    return replace_parts(statement, parts)


# -- tables of values ------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Row:
    """One exact point: the balls of all nodes, and those of the derived entries."""

    point: Point
    values: Values
    derived: tuple[arb, ...]


def rows(statement: Assertion, count: int = POINTS) -> list[Row]:
    """The first points of the box with the derived side evaluated there."""
    derived = derived_parts(statement)
    symbols = free_symbols(statement)
    found = []
    for point in draw_points(symbols, statement.box, count):
        values = values_at(point)
        found.append(Row(point, values, tuple(values.of(part) for part in derived)))
    return found


def derived_parts(statement: Assertion) -> list[sp.Expr]:
    """What the printed formulas are compared with: the derived side, or the functional of an optimum."""
    return list_entries(statement.functional if isinstance(statement, Optimum) else statement.derived)


def free_symbols(statement: Assertion) -> list[sp.Symbol]:
    """The parameters of a statement, in order of their names."""
    found = set().union(*(part.free_symbols for part in (*printed_parts(statement), *derived_parts(statement))))
    if isinstance(statement, Optimum):
        inside = sp.Tuple(*statement.regressors, *statement.interval).free_symbols
        found = (found | inside) - {statement.variable}
    return sorted(found, key=str)


def is_excluded(statement: Equation | Bound, printed: arb, derived: arb) -> bool:
    """True when two finite balls contradict the statement."""
    if not (printed.is_finite() and derived.is_finite()):
        return False
    if isinstance(statement, Bound):
        return EXCLUDES[statement.relation](printed - derived)
    if statement.tolerance is None:
        return not (printed - derived).contains(0)
    tolerance = sp.sympify(statement.tolerance, strict=True)
    return bool(abs(printed - derived) > values_at({}).of(tolerance))


def find_refuting_point(statement: Assertion, change: Change, table: Sequence[Row]) -> int | None:
    """Number of the first point at which the changed statement falls, or None."""
    optimum = isinstance(statement, Optimum)
    has_fallen: Callable[[Any, Change, Row], bool] = has_optimum_fallen if optimum else has_formula_fallen
    for place, row in enumerate(table):
        try:
            if has_fallen(statement, change, row):
                return place
        except UnsupportedError:
            return None
    return None


def has_formula_fallen(statement: Equation | Bound, change: Change, row: Row) -> bool:
    """True when the changed printed side contradicts the derived one at a point: the rearranged entries, or one edited.

    Raises UnsupportedError outside the language of balls.
    """
    parts = printed_parts(statement)
    if change.order is not None:
        balls = [row.values.of(parts[place]) for place in change.order]
        return any(is_excluded(statement, ball, row.derived[k]) for k, ball in enumerate(balls))
    assert change.edit is not None
    ball = row.values.evaluate_edited(parts[change.part], change.edit)
    return is_excluded(statement, ball, row.derived[change.part])


def has_optimum_fallen(statement: Optimum, change: Change, row: Row) -> bool:
    """Constraints, equal values, instants inside and the modulus of the dual polynomial, at one point."""
    assert change.edit is not None
    parts = printed_parts(statement)
    balls = [
        row.values.evaluate_edited(part, change.edit) if place == change.part else row.values.of(part)
        for place, part in enumerate(parts)
    ]
    if not all(ball.is_finite() for ball in balls):
        return False
    m, n = len(statement.dual), len(statement.support)
    return has_proof_fallen(statement, row, (balls[:m], balls[m : m + n], balls[m + n : m + 2 * n], balls[-1]))


def has_proof_fallen(statement: Optimum, row: Row, parts: tuple[list[arb], list[arb], list[arb], arb]) -> bool:
    """True when balls of dual, support, weights and value contradict an optimum at one point.

    Looked at: instants inside, ``sum w_k H(t_k) = P``, the value against ``x . P`` and against ``sum |w_k|``, and
    ``|x . H| <= 1`` on a grid of the interval. Raises UnsupportedError outside the language of balls.
    """
    dual, support, weights, value = parts
    start, end = (row.values.of(sp.sympify(side, strict=True)) for side in statement.interval)
    if any(at < start or at > end for at in support):
        return True
    columns = [regressors_at(statement, row, at) for at in support]
    for i, wanted in enumerate(row.derived):
        if are_apart(sum((w * column[i] for w, column in zip(weights, columns, strict=True)), arb(0)), wanted):
            return True
    of_dual = sum((x * p for x, p in zip(dual, row.derived, strict=True)), arb(0))
    if are_apart(value, of_dual) or are_apart(sum((abs(w) for w in weights), arb(0)), value):
        return True
    grid = (start + (end - start) * k / GRID for k in range(GRID + 1))
    return any(bool(abs(product(dual, regressors_at(statement, row, at))) > 1) for at in grid)


def product(left: Sequence[arb], right: Sequence[arb]) -> arb:
    """Scalar product of two rows of balls of one length."""
    return sum((a * b for a, b in zip(left, right, strict=True)), arb(0))


def regressors_at(statement: Optimum, row: Row, at: arb) -> list[arb]:
    """Balls of H(t) at an instant, with the parameters of the row's point; raises UnsupportedError."""
    values = Values({**row.values.point, statement.variable: at})
    return [values.of(sp.sympify(h, strict=True)) for h in statement.regressors]


def are_apart(left: arb, right: arb) -> bool:
    """True when two balls are finite and have no number in common."""
    return bool(left.is_finite() and right.is_finite() and not (left - right).contains(0))
