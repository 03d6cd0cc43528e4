"""Regimes without a closed form: followed and certified for every value of the parameter."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import partial
from typing import Any

from flint import fmpq, fmpq_mat

from navsym import checker
from navsym.methods.phases.closed import refined
from navsym.methods.phases.family import Family
from navsym.methods.phases.scan import Pattern
from navsym.methods.phases.vanishing import Echelon, echelon, rescaled, scaled, scaled_certificate, tied
from navsym.proof.balls import exact_rational
from navsym.proof.decimals import decimal, exact
from navsym.proof.optimality.basis import make_basis
from navsym.proof.optimality.enclosure import rational
from navsym.proof.optimality.march import follow, march, never, simple
from navsym.proof.optimality.moving import Member, Moving
from navsym.proof.optimality.range import Piece, Ranged, Track, piece, range_document

MOST_CELLS = 10_000


def fraction_of(x: fmpq) -> Fraction:
    """The same rational number for Python."""
    return Fraction(int(x.p), int(x.q))


def followed(family: Family, pattern: Pattern, lower: fmpq, upper: fmpq, enough: Callable[[], bool] = never) -> Ranged:
    """Certificate pieces for the pattern between two values, as far as the tests pass and until it is enough."""
    form = echelon(family) if family.growing else None
    if form is None:
        least = max(lower, upper / 400) if family.growing else lower
        found = from_middle(family, pattern, least, upper, enough)
        documents = [plain(family, part) for part in parts(found)]
        return Ranged(tuple(found), tuple(documents))
    start, documents = [], []
    if lower == 0:
        start = from_zero(family, form, pattern, upper, enough)
        if not start:
            return Ranged((), ())
        lower = start[-1].upper
        documents += [scaled_certificate(family, form, part) for part in parts(start)]
    scaled_family = rescaled(family, form)
    rest = from_middle(scaled_family, pattern, lower, upper, enough) if lower < upper else []
    if rest and lower < rest[0].lower and not enough():
        rest = [*from_middle(scaled_family, pattern, lower, rest[0].lower, enough), *rest]
    documents += [tied(family, form, plain(scaled_family, part)) for part in parts(rest)]
    return Ranged((*start, *rest), tuple(documents))


def from_middle(family: Family, pattern: Pattern, lower: fmpq, upper: fmpq, enough: Callable[[], bool]) -> list[Piece]:
    """Pieces from the middle towards both ends; in a turned basis where the first one makes none."""
    accepts = accepted_by(partial(plain, family))
    found = follow(plain_track(family, pattern, conditioner), lower, upper, enough, accepts)
    return found or ([] if enough() else follow(plain_track(family, pattern, turned), lower, upper, enough, accepts))


def covered(pieces: Sequence[Piece]) -> list[tuple[fmpq, fmpq]]:
    """Ranges that pieces in order cover, neighbours joined; pieces from zero and from the middle need not meet."""
    done: list[tuple[fmpq, fmpq]] = []
    for one in pieces:
        start = done.pop()[0] if done and done[-1][1] == one.lower else one.lower
        done.append((start, one.upper))
    return done


def plain(family: Family, pieces: Sequence[Piece]) -> dict[str, Any]:
    """The range certificate of pieces that lie next to each other."""
    return range_document(family.moving, family.parameter.name, pieces)


def accepted_by(document: Callable[[Sequence[Piece]], dict[str, Any]]) -> Callable[[Piece], bool]:
    """Whether the independent checker accepts the certificate of a piece alone: its balls come from texts, and are not
    those of the proof here."""

    def accepts(one: Piece) -> bool:
        try:
            checker.check(checker.load(json.dumps(document([one]))))
        except checker.Refused:
            return False
        return True

    return accepts


def parts(pieces: Sequence[Piece]) -> list[list[Piece]]:
    """Neighbours in groups that take no more cells together than a checker allows one certificate."""
    done: list[list[Piece]] = []
    used = MOST_CELLS
    for one in pieces:
        apart = bool(done) and done[-1][-1].upper != one.lower
        if apart or used + one.cells > MOST_CELLS:
            done.append([])
            used = 0
        done[-1].append(one)
        used += one.cells
    return done


def plain_track(family: Family, pattern: Pattern, basis: Callable[[Family, fmpq], fmpq_mat]) -> Track:
    """The problem in a basis at a value of the parameter, which is renewed now and then."""
    bases: list[tuple[fmpq, fmpq, fmpq_mat]] = []

    def moving(a: fmpq, b: fmpq) -> Moving:
        middle, half = (a + b) / 2, (b - a) / 2
        if not bases or abs(middle - bases[-1][0]) > 2 * bases[-1][1]:
            bases.append((middle, half, basis(family, middle)))
        return Moving(family.moving, family.parameter, bases[-1][2], middle, half)

    return Track(family.moving, family.parameter, pattern, lambda p: member(family, pattern, p), moving)


def from_zero(family: Family, form: Echelon, pattern: Pattern, upper: fmpq, enough: Callable[[], bool]) -> list[Piece]:
    """Pieces from the length zero on, scaled by powers of the length, as far as their series are sharp."""
    track = Track(
        family.moving,
        family.parameter,
        pattern,
        lambda p: member(family, pattern, p),
        lambda a, b: scaled(family, form, a, b),
    )
    accepts = accepted_by(lambda part: scaled_certificate(family, form, part)["of"][0])
    last = min(simple(upper * fmpq(7, 8), upper), simple(form.reach, form.reach))
    end = last
    for _ in range(12):
        if enough():
            break
        start = track.first(end / 2)
        first = None if start is None else piece(track, start, fmpq(0), end)
        if first is not None and accepts(first):
            return [first, *march(track, first.ends[1], end, last, 3, enough, accepts)]
        end = simple(end / 2, end)
    return []


def member(family: Family, pattern: Pattern, p: fmpq) -> Member | None:
    """The solution at a value whose pattern can be told in double precision."""
    found = refined(family, fraction_of(p), pattern)
    if found is None:
        return None
    done, problem = found.polished, family.exact(exact_rational(p))
    weights = [w * problem.panels[k].bound() for w, k in zip(done.weights, done.panel, strict=True)]
    return Member(tuple(map(rational, done.dual)), tuple(map(rational, done.v)), tuple(map(rational, weights)))


def conditioner(family: Family, p: fmpq) -> fmpq_mat:
    """The orthonormalising matrix at a value, rounded to twelve digits."""
    basis = make_basis(family.exact(exact_rational(p)))
    m = basis.transform.nrows()
    return fmpq_mat(m, m, [exact(decimal(basis.transform[i, j], 12)) for i in range(m) for j in range(m)])


def turned(family: Family, p: fmpq) -> fmpq_mat:
    """The same after a reflection along (1, ..., m): the boxes of the proof are as large as what moves in them, and an
    unknown of the dual that is zero for all values has no size of its own."""
    A = conditioner(family, p)
    m = A.nrows()
    squares = sum(k * k for k in range(1, m + 1))
    mirror = [fmpq(int(i == j)) - fmpq(2 * (i + 1) * (j + 1), squares) for i in range(m) for j in range(m)]
    return fmpq_mat(m, m, mirror) * A
