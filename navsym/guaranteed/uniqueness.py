"""Whether the optimal estimator is proved not to be the only one.

A dual x with exact entries is optimal when ``|x . H_j| <= sigma_j`` and some weights of the right signs, at places
where the bound is reached exactly, satisfy ``sum w_i H(t_i) = P``. When there are more such places than unknowns
and weights all of which differ from zero, some of them may be changed a little and the rest follows: the
optimum is a face. Places are the whole of a panel where ``x . H = +-sigma`` identically, and exact contacts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import sympy as sp
from flint import arb, arb_mat, fmpq, fmpq_mat

from navsym.core.balls import enclose, precision
from navsym.core.exact import EIGHT, rational_near, to_fmpq, to_rational
from navsym.core.simplex import independent_rows
from navsym.guaranteed.certificate.basis import Basis, unit_fraction
from navsym.guaranteed.certificate.enclosure import Panel, PanelProblem, Touch, prove_panel_bound
from navsym.guaranteed.certificate.fixed import flatten_contacts
from navsym.guaranteed.estimability import is_equal, is_zero_matrix
from navsym.guaranteed.search.exchange import Contacts, add_places, interior_dual

BITS = 256
NOTHING = arb(2) ** -200
SAMPLES = 12


@dataclass(frozen=True, slots=True)
class ContactPlace:
    """An exact place where the dual polynomial is ``sign * sigma``, and whether it is flat there."""

    panel: int
    at: fmpq
    sign: int
    flat: bool = False

    @property
    def touch(self) -> Touch:
        """The same for a proof over the panel."""
        inside = self.flat or 0 < self.at < 1
        return Touch(self.at, self.sign, True, "no" if inside else "from" if self.at == 0 else "to")


def exact_places(problem: PanelProblem, contacts: Contacts, x: Sequence[sp.Rational]) -> list[ContactPlace] | None:
    """Places where the bound is proved to be reached, or None when the dual is not proved feasible."""
    places: list[ContactPlace] = []
    for k, panel in enumerate(problem.panels):
        f = sp.expand(sum((c * h for c, h in zip(x, panel.functions, strict=True)), sp.S.Zero))
        sign = 1 if bool(enclose(f.subs(panel.variable, (panel.start + panel.end) / 2)) > 0) else -1
        if is_equal(f, sign * panel.sigma):
            places += [ContactPlace(k, fmpq(j, SAMPLES), sign) for j in range(SAMPLES + 1)]
            continue
        mine, slope = list[ContactPlace](), f.diff(panel.variable)
        for place in guess_places(contacts, k, panel, f):
            here = {panel.variable: exact_time(panel, place)}
            if is_equal(f.subs(here), place.sign * panel.sigma):
                flat = is_equal(slope.subs(here), sp.S.Zero)
                mine += [replace(place, flat=flat)] if flat or place.at in (0, 1) else []
        with precision(BITS):
            balls = [enclose(c, bits=BITS) for c in x]
            if prove_panel_bound(panel, balls, [place.touch for place in mine]) is None:
                return None
        places += mine
    return places


def guess_places(contacts: Contacts, k: int, panel: Panel, f: sp.Expr) -> list[ContactPlace]:
    """Contacts of a panel at shares with a small denominator."""
    at = [(int(j), float(u)) for j, u in zip(contacts.panel, contacts.u, strict=True)]
    shares = {unit_fraction(u) for j, u in [*at, *contacts.touching] if j == k}
    found = {}
    for share in shares:
        best = to_rational(share).limit_denominator(60)
        value = f.subs(panel.variable, panel.start + (panel.end - panel.start) * best)
        found[to_fmpq(best)] = 1 if bool(enclose(value) > 0) else -1
    return [ContactPlace(k, share, sign) for share, sign in found.items()]


def exact_time(panel: Panel, place: ContactPlace) -> sp.Expr:
    """The exact instant of a place, whose share of the panel is from 0 to 1."""
    return panel.start + (panel.end - panel.start) * to_rational(place.at)


def has_interior_weights(problem: PanelProblem, places: Sequence[ContactPlace]) -> bool:
    """Weights of the right signs at all places, and more places than independent regressors there.

    In rational numbers where all are rational, else in balls: the last weights are exact and free to move.
    """
    values, signs = rational_columns(problem, places), [p.sign for p in places]
    N, P = signed_columns(problem, places)
    rank = P.size if values is None else values[0].rank()
    inner = widest_weights(N, P, np.ones((len(places), 1)), 1.0) if len(places) > rank else None
    order = None if inner is None or not inner[1][0] > 1e-9 else independent_first(N, rank)
    if inner is None or order is None:
        return False
    fixed = {i: signs[i] * fmpq(round(float(inner[0][i]) * 2**40), 2**40) for i in order[rank:]}
    with precision(BITS):
        solve = solve_in_balls if values is None else partial(solve_exactly, values)
        solved = solve(problem, places, order[:rank], fixed)
    pairs: list[tuple[int, Any]] = [*fixed.items(), *zip(order, solved or (), strict=False)]
    return solved is not None and all(bool(signs[i] * w > 0) for i, w in pairs)


def solve_in_balls(
    problem: PanelProblem, places: Sequence[ContactPlace], first: Sequence[int], fixed: dict[int, fmpq]
) -> list[arb] | None:
    """The weights at the first places next to those that are fixed elsewhere."""
    columns, right = [problem.panels[p.panel].rows(arb(p.at)) for p in places], problem.target()
    for i, w in fixed.items():
        right = [r - arb(w) * h for r, h in zip(right, columns[i], strict=True)]
    try:
        return arb_mat([columns[i] for i in first]).transpose().solve(arb_mat([[r] for r in right])).entries()
    except ZeroDivisionError:
        return None


def solve_exactly(
    values: tuple[fmpq_mat, fmpq_mat],
    _: PanelProblem,
    places: Sequence[ContactPlace],
    first: Sequence[int],
    fixed: dict[int, fmpq],
) -> list[fmpq] | None:
    """The same in rational numbers; None where the equations contradict each other."""
    (N, P), rank = values, len(first)
    right = [P[i, 0] - sum((w * N[i, j] for j, w in fixed.items()), fmpq(0)) for i in range(N.nrows())]
    rows = [[*(N[i, j] for j in first), right[i]] for i in range(N.nrows())]
    reduced, found = fmpq_mat(rows).rref()
    good = found == rank and all(reduced[i, i] == 1 for i in range(rank))
    return [reduced[i, rank] for i in range(rank)] if good else None


def signed_columns(problem: PanelProblem, places: Sequence[ContactPlace]) -> tuple[np.ndarray, np.ndarray]:
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


def widest_weights(
    N: np.ndarray, P: np.ndarray, shares: np.ndarray, most: float
) -> tuple[np.ndarray, np.ndarray] | None:
    """Weights w >= 0 and rooms ``0 <= s <= most`` with ``N w = P``, ``shares s <= w`` and the largest sum of s."""
    from scipy.optimize import linprog

    (m, n), rooms = N.shape, shares.shape[1]
    answer = linprog(
        np.r_[np.zeros(n), -np.ones(rooms)],
        A_ub=np.c_[-np.eye(n), shares],
        b_ub=np.zeros(n),
        A_eq=np.c_[N, np.zeros((m, rooms))],
        b_eq=P,
        bounds=[(0, None)] * n + [(0, most)] * rooms,
    )
    return (answer.x[:n], answer.x[n:]) if answer.success else None


def rational_columns(problem: PanelProblem, places: Sequence[ContactPlace]) -> tuple[fmpq_mat, fmpq_mat] | None:
    """The regressors at the places as columns, and P, when all of them are rational numbers."""
    rows = [h for column in exact_columns(problem, places) for h in column]
    values = [sp.sympify(e, strict=True) for e in (*rows, *problem.functional)]
    if not all(v.is_Rational for v in values):
        return None
    numbers = [to_fmpq(v) for v in values]
    m = len(problem.functional)
    return fmpq_mat(len(places), m, numbers[:-m]).transpose(), fmpq_mat(m, 1, numbers[-m:])


def independent_first(N: np.ndarray, m: int) -> list[int] | None:
    """Columns ordered so that the first m are independent; None when there are no m of them."""
    chosen = independent_rows(N.T, m, 1e-8).tolist()
    return None if len(chosen) < m else chosen + [i for i in range(N.shape[1]) if i not in chosen]


# Whether the optimal estimator is the only one, where fewer contacts than unknowns carry it.
#
# Every optimal estimator has its weights where a dual touches that is optimal itself. So a dual with as much room as
# there can be is looked for: it meets its bound at given exact places and stays below elsewhere, proved in balls. When
# the regressors at these places are independent, the weights follow from ``sum w_i H(t_i) = P`` and are the only
# ones; the equations that are more than the weights must hold exactly, and the signs must be those of the dual.
# When they are dependent and some weights of the right signs leave room at all places, there are many.


#: Shares of a panel with a larger denominator, or further away than this, are not guessed; more places not solved.
LARGEST, CLOSE, MOST = 720, 1e-6, 6


def is_only_optimum(problem: PanelProblem, basis: Basis, contacts: Contacts, dual: Sequence[arb]) -> bool | None:
    """True when the optimal estimator is proved to be the only one, False when another is, else None."""
    simple = [c for x in dual if (c := rational_near(x, LARGEST, EIGHT)) is not None]
    exact = (exact_places(problem, contacts, simple) if len(simple) == len(dual) else None) or []
    some = widest_weights(*signed_columns(problem, exact), np.eye(len(exact)), 1e-3) if exact else None
    used = [] if some is None else [place for place, room in zip(exact, some[1], strict=True) if room > 1e-7]
    if used and has_interior_weights(problem, used):
        return False
    if any(panel.values for panel in problem.panels):
        return None
    sets = [contacts, flatten_contacts(contacts)]
    if 0 < len(contacts.touching) <= basis.panels.functional.size:
        sets.append(flatten_contacts(add_places(basis.panels, contacts, contacts.touching)))
    for places in sets:
        pins = guess_pins(places)
        x = None if pins is None else interior_dual(basis.panels, places)
        if pins is not None and x is not None and touches_only_at(problem, basis, pins, x):
            return decide_weights(problem, pins)
    return decide_by_simple_dual(problem, exact, simple)


def decide_by_simple_dual(
    problem: PanelProblem, places: Sequence[ContactPlace], x: Sequence[sp.Rational]
) -> bool | None:
    """The same from a dual of simple rational numbers and all places where it touches, when these are single ones."""
    if not places:
        return None
    with precision(BITS):
        balls = [enclose(c, bits=BITS) for c in x]
        for k, panel in enumerate(problem.panels):
            here = sum(place.panel == k for place in places)
            if here > SAMPLES or (here == 0 and not is_strictly_below(panel, balls)):
                return None
    return decide_weights(problem, places)


def is_strictly_below(panel: Panel, dual: Sequence[arb]) -> bool:
    """The dual is proved to touch nowhere on the panel: it keeps a bound that is a little smaller."""
    return prove_panel_bound(replace(panel, sigma=panel.sigma * (1 - sp.Rational(1, 10**9))), dual, []) is not None


def guess_pins(contacts: Contacts) -> list[ContactPlace] | None:
    """The contacts at shares with a small denominator; None where one has none."""
    pins = []
    for k, u, inner, sign in zip(contacts.panel, contacts.u, contacts.inner, contacts.sign, strict=True):
        share = unit_fraction(float(u))
        exact = to_rational(share)
        best = exact.limit_denominator(LARGEST)
        if abs(best - exact) > CLOSE:
            return None
        pins.append(ContactPlace(int(k), to_fmpq(best), int(sign), bool(inner)))
    return pins


def touches_only_at(problem: PanelProblem, basis: Basis, pins: Sequence[ContactPlace], x: np.ndarray) -> bool:
    """A dual next to x meets its bound at the pins, flat where they say so, and is proved to stay below elsewhere."""
    with precision(BITS):
        dual = exact_pinned_dual(problem, basis, pins, x)
        if dual is None:
            return False
        for k, panel in enumerate(problem.panels):
            touches = [pin.touch for pin in pins if pin.panel == k]
            if not (is_strictly_below(panel, dual) if not touches else prove_panel_bound(panel, dual, touches)):
                return False
    return True


def exact_pinned_dual(
    problem: PanelProblem, basis: Basis, pins: Sequence[ContactPlace], x: np.ndarray
) -> list[arb] | None:
    """Balls around a dual that meets the conditions of the pins exactly: some entries rational, the others follow."""
    rows, right = pin_conditions(problem, pins)
    near = (basis.transform.transpose() * arb_mat([[arb(float(c))] for c in x])).entries()
    sizes = [max(abs(row[j]).mid() for row in rows) for j in range(len(near))]
    least = NOTHING * max(sizes)  # a sine that vanishes is no column to be scaled up
    dense = np.array([[float(h / s) if s > least else 0.0 for h, s in zip(row, sizes, strict=True)] for row in rows])
    rank = int(np.linalg.matrix_rank(dense, tol=1e-9))
    chosen, order = independent_first(dense.T, rank), independent_first(dense, rank)
    if chosen is None or order is None or not conditions_follow(problem, pins, chosen[:rank], chosen[rank:]):
        return None
    free = {j: near[j].mid() for j in order[rank:]}
    rest = [right[i] - sum((rows[i][j] * c for j, c in free.items()), arb(0)) for i in chosen[:rank]]
    block = arb_mat([[rows[i][j] for j in order[:rank]] for i in chosen[:rank]])
    try:
        solved = block.solve(arb_mat([[r] for r in rest])).entries()
    except ZeroDivisionError:
        return None
    found = dict(zip(order[:rank], solved, strict=True)) | free
    return [found[j] for j in range(len(near))]


def pin_conditions(problem: PanelProblem, pins: Sequence[ContactPlace]) -> tuple[list[list[arb]], list[arb]]:
    """Values, and slopes where flat, as rows for the dual, and what they must be."""
    rows, right = [], []
    for pin in pins:
        panel = problem.panels[pin.panel]
        series = panel.series(arb(pin.at), arb(1), int(pin.flat))
        rows.append([h[0] for h in series])
        right.append(pin.sign * panel.bound())
        if pin.flat:
            rows.append([h[1] for h in series])
            right.append(arb(0))
    return rows, right


def conditions_follow(
    problem: PanelProblem, pins: Sequence[ContactPlace], chosen: Sequence[int], others: Sequence[int]
) -> bool:
    """The conditions left out follow from the others: each is one of them exactly (a period later), or is empty."""
    if not others:
        return True
    exact = exact_conditions(problem, pins)

    def is_same(row: Sequence[sp.Expr], other: Sequence[sp.Expr]) -> bool:
        return any(is_zero_matrix([a - s * b for a, b in zip(row, other, strict=True)]) for s in (1, -1))

    return all(is_zero_matrix(exact[i]) or any(is_same(exact[i], exact[j]) for j in chosen) for i in others)


def exact_conditions(problem: PanelProblem, pins: Sequence[ContactPlace]) -> list[tuple[sp.Expr, ...]]:
    """The rows of the conditions with their right sides, exactly; slopes are with respect to the share."""
    rows: list[tuple[sp.Expr, ...]] = []
    for pin in pins:
        panel, at = problem.panels[pin.panel], exact_time(problem.panels[pin.panel], pin)
        rows.append((*(h.subs(panel.variable, at) for h in panel.functions), pin.sign * panel.sigma))
        if pin.flat:
            slopes = (h.diff(panel.variable) * (panel.end - panel.start) for h in panel.functions)
            rows.append((*(h.subs(panel.variable, at) for h in slopes), sp.S.Zero))
    return rows


def decide_weights(problem: PanelProblem, places: Sequence[ContactPlace]) -> bool | None:
    """Whether weights at these places, all of the contacts of an optimal dual, are the only ones."""
    twins = [k for k in range(len(places)) if any(is_twin(problem, places[k], other) for other in places[:k])]
    rest = [place for k, place in enumerate(places) if k not in twins]
    if len(rest) <= len(problem.functional) and has_only_weights(problem, rest):
        return not twins  # the weight of a place may be shared with its twin
    return False if has_interior_weights(problem, places) else None


def is_twin(problem: PanelProblem, place: ContactPlace, other: ContactPlace) -> bool:
    """The regressors over the noise bound are the same at two places, and so is the sign."""
    if place.sign != other.sign:
        return False
    a, b = exact_columns(problem, [place, other])
    bounds = [problem.panels[p.panel].sigma for p in (place, other)]
    return is_zero_matrix([h * bounds[1] - g * bounds[0] for h, g in zip(a, b, strict=True)])


def exact_columns(problem: PanelProblem, places: Sequence[ContactPlace]) -> list[list[sp.Expr]]:
    """The regressors at the places, exactly."""
    pairs = [(problem.panels[p.panel], p) for p in places]
    return [[h.subs(panel.variable, exact_time(panel, p)) for h in panel.functions] for panel, p in pairs]


def has_only_weights(problem: PanelProblem, places: Sequence[ContactPlace]) -> bool:
    """The regressors at the places are independent, and weights of the right signs satisfy all equations exactly."""
    with precision(BITS):
        N = arb_mat([problem.panels[p.panel].rows(arb(p.at)) for p in places]).transpose()
        dense = np.array([[float(h) for h in row] for row in N.tolist()])
        sizes = np.abs(dense).max(axis=1, keepdims=True)
        chosen = independent_first((dense / np.where(sizes > 0, sizes, 1.0)).T, len(places))
        if chosen is None:
            return False
        rows, others = chosen[: len(places)], chosen[len(places) :]
        target, entries = problem.target(), N.tolist()
        try:
            weights = arb_mat([entries[i] for i in rows]).solve(arb_mat([[target[i]] for i in rows])).entries()
        except ZeroDivisionError:
            return False
        if not all(bool(p.sign * w > 0) for p, w in zip(places, weights, strict=True)):
            return False
    return not others or (len(places) <= MOST and equations_hold(problem, places, rows, others))


def equations_hold(
    problem: PanelProblem, places: Sequence[ContactPlace], rows: Sequence[int], others: Sequence[int]
) -> bool:
    """``sum w_i H(t_i) = P`` in the other rows, exactly, when it holds in those that fix the weights."""
    columns = exact_columns(problem, places)
    block = sp.Matrix([[column[i] for column in columns] for i in rows])
    determinant = block.det(method="berkowitz")
    times = block.adjugate() * sp.Matrix([problem.functional[i] for i in rows])
    return is_zero_matrix(
        sum((column[i] * w for column, w in zip(columns, times, strict=True)), -determinant * problem.functional[i])
        for i in others
    )
