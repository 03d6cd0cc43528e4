"""BibTeX for a paper and for a verdict on one of its statements."""

from __future__ import annotations

import html
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from navsym import __version__
from navsym.claims import Paper, Record, Status
from navsym.core.answers import Answer, named
from navsym.report.formula.sides import only_truth
from navsym.report.names import latex_escape
from navsym.verification.decide import decide_papers
from navsym.verification.ledger import stored_records
from navsym.verification.papers import find_claim

SHORT = 120  # characters of a formula that a note may hold


@dataclass(frozen=True, slots=True, repr=False)
class Citation(Answer):
    """BibTeX of a paper and of the verdict on one of its claims; ``str`` gives the text."""

    id: str
    status: Status
    bibtex: str

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym cite``."""
        return named(self, "id status bibtex")

    def __str__(self) -> str:
        return self.bibtex

    def __repr__(self) -> str:
        return f"<citation of {self.id}: {self.status}>"

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self.bibtex)}</pre>"


def cite(claim: str, *, fresh: bool = False) -> Citation:
    """BibTeX for a paper and for the verdict on one of its claims, from the ledger where it has one on this statement.

    claim : id such as "guaranteed_velocity:4.3.u2"
    fresh : decide now instead of citing the ledger

    Raises DomainError, with the ids that come closest, for an id that is none, and NavsymError for a damaged ledger.

    >>> import navsym as nav
    >>> print(nav.cite("alpha_beta_filter:8"))
    @misc{kalata1984,
    ...
    @misc{kalata1984-8,
      title = {Verdict on alpha_beta_filter:8: PROVED},
    ...
    """
    module, wanted = find_claim(claim)
    better = module.correction_of(wanted.id)
    both = replace(module, claims=(wanted,) if better is None else (wanted, better))
    record, *correction = decide_papers([both], stored={} if fresh else stored_records())
    return Citation(wanted.id, record.status, bibtex(module.paper, record, __version__, *correction))


def bibtex(paper: Paper, record: Record, version: str, correction: Record | None = None) -> str:
    """Two entries: the paper, and the verdict with its scope and the version that decided it.

    correction : record of the claim that corrects this one, to be named with it
    """
    first = paper.authors[0].split()[-1] if paper.authors else paper.module
    key = citation_key(f"{first}{paper.year or ''}").lower()
    language = f"In {paper.language}" if paper.language else ""
    source = " ".join(f"{part.rstrip('.')}." for part in (paper.source, language) if part)
    verdict = {
        "title": f"Verdict on {record.id}: {record.status}",
        "author": "{navsym contributors}",
        "howpublished": f"navsym {version}, claim {latex_escape(record.id)}",
        "note": latex_escape(" ".join([verdict_words(record), *correction_words(correction)])),
    }
    words = {
        "author": " and ".join(latex_escape(author) for author in paper.authors),
        "title": "{" + latex_escape(paper.title) + "}",
        "year": "" if paper.year is None else str(paper.year),
        "note": latex_escape(source),
        "doi": paper.doi,
    }
    return (
        bibtex_entry("misc", key, words) + "\n" + bibtex_entry("misc", f"{key}-{citation_key(record.number)}", verdict)
    )


def verdict_words(record: Record) -> str:
    """What is claimed, how it was decided and for what; where it fails, an exact point."""
    scope = "" if record.status == "REFUTED" else f", for {record.scope or 'the numbers as they stand'}"
    words = f"{record.title} Decided by {record.method}{scope}."
    if record.assumptions:
        words += f" Assuming {'; '.join(record.assumptions)}."
    if record.counterexample:
        words += f" Counterexample: {record.point_text}."
    return words


def correction_words(correction: Record | None) -> list[str]:
    """Which claim stands in its place, and its formula where it is short."""
    if correction is None:
        return []
    printed = correction.printed
    says = f": {printed}" if len(printed) <= SHORT and not only_truth(printed) else ""
    return [f"Corrected by {correction.id}, {correction.status}{says}."]


def bibtex_entry(kind: str, key: str, fields: Mapping[str, str]) -> str:
    """An entry of BibTeX; empty fields are left out."""
    lines = [f"  {name} = {{{value}}}," for name, value in fields.items() if value]
    return "\n".join([f"@{kind}{{{key},", *lines, "}", ""])


def citation_key(text: str) -> str:
    """Letters, digits and points of a text; a star becomes ``corrected``."""
    return re.sub(r"[^A-Za-z0-9.]", "", text.replace("*", "corrected"))
