"""Exact points of systems of equations: a search among whole numbers and their square roots.

A polynomial may keep its value, or change its sign, when some variables change theirs: its terms have one parity in
them. Then these variables may all be multiples of one square root, and the polynomial stays rational beside it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from random import Random
from typing import Any

import sympy as sp
from flint import fmpq_poly, nmod_mat

from navsym.observability.reduction import System
from navsym.observability.ring import Poly, Ring

#: Points tried, largest value, and largest number under a root of an equation.
TRIES, LARGEST, LARGE = 1500, 24, 2**60
#: The variable of an equation that is solved.
X = sp.Symbol("x")


def search_points(system: System, ring: Ring) -> Iterator[dict[Any, sp.Expr]]:
    """Points at which the equations vanish, from the last to the first of an order with variables of their own."""
    order = triangular_order(system, ring)
    if not order or ring.meaning:
        return
    source, cosines = Random(5), {cosine for _, cosine in ring.pairs()}
    symmetries = [places for places in sign_changes(order[-1][0]) if not cosines & {*places}]
    for _ in range(TRIES):
        size = source.randint(2, LARGEST)
        at = {k: sp.Integer(source.choice((-1, 1)) * source.randint(1, size)) for k in range(len(ring.symbols))}
        at |= dict.fromkeys(cosines, sp.Integer(1))
        roots = [(source.randint(2, LARGEST), places) for places in symmetries if source.random() < 0.5]
        f, place = order[-1]
        root = root_beside(f, place, at, roots)
        if root is None:
            continue
        at[place] = root
        for number, places in roots:
            at |= {k: at[k] * sp.sqrt(number) for k in places}
        for f, place in reversed(order[:-1]):
            top, *rest = sp.Poly(value_at(f, at, place), X).all_coeffs()
            if len(rest) != 1:
                break
            at[place] = sp.radsimp(-rest[0] / top)
        else:
            if all(sp.expand(value_at(f, at)) == 0 for f in system):
                point = {s: at[k] for k, s in enumerate(ring.symbols) if s.is_Symbol}
                halves = zip(ring.angles, ring.pairs(), strict=True)
                yield point | {angle.symbol: 2 * angle.parts * sp.atan(at[s]) for angle, (s, _) in halves}


def value_at(f: Poly, at: dict[int, sp.Expr], free: int | None = None) -> sp.Expr:
    """A polynomial at a point, in one variable that is left if there is one."""
    values = at if free is None else {**at, free: X}
    terms = ((c, [(values[k], int(e)) for k, e in enumerate(powers) if e]) for powers, c in f.to_dict().items())
    return sp.expand(sp.Add(*(sp.Mul(int(c), *(x**e for x, e in powers)) for c, powers in terms)))


def triangular_order(system: System, ring: Ring) -> list[tuple[Poly, int]]:
    """Equations with variables that those behind them do not hold, linear but in the last; the others may follow."""
    rest, order = sorted(system, key=len, reverse=True), list[tuple[Poly, int]]()
    cosines = {cosine for _, cosine in ring.pairs()}
    while rest:
        own = [
            (int(degree), len(f), place, f)
            for f in rest
            for place, degree in enumerate(f.degrees())
            if degree and place not in cosines and not any(g is not f and g.degrees()[place] for g in rest)
        ]
        own = [item for item in own if item[0] == 1 or len(rest) == 1]
        if own:
            degree, _, place, f = min(own, key=lambda item: item[:3])
            order.append((f, place))
            rest = [g for g in rest if g is not f]
        else:
            rest = rest[1:]
    return order


def sign_changes(f: Poly) -> list[list[int]]:
    """Sets of variables that may change their signs together, the sign of f at most with them: a basis."""
    first, *others = ([int(e) for e in powers] for powers in f.to_dict())
    parities = [[(a - b) % 2 for a, b in zip(row, first, strict=True)] for row in others] or [[0] * len(first)]
    kernel, count = nmod_mat(parities, 2).nullspace()
    held = [k for k, degree in enumerate(f.degrees()) if degree]
    found = [[k for k in held if int(kernel[k, j])] for j in range(count)]
    return [places for places in found if places]


def root_beside(f: Poly, place: int, at: dict[int, sp.Expr], roots: Sequence[tuple[int, list[int]]]) -> sp.Expr | None:
    """A root in one variable, rational or with a square root, where some variables are multiples of square roots."""
    values: dict[int, int] = {}
    lowest = [min(sum(int(p[k]) for k in places) for p in f.to_dict()) for _, places in roots]
    for powers, c in f.to_dict().items():
        value = int(c)
        for k, e in enumerate(powers):
            value *= int(at[k]) ** int(e) if e and k != place else 1
        for (number, places), low in zip(roots, lowest, strict=True):
            value *= number ** ((sum(int(powers[k]) for k in places) - low) // 2)
        values[int(powers[place])] = values.get(int(powers[place]), 0) + value
    if not any(values.values()):
        return None
    found, whole = None, fmpq_poly([values.get(k, 0) for k in range(max(values) + 1)])
    factors: Any = whole.factor()[1]
    for factor, _ in factors:
        parts = [sp.Rational(int(x.p), int(x.q)) for x in factor.coeffs()]
        if len(parts) == 2 and parts[0] != 0:
            return -parts[0] / parts[1]
        if len(parts) == 3 and (inside := parts[1] ** 2 - 4 * parts[0] * parts[2]) > 0 and inside.p * inside.q < LARGE:
            found = (sp.sqrt(inside) - parts[1]) / (2 * parts[2])
    return found
