"""Write the report: static HTML pages of verdicts, erratum sheets and certificates."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from navsym.cli._progress import Progress
from navsym.cli.output import OutputError, emit, write_text
from navsym.core.errors import ShapeError


def command(
    modules: Annotated[list[str] | None, typer.Argument(help="derivation modules; default: all")] = None,
    out: Annotated[Path, typer.Option(help="folder for the pages; made when it is not there")] = Path("report"),
    source: Annotated[
        Path | None, typer.Option("--from", help="take verdicts from a document of navsym verify --json, or a ledger")
    ] = None,
    jobs: Annotated[int | None, typer.Option(help="claims decided at the same time; default: one per core")] = None,
    seconds: Annotated[
        float, typer.Option(help="limit for one claim, seconds of processor time; above it the verdict is OPEN")
    ] = 90.0,
    fresh: Annotated[bool, typer.Option("--fresh", help="decide everything again, ignoring what is kept")] = False,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> int:
    """Decide the claims (or read verdicts with --from) and write the pages. Status 1 as in verify.

    Example: navsym report alpha_beta_filter --out report
    """
    from navsym.cli.verify import cards_of, decided, load, not_as_declared
    from navsym.verification.decide import unexpected

    chosen = load(modules or [])
    given = read_document(source, modules or []) if source else None
    make_folder(out)  # before minutes are spent on what cannot be written
    document = given or decided(chosen, jobs, seconds, fresh)

    names = write_pages(out, document, cards_of(chosen))
    pages = [name for name in names if name.endswith(".html")]
    result = {"out": str(out), "files": len(names), "pages": pages, "counts": document["counts"]}
    wrong = unexpected(document["claims"])
    told = "\n".join([f"{len(names)} files; open {out / 'index.html'}", *not_as_declared(wrong)])
    emit(result, as_json=json_, text=told)
    return 1 if wrong else 0


def wordings() -> dict[str, Any]:
    """Wording of the erratum sheets by module, from the folder beside the derivations."""
    from navsym.claims.paper import papers_folder
    from navsym.report.wording import read_wording

    files = sorted((papers_folder() / "errata").glob("*.toml"))
    return {path.stem: read_wording(path.read_text(encoding="utf-8"), path.name) for path in files}


KEYS = frozenset(
    "id paper number title status expect method scope assumptions printed derived corrects slip reason "
    "evidence counterexample difference".split()
)


def read_document(path: Path, modules: list[str]) -> dict[str, Any]:
    """A document of ``navsym verify --json`` or a ledger, cut to the modules asked for."""
    from navsym.language.jsonfile import read_json

    document = read_json(path, limit=200_000_000)
    where = str(path)
    expected = "a document of navsym verify --json"
    needed = {"claims", "papers", "counts"}
    if not isinstance(document, dict) or not needed <= set(document):
        came = f"no {', '.join(sorted(needed - set(document)))}" if isinstance(document, dict) else "no object"
        raise ShapeError(f"expected {expected}; got {came}; make it with navsym verify --json", where=where)
    for place, record in enumerate(document["claims"]):
        if not isinstance(record, dict) or (lacking := KEYS - set(record)):
            what = ", ".join(sorted(lacking)) if isinstance(record, dict) else "the record"
            raise ShapeError(f"expected {expected}; got no {what} in it; make it again", where=f"{where}: {place}")
    papers = [paper for paper in document["papers"] if not modules or paper["module"] in modules]
    kept = {paper["module"] for paper in papers}
    claims = [record for record in document["claims"] if record["paper"] in kept]
    statuses = [record["status"] for record in claims]
    return {"claims": claims, "papers": papers, "counts": {s: statuses.count(s) for s in document["counts"]}}


def make_folder(out: Path) -> None:
    """The folder of the pages and that of their certificates; raises OutputError where they cannot be made."""
    try:
        (out / "certificates").mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"expected a folder that can be made; got '{error.strerror}'; choose another --out"
        raise OutputError(message, where=str(out)) from error


def write_pages(out: Path, document: dict[str, Any], cards: dict[str, Any]) -> list[str]:
    """Write the files of the report as they are made, each whole or not at all; their names."""
    from navsym.report.page import pages

    names, words = [], wordings()
    resume = f"finished pages are in {out}, the index is not; the same command makes them all in seconds"
    with Progress("claims set in type", len(document["claims"]), resume) as bar:
        for name, text in pages(document, cards, words, progress=bar.step):
            write_text(out / name, text, durable=False)
            names.append(name)
    return names
