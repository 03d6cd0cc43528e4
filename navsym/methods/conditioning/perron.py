"""Singular values of a matrix whose signs are known: Collatz and Wielandt's bounds in ball arithmetic.

The observability matrix of a polynomial motion is totally positive: its entries are positive and those
of its inverse alternate like a chessboard. Then the largest singular value of the matrix and of its
inverse are Perron roots of positive matrices B^T B, and every positive vector x encloses such a root:

    min_i (B^T B x)_i / x_i  <=  sigma_max(B)^2  <=  max_i (B^T B x)_i / x_i.

Sums of positive balls lose nothing, so a few dozen matrix-vector products give any number of digits. The
signs are checked on the exact inverse each time, nothing is taken on trust; a matrix of other signs gets
None and goes to the exact polynomial.
"""

from __future__ import annotations

import flint

from navsym.methods.conditioning.enclosure import Enclosure, square_root
from navsym.methods.conditioning.exact import Rows, dyadic, fraction, rational_matrix

ITERATIONS = 600


def condition_by_signs(rows: Rows, *, digits: int, equilibrate: bool = False) -> Enclosure | None:
    """Certified 2-norm condition number of a square matrix with chessboard signs, or None."""
    matrix = rational_matrix(rows)
    if matrix.nrows() != matrix.ncols() or not one_sign_pattern(matrix):
        return None
    try:
        inverse = matrix.inv()
    except ZeroDivisionError:
        return None
    if not one_sign_pattern(inverse):
        return None
    with flint.ctx.workprec(int(3.33 * digits) + 64):
        direct, back = magnitudes(matrix), magnitudes(inverse)
        if equilibrate:
            direct, back = scaled(direct, back)
        largest, reciprocal = perron_root(direct, digits + 3), perron_root(back, digits + 3)
    if largest is None or reciprocal is None:
        return None
    return square_root(largest.lower * reciprocal.lower, largest.upper * reciprocal.upper, digits + 3)


def one_sign_pattern(matrix: flint.fmpq_mat) -> bool:
    """True when no entry is zero and the sign of entry (i, j) is s_i t_j: signs can be taken out."""
    n = matrix.ncols()
    entries = matrix.entries()
    if any(x == 0 for x in entries):
        return False
    top = [x > 0 for x in entries[:n]]
    for i in range(matrix.nrows()):
        turned = (entries[i * n] > 0) != top[0]
        if any(((x > 0) != t) != turned for x, t in zip(entries[i * n : (i + 1) * n], top, strict=True)):
            return False
    return True


def magnitudes(matrix: flint.fmpq_mat) -> flint.arb_mat:
    """Balls around the absolute values of the entries: the same singular values when signs come out."""
    return flint.arb_mat(matrix.nrows(), matrix.ncols(), [flint.arb(abs(x)) for x in matrix.entries()])


def scaled(direct: flint.arb_mat, back: flint.arb_mat) -> tuple[flint.arb_mat, flint.arb_mat]:
    """N D^-1 and D N^-1, with D the column norms of N as balls."""
    n = direct.nrows()
    norms = [sum((direct[i, j] ** 2 for i in range(n)), flint.arb(0)).sqrt() for j in range(n)]
    left = flint.arb_mat(n, n, [direct[i, j] / norms[j] for i in range(n) for j in range(n)])
    right = flint.arb_mat(n, n, [back[i, j] * norms[i] for i in range(n) for j in range(n)])
    return left, right


def perron_root(matrix: flint.arb_mat, digits: int) -> Enclosure | None:
    """Bracket of relative width 10^-digits around sigma_max(B)^2, B positive, (n, n); None if too slow."""
    once = matrix.transpose() * matrix
    # Squaring costs n products of a vector and halves the number of rounds; the proof uses `once`.
    twice = once * once
    x = flint.arb_mat(matrix.ncols(), 1, [1] * matrix.ncols())
    wanted = flint.arb(10) ** (-digits)
    for round_ in range(1, ITERATIONS + 1):
        x = midpoints(twice * x)
        # Quotients cost as much as a product; looking every third time is enough.
        if round_ % 3 == 0:
            lower, upper = quotients(once * x, x)
            if upper - lower <= wanted * lower:
                return Enclosure(fraction(dyadic(lower)), fraction(dyadic(upper)))
    return None


def quotients(image: flint.arb_mat, x: flint.arb_mat) -> tuple[flint.arb, flint.arb]:
    """Exact lower end of the smallest and upper end of the largest image_i / x_i."""
    ratios = [a / b for a, b in zip(image.entries(), x.entries(), strict=True)]
    return min(r.lower() for r in ratios), max(r.upper() for r in ratios)


def midpoints(image: flint.arb_mat) -> flint.arb_mat:
    """An exact positive vector near the image, scaled by its first entry's power of two."""
    entries = [y.mid() for y in image.entries()]
    _, exponent = entries[0].man_exp()
    scale = flint.arb(2) ** (-int(exponent))
    return flint.arb_mat(len(entries), 1, [(y * scale).mid() for y in entries])
