"""Epochs with too few measurements to determine the state: the target may be determined all the same, exactly."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from flint import arb, arb_mat, fmpq

from navsym.core.simplex import independent_rows
from navsym.guaranteed.streaming.estimate import Plan
from navsym.guaranteed.streaming.exchange import Cloud, bounds_of, exchange
from navsym.guaranteed.streaming.flow import Flow, in_row_space, pivot_columns
from navsym.guaranteed.streaming.memory import Row, list_cones

#: With more rows than this, rational ranks cost more than they are worth.
MOST = 400


def solve_scarce(flow: Flow, rows: Sequence[Row], now: fmpq) -> Plan | None:
    """The least radius from rows that do not determine the state; None where the target is not proved to be estimable.

    Where all rows are rational, the space that they span is known exactly, and a vector of it by its entries at the
    pivots. Otherwise those of the present epoch alone are (Phi is the identity there); they give the optimum
    where all rows together are independent, because an unbiased estimator is then unique.
    """
    functional = [flow.exact_target(k) for k in range(len(flow.functional))]
    if not rows or len(rows) > MOST or any(p is None for p in functional):
        return None
    exact = [flow.exact_row(row.j, row.t, now) for row in rows]
    places = [i for i, row in enumerate(exact) if row is not None]
    if len(places) < len(rows):
        places = [i for i in places if rows[i].t == now]
        if not places or not are_independent(flow, rows, now):
            return None
    table = [exact[i] for i in places]
    if not in_row_space(functional, table):  # type: ignore[arg-type]
        return None
    return solve_reduced(flow, rows, now, places, table, functional)  # type: ignore[arg-type]


def solve_reduced(
    flow: Flow,
    rows: Sequence[Row],
    now: fmpq,
    places: Sequence[int],
    table: Sequence[Sequence[fmpq]],
    functional: Sequence[fmpq],
) -> Plan | None:
    """The optimum in the unknowns at the pivots of the rows."""
    columns = pivot_columns(table)
    cloud = reduced_cloud(flow, [rows[i] for i in places], table, columns)
    start = cloud.start()
    found = start and exchange(cloud, arb_mat([[functional[k] for k in columns]]), start)
    if not found:
        return None
    lower, upper = bounds_of(cloud, found)
    weights, whole = cloud.spread(found), len(places) == len(rows)
    basis = [places[i] for i in weights]
    return Plan(flow, now, list(rows), columns, basis, found.signs, [*weights.values()], lower, upper, whole)


def reduced_cloud(
    flow: Flow, rows: Sequence[Row], table: Sequence[Sequence[fmpq]], columns: Sequence[int], *, data: bool = False
) -> Cloud:
    """Rows with their regressors at the pivots, and the measurements where they matter."""
    vectors = [arb_mat([[row[k] for k in columns]]) for row in table]
    sigma, offset = [row.sigma for row in rows], [arb(row.z) for row in rows] if data else []
    scaled = [[float(e / s) for e in v.entries()] for v, s in zip(vectors, sigma, strict=True)]
    shifted = np.array([float(z / s) for z, s in zip(offset, sigma, strict=True)]) if data else None
    return Cloud(vectors, sigma, np.array(scaled), offset, shifted, cones=list_cones(flow, rows))


def find_contradiction(flow: Flow, rows: Sequence[Row], now: fmpq, most: int = 0) -> list[Row]:
    """Rational rows that no state explains together; none where that is not proved, or without ``most`` epochs not so.

    Whoever explains the data gives one of the epochs of a contradiction a gross error: each is left out in turn.
    """
    found = contradict(flow, rows, now)
    for t in dict.fromkeys((row.t.p, row.t.q) for row in found) if most else ():
        if not find_contradiction(flow, [row for row in rows if (row.t.p, row.t.q) != t], now, most - 1):
            return []
    return found


def contradict(flow: Flow, rows: Sequence[Row], now: fmpq) -> list[Row]:
    """The same without gross errors."""
    exact = [flow.exact_row(row.j, row.t, now) for row in rows] if len(rows) <= MOST else []
    known = [(row, line) for row, line in zip(rows, exact, strict=False) if line is not None]
    for row, line in known:
        if not any(line) and abs(arb(row.z)) > row.sigma:
            return [row]  # it shows nothing but its noise
    table = [line for _, line in known]
    columns = pivot_columns(table) if table else []
    if not columns:
        return []
    cloud = reduced_cloud(flow, [row for row, _ in known], table, columns, data=True)
    start = cloud.start()
    found = start and exchange(cloud, arb_mat([[1] * len(columns)]), start)
    if not found or found.ray is None:
        return []
    return [known[i][0] for i, w in cloud.spread(found).items() if not w.contains(0)]


def are_independent(flow: Flow, rows: Sequence[Row], now: fmpq) -> bool:
    """Whether balls show that no row is a combination of the others: some square minor is not zero."""
    k = len(rows)
    if k > flow.size:
        return False
    balls = [[flow.ball_row(row.j, row.t, now)[c] for c in flow.columns] for row in rows]
    chosen = independent_rows(np.array([[float(e.mid()) for e in row] for row in balls]).T, k, 0.0)
    return len(chosen) == k and not arb_mat([[row[c] for c in chosen] for row in balls]).det().contains(0)
