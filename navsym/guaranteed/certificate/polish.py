"""From contacts in double precision to contacts with any number of digits.

The optimality system in (x, inner contacts, weights) is solved by Newton's method with the
Jacobian of the double solution (its pseudo-inverse when the problem is degenerate), residuals in
high precision. In the orthonormal basis that Jacobian is well scaled, so each step gains about as
many digits as the double solution had; nothing here is rigorous.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from flint import arb, arb_mat, fmpq

from navsym.core.balls import precision
from navsym.guaranteed.certificate.basis import Basis, unit_fraction
from navsym.guaranteed.certificate.enclosure import Panel, PanelProblem
from navsym.guaranteed.search.exchange import Contacts, pin_rows
from navsym.guaranteed.search.kernels import contact_system


def contact_rows(
    panels: Sequence[Panel], places: Sequence[int], v: Sequence[arb], inner: Sequence[bool]
) -> tuple[arb_mat, arb_mat]:
    """H and its slopes with respect to the fraction at the places, (l, m) each; slopes of zero at ends."""
    series = [panels[k].series(at, arb(1), int(free)) for k, at, free in zip(places, v, inner, strict=True)]
    slopes = [[h[1] if free else arb(0) for h in row] for row, free in zip(series, inner, strict=True)]
    return arb_mat([[h[0] for h in row] for row in series]), arb_mat(slopes)


STEPS = 60
#: A residual so many times the smallest one, or no number at all, says that Newton's method has run away.
AWAY = arb(10) ** 6
#: Corrections below this may stop shrinking: the precision is used up.
SMALL = arb(1e-12)


@dataclass(frozen=True, slots=True, eq=False)
class ContactSolution:
    """Contacts to high precision, all midpoints exact.

    panel, v, inner, sign : place of each contact as a fraction of its panel, whether it may move, its sign
    weights : times their noise bounds, as certificates have them
    dual    : x in the basis of the problem
    residual : size of the last correction, or what the next one would be, relative
    regular : True when the optimality system is square and far from singular
    """

    panel: tuple[int, ...]
    v: tuple[arb, ...]
    inner: tuple[bool, ...]
    sign: tuple[int, ...]
    weights: tuple[arb, ...]
    dual: tuple[arb, ...]
    residual: float
    regular: bool
    touching: tuple[tuple[int, fmpq], ...] = ()


def sharpen_contacts(
    panels: Sequence[Panel], basis: Basis, contacts: Contacts, bits: int, goal: arb | float
) -> ContactSolution:
    """Newton with a fixed Jacobian until the correction is below ``goal`` or stops shrinking.

    Steps that run away lead back to where they began; the answer is then called irregular.
    """
    inverse, regular = pseudo_inverse(basis, contacts)
    m, l = contacts.dual.size, contacts.u.size
    with precision(bits):
        x = [arb(float(c)) for c in contacts.dual]
        v = [arb(unit_fraction(float(u))) for u in contacts.u]
        w = [arb(float(c)) for c in contacts.weights]
        p = [basis.functional[i, 0] / basis.size for i in range(m)]
        signs = [int(s) for s in contacts.sign]
        inner = [bool(i) for i in contacts.inner]
        places, goal = contacts.panel.tolist(), arb(goal)
        bounds = [panels[k].bound() for k in places]
        begun, away, last = (x, v, w), arb("inf"), None
        for _ in range(STEPS):
            rows = contact_rows(panels, places, v, inner)
            F = optimality_residual(rows, bounds, basis, x, w, p, signs, inner)
            size = largest_modulus(F)
            if not size <= away:
                (x, v, w), regular, size = begun, False, away / AWAY
                break
            away = min(away, AWAY * max(size, SMALL))
            ratio = arb(0) if last is None else (size / last).mid()
            if size < goal or (ratio > 0.5 and size < SMALL):
                break
            done = 0 < ratio < 1e-6 and size * ratio < goal
            last, size = size, (size * ratio).mid()
            step = newton_correction(inverse, F)
            x = [(a + s).mid() for a, s in zip(x, step[:m], strict=True)]
            free = iter(step[m : len(step) - l])
            v = [(a + next(free) / 2).mid() if i else a for a, i in zip(v, inner, strict=True)]
            w = [(a + s).mid() for a, s in zip(w, step[len(step) - l :], strict=True)]
            if done:  # with the ratio of the last two the next correction would be below the goal
                break
        dual = basis.transform.transpose() * arb_mat([[a] for a in x])
        touching = tuple((k, unit_fraction(u)) for k, u in contacts.touching)
        return ContactSolution(
            tuple(int(k) for k in contacts.panel),
            tuple(v),
            tuple(inner),
            tuple(signs),
            tuple((a * basis.size).mid() for a in w),
            tuple(dual[i, 0].mid() for i in range(m)),
            float(size),
            regular,
            touching,
        )


def pin_dual(
    problem: PanelProblem, basis: Basis, places: Contacts, v: Sequence[arb], x: np.ndarray, goal: arb | float
) -> list[arb]:
    """The dual next to x, in the basis of the problem, that meets its bound at the contacts and is flat at inner ones.

    v : the places of the contacts to high precision; they give fewer conditions on x than unknowns
    """
    rows = pin_rows(basis.panels, places)[0]
    inverse, nothing = np.linalg.pinv(rows, rcond=1e-9), [arb(0)] * x.size
    signs, inner = [int(s) for s in places.sign], [bool(i) for i in places.inner]
    y, goal = [arb(float(c)) for c in x], arb(goal)
    bounds = [problem.panels[k].bound() for k in places.panel]
    here = contact_rows(problem.panels, places.panel.tolist(), v, inner)
    for _ in range(STEPS):
        F = optimality_residual(here, bounds, basis, y, [arb(0)] * len(v), nothing, signs, inner)[: rows.shape[0]]
        if largest_modulus(F) < goal:
            break
        y = [(a + s).mid() for a, s in zip(y, newton_correction(inverse, F), strict=True)]
    return [a.mid() for a in (basis.transform.transpose() * arb_mat([[a] for a in y])).entries()]


def pseudo_inverse(basis: Basis, contacts: Contacts) -> tuple[np.ndarray, bool]:
    made, c = basis.panels, contacts
    C, (C1, C2) = made.coefficients, made.derivatives
    _, J = contact_system(C, C1, C2, made.functional, c.panel, c.u, c.inner, c.sign, c.dual, c.weights)
    square = J.shape[0] == J.shape[1]
    if square and (inverse := regular_inverse(J)) is not None:
        return inverse, True
    regular = square and bool(np.linalg.matrix_rank(J, tol=1e-9 * np.linalg.norm(J, 2)) == len(J))
    return np.linalg.pinv(J, rcond=1e-9), regular


def regular_inverse(J: np.ndarray) -> np.ndarray | None:
    """The inverse, where Frobenius' norms say that no singular value is below 1e-9 of the largest."""
    try:
        inverse: np.ndarray = np.linalg.inv(J)
    except np.linalg.LinAlgError:
        return None
    return inverse if np.linalg.norm(J) * np.linalg.norm(inverse) < 1e9 else None


