"""Ready-made exports: names that stand for claims, for regimes in the order of the parameter, and for programs."""

from __future__ import annotations

from navsym.export.algorithms import earth, kalman, observer, pulsating, terrain, trajectory, velocity
from navsym.export.chain import Chain, Decided, Program
from navsym.export.languages.names import identifier
from navsym.export.parts import ExportedFunction

_GV = "guaranteed_velocity"

#: Name -> arguments of ``navsym export``; a name of ALGORITHMS among them is one too.
READY: dict[str, tuple[str, ...]] = {
    "velocity-correction": (
        f"velocity_correction_y1={_GV}:range.y1",
        f"velocity_correction_y2={_GV}:range.y2+{_GV}:range.y2.end*+{_GV}:range.y2.last",
        f"velocity_correction_y3={_GV}:range.y3+{_GV}:range.y3.end*+{_GV}:range.y3.last",
        "velocity-estimator-y1",
        "velocity-estimator-y2",
        "velocity-estimator-y3",
        f"estimate_y1={_GV}:4.14.y1",
        f"estimate_y2={_GV}:4.14.y2*",
        f"estimate_y3={_GV}:4.14.y3",
        f"estimate_y4={_GV}:4.16.y4",
        f"estimate_y5={_GV}:4.16.y5*",
        f"estimate_y6={_GV}:4.16.y6*",
    ),
    "velocity-weights": tuple(f"{_GV}:4.12.Phi{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)),
    "two-stage": ("two-stage-observer",),
    "pulsating": ("pulsating-filter",),
    "trajectory": ("trajectory-filter",),
    "terrain": ("terrain-crossing", "terrain-t-G", "terrain-t-G-extremes", "terrain-correction"),
    "kalman": ("kalman-update-9-3",),
    "earth": ("earth-geocentric", "earth-trihedron", "earth-rates"),
}

#: Paper -> symbol or result -> unit, for claims that are exported by themselves.
UNITS: dict[str, dict[str, str]] = {
    _GV: velocity.UNITS
    | {
        "tau": "1/omega_0 (Schuler time)",
        "z0": "any, say m/s",
        "zm": "that of z0",
        "zT": "that of z0",
        "dual": "1",
        "sigma": "unit of z",
    }
}

#: Name -> a chain (one function) or a program (a first state and a step).
ALGORITHMS: dict[str, Chain | Program] = {
    "velocity-estimator-y1": velocity.estimator("y1"),
    "velocity-estimator-y2": velocity.estimator("y2"),
    "velocity-estimator-y3": velocity.estimator("y3"),
    "two-stage-observer": observer.OBSERVER,
    "pulsating-filter": pulsating.FILTER,
    "trajectory-filter": trajectory.FILTER,
    "kalman-update-9-3": kalman.update(9, 3),
    "terrain-crossing": terrain.CROSSING,
    "terrain-t-G": terrain.DIRECTION,
    "terrain-t-G-extremes": terrain.EXTREMES,
    "terrain-correction": terrain.CORRECTION,
    "earth-geocentric": earth.GEOCENTRIC,
    "earth-trihedron": earth.TRIHEDRON,
    "earth-rates": earth.RATES,
}


def algorithm(name: str, decided: Decided, real: str) -> list[ExportedFunction]:
    """The functions of one of ALGORITHMS."""
    found, plain = ALGORITHMS[name], identifier(name)
    if isinstance(found, Program):
        return found.functions(plain, decided, real)
    return [found.function(plain, decided, real)]
