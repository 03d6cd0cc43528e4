"""The guaranteed estimator of a model: optimal times and weights, with a certificate."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import navsym as nav
from navsym.cli._progress import Progress
from navsym.cli._settings import values_of
from navsym.cli.output import Told, dumps, table, write_text


def command(
    file: Path,
    *,
    target: str | None = None,
    set_: list[str] | None = None,
    digits: int = 30,
    compare: bool = False,
    design: bool = False,
    out: Path | None = None,
) -> Told:
    """Find the estimator with the smallest guaranteed standard deviation, with a certificate that can be replayed.

    The value is in units of the target; times run from the start of the interval.
    The status is 1 when fewer digits are certified than were asked for (OPEN).

    Example: navsym solve examples/schuler-velocity.toml --target drift --set T=pi/2
    """
    found: Any = nav.design if design else nav.solve
    estimator = found(file, target, digits=digits, values=values_of(set_))
    document = estimator.document()
    if out is not None:
        write_text(out, dumps(document["certificate"]) + "\n")
    if compare:
        from navsym.guaranteed.convex import LP_SOLVERS

        with Progress("solvers", len(LP_SOLVERS), "without --compare the answer comes at once") as bar:
            document["compare"] = estimator.compare(progress=bar.step).document()
    status = 0 if document["status"] == "CERTIFIED" else 1
    return Told(document, lambda: (design_text if design else as_text)(document), status)


def as_text(document: dict[str, Any]) -> str:
    value = document["value"]
    lines = [
        f"{document['target']}: {document['status']}",
        f"guaranteed standard deviation  {value['lower']}",
        f"                            …  {value['upper']}",
    ]
    rows = [(row["measurement"], row["at"], row["weight"]) for row in document["support"]]
    lines.append(table(("measurement", "at", "weight"), rows))
    words = {True: "the only optimal estimator", None: "other optimal estimators are not excluded"}
    lines.append(words.get(document["unique"], "other optimal estimators exist"))
    if "missing" in document:
        lines.append(document["missing"])
    if "compare" in document:
        lines.append(comparison(document["compare"]))
    return "\n".join(lines)


def design_text(document: dict[str, Any]) -> str:
    """What to buy, where to measure, and how the value changes with each bound and instant."""
    names = ("measurement", "at", "sigma", "weight", "share", "slope")
    rows = [
        (*(row[n] for n in names[:3]), *("" if row[n] is None else f"{row[n]:.6g}" for n in names[3:]))
        for row in document["support"]
    ]
    return "\n".join(
        [
            f"{document['target']}: {document['status']}",
            f"guaranteed error  {document['value']['lower']}",
            f"               …  {document['value']['upper']}",
            f"needs {', '.join(document['bought'])}: cost {document['cost']}",
            table(names, rows, right=names[2:]),
            *([comparison(document["compare"])] if "compare" in document else []),
        ]
    )


def comparison(data: dict[str, Any]) -> str:
    rows = [("least squares", "", data["least_squares"]), ("Kalman, white noise", "", data["kalman_white_noise"])]
    rows += [(row["solver"], row["status"], row["value"]) for row in data["solvers"]]
    return table(("estimator", "status", "guaranteed deviation"), rows, right=("guaranteed deviation",))
