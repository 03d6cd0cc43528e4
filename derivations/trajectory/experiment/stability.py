"""Fixed-gain observers of a polynomial motion: stability over a box of gains, and exact noise levels.

In the variables f = D_f x every motion of order n has the same integer matrices (Pascal's triangle and a
row of ones), so that one gain vector describes the observer f' = Phi f + k (z - h f) completely. Whether all
roots of det(z E - Phi + k h) lie inside the unit circle is decided for a whole box of gains: the map
z = (1 + w) / (1 - w) turns the circle into the imaginary axis, and Routh's column is computed in balls.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import flint
import sympy as sp

from navsym.core.errors import DomainError, TooLargeError
from navsym_papers.trajectory.model import pascal_rows

BITS = 160
LARGEST_BOXES = 20000


@dataclass(frozen=True, slots=True)
class StabilityFinding:
    """What was decided for a box of gains.

    stable  : True or False for the whole box, None when it is neither or undecided
    boxes   : number of sub-boxes examined
    reason  : one sentence
    """

    stable: bool | None
    boxes: int
    reason: str


# -- characteristic polynomial -----------------------------------------------------------------------


def difference_rows(n: int) -> list[list[int]]:
    """Rows h (Phi - E)^m, m = 0..n-1, of Pascal's Phi and h = (1, ..., 1): exact integers."""
    Phi = pascal_rows(n)
    rows = [[1] * n]
    for _ in range(n - 1):
        last = rows[-1]
        rows.append([sum(last[i] * Phi[i][j] for i in range(n)) - last[j] for j in range(n)])
    return rows


def closed_loop(gain: Sequence[flint.arb]) -> list[flint.arb]:
    """Coefficients of det((1 + s) E - Phi + k h) in powers of s, lowest first, length n + 1.

    With M = Phi - E nilpotent, the determinant is s^n + sum_m s^(n-1-m) h M^m k.
    """
    n = len(gain)
    rows = difference_rows(n)
    moments = [sum((k * c for k, c in zip(gain, row, strict=True)), flint.arb(0)) for row in rows]
    return [moments[n - 1 - power] for power in range(n)] + [flint.arb(1)]


def half_plane(coefficients: Sequence[Any]) -> list[Any]:
    """Coefficients in w after z = (1 + w) / (1 - w), that is s = 2 w / (1 - w); highest first.

    Roots with |z| < 1 become roots with negative real part.
    """
    n = len(coefficients) - 1
    out: list[Any] = [0] * (n + 1)
    for power, c in enumerate(coefficients):
        for i in range(n - power + 1):
            out[power + i] += c * (2**power * math.comb(n - power, i) * (-1) ** i)
    return out[::-1]


def write_half_plane(scale: Sequence[str]) -> list[str]:
    """The coefficients of :func:`half_plane` for the gains k1/scale_1, k2/scale_2, ..., highest first, as texts."""
    n, rows = len(scale), difference_rows(len(scale))
    parts = [half_plane([0] * n + [1])]
    parts += [half_plane([rows[n - 1 - power][i] for power in range(n)] + [0]) for i in range(n)]
    names = ["1", *(f"k{i}/({text})" for i, text in enumerate(scale, start=1))]
    return [
        " + ".join(f"{c}*{name}" for c, name in zip(row, names, strict=True) if c) for row in zip(*parts, strict=True)
    ]


def routh_column(polynomial: Sequence[flint.arb]) -> list[flint.arb]:
    """First column of Routh's table; as long as its entries keep away from zero."""
    upper, lower = list(polynomial[0::2]), list(polynomial[1::2])
    column = [upper[0]]
    while lower:
        column.append(lower[0])
        if lower[0].contains(0):
            break
        following = [
            (lower[0] * upper[i + 1] - upper[0] * (lower[i + 1] if i + 1 < len(lower) else 0)) / lower[0]
            for i in range(len(upper) - 1)
        ]
        upper, lower = lower, following
    return column


