"""What a campaign prints: the row for docs/attacks.md, and its counts for people."""

from __future__ import annotations

import datetime
import shlex
from collections.abc import Sequence
from typing import Any

from navsym.cli.output import table


def markdown_row(document: dict[str, Any], what: str, words: Sequence[str], seconds: float) -> str:
    """The row of the table in docs/attacks.md: what was attacked, the words of the command, the outcome, the date."""
    # Counts by the kind of change stand beside those by outcome.
    said = [f"{n:,} {outcome}" for outcome, n in document["counts"].items() if not outcome.startswith("kind ")]
    said += [f"{len(document[name])} {name}" for name in ("wrong", "stopped") if document[name] or name == "wrong"]
    if document["measured"]:
        said.append(f"slowest {max(row['slowest'] for row in document['measured'].values()):.2f} s")
    took = f"{seconds / 60:.0f} min" if seconds > 90 else f"{seconds:.0f} s"
    took += f", {document['resumed']} of {document['batches']} batches kept from before" * bool(document["resumed"])
    date = datetime.date.today().isoformat()
    return f"| {what} | `navsym {shlex.join(words)}` | {', '.join(said)} ({took}) | {date} |"


def as_text(document: dict[str, Any]) -> str:
    """Counts by outcome, what was measured of each reader, and the first of what is wrong, open, stopped, not kept."""
    rows = [(outcome, str(count)) for outcome, count in document["counts"].items()]
    lines = [table((document["campaign"], "count"), rows)]
    measured = document["measured"]
    if measured:
        names = list(next(iter(measured.values())))
        rows_measured = [(reader, *(f"{row[n]:g}" for n in names)) for reader, row in measured.items()]
        lines.append(table(("reader", *names), rows_measured))
    lines.append(f"{document['batches']} batches, {document['resumed']} resumed, wrong: {len(document['wrong'])}")
    for key, word in (("wrong", "wrong"), ("open", "open"), ("stopped", "stopped"), ("unsaved", "not kept")):
        lines += [f"{word}: {item}" for item in document[key][:20]]
    return "\n".join(lines)
