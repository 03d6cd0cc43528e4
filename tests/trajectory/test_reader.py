"""Tracks from files: what is read, what is refused with its line, what is repaired and listed."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import navsym as nav
from navsym.core.errors import (
    DomainError,
    DuplicateError,
    EmptyError,
    ExpressionSyntaxError,
    NavsymError,
    NotFiniteError,
    ShapeError,
)
from navsym.trajectory.reader import read_columns, read_track

GOOD = "t,lat,lon,height\n0,45.0,10.0,100\n1,45.001,10.0,101\n2,45.002,10.001,102\n"

POS = """% program   : test
%  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)
2023/07/11 06:04:30.000   35.165393934  136.881442407    39.6452   5  20   3.4239   3.9531   8.3145
2023/07/11 06:04:31.500   35.165393682  136.881442635    39.5607   5  20   3.4238   3.9532   8.3150
"""


def write(tmp_path, text, name="track.csv"):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_a_plain_table_is_read_into_radians_and_metres(tmp_path):
    track = read_track(write(tmp_path, GOOD))
    assert_allclose(track.t, [0, 1, 2])
    assert_allclose(np.degrees(track.latitude), [45.0, 45.001, 45.002], rtol=1e-14)
    assert track.lines.tolist() == [2, 3, 4]
    assert track.sigma is None and track.repairs == () and track.warnings == ()


@pytest.mark.parametrize(
    "text",
    [
        GOOD.replace("t,lat,lon,height", "Time (s),Latitude (deg),Longitude [deg],Altitude (m)"),
        GOOD.replace("t,lat,lon,height\n", ""),
        GOOD.replace(",", ";"),
        GOOD.replace(",", "\t"),
        "# a remark\n" + GOOD,
        "\n".join(f"{a},x" for a in GOOD.splitlines()),
        GOOD.replace("\n", "\r\n"),
    ],
)
def test_headers_separators_remarks_and_more_columns_change_nothing(tmp_path, text):
    assert_allclose(read_track(write(tmp_path, text)).latitude, read_track(write(tmp_path, GOOD)).latitude)


def test_rtklib_positions_bring_their_standard_deviations(tmp_path):
    track = read_track(write(tmp_path, POS, "x.pos"))
    assert_allclose(np.diff(track.t), [1.5])
    assert_allclose(track.sigma[0], [3.9531, 3.4239, 8.3145])


def test_week_and_seconds_are_the_same_instant_as_date_and_clock(tmp_path):
    week = POS.replace("2023/07/11 06:04:30.000", "2270 194670.000").replace("2023/07/11 06:04:31.500", "2270 194671.5")
    assert_allclose(read_track(write(tmp_path, week, "w.pos")).t, read_track(write(tmp_path, POS, "d.pos")).t)


BAD = [
    ("", EmptyError, "empty file", None),
    ("t,lat,lon,height\n", EmptyError, "got none", None),
    ("a,b,c\n1,2,3\n", ShapeError, "column t", "line 1"),
    ("t,t,lat,lon,height\n0,0,1,1,1\n", DuplicateError, "one column for t", "line 1"),
    (GOOD + "3,nan,10,100\n", NotFiniteError, "latitude", "line 5"),
    (GOOD + "3,95,10,100\n", DomainError, "within 90", "line 5"),
    (GOOD + "3,45,400,100\n", DomainError, "longitude", "line 5"),
    (GOOD + "2,45,10,100\n", DuplicateError, "later time", "line 5"),
    (GOOD + "1,45,10,100\n", DomainError, "later time", "line 5"),
    (GOOD + "3,45\n", ShapeError, "expected 4 fields", "line 5"),
    (GOOD + "3,0x2d,10,100\n", ExpressionSyntaxError, "latitude: expected a number", "line 5"),
    (GOOD + "3,__import__('os'),10,100\n", ExpressionSyntaxError, "expected a number", "line 5"),
    ("t;lat;lon;height\n0;45,5;10,5;100,0\n", ExpressionSyntaxError, "decimal point", "line 2"),
    ("t,lat,lon,height (cubits)\n0,45,10,100\n", DomainError, "column h in a unit of length .m, dm.*feet", "line 1"),
    ("t (lightyear),lat,lon,height\n0,45,10,100\n", DomainError, "column t in a unit of time .s, ms", "line 1"),
    ("t (m),lat,lon,height\n0,45,10,100\n", DomainError, "column t in a unit of time", "line 1"),
    ("t,lat (deg) (rad),lon,height\n0,45,10,100\n", DomainError, "column lat in a unit of angle", "line 1"),
    ("t,lat (),lon,height\n0,45,10,100\n", DomainError, "column lat in a unit of angle", "line 1"),
    ("t,lat,lon (dms),height\n0,45,10,100\n", DomainError, "column lon in a unit of angle", "line 1"),
    ("t,lat (0 deg),lon,height\n0,45,10,100\n", DomainError, "column lat in a unit of angle", "line 1"),
    ("t (h),lat,lon,height\n1e307,45,10,100\n", NotFiniteError, "time: expected a finite", "line 2"),
    (GOOD.replace("lat", "lat (rad)"), DomainError, "within 90 degrees; got 2578", "line 2"),
    (GOOD.encode() + b"# caf\xe9\n", ExpressionSyntaxError, "0xe9", "line 5"),
    (GOOD.encode("utf-16"), ExpressionSyntaxError, "UTF-16", None),
    ("% x-ecef(m)\n2270 1.0 1 2 3 1 9\n", DomainError, "llh", None),
    ("%  GPST  e-baseline(m)  n-baseline(m)  u-baseline(m) Q\n2270 1.0 10.5 22.9 0.1 1 9\n", DomainError, "llh", None),
    (
        "%  GPST  latitude(d'\")  longitude(d'\") height(m)  Q\n2270 1.0 55 45 00.0 37 36 36.0 150.0 1 9\n",
        DomainError,
        "minutes and seconds",
        None,
    ),
    (POS.replace("   5  20", "   0  20"), DomainError, "got 0, which is none", "line 3"),
    (POS.replace("3.4239", "nan"), NotFiniteError, "sdn, sde, sdu", "line 3"),
]


@pytest.mark.parametrize("text, kind, message, line", BAD)
def test_strict_reading_names_the_line_of_what_is_wrong(tmp_path, text, kind, message, line):
    with pytest.raises(kind, match=message) as caught:
        read_track(write(tmp_path, text))
    assert line is None or line in str(caught.value)
    assert "expected" in caught.value.message and "got" in caught.value.message


def test_a_decimal_comma_between_commas_is_not_taken_for_a_column(tmp_path):
    with pytest.raises(ShapeError, match="expected 4 fields; got 5"):
        read_track(write(tmp_path, GOOD + "3,45,0,10.0,103\n"))


@given(st.binary(max_size=300), st.sampled_from(["strict", "repair"]))
def test_any_bytes_are_read_or_refused_with_an_error_of_ours(tmp_path_factory, data, policy):
    path = tmp_path_factory.mktemp("any") / "x.csv"
    for content in (data, GOOD.encode() + data, b"% x\n" + data):
        path.write_bytes(content)
        try:
            track = read_track(path, policy)
        except NavsymError:
            continue
        assert (np.diff(track.t) > 0).all() and np.isfinite(track.latitude).all()


def test_the_first_problem_counts_the_others(tmp_path):
    with pytest.raises(NavsymError, match=r"2 more rows have problems \(lines 6, 7\)"):
        read_track(write(tmp_path, GOOD + "3,nan,10,1\n4,91,10,1\n1,45,10,1\n"))


def test_repair_lists_what_it_leaves_out_and_mends(tmp_path):
    text = "t;lat;lon;height\n0;45,5;10;100\n1;45.6;10;100\n1;45.6;10;100\n2;nan;10;100\n3;45.7;10;100\n"
    track = read_track(write(tmp_path, text), "repair")
    assert track.t.tolist() == [0, 1, 3]
    assert [r.split(":")[0] for r in track.repairs] == ["line 2", "line 5", "line 4"]
    assert_allclose(np.degrees(track.latitude[0]), 45.5)


def test_repair_reads_latin_1_and_says_so(tmp_path):
    track = read_track(write(tmp_path, GOOD.encode() + b"# caf\xe9\n"), "repair")
    assert len(track.t) == 3 and len(track.repairs) == 1


def test_a_byte_order_mark_is_no_part_of_the_head_of_a_column(tmp_path):
    """Spreadsheets write one; a second one is a name that no column has."""
    track = read_track(write(tmp_path, b"\xef\xbb\xbf" + GOOD.encode()))
    assert len(track.t) == 3 and not track.repairs
    with pytest.raises(ShapeError, match="expected a column t"):
        read_track(write(tmp_path, 2 * b"\xef\xbb\xbf" + GOOD.encode()))


#: Column, head, and how much one of its unit is in seconds, degrees, radians or metres.
UNITS = [
    ("t", "t (ms)", "1/1000"),
    ("t", "Time [us]", "1/1000000"),
    ("t", "timestamp (ns since 1970-01-01)", "1/1000000000"),
    ("t", "t (\u00b5s)", "1/1000000"),
    ("t", "t (min)", "60"),
    ("t", "t (h)", "3600"),
    ("t", "t (0.1 s)", "1/10"),
    ("t", "time (UTC)", "1"),
    ("h", "height (km)", "1000"),
    ("h", "alt (ft)", "0.3048"),
    ("h", "altitude [Feet MSL]", "0.3048"),
    ("h", "height (US survey feet)", "1200/3937"),
    ("h", "height (us-ft)", "1200/3937"),
    ("h", "Height (ellipsoidal) [mm]", "1/1000"),
    ("lat", "lat (1e-7 deg)", "1/10000000"),
    ("lat", "lat (degE7)", "1/10000000"),
    ("lat", "lat (10^-7 deg)", "1/10000000"),
    ("lat", "Latitude (degrees_north)", "1"),
    ("lat", "lat (arcsec)", "1/3600"),
    ("lat", "lat (gon)", "9/10"),
]


@pytest.mark.parametrize(("column", "head", "factor"), UNITS)
def test_the_unit_in_the_head_of_a_column_converts_exactly(tmp_path, column, head, factor):
    texts = ["1.7", "2.3", "3.1", "64.000001", "65.1"]
    heads = {"t": "t", "lat": "lat", "lon": "lon", "h": "h"} | {column: head}
    rows = [{"t": str(k), "lat": "0", "lon": "0", "h": "0"} | {column: text} for k, text in enumerate(texts)]
    table = "\n".join([",".join(heads.values()), *(",".join(row.values()) for row in rows)])
    expected = [float(Fraction(text) * Fraction(factor)) for text in texts]
    expected = [math.radians(value) for value in expected] if column == "lat" else expected
    columns = {heads[name]: [float(row[name]) for row in rows] for name in heads}
    for track in (read_track(write(tmp_path, table)), read_columns(columns)):
        found = {"t": track.t, "lat": track.latitude, "h": track.height}[column]
        assert found.tolist() == expected
        assert bool(track.repairs) == (Fraction(factor) != 1)


@pytest.mark.parametrize(("unit", "factor"), [("rad", "1"), ("mrad", "1/1000"), ("\u00b5rad", "1/1000000")])
def test_radians_are_not_turned_twice(tmp_path, unit, factor):
    text = f"t,lat ({unit}),lon ({unit}),h\n0,0.7,0.1,5\n1,0.7000001,0.1,5\n"
    track = read_track(write(tmp_path, text))
    assert track.latitude.tolist() == [float(Fraction(x) * Fraction(factor)) for x in ("0.7", "0.7000001")]
    assert track.warnings == ()


def test_a_track_in_other_units_has_the_same_velocity(tmp_path):
    rows = np.genfromtxt("examples/drive.csv", delimiter=",", skip_header=1)
    scale = np.array([1000.0, 1e7, math.radians(1.0), 3937 / 1200])
    heads = "t (ms),lat (1e-7 deg),lon (rad),height (US survey feet)"
    lines = "\n".join(",".join(f"{x!r}" for x in row) for row in (rows * scale).tolist())
    expected, found = nav.track("examples/drive.csv"), nav.track(write(tmp_path, f"{heads}\n{lines}\n"))
    assert_allclose(found.velocity, expected.velocity, atol=1e-6)
    assert_allclose(found.acceleration, expected.acceleration, atol=1e-6)
    assert [line.split(" from ")[1].split(",")[0] for line in found.repairs] == [
        "ms",
        "1e-7 deg",
        "rad",
        "US survey feet",
    ]


def test_repair_names_the_feet_that_it_converts(tmp_path):
    track = read_track(write(tmp_path, "t,lat,lon,alt (ft)\n0,45,10,1000\n1,45,10,1000\n"), "repair")
    assert_allclose(track.height, 304.8)
    assert "feet" in track.repairs[0]


def test_heights_of_an_airliner_at_the_speed_of_a_ship_are_doubted(tmp_path):
    track = read_track(
        write(
            tmp_path,
            GOOD.replace(",100\n", ",30000\n")
            .replace("45.001", "45.00001")
            .replace("45.002", "45.00002")
            .replace("10.001", "10.0"),
        )
    )
    assert any("feet" in w for w in track.warnings)


def test_steps_of_many_minutes_are_asked_for_their_unit_and_milliseconds_in_the_head_are_not(tmp_path):
    rows = "".join(f"{1000 * k},45,10,100\n" for k in range(5))
    assert any("1000 s: are the times in milliseconds" in w for w in read_track(write(tmp_path, rows)).warnings)
    assert read_track(write(tmp_path, "t (ms),lat,lon,height\n" + rows)).warnings == ()


def test_an_unknown_policy_is_refused(tmp_path):
    with pytest.raises(DomainError, match="policy"):
        read_track(write(tmp_path, GOOD), "guess")


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(NavsymError, match="readable file"):
        read_track(tmp_path / "no.csv")


def test_a_row_with_several_bad_fields_is_named_once(tmp_path):
    rows = "".join(f"{k},x,y,z\n" for k in range(3, 6))
    with pytest.raises(NavsymError, match=r"; 2 more rows have problems \(lines 6, 7\)"):
        read_track(write(tmp_path, GOOD + rows))


@pytest.mark.parametrize("clock", ["UTC", "JST"])
def test_a_clock_that_is_not_that_of_gps_is_named(tmp_path, clock):
    (tmp_path / "x.pos").write_text(POS.replace("GPST", clock + " "), encoding="utf-8")
    track = read_track(tmp_path / "x.pos")
    assert any(clock in warning for warning in track.warnings)
    (tmp_path / "x.pos").write_text(POS, encoding="utf-8")
    assert read_track(tmp_path / "x.pos").warnings == ()


def test_repair_keeps_a_place_whose_deviations_are_not_numbers(tmp_path):
    track = read_track(write(tmp_path, POS.replace("3.4239", "nan")), "repair")
    assert track.t.size == 2 and track.sigma is None
    assert any("standard deviations not used" in repair for repair in track.repairs)


def test_deviations_in_a_csv_are_not_passed_over_in_silence(tmp_path):
    """They are read from RTKLIB files only; whoever writes them into a CSV hears of it."""
    rows = "".join(f"{k},{45 + 1e-4 * k},10,100,5,5,5\n" for k in range(8))
    (warning,) = read_track(write(tmp_path, "t,lat,lon,height,sdn (m),sde (m),sdu (m)\n" + rows)).warnings
    assert warning.startswith("line 1: sdn, sde, sdu not read: give one deviation as sigma")