def decide_column(column: Sequence[flint.arb], length: int) -> bool | None:
    """True: all positive. False: one is negative after positive ones. None: a ball meets zero.

    All positive is Routh's condition for every root to lie left of the imaginary axis. The product of the
    first k entries is Hurwitz's k-th determinant; a polynomial without a root to the right is a limit of such
    polynomials and has no negative determinant, so a first negative entry means a root to the right.
    """
    for entry in column:
        if entry < 0:
            return False
        if not entry > 0:
            return None
    return True if len(column) == length else None


# -- boxes ----------------------------------------------------------------------------------------------


def gain_stability(
    gain: Sequence[Fraction], half_width: Sequence[Fraction], scale: Sequence[flint.arb] | None = None
) -> StabilityFinding:
    """Decide |z| < 1 for all roots of the observer, for every gain in the box.

    gain, half_width : (n,) exact centre and half width
    scale            : (n,) balls that turn the gain into the variables f; None when it is given there

    Boxes that are undecided are halved in the coordinate of largest relative width.
    """
    if len(gain) != len(half_width):
        raise DomainError(f"half_width: expected {len(gain)} entries; got {len(half_width)}; one per gain")
    todo = [[(g - w, g + w) for g, w in zip(gain, half_width, strict=True)]]
    answers: set[bool] = set()
    count = 0
    with flint.ctx.workprec(BITS):
        while todo:
            box = todo.pop()
            count += 1
            answer = decide_box(box, scale)
            if answer is None:
                todo += halves(box)
            else:
                answers.add(answer)
            if len(answers) == 2 or count + len(todo) > LARGEST_BOXES:
                reason = "the box holds both kinds" if len(answers) == 2 else "too many boxes"
                return StabilityFinding(None, count, reason)
    stable = answers.pop()
    side = "every root inside the unit circle" if stable else "a root outside the unit circle"
    return StabilityFinding(stable, count, f"{side} for every gain of the box ({count} boxes)")


def decide_box(box: Sequence[tuple[Fraction, Fraction]], scale: Sequence[flint.arb] | None) -> bool | None:
    """True when every gain of a box is stable, False when none is, None when the balls leave it undecided.

    Routh's column of the characteristic polynomial, mapped from the unit circle to the half plane, in balls.
    """
    balls = [interval(low, high) for low, high in box]
    if scale is not None:
        balls = [b * s for b, s in zip(balls, scale, strict=True)]
    column = routh_column(half_plane(closed_loop(balls)))
    return decide_column(column, len(box) + 1)


def halves(box: list[tuple[Fraction, Fraction]]) -> list[list[tuple[Fraction, Fraction]]]:
    """The box cut in two across its largest relative width; raises TooLargeError for a single point."""
    widths = [(high - low) / max(abs(low), abs(high), Fraction(1, 10**30)) for low, high in box]
    i = widths.index(max(widths))
    middle = (box[i][0] + box[i][1]) / 2
    if widths[i] == 0:
        raise TooLargeError("gain: expected a box that can be decided; got an undecided point; use more bits")
    return [[*box[:i], (box[i][0], middle), *box[i + 1 :]], [*box[:i], (middle, box[i][1]), *box[i + 1 :]]]


def interval(low: Fraction, high: Fraction) -> flint.arb:
    """A ball that contains both ends, hence everything between."""
    return exact(low).union(exact(high))


def exact(x: Fraction) -> flint.arb:
    """A ball that contains a fraction, at the working precision."""
    return flint.arb(flint.fmpq(x.numerator, x.denominator))


def normalised_scale(n: int) -> list[flint.arb]:
    """Factors from gains in the normalised variables x^q = D_s f to gains in f: 1 / D_s."""
    with flint.ctx.workprec(BITS):
        return [1 / flint.arb(sum(i ** (2 * j) for i in range(1, n + 1))).sqrt() for j in range(n)]


def metric_scale(n: int, tau: Fraction) -> list[flint.arb]:
    """Factors from gains in (m, m/s, m/s^2, ...) per metre to gains in f: tau^j / j!."""
    with flint.ctx.workprec(BITS):
        return [exact(tau**j / math.factorial(j)) for j in range(n)]


