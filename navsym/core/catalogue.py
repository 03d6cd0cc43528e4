"""Entries by name that are read once, when one is asked for; unknown names are refused with the nearest one."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from difflib import get_close_matches
from typing import Any, ClassVar, TypeVar

from navsym.core.errors import UnknownSymbolError
from navsym.core.tables import Shown

Item = TypeVar("Item")


class Catalogue(Mapping[str, Item], Shown):
    """A mapping with a name, a word for what a key is, and the way to a list of all of them."""

    name: ClassVar[str]
    expected: ClassVar[str]
    remedy: ClassVar[str]

    @property
    @abstractmethod
    def entries(self) -> Mapping[str, Item]:
        """All of them."""

    def __getitem__(self, key: str) -> Item:
        if key not in self.entries:
            near = get_close_matches(str(key), self.entries, n=1)
            remedy, got = f"did you mean {near[0]}?" if near else self.remedy, repr(str(key)[:40])
            raise UnknownSymbolError(f"expected {self.expected}; got {got}; {remedy}", where=self.name)
        return self.entries[key]

    def get(self, key: str, default: Any = None) -> Any:
        """The entry of a name, or the default; nothing is raised."""
        return self.entries.get(key, default)

    def __contains__(self, key: object) -> bool:
        return key in self.entries

    def __iter__(self) -> Iterator[str]:
        return iter(self.entries)

    def __len__(self) -> int:
        return len(self.entries)
