"""Exact contacts for every length of the interval in a range: Krawczyk's test with a moving centre.

The regressors are fixed functions on [0, T]. In a piece of the range the solution is followed by
polynomials in s, ``T = middle + half s``; the optimality system at the moving centre is enclosed by
the mean value theorem, ``F(s) in F(0) + s dF/ds``, and the contacts hold all other times below the bound.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import comb
from typing import Any

import sympy as sp
from flint import arb, arb_mat, fmpq, fmpq_mat

from navsym.proof.balls import precision
from navsym.proof.decimals import decimal, exact
from navsym.proof.enclosure import ORDER, Panel, Problem, Touch, bounded, rational, total
from navsym.proof.optimality import header

BITS = 200
NODES = (fmpq(-1), fmpq(-1, 3), fmpq(1, 3), fmpq(1))
DIGITS = 28
#: Pieces shorter than this part of the length are not worth their number: a sliver is left instead.
SMALLEST = fmpq(1, 20000)
EVERY = arb(0, 1)
#: The bound is proved here for a box wider by this part, so that a checker with other cells has room.
WIDER = arb(0.25)


@dataclass(frozen=True, slots=True, eq=False)
class Member:
    """Solution for one length: dual in the basis of the problem, times of the contacts, weights."""

    dual: tuple[fmpq, ...]
    times: tuple[fmpq, ...]
    weights: tuple[fmpq, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """What is followed: patterns of contacts (panel, end, sign), a solver, and a conditioning matrix.

    solve : T -> Member, or None when the pattern is another one there
    basis : T -> rational matrix A, such that A H is well conditioned on [0, T]
    """

    problem: Problem
    pattern: tuple[tuple[int, str, int], ...]
    solve: Callable[[fmpq], Member | None]
    basis: Callable[[fmpq], fmpq_mat]


@dataclass(frozen=True, slots=True, eq=False)
class Ranged:
    """The certificate of a range, as far as it came: up to ``reached``."""

    start: fmpq
    reached: fmpq
    pieces: list[dict[str, Any]]
    cells: int

    def document(self, problem: Problem, parameter: str) -> dict[str, Any]:
        head = header(problem, "range", BITS, self.cells)
        for panel in head["panels"]:
            panel["to"] = parameter
        ends = {"parameter": parameter, "from": fraction(self.start), "to": fraction(self.reached)}
        return head | ends | {"pieces": self.pieces}


def fraction(x: fmpq) -> str:
    return str(int(x.p)) if x.q == 1 else f"{int(x.p)}/{int(x.q)}"


def follow(track: Track, lower: fmpq, upper: fmpq, most: int = 4000) -> Ranged:
    """Pieces from ``lower`` towards ``upper``, each as long as its tests allow."""
    pieces: list[dict[str, Any]] = []
    at, cells, step = lower, 0, lower / 40
    while at < upper and len(pieces) < most:
        end = min(at + step, upper)
        end = upper if upper - end < step / 8 else simple(end, step)
        made = piece(track, at, end)
        if made is None:
            step = step / 2
            if step < SMALLEST * at:
                break
            continue
        pieces.append(made[0])
        cells += made[1]
        at, step = end, step * fmpq(5, 4)
    return Ranged(lower, at, pieces, cells)


def simple(x: fmpq, step: fmpq) -> fmpq:
    """A short decimal near x, well within the step."""
    unit = fmpq(1)
    while unit > step / 16:
        unit = unit / 10
    return unit * (x / unit).floor()


def piece(track: Track, a: fmpq, b: fmpq) -> tuple[dict[str, Any], int] | None:
    """One piece of the certificate, or None when a test fails."""
    middle, half = (a + b) / 2, (b - a) / 2
    members = [track.solve(middle + half * s) for s in NODES]
    if any(m is None for m in members):
        return None
    found = [m for m in members if m is not None]
    A = track.basis(b)
    with precision(BITS):
        dual = conditioned(found, A)
        curves = [
            interpolated(values)
            for values in zip(
                *[[*d, *m.times, *m.weights] for d, m in zip(dual, found, strict=True)], strict=True
            )
        ]
        return verified(track, A, curves, middle, half)


def conditioned(found: Sequence[Member], A: fmpq_mat) -> list[list[fmpq]]:
    """Duals y in the basis A H: ``A^T y = x``."""
    m = A.nrows()
    inverse = A.transpose().inv()
    columns = [inverse * fmpq_mat(m, 1, list(member.dual)) for member in found]
    return [[c[i, 0] for i in range(m)] for c in columns]


def interpolated(values: Sequence[fmpq]) -> list[fmpq]:
    """Coefficients of the cubic through the values at the nodes, rounded to DIGITS digits."""
    V = fmpq_mat(4, 4, [s**k for s in NODES for k in range(4)])
    c = V.inv() * fmpq_mat(4, 1, list(values))
    scale = max([abs(c[k, 0]) for k in range(4)]) or fmpq(1)
    unit = fmpq(1)
    while unit > scale / fmpq(10) ** DIGITS:
        unit = unit / 10
    return [unit * ((c[k, 0] / unit) + fmpq(1, 2)).floor() for k in range(4)]


def moved_problem(problem: Problem, A: fmpq_mat, end: fmpq) -> tuple[Problem, list[arb]]:
    """The problem in the basis A H on [0, end], time as a fraction of it, and A P."""
    m = A.nrows()
    mix = arb_mat(m, m, [arb(a) for a in A.entries()])
    stop = sp.Rational(int(end.p), int(end.q))
    panels = tuple(moved_panel(p, stop, mix) for p in problem.panels)
    target = mix * arb_mat([[p] for p in problem.target()])
    return Problem(panels, problem.functional), [target[i, 0] for i in range(m)]


def moved_panel(panel: Panel, stop: sp.Expr, mix: arb_mat) -> Panel:
    """The panel with other ends and another basis; the tape of its functions is kept."""
    moved = replace(panel, start=sp.S.Zero, end=stop, mix=mix)
    moved.__dict__["program"] = panel.program
    return moved


def verified(
    track: Track, A: fmpq_mat, curves: Sequence[Sequence[fmpq]], middle: fmpq, half: fmpq
) -> tuple[dict[str, Any], int] | None:
    """Krawczyk's test for all s, signs, places and the bound off the contacts."""
    m, l, end = A.nrows(), len(track.pattern), middle + half
    problem, target = moved_problem(track.problem, A, end)
    z = [list(map(arb, c)) for c in curves]
    for i, (_, kind, _) in enumerate(track.pattern):
        z[m + i] = (
            [arb(c) / arb(end) for c in curves[m + i]] if kind == "no" else ends_of(kind, middle, half, end)
        )
    free = [k for k in range(m + 2 * l) if not m <= k < m + l or track.pattern[k - m][1] == "no"]
    radius = {k: arb(0) for k in free}
    F0, _ = moving_system(problem, target, track.pattern, [c[0] for c in z])
    for attempt in range(4):
        move = image(problem, target, track.pattern, z, F0, radius, free)
        if move is None:
            return None
        if attempt and all(bool(abs(d) * 10 < radius[k] * 9) for k, d in move.items()):
            break
        radius = {k: arb((abs(d).upper() * 2 + arb(10) ** (-DIGITS + 4)).upper()) for k, d in move.items()}
        radius = {k: arb(exact(decimal(r, 3, 1))) for k, r in radius.items()}
    else:
        return None
    here = [at_all(c) + move.get(k, arb(0)) for k, c in enumerate(z)]
    touches: list[list[Touch]] = [[] for _ in problem.panels]
    for i, (k, kind, s) in enumerate(track.pattern):
        v, w = here[m + i], here[m + l + i]
        inside = kind != "no" or (bool(v > 0) and bool(v < arb((middle - half) / end)))
        if not inside or not bool(s * w > 0):
            return None
        touches[k].append(Touch(v, s, True, kind))
    cells = 0
    for panel, mine in zip(problem.panels, touches, strict=True):
        used = bounded(panel, [x + x.rad() * WIDER * EVERY for x in here[:m]], mine, 400)
        if used is None:
            return None
        cells += used
    return row(track, A, curves, radius, middle, half, end), cells


