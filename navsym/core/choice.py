"""One word among those that are known; the closest one is suggested."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from navsym.core.errors import DomainError


def one_of(value: str, known: Iterable[str], where: str) -> str:
    """The value itself; raises DomainError, with the known word that comes closest, where it is none of them."""
    words, given = list(known), str(value) if isinstance(value, str) else type(value).__name__
    if given in words:
        return given
    close = difflib.get_close_matches(given[:60].lower(), [word.lower() for word in words], n=1)
    meant = next((word for word in words if close and word.lower() == close[0]), None)
    advice = f"did you mean {meant}?" if meant else "name one of them"
    raise DomainError(f"expected one of {', '.join(words)}; got {given[:60]}; {advice}", where=where)
