"""The experiment on joint correction as one document: position errors of five estimators after the first fix."""

from __future__ import annotations

from typing import Any

from navsym.methods.two_stage_flight import great_circle
from navsym.methods.two_stage_ins import Errors, compare

#: Decay rates (lambda_c, lambda_h) of the two stages, in Schuler units.
DECAYS = ((2.0, 3.0), (2.0, 5.0))


def study(seed: int = 1) -> dict[str, Any]:
    """Velocity for 90 minutes, then both for 30, at 250 m/s from latitude 45 degrees; exact covariances.

    The covariances are propagated exactly, so that the seed changes nothing; it is kept in the document.
    """
    flight = great_circle(duration=7200.0, step=10.0)
    rows = []
    for lambda_c, lambda_h in DECAYS:
        found = compare(flight, Errors(), lambda_c=lambda_c, lambda_h=lambda_h)
        for name, errors in found.rows.items():
            rows.append({"lambda_c": lambda_c, "lambda_h": lambda_h, "estimator": name, "position_m": list(errors)})
    return {"experiment": "joint_correction", "seed": seed, "minutes": list(found.minutes), "rows": rows}


def as_table(document: dict[str, Any]) -> tuple[list[str], list[list[str]]]:
    """Headings and rows for people: position errors in metres."""
    heads = ["lambda_c", "lambda_h", "estimator", *(f"{minute:g} min" for minute in document["minutes"])]
    rows = [
        [f"{row['lambda_c']:g}", f"{row['lambda_h']:g}", row["estimator"], *(f"{x:.3g}" for x in row["position_m"])]
        for row in document["rows"]
    ]
    return heads, rows
