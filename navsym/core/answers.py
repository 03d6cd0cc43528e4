"""Answers: each shows itself in one line, gives the document of its verb, can be checked, exported and plotted."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


class Answer:
    """Base of the answers of the front door; each adds ``document`` and a ``__repr__`` of one line.

    Checking, exporting and plotting belong to rooms above the subjects; they are reached by their public names, so that
    no subject imports what stands on it.
    """

    __slots__ = ()

    def document(self) -> dict[str, Any]:
        """The answer as plain data: the JSON document of the verb."""
        raise NotImplementedError

    def check(self) -> Any:
        """Replay the certificates of this answer in the independent checker: :func:`navsym.check`."""
        import navsym

        return navsym.check(self)

    def export(self, to: str | list[str] = "c", out: str = "build") -> Any:
        """Write this answer as verified code: :func:`navsym.export`."""
        import navsym

        return navsym.export(self, to=to, out=out)

    def plot(self) -> Any:
        """A picture of this answer: :func:`navsym.plot`."""
        import navsym

        return navsym.plot(self)

    def certificates(self) -> list[Mapping[str, Any]]:
        """The certificates that :meth:`check` replays."""
        return []
