"""The paper's experiment, run again: five straight tracks, twenty flights over each, five algorithms.

A flight is straight at a constant absolute altitude of 800 m above the mean of the ground below. The
inertial system errs by a constant position and velocity and, on request, by accelerometer errors
N(0.001, 0.005) m/s^2 per sample, as the paper prints them. **The altimeter is simulated**: the height
above ground is read from one map with an error of 1.5 per cent and compared with another map (or the
same one). Speed, ranges of the errors and length of the track are not in the paper; they are arguments.
"""

import functools
import json
import time
from collections.abc import Callable, Iterable
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from navsym.core.datasets import dataset, local_copy
from navsym.core.errors import DomainError, EmptyError
from navsym.terrain.heights import TerrainMap
from navsym.terrain.refine import refine
from navsym.terrain.search import search_full, search_position
from navsym.terrain.sequential import search_sequential
from navsym.terrain.track import Hypotheses, Profile
from navsym_papers.terrain_search.experiment.flights import Setting, course, fly, sample_terrain, terrain_from
from navsym_papers.terrain_search.experiment.table import PRINTED, Record, table, verdicts
from navsym_papers.terrain_search.experiment.table import (
    as_table as as_table,  # what `simulate` shows beside the document
)

Array = NDArray[np.float64]
Correction = tuple[Array, Array]

GRID = Hypotheses((50.0, 50.0), (20, 20), (1.0, 1.0), (5, 5))
#: The two products of one tile, as data sets: flown over, matched with.
TILES = ("nasadem", "srtm")


# The algorithms: each gives the corrections of position and velocity at the last time


def by_position(terrain: TerrainMap, track: Profile) -> Correction:
    """The position search (terrain_search:2)."""
    i, j = search_position(terrain, track, GRID).index[:2]
    return 50.0 * np.array([i, j]), np.zeros(2)


def by_full(terrain: TerrainMap, track: Profile) -> Correction:
    """The joint search (terrain_search:4), by bounding."""
    i, j, Vi, Vj = search_full(terrain, track, GRID).index
    velocity = np.array([Vi, Vj], dtype=float)
    return 50.0 * np.array([i, j]) + velocity * track.elapsed[-1], velocity


def by_sequence(terrain: TerrainMap, track: Profile, *, improved: bool = False) -> Correction:
    """The sequential search of the paper, or about the matrix centre."""
    found = search_sequential(terrain, track, GRID, improved=improved)
    return found.shift, found.velocity


def by_refinement(terrain: TerrainMap, track: Profile) -> Correction:
    """The joint search, then Gauss-Newton between the grid points."""
    i, j, Vi, Vj = search_full(terrain, track, GRID).index
    fine = refine(terrain, track, (50.0 * i, 50.0 * j), (float(Vi), float(Vj)))
    return fine.position + fine.velocity * track.elapsed[-1], fine.velocity


ALGORITHMS: dict[str, Callable[[TerrainMap, Profile], Correction]] = {
    "position": by_position,
    "full": by_full,
    "sequential": by_sequence,
    "sequential about C": partial(by_sequence, improved=True),
    "full, refined": by_refinement,
}


# Runs


def experiment(
    terrain: TerrainMap | None = None,
    ground: TerrainMap | None = None,
    *,
    name: str = "one map",
    settings: Iterable[Setting] = (Setting(), Setting(accelerometers=True)),
    tracks: int = 5,
    runs: int = 20,
    seed: int = 1,
    journal: str | Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> dict[str, Any]:
    """Table 1 again: ``{"rows", "printed", "verdicts", "flights"}``, errors in metres and m/s.

    name     : of the ground, for the table
    terrain  : the map to match with (None: matplotlib's sample) ; ground : the map flown over (None: the same)
    journal  : a file to which every finished flight is appended; flights found there, with the same
               setting, seed and maps, are not flown again
    progress : called with (finished, all) flights
    Same arguments, same answer, except for the times. Raises DomainError and EmptyError when nothing is to fly.
    """
    terrain = sample_terrain() if terrain is None else terrain
    ground = terrain if ground is None else ground
    if tracks < 1 or runs < 1:
        raise DomainError(f"runs: expected at least one track and one run; got {tracks} and {runs}; give more")
    wanted = [(s, k, r) for s in settings for k in range(tracks) for r in range(runs)]
    if not wanted:
        raise EmptyError("settings: expected at least one; got none; give one")
    maps = f"{crc32(terrain.heights.data):08x}-{crc32(ground.heights.data):08x}"
    stamp = {"seed": seed, "ground": name, "maps": maps}
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
    rows = table(records)
    return {"rows": rows, "printed": PRINTED, "verdicts": verdicts(rows), "flights": len(wanted)}


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
    """What ``navsym simulate terrain_search`` runs: the experiment on the sample terrain and on a tile.

    runs : flights over each of the five tracks ; steps : measurements of each flight
    The errors are drawn from the whole range of the hypotheses (4 m/s) and from a fifth of it, each
    with and without accelerometer errors. The tile is flown over as one product and matched as another.
    """
    drifts = ((4.0, False), (4.0, True), (0.8, False), (0.8, True))
    settings = [Setting(measurements=steps, drift=d, accelerometers=a) for d, a in drifts]
    places = grounds()
    rows: list[dict[str, Any]] = []
    each = len(settings) * 5 * runs
    for number, (name, terrain, ground) in enumerate(places):
        told = (
            None
            if progress is None
            else lambda done, _, before=number * each: progress(before + done, len(places) * each)
        )
        rows += experiment(
            terrain, ground, name=name, settings=settings, runs=runs, seed=seed, journal=journal, progress=told
        )["rows"]
    found = {"rows": rows, "printed": PRINTED, "verdicts": verdicts(rows), "flights": len(places) * each}
    missing = "" if len(places) > 1 else "the tile N44W072 is not in NAVSYM_DATA; `navsym data list` says where it is"
    return {"experiment": "terrain_search", **found, "remarks": [missing] if missing else []}


def grounds() -> list[tuple[str, TerrainMap, TerrainMap]]:
    """(name, map to match with, map to fly over): the sample, and the tile when both of its products are there."""
    sample = sample_terrain()
    places = [("matplotlib's Jacksboro sample", sample, sample)]
    flown, matched = (local_copy(dataset(name)) for name in TILES)
    if flown is not None and matched is not None:
        places.append(("N44W072, NASADEM flown, SRTM matched", terrain_from(matched), terrain_from(flown)))
    return places


def sweep_job(sweep: Any, index: int) -> dict[str, Any]:
    """Errors of position and velocity of every search algorithm on one simulated flight over the sample terrain."""
    terrain = matching_map()
    flown = one_flight(terrain, terrain, Setting(), (sweep.kind, index, 0), sweep.seed)
    names = ("position", "velocity")
    return {"index": index, **{f"{name} of {r.algorithm}": getattr(r, name) for r in flown for name in names}}


@functools.cache
def matching_map() -> TerrainMap:
    """The sample terrain, read once in a process; raises MissingEngineError without matplotlib."""
    return sample_terrain()
