"""Entries of the book: TOML files by chapter, read into frozen objects and decided as claim files are.

``statuses.json`` beside the chapters keeps what was granted, under the hash of the statement: entry -> status and hash
of its certificate. A statement that has changed since is decided when it is shown; :meth:`Entry.prove` always decides.
"""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from navsym.claims import OPEN, Status, Verdict
from navsym.core.catalogue import Catalogue
from navsym.core.errors import DuplicateError
from navsym.core.tables import Shown
from navsym.core.tables import Table as Rows
from navsym.language.names import quote
from navsym.language.schema import Table, expect_keys, join_place, require_key
from navsym.language.shapes import NOTES
from navsym.language.tomlfile import read_toml

FOLDER = Path(__file__).with_name("chapters")
KEPT = Path(__file__).with_name("statuses.json")
STATEMENT = ("left", "relation", "right", "chain", "given", "box", "order")
SECONDS = 20.0  # of processor time for one entry, as in ``navsym prove``


@dataclass(frozen=True, slots=True)
class Misprint:
    """A published form of an entry that its author has corrected.

    id       : the entry
    latex    : as it was printed, in our own writing
    source   : where it was printed and where the author corrected it
    document : the claim file of the printed form

    >>> import navsym as nav
    >>> nav.book["rotation-about-x-orthogonal"].misprints[0].prove().status
    Status.REFUTED
    """

    id: str
    latex: str
    source: str
    document: Mapping[str, Any] = field(default_factory=dict, repr=False, hash=False)

    @property
    def status(self) -> Status:
        """The verdict on the printed form that is kept; it is decided now when the text has changed since."""
        rows = {row["statement"]: row["status"] for row in book.kept.get(self.id, {}).get("misprints", ())}
        kept = rows.get(digest(self.document))
        return self.prove().status if kept is None else Status(kept)

    def prove(self, seconds: float = SECONDS) -> Verdict:
        """The verdict on the printed form, searched and granted now, also where its units give it away."""
        return decide(without_units(self.document), self.id, seconds)


@dataclass(frozen=True, slots=True)
class Entry(Shown):
    """One formula of the book.

    id, chapter, title : what it is called and where it stands
    latex    : as it is printed, in our own writing
    source   : the textbook or paper that has the formula
    note     : a remark, or an empty text
    document : the claim file of this one statement, with the declarations of its chapter
    misprints : printed forms that their author has corrected to this formula

    >>> import navsym as nav
    >>> entry = nav.book["skew-is-cross"]
    >>> entry
    <PROVED: skew-is-cross; skew(u) @ v = cross(u, v)>
    >>> entry.prove().holds
    True
    """

    id: str
    chapter: str
    title: str
    latex: str
    source: str
    note: str = ""
    document: Mapping[str, Any] = field(default_factory=dict, repr=False, hash=False)
    misprints: tuple[Misprint, ...] = ()

    @property
    def statement(self) -> str:
        """The formula in the language of claim files."""
        block = self.document["claim"][0]
        text = block.get("chain") or f"{block['left']} {block.get('relation', '=')} {block['right']}"
        return text + "".join(f", {given}" for given in block.get("given", ()))

    @property
    def status(self) -> Status:
        """The verdict that was granted for this statement; it is decided now when the statement has changed since."""
        kept = book.kept.get(self.id, {})
        return Status(kept["status"]) if kept.get("statement") == digest(self.document) else self.prove().status

    def prove(self, seconds: float = SECONDS) -> Verdict:
        """The verdict, searched and granted now; OPEN after ``seconds``."""
        return decide(self.document, self.id, seconds)

    def record(self) -> dict[str, Any]:
        """One entry of the JSON document of ``navsym book``."""
        names = ("id", "chapter", "title", "latex")
        shown = {name: getattr(self, name) for name in names}
        misprints = [{"source": misprint.source, "printed": misprint.latex} for misprint in self.misprints]
        return {**shown, "status": str(self.status), "source": self.source, "misprints": misprints}

    def table(self) -> Rows:
        """A line of the table of a search."""
        return Entries([self]).table()

    def __repr__(self) -> str:
        return f"<{self.status}: {self.id}; {self.statement}>"


class Entries(Shown, list[Entry]):
    """What a search has found, in order."""

    def table(self) -> Rows:
        """Each entry with its verdict, its statement and its source."""
        rows = [(entry.id, entry.status, entry.title, entry.statement, entry.source) for entry in self]
        return ("entry", "verdict", "title", "statement", "source"), rows


