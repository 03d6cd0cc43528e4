"""For the verbs that speak about one claim: find it by its id, and decide it."""

from __future__ import annotations

import difflib
import json
from typing import TYPE_CHECKING, Any

from navsym.claims import equation_of
from navsym.core.errors import DomainError

if TYPE_CHECKING:
    from navsym.claims import Claim, Paper

SECONDS = 90.0


def find(wanted: str) -> tuple[Paper, Claim]:
    """Paper and claim of an id ``module:number``; ``module:4.3`` alone is refused with the ids that begin so."""
    from navsym.cli.verify import load

    module, colon, number = wanted.partition(":")
    if not colon and (known := modules_with(wanted)):
        whole = " or ".join(f"{name}:{wanted}" for name in known)
        message = f"expected the id of a claim, MODULE:NUMBER; got {wanted[:80]}; take {whole}"
        raise DomainError(message, where="command line")
    (paper,) = load([module])
    for claim in paper.claims:
        if claim.number == number:
            return paper.paper, claim
    ids = [claim.id for claim in paper.claims]
    close = [known for known in ids if known.startswith(wanted)] if number else ids
    if not close:
        close = [f"{module}:{n}" for n in difflib.get_close_matches(number, [c.number for c in paper.claims])]
    advice = f"take one of {', '.join(close[:6])}" if close else f"see navsym list --paper {module}"
    raise DomainError(f"expected the id of a claim; got {wanted[:80]}; {advice}", where="command line")


def modules_with(number: str) -> list[str]:
    """Modules that have claims of this number, or of parts of it."""
    pairs = [(name.partition(":")[0], name.partition(":")[2]) for name in stored_records()]
    return sorted({module for module, known in pairs if known == number or known.startswith(f"{number}.")})


def parts_of(wanted: str) -> list[str]:
    """Ids of all claims about a numbered equation, ``module:4.16``; of anything else, what was wanted."""
    from navsym.cli.verify import load

    module, colon, number = wanted.partition(":")
    if not colon:
        return [wanted]
    (paper,) = load([module])
    numbers = [claim.number for claim in paper.claims]
    if number in numbers or number not in paper.paper.equations:
        return [wanted]
    return [f"{module}:{n}" for n in numbers if equation_of(n, paper.paper.equations) == number] or [wanted]


def decide(wanted: str, seconds: float = SECONDS) -> tuple[Paper, dict[str, Any]]:
    """Paper card and record of one claim, decided now in a limited child process."""
    from navsym.verification.decide import PaperModule, verify

    paper, claim = find(wanted)
    document = verify([PaperModule(paper.module, paper, (claim,))], jobs=1, seconds=seconds)
    return paper, document["claims"][0]


def stored_records() -> dict[str, dict[str, Any]]:
    """Records of the ledger by id; empty when there is none."""
    from navsym.claims.paper import papers_folder

    path = papers_folder() / "verdicts.json"
    if not path.exists():
        return {}
    return {record["id"]: record for record in json.loads(path.read_text(encoding="utf-8"))["claims"]}
