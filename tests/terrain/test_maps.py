"""Map and track files: sizes before memory, no pickles, and places in messages."""

from __future__ import annotations

import io
import zipfile

import numpy as np
import pytest

from navsym.core.errors import NavsymError
from navsym.models.earth import cartesian
from navsym.terrain import maps as readers_maps
from navsym.terrain.maps import local_frame, read_map, read_track


def write_npz(path, **arrays):
    np.savez(path, **arrays)
    return path


def good(**changes):
    return {"heights": np.arange(12.0).reshape(3, 4), "x0": 1.0, "y0": 2.0, "dx": 3.0, "dy": 4.0, **changes}


def test_an_npz_map_comes_back_as_it_was_written(tmp_path):
    raster = read_map(write_npz(tmp_path / "m.npz", **good(nodata=-9999)))
    np.testing.assert_array_equal(raster.heights, good()["heights"])
    assert (raster.x0, raster.y0, raster.dx, raster.dy, raster.nodata) == (1, 2, 3, 4, -9999)
    assert not raster.geographic


def test_compressed_and_column_ordered_arrays_are_read(tmp_path):
    np.savez_compressed(tmp_path / "m.npz", **good(heights=np.asfortranarray(np.arange(6).reshape(2, 3))))
    np.testing.assert_array_equal(read_map(tmp_path / "m.npz").heights, [[0, 1, 2], [3, 4, 5]])


def kind_of(path):
    with pytest.raises(NavsymError) as caught:
        read_map(path)
    assert str(path) in caught.value.where
    return caught.value.kind


def test_a_pickle_in_an_npz_is_refused_unopened(tmp_path):
    class Bomb:
        def __reduce__(self):
            return (pytest.fail, ("the pickle was opened",))

    path = write_npz(tmp_path / "m.npz", **good(heights=np.array([Bomb()], dtype=object)))
    assert kind_of(path) == "domain"


def announced(path, header, body=b""):
    """An npz whose array announces something."""
    text = header.encode() + b" " * (117 - len(header)) + b"\n"
    npy = b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + body
    with zipfile.ZipFile(path, "w") as archive:
        for name, value in good().items():
            buffer = io.BytesIO()
            np.save(buffer, value)
            archive.writestr(f"{name}.npy", npy if name == "heights" else buffer.getvalue())
    return path


@pytest.mark.parametrize(
    ("header", "kind"),
    [
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (10000000, 10000000), }", "too-large"),
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (-1, 4), }", "too-large"),
        ("{'descr': '|O', 'fortran_order': False, 'shape': (2, 2), }", "domain"),
        ("{'descr': '<U9', 'fortran_order': False, 'shape': (2, 2), }", "domain"),
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), }", "syntax"),
        ("__import__('os').getcwd()", "syntax"),
        ("{'descr': '<f8'}", "syntax"),
    ],
)
def test_a_hostile_header_is_refused_before_memory_is_taken(tmp_path, header, kind):
    assert kind_of(announced(tmp_path / "m.npz", header)) == kind


def test_a_small_archive_that_inflates_far_is_refused_before_it_does(tmp_path, monkeypatch):
    shape = (4000, 4000)  # 128 MB each
    np.savez_compressed(tmp_path / "two.npz", **good(heights=np.zeros(shape), spare=np.zeros(shape)))
    monkeypatch.setattr(readers_maps, "MOST_INFLATED", 200_000_000)
    monkeypatch.setattr(zipfile.ZipFile, "open", lambda *_, **__: pytest.fail("a member was opened"))
    assert kind_of(tmp_path / "two.npz") == "too-large"


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_a_compression_without_a_bound_is_refused(tmp_path, method):
    """A few bytes of it may inflate to gigabytes in one step."""
    with zipfile.ZipFile(tmp_path / "m.npz", "w", method) as archive:
        for name, value in good().items():
            buffer = io.BytesIO()
            np.save(buffer, value)
            archive.writestr(f"{name}.npy", buffer.getvalue())
    assert kind_of(tmp_path / "m.npz") == "domain"


def test_damaged_and_missing_files_are_named(tmp_path):
    path = write_npz(tmp_path / "m.npz", **good())
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])
    assert kind_of(path) == "syntax"
    spoiled = bytearray(data)
    spoiled[150:180] = bytes(30)
    path.write_bytes(bytes(spoiled))
    assert kind_of(path) == "syntax"
    assert kind_of(tmp_path / "none.npz") == "missing-file"
    assert kind_of(tmp_path / "none.tif") in ("missing-file", "missing")
    (tmp_path / "m.asc").write_text("ncols 3")
    assert kind_of(tmp_path / "m.asc") == "domain"


def test_a_missing_or_doubled_array_is_named(tmp_path):
    arrays = good()
    del arrays["dy"]
    assert kind_of(write_npz(tmp_path / "m.npz", **arrays)) == "empty"
    path = write_npz(tmp_path / "n.npz", **good())
    with pytest.warns(UserWarning, match="Duplicate"), zipfile.ZipFile(path, "a") as archive:
        archive.writestr("dx.npy", b"")
    assert kind_of(path) == "duplicate"
    assert kind_of(write_npz(tmp_path / "v.npz", **good(dx=np.ones(2)))) == "shape"
    assert kind_of(write_npz(tmp_path / "w.npz", **good(dx=np.nan))) == "not-finite"


