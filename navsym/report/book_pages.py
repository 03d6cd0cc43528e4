"""The book as pages of the report: an index of its chapters, and a page for each with every entry and its verdict."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from navsym.book.entries import Entry, book
from navsym.report.formula.latex import convert_own


@dataclass(frozen=True, slots=True)
class Chapter:
    """A chapter with its page."""

    title: str
    file: str
    entries: tuple[Entry, ...]

    @property
    def counts(self) -> Counter[str]:
        """How many entries have each verdict."""
        return Counter(str(entry.status) for entry in self.entries)

    @property
    def misprints(self) -> int:
        """How many printed forms its entries correct."""
        return sum(len(entry.misprints) for entry in self.entries)


def book_pages(template: Callable[[str], Any], shared: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Names and texts of the pages; ``shared`` has the marks and meanings of verdicts, ``template`` those by name.

    >>> from navsym.report.page import MARKS, environment
    >>> made = dict(book_pages(environment().get_template, {"marks": MARKS}))
    >>> len(made), "Kinematics" in made["book.html"], "transport-rate" in made["book-04.html"]
    (24, True, True)
    """
    titles = dict.fromkeys(entry.chapter for entry in book.values())
    chapters = [
        Chapter(title, f"book-{place:02}.html", tuple(entry for entry in book.values() if entry.chapter == title))
        for place, title in enumerate(titles, start=1)
    ]
    words = {**shared, "mathml": convert_own, "symbols": describe_symbols}
    for place, chapter in enumerate(chapters):
        near = [chapters[k] if 0 <= k < len(chapters) else None for k in (place - 1, place + 1)]
        yield chapter.file, template("book_chapter.html").render(words, chapter=chapter, near=near)
    total = sum((chapter.counts for chapter in chapters), Counter[str]())
    yield "book.html", template("book.html").render(shared, chapters=chapters, total=total)


def describe_symbols(entry: Entry) -> list[tuple[str, str]]:
    """The declarations in words of the names that an entry uses."""
    used = words_of(entry.statement)
    return [(name, describe(words)) for name, words in entry.document.get("symbols", {}).items() if name in used]


def words_of(statement: str) -> set[str]:
    """The names in a text."""
    return set(re.findall(r"(?<![.\w])[A-Za-z]\w*", statement.replace("].T", "]").replace(").T", ")")))


def describe(declaration: Any) -> str:
    """A declaration in words: ``real``, ``0 to pi``, ``vector 3``."""
    if not isinstance(declaration, (list, Mapping)):
        return str(declaration)
    if isinstance(declaration, list):  # a range by its ends, or the sizes of a matrix
        return (" to " if isinstance(declaration[0], str) else " x ").join(map(str, declaration))
    bare = {"sign", "range"}
    parts = (
        key if value is True else describe(value) if key in bare else f"{key} {describe(value)}"
        for key, value in declaration.items()
    )
    return ", ".join(parts)
