"""The pages of the report in a folder."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from navsym.claims.paper import papers_folder
from navsym.claims.workspace import find_workspace
from navsym.core.answers import Answer
from navsym.language.files import make_folder, read_text, write_text
from navsym.language.tomlfile import read_toml
from navsym.report.page import pages
from navsym.report.wording import read_wording
from navsym.verification.decide import SECONDS, verify
from navsym.verification.ledger import Ledger, read_ledger
from navsym.verification.papers import list_changed, load_papers

LARGEST = 1_000_000  # bytes of the wording of a sheet


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
    out: str | os.PathLike[str] | None = None,
    source: str | os.PathLike[str] | Ledger | None = None,
    jobs: int | None = None,
    seconds: float = SECONDS,
    fresh: bool = False,
    progress: Callable[[int, int, str], None] = lambda done, of, doing: None,
    remark: Callable[[str], None] = lambda sentence: None,
) -> Site:
    """Write static HTML pages of verdicts, erratum sheets and certificates into a folder.

    The pages need neither a network nor a script. Every certificate is a file that ``navsym check`` replays. The report
    of all papers has the book, too.

    papers   : names of derivation modules; all when none is given
    out      : the folder, by default ``report``, in the workspace if there is one; made when it is not there
    source   : a ledger, or the path of a document of ``navsym verify --json``; by default the claims are decided, and
               so are those of a ledger whose paper has changed since
    jobs, seconds, fresh : as in :func:`navsym.verify`
    progress : called with (done, all, id) while claims are decided, and again while they are set in type
    remark   : called with a sentence on what is kept

    Raises OutputError for a folder that cannot be made, ShapeError for a document that is none of verdicts.

    >>> import navsym as nav
    >>> site = nav.report("alpha_beta_filter", out="pages")
    >>> "index.html" in site.files, site.ledger.counts["REFUTED"]
    (True, 1)
    """
    workspace, chosen = find_workspace(), load_papers(papers)
    folder = Path("report" if workspace is None else workspace.root / "report") if out is None else Path(out)
    cards = {module.name: module.paper for module in chosen}
    ledger = source if isinstance(source, Ledger) else None
    if source is not None and not isinstance(source, Ledger):
        ledger = read_ledger(source)
    make_folder(folder / "certificates", "choose another --out")  # before minutes are spent on what cannot be written
    run = partial(verify, jobs=jobs, seconds=seconds, fresh=fresh, progress=progress, remark=remark)
    if ledger is None:
        ledger = run(*papers)
    elif papers:
        ledger = ledger.restrict(cards)
    if changed := list_changed(ledger.papers, chosen):
        remark(f"the text of {', '.join(changed)} has changed since its verdicts were written: decided now")
        ledger = run(*changed).merge(ledger)
    whole = not papers and workspace is None
    return write_pages(folder, Ledger(ledger.claims, ledger.papers, ledger.unsaved, cards), progress, book=whole)


def read_models() -> dict[str, Any]:
    """The error models of the workspace, by their files, with their conventions."""
    from navsym.verification.error_models import conventions

    workspace = find_workspace()
    names = [] if workspace is None else workspace.list_files("models")
    files = {name: workspace.root / name for name in names} if workspace else {}
    return {name: conventions(path) for name, path in files.items() if "roles" in read_toml(path)}


def write_pages(out: Path, ledger: Ledger, progress: Callable[[int, int, str], None], *, book: bool = False) -> Site:
    """Write the files of the report as they are made, each whole or not at all; with the book or without."""
    names, numbers, workspace = list[str](), itertools.count(1), find_workspace()

    def step(claim: str) -> None:
        progress(next(numbers), len(ledger), claim)

    home = papers_folder() if workspace is None else workspace.root
    files = sorted((home / "errata").glob("*.toml"))  # wording of the erratum sheets, by module
    wordings = {path.stem: read_wording(read_text(path, LARGEST), path.name) for path in files}
    for name, text in pages(ledger, wordings, book=book, models=read_models(), progress=step):
        write_text(out / name, text, durable=False)
        names.append(name)
    return Site(out, tuple(names), ledger)
