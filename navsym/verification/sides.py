"""What a statement says, as text: its two sides for people, and the hash under which its certificate is kept."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

import sympy as sp

from navsym.claims import Bound, Equation, Optimum, Property, Statement, Worded
from navsym.prove.wording import expression_text


def sides(statement: Statement) -> tuple[str, str]:
    """Printed and derived side in the language of files: as their author wrote them, where that is known."""
    if isinstance(statement, Equation | Bound):
        written = statement.written
        left = side_text(statement.printed, written.left if written else ())
        right = side_text(statement.derived, written.right if written else ())
        if isinstance(statement, Bound):
            return f"{left} {statement.relation} {right}", ""
        limit = written.tolerance if written else statement.tolerance
        return left if limit is None else f"{left} +- {limit if written else side_text(limit)}", right
    if isinstance(statement, Optimum):
        return optimum_text(statement)
    if isinstance(statement, Worded):
        return statement.sides
    assert isinstance(statement, Property)
    return value_text(statement.printed), value_text(statement.derived.value)


def side_text(side: Any, written: Sequence[str] = ()) -> str:
    """One side of a statement as text: a matrix by rows, a tuple, or one expression.

    written : text of each entry, where it is known
    """
    is_list = isinstance(side, sp.MatrixBase | tuple | list)
    texts = written or [expression_text(sp.sympify(entry, strict=True)) for entry in (side if is_list else [side])]
    if isinstance(side, sp.MatrixBase):
        rows = [", ".join(texts[k : k + side.cols]) for k in range(0, len(texts), side.cols or 1)]
        return f"[{', '.join(f'[{row}]' for row in rows)}]"
    return f"({', '.join(texts)})" if is_list else texts[0]


def value_text(value: Any) -> str:
    """A value of a property as text, tuples entry by entry."""
    if isinstance(value, tuple):
        return "(" + ", ".join(value_text(item) for item in value) + ")"
    return value if isinstance(value, str) else str(value)


def optimum_text(statement: Optimum) -> tuple[str, str]:
    """The printed dual, support, weights and value as text, and the regressors and functional."""
    printed = "; ".join(
        f"{name} = {side_text(getattr(statement, name))}" for name in "dual support weights value".split()
    )
    return printed, f"H = {side_text(statement.regressors)}, P = {side_text(statement.functional)}"


def hash_statement(statement: Statement, texts: list[dict[str, Any]] | None) -> str:
    """SHA-256 of a statement: two that differ in what they assert, or for which values, have different ones.

    texts : the statement in the language of the checker; None where it lies outside of it
    """
    text = json.dumps(describe(statement) if texts is None else texts, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def describe(value: Any) -> Any:
    """A statement, or a part of one, as plain data that differs where it differs: symbols with what they declare."""
    if is_dataclass(value):
        return [type(value).__name__, *(describe(getattr(value, field.name)) for field in fields(value))]
    if isinstance(value, Mapping):
        return sorted(([describe(key), describe(item)] for key, item in value.items()), key=str)
    if isinstance(value, (tuple, list, sp.MatrixBase)):
        return [*map(describe, value)]
    if isinstance(value, sp.Basic):
        return [expression_text(value), *sorted(map(sp.srepr, value.free_symbols))]
    return str(value)
