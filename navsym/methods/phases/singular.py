"""Values of the parameter at which a family is singular: a pole, an empty interval, dependent regressors.

Candidates are the roots of denominators, of the length and of the noise bounds, and the values at which two
frequencies or rates of the regressors meet or vanish; each is then tested on the problem itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import reduce
from itertools import combinations, islice

import sympy as sp
from flint import arb

from navsym.claims import PROVED, Equation
from navsym.errors import NavsymError
from navsym.methods.phases.family import Family, U
from navsym.proof.balls import enclose
from navsym.proof.ladder import decide
from navsym.proof.optimality.basis import DependentError, make_basis

#: Expressions whose roots are looked for, minors of coefficients, and cells on which one is shown to have none.
MOST = 400
MOST_MINORS = 200
CELLS = 64


@dataclass(frozen=True, slots=True)
class Singular:
    """A value of the parameter where the range is split, and why."""

    at: sp.Expr
    why: str


def singular_values(family: Family, lower: sp.Expr, upper: sp.Expr) -> tuple[tuple[Singular, ...], tuple[sp.Expr, ...]]:
    """Singular values in [lower, upper], in order, and the expressions whose roots in it are not known."""
    found: dict[sp.Expr, str] = {}
    unknown: list[sp.Expr] = []
    for k, expression in enumerate(dict.fromkeys(suspects(family))):
        roots = real_roots(expression, family.parameter) if k < MOST else None
        if roots is None:
            unknown += [] if rootless(expression, family.parameter, lower, upper) else [expression]
            continue
        for root in roots:
            below, above = enclose(root - lower, bits=200), enclose(upper - root, bits=200)
            if root not in found and not bool(below < 0) and not bool(above < 0):
                why = reason(family, root)
                if why is not None:
                    found[root] = why
    ordered = sorted(found, key=lambda e: float(enclose(e).mid()))
    return tuple(Singular(at, found[at]) for at in ordered), tuple(unknown)


def suspects(family: Family) -> Iterator[sp.Expr]:
    """Expressions in the parameter whose roots may be singular."""
    p = family.parameter
    parts = [*family.functional, *family.sigma, *(h for row in family.rows for h in row)]
    lengths = dict.fromkeys(stop - start for start, stop in family.panels)
    yield from (e for e in (*lengths, *family.sigma) if p in e.free_symbols)
    if all(e.is_polynomial(p) for e in family.functional):
        yield from (e for e in (reduce(sp.gcd, family.functional),) if p in e.free_symbols)
    for part in parts:
        for power in part.atoms(sp.Pow):
            if power.exp.is_negative and p in power.base.free_symbols and U not in power.base.free_symbols:
                yield power.base
    for part in (*parts, family.start, family.stop):
        yield from (e.base for e in part.atoms(sp.Pow) if is_square_root(e, p))
    yield from lost_ranks(family)
    rates = list(dict.fromkeys(r for part in parts for r in rates_of(part)))
    yield from (r for r in rates if p in r.free_symbols)
    for a, b in combinations(rates, 2):
        yield from (e for e in (a - b, a + b) if p in e.free_symbols)


def is_square_root(power: sp.Pow, parameter: sp.Symbol) -> bool:
    """True for ``base**(k/2)`` with a base in the parameter alone."""
    return bool(power.exp.is_Rational and power.exp.q == 2 and power.base.free_symbols == {parameter})


def lost_ranks(family: Family) -> Iterator[sp.Expr]:
    """Expressions that vanish where the regressors, as combinations of functions of U, lose rank: the common divisor
    of minors of the matrix of their coefficients."""
    p, m = family.parameter, len(family.functional)
    columns: dict[tuple[int, sp.Expr], list[sp.Expr]] = {}
    for k, row in enumerate(family.rows):
        for i, h in enumerate(row):
            for term in sp.Add.make_args(sp.expand(h)):
                factor, function = term.as_independent(U, as_Add=False)
                columns.setdefault((k, function), [sp.S.Zero] * m)[i] += factor
    vectors = list(columns.values())
    if not all(c.is_rational_function(p) for v in vectors for c in v) or not any(c.has(p) for v in vectors for c in v):
        return
    common = sp.S.Zero
    for chosen in islice(combinations(vectors, m), MOST_MINORS):
        common = sp.gcd(common, sp.fraction(sp.together(sp.Matrix(chosen).det(method="berkowitz")))[0])
        if common != 0 and p not in common.free_symbols:
            return
    if common != 0:
        yield common


def rates_of(part: sp.Expr) -> Iterator[sp.Expr]:
    """Factors of U in the arguments of functions."""
    for f in part.atoms(sp.Function) | {e for e in part.atoms(sp.exp)}:
        for argument in f.args:
            rate = sp.expand(argument).coeff(U, 1)
            if rate != 0:
                yield rate


def real_roots(expression: sp.Expr, p: sp.Symbol) -> list[sp.Expr] | None:
    """Real roots of a polynomial in p, or in p and one square root of such, exactly; None for anything else."""
    top = sp.fraction(sp.together(expression))[0]
    if not top.free_symbols:
        return []
    roots = [e for e in top.atoms(sp.Pow) if e.exp == sp.Rational(1, 2) and p in e.free_symbols]
    if len(roots) == 1:
        s = sp.Dummy()
        squared = sp.resultant(top.subs(roots[0], s), s**2 - roots[0].base, s)
        found = polynomial_roots(squared, p)
        return None if found is None else [root for root in found if vanishes(top.subs(p, root))]
    return polynomial_roots(top, p)


def vanishes(x: sp.Expr) -> bool:
    """False only when a ball shows that a number is not zero."""
    return not bool(abs(enclose(x)) > 0)


def polynomial_roots(top: sp.Expr, p: sp.Symbol) -> list[sp.Expr] | None:
    """Real roots of a polynomial in p; None for anything else."""
    if top.is_Rational and top != 0:
        return []
    if not top.is_polynomial(p) or top.free_symbols != {p}:
        return None
    try:
        return list(dict.fromkeys(sp.Poly(top, p).real_roots()))
    except (NotImplementedError, sp.PolynomialError):
        return None


def rootless(expression: sp.Expr, p: sp.Symbol, lower: sp.Expr, upper: sp.Expr) -> bool:
    """True when balls over cells of the range show that the expression has no root there."""
    a, width = enclose(lower), enclose(upper - lower)
    cells = [a + width * (arb(2 * k + 1) + arb(0, 1)) / (2 * CELLS) for k in range(CELLS)]
    return all(bool(size > 0) or bool(size < 0) for size in (enclose(expression, {p: cell}) for cell in cells))


def reason(family: Family, value: sp.Expr) -> str | None:
    """Why the problem is singular there, or None when it is not."""
    name = f"{family.parameter.name} = {value}"
    lengths = dict.fromkeys(family.at(stop - start, value) for start, stop in family.panels)
    if any(decide(Equation(length, sp.S.Zero)).status is PROVED for length in lengths):
        return f"{family.stretch_name} has no length at {name}"
    parts = {
        "a regressor": [h for row in family.rows for h in row],
        "the functional": family.functional,
        "a noise bound": family.sigma,
    }
    for what, expressions in parts.items():
        if any(family.at(e, value).has(sp.zoo, sp.nan, sp.oo, -sp.oo) for e in expressions):
            return f"{what} has a pole at {name}, where the problem is solved apart"
    if not all(bool(enclose(family.at(s, value)) > 0) for s in family.sigma):
        return f"a noise bound is not positive at {name}"
    try:
        make_basis(family.exact(value))
    except DependentError:
        return f"the regressors become dependent at {name}"
    except NavsymError as error:
        return f"the problem is refused at {name}: {error}"
    return None
