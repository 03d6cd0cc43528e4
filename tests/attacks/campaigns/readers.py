"""Every reader of files with an honest file for it, and files built to exhaust or mislead it.

Binary maps and tracks are read from a path: each damaged file is written to the temporary folder first.
An npz map is damaged twice over: as a whole, where the archive's own checksums notice most, and inside
its arrays before it is packed, where only the reader can.
"""

from __future__ import annotations

import io
import json
import os
import struct
import tempfile
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from navsym import checker
from navsym.core.errors import NavsymError
from navsym.language.expression import parse, symbol
from navsym.language.jsonfile import parse_json
from navsym.language.tomlfile import parse_toml
from navsym.models.modelfile import model_from
from navsym.multimodel.filters import read_bank
from navsym.prove.claimfile import claims_from
from navsym.studies.plan import sweep_from
from navsym.terrain import maps as readers_maps
from navsym.terrain.locate import locate
from navsym.trajectory import reader as readers_tracks

Reader = Callable[[bytes], Any]

SYMBOLS = {name: symbol(name) for name in ("x", "T", "w", "t")}
EXPRESSION = b"cos(T/2)/sin(T/4)**2 - sqrt(x*(1 + 0.25e-1))*atan2(x, -pi) + abs(log(x**2)/tan(T))"
MODEL = b"""[model]
name = "m"
states = ["x", "v"]
F = [["0", "w**2"], ["-1/w", "1/2"]]
[parameters]
w = ["1/2", "2"]
[[measurement]]
name = "position"
h = ["1", "sin(w*t)"]
sigma = "1"
[interval]
T = "pi/2"
"""
BASIS = b"""[basis]
variable = "s"
H = [["1", "s"], ["s**2", "exp(-s)"]]
sigma = ["1", "2"]
interval = ["0", "1"]
[targets]
a = ["0", "1"]
"""
CLAIMS = b"""[symbols]
a = "real"
T = ["0", "2*pi"]
[[claim]]
id = "one"
left = "sin(2*a)/T"
right = "2*cos(a)"
relation = "<="
box = {T = ["1", "2"]}
"""
BANK = json.dumps(
    {
        "models": [{"F": [[1.0, 2e3], [0, -1]], "Q": [[1, 0], [0, 1]], "H": [[1, 0]], "R": [[0.5]]}] * 2,
        "mode_transition": [[0.9, 0.1], [0.2, 0.8]],
        "initial": {"mean": [0, 0], "covariance": [[1, 0], [0, 1]], "probabilities": [0.5, 0.5]},
        "measurements": [[1.0], [2.5], [-1e-3]],
        "memoryless": True,
    }
).encode()
SWEEP = b'{"kind": "guaranteed", "jobs": 3, "seed": 5, "degree": 2, "start": "1/2", "end": "7/3"}'
CONFIG = json.dumps(
    {
        "map": {"heights": [[1.0, 2, 4], [3, 5, 6], [0, 7, 8]], "x0": 0, "y0": 0, "dx": 10, "dy": 10},
        "track": {"t": [0, 1, 2, 3], "x": [5, 6, 7, 8], "y": [5.0, 6, 8, 9], "h": [2, 3, 3.5, 4]},
        "position": {"step": [1, 1], "half_count": [1, 1]},
        "velocity": {"step": [0.5, 0.5], "half_count": [0, 1]},
    }
).encode()
CERTIFICATE = json.dumps(
    {
        "kind": "gap",
        "variable": "t",
        "functional": ["0", "1"],
        "bits": 80,
        "cells": 40,
        "panels": [{"measurement": 0, "from": "0", "to": "2", "sigma": "1", "H": ["1", "t"]}],
        "dual": ["-0.999", "0.999"],
        "support": [[0, "0"], [0, "1"]],
        "lower": "0.9989",
        "upper": "1.0001",
        "parameter": "p",
        "from": "0",
        "to": "0",
    }
).encode()
TRACK = b"time,lat,lon,height\n" + b"".join(b"%d.5,%d.25,-72.%d,%d\n" % (k, 44, k, 100 + k) for k in range(8))
FLAT = b"t,x,y,h\n" + b"".join(b"%d,%d.5,%d,%d\n" % (k, k, 2 * k, 100 + k) for k in range(8))
POSITIONS = b"% (lat/lon/height=WGS84/ellipsoidal)\n%  GPST latitude(deg) longitude(deg) height(m) Q ns\n" + b"".join(
    b"2020/01/01 00:00:%02d.000   44.1000%d0000  -72.000000000   120.5000   1   9  0.01 0.01 0.02\n" % (k, k)
    for k in range(6)
)


def matlab_header() -> bytes:
    """The beginning of a MATLAB file, which is no track that navsym reads."""
    text = b"MATLAB 5.0 MAT-file, Platform: GLNXA64".ljust(124, b" ")
    return text + struct.pack("<HH", 0x0100, 0x4D49) + struct.pack("<II", 14, 64) + bytes(64)


