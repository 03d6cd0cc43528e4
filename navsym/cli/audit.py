"""Read the formulas of source code and decide questions about them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli.output import emit, table, write_text

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
    answer = nav.audit(file, function=function)
    if html is not None:
        from navsym.report.audit_page import audit_page

        write_text(html, audit_page(answer))
    if annotations and not json_:
        lines = answer.annotations()
        emit({}, as_json=False, text="\n".join(lines))
    else:
        emit(answer.document(all_), as_json=json_, text=lambda: as_text(answer, all_))
    return 1 if answer.meaningless or any(q.status == nav.REFUTED for q in answer.questions) else 0


def as_text(answer: Audit, every: bool = False) -> str:
    """What was read, then the questions with their entries, or the formulas."""
    blocks = []
    for title, heads, rows in answer.tables(every):
        blocks += ([f"{title}\n"] if title else []) + ([table(heads, rows)] if rows else [])
    return "\n".join(blocks)
