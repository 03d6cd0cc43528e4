"""The paper's experiment, run again: five straight tracks, twenty flights over each, five algorithms.

A flight is straight at a constant absolute altitude of 800 m above the mean of the ground below. The
inertial system errs by a constant position and velocity and, on request, by accelerometer errors
N(0.001, 0.005) m/s^2 per sample, as the paper prints them. **The altimeter is simulated**: the height
above ground is read from one map with an error of 1.5 per cent and compared with another map (or the
same one). Speed, ranges of the errors and length of the track are not in the paper; they are arguments.
"""

from __future__ import annotations

import importlib.util
import json
import math
import time
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from navsym.errors import DomainError, EmptyError, MissingEngineError
from navsym.methods.terrain import search_full, search_position
from navsym.methods.terrain_refine import refine
from navsym.methods.terrain_sequential import search_sequential
from navsym.models.terrain import ON_MAP, TerrainMap
from navsym.models.terrain_track import Hypotheses, Track
from navsym.text.readers_maps import local_frame, read_map

Array = NDArray[np.float64]
Correction = tuple[Array, Array]

#: Figures of table 1: seconds, position (m), velocity (m/s).
PRINTED: dict[str, dict[str, float]] = {
    "position": {"seconds": 2.0, "position": 152.2},
    "full": {"seconds": 40.1, "position": 92.7, "velocity": 0.48},
    "sequential": {"seconds": 2.2, "position": 97.0, "velocity": 0.55},
}
RATE = 2.0


@dataclass(frozen=True, slots=True)
class Setting:
    """What is varied between experiments.

    measurements   : number of them, at 2 Hz ; speed : m/s over ground ; clearance : m above the mean ground
    shift, drift   : initial position (m) and velocity errors (m/s) are uniform in -shift…shift, -drift…drift
    altimeter      : relative standard deviation of the height above ground
    accelerometers : whether accelerometer errors are added, mean and variance as printed
    """

    measurements: int = 1000
    speed: float = 40.0
    clearance: float = 800.0
    shift: float = 800.0
    drift: float = 4.0
    altimeter: float = 0.015
    accelerometers: bool = False
    mean: float = 0.001
    variance: float = 0.005


GRID = Hypotheses((50.0, 50.0), (20, 20), (1.0, 1.0), (5, 5))


@dataclass(frozen=True, slots=True, eq=False)
class Flight:
    """A recorded track and the correction that would have been right at its end."""

    track: Track
    shift: Array
    velocity: Array


def sample_terrain() -> TerrainMap:
    """The elevation sample that comes with matplotlib, in local metres."""
    spec = importlib.util.find_spec("matplotlib")
    if spec is None or spec.origin is None:
        raise MissingEngineError("expected matplotlib for its elevation sample; got none; install navsym in full")
    name = "mpl-data/sample_data/jacksboro_fault_dem.npz"
    return terrain_from(Path(spec.origin).parent / name)


def terrain_from(path: str | Path) -> TerrainMap:
    """A map file as a map in local metres."""
    raster = local_frame(read_map(path))
    return TerrainMap(raster.heights, raster.x0, raster.y0, raster.dx, raster.dy, nodata=raster.nodata)


