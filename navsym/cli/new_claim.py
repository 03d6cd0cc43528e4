"""Add a claim to a derivation module: both sides as formulas, decided at once."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from navsym.cli.output import emit, write_text
from navsym.errors import DomainError


def command(
    module: Annotated[str, typer.Argument(help="derivation module in one file")],
    number: Annotated[str, typer.Argument(help="equation and part, such as 4.3.u2; a star for a correction")],
    printed: Annotated[str, typer.Option(help="the printed side, in the language of files")],
    derived: Annotated[str, typer.Option(help="the derived side; replace it by the route from the model")],
    title: Annotated[str, typer.Option(help="what the equation says, one sentence")] = "",
    corrects: Annotated[str, typer.Option(help="number of the refuted claim that this one replaces")] = "",
    reason: Annotated[str, typer.Option(help="for a refuted claim: what is wrong")] = "",
    slip: Annotated[str, typer.Option(help="for a refuted claim: who slipped, paper or scan")] = "paper",
    folder: Annotated[Path | None, typer.Option(help="where; default: the folder of derivations")] = None,
    json_: Annotated[bool, typer.Option("--json", help="print one JSON document")] = False,
) -> None:
    """Decide printed = derived and append the claim, declared with the verdict that was found.

    Example: navsym new-claim schuler_pendulum 3 --printed "sin(2*x)" --derived "2*sin(x)*cos(x)"
    """
    from navsym.cli.verify import ledger_folder
    from navsym.text.scaffold import check_module_name, with_claim

    path = (folder or ledger_folder()) / f"{check_module_name(module)}.py"
    if not path.is_file():
        message = f"expected a module in one file; got {module}; make it with navsym new-paper"
        raise DomainError(message, where=str(path))
    verdict = decided(printed, derived)
    sentence = title or f"Equation ({number.rstrip('*')}), {'corrected' if corrects else 'as it stands in the paper'}."
    why = reason or ("say here what is wrong" if verdict.status == "REFUTED" else "")
    source = path.read_text(encoding="utf-8")
    if slip not in ("paper", "scan"):
        raise DomainError(f"expected paper or scan; got {slip[:40]}; name one", where="--slip")
    who = slip if verdict.status == "REFUTED" else ""
    text = with_claim(source, number, sentence, printed, derived, str(verdict.status), corrects, why, who)
    write_text(path, text)
    document = {
        "path": str(path), "id": f"{module}:{number}", "status": str(verdict.status), "evidence": verdict.evidence,
    }  # fmt: skip
    emit(document, as_json=json_, text=lambda: as_text(document))


def decided(printed: str, derived: str) -> Any:
    """Verdict of the equation between the two texts."""
    from navsym.claims import Equation
    from navsym.proof.ladder import decide_within
    from navsym.text.scaffold import read

    return decide_within(Equation(read(printed, "--printed"), read(derived, "--derived")))


def as_text(document: dict[str, Any]) -> str:
    lines = [f"{document['id']}  {document['status']}  {document['evidence']}", document["path"]]
    if document["status"] == "REFUTED":
        module, _, number = document["id"].partition(":")
        command = f"navsym new-claim {module} '{number}*' --corrects {number} --printed … --derived …"
        lines.append(f"next: its correction, {command}")
    return "\n".join(lines)
