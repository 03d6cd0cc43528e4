"""Error models as they are published, typed from their sources, as conventions files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Grid = list[list[str]]

C: Grid = [[f"c{i}{j}" for j in (1, 2, 3)] for i in (1, 2, 3)]
E: Grid = [["1" if i == j else "0" for j in range(3)] for i in range(3)]
O: Grid = [["0"] * 3 for _ in range(3)]

SHORT = {"p": "position", "v": "velocity", "a": "attitude", "g": "gyro_bias", "b": "accelerometer_bias"}
SCALES = {"k": "gyro_scale", "s": "accelerometer_scale"}


def diag(u: list[str]) -> Grid:
    """A diagonal matrix."""
    return [[u[i] if i == j else "0" for j in range(3)] for i in range(3)]


def neg(A: Grid) -> Grid:
    """-A."""
    return [[x if x == "0" else f"-({x})" for x in row] for row in A]


def scale(factor: str, A: Grid) -> Grid:
    """A factor times a matrix."""
    return [[x if x == "0" else f"({factor})*({x})" for x in row] for row in A]


def skew(u: list[str]) -> Grid:
    """The matrix of u x."""
    x, y, z = u
    return [["0", f"-({z})", y], [z, "0", f"-({x})"], [f"-({y})", x, "0"]]


def mul(A: Grid, B: Grid) -> Grid:
    """A B."""
    return [[" + ".join(f"({A[i][k]})*({B[k][j]})" for k in range(3)) for j in range(3)] for i in range(3)]


def transpose(A: Grid) -> Grid:
    """A'."""
    return [list(row) for row in zip(*A, strict=True)]


def document(
    order: str,
    blocks: Mapping[str, Grid],
    quantities: Mapping[str, Any],
    known: Mapping[str, str] | None = None,
    **declared: Any,
) -> dict[str, Any]:
    """A conventions file: ``order`` lists the roles by letters, ``blocks["va"]`` is velocity by attitude."""
    states = {role: [f"x_{role}{k}" for k in range(3)] for role in order}
    F = [["0"] * (3 * len(order)) for _ in range(3 * len(order))]
    for key, block in blocks.items():
        row, column = order.index(key[0]), order.index(key[1])
        for i in range(3):
            for j in range(3):
                F[3 * row + i][3 * column + j] = block[i][j]
    names = {n for cells in quantities.values() for n in names_of(cells)}
    parameters = {name: "real" for name in sorted(names)} | declared
    return {
        "model": {"states": [name for role in order for name in states[role]], "F": F},
        "parameters": parameters,
        "roles": {(SHORT | SCALES)[role]: states[role] for role in order},
        "quantities": dict(quantities),
        "known": dict(known or {}),
    }


def names_of(cells: Any) -> list[str]:
    """Bare names of a quantity."""
    if isinstance(cells, list):
        return [name for cell in cells for name in names_of(cell)]
    return [cells] if cells.isidentifier() else []


F_N, F_B, W_B = (["f1", "f2", "f3"], ["a1", "a2", "a3"], ["w1", "w2", "w3"])
NED = {
    "specific_force": F_N,
    "rotation": C,
    "latitude": "L",
    "height": "h",
    "velocity": ["vN", "vE", "vD"],
    "earth_rate": "W",
    "gravity": "g",
    "radii": ["RN", "RE"],
}
POSITIVE = {
    "RN": ["6", "7"],
    "RE": ["7", "8"],
    "R": ["6", "7"],
    "h": ["0", "1"],
    "L": ["-1", "1"],
    "g": "positive",
    "W": "positive",
}


def declared(quantities: Mapping[str, Any]) -> dict[str, Any]:
    """Declarations of the names that have a range."""
    names = {n for cells in quantities.values() for n in names_of(cells)}
    return {name: value for name, value in POSITIVE.items() if name in names}


