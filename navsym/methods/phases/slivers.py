"""What lies between certified ranges: thin stretches of the parameter with a two-sided certificate each.

At a change of pattern the exact contacts are singular. There the parameter is a ball, a dual and places are
fixed, and weak duality bounds the optimum from both sides for every value in the ball.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np
import sympy as sp
from flint import arb, fmpq

from navsym.errors import NavsymError
from navsym.methods.phases.family import Family
from navsym.methods.phases.scan import ordered
from navsym.numeric.exchange.search import Contacts, find_contacts
from navsym.proof.decimals import decimal
from navsym.proof.optimality.basis import DependentError, make_basis
from navsym.proof.optimality.enclosure import Problem, interval
from navsym.proof.optimality.fixed import gap
from navsym.proof.optimality.polish import polish
from navsym.proof.optimality.range import fraction

DIGITS = 14
BITS = 400
#: Enclosures wider than this part of the value are not worth the name.
WIDEST = 1e-2
#: Contacts of one sign that come so near to each other, u in [-1, 1], carry their weights together if need be.
NEAR = 0.2
#: Attempts for one stretch, the shortest sliver as part of it, and into how many a failed one is cut at most.
MOST_TRIES = 150
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
        return decimal(self.start, 60), decimal(self.end, 60), self.lower, self.upper


def slivers(family: Family, start: fmpq, end: fmpq) -> tuple[list[Sliver], list[tuple[fmpq, fmpq]]]:
    """Slivers on a stretch, each as long as it stays narrow, and what they leave when the attempts are used up."""
    made: list[Sliver] = []
    left: list[tuple[fmpq, fmpq]] = []
    stack, tries, shortest = [(start, end)], 0, (end - start) * SHORTEST
    while stack:
        a, b = stack.pop()
        if tries == MOST_TRIES or b - a < shortest:
            left.append((a, b))
            continue
        tries += 1
        one, width = sliver(family, a, b)
        if one is not None:
            made.append(one)
            continue
        stack += reversed(cut(a, b, width))
    return made, joined(left)


def cut(a: fmpq, b: fmpq, width: float) -> list[tuple[fmpq, fmpq]]:
    """Equal parts of a stretch on which an enclosure had this width: as many as make it narrow enough."""
    parts = 2 if width == inf else max(2, min(MOST_PARTS, int(1.2 * width / WIDEST) + 1))
    marks = [a + (b - a) * fmpq(k, parts) for k in range(parts + 1)]
    return list(pairwise(marks))


def joined(stretches: list[tuple[fmpq, fmpq]]) -> list[tuple[fmpq, fmpq]]:
    """Neighbours made one."""
    done: list[tuple[fmpq, fmpq]] = []
    for a, b in stretches:
        if done and done[-1][1] == a:
            a = done.pop()[0]
        done.append((a, b))
    return done


def sliver(family: Family, start: fmpq, end: fmpq) -> tuple[Sliver | None, float]:
    """The two-sided certificate with the parameter as a ball, None when it is too wide, and how wide it is."""
    made, width = sliver_on(family, start, end, False)
    if made is not None:
        return made, width
    made, other = sliver_on(family, start, end, True)
    return made, min(width, other)


def sliver_on(family: Family, start: fmpq, end: fmpq, together: bool) -> tuple[Sliver | None, float]:
    """The sliver with weights at the contacts of the middle, or at the middles of those that are about to merge."""
    middle = (start + end) / 2
    at = sp.Rational(int(middle.p), int(middle.q))
    try:
        problem = family.exact(at)
        basis = make_basis(problem)
        contacts = find_contacts(basis.panels)
        refined = polish(problem.panels, basis, contacts, BITS, 1e-40)
        carriers = merged(contacts) if together else None
        found = gap(ball_problem(family, interval(start, end)), basis, contacts, refined, DIGITS, BITS, carriers)
    except (DependentError, NavsymError, ZeroDivisionError, ValueError):
        return None, inf
    if not 0 < found.width < WIDEST or not bool(arb(found.lower) > 0):
        return None, found.width if found.width > 0 else inf
    room = (found.upper - found.lower) / ROOM
    lower, upper = decimal(found.lower - room, DIGITS + 6, -1), decimal(found.upper + room, DIGITS + 6, 1)
    ends = {"parameter": family.parameter.name, "from": fraction(start), "to": fraction(end)}
    document = {**found.certificate, "kind": "sliver", **ends, "lower": lower, "upper": upper}
    return Sliver(start, end, lower, upper, document), found.width


def merged(contacts: Contacts) -> Contacts:
    """Neighbours of one sign on one panel as one contact at their mean: what that costs is of the second order."""
    found = ordered(contacts)
    change = (np.diff(found.panel) != 0) | (np.diff(found.sign) != 0) | (np.diff(found.u) > NEAR)
    groups = np.split(np.arange(found.u.size), np.flatnonzero(change) + 1)
    weights = np.array([found.weights[g].sum() for g in groups])
    means = np.array([(found.weights[g] * found.u[g]).sum() for g in groups]) / weights
    first = np.array([g[0] for g in groups])
    return replace(found, panel=found.panel[first], u=means, sign=found.sign[first], weights=weights)


def ball_problem(family: Family, ball: arb) -> Problem:
    """The problem with a ball for the parameter."""
    values = {family.parameter: ball}
    panels = tuple(replace(panel, values=values) for panel in family.moving.panels)
    return Problem(panels, family.moving.functional, values)
