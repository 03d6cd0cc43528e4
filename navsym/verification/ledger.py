"""The ledger: the verdicts of one run, and the files of all verdicts as they were last written.

``verdicts.json`` is compared in the tests, so that no verdict changes unnoticed. It holds nothing that varies from run
to run: no times. Certificates have a file beside it, and ``README.md`` is the same for people.
"""

from __future__ import annotations

import contextlib
import fcntl
import html
import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol, TypeVar

import msgspec

from navsym.claims import Paper, Record, equation_of
from navsym.claims.display import mark_verdict, write_card, write_table
from navsym.claims.paper import papers_folder
from navsym.claims.workspace import find_workspace
from navsym.core.answers import Answers
from navsym.core.errors import DomainError, ShapeError
from navsym.language.files import write_text
from navsym.language.jsonfile import read_json
from navsym.prove.grant import UNCHECKED
from navsym.verification.certificates import LARGEST, REMEDY, certificates_file, certificates_text, collect_certificates
from navsym.verification.papers import PaperSummary, load_papers

MARKS = {"PROVED": "✓", "CERTIFIED": "✓", "CONFIRMED": "~", "REFUTED": "✗", "OPEN": "?"}
#: What a claim is about, and who slipped, in a word.
KINDS = {"printed": "formula", "beside": "sentence", "remark": "remark", "beyond": "beyond"}
WHOSE = {"paper": "paper", "scan": "scan", "undecidable": "paper or scan"}
WORST_FIRST = ("REFUTED", "OPEN", "CONFIRMED", "CERTIFIED", "PROVED")


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Ledger(Answers[Record]):
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
    def from_json(cls, document: Mapping[str, Any]) -> Ledger:
        """The ledger of a document of ``navsym verify --json``, or of ``verdicts.json``."""
        claims = tuple(Record.from_json(record) for record in document["claims"])
        papers = msgspec.convert(document["papers"], tuple[PaperSummary, ...])
        return cls(claims, papers, tuple(document.get("unsaved", ())))

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym verify``."""
        whole = {"claims": [record.to_json() for record in self.claims], "papers": self.summaries()}
        return whole | {"counts": self.counts} | ({"unsaved": list(self.unsaved)} if self.unsaved else {})

    def summaries(self) -> list[dict[str, Any]]:
        """The coverage of each paper as plain data."""
        return [{k: v for k, v in entry.items() if k != "source"} for entry in map(coverage, self.papers)]

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
    def unchecked(self) -> tuple[Record, ...]:
        """Records of verdicts on which others rely, but for which the checker has no kind of certificate."""
        return tuple(record for record in self.claims if UNCHECKED in record.evidence)

    @property
    def changed(self) -> tuple[str, ...]:
        """Ids whose verdict or statement is not the one in ``verdicts.json``, or that it does not have.

        Raises NavsymError for a damaged file.
        """
        stored = stored_records()

        def is_stored(record: Record) -> bool:
            old = stored.get(record.id)
            if old is None or old.status != record.status:
                return False
            return old.statement == record.statement or "" in (old.statement, record.statement)

        return tuple(record.id for record in self.claims if not is_stored(record))

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

    @property
    def is_kept(self) -> bool:
        """True where a ledger exists for these verdicts: those of single files need a workspace."""
        return find_workspace() is not None or not any(paper.module.endswith(".toml") for paper in self.papers)

    def write(self) -> None:
        """Update ``verdicts.json``, ``certificates.json`` and ``README.md`` beside the papers.

        In a workspace these are ``ledger.json`` and ``certificates.json`` of its folder, and no page for people.
        Papers that were not run keep their verdicts; several processes may write, one after the other.
        Raises DomainError for verdicts of files outside a workspace, NavsymError where verdicts of papers that were not
        run cannot be read, or nothing can be written.

        >>> import navsym as nav
        >>> nav.verify("alpha_beta_filter").write()                                              # doctest: +SKIP
        """
        if not self.is_kept:
            message = "expected a workspace for the verdicts of files; got none; make one with navsym init"
            raise DomainError(message, where="verify --write")
        path, cards = ledger_file(), {module.name: module.paper for module in load_papers()}
        with lock_folder(path.parent):
            whole = replace(self.merge(self.read_others(set(cards))), cards=cards)
            write_text(certificates_file(), certificates_text(collect_certificates(whole.claims)))
            write_text(path, ledger_text(whole))
            if find_workspace() is None:
                write_text(path.with_name("README.md"), people_text(whole))

    def read_others(self, known: set[str]) -> Ledger:
        """What the files say of the papers that were not run; without any, the files need not be readable."""
        run = {paper.module for paper in self.papers}
        return Ledger((), ()) if known <= run else stored_ledger()

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
    """Records on the formula of an equation, the worst verdict first; slips of a paper before what may be the copy's.

    Sentences and remarks beside it are not among them, nor a slip that another claim counts.
    """
    mine = [record for record in records if equation_of(record.number, equations) == equation]
    about = [record for record in mine if record.kind == "printed" and record.cause is None]
    return sorted(about, key=lambda record: (WORST_FIRST.index(record.status), may_be_the_copy(record)))


def may_be_the_copy(record: Record) -> bool:
    """True when a record is refuted for damage of the copy that was read, or nobody can tell whether it is that."""
    return record.status == "REFUTED" and record.slip in ("scan", "undecidable")


# The files


def read_ledger(path: str | os.PathLike[str]) -> Ledger:
    """A document of ``navsym verify --json``, or a ledger; raises NavsymError for a damaged file or another one."""
    document, where = read_json(path, limit=LARGEST), str(path)
    expected = "a document of navsym verify --json"
    needed = {"claims", "papers", "counts"}
    if not isinstance(document, dict) or not needed <= set(document):
        came = f"no {', '.join(sorted(needed - set(document)))}" if isinstance(document, dict) else "no object"
        raise ShapeError(f"expected {expected}; got {came}; {REMEDY}", where=where)
    try:
        return Ledger.from_json(document)
    except (msgspec.MsgspecError, TypeError, ValueError, KeyError) as error:
        raise ShapeError(f"expected {expected}; got another form ({error}); {REMEDY}", where=where) from None


def ledger_file() -> Path:
    """The file of all verdicts as they were last written: ``ledger.json`` of the workspace, or that of the papers."""
    workspace = find_workspace()
    return papers_folder() / "verdicts.json" if workspace is None else workspace.ledger_file


def stored_ledger() -> Ledger:
    """The ledger as it was last written; empty when there is none yet. Raises NavsymError for a damaged file."""
    return read_ledger(ledger_file()) if ledger_file().exists() else Ledger((), ())


def stored_records() -> dict[str, Record]:
    """Records of the ledger by claim id."""
    return {record.id: record for record in stored_ledger()}


@contextlib.contextmanager
def lock_folder(folder: Path) -> Iterator[None]:
    """Let one process at a time change the files of a folder; the others wait."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        with contextlib.suppress(OSError):  # a file system without locks
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        with contextlib.suppress(OSError):  # a child made meanwhile holds the file open, and would keep the lock
            fcntl.flock(handle, fcntl.LOCK_UN)
        os.close(handle)