def kf_gins(scaled: bool = False) -> dict[str, Any]:
    """Wuhan University, KF-GINS: phi angle, north-east-down, position error in metres, constant biases.

    scaled : with its scale factors, which decay as its biases do; all 21 states
    """
    m, n = "(RN + h)", "(RE + h)"
    pp = [[f"-vD/{m}", "0", f"vN/{m}"], [f"vE*tan(L)/{n}", f"-(vD + vN*tan(L))/{n}", f"vE/{n}"], ["0", "0", "0"]]
    vp = [
        [f"-2*vE*W*cos(L)/{m} - vE**2/({m}*{n}*cos(L)**2)", "0", f"vN*vD/{m}**2 - vE**2*tan(L)/{n}**2"],
        [f"2*W*(vN*cos(L) - vD*sin(L))/{m} + vN*vE/({m}*{n}*cos(L)**2)", "0", f"(vE*vD + vN*vE*tan(L))/{n}**2"],
        [f"2*W*vE*sin(L)/{m}", "0", f"-vE**2/{n}**2 - vN**2/{m}**2 + 2*g/(sqrt(RN*RE) + h)"],
    ]
    vv = [
        [f"vD/{m}", f"-2*(W*sin(L) + vE*tan(L)/{n})", f"vN/{m}"],
        [f"2*W*sin(L) + vE*tan(L)/{n}", f"(vD + vN*tan(L))/{n}", f"2*W*cos(L) + vE/{n}"],
        [f"-2*vN/{m}", f"-2*(W*cos(L) + vE/{n})", "0"],
    ]
    ap = [
        [f"-W*sin(L)/{m}", "0", f"vE/{n}**2"],
        ["0", "0", f"-vN/{m}**2"],
        [f"-W*cos(L)/{m} - vE/({m}*{n}*cos(L)**2)", "0", f"-vE*tan(L)/{n}**2"],
    ]
    av = [["0", f"1/{n}", "0"], [f"-1/{m}", "0", "0"], ["0", f"-tan(L)/{n}", "0"]]
    aa = neg(skew(local_rate(m, n)))
    blocks = {
        "pp": pp,
        "pv": E,
        "vp": vp,
        "vv": vv,
        "va": skew(F_N),
        "vb": C,
        "ap": ap,
        "av": av,
        "aa": aa,
        "ag": neg(C),
    }
    if scaled:
        decays = {key: diag(["-1/T"] * 3) for key in ("gg", "bb", "kk", "ss")}
        blocks |= decays | {"ak": neg(mul(C, diag(W_B))), "vs": mul(C, diag(F_B))}
        quantities = NED | {"specific_force_body": F_B, "angular_rate": W_B}
        return document("pvagbks", blocks, quantities, T="positive", **declared(quantities))
    return document("pvagb", blocks, NED, **declared(NED))


def local_rate(m: str, n: str) -> list[str]:
    """Rate of the north-east-down level beside inertial space."""
    return [f"W*cos(L) + vE/{n}", f"-vN/{m}", f"-W*sin(L) - vE*tan(L)/{n}"]