def errors_over(times: Array, setting: Setting, generator: np.random.Generator) -> tuple[Array, Array]:
    """Corrections (n, 2) of position and velocity over time: model (1), integrated sample by sample."""
    shift = generator.uniform(-setting.shift, setting.shift, 2)
    drift = generator.uniform(-setting.drift, setting.drift, 2)
    noise = generator.normal(setting.mean, math.sqrt(setting.variance), (times.size - 1, 2))
    steps = np.diff(times)[:, None] * (noise if setting.accelerometers else 0.0 * noise)
    velocity = drift + np.vstack([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    # Exact for an acceleration that is constant between samples.
    moved = 0.5 * (velocity[1:] + velocity[:-1]) * np.diff(times)[:, None]
    return shift + np.vstack([np.zeros((1, 2)), np.cumsum(moved, axis=0)]), velocity


def fly(
    ground: TerrainMap, start: Array, heading: float, setting: Setting, generator: np.random.Generator
) -> Flight:
    """One flight over ``ground``: straight, at a constant absolute altitude.

    start : (2,) position in the middle of the track ; heading : of the way, radians from the x axis
    """
    t = np.arange(setting.measurements) / RATE
    way = setting.speed * (t - 0.5 * t[-1])
    truth = start + way[:, None] * np.array([math.cos(heading), math.sin(heading)])
    position, velocity = errors_over(t, setting, generator)
    heights = ground.height(truth[:, 0], truth[:, 1])
    altitude = heights.mean() + setting.clearance
    above = altitude - heights
    measured = altitude - above * (1.0 + setting.altimeter * generator.normal(size=t.size))
    inertial = truth - position
    return Flight(Track(t, inertial[:, 0], inertial[:, 1], measured), position[-1], velocity[-1])


# The algorithms: each gives the corrections of position and velocity at the last time


def by_position(terrain: TerrainMap, track: Track) -> Correction:
    """The position search (terrain_search:2)."""
    i, j = search_position(terrain, track, GRID).index[:2]
    return 50.0 * np.array([i, j]), np.zeros(2)


def by_full(terrain: TerrainMap, track: Track) -> Correction:
    """The joint search (terrain_search:4), by bounding."""
    i, j, Vi, Vj = search_full(terrain, track, GRID).index
    velocity = np.array([Vi, Vj], dtype=float)
    return 50.0 * np.array([i, j]) + velocity * track.elapsed[-1], velocity


def by_sequence(terrain: TerrainMap, track: Track) -> Correction:
    """The sequential search of the paper."""
    found = search_sequential(terrain, track, GRID)
    return found.shift, found.velocity


def by_centre(terrain: TerrainMap, track: Track) -> Correction:
    """The sequential search about the matrix centre."""
    found = search_sequential(terrain, track, GRID, improved=True)
    return found.shift, found.velocity


def by_refinement(terrain: TerrainMap, track: Track) -> Correction:
    """The joint search, then Gauss-Newton between the grid points."""
    i, j, Vi, Vj = search_full(terrain, track, GRID).index
    fine = refine(terrain, track, (50.0 * i, 50.0 * j), (float(Vi), float(Vj)))
    return fine.position + fine.velocity * track.elapsed[-1], fine.velocity


ALGORITHMS: dict[str, Callable[[TerrainMap, Track], Correction]] = {
    "position": by_position,
    "full": by_full,
    "sequential": by_sequence,
    "sequential about C": by_centre,
    "full, refined": by_refinement,
}


# Runs


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


def experiment(
    terrain: TerrainMap | None = None,
    ground: TerrainMap | None = None,
    *,
    settings: Iterable[Setting] = (Setting(), Setting(accelerometers=True)),
    tracks: int = 5,
    runs: int = 20,
    seed: int = 1,
    journal: str | Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, Any]:
    """Table 1 again: ``{"rows": [...], "printed": {...}, "flights": N}``, errors in metres and m/s.

    terrain  : the map to match with (None: matplotlib's sample) ; ground : the map flown over (None: the same)
    journal  : a file to which every finished flight is appended; flights found there, with the same
               setting, seed and maps, are not flown again
    progress : called with (finished, all) flights
    Same arguments, same answer, except for the times.
    """
    terrain = sample_terrain() if terrain is None else terrain
    ground = terrain if ground is None else ground
    if tracks < 1 or runs < 1:
        raise DomainError(f"runs: expected at least one track and one run; got {tracks} and {runs}; give more")
    wanted = [(s, k, r) for s in settings for k in range(tracks) for r in range(runs)]
    if not wanted:
        raise EmptyError("settings: expected at least one; got none; give one")
    stamp = {"seed": seed, "maps": f"{crc32(terrain.heights.data):08x}-{crc32(ground.heights.data):08x}"}
    done = read_journal(journal)
    records: list[Record] = []
    for finished, (setting, k, r) in enumerate(wanted):
        key = (json.dumps({**asdict(setting), **stamp}, sort_keys=True), k, r)
        flown = done.get(key) or one_flight(terrain, ground, setting, key, seed)
        if key not in done:
            append_journal(journal, flown)
        records += flown
        if progress is not None:
            progress(finished + 1, len(wanted))
    return {"rows": table(records), "printed": PRINTED, "flights": len(wanted)}


def one_flight(
    terrain: TerrainMap, ground: TerrainMap, setting: Setting, key: tuple[str, int, int], seed: int
) -> list[Record]:
    """All algorithms on one flight; key: setting in one line, track k, run r."""
    name_of_setting, k, r = key
    start, heading = course(ground, setting, k, seed)
    flight = fly(ground, start, heading, setting, np.random.default_rng([seed, 7, k, r]))
    records = []
    for name, algorithm in ALGORITHMS.items():
        began = time.thread_time()
        shift, velocity = algorithm(terrain, flight.track)
        seconds = time.thread_time() - began
        errors = (float(np.hypot(*(shift - flight.shift))), float(np.hypot(*(velocity - flight.velocity))))
        records.append(Record(name_of_setting, k, r, name, *errors, seconds))
    return records


def course(ground: TerrainMap, setting: Setting, k: int, seed: int) -> tuple[Array, float]:
    """Middle and heading of track k: random, with room for all hypotheses inside the map."""
    generator = np.random.default_rng([seed, 3, k])
    left, right, bottom, top = ground.extent
    length = setting.speed * (setting.measurements - 1) / RATE
    # Room for the errors at the end and for the hypotheses about them.
    room = setting.shift + (setting.drift + 1.5) * (setting.measurements / RATE) + 200.0
    for _ in range(1000):
        heading = generator.uniform(0.0, 2.0 * math.pi)
        middle = np.array([generator.uniform(left, right), generator.uniform(bottom, top)])
        half = 0.5 * length * np.array([math.cos(heading), math.sin(heading)])
        ends = np.array([middle - half, middle + half])
        inside = (ends[:, 0] - room > left) & (ends[:, 0] + room < right)
        inside &= (ends[:, 1] - room > bottom) & (ends[:, 1] + room < top)
        if inside.all() and (ground.sample(*between(ends))[1] == ON_MAP).all():
            return middle, heading
    raise DomainError(
        f"ground: expected room for a track of {length / 1000:.1f} km and its hypotheses; got a map of "
        f"{(right - left) / 1000:.1f} by {(top - bottom) / 1000:.1f} km; fly slower or shorter"
    )


def between(ends: Array) -> tuple[Array, Array]:
    """Points along the straight line from ends[0] to ends[1]."""
    share = np.linspace(0.0, 1.0, 200)
    x, y = (ends[0, k] + share * (ends[1, k] - ends[0, k]) for k in (0, 1))
    return x, y


def table(records: list[Record]) -> list[dict[str, Any]]:
    """One row for each setting and algorithm.

    ``rms_position`` and ``rms_velocity`` are root mean square errors; ``printed_measure`` is the paper's
    formula sqrt(sum |e| / (N - 1)), whose unit is the root of a metre (terrain_search:sigma.unit).
    """
    rows = []
    for key in dict.fromkeys((r.setting, r.algorithm) for r in records):
        chosen = [r for r in records if (r.setting, r.algorithm) == key]
        position = np.array([r.position for r in chosen])
        velocity = np.array([r.velocity for r in chosen])
        rows.append(
            {
                **json.loads(key[0]),
                "algorithm": key[1],
                "rms_position": float(np.sqrt(np.mean(position**2))),
                "median_position": float(np.median(position)),
                "rms_velocity": float(np.sqrt(np.mean(velocity**2))),
                "false_fixes": int((position > 500.0).sum()),
                "printed_measure": float(np.sqrt(position.sum() / max(position.size - 1, 1))),
                "seconds": float(np.median([r.seconds for r in chosen])),
                "printed": PRINTED.get(key[1], {}).get("position"),
            }
        )
    return rows


# The journal


def read_journal(path: str | Path | None) -> dict[tuple[str, int, int], list[Record]]:
    """Finished flights of an interrupted run; a last line that was cut off is flown again."""
    found: dict[tuple[str, int, int], list[Record]] = {}
    if path is None or not Path(path).exists():
        return found
    for line in Path(path).read_text(encoding="utf-8").splitlines():
        try:
            records = [Record(**entry) for entry in json.loads(line)]
        except (ValueError, TypeError):
            continue
        if len(records) == len(ALGORITHMS):
            found[records[0].setting, records[0].track, records[0].run] = records
    return found


def append_journal(path: str | Path | None, records: list[Record]) -> None:
    """Write one flight as one line, at once."""
    if path is not None:
        with open(path, "a", encoding="utf-8") as file:
            file.write(json.dumps([asdict(r) for r in records]) + "\n")


def study(
    runs: int = 20,
    steps: int = 1000,
    seed: int = 1,
    *,
    journal: str | Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, Any]:
    """What ``navsym simulate terrain_search`` runs: the experiment on the sample terrain, twice.

    runs : flights over each of the five tracks ; steps : measurements of each flight
    The errors are drawn from the whole range of the hypotheses (4 m/s) and from a fifth of it, each
    with and without accelerometer errors.
    """
    drifts = ((4.0, False), (4.0, True), (0.8, False), (0.8, True))
    settings = [Setting(measurements=steps, drift=d, accelerometers=a) for d, a in drifts]
    return experiment(settings=settings, runs=runs, seed=seed, journal=journal, progress=progress)


def as_table(document: dict[str, Any]) -> tuple[list[str], list[list[str]]]:
    """Headings and rows for people, beside the printed figures of table 1."""
    headings = [
        "drift m/s", "accelerometers", "algorithm", "RMS m", "median m", "RMS m/s", "> 500 m", "ms",
        "printed m", "printed m/s",
    ]  # fmt: skip
    rows = []
    for row in document["rows"]:
        printed = document["printed"].get(row["algorithm"], {})
        rows.append(
            [
                f"{row['drift']:g}",
                "with errors" if row["accelerometers"] else "perfect",
                row["algorithm"],
                f"{row['rms_position']:.1f}",
                f"{row['median_position']:.1f}",
                f"{row['rms_velocity']:.2f}",
                f"{row['false_fixes']}",
                f"{1e3 * row['seconds']:.1f}",
                f"{printed['position']:.1f}" if "position" in printed else "",
                f"{printed['velocity']:.2f}" if "velocity" in printed else "",
            ]
        )
    return headings, rows


def growth(
    terrain: TerrainMap | None = None,
    *,
    drifts: Iterable[float] = (0.0, 0.5, 1.0, 2.0, 4.0),
    measurements: Iterable[int] = (250, 500, 1000),
    tracks: int = 3,
    runs: int = 5,
    seed: int = 2,
) -> list[dict[str, Any]]:
    """How each algorithm's error grows with the velocity error and the length of the track."""
    settings = [Setting(measurements=n, drift=v) for n in measurements for v in drifts]
    rows: list[dict[str, Any]] = experiment(terrain, settings=settings, tracks=tracks, runs=runs, seed=seed)["rows"]
    return rows
