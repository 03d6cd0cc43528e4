"""The book as pages of the report: an index of its chapters, and a page for each with every entry and its verdict."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from navsym.book.entries import Entry, Misprint, book
from navsym.report.formula.latex import convert_own
from navsym.report.page import slug


@dataclass(frozen=True, slots=True)
class Shown:
    """A formula set in type, None where it cannot be, and its verdict."""

    stated: Entry | Misprint
    status: str
    mathml: Markup | None


@dataclass(frozen=True, slots=True)
class EntryView:
    """An entry with the declarations of its names and its misprints."""

    entry: Entry
    anchor: str
    shown: Shown
    symbols: tuple[tuple[str, str], ...]
    misprints: tuple[Shown, ...]


@dataclass(frozen=True, slots=True)
class Chapter:
    """A chapter with its page."""

    title: str
    file: str
    entries: tuple[EntryView, ...]
    counts: Mapping[str, int]
    misprints: int


def book_pages(template: Callable[[str], Any], shared: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Names and texts of the pages; ``shared`` has the marks and meanings of verdicts, ``template`` those by name.

    >>> from navsym.report.page import MARKS, environment
    >>> made = dict(book_pages(environment().get_template, {"marks": MARKS}))
    >>> len(made), "Kinematics" in made["book.html"], "transport-rate" in made["book-04.html"]
    (24, True, True)
    """
    titles = dict.fromkeys(entry.chapter for entry in book.values())
    chapters = [read_chapter(title, f"book-{place:02}.html") for place, title in enumerate(titles, start=1)]
    for place, chapter in enumerate(chapters):
        near = [chapters[k] if 0 <= k < len(chapters) else None for k in (place - 1, place + 1)]
        yield chapter.file, template("book_chapter.html").render(shared, chapter=chapter, near=near)
    total = sum((Counter(chapter.counts) for chapter in chapters), Counter[str]())
    yield "book.html", template("book.html").render(shared, chapters=chapters, total=total)


def read_chapter(title: str, file: str) -> Chapter:
    """The entries of a chapter as its page shows them."""
    entries = tuple(view_entry(entry) for entry in book.values() if entry.chapter == title)
    counts = Counter(view.shown.status for view in entries)
    return Chapter(title, file, entries, counts, sum(len(view.misprints) for view in entries))


def view_entry(entry: Entry) -> EntryView:
    """An entry as its card shows it."""
    used = words_of(entry.statement)
    table = entry.document.get("symbols", {})
    symbols = tuple((name, describe(table[name])) for name in table if name in used)
    return EntryView(entry, f"e-{slug(entry.id)}", show(entry), symbols, tuple(map(show, entry.misprints)))


def show(stated: Entry | Misprint) -> Shown:
    """A formula in MathML, with its verdict."""
    return Shown(stated, str(stated.status), convert_own(stated.latex))


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
