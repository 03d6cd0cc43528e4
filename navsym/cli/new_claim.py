"""Add a claim to a derivation module: both sides as formulas, decided at once."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from navsym.claims import Verdict, equation_of
from navsym.cli.output import emit, write_text
from navsym.core.errors import DomainError

if TYPE_CHECKING:
    from navsym.language.scaffold import NewClaim


def command(
    module: Annotated[str, typer.Argument(help="derivation module in one file")],
    number: Annotated[str, typer.Argument(help="equation and part, such as 4.3.u2; a star for a correction")],
    printed: Annotated[str, typer.Option(help="the printed side, in the language of files")],
    derived: Annotated[str, typer.Option(help="the derived side; replace it by the route from the model")],
    title: Annotated[str, typer.Option(help="what the equation says, one sentence")] = "",
    positive: Annotated[str, typer.Option(help="new names that are positive, such as R,g; others are real")] = "",
    tolerance: Annotated[
        str | None, typer.Option(help="for a printed numeral: half a unit of its last digit, such as 0.05")
    ] = None,
    corrects: Annotated[str, typer.Option(help="number of the refuted claim that this one replaces")] = "",
    reason: Annotated[str, typer.Option(help="for a refuted claim: what is wrong")] = "",
    slip: Annotated[str, typer.Option(help="for a refuted claim: who slipped, paper or scan")] = "paper",
    folder: Annotated[Path | None, typer.Option(help="where; default: the folder of derivations")] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Decide printed = derived and append the claim, declared with the verdict that was found.

    Example: navsym new-claim schuler_pendulum 1 --printed "2*pi*sqrt(R/g)" --derived "2*pi/sqrt(g/R)" --positive R,g
    """
    from navsym.claims.paper import papers_folder
    from navsym.language.scaffold import NewClaim, append_claim, check_module_name, read_equation_numbers

    path = (folder or papers_folder()) / f"{check_module_name(module)}.py"
    if not path.is_file():
        message = f"expected a module in one file; got {module}; make it with navsym new-paper"
        raise DomainError(message, where=str(path))
    if slip not in ("paper", "scan"):
        raise DomainError(f"expected paper or scan; got {slip[:40]}; name one", where="--slip")
    names = frozenset(name.strip() for name in positive.split(",") if name.strip())
    sentence = title or f"Equation ({number.rstrip('*')}), {'corrected' if corrects else 'as it stands in the paper'}."
    source = path.read_text(encoding="utf-8")
    asked = NewClaim(number, sentence, printed, derived, "OPEN", corrects, reason, "", names, tolerance)
    append_claim(source, asked)  # what cannot be written is refused before it is decided
    verdict = decided(source, asked)
    write_text(path, append_claim(source, declared(asked, verdict, slip)))
    document = {
        "path": str(path),
        "id": f"{module}:{number}",
        "status": str(verdict.status),
        "evidence": verdict.evidence,
        "equation": equation_of(number, read_equation_numbers(source)),
    }
    emit(document, as_json=json_, text=lambda: as_text(document, asked))


def decided(source: str, asked: NewClaim) -> Verdict:
    """Verdict on the two sides, with the names as the file and the command declare them.

    Raises DomainError where nothing is decided for real names and everything for positive ones.
    """
    verdict = verdict_for(source, asked, asked.positive)
    new = new_names(source, asked)
    if verdict.status != "OPEN" or not new:
        return verdict
    if verdict_for(source, asked, asked.positive | new).status.holds:
        listed = ",".join(sorted(new))
        message = (
            f"expected names that say enough; got {listed} of any sign, for which nothing was decided, while it holds "
            f"for positive ones; add --positive {listed} if they are, or declare them in the file"
        )
        raise DomainError(message, where="--positive")
    return verdict


def verdict_for(source: str, asked: NewClaim, positive: frozenset[str]) -> Verdict:
    from navsym.claims import Equation
    from navsym.language.scaffold import parse_module, read_claim_side, read_declarations, read_tolerance
    from navsym.prove.ladder import decide_within

    given = read_declarations(parse_module(source), positive)
    printed, derived = (
        read_claim_side(asked.printed, "--printed", given),
        read_claim_side(asked.derived, "--derived", given),
    )
    tolerance = None if asked.tolerance is None else read_tolerance(asked.tolerance)
    return decide_within(Equation(printed, derived, tolerance=tolerance))


def new_names(source: str, asked: NewClaim) -> frozenset[str]:
    """Names of the two sides that neither the file nor the command declares."""
    from navsym.language.scaffold import EXAMPLE, parse_module, read_claim_side, read_declarations

    given = read_declarations(parse_module(source.replace(EXAMPLE, "", 1)), asked.positive)
    sides = read_claim_side(asked.printed, "--printed"), read_claim_side(asked.derived, "--derived")
    return frozenset(s.name for side in sides for s in side.free_symbols) - frozenset(given)


def declared(asked: NewClaim, verdict: Verdict, slip: str) -> NewClaim:
    """The claim with the verdict that was found, and with words where it needs some."""
    import dataclasses

    refuted = verdict.status == "REFUTED"
    reason = asked.reason or ("say here what is wrong" if refuted else "")
    return dataclasses.replace(asked, expect=str(verdict.status), reason=reason, slip=slip if refuted else "")


def as_text(document: dict[str, Any], asked: NewClaim) -> str:
    """The verdict, the file, and what to do next."""
    lines = [f"{document['id']}  {document['status']}  {document['evidence']}", document["path"]]
    if document["equation"] is None:
        lines.append(f"note: {asked.number} is none of the numbered equations of PAPER; it counts as a remark")
    if document["status"] == "REFUTED":
        module, _, number = document["id"].partition(":")
        command = f"navsym new-claim {module} '{number}*' --corrects {number} --printed … --derived …"
        lines.append(f"next: its correction, {command}")
        if asked.tolerance is None and asked.printed.strip("+-").replace(".", "", 1).isdigit():
            lines.append("a rounded numeral needs --tolerance: take the claim out of the file and add it with one")
    return "\n".join(lines)
