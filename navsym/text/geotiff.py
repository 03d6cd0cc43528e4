"""Plain GeoTIFF files without a library: one band of numbers in strips or tiles, uncompressed or deflated.

What the format allows beyond that (other compressions, several planes, palettes, bits, big files, rotation by a matrix)
is left to rasterio: :func:`read_plain` returns None. Every offset and size is checked against the file, and the size of
the raster against a limit, before anything is allocated. TIFF 6.0; OGC 19-008, GeoTIFF 1.1.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Tags that are read, and whether a plain file may hold several values.
WIDTH, HEIGHT, BITS, COMPRESSION, OFFSETS, SAMPLES, ROWS, COUNTS = 256, 257, 258, 259, 273, 277, 278, 279
PLANES, PREDICTOR, TILE_WIDTH, TILE_HEIGHT, TILE_OFFSETS, TILE_COUNTS, FORMAT = 284, 317, 322, 323, 324, 325, 339
SCALE, TIEPOINT, MATRIX, KEYS, NODATA = 33550, 33922, 34264, 34735, 42113
#: Field types: number -> (bytes, letter of struct).
FIELDS = {
    1: (1, "B"),
    2: (1, "c"),
    3: (2, "H"),
    4: (4, "I"),
    5: (8, "Q"),
    6: (1, "b"),
    8: (2, "h"),
    9: (4, "i"),
    11: (4, "f"),
    12: (8, "d"),
}
#: SampleFormat -> kind of a numpy type.
KINDS = {1: "u", 2: "i", 3: "f"}
RAW, DEFLATE, OLD_DEFLATE = 1, 8, 32946
#: Entries of a directory, and values of one tag, that a sensible file may have.
MOST_TAGS, MOST_VALUES = 200, 2_000_000
#: GeoKeys: model type (2 = geographic), raster type (2 = heights stand at points, not in areas).
MODEL_TYPE, RASTER_TYPE = 1024, 1025
#: Units of angles, lengths and heights, and the system of coordinates; codes of the metre, the degree, Web Mercator.
ANGLES, SYSTEM, LENGTHS, HEIGHTS = 2054, 3072, 3076, 4099
METRE, DEGREE, WEB_MERCATOR = 9001, 9102, (3857, 3785)
#: A grid without a word about its coordinates and with a spacing below this is one in degrees, not in metres.
LEAST_SPACING = 0.05


@dataclass(frozen=True, slots=True)
class Transform:
    """x = a column + c, y = e row + f of the corner of a pixel, north up; the names of the usual six numbers."""

    a: float
    c: float
    e: float
    f: float
    b: float = 0.0
    d: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Plain:
    """One band: heights (rows from the north), transform, value for none, whether in degrees, what is foreign to us."""

    heights: NDArray[Any]
    transform: Transform
    nodata: float | None
    geographic: bool
    foreign: str | None = None


class Damaged(ValueError):
    """The file contradicts itself or ends too early."""


def read_plain(data: bytes, most: int) -> Plain | None:
    """The band of a plain file; None when the file is not plain.

    most : largest number of heights ; raises Damaged, and OverflowError above ``most``
    """
    tags, order = directory(data)
    dtype = sample_type(tags, order)
    if dtype is None or MATRIX in tags or SCALE not in tags or TIEPOINT not in tags:
        return None
    shape = (whole(tags, HEIGHT), whole(tags, WIDTH))
    if min(shape) < 1 or math.prod(shape) > most:
        raise OverflowError(f"shape {shape}")
    heights = assembled(data, tags, shape, dtype)
    keys = geo_keys(tags)
    transform = placed(tags, keys.get(RASTER_TYPE) == 2)
    return Plain(heights, transform, void(tags), keys.get(MODEL_TYPE) == 2, foreign(keys, transform.a))


def directory(data: bytes) -> tuple[dict[int, tuple[Any, ...]], str]:
    """Values of all known tags of the first directory, and the byte order."""
    order = {b"II": "<", b"MM": ">"}.get(data[:2])
    if order is None or len(data) < 8:
        raise Damaged("no TIFF header")
    version, start = struct.unpack(order + "HI", data[2:8])
    if version != 42:
        return {}, order
    (entries,) = struct.unpack(order + "H", part(data, start, 2))
    if not 0 < entries <= MOST_TAGS:
        raise Damaged(f"{entries} entries in the directory")
    table = part(data, start + 2, 12 * entries)
    return {tag: values for tag, values in fields(data, table, order)}, order


def fields(data: bytes, table: bytes, order: str) -> Iterator[tuple[int, tuple[Any, ...]]]:
    """(tag, values) of every entry of a known type."""
    for k in range(0, len(table), 12):
        tag, kind, count = struct.unpack(order + "HHI", table[k : k + 8])
        if kind not in FIELDS:
            continue
        size, letter = FIELDS[kind]
        if count > MOST_VALUES:
            raise Damaged(f"{count} values of tag {tag}")
        at = table[k + 8 : k + 12]
        raw = at[: size * count] if size * count <= 4 else part(data, struct.unpack(order + "I", at)[0], size * count)
        yield tag, struct.unpack(f"{order}{count}{letter}", raw)


def part(data: bytes, start: int, size: int) -> bytes:
    """Bytes of the file; Damaged when it ends before."""
    if start + size > len(data):
        raise Damaged(f"{size} bytes at {start} of {len(data)}")
    return data[start : start + size]


def whole(tags: dict[int, tuple[Any, ...]], tag: int, default: int | None = None) -> int:
    """One whole number."""
    values = tags.get(tag, () if default is None else (default,))
    if len(values) < 1 or not isinstance(values[0], int):
        raise Damaged(f"tag {tag} missing")
    return values[0]


def sample_type(tags: dict[int, tuple[Any, ...]], order: str) -> np.dtype[Any] | None:
    """Type of one sample, or None when the file is not plain."""
    if not tags or whole(tags, SAMPLES, 1) != 1 or whole(tags, PLANES, 1) != 1 or whole(tags, PREDICTOR, 1) != 1:
        return None
    bits, kind = whole(tags, BITS, 1), KINDS.get(whole(tags, FORMAT, 1), "")
    known = (kind == "f" and bits in (32, 64)) or (kind in ("u", "i") and bits in (8, 16, 32))
    if not known or whole(tags, COMPRESSION, 1) not in (RAW, DEFLATE, OLD_DEFLATE):
        return None
    return np.dtype(f"{order}{kind}{bits // 8}")


def assembled(data: bytes, tags: dict[int, tuple[Any, ...]], shape: tuple[int, int], dtype: np.dtype[Any]) -> Any:
    """Strips or tiles put together; what tiles have beyond the edge is cut off."""
    ny, nx = shape
    if TILE_OFFSETS in tags:
        high, wide = whole(tags, TILE_HEIGHT), whole(tags, TILE_WIDTH)
        offsets, counts = tags[TILE_OFFSETS], tags.get(TILE_COUNTS, ())
    else:
        high, wide = min(whole(tags, ROWS, ny), ny), nx
        offsets, counts = tags.get(OFFSETS, ()), tags.get(COUNTS, ())
    if high < 1 or wide < 1 or high * wide > 4 * ny * nx + 65536:
        raise Damaged(f"blocks of {high} by {wide}")
    across, down = -(-nx // wide), -(-ny // high)
    if not len(offsets) == len(counts) == across * down:
        raise Damaged(f"{len(offsets)} blocks instead of {across * down}")
    out = np.empty(shape, dtype=dtype.newbyteorder("="))
    for number, (start, count) in enumerate(zip(offsets, counts, strict=True)):
        top, left = number // across * high, number % across * wide
        rows = high if TILE_OFFSETS in tags else min(high, ny - top)
        block = block_of(part(data, start, count), whole(tags, COMPRESSION, 1), rows * wide, dtype)
        block = block.reshape(rows, wide)[: ny - top, : nx - left]
        out[top : top + block.shape[0], left : left + block.shape[1]] = block
    return out


def block_of(raw: bytes, compression: int, samples: int, dtype: np.dtype[Any]) -> NDArray[Any]:
    """Samples of one block; a deflated one is never inflated beyond its announced size."""
    size = samples * dtype.itemsize
    if compression != RAW:
        try:
            raw = zlib.decompressobj().decompress(raw, size)
        except zlib.error as reason:
            raise Damaged(str(reason)) from None
    if len(raw) < size:
        raise Damaged(f"a block of {len(raw)} bytes instead of {size}")
    return np.frombuffer(raw, dtype=dtype, count=samples)


def placed(tags: dict[int, tuple[Any, ...]], points: bool) -> Transform:
    """Place of the pixels' corners from one tie point and the scale.

    points : the tie point is where a height stands, not the corner of its pixel
    """
    scale, tie = tags[SCALE], tags[TIEPOINT]
    if len(scale) < 2 or len(tie) < 6 or not all(isinstance(v, float) for v in (*scale[:2], *tie[:6])):
        raise Damaged("scale or tie point")
    if not all(math.isfinite(v) for v in (*scale[:2], *tie[:6])):
        raise Damaged("scale or tie point not finite")
    half = 0.5 if points else 0.0
    a, e = scale[0], -scale[1]
    return Transform(a, tie[3] - (tie[0] + half) * a, e, tie[4] - (tie[1] + half) * e)


def geo_keys(tags: dict[int, tuple[Any, ...]]) -> dict[int, int]:
    """Keys whose value stands in the directory of keys itself."""
    values = tags.get(KEYS, ())
    rows = [values[k : k + 4] for k in range(4, len(values) - 3, 4)]
    return {row[0]: row[3] for row in rows if row[1] == 0}


def foreign(keys: dict[int, int], spacing: float) -> str | None:
    """What the keys say that is neither degrees nor true metres; None when all is well."""
    if keys.get(SYSTEM) in WEB_MERCATOR:
        return "Web Mercator, whose metres are too long away from the equator"
    for key, known, what in ((ANGLES, DEGREE, "angles"), (LENGTHS, METRE, "lengths"), (HEIGHTS, METRE, "heights")):
        if keys.get(key, known) != known:
            return f"{what} in the unit of EPSG code {keys[key]}"
    if MODEL_TYPE not in keys and spacing < LEAST_SPACING:
        return f"no system of coordinates and a spacing of {spacing:g}"
    return None


def void(tags: dict[int, tuple[Any, ...]]) -> float | None:
    """The value that means no height, written as text."""
    text = b"".join(tags.get(NODATA, ())) if all(isinstance(c, bytes) for c in tags.get(NODATA, ())) else b""
    text = text.strip(b"\0 ")
    if not text:
        return None
    try:
        return float(text.decode("ascii"))
    except ValueError:
        raise Damaged("the value for no data") from None
