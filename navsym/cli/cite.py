"""Cite a verdict: BibTeX of the paper and of the verdict."""

from __future__ import annotations

import navsym as nav
from navsym.cli.output import Told


def command(claim: str, *, fresh: bool = False) -> Told:
    """Print BibTeX for the paper and for the verdict, from the ledger where it has one.

    Example: navsym cite "guaranteed_velocity:4.3.u2*" >> references.bib
    """
    cited = nav.cite(claim, fresh=fresh)
    return Told(cited.document, cited.bibtex)
