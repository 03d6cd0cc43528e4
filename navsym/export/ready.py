"""Ready-made exports: names that stand for claims, for regimes in the order of the parameter, and for programs."""

from __future__ import annotations

from navsym.claims.paper import import_paper
from navsym.export.algorithms.kalman import update
from navsym.export.chain import Chain, Decided, Program
from navsym.export.languages.names import identifier
from navsym.export.parts import ExportedFunction

_GV = "guaranteed_velocity"
KALMAN = "kalman-update-9-3"

#: Name -> arguments of ``navsym export``; a name of PAPERS among them is one too.
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
    "kalman": (KALMAN,),
    "earth": ("earth-geocentric", "earth-trihedron", "earth-rates"),
}

#: Name -> the paper whose ``programs`` have it, each a chain (one function) or a program (a first state and a step).
PAPERS: dict[str, str] = {
    "velocity-estimator-y1": _GV,
    "velocity-estimator-y2": _GV,
    "velocity-estimator-y3": _GV,
    "two-stage-observer": "joint_correction",
    "pulsating-filter": "multistructure",
    "trajectory-filter": "trajectory",
    "terrain-crossing": "terrain_search",
    "terrain-t-G": "terrain_search",
    "terrain-t-G-extremes": "terrain_search",
    "terrain-correction": "terrain_search",
    "earth-geocentric": "trajectory",
    "earth-trihedron": "trajectory",
    "earth-rates": "trajectory",
}


def units_of_paper(paper: str) -> dict[str, str]:
    """Symbol or result -> unit, for claims of a paper that are exported by themselves."""
    return dict(import_paper(f"{paper}.programs").UNITS) if paper == _GV else {}


def is_program(name: str) -> bool:
    """True for the name of a ready-made chain or program."""
    return name == KALMAN or name in PAPERS


def algorithm(name: str, decided: Decided, real: str) -> list[ExportedFunction]:
    """The functions of a ready-made chain or program."""
    found: Chain | Program = update(9, 3) if name == KALMAN else import_paper(f"{PAPERS[name]}.programs").PROGRAMS[name]
    plain = identifier(name)
    if isinstance(found, Program):
        return found.functions(plain, decided, real)
    return [found.function(plain, decided, real)]