def test_an_srtm_tile_is_turned_so_that_row_zero_is_the_south(tmp_path):
    heights = np.zeros((1201, 1201), ">i2")
    heights[0, :], heights[-1, 0], heights[600, 600] = 9, 5, -32768
    path = tmp_path / "S03W072_made.hgt"
    path.write_bytes(heights.tobytes())
    raster = read_map(path)
    assert (raster.x0, raster.y0, raster.geographic, raster.nodata) == (-72.0, -3.0, True, -32768.0)
    assert raster.heights[0, 0] == 5 and (raster.heights[-1] == 9).all()
    assert raster.dx == 1 / 1200


def test_a_tile_in_the_local_frame_has_metres(tmp_path):
    raster = readers_maps.Raster(np.zeros((1201, 1201)), 10.0, 60.0, 1 / 1200, 1 / 1200, None, True)
    local = local_frame(raster)
    assert (local.x0, local.y0, local.geographic) == (0.0, 0.0, False)
    # Chords of a thousandth of a degree on the ellipsoid; a sphere would be off by two parts in a thousand.
    corner, east, north = (cartesian(*np.radians(place), 0.0) for place in ((60.5, 10), (60.5, 10.001), (60.501, 10)))
    np.testing.assert_allclose(local.dx * 1.2, np.linalg.norm(east - corner), rtol=1e-7)
    np.testing.assert_allclose(local.dy * 1.2, np.linalg.norm(north - corner), rtol=1e-6)


@pytest.mark.parametrize(
    ("name", "size", "kind"), [("tile.hgt", 2 * 1201**2, "domain"), ("N44W072.hgt", 1000, "shape")]
)
def test_a_tile_of_the_wrong_name_or_size_is_refused(tmp_path, name, size, kind):
    (tmp_path / name).write_bytes(bytes(size))
    assert kind_of(tmp_path / name) == kind


def band_of(heights, **place):
    """A band whose corner lies at (100, 50), with pixels of 2 by 3."""
    numbers = {"a": 2.0, "c": 100.0, "e": -3.0, "f": 50.0}
    return readers_maps.Band(heights, readers_maps.Transform(**(numbers | place)), -1.0, False)


def test_a_north_up_raster_is_turned_and_stands_at_the_middle_of_its_pixels():
    raster = readers_maps.upright(band_of(np.arange(6.0).reshape(2, 3)))
    assert (raster.x0, raster.y0, raster.dx, raster.dy) == (101.0, 45.5, 2.0, 3.0)
    np.testing.assert_array_equal(raster.heights, [[3, 4, 5], [0, 1, 2]])


@pytest.mark.parametrize("wrong", [{"b": 0.1}, {"e": 3.0}, {"a": -2.0}])
def test_a_turned_raster_is_refused(wrong):
    with pytest.raises(NavsymError, match="north up"):
        readers_maps.upright(band_of(np.zeros((2, 2)), **wrong))


def test_the_sample_of_matplotlib_is_read():
    matplotlib = pytest.importorskip("matplotlib")
    raster = read_map(f"{matplotlib.get_data_path()}/sample_data/jacksboro_fault_dem.npz")
    assert raster.heights.shape == (344, 403) and raster.geographic
    assert 36.4 < raster.y0 < 36.5 and raster.dy > 0


def test_a_track_is_read_by_the_names_of_its_columns(tmp_path):
    path = tmp_path / "track.csv"
    text = "# flown in May\nH, x ,y,t,note\n5,1,2,0,a\n\n6,1.5,2.5,1,b\n"
    for written in (text, text.replace(",", ";"), text.replace(",", "\t"), "\ufeff" + text.replace("\n", "\r")):
        path.write_text(written, encoding="utf-8")
        assert read_track(path) == {"t": [0, 1], "x": [1, 1.5], "y": [2, 2.5], "h": [5, 6]}


@pytest.mark.parametrize(
    ("text", "kind", "message"),
    [
        ("t,x,y\n0,1,2\n", "shape", "columns t, x, y, h"),
        ("t,x,y,h,h\n0,1,2,3,4\n", "shape", "columns t, x, y, h"),
        ("t,x,y,h\n0,1,2\n", "shape", "line 2"),
        ("t,x,y,h\n0,600,0,900,0,264,2\n", "shape", "line 2.*expected 4 cells"),
        ("t;x;y;h\n0;600,0;900,0;264,2\n", "syntax", "line 2: x: expected a number"),
        ("t,x,y,h\n0,1,2,١\n", "syntax", "line 2"),
        ("t,x,y,h\n0,1,2,1_0\n", "syntax", "line 2"),
        ("t,x,y,h\n0,1,2,nan\n", "not-finite", "line 2"),
        ("t,x,y,h\n", "empty", "below the head"),
        ("# nothing\n", "shape", "columns t, x, y, h"),
    ],
)
def test_a_wrong_track_file_is_refused_with_its_line(tmp_path, text, kind, message):
    path = tmp_path / "track.csv"
    path.write_text(text)
    with pytest.raises(NavsymError, match=message) as caught:
        read_track(path)
    assert caught.value.kind == kind
