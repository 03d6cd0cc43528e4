"""For notebooks: show a claim with its verdict, and stop when the verdict is not the declared one."""

from __future__ import annotations

import html
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from navsym.claims import Bound, Claim, Equation, Optimum, Property, Statement, Verdict
from navsym.claims.display import SIGNS, latex_of, mark_verdict, write_card
from navsym.core.errors import NavsymError
from navsym.prove.ladder import decide


class UnexpectedVerdictError(NavsymError):
    """A verdict that differs from the declared one."""

    kind = "verdict"
    status = 1


@dataclass(frozen=True, slots=True, eq=False)
class Shown:
    """A claim, its statement and its verdict, as a notebook displays them."""

    claim: Claim
    statement: Statement
    verdict: Verdict

    def _repr_html_(self) -> str:
        """A card; every word that comes from data is escaped."""
        verdict = self.verdict
        rows = [
            f"<b>{html.escape(self.claim.id)}</b> {html.escape(self.claim.title)}",
            *(f"<i>{name}</i> $\\displaystyle {latex}$" for name, latex in statement_latex(self.statement)),
            f"{mark_verdict(str(verdict.status))} by {html.escape(verdict.method)}, {html.escape(verdict.scope)}",
        ]
        rows += [html.escape(words) for words in remarks(self.claim, verdict)]
        return write_card(rows, str(verdict.status))

    def __repr__(self) -> str:
        return f"{self.claim.id}: {self.verdict.status} ({self.verdict.method}; {self.verdict.scope})"


def show(claim: Claim) -> Shown:
    """Derive and decide a claim, and display both sides with the verdict."""
    statement = claim.derive()
    return Shown(claim, statement, decide(statement))


def require(claim: Claim) -> Verdict:
    """The verdict of a claim; raises UnexpectedVerdictError when it is not the declared one."""
    verdict = decide(claim.derive())
    if verdict.status != claim.expect:
        message = f"expected {claim.id} to be {claim.expect}; got {verdict.status}: {verdict.evidence}"
        raise UnexpectedVerdictError(message)
    return verdict


def explore(draw: Callable[..., Any], **ranges: tuple[float, float, float]) -> Any:
    """A drawing with sliders; without a browser it is drawn at the start and at all ends, so that it is tested.

    draw   : function of the named quantities that returns what is shown
    ranges : name -> (lowest, highest, start)

    Returns the widget of ipywidgets.
    """
    import ipywidgets

    start = {name: middle for name, (_, _, middle) in ranges.items()}
    for name, (low, high, _) in ranges.items():
        for end in (low, high):
            draw(**{**start, name: end})
    controls = {
        name: ipywidgets.FloatSlider(value=middle, min=low, max=high, step=(high - low) / 100, continuous_update=False)
        for name, (low, high, middle) in ranges.items()
    }
    return ipywidgets.interactive(draw, **controls)


def remarks(claim: Claim, verdict: Verdict) -> list[str]:
    """What stands below a verdict: reason or slip, counterexample, assumptions."""
    found = []
    if claim.reason:
        found.append(f"{claim.slip or 'note'}: {claim.reason}")
    if verdict.counterexample:
        found.append("counterexample: " + ", ".join(f"{k} = {v}" for k, v in verdict.counterexample.items()))
    if verdict.assumptions:
        found.append("assuming " + ", ".join(verdict.assumptions))
    return found


def statement_latex(statement: Statement) -> list[tuple[str, str]]:
    """The parts of a statement as (word, LaTeX)."""
    if isinstance(statement, Equation):
        return [("printed", latex_of(statement.printed)), ("derived", latex_of(statement.derived))]
    if isinstance(statement, Bound):
        relation = SIGNS.get(statement.relation, statement.relation)
        return [("bound", f"{latex_of(statement.printed)} {relation} {latex_of(statement.derived)}")]
    if isinstance(statement, Optimum):
        names = ("dual", "support", "weights", "value")
        return [(name, latex_of(getattr(statement, name))) for name in names]
    assert isinstance(statement, Property)
    return [("printed", latex_of(statement.printed)), ("found", latex_of(statement.derived.value))]


def verdict_table(claims: Mapping[str, Claim] | list[Claim], choose: Callable[[Claim], bool] = bool) -> str:
    """Claims and verdicts as aligned text, one line each."""
    chosen = [claim for claim in (claims.values() if isinstance(claims, Mapping) else claims) if choose(claim)]
    width = max((len(claim.number) for claim in chosen), default=0)
    return "\n".join(f"{c.number:<{width}}  {decide(c.derive()).status:<9}  {c.title}" for c in chosen)