def ends_of(kind: str, middle: fmpq, half: fmpq, end: fmpq) -> list[arb]:
    return [arb(0)] if kind == "from" else [arb(middle / end), arb(half / end)]


def at_all(c: Sequence[arb]) -> arb:
    """A ball around the polynomial for all |s| <= 1."""
    value = arb(0)
    for a in reversed(c):
        value = value * EVERY + a
    return value


def slope(c: Sequence[arb]) -> arb:
    value = arb(0)
    for k in range(len(c) - 1, 0, -1):
        value = value * EVERY + k * c[k]
    return value


def image(
    problem: Problem, target: Sequence[arb], pattern: Sequence[tuple[int, str, int]], z: Sequence[Sequence[arb]],
    F0: Sequence[arb], radius: dict[int, arb], free: Sequence[int],
) -> dict[int, arb] | None:  # fmt: skip
    """Krawczyk's image of the box relative to its moving centre, or None when F' looks singular."""
    _, wide = moving_system(
        problem, target, pattern, [at_all(c) + radius.get(k, arb(0)) * EVERY for k, c in enumerate(z)]
    )
    speed = [slope(c) for c in z]
    F = [f + total(row_, speed) * EVERY for f, row_ in zip(F0, wide, strict=True)]
    J = arb_mat([[row_[k] for k in free] for row_ in wide])
    try:
        Y = arb_mat([[e.mid() for e in row_] for row_ in J.mid().inv().tolist()])
    except ZeroDivisionError:
        return None
    n = len(free)
    identity = arb_mat([[int(i == j) for j in range(n)] for i in range(n)])
    moved = (identity - Y * J) * arb_mat([[radius[k] * EVERY] for k in free]) - Y * arb_mat([[f] for f in F])
    if not all(moved[i, 0].is_finite() for i in range(n)):
        return None
    return {k: moved[i, 0] for i, k in enumerate(free)}


