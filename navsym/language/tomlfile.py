"""Strict TOML: decimals kept as their text, no key twice, bounded size and depth."""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Mapping
from typing import Any

from navsym.core.errors import DuplicateError, ExpressionSyntaxError, NavsymError, NotFiniteError, TooLargeError
from navsym.language.files import decode, name_file, read_bytes
from navsym.language.names import join_places, quote, too_deep

SIZE = 256_000  # bytes: the reader of the standard library does about a megabyte a second
DEPTH = 16  # nesting of brackets, and parts of a dotted key
INTEGER_BITS = 3_300

PIECE = re.compile(
    r'"""(?:[^"\\]|\\.|"(?!""))*"""|\'\'\'(?:[^\']|\'(?!\'\'))*\'\'\'|"(?:[^"\\\n]|\\.)*"|\'[^\'\n]*\''
    r"|#[^\n]*|[\[\]{}=,\n.]",
    re.DOTALL,
)
LINE = re.compile(r"\(at line (\d+), column (\d+)\)|\(at end of document\)")
TWICE = ("Cannot overwrite", "Cannot declare", "Duplicate", "Cannot mutate", "Cannot redefine", "Can not")


class Numeral(str):
    """A TOML decimal as it was written, so that 0.1 stays one tenth."""

    __slots__ = ()


def read_toml(path: str | os.PathLike[str], *, limit: int = SIZE) -> dict[str, Any]:
    """The document in a TOML file; decimals come as :class:`Numeral`, dates are refused.

    Raises NavsymError of kind ``missing-file``, EmptyError, ExpressionSyntaxError (with line and column),
    DuplicateError, NotFiniteError (nan, inf) or TooLargeError; ``where`` is ``"file: key"``.
    """
    return parse_toml(read_bytes(path, limit), name_file(path))


def parse_toml(data: bytes | str, where: str = "") -> dict[str, Any]:
    """Like :func:`read_toml` for what is in memory already."""
    text = decode(data if isinstance(data, bytes) else data.encode("utf-8", "replace"), where)
    bound_nesting(text, where)
    try:
        document = tomllib.loads(text, parse_float=lambda digits: Numeral(digits.replace("_", "").lower()))
        check_values(document, where, ())
    except tomllib.TOMLDecodeError as failure:
        raise syntax_error(str(failure), where) from None
    except RecursionError:
        raise too_deep(DEPTH, where) from None
    except ValueError:  # an integer beyond the interpreter's limit of digits, an impossible date
        message = "expected numbers below 1000 digits and real dates; got another; correct it"
        raise TooLargeError(message, where=where) from None
    return document


def syntax_error(message: str, where: str) -> NavsymError:
    """The reader's complaint as one of ours, with its line and column."""
    found = LINE.search(message)
    line = f"line {found[1]}, column {found[2]}" if found and found[1] else "the end"
    place = f"{where}: {line}" if where else line
    what = quote(LINE.sub("", message).strip(), 80)[1:-1]
    if message.startswith(TWICE):
        got = f"one twice ({what})"
        return DuplicateError(f"expected every key and table once; got {got}; remove one", where=place)
    advice = "correct it there (keys are ASCII, names and formulas stand in quotation marks)"
    return ExpressionSyntaxError(f"expected TOML; got an error ({what}); {advice}", where=place)


def bound_nesting(text: str, where: str) -> None:
    """Refuse deep brackets and long dotted keys before the recursive reader sees them."""
    depth = dots = row = 0
    for match in PIECE.finditer(text):
        piece = match[0]
        row += piece.count("\n")
        if piece in ("[", "{"):
            depth, dots = depth + 1, 0
        elif piece in ("]", "}"):
            depth = max(0, depth - 1)
        elif piece == ".":
            dots += 1
        elif piece in ("\n", "=", ","):
            dots = 0
        if depth > DEPTH or dots > DEPTH:
            raise too_deep(DEPTH, f"{where}: line {row + 1}" if where else f"line {row + 1}")


def check_values(value: Any, where: str, path: tuple[Any, ...]) -> None:
    """Every number finite and of bounded size, and no dates."""
    if isinstance(value, (dict, list)):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            check_values(item, where, (*path, key))
    elif isinstance(value, Numeral):
        if value.lstrip("+-") in ("nan", "inf"):
            message = f"expected a finite number; got {value}; replace it"
            raise NotFiniteError(message, where=join_places(where, path))
    elif isinstance(value, int):
        if value.bit_length() > INTEGER_BITS:
            message = f"expected at most {INTEGER_BITS} bits; got {value.bit_length()}; rescale"
            raise TooLargeError(message, where=join_places(where, path))
    elif not isinstance(value, str):
        message = f"expected text or a number; got a {type(value).__name__}; put it in quotes or remove it"
        raise ExpressionSyntaxError(message, where=join_places(where, path))


def toml_text(document: Mapping[str, Any]) -> str:
    """TOML text of tables: ``parse_toml(toml_text(d)) == d``.

    document : table -> its keys, or a list of such tables ([[table]] blocks); values are texts, integers, truth values,
               and lists and tables of them
    """
    blocks = []
    for table, content in document.items():
        heads = [(f"[{toml_key(table)}]", content)]
        if isinstance(content, list):
            heads = [(f"[[{toml_key(table)}]]", block) for block in content]
        for head, keys in heads:
            lines = [f"{toml_key(key)} = {toml_value(value)}" for key, value in keys.items()]
            blocks.append("\n".join([head, *lines]))
    return "\n\n".join(blocks) + "\n"


def toml_key(key: str) -> str:
    """A key, in quotes where it is not bare."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else toml_value(key)


def toml_value(value: Any) -> str:
    """A text in quotes, an integer, a list or a table; the rows of a matrix stand below each other."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{toml_key(key)} = {toml_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, int):
        return str(value).lower()
    if isinstance(value, list) and value and isinstance(value[0], list):
        return "[\n" + "".join(f"  {toml_value(row)},\n" for row in value) + "]"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml_value(item) for item in value) + "]"
    escaped = str(value).replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\U{ord(c):08x}" for c in escaped) + '"'
