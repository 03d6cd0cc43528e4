"""Unknowns that the measurements do not tell apart: the exact relation between their regressors.

Balls tell which regressors are involved; the coefficients are then rational numbers next to the balls, or the
exact solution of as many equations at instants. Only a proof for all instants counts.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import sympy as sp
from flint import arb, arb_series, fmpq

from navsym.claims import PROVED, Equation
from navsym.core.balls import UnsupportedError, enclose, precision, series_terms
from navsym.core.errors import NavsymError, NotEstimableError
from navsym.core.exact import decimal, rational_near
from navsym.core.simplex import independent_rows
from navsym.guaranteed.certificate.enclosure import interval_ball, joint_tape, series_coefficients
from navsym.guaranteed.problem import GuaranteedProblem
from navsym.guaranteed.time_varying import rational_end
from navsym.language.expression import to_text
from navsym.models.modelfile import ModelFile, Piece
from navsym.prove.ladder import decide

# Directions of the state that no measurement shows, exactly, where F depends on the time.
#
# A solution x of dx/dt = F x has ``d^k/dt^k (h x) = o_k x`` with ``o_0 = h``, ``o_(k+1) = o_k' + o_k F``. Rows that are
# independent at T are taken, N is what they all take to zero: ``R N = 0`` with an identity matrix in the other rows.
# Where ``h N = 0`` and ``N' - F N = N M`` identically, the solutions through N(T) stay in the columns of N,
# ``x = N c`` with ``c' = -M c``, and no measurement shows them next to T; where F and h are analytic on the interval,
# nowhere on it. A rank decides nothing here: the two identities do.


BITS = 256
#: Rows with more operations than this are not differentiated again; a pivot below this is called zero (a guess).
LONGEST, NOTHING = 3000, arb(10) ** -40
#: Parts of the interval on which a regressor is shown to be analytic.
MOST_PARTS = 400


@dataclass(frozen=True, slots=True)
class NullDirection:
    """A direction of the unknowns that no measurement shows; the entry ``at`` is one, and its unknown is dropped."""

    entries: tuple[sp.Expr, ...]
    at: int


def unobservable_directions(found: ModelFile) -> list[NullDirection]:
    """Independent directions of states at T, exact; empty where none is proved.

    No two have an entry at each other's place.

    h and F must be analytic on every piece. Where two pieces meet, the columns of the later one must lie among those
    of the earlier one: ``x = N c`` goes on to the start of a piece, as N is meromorphic beside the interval.
    """
    T, after = found.T, None
    if T is None or not T.is_Rational:
        return []
    directions: list[NullDirection] = []
    try:
        for piece in reversed(found.pieces):
            end = T if piece.end is None else piece.end
            part = prove_kernel(found, piece, end)
            if part is None or not is_analytic(found, piece, end):
                return []
            N, free = part
            at_end = N.subs(found.time, end)
            if after is None:
                directions = [NullDirection(tuple(at_end[:, k]), j) for k, j in enumerate(free)]
            elif not is_zero_matrix(after - at_end * after.extract(free, list(range(after.cols)))):
                return []
            after = N.subs(found.time, piece.start)
    except UnsupportedError:
        return []
    return directions


def is_zero_matrix(matrix: Iterable[sp.Expr]) -> bool:
    """Every entry is proved to be zero."""
    return all(is_equal(sp.sympify(entry, strict=True), sp.S.Zero) for entry in matrix)


def is_equal(x: sp.Expr, y: sp.Expr) -> bool:
    """x = y, proved."""
    return x == y or decide(Equation(x, y)).status is PROVED


def prove_kernel(found: ModelFile, piece: Piece, end: sp.Expr) -> tuple[sp.Matrix, list[int]] | None:
    """N on a piece with its identities proved, and its free rows; None where there is none."""
    R, pivots = derivative_rows(found, piece, end)
    free = [j for j in range(len(found.states)) if j not in pivots]
    if R is None or not free:
        return None
    N = kernel_matrix(R, pivots, free, found.time)
    return (N, free) if is_invariant(found, piece, N, free) else None


def kernel_matrix(R: sp.Matrix, pivots: Sequence[int], free: Sequence[int], time: sp.Symbol) -> sp.Matrix:
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


def derivative_rows(found: ModelFile, piece: Piece, end: sp.Expr) -> tuple[sp.Matrix | None, list[int]]:
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
            left = reduce_row([enclose(f.subs(time, end), bits=BITS) for f in row], reduced, pivots)
            best = max(range(len(left)), key=lambda j: float(abs(left[j]).lower()))
            if not bool(abs(left[best]) > NOTHING):
                continue
            reduced.append([f / left[best] for f in left])
        pivots.append(best)
        chosen.append(row)
        waiting.append((row.diff(time) + row * F).applyfunc(sp.expand))
    return (sp.Matrix.vstack(*chosen) if chosen else sp.zeros(0, F.cols)), pivots


def reduce_row(row: list[arb], reduced: Sequence[Sequence[arb]], pivots: Sequence[int]) -> list[arb]:
    """The row without its parts along rows that are one at their pivots."""
    for other, pivot in zip(reduced, pivots, strict=True):
        share = row[pivot]
        row = [f - share * g for f, g in zip(row, other, strict=True)]
    return row


def is_invariant(found: ModelFile, piece: Piece, N: sp.Matrix, free: Sequence[int]) -> bool:
    """N has values at the ends of the piece, and the identities ``h N = 0`` and ``N' - F N = N M`` are proved."""
    for end in (piece.start, found.T if piece.end is None else piece.end):
        if not all(enclose(entry, bits=BITS).is_finite() for entry in N.subs(found.time, end)):
            return False
    moved = N.diff(found.time) - piece.F * N
    defect = moved - N * moved.extract(list(free), list(range(N.cols)))
    H = sp.Matrix([list(measurement.h) for measurement in found.measurements])
    return is_zero_matrix(H * N) and is_zero_matrix(defect)


