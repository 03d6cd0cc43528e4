"""Programs of the paper: the trajectory filter (value, rate and second rate of one coordinate), and Earth conversions.

The conversions are geodetic to geocentric position, axes of one trihedron to the other, and rates from speeds.
"""

import sympy as sp

from navsym.export.chain import Chain, Link, Program, kept, units_of
from navsym.export.parts import Layout

COVARIANCE = ("p11", "p12", "p13", "p22", "p23", "p33")
AHEAD = ("m11", "m12", "m13", "", "m22", "m23", "", "", "m33")
AFTER = ("n11", "n12", "n13", "", "n22", "n23", "", "", "n33")

#: Definite matrices only: variances between one and two, covariances below a third.
TESTS = {n: ((1.0, 2.0) if n[1] == n[2] else (-0.3, 0.3)) for n in COVARIANCE}
TESTS |= {"q1": (1e-3, 1.0), "q2": (1e-3, 1.0), "q3": (1e-3, 1.0), "R": (1e-3, 10.0)}
LAYOUT = Layout(
    arrays={"f": ("f1", "f2", "f3"), "P": COVARIANCE, "q": ("q1", "q2", "q3")},
    order=("f", "P", "q", "R", "z"),
    tests=TESTS,
    units={"f": "unit of z", "P": "(unit of z)^2", "q": "(unit of z)^2", "R": "(unit of z)^2", "z": "any, say m"},
)

FILTER = Program(
    init=kept("The first estimate (value, tau f', tau^2 f''/2) and its covariance, upper triangle", ("f", "P"), LAYOUT),
    step=Chain(
        title="Prediction over tau and correction by one measurement of the value",
        links=(
            Link(AHEAD, "trajectory:algorithm.P_ahead"),
            Link(("K1", "K2", "K3"), "trajectory:algorithm.K*"),
            Link(("g1", "g2", "g3"), "trajectory:algorithm.C*"),
            Link(AFTER, "trajectory:algorithm.P*"),
        ),
        outputs={"estimate": ("g1", "g2", "g3"), "covariance": tuple(n for n in AFTER if n)},
        layout=LAYOUT,
        box={"R": (sp.Integer(0), None)},
    ),
    fields={"f": "estimate", "P": "covariance"},
)

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

PROGRAMS: dict[str, Chain | Program] = {
    "trajectory-filter": FILTER,
    "earth-geocentric": GEOCENTRIC,
    "earth-trihedron": TRIHEDRON,
    "earth-rates": RATES,
}
