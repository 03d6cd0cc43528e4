"""The ledger: the verdicts of one run, and the files of all verdicts as they were last written.

``verdicts.json`` is compared in the tests, so that no verdict changes unnoticed. It holds nothing that varies from run
to run: no times, no certificates. ``README.md`` beside it is the same for people.
"""

from __future__ import annotations

import html
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Protocol, TypeVar

from navsym.claims import Paper, Record, equation_of
from navsym.claims.display import mark_verdict, write_card, write_table
from navsym.core.answers import Answer
from navsym.core.errors import UnknownSymbolError
from navsym.language.files import write_text
from navsym.verification.papers import PaperSummary, ledger_file, load_papers, stored_records

MARKS = {"PROVED": "✓", "CERTIFIED": "✓", "CONFIRMED": "~", "REFUTED": "✗", "OPEN": "?"}
WORST_FIRST = ("REFUTED", "OPEN", "CONFIRMED", "CERTIFIED", "PROVED")


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Ledger(Answer):
    """Verdicts on the claims of papers, in the order of the sources.

    claims : a :class:`navsym.claims.Record` for each
    papers : coverage of the numbered equations, one for each paper
    unsaved: ids of verdicts that could not be kept for the next run
    cards  : module -> :class:`navsym.claims.Paper`

    >>> import navsym as nav
    >>> ledger = nav.verify("alpha_beta_filter")
    >>> ledger
    <Ledger: 19 claims: 18 PROVED, 1 REFUTED, all as declared>
    >>> ledger["alpha_beta_filter:12.stable"].printed
    '4*r'
    """

    claims: tuple[Record, ...]
    papers: tuple[PaperSummary, ...]
    unsaved: tuple[str, ...] = ()
    cards: Mapping[str, Paper] = field(default_factory=dict)

    @classmethod
    def from_json(cls, document: Mapping[str, Any], cards: Mapping[str, Paper] | None = None) -> Ledger:
        """The ledger of a document of ``navsym verify --json``, or of ``verdicts.json``."""
        claims = tuple(Record.from_json(record) for record in document["claims"])
        papers = (PaperSummary(**{**paper, "missing": tuple(paper["missing"])}) for paper in document["papers"])
        return cls(claims, tuple(papers), tuple(document.get("unsaved", ())), cards or {})

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym verify``."""
        whole = {"claims": [record.to_json() for record in self.claims], "papers": self.summaries()}
        return whole | {"counts": self.counts} | ({"unsaved": list(self.unsaved)} if self.unsaved else {})

    def summaries(self) -> list[dict[str, Any]]:
        """The coverage of each paper as plain data."""
        return [{**asdict(paper), "missing": list(paper.missing)} for paper in self.papers]

    @property
    def counts(self) -> dict[str, int]:
        """Number of claims with each status, zero included."""
        statuses = [record.status for record in self.claims]
        return {status: statuses.count(status) for status in MARKS}  # type: ignore[arg-type]

    @property
    def unexpected(self) -> tuple[Record, ...]:
        """Records whose verdict is not the one that the source declares."""
        return tuple(record for record in self.claims if not record.is_expected)

    @property
    def missing(self) -> tuple[str, ...]:
        """Numbered equations that are neither claimed nor definitions: ``module:number``."""
        return tuple(f"{paper.module}:{number}" for paper in self.papers for number in paper.missing)

    @property
    def changed(self) -> tuple[str, ...]:
        """Ids whose verdict is not the one in ``verdicts.json``, or that it does not have."""
        stored = stored_records()
        return tuple(r.id for r in self.claims if r.id not in stored or stored[r.id].status != r.status)

    def __len__(self) -> int:
        return len(self.claims)

    def __iter__(self) -> Iterator[Record]:
        return iter(self.claims)

    def __getitem__(self, wanted: str) -> Record:
        found = next((record for record in self.claims if record.id == wanted), None)
        if found is None:
            raise UnknownSymbolError(f"expected the id of a claim in this ledger; got {wanted!r}; see nav.claims()")
        return found

    def by_paper(self) -> list[tuple[PaperSummary, list[Record]]]:
        """Each paper with its records in the order of its equations."""
        return [
            (paper, sort_records(self.cards.get(paper.module), (r for r in self.claims if r.paper == paper.module)))
            for paper in self.papers
        ]

    def restrict(self, modules: Iterable[str]) -> Ledger:
        """The part on some papers."""
        wanted = set(modules)
        papers = tuple(paper for paper in self.papers if paper.module in wanted)
        return Ledger(tuple(r for r in self.claims if r.paper in wanted), papers, self.unsaved, self.cards)

    def certificates(self) -> list[Mapping[str, Any]]:
        """The certificates of all verdicts that have one."""
        return [record.certificate for record in self.claims if record.certificate is not None]

    def write(self) -> None:
        """Update ``verdicts.json`` and ``README.md`` beside the papers; papers that were not run keep their verdicts.

        >>> import navsym as nav
        >>> nav.verify("alpha_beta_filter").write()                                              # doctest: +SKIP
        """
        path = ledger_file()
        old = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {"claims": [], "papers": []}
        whole = self.merge(Ledger.from_json(old))
        whole = Ledger(whole.claims, whole.papers, cards={module.name: module.paper for module in load_papers()})
        write_text(path, ledger_text(whole))
        write_text(path.with_name("README.md"), people_text(whole))

    def merge(self, old: Ledger) -> Ledger:
        """These verdicts together with the old ones of papers that were not run."""
        run = {paper.module for paper in self.papers}
        papers = sorted([p for p in old.papers if p.module not in run] + list(self.papers), key=lambda p: p.module)
        order = [paper.module for paper in papers]
        claims = [record for record in old.claims if record.paper not in run] + list(self.claims)
        return Ledger(tuple(sorted(claims, key=lambda record: order.index(record.paper))), tuple(papers))

    def __repr__(self) -> str:
        counted = ", ".join(f"{count} {status}" for status, count in self.counts.items() if count)
        wrong = len(self.unexpected)
        return f"<Ledger: {len(self)} claims: {counted or 'none'}, {f'{wrong} not' if wrong else 'all'} as declared>"

    def _repr_html_(self) -> str:
        """One line for each paper, and the claims whose verdict is not the declared one."""
        rows = []
        for paper, records in self.by_paper():
            statuses = [str(record.status) for record in records]
            rows.append((paper.module, *(statuses.count(status) for status in MARKS), ", ".join(paper.missing)))
        lines = [write_table(("paper", *MARKS, "missing equations"), rows)]
        lines += [f"{html.escape(r.id)} {mark_verdict(str(r.status))}, declared {r.expect}" for r in self.unexpected]
        return write_card(lines, "REFUTED" if self.unexpected else "PROVED")


# The order of a paper


class Numbered(Protocol):
    """Anything about one equation of a paper."""

    @property
    def number(self) -> str: ...


Item = TypeVar("Item", bound=Numbered)


def sort_records(paper: Paper | None, records: Iterable[Item]) -> list[Item]:
    """Records of one paper in the order of its equations; statements without a number come last."""
    equations = paper.equations if paper is not None else ()
    place: dict[str | None, int] = {equation: i for i, equation in enumerate(equations)}
    return sorted(records, key=lambda record: place.get(equation_of(record.number, equations), len(place)))


def records_about(equation: str, equations: Sequence[str], records: Iterable[Record]) -> list[Record]:
    """Records on a numbered equation, the worst verdict first; slips of a paper before the damage of a copy."""
    about = [record for record in records if equation_of(record.number, equations) == equation]
    return sorted(about, key=lambda record: (WORST_FIRST.index(record.status), record.slip == "scan"))


def is_only_in_the_copy(record: Record) -> bool:
    """True when a record, the first of :func:`records_about`, is refuted only for damage of the copy that was read."""
    return record.status == "REFUTED" and record.slip == "scan"


# The files


def ledger_text(ledger: Ledger) -> str:
    """The ledger as JSON text, the same for the same verdicts."""
    claims = [record.ledger_json() for record in ledger.claims]
    content = {"papers": ledger.summaries(), "counts": ledger.counts, "claims": claims}
    return json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def people_text(ledger: Ledger) -> str:
    """Claims and verdicts as a Markdown page, one section per paper, in the order of its equations."""
    lines = [
        "# Claims and verdicts",
        "",
        "Generated by `navsym verify --write`; do not edit. A star marks the claim that corrects a refuted one.",
        "",
    ]
    for paper, records in ledger.by_paper():
        lines += paper_lines(paper, records)
    return "\n".join(lines) + "\n"


def paper_lines(paper: PaperSummary, records: list[Record]) -> list[str]:
    """The section of a paper: coverage, numbers of verdicts and a table of the claims."""
    statuses = [str(record.status) for record in records]
    summary = ", ".join(f"{statuses.count(s)} {s}" for s in MARKS if s in statuses)
    lines = [
        f"## {paper.module}",
        "",
        f"{paper.title}. {paper.equations} numbered equations, {paper.claimed} claimed, "
        f"{paper.definitions} definitions, {len(paper.missing)} missing. {summary}.",
        "",
        "| claim | verdict | what it says | slip |",
        "| --- | --- | --- | --- |",
    ]
    return [*lines, *map(claim_line, records), ""]


def claim_line(record: Record) -> str:
    """One claim as a line of the table."""
    slip = f"{record.slip}: {record.reason}" if record.slip else record.reason or ""
    cells = (f"`{record.number}`", f"{MARKS[record.status]} {record.status}", record.title, slip)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
