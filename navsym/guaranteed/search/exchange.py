"""Exchange search for the guaranteed estimator: which instants, with which signs and weights.

Minimise ``sum |w_i|`` subject to ``sum w_i q(u_i) = p``; dual: maximise ``p . x`` subject to
``|x . q(u)| <= 1``. The functions q are given by Chebyshev coefficients on panels (one panel
for each analytic piece of each measurement, noise bound divided out), orthonormal or nearly so.
A grid simplex finds the pattern, Newton on the optimality system places the contacts. The
answer is a hint in double precision: :mod:`navsym.guaranteed.certificate.fixed` turns it into enclosures.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from navsym.core.arrays import as_array
from navsym.core.simplex import independent_rows, simplex
from navsym.guaranteed.search.alternance import SAME, find_alternance, local_maxima
from navsym.guaranteed.search.kernels import Array, Ints, contact_system, differentiation, grid_values

NEAR = 1e-7  # |f| above 1 - NEAR counts as touching
NEGLIGIBLE = 1e-7  # weights below this part of their sum are not contacts
ROUNDS = 8
VERTICES = 6
SNAP = 1e-8  # an inner contact this near to an end of its panel stands on the end
MOST_TOUCHES = 600
PER_COEFFICIENT, LEAST, MOST = 12, 128, 20_000  # nodes that find the maxima of a sum, and their bounds


@dataclass(frozen=True, slots=True, eq=False)
class SearchGrid:
    """What every search on the same functions needs, made once: places, values there, rows to start from."""

    nodes: Array
    grid: Array
    start: Ints
    fine: Array


@dataclass(frozen=True, eq=False)
class Panels:
    """Functions on panels and the functional.

    coefficients : (panels, K, m) Chebyshev coefficients in the local variable u in [-1, 1]
    functional   : (m,) p, in the same basis
    """

    coefficients: Array
    functional: Array

    def __post_init__(self) -> None:
        panels, K, m = np.shape(self.coefficients)
        for name, wanted, why in (("coefficients", (panels, K, m), "panels"), ("functional", (m,), "unknowns")):
            object.__setattr__(self, name, as_array(name, getattr(self, name), wanted, why))

    @cached_property
    def derivatives(self) -> tuple[Array, Array]:
        """Coefficients of the first and second derivative with respect to u."""
        D = differentiation(self.coefficients.shape[1])
        slopes = D @ self.coefficients
        return slopes, D @ slopes

    @cached_property
    def search(self) -> SearchGrid:
        """Nodes, values there and rows to start from, made at the first use."""
        nodes = search_nodes(self)
        grid = grid_values(self.coefficients, nodes)
        fine = chebyshev_nodes(min(MOST, max(PER_COEFFICIENT * self.coefficients.shape[1], LEAST)) + 1)
        return SearchGrid(nodes, grid, independent_rows(grid, grid.shape[1]), fine)


@dataclass(frozen=True, slots=True, eq=False)
class Contacts:
    """Where the dual polynomial touches its bound, in double precision.

    panel, u : (l,) place of each contact, u in [-1, 1]
    inner    : (l,) 1 where the contact may move (f' = 0 there), 0 at an end of a panel
    sign     : (l,) sign of f there, also of the weight
    weights  : (l,)
    dual     : (m,)
    excess   : largest ``|f| - 1`` seen on a fine grid
    touching : panel and u of every further place where ``|f|`` is near one, weight zero
    """

    panel: Ints
    u: Array
    inner: Ints
    sign: Array
    weights: Array
    dual: Array
    excess: float
    touching: tuple[tuple[int, float], ...] = ()


def search_nodes(panels: Panels) -> Array:
    """Chebyshev-spaced search nodes, ends included, several for each oscillation."""
    K = panels.coefficients.shape[1]
    m = panels.functional.size
    return chebyshev_nodes(int(min(4000, max(6 * K, 16 * m, 64))) + 1)


@lru_cache(maxsize=32)
def chebyshev_nodes(count: int) -> Array:
    """``-cos(pi k / (count - 1))``, (count,) rising from -1 to 1, both exact; read-only, since it is shared."""
    nodes: Array = -np.cos(np.pi * np.arange(count) / (count - 1))
    nodes[0], nodes[-1] = -1.0, 1.0
    nodes.flags.writeable = False
    return nodes


def find_contacts(panels: Panels) -> Contacts:
    """Solve the problem to double precision; the fast road first, the careful one when it refuses."""
    return next(contact_candidates(panels))


def contact_candidates(panels: Panels) -> Iterator[Contacts]:
    """The answer of the fast road, where it has one, then that of the careful one."""
    quick = regular_contacts(panels)
    if quick is not None:
        yield quick
    yield degenerate_contacts(panels, panels.search.nodes)


def regular_contacts(panels: Panels) -> Contacts | None:
    """Contacts of a full alternance, or None when there is none or the fast road does not find it."""
    made = panels.search
    move, panel, u, weights, x, height, where, places = find_alternance(
        panels.coefficients, panels.functional, made.nodes, made.grid, made.start, made.fine, 1.0 - NEAR
    )
    sizes = np.abs(weights)
    if move == np.inf or height > 1.0 + 1e-9 or not sizes.min() > NEGLIGIBLE * sizes.sum():
        return None
    inner = (np.abs(u) < 1.0).astype(np.int64)
    touching = tuple(zip(where.tolist(), places.tolist(), strict=True))[:MOST_TOUCHES]
    return Contacts(panel, u, inner, np.sign(weights), weights, x, height - 1.0, touching)


def regressor_rows(coefficients: Array, panel: Ints, u: Array) -> Array:
    """q at the given places, (l, m)."""
    K = coefficients.shape[1]
    T = np.cos(np.arange(K) * np.arccos(np.clip(u, -1.0, 1.0))[:, None])
    rows: Array = np.einsum("lk,lkm->lm", T, coefficients[panel])
    return rows


def degenerate_contacts(panels: Panels, nodes: Array) -> Contacts:
    """The road for degenerate problems: vertices of the dual face, averaged; contacts merged."""
    C, p = panels.coefficients, panels.functional
    extra_panel = np.empty(0, dtype=np.int64)
    extra_u = np.empty(0)
    best: Contacts | None = None
    for k in range(ROUNDS):
        panel = np.concatenate([np.repeat(np.arange(C.shape[0]), nodes.size), extra_panel])
        u = np.concatenate([np.tile(nodes, C.shape[0]), extra_u])
        G = np.concatenate([grid_values(C, nodes), regressor_rows(C, extra_panel, extra_u)])
        basis, vertices = dual_face(G, p)
        tried = []
        # A point inside the face; where the face is a point in truth, only the first vertex comes near it.
        for x in (vertices.mean(axis=0), vertices[0]):
            for reach in {1.0, 3.0**-k}:  # contacts may be nearer than nodes: later rounds keep them apart
                tried.append(fit_contacts(panels, merge_rows(panels, G, p, basis, panel, u, nodes, reach), x))
            best = min(tried if best is None else [best, *tried], key=lambda c: c.excess)
            best = best if best.excess < 1e-9 or has_misfits(best) else complete_dual(panels, best)
            if best.excess < 1e-9:
                return best
        for dual in (*vertices, tried[-1].dual):
            where, places, height = local_maxima(C @ dual, panels.search.fine)
            extra_panel = np.concatenate([extra_panel, where[height > 1.0 + 1e-12]])
            extra_u = np.concatenate([extra_u, places[height > 1.0 + 1e-12]])
    assert best is not None
    return best


def complete_dual(panels: Panels, found: Contacts) -> Contacts:
    """The same with a dual that also touches where it nearly does, by Newton's method; if it is optimal.

    Where the dual is unique and contacts without weight belong to it, the contacts with weight do not fix it.
    """
    C1, C2 = panels.derivatives
    where, places, heights = local_maxima(panels.coefficients @ found.dual, panels.search.fine)
    near = heights > 1.0 - max(NEAR, 30.0 * found.excess)
    all_ = add_places(panels, found, places_apart(where[near], places[near], found.panel, found.u))
    panel, u, inner, sign, x, weights = all_.panel, all_.u, all_.inner, all_.sign, all_.dual, all_.weights
    free, m = int(inner.sum()), x.size
    for _ in range(8):
        F, J = contact_system(panels.coefficients, C1, C2, panels.functional, panel, u, inner, sign, x, weights)
        rows = u.size + free  # what the weights must satisfy is left out
        step = np.linalg.lstsq(J[:rows, : m + free], -F[:rows], rcond=1e-11)[0]
        x, u = x + step[:m], u.copy()
        u[inner == 1] = np.clip(u[inner == 1] + step[m:], -1.0, 1.0)
    excess, touching = survey_dual(panels, x, found.panel, found.u)
    cost = float(np.abs(found.weights).sum())
    if excess >= found.excess or abs(float(panels.functional @ x) - cost) > 1e-9 * cost:
        return found  # where the two sides differ, contacts are missing that have a weight
    return replace(found, dual=x, excess=excess, touching=touching)


def add_places(panels: Panels, found: Contacts, more: Sequence[tuple[int, float]]) -> Contacts:
    """The contacts and further places without weight."""
    extra = np.array([v for _, v in more])
    panel = np.concatenate([found.panel, np.array([k for k, _ in more], dtype=np.int64)])
    u = np.concatenate([found.u, extra])
    inner = np.concatenate([found.inner, (np.abs(extra) < 1.0).astype(np.int64)])
    sign = np.sign(regressor_rows(panels.coefficients, panel, u) @ found.dual)
    weights = np.concatenate([found.weights, np.zeros(extra.size)])
    return replace(found, panel=panel, u=u, inner=inner, sign=sign, weights=weights, touching=())


def pick_contacts(found: Contacts, chosen: Ints, touching: tuple[tuple[int, float], ...]) -> Contacts:
    """Some of the contacts, in the order chosen, and the places that touch beside them."""
    names = ("panel", "u", "inner", "sign", "weights")
    return replace(found, touching=touching, **{name: getattr(found, name)[chosen] for name in names})


def dual_face(G: Array, p: Array) -> tuple[Ints, Array]:
    """An optimal basis and vertices (n, m) of the face of optimal duals.

    Small changes of p lead to the vertices; their mean touches the bound only where every optimal dual does.
    """
    random = np.random.default_rng(7)
    size = 1e-9 * np.abs(p).max()
    limit = 80 * p.size + 400
    basis, _, x, _ = simplex(G, p + size * random.standard_normal(p.size), independent_rows(G, p.size), limit)
    first, vertices = basis, [x]
    for _ in range(VERTICES):
        basis, _, x, _ = simplex(G, p + 100 * size * random.standard_normal(p.size), basis, limit)
        vertices.append(x)
    return first, np.array(vertices)


def merge_rows(
    panels: Panels, G: Array, p: Array, basis: Ints, panel: Ints, u: Array, nodes: Array, reach: float
) -> tuple[Ints, Array, Array, Array]:
    """Contacts from basis rows: negligible ones dropped, neighbours of one sign made one."""
    weights = np.linalg.lstsq(G[basis].T, p, rcond=1e-13)[0]
    keep = np.abs(weights) > NEGLIGIBLE * np.abs(weights).sum()
    basis, weights = basis[keep], weights[keep]
    order = np.lexsort((u[basis], panel[basis]))
    groups: list[list[int]] = []
    for k in order:
        if groups:
            last = groups[-1][-1]
            after = int(np.clip(np.searchsorted(nodes, u[basis[k]]), 1, nodes.size - 1))
            near = abs(u[basis[k]] - u[basis[last]]) <= 2.6 * reach * (nodes[after] - nodes[after - 1])
            if near and panel[basis[k]] == panel[basis[last]] and weights[k] * weights[last] > 0:
                groups[-1].append(int(k))
                continue
        groups.append([int(k)])
    at_panel = np.array([panel[basis[g[0]]] for g in groups], dtype=np.int64)
    at_weight = np.array([weights[g].sum() for g in groups])
    at_u = np.array([end_or_mean(u[basis[g]], weights[g]) for g in groups])
    return at_panel, at_u, np.sign(at_weight), at_weight


def end_or_mean(u: Array, weights: Array) -> float:
    """The weighted mean of places u (l,) in [-1, 1], or the outermost of them when the mean is at an end."""
    mean = float((u * weights).sum() / weights.sum())
    return float(u[np.abs(u).argmax()]) if abs(mean) > 1.0 - 1e-9 else mean


def fit_contacts(panels: Panels, start: tuple[Ints, Array, Array, Array], x: Array) -> Contacts:
    """Newton in the least-squares sense on the optimality system, contacts kept inside their panels."""
    C = panels.coefficients
    C1, C2 = panels.derivatives
    panel, u, sign, weights = start
    inner = inner_flags(C1, panel, u, sign, x)
    m, l = panels.functional.size, u.size
    x = x.copy()
    for _ in range(25):
        F, J = contact_system(C, C1, C2, panels.functional, panel, u, inner, sign, x, weights)
        step = np.linalg.lstsq(J, -F, rcond=1e-11)[0]
        x = x + step[:m]
        moved = u.copy()
        moved[inner == 1] += np.clip(step[m : m + int(inner.sum())], -0.2, 0.2)
        weights = weights + step[-l:]
        outside = (np.abs(moved) >= 1.0 - SNAP) & (inner == 1)
        u = np.where(outside, np.sign(moved), moved)
        inner = np.where(outside, 0, inner)
        if np.abs(step).max() < 1e-13 * max(1.0, float(np.abs(x).max())):
            break
    kept, weights = drop_dependent_contacts(regressor_rows(C, panel, u), weights)
    heavy = np.abs(weights) > NEGLIGIBLE * np.abs(weights).sum()  # the others touch without a weight
    kept, weights = kept[heavy], weights[heavy]
    panel, u, inner, sign = panel[kept], u[kept], inner[kept], sign[kept]
    excess, touching = survey_dual(panels, x, panel, u)
    found = Contacts(panel, u, inner, sign, weights, x, excess, touching)
    return replace(found, excess=max(excess, 1e-3)) if has_misfits(found) else found


def has_misfits(found: Contacts) -> bool:
    """Some weight has not the sign of the dual polynomial at its contact."""
    return bool((found.weights * found.sign <= 0).any())


def drop_dependent_contacts(rows: Array, weights: Array) -> tuple[Ints, Array]:
    """Fewer contacts with the same sum and the same cost, until their rows are independent.

    Along a null vector n of the rows the cost ``sum |w|`` does not change while no weight changes
    its sign, since ``x . row_i = sign(w_i)``; the first weight that vanishes is dropped. Carathéodory.
    """
    kept = np.arange(weights.size)
    while kept.size > 1:
        _, s, Vt = np.linalg.svd(rows[kept].T)
        if kept.size <= s.size and s[-1] > 1e-9 * s[0]:
            break
        n = Vt[-1]
        ratios = np.where(np.abs(n) > 1e-12, weights / np.where(n == 0.0, 1.0, n), np.inf)
        forward = np.where(ratios > 0, ratios, np.inf)
        if not np.isfinite(forward).any():
            n, forward = -n, np.where(ratios < 0, -ratios, np.inf)
        if not np.isfinite(forward).any():
            break
        drop = int(np.argmin(forward))
        weights = np.delete(weights - forward[drop] * n, drop)
        kept = np.delete(kept, drop)
    return kept, weights


def inner_flags(C1: Array, panel: Ints, u: Array, sign: Array, x: Array) -> Ints:
    """0 for a contact on an end of its panel towards which the polynomial still grows, or is flat."""
    flags = np.ones(u.size, dtype=np.int64)
    for i in np.flatnonzero(np.abs(u) >= 1.0 - 1e-12):
        slope = regressor_rows(C1, panel[i : i + 1], u[i : i + 1])[0] @ x
        flags[i] = 0 if slope * sign[i] * u[i] > -1e-6 else 1
    return flags


def survey_dual(panels: Panels, x: Array, panel: Ints, u: Array) -> tuple[float, tuple[tuple[int, float], ...]]:
    """Largest ``|f| - 1``, and the near-touching maxima that are not among the given contacts."""
    where, v, height = local_maxima(panels.coefficients @ x, panels.search.fine)
    near = height > 1.0 - NEAR
    return float(height.max(initial=1.0)) - 1.0, places_apart(where[near], v[near], panel, u)


def places_apart(where: Ints, v: Array, panel: Ints, u: Array) -> tuple[tuple[int, float], ...]:
    """The near-touching places that are not among the given contacts."""
    contacts = list(zip(panel.tolist(), u.tolist(), strict=True))
    rest = [
        (k, place)
        for k, place in zip(where.tolist(), v.tolist(), strict=True)
        if not any(k == j and abs(place - w) < SAME for j, w in contacts)
    ]
    return tuple(rest[:MOST_TOUCHES])


# Among several optimal duals one that leaves as much room below its bound as it can, off the contacts.

#: Less room than this is none.
LEAST_SLACK = 1e-7


def interior_dual(panels: Panels, contacts: Contacts) -> Array | None:
    """The dual x with ``x . q = sign`` at the contacts and the most room elsewhere, or None.

    Flat at inner contacts, with the largest delta in ``|x . q(u)| <= 1 - delta room(u)`` on a grid; None when nothing
    is left to choose or the search fails.

    A vertex of the face of optimal duals touches its bound at places that carry no weight, which no certificate
    in rounded numbers survives; a point inside the face does not.
    """
    from scipy.optimize import linprog

    A, values = pin_rows(panels, contacts)
    m = panels.functional.size
    if np.linalg.matrix_rank(A, tol=1e-9) >= m:
        return None
    nodes = search_nodes(panels)
    G, room = grid_values(panels.coefficients, nodes), wanted_slack(panels, contacts, nodes)[:, None]
    answer = linprog(
        np.r_[np.zeros(m), -1.0],
        A_ub=np.block([[G, room], [-G, room]]),
        b_ub=np.ones(2 * G.shape[0]),
        A_eq=np.c_[A, np.zeros(A.shape[0])],
        b_eq=values,
        bounds=[(None, None)] * m + [(0.0, 1.0)],
    )
    return np.asarray(answer.x[:m], dtype=float) if answer.success and answer.x[m] > LEAST_SLACK else None


def pin_rows(panels: Panels, contacts: Contacts) -> tuple[Array, Array]:
    """Values at the contacts and slopes at the inner ones as rows for x, with what they must be."""
    inner = contacts.inner == 1
    rows = regressor_rows(panels.coefficients, contacts.panel, contacts.u)
    flat = regressor_rows(panels.derivatives[0], contacts.panel[inner], contacts.u[inner])
    return np.vstack([rows, flat]), np.r_[contacts.sign.astype(float), np.zeros(int(inner.sum()))]


def wanted_slack(panels: Panels, contacts: Contacts, nodes: Array) -> Array:
    """The room that is wanted: 0 at a contact, from there up to 1 like a parabola, from an end like a line."""
    wanted = np.ones((panels.coefficients.shape[0], nodes.size))
    for k, u, inner in zip(contacts.panel, contacts.u, contacts.inner, strict=True):
        away = 3.0 * np.abs(nodes - u)
        wanted[k] = np.minimum(wanted[k], away**2 if inner else away)
    return wanted.ravel()
