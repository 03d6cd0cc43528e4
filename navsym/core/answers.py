"""Answers: each shows itself in one line, gives the document of its verb, can be checked, exported and plotted."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, fields, is_dataclass, replace
from pathlib import Path
from typing import Any, Generic, Self, TypeVar, overload

from navsym.core.errors import UnknownSymbolError
from navsym.core.tables import Shown

Part = TypeVar("Part")


def named(owner: Any, names: str) -> dict[str, Any]:
    """Fields or properties as plain data, name by name: how documents are made.

    >>> named(1 + 2j, "real imag")
    {'real': 1.0, 'imag': 2.0}
    """
    return {name: plain(getattr(owner, name)) for name in names.split()}


def plain(value: Any) -> Any:
    """Tuples and arrays as lists, parts by their own documents or fields, paths and statuses as text."""
    if hasattr(value, "document"):
        return value.document()
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [*map(plain, value)]
    if isinstance(value, Mapping):
        return dict(value)
    if is_dataclass(value):
        return asdict(value)  # type: ignore[arg-type]
    return str(value) if isinstance(value, str | Path) else value


class Answer(Shown):
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
        """The certificates that :meth:`check` replays: the answer's own, where it has one."""
        own = getattr(self, "certificate", None)
        return [] if own is None else [own]


class Answers(Answer, Generic[Part]):
    """Base of answers of several parts: the first field of the class has them, in order.

    They are counted, gone through, and taken by their place, by their id, or some of them by a slice.
    """

    __slots__ = ()

    @property
    def parts(self) -> tuple[Part, ...]:
        """The parts in order."""
        found: tuple[Part, ...] = getattr(self, fields(self)[0].name)  # type: ignore[arg-type]
        return found

    def __len__(self) -> int:
        return len(self.parts)

    def __iter__(self) -> Iterator[Part]:
        return iter(self.parts)

    @overload
    def __getitem__(self, wanted: int | str) -> Part: ...
    @overload
    def __getitem__(self, wanted: slice) -> Self: ...
    def __getitem__(self, wanted: int | str | slice) -> Any:
        """A part by its place or its id; the same kind of collection for a slice."""
        if isinstance(wanted, slice):
            return replace(self, **{fields(self)[0].name: self.parts[wanted]})  # type: ignore[type-var, arg-type]
        if isinstance(wanted, int):
            return self.parts[wanted]
        known = {getattr(part, "id", None): part for part in reversed(self.parts)}
        if not isinstance(wanted, str) or wanted not in known:
            listed = ", ".join(str(name) for name in [*known][:-9:-1]) or "nothing, the list is empty"
            raise UnknownSymbolError(f"expected the id of a part, such as {listed}; got {wanted!r}; correct it")
        return known[wanted]
