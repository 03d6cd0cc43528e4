"""The report: verdicts as a folder of plain HTML pages that need no network and no script to be read.

:func:`pages` turns a ledger into texts by file name, and :func:`report` writes them. Every word that comes from data is
escaped by the templates; the only markup that data can cause is made by :mod:`navsym.report.formula.sides` and
:mod:`navsym.report.plots`, which escape what they take.
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import jinja2
from markupsafe import Markup

from navsym.claims import Paper, Record, equation_of
from navsym.claims.display import MARKS as MARKS
from navsym.report.erratum import Erratum, erratum_of, printed_side
from navsym.report.explain import WORDS, ended, number_words, steps
from navsym.report.formula.latex import sentence_html, sentence_latex
from navsym.report.formula.sides import Formula, as_printed, coordinates, formula, only_truth
from navsym.report.names import latex_escape
from navsym.report.plots import refutation_svg
from navsym.report.trust import backing_words, count_certificates
from navsym.report.wording import Words
from navsym.verification.certificates import list_parts
from navsym.verification.ledger import Ledger, may_be_the_copy, records_about, sort_records

# Names of the files of a report, and the certificates that it keeps as files.


def certificates_by_file(record: Record) -> list[tuple[str, Any]]:
    """File names and certificates of a record: one for each entry where a claim has several."""
    parts, name = list_parts(record.certificate or {}), f"certificates/{slug(record.id)}"
    if not record.certificate:
        return []
    if len(parts) == 1:
        return [(f"{name}.json", parts[0])]
    return [(f"{name}.{place}.json", part) for place, part in enumerate(parts, start=1)]


def slug(name: str) -> str:
    """A name that is safe in a file name and in an address; different names stay different."""
    plain = re.sub(r"[^A-Za-z0-9.-]", "_", name)[:80].strip(".")
    return plain if plain == name else f"{plain}-{hashlib.sha256(name.encode('utf-8', 'replace')).hexdigest()[:6]}"


# Scopes and truth values of records, as a page says them.


RANGES = (
    (re.compile(r"(\w+) in \(0, oo\)"), r"\1 > 0"),
    (re.compile(r"(\w+) in \[0, oo\)"), r"\1 ≥ 0"),
    (re.compile(r"(\w+) in \(-oo, 0\)"), r"\1 < 0"),
    (re.compile(r"\boo\b"), "∞"),
    (re.compile(r" != "), " ≠ "),
    (re.compile(r" >= "), " ≥ "),
    (re.compile(r" <= "), " ≤ "),
)
SINGLE = {"True": "it holds", "False": "it does not hold"}


def scope_words(text: str) -> str:
    """A scope or an assumption with the signs of mathematics: ``T in (0, oo)`` is T > 0."""
    if text == "one point":
        return "one point, which is enough to refute"
    for pattern, sign in RANGES:
        text = pattern.sub(sign, text)
    return text


def truth_words(text: str) -> str:
    """One truth value or several, as a statement about what is asked."""
    values = re.findall(r"True|False", text)
    if len(values) == 1:
        return SINGLE[values[0]]
    if set(values) == {"True"}:
        return f"it holds in all {len(values)} cases"
    return "; ".join(f"case {place}: {SINGLE[value]}" for place, value in enumerate(values, start=1))


TEMPLATES = Path(__file__).parent / "templates"
COPY_MARK = "copy"  # a word: no sign says it


@dataclass(frozen=True, slots=True)
class Cell:
    """One equation of the matrix: what it is worth and where it is told."""

    equation: str
    status: str
    mark: str
    words: str
    anchor: str


@dataclass(frozen=True, slots=True)
class PaperView:
    """A paper with its matrix row, its claims and its erratum sheet; ``damaged`` may be refuted only in the copy."""

    card: Paper
    file: str
    cells: tuple[Cell, ...]
    records: tuple[Record, ...]
    counts: Mapping[str, int]
    damaged: int
    unnumbered: int
    erratum: Erratum
    unexpected: tuple[str, ...]


def pages(
    ledger: Ledger,
    words: Mapping[str, Words] | None = None,
    *,
    book: bool = False,
    models: Mapping[str, Any] = MappingProxyType({}),
    progress: Callable[[str], None] = lambda claim: None,
) -> Iterator[tuple[str, str]]:
    """The files of the report, name and text, as they are made; the index comes last.

    ledger   : the verdicts; a paper whose card is not in it is shown without its matrix of equations
    words    : wording of erratum sheets by module
    book     : whether the pages of the book come too, ``book.html`` and one for each chapter, and ``atlas.html``
    models   : file of an error model -> its conventions; each has a page
    progress : called with the id of each claim that is set in type

    Files: ``certificates/*.json``, ``verdicts.json``, ``MODULE.html``, ``MODULE.erratum.html`` and
    ``.tex``, ``MODEL.conventions.html``, ``trust.html``, ``index.html``.
    """
    words, env, papers = words or {}, environment(), []
    shared: dict[str, Any] = {"marks": MARKS, "meanings": WORDS["meaning"], "copy_mark": COPY_MARK}
    shared |= {"kinds": WORDS["side"], "whose": WORDS["card_slip"]}
    for record in ledger.claims:  # as navsym check reads them
        for name, part in certificates_by_file(record):
            yield name, json.dumps(part, ensure_ascii=False, indent=1) + "\n"
    yield "verdicts.json", json.dumps(ledger.document(), ensure_ascii=False, allow_nan=False, indent=1) + "\n"
    for summary in ledger.papers:
        bare = Paper(summary.module, summary.title, authors=(), year=None, source="", language="", equations=())
        card = ledger.cards.get(summary.module) or bare
        paper = paper_view(card, ledger.claims, words.get(summary.module))
        papers.append(paper)
        given = {"known": {r.id: r for r in paper.records}, "corrections": {r.corrects: r for r in paper.records}}
        given |= {"paper": paper, "records": followed(paper.records, progress)}
        yield f"{paper.file}.html", env.get_template("paper.html").render(shared | given)
        yield f"{paper.file}.erratum.html", env.get_template("erratum.html").render(shared, paper=paper)
        yield f"{paper.file}.erratum.tex", env.get_template("erratum.tex").render(paper=paper)
    places = {record.id: f"{paper.file}.html#{anchor_of(record)}" for paper in papers for record in paper.records}
    yield "trust.html", env.get_template("trust.html").render(shared, trust=count_certificates(ledger), places=places)
    if book:
        from navsym.report.atlas_page import atlas_pages
        from navsym.report.book_pages import book_pages

        yield from book_pages(env.get_template, shared)
        yield from atlas_pages(env.get_template, shared)
    found = [(f"{slug(name.removesuffix('.toml'))}.conventions.html", name, answer) for name, answer in models.items()]
    for file, _, answer in found:
        from navsym.report.conventions_page import conventions_page

        yield file, conventions_page(answer)
    papers.sort(key=lambda paper: not paper.erratum.entries)  # those with something to correct come first
    total = {status: sum(paper.counts[status] for paper in papers) for status in MARKS}
    shown = env.get_template("index.html").render(shared, papers=papers, total=total, book=book, models=found)
    yield "index.html", shown


def environment() -> jinja2.Environment:
    """Templates with escaping on, for HTML by the engine and for LaTeX by the filter ``tex``."""
    env = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        autoescape=lambda name: not (name or "").endswith(".tex"),
        undefined=jinja2.StrictUndefined,
        finalize=visible,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    env.filters |= {"tex": latex_escape, "slug": slug, "sentence": sentence_html, "sentence_tex": sentence_latex}
    env.filters |= {"ended": ended, "in_words": scope_words, "anchor": anchor_of, "printed": printed_side}
    env.filters |= {"ends": number_words, "side": side, "steps": steps, "plot": plot_of, "coordinates": coordinates}
    env.filters |= {"formula": formula, "source": as_printed, "backing": backing_words, "files": certificate_files}
    script = (TEMPLATES / "filter.js").read_text(encoding="utf-8").strip()
    env.globals["style"] = Markup((TEMPLATES / "style.css").read_text(encoding="utf-8"))
    env.globals["script"] = Markup(script)
    env.globals["script_hash"] = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return env


def visible(value: Any) -> Any:
    """Words without control characters: those that turn the direction of text are written out."""
    if not isinstance(value, str) or isinstance(value, Markup) or value.isprintable():
        return value
    return "".join(c if c.isprintable() or c in "\n\t" else repr(c)[1:-1] for c in value)


def paper_view(card: Paper, records: Sequence[Record], words: Words | None) -> PaperView:
    """Everything that the page of one paper shows."""
    mine = sort_records(card, [record for record in records if record.paper == card.module])
    statuses = [str(record.status) for record in mine]
    numbered = [equation_of(record.number, card.equations) for record in mine]
    return PaperView(
        card=card,
        file=slug(card.module),
        cells=tuple(equation_cell(card, equation, mine) for equation in card.equations),
        records=tuple(mine),
        counts={status: statuses.count(status) for status in MARKS},
        damaged=sum(may_be_the_copy(record) for record in mine),
        unnumbered=numbered.count(None),
        erratum=erratum_of(card, mine, words),
        unexpected=tuple(record.id for record in mine if not record.is_expected),
    )


def equation_cell(card: Paper, equation: str, records: Sequence[Record]) -> Cell:
    """The worst verdict on an equation; ``copy`` if perhaps its damage, ``definition`` or ``missing`` without any."""
    found = records_about(equation, card.equations, records)
    if not found:
        beside = any(equation_of(record.number, card.equations) == equation for record in records)
        kind = "definition" if equation in card.definitions or beside else "missing"
        other = "only sentences beside it are claimed" if beside else "neither claimed nor listed as a definition"
        words = card.definitions.get(equation, other)
        return Cell(equation, kind, "·" if kind == "definition" else "!", f"{kind}: {words}", "")
    worst = found[0]
    many = f"{len(found)} claims, the worst " if len(found) > 1 else ""
    words = f"{many}{worst.status}: {worst.title}"
    if may_be_the_copy(worst):
        return Cell(equation, "copy", COPY_MARK, f"perhaps only in the copy that was read: {words}", anchor_of(worst))
    return Cell(equation, worst.status.lower(), MARKS[worst.status], words, anchor_of(worst))


def anchor_of(record: Record) -> str:
    """Anchor of a claim on the page of its paper."""
    return f"c-{slug(record.number)}"


def followed(records: Sequence[Record], progress: Callable[[str], None]) -> Iterator[Record]:
    """The records; progress gets the id of each when the page has it."""
    for record in records:
        yield record
        progress(record.id)


def plot_of(record: Record) -> Markup:
    """The picture of a refuted record; empty for others, and where there is no curve."""
    return Markup(refutation_svg(record) if record.status == "REFUTED" else "")


def certificate_files(record: Record) -> list[str]:
    """Names of the files of its certificates."""
    return [name for name, _ in certificates_by_file(record)]


def side(text: str) -> Formula:
    """A side set in type; what is only said to hold or not comes in words."""
    return Formula(truth_words(text), None, None, words=True) if only_truth(text) else formula(text)