def groves_ned() -> dict[str, Any]:
    """Groves, 2nd edition, (14.63)-(14.71): local navigation frame, geodetic position, geocentric radius of gravity."""
    m, n = "(RN + h)", "(RE + h)"
    quantities = {**NED, "radii": ["RN", "RE", "rS"]}
    aa = neg(skew(local_rate(m, n)))
    av = [["0", f"-1/{n}", "0"], [f"1/{m}", "0", "0"], ["0", f"tan(L)/{n}", "0"]]
    ap = [
        ["W*sin(L)", "0", f"vE/{n}**2"],
        ["0", "0", f"-vN/{m}**2"],
        [f"W*cos(L) + vE/({n}*cos(L)**2)", "0", f"-vE*tan(L)/{n}**2"],
    ]
    vv = [
        [f"vD/{m}", f"-2*vE*tan(L)/{n} - 2*W*sin(L)", f"vN/{m}"],
        [f"vE*tan(L)/{n} + 2*W*sin(L)", f"(vN*tan(L) + vD)/{n}", f"vE/{n} + 2*W*cos(L)"],
        [f"-2*vN/{m}", f"-2*vE/{n} - 2*W*cos(L)", "0"],
    ]
    vp = [
        [f"-vE**2/({n}*cos(L)**2) - 2*vE*W*cos(L)", "0", f"vE**2*tan(L)/{n}**2 - vN*vD/{m}**2"],
        [f"vN*vE/({n}*cos(L)**2) + 2*vN*W*cos(L) - 2*vD*W*sin(L)", "0", f"-(vN*vE*tan(L) + vE*vD)/{n}**2"],
        ["2*vE*W*sin(L)", "0", f"vE**2/{n}**2 + vN**2/{m}**2 - 2*g/rS"],
    ]
    pv = [[f"1/{m}", "0", "0"], ["0", f"1/({n}*cos(L))", "0"], ["0", "0", "-1"]]
    pp = [["0", "0", f"-vN/{m}**2"], [f"vE*sin(L)/({n}*cos(L)**2)", "0", f"-vE/({n}**2*cos(L))"], ["0", "0", "0"]]
    blocks = {
        "aa": aa, "av": av, "ap": ap, "ag": C, "va": neg(skew(F_N)), "vv": vv, "vp": vp, "vb": C, "pv": pv, "pp": pp,
    }  # fmt: skip
    return document("avpbg", blocks, quantities, rS="positive", **declared(NED))


def groves_inertial() -> dict[str, Any]:
    """Groves, 2nd edition, (14.30)-(14.35): Earth-centred inertial frame."""
    quantities = {
        "specific_force": F_N,
        "rotation": C,
        "position": ["r1", "r2", "r3"],
        "gravity": ["g1", "g2", "g3"],
        "radii": ["rS"],
    }
    norm = "sqrt(r1**2 + r2**2 + r3**2)"
    vp = [[f"-2*g{i}*r{j}/(rS*{norm})" for j in (1, 2, 3)] for i in (1, 2, 3)]
    blocks = {"ag": C, "va": neg(skew(F_N)), "vp": vp, "vb": C, "pv": E}
    return document("avpbg", blocks, quantities, {"frame": "inertial"}, rS="positive")


def groves_earth() -> dict[str, Any]:
    """Groves, 2nd edition, (14.46)-(14.50): Earth-centred Earth-fixed frame."""
    file = groves_inertial()
    quantities = {**file["quantities"], "earth_rate": "W"}
    spin = skew(["0", "0", "W"])
    norm = "sqrt(r1**2 + r2**2 + r3**2)"
    vp = [[f"-2*g{i}*r{j}/(rS*{norm})" for j in (1, 2, 3)] for i in (1, 2, 3)]
    blocks = {"aa": neg(spin), "ag": C, "va": neg(skew(F_N)), "vv": scale("-2", spin), "vp": vp, "vb": C, "pv": E}
    return document("avpbg", blocks, quantities, rS="positive", W="positive")


def sola_local() -> dict[str, Any]:
    """Sola, Quaternion kinematics for the error-state Kalman filter, section 5.3: angular error in the body."""
    quantities = {"specific_force_body": F_B, "angular_rate": W_B, "rotation": C}
    blocks = {"pv": E, "va": neg(mul(C, skew(F_B))), "vb": neg(C), "aa": neg(skew(W_B)), "ag": neg(E)}
    return document("pvabg", blocks, quantities, {"frame": "inertial"})


def sola_global() -> dict[str, Any]:
    """Sola, section 7: angular error in the global frame."""
    quantities = {"specific_force_body": F_B, "angular_rate": W_B, "rotation": C}
    turned = [" + ".join(f"{C[i][k]}*{F_B[k]}" for k in range(3)) for i in range(3)]
    blocks = {"pv": E, "va": neg(skew(turned)), "vb": neg(C), "ag": neg(C)}
    return document("pvabg", blocks, quantities, {"frame": "inertial"})


