"""Exact contacts for every value of a parameter in a range: Newton's method for intervals along a moving centre.

In a piece of the range the solution is followed by polynomials z(s), ``p = middle + half s``. The optimality
system at the moving centre, ``F(s) = F(z(s), p(s))``, and its derivative are enclosed as power series in s with
a remainder over all |s| <= 1, and so is ``f(v, s) = y(s) . q(v, p(s))`` around every place v. The parameter
may enter the regressors, the ends of the panels, the noise bounds and the functional.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import sympy as sp
from flint import arb, arb_mat, fmpq, fmpq_mat

from navsym import checker
from navsym.core.balls import precision, series_terms
from navsym.core.exact import decimal, from_decimal, to_fmpq
from navsym.guaranteed.certificate.enclosure import PanelProblem
from navsym.guaranteed.certificate.fixed import ENDS, certificate_header
from navsym.guaranteed.certificate.moving import EVERY, Member, MovingProblem, expand_polynomial, series_coefficient

BITS = 192
#: Order of the series in s, the last coefficient over the whole piece; and degree of the curves.
ORDER = 2
DEGREE = 5
DIGITS = 32
#: Cells of one piece: so many for each panel, and so many for each contact.
CELLS, CELLS_EACH = 24, 12
HUGE = 10**9
#: A box has this much more room than Newton's step in it needs, and is tried with so many times what a step took: a
#: checker's balls come from texts.
MARGIN, SLACK = arb(5) / 4, 2
#: Bounds of the value are this part of it wider than what is proved here.
ROOM = 10**6
#: Of what the unknown that moves most needs, relative to its size, every other has this part as well.
SHARE = arb(1) / 4

Pattern = tuple[tuple[int, str, int], ...]


@dataclass(frozen=True, slots=True, eq=False)
class PatternTrack:
    """What is followed: the contacts (panel, end, sign), a first solution, and the problem in a good basis.

    first : p -> Member of this pattern to start from, or None
    basis : p -> the matrix of a good basis there
    bases : (middle, half, basis) of pieces at which the basis was renewed
    """

    problem: PanelProblem
    parameter: sp.Symbol
    pattern: Pattern
    first: Callable[[fmpq], Member | None]
    basis: Callable[[fmpq], fmpq_mat]
    bases: list[tuple[fmpq, fmpq, fmpq_mat]] = field(default_factory=list)

    def moving(self, a: fmpq, b: fmpq) -> MovingProblem:
        """The problem on a piece, in a basis that is renewed now and then."""
        middle, half = (a + b) / 2, (b - a) / 2
        if not self.bases or abs(middle - self.bases[-1][0]) > 2 * self.bases[-1][1]:
            self.bases.append((middle, half, self.basis(middle)))
        return MovingProblem(self.problem, self.parameter, self.bases[-1][2], middle, half)

    def holds(self, piece: RangePiece) -> bool:
        """Whether the checker, whose balls come from texts, accepts the certificate of a piece alone."""
        try:
            checker.check(checker.load(json.dumps(range_document(self.problem, self.parameter.name, [piece]))))
        except checker.Refused:
            return False
        return True


@dataclass(frozen=True, slots=True, eq=False)
class RangePiece:
    """One verified piece: its certificate, cells that suffice, its optima, the solution at either end."""

    lower: fmpq
    upper: fmpq
    row: dict[str, Any]
    cells: int
    value: arb
    ends: tuple[Member, Member]


@dataclass(frozen=True, slots=True, eq=False)
class RangeProof:
    """What was followed, as far as it came: pieces next to each other, in order, and their certificates."""

    pieces: tuple[RangePiece, ...]
    documents: tuple[dict[str, Any], ...]


def range_document(problem: PanelProblem, parameter: str, pieces: Sequence[RangePiece]) -> dict[str, Any]:
    """The certificate of pieces that lie next to each other; its bounds leave room for a checker with wider balls."""
    low, high = (min(to_fmpq(p.value.lower()) for p in pieces), max(to_fmpq(p.value.upper()) for p in pieces))
    room = max(abs(low), abs(high)) / ROOM
    ends = decimal(low - room, 9, -1), decimal(high + room, 9, 1)
    head = certificate_header(problem, "range", BITS, sum(p.cells for p in pieces), *ends)
    over = {"parameter": parameter, "from": str(pieces[0].lower), "to": str(pieces[-1].upper)}
    return head | over | {"pieces": [p.row for p in pieces]}


# -- one piece ---------------------------------------------------------------------------------------


def verify_piece(track: PatternTrack, member: Member, a: fmpq, b: fmpq) -> RangePiece | None:
    """The piece between two values, from a solution near it; None when a test fails.

    Its place in the parameter and its box are searched here; the checker decides whether the optimum is in the box.
    """
    a, b = min(a, b), max(a, b)
    with precision(BITS):
        moving = track.moving(a, b)
        curves = solution_curves(moving, track.pattern, moving.local_member(member))
        box = None if curves is None else find_box(moving, track.pattern, curves)
        if curves is None or box is None:
            return None
        radius, value = box
        ends = tuple(moving.global_member(*curve_values(curves, s, moving.size)) for s in (-1, 1))
        cells = CELLS * len(track.problem.panels) + CELLS_EACH * len(track.pattern)
        found = RangePiece(a, b, piece_row(track, moving, curves, radius), cells, value, ends)  # type: ignore[arg-type]
    return found if track.holds(found) else None


def curve_values(curves: Sequence[Sequence[fmpq]], s: int, m: int) -> tuple[list[fmpq], list[fmpq], list[fmpq]]:
    """Dual, places and weights at s."""
    values = [sum((c * s**k for k, c in enumerate(row)), fmpq(0)) for row in curves]
    l = (len(curves) - m) // 2
    return values[:m], values[m : m + l], values[m + l :]


def solution_curves(
    moving: MovingProblem, pattern: Pattern, start: Sequence[fmpq], degree: int = DEGREE
) -> list[list[fmpq]] | None:
    """Taylor polynomials of the solution about the middle: ``z <- z - F'(0)^-1 F(z(s))``, an order a step."""
    free = free_unknowns(pattern, moving.size)
    found = correct_centre(moving, pattern, [[c] for c in start], free)
    if found is None:
        return None
    curves, inverse = found
    for count in (*range(2, degree + 2), degree + 1):
        with series_terms(count):
            F, _ = moving_system(moving, pattern, curves, {}, arb(0))
            steps = [(inverse * arb_mat([[series_coefficient(f, k)] for f in F])).tolist() for k in range(count)]
        for place, k in enumerate(free):
            c = [*curves[k], *[fmpq(0)] * (count - len(curves[k]))]
            curves[k] = [old - to_fmpq(steps[j][place][0]) for j, old in enumerate(c)]
    return [round_coefficients(c) for c in curves]


