"""Regimes without a closed form: followed and certified for every value of the parameter."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import sympy as sp
from flint import arb, arb_mat, arb_series, fmpq, fmpq_mat

from navsym import checker
from navsym.core.balls import enclose, series_terms
from navsym.core.exact import decimal, from_decimal, to_fmpq, to_fraction, to_rational
from navsym.guaranteed.certificate.basis import make_basis
from navsym.guaranteed.certificate.enclosure import interval_ball
from navsym.guaranteed.certificate.moving import (
    Member,
    MovingProblem,
    VanishingProblem,
    rational_functional,
    series_coefficient,
)
from navsym.guaranteed.certificate.range import (
    BITS,
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
    """Rational A, the first powers of its rows, the power for the functional, coefficients of A H by panel.

    reach : the length up to which every argument stays within REACH
    """

    basis: fmpq_mat
    lows: tuple[int, ...]
    shift: int
    exact: tuple[fmpq_mat, ...]
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
    exact = tuple(A * fmpq_mat(m, count, [c for row in t for c in row]) for t in tables if t is not None)
    image = A * fmpq_mat(m, 1, rational_functional(family.moving))
    shift = max(low for i, low in enumerate(lows) if image[i, 0] != 0)
    return Echelon(A, lows, shift, exact, REACH / max(rates) if rates else fmpq(10**6))


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


def scaled_problem(family: Family, form: Echelon, start: fmpq, end: fmpq) -> VanishingProblem:
    """The scaled problem for lengths from start to end: exact coefficients, and the last one over [0, end]."""
    m, count = form.basis.nrows(), form.exact[0].ncols()
    mix = arb_mat(m, m, [arb(a) for a in form.basis.entries()])
    local = []
    for panel, table in zip(family.moving.panels, form.exact, strict=True):
        with series_terms(count + 1):
            sigma = enclose(panel.sigma, bits=BITS)
            whole = panel.program.run({panel.variable: arb_series([interval_ball(fmpq(0), end), arb(1)])})
            last = mix * arb_mat([[series_coefficient(h, count)] for h in whole])
        rows = [[arb(table[i, k]) / sigma for k in range(count)] + [last[i, 0] / sigma] for i in range(m)]
        local.append(tuple(tuple(row) for row in rows))
    middle, half = (start + end) / 2, (end - start) / 2
    return VanishingProblem(
        family.moving, family.parameter, form.basis, middle, half, form.lows, form.shift, tuple(local)
    )


# -- the certificate: regressors written with entire functions ---------------------------------------


def scaled_certificate(family: Family, form: Echelon, pieces: Sequence[RangePiece]) -> dict[str, Any]:
    """A range certificate of the scaled problem on [0, 1], and the identities that tie it to the original.

    ``sin_k(x)`` is sin(x) less its Taylor polynomial of degree below k, divided by x**k, and so for the others.
    """
    m, T = len(family.functional), family.parameter.name
    v = "v" if T != "v" else "place"
    document = plain_certificate(family, pieces)
    for row, panel in zip(family.rows, document["panels"], strict=True):
        panel |= {"from": "0", "to": "1", "H": [scaled_row_text(form, i, row, T, v) for i in range(m)]}
    unit = [[str(int(i == j)) for j in range(m)] for i in range(m)]
    own = {"functional": scaled_functional(family, form), "pieces": [p.row | {"basis": unit} for p in pieces]}
    return tie_certificate(family, form, document | own | {"variable": v})


def rescale_family(family: Family, form: Echelon) -> Family:
    """The same problems with places as shares of the interval and rows scaled, for lengths above zero."""
    T, m = family.parameter, len(family.functional)
    rows = tuple(
        tuple(
            sum((to_rational(form.basis[i, j]) * h.subs(U, T * U) for j, h in enumerate(row)), sp.S.Zero)
            / T ** form.lows[i]
            for i in range(m)
        )
        for row in family.rows
    )
    image = form.basis * fmpq_mat(m, 1, rational_functional(family.moving))
    functional = tuple(to_rational(image[i, 0]) * T ** (form.shift - low) for i, low in enumerate(form.lows))
    return replace(family, rows=rows, functional=functional, start=sp.S.Zero, end=sp.S.One)


def tie_certificate(family: Family, form: Echelon, document: dict[str, Any]) -> dict[str, Any]:
    """A certificate of the rescaled problem with the identities that tie it to the original."""
    T, v = family.parameter, document["variable"]
    ties = [
        tie_identity(form, i, row, text, T, v)
        for row, panel in zip(family.rows, document["panels"], strict=True)
        for i, text in enumerate(panel["H"])
    ]
    return {"kind": "all", "of": [document, *ties]}


def scaled_row_text(form: Echelon, i: int, row: tuple[sp.Expr, ...], T: str, v: str) -> str:
    """Row i of ``A H(T v) / T**k_i``, powers cancelled."""
    parts: dict[sp.Symbol, str] = {}
    K = max(form.lows) + 1
    total = sum(
        (to_rational(form.basis[i, j]) * expand_functions(h, K, T, v, parts) for j, h in enumerate(row)), sp.S.Zero
    )
    terms = []
    for (power,), factor in sp.Poly(sp.expand(total), U).terms():
        for monomial, c in sp.Poly(factor, *parts).terms() if parts else [((), factor)]:
            texts = [f"({to_text(c)})", f"{T}**{power - form.lows[i]}", f"{v}**{power}"]
            texts += [f"{name}**{n}" for name, n in zip(parts.values(), monomial, strict=True) if n]
            terms.append("*".join(texts))
    return " + ".join(terms)


def expand_functions(h: sp.Expr, K: int, T: str, v: str, parts: dict[sp.Symbol, str]) -> sp.Expr:
    """h with every function written as its Taylor polynomial and ``(c u)**K`` times an entire function.

    A reciprocal is written as its Taylor polynomial and ``u**K`` times a rational function.
    """

    def function(f: sp.Expr) -> sp.Expr:
        c, name = sp.expand(f.args[0] / U), {sp.sin: "sin", sp.cos: "cos", sp.exp: "exp"}[f.func]
        symbol = sp.Symbol(f"{name}[{c}]")
        parts[symbol] = f"{name}_{K}(({to_text(c)})*{T}*{v})"
        return taylor_polynomial(name, c, K) + (c * U) ** K * symbol

    def reciprocal(f: sp.Expr) -> sp.Expr:
        (table,), symbol = taylor_table((f,), K) or ([],), sp.Symbol(f"rest[{f}]")
        polynomial = sum((to_rational(a) * U**k for k, a in enumerate(table)), sp.S.Zero)
        rest = sp.cancel(sp.together(f - polynomial) / U**K)
        parts[symbol] = f"({to_text(rest.subs(U, sp.Symbol(T, real=True) * sp.Symbol(v, real=True)))})"
        return polynomial + U**K * symbol

    shown = in_exponentials(h)
    below = reciprocals(shown)
    shown = shown.replace(lambda e: isinstance(e, (sp.sin, sp.cos, sp.exp)), function)
    return sp.expand(shown.xreplace({f: reciprocal(f) for f in below}))


def taylor_polynomial(name: str, c: sp.Rational, K: int) -> sp.Expr:
    """Taylor polynomial, of degree below K, of exp, sin or cos of c u."""
    signs = {"exp": lambda k: 1, "sin": lambda k: (0, 1, 0, -1)[k % 4], "cos": lambda k: (1, 0, -1, 0)[k % 4]}
    return sum((signs[name](k) * (c * U) ** k / sp.factorial(k) for k in range(K)), sp.S.Zero)


def tie_identity(form: Echelon, i: int, row: tuple[sp.Expr, ...], text: str, T: sp.Symbol, v: str) -> dict[str, Any]:
    """``H_i T**k_i = sum_j A_ij H_j(T v)``."""
    place = sp.Symbol(v, real=True)
    pairs = [(to_rational(form.basis[i, j]), h.subs(U, T * place)) for j, h in enumerate(row)]
    right = " + ".join(f"({to_text(a)})*({to_text(h)})" for a, h in pairs if a != 0)
    return {"kind": "identity", "left": f"({text})*{T.name}**{form.lows[i]}", "right": right, "symbols": [T.name, v]}


def scaled_functional(family: Family, form: Echelon) -> list[str]:
    """``(A P)_i T**(shift - k_i)`` as texts for the certificate."""
    image = form.basis * fmpq_mat(form.basis.nrows(), 1, rational_functional(family.moving))
    T = family.parameter.name
    return [
        f"({to_text(to_rational(image[i, 0]))})*{T}**{form.shift - low}" if image[i, 0] != 0 else "0"
        for i, low in enumerate(form.lows)
    ]


MOST_CELLS = 10_000


def follow_regime(
    family: Family, pattern: Pattern, lower: fmpq, upper: fmpq, enough: Callable[[], bool] = never
) -> RangeProof:
    """Certificate pieces for the pattern between two values, as far as the tests pass and until it is enough."""
    form = echelon_form(family) if family.growing else None
    if form is None:
        least = max(lower, upper / 400) if family.growing else lower
        found = follow_from_middle(family, pattern, least, upper, enough)
        documents = [plain_certificate(family, part) for part in group_pieces(found)]
        return RangeProof(tuple(found), tuple(documents))
    start, documents = [], []
    if lower == 0:
        start = follow_from_zero(family, form, pattern, upper, enough)
        if not start:
            return RangeProof((), ())
        lower = start[-1].upper
        documents += [scaled_certificate(family, form, part) for part in group_pieces(start)]
    scaled_family = rescale_family(family, form)
    rest = follow_from_middle(scaled_family, pattern, lower, upper, enough) if lower < upper else []
    if rest and lower < rest[0].lower and not enough():
        rest = [*follow_from_middle(scaled_family, pattern, lower, rest[0].lower, enough), *rest]
    documents += [tie_certificate(family, form, plain_certificate(scaled_family, part)) for part in group_pieces(rest)]
    return RangeProof((*start, *rest), tuple(documents))


def follow_from_middle(
    family: Family, pattern: Pattern, lower: fmpq, upper: fmpq, enough: Callable[[], bool]
) -> list[RangePiece]:
    """Pieces from the middle towards both ends; in a turned basis where the first one makes none."""
    found = follow_pattern(plain_track(family, pattern, conditioning_matrix), lower, upper, enough)
    if found or enough():
        return found
    return follow_pattern(plain_track(family, pattern, reflected_matrix), lower, upper, enough)


def covered(pieces: Sequence[RangePiece]) -> list[tuple[fmpq, fmpq]]:
    """Ranges that pieces in order cover, neighbours joined; pieces from zero and from the middle need not meet."""
    return join_intervals([(one.lower, one.upper) for one in pieces])


def plain_certificate(family: Family, pieces: Sequence[RangePiece]) -> dict[str, Any]:
    """The range certificate of pieces that lie next to each other."""
    return range_document(family.moving, family.parameter.name, pieces)


def checker_accepts(document: Callable[[Sequence[RangePiece]], dict[str, Any]]) -> Callable[[RangePiece], bool]:
    """A predicate: the independent checker accepts the certificate of a piece alone.

    Its balls come from texts, and are not those of the proof here.
    """

    def accepts(one: RangePiece) -> bool:
        try:
            checker.check(checker.load(json.dumps(document([one]))))
        except checker.Refused:
            return False
        return True

    return accepts


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


def plain_track(family: Family, pattern: Pattern, basis: Callable[[Family, fmpq], fmpq_mat]) -> PatternTrack:
    """The problem in a basis at a value of the parameter, which is renewed now and then."""
    bases: list[tuple[fmpq, fmpq, fmpq_mat]] = []

    def moving(a: fmpq, b: fmpq) -> MovingProblem:
        middle, half = (a + b) / 2, (b - a) / 2
        if not bases or abs(middle - bases[-1][0]) > 2 * bases[-1][1]:
            bases.append((middle, half, basis(family, middle)))
        return MovingProblem(family.moving, family.parameter, bases[-1][2], middle, half)

    first, holds = partial(pattern_member, family, pattern), checker_accepts(partial(plain_certificate, family))
    return PatternTrack(family.moving, family.parameter, pattern, first, moving, holds)


def follow_from_zero(
    family: Family, form: Echelon, pattern: Pattern, upper: fmpq, enough: Callable[[], bool]
) -> list[RangePiece]:
    """Pieces from the length zero on, scaled by powers of the length, as far as their series are sharp."""
    track = PatternTrack(
        family.moving,
        family.parameter,
        pattern,
        partial(pattern_member, family, pattern),
        partial(scaled_problem, family, form),
        checker_accepts(lambda part: scaled_certificate(family, form, part)["of"][0]),
    )
    last = min(short_decimal(upper * fmpq(7, 8), upper), short_decimal(form.reach, form.reach))
    end = last
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
    done, problem = found.polished, family.exact(to_rational(p))
    weights = [w * problem.panels[k].bound() for w, k in zip(done.weights, done.panel, strict=True)]
    return Member(tuple(map(to_fmpq, done.dual)), tuple(map(to_fmpq, done.v)), tuple(map(to_fmpq, weights)))


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
