"""Certificates of the guaranteed optimum: ``touch`` (exact contacts) and ``gap`` (two-sided).

Weak duality: if ``|x . H| <= sigma`` everywhere and ``sum w_i H(t_i) = P`` then
``x . P <= optimum <= sum sigma |w_i|``. A gap certificate names x and the places t_i, both exact,
and nothing has to touch. A touch certificate names a small box in which Newton's method for intervals finds an
exact solution of the optimality system; then both sides are equal and known to any digits.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from flint import arb, arb_mat, ctx, fmpq

from navsym.core.balls import precision
from navsym.core.exact import EIGHT, decimal, from_decimal, lower_end, rational_near, to_fmpq, upper_end
from navsym.guaranteed.certificate.basis import Basis, make_basis, unit_fraction
from navsym.guaranteed.certificate.enclosure import (
    Panel,
    PanelProblem,
    Touch,
    combine_series,
    dot_product,
    prove_panel_bound,
)
from navsym.guaranteed.certificate.entire import write_entire
from navsym.guaranteed.certificate.polish import ContactSolution, pin_dual, sharpen_contacts
from navsym.guaranteed.search.exchange import (
    Contacts,
    add_places,
    contact_candidates,
    interior_dual,
    regressor_rows,
    search_nodes,
)
from navsym.language.expression import to_text

# As many places as unknowns, with weights that satisfy the constraints exactly: the upper side of the optimum.


def complete_support(basis: Basis, contacts: Contacts, at: Sequence[fmpq]) -> list[tuple[int, fmpq]]:
    """As many places as unknowns, regressors far from dependent: the contacts, filled up from the grid.

    at : the exact fraction of each contact; where a step of Newton's left the panel by a rounding, its end is taken
    """
    C = basis.panels.coefficients
    m = C.shape[2]
    nodes = search_nodes(basis.panels)
    grid = [(k, float(u)) for k in range(C.shape[0]) for u in nodes[:: max(1, nodes.size // (12 * m))]]
    grid += [(k, 1.0) for k in range(C.shape[0])]
    order = np.argsort(-np.abs(contacts.weights))
    chosen: list[tuple[int, fmpq]] = []
    rest = np.eye(m)
    for i in order:
        row = regressor_rows(C, contacts.panel[i : i + 1], contacts.u[i : i + 1])[0] @ rest
        if np.linalg.norm(row) > 1e-7 and len(chosen) < m:
            chosen.append((int(contacts.panel[i]), min(max(at[i], fmpq(0)), fmpq(1))))
            rest = project_out(rest, row)
    rows = regressor_rows(C, np.array([k for k, _ in grid]), np.array([u for _, u in grid]))
    while len(chosen) < m:
        along = rows @ rest
        best = int(np.argmax(np.linalg.norm(along, axis=1)))
        chosen.append((grid[best][0], unit_fraction(grid[best][1])))
        rest = project_out(rest, along[best])
    return chosen


def project_out(rest: np.ndarray, row: np.ndarray) -> np.ndarray:
    """The projection ``rest`` with one more direction taken out."""
    unit = row / np.linalg.norm(row)
    projected: np.ndarray = rest - np.outer(rest @ unit, unit)
    return projected


def balance_weights(problem: PanelProblem, support: Sequence[tuple[int, fmpq]]) -> list[arb]:
    """Weights times their noise bounds with ``sum w H(t_i) = P`` exactly, as balls: no optimum exceeds their sum.

    The order is that of the checker, whose balls are as wide as these where sigma moves.
    """
    panels = [problem.panels[k] for k, _ in support]
    columns = [[h / panel.bound() for h in panel.rows(arb(v))] for panel, (_, v) in zip(panels, support, strict=True)]
    return arb_mat(columns).transpose().solve(arb_mat([[p] for p in problem.target()])).entries()  # type: ignore[no-any-return]


#: Cells of one proof, where numbers have the usual bits or fewer.
LIMIT, USUAL = 20000, 1500
#: Every attempt that gives up digits may have half of those before it, at least this part.
LEAST = 1 / 32
#: With so many lost digits a second box is tried.
CLOSE = 8


@dataclass(frozen=True, slots=True, eq=False)
class CertifiedOptimum:
    """An optimum between two bounds, with the data that prove it.

    lower, upper : exact rationals
    support      : (panel, fraction, weight) with balls for fraction and weight
    dual         : x, exact for a gap, balls for exact contacts
    unique       : True when the estimator is proved to be the only optimal one, else None
    certificate  : plain data for ``navsym check``
    """

    lower: fmpq
    upper: fmpq
    support: tuple[tuple[int, arb, arb], ...]
    dual: tuple[arb, ...]
    unique: bool | None
    certificate: Mapping[str, Any]

    @property
    def width(self) -> float:
        """Relative width of the enclosure."""
        size = abs(self.upper)
        return 0.0 if size == 0 else float(arb((self.upper - self.lower) / size))

    def reaches(self, digits: int) -> bool:
        """The relative width is at most ``10**-digits``, decided in rational numbers."""
        return bool((self.upper - self.lower) * fmpq(10) ** digits <= abs(self.upper))


def certify(problem: PanelProblem, digits: int = 30, basis: Basis | None = None) -> CertifiedOptimum:
    """Solve and enclose to a relative width of ``10**-digits`` if the problem lets us.

    Raises DependentError when the regressors look dependent; the width of the answer tells how
    far it came.
    """
    basis = make_basis(problem) if basis is None else basis
    best: CertifiedOptimum | None = None
    for contacts in contact_candidates(basis.panels):
        found = certify_contacts(problem, basis, contacts, digits)
        best = found if best is None or found.width < best.width else best
        if best.reaches(digits):
            break
    assert best is not None
    return best


def certify_contacts(problem: PanelProblem, basis: Basis, contacts: Contacts, digits: int) -> CertifiedOptimum:
    """The exact-contact certificate where the contacts are regular, else the two-sided one.

    Functions that are close to dependent need a smaller box than the digits ask for: it is tried second.
    """
    loss = basis.loss
    # A ball in the regressors is an error that may differ from instant to instant: only two sides are rigorous then.
    exact_data = not any(panel.values for panel in problem.panels)
    first = refined, bits = refine_contacts(problem, basis, contacts, digits)
    for more in (0, loss) if loss >= CLOSE else (0,):
        if more:
            refined, bits = refine_contacts(problem, basis, contacts, digits + more)
        if not exact_data or not refined.regular or contacts.excess >= 1e-7 or refined.touching:
            break
        proved = certify_touch(problem, basis, refined, digits + more, bits)
        if proved is not None:
            return proved
    refined, bits = first
    return certify_gap(problem, basis, contacts, refined, digits, bits)


def refine_contacts(
    problem: PanelProblem, basis: Basis, contacts: Contacts, digits: int
) -> tuple[ContactSolution, int]:
    """Contacts good for so many digits of the value, and the bits to compute them with."""
    loss = basis.loss
    bits = int(3.33 * (digits + 2 * loss + 25)) + 64
    return sharpen_contacts(problem.panels, basis, contacts, bits, correction_goal(digits + loss)), bits


def correction_goal(digits: int) -> arb:
    """How small corrections must become for so many digits."""
    return arb(10) ** -(digits + 14)


# -- exact contacts ---------------------------------------


def certify_touch(
    problem: PanelProblem, basis: Basis, found: ContactSolution, digits: int, bits: int
) -> CertifiedOptimum | None:
    """The exact-contact certificate, or None when one of its tests fails."""
    loss = basis.loss
    places = digits + 10 + loss // 2  # the digits that cancel in x . H widen what a checker sees of a box
    with precision(bits):
        middles = [decimal(c, places + loss + 8) for c in solution_unknowns(found)]
        spread = [decimal(r, 3, 1) for r in box_radii(problem, basis, found, places)]
        z = solution_box(
            problem, found, [arb(from_decimal(c)) for c in middles], [arb(from_decimal(r)) for r in spread]
        )
        if z is None or not is_admissible(found, z):
            return None
        m = len(found.dual)
        cells = prove_off_contacts(problem, z[:m], exact_touches(found, z), loss)
        if cells is None:
            return None
        value = dot_product(z[:m], problem.target())
        lower, upper = lower_end(value, digits + 4), upper_end(value, digits + 4)
        at, first = put_ends(found, middles, [ENDS.get(end, "") for end in end_names(found)]), len(z) - len(found.v)
        # A place at an end is an unknown for the checker, too, with an equation of its own.
        wide = put_ends(found, spread, [min(spread, key=from_decimal)] * len(found.v))
        solution = {
            "from": "0",
            "to": "0",
            "basis": [[str(int(i == j)) for i in range(m)] for j in range(m)],
            "dual": [[c] for c in middles[:m]],
            "contacts": [
                {"panel": k, "at": [v], "weight": [w]} for k, v, w in zip(found.panel, at, middles[first:], strict=True)
            ],
            "radius": [*spread[:m], *wide, *spread[first:]],
        }
        document = certificate_header(problem, "touch", bits, cells, lower, upper) | {"pieces": [solution]}
        weights = [w / problem.panels[k].bound() for k, w in zip(found.panel, z[first:], strict=True)]
        support = tuple(zip(found.panel, put_ends(found, z, found.v), weights, strict=True))
        return CertifiedOptimum(from_decimal(lower), from_decimal(upper), support, tuple(z[:m]), True, document)


def solution_unknowns(found: ContactSolution) -> list[arb]:
    """(x, inner contacts, weights) in one list."""
    free = [v for v, i in zip(found.v, found.inner, strict=True) if i]
    return [*found.dual, *free, *found.weights]


def box_radii(problem: PanelProblem, basis: Basis, found: ContactSolution, places: int) -> list[arb]:
    """Radii of the box: equal in the orthonormal basis, hence scaled by its columns in that of the problem."""
    unit = arb(10) ** (-places)
    m = len(found.dual)
    columns = [sum((abs(basis.transform[k, j]) for k in range(m)), arb(0)) for j in range(m)]
    weights = sum((abs(w) for w in found.weights), arb(0))
    free = sum(found.inner)
    return [unit * c.mid() for c in columns] + [unit] * free + [unit * weights.mid()] * len(found.weights)


def solution_box(
    problem: PanelProblem, found: ContactSolution, centre: Sequence[arb], radius: Sequence[arb]
) -> list[arb] | None:
    """Balls around the only solution of the optimality system in a box, or None, by Newton's method for intervals.

    With F' enclosed over the box Z the set ``z - F'(Z)^-1 F(z)`` contains every zero in Z; when it lies inside Z a zero
    exists and is the only one. Neumaier, Interval Methods for Systems of Equations, section 5.1.
    """
    box = [c + r * arb(0, 1) for c, r in zip(centre, radius, strict=True)]
    value, _ = optimality_system(problem, found, centre)
    _, jacobian = optimality_system(problem, found, box)
    try:
        moves = jacobian.solve(arb_mat([[f] for f in value]), algorithm="precond").entries()
    except ZeroDivisionError:
        return None
    # A ball that is not finite lies nowhere.
    inside = all(bool(abs(d) < r) for d, r in zip(moves, radius, strict=True))
    return [c - d for c, d in zip(centre, moves, strict=True)] if inside else None


def optimality_system(problem: PanelProblem, found: ContactSolution, z: Sequence[arb]) -> tuple[list[arb], arb_mat]:
    """F and F' of the optimality system over balls: ``f(v_i) - s_i sigma``, ``f'(v_i)``, ``sum w_i H/sigma - P``."""
    m, l = len(found.dual), len(found.v)
    x, w = z[:m], z[len(z) - l :]
    free = iter(range(m, len(z) - l))
    size = len(z)
    J = [[arb(0)] * size for _ in range(size)]
    F = [arb(0)] * (size - m) + [-p for p in problem.target()]
    row = l
    for i, k in enumerate(found.panel):
        panel = problem.panels[k]
        column = next(free) if found.inner[i] else None
        at = found.v[i] if column is None else z[column]
        H, bound = panel.series(at, arb(1), 2), panel.bound()
        f, share = combine_series(x, H), w[i] / bound
        F[i] = f[0] - found.sign[i] * bound
        J[i][:m] = [h[0] for h in H]
        for j, h in enumerate(H):
            F[size - m + j] += share * h[0]
            J[size - m + j][size - l + i] = h[0] / bound
        if column is not None:
            F[row] = f[1]
            J[i][column] = f[1]
            J[row][:m] = [h[1] for h in H]
            J[row][column] = 2 * f[2]
            for j, h in enumerate(H):
                J[size - m + j][column] = share * h[1]
            row += 1
    return F, arb_mat(J)


def is_admissible(found: ContactSolution, z: Sequence[arb]) -> bool:
    """Inner contacts strictly inside their panels, weights of the signs of f."""
    m, l = len(found.dual), len(found.v)
    inside = all(bool(v > 0) and bool(v < 1) for v in z[m : len(z) - l])
    return inside and all(bool(s * w > 0) for s, w in zip(found.sign, z[len(z) - l :], strict=True))


def exact_touches(found: ContactSolution, z: Sequence[arb]) -> list[list[Touch]]:
    """Touches by panel, with balls for the inner ones."""
    rows: list[list[Touch]] = [[] for _ in range(max(found.panel) + 1)]
    places = put_ends(found, z, list(map(to_fmpq, found.v)))
    for k, v, s, end in zip(found.panel, places, found.sign, end_names(found), strict=True):
        rows[k].append(Touch(v, s, True, end))
    return rows


def prove_off_contacts(
    problem: PanelProblem, x: Sequence[arb], touches: Sequence[Sequence[Touch]], loss: int
) -> int | None:
    """Cells that prove ``|x . H| < sigma`` off exact contacts; where few bits do not suffice, with all."""
    with precision(min(ctx.prec, int(3.33 * loss) + 64)):
        cells = prove_all_panels(problem, x, touches)
    return prove_all_panels(problem, x, touches) if cells is None else cells


def prove_all_panels(
    problem: PanelProblem, x: Sequence[arb], touches: Sequence[Sequence[Touch]], share: float = 1.0
) -> int | None:
    """Cells that prove ``|x . H| <= sigma`` on every panel, or None; with many bits fewer of them may be tried."""
    cells, limit = 0, int(share * LIMIT * min(1.0, USUAL / ctx.prec) ** 2)
    for k, panel in enumerate(problem.panels):
        used = prove_panel_bound(panel, x, touches[k] if k < len(touches) else [], limit)
        if used is None:
            return None
        cells += used
    return cells


def put_ends(found: ContactSolution, z: Sequence[Any], ends: Sequence[Any]) -> list[Any]:
    """The places among the unknowns z, and for the contacts that do not move what stands in ``ends``."""
    free = iter(z[len(found.dual) :])
    return [next(free) if inner else end for inner, end in zip(found.inner, ends, strict=True)]


#: The ends of a panel as a certificate names them.
ENDS = {"from": "0", "to": "1"}


def end_names(found: ContactSolution) -> list[str]:
    """On which ends of their panels contacts sit: "from", "to", or "no"."""
    return ["no" if inner else "to" if v == 1 else "from" for v, inner in zip(found.v, found.inner, strict=True)]


# -- two-sided ---------------------------------------


def certify_gap(
    problem: PanelProblem, basis: Basis, contacts: Contacts, found: ContactSolution, digits: int, bits: int
) -> CertifiedOptimum:
    """The two-sided certificate; the dual is shrunk until nothing above the bound is left."""
    places = digits + basis.loss + 12
    with precision(bits):
        support = complete_support(basis, contacts, [from_decimal(decimal(v, places)) for v in found.v])
        costs = balance_weights(problem, support)
        upper = upper_end(sum(map(abs, costs), arb(0)), digits + 6)
        x, cells, touches = best_dual(problem, basis, contacts, found, digits, from_decimal(upper))
        lower = lower_end(dot_product([arb(c) for c in x], problem.target()), digits + 6)
        # The checker has no touches to guide it: it halves its way towards each of them.
        plain = cells + sum(map(len, touches)) * 2 * (digits + 12)
        document = certificate_header(problem, "gap", bits, plain, lower, upper) | {
            "dual": [decimal(c, places + 8) for c in x],
            "support": [[k, decimal(v, places)] for k, v in support],
        }
        rows = tuple((k, arb(v), w / problem.panels[k].bound()) for (k, v), w in zip(support, costs, strict=True))
        shown = tuple(
            row for row in rows if not bool(abs(row[2]) < arb(10) ** (-digits) * abs(arb(from_decimal(upper))))
        )
        return CertifiedOptimum(
            from_decimal(lower), from_decimal(upper), shown, tuple(arb(c) for c in x), None, document
        )


def best_dual(
    problem: PanelProblem, basis: Basis, contacts: Contacts, found: ContactSolution, digits: int, upper: fmpq
) -> tuple[list[fmpq], int, list[list[Touch]]]:
    """The attempt that keeps the bound and reaches highest, the cells of its proof, its touches; zero when none holds.

    The first attempt within the digits of the upper bound is taken: those after it are no better.
    """
    places, target = digits + basis.loss + 12, problem.target()
    best: tuple[list[fmpq], int, list[list[Touch]]] = [fmpq(0)] * len(found.dual), 0, []
    highest, share = fmpq(0), 1.0
    for base, shrink, seen in dual_attempts(problem, basis, contacts, found, digits):
        scale, touches = 1 - fmpq(1, 10) ** shrink, near_touches(problem, seen, places)
        x = [from_decimal(decimal(c * scale, places + 8)) for c in base]
        reached = to_fmpq(dot_product([arb(c) for c in x], target))
        if reached <= highest:
            continue
        cells = prove_all_panels(problem, [arb(c) for c in x], touches, share)
        share = share if shrink > digits else max(share / 2, LEAST)
        if cells is not None:
            best, highest = (x, cells, touches), reached
            if (upper - reached) * 10**digits <= upper:
                break
    return best


def dual_attempts(
    problem: PanelProblem, basis: Basis, contacts: Contacts, found: ContactSolution, digits: int
) -> Iterator[tuple[list[fmpq], int, ContactSolution]]:
    """Duals, by how many digits to shrink them, and where they touch.

    Where the contacts do not fix the dual, round numbers come first, then one that touches at all places where it
    nearly does, then one with room to spare off the contacts, or off all places where it touches.
    """
    base, goal = [to_fmpq(c) for c in found.dual], correction_goal(digits + basis.loss)
    few = 0 < len(contacts.touching) <= len(base)
    # More touches than unknowns are places of a dual that is near its bound along a part of a panel.
    found = found if few else replace(found, touching=())
    if not found.regular:
        rounded = [rational_near(c, 720, EIGHT) for c in base]  # guesses to be proved
        yield [c if r is None else to_fmpq(r) for c, r in zip(base, rounded, strict=True)], digits + 3, found
        full, v = contacts, found.v
        if few:
            full = add_places(basis.panels, contacts, contacts.touching)
            whole = sharpen_contacts(problem.panels, basis, full, ctx.prec, goal)
            v = whole.v
            yield [to_fmpq(c) for c in whole.dual], digits + 3, whole
        for places, at in ((contacts, found.v), (flatten_contacts(full), v)):
            inside = interior_dual(basis.panels, places)
            if inside is not None:
                dual = pin_dual(problem, basis, places, at, inside, goal)
                yield [to_fmpq(c) for c in dual], digits + 3, replace(found, touching=())
                break
    fewer = {3 * digits // 4, digits // 2, 12, 9, 6, 4, 3, 2, 1}
    for k in (digits + 3, *sorted((k for k in fewer if 0 < k < digits + 3), reverse=True)):
        yield base, k, found


def flatten_contacts(places: Contacts) -> Contacts:
    """The same, taken to be flat at ends as well: so are duals that must touch at places which belong together."""
    return replace(places, inner=np.ones_like(places.inner))


def near_touches(problem: PanelProblem, found: ContactSolution, places: int) -> list[list[Touch]]:
    """Where the dual polynomial is expected at its bound: contacts and further near maxima."""
    rows: list[list[Touch]] = [[] for _ in problem.panels]
    for k, at_ball, s in zip(found.panel, found.v, found.sign, strict=True):
        rows[k].append(Touch(from_decimal(decimal(at_ball, places)), s))
    for k, v in found.touching:
        f = dot_product(found.dual, problem.panels[k].rows(arb(v)))
        at = from_decimal(decimal(stationary_fraction(problem.panels[k], found.dual, v), places))
        if all(abs(at - t.at) > fmpq(1, 10**6) for t in rows[k]):
            rows[k].append(Touch(at, 1 if bool(f > 0) else -1))
    return rows


def stationary_fraction(panel: Panel, x: Sequence[arb], v: fmpq) -> fmpq:
    """A stationary point of f near the fraction v, by Newton's method; v itself when it runs away."""
    if v in (0, 1):
        return v
    at = arb(v)
    for _ in range(8):
        f = combine_series(x, panel.series(at, arb(1), 2))
        if f[2].contains(0):
            return v
        at = (at - f[1] / (2 * f[2])).mid()
    return to_fmpq(at) if bool(abs(at - arb(v)) < 1e-4) else v


def certificate_header(
    problem: PanelProblem, kind: str, bits: int, cells: int, lower: str, upper: str
) -> dict[str, Any]:
    """What every kind says about the problem; the parameter is one that occurs nowhere, unless it is replaced."""
    variable = problem.panels[0].variable.name
    return {
        "kind": kind,
        "variable": variable,
        "panels": [panel_row(panel) for panel in problem.panels],
        "functional": [to_text(p) for p in problem.functional],
        "bits": bits,
        "cells": cells,
        "parameter": "p" if variable != "p" else "q",
        "from": "0",
        "to": "0",
        "lower": lower,
        "upper": upper,
    }


def panel_row(panel: Panel) -> dict[str, Any]:
    return {
        "measurement": panel.measurement,
        "from": to_text(panel.start),
        "to": to_text(panel.end),
        "sigma": to_text(panel.sigma),
        "H": [write_entire(h) for h in panel.functions],
    }