def around(panel: Panel, place: arb) -> list[list[arb]]:
    """H, H', H''/2 over a ball of places, from an expansion about its middle.

    A combination of regressors that nearly cancels keeps its size this way; over the ball itself every
    term of it would be as wide as if it stood alone.
    """
    middle = place.mid()
    away = place - middle
    thin = panel.series(middle, arb(1), ORDER)
    wide = panel.series(place, arb(1), ORDER)
    rows = [[*t[:ORDER], w[ORDER]] for t, w in zip(thin, wide, strict=True)]
    return [[derived(r, away, d) for d in range(3)] for r in rows]


def derived(taylor: Sequence[arb], away: arb, d: int) -> arb:
    """``f^(d)/d!`` at distance ``away`` from the centre."""
    value = arb(0)
    for k in range(len(taylor) - 1, d - 1, -1):
        value = value * away + comb(k, d) * taylor[k]
    return value


def moving_system(
    problem: Problem, target: Sequence[arb], pattern: Sequence[tuple[int, str, int]], z: Sequence[arb]
) -> tuple[list[arb], list[list[arb]]]:
    """F and its derivatives with respect to x, all places (ends included) and weights."""
    m, l = len(problem.functional), len(pattern)
    x, w = z[:m], z[m + l :]
    H = [around(problem.panels[k], z[m + i]) for i, (k, _, _) in enumerate(pattern)]
    inner = [i for i in range(l) if pattern[i][1] == "no"]
    F: list[arb] = []
    J = [[arb(0)] * (m + 2 * l) for _ in range(l + len(inner) + m)]
    for i, (k, _, s) in enumerate(pattern):
        F.append(total(x, [h[0] for h in H[i]]) - s * problem.panels[k].bound())
        J[i][:m] = [h[0] for h in H[i]]
        J[i][m + i] = total(x, [h[1] for h in H[i]])
    for r, i in enumerate(inner, l):
        F.append(total(x, [h[1] for h in H[i]]))
        J[r][:m] = [h[1] for h in H[i]]
        J[r][m + i] = 2 * total(x, [h[2] for h in H[i]])
    for j, p in enumerate(target):
        F.append(total(w, [h[j][0] for h in H]) - p)
        for i in range(l):
            J[l + len(inner) + j][m + i] = w[i] * H[i][j][1]
            J[l + len(inner) + j][m + l + i] = H[i][j][0]
    return F, J


def row(
    track: Track,
    A: fmpq_mat,
    curves: Sequence[Sequence[fmpq]],
    radius: dict[int, arb],
    middle: fmpq,
    half: fmpq,
    end: fmpq,
) -> dict[str, Any]:
    """The piece as plain data; places are times."""
    m, l = A.nrows(), len(track.pattern)
    text = lambda c: [fraction(a) if a.q > 10**80 else decimal(a, 60) for a in c]  # noqa: E731
    contacts = [
        {
            "panel": k,
            "at": text(curves[m + i]) if kind == "no" else [],
            "end": kind,
            "sign": s,
            "weight": text(curves[m + l + i]),
        }
        for i, (k, kind, s) in enumerate(track.pattern)
    ]
    scale = {k: (rational(r) * end if m <= k < m + l else rational(r)) for k, r in radius.items()}
    return {
        "from": fraction(middle - half), "to": fraction(middle + half),
        "basis": [[fraction(A[i, j]) for j in range(m)] for i in range(m)],
        "dual": [text(c) for c in curves[:m]], "contacts": contacts,
        "radius": [decimal(scale[k], 12, 1) for k in sorted(scale)],
    }  # fmt: skip
