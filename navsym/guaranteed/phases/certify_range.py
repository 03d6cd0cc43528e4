"""Regimes without a closed form: followed and certified for every value of the parameter."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import sympy as sp
from flint import fmpq, fmpq_mat

from navsym.checker import AT_ZERO
from navsym.core.exact import decimal, from_decimal, to_fmpq, to_fraction, to_rational
from navsym.guaranteed.certificate.basis import make_basis
from navsym.guaranteed.certificate.entire import REMAINDERS
from navsym.guaranteed.certificate.moving import Member, rational_functional
from navsym.guaranteed.certificate.range import (
    PatternTrack,
    RangePiece,
    RangeProof,
    follow_pattern,
    march_pieces,
    never,
    range_document,
    short_decimal,
    verify_piece,
)
from navsym.guaranteed.phases.closed_forms import sharp_member
from navsym.guaranteed.phases.family import Family, U
from navsym.guaranteed.phases.narrow import join_intervals
from navsym.guaranteed.phases.patterns import Pattern
from navsym.guaranteed.streaming.flow import pivot_columns
from navsym.language.expression import to_text

# Next to a vanishing interval: regressors on [0, T] scaled by powers of T, so that the limit is regular.
#
# With Taylor coefficients h_k of the regressors at u = 0, a rational matrix A brings them to echelon form:
# row i of ``A H(u)`` starts with u**k_i, k_1 < k_2 < …, and ``(A H)_i(T v) / T**k_i`` has a limit as T -> 0.


EXTRA = 12
#: Series about zero are sharp, and their certificates accepted, for arguments up to about this.
REACH = fmpq(7, 8)


@dataclass(frozen=True, slots=True, eq=False)
class Echelon:
    """Rational A, the first powers of its rows, and the power for the functional.

    reach : the length up to which every argument stays within REACH
    """

    basis: fmpq_mat
    lows: tuple[int, ...]
    shift: int
    reach: fmpq


def echelon_form(family: Family) -> Echelon | None:
    """The echelon form of the regressors at u = 0, or None when a coefficient is not rational."""
    m, count = len(family.functional), len(family.functional) + EXTRA
    rates = argument_rates([h for row in family.rows for h in row])
    if rates is None:
        return None
    tables = [taylor_table(row, count) for row in family.rows]
    if any(t is None for t in tables) or not all(p.is_Rational for p in family.functional):
        return None
    wide = [[t[i][k] for k in range(count) for t in tables if t is not None] for i in range(m)]
    pivots = pivot_columns(wide)
    if len(pivots) < m:
        return None
    A = fmpq_mat([[row[k] for k in pivots] for row in wide]).inv()
    lows = tuple(k // len(tables) for k in pivots)
    image = A * fmpq_mat(m, 1, rational_functional(family.moving))
    shift = max(low for i, low in enumerate(lows) if image[i, 0] != 0)
    return Echelon(A, lows, shift, REACH / max(rates) if rates else fmpq(10**6))


def argument_rates(row: list[sp.Expr]) -> list[fmpq] | None:
    """|c| of every ``sin(c u)``, ``cos(c u)``, ``exp(c u)``, and a bound of 1/|z| for the zeros z of every denominator.

    None when there is another function.
    """
    rates = []
    for f in {f for h in map(in_exponentials, row) for f in h.atoms(sp.Function, sp.exp) | reciprocals(h)}:
        rate = pole_rate(f) if f.is_Pow and not f.is_polynomial(U) and f.base != sp.E else argument_rate(f)
        if rate is None:
            return None
        rates.append(rate)
    for h in map(in_exponentials, row):
        # Polynomials in U and in what :func:`expand_functions` replaces.
        own = {f: sp.Dummy() for f in h.atoms(sp.Function, sp.exp) | reciprocals(h)}
        if not h.xreplace(own).is_polynomial(U):
            return None
    return rates


def in_exponentials(h: sp.Expr) -> sp.Expr:
    """Hyperbolic functions written with exponentials."""
    return sp.expand(h.rewrite(sp.exp)) if h.has(sp.sinh, sp.cosh) else h


def reciprocals(h: sp.Expr) -> set[sp.Expr]:
    """Reciprocals of polynomials in U."""
    powers = (e for e in h.atoms(sp.Pow) if e.exp.is_Integer and e.exp.is_negative)
    return {e for e in powers if e.has(U) and e.base.is_polynomial(U)}


def argument_rate(f: sp.Expr) -> fmpq | None:
    """|c| of ``sin(c u)``, ``cos(c u)``, ``exp(c u)``."""
    c = sp.expand(f.args[0] / U) if f.func in (sp.sin, sp.cos, sp.exp) else sp.S.NaN
    return abs(to_fmpq(c)) if c.is_Rational else None


def pole_rate(f: sp.Expr) -> fmpq | None:
    """A bound of 1/|z| for the zeros z of ``sum a_k u**k``, by Cauchy: ``max |a_k / a_0| + 1``; None where a_0 = 0."""
    c = sp.Poly(f.base, U).all_coeffs()
    if c[-1] == 0 or not all(a.is_Rational for a in c):
        return None
    most = max(abs(a / c[-1]) for a in c) + 1
    return to_fmpq(most)


def taylor_table(row: tuple[sp.Expr, ...], count: int) -> list[list[fmpq]] | None:
    """Taylor coefficients at u = 0 of every regressor, exactly; None when one is not rational."""
    table = []
    for h in row:
        coefficients, derivative = [], h
        for k in range(count):
            value = sp.expand(derivative.subs(U, 0) / sp.factorial(k))
            if not value.is_Rational:
                return None
            coefficients.append(to_fmpq(value))
            derivative = derivative.diff(U)
        table.append(coefficients)
    return table


def rescale_family(family: Family, form: Echelon, *, entire: bool = False) -> Family:
    """The same problems with places as shares of the interval and rows scaled: ``(A H)_i(T u) / T**k_i``.

    entire : with entire functions, so that the rows are regular at T = 0; for lengths within the reach of the form
    """
    T, m = family.parameter, len(family.functional)
    scaled = entire_row if entire else scaled_row
    rows = tuple(tuple(scaled(form, i, row, T) for i in range(m)) for row in family.rows)
    image = form.basis * fmpq_mat(m, 1, rational_functional(family.moving))
    functional = tuple(to_rational(image[i, 0]) * T ** (form.shift - low) for i, low in enumerate(form.lows))
    return replace(family, rows=rows, functional=functional, start=sp.S.Zero, end=sp.S.One)


def scaled_row(form: Echelon, i: int, row: Sequence[sp.Expr], T: sp.Symbol) -> sp.Expr:
    """Row i of ``A H(T u) / T**k_i``."""
    terms = (to_rational(form.basis[i, j]) * h.subs(U, T * U) for j, h in enumerate(row))
    return sum(terms, sp.S.Zero) / T ** form.lows[i]


def entire_row(form: Echelon, i: int, row: Sequence[sp.Expr], T: sp.Symbol) -> sp.Expr:
    """The same with powers of T cancelled."""
    parts: dict[sp.Expr, sp.Symbol] = {}
    K = max(form.lows) + 1
    terms = (to_rational(form.basis[i, j]) * expand_functions(h, K, parts) for j, h in enumerate(row))
    known = sp.Poly(sp.expand(sum(terms, sp.S.Zero)), U).terms()
    here = {symbol: f.subs(U, T * U) for f, symbol in parts.items()}
    scaled = (c.xreplace(here) * T ** (power - form.lows[i]) * U**power for (power,), c in known)
    return sum(scaled, sp.S.Zero)


def expand_functions(h: sp.Expr, K: int, parts: dict[sp.Expr, sp.Symbol]) -> sp.Expr:
    """h with every function written as its Taylor polynomial and ``u**K`` times a part that is regular at zero.

    parts : regular part -> the symbol that stands for it
    """

    def function(f: sp.Expr) -> sp.Expr:
        c, remainder = sp.expand(f.args[0] / U), REMAINDERS[f.func]
        signs = AT_ZERO[remainder.name]
        polynomial = sum((signs[k % 4] * (c * U) ** k / sp.factorial(k) for k in range(K)), sp.S.Zero)
        return polynomial + (c * U) ** K * parts.setdefault(remainder(K, c * U), sp.Dummy())

    def reciprocal(f: sp.Expr) -> sp.Expr:
        (table,) = taylor_table((f,), K) or ([],)
        polynomial = sum((to_rational(a) * U**k for k, a in enumerate(table)), sp.S.Zero)
        rest = sp.cancel(sp.together(f - polynomial) / U**K)
        return polynomial + U**K * parts.setdefault(rest, sp.Dummy())

    shown = in_exponentials(h)
    below = reciprocals(shown)
    shown = shown.replace(lambda e: isinstance(e, (sp.sin, sp.cos, sp.exp)), function)
    return sp.expand(shown.xreplace({f: reciprocal(f) for f in below}))


def tie_certificate(family: Family, form: Echelon, document: dict[str, Any]) -> dict[str, Any]:
    """A certificate of the rescaled problem with the identities that tie it to the original."""
    ties = [
        tie_identity(form, i, row, text, family.parameter)
        for row, panel in zip(family.rows, document["panels"], strict=True)
        for i, text in enumerate(panel["H"])
    ]
    return {"kind": "all", "of": [document, *ties]}


def tie_identity(form: Echelon, i: int, row: Sequence[sp.Expr], text: str, T: sp.Symbol) -> dict[str, Any]:
    """``H_i T**k_i = sum_j A_ij H_j(T u)``."""
    pairs = [(to_rational(form.basis[i, j]), h.subs(U, T * U)) for j, h in enumerate(row)]
    right = " + ".join(f"({to_text(a)})*({to_text(h)})" for a, h in pairs if a != 0)
    left = f"({text})*{T.name}**{form.lows[i]}"
    return {"kind": "identity", "left": left, "right": right, "symbols": [T.name, U.name]}


MOST_CELLS = 10_000


def follow_regime(
    family: Family, pattern: Pattern, lower: fmpq, upper: fmpq, enough: Callable[[], bool] = never
) -> RangeProof:
    """Certificate pieces for the pattern between two values, as far as the tests pass and until it is enough."""
    form = echelon_form(family) if family.growing else None
    if form is None:
        least = max(lower, upper / 400) if family.growing else lower
        found = follow_from_middle(family, pattern, least, upper, enough)
        return RangeProof(tuple(found), tuple(range_certificates(family, found)))
    start, documents = [], []
    scaled = rescale_family(family, form)
    if lower == 0:
        near = rescale_family(family, form, entire=True)
        start = follow_from_zero(near, scaled, form.reach, pattern, upper, enough)
        if not start:
            return RangeProof((), ())
        lower = start[-1].upper
        documents += range_certificates(near, start)
    rest = follow_from_middle(scaled, pattern, lower, upper, enough) if lower < upper else []
    if rest and lower < rest[0].lower and not enough():
        rest = [*follow_from_middle(scaled, pattern, lower, rest[0].lower, enough), *rest]
    documents += range_certificates(scaled, rest)
    return RangeProof((*start, *rest), tuple(tie_certificate(family, form, document) for document in documents))


def follow_from_middle(
    family: Family, pattern: Pattern, lower: fmpq, upper: fmpq, enough: Callable[[], bool]
) -> list[RangePiece]:
    """Pieces from the middle towards both ends; in a turned basis where the first one makes none."""
    found: list[RangePiece] = []
    for basis in (conditioning_matrix, reflected_matrix):
        found = follow_pattern(track_pattern(family, family, pattern, basis), lower, upper, enough)
        if found or enough():
            break
    return found


def covered(pieces: Sequence[RangePiece]) -> list[tuple[fmpq, fmpq]]:
    """Ranges that pieces in order cover, neighbours joined; pieces from zero and from the middle need not meet."""
    return join_intervals([(one.lower, one.upper) for one in pieces])


def range_certificates(family: Family, pieces: Sequence[RangePiece]) -> list[dict[str, Any]]:
    """The range certificates of pieces in order."""
    return [range_document(family.moving, family.parameter.name, part) for part in group_pieces(pieces)]


def group_pieces(pieces: Sequence[RangePiece]) -> list[list[RangePiece]]:
    """Neighbours in groups that take no more cells together than a checker allows one certificate."""
    done: list[list[RangePiece]] = []
    used = MOST_CELLS
    for one in pieces:
        apart = bool(done) and done[-1][-1].upper != one.lower
        if apart or used + one.cells > MOST_CELLS:
            done.append([])
            used = 0
        done[-1].append(one)
        used += one.cells
    return done


def track_pattern(
    family: Family, members: Family, pattern: Pattern, basis: Callable[[Family, fmpq], fmpq_mat]
) -> PatternTrack:
    """What is followed of a family; its first solution comes from the members of an equal one."""
    first = partial(pattern_member, members, pattern)
    return PatternTrack(family.moving, family.parameter, pattern, first, partial(basis, family))


def follow_from_zero(
    near: Family, scaled: Family, reach: fmpq, pattern: Pattern, upper: fmpq, enough: Callable[[], bool]
) -> list[RangePiece]:
    """Pieces from the length zero on, as far as the entire functions of the rows reach.

    scaled : the same family where balls and doubles have values: for lengths above zero
    """
    track = track_pattern(near, scaled, pattern, unit_matrix)
    last = min(upper, short_decimal(reach, reach))
    end = short_decimal(last * fmpq(7, 8), last)
    for _ in range(12):
        if enough():
            break
        start = track.first(end / 2)
        first = None if start is None else verify_piece(track, start, fmpq(0), end)
        if first is not None:
            return [first, *march_pieces(track, first.ends[1], end, last, 3, enough)]
        end = short_decimal(end / 2, end)
    return []


def pattern_member(family: Family, pattern: Pattern, p: fmpq) -> Member | None:
    """The solution at a value whose pattern can be told in double precision."""
    found = sharp_member(family, to_fraction(p), pattern)
    if found is None:
        return None
    done = found.polished
    return Member(*(list(map(to_fmpq, part)) for part in (done.dual, done.v, done.weights)))


def unit_matrix(family: Family, _: fmpq) -> fmpq_mat:
    """No other basis: rows that are scaled are as independent as powers."""
    m = len(family.functional)
    return fmpq_mat(m, m, [int(i == j) for i in range(m) for j in range(m)])


def conditioning_matrix(family: Family, p: fmpq) -> fmpq_mat:
    """The orthonormalising matrix at a value, rounded to twelve digits."""
    basis = make_basis(family.exact(to_rational(p)))
    m = basis.transform.nrows()
    return fmpq_mat(m, m, [from_decimal(decimal(basis.transform[i, j], 12)) for i in range(m) for j in range(m)])


def reflected_matrix(family: Family, p: fmpq) -> fmpq_mat:
    """The conditioning matrix after a reflection along (1, ..., m).

    The boxes of the proof are as large as the unknowns that move in them; an unknown of the dual that is zero for all
    values has no size of its own.
    """
    A = conditioning_matrix(family, p)
    m = A.nrows()
    squares = sum(k * k for k in range(1, m + 1))
    mirror = [fmpq(int(i == j)) - fmpq(2 * (i + 1) * (j + 1), squares) for i in range(m) for j in range(m)]
    return fmpq_mat(m, m, mirror) * A
