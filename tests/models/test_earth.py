"""Ellipsoid, trihedra and rates: symbolic identities, and numbers against independent geodesy."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pyproj
import pytest
import sympy as sp
from geographiclib.geodesic import Geodesic
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from navsym.models.earth import ECCENTRICITY_SQUARED, SEMI_MAJOR, cartesian, local_axes, prime_vertical_radius
from navsym_papers.trajectory import ellipsoid

latitudes = st.floats(-np.pi / 2, np.pi / 2)
longitudes = st.floats(-np.pi, np.pi)
heights = st.floats(-5e3, 1e6)

TO_CARTESIAN = pyproj.Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)


@given(latitudes, longitudes, heights)
def test_cartesian_positions_agree_with_proj(latitude, longitude, height):
    theirs = TO_CARTESIAN.transform(np.degrees(longitude), np.degrees(latitude), height)
    assert_allclose(cartesian(latitude, longitude, height), theirs, atol=2e-8)  # metres


@given(latitudes, longitudes)
def test_local_axes_are_orthonormal_and_right_handed(latitude, longitude):
    axes = local_axes(latitude, longitude)
    assert_allclose(axes @ axes.T, np.eye(3), atol=1e-15)
    assert_allclose(np.cross(axes[0], axes[1]), axes[2], atol=1e-15)


def meridian_radius(latitude):
    """a (1 - e^2) / (1 - e^2 sin^2 phi)^(3/2), metres: change of northing per radian of latitude."""
    return prime_vertical_radius(latitude) ** 3 * ((1 - ECCENTRICITY_SQUARED) / SEMI_MAJOR**2)


@given(st.floats(-1.5, 1.5), longitudes, st.floats(0, 5e3))
def test_a_step_in_latitude_and_longitude_goes_north_and_east_by_the_two_radii(latitude, longitude, height):
    axes, d = local_axes(latitude, longitude), 1e-5
    north = cartesian(latitude + d, longitude, height) - cartesian(latitude - d, longitude, height)
    east = cartesian(latitude, longitude + d, height) - cartesian(latitude, longitude - d, height)
    assert_allclose(axes @ north / (2 * d), [0, meridian_radius(latitude) + height, 0], atol=0.01)
    parallel = (prime_vertical_radius(latitude) + height) * np.cos(latitude)
    assert_allclose(axes @ east / (2 * d), [parallel, 0, 0], atol=0.01)


def test_a_geodesic_leaves_in_the_direction_of_its_azimuth():
    for latitude, azimuth in ((35.2, 77.0), (-60.0, 200.0), (89.0, 12.0), (0.0, 90.0)):
        end = Geodesic.WGS84.Direct(latitude, 10.0, azimuth, 1.0)
        move = cartesian(np.radians(end["lat2"]), np.radians(end["lon2"]), 0.0)
        move = move - cartesian(np.radians(latitude), np.radians(10.0), 0.0)
        east, north, up = local_axes(np.radians(latitude), np.radians(10.0)) @ move
        assert_allclose([east, north], [np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))], atol=1e-6)
        assert abs(up) < 1e-6


def test_chords_of_the_geodesic_test_set_are_shorter_than_its_geodesics():
    folder = os.environ.get("NAVSYM_DATA", "")
    path = Path(folder) / "geodesy" / "GeodTest-100.dat"
    if not folder or not path.is_file():
        pytest.skip("the geodesic test set is not here: set NAVSYM_DATA to a folder with geodesy/GeodTest-100.dat")
    table = np.loadtxt(path)
    ends = [cartesian(np.radians(table[:, i]), np.radians(table[:, i + 1]), np.zeros(len(table))) for i in (0, 3)]
    chord, length = np.linalg.norm(ends[1] - ends[0], axis=1), table[:, 6]
    assert (chord <= length).all()
    # Beyond half a turn of arc the bound of a sphere of the smallest radius of curvature says little.
    near = length < 6e6
    assert (length[near] <= 2 * 6399594.0 * np.arcsin(chord[near] / (2 * 6335439.0))).all()


@given(st.floats(-1.5, 1.5), heights)
def test_geocentric_coordinates_agree_with_the_corrected_formulas_of_the_paper(latitude, height):
    from navsym.models.earth import ECCENTRICITY_SQUARED, SEMI_MAJOR

    root = np.sqrt(1 - ECCENTRICITY_SQUARED * np.sin(latitude) ** 2)
    factor = 1 - SEMI_MAJOR * ECCENTRICITY_SQUARED / (SEMI_MAJOR + height * root)
    x, _, z = cartesian(latitude, 0.0, height)
    assert_allclose(z / x, factor * np.tan(latitude), rtol=1e-12, atol=1e-15)


def test_the_rates_of_the_trihedron_turn_its_axes():
    _, symbols, velocity = ellipsoid.moving_position()
    values = dict(zip(symbols.values(), map(sp.Rational, ("0.5", "1.1", "6.4", "0.03", "-0.02", "0.7")), strict=True))
    omega = np.array(ellipsoid.angular_velocity(symbols).subs(values), dtype=float).ravel()
    r = np.array([0.0, 0.0, 6.4])
    expected = np.array(velocity.subs(values), dtype=float).ravel()
    climb = np.array([0.0, 0.0, 0.7])
    assert_allclose(np.cross(omega, r) + climb, expected, atol=1e-14)