def psi_level() -> dict[str, Any]:
    """The psi-angle model in the computer frame (Benson 1975; Goshen-Meskin and Bar-Itzhack 1992)."""
    quantities = {
        "specific_force": F_N, "rotation": C, "earth_rate": ["e1", "e2", "e3"], "transport_rate": ["t1", "t2", "t3"],
        "gravity": "g", "radii": ["R"], "latitude": "L", "velocity": ["vN", "vE", "vD"],
    }  # fmt: skip
    both = ["e1 + t1", "e2 + t2", "e3 + t3"]
    blocks = {
        "pp": neg(skew(["t1", "t2", "t3"])), "pv": E, "va": skew(F_N), "vb": C, "aa": neg(skew(both)), "ag": neg(C),
        "vv": neg(skew(["2*e1 + t1", "2*e2 + t2", "2*e3 + t3"])),
        "vp": [["-g/R", "0", "0"], ["0", "-g/R", "0"], ["0", "0", "2*g/R"]],
    }  # fmt: skip
    return document("pvagb", blocks, quantities, **declared(quantities))


def savage() -> dict[str, Any]:
    """Savage, psi form in his wander azimuth frame with its third axis up: the level does not turn about it."""
    turn = ["t1", "t2", "0"]
    quantities = {
        "specific_force": F_N, "rotation": C, "earth_rate": ["e1", "e2", "e3"], "transport_rate": turn, "gravity": "g",
        "radii": ["R"], "latitude": "L", "velocity": ["v1", "v2", "v3"], "wander_angle": "alpha",
    }  # fmt: skip
    both, twice = ["e1 + t1", "e2 + t2", "e3"], ["2*e1 + t1", "2*e2 + t2", "2*e3"]
    blocks = {
        "aa": neg(skew(both)), "ag": neg(C), "va": skew(F_N), "vb": C, "vv": neg(skew(twice)), "pv": E,
        "pp": neg(skew(turn)), "vp": [["-g/R", "0", "0"], ["0", "-g/R", "0"], ["0", "0", "2*g/R"]],
    }  # fmt: skip
    known = {"frame": "local-level", "axes": "ENU"}
    return document("avpgb", blocks, quantities, known, **declared(quantities))


def farrell() -> dict[str, Any]:
    """Farrell and Barth 1999, tables 6.1 and 6.2: geodetic position, one radius, the turn of the navigation axes."""
    quantities = {**NED, "radii": ["R"]}
    quantities.pop("height")
    rho, earth, k = ["vE/R", "-vN/R", "-vE*tan(L)/R"], ["W*cos(L)", "0", "-W*sin(L)"], "vD/R"
    (n, e, d), (N, _, D) = rho, earth
    whole = [f"{x} + {y}" for x, y in zip(earth, rho, strict=True)]
    twice = [f"({x}) + ({y})" for x, y in zip(whole, earth, strict=True)]
    secant = f"({n})/cos(L)**2"
    blocks = {
        "pp": [["0", "0", f"({e})/R"], [f"-({d})/cos(L)", "0", f"-({n})/(R*cos(L))"], ["0", "0", "0"]],
        "pv": [["1/R", "0", "0"], ["0", "1/(R*cos(L))", "0"], ["0", "0", "-1"]],
        "vp": [
            [f"-2*{N}*vE - {secant}*vE", "0", f"({e})*{k} - ({n})*({d})"],
            [f"2*({N}*vN + ({D})*vD) + {secant}*vN", "0", f"-({e})*({d}) - {k}*({n})"],
            [f"-2*vE*({D})", "0", f"({n})**2 + ({e})**2 - 2*g/R"],
        ],
        "vv": [
            [k, f"2*({whole[2]})", f"-({e})"],
            [f"-({twice[2]})", f"{k} - ({e})*tan(L)", twice[0]],
            [f"2*({e})", f"-2*({whole[0]})", "0"],
        ],
        "va": neg(skew(F_N)),
        "ap": [[f"-({D})", "0", f"({n})/R"], ["0", "0", f"({e})/R"], [f"{N} + {secant}", "0", f"({d})/R"]],
        "av": [["0", "-1/R", "0"], ["1/R", "0", "0"], ["0", "tan(L)/R", "0"]],
        "aa": neg(skew(whole)),
    }  # fmt: skip
    return document("pva", blocks, quantities, **declared(quantities))


