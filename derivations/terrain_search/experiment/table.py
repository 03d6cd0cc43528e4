"""Table 1 beside the flights: errors with confidence intervals, and a verdict for every printed figure.

Flights over one track see the same ground, so they are no independent sample; tracks are. Intervals are those of
the mean over tracks, by Student's distribution: wide with five tracks, and honest.
"""

import json
import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.claims.verdict import CONFIRMED, OPEN, Verdict

Array = NDArray[np.float64]

#: Figures of table 1: seconds, position (m), velocity (m/s).
PRINTED: dict[str, dict[str, float]] = {
    "position": {"seconds": 2.0, "position": 152.2},
    "full": {"seconds": 40.1, "position": 92.7, "velocity": 0.48},
    "sequential": {"seconds": 2.2, "position": 97.0, "velocity": 0.55},
}
UNITS = {"position": "m", "velocity": "m/s"}
#: Width of an interval, as a share of the printed figure, above which it confirms nothing.
WIDEST = 1.0
#: Errors beyond this, in metres, are counted as false fixes.
FALSE = 500.0


@dataclass(frozen=True, slots=True)
class Record:
    """One algorithm on one flight: errors (m, m/s) at the last time and the time taken."""

    setting: str
    track: int
    run: int
    algorithm: str
    position: float
    velocity: float
    seconds: float


def table(records: list[Record]) -> list[dict[str, Any]]:
    """One row for each setting and algorithm.

    ``rms_position`` and ``rms_velocity`` are root mean square errors, with their 95 % intervals beside them (null
    for one track); ``printed_measure`` is the paper's formula sqrt(sum |e| / (N - 1)), whose unit is the root of
    a metre (terrain_search:sigma.unit).
    """
    rows = []
    for key in dict.fromkeys((r.setting, r.algorithm) for r in records):
        chosen = [r for r in records if (r.setting, r.algorithm) == key]
        position = np.array([r.position for r in chosen])
        velocity = np.array([r.velocity for r in chosen])
        tracks = np.array([r.track for r in chosen])
        rows.append(
            {
                **json.loads(key[0]),
                "algorithm": key[1],
                "flights": len(chosen),
                "rms_position": float(np.sqrt(np.mean(position**2))),
                "rms_position_interval": rms_interval(position, tracks),
                "median_position": float(np.median(position)),
                "rms_velocity": float(np.sqrt(np.mean(velocity**2))),
                "rms_velocity_interval": rms_interval(velocity, tracks),
                "false_fixes": int((position > FALSE).sum()),
                "printed_measure": float(np.sqrt(position.sum() / max(position.size - 1, 1))),
                "seconds": float(np.median([r.seconds for r in chosen])),
                "printed": PRINTED.get(key[1], {}).get("position"),
            }
        )
    return rows


def rms_interval(errors: Array, tracks: NDArray[Any]) -> list[float] | None:
    """95 % interval of the root mean square error, from the mean squares of the tracks; None for one track."""
    from scipy.special import stdtrit

    names = np.unique(tracks)
    if names.size < 2:
        return None
    squares = np.array([np.mean(errors[tracks == name] ** 2) for name in names])
    half = float(stdtrit(names.size - 1, 0.975)) * float(squares.std(ddof=1)) / math.sqrt(names.size)
    return [math.sqrt(max(float(squares.mean()) - half, 0.0)), math.sqrt(float(squares.mean()) + half)]


def verdicts(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """A verdict for every printed error and setting: CONFIRMED when it lies within a narrow interval, else OPEN.

    Never REFUTED: the tracks, the speed, the ranges of the errors and the ground of the paper are not published.
    """
    found = []
    for row in rows:
        for quantity, unit in UNITS.items():
            printed = PRINTED.get(row["algorithm"], {}).get(quantity)
            if printed is not None:
                verdict = judged(printed, row[f"rms_{quantity}"], row[f"rms_{quantity}_interval"], unit, row)
                name = f"table.{row['algorithm']}.{quantity}"
                found.append({"figure": name, "printed": printed, **plain(verdict)})
    return found


def judged(printed: float, value: float, interval: list[float] | None, unit: str, row: dict[str, Any]) -> Verdict:
    """The verdict on one printed error in one setting."""
    between = "no interval from one track" if interval is None else f"{interval[0]:.4g} to {interval[1]:.4g} {unit}"
    evidence = f"simulated {value:.4g} {unit}, 95 % interval {between}, {row['flights']} flights; printed {printed:g}"
    inside = interval is not None and interval[0] <= printed <= interval[1]
    if inside and interval is not None and interval[1] - interval[0] <= WIDEST * printed:
        return Verdict(CONFIRMED, "simulation", scope=scope_of(row), evidence=evidence)
    why = (
        "the interval is too wide to say"
        if inside
        else ("tracks, speed, ranges of the errors and ground of the paper are not published")
    )
    return Verdict(OPEN, "simulation", scope=scope_of(row), evidence=f"{evidence}; {why}")


def scope_of(row: dict[str, Any]) -> str:
    """What was simulated, in words."""
    errors = "accelerometer errors as printed" if row["accelerometers"] else "no accelerometer errors"
    return (
        f"{row['ground']}, {row['measurements']} measurements at {row['speed']:g} m/s, velocity errors up to "
        f"{row['drift']:g} m/s, {errors}, simulated altimeter"
    )


def plain(verdict: Verdict) -> dict[str, Any]:
    """The parts of a verdict that a document shows."""
    known = asdict(verdict)
    return {"status": str(verdict.status), **{name: known[name] for name in ("method", "scope", "evidence")}}


def as_table(document: dict[str, Any]) -> tuple[list[str], list[list[str]]]:
    """Headings and rows for people, beside the printed figures of table 1."""
    headings = (
        "ground|drift m/s|accelerometers|algorithm|RMS m|95 %|median m|RMS m/s|95 %|> 500 m|ms|printed m|printed m/s"
    ).split("|")
    rows = []
    for row in document["rows"]:
        printed = document["printed"].get(row["algorithm"], {})
        rows.append(
            [
                row["ground"],
                f"{row['drift']:g}",
                "with errors" if row["accelerometers"] else "perfect",
                row["algorithm"],
                f"{row['rms_position']:.1f}",
                between(row["rms_position_interval"], 0),
                f"{row['median_position']:.1f}",
                f"{row['rms_velocity']:.2f}",
                between(row["rms_velocity_interval"], 2),
                f"{row['false_fixes']}",
                f"{1e3 * row['seconds']:.1f}",
                judged_figure(document, row, "position", 1),
                judged_figure(document, row, "velocity", 2) if "velocity" in printed else "",
            ]
        )
    return headings, rows


def between(interval: list[float] | None, digits: int) -> str:
    """An interval for people."""
    return "" if interval is None else f"{interval[0]:.{digits}f} - {interval[1]:.{digits}f}"


def judged_figure(document: dict[str, Any], row: dict[str, Any], quantity: str, digits: int) -> str:
    """A printed figure with its verdict."""
    printed = document["printed"].get(row["algorithm"], {}).get(quantity)
    if printed is None:
        return ""
    name, scope = f"table.{row['algorithm']}.{quantity}", scope_of(row)
    status = next((v["status"] for v in document["verdicts"] if v["figure"] == name and v["scope"] == scope), "")
    return f"{printed:.{digits}f} {status.lower()}"
