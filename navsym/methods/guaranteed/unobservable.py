"""Directions of the state that no measurement shows, exactly, where F depends on the time.

A solution x of dx/dt = F x has ``d^k/dt^k (h x) = o_k x`` with ``o_0 = h``, ``o_(k+1) = o_k' + o_k F``. Rows that are
independent at T are taken, N is what they all take to zero: ``R N = 0`` with an identity matrix in the other rows.
Where ``h N = 0`` and ``N' - F N = N M`` identically, the solutions through N(T) stay in the columns of N,
``x = N c`` with ``c' = -M c``, and no measurement shows them next to T; where F and h are analytic on the interval,
nowhere on it. A rank decides nothing here: the two identities do.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import sympy as sp
from flint import arb, arb_series, fmpq

from navsym.claims import PROVED, Equation
from navsym.methods.guaranteed.varying import exact_end
from navsym.proof.balls import UnsupportedError, enclose, precision
from navsym.proof.ladder import decide
from navsym.proof.optimality.enclosure import coefficients, interval, terms
from navsym.proof.optimality.tapes import program
from navsym.text.modeltypes import ModelFile

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

    Only for models in one piece; h and F must be analytic on the interval.
    """
    T = found.T
    if T is None or not T.is_Rational or len(found.pieces) > 1:
        return []
    try:
        R, pivots = independent_rows(found, T)
        free = [j for j in range(len(found.states)) if j not in pivots]
        if R is None or not free:
            return []
        N = kernel(R, pivots, free, found.time)
        if not shown(found, N, free) or not all(analytic(found, entry) for entry in entries_of(found)):
            return []
    except UnsupportedError:
        return []
    at_end = N.subs(found.time, T)
    return [Direction(tuple(at_end[:, k]), j) for k, j in enumerate(free)]


def entries_of(found: ModelFile) -> Iterator[sp.Expr]:
    """Every entry of F and of the measurements."""
    yield from found.pieces[0].F
    for measurement in found.measurements:
        yield from measurement.h


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


def independent_rows(found: ModelFile, T: sp.Expr) -> tuple[sp.Matrix | None, list[int]]:
    """Rows o_k that are independent at T, and the columns of a regular block of them there."""
    F, time = found.pieces[0].F, found.time
    waiting = [sp.Matrix([list(measurement.h)]) for measurement in found.measurements]
    chosen: list[sp.Matrix] = []
    reduced: list[list[arb]] = []
    pivots: list[int] = []
    while waiting:
        row = waiting.pop(0)
        if row.has(sp.zoo, sp.nan) or sp.count_ops(row) > LONGEST:
            return None, []
        with precision(BITS):
            left = remaining([enclose(f.subs(time, T), bits=BITS) for f in row], reduced, pivots)
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


def shown(found: ModelFile, N: sp.Matrix, free: Sequence[int]) -> bool:
    """N has a value at T, and the identities ``h N = 0`` and ``N' - F N = N M`` are proved."""
    at_end = [enclose(entry, bits=BITS) for entry in N.subs(found.time, found.T)]
    if not all(entry.is_finite() for entry in at_end):
        return False
    moved = N.diff(found.time) - found.pieces[0].F * N
    defect = moved - N * moved.extract(list(free), list(range(N.cols)))
    H = sp.Matrix([list(measurement.h) for measurement in found.measurements])
    zeros = [entry for entry in [*(H * N), *defect] if entry != 0]
    return all(decide(Equation(entry, sp.S.Zero)).status is PROVED for entry in zeros)


def analytic(found: ModelFile, entry: sp.Expr) -> bool:
    """Series in balls exist about every place of the interval, on parts of it."""
    if entry.is_polynomial(found.time):
        return True
    assert found.T is not None
    tape, waiting, used = program([entry]), [(fmpq(0), exact_end(found.T))], 0
    while waiting and used < MOST_PARTS:
        start, end = waiting.pop()
        used += 1
        with terms(2):
            value = coefficients(tape.run({found.time: arb_series([interval(start, end), arb(1)])})[0], 1)
        if not all(c.is_finite() for c in value):
            middle = (start + end) / 2
            waiting += [(start, middle), (middle, end)]
    return not waiting
