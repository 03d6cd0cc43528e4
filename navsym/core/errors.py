"""Errors that a user can cause and mend.

Each is a :class:`NavsymError`: it has a ``kind`` (one word that programs test), a ``where`` (argument, or file and key
or line) and a message of the form *expected …; got …; remedy*. Nothing else may leave a public function on bad input.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable

#: Longest name.
NAME_LENGTH = 64
#: Foreign text inside a message: it stands in quotes and may hold anything, semicolons too.
QUOTED = re.compile(r"(?<![^\s(\[=:])(['\"]).*?\1(?![A-Za-z])")


def printable(text: str) -> str:
    """The text with every character that is not printable (controls, line ends, half surrogates) written as an escape.

    Names and values of a file stand in messages; they can neither steer a terminal nor feign a second line.
    """
    return "".join(char if char.isprintable() else repr(char)[1:-1] for char in text)


def quote(value: object, limit: int = 40) -> str:
    """Foreign text as it may stand in a message: quoted, escaped, ASCII only, and cut."""
    if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e15:
        return repr(value)
    text = value if isinstance(value, str) else f"{type(value).__name__} {shorten_repr(value, limit)}"
    cut = text[:limit]
    return ascii(cut) + (f" ... ({len(text)} characters)" if len(text) > limit else "")


def shorten_repr(value: object, limit: int) -> str:
    """``repr`` of small things only: that of a huge integer or a deep list costs time or fails."""
    if isinstance(value, int) and value.bit_length() > 200:
        return f"of {value.bit_length()} bits"
    if isinstance(value, (list, tuple, dict)):
        return f"of {len(value)} entries"
    try:
        return repr(value)[:limit]
    except Exception:  # an object of somebody else, which cannot say what it is
        return "without a text"


#: Tables that files of the other kind have in their place.
ELSEWHERE = {"symbols": "parameters", "parameters": "symbols"}


def suggest_nearest(name: str, known: Iterable[str]) -> str:
    """``"did you mean 'omega'?"``, or the list of what there is."""
    choices = sorted(known)
    if not choices:
        return "nothing is declared here"
    close = [other for other in (ELSEWHERE.get(str(name)),) if other in choices]
    close = close or difflib.get_close_matches(str(name)[:NAME_LENGTH], choices[:5000], n=1, cutoff=0.6)
    if close:
        return f"did you mean {close[0]!r}?"
    rest = "" if len(choices) <= 8 else f" and {len(choices) - 8} more"
    return "known are " + ", ".join(repr(choice[:NAME_LENGTH]) for choice in choices[:8]) + rest


class NavsymError(Exception):
    """Base of all errors that are the user's to mend: catch it and ask for its kind.

    Classes that docstrings name, such as NotEstimableError of the kind ``not-estimable``, are below it.

    kind     : one of the words listed in the README under "Errors", such as ``"shape"``
    where    : ``"file: key"``, ``"file: line 3, column 7"`` or ``"prove: left"``; empty where there is no place
    message  : ``"expected …; got …; remedy"``
    expected, got, remedy : the three parts of the message
    status   : exit status of the command line

    >>> import navsym as nav
    >>> try:
    ...     nav.prove(0.1, "=", "x")
    ... except nav.NavsymError as error:
    ...     error.kind, error.where, error.got, error.remedy
    ('domain', 'prove: left', 'the float 0.1', 'write "1/10" or "0.1" as text')
    """

    kind = "input"
    status = 2

    def __init__(self, message: str, *, where: str = "", kind: str | None = None):
        self.message = printable(message)
        self.where = printable(where)
        super().__init__(self.message)
        if kind is not None:
            self.kind = kind

    def __str__(self) -> str:
        return f"{self.where}: {self.message}" if self.where else self.message

    @property
    def expected(self) -> str:
        """What was expected; empty where the message has no such part."""
        return self.parts()[0]

    @property
    def got(self) -> str:
        """What came instead."""
        return self.parts()[1]

    @property
    def remedy(self) -> str:
        """What to do about it, an imperative."""
        return self.parts()[2]

    def parts(self) -> tuple[str, str, str]:
        """The message at its two semicolons; those inside quoted text do not count."""
        start = self.message.find("expected ")
        middle = self.message.find("; got ", start)
        if start < 0 or middle < 0:
            return "", "", self.message
        rest = self.message[middle + 6 :]
        end = QUOTED.sub(lambda found: "-" * len(found[0]), rest).find("; ")
        end = end if end >= 0 else len(rest)
        return self.message[start + 9 : middle], rest[:end], rest[end + 2 :]

    def at(self, where: str) -> NavsymError:
        """The same error with a place put in front of the one it has."""
        place = printable(where)
        self.where = f"{place}: {self.where}" if self.where else place
        return self

    def as_json(self) -> dict[str, dict[str, str]]:
        return {"error": {"kind": self.kind, "where": self.where, "message": self.message}}


class ExpressionSyntaxError(NavsymError):
    """Text that is not an expression of the language."""

    kind = "syntax"


class UnknownSymbolError(NavsymError):
    """A name that the file does not declare."""

    kind = "unknown-symbol"


class ShapeError(NavsymError):
    """An array, matrix or list of the wrong size."""

    kind = "shape"


class NotFiniteError(NavsymError):
    """NaN or an infinity where a number is needed."""

    kind = "not-finite"


class EmptyError(NavsymError):
    """Nothing where something is needed."""

    kind = "empty"


class DuplicateError(NavsymError):
    """The same name or key twice."""

    kind = "duplicate"


class DomainError(NavsymError):
    """A value outside the range in which the question makes sense."""

    kind = "domain"


class InconsistentError(NavsymError):
    """Data that no state explains."""

    kind = "inconsistent"


class NotEstimableError(NavsymError):
    """A functional that the measurements do not determine."""

    kind = "not-estimable"


class UnobservableError(NavsymError):
    """A state, or a combination of states, that no measurement shows."""

    kind = "unobservable"


class OutsideMapError(NavsymError):
    """A position off the map."""

    kind = "outside-map"


class NoDataError(NavsymError):
    """A map cell without a height."""

    kind = "nodata"


class TooLargeError(NavsymError):
    """A request above a stated limit of size, depth, memory or time."""

    kind = "too-large"


class MissingEngineError(NavsymError):
    """Something that this machine lacks; the message says how to get it."""

    kind = "missing"
    status = 3


class OutputError(NavsymError):
    """A file that cannot be written."""

    kind = "output"