def is_analytic(found: ModelFile, piece: Piece, end: sp.Expr) -> bool:
    """Every entry of F and h has series in balls about every place of the piece, on parts of it."""
    entries = {*piece.F, *(h for measurement in found.measurements for h in measurement.h)}
    return all(
        entry.is_polynomial(found.time) or has_series(entry, found.time, rational_end(piece.start), rational_end(end))
        for entry in entries
    )


def has_series(entry: sp.Expr, time: sp.Symbol, start: fmpq, end: fmpq) -> bool:
    """The series of an entry exist on parts of [start, end]."""
    tape, waiting, used = joint_tape([entry]), [(start, end)], 0
    while waiting and used < MOST_PARTS:
        lower, upper = waiting.pop()
        used += 1
        with series_terms(2):
            value = series_coefficients(tape.run({time: arb_series([interval_ball(lower, upper), arb(1)])})[0], 1)
        if not all(c.is_finite() for c in value):
            middle = (lower + upper) / 2
            waiting += [(lower, middle), (middle, upper)]
    return not waiting


#: More regressors than this with coefficients that are not rational are not solved for; longer ones are rounded.
MOST, LETTERS = 4, 40
TINY = 1e-40
SHARES = [sp.Rational(k, 12) for k in (0, 12, 6, 3, 9, 4, 8, 2, 10, 1, 5, 7, 11)]
DECIDING = 1200
Relation = dict[int, sp.Expr]


def drop_dependent(problem: GuaranteedProblem, kept: list[int], index: int, coefficients: Sequence[arb]) -> None:
    """Remove an unknown: ``kept[index]``, whose regressor is about this combination of those before it, or another.

    Raises NotEstimableError with a null direction where the functional changes along it, and a NavsymError of
    kind ``"open"`` where neither this nor the relation can be proved.
    """
    k, balls = kept[index], dict(zip(kept, coefficients, strict=False))
    found = unobservable_directions(problem.model) if problem.model else exact_directions(problem, k, balls)
    direction = next((one for one in found if one.at in kept), None)
    if direction is None:
        raise undecided_error(problem, k, balls)
    change = sum((c * p for c, p in zip(direction.entries, problem.functional, strict=True)), sp.S.Zero)
    if not is_equal(change, sp.S.Zero):
        if enclose(change, bits=DECIDING).contains(0):
            raise undecided_error(problem, k, balls)
        words = ", ".join(t if len(t := to_text(c)) <= LETTERS else decimal(enclose(c), 15) for c in direction.entries)
        raise NotEstimableError(
            f"functional: expected one that the measurements determine; got one that changes along the null "
            f"direction [{words}] which no measurement shows; estimate another combination"
        )
    kept.remove(direction.at)