def right_invariant() -> dict[str, Any]:
    """Barrau and Bonnabel; Hartley et al. 2020: right-invariant error with biases, world frame."""
    quantities = {
        "specific_force_body": F_B, "angular_rate": W_B, "rotation": C, "velocity": ["v1", "v2", "v3"],
        "position": ["r1", "r2", "r3"], "gravity": ["g1", "g2", "g3"],
    }  # fmt: skip
    blocks = {
        "va": skew(["g1", "g2", "g3"]), "pv": E, "ag": neg(C), "vg": neg(mul(skew(["v1", "v2", "v3"]), C)),
        "vb": neg(C),
        "pg": neg(mul(skew(["r1", "r2", "r3"]), C)),
    }  # fmt: skip
    return document("avpgb", blocks, quantities, {"frame": "inertial"})


def pronto() -> dict[str, Any]:
    """Pronto, rbis.cpp: velocity in the body; a correction is added, or multiplied to the quaternion from the right."""
    u, g = ["u1", "u2", "u3"], ["g1", "g2", "g3"]
    quantities = {"specific_force_body": F_B, "angular_rate": W_B, "rotation": C, "velocity_body": u, "gravity": g}
    seen = [" + ".join(f"{C[k][i]}*{g[k]}" for k in range(3)) for i in range(3)]
    spin = neg(skew(W_B))
    blocks = {
        "vv": spin, "va": skew(seen), "aa": spin, "pv": C, "pa": neg(mul(C, skew(u))), "vg": neg(skew(u)),
        "vb": neg(E), "ag": neg(E),
    }  # fmt: skip
    return document("vapgb", blocks, quantities, {"frame": "inertial", "error": "truth - estimate"})


def minnesota() -> dict[str, Any]:
    """University of Minnesota, EKF_15state_quat.cxx: half angles; gravity decreases on the way down."""
    quantities = {"specific_force_body": F_B, "angular_rate": W_B, "rotation": C, "gravity": "g", "radii": ["R"]}
    blocks = {
        "pv": E, "vp": [["0"] * 3, ["0"] * 3, ["0", "0", "-2*g/R"]], "va": scale("-2", mul(C, skew(F_B))),
        "vb": neg(C), "aa": neg(skew(W_B)), "ag": scale("-1/2", E), "bb": diag(["-1/T"] * 3), "gg": diag(["-1/T"] * 3),
    }  # fmt: skip
    known = {"frame": "local-level", "axes": "NED", "error": "truth - estimate"}
    return document("pvabg", blocks, quantities, known, T="positive", **declared(quantities))


def left_invariant() -> dict[str, Any]:
    """Barrau and Bonnabel; Hartley et al. 2020: left-invariant error with biases."""
    quantities = {"specific_force_body": F_B, "angular_rate": W_B, "rotation": C}
    turn = neg(skew(W_B))
    blocks = {"aa": turn, "va": neg(skew(F_B)), "vv": turn, "pv": E, "pp": turn, "ag": neg(E), "vb": neg(E)}
    return document("avpgb", blocks, quantities, {"frame": "inertial"})