class Book(Catalogue[Entry]):
    """All entries by id, in the order of the chapters.

    >>> import navsym as nav
    >>> nav.book["transport-rate"].chapter
    'Strapdown mechanisation, coning and sculling'
    >>> [entry.id for entry in nav.book.search("melbourne")]
    ['melbourne-wubbena']
    """

    name, expected, remedy = "book", "the id of an entry", "search with nav.book.search"

    @cached_property
    def entries(self) -> dict[str, Entry]:
        """The entries of all chapters; raises DuplicateError when two have one id."""
        found: dict[str, Entry] = {}
        for path in sorted(FOLDER.glob("*.toml")):
            for entry in read_chapter(path):
                if entry.id in found:
                    got = f"{quote(entry.id)} also in {quote(found[entry.id].chapter)}"
                    raise DuplicateError(f"expected an id once; got {got}; rename one", where=path.name)
                found[entry.id] = entry
        return found

    @cached_property
    def kept(self) -> dict[str, dict[str, Any]]:
        """What was granted: entry -> hash of its statement, status, hash of its certificate, the same of misprints."""
        return dict(json.loads(KEPT.read_text(encoding="utf-8")))

    def table(self) -> Rows:
        """The chapters, with the number of their entries."""
        return ("chapter", "entries"), Counter(entry.chapter for entry in self.values()).items()

    def __repr__(self) -> str:
        return f"<book: {len(self)} entries>"

    def search(self, words: str = "") -> Entries:
        """Entries in which every word occurs, in id, chapter, title, LaTeX, statement or source; or by a formula.

        A formula finds what is the same up to the names of symbols and the order of terms: first the entries that state
        it, then those with it as a side, then those with it as a part.

        Raises ExpressionSyntaxError for what looks like a formula and is none.

        >>> import navsym as nav
        >>> [entry.id for entry in nav.book.search("skew(p) @ q = cross(p, q)")]
        ['skew-is-cross']
        """
        from navsym.book.search import find_formula, is_formula

        if is_formula(words):
            return Entries(find_formula(words, self))
        wanted = words.lower().split()
        return Entries(entry for entry in self.values() if all(word in text_of(entry) for word in wanted))


def text_of(entry: Entry) -> str:
    """What a search looks through."""
    parts = (entry.id, entry.chapter, entry.title, entry.latex, entry.statement, entry.source)
    return "\n".join(parts).lower()


def read_chapter(path: Path) -> list[Entry]:
    """The entries of one file; raises a NavsymError that names the file and the key."""
    document = read_toml(path)
    expect_keys(document, ("chapter", "symbols", "rates", "entry"), path.name)
    chapter = require_key(document, "chapter", path.name)
    return [
        read_book_entry(block, chapter, document, join_place(path.name, place))
        for place, block in enumerate(require_key(document, "entry", path.name))
    ]


def read_book_entry(block: Table, chapter: Table, document: Table, where: str) -> Entry:
    """One [[entry]] block; the source of the chapter holds unless the entry names its own."""
    expect_keys(block, ("id", "title", "latex", "source", "note", "misprint", *STATEMENT), where)
    name, title, latex = [require_key(block, key, where) for key in ("id", "title", "latex")]
    misprints = tuple(
        read_misprint(printed, block, document, join_place(where, f"misprint[{place}]"))
        for place, printed in enumerate(block.get("misprint", ()))
    )
    source = block.get("source", chapter["source"])
    statement = claim_file(block, name, document)
    return Entry(name, chapter["title"], title, latex, source, block.get("note", ""), statement, misprints)


def read_misprint(printed: Table, block: Table, document: Table, where: str) -> Misprint:
    """One [[entry.misprint]] block; hypotheses and ranges are those of its entry."""
    expect_keys(printed, ("latex", "source", "left", "relation", "right", "chain"), where)
    latex, source = [require_key(printed, key, where) for key in ("latex", "source")]
    stated = {**{key: block[key] for key in ("given", "box", "order") if key in block}, **printed}
    return Misprint(block["id"], latex, source, claim_file(stated, block["id"], document))


def claim_file(block: Table, name: str, document: Table) -> dict[str, Any]:
    """The claim file of one statement under the declarations of its chapter."""
    claim = {"id": name, **{key: block[key] for key in STATEMENT if key in block}}
    statement = {"symbols": document.get("symbols", {}), "claim": [claim]}
    if any("dot_(" in claim.get(side, "") for side in ("left", "right", "chain")):
        statement["rates"] = document.get("rates", {})
    return statement


def without_units(document: Mapping[str, Any]) -> dict[str, Any]:
    """The claim file without units and frames: what is printed wrongly is refuted, not refused."""
    symbols = {
        name: {key: item for key, item in value.items() if key not in NOTES} if isinstance(value, dict) else value
        for name, value in document["symbols"].items()
    }
    return {**document, "symbols": symbols}


def decide(document: Mapping[str, Any], name: str, seconds: float) -> Verdict:
    """The verdict on a claim file of one statement; OPEN after ``seconds``."""
    from navsym.prove.claimfile import claims_from, decide_claims

    return decide_claims(claims_from(dict(document), name), seconds=seconds)[0]


def digest(data: Any) -> str:
    """A hash of plain data."""
    return hashlib.sha256(json.dumps(data, sort_keys=True, default=str).encode()).hexdigest()[:32]


def keep_row(stated: Entry | Misprint) -> dict[str, Any]:
    """Decide a statement now: its hash, its status, the hash of its certificate."""
    verdict = stated.prove()
    certificate = "" if verdict.certificate is None else digest(verdict.certificate)
    return {"certificate": certificate, "statement": digest(stated.document), "status": str(verdict.status)}


def keep_statuses() -> list[Entry]:
    """Decide every entry and every misprint and write ``statuses.json``; the entries that are OPEN. Some minutes."""
    rows = {}
    for entry in book.values():
        rows[entry.id] = keep_row(entry)
        if entry.misprints:
            rows[entry.id]["misprints"] = [keep_row(misprint) for misprint in entry.misprints]
    lines = [f"{json.dumps(name)}: {json.dumps(row)}" for name, row in sorted(rows.items())]
    KEPT.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
    return [book[name] for name, row in rows.items() if row["status"] == OPEN]


#: The book of this package.
book = Book()
