"""The target at every epoch of a stream of measurements, with a guaranteed radius; gross errors excluded."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from navsym.cli._options import called_options
from navsym.cli._settings import values_of
from navsym.cli.output import Told, remark, table

if TYPE_CHECKING:
    from navsym.guaranteed.streaming.run import Stream

#: Rows of the table at its start and at its end.
SHOWN = 12


def command(
    file: Path,
    *,
    data: Path,
    target: str | None = None,
    memory: int | None = None,
    outliers: int = 0,
    bound: str = "bounded",
    step: str | None = None,
    state: Path | None = None,
    set_: list[str] | None = None,
) -> Told:
    """Estimate the target at the time of each epoch, from all epochs so far or the last --memory, with its radius.

    The radius is the least sum of sigma times weight of an unbiased estimate. Data that no state explains are an error.
    Certificates stand in the JSON document: of all epochs where these are few, else of the last.

    Example: navsym guard examples/guard.toml --data examples/guard.csv --target range --outliers 1
    """
    from navsym.guaranteed.streaming.run import run_stream

    with called_options("Guard"):
        stream = run_stream(
            file, data, target, bound, memory=memory, outliers=outliers, values=values_of(set_), step=step, state=state
        )
    for line in stream.remarks:
        remark(line)
    return Told(stream.document, lambda: as_text(stream))


def as_text(stream: Stream) -> str:
    """The first and the last rows, and how many are left out."""
    rows: list[Any] = [describe_row(row) for row in stream.rows]
    left = len(rows) - 2 * SHOWN
    if left > 0:
        rows = [*rows[:SHOWN], (f"({left} more)", "", "", "", ""), *rows[-SHOWN:]]
    head = ("t", "estimate", "radius", "support", "excluded")
    return f"{stream.summary()}\n{table(head, rows, right=head[:4])}"


def describe_row(row: dict[str, Any]) -> tuple[str, ...]:
    """One epoch in words."""
    if row["estimate"] is None:
        return f"{row['t']:.9g}", "not estimable", "", "", ""
    excluded = ", ".join(f"{t:.9g}" for t in row["excluded"])
    radius = f"{float(row['radius']['upper']):.6g}"
    return f"{row['t']:.9g}", f"{row['estimate']:.9g}", radius, str(row["support"]), excluded
