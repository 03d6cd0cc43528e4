"""Ready-made exports: names that stand for claims, for regimes in the order of the parameter, and for programs."""

from __future__ import annotations

import tomllib
from pathlib import Path

from navsym.claims.paper import import_paper
from navsym.export.algorithms.kalman import update
from navsym.export.chain import Chain, Decided, Program
from navsym.export.languages.names import identifier
from navsym.export.parts import ExportedFunction

KALMAN = "kalman-update-9-3"
TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
#: Name -> arguments of ``navsym export``, and name -> the paper whose ``programs`` have it.
READY: dict[str, list[str]] = TABLE["ready"]
PAPERS: dict[str, str] = TABLE["papers"]
#: Papers whose claims have units when they are exported by themselves.
WITH_UNITS = ("guaranteed_velocity",)


def units_of_paper(paper: str) -> dict[str, str]:
    """Symbol or result -> unit, for claims of a paper that are exported by themselves."""
    return dict(import_paper(f"{paper}.programs").UNITS) if paper in WITH_UNITS else {}


def algorithm(name: str, decided: Decided, real: str) -> list[ExportedFunction]:
    """The functions of a ready-made chain or program."""
    found: Chain | Program = update(9, 3) if name == KALMAN else import_paper(f"{PAPERS[name]}.programs").PROGRAMS[name]
    plain = identifier(name)
    if isinstance(found, Program):
        return found.functions(plain, decided, real)
    return [found.function(plain, decided, real)]