def correct_centre(
    moving: MovingProblem, pattern: Pattern, z: list[list[fmpq]], free: Sequence[int]
) -> tuple[list[list[fmpq]], arb_mat] | None:
    """Newton at the middle of the piece; the solution and the inverse of the derivative there."""
    last = None
    for _ in range(8):
        with series_terms(1):
            F, J = moving_system(moving, pattern, z, {}, arb(0))
        inverse = midpoint_inverse([[row_.get(k, arb(0)) for k in free] for row_ in J], 0)
        if inverse is None:
            return None
        steps = (inverse * arb_mat([[series_coefficient(f, 0).mid()] for f in F])).tolist()
        size = max(float(abs(e[0]).mid()) for e in steps)
        if not size < 1e3 or (last is not None and size > 10 * last + 1e-20):
            return None
        for place, k in enumerate(free):
            z[k] = [z[k][0] - to_fmpq(steps[place][0])]
        if size < 1e-28:
            return z, inverse
        last = size
    return (z, inverse) if inverse is not None and size < 1e-15 else None


def round_coefficients(c: Sequence[fmpq]) -> list[fmpq]:
    """Coefficients rounded to DIGITS digits of the largest."""
    scale = max(abs(a) for a in c) or fmpq(1)
    unit = fmpq(1)
    while unit > scale / fmpq(10) ** DIGITS:
        unit = unit / 10
    return [unit * ((a / unit) + fmpq(1, 2)).floor() for a in c]


def midpoint_inverse(J: Sequence[Sequence[Any]], k: int) -> arb_mat | None:
    """Midpoint inverse of coefficient k, or None when it is singular."""
    middle = arb_mat([[series_coefficient(e, k).mid() for e in row] for row in J])
    try:
        found = middle.inv()
    except ZeroDivisionError:
        return None
    good = all(e.is_finite() for row in found.tolist() for e in row)
    return arb_mat([[e.mid() for e in row] for row in found.tolist()]) if good else None


def free_unknowns(pattern: Pattern, m: int) -> list[int]:
    """Unknowns among (y, places, weights): all but the places at ends."""
    l = len(pattern)
    return [k for k in range(m + 2 * l) if not m <= k < m + l or pattern[k - m][1] == "no"]


