"""Krawczyk's test: a box that contains exactly one exact solution of a square system."""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb, arb_mat


def krawczyk(
    centre: Sequence[arb], radius: Sequence[arb], value: Sequence[arb], jacobian: arb_mat
) -> list[arb] | None:
    """Balls around the only zero of F in ``centre +- radius``, or None when the test fails.

    centre   : exact midpoint of the box
    value    : F(centre), enclosed
    jacobian : F' enclosed over the whole box

    With any matrix Y the set ``K = z - Y F(z) + (I - Y F'(Z)) (Z - z)`` contains every zero in Z;
    when K lies inside Z a zero exists and is the only one. Krawczyk 1969; Neumaier, Interval
    Methods for Systems of Equations, section 5.1.
    """
    n = len(centre)
    middle = arb_mat([[e.mid() for e in row] for row in jacobian.tolist()])
    try:
        Y = arb_mat([[e.mid() for e in row] for row in middle.inv().tolist()])
    except ZeroDivisionError:
        return None
    identity = arb_mat([[1 if i == j else 0 for j in range(n)] for i in range(n)])
    shift = Y * arb_mat([[f] for f in value])
    spread = (identity - Y * jacobian) * arb_mat([[r * arb(0, 1)] for r in radius])
    image = [centre[i] - shift[i, 0] + spread[i, 0] for i in range(n)]
    inside = all(bool(abs(k - z) < r) for k, z, r in zip(image, centre, radius, strict=True))
    return image if inside else None