def largest_modulus(F: Sequence[arb]) -> arb:
    """The largest modulus of numbers, exactly; no number where one of them is none."""
    sizes = [abs(f).mid() for f in F]
    return max(sizes) if all(size.is_finite() for size in sizes) else arb("nan")


def newton_correction(inverse: np.ndarray, F: Sequence[arb]) -> list[arb]:
    """``-inverse F`` where F is divided by its largest number, so that tiny residuals keep their digits."""
    scale = largest_modulus(F)
    if scale == 0:
        return [arb(0)] * inverse.shape[0]
    small = np.array([float((f / scale).mid()) for f in F])
    return [-arb(float(s)) * scale for s in inverse @ small]


def optimality_residual(
    rows: tuple[arb_mat, arb_mat],
    bounds: Sequence[arb],
    basis: Basis,
    x: Sequence[arb],
    w: Sequence[arb],
    p: Sequence[arb],
    signs: Sequence[int],
    inner: Sequence[bool],
) -> list[arb]:
    """The optimality system in high precision; slopes with respect to u = 2 v - 1.

    rows   : of :func:`contact_rows`
    bounds : the noise bound at every contact
    """
    H, slopes = rows
    dual = basis.transform.transpose() * arb_mat([[a] for a in x])
    heights = [f / b - s for f, b, s in zip((H * dual).entries(), bounds, signs, strict=True)]
    flat = [f / (2 * b) for f, b, i in zip((slopes * dual).entries(), bounds, inner, strict=True) if i]
    balance = basis.transform * H.transpose() * arb_mat([[a / b] for a, b in zip(w, bounds, strict=True)])
    return [a.mid() for a in [*heights, *flat, *(b - a for a, b in zip(p, balance.entries(), strict=True))]]
