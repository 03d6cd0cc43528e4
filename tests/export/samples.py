"""Functions that the export tests share: a weight, an estimate, regimes, a matrix, removable singularities."""

from __future__ import annotations

from functools import cache

import sympy as sp

from navsym.claims import Claim, Equation, Statement
from navsym.export.functions import ExportedFunction, Material, function_of, material
from navsym.prove.ladder import decide
from navsym_papers.guaranteed_velocity import beyond, weights

w = sp.Symbol("w", real=True)
lam = sp.Symbol("lambda", real=True)
beta = sp.Symbol("beta", positive=True)


def of_claim(claim: Claim) -> Material:
    statement = claim.derive()
    return material(claim.id, statement, decide(statement), title=claim.title)


def of_statement(name: str, statement: Statement) -> Material:
    return material(f"sample:{name}", statement, decide(statement))


def versine() -> Equation:
    return Equation((1 - sp.cos(w)) / w**2, 2 * sp.sin(w / 2) ** 2 / w**2, {w: (-1, 1)})


def lag() -> Equation:
    return Equation(w - sp.sin(w), w - 2 * sp.sin(w / 2) * sp.cos(w / 2), {w: (-3, 3)})


def holes() -> Equation:
    """The coefficients of a rotation vector and of a Markov process: every one has a hole at zero that is none."""
    other = [
        2 * sp.sin(w / 2) * sp.cos(w / 2) / w,
        2 * sp.sin(w / 2) ** 2 / w**2,
        (w - 2 * sp.sin(w / 2) * sp.cos(w / 2)) / w**3,
        (1 - sp.exp(-w / 2) ** 2) / w,
        (sp.exp(w) - sp.exp(-w)) / (2 * w),
    ]
    printed = [sp.sin(w) / w, (1 - sp.cos(w)) / w**2, (w - sp.sin(w)) / w**3, (1 - sp.exp(-w)) / w, sp.sinh(w) / w]
    return Equation(sp.Matrix(printed), sp.Matrix(other), {w: (-3, 3)})


def rotation() -> Equation:
    c, s = sp.cos(lam), sp.sin(lam)
    printed = sp.Matrix([[c, s / beta], [-beta * s, c]])
    half = lam / 2
    other = sp.Matrix([[1 - 2 * sp.sin(half) ** 2, s / beta], [-beta * s, sp.cos(half) ** 2 - sp.sin(half) ** 2]])
    return Equation(printed, other, {lam: (-3, 3), beta: (sp.Rational(1, 10), 2)})


REGIMES = tuple(one for one in beyond.REGIMES if one.number in ("range.y3", "range.y3.end*", "range.y3.last"))
#: Name -> what is decided, once for both types of numbers.
MAKERS = {
    "Phi33": lambda: [of_claim(weights.WEIGHTS[8])],
    "tilt": lambda: [of_claim(weights.lateral_estimates[2])],
    "velocity_correction_y3": lambda: [of_claim(claim) for claim in REGIMES],
    **{f.__name__: lambda f=f: [of_statement(f.__name__, f())] for f in (versine, lag, rotation, holes)},
}


@cache
def materials(name: str) -> list[Material]:
    return MAKERS[name]()


@cache
def by_name(name: str, real: str = "double") -> ExportedFunction:
    own = {"name": name} if name.startswith("velocity") else {}
    return function_of(materials(name), real=real, **own)


def functions(real: str = "double") -> tuple[ExportedFunction, ...]:
    return tuple(by_name(name, real) for name in MAKERS)
