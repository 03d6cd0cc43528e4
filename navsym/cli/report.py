"""Write the report: static HTML pages of verdicts, erratum sheets and certificates."""

from __future__ import annotations

from pathlib import Path

import navsym as nav
from navsym.cli._progress import Progress
from navsym.cli.output import Told, remark
from navsym.cli.verify import unexpected_lines


def command(
    modules: list[str] | None = None,
    *,
    out: Path | None = None,
    source: Path | None = None,
    jobs: int | None = None,
    seconds: float = 90.0,
    fresh: bool = False,
) -> Told:
    """Decide the claims (or read verdicts with --from) and write the pages. Exit status as in verify.

    Example: navsym report alpha_beta_filter --out report
    """
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
    return Told(site.document, told, 1 if wrong else 0)
