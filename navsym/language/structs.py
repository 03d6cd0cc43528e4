"""Documents as structures: the keys and kinds of values that a format has, checked by msgspec."""

from __future__ import annotations

import re
from typing import Any, TypeVar

import msgspec

from navsym.core.errors import DomainError, shorten_repr

T = TypeVar("T")

#: What msgspec says of a value, and where: ``Expected `int` >= 1 - at `$.jobs```.
REASON = re.compile(r"(?P<said>.*?)(?: - at `\$\.?(?P<path>.*)`)?", re.DOTALL)
#: What it wanted and what it got, in the forms that differ.
WANTED = re.compile(r"Expected (?P<wanted>.*?)(?:, got (?P<got>.*))?", re.DOTALL)


def fit_struct(document: Any, struct: type[T]) -> T:
    """The document as a value of a ``msgspec.Struct``.

    Raises DomainError that names the key: unknown, missing, of another type, or outside its range.
    """
    try:
        return msgspec.convert(document, struct)
    except msgspec.ValidationError as failure:
        found = REASON.fullmatch(str(failure))
        said, path = (found["said"], found["path"] or "") if found else (str(failure), "")
        wanted = WANTED.fullmatch(said)
        if wanted is None:  # an unknown or missing key, a word that is not in the list
            known = ", ".join(field.name for field in msgspec.structs.fields(struct))  # type: ignore[arg-type]
            message = f"expected the keys and words of this document; got {said.replace('`', '')}; keys are {known}"
            raise DomainError(f"{path}: {message}" if path else message) from None
        is_there = isinstance(document, dict) and path in document
        got = shorten_repr(document[path], 60) if is_there else wanted["got"] or "another"
        message = f"expected {wanted['wanted']}; got {got}; correct it".replace("`", "")
        raise DomainError(f"{path}: {message}" if path else message) from None
