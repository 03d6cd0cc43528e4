"""What lies between certified ranges: thin stretches of the parameter with a two-sided certificate each.

At a change of pattern the exact contacts are singular. There the parameter is a ball, a dual and places are
fixed, and weak duality bounds the optimum from both sides for every value in the ball.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np
import sympy as sp
from flint import arb, fmpq

from navsym.core.balls import precision
from navsym.core.errors import NavsymError
from navsym.core.exact import decimal, from_decimal, to_fmpq, to_rational
from navsym.guaranteed.certificate.basis import Basis, DependentError, make_basis, unit_fraction
from navsym.guaranteed.certificate.enclosure import Panel, PanelProblem, Touch, dot_product, interval_ball
from navsym.guaranteed.certificate.fixed import (
    balance_weights,
    certificate_header,
    complete_support,
    dual_attempts,
    near_touches,
    prove_all_panels,
)
from navsym.guaranteed.certificate.polish import ContactSolution, sharpen_contacts
from navsym.guaranteed.certificate.range import never
from navsym.guaranteed.phases.family import Family
from navsym.guaranteed.phases.patterns import order_contacts
from navsym.guaranteed.search.exchange import Contacts, find_contacts

DIGITS = 14
BITS = 400
PLACES = 60
#: Points on which the size of a dual polynomial is looked at, and the room it is given beyond what is seen.
GRID = 200
TINY = arb(10) ** -9
#: Enclosures wider than this part of the value are not worth the name.
WIDEST = 1e-2
#: Contacts of one sign that come so near to each other, u in [-1, 1], carry their weights together if need be.
NEAR = 0.2
#: Attempts for one stretch, the shortest sliver as part of it, and into how many a failed one is cut at most.
MOST_TRIES = 400
SHORTEST = fmpq(1, 1 << 40)
MOST_PARTS = 8
#: Bounds are this part of their distance wider than what is proved here: a checker's balls are not the same.
ROOM = 50


@dataclass(frozen=True, slots=True, eq=False)
class Sliver:
    """Bounds of the optimum for every value between ``start`` and ``end``."""

    start: fmpq
    end: fmpq
    lower: str
    upper: str
    certificate: Mapping[str, Any]

    def row(self) -> tuple[str, str, str, str]:
        """Decimal strings of start, end, lower and upper, the first two to 60 digits."""
        return decimal(self.start, 60), decimal(self.end, 60), self.lower, self.upper


def certify_slivers(
    family: Family, start: fmpq, end: fmpq, enough: Callable[[], bool] = never
) -> tuple[list[Sliver], list[tuple[fmpq, fmpq]]]:
    """Slivers of an interval, each as long as its enclosure stays narrow, and the intervals that they leave.

    enough : asked before every attempt; True stops
    """
    made: list[Sliver] = []
    left: list[tuple[fmpq, fmpq]] = []
    stack, tries, shortest = [(start, end)], 0, (end - start) * SHORTEST
    while stack:
        a, b = stack.pop()
        if tries == MOST_TRIES or b - a < shortest or enough():
            left.append((a, b))
            continue
        tries += 1
        one, width = certify_sliver(family, a, b)
        if one is not None:
            made.append(one)
            continue
        stack += reversed(cut_interval(a, b, width))
    return made, join_intervals(left)


def cut_interval(a: fmpq, b: fmpq, width: float) -> list[tuple[fmpq, fmpq]]:
    """Equal parts of a stretch on which an enclosure had this width: as many as make it narrow enough."""
    parts = 2 if width == inf else max(2, min(MOST_PARTS, int(1.2 * width / WIDEST) + 1))
    marks = [a + (b - a) * fmpq(k, parts) for k in range(parts + 1)]
    return list(pairwise(marks))


def join_intervals(stretches: list[tuple[fmpq, fmpq]]) -> list[tuple[fmpq, fmpq]]:
    """Neighbours made one."""
    done: list[tuple[fmpq, fmpq]] = []
    for a, b in stretches:
        if done and done[-1][1] == a:
            a = done.pop()[0]
        done.append((a, b))
    return done


def certify_sliver(family: Family, start: fmpq, end: fmpq) -> tuple[Sliver | None, float]:
    """The two-sided certificate with the parameter as a ball, None when it is too wide, and how wide it is."""
    middle = (start + end) / 2
    values = {family.parameter: interval_ball(start, end)}
    shown = PanelProblem(
        tuple(replace(panel, values=values) for panel in family.moving.panels), family.moving.functional, values
    )
    if not all(bool(b > a) and bool(sigma > 0) for a, b, sigma in (panel.edges() for panel in shown.panels)):
        return None, inf
    ball = divide_by_bounds(shown)
    try:
        problem = family.exact(to_rational(middle))
        basis = make_basis(problem)
        contacts = find_contacts(basis.panels)
        refined = sharpen_contacts(problem.panels, basis, contacts, BITS, 1e-40)
        with precision(BITS):
            support, most = cheapest_support(ball, basis, contacts, refined)
            x, cells = bounded_dual(ball, basis, contacts, refined)
            least = to_fmpq(dot_product([arb(c) for c in x], ball.target()).lower())
    except (DependentError, NavsymError, ArithmeticError, ValueError):
        return None, inf
    width = float(arb((most - least) / most))
    if not 0 < width < WIDEST or not least > 0:
        return None, width if width > 0 else inf
    room = (most - least) / ROOM
    lower, upper = decimal(least - room, DIGITS + 6, -1), decimal(most + room, DIGITS + 6, 1)
    document = certificate_header(shown, "sliver", BITS, cells, lower, upper) | {
        "parameter": family.parameter.name,
        "from": str(start),
        "to": str(end),
        "dual": [decimal(c, PLACES) for c in x],
        "support": [[k, decimal(v, PLACES)] for k, v in support],
    }
    return Sliver(start, end, lower, upper, document), width


Support = list[tuple[int, fmpq]]


def cheapest_support(
    ball: PanelProblem, basis: Basis, contacts: Contacts, refined: ContactSolution
) -> tuple[Support, fmpq]:
    """Places and an upper bound: the contacts of the middle, or the middles of those that are about to merge.

    Raises ValueError when balls as wide as these carry the functional on neither.
    """
    together = merge_contacts(contacts)
    places = [from_decimal(decimal(v, PLACES)) for v in refined.v], [unit_fraction(float(u)) for u in together.u]
    found = []
    for carriers, at in zip((contacts, together), places, strict=True):
        support = complete_support(basis, carriers, at)
        try:
            found.append((to_fmpq(sum(map(abs, balance_weights(ball, support)), arb(0)).upper()), support))
        except (ZeroDivisionError, ValueError):
            continue
    if not found:
        raise ValueError("no weights in balls as wide as these")
    most, support = min(found, key=lambda pair: pair[0])
    return support, most


def bounded_dual(
    ball: PanelProblem, basis: Basis, contacts: Contacts, refined: ContactSolution
) -> tuple[list[fmpq], int]:
    """A dual within the bound for every value in the ball, and the cells of the proof.

    Raises ValueError when none is found.
    """
    best: tuple[fmpq, list[fmpq], int] | None = None
    tried: list[list[fmpq]] = []
    for base, _, seen in dual_attempts(ball, basis, contacts, refined, DIGITS):
        if base in tried:
            continue
        tried.append(base)
        over = dual_excess(ball, base, near_touches(ball, seen, PLACES))
        for more in (arb(1.05), arb(1.5), arb(4)):
            scale = to_fmpq((1 / (1 + over * more + TINY)).mid())
            x = [from_decimal(decimal(c * scale, PLACES)) for c in base]
            reached = to_fmpq(dot_product([arb(c) for c in x], ball.target()).lower())
            if best is not None and reached <= best[0]:
                break
            cells = prove_all_panels(ball, [arb(c) for c in x], [[] for _ in ball.panels])
            if cells is not None:
                best = reached, [from_decimal(decimal(c * (1 - fmpq(1, 10**9)), PLACES)) for c in x], cells
                break
    if best is None:
        raise ValueError("no dual within the bound")
    return best[1], best[2]


def dual_excess(ball: PanelProblem, x: Sequence[fmpq], touches: Sequence[Sequence[Touch]]) -> arb:
    """By how much the dual polynomial may leave its bound, at its touches and on a grid: a guess to be proved."""
    dual, worst = [arb(c) for c in x], arb(0)
    for panel, near in zip(ball.panels, touches, strict=True):
        for v in (*(to_fmpq(t.at) for t in near), *(fmpq(k, GRID) for k in range(GRID + 1))):
            worst = max(worst, (abs(dot_product(dual, panel.rows(arb(v)))) / panel.bound()).upper() - 1)
    return worst


def merge_contacts(contacts: Contacts) -> Contacts:
    """Neighbours of one sign on one panel as one contact at their mean: what that costs is of the second order."""
    found = order_contacts(contacts)
    change = (np.diff(found.panel) != 0) | (np.diff(found.sign) != 0) | (np.diff(found.u) > NEAR)
    groups = np.split(np.arange(found.u.size), np.flatnonzero(change) + 1)
    weights = np.array([found.weights[g].sum() for g in groups])
    means = np.array([(found.weights[g] * found.u[g]).sum() for g in groups]) / weights
    first = np.array([g[0] for g in groups])
    return replace(found, panel=found.panel[first], u=means, sign=found.sign[first], weights=weights)


def divide_by_bounds(problem: PanelProblem) -> PanelProblem:
    """Regressors over their noise bounds, one by one: where a bound moves, a checker's balls are as wide as these."""

    def scaled(panel: Panel) -> Panel:
        functions = tuple(sp.Mul(h, 1 / panel.sigma, evaluate=False) for h in panel.functions)
        return replace(panel, functions=functions, sigma=sp.S.One)

    panels = tuple(scaled(panel) if panel.sigma.free_symbols else panel for panel in problem.panels)
    return replace(problem, panels=panels)
