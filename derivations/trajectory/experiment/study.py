"""The experiment of the GLONASS paper as one document: printed figures beside obtained ones."""

import math
from collections.abc import Callable
from typing import Any

from navsym_papers.trajectory.experiment.courses import experiment

FIGURES = ("position", "speed_straight", "speed_yawing", "acceleration_straight", "acceleration_yawing")


def study(
    runs: int = 2, seed: int = 1, *, progress: Callable[[int, int], None] = lambda done, of: None
) -> dict[str, Any]:
    """Mean figures over some runs, by speed, heading programme and algorithm; null where it diverges.

    progress : called with (finished, all) runs
    """
    found = experiment(runs, seed, progress)
    rows = [{**row, **{key: finite(row[key]) for key in ("obtained", "spread")}} for row in found]
    return {"experiment": "trajectory", "runs": runs, "seed": seed, "units": "m, m/s, m/s^2", "rows": rows}


def finite(values: dict[str, float]) -> dict[str, float | None]:
    """Plain numbers; what is not finite becomes null."""
    return {key: value if math.isfinite(value) else None for key, value in values.items()}


def as_table(document: dict[str, Any]) -> tuple[list[str], list[list[str]]]:
    """Headings and rows for people; a printed figure stands in brackets behind the obtained one."""
    heads = ["V, m/s", "heading", "algorithm", *FIGURES]
    return heads, [table_row(row) for row in document["rows"]]


def table_row(row: dict[str, Any]) -> list[str]:
    """One line of the table."""
    cells = [str(row["speed"]), row["heading"], row["algorithm"]]
    for name in FIGURES:
        value, printed = row["obtained"].get(name), row["printed"].get(name)
        shown = "diverges" if value is None else f"{value:.3g}"
        cells.append(shown if printed is None else f"{shown} ({printed})")
    return cells
