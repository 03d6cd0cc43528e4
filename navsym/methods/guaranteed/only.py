"""Whether the optimal estimator is the only one, where fewer contacts than unknowns carry it.

Every optimal estimator has its weights where a dual touches that is optimal itself. So a dual with as much room as
there can be is looked for: it meets its bound at given exact places and stays below elsewhere, proved in balls. When
the regressors at these places are independent, the weights follow from ``sum w_i H(t_i) = P`` and are the only
ones; the equations that are more than the weights must hold exactly, and the signs must be those of the dual.
When they are dependent and some weights of the right signs leave room at all places, there are many.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp
from flint import arb, arb_mat, fmpq

from navsym.claims import PROVED, Equation
from navsym.methods.guaranteed.unique import (
    BITS,
    NOTHING,
    SAMPLES,
    Place,
    end_of,
    exact_interior,
    exact_places,
    exact_values,
    independent_first,
    interior,
    recognised,
    time_of,
)
from navsym.numeric.exchange.interior import interior_dual
from navsym.numeric.exchange.search import Contacts, with_places
from navsym.proof.balls import enclose, exact_rational, precision
from navsym.proof.ladder import decide
from navsym.proof.optimality.basis import Basis, as_fraction
from navsym.proof.optimality.enclosure import Panel, Problem, Touch
from navsym.proof.optimality.fixed import flattened
from navsym.proof.optimality.whole import bounded

#: Shares of a panel with a larger denominator, or further away than this, are not guessed; more places not solved.
LARGEST, CLOSE, MOST = 720, 1e-6, 6


@dataclass(frozen=True, slots=True)
class Pin:
    """An exact place, and whether the dual is flat there."""

    place: Place
    flat: bool


def only_optimal(problem: Problem, basis: Basis, contacts: Contacts, dual: Sequence[arb]) -> bool | None:
    """True when the optimal estimator is proved to be the only one, False when another is, else None."""
    if any(panel.values for panel in problem.panels):
        return None
    sets = [contacts, flattened(contacts)]
    if 0 < len(contacts.touching) <= basis.panels.functional.size:
        sets.append(flattened(with_places(basis.panels, contacts, contacts.touching)))
    for places in sets:
        pins = guess_pins(places)
        x = None if pins is None else interior_dual(basis.panels, places)
        if pins is not None and x is not None and touches_only(problem, basis, pins, x):
            return decided(problem, [pin.place for pin in pins])
    return by_round_dual(problem, contacts, dual)


def by_round_dual(problem: Problem, contacts: Contacts, dual: Sequence[arb]) -> bool | None:
    """The same from a dual of simple rational numbers and all places where it touches, when these are single ones."""
    x = [c for c in map(recognised, dual) if c is not None]
    places = exact_places(problem, contacts, x) if len(x) == len(dual) else None
    if not places:
        return None
    with precision(BITS):
        balls = [enclose(c, bits=BITS) for c in x]
        for k, panel in enumerate(problem.panels):
            here = sum(place.panel == k for place in places)
            if here > SAMPLES or (here == 0 and not strictly_below(panel, balls)):
                return None
    return decided(problem, places)


def strictly_below(panel: Panel, dual: Sequence[arb]) -> bool:
    """The dual is proved to touch nowhere on the panel: it keeps a bound that is a little smaller."""
    return bounded(replace(panel, sigma=panel.sigma * (1 - sp.Rational(1, 10**9))), dual, []) is not None


def guess_pins(contacts: Contacts) -> list[Pin] | None:
    """The contacts at shares with a small denominator; None where one has none."""
    pins = []
    for k, u, inner, sign in zip(contacts.panel, contacts.u, contacts.inner, contacts.sign, strict=True):
        share = as_fraction(float(u))
        exact = exact_rational(share)
        best = exact.limit_denominator(LARGEST)
        if abs(best - exact) > CLOSE:
            return None
        pins.append(Pin(Place(int(k), fmpq(int(best.p), int(best.q)), int(sign)), bool(inner)))
    return pins


def touches_only(problem: Problem, basis: Basis, pins: Sequence[Pin], x: np.ndarray) -> bool:
    """A dual next to x meets its bound at the pins, flat where they say so, and is proved to stay below elsewhere."""
    with precision(BITS):
        dual = pinned_exactly(problem, basis, pins, x)
        if dual is None:
            return False
        for k, panel in enumerate(problem.panels):
            mine = [pin for pin in pins if pin.place.panel == k]
            touches = [Touch(p.place.at, p.place.sign, True, "no" if p.flat else end_of(p.place.at)) for p in mine]
            if not (strictly_below(panel, dual) if not touches else bounded(panel, dual, touches)):
                return False
    return True


def pinned_exactly(problem: Problem, basis: Basis, pins: Sequence[Pin], x: np.ndarray) -> list[arb] | None:
    """Balls around a dual that meets the conditions of the pins exactly: some entries rational, the others follow."""
    rows, right = conditions(problem, pins)
    near = (basis.transform.transpose() * arb_mat([[arb(float(c))] for c in x])).entries()
    sizes = [max(abs(row[j]).mid() for row in rows) for j in range(len(near))]
    least = NOTHING * max(sizes)  # a sine that vanishes is no column to be scaled up
    dense = np.array([[float(h / s) if s > least else 0.0 for h, s in zip(row, sizes, strict=True)] for row in rows])
    rank = int(np.linalg.matrix_rank(dense, tol=1e-9))
    chosen, order = independent_first(dense.T, rank), independent_first(dense, rank)
    if chosen is None or order is None or not follow(problem, pins, chosen[:rank], chosen[rank:]):
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


def conditions(problem: Problem, pins: Sequence[Pin]) -> tuple[list[list[arb]], list[arb]]:
    """Values, and slopes where flat, as rows for the dual, and what they must be."""
    rows, right = [], []
    for pin in pins:
        panel = problem.panels[pin.place.panel]
        series = panel.series(arb(pin.place.at), arb(1), int(pin.flat))
        rows.append([h[0] for h in series])
        right.append(pin.place.sign * panel.bound())
        if pin.flat:
            rows.append([h[1] for h in series])
            right.append(arb(0))
    return rows, right


def follow(problem: Problem, pins: Sequence[Pin], chosen: Sequence[int], others: Sequence[int]) -> bool:
    """The conditions left out follow from the others: each is one of them exactly (a period later), or is empty."""
    if not others:
        return True
    exact = exact_conditions(problem, pins)
    return all(zero(exact[i]) or any(same(exact[i], exact[j]) for j in chosen) for i in others)


def exact_conditions(problem: Problem, pins: Sequence[Pin]) -> list[tuple[sp.Expr, ...]]:
    """The rows of the conditions with their right sides, exactly; slopes are with respect to the share."""
    rows: list[tuple[sp.Expr, ...]] = []
    for pin in pins:
        panel, at = problem.panels[pin.place.panel], time_of(problem.panels[pin.place.panel], pin.place)
        rows.append((*(h.subs(panel.variable, at) for h in panel.functions), pin.place.sign * panel.sigma))
        if pin.flat:
            slopes = (h.diff(panel.variable) * (panel.end - panel.start) for h in panel.functions)
            rows.append((*(h.subs(panel.variable, at) for h in slopes), sp.S.Zero))
    return rows


def zero(row: Sequence[sp.Expr]) -> bool:
    """Every entry is proved to be zero."""
    return all(entry == 0 or proved(entry) for entry in row)


def same(row: Sequence[sp.Expr], other: Sequence[sp.Expr]) -> bool:
    """The rows are equal but for a sign."""
    return any(zero([a - s * b for a, b in zip(row, other, strict=True)]) for s in (1, -1))


def proved(entry: sp.Expr) -> bool:
    """The number is proved to be zero."""
    return decide(Equation(sp.sympify(entry, strict=True), sp.S.Zero)).status is PROVED


def decided(problem: Problem, places: Sequence[Place]) -> bool | None:
    """Whether weights at these places, all of the contacts of an optimal dual, are the only ones."""
    m, values = len(problem.functional), exact_values(problem, places)
    twins = [k for k in range(len(places)) if any(alike(problem, places[k], other) for other in places[:k])]
    rest = [place for k, place in enumerate(places) if k not in twins]
    if len(rest) <= m and independent_weights(problem, rest):
        return not twins  # the weight of a place may be shared with its twin
    several = (
        exact_interior(values, [p.sign for p in places])
        if values is not None
        else len(places) > m and interior(problem, places, m)
    )
    return False if several else None


def alike(problem: Problem, place: Place, other: Place) -> bool:
    """The regressors over the noise bound are the same at two places, and so is the sign."""
    if place.sign != other.sign:
        return False
    a, b = columns_at(problem, [place, other])
    bounds = [problem.panels[p.panel].sigma for p in (place, other)]
    return zero([h * bounds[1] - g * bounds[0] for h, g in zip(a, b, strict=True)])


def columns_at(problem: Problem, places: Sequence[Place]) -> list[list[sp.Expr]]:
    """The regressors at the places, exactly."""
    panels = [problem.panels[p.panel] for p in places]
    return [
        [h.subs(panel.variable, time_of(panel, p)) for h in panel.functions]
        for panel, p in zip(panels, places, strict=True)
    ]


def independent_weights(problem: Problem, places: Sequence[Place]) -> bool:
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


def equations_hold(problem: Problem, places: Sequence[Place], rows: Sequence[int], others: Sequence[int]) -> bool:
    """``sum w_i H(t_i) = P`` in the other rows, exactly, when it holds in those that fix the weights."""
    columns = columns_at(problem, places)
    block = sp.Matrix([[column[i] for column in columns] for i in rows])
    determinant = block.det(method="berkowitz")
    times = block.adjugate() * sp.Matrix([problem.functional[i] for i in rows])
    return all(
        proved(
            sum((column[i] * w for column, w in zip(columns, times, strict=True)), sp.S.Zero)
            - determinant * problem.functional[i]
        )
        for i in others
    )