def msckf() -> dict[str, Any]:
    """Mourikis and Roumeliotis 2007, error state truth minus estimate."""
    return {**sola_local(), "known": {"frame": "inertial", "error": "truth - estimate"}}


def psins() -> dict[str, Any]:
    """Yan, PSINS toolbox, etm: phi angle in east-north-up, geodetic position, no gradient of gravity."""
    m, n = "(RN + h)", "(RE + h)"
    quantities = {**NED, "velocity": ["vE", "vN", "vU"]}
    earth, turn = ["0", "W*cos(L)", "W*sin(L)"], [f"-vN/{m}", f"vE/{n}", f"vE*tan(L)/{n}"]
    both = [f"{x} + {y}" for x, y in zip(earth, turn, strict=True)]
    twice = [f"2*({x}) + {y}" for x, y in zip(earth, turn, strict=True)]
    m1 = [["0", "0", "0"], ["-W*sin(L)", "0", "0"], ["W*cos(L)", "0", "0"]]
    m2 = [["0", "0", f"vN/{m}**2"], ["0", "0", f"-vE/{n}**2"], [f"vE/({n}*cos(L)**2)", "0", f"-vE*tan(L)/{n}**2"]]
    av = [["0", f"-1/{m}", "0"], [f"1/{n}", "0", "0"], [f"tan(L)/{n}", "0", "0"]]
    v = skew(["vE", "vN", "vU"])
    vv = plus(mul(v, av), neg(skew(twice)))
    pp = [["0", "0", f"-vN/{m}**2"], [f"vE*tan(L)/({n}*cos(L))", "0", f"-vE/(cos(L)*{n}**2)"], ["0", "0", "0"]]
    blocks = {
        "aa": neg(skew(both)), "av": av, "ap": plus(m1, m2), "ag": neg(C), "va": skew(F_N), "vv": vv,
        "vp": mul(v, plus(plus(m1, m1), m2)), "vb": C,
        "pv": [["0", f"1/{m}", "0"], [f"1/({n}*cos(L))", "0", "0"], ["0", "0", "1"]], "pp": pp,
    }  # fmt: skip
    return document("avpgb", blocks, quantities, **declared(quantities))


def plus(A: Grid, B: Grid) -> Grid:
    """A + B."""
    return [[f"({x}) + ({y})" for x, y in zip(*rows, strict=True)] for rows in zip(A, B, strict=True)]


def navego() -> dict[str, Any]:
    """NaveGo, F_update as found in a public copy: one radius R, both bias blocks +C beside + f x."""
    quantities = {**NED, "radii": ["R", "R", "rS"]}
    quantities.pop("height")
    aa = neg(skew(local_rate("R", "R")))
    av = [["0", "1/R", "0"], ["-1/R", "0", "0"], ["0", "-tan(L)/R", "0"]]
    ap = [
        ["-W*sin(L)", "0", "-vE/R**2"],
        ["0", "0", "vN/R**2"],
        ["-W*cos(L) - vE/(R*cos(L)**2)", "0", "vE*tan(L)/R**2"],
    ]
    vv = [
        ["vD/R", "-2*(W*sin(L) + vE*tan(L)/R)", "vN/R"],
        ["2*W*sin(L) + vE*tan(L)/R", "(vN*tan(L) + vD)/R", "2*W*cos(L) + vE/R"],
        ["-2*vN/R", "-2*(W*cos(L) + vE/R)", "0"],
    ]
    vp = [
        ["-vE*(2*W*cos(L) + vE/(R*cos(L)**2))", "0", "(vE**2*tan(L) - vN*vD)/R**2"],
        ["2*W*(vN*cos(L) - vD*sin(L)) + vN*vE/(R*cos(L)**2)", "0", "-vE*(vN*tan(L) + vD)/R**2"],
        ["2*W*vE*sin(L)", "0", "vE**2/R**2 + vN**2/R**2 - 2*g/rS"],
    ]
    pv = [["1/R", "0", "0"], ["0", "1/(R*cos(L))", "0"], ["0", "0", "-1"]]
    pp = [["0", "0", "-vN/R**2"], ["vE*tan(L)/(R*cos(L))", "0", "-vE/(R**2*cos(L))"], ["0", "0", "0"]]
    blocks = {
        "aa": aa, "av": av, "ap": ap, "ag": C, "va": skew(F_N), "vv": vv, "vp": vp, "vb": C, "pv": pv, "pp": pp,
    }  # fmt: skip
    return document("avpgb", blocks, quantities, rS="positive", **declared(quantities))


