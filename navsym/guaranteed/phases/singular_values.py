"""The range of the parameter cut into sections without a singular value inside."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import reduce
from itertools import combinations, islice, pairwise
from typing import Any

import sympy as sp
from flint import arb

from navsym.claims import PROVED, REFUTED, Equation
from navsym.core.balls import enclose
from navsym.core.errors import DomainError, NavsymError, NotEstimableError
from navsym.core.exact import lower_end, to_fraction, to_rational, upper_end
from navsym.guaranteed.certificate.basis import DependentError, make_basis
from navsym.guaranteed.estimability import is_equal, recognised
from navsym.guaranteed.phases.boundaries import Boundary
from navsym.guaranteed.phases.family import Family, U
from navsym.language.expression import to_text
from navsym.prove.ladder import decide

# Families with regressors that depend on the others for every value of the parameter: they are left out, exactly.


def drop_dependent_unknowns(family: Family, value: sp.Rational) -> tuple[Family, tuple[dict[str, Any], ...]]:
    """The family without dependent unknowns, and identity certificates that tie it to the whole one.

    value : a value of the parameter at which dependence is looked for; it is proved for all of them

    Raises NotEstimableError when the functional needs what no measurement shows.
    """
    ties: list[dict[str, Any]] = []
    while True:
        try:
            make_basis(family.exact(value))
        except DependentError as found:
            relation = [recognised(c) for c in found.relation]
            if any(c is None for c in relation):
                raise
            family = drop_unknown(family, found, relation, ties)
        else:
            return family, tuple(ties)


def drop_unknown(
    family: Family, found: DependentError, relation: list[sp.Rational | None], ties: list[dict[str, Any]]
) -> Family:
    """One unknown fewer: ``H_k = sum c_j H_j`` and ``P_k = sum c_j P_j``, both proved."""
    k = found.index
    for row in (*family.rows, family.functional):
        other = sum((c * h for c, h in zip(relation, row, strict=False) if c), sp.S.Zero)
        verdict = decide(Equation(row[k], other))
        if verdict.status is not PROVED or verdict.assumptions:
            if row is family.functional and verdict.status is REFUTED:
                raise NotEstimableError(
                    f"functional: expected one that the measurements determine; got one that changes along a "
                    f"direction of unknown {k + 1} which no measurement shows; estimate another combination"
                )
            raise found
        symbols = sorted({s.name for s in (row[k] - other).free_symbols | {U, family.parameter}})
        left, right = to_text(sp.sympify(row[k], strict=True)), to_text(sp.sympify(other, strict=True))
        ties.append({"kind": "identity", "left": left, "right": right, "symbols": symbols})
    rows = tuple(tuple(h for j, h in enumerate(row) if j != k) for row in family.rows)
    functional = tuple(p for j, p in enumerate(family.functional) if j != k)
    left_out = (*family.left_out, family.unknowns[k])
    return replace(family, rows=rows, functional=functional, left_out=left_out)


# Values of the parameter at which a family is singular: a pole, an empty interval, dependent regressors.
#
# Candidates are the roots of denominators, of the length and of the noise bounds, and the values at which two
# frequencies or rates of the regressors meet or vanish; each is then tested on the problem itself.


#: Expressions whose roots are looked for, minors of coefficients, and cells on which one is shown to have none.
MOST = 400
MOST_MINORS = 200
CELLS = 64


@dataclass(frozen=True, slots=True)
class SingularValue:
    """A value of the parameter where the range is split, and why."""

    at: sp.Expr
    why: str


def find_singular_values(
    family: Family, lower: sp.Expr, upper: sp.Expr
) -> tuple[tuple[SingularValue, ...], tuple[sp.Expr, ...]]:
    """Singular values in [lower, upper], in order, and the expressions whose roots in it are not known."""
    found: dict[sp.Expr, str] = {}
    unknown: list[sp.Expr] = []
    for k, expression in enumerate(dict.fromkeys(suspect_expressions(family))):
        roots = exact_real_roots(expression, family.parameter) if k < MOST else None
        if roots is None:
            unknown += [] if is_rootless(expression, family.parameter, lower, upper) else [expression]
            continue
        for root in roots:
            below, above = enclose(root - lower, bits=200), enclose(upper - root, bits=200)
            if root not in found and not bool(below < 0) and not bool(above < 0):
                why = singularity_reason(family, root)
                if why is not None:
                    found[root] = why
    ordered = sorted(found, key=lambda e: float(enclose(e).mid()))
    return tuple(SingularValue(at, found[at]) for at in ordered), tuple(unknown)


def suspect_expressions(family: Family) -> Iterator[sp.Expr]:
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
    yield from rank_losses(family)
    rates = list(dict.fromkeys(r for part in parts for r in function_rates(part)))
    yield from (r for r in rates if p in r.free_symbols)
    for a, b in combinations(rates, 2):
        yield from (e for e in (a - b, a + b) if p in e.free_symbols)


def is_square_root(power: sp.Pow, parameter: sp.Symbol) -> bool:
    """True for ``base**(k/2)`` with a base in the parameter alone."""
    return bool(power.exp.is_Rational and power.exp.q == 2 and power.base.free_symbols == {parameter})


def rank_losses(family: Family) -> Iterator[sp.Expr]:
    """Expressions that vanish where the regressors, as combinations of functions of U, lose rank.

    Each is the common divisor of minors of the matrix of their coefficients.
    """
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


def function_rates(part: sp.Expr) -> Iterator[sp.Expr]:
    """Factors of U in the arguments of functions."""
    for f in part.atoms(sp.Function) | {e for e in part.atoms(sp.exp)}:
        for argument in f.args:
            rate = sp.expand(argument).coeff(U, 1)
            if rate != 0:
                yield rate


def exact_real_roots(expression: sp.Expr, p: sp.Symbol) -> list[sp.Expr] | None:
    """Real roots of a polynomial in p, or in p and one square root of such, exactly; None for anything else."""
    top = sp.fraction(sp.together(expression))[0]
    if not top.free_symbols:
        return []
    roots = [e for e in top.atoms(sp.Pow) if e.exp == sp.Rational(1, 2) and p in e.free_symbols]
    if len(roots) == 1:
        s = sp.Dummy()
        squared = sp.resultant(top.subs(roots[0], s), s**2 - roots[0].base, s)
        found = polynomial_roots(squared, p)
        return None if found is None else [root for root in found if not bool(abs(enclose(top.subs(p, root))) > 0)]
    return polynomial_roots(top, p)


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


def is_rootless(expression: sp.Expr, p: sp.Symbol, lower: sp.Expr, upper: sp.Expr) -> bool:
    """True when balls over cells of the range show that the expression has no root there."""
    a, width = enclose(lower), enclose(upper - lower)
    cells = [a + width * (arb(2 * k + 1) + arb(0, 1)) / (2 * CELLS) for k in range(CELLS)]
    return all(bool(size > 0) or bool(size < 0) for size in (enclose(expression, {p: cell}) for cell in cells))


def singularity_reason(family: Family, value: sp.Expr) -> str | None:
    """Why the problem is singular there, or None when it is not."""
    name = f"{family.parameter.name} = {value}"
    lengths = dict.fromkeys(family.at(stop - start, value) for start, stop in family.panels)
    if any(is_equal(length, sp.S.Zero) for length in lengths):
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


DIGITS = 34


Part = tuple[Family, sp.Expr, sp.Expr]


@dataclass(frozen=True, slots=True, eq=False)
class RegularInterval:
    """A part of the range without a singular value inside, as far as they are known.

    singular : those of the range
    unknown  : expressions that may have roots in the range at which it is singular
    ties     : certificates of unknowns left out
    """

    family: Family
    lower: sp.Expr
    upper: sp.Expr
    singular: tuple[SingularValue, ...]
    unknown: tuple[sp.Expr, ...]
    ties: tuple[dict[str, Any], ...]

    @property
    def names(self) -> set[sp.Expr]:
        """The singular values."""
        return {s.at for s in self.singular}


def family_intervals(family: Family, lower: sp.Expr, upper: sp.Expr) -> list[Part]:
    """The range cut where one family of a chain follows another."""
    chain = family.chain
    first = [lower, *(one.least for one in chain[1:])]
    last = [*(one.least for one in chain[1:]), upper]
    done = []
    for one, a, b in zip(chain, first, last, strict=True):
        start, end = (lower if is_above(lower, a) else a), (upper if is_above(b, upper) else b)
        if is_above(end, start):
            done.append((one, start, end))
    return done


@dataclass(frozen=True, slots=True)
class ImaginaryInterval:
    """A part of the range in which a square root of the file is imaginary: there is no problem there."""

    root: sp.Expr
    lower: sp.Expr
    upper: sp.Expr

    def in_words(self, name: str) -> str:
        """What is imaginary where."""
        return f"{self.root} is imaginary for {name} from {self.lower} to {self.upper}, where there is no problem"


def real_intervals(family: Family, lower: sp.Expr, upper: sp.Expr) -> tuple[list[Part], list[ImaginaryInterval]]:
    """The range cut where square roots of the parameter become imaginary, and the parts in which one of them is.

    Roots that only stand where sines become hyperbolic sines, or in pairs, cut nothing. Raises DomainError when one is
    imaginary on the whole range.
    """
    roots = {r for e in family_expressions(family) for r in e.atoms(sp.Pow) if is_square_root(r, family.parameter)}
    found = {z for r in roots for z in exact_real_roots(r.base, family.parameter) or ()}
    marks = sorted(
        (z for z in found if is_above(z, lower) and is_above(upper, z)), key=lambda z: float(enclose(z).mid())
    )
    parts, left = [], []
    for a, b in pairwise([lower, *marks, upper]):
        bad = imaginary_root(family, roots, value_inside(a, b))
        if bad is None:
            parts.append((family, a, b))
        else:
            left.append(ImaginaryInterval(bad, a, b))
    if not parts:
        raise DomainError(
            f"{family.parameter.name}: expected a range in which the problem is real; got {lower} to {upper}, and "
            f"{left[0].in_words(family.parameter.name)}; give a range in which {left[0].root.base} is not negative"
        )
    return ([(family, lower, upper)] if not left else parts), left


def family_expressions(family: Family) -> list[sp.Expr]:
    """All that may depend on the parameter."""
    rows = [h for row in family.rows for h in row]
    return [*family.functional, *family.sigma, *rows, family.start, *family.cuts, family.stop]


def imaginary_root(family: Family, roots: set[sp.Expr], value: sp.Rational) -> sp.Expr | None:
    """A square root that makes the problem imaginary at a value, or None."""
    real = family.real_near(value)
    if not any(real.at(e, value).has(sp.I) for e in family_expressions(real)):
        return None
    negative = [sp.sqrt(r.base) for r in roots if bool(enclose(family.at(r.base, value)) < 0)]
    return min(negative, key=sp.default_sort_key, default=None)


def is_above(x: sp.Expr, y: sp.Expr) -> bool:
    """x > y, by balls."""
    return x != y and bool(enclose(x - y) > 0)


def split_at_singular_values(family: Family, lower: sp.Expr, upper: sp.Expr) -> list[RegularInterval]:
    """The range cut at its singular values, and unknowns that depend on others left out."""
    inside = value_inside(lower, upper)
    family, ties = drop_dependent_unknowns(family.real_near(inside), inside)
    singular, unknown = find_singular_values(family, lower, upper)
    inner = [s.at for s in singular if is_above(s.at, lower) and is_above(upper, s.at)]
    return [
        RegularInterval(family.real_near(value_inside(a, b)), a, b, singular, unknown, ties)
        for a, b in pairwise([lower, *inner, upper])
    ]


def value_inside(lower: sp.Expr, upper: sp.Expr) -> sp.Rational:
    """A rational value between the ends that no symmetry singles out."""
    ball = enclose(lower + (upper - lower) * sp.Rational(5, 13), bits=96)
    return to_rational(to_fraction(ball).limit_denominator(10**6))


def singular_boundary(singular: SingularValue) -> Boundary:
    """A singular value as a boundary."""
    ball = enclose(singular.at, bits=200)
    return Boundary(singular.at, lower_end(ball, DIGITS), upper_end(ball, DIGITS), singular.why, True)


def unsolved_boundary(section: RegularInterval) -> Boundary:
    """What may split a section further, as a boundary somewhere in it that was not located."""
    ends = lower_end(enclose(section.lower, bits=200), DIGITS), upper_end(enclose(section.upper, bits=200), DIGITS)
    shown = ", ".join(map(str, section.unknown[:5])) + (", …" if len(section.unknown) > 5 else "")
    return Boundary(None, *ends, f"singular values may lie where these vanish, which were not solved: {shown}", False)


def need_range(family: Family, lower: sp.Expr, upper: sp.Expr) -> None:
    """Raises DomainError for ends that are no finite numbers, for from >= to, and for lengths below zero."""
    need_order(lower, upper)
    if family.growing and not bool(enclose(lower) >= 0):
        raise DomainError(f"range: expected lengths 0 <= from < to; got {lower} to {upper}; mend them")


def need_order(lower: sp.Expr, upper: sp.Expr) -> None:
    """Raises DomainError for ends that are no finite numbers, and for from >= to."""
    for end in (lower, upper):
        if end.free_symbols or not enclose(end).is_finite():
            raise DomainError(f"range: expected finite numbers; got {end}; give two numbers")
    if not bool(enclose(upper - lower) > 0):
        raise DomainError(f"range: expected from < to; got {lower} to {upper}; exchange or mend them")
