"""Earth conversions: geodetic to geocentric position, axes of one trihedron to the other, rates from speeds."""

from __future__ import annotations

import sympy as sp

from navsym.export.chain import Chain, Link, units_of
from navsym.export.parts import Layout

TANGENT, SQUARE = sp.Symbol("tan_phi", real=True), sp.Symbol("r_squared", real=True)
LENGTH = "Mm (10^6 m), or any unit in which the proved range holds"
UNITS = units_of(
    {
        LENGTH: "a h radius",
        "1": "e",
        "rad": "phi_e phi latitude",
        "Mm/s": "V radius_rate",
        "rad/s": "latitude_rate longitude_rate",
        "any": "xi",
        "that of xi": "eta",
    }
)

GEOCENTRIC = Chain(
    title="Geocentric latitude and radius from geodetic latitude and height",
    links=(
        Link(("tan_phi",), "trajectory:earth.tan_phi*"),
        Link(("phi",), "", (sp.atan(TANGENT),)),
        Link(("r_squared",), "trajectory:earth.r"),
        Link(("radius",), "", (sp.sqrt(SQUARE),)),
    ),
    outputs={"phi": "phi", "radius": "radius"},
    layout=Layout({}, ("phi_e", "h", "a", "e"), {}, UNITS),
)
TRIHEDRON = Chain(
    title="A vector on geocentric axes (East, North, Up) turned to geodetic axes",
    links=(
        Link(("eta1",), "trajectory:earth.rotation.xi1"),
        Link(("eta2",), "trajectory:earth.rotation.xi2"),
        Link(("eta3",), "trajectory:earth.rotation.xi3"),
    ),
    outputs={"eta": ("eta1", "eta2", "eta3")},
    layout=Layout({"xi": ("xi1", "xi2", "xi3")}, ("xi", "phi_e", "phi"), {}, UNITS),
)
RATES = Chain(
    title="Rates of latitude, longitude and radius from the speeds East, North, Up",
    links=(
        Link(("dphi",), "trajectory:kinematics.phi_rate"),
        Link(("dlambda",), "trajectory:kinematics.lambda_rate*"),
        Link(("dr",), "trajectory:kinematics.r_rate"),
    ),
    outputs={"latitude_rate": "dphi", "longitude_rate": "dlambda", "radius_rate": "dr"},
    layout=Layout({"V": ("V1", "V2", "V3")}, ("V", "latitude", "radius"), {}, UNITS),
)