def exact_directions(problem: GuaranteedProblem, k: int, balls: dict[int, arb]) -> list[NullDirection]:
    """Exact c with ``H_k = sum c_j H_j`` on all measurements at all times, as a direction; none without a proof."""
    involved = [j for j, c in balls.items() if not abs(c) < TINY]
    near = {j: c for j in involved if (c := recognised(balls[j])) is not None}
    relation = near if len(near) == len(involved) else solve_at_times(problem, k, involved)
    if relation is None or not is_relation_proved(problem, k, relation):
        return []
    entries = {j: -c for j, c in relation.items()} | {k: sp.S.One}
    return [NullDirection(tuple(entries.get(j, sp.S.Zero) for j in range(len(problem.functional))), k)]


def undecided_error(problem: GuaranteedProblem, k: int, balls: dict[int, arb]) -> NavsymError:
    """What is known where no relation is proved: the direction along which nothing is seen to change."""
    seen = {j: decimal(-c, 12) for j, c in balls.items() if not abs(c) < TINY} | {k: "1"}
    near = [seen.get(j, "0") for j in range(len(problem.functional))]
    got = "functions that agree to 1800 digits"
    if problem.error:
        got = f"integrated functions that agree within their error of {float(problem.error):.0e}"
    return NavsymError(
        f"expected regressors whose dependence can be decided; got {got}: no measurement shows about the "
        f"direction [{', '.join(near)}]; leave that unknown out or rewrite equal functions alike",
        kind="open",
    )


def recognised(x: arb) -> sp.Rational | None:
    """The rational number with a small denominator next to x, or None."""
    return rational_near(x, 10**9, sp.Rational(1, 10**40))


def solve_at_times(problem: GuaranteedProblem, k: int, involved: list[int]) -> Relation | None:
    """The coefficients from as many exact equations as there are of them, or None where there are too many."""
    if problem.error or not 1 <= len(involved) <= MOST:
        return None
    rows = [
        [row[j].subs(problem.variable, stretch.start + (stretch.end - stretch.start) * share) for j in (*involved, k)]
        for stretch in problem.stretches
        for row in stretch.rows
        for share in SHARES
    ]
    chosen = rows_of_full_rank(np.array([[float(enclose(h).mid()) for h in row] for row in rows]), len(involved))
    if chosen is None:
        return None
    N = sp.Matrix([rows[i][:-1] for i in chosen])
    right = sp.Matrix([rows[i][-1] for i in chosen])
    return dict(zip(involved, N.adjugate() * right / N.det(method="berkowitz"), strict=True))


def rows_of_full_rank(values: np.ndarray, count: int) -> list[int] | None:
    """Rows whose first ``count`` entries are independent, the best first; None when there are not enough."""
    if not np.isfinite(values).all():
        return None
    scaled = values[:, :count] / np.maximum(np.abs(values[:, :count]).max(axis=0), 1e-300)
    chosen = independent_rows(scaled, count, 1e-6, 0.5).tolist()  # the simplest of the good ones
    return chosen if len(chosen) == count else None


def is_relation_proved(problem: GuaranteedProblem, k: int, relation: Relation) -> bool:
    """The relation is proved for every measurement on every stretch."""
    rows = [row for stretch in problem.stretches for row in stretch.rows]
    return all(is_equal(row[k], sum((c * row[j] for j, c in relation.items()), sp.S.Zero)) for row in rows)
