"""The pages of the report in a folder."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from navsym.claims.paper import papers_folder
from navsym.claims.record import NOT_IN_LEDGERS, Record
from navsym.core.answers import Answer
from navsym.core.errors import OutputError, ShapeError
from navsym.language.files import read_text, write_text
from navsym.language.jsonfile import read_json
from navsym.report.page import pages
from navsym.report.wording import Words, read_wording
from navsym.verification.decide import SECONDS, verify
from navsym.verification.ledger import Ledger
from navsym.verification.papers import load_papers

LARGEST = 200_000_000  # bytes of a document
KEYS = frozenset(Record.__dataclass_fields__) - frozenset(NOT_IN_LEDGERS)


@dataclass(frozen=True, slots=True, repr=False)
class Site(Answer):
    """The written pages.

    out    : their folder; open ``index.html``
    files  : names of all files in it, certificates included
    ledger : the verdicts that they show
    """

    out: Path
    files: tuple[str, ...]
    ledger: Ledger

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym report``."""
        shown = [name for name in self.files if name.endswith(".html")]
        return {"out": str(self.out), "files": len(self.files), "pages": shown, "counts": self.ledger.counts}

    def __repr__(self) -> str:
        return f"<report: {len(self.files)} files; open {self.out / 'index.html'}>"


def report(
    *papers: str,
    out: str | os.PathLike[str] = "report",
    source: str | os.PathLike[str] | Ledger | None = None,
    jobs: int | None = None,
    seconds: float = SECONDS,
    fresh: bool = False,
    progress: Callable[[int, int, str], None] = lambda done, of, doing: None,
    remark: Callable[[str], None] = lambda sentence: None,
) -> Site:
    """Write static HTML pages of verdicts, erratum sheets and certificates into a folder.

    The pages need neither a network nor a script. Every certificate is a file that ``navsym check`` replays.

    papers   : names of derivation modules; all when none is given
    out      : the folder; made when it is not there
    source   : a ledger, or the path of a document of ``navsym verify --json``; by default the claims are decided
    jobs, seconds, fresh : as in :func:`navsym.verify`
    progress : called with (done, all, id) while claims are decided, and again while they are set in type
    remark   : called with a sentence on what is kept

    Raises OutputError for a folder that cannot be made, ShapeError for a document that is none of verdicts.

    >>> import navsym as nav
    >>> site = nav.report("alpha_beta_filter", out="pages")
    >>> "index.html" in site.files, site.ledger.counts["REFUTED"]
    (True, 1)
    """
    folder, chosen = Path(out), load_papers(papers)
    cards = {module.name: module.paper for module in chosen}
    ledger = source if isinstance(source, Ledger) else None
    if source is not None and not isinstance(source, Ledger):
        ledger = read_document(source)
    make_folder(folder)  # before minutes are spent on what cannot be written
    if ledger is None:
        ledger = verify(*papers, jobs=jobs, seconds=seconds, fresh=fresh, progress=progress, remark=remark)
    elif papers:
        ledger = ledger.restrict(cards)
    return write_pages(folder, Ledger(ledger.claims, ledger.papers, ledger.unsaved, cards), progress)


def read_document(path: str | os.PathLike[str]) -> Ledger:
    """A document of ``navsym verify --json``, or a ledger; raises ShapeError for another one."""
    document, where = read_json(path, limit=LARGEST), str(path)
    expected = "a document of navsym verify --json"
    needed = {"claims", "papers", "counts"}
    if not isinstance(document, dict) or not needed <= set(document):
        came = f"no {', '.join(sorted(needed - set(document)))}" if isinstance(document, dict) else "no object"
        raise ShapeError(f"expected {expected}; got {came}; make it with navsym verify --json", where=where)
    for place, record in enumerate(document["claims"]):
        if not isinstance(record, dict) or (lacking := KEYS - set(record)):
            what = ", ".join(sorted(lacking)) if isinstance(record, dict) else "the record"
            raise ShapeError(f"expected {expected}; got no {what} in it; make it again", where=f"{where}: {place}")
    try:
        return Ledger.from_json(document)
    except (TypeError, ValueError, KeyError) as error:
        raise ShapeError(f"expected {expected}; got another form ({error}); make it again", where=where) from None


def make_folder(out: Path) -> None:
    """Make the folder of the pages and that of their certificates; raises OutputError where they cannot be made."""
    try:
        (out / "certificates").mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"expected a folder that can be made; got '{error.strerror}'; choose another --out"
        raise OutputError(message, where=str(out)) from error


def write_pages(out: Path, ledger: Ledger, progress: Callable[[int, int, str], None]) -> Site:
    """Write the files of the report as they are made, each whole or not at all."""
    names: list[str] = []
    done = 0

    def step(claim: str) -> None:
        nonlocal done
        done += 1
        progress(done, len(ledger), claim)

    for name, text in pages(ledger, read_wordings(), progress=step):
        write_text(out / name, text, durable=False)
        names.append(name)
    return Site(out, tuple(names), ledger)


def read_wordings() -> dict[str, Words]:
    """Wording of the erratum sheets by module, from the folder beside the papers."""
    files = sorted((papers_folder() / "errata").glob("*.toml"))
    return {path.stem: read_wording(read_text(path, LARGEST), path.name) for path in files}
