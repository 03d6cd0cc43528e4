"""What every declarative file needs: known keys, right types, labels, exact entries."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from navsym.core.errors import DuplicateError, EmptyError, ExpressionSyntaxError, ShapeError, TooLargeError
from navsym.language.expression import Expr, Matrix, Parsed, parse_noting
from navsym.language.names import NAME_LENGTH, Table, join_place, quote
from navsym.language.names import expect_keys as expect_keys
from navsym.language.tomlfile import Numeral

LABEL = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.:*'+-]*")
SIDE = 64  # rows of a matrix, entries of a vector


def require_key(table: Table, key: str, where: str) -> Any:
    """The value of a key that must be there."""
    if key not in table:
        raise EmptyError(f"expected the key {key}; got none; add it", where=join_place(where, key))
    return table[key]


LIST_ADVICE = 'write it in brackets with commas: ["1", "0"], and a matrix by its rows: [["0", "1"], ["0", "0"]]'


def as_table(value: Any, where: str) -> Table:
    """The value, when it is a table."""
    if not isinstance(value, dict):
        message = f"expected a table; got {describe_value(value)}; write [name] and keys below it"
        raise ShapeError(message, where=where)
    return value


def as_list(value: Any, where: str, what: str = "a list") -> Sequence[Any]:
    """A list with at least one entry and at most ``SIDE``."""
    if not isinstance(value, list):
        remedy = f"write [[{where.rpartition(': ')[2]}]], with two brackets" if isinstance(value, dict) else LIST_ADVICE
        raise ShapeError(f"expected {what}; got {describe_value(value)}; {remedy}", where=where)
    if not value:
        raise EmptyError(f"expected {what}; got an empty one; fill it in", where=where)
    if len(value) > SIDE:
        message = f"expected {what} of at most {SIDE} entries; got {len(value)}; split it"
        raise TooLargeError(message, where=where)
    return value


def as_text(value: Any, where: str, what: str) -> str:
    """The value, when it is quoted text."""
    if not isinstance(value, str) or isinstance(value, Numeral):
        message = f"expected {what} in quotes; got {describe_value(value)}; quote it"
        raise ExpressionSyntaxError(message, where=where)
    return value


def as_title(value: Any, where: str) -> str:
    """One printable line for people."""
    text = as_text(value, where, "a name")
    if not text.strip():
        raise EmptyError("expected a name; got an empty one; fill it in", where=where)
    if len(text) > 200:
        raise TooLargeError(f"expected at most 200 characters; got {len(text)}; shorten it", where=where)
    if not text.isprintable():
        message = f"expected one printable line; got {quote(text)}; remove the control characters"
        raise ExpressionSyntaxError(message, where=where)
    return text


def as_label(value: Any, where: str) -> str:
    """A short ASCII label: ``"velocity"``, ``"double-angle"``, ``"4.8*"``."""
    text = as_text(value, where, "a label")
    if not text:
        raise EmptyError("expected a label; got an empty one; fill it in", where=where)
    if len(text) > NAME_LENGTH:
        message = f"expected at most {NAME_LENGTH} characters; got {len(text)}; shorten it"
        raise TooLargeError(message, where=where)
    if not LABEL.fullmatch(text):
        message = f"expected ASCII letters, digits and _ . : * ' + -; got {quote(text)}; rename it"
        raise ExpressionSyntaxError(message, where=where)
    return text


def require_distinct(names: Iterable[str], where: str) -> None:
    """Refuse a name that comes twice."""
    seen: set[str] = set()
    for name in names:
        if name in seen:
            message = f"expected distinct names; got {quote(name)} twice; rename one of them"
            raise DuplicateError(message, where=where)
        seen.add(name)


def read_entry(value: Any, symbols: Mapping[str, Expr], where: str) -> Expr:
    """An exact expression from quoted text, or from a bare TOML number by its digits."""
    return read_entry_noting(value, symbols, where).expression


def read_entry_noting(value: Any, symbols: Mapping[str, Expr], where: str) -> Parsed:
    """Like :func:`read_entry`, together with the divisors of the text."""
    return parse_noting(as_formula(value, where), symbols, where=where)


def as_formula(value: Any, where: str) -> str:
    """The quoted text of a formula, or the digits of a whole number."""
    if isinstance(value, bool) or not isinstance(value, int | str):
        message = f'expected an expression in quotes; got {describe_value(value)}; write it as "1/2"'
        raise ExpressionSyntaxError(message, where=where)
    return str(value)


def read_vector(value: Any, symbols: Mapping[str, Expr], where: str, size: int, why: str) -> tuple[Expr, ...]:
    """A list of ``size`` expressions."""
    items = as_list(value, where, "a list of expressions")
    if len(items) != size:
        message = f"expected {size} entries, {why}; got {len(items)}; correct the list"
        raise ShapeError(message, where=where)
    return tuple(read_entry(item, symbols, join_place(where, i)) for i, item in enumerate(items))


def read_square(value: Any, symbols: Mapping[str, Expr], where: str, size: int, why: str) -> Matrix:
    """A ``size`` by ``size`` matrix from a list of rows."""
    rows = as_list(value, where, "a list of rows")
    if len(rows) != size:
        message = f"expected {size} rows, {why}; got {len(rows)}; correct the matrix"
        raise ShapeError(message, where=where)
    return Matrix([list(read_vector(row, symbols, join_place(where, i), size, why)) for i, row in enumerate(rows)])


def describe_value(value: Any) -> str:
    """What a TOML value is, in words."""
    names = {bool: "true or false", int: "a number", Numeral: "a decimal", dict: "a table", list: "a list"}
    return names.get(type(value), quote(value))