def inertial_model(order: str, blocks: Mapping[str, Grid], known: Mapping[str, str] | None = None) -> dict[str, Any]:
    """A model of a flat world with the quantities of a visual-inertial filter."""
    quantities = {"specific_force_body": F_B, "angular_rate": W_B, "rotation": C}
    return document(order, blocks, quantities, {"frame": "inertial", **(known or {})})


LOCAL = {"pv": E, "va": neg(mul(C, skew(F_B))), "vb": neg(C), "aa": neg(skew(W_B)), "ag": neg(E)}


def msckf_vio() -> dict[str, Any]:
    """KumarRobotics/msckf_vio 050c50d, src/msckf_vio.cpp, processModel: JPL quaternion from the world to the body."""
    return inertial_model("agvbp", LOCAL, {"error": "truth - estimate"})


def imu_gps_localization() -> dict[str, Any]:
    """ydsf16/imu_gps_localization 432bc0c, imu_processor.cpp: the rate of its transition matrix."""
    return inertial_model("pvabg", LOCAL)


def autonomous_driving() -> dict[str, Any]:
    """gaoxiang12/slam_in_autonomous_driving 282486e, src/ch3/eskf.hpp; correction is added to the estimate."""
    return inertial_model("pvagb", LOCAL, {"error": "truth - estimate"})


def lins() -> dict[str, Any]:
    """ChaoqinRobotics LINS 94fe6c8, lins/include/KalmanFilter.hpp."""
    return inertial_model("pvabg", LOCAL)


def lins_before() -> dict[str, Any]:
    """The same before its issue 4 was answered: [w x] with the other sign."""
    return inertial_model("pvabg", {**LOCAL, "aa": skew(W_B)})


def okvis() -> dict[str, Any]:
    """ethz-asl/okvis 17246bd, ImuError.cpp: its transition over one step, to first order in the step."""
    turned = [" + ".join(f"{C[i][k]}*{F_B[k]}" for k in range(3)) for i in range(3)]
    return inertial_model("pavgb", {"pv": E, "va": neg(skew(turned)), "vb": neg(C), "ag": neg(C)})


def gps_imu_fusion() -> dict[str, Any]:
    """zm0612/eskf-gps-imu-fusion 4b57efe, src/eskf.cpp, without its Earth model: F alone."""
    quantities = {"specific_force": F_N, "rotation": C}
    return document("pvagb", {"pv": E, "va": skew(F_N), "vb": C, "ag": neg(C)}, quantities, {"frame": "inertial"})


def gps_imu_fusion_fed_back() -> dict[str, Any]:
    """The same with its feedback: corrections are added to position, velocity and to both biases."""
    known = {"frame": "inertial", "error": "truth - estimate", "bias_sign": "truth - estimate"}
    return gps_imu_fusion() | {"known": known}


def openvins() -> dict[str, Any]:
    """OpenVINS, documentation of its propagation: error on the left of the rotation from the world to the body."""
    return inertial_model("apvgb", LOCAL, {"error": "truth - estimate"})


