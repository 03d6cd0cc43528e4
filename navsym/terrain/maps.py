"""Height maps and tracks in files: npz without pickles, SRTM tiles, GeoTIFF, CSV.

Nothing is allocated before the size that a header announces has been multiplied out and compared
with a limit, and nothing in a file is executed.
"""

from __future__ import annotations

import io
import logging
import math
import os
import re
import struct
import warnings
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from navsym.core.errors import (
    DomainError,
    DuplicateError,
    EmptyError,
    ExpressionSyntaxError,
    MissingEngineError,
    NavsymError,
    NotFiniteError,
    ShapeError,
    TooLargeError,
)
from navsym.language.csvfile import read_numbers
from navsym.language.files import file_in_errors, name_file, read_bytes, read_text
from navsym.models.earth import ECCENTRICITY_SQUARED, SEMI_MAJOR, prime_vertical_radius
from navsym.terrain.heights import voids_in

# Plain GeoTIFF files: one band of numbers in strips or tiles, uncompressed or deflated. tifffile reads the tags; the
# blocks are put together here, so that every offset and size is checked against the file, and the size of the raster
# against a limit, before anything is allocated. The rest of the format is left to rasterio: :func:`read_plain` returns
# None. TIFF 6.0; OGC 19-008, GeoTIFF 1.1.

SCALE, TIEPOINT, MATRIX, KEYS, METADATA, NODATA = 33550, 33922, 34264, 34735, 42112, 42113
#: One entry of GDAL's metadata, with the band that it is about and what it says of the samples.
ITEM = re.compile(r"<Item\s([^>]*)>([^<]*)</Item>")
#: What a file beside the map may say of its samples.
SAID = re.compile(r"<(Scale|Offset|UnitType|NoDataValue)\b")
#: Compressions that are read here: none, and two names of deflate.
RAW, DEFLATES = 1, (8, 32946)
#: Entries of a directory, and values of one tag, that a sensible file may have.
MOST_TAGS, MOST_VALUES = 200, 2_000_000
#: SampleFormat and bits of the numbers that are read here: unsigned, signed, floating point.
SAMPLES = {(kind, bits) for kind in (1, 2) for bits in (8, 16, 32)} | {(3, 32), (3, 64)}
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
class Band:
    """One band: heights (rows from the north), transform, value for none, whether in degrees, what is foreign to us.

    factor, offset : heights in metres are ``factor`` times the samples plus ``offset``
    """

    heights: NDArray[Any]
    transform: Any
    nodata: float | None
    geographic: bool
    foreign: str | None = None
    factor: float = 1.0
    offset: float = 0.0


class Damaged(ValueError):
    """The file contradicts itself or ends too early."""


class Bomb(OverflowError):
    """A small file that would inflate to a number of bytes, the argument, above the limit."""


def read_plain(data: bytes, most: int) -> Band | None:
    """The band of a plain file; None when the file is not plain.

    most : largest number of heights ; raises Damaged, and OverflowError above ``most``
    """
    require_small_directory(data)
    import tifffile

    silence = logging.getLogger("tifffile")
    silence.disabled = True  # damage is an error here, not a remark in a log
    try:
        with tifffile.TiffFile(io.BytesIO(data)) as file:
            return None if file.is_bigtiff else plain_page(file.pages.first, data, file.byteorder, most)
    except (Damaged, OverflowError):
        raise
    except Exception as reason:  # whatever the library makes of a damaged directory
        raise Damaged(f"{type(reason).__name__}: {reason}") from None
    finally:
        silence.disabled = False


def require_small_directory(data: bytes) -> None:
    """Damaged for a first directory that announces more than a sensible file has; nothing of it is read before."""
    order = {b"II": "<", b"MM": ">"}.get(data[:2])
    if order is None or len(data) < 8:
        raise Damaged("no TIFF header")
    version, start = struct.unpack(order + "HI", data[2:8])
    if version != 42:
        return
    (entries,) = struct.unpack(order + "H", data[start : start + 2].ljust(2, b"\0"))
    if not 0 < entries <= MOST_TAGS:
        raise Damaged(f"{entries} entries in the directory")
    layout = np.dtype([("tag", order + "u2"), ("type", order + "u2"), ("count", order + "u4"), ("at", order + "u4")])
    if start + 2 + 12 * entries > len(data):
        raise Damaged("the directory ends too early")
    if np.frombuffer(data, layout, entries, start + 2)["count"].max() > MOST_VALUES:
        raise Damaged("a tag with too many values")


