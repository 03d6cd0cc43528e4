"""GeoTIFF files written by the test itself and by another program (Pillow), and damaged ones."""

from __future__ import annotations

import json
import random
import struct
import sys
import zlib

import numpy as np
import pytest
from PIL import Image, TiffImagePlugin

from navsym.cli.main import run
from navsym.core.errors import NavsymError
from navsym.terrain.heights import TerrainMap
from navsym.terrain.maps import Damaged, read_map, read_plain

KINDS = {"u": 1, "i": 2, "f": 3}
LETTERS = {3: "H", 4: "I", 12: "d", 2: "s"}


def geotiff(heights, *, order="<", tile=None, rows=None, deflate=False, extra=(), nodata=None, point=False, drop=()):
    """Bytes of a TIFF: a 100 m by 50 m raster whose first corner lies at (500000, 4900000), north up."""
    ny, nx = heights.shape
    stored = heights.astype(heights.dtype.newbyteorder(order))
    if tile:
        grown = np.zeros((-(-ny // tile) * tile, -(-nx // tile) * tile), stored.dtype)
        grown[:ny, :nx] = stored
        blocks = [grown[r : r + tile, c : c + tile] for r in range(0, ny, tile) for c in range(0, nx, tile)]
    else:
        blocks = [stored[r : r + (rows or ny)] for r in range(0, ny, rows or ny)]
    raw = [zlib.compress(b.tobytes()) if deflate else b.tobytes() for b in blocks]
    keys = [1, 1, 0, 2, 1024, 0, 1, 1, 1025, 0, 1, 2 if point else 1]
    tags = {
        256: (4, [nx]),
        257: (4, [ny]),
        258: (3, [8 * heights.itemsize]),
        259: (3, [8 if deflate else 1]),
        277: (3, [1]),
        339: (3, [KINDS[heights.dtype.kind]]),
        33550: (12, [100.0, 50.0, 0.0]),
        33922: (12, [0.0, 0.0, 0.0, 5e5, 4.9e6, 0.0]),
        34735: (3, keys),
    }
    if tile:
        tags |= {322: (4, [tile]), 323: (4, [tile]), 324: (4, "offsets"), 325: (4, [len(r) for r in raw])}
    else:
        tags |= {273: (4, "offsets"), 278: (4, [rows or ny]), 279: (4, [len(r) for r in raw])}
    if nodata is not None:
        tags[42113] = (2, [nodata.encode() + b"\0"])
    tags |= dict(extra)
    return written({tag: value for tag, value in tags.items() if tag not in drop}, raw, order)


def written(tags, blocks, order):
    """Header, blocks, directory, long values."""
    starts, at = [], 8
    for block in blocks:
        starts.append(at)
        at += len(block)
    directory, beyond = b"", b""
    after = at + 2 + 12 * len(tags) + 4
    for tag in sorted(tags):
        kind, values = tags[tag]
        values = starts if values == "offsets" else values
        data = values[0] if kind == 2 else struct.pack(f"{order}{len(values)}{LETTERS[kind]}", *values)
        count = len(data) if kind == 2 else len(values)
        place = data.ljust(4, b"\0") if len(data) <= 4 else struct.pack(order + "I", after + len(beyond))
        beyond += data if len(data) > 4 else b""
        directory += struct.pack(order + "HHI", tag, kind, count) + place
    head = (b"II" if order == "<" else b"MM") + struct.pack(order + "HI", 42, at)
    return head + b"".join(blocks) + struct.pack(order + "H", len(tags)) + directory + b"\0\0\0\0" + beyond


def relief(dtype="f4", shape=(37, 41)):
    return (100 * np.random.default_rng(1).random(shape)).astype(dtype)


@pytest.mark.parametrize("dtype", ["u1", "i2", "u2", "i4", "f4", "f8"])
@pytest.mark.parametrize(
    "layout", [{}, {"rows": 5}, {"tile": 16}, {"deflate": True, "rows": 7}, {"order": ">", "tile": 16}]
)
def test_a_written_raster_comes_back_with_its_place(tmp_path, dtype, layout):
    heights = relief(dtype)
    (tmp_path / "m.tif").write_bytes(geotiff(heights, **layout))
    raster = read_map(tmp_path / "m.tif")
    np.testing.assert_array_equal(raster.heights, heights[::-1])
    assert (raster.dx, raster.dy, raster.geographic, raster.nodata) == (100.0, 50.0, False, None)
    assert (raster.x0, raster.y0) == (5e5 + 50.0, 4.9e6 - 36.5 * 50.0)


def test_heights_at_points_stand_half_a_pixel_nearer_to_the_corner(tmp_path):
    (tmp_path / "m.tif").write_bytes(geotiff(relief(), point=True, nodata="-9999"))
    raster = read_map(tmp_path / "m.tif")
    assert (raster.x0, raster.y0, raster.nodata) == (5e5, 4.9e6 - 36 * 50.0, -9999.0)


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ([3072, 0, 1, 3857], "Web Mercator"),
        ([3076, 0, 1, 9003], "lengths in the unit of EPSG code 9003"),
        ([2054, 0, 1, 9105], "angles in the unit of EPSG code 9105"),
        ([4099, 0, 1, 9002], "heights in the unit of EPSG code 9002"),
    ],
)
def test_coordinates_that_would_be_taken_for_metres_are_refused_in_words(tmp_path, keys, said):
    directory = (3, [1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, *keys])
    (tmp_path / "m.tif").write_bytes(geotiff(relief(), extra={34735: directory}))
    with pytest.raises(NavsymError, match=said) as caught:
        read_map(tmp_path / "m.tif")
    assert caught.value.kind == "domain" and "warp it" in caught.value.message


def test_degrees_without_a_word_about_them_are_not_taken_for_metres(tmp_path):
    degrees = {33550: (12, [1 / 1200, 1 / 1200, 0.0]), 33922: (12, [0.0, 0.0, 0.0, -72.0, 45.0, 0.0])}
    (tmp_path / "m.tif").write_bytes(geotiff(relief(), extra=degrees, drop=(34735,)))
    with pytest.raises(NavsymError, match=r"no system of coordinates and a spacing of 0\.000833"):
        read_map(tmp_path / "m.tif")


@pytest.mark.parametrize("compression", [None, "tiff_adobe_deflate"])
@pytest.mark.parametrize("mode", ["F", "I;16", "L", "I"])
def test_files_of_another_program_are_read(tmp_path, mode, compression):
    dtype = {"F": "f4", "I;16": "u2", "L": "u1", "I": "i4"}[mode]
    heights = relief(dtype)
    tags = TiffImagePlugin.ImageFileDirectory_v2()
    for tag, kind, value in (
        (33550, 12, (2.0, 3.0, 0.0)),
        (33922, 12, (0.0, 0.0, 0.0, 10.0, 20.0, 0.0)),
        (34735, 3, (1, 1, 0, 1, 1024, 0, 1, 2)),
        (42113, 2, "0"),
    ):
        tags.tagtype[tag] = kind
        tags[tag] = value
    image = Image.fromarray(heights)
    assert image.mode == mode
    image.save(tmp_path / "m.tif", tiffinfo=tags, compression=compression)
    raster = read_map(tmp_path / "m.tif")
    np.testing.assert_array_equal(raster.heights, heights[::-1])
    assert (raster.x0, raster.dx, raster.dy, raster.geographic, raster.nodata) == (11.0, 2.0, 3.0, True, 0.0)


@pytest.mark.parametrize(
    "other",
    [
        {"extra": {259: (3, [5])}},
        {"extra": {277: (3, [3])}},
        {"extra": {317: (3, [2])}},
        {"drop": (33550,)},
        {"extra": {34264: (12, [1.0] * 16)}},
        {"extra": {258: (3, [1])}},
    ],
)
def test_what_is_not_plain_is_left_to_rasterio(tmp_path, other, monkeypatch):
    """Without that library it is refused by name."""
    monkeypatch.setitem(sys.modules, "rasterio", None)
    data = geotiff(relief(), **other)
    assert read_plain(data, 10**6) is None
    (tmp_path / "m.tif").write_bytes(data)
    with pytest.raises(NavsymError) as caught:
        read_map(tmp_path / "m.tif")
    assert caught.value.kind in ("missing", "syntax", "domain")


def test_a_raster_above_the_limit_is_refused_before_anything_is_read():
    huge = geotiff(relief(), extra={256: (4, [2**31]), 257: (4, [2**31])})
    with pytest.raises(OverflowError):
        read_plain(huge, 200_000_000)


def test_a_block_that_inflates_beyond_its_size_is_cut_there():
    bomb = zlib.compress(b"\0" * 50_000_000)
    data = geotiff(relief(shape=(2, 2)), deflate=True)
    blocks = written({tag: v for tag, v in tags_of(len(bomb)).items()}, [bomb], "<")
    assert read_plain(blocks, 100).heights.shape == (2, 2)
    assert read_plain(data, 100).heights.shape == (2, 2)


def metadata(**roles):
    items = "".join(
        f'<Item name="{name.upper()}" sample="0" role="{name}">{value}</Item>' for name, value in roles.items()
    )
    text = f'<GDALMetadata><Item name="scale" sample="0">77</Item>{items}</GDALMetadata>'
    return {42112: (2, [text.encode() + b"\0"])}


def test_heights_are_the_scale_times_the_samples_plus_the_offset_and_voids_stay_voids(tmp_path):
    samples = np.array([[3, -100, 7], [5, 0, 1]], "i2")
    (tmp_path / "m.tif").write_bytes(geotiff(samples, nodata="-100", extra=metadata(scale="0.5", offset="200")))
    raster = read_map(tmp_path / "m.tif")
    np.testing.assert_array_equal(raster.heights, [[202.5, 200.0, 200.5], [201.5, np.nan, 203.5]])
    terrain = TerrainMap(raster.heights, raster.x0, raster.y0, raster.dx, raster.dy, raster.nodata)
    assert np.isnan(terrain.heights).sum() == 1


def test_metadata_without_a_scale_change_nothing(tmp_path):
    (tmp_path / "m.tif").write_bytes(geotiff(relief(), extra=metadata(unittype="metre", offset="0")))
    raster = read_map(tmp_path / "m.tif")
    np.testing.assert_array_equal(raster.heights[::-1], relief())
    assert raster.heights.dtype == np.float32


@pytest.mark.parametrize(
    ("roles", "kind", "said"),
    [
        ({"scale": "ten"}, "syntax", "scale ten"),
        ({"scale": "0"}, "syntax", "scale 0"),
        ({"offset": "nan"}, "syntax", "offset nan"),
        ({"unittype": "US survey foot"}, "domain", "heights in US survey foot"),
    ],
)
def test_samples_that_are_no_metres_are_refused_in_words(tmp_path, roles, kind, said):
    (tmp_path / "m.tif").write_bytes(geotiff(relief(), extra=metadata(**roles)))
    with pytest.raises(NavsymError, match=said) as caught:
        read_map(tmp_path / "m.tif")
    assert caught.value.kind == kind


def test_what_stands_beside_the_map_about_its_samples_is_refused(tmp_path):
    (tmp_path / "m.tif").write_bytes(geotiff(relief()))
    beside = tmp_path / "m.tif.aux.xml"
    beside.write_text("<PAMDataset><PAMRasterBand band='1'><Metadata/></PAMRasterBand></PAMDataset>")
    assert read_map(tmp_path / "m.tif").heights.shape == relief().shape
    beside.write_text("<PAMDataset><PAMRasterBand band='1'><Scale>2</Scale></PAMRasterBand></PAMDataset>")
    with pytest.raises(NavsymError, match="expected Scale in the map itself; got it in m"):
        read_map(tmp_path / "m.tif")


@pytest.mark.parametrize("written", ["-9999.9", "-3.4028235e+38", "-32767.1", "1e-40"])
def test_a_void_of_single_precision_is_one_although_its_number_is_rounded_there(tmp_path, written):
    heights = relief()
    heights[3, 4] = np.float32(written)
    (tmp_path / "m.tif").write_bytes(geotiff(heights, nodata=written))
    raster = read_map(tmp_path / "m.tif")
    for held in (raster.heights, raster.heights.astype(float), raster.heights.tolist()):
        terrain = TerrainMap(held, raster.x0, raster.y0, raster.dx, raster.dy, raster.nodata)
        assert np.argwhere(np.isnan(terrain.heights)).tolist() == [[relief().shape[0] - 4, 4]]


def test_a_small_file_that_inflates_far_is_refused_before_it_does(tmp_path):
    """The announced shape counts; not one block is inflated."""
    block = zlib.compress(b"\0" * 400)
    tags = tags_of(len(block)) | {256: (4, [12_000]), 257: (4, [12_000]), 278: (4, [12_000])}
    (tmp_path / "m.tif").write_bytes(written(tags, [block], "<"))
    with pytest.raises(NavsymError, match=r"once inflated; got 576000000; cut the map") as caught:
        read_map(tmp_path / "m.tif")
    assert caught.value.kind == "too-large"


def tags_of(size):
    return {
        256: (4, [2]),
        257: (4, [2]),
        258: (3, [32]),
        259: (3, [8]),
        277: (3, [1]),
        339: (3, [3]),
        273: (4, "offsets"),
        278: (4, [2]),
        279: (4, [size]),
        33550: (12, [1.0, 1.0, 0.0]),
        33922: (12, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    }


def test_damaged_files_are_damaged_and_nothing_else():
    generator = random.Random(3)
    good = [geotiff(relief(), **layout) for layout in ({}, {"tile": 16}, {"deflate": True, "rows": 5}, {"order": ">"})]
    seen = {"read": 0, "refused": 0}
    for _ in range(3000):
        data = bytearray(generator.choice(good))
        for _ in range(generator.randint(1, 6)):
            # The directory and its long values stand at the end.
            late = generator.random() < 0.7
            place = -generator.randint(1, 400) if late else generator.randrange(len(data))
            data[place] = generator.randrange(256)
        if generator.random() < 0.2:
            data = data[: generator.randrange(len(data))]
        try:
            read_plain(bytes(data), 10**6)
            seen["read"] += 1
        except (Damaged, OverflowError, struct.error, UnicodeDecodeError):
            seen["refused"] += 1
    assert min(seen.values()) > 100


@pytest.mark.parametrize(
    ("data", "kind"),
    [(b"", "syntax"), (b"II*\0", "syntax"), (b"II*\0\xff\xff\xff\x7f", "syntax"), (b"GIF89a..", "syntax")],
)
def test_rubbish_at_the_command_line_is_one_error_document(tmp_path, capsys, data, kind):
    (tmp_path / "m.tif").write_bytes(data)
    config = {
        "map": {"file": "m.tif"},
        "track": {"t": [0, 1, 2, 3], "x": [0, 1, 2, 3], "y": [0, 1, 2, 3], "h": [1, 2, 3, 4]},
        "position": {"step": [1, 1], "half_count": [1, 1]},
        "velocity": {"step": [1, 1], "half_count": [1, 1]},
    }
    (tmp_path / "c.json").write_text(json.dumps(config))
    assert run(["locate", str(tmp_path / "c.json"), "--json"]) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert error["kind"] == kind and "m.tif" in error["where"]