def npy(array: Any) -> bytes:
    """The bytes of an npy file that holds an array."""
    buffer = io.BytesIO()
    np.save(buffer, np.asarray(array), allow_pickle=False)
    return buffer.getvalue()


HEIGHTS = npy(np.arange(12, dtype=np.float32).reshape(3, 4))


def archive(heights: bytes = HEIGHTS) -> bytes:
    """An npz map around the bytes of its array of heights."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as out:
        out.writestr("heights.npy", heights)
        for name, value in (("x0", 0.0), ("y0", 1.0), ("dx", 30.0), ("dy", 30.0)):
            out.writestr(f"{name}.npy", npy(value))
    return buffer.getvalue()


def tiff() -> bytes:
    """A small GeoTIFF: one band of 2 by 2 heights, pixel scale and tie point."""
    doubles = struct.pack("<9d", 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 10.0, 50.0, 0.0)
    pixels = struct.pack("<4h", 1, 2, 3, 4)
    start = 8 + 2 + 12 * 10 + 4
    entries = (
        (256, 3, 1, 2),
        (257, 3, 1, 2),
        (258, 3, 1, 16),
        (259, 3, 1, 1),
        (262, 3, 1, 1),
        (273, 4, 1, start + 72),
        (278, 3, 1, 2),
        (279, 4, 1, 8),
        (33550, 12, 3, start),
        (33922, 12, 6, start + 24),
    )
    table = b"".join(struct.pack("<HHII", *entry) for entry in entries)
    return b"II*\0" + struct.pack("<IH", 8, len(entries)) + table + struct.pack("<I", 0) + doubles + pixels


def scratch() -> Path:
    """Folder of this process for files that are read from a path; who reads many removes it at the end."""
    folder = Path(tempfile.gettempdir()) / f"navsym-read-{os.getpid()}"
    folder.mkdir(exist_ok=True)
    return folder


def from_file(read: Callable[[Path], Any], name: str) -> Reader:
    """A reader of paths as one of bytes: they are written to a temporary file first."""

    def reader(data: bytes) -> Any:
        path = scratch() / name
        try:
            path.write_bytes(data)
            return read(path)
        finally:
            path.unlink(missing_ok=True)

    return reader


def text_reader(read: Callable[[Any], Any]) -> Reader:
    """A reader of parsed JSON as one of bytes."""
    return lambda data: read(parse_json(data, "f"))


def map_reader(path: Path) -> Any:
    """The map of a file in its local frame, in metres."""
    return readers_maps.local_frame(readers_maps.read_map(path))


def certificate(data: bytes) -> Any:
    """The checker's own refusal counts as one of ours.

    Its work is bounded by the cells and bits that a certificate announces: these are cut here.
    """
    try:
        item = checker.load(data.decode("utf-8"))
        for name, most in (("cells", 200), ("bits", 200)):
            if isinstance(item, dict) and type(item.get(name)) is int:
                item[name] = min(item[name], most)
        return checker.check(item)
    except (checker.Refused, UnicodeDecodeError) as error:
        raise NavsymError(f"expected a certificate; got {error}; do check it") from None


#: Name -> reader of bytes, an honest file.
READERS: dict[str, tuple[Reader, bytes]] = {
    "expression": (lambda data: parse(data.decode("latin-1"), SYMBOLS, where="f"), EXPRESSION),
    "model": (lambda data: model_from(parse_toml(data, "f"), "f"), MODEL),
    "basis": (lambda data: model_from(parse_toml(data, "f"), "f"), BASIS),
    "claims": (lambda data: claims_from(parse_toml(data, "f"), "f"), CLAIMS),
    "json": (lambda data: parse_json(data, "f"), BANK),
    "bank": (text_reader(read_bank), BANK),
    "sweep": (text_reader(sweep_from), SWEEP),
    "config": (text_reader(locate), CONFIG),
    "certificate": (certificate, CERTIFICATE),
    "track.csv": (from_file(readers_tracks.read_track, "t.csv"), TRACK),
    "repaired.csv": (from_file(lambda path: readers_tracks.read_track(path, "repair"), "r.csv"), TRACK),
    "flat.csv": (from_file(readers_maps.read_track, "f.csv"), FLAT),
    "track.pos": (from_file(readers_tracks.read_track, "t.pos"), POSITIONS),
    "track.mat": (from_file(readers_tracks.read_track, "t.mat"), matlab_header()),
    "map.npz": (from_file(map_reader, "m.npz"), archive()),
    "heights": (lambda data: from_file(map_reader, "h.npz")(archive(data)), HEIGHTS),
    "map.hgt": (from_file(map_reader, "N44W072.hgt"), bytes(2 * 1201)),
    "map.tif": (from_file(map_reader, "m.tif"), tiff()),
}


# -- files that promise more than they hold, or hold more than they promise -----------------------------


def lying_array(shape: str, kind: str = "<f4", body: bytes = b"") -> bytes:
    """An npy file whose header announces this shape and type."""
    header = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}".encode()
    header += b" " * (-(len(header) + 11) % 64) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + body


def deflated(size: int) -> bytes:
    """An npz whose heights unpack to this many zeros."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as out:
        out.writestr("heights.npy", lying_array("(2, 2)") + bytes(size))
        for name in ("x0", "y0", "dx", "dy"):
            out.writestr(f"{name}.npy", npy(1.0))
    return buffer.getvalue()


