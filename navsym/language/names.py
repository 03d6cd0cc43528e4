"""Keys of tables in files: where one stands, and which ones a format knows.

Apart from :mod:`navsym.language.schema` because files of numbers need no reader of expressions.
"""

from __future__ import annotations

import os
import re
import unicodedata
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from navsym.core.errors import NAME_LENGTH as NAME_LENGTH
from navsym.core.errors import (
    DomainError,
    DuplicateError,
    ExpressionSyntaxError,
    ShapeError,
    TooLargeError,
    UnknownSymbolError,
)
from navsym.core.errors import quote as quote
from navsym.core.errors import suggest_nearest as suggest_nearest

# Names that a file may declare, and how foreign text is quoted in a message.


#: The inverse hyperbolic functions as logarithms with values at the same points: all engines see these.
INVERSES = {"asinh": "log(x + sqrt(x**2 + 1))", "acosh": "log(x + sqrt(x**2 - 1))", "atanh": "log((1 + x)/(1 - x))/2"}

#: Functions of the language; `atan2` takes two arguments, the others one.
FUNCTIONS = (*"sin cos tan cot sec csc exp log sqrt abs asin acos atan atan2 sinh cosh tanh".split(), *INVERSES)

#: Names that have a meaning already.
RESERVED = frozenset({"pi", "oo", *FUNCTIONS})

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def check_name(name: object, *, where: str = "") -> str:
    """The name itself, when a file may declare it: ASCII letters, digits and underscores.

    Raises ExpressionSyntaxError, TooLargeError, or DuplicateError for ``pi``, ``oo`` and the functions.
    """
    if not isinstance(name, str) or (len(name) <= NAME_LENGTH and not NAME.fullmatch(name)):
        expected = "a name: an ASCII letter, then ASCII letters, digits and underscores"
        raise ExpressionSyntaxError(f"expected {expected}; got {quote(name)}; rename it", where=where)
    if len(name) > NAME_LENGTH:
        expected, got = f"a name of at most {NAME_LENGTH} characters", f"{len(name)} of them, {quote(name)}"
        raise TooLargeError(f"expected {expected}; got {got}; shorten it", where=where)
    if name in RESERVED:
        meaning = {"pi": "the number pi", "oo": "infinity"}.get(name, "a function")
        got = f"{name!r}, which already means {meaning}"
        raise DuplicateError(f"expected a new name; got {got}; rename it", where=where)
    return name


def describe_character(char: str) -> str:
    """A character with its code and its Unicode name, so that look-alikes show."""
    code = f"U+{ord(char):04X}"
    name = unicodedata.name(char, "")
    return f"{char!a} ({code} {name})" if name else f"{char!a} ({code})"


Table = Mapping[str, Any]


def require_table(value: Any, where: str, what: str = "values by name") -> dict[str, Any]:
    """An argument that is a mapping, as a dict; an empty one for None. Raises ShapeError for all else."""
    if not isinstance(value, Mapping | None):
        raise ShapeError(f"expected {what}; got {quote(value)}; give a dict", where=where)
    return dict(value or {})


def require_path(value: Any, where: str) -> Path:
    """An argument that is a path, as one. Raises DomainError for all else."""
    if not isinstance(value, str | os.PathLike):
        raise DomainError(f"expected a path; got {quote(value)}; give text or a Path", where=where)
    return Path(value)


def require_flag(value: Any, where: str) -> bool:
    """An argument that is True or False. Raises ShapeError for all else."""
    if not isinstance(value, int):
        raise ShapeError(f"expected True or False; got {quote(value)}; give one of them", where=where)
    return bool(value)


def join_place(where: str, key: object) -> str:
    """The place of a key: ``"file: model.F"``, ``"file: measurement[2].h"``."""
    part = f"[{key}]" if isinstance(key, int) else quote(key)[1:-1]
    if not where:
        return part
    if isinstance(key, int):
        return f"{where}{part}"
    return f"{where}.{part}" if ": " in where else f"{where}: {part}"


def join_places(where: str, path: Iterable[object]) -> str:
    """The place at the end of a path of keys: ``"file: models[2].F"``."""
    text = ""
    for key in path:
        text += f"[{key}]" if isinstance(key, int) else f".{ascii(str(key)[:60])[1:-1]}" if key != "" else ""
    text = text.lstrip(".")
    return f"{where}: {text}" if where and text else where or text or "the document"


def too_deep(depth: int, where: str) -> TooLargeError:
    """The error for too many levels."""
    return TooLargeError(f"expected at most {depth} levels; got more; flatten the document", where=where)


def expect_keys(table: Table, known: Collection[str], where: str) -> None:
    """Refuse a key that the format does not have, naming the one that was probably meant.

    A key that is passed over in silence may be a misspelt one, and then the answer belongs to another question.
    """
    for key in table:
        if key not in known:
            raise ExpressionSyntaxError(describe_unknown(key, known), where=join_place(where, key))


def only_keys(table: Table, known: Collection[str], place: str = "") -> None:
    """The same for tables of numbers, of kind ``unknown-symbol``; whoever knows the file puts it before the place."""
    for key in table:
        if key not in known:
            name = join_place("", key)
            raise UnknownSymbolError(describe_unknown(key, known), where=f"{place}.{name}" if place else name)


def describe_unknown(key: object, known: Collection[str]) -> str:
    """What to say of a key that a format does not have."""
    remedy = f"remove or correct it: {suggest_nearest(str(key), known)}"
    return f"expected one of the keys {', '.join(known)}; got {quote(key)}; {remedy}"


def list_calls(text: str, names: str) -> Iterator[list[str]]:
    """The arguments of each call of some functions in a text, split at the commas outside of brackets.

    >>> list(list_calls("sum(f(k, 2), k, 1, n) + x", "sum|product"))
    [['f(k, 2)', ' k', ' 1', ' n']]
    """
    for call in re.finditer(rf"\b(?:{names})\s*\(", text):
        depth, pieces = 0, [""]
        for letter in text[call.end() :]:
            depth += (letter in "([") - (letter in ")]")
            if depth < 0:
                break
            pieces = [*pieces, ""] if letter == "," and not depth else [*pieces[:-1], pieces[-1] + letter]
        yield pieces
