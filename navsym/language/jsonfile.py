"""Strict JSON: finite numbers, no key twice, bounded size and depth."""

from __future__ import annotations

import json
import math
import os
from typing import Any

from navsym.core.errors import DuplicateError, ExpressionSyntaxError, NotFiniteError, TooLargeError
from navsym.language.files import decode, name_file, read_bytes
from navsym.language.names import join_places, quote, too_deep

SIZE = 16_000_000  # bytes
DEPTH = 64
CONTAINERS = 1_000_000  # lists and tables in one document


def read_json(path: str | os.PathLike[str], *, limit: int = SIZE) -> Any:
    """The document in a JSON file: dicts, lists, strings, ints, finite floats, booleans, None.

    Raises NavsymError of kind ``missing-file``, EmptyError, ExpressionSyntaxError (with line and column),
    DuplicateError, NotFiniteError (NaN, Infinity, 1e999) or TooLargeError; ``where`` is ``"file: key"``.
    """
    return parse_json(read_bytes(path, limit), name_file(path))


def parse_json(data: bytes | str, where: str = "") -> Any:
    """Like :func:`read_json` for what is in memory already."""
    text = decode(data if isinstance(data, bytes) else data.encode("utf-8", "replace"), where)
    if text.count("[") + text.count("{") > CONTAINERS:
        message = f"expected at most {CONTAINERS} lists and tables; got more; split the document"
        raise TooLargeError(message, where=where)
    try:
        document = json.loads(text, object_pairs_hook=lambda pairs: require_unique_keys(pairs, where))
    except json.JSONDecodeError as failure:
        place = f"line {failure.lineno}, column {failure.colno}"
        near = quote(text[failure.pos : failure.pos + 20])
        message = f"expected JSON ({failure.msg}); got {near}; correct it there"
        raise ExpressionSyntaxError(message, where=f"{where}: {place}" if where else place) from None
    except RecursionError:
        raise too_deep(DEPTH, where) from None
    except ValueError:  # an integer beyond the interpreter's limit of digits
        raise too_many_digits(where) from None
    check_document(document, where)
    return document


def require_unique_keys(pairs: list[tuple[str, Any]], where: str) -> dict[str, Any]:
    """The pairs as a table, when no key comes twice."""
    table = dict(pairs)
    if len(table) < len(pairs):
        seen: set[str] = set()
        twice = next(key for key, _ in pairs if key in seen or seen.add(key))  # type: ignore[func-returns-value]
        message = f"expected every key once; got {quote(twice)} again; remove one of them"
        raise DuplicateError(message, where=join_places(where, (twice,)))
    return table


def check_document(document: Any, where: str) -> None:
    """Walk without recursion: every number finite, every string valid text, nothing too deep."""
    stack: list[tuple[Any, tuple[Any, ...]]] = [(document, ())]
    while stack:
        value, path = stack.pop()
        if isinstance(value, (dict, list)):
            if len(path) > DEPTH:
                raise too_deep(DEPTH, join_places(where, path[:4]))
            items = value.items() if isinstance(value, dict) else enumerate(value)
            for key, item in items:
                if isinstance(item, (dict, list)):
                    stack.append((item, (*path, key)))
                elif type(item) is not bool:
                    check_leaf(item, where, path, key)
                if isinstance(key, str):
                    check_text(key, where, path, "")
        elif not path:
            check_leaf(value, where, (), "")


def check_leaf(value: Any, where: str, path: tuple[Any, ...], key: Any) -> None:
    """Refuse a number that is not finite or does not fit a double, and broken text."""
    if isinstance(value, float):
        if not math.isfinite(value):
            got = "NaN" if value != value else "an infinite number"
            message = f"expected a finite number; got {got}; replace or remove it"
            raise NotFiniteError(message, where=join_places(where, (*path, key)))
    elif isinstance(value, str):
        check_text(value, where, path, key)
    elif isinstance(value, int) and value.bit_length() > 1023:
        raise too_many_digits(join_places(where, (*path, key)))


def check_text(value: str, where: str, path: tuple[Any, ...], key: Any) -> None:
    """Refuse lone surrogates, which no output can carry."""
    if not value.isascii() and any("\ud800" <= char <= "\udfff" for char in value):
        message = f"expected valid Unicode; got a lone surrogate in {quote(value)}; remove it"
        raise ExpressionSyntaxError(message, where=join_places(where, (*path, key)))


def too_many_digits(where: str) -> TooLargeError:
    """The error for an integer that no double holds."""
    return TooLargeError("expected integers below 2**1023; got a larger one; rescale it", where=where)
