"""What lies between certified ranges: thin stretches of the parameter with a two-sided certificate each.

At a change of pattern the exact contacts are singular. There the parameter is a ball, a dual and places are
fixed, and weak duality bounds the optimum from both sides for every value in the ball.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
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
DEPTH = 6


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


def slivers(family: Family, start: fmpq, end: fmpq, depth: int = DEPTH) -> list[Sliver] | None:
    """Slivers that cover a stretch, halved a few times; None when one of them stays too wide."""
    one = sliver(family, start, end)
    if one is not None:
        return [one]
    if depth == 0:
        return None
    middle = (start + end) / 2
    left = slivers(family, start, middle, depth - 1)
    right = None if left is None else slivers(family, middle, end, depth - 1)
    return None if left is None or right is None else left + right


def sliver(family: Family, start: fmpq, end: fmpq) -> Sliver | None:
    """The two-sided certificate with the parameter as a ball, or None when it is too wide."""
    made = sliver_on(family, start, end, False)
    return sliver_on(family, start, end, True) if made is None else made


def sliver_on(family: Family, start: fmpq, end: fmpq, together: bool) -> Sliver | None:
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
        return None
    if not 0 < found.width < WIDEST or not bool(arb(found.lower) > 0):
        return None
    ends = {"parameter": family.parameter.name, "from": fraction(start), "to": fraction(end)}
    document = {**found.certificate, "kind": "sliver", **ends}
    return Sliver(start, end, document["lower"], document["upper"], document)


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
