"""Real modes: a car's satellite solution is fixed, float or single, and a filter has to notice by itself.

Velocities of the reference inertial system are integrated to a position that drifts slowly; satellite
positions minus that drift, seen with the noise of one of three modes. The receiver's own flag is not shown to the
filter and serves to judge it. Data: see the list of real data sets, Nagoya run (MIT, (c) 2023 Taro Suzuki).
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import NoDataError
from navsym.multimodel.bank import Bank
from navsym.multimodel.engine import Estimates
from navsym.multimodel.filters import run_filter

Array = NDArray[np.floating[Any]]
QUALITY = ("fixed", "float", "single")
#: RTKLIB's number for each quality.
FLAGS = (1, 2, 5)
#: Metres, one axis, what a user would say of each quality before having seen the run.
DEVIATIONS = (0.03, 1.0, 10.0)
#: Metres: an error beyond the first is no fix, whatever the flag says; one below the second is.
WRONG, GOOD = 1.0, 0.2
FILES = ("nagoya_reference.csv", "nagoya_rover_rtk.pos")


@dataclass(frozen=True, slots=True, eq=False)
class Road:
    """The run on the reference's clock.

    measurement : (T, 2) satellite minus integrated position, East and North, metres; NaN without a solution
    truth       : (T, 2) reference minus integrated position
    flag        : (T,)   index into QUALITY, -1 without a solution
    """

    measurement: Array
    truth: Array
    flag: NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class Judgement:
    """What came of it.

    confusion : (3, 3) steps, rows = the receiver's flag, columns = the most probable mode
    agreement : share of steps on the diagonal
    rms, rms_raw : m, horizontal: the filter, the satellite alone
    nees      : mean normalised squared error of the filter; 2 would be consistent
    wrong_fixes, caught : steps flagged fixed that are more than a metre off, and those put in a wider mode
    good_fixes, kept    : steps flagged fixed within 0.2 m, and those put in the narrowest mode
    """

    confusion: NDArray[np.intp]
    agreement: float
    rms: float
    rms_raw: float
    nees: float
    wrong_fixes: int
    caught: int
    good_fixes: int
    kept: int
    estimate: Estimates


def read_road(folder: Path) -> Road:
    """Read the two files of the run; NoDataError when one is not there."""
    for name in FILES:
        if not (folder / name).is_file():
            fetch = "run `navsym data get` with nagoya-reference and nagoya-rtk"
            raise NoDataError(f"{name}: expected the file in {folder}; got none; {fetch}")
    reference = np.loadtxt(folder / FILES[0], delimiter=",", skiprows=1, usecols=(0, 2, 3, 11, 12))
    rover = np.loadtxt(folder / FILES[1], comments="%", usecols=(1, 2, 3, 5))
    return align(reference, rover)


def align(reference: Array, rover: Array) -> Road:
    """Rows (time, lat, lon, East velocity, North velocity) and (time, lat, lon, flag), degrees, to one clock."""
    origin = reference[0, 1:3]
    truth = local(reference[:, 1:3], origin)
    dt = np.diff(reference[:, 0], prepend=reference[0, 0])[:, None]
    velocity = reference[:, 3:5]
    before = np.vstack([velocity[:1], velocity[:-1]])
    integrated = np.cumsum(0.5 * dt * (velocity + before), axis=0)
    rows = np.searchsorted(reference[:, 0], rover[:, 0] - 0.05)
    met = (rows < len(reference)) & (np.abs(reference[np.minimum(rows, len(reference) - 1), 0] - rover[:, 0]) < 0.05)
    measurement, flag = np.full((len(reference), 2), np.nan), np.full(len(reference), -1, dtype=np.intp)
    measurement[rows[met]] = local(rover[met, 1:3], origin) - integrated[rows[met]]
    flag[rows[met]] = [FLAGS.index(int(q)) if int(q) in FLAGS else -1 for q in rover[met, 3]]
    measurement[flag < 0] = np.nan
    return Road(measurement, truth - integrated, flag)


def local(degrees: Array, origin: Array) -> Array:
    """East and North (N, 2) in metres of latitudes and longitudes near an origin, WGS 84 radii of curvature."""
    lat, lon = np.radians(degrees).T
    lat0, lon0 = np.radians(origin)
    a, e2 = 6378137.0, 0.00669437999014
    w = np.sqrt(1.0 - e2 * np.sin(lat0) ** 2)
    return np.column_stack([(lon - lon0) * np.cos(lat0) * a / w, (lat - lat0) * a * (1.0 - e2) / w**3])


def road_bank(road: Road, *, walk: float = 0.003, stay: float = 0.98) -> Bank:
    """Three modes that differ in the noise of the position; the drift walks ``walk`` metres per step and axis."""
    eye = np.eye(2)
    models = [{"F": eye, "Q": walk**2 * eye, "H": eye, "R": sigma**2 * eye} for sigma in DEVIATIONS]
    switch = np.full((3, 3), (1.0 - stay) / 2.0)
    np.fill_diagonal(switch, stay)
    first = road.measurement[~np.isnan(road.measurement).any(axis=1)][0]
    return Bank(
        models, switch, {"mean": first, "covariance": DEVIATIONS[2] ** 2 * eye, "probabilities": np.full(3, 1.0 / 3.0)}
    )


def judge(road: Road, method: str = "imm", *, depth: int | None = None) -> Judgement:
    """Filter the run without its flags, and compare the most probable mode with them."""
    estimate = run_filter(road_bank(road), road.measurement, method, depth=depth, missing=True)
    seen = road.flag >= 0
    guess = estimate.probabilities.argmax(axis=1)
    confusion = np.zeros((3, 3), dtype=np.intp)
    np.add.at(confusion, (road.flag[seen], guess[seen]), 1)
    error = estimate.mean - road.truth
    squared = (error * np.linalg.solve(estimate.covariance, error[..., None])[..., 0]).sum(axis=1)
    off = np.sqrt(((road.measurement - road.truth) ** 2).sum(axis=1))
    wrong, good = (road.flag == 0) & (off > WRONG), (road.flag == 0) & (off < GOOD)
    return Judgement(
        confusion,
        float(np.trace(confusion) / confusion.sum()),
        rms(error[seen]),
        rms((road.measurement - road.truth)[seen]),
        float(squared[seen].mean()),
        int(wrong.sum()),
        int((guess[wrong] > 0).sum()),
        int(good.sum()),
        int((guess[good] == 0).sum()),
        estimate,
    )


def rms(error: Array) -> float:
    """Root mean square length of horizontal errors."""
    return float(np.sqrt((error**2).sum(axis=1).mean()))