def navego_2014(opposite: bool = False) -> dict[str, Any]:
    """rodralez/NaveGo 04c75bf, F_update.m, after Titterton and Weston: one radius, no gradient of gravity."""
    document = navego()
    states, F = document["model"]["states"], [list(row) for row in document["model"]["F"]]
    row, column = states.index("x_v2"), states.index("x_p2")
    F[row][column] = "(vN**2 + vE**2)/R**2"
    quantities = {**document["quantities"], "radii": ["R"]}
    gyro, accelerometer = (C, neg(C)) if opposite else (neg(C), C)
    for side, other, block in (("a", "g", gyro), ("v", "b", accelerometer)):
        for i in range(3):
            for j in range(3):
                F[states.index(f"x_{side}{i}")][states.index(f"x_{other}{j}")] = block[i][j]
    parameters = {k: v for k, v in document["parameters"].items() if k != "rS"}
    return document | {"model": {"states": states, "F": F}, "quantities": quantities, "parameters": parameters}


def navego_107() -> dict[str, Any]:
    """The same with the bias blocks that issue 107 of NaveGo quotes: +C for gyros and -C for accelerometers."""
    return navego_2014(opposite=True)


def vins_mono() -> dict[str, Any]:
    """Qin, Li, Shen, VINS-Mono, arXiv:1708.03852, equation 9: the error of the preintegrated rotation in the body."""
    return inertial_model("pvabg", LOCAL)


def pyins() -> dict[str, Any]:
    """nmayorov/pyins 13e0599, pyins/error_model.py: ENU, velocity beside the turned one, position in metres."""
    quantities = {**NED, "velocity": ["vE", "vN", "vU"], "radii": ["RN", "RE", "R0"]}
    m, n = "(RN + h)", "(RE + h)"
    R = [["0", f"-1/{m}", "0"], [f"1/{n}", "0", "0"], [f"tan(L)/{n}", "0", "0"]]
    v, earth = skew(["vE", "vN", "vU"]), ["0", "W*cos(L)", "W*sin(L)"]
    rho = [f"-vN/{m}", f"vE/{n}", f"vE*tan(L)/{n}"]
    both = [f"{x} + {y}" for x, y in zip(earth, rho, strict=True)]
    twice = [f"2*({x}) + {y}" for x, y in zip(earth, rho, strict=True)]
    down = skew(["0", "0", "-g"])
    blocks = {
        "pv": E, "pa": v, "vv": neg(skew(twice)), "va": neg(down),
        "vp": [["0", "0", "0"], ["0", "0", "0"], ["0", "0", "2*g/R0"]],
        "ap": mul(skew(earth), R), "av": R, "aa": plus(neg(skew(both)), mul(R, v)),
        "ag": neg(C), "vg": mul(v, C), "vb": C,
    }  # fmt: skip
    return document("pvagb", blocks, quantities, R0="positive", **declared(quantities))


PUBLISHED = {
    "Groves, inertial frame": groves_inertial,
    "Groves, Earth frame": groves_earth,
    "Groves, local level": groves_ned,
    "KF-GINS": kf_gins,
    "Sola, local error": sola_local,
    "Sola, global error": sola_global,
    "psi angle": psi_level,
    "right invariant": right_invariant,
    "left invariant": left_invariant,
    "pronto": pronto,
    "Minnesota": minnesota,
    "MSCKF": msckf,
    "PSINS": psins,
    "NaveGo": navego,
    "msckf_vio": msckf_vio,
    "OpenVINS": openvins,
    "VINS-Mono": vins_mono,
    "OKVIS": okvis,
    "imu_gps_localization": imu_gps_localization,
    "slam_in_autonomous_driving": autonomous_driving,
    "LINS": lins,
    "LINS, before issue 4": lins_before,
    "eskf-gps-imu-fusion": gps_imu_fusion,
    "eskf-gps-imu-fusion, with feedback": gps_imu_fusion_fed_back,
    "NaveGo 2014": navego_2014,
    "NaveGo, issue 107": navego_107,
    "pyins": pyins,
    "Savage": savage,
    "Farrell and Barth": farrell,
}