def plain_page(page: Any, data: bytes, order: str, most: int) -> Band | None:
    """The band of a page of tifffile, which has read the tags; None when it is not plain."""
    wanted = (SCALE, TIEPOINT, MATRIX, KEYS, METADATA, NODATA)
    tags = {tag.code: tag.value for tag in page.tags if tag.code in wanted}
    if page.samplesperpixel != 1 or page.planarconfig != 1 or page.predictor != 1 or MATRIX in tags:
        return None
    known = page.dtype is not None and (page.sampleformat, page.bitspersample) in SAMPLES
    if not known or page.compression not in (RAW, *DEFLATES) or SCALE not in tags or TIEPOINT not in tags:
        return None
    shape = (int(page.imagelength), int(page.imagewidth))
    if min(shape) < 1 or math.prod(shape) > most:
        raise OverflowError(f"shape {shape}")
    size = math.prod(shape) * np.dtype(page.dtype).itemsize
    if page.compression != RAW and not is_inflatable(size, len(data)):
        raise Bomb(size)
    heights = assembled(data, page, shape, np.dtype(page.dtype).newbyteorder(order))  # type: ignore[call-overload]
    keys = geo_keys(tags.get(KEYS, ()))
    transform = placed(tags[SCALE], tags[TIEPOINT], keys.get(RASTER_TYPE) == 2)
    band = band_items(tags.get(METADATA, ""))
    strange = foreign(keys, transform.a) or foreign_heights(band.get("unittype", ""))
    factor, offset = (finite_item(band, name, usual) for name, usual in (("scale", 1.0), ("offset", 0.0)))
    degrees = keys.get(MODEL_TYPE) == 2
    return Band(heights, transform, void(tags.get(NODATA, "")), degrees, strange, factor, offset)


def is_inflatable(size: int, compressed: int) -> bool:
    """Whether an archive of so many bytes may inflate to ``size``: a small one not to many times what it is."""
    return size <= max(MOST_INFLATED, MOST_TIMES * compressed)


def band_items(metadata: Any) -> dict[str, str]:
    """What GDAL's metadata say of the first band, by role: ``scale``, ``offset``, ``unittype``."""
    found = {}
    for attributes, text in ITEM.findall(metadata if isinstance(metadata, str) else metadata.decode("latin-1")):
        words = dict(re.findall(r"(\w+)\s*=\s*[\"']([^\"']*)[\"']", attributes))
        if words.get("sample", "0") == "0":
            found[words.get("role", "").lower()] = text.strip()
    return found


def finite_item(band: dict[str, str], name: str, usual: float) -> float:
    """A number of the band's metadata; Damaged for another text, and for a scale of zero."""
    try:
        value = float(band.get(name, usual))
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or (name == "scale" and value == 0.0):
        raise Damaged(f"{name} {band[name]:.40}")
    return value


def foreign_heights(unit: str) -> str | None:
    """A unit of heights that is not the metre; None for the metre and for none."""
    return None if unit.lower() in ("", "m", "metre", "metres", "meter", "meters") else f"heights in {unit:.40}"


