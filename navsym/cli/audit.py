"""Read the formulas of source code and decide questions about them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from navsym.cli.output import emit, table

if TYPE_CHECKING:
    from navsym.audit.answer import Audit


def command(
    file: Path,
    *,
    function: str | None = None,
    all_: bool = False,
    annotations: bool = False,
    html: Path | None = None,
    json_: bool = False,
) -> int:
    """Read the formulas of source code and decide questions about them. Status 1 when an entry is refuted.

    Example: navsym audit examples/audit/yaw_jacobian.toml

    Formulas only: navsym audit examples/audit/yaw_jacobian.c --function predict
    """
    import navsym as nav

    answer = nav.audit(file, function=function)
    if html is not None:
        from navsym.language.files import write_text
        from navsym.report.audit_page import audit_page

        write_text(html, audit_page(answer))
    if annotations and not json_:
        lines = answer.annotations()
        emit({}, as_json=False, text="\n".join(lines))
    else:
        emit(answer.document(all_), as_json=json_, text=lambda: as_text(answer, all_))
    return 1 if any(question.status == nav.REFUTED for question in answer.questions) else 0


def as_text(answer: Audit, every: bool) -> str:
    """What was read, then the questions with their entries, or the formulas."""
    files = [(f.file, f.language, f"{f.statements - f.unread} of {f.statements}") for f in answer.files]
    blocks = [table(("file", "language", "statements read"), files)]
    refused = [(f"{f.file}:{line}", why) for f in answer.files for line, why in f.refused]
    if refused:
        blocks.append(table(("not read", "because"), refused))
    if answer.formulas:
        rows = [(formula.name, str(formula.line or ""), formula.formula, formula.case) for formula in answer.formulas]
        blocks.append(table(("output", "line", "formula", "case"), rows))
    for question in answer.questions:
        listed = [e for e in question.entries if every or not e.status.holds]
        proved = sum(e.status.holds for e in question.entries)
        head = (
            f"{question.name} ({question.kind}): {question.status}, {proved} of {len(question.entries)} entries proved"
        )
        blocks.append(f"{head}, {question.sense}\n" if question.status.holds else f"{head}\n")
        if listed:
            rows = [
                (f"{e.entry[0]},{e.entry[1]}", f"{Path(e.file).name}:{e.line}", str(e.status), e.remark())
                for e in listed
            ]
            blocks.append(table(("entry", "place", "verdict", "remark"), rows))
    return "\n".join(blocks)
