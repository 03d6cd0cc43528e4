"""Tracks from files: CSV of time, latitude, longitude, height, and RTKLIB positions.

Two policies. ``strict``: the first row that cannot be taken as it stands is an error that names its line
and counts the others. ``repair``: such rows are left out, known oddities of the file are mended, and every
repair is listed with its line. Nothing is repaired silently. Angles leave this file in radians.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from navsym.core.arrays import Array, as_array, as_floats
from navsym.core.errors import (
    DomainError,
    DuplicateError,
    EmptyError,
    ExpressionSyntaxError,
    NavsymError,
    NotFiniteError,
    ShapeError,
    TooLargeError,
)
from navsym.language.csvfile import LARGEST_FILE, lines_of, number_of, read_rows
from navsym.language.files import decode, name_file, read_bytes
from navsym.trajectory.units import BRACKETS, Unit, unit_of, usual_unit

Policy = Literal["strict", "repair"]

LARGEST_ROWS = 2_000_000
MOST_PROBLEMS = 1_000  # after so many a strict reading gives up: the file is something else
LONG_STEP = 100.0  # seconds, at which a remark asks for the unit: 5 Hz in milliseconds are 200
GPS_EPOCH = datetime(1980, 1, 6, tzinfo=UTC)

#: Column -> names that mean it, lower case, without the unit in brackets.
NAMES = {
    "t": ("t", "time", "gps tow", "tow", "seconds", "timestamp"),
    "lat": ("lat", "latitude", "phi"),
    "lon": ("lon", "lng", "long", "longitude", "lambda"),
    "h": ("h", "height", "alt", "altitude", "ellipsoid height", "hgt", "elevation"),
}


@dataclass(frozen=True, slots=True, eq=False)
class TrackFile:
    """A track as read.

    t                   : (N,) seconds, strictly increasing
    latitude, longitude : (N,) radians
    height              : (N,) metres
    sigma               : (N, 3) standard deviations East, North, Up in metres, or None
    lines               : (N,) line of the file for each row
    repairs, warnings   : sentences, each naming its line where it has one
    """

    t: Array
    latitude: Array
    longitude: Array
    height: Array
    sigma: Array | None
    lines: NDArray[np.int64]
    repairs: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Row:
    """One row: line, seconds, radians, metres, and standard deviations where the file has them."""

    line: int
    t: float
    lat: float
    lon: float
    h: float
    sigma: tuple[float, float, float] | None = None


@dataclass(slots=True)
class Log:
    """Where problems go: raised at the end when strict, listed when repairing; and the units of the columns."""

    where: str
    policy: Policy
    errors: list[NavsymError] = field(default_factory=list)
    repairs: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    units: tuple[Unit, ...] = tuple(map(usual_unit, NAMES))

    def problem(self, kind: type[NavsymError], line: int, message: str, repair: str = "row left out") -> None:
        """Note a problem of a line: an error of this kind when strict, else the repair that was made.

        Raises the first error as soon as there are :data:`MOST_PROBLEMS`.
        """
        if self.policy == "strict":
            self.errors.append(kind(message, where=f"{self.where}: line {line}"))
            if len(self.errors) >= MOST_PROBLEMS:
                self.check()
        else:
            self.repairs.append(f"line {line}: {repair} ({message})")

    def check(self) -> None:
        """Raise the first problem; the message counts the other rows and names their lines, each once."""
        if not self.errors:
            return
        first, *rest = self.errors
        here = line_of(first)
        others = list(dict.fromkeys(line_of(error) for error in rest if line_of(error) != here))
        if others:
            lines = ", ".join(others[:8]) + (", ..." if len(others) > 8 else "")
            count = f"{len(others)}" + (" or" if len(self.errors) >= MOST_PROBLEMS else "")
            first.message += f"; {count} more rows have problems (lines {lines})"
            first.args = (first.message,)
        raise first


def line_of(error: NavsymError) -> str:
    """Number of the line that an error names."""
    return error.where.rsplit(" ", 1)[-1]


def read_track(path: str | os.PathLike[str], policy: Policy | str = "strict") -> TrackFile:
    """Read a CSV or RTKLIB ``.pos`` track.

    Raises NavsymError with the line: unreadable text, a missing column, a value that is not a finite
    number, a latitude beyond 90 degrees, a time that stands still or goes back.
    """
    log = new_log(name_file(path), policy)
    text = text_of(read_bytes(path, LARGEST_FILE), log)
    is_rtklib = text.lstrip().startswith("%")  # such files begin with a comment
    return checked_track(rtklib_rows(text, log) if is_rtklib else csv_rows(text, log), log)


def new_log(where: str, policy: Policy | str) -> Log:
    """Where problems of a track go; DomainError for a policy that does not exist."""
    if policy not in ("strict", "repair"):
        raise DomainError(f"expected strict or repair; got {policy!r:.40}; choose one", where="policy")
    return Log(where, policy)  # type: ignore[arg-type]


def checked_track(rows: Iterable[Row], log: Log) -> TrackFile:
    """The track of rows that pass every check, with what was repaired."""
    kept = in_order([row for row in rows if acceptable(row, log)], log)
    log.check()
    if not kept:
        raise EmptyError(
            "expected rows of time, latitude, longitude, height; got none; check the file", where=log.where
        )
    sanity(kept, log)
    return assembled(kept, log)


def read_columns(data: Any, policy: Policy | str = "strict") -> TrackFile:
    """A track from a DataFrame or mapping with columns as a CSV names them, or from an array (N, 4).

    Seconds, degrees, metres; row k counts from 1 where a file has its line. The same checks as for a file.
    """
    log = new_log("track", policy)
    try:
        columns = columns_in(data, log)
        units = [own.name or usual for own, usual in zip(log.units, ("s", "deg", "deg", "m"), strict=True)]
        pairs = zip(columns, units, strict=True)
        values = [as_floats("data", column, "one entry per row", unit).ravel().tolist() for column, unit in pairs]
    except NavsymError as error:
        raise error if error.where else error.at(log.where) from None
    if len({len(column) for column in values}) > 1:
        lengths = [len(column) for column in values]
        raise ShapeError(f"expected columns of one length; got {lengths}; complete them", where=log.where)
    if len(values[0]) > LARGEST_ROWS:
        raise too_long(log)
    rows = (row_of(row, k, [f"{x}" for x in row], None, log) for k, row in enumerate(zip(*values, strict=True), 1))
    return checked_track((row for row in rows if row is not None), log)


def columns_in(data: Any, log: Log) -> list[Any]:
    """The four columns of a DataFrame, a mapping or an array."""
    if hasattr(data, "keys") and hasattr(data, "__getitem__"):
        names = list(data.keys())
        places = columns_of([str(name) for name in names], log, "columns")
        return [data[names[places[name]]] for name in NAMES]
    return list(as_array("data", data, (None, 4), "rows of t, lat, lon, height").T)


def text_of(data: bytes, log: Log) -> str:
    """UTF-8 text; when repairing also from latin-1."""
    if not data.strip():
        raise EmptyError("expected a track; got an empty file; check the export", where=log.where)
    if log.policy == "repair":
        try:
            data.decode("utf-8")
        except UnicodeDecodeError:
            if not data.startswith((b"\xff\xfe", b"\xfe\xff")) and b"\0" not in data:
                log.repairs.append("line 1: text read as latin-1, because it is not UTF-8")
                return data.decode("latin-1")
    return decode(data, log.where)


def rtklib_rows(text: str, log: Log) -> Iterator[Row]:
    """Rows of an RTKLIB solution in degrees: two time fields, lat, lon, height, Q, ns, sdn, sde, sdu, ..."""
    understood(text, log)
    for number, line in enumerate(lines_of(text), 1):
        if not line.strip() or line.startswith("%"):
            continue
        if number > LARGEST_ROWS:
            raise too_long(log)
        fields = line.replace(",", " ").split()
        if len(fields) < 5:
            log.problem(ShapeError, number, f"expected at least 5 fields; got {len(fields)}; mend or remove the row")
            continue
        if fields[5:6] == ["0"]:
            log.problem(DomainError, number, "Q: expected a solution, 1 to 7; got 0, which is none; remove the row")
            continue
        time = rtklib_time(fields[0], fields[1])
        values = [time, *(number_of(x) for x in fields[2:5])]
        sigma = rtklib_sigma(fields, number, log)
        row = row_of(values, number, [" ".join(fields[:2]), *fields[2:5]], sigma, log)
        if row is not None:
            yield row


#: What a header says when the columns are not decimal degrees: (mark, what it is, what to do).
OTHER_COLUMNS = (
    ("x-ecef", "x/y/z-ecef", "write the solution as llh"),
    ("-baseline", "a baseline east, north, up", "write the solution as llh"),
    ("latitude(d'", "degrees, minutes and seconds", "write the solution in decimal degrees"),
)


def understood(text: str, log: Log) -> None:
    """Refuse files whose header names other columns than degrees and metres; say which clock it names."""
    header = [line.lower() for line in lines_of(text[:20000]) if line.startswith("%")]
    for mark, what, remedy in OTHER_COLUMNS:
        if any(mark in line for line in header):
            raise DomainError(f"expected lat/lon/height in degrees; got {what}; {remedy}", where=log.where)
    clock = next((name for name in ("utc", "jst") for line in header if line.lstrip("% ").startswith(name)), None)
    if clock:
        log.warnings.append(f"times are {clock.upper()} by the header and are taken as they stand, not as GPS time")


def rtklib_time(day: str, clock: str) -> float | None:
    """Seconds since 1980-01-06 (GPS) of ``2023/07/11 06:04:30.000`` or of week and seconds of week."""
    if "/" not in day:
        week, seconds = number_of(day), number_of(clock)
        return None if week is None or seconds is None else week * 604800.0 + seconds
    match = re.fullmatch(r"(\d+):(\d+):(\d+(?:\.\d*)?)", clock)
    try:
        moment = datetime.strptime(day, "%Y/%m/%d").replace(tzinfo=UTC)
    except ValueError:
        return None
    if match is None:
        return None
    hours, minutes, seconds = int(match[1]), int(match[2]), float(match[3])
    return (moment - GPS_EPOCH).total_seconds() + 3600.0 * hours + 60.0 * minutes + seconds


def rtklib_sigma(fields: Sequence[str], line: int, log: Log) -> tuple[float, float, float] | None:
    """East, North, Up from the columns sdn, sde, sdu; None when they are missing or zero."""
    values = [number_of(x) for x in fields[7:10]]
    if any(v is not None and not math.isfinite(v) for v in values):
        message = f"sdn, sde, sdu: expected finite numbers; got {' '.join(fields[7:10])}; mend or remove the row"
        log.problem(NotFiniteError, line, message, "standard deviations not used")
    if len(values) < 3 or any(v is None or not math.isfinite(v) or v <= 0 for v in values):
        return None
    north, east, up = (float(v) for v in values if v is not None)
    return east, north, up


def csv_rows(text: str, log: Log) -> Iterator[Row]:
    """Rows of a CSV; the separator is a comma, a semicolon or a tab."""
    lines = list(read_rows(text, len(NAMES)))
    if not lines:
        raise EmptyError("expected a track; got no rows; check the export", where=log.where)
    if len(lines) > LARGEST_ROWS:
        raise too_long(log)
    line, first = lines[0]
    columns, start = dict(zip(NAMES, range(4), strict=True)), 0
    if any(number_of(x) is None and decimal_comma(x) is None for x in first):
        columns, start = columns_of(first, log, f"line {line}"), 1
    # A row of another length has a stray or decimal comma: its columns cannot be told.
    width = max(len(first), 4)
    for number, fields in lines[start:]:
        if len(fields) != width:
            log.problem(ShapeError, number, f"expected {width} fields; got {len(fields)}; mend the row")
            continue
        texts = [fields[columns[name]] for name in NAMES]
        row = row_of([value_of(x, number, log) for x in texts], number, texts, None, log)
        if row is not None:
            yield row


def columns_of(header: Sequence[str], log: Log, line: str) -> dict[str, int]:
    """Places of the four columns; their units go to the log, and what is converted to its repairs."""
    where = f"{log.where}: {line}"
    plain = [BRACKETS.sub("", x).strip().lower() for x in header]
    found: dict[str, int] = {}
    for name, words in NAMES.items():
        places = [i for i, x in enumerate(plain) if x in words]
        if not places:
            expected = f"a column {name} (one of {', '.join(words)})"
            raise ShapeError(f"expected {expected}; got {', '.join(header)[:99]}; add it", where=where)
        if len(places) > 1:
            message = f"expected one column for {name}; got {len(places)}; remove or rename one"
            raise DuplicateError(message, where=where)
        found[name] = places[0]
    deviations = ", ".join(x for x in plain if x.startswith(("sd", "std", "sigma")))
    if deviations:
        log.warnings.append(f"{line}: {deviations} not read: give one deviation as sigma, or write an RTKLIB .pos")
    log.units = tuple(unit_of(name, header[place], where) for name, place in found.items())
    for place, unit in zip(found.values(), log.units, strict=True):
        if unit.factor != 1 or unit.radian:
            log.repairs.append(f"{line}: {plain[place]} converted from {unit.name}, the unit in its head")
    return found


def value_of(text: str, line: int, log: Log) -> float | None:
    """A number; a decimal comma is a problem of the row when strict and mended when repairing."""
    value = number_of(text)
    if value is not None:
        return value
    mended = decimal_comma(text)
    if mended is None:
        return None
    message = f"expected a decimal point; got {text!r}; write points"
    log.problem(ExpressionSyntaxError, line, message, "decimal comma read as a point")
    return mended


def decimal_comma(text: str) -> float | None:
    """The number in a text with one decimal comma; None for any other text."""
    return number_of(text.replace(",", ".")) if re.fullmatch(r"[+-]?\d+,\d+", text.strip(), re.A) else None


def too_long(log: Log) -> NavsymError:
    """The error of a file with more than :data:`LARGEST_ROWS` rows."""
    return TooLargeError(f"expected at most {LARGEST_ROWS} rows; got more; split the file", where=log.where)


def row_of(
    values: Sequence[float | None], line: int, texts: Sequence[str], sigma: tuple[float, float, float] | None, log: Log
) -> Row | None:
    """A row in seconds, radians and metres, or None after noting what is wrong with it."""
    numbers = []
    for name, value, text, unit in zip(
        ("time", "latitude", "longitude", "height"), values, texts, log.units, strict=True
    ):
        if value is None:
            message = f"{name}: expected a number; got {text[:40]!r}; mend or remove the row"
            log.problem(ExpressionSyntaxError, line, message)
            return None
        numbers.append(unit.convert(float(value)))
        if not math.isfinite(numbers[-1]):
            message = f"{name}: expected a finite number; got {text[:40]}; mend or remove the row"
            log.problem(NotFiniteError, line, message)
            return None
    t, lat, lon, h = numbers
    return Row(line, t, lat, lon, h, sigma)


def acceptable(row: Row, log: Log) -> bool:
    """Whether the position can be on the Earth."""
    limits: tuple[tuple[str, float, Callable[[float], bool], str], ...] = (
        ("latitude", math.degrees(row.lat), lambda x: abs(x) <= 90, "within 90 degrees"),
        ("longitude", math.degrees(row.lon), lambda x: -180 <= x <= 360, "from -180 to 360 degrees"),
        ("height", row.h, lambda x: -20e3 <= x <= 1e8, "from -20 km to 100000 km"),
    )
    for name, value, fits, words in limits:
        if not fits(value):
            message = f"{name}: expected a value {words}; got {value:.12g}; check the column and its unit"
            log.problem(DomainError, row.line, message)
            return False
    return True


def in_order(rows: list[Row], log: Log) -> list[Row]:
    """Rows of strictly increasing time; the first of equal times stays."""
    kept: list[Row] = []
    for row in rows:
        if not kept or row.t > kept[-1].t:
            kept.append(row)
            continue
        later = f"time: expected a later time than {kept[-1].t:.3f}"
        if row.t == kept[-1].t:
            log.problem(DuplicateError, row.line, f"{later}; got the same; keep one of the rows")
        else:
            log.problem(DomainError, row.line, f"{later}; got {row.t:.3f}; sort or remove the row")
    return kept


def sanity(rows: Sequence[Row], log: Log) -> None:
    """What is possible but unlikely."""
    heights = [row.h for row in rows]
    t, lat, lon, h = (unit.name for unit in log.units)
    step = float(np.median(np.diff([row.t for row in rows]))) if len(rows) > 1 else 0.0
    if not t and step >= LONG_STEP:
        log.warnings.append(f"the usual step is {step:.4g} s: are the times in milliseconds or less?")
    if not h and max(heights) > 9000 and slow(rows):
        log.warnings.append(f"heights reach {max(heights):.0f} m at the speed of a car or ship: are they in feet?")
    small = (abs(row.lat) <= math.radians(math.pi / 2) and abs(row.lon) <= math.radians(math.pi) for row in rows)
    if not (lat or lon) and len(rows) > 1 and all(small):
        log.warnings.append("all latitudes and longitudes are below pi/2 and pi: are they in radians?")


def slow(rows: Sequence[Row]) -> bool:
    """True when the ends of the track are reached at less than 60 m/s."""
    a, b = rows[0], rows[-1]
    metres = 6371e3 * math.hypot(b.lat - a.lat, (b.lon - a.lon) * math.cos(a.lat))
    return b.t > a.t and metres / (b.t - a.t) < 60


def assembled(rows: Sequence[Row], log: Log) -> TrackFile:
    """The track of checked rows: latitudes and longitudes in radians, arrays (N,).

    Standard deviations that only some rows have are left out, with a warning.
    """
    known = [row.sigma for row in rows if row.sigma is not None]
    if known and len(known) < len(rows):
        log.warnings.append("standard deviations are missing in some rows and were not used")
    return TrackFile(
        t=np.array([row.t for row in rows]),
        latitude=np.array([row.lat for row in rows]),
        longitude=np.array([row.lon for row in rows]),
        height=np.array([row.h for row in rows]),
        sigma=np.array(known) if len(known) == len(rows) else None,
        lines=np.array([row.line for row in rows], dtype=np.int64),
        repairs=tuple(log.repairs),
        warnings=tuple(log.warnings),
    )
