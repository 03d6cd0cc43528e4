"""Read the formulas of source code and decide questions about them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli.output import Told, table, write_text

if TYPE_CHECKING:
    from navsym.audit.answer import Audit


def command(
    file: Path, *, function: str | None = None, all_: bool = False, annotations: bool = False, html: Path | None = None
) -> Told:
    """Read the formulas of source code and decide questions about them. Status 1 when an entry is refuted.

    Example: navsym audit examples/audit/yaw_jacobian.toml

    Formulas only: navsym audit examples/audit/yaw_jacobian.c --function predict
    """
    answer = nav.audit(file, function=function)
    if html is not None:
        from navsym.report.audit_page import audit_page

        write_text(html, audit_page(answer))
    status = 1 if answer.meaningless or any(q.status == nav.REFUTED for q in answer.questions) else 0
    text = "\n".join(answer.annotations()) if annotations else lambda: as_text(answer, all_)
    return Told(lambda: answer.document(all_), text, status)


def as_text(answer: Audit, every: bool = False) -> str:
    """What was read, then the questions with their entries, or the formulas."""
    blocks = []
    for title, heads, rows in answer.tables(every):
        blocks += ([f"{title}\n"] if title else []) + ([table(heads, rows)] if rows else [])
    return "\n".join(blocks)
