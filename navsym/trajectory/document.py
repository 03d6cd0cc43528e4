"""What ``navsym track`` prints: velocity and acceleration of a track as one document."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from navsym.core.arrays import Array
from navsym.trajectory.estimate import Settings, estimate, filtered, gaps, largest_gap, window_of
from navsym.trajectory.tracks import Noise, Positions, Rows, TrackEstimate, memory, usual_step

#: Mean squared normalised innovation outside this range makes the standard deviations doubtful.
CONSISTENT = (0.5, 2.0)
#: Steps whose lengths differ by more than this part of the usual step are jitter worth a remark.
JITTER = 0.5


def document(
    t: Array,
    track: Positions,
    settings: Settings,
    *,
    lines: Rows | None = None,
    warnings: tuple[str, ...] = (),
    repairs: tuple[str, ...] = (),
) -> dict[str, Any]:
    """Velocity and acceleration with standard deviations, gains in use, noise found, warnings, repairs.

    t : (N,) times as the file has them; lines : (N,) lines of the file, for the warnings
    """
    found, noise = estimate(track, settings)
    rows = np.arange(1, len(t) + 1) if lines is None else lines
    return {
        "method": settings.method,
        "order": settings.order,
        "window": window_in_use(track, noise, settings),
        "rows": len(t),
        "axes": ["east", "north", "up"],
        "t": t.tolist(),
        "velocity": found.velocity.tolist(),
        "velocity_sd": found.velocity_sd.tolist(),
        "acceleration": found.acceleration.tolist(),
        "acceleration_sd": found.acceleration_sd.tolist(),
        "flags": list(found.flags),
        "gains": found.gains,
        "certificate": certificate(track, found, noise, settings),
        "noise": {
            "position_sd": np.sqrt(noise.scale * np.median(track.variance, axis=0)).tolist(),
            "density": noise.density.tolist(),
            "memory_seconds": memory(noise, track.variance, settings.order),
        },
        "warnings": [*warnings, *remarks(track, found, noise, settings, rows)],
        "repairs": list(repairs),
    }


def certificate(track: Positions, found: TrackEstimate, noise: Noise, settings: Settings) -> dict[str, Any] | None:
    """Exact duality bounds of the weights of the guaranteed method; null for the other methods."""
    span = window_in_use(track, noise, settings)
    if settings.method != "guaranteed" or span is None:
        return None
    use = np.array([flag != "outlier" for flag in found.flags], dtype=np.int64)
    kind = "least sum of absolute weights between exact rational bounds (linear duality)"
    return {"kind": kind, **largest_gap(track, settings, use, span)}


def window_in_use(track: Positions, noise: Noise, settings: Settings) -> float | None:
    """Length of the window in seconds, None for methods without one."""
    if settings.method not in ("window", "guaranteed"):
        return None
    return window_of(track, noise, settings)


def remarks(track: Positions, found: TrackEstimate, noise: Noise, settings: Settings, lines: Rows) -> list[str]:
    """What a person should know of a track, in sentences: gaps, rows left out or doubted, uneven steps, doubts.

    lines : (N,) number of the line of each row in its file
    """
    out = [f"gap of {track.t[k + 1] - track.t[k]:.3g} s after line {lines[k]}" for k in gaps(track)[:20].tolist()]
    for name, text in (("outlier", "left out"), ("doubtful", "believed less")):
        where = [int(lines[k]) for k, flag in enumerate(found.flags) if flag == name]
        if where:
            listed = ", ".join(map(str, where[:20])) + (", ..." if len(where) > 20 else "")
            out.append(f"{len(where)} rows were {text} ({name}): lines {listed}")
    steps = np.diff(track.t)
    usual = usual_step(track.t)
    uneven = int(((np.abs(steps - usual) > JITTER * usual) & (steps < 5 * usual)).sum())
    if uneven:
        out.append(f"{uneven} steps differ from the usual {usual:.3g} s by more than half of it")
    return out + doubts(track, found, noise, settings)


def doubts(track: Positions, found: TrackEstimate, noise: Noise, settings: Settings) -> list[str]:
    """Whether the standard deviations can be believed: innovations should be as large as they say."""
    use = np.array([flag != "outlier" for flag in found.flags], dtype=np.int64)
    run = filtered(track, noise, Settings("filter", settings.order, gate=0.0), use)
    kept = np.flatnonzero(use)[settings.order :]
    mean = float((run.innovations**2 / run.variances)[:, kept].mean())
    if CONSISTENT[0] <= mean <= CONSISTENT[1] or not math.isfinite(mean):
        return []
    side = "optimistic" if mean > 1 else "pessimistic"
    return [
        f"standard deviations are {side}: squared innovations are {mean:.3g} times their predicted variance; "
        "the motion or the noise is not the same all along the track"
    ]
