"""Explain a verdict step by step: what was reduced, where, and the arithmetic of a counterexample."""

from __future__ import annotations

import inspect
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from navsym.claims.paper import papers_folder
from navsym.cli._claims import decide, find
from navsym.cli.output import emit

if TYPE_CHECKING:
    from navsym.claims import Claim

WIDTH = 100
FORMULA = " " * 6


def command(
    claim: Annotated[str, typer.Argument(help="id of a claim, such as guaranteed_velocity:4.3.u2")],
    seconds: Annotated[float, typer.Option(help="limit, seconds; above it the verdict is OPEN")] = 90.0,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> int:
    """Tell why a claim has its verdict.

    Example: navsym explain guaranteed_velocity:4.3.u2
    """
    from navsym.report.explain import steps

    paper, found = find(claim)
    _, record = decide(claim, seconds)
    told = [{"heading": s.heading, "words": s.words, "formula": s.formula} for s in steps(record)]
    correction = correction_of(claim)
    document = {
        "id": record["id"],
        "status": record["status"],
        "paper": paper.title,
        "source": place_of(found.derive),
        "corrected_by": correction and correction.id,
        "steps": told,
        "correction": correction and {"title": correction.title, "formula": formula_of(correction)},
    }
    emit(document, as_json=json_, text=lambda: as_text(document))
    return 0 if record["status"] == record["expect"] else 1


def place_of(derive: Any) -> str:
    """File and line of the derivation, from the folder of the derivations on."""
    code = inspect.unwrap(derive).__code__
    file = Path(code.co_filename).relative_to(papers_folder().parent)
    return f"{file.as_posix()}:{code.co_firstlineno}"


def correction_of(wanted: str) -> Claim | None:
    """The claim that corrects this one."""
    from navsym.cli.verify import load

    (paper,) = load([wanted.partition(":")[0]])
    return next((claim for claim in paper.claims if claim.corrects_id == wanted), None)


def formula_of(claim: Claim) -> str | None:
    """The formula that a claim prints; None where all is said in its title."""
    from navsym.report.formula.sides import only_truth
    from navsym.verification.decide import sides

    printed, _ = sides(claim.derive())
    return None if only_truth(printed) else printed


def indented(formula: str) -> str:
    return textwrap.fill(formula, WIDTH, initial_indent=FORMULA, subsequent_indent=FORMULA)


def as_text(document: dict[str, Any]) -> str:
    """Numbered steps; formulas on lines of their own."""
    lines, number = [f"{document['id']}  {document['status']}", f"{document['paper']}", ""], 0
    for step in document["steps"]:
        number += bool(step["heading"])
        head = f"{number}. {step['heading']}. " if step["heading"] else "   "
        lines.append(textwrap.fill(head + step["words"], WIDTH, subsequent_indent="   ", break_long_words=False))
        if step["formula"]:
            lines += ["", indented(step["formula"]), ""]
    lines += ["", f"Derivation: {document['source']}"]
    if document["corrected_by"]:
        should = document["correction"]
        lines += ["", f"It should read ({document['corrected_by']}): {should['title']}"]
        lines += ["", indented(should["formula"])] if should["formula"] else []
    return "\n".join(lines)
