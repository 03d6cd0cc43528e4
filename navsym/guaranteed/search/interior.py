"""Among several optimal duals one that leaves as much room below its bound as it can, off the contacts."""

from __future__ import annotations

import numpy as np

from navsym.guaranteed.search.exchange import Contacts, Panels, regressor_rows, search_nodes
from navsym.guaranteed.search.kernels import Array, grid_values

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
