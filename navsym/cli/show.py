"""Show one claim: both sides and the verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING

import navsym as nav
from navsym.cli.output import Told
from navsym.core.errors import printable

if TYPE_CHECKING:
    from navsym.claims import Record


def command(claim: str, *, seconds: float = 90.0) -> Told:
    """Show both sides of a claim and its verdict, decided now; all parts of an equation that has several.

    Example: navsym show guaranteed_velocity:4.3.u2
    """
    records = nav.show(claim, seconds=seconds)
    entries = [record.to_json() for record in records]
    document = entries[0] if len(entries) == 1 else {"claims": entries}
    status = 0 if all(record.is_expected for record in records) else 1
    return Told(document, lambda: "\n\n".join(map(as_text, records)), status)


def as_text(record: Record) -> str:
    """A few lines, the verdict first."""
    lines = [f"{record.id}  {record.status}", record.title]
    facts = [(name, getattr(record, name)) for name in "latex printed derived scope method evidence".split()]
    lines += [f"  {name:<9}{words}" for name, words in facts if words or name == "printed"]
    if record.assumptions:
        lines.append(f"  assuming {'; '.join(record.assumptions)}")
    if record.counterexample:
        lines.append(f"  at       {record.point_text}")
    if record.reason:
        lines.append(f"  {record.slip or 'note':<9}{record.reason}")
    if record.corrects:
        lines.append(f"  corrects {record.corrects}")
    if not record.is_expected:
        lines.append(f"  declared {record.expect}")
    return "\n".join(map(printable, lines))