def moving_system(
    moving: MovingProblem, pattern: Pattern, z: Sequence[Sequence[Any]], radius: dict[int, arb], s: arb
) -> tuple[list[Any], list[dict[int, Any]]]:
    """F and its derivatives as series about s: ``f(v_i) - s_i``, ``w_i f'(v_i)``, ``sum w_i q(v_i) - A P``."""
    m, l = moving.size, len(pattern)
    here = [expand_polynomial(c, s) + radius.get(k, arb(0)) * EVERY for k, c in enumerate(z)]
    y, w = here[:m], here[m + l :]
    F: list[Any] = []
    J: list[dict[int, Any]] = []
    slopes: list[tuple[Any, dict[int, Any]]] = []
    balance = [-t for t in moving.target(s)]
    rows: list[dict[int, Any]] = [{} for _ in range(m)]
    for i, (k, kind, sign) in enumerate(pattern):
        q = moving.rows(k, here[m + i], s)
        f = [dot(y, [row[d] for row in q]) for d in range(3)]
        F.append(f[0] - sign)
        J.append({j: q[j][0] for j in range(m)} | {m + i: f[1]})
        if kind == "no":  # times the weight, as the checker has it: the gradient of sum w_i (f(v_i) - s_i)
            row_ = {j: w[i] * q[j][1] for j in range(m)} | {m + i: 2 * w[i] * f[2], m + l + i: f[1]}
            slopes.append((w[i] * f[1], row_))
        for j in range(m):
            balance[j] = balance[j] + w[i] * q[j][0]
            rows[j] |= {m + i: w[i] * q[j][1], m + l + i: q[j][0]}
    return [*F, *(f for f, _ in slopes), *balance], [*J, *(g for _, g in slopes), *rows]


def dot(x: Sequence[Any], y: Sequence[Any]) -> Any:
    value = x[0] * y[0]
    for a, b in zip(x[1:], y[1:], strict=True):
        value = value + a * b
    return value


def find_box(
    moving: MovingProblem, pattern: Pattern, curves: Sequence[Sequence[fmpq]]
) -> tuple[dict[int, arb], arb] | None:
    """Radii of a box about the curves in which Newton's method holds for all s, and the value there; or None."""
    z = [list(map(arb, c)) for c in curves]
    free = free_unknowns(pattern, moving.size)
    residual = enclose_series(lambda s: moving_system(moving, pattern, z, {}, s)[0])
    radius: dict[int, arb] = {}
    for attempt in range(4):
        move = newton_image(moving, pattern, z, residual, radius, free)
        if move is None or not all(bool(abs(d) < HUGE) for d in move.values()):
            return None
        if attempt and all(bool(abs(d) * MARGIN < radius[k]) for k, d in move.items()):
            spread = {k: abs(move[k]).upper() * SLACK for k in range(moving.size)}
            return radius, value_ball(moving, z[: moving.size], spread)
        radius = {k: arb(from_decimal(decimal(r, 3, 1))) for k, r in box_radius(move, z).items()}
    return None


def box_radius(move: dict[int, arb], z: Sequence[Sequence[arb]]) -> dict[int, arb]:
    """The radius of a box in which Newton's step has more room than it needs."""
    sizes = {k: max(map(abs, z[k]), key=lambda a: float(a.mid())) + arb(10) ** -20 for k in move}
    worst = max((abs(d).upper() / sizes[k] for k, d in move.items()), key=to_fmpq) + arb(10) ** (4 - DIGITS)
    return {k: (SLACK * abs(d).upper() + SHARE * worst * sizes[k]).upper() for k, d in move.items()}


def value_ball(moving: MovingProblem, y: Sequence[Sequence[arb]], spread: dict[int, arb]) -> arb:
    """The optimum ``y . A P`` for all s."""

    def product(s: arb) -> list[Any]:
        return [dot([expand_polynomial(c, s) + spread[j] * EVERY for j, c in enumerate(y)], moving.target(s))]

    return ball_over_piece(enclose_series(product)[0])


def enclose_series(function: Callable[[arb], list[Any]], order: int = ORDER) -> list[list[arb]]:
    """Taylor coefficients about s = 0 of every entry; the last holds over all |s| <= 1."""
    with series_terms(order):
        thin = function(arb(0))
    with series_terms(order + 1):
        wide = function(EVERY)
    return [
        [*(series_coefficient(a, k) for k in range(order)), series_coefficient(b, order)]
        for a, b in zip(thin, wide, strict=True)
    ]


def newton_image(
    moving: MovingProblem,
    pattern: Pattern,
    z: Sequence[Sequence[arb]],
    residual: Sequence[Sequence[arb]],
    radius: dict[int, arb],
    free: Sequence[int],
) -> dict[int, arb] | None:
    """Newton's step from the moving centre for all s, by the derivatives of the whole box.

    None when these look singular. The checker does the same, with balls of the same order.
    """
    n = len(free)

    def entries(s: arb) -> list[Any]:
        J = moving_system(moving, pattern, z, radius, s)[1]
        return [row_.get(k, arb(0)) for row_ in J for k in free]

    J = arb_mat(n, n, [ball_over_piece(e) for e in enclose_series(entries)])
    try:
        moved = J.solve(-arb_mat([[ball_over_piece(r)] for r in residual]), algorithm="precond").entries()
    except ZeroDivisionError:
        return None
    return dict(zip(free, moved, strict=True)) if all(d.is_finite() for d in moved) else None


