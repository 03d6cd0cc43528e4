"""The claims of the papers with the verdicts that the ledger holds: what ``navsym list`` shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from navsym.claims import Claim, Record, Status
from navsym.core.answers import Answer, Answers, named
from navsym.core.choice import one_of
from navsym.core.tables import Table
from navsym.report.formula.sides import latex
from navsym.verification.ledger import sort_records, stored_ledger
from navsym.verification.papers import list_changed, load_papers

if TYPE_CHECKING:
    from navsym.report.citation import Citation
    from navsym.report.explain import Explanation

SLIPS = ("paper", "scan", "undecidable", "any")


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ListedClaim(Answer):
    """A claim of a paper with the verdict that the ledger holds.

    claim  : the :class:`navsym.claims.Claim`
    record : what the ledger holds, or None when the claim was not decided yet
    """

    claim: Claim
    record: Record | None

    @property
    def id(self) -> str:
        """``module:number``."""
        return self.claim.id

    @property
    def number(self) -> str:
        """Equation and part; a short name for a statement without a number."""
        return self.claim.number

    @property
    def paper(self) -> str:
        """Name of the derivation module."""
        return self.claim.module

    @property
    def title(self) -> str:
        """One sentence: what is claimed."""
        return self.claim.title

    @property
    def status(self) -> Status:
        """The verdict of the ledger; the declared one where there is none."""
        return self.record.status if self.record else self.claim.expect

    @property
    def latex(self) -> str | None:
        """LaTeX of the printed side; None for a statement in words, or one that was not decided yet."""
        return latex(self.record.printed) if self.record else None

    def explain(self, *, seconds: float = 90.0) -> Explanation:
        """Why it has its verdict: :func:`navsym.explain`."""
        from navsym.report.explain import explain

        return explain(self.id, seconds=seconds)

    def cite(self) -> Citation:
        """BibTeX of paper and verdict: :func:`navsym.cite`."""
        from navsym.report.citation import cite

        return cite(self.id)

    def document(self) -> dict[str, Any]:
        """One entry of ``claims`` in the JSON document of ``navsym list``."""
        decided = {"decided": self.record is not None, "corrects": self.claim.corrects_id}
        return named(self, "id paper number title status") | decided | named(self.claim, "slip reason")

    def __repr__(self) -> str:
        return f"<{self.id}: {self.status}; {self.title}>"

    def _repr_latex_(self) -> str | None:
        return None if self.latex is None else rf"$\displaystyle {self.latex} \qquad \text{{{self.status}}}$"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Listing(Answers[ListedClaim]):
    """Claims in the order of their papers: a sequence, or by id.

    changed : papers whose text has changed since their verdicts were written; what their claims declare is shown
    """

    claims: tuple[ListedClaim, ...]
    changed: tuple[str, ...] = ()

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym list``."""
        return {"claims": [claim.document() for claim in self.claims], "count": len(self)}

    def __repr__(self) -> str:
        papers = ", ".join(dict.fromkeys(claim.paper for claim in self.claims))
        return f"<{len(self)} claim{'' if len(self) == 1 else 's'}{f' of {papers}' if papers else ''}>"

    def table(self) -> Table:
        """A line for each claim; a verdict that was not decided yet is the declared one."""
        return ("claim", "verdict", "what it says", "slip"), [
            (c.id, f"{c.status}{'' if c.record else ' (declared)'}", c.title, c.claim.slip or "") for c in self
        ]


def claims(*papers: str, status: str | Sequence[str] = (), slip: str | None = None, words: str = "") -> Listing:
    r"""The claims of these papers, or of all, with the verdicts of the ledger; nothing is decided.

    A claim shows what it declares where the ledger has no verdict, or the text of its paper has changed since.

    papers : names of derivation modules, such as "guaranteed_velocity"
    status : verdicts that count, such as "REFUTED"; all when none is given
    slip   : "paper" or "scan" for claims refuted by a slip there, "undecidable" between the two, "any" for all
    words  : text that the id or the title contains, in small or capital letters

    Raises DomainError for a paper, a verdict or a slip that is none, and NavsymError for a damaged ledger.

    >>> import navsym as nav
    >>> refuted = nav.claims("alpha_beta_filter", status="REFUTED")
    >>> refuted
    <1 claim of alpha_beta_filter>
    >>> refuted[0].id
    'alpha_beta_filter:remark.critical'
    >>> nav.claims()["guaranteed_velocity:4.3.u2*"].latex
    ' - \\frac{\\sin^{2}\\left( T/4 \\right)}{\\cos\\left( T/2 \\right)}'
    """
    given: Any = status if isinstance(status, list | tuple | set | frozenset) else [status]
    statuses = {one_of(word.upper() if isinstance(word, str) else word, tuple(Status), "status") for word in given}
    kind = None if slip is None else one_of(slip, SLIPS, "slip")
    ledger, modules, wanted = stored_ledger(), load_papers(papers), str(words).lower()
    changed = list_changed(ledger.papers, modules)
    stored = {record.id: record for record in ledger if record.paper not in changed}
    listed: list[ListedClaim] = []
    for module in modules:
        listed += sort_records(module.paper, [ListedClaim(claim, stored.get(claim.id)) for claim in module.claims])
    return Listing(tuple(claim for claim in listed if fits(claim, statuses, kind, wanted)), tuple(changed))


def fits(claim: ListedClaim, statuses: set[str], slip: str | None, words: str) -> bool:
    """True for a claim that passes every filter."""
    if statuses and claim.status not in statuses:
        return False
    if slip and not (claim.claim.slip if slip == "any" else claim.claim.slip == slip):
        return False
    return words in claim.id.lower() or words in claim.title.lower()