def coverage(paper: PaperSummary) -> dict[str, Any]:
    """The coverage of a paper as plain data."""
    return {**asdict(paper), "missing": list(paper.missing)}


def ledger_text(ledger: Ledger) -> str:
    """The ledger as JSON text, the same for the same verdicts."""
    claims = [record.ledger_json() for record in ledger.claims]
    content = {"papers": [*map(coverage, ledger.papers)], "counts": ledger.counts, "claims": claims}
    return json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def people_text(ledger: Ledger) -> str:
    """Claims and verdicts as a Markdown page, one section per paper, in the order of its equations."""
    lines = [
        "# Claims and verdicts",
        "",
        "Generated by `navsym verify --write`; edits are lost. A star marks the claim that corrects a refuted one.",
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
        "| claim | verdict | kind | what it says | slip |",
        "| --- | --- | --- | --- | --- |",
    ]
    return [*lines, *map(claim_line, records), ""]


def claim_line(record: Record) -> str:
    """One claim as a line of the table."""
    slip = f"{WHOSE[record.slip]}: {record.reason}" if record.slip else record.reason or ""
    slip += f"; the slip of {record.cause.partition(':')[2]}" if record.cause else ""
    cells = (f"`{record.number}`", f"{MARKS[record.status]} {record.status}", KINDS[record.kind], record.title, slip)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