def ball_over_piece(c: Sequence[arb]) -> arb:
    """A ball around the polynomial for all |s| <= 1."""
    return c[0] + sum((a * EVERY for a in c[1:]), arb(0))


def piece_row(
    track: PatternTrack, moving: MovingProblem, curves: Sequence[Sequence[fmpq]], radius: dict[int, arb]
) -> dict[str, Any]:
    """The piece as plain data. A place at an end is an unknown for the checker, too, with an equation of its own."""
    m, l, smallest = moving.size, len(track.pattern), min(radius.values(), key=to_fmpq)
    text = lambda c: [decimal(a, 60) for a in c]  # noqa: E731
    contacts = [
        {"panel": k, "at": text(curves[m + i]) if kind == "no" else [ENDS[kind]], "weight": text(curves[m + l + i])}
        for i, (k, kind, _) in enumerate(track.pattern)
    ]
    return {
        "from": str(moving.middle - moving.half),
        "to": str(moving.middle + moving.half),
        "basis": [[str(moving.basis[i, j]) for j in range(m)] for i in range(m)],
        "dual": [text(c) for c in curves[:m]],
        "contacts": contacts,
        "radius": [decimal(to_fmpq(radius.get(k, smallest)), 12, 1) for k in range(m + 2 * l)],
    }


# How far a pattern of contacts is followed: pieces of a range next to each other, as long as they pass.


MOST_PIECES = 200
#: Halvings of a step before the march gives up.
MOST_FAILURES = 12
#: Nearer to the end of a regime than this part of it, a sliver takes over.
NEAREST = fmpq(1, 10**16)


def never() -> bool:
    """No limit is met."""
    return False


def follow_pattern(
    track: PatternTrack, lower: fmpq, upper: fmpq, enough: Callable[[], bool] = never
) -> list[RangePiece]:
    """Pieces from the middle towards both ends, each as long as its tests allow, until it is enough."""
    middle = short_decimal((lower + upper) / 2, upper - lower)
    member = track.first(middle)
    if member is None:
        return []
    up = march_pieces(track, member, middle, upper, MOST_FAILURES, enough)
    down = march_pieces(track, up[0].ends[0] if up else member, middle, lower, MOST_FAILURES, enough)
    return [*reversed(down), *up]


def march_pieces(
    track: PatternTrack,
    member: Member,
    at: fmpq,
    last: fmpq,
    failures: int = MOST_FAILURES,
    enough: Callable[[], bool] = never,
) -> list[RangePiece]:
    """Pieces from ``at`` to ``last``, upwards or downwards.

    failures : halvings of one step after which the march stops
    enough   : asked before every step; True stops the march

    Towards the end of a regime a weight, the distance of a contact from an end or the slack below the bound vanishes.
    A piece may then be about as long as the square root of the distance, so steps square their distance.
    """
    pieces: list[RangePiece] = []
    span = abs(last - at)
    step, failed = span / 3, 0
    while at != last and len(pieces) < MOST_PIECES and failed < failures and not enough():
        made = None
        for end in ends_to_try(at, last, step, span):
            made = verify_piece(track, member, at, end)
            if made is not None:
                break
        if made is None:
            if abs(last - at) < span * NEAREST:
                break
            step, failed = step / 2, failed + 1
            continue
        pieces.append(made)
        step = step * (fmpq(5, 4) if failed == 0 else 1)
        failed = 0
        at, member = end, made.ends[1 if end > at else 0]
    return pieces


def ends_to_try(at: fmpq, last: fmpq, step: fmpq, span: fmpq) -> list[fmpq]:
    """The next end; near the last one that first, then one with the distance to it raised to the power 3/2."""
    rest, side = abs(last - at), 1 if last > at else -1
    if step * fmpq(9, 8) < rest:
        return [short_decimal(at + side * step, step)]
    near = rest * to_fmpq(arb(rest / span).sqrt()) / 2
    if rest < span * NEAREST:
        return [last]
    return [last, short_decimal(last - side * near, near), short_decimal(at + side * rest / 2, rest)]


def short_decimal(x: fmpq, step: fmpq) -> fmpq:
    """A short decimal near x, well within the step."""
    unit = fmpq(1)
    while unit > step / 16:
        unit = unit / 10
    return unit * (x / unit).floor()
