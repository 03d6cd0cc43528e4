"""Velocity and acceleration of measured positions, with what a person should know of them."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from navsym.core.answers import Answer, named, plain
from navsym.core.arrays import Array, freeze, without_units
from navsym.core.errors import DomainError
from navsym.language.files import file_in_errors, write_text
from navsym.language.names import quote
from navsym.trajectory.consistency import Consistency, compare, consistency_of
from navsym.trajectory.estimate import Progress, Settings, estimate, filtered, gaps, largest_gap, window_of
from navsym.trajectory.reader import TrackFile, read_columns, read_track
from navsym.trajectory.tracks import (
    Noise,
    Positions,
    Rows,
    TrackEstimate,
    check_order,
    memory,
    project_positions,
    student,
    usual_step,
)

#: Mean squared normalised innovation outside this range makes the standard deviations doubtful.
CONSISTENT = (0.5, 2.0)
#: Steps whose lengths differ by more than this part of the usual step are jitter worth a remark.
JITTER = 0.5
#: Rows more than states below which a remark says how roughly the noise is known.
FEW = 10
#: Rows of the table for people.
SHOWN = 12


@dataclass(frozen=True, slots=True, eq=False)
class Track(Answer):
    """Velocity and acceleration along a track, East, North, Up of each row; the answer of :func:`track`.

    t             : (N,) times as the file has them, s
    velocity, velocity_sd         : (N, 3) m/s
    acceleration, acceleration_sd : (N, 3) m/s^2; None for order 2, which estimates no acceleration
    flags         : one word per row: ``used``, ``doubtful`` or ``outlier``
    gains         : channel -> gain of the last step in use (empty for methods without one)
    method, order : as asked; window : its length in s, None for methods without one
    noise         : :class:`navsym.trajectory.tracks.Noise` of the track; position_sd : (3,) m; memory : s
    certificate   : exact bounds of the weights of the guaranteed method, else None
    warnings, repairs : sentences, each naming its line where it has one
    nis, nees     : :class:`navsym.trajectory.consistency.Consistency` of the innovations, and against a reference
                    where one was given, else None
    """

    t: Array
    velocity: Array
    velocity_sd: Array
    acceleration: Array | None
    acceleration_sd: Array | None
    flags: tuple[str, ...]
    gains: dict[str, list[float]]
    method: str
    order: int
    window: float | None
    noise: Noise
    position_sd: Array
    memory: float
    certificate: dict[str, Any] | None
    warnings: tuple[str, ...]
    repairs: tuple[str, ...]
    nis: Consistency | None = None
    nees: Consistency | None = None

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym track``."""
        noise = {
            "position_sd": self.position_sd,
            "density": self.noise.density,
            "memory_seconds": self.memory,
            "coloured_share": self.noise.ratio / (1.0 + self.noise.ratio),
            "correlation_seconds": self.noise.tau,
            "forgetting_rate": self.noise.rate,
            "exponent": self.noise.exponent,
            "drift": self.noise.drift,
            "drift_seconds": self.noise.lasting,
        }
        return {
            **named(self, "method order window"),
            "rows": len(self.t),
            "axes": ["east", "north", "up"],
            **named(self, "t velocity velocity_sd acceleration acceleration_sd flags gains certificate"),
            "noise": {name: plain(value) for name, value in noise.items()},
            **named(self, "nis nees warnings repairs"),
            "remarks": [*self.warnings, *self.repairs],
        }

    def certificates(self) -> list[Any]:
        """None for the checker: bounds of weights are no kind that it knows."""
        return []

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write all rows as CSV: time, velocity, its deviations, acceleration where it is estimated, and the flag."""
        names, parts = ["t", "ve", "vn", "vu", "sd_ve", "sd_vn", "sd_vu"], [self.velocity, self.velocity_sd]
        if self.acceleration is not None and self.acceleration_sd is not None:
            names += ["ae", "an", "au", "sd_ae", "sd_an", "sd_au"]
            parts += [self.acceleration, self.acceleration_sd]
        numbers = np.column_stack([self.t, *parts])
        rows = [",".join([*map(repr, row.tolist()), flag]) for row, flag in zip(numbers, self.flags, strict=True)]
        write_text(path, "\n".join([",".join([*names, "row"]), *rows, ""]))

    def __repr__(self) -> str:
        fastest = float(np.sqrt((self.velocity**2).sum(axis=1)).max())
        used = sum(flag == "used" for flag in self.flags)
        return f"<Track: {len(self.t)} rows, {used} used, method {self.method}, up to {fastest:.4g} m/s>"

    def table(self) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
        """Heads and at most two dozen rows for people: what is estimated, with standard deviations."""
        heads, parts = ["t, s", "vE, m/s", "vN", "vU"], [(self.velocity, self.velocity_sd)]
        if self.acceleration is not None and self.acceleration_sd is not None:
            heads += ["aE, m/s2", "aN", "aU"]
            parts += [(self.acceleration, self.acceleration_sd)]
        rows = []
        for k in range(0, len(self.t), max(1, len(self.t) // SHOWN)):
            pairs = [pair for values, spreads in parts for pair in zip(values[k], spreads[k], strict=True)]
            numbers = (write_uncertain(value, spread) for value, spread in pairs)
            rows.append((f"{self.t[k]:.3f}", *numbers, self.flags[k]))
        return (*heads, "row"), rows


def write_uncertain(value: float, spread: float) -> str:
    """``7.1688 ± 0.0065``: two digits of the deviation, and the value to the same place."""
    places = min(max(1 - math.floor(math.log10(spread)), 0), 12) if spread > 0.0 else 3
    return f"{round(value, places) + 0.0:.{places}f} ± {spread:.{places}f}"


def track(
    data: Any,
    *,
    window: float | None = None,
    order: int = 3,
    method: str | None = None,
    sigma: float | None = None,
    gate: float = 5.0,
    policy: str = "strict",
    reference: Any = None,
    progress: Progress | None = None,
) -> Track:
    """Velocity and acceleration of measured positions, with standard deviations.

    data   : path of a CSV file (time, latitude, longitude, height) or of an RTKLIB ``.pos``; a DataFrame or mapping
             with columns of these names; or an array (N, 4). Seconds, degrees, metres, unless the head of a column
             names another unit, as in ``t (ms)``, ``lat (1e-7 deg)`` or ``height (US survey feet)``.
    window : length of the sliding window, s; asks for the method ``window``
    order  : states of the motion, 2 to 6; an acceleration is estimated from 3 on
    method : ``differences``, ``window``, ``filter``, ``smoother`` (default) or ``guaranteed``
    sigma  : standard deviation of positions, m; default: the file's, else that found in the track
    gate   : an innovation beyond so many standard deviations has less weight; 0 switches this off
    policy : ``strict`` refuses bad rows; ``repair`` mends or leaves them out, and lists them
    reference : velocities to compare with, a CSV file with columns t, ve, vn, vu (and sd_ve, sd_vn, sd_vu) or an array
             (M, 4 or 7), s and m/s; the answer then has their NEES
    progress : called with the steps that are done, how many there are, and a word on the present one

    Positions go to axes fixed to the Earth. The noise of positions, white and coloured, and of a motion that may
    forget its last derivative are found by maximum likelihood, in the 10,000 middle rows of a long track. The
    smoother is that of Rauch, Tung and Striebel.
    Standard deviations know that the noise was only estimated and follow the innovations about each row.

    Returns :class:`Track`. Raises NavsymError: ``missing-file``, ``syntax``, ``shape``, ``not-finite``, ``domain``,
    ``duplicate`` (equal times), ``empty``. Source: Maybeck, Stochastic Models, Estimation and Control, vol. 2, ch. 8.

    >>> import navsym as nav
    >>> nav.track("examples/drive.csv", sigma=0.5)
    <Track: 61 rows, 61 used, method smoother, up to 13.36 m/s>
    >>> rows = [(k, 45 + 1e-4 * k, 10.0, 100.0) for k in range(20)]
    >>> bool(abs(nav.track(rows, order=2).velocity[10, 1] - 11.11) < 0.01)
    True
    """
    settings = settings_of(method, window, order, gate, sigma)
    read = read_track(data, policy) if isinstance(data, str | os.PathLike) else read_columns(data, policy)
    with file_in_errors(data, "track"):
        check_order(len(read.t), settings.order)
        given = read.sigma if sigma is None else sigma
        positions = project_positions(read.t - read.t[0], read.latitude, read.longitude, read.height, given)
        found = describe_motion(read, positions, settings, progress)
        return found if reference is None else with_reference(found, reference)


def with_reference(found: Track, reference: Any) -> Track:
    """The answer with its NEES, and a remark where the clocks seem to differ."""
    nees = compare(found.t, found.velocity, found.velocity_sd, reference)
    if nees.lag is None:
        return replace(found, nees=nees)
    return replace(found, nees=nees, warnings=(*found.warnings, str(nees.lag)))


def settings_of(method: str | None, window: float | None, order: int, gate: float, sigma: float | None) -> Settings:
    """The settings of a call: a window asks for the sliding window, every other method has to be named."""
    window, sigma = without_units(window, "track: window", "s"), without_units(sigma, "track: sigma", "m")
    numbers: dict[str, float | None] = {"window": window, "gate": gate, "sigma": sigma}
    for name, value in numbers.items():
        if value is None:
            continue
        if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not abs(value) < 1e300:
            raise DomainError(f"expected a number; got {quote(value)}; give one", where=f"track: {name}")
    if isinstance(order, bool) or not isinstance(order, int):
        raise DomainError(f"expected 2 to 6 states; got {quote(order)}; give a whole number", where="track: order")
    if not isinstance(method, str | None):
        raise DomainError(f"expected the name of a method; got {quote(method)}; give text", where="track: method")
    chosen = method or ("window" if window is not None else "smoother")
    if window is not None and chosen not in ("window", "guaranteed"):
        message = f"expected method window or guaranteed with it; got {chosen}; drop one"
        raise DomainError(message, where="track: window")
    if sigma is not None and not 0 < sigma < math.inf:
        message = f"expected a positive number of metres; got {sigma}; leave it out if unknown"
        raise DomainError(message, where="track: sigma")
    return Settings(chosen, order, window, gate, sigma is not None)  # type: ignore[arg-type]


def describe_motion(
    read: TrackFile, positions: Positions, settings: Settings, progress: Progress | None = None
) -> Track:
    """The answer for a track as read and as projected."""
    found, noise = estimate(positions, settings, progress)
    nis = innovation_squares(positions, found, noise, settings)
    acceleration, acceleration_sd = found.derivatives[1] if len(found.derivatives) > 1 else (None, None)
    return Track(
        freeze(np.array(read.t)),
        found.velocity,
        found.velocity_sd,
        acceleration,
        acceleration_sd,
        found.flags,
        found.gains,
        settings.method,
        settings.order,
        window_in_use(positions, noise, settings),
        noise,
        np.sqrt(np.median(noise.total(positions), axis=0)),
        memory(noise, positions.variance, settings.order),
        certificate(positions, found, noise, settings),
        (*read.warnings, *remarks(positions, found, settings, nis, read.lines)),
        read.repairs,
        nis,
    )


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


def remarks(
    track: Positions, found: TrackEstimate, settings: Settings, nis: Consistency | None, lines: Rows
) -> list[str]:
    """What a person should know of a track, in sentences: gaps, rows left out or doubted, uneven steps, doubts.

    lines : (N,) number of the line of each row in its file
    """
    out = []
    if settings.order < 3:
        out.append("acceleration is not estimated, only velocity: a motion with 2 states has none; ask for order 3")
    out += [f"gap of {track.t[k + 1] - track.t[k]:.3g} s after line {lines[k]}" for k in gaps(track)[:20].tolist()]
    for name, text in (("outlier", "left out"), ("doubtful", "believed less")):
        where = [int(lines[k]) for k, flag in enumerate(found.flags) if flag == name]
        if where:
            listed = ", ".join(map(str, where[:20])) + (", ..." if len(where) > 20 else "")
            rows, place = ("1 row was", "line") if len(where) == 1 else (f"{len(where)} rows were", "lines")
            out.append(f"{rows} {text} ({name}): {place} {listed}")
    spare = len(lines) - found.flags.count("outlier") - settings.order
    if spare < FEW and not settings.fixed_scale:
        level, _, up = student(spare + settings.order, settings.order, False)
        out.append(
            f"{spare + settings.order} rows for {settings.order} states tell little of the noise: standard deviations "
            f"are rough, and {level:.3g} (level) and {up:.3g} (up) times as large as those of a noise that is known"
        )
    steps = np.diff(track.t)
    usual = usual_step(track.t)
    uneven = int(((np.abs(steps - usual) > JITTER * usual) & (steps < 5 * usual)).sum())
    if uneven:
        out.append(f"{uneven} steps differ from the usual {usual:.3g} s by more than half of it")
    return out + doubts(nis)


def innovation_squares(track: Positions, found: TrackEstimate, noise: Noise, settings: Settings) -> Consistency | None:
    """NIS of the rows in use, of the filter without a gate that has the noise of the track."""
    use = np.array([flag != "outlier" for flag in found.flags], dtype=np.int64)
    run = filtered(track, noise, Settings("filter", settings.order, gate=0.0), use)
    kept = np.flatnonzero(use)[settings.order :]
    return consistency_of((run.innovations / np.sqrt(run.variances))[:, kept].T)


def doubts(nis: Consistency | None) -> list[str]:
    """Whether the standard deviations can be believed: innovations should be as large as they say."""
    if nis is None or CONSISTENT[0] <= nis.mean <= CONSISTENT[1] or not math.isfinite(nis.mean):
        return []
    side = "optimistic" if nis.mean > 1 else "pessimistic"
    return [
        f"standard deviations are {side}: squared innovations are {nis.mean:.3g} times their predicted variance; "
        "the motion or the noise is not the same all along the track"
    ]
