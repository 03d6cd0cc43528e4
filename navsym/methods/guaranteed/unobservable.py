"""Directions of the state that no measurement shows, exactly, where F depends on the time.

A solution x of dx/dt = F x has ``d^k/dt^k (h x) = o_k x`` with ``o_0 = h``, ``o_(k+1) = o_k' + o_k F``. Rows that are
independent at T are taken, N is what they all take to zero: ``R N = 0`` with an identity matrix in the other rows.
Where ``h N = 0`` and ``N' - F N = N M`` identically, the solutions through N(T) stay in the columns of N,
``x = N c`` with ``c' = -M c``, and no measurement shows them next to T; where F and h are analytic on the interval,
nowhere on it. A rank decides nothing here: the two identities do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp
from flint import arb, arb_series, fmpq

from navsym.claims import PROVED, Equation
from navsym.methods.guaranteed.varying import exact_end
from navsym.proof.balls import UnsupportedError, enclose, precision
from navsym.proof.ladder import decide
from navsym.proof.optimality.enclosure import coefficients, interval, terms
from navsym.proof.optimality.tapes import program
from navsym.text.modeltypes import ModelFile, Piece

BITS = 256
#: Rows with more operations than this are not differentiated again; a pivot below this is called zero (a guess).
LONGEST, NOTHING = 3000, arb(10) ** -40
#: Parts of the interval on which a regressor is shown to be analytic.
MOST_PARTS = 400


@dataclass(frozen=True, slots=True)
class Direction:
    """A state at T whose motion no measurement shows; the entry ``at`` is one."""

    entries: tuple[sp.Expr, ...]
    at: int


def null_directions(found: ModelFile) -> list[Direction]:
    """Independent directions, exact; empty where none is proved. No two have an entry at each other's place.

    h and F must be analytic on every piece. Where two pieces meet, the columns of the later one must lie among those
    of the earlier one: ``x = N c`` goes on to the start of a piece, as N is meromorphic beside the interval.
    """
    T, after = found.T, None
    if T is None or not T.is_Rational:
        return []
    directions: list[Direction] = []
    try:
        for piece in reversed(found.pieces):
            end = T if piece.end is None else piece.end
            part = kernel_of(found, piece, end)
            if part is None or not analytic(found, piece, end):
                return []
            N, free = part
            at_end = N.subs(found.time, end)
            if after is None:
                directions = [Direction(tuple(at_end[:, k]), j) for k, j in enumerate(free)]
            elif not vanishes(after - at_end * after.extract(free, list(range(after.cols)))):
                return []
            after = N.subs(found.time, piece.start)
    except UnsupportedError:
        return []
    return directions


def vanishes(matrix: sp.Matrix) -> bool:
    """Every entry is proved to be zero."""
    return all(entry == 0 or decide(Equation(entry, sp.S.Zero)).status is PROVED for entry in matrix)


def kernel_of(found: ModelFile, piece: Piece, end: sp.Expr) -> tuple[sp.Matrix, list[int]] | None:
    """N on a piece with its identities proved, and its free rows; None where there is none."""
    R, pivots = independent_rows(found, piece, end)
    free = [j for j in range(len(found.states)) if j not in pivots]
    if R is None or not free:
        return None
    N = kernel(R, pivots, free, found.time)
    return (N, free) if shown(found, piece, N, free) else None


def kernel(R: sp.Matrix, pivots: Sequence[int], free: Sequence[int], time: sp.Symbol) -> sp.Matrix:
    """N with ``R N = 0`` and an identity matrix in the free rows."""
    N = sp.zeros(R.cols, len(free))
    for k, j in enumerate(free):
        N[j, k] = sp.S.One
    if R.rows:
        block = R[:, list(pivots)]
        shares = block.adjugate() * R[:, list(free)] / block.det(method="berkowitz")
        short = sp.cancel if all(entry.is_rational_function(time) for entry in shares) else sp.factor_terms
        for i, j in enumerate(pivots):
            N[j, :] = -shares[i, :].applyfunc(short)
    return N


def independent_rows(found: ModelFile, piece: Piece, end: sp.Expr) -> tuple[sp.Matrix | None, list[int]]:
    """Rows o_k that are independent at the end of a piece, and the columns of a regular block of them there."""
    F, time = piece.F, found.time
    waiting = [sp.Matrix([list(measurement.h)]) for measurement in found.measurements]
    chosen: list[sp.Matrix] = []
    reduced: list[list[arb]] = []
    pivots: list[int] = []
    while waiting:
        row = waiting.pop(0)
        if row.has(sp.zoo, sp.nan) or sp.count_ops(row) > LONGEST:
            return None, []
        with precision(BITS):
            left = remaining([enclose(f.subs(time, end), bits=BITS) for f in row], reduced, pivots)
            best = max(range(len(left)), key=lambda j: float(abs(left[j]).lower()))
            if not bool(abs(left[best]) > NOTHING):
                continue
            reduced.append([f / left[best] for f in left])
        pivots.append(best)
        chosen.append(row)
        waiting.append((row.diff(time) + row * F).applyfunc(sp.expand))
    return (sp.Matrix.vstack(*chosen) if chosen else sp.zeros(0, F.cols)), pivots


def remaining(row: list[arb], reduced: Sequence[Sequence[arb]], pivots: Sequence[int]) -> list[arb]:
    """The row without its parts along rows that are one at their pivots."""
    for other, pivot in zip(reduced, pivots, strict=True):
        share = row[pivot]
        row = [f - share * g for f, g in zip(row, other, strict=True)]
    return row


def shown(found: ModelFile, piece: Piece, N: sp.Matrix, free: Sequence[int]) -> bool:
    """N has values at the ends of the piece, and the identities ``h N = 0`` and ``N' - F N = N M`` are proved."""
    for end in (piece.start, found.T if piece.end is None else piece.end):
        if not all(enclose(entry, bits=BITS).is_finite() for entry in N.subs(found.time, end)):
            return False
    moved = N.diff(found.time) - piece.F * N
    defect = moved - N * moved.extract(list(free), list(range(N.cols)))
    H = sp.Matrix([list(measurement.h) for measurement in found.measurements])
    return vanishes(H * N) and vanishes(defect)


def analytic(found: ModelFile, piece: Piece, end: sp.Expr) -> bool:
    """Every entry of F and h has series in balls about every place of the piece, on parts of it."""
    entries = {*piece.F, *(h for measurement in found.measurements for h in measurement.h)}
    return all(
        entry.is_polynomial(found.time) or resolved(entry, found.time, exact_end(piece.start), exact_end(end))
        for entry in entries
    )


def resolved(entry: sp.Expr, time: sp.Symbol, start: fmpq, end: fmpq) -> bool:
    """The series of an entry exist on parts of [start, end]."""
    tape, waiting, used = program([entry]), [(start, end)], 0
    while waiting and used < MOST_PARTS:
        lower, upper = waiting.pop()
        used += 1
        with terms(2):
            value = coefficients(tape.run({time: arb_series([interval(lower, upper), arb(1)])})[0], 1)
        if not all(c.is_finite() for c in value):
            middle = (lower + upper) / 2
            waiting += [(lower, middle), (middle, upper)]
    return not waiting
