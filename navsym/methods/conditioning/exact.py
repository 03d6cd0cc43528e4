"""Singular values as roots of an exact polynomial: works for every matrix of rational entries.

For a matrix N with rational entries the squared singular values are the roots of the characteristic
polynomial of N^T N, which has rational coefficients and only real roots. Columns scaled to unit length
keep that: with D = diag(column norms) the matrix D^-1 N^T N D^-1 is similar to N^T N D^-2, which is
rational again, although D is not.

A floating Newton iteration proposes a bracket for each extreme root; the proof is Descartes' rule of signs,
which counts *exactly* for a polynomial with real roots only: the coefficients of p(x + a) change sign
as often as p has roots above a. Two shifts per root decide the bracket in exact arithmetic.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from fractions import Fraction

import flint

from navsym.errors import NotEstimableError, ShapeError, TooLargeError
from navsym.methods.conditioning.enclosure import Enclosure, square_root

Rows = Sequence[Sequence[Fraction]]


def squared_singular_polynomial(rows: Rows, *, equilibrate: bool = False) -> flint.fmpq_poly:
    """Characteristic polynomial of N^T N, or of N^T N D^-2 when the columns are scaled to unit length.

    Its roots are the squared singular values of N, or of N D^-1.
    """
    matrix = rational_matrix(rows)
    gram = matrix.transpose() * matrix
    if equilibrate:
        gram = gram * inverse_diagonal(gram)
    return gram.charpoly()


def rational_matrix(rows: Rows) -> flint.fmpq_mat:
    """The rows as an exact matrix; ShapeError when they are ragged or empty."""
    widths = {len(row) for row in rows}
    if len(widths) != 1 or not next(iter(widths)):
        raise ShapeError(f"expected rows of one positive length; got {sorted(widths)}; mend the matrix")
    entries = [flint.fmpq(x.numerator, x.denominator) for row in rows for x in map(Fraction, row)]
    return flint.fmpq_mat(len(rows), widths.pop(), entries)


def inverse_diagonal(gram: flint.fmpq_mat) -> flint.fmpq_mat:
    """The diagonal matrix D^-2 (n, n) of 1 / gram[j, j]. Raises NotEstimableError when a column of N is zero."""
    n = gram.nrows()
    if any(gram[j, j] == 0 for j in range(n)):
        raise NotEstimableError("expected columns that are not zero; got a zero column; leave it out")
    return flint.fmpq_mat(n, n, [1 / gram[i, i] if i == j else 0 for i in range(n) for j in range(n)])


def roots_above(polynomial: flint.fmpq_poly, point: flint.fmpq) -> int:
    """Number of roots above a point, for a polynomial all of whose roots are real.

    Sign changes among the coefficients of p(x + point); Descartes' bound is attained when every root is real.
    """
    shifted = polynomial(flint.fmpq_poly([point, 1])).numer().coeffs()
    signs = [c > 0 for c in shifted if c != 0]
    return sum(a != b for a, b in itertools.pairwise(signs))


def largest_root(polynomial: flint.fmpq_poly, digits: int) -> Enclosure:
    """Bracket of relative width 10^-digits around the largest root, proved; all roots real, positive."""
    for guard in (32, 96, 320, 1600):
        bits = math.ceil(digits * 3.3220) + 4
        middle = newton_from_above(polynomial, bits + guard)
        if middle is None:
            continue
        low = middle * flint.fmpq(2**bits - 1, 2**bits)
        high = middle * flint.fmpq(2**bits + 1, 2**bits)
        if roots_above(polynomial, high) == 0 and roots_above(polynomial, low) >= 1:
            return Enclosure(fraction(low), fraction(high))
    raise TooLargeError(f"expected {digits} digits of a root; got fewer within the limits; ask for fewer")


def newton_from_above(polynomial: flint.fmpq_poly, bits: int) -> flint.fmpq | None:
    """A dyadic number near the largest root; only a proposal, the caller proves it.

    Above its largest root a polynomial with real roots is convex, so Newton's iteration from the
    sum of the (positive) roots descends to the largest one.
    """
    with flint.ctx.workprec(bits):
        ball = flint.arb_poly(polynomial)
        slope = ball.derivative()
        degree = polynomial.degree()
        x = flint.arb(-polynomial[degree - 1] / polynomial[degree])
        for _ in range(40 * degree + 200):
            step = (ball(x) / slope(x)).mid()
            if not step.is_finite():
                return None
            x = (x - step).mid()
            if abs(step) <= abs(x) * flint.arb(2) ** (20 - bits):
                return dyadic(x)
    return None


def dyadic(x: flint.arb) -> flint.fmpq:
    """The exact value of a ball of radius zero."""
    mantissa, exponent = x.man_exp()
    power = int(exponent)
    return flint.fmpq(mantissa) * (flint.fmpq(2**power) if power >= 0 else flint.fmpq(1, 2**-power))


def fraction(x: flint.fmpq) -> Fraction:
    """The same rational number for the standard library."""
    return Fraction(int(x.p), int(x.q))


def condition_by_polynomial(rows: Rows, *, digits: int, equilibrate: bool = False) -> Enclosure:
    """Certified 2-norm condition number, (m, n) exact numbers with m >= n.

    Raises NotEstimableError when the columns are dependent: the condition number is infinite.
    """
    polynomial = squared_singular_polynomial(rows, equilibrate=equilibrate)
    if polynomial[0] == 0:
        raise NotEstimableError(
            "expected independent columns; got a singular matrix, whose condition number is infinite; "
            "leave out dependent columns"
        )
    largest = largest_root(polynomial, digits + 3)
    reciprocal = largest_root(flint.fmpq_poly(polynomial.coeffs()[::-1]), digits + 3)
    return square_root(largest.lower * reciprocal.lower, largest.upper * reciprocal.upper, digits + 3)