# -- exact response ----------------------------------------------------------------------------------------


def stationary_covariance(gain: Sequence[Fraction], drive: Sequence[Fraction] | None = None) -> list[list[Fraction]]:
    """Covariance of the error of f under white measurement noise of variance one, exact, (n, n).

    Solves P = C P C^T + k k^T with C = Phi - k h over the rationals; C has to be stable. Another ``drive`` d gives the
    sum of all C^l d d^T C^lT.
    """
    n = len(gain)
    Phi = pascal_rows(n)
    C = [[Phi[i][j] - gain[i] for j in range(n)] for i in range(n)]
    size = n * n
    system = [Fraction(int(r == c)) for r in range(size) for c in range(size)]
    for i in range(n):
        for j in range(n):
            for k in range(n):
                for m in range(n):
                    system[(i * n + j) * size + k * n + m] -= C[i][k] * C[j][m]
    right = [a * b for a in drive or gain for b in drive or gain]
    solved = rational(size, size, system).solve(rational(size, 1, right))
    return [[back(solved[i * n + j, 0]) for j in range(n)] for i in range(n)]


def rational(rows: int, columns: int, entries: Sequence[Fraction]) -> flint.fmpq_mat:
    """A matrix (rows, columns) of flint from fractions, row by row."""
    return flint.fmpq_mat(rows, columns, [flint.fmpq(x.numerator, x.denominator) for x in entries])


def back(x: flint.fmpq) -> Fraction:
    """A rational of flint as a fraction."""
    return Fraction(int(x.p), int(x.q))


def harmonic_lag(gain: Sequence[Fraction], tau: Fraction, period: Fraction, state: int) -> sp.Expr:
    """|estimate - truth| / |truth| of one state in the steady answer to a harmonic motion.

    gain  : (n,) in the variables f; the position is exp(i 2 pi t / period), sampled every tau
    state : 1 position, 2 speed, 3 acceleration, ...
    The observer answers z_k = zeta^k with f zeta^k, f = (zeta E - C)^-1 k zeta; the true f of
    the state is (i omega tau)^(state - 1) / (state - 1)!. With s = zeta - 1 and M = Phi - E, f is
    zeta sum_j M^j k s^(n-1-j) over s^n + sum_j h M^j k s^(n-1-j).
    """
    n, c, s, angle = len(gain), *sp.symbols("c s a", real=True)
    shift, M = c - 1 + sp.I * s, sp.Matrix(pascal_rows(n)) - sp.eye(n)
    columns = [M**j * sp.Matrix([sp.Rational(k) for k in gain]) for j in range(n)]
    above = sum(column[state - 1] * shift ** (n - 1 - j) for j, column in enumerate(columns)) * (shift + 1)
    below = shift**n + sum(sum(column) * shift ** (n - 1 - j) for j, column in enumerate(columns))
    truth = (sp.I * angle) ** (state - 1) / math.factorial(state - 1)
    sizes = [sum(part**2 for part in sp.expand(z).as_real_imag()) for z in (above - truth * below, truth * below)]
    turn = 2 * sp.pi * sp.Rational(tau / period)
    return sp.sqrt(sizes[0] / sizes[1]).subs({c: sp.cos(turn), s: sp.sin(turn), angle: turn})


def bound_bessel(m: int) -> tuple[sp.Expr, sp.Expr]:
    """Two numbers between which J_m(pi/36) lies: sums of two and of three terms of its alternating series."""
    terms = [(sp.pi / 72) ** (2 * k + m) / (math.factorial(k) * math.factorial(k + m)) for k in range(3)]
    return terms[0] - terms[1], terms[0] - terms[1] + terms[2]


def root_decimal(x: Fraction, digits: int) -> str:
    """Decimal string of sqrt(x), rounded to a number of places after the point."""
    scaled = x * 100 ** (digits + 1)
    whole = (math.isqrt(scaled.numerator // scaled.denominator) + 5) // 10
    text = str(whole).rjust(digits + 1, "0")
    return f"{text[:-digits]}.{text[-digits:]}"
