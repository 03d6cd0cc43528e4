"""Values of the parameter at which a family is singular: a pole, an empty interval, dependent regressors.

Candidates are the roots of denominators, of the length and of the noise bounds, and the values at which two
frequencies or rates of the regressors meet or vanish; each is then tested on the problem itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import sympy as sp

from navsym.claims import PROVED, Equation
from navsym.errors import NavsymError
from navsym.methods.phases.family import Family, U
from navsym.proof.balls import enclose
from navsym.proof.ladder import decide
from navsym.proof.optimality.basis import DependentError, make_basis

MOST = 40


@dataclass(frozen=True, slots=True)
class Singular:
    """A value of the parameter where the range is split, and why."""

    at: sp.Expr
    why: str


def singular_values(family: Family, lower: sp.Expr, upper: sp.Expr) -> tuple[Singular, ...]:
    """Singular values in [lower, upper], in order."""
    found: dict[sp.Expr, str] = {}
    for expression in list(dict.fromkeys(suspects(family)))[:MOST]:
        for root in real_roots(expression, family.parameter):
            below, above = enclose(root - lower, bits=200), enclose(upper - root, bits=200)
            if root not in found and not bool(below < 0) and not bool(above < 0):
                why = reason(family, root)
                if why is not None:
                    found[root] = why
    ordered = sorted(found, key=lambda e: float(enclose(e).mid()))
    return tuple(Singular(at, found[at]) for at in ordered)


def suspects(family: Family) -> Iterator[sp.Expr]:
    """Expressions in the parameter whose roots may be singular."""
    p = family.parameter
    parts = [*family.functional, *family.sigma, *(h for row in family.rows for h in row)]
    lengths = dict.fromkeys(stop - start for start, stop in family.panels)
    yield from (e for e in (*lengths, *family.sigma) if p in e.free_symbols)
    for part in parts:
        for power in part.atoms(sp.Pow):
            if power.exp.is_negative and p in power.base.free_symbols and U not in power.base.free_symbols:
                yield power.base
    rates = list(dict.fromkeys(r for part in parts for r in rates_of(part)))
    yield from (r for r in rates if p in r.free_symbols)
    for a, b in combinations(rates, 2):
        yield from (e for e in (a - b, a + b) if p in e.free_symbols)


def rates_of(part: sp.Expr) -> Iterator[sp.Expr]:
    """Factors of U in the arguments of functions."""
    for f in part.atoms(sp.Function) | {e for e in part.atoms(sp.exp)}:
        for argument in f.args:
            rate = sp.expand(argument).coeff(U, 1)
            if rate != 0:
                yield rate


def real_roots(expression: sp.Expr, p: sp.Symbol) -> list[sp.Expr]:
    """Real roots of a polynomial in p, exactly; none of anything else."""
    top = sp.fraction(sp.together(expression))[0]
    if not top.is_polynomial(p) or top.free_symbols != {p}:
        return []
    try:
        return list(dict.fromkeys(sp.Poly(top, p).real_roots()))
    except (NotImplementedError, sp.PolynomialError):
        return []


def reason(family: Family, value: sp.Expr) -> str | None:
    """Why the problem is singular there, or None when it is not."""
    name = f"{family.parameter.name} = {value}"
    lengths = dict.fromkeys(family.at(stop - start, value) for start, stop in family.panels)
    if any(decide(Equation(length, sp.S.Zero)).status is PROVED for length in lengths):
        return f"{family.stretch_name} has no length at {name}"
    try:
        make_basis(family.exact(value))
    except DependentError:
        return f"the regressors become dependent at {name}"
    except (NavsymError, ZeroDivisionError, ValueError):
        return f"the regressors have a pole at {name}, where the problem is solved apart"
    return None
