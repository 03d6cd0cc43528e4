"""The experiment on joint correction as one document: position errors of five estimators after the first fix."""

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np

from navsym_papers.joint_correction.experiment import ins
from navsym_papers.joint_correction.experiment.flight import EARTH_RADIUS, SCHULER_RATE, Flight, great_circle

#: Decay rates (lambda_c, lambda_h) of the two stages, in Schuler units.
DECAYS = ((2.0, 3.0), (2.0, 5.0))

#: What the last paragraph of the paper lists, one after the other: situation and minutes.
SITUATIONS = (
    (ins.Situation.VELOCITY, 40.0),
    (ins.Situation.BOTH, 20.0),
    (ins.Situation.VELOCITY, 15.0),
    (ins.Situation.NEITHER, 10.0),
    (ins.Situation.POSITION, 25.0),
)


def study(seed: int = 1, *, progress: Callable[[int, int], None] = lambda done, of: None) -> dict[str, Any]:
    """Velocity for 90 minutes, then both for 30, at 250 m/s from latitude 45 degrees; exact covariances.

    The covariances are propagated exactly, so that the seed changes nothing; it is kept in the document.
    progress : called with (finished, all) covariance runs, the two over the situations included
    """
    flight = great_circle(duration=7200.0, step=10.0)
    done, of = itertools.count(1), len(DECAYS) * ins.ESTIMATORS + 2

    def step() -> None:
        progress(next(done), of)

    rows = []
    for lambda_c, lambda_h in DECAYS:
        found = ins.compare(flight, ins.Errors(), lambda_c=lambda_c, lambda_h=lambda_h, step=step)
        for name, errors in found.rows.items():
            rows.append({"lambda_c": lambda_c, "lambda_h": lambda_h, "estimator": name, "position_m": list(errors)})
    return {
        "experiment": "joint_correction",
        "seed": seed,
        "minutes": list(found.minutes),
        "rows": rows,
        "situations": situations(flight, step),
    }


def situations(flight: Flight, step: Callable[[], None] = lambda: None) -> list[dict[str, Any]]:
    """Errors at the end of every situation: algorithm and Kalman filter of the full model, exact covariances."""
    seconds = float(flight.tau[1] - flight.tau[0]) / SCHULER_RATE
    chosen = ins.plan(SITUATIONS, seconds, *DECAYS[0])
    curves = {"two stages": ins.standard_deviations(ins.steps_of(flight, chosen, ins.Errors()), ins.Errors())}
    step()
    curves["Kalman filter, full model"] = ins.kalman_deviations(flight, chosen, ins.Errors())
    step()
    ends = np.cumsum([round(minutes * 60.0 / seconds) for _, minutes in SITUATIONS])
    speed = EARTH_RADIUS * SCHULER_RATE
    return [
        {
            "situation": str(situation),
            "minutes": minutes,
            "estimator": name,
            "position_m": float(ins.position_error(curve)[end]),
            "velocity_error_mps": float(np.hypot(curve[end, 1], curve[end, 4]) * speed),
        }
        for (situation, minutes), end in zip(SITUATIONS, ends, strict=True)
        for name, curve in curves.items()
    ]


def as_table(document: dict[str, Any]) -> tuple[list[str], list[list[str]]]:
    """Headings and rows for people: position errors in metres."""
    heads = ["lambda_c", "lambda_h", "estimator", *(f"{minute:g} min" for minute in document["minutes"])]
    rows = [
        [f"{row['lambda_c']:g}", f"{row['lambda_h']:g}", row["estimator"], *(f"{x:.3g}" for x in row["position_m"])]
        for row in document["rows"]
    ]
    return heads, rows


def sweep_job(sweep: Any, index: int) -> dict[str, Any]:
    """Standard deviations of position in metres, 30 minutes after position is first measured, of every estimator.

    The parameters are lambda_c and lambda_h, the flight a great circle of two hours.
    """
    first, second = sweep.parameters(index)
    flight = great_circle(duration=7200.0, step=20.0)
    found = ins.compare(flight, ins.Errors(), lambda_c=float(first), lambda_h=float(second))
    last = {name: float(errors[-1]) for name, errors in found.rows.items()}
    return {"index": index, "lambda_c": str(first), "lambda_h": str(second), **last}