def lying_tiff(width: int, height: int) -> bytes:
    """A GeoTIFF that announces this many pixels and has four."""
    data = tiff().replace(struct.pack("<HHII", 256, 3, 1, 2), struct.pack("<HHII", 256, 4, 1, width))
    return data.replace(struct.pack("<HHII", 257, 3, 1, 2), struct.pack("<HHII", 257, 4, 1, height))


def many_members(count: int) -> bytes:
    """An npz with so many empty members."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as out:
        for k in range(count):
            out.writestr(f"{k}.npy", b"")
    return buffer.getvalue()


BOMBS: dict[str, tuple[str, Callable[[], bytes]]] = {
    "array of 10^18 numbers": ("heights", lambda: lying_array("(1000000000, 1000000000)")),
    "array of 10^8 numbers and no bytes": ("heights", lambda: lying_array("(10000, 10000)")),
    "negative shape": ("heights", lambda: lying_array("(-1, 4)", body=bytes(16))),
    "shape of many axes": ("heights", lambda: lying_array("(" + "1, " * 60 + ")", body=bytes(4))),
    "array of objects": ("heights", lambda: lying_array("(1,)", "|O", b"cos\nsystem\n(S'true'\ntR.")),
    "header of a calculation": ("heights", lambda: lying_array("(9**9**9,)")),
    "header of nesting": ("heights", lambda: lying_array("(" * 2000 + ")" * 2000)),
    "header of 60 kB": ("heights", lambda: lying_array("(2, 2)" + " " * 60_000)),
    "64 MB of zeros in 64 kB": ("map.npz", lambda: deflated(64 * 2**20)),
    "many members": ("map.npz", lambda: many_members(5000)),
    "an archive in an archive": ("map.npz", lambda: archive(archive())),
    "a truncated archive": ("map.npz", lambda: archive()[:-40]),
    "a tile that is one": ("map.hgt", lambda: bytes(2 * 1201**2)),
    "a tile one byte short": ("map.hgt", lambda: bytes(2 * 1201**2 - 1)),
    "a tile of 100 MB": ("map.hgt", lambda: bytes(100_000_000)),
    "a raster of 10^18 pixels": ("map.tif", lambda: lying_tiff(2**30, 2**30)),
    "a raster of 10^8 pixels": ("map.tif", lambda: lying_tiff(10_000, 10_000)),
    "a gzip": ("map.tif", lambda: zlib.compress(bytes(2**20))),
    "a line of 10^6 columns": ("track.csv", lambda: b"time,lat,lon,height\n" + b"1," * 10**6),
    "10^5 rows of nothing": ("track.csv", lambda: b"time,lat,lon,height\n" + b",,,\n" * 10**5),
    "an open quote": ("track.csv", lambda: b'time,lat,lon,height\n"' + b"1,2,3,4\n" * 30_000),
    "a number of 10^6 digits": ("flat.csv", lambda: b"t,x,y,h\n" + b"9" * 10**6 + b",1,1,1\n"),
    "a year of 10^5 digits": ("track.pos", lambda: b"% GPST\n" + b"9" * 10**5 + b"/01/01 00:00:00 1 2 3\n"),
    "brackets": ("json", lambda: b"[" * 10**6),
    "a long number": ("json", lambda: b"1" * 10**6),
    "many keys": ("json", lambda: b"{" + b",".join(b'"%d":0' % k for k in range(10**5)) + b"}"),
    "a tower of powers": ("expression", lambda: b"**".join([b"9"] * 90)),
    "an exponent of text": ("expression", lambda: b"(x+T+w+t+1)**999*(x-T+w-t)**999"),
    "many parentheses": ("expression", lambda: b"(" * 5000 + b"x" + b")" * 5000),
    "nested functions": ("expression", lambda: b"exp(" * 12 + b"9" + b")" * 12),
    "many terms": ("expression", lambda: b"+".join(b"sin(%d*x)" % k for k in range(500))),
    "many tables": ("claims", lambda: b"[[claim]]\n" * 10**4),
    "many jobs": ("sweep", lambda: SWEEP.replace(b'"jobs": 3', b'"jobs": 1000000000000')),
    "a bank of 10^5 measurements": ("bank", lambda: BANK.replace(b"[[1.0],", b"[" + b"[1.0]," * 10**5)),
    "a search of 10^12 hypotheses": ("config", lambda: CONFIG.replace(b"[1, 1]}", b"[1000000, 1000000]}", 1)),
}
