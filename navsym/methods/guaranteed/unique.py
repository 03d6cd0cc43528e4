"""Whether the optimal estimator is proved not to be the only one.

A dual x with exact entries is optimal when ``|x . H_j| <= sigma_j`` and some weights of the right signs, at places
where the bound is reached exactly, satisfy ``sum w_i H(t_i) = P``. When there are more such places than unknowns
and weights all of which differ from zero, some of them may be changed a little and the rest follows: the
optimum is a face. Places are the whole of a panel where ``x . H = +-sigma`` identically, and exact contacts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import sympy as sp
from flint import arb, arb_mat, fmpq, fmpq_mat

from navsym.claims import PROVED, Equation
from navsym.numeric.exchange.search import Contacts
from navsym.proof.balls import enclose, exact_rational, precision
from navsym.proof.ladder import decide
from navsym.proof.optimality.basis import as_fraction
from navsym.proof.optimality.enclosure import Panel, Problem, Touch, rational
from navsym.proof.optimality.whole import bounded

BITS = 256
NEAR = sp.Rational(1, 10**8)
NOTHING = arb(2) ** -200
SAMPLES = 12


@dataclass(frozen=True, slots=True)
class Place:
    """An exact place where the dual polynomial is ``sign * sigma``."""

    panel: int
    at: fmpq
    sign: int


def several_optimal(problem: Problem, contacts: Contacts, dual: Sequence[arb]) -> bool:
    """True when a second optimal estimator is proved to exist."""
    x = [recognised(c) for c in dual]
    if any(c is None for c in x):
        return False
    exact = [c for c in x if c is not None]
    places = exact_places(problem, contacts, exact)
    m = len(exact)
    if not places:
        return False
    places = [places[i] for i in largest_support(*numbers_at(problem, places))]
    if not places:
        return False
    rational_values = exact_values(problem, places)
    if rational_values is not None:
        return exact_interior(rational_values, [p.sign for p in places])
    return len(places) > m and interior(problem, places, m)


def recognised(x: arb) -> sp.Rational | None:
    """The rational with a small denominator next to a ball."""
    value = rational(x)
    number = exact_rational(value)
    best = number.limit_denominator(720)
    return best if abs(best - number) <= NEAR * max(1, abs(number)) else None


def exact_places(problem: Problem, contacts: Contacts, x: Sequence[sp.Rational]) -> list[Place] | None:
    """Places where the bound is proved to be reached, or None when the dual is not proved feasible."""
    places: list[Place] = []
    for k, panel in enumerate(problem.panels):
        f = sp.expand(sum((c * h for c, h in zip(x, panel.functions, strict=True)), sp.S.Zero))
        sign = flat_sign(panel, f)
        if sign:
            places += [Place(k, fmpq(j, SAMPLES), sign) for j in range(SAMPLES + 1)]
            continue
        mine = [place for place in guess_places(contacts, k, panel, f) if holds(panel, f, place)]
        touches = [Touch(p.at, p.sign, True, "no" if level(panel, f, p) else end_of(p.at)) for p in mine]
        with precision(BITS):
            balls = [enclose(c, bits=BITS) for c in x]
            if bounded(panel, balls, touches) is None:
                return None
        places += mine
    return places


def flat_sign(panel: Panel, f: sp.Expr) -> int:
    """The sign with which f is its bound on the whole panel, 0 when it is not."""
    value = enclose(f.subs(panel.variable, (panel.start + panel.end) / 2))
    sign = 1 if bool(value > 0) else -1
    return sign if decide(Equation(f, sign * panel.sigma)).status is PROVED else 0


def guess_places(contacts: Contacts, k: int, panel: Panel, f: sp.Expr) -> list[Place]:
    """Contacts of a panel at shares with a small denominator."""
    at = [(int(j), float(u)) for j, u in zip(contacts.panel, contacts.u, strict=True)]
    shares = {as_fraction(u) for j, u in [*at, *contacts.touching] if j == k}
    found = {}
    for share in shares:
        best = exact_rational(share).limit_denominator(60)
        value = f.subs(panel.variable, panel.start + (panel.end - panel.start) * best)
        found[fmpq(int(best.p), int(best.q))] = 1 if bool(enclose(value) > 0) else -1
    return [Place(k, at_, sign) for at_, sign in found.items()]


def holds(panel: Panel, f: sp.Expr, place: Place) -> bool:
    """The bound is reached there exactly, with a slope of zero inside the panel."""
    value = f.subs(panel.variable, time_of(panel, place))
    reached = decide(Equation(value, place.sign * panel.sigma)).status is PROVED
    return reached and (end_of(place.at) != "no" or level(panel, f, place))


def level(panel: Panel, f: sp.Expr, place: Place) -> bool:
    """The slope there is zero; it may also be at an end."""
    slope = f.diff(panel.variable).subs(panel.variable, time_of(panel, place))
    return decide(Equation(slope, sp.S.Zero)).status is PROVED


def time_of(panel: Panel, place: Place) -> sp.Expr:
    """The exact instant of a place, whose share of the panel is from 0 to 1."""
    return panel.start + (panel.end - panel.start) * sp.Rational(int(place.at.p), int(place.at.q))


def end_of(at: fmpq) -> str:
    """The end of a panel at which a share lies: ``from`` at 0, ``to`` at 1, ``no`` inside."""
    return "from" if at == 0 else "to" if at == 1 else "no"


def interior(problem: Problem, places: Sequence[Place], m: int) -> bool:
    """Weights of the right signs at all places: the last ones exact and free to move, the others from balls."""
    N, P = numbers_at(problem, places)
    with precision(BITS):
        columns = [problem.panels[p.panel].rows(arb(p.at)) for p in places]
        weights = most_inside(N, P)
        if weights is None:
            return False
        order = independent_first(N, m)
        if order is None:
            return False
        fixed = [fmpq(round(float(weights[i]) * 2**40), 2**40) for i in order[m:]]
        right = problem.target()
        for i, w in zip(order[m:], fixed, strict=True):
            right = [r - places[i].sign * arb(w) * h for r, h in zip(right, columns[i], strict=True)]
        block = arb_mat([columns[i] for i in order[:m]]).transpose()
        try:
            solved = block.solve(arb_mat([[r] for r in right]))
        except ZeroDivisionError:
            return False
        signs = [places[i].sign for i in order[:m]]
        return all(w > 0 for w in fixed) and all(bool(s * solved[j, 0] > 0) for j, s in enumerate(signs))


def numbers_at(problem: Problem, places: Sequence[Place]) -> tuple[np.ndarray, np.ndarray]:
    """Signed regressors at the places as columns and P, in doubles, rows scaled."""
    with precision(BITS):
        columns = [problem.panels[p.panel].rows(arb(p.at)) for p in places]
        sizes = [[abs(h).mid() for h in row] for row in zip(*columns, strict=True)]
        largest = max(map(max, sizes))
        # A cosine that vanishes is no row to be scaled up.
        scale = [max(row) if max(row) > NOTHING * largest else arb(1) for row in sizes]
        signed = zip((p.sign for p in places), columns, strict=True)
        N = [[sign * float(h / s) for h, s in zip(column, scale, strict=True)] for sign, column in signed]
        P = [float((p / s).mid()) for p, s in zip(problem.target(), scale, strict=True)]
    return np.array(N).T, np.array(P)


def largest_support(N: np.ndarray, P: np.ndarray) -> list[int]:
    """Columns that some nonnegative solution of ``N w = P`` uses."""
    from scipy.optimize import linprog

    m, n = N.shape
    room = np.eye(n)
    answer = linprog(
        np.r_[np.zeros(n), -np.ones(n)],
        A_ub=np.c_[-room, room],
        b_ub=np.zeros(n),
        A_eq=np.c_[N, np.zeros((m, n))],
        b_eq=P,
        bounds=[(0, None)] * n + [(0, 1e-3)] * n,
    )
    return [i for i in range(n) if answer.success and answer.x[n + i] > 1e-7]


def exact_values(problem: Problem, places: Sequence[Place]) -> tuple[fmpq_mat, fmpq_mat] | None:
    """The regressors at the places as columns, and P, when all of them are rational numbers."""
    rows: list[sp.Expr] = []
    for place in places:
        panel = problem.panels[place.panel]
        at = time_of(panel, place)
        rows += [sp.sympify(h, strict=True).subs(panel.variable, at) for h in panel.functions]
    values = [*rows, *(sp.sympify(p, strict=True) for p in problem.functional)]
    if not all(v.is_Rational for v in values):
        return None
    numbers = [fmpq(int(v.p), int(v.q)) for v in values]
    m = len(problem.functional)
    return fmpq_mat(len(places), m, numbers[:-m]).transpose(), fmpq_mat(m, 1, numbers[-m:])


def exact_interior(values: tuple[fmpq_mat, fmpq_mat], signs: Sequence[int]) -> bool:
    """Weights of the right signs at all places and a null vector of their columns, in rational numbers."""
    N, P = values
    m, n = N.nrows(), N.ncols()
    rank = N.rank()
    if rank >= n:
        return False
    dense = np.array([[signs[j] * float(N[i, j]) for j in range(n)] for i in range(m)])
    scale = np.abs(dense).max(axis=1) + 1e-300
    weights = most_inside(dense / scale[:, None], np.array([float(P[i, 0]) for i in range(m)]) / scale)
    order = None if weights is None else independent_first(dense, rank)
    if weights is None or order is None:
        return False
    fixed = {i: signs[i] * fmpq(round(float(weights[i]) * 2**40), 2**40) for i in order[rank:]}
    right = [P[i, 0] - sum((w * N[i, j] for j, w in fixed.items()), fmpq(0)) for i in range(m)]
    augmented = fmpq_mat(m, rank + 1, [c for i in range(m) for c in [*(N[i, j] for j in order[:rank]), right[i]]])
    reduced, found = augmented.rref()
    if found != rank or any(reduced[i, i] != 1 for i in range(rank)):
        return False
    solved = [reduced[i, rank] for i in range(rank)]
    return all(signs[j] * w > 0 for j, w in fixed.items()) and all(
        signs[j] * w > 0 for j, w in zip(order[:rank], solved, strict=True)
    )


def most_inside(N: np.ndarray, P: np.ndarray) -> np.ndarray | None:
    """Positive weights with ``N w = P`` whose smallest is as large as can be."""
    from scipy.optimize import linprog

    m, n = N.shape
    answer = linprog(
        np.r_[np.zeros(n), -1.0],
        A_ub=np.c_[-np.eye(n), np.ones(n)],
        b_ub=np.zeros(n),
        A_eq=np.c_[N, np.zeros(m)],
        b_eq=P,
        bounds=[(0, None)] * n + [(0, 1.0)],
    )
    return answer.x[:n] if answer.success and answer.x[-1] > 1e-9 else None


def independent_first(N: np.ndarray, m: int) -> list[int] | None:
    """Columns ordered so that the first m are independent; None when there are no m of them."""
    chosen: list[int] = []
    rest = N.copy()
    for _ in range(m):
        sizes = np.linalg.norm(rest, axis=0)
        best = int(np.argmax(sizes))
        if sizes[best] < 1e-8:
            return None
        chosen.append(best)
        unit = rest[:, best] / sizes[best]
        rest = rest - np.outer(unit, unit @ rest)
    return chosen + [i for i in range(N.shape[1]) if i not in chosen]
