"""A pattern followed towards a value where its optimality system becomes singular, with many digits.

Next to such a value contacts merge or weights vanish together, and Newton's method started from afar fails. Values
that come nearer by a constant factor, each started from the ones before by extrapolation, need no more than
digits: those that the system loses there are had from balls of high precision.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import sympy as sp
from flint import arb, arb_mat

from navsym.core.balls import precision
from navsym.guaranteed.certificate.enclosure import PanelProblem
from navsym.guaranteed.certificate.fixed import optimality_system, put_ends, solution_unknowns
from navsym.guaranteed.certificate.polish import ContactSolution
from navsym.guaranteed.phases.family import Family

WALK_BITS = 1600
#: Digits of the box that is tested at the end of the walk.
WALK_DIGITS = 160
#: How much nearer a value comes to the root than the one before: the first few, and the others.
FIRST, NEARER = sp.Rational(4, 5), sp.Rational(1, 4)
MOST_STEPS = 70
MOST_CORRECTIONS = 12
WALK_GOAL = 1e-300


def walk_to(
    family: Family, found: ContactSolution, begin: sp.Rational, root: sp.Rational, end: sp.Rational
) -> ContactSolution | None:
    """The solution of a pattern at ``end``, near the root, from its solution at ``begin`` on the same side."""
    if not found.regular:
        return None
    with precision(WALK_BITS):
        known: list[tuple[sp.Rational, list[arb]]] = []
        value = begin
        for _ in range(MOST_STEPS):
            start = extrapolate(known[-3:], value) if known else solution_unknowns(found)
            z = settle_system(family.exact(value), found, start)
            if z is None:
                return None
            if value == end:
                m, v = len(found.dual), tuple(put_ends(found, z, found.v))
                return replace(found, dual=tuple(z[:m]), v=v, weights=tuple(z[-len(v) :]), residual=0.0, touching=())
            known.append((value, z))
            share = NEARER if len(known) > 2 else FIRST
            value = max((root + (value - root) * share, end), key=lambda p: abs(p - root))
    return None


def extrapolate(known: Sequence[tuple[sp.Rational, list[arb]]], value: sp.Rational) -> list[arb]:
    """Lagrange's polynomial through the last solutions."""
    total = [arb(0)] * len(known[0][1])
    for p, z in known:
        share = sp.Integer(1)
        for q, _ in known:
            share *= (value - q) / (p - q) if q != p else 1
        factor = arb(int(share.p)) / int(share.q)
        total = [a + factor * b for a, b in zip(total, z, strict=True)]
    return [a.mid() for a in total]


def settle_system(problem: PanelProblem, found: ContactSolution, z: list[arb]) -> list[arb] | None:
    """Newton's method on the optimality system, None when it does not settle."""
    last = None
    for _ in range(MOST_CORRECTIONS):
        F, J = optimality_system(problem, found, z)
        middle = arb_mat([[e.mid() for e in row] for row in J.tolist()])
        try:
            step = middle.solve(arb_mat([[f.mid()] for f in F])).entries()
        except ZeroDivisionError:
            return None
        size = max(abs(e).mid() for e in step)
        if not size.is_finite():
            return None
        z = [(a - e).mid() for a, e in zip(z, step, strict=True)]
        if bool(size < arb(WALK_GOAL)) or (last is not None and bool(size < arb(10) ** -200) and not bool(size < last)):
            return z
        last = size
    return None
