"""List the claims of the papers with the verdicts of the ledger."""

from __future__ import annotations

import navsym as nav
from navsym.claims.display import count_in_words
from navsym.cli.output import Told, remark, table


def command(
    *,
    paper: list[str] | None = None,
    status: list[str] | None = None,
    slip: str | None = None,
    words: str | None = None,
) -> Told:
    """List claims in the order of the paper, without deciding them.

    A claim shows its declaration where the ledger does not hold it, or the text of its paper has changed since.

    Example: navsym list --status REFUTED --slip paper
    """
    listing = nav.claims(*(paper or []), status=status or (), slip=slip, words=words or "")
    for name in listing.changed:
        remark(f"the text of {name} has changed since its verdicts were written: navsym verify {name} --write")
    return Told(listing.document, lambda: f"{table(*listing.table())}\n{count_in_words(len(listing), 'claim')}")