def assembled(data: bytes, page: Any, shape: tuple[int, int], dtype: np.dtype[Any]) -> NDArray[Any]:
    """Strips or tiles put together; what tiles have beyond the edge is cut off."""
    ny, nx = shape
    high, wide = (page.tilelength, page.tilewidth) if page.is_tiled else (min(page.rowsperstrip, ny), nx)
    if high < 1 or wide < 1 or high * wide > 4 * ny * nx + 65536:
        raise Damaged(f"blocks of {high} by {wide}")
    across, down = -(-nx // wide), -(-ny // high)
    if not len(page.dataoffsets) == len(page.databytecounts) == across * down:
        raise Damaged(f"{len(page.dataoffsets)} blocks instead of {across * down}")
    out = np.empty(shape, dtype=dtype.newbyteorder("="))
    for number, (start, count) in enumerate(zip(page.dataoffsets, page.databytecounts, strict=True)):
        top, left = number // across * high, number % across * wide
        rows = high if page.is_tiled else min(high, ny - top)
        if start + count > len(data):
            raise Damaged(f"{count} bytes at {start} of {len(data)}")
        block = block_of(data[start : start + count], page.compression, rows * wide, dtype)
        block = block.reshape(rows, wide)[: ny - top, : nx - left]
        out[top : top + block.shape[0], left : left + block.shape[1]] = block
    return out


def block_of(raw: bytes, compression: int, samples: int, dtype: np.dtype[Any]) -> NDArray[Any]:
    """Samples of one block; a deflated one is never inflated beyond its announced size."""
    size = samples * dtype.itemsize
    if compression != RAW:
        raw = zlib.decompressobj().decompress(raw, size)
    if len(raw) < size:
        raise Damaged(f"a block of {len(raw)} bytes instead of {size}")
    return np.frombuffer(raw, dtype=dtype, count=samples)


def placed(scale: Any, tie: Any, points: bool) -> Transform:
    """Place of the pixels' corners from one tie point and the scale.

    points : the tie point is where a height stands, not the corner of its pixel
    """
    if len(scale) < 2 or len(tie) < 6 or not all(isinstance(v, float) for v in (*scale[:2], *tie[:6])):
        raise Damaged("scale or tie point")
    if not all(math.isfinite(v) for v in (*scale[:2], *tie[:6])):
        raise Damaged("scale or tie point not finite")
    half = 0.5 if points else 0.0
    a, e = scale[0], -scale[1]
    return Transform(a, tie[3] - (tie[0] + half) * a, e, tie[4] - (tie[1] + half) * e)


def geo_keys(values: Any) -> dict[int, int]:
    """Keys whose value stands in the directory of keys itself."""
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


def void(written: Any) -> float | None:
    """The value that means no height, written as text."""
    text = written.strip("\0 ") if isinstance(written, str) else ""
    try:
        return float(text) if text else None
    except ValueError:
        raise Damaged("the value for no data") from None


#: Largest number of heights in a map file, and of bytes in a track file.
MOST_HEIGHTS, MOST_BYTES = 200_000_000, 64_000_000
#: Bytes to which an archive may inflate, whatever its size; a larger one to so many times its own bytes.
MOST_INFLATED, MOST_TIMES = 256_000_000, 50
#: Largest GeoTIFF, bytes.
MOST_TIFF_BYTES = 8 * MOST_HEIGHTS
SRTM_VOID = -32768


@dataclass(frozen=True, slots=True, eq=False)
class Raster:
    """What a map file holds: heights with row = y ascending, and where they lie.

    geographic : True when x0, y0, dx, dy are degrees of longitude and latitude
    """

    heights: NDArray[Any]
    x0: float
    y0: float
    dx: float
    dy: float
    nodata: float | None = None
    geographic: bool = False


def read_map(path: str | os.PathLike[str]) -> Raster:
    """A map from ``.npz``, ``.hgt`` or ``.tif``/``.tiff``, told apart by the end of the name.

    Raises NavsymError: ``missing-file``, ``syntax``, ``shape``, ``too-large``, ``domain``, ``missing``.
    """
    readers: dict[str, Callable[[Path], Raster]] = {
        ".npz": read_npz,
        ".hgt": read_hgt,
        ".tif": read_geotiff,
        ".tiff": read_geotiff,
    }
    reader = readers.get(Path(path).suffix.lower())
    with file_in_errors(path):
        if reader is None:
            got = name_file(Path(path).name)[-40:]
            raise DomainError(f"expected {', '.join(readers)} at the end; got {got}; convert it")
        return reader(Path(path))


def metres_per_degree(latitude: float) -> tuple[float, float]:
    """Metres of a degree of longitude and of one of latitude, on WGS-84 at a latitude in degrees and height zero."""
    phi = math.radians(latitude)
    N = float(prime_vertical_radius(phi))
    M = N**3 * (1 - ECCENTRICITY_SQUARED) / SEMI_MAJOR**2
    return math.radians(N * math.cos(phi)), math.radians(M)


def middle_latitude(raster: Raster) -> float:
    """The latitude of the middle row of a geographic tile, degrees."""
    return raster.y0 + 0.5 * raster.dy * (raster.heights.shape[0] - 1)


def local_frame(raster: Raster) -> Raster:
    """A geographic tile in metres east and north of its south-west node, by the ellipsoid at its middle latitude."""
    if not raster.geographic:
        return raster
    east, north = metres_per_degree(middle_latitude(raster))
    return Raster(raster.heights, 0.0, 0.0, east * raster.dx, north * raster.dy, raster.nodata)


# npz


def read_npz(path: Path) -> Raster:
    """``heights`` (row = y), ``x0, y0, dx, dy`` and perhaps ``nodata``; or the names of matplotlib's sample.

    The sample has ``elevation``, ``xmin``, ``xmax``, ``ymin``, ``ymax``, ``dx``, ``dy`` in degrees and its
    first row in the north.
    """
    with opened_zip(path) as archive:
        names = member_names(archive)
        get = lambda name: read_member(archive, names, name)  # noqa: E731
        if "elevation" in names and "heights" not in names:
            west, south, north, dx, dy = (scalar(get, name) for name in ("xmin", "ymin", "ymax", "dx", "dy"))
            # ymin and ymax are the outer edges of cells; the lowest row lies half a cell inside.
            return Raster(get("elevation")[::-1], west + 0.5 * dx, min(south, north) + 0.5 * dy, dx, dy, None, True)
        x0, y0, dx, dy = (scalar(get, name) for name in ("x0", "y0", "dx", "dy"))
        nodata = scalar(get, "nodata", finite=False) if "nodata" in names else None
        return Raster(get("heights"), x0, y0, dx, dy, nodata)


def opened_zip(path: Path) -> zipfile.ZipFile:
    """An npz archive; raises NavsymError for a missing file, ExpressionSyntaxError for a damaged one."""
    try:
        if not path.is_file():
            raise FileNotFoundError
        archive = zipfile.ZipFile(path)
    except FileNotFoundError:
        message = "expected a readable map file; got nothing there; check the path"
        raise NavsymError(message, kind="missing-file") from None
    except Exception as reason:  # zipfile has many: BadZipFile, NotImplementedError, struct errors
        raise damaged("an npz archive", reason) from None
    packed = [member for member in archive.infolist() if member.compress_type != zipfile.ZIP_STORED]
    size = sum(member.file_size for member in packed)
    # numpy writes deflate; of the others one block may inflate without a bound
    if any(member.compress_type != zipfile.ZIP_DEFLATED for member in packed):
        message = "expected arrays stored or deflated; got another compression; save it by numpy.savez_compressed"
        raise DomainError(message)
    if not is_inflatable(size, path.stat().st_size):
        raise bomb(size)
    return archive


def bomb(size: int) -> TooLargeError:
    """The error of an archive that would inflate too far; nothing of it has been inflated."""
    least = f"at most {MOST_INFLATED} bytes, or {MOST_TIMES} times those of the file"
    return TooLargeError(f"expected {least}, once inflated; got {size}; cut the map, or store it uncompressed")


def damaged(what: str, reason: object) -> ExpressionSyntaxError:
    """The error of a damaged file; what says what was expected in it, reason what came."""
    return ExpressionSyntaxError(f"expected {what}; got a damaged file ({reason!s:.80}); fetch or write it again")


def member_names(archive: zipfile.ZipFile) -> frozenset[str]:
    """Names of the arrays in an archive; raises DuplicateError when one comes twice."""
    names = [name.removesuffix(".npy") for name in archive.namelist()]
    if len(set(names)) < len(names):
        raise DuplicateError("expected every array once; got one name twice; write it again")
    return frozenset(names)


def read_member(archive: zipfile.ZipFile, names: frozenset[str], name: str) -> NDArray[Any]:
    """One array of an npz archive, its header checked before anything is allocated."""
    if name not in names:
        message = f"expected an array '{name}'; got {', '.join(sorted(names))[:120]}; add it"
        raise EmptyError(message, where=name)
    try:
        with archive.open(f"{name}.npy") as file:
            shape, fortran, dtype = npy_header(file)
            size = checked_size(shape, dtype)
            data = file.read(size + 1)
    except NavsymError as error:
        raise error.at(name) from None
    except Exception as reason:  # zlib, zipfile and struct errors of a damaged member
        raise damaged(f"the array '{name}'", reason) from None
    if len(data) != size:
        raise damaged(f"{size} bytes of '{name}'", f"{len(data)} bytes")
    array = np.frombuffer(data, dtype=dtype).reshape(shape, order="F" if fortran else "C")
    return np.array(array)


def npy_header(file: Any) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Shape, whether the order is Fortran's, and type of an npy member; the file then stands at its data.

    Raises ValueError for another version of the format, and numpy's errors for a header that cannot be read.
    """
    version = np.lib.format.read_magic(file)
    readers = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
    if version not in readers:
        raise ValueError(f"version {version} of the npy format")
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # numpy warns of headers that only Python 2 wrote
        shape, fortran, dtype = readers[version](file, max_header_size=4096)
    return shape, bool(fortran), dtype


def checked_size(shape: tuple[int, ...], dtype: np.dtype[Any]) -> int:
    """Bytes that a header announces; refuses objects (pickles), other types and large arrays."""
    if dtype.kind not in "iuf" or dtype.hasobject:
        raise DomainError(f"expected real numbers; got type {dtype!s:.40}; save plain numbers")
    if any(n < 0 for n in shape) or math.prod(shape) > MOST_HEIGHTS:
        raise TooLargeError(f"expected at most {MOST_HEIGHTS} numbers; got shape {shape!s:.60}; cut the map")
    return math.prod(shape) * dtype.itemsize


def scalar(get: Callable[[str], NDArray[Any]], name: str, *, finite: bool = True) -> float:
    """A single number of the archive as a float; get reads an array by name.

    Raises ShapeError for more or fewer numbers, NotFiniteError for nan and infinity unless finite is False.
    """
    array = get(name)
    if array.size != 1:
        raise ShapeError(f"expected one number; got shape {array.shape}; give one", where=name)
    value = float(array.reshape(-1)[0])
    if finite and not math.isfinite(value):
        raise NotFiniteError(f"expected a finite number; got {value}; mend it", where=name)
    return value


# SRTM tiles


def read_hgt(path: Path) -> Raster:
    """A one-degree SRTM tile: big-endian int16, first row in the north, -32768 where there is no height.

    The corner is read from the name (``N44W072…``), the number of samples (1201 or 3601) from the size.
    """
    name = re.match(r"([NS])(\d{2})([EW])(\d{3})", path.name.upper())
    if name is None:
        got = name_file(path.name)[-40:]
        raise DomainError(f"expected a name such as N44W072.hgt, which gives the corner; got {got}; rename it")
    data = read_bytes(path, 2 * 3601 * 3601)
    side = {2 * n * n: n for n in (1201, 3601)}.get(len(data))
    if side is None:
        sizes = f"{2 * 1201**2} or {2 * 3601**2} bytes (1201 or 3601 samples squared)"
        raise ShapeError(f"expected {sizes}; got {len(data)}; fetch it again")
    latitude = int(name[2]) * (1 if name[1] == "N" else -1)
    longitude = int(name[4]) * (1 if name[3] == "E" else -1)
    heights = np.frombuffer(data, dtype=">i2").reshape(side, side)[::-1].astype(np.int16)
    step = 1.0 / (side - 1)
    return Raster(heights, float(longitude), float(latitude), step, step, float(SRTM_VOID), True)


# GeoTIFF


def read_geotiff(path: Path) -> Raster:
    """First band of an upright GeoTIFF: plain files are read here, others by rasterio if it is there.

    Raises MissingEngineError for a file that needs the extra ``maps``.
    """
    data = read_bytes(path, MOST_TIFF_BYTES)
    try:
        plain = read_plain(data, MOST_HEIGHTS)
    except Bomb as reason:
        raise bomb(reason.args[0]) from None
    except OverflowError as reason:
        raise TooLargeError(f"expected at most {MOST_HEIGHTS} numbers; got {reason!s:.60}; cut the map") from None
    except Damaged as reason:
        raise damaged("a GeoTIFF", reason) from None
    if plain is not None:
        refuse_sidecar(path)
    band = by_rasterio(path) if plain is None else plain
    if band.foreign is not None:  # it would be taken for metres, or for degrees, without being that
        wanted = "places in degrees or true metres, and heights in metres"
        raise DomainError(f"expected {wanted}; got {band.foreign}; warp it first")
    return in_metres(upright(band), band.factor, band.offset)


def refuse_sidecar(path: Path) -> None:
    """Refuse what a file of GDAL beside the map says of its samples, which is not read here."""
    beside = path.with_name(f"{path.name}.aux.xml")
    said = SAID.search(read_text(beside, MOST_BYTES)) if beside.is_file() else None
    if said:
        place = beside.name[-60:]
        raise DomainError(f"expected {said[1]} in the map itself; got it in {place}; write it there by gdal_translate")


def in_metres(raster: Raster, factor: float, offset: float) -> Raster:
    """Heights from samples: ``factor`` times each plus ``offset``; what means no height stays without one."""
    if (factor, offset) == (1.0, 0.0):
        return raster
    heights = np.array(raster.heights, dtype=np.float64)
    heights[voids_in(raster.heights, raster.nodata)] = np.nan
    return replace(raster, heights=factor * heights + offset, nodata=math.nan)


def by_rasterio(path: Path) -> Band:
    """Files that are not plain: compressed in other ways, tiled by planes, placed by a matrix."""
    try:
        import rasterio
    except ModuleNotFoundError:
        raise MissingEngineError(
            "expected one band of numbers, uncompressed or deflated, placed by a tie point and a scale, or the Python "
            "package rasterio; got another GeoTIFF and no rasterio; install the extra navsym[maps]"
        ) from None
    try:
        with rasterio.open(path) as source:
            shape, transform = (source.height, source.width), source.transform
            size = checked_size(shape, np.dtype(source.dtypes[0]))
            if not is_inflatable(size, path.stat().st_size):
                raise bomb(size)
            geographic = bool(source.crs is not None and source.crs.is_geographic)
            foreign = foreign_to_us(source.crs) or foreign_heights(source.units[0] or "")
            scales = source.scales[0], source.offsets[0]
            return Band(source.read(1), transform, source.nodata, geographic, foreign, *scales)
    except NavsymError:
        raise
    except Exception as reason:  # whatever GDAL says about a damaged file
        raise damaged("a GeoTIFF", reason) from None


def foreign_to_us(crs: Any) -> str | None:
    """The same question to rasterio's system of coordinates."""
    if crs is None or crs.is_geographic:
        return None
    if crs.to_epsg() in WEB_MERCATOR:
        return "Web Mercator, whose metres are too long away from the equator"
    name, metres = crs.linear_units_factor
    return None if math.isclose(metres, 1.0, rel_tol=1e-9) else f"lengths in {name}"


def upright(band: Band) -> Raster:
    """A north-up raster with its rows turned round; heights stand at the middle of the pixels."""
    heights, transform = band.heights, band.transform
    if transform.b or transform.d or transform.a <= 0 or transform.e >= 0:
        raise DomainError("expected a raster with north up and no rotation; got another one; warp it first")
    x0 = transform.c + 0.5 * transform.a
    y0 = transform.f + transform.e * (heights.shape[0] - 0.5)
    void = None if band.nodata is None else float(band.nodata)
    return Raster(heights[::-1], x0, y0, transform.a, -transform.e, void, band.geographic)


# Tracks


#: Columns of a track: in the unit of the map, or on the Earth in degrees.
PLANE, GEODETIC = ("t", "x", "y", "h"), ("t", "lat", "lon", "h")


def read_track(path: str | os.PathLike[str]) -> dict[str, list[float]]:
    """Columns t, x, y, h, or t, lat, lon, h, of a CSV file with a head; raises NavsymError with the line."""
    return read_numbers(path, (PLANE, GEODETIC))
