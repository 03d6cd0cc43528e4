"""Krawczyk's test in balls: a box that contains exactly one solution of a square system."""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb, arb_mat, ctx

from navsym.core.balls import precision


def krawczyk(centre: Sequence[arb], radius: Sequence[arb], value: Sequence[arb], jacobian: arb_mat) -> list[arb] | None:
    """Balls around the only zero of F in ``centre +- radius``, or None when the test fails.

    centre   : exact midpoint of the box
    value    : F(centre), enclosed
    jacobian : F' enclosed over the whole box

    With any matrix Y the set ``K = z - Y F(z) + (I - Y F'(Z)) (Z - z)`` contains every zero in Z;
    when K lies inside Z a zero exists and is the only one. Krawczyk 1969; Neumaier, Interval
    Methods for Systems of Equations, section 5.1.
    """
    for bits in (ctx.prec // 2 + 32, ctx.prec):
        image = krawczyk_step(centre, radius, value, jacobian, bits)
        # A ball that is not finite lies nowhere.
        if image is not None and all(bool(abs(k - z) < r) for k, z, r in zip(image, centre, radius, strict=True)):
            return image
    return None


def krawczyk_step(
    centre: Sequence[arb], radius: Sequence[arb], value: Sequence[arb], jacobian: arb_mat, bits: int
) -> list[arb] | None:
    """The set K with a matrix Y of some bits; only ``I - Y F'(Z)`` is computed with so few."""
    n = len(centre)
    with precision(bits):
        try:
            Y = jacobian.mid().inv().mid()
        except ZeroDivisionError:
            return None
        spread = (arb_mat(n, n, 1) - Y * jacobian) * arb_mat(n, 1, [r * arb(0, 1) for r in radius])
    shift = Y * arb_mat(n, 1, list(value))
    return [z - s + d for z, s, d in zip(centre, shift.entries(), spread.entries(), strict=True)]
