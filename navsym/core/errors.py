"""What navsym says when it cannot do what was asked.

Every error a user can cause is a :class:`NavsymError`: it has a ``kind`` (one word that
programs test), a ``where`` (file and key or line) and a message of the form *expected …;
got …; do …*. Nothing else may leave a public function on bad input.
"""

from __future__ import annotations


def printable(text: str) -> str:
    """The text with every character that is not printable (controls, line ends, half surrogates) written as an escape.

    Names and values of a file stand in messages; they can neither steer a terminal nor feign a second line.
    """
    return "".join(char if char.isprintable() else repr(char)[1:-1] for char in text)


class NavsymError(Exception):
    """Base of all errors that are the user's to mend.

    kind   : one of the words listed in the README under "Errors", such as ``"shape"``
    where  : ``"file: key"`` or ``"file: line 3, column 7"``; empty when there is no file
    status : exit status of the command line
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
