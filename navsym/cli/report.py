"""Write the report: static HTML pages of verdicts, erratum sheets and certificates."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from navsym.cli._progress import Progress
from navsym.cli.output import emit, remark
from navsym.cli.verify import unexpected_lines


def command(
    modules: Annotated[list[str] | None, typer.Argument(help="derivation modules; default: all")] = None,
    out: Annotated[
        Path | None, typer.Option(help="folder for the pages, made when it is not there; default: report")
    ] = None,
    source: Annotated[
        Path | None, typer.Option("--from", help="take verdicts from a document of navsym verify --json, or a ledger")
    ] = None,
    jobs: Annotated[int | None, typer.Option(help="claims decided at the same time; default: one per core")] = None,
    seconds: Annotated[
        float, typer.Option(help="limit of processor time for one claim; above it the verdict is OPEN")
    ] = 90.0,
    fresh: Annotated[bool, typer.Option("--fresh", help="search everything again, use no kept certificate")] = False,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> int:
    """Decide the claims (or read verdicts with --from) and write the pages. Exit status as in verify.

    Example: navsym report alpha_beta_filter --out report
    """
    import navsym as nav

    resume = "verdicts and finished pages are kept, their index is not; the same command goes on from there"
    with Progress("claims", resume=resume) as bar:
        site = nav.report(
            *(modules or []),
            out=out,
            source=source,
            jobs=jobs,
            seconds=seconds,
            fresh=fresh,
            progress=bar.follow,
            remark=remark,
        )
    wrong = site.ledger.unexpected
    told = "\n".join([f"{len(site.files)} files; open {site.out / 'index.html'}", *unexpected_lines(wrong)])
    emit(site.document(), as_json=json_, text=told)
    return 1 if wrong else 0
