"""Condition numbers known with certainty, and what double precision makes of them.

Two independent routes give the same enclosure: eigenvalues in balls (any rational matrix) and Perron bounds for
chessboard signs (the matrices of this paper; faster).
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import flint
import numpy as np

from navsym.core.answers import Answer
from navsym.core.errors import (
    DomainError,
    ExpressionSyntaxError,
    NavsymError,
    NotEstimableError,
    ShapeError,
    TooLargeError,
)
from navsym.core.exact import to_fraction
from navsym.core.numbers import Number
from navsym.core.tables import Table
from navsym.core.units import drop_unit
from navsym.language.names import quote
from navsym.models.earth import observability_rows, power_rows
from navsym.trajectory.enclosure import Enclosure, exponent_of, square_root

# Singular values as eigenvalues: works for every matrix of rational entries.
#
# The squared singular values of N are the eigenvalues of N^T N. Columns scaled to unit length keep that: with
# D = diag(column norms) the matrix D^-1 N^T N D^-1 is similar to N^T N D^-2, which is rational, although D is not.
# flint encloses all eigenvalues of a matrix of balls; they are real, so the ends of their real parts are bounds.


Rows = Sequence[Sequence[Fraction]]


def squared_matrix(rows: Rows, equilibrate: bool) -> flint.fmpq_mat:
    """N^T N, or N^T N D^-2 with the squared lengths of the columns in D^2."""
    matrix = rational_matrix(rows)
    gram = matrix.transpose() * matrix
    return gram * inverse_diagonal(gram) if equilibrate else gram


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


def condition_by_eigenvalues(rows: Rows, *, digits: int, equilibrate: bool = False) -> Enclosure:
    """Certified 2-norm condition number, (m, n) exact numbers with m >= n.

    Raises NotEstimableError when the columns are dependent: the condition number is infinite.
    """
    matrix = squared_matrix(rows, equilibrate)
    if matrix.rank() < matrix.nrows():
        raise NotEstimableError(
            "expected independent columns; got a singular matrix, whose condition number is infinite; "
            "leave out dependent columns"
        )
    for bits in (128 << k for k in range(9)):
        with flint.ctx.workprec(bits):
            values = [x.real for x in flint.acb_mat(matrix).eig(multiple=True, nonstop=True)]
            ends = [(to_fraction(x.lower()), to_fraction(x.upper())) for x in values if x.is_finite()]
        if len(ends) == len(values) and min(ends)[0] > 0:
            lows, highs = zip(*ends, strict=True)
            least, most = max(lows) / min(highs), max(highs) / min(lows)
            if most - least <= least / 10 ** (digits + 2):
                return square_root(least, most, digits + 3)
    raise TooLargeError(f"expected {digits} digits of two eigenvalues; got fewer within the limits; ask for fewer")


def state_condition(rows: Rows, lower: Fraction, upper: Fraction, *, equilibrate: bool = False) -> dict[str, Any]:
    """That the condition number lies between two numbers, as the checker reads it."""
    matrix = [[str(Fraction(x)) for x in row] for row in rows]
    return {"matrix": matrix, "unit": int(equilibrate), "lower": str(lower), "upper": str(upper)}


def certify_condition(statement: dict[str, Any], digits: int = 12) -> dict[str, Any]:
    """The certificate that the statement holds, or else that it fails: brackets of the extreme squared singular values.

    statement : by :func:`state_condition`
    digits    : of the brackets, more than the ends of the statement have
    """
    rows = [[Fraction(x) for x in row] for row in statement["matrix"]]
    bits, (largest, smallest) = extreme_values(squared_matrix(rows, bool(statement["unit"])), digits)
    low, high = Fraction(10**digits - 1, 10**digits), Fraction(10**digits + 1, 10**digits)
    brackets = [round_to(x * side, digits + 4) for x in (largest, smallest) for side in (low, high)]
    least, most = brackets[0] / brackets[3], brackets[1] / brackets[2]
    outside = most < Fraction(statement["lower"]) ** 2 or least > Fraction(statement["upper"]) ** 2
    return {
        "kind": "condition",
        "statement": statement,
        "outside": int(outside),
        "brackets": [*map(str, brackets)],
        "bits": bits,
    }


def extreme_values(matrix: flint.fmpq_mat, digits: int) -> tuple[int, tuple[Fraction, Fraction]]:
    """Bits, and the largest and the smallest eigenvalue, agreed on at half of these bits; all are real and positive.

    A proposal, which its reader proves. Entries of very different sizes hide eigenvalues at few bits.
    """
    sizes = [abs(x) for x in matrix.entries() if x] or [flint.fmpq(1)]
    before, bits = None, min(128 + int(max(sizes) / min(sizes)).bit_length(), 10000)
    while bits <= 20000:
        with flint.ctx.workprec(bits):
            values = [x.real.mid() for x in flint.acb_mat(matrix).eig(algorithm="approx")]
            ends = max(values, key=to_fraction), min(values, key=to_fraction)
        found = to_fraction(ends[0]), to_fraction(ends[1])
        near = [abs(x - y) < x / 10 ** (digits + 4) for x, y in zip(found, before or found, strict=True)]
        if before and all(near):
            return bits, found
        before, bits = found, 2 * bits
    raise TooLargeError(f"expected {digits} digits of two eigenvalues; got fewer within the limits; ask for fewer")


def round_to(x: Fraction, digits: int) -> Fraction:
    """A positive number to so many significant digits."""
    unit = Fraction(10) ** (exponent_of(x) - digits)
    return round(x / unit) * unit


# Singular values of a matrix whose signs are known: Collatz and Wielandt's bounds in ball arithmetic.
#
# The observability matrix of a polynomial motion is totally positive: its entries are positive and those
# of its inverse alternate like a chessboard. Then the largest singular value of the matrix and of its
# inverse are Perron roots of positive matrices B^T B, and every positive vector x encloses such a root:
#
#     min_i (B^T B x)_i / x_i  <=  sigma_max(B)^2  <=  max_i (B^T B x)_i / x_i.
#
# Sums of positive balls lose nothing, so a few dozen matrix-vector products give any number of digits. The
# signs are checked on the exact inverse each time, nothing is taken on trust; a matrix of other signs gets
# None and goes to the eigenvalues.


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
                return Enclosure(to_fraction(lower), to_fraction(upper))
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


#: Beyond this size the printed digits of the entries alone fill megabytes.
LARGEST_ORDER = 120
LARGEST_DIGITS = 2000
#: Digits of an enclosure beside which the error of a double shows.
BESIDE_DOUBLES = 20

#: A double-precision value further off than this is not to be used.
TRUST = 0.10


@dataclass(frozen=True, slots=True)
class MatrixCondition:
    """Certified 2-norm condition number of one matrix, with what double precision makes of it.

    name      : N_p, N_pN, N_f or N_s
    enclosure : exact bounds of the condition number; digits : that were asked for
    computed  : by singular values in double precision; infinite when these overflow
    """

    name: str
    enclosure: Enclosure
    digits: int
    computed: float

    @property
    def value(self) -> Number:
        """The condition number, rounded outwards to the digits that were asked for."""
        return Number(*self.enclosure.decimal(self.digits))

    @property
    def double(self) -> float | None:
        """What double precision gives; None when it overflows."""
        return self.computed if math.isfinite(self.computed) else None

    @property
    def relative_error(self) -> float | None:
        """double / value - 1; None without a double."""
        return None if self.double is None else float(Fraction(self.double) / self.enclosure.lower - 1)

    @property
    def trustworthy(self) -> bool:
        """True when the double is within :data:`TRUST`, relative, of the certified value."""
        return self.relative_error is not None and abs(self.relative_error) <= TRUST

    def document(self) -> dict[str, Any]:
        """The part of the verb's document that belongs to this matrix."""
        names = ("double", "relative_error", "trustworthy")
        return {**self.value.document(), **{name: getattr(self, name) for name in names}}


def check_digits(digits: int) -> None:
    """Refuse digits that no answer has: fewer than one, or more than :data:`LARGEST_DIGITS`."""
    if digits < 1:
        raise DomainError(f"expected 1 to {LARGEST_DIGITS}; got {digits}; ask for at least one", where="digits")
    if digits > LARGEST_DIGITS:
        raise TooLargeError(f"expected 1 to {LARGEST_DIGITS}; got {digits}; ask for fewer", where="digits")


def condition_number(rows: Rows, *, digits: int = 30, equilibrate: bool = False) -> Enclosure:
    """Certified 2-norm condition number of a matrix with exact rational entries.

    rows        : (m, n) exact numbers, m >= n and full column rank
    equilibrate : scale the columns to unit length first (their norms may be irrational)

    Raises DomainError and TooLargeError (digits), and NotEstimableError when the columns are dependent (the
    condition number is infinite).
    """
    check_digits(digits)
    found = condition_by_signs(rows, digits=digits, equilibrate=equilibrate)
    return found or condition_by_eigenvalues(rows, digits=digits, equilibrate=equilibrate)


def four_matrices(n: int, rho: Fraction, tau: Fraction) -> Iterator[tuple[str, Rows, bool]]:
    """Name and rows of N_p, N_pN, N_f, N_s, and whether their columns are scaled to unit length (trajectory:table).

    Signs of columns do not change a norm, so N_pN and N_s agree for every nonzero rho and tau; both are computed from
    their own definitions all the same.
    """
    measured, powers = observability_rows(n, rho, tau), power_rows(n)
    yield from (("N_p", measured, False), ("N_pN", measured, True), ("N_f", powers, False), ("N_s", powers, True))


def check_request(n: int, rho: Fraction, tau: Fraction) -> None:
    """Refuse orders and steps for which the four matrices are not made.

    Raises TooLargeError above :data:`LARGEST_ORDER`, and DomainError for n below 1, tau below 0, and rho or tau zero.
    """
    if n < 1:
        raise DomainError(f"expected 1 to {LARGEST_ORDER}; got {n}; choose a positive order", where="n")
    if n > LARGEST_ORDER:
        raise TooLargeError(f"expected 1 to {LARGEST_ORDER}; got {n}; choose a smaller order", where="n")
    if tau < 0:
        raise DomainError(f"expected a positive step of time; got {tau}; give its length", where="tau")
    if rho == 0 or tau == 0:
        name = "rho" if rho == 0 else "tau"
        raise DomainError("expected a nonzero number; got 0; the columns of N_p would vanish", where=name)


def column_norms(matrix: np.ndarray) -> np.ndarray:
    """Norms with the largest entry taken out, so that squares neither overflow nor vanish."""
    scale = np.abs(matrix).max(axis=0)
    scale[scale == 0] = 1.0
    return scale * np.linalg.norm(matrix / scale, axis=0)


def double_condition(rows: Rows, equilibrate: bool = False) -> float:
    """Largest over smallest singular value of rows (m, n) in doubles; inf where that is no number."""
    matrix = np.array([[float(x) for x in row] for row in rows])
    if equilibrate:
        matrix = matrix / column_norms(matrix)
    if not np.all(np.isfinite(matrix)):
        return math.inf
    values = np.linalg.svd(matrix, compute_uv=False)
    return float(values[0] / values[-1]) if values[-1] > 0 else math.inf


#: A decimal or a fraction of two: nothing else and nothing huge.
DECIMAL = r"\d{1,60}(?:\.\d{0,60})?(?:[eE][+-]?\d{1,3})?"
QUOTIENT = re.compile(rf"[+-]?{DECIMAL}(?:/{DECIMAL})?", re.ASCII)


@dataclass(frozen=True, slots=True)
class Conditions(Answer):
    """Condition numbers of the four observability matrices of a polynomial motion; the answer of :func:`condition`.

    N_p, N_pN : of the measured positions, with their own and with unit columns
    N_f, N_s  : of the powers of the step, with their own and with unit columns
    n, tau, rho, digits : the request; tau in seconds and rho in 1/m, exact
    """

    n: int
    tau: Fraction
    rho: Fraction
    digits: int
    N_p: MatrixCondition
    N_pN: MatrixCondition
    N_f: MatrixCondition
    N_s: MatrixCondition

    def __iter__(self) -> Iterator[MatrixCondition]:
        return iter((self.N_p, self.N_pN, self.N_f, self.N_s))

    @property
    def warnings(self) -> tuple[str, ...]:
        """One sentence for each double-precision value that is off by more than a tenth."""
        return tuple(
            f"{c.name}: the double-precision value {c.double or math.inf:.4e} is off by "
            f"{100 * (math.inf if c.relative_error is None else c.relative_error):+.1f} %"
            for c in self
            if not c.trustworthy
        )

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym condition``."""
        head = {"n": self.n, "rho": str(self.rho), "tau": str(self.tau), "digits": self.digits}
        return {**head, **{c.name: c.document() for c in self}, "warnings": list(self.warnings)}

    def certificates(self) -> list[Mapping[str, Any]]:
        """That each of the four condition numbers lies between its ends, for the checker."""
        found: list[Mapping[str, Any]] = []
        for part, (_, rows, equilibrate) in zip(self, four_matrices(self.n, self.rho, self.tau), strict=True):
            ends = (Fraction(part.value.lower), Fraction(part.value.upper))
            statement = state_condition(rows, *ends, equilibrate=equilibrate)
            found.append(certify_condition(statement, max(self.digits, BESIDE_DOUBLES) + 10))
        return found

    def __repr__(self) -> str:
        values = ", ".join(f"{c.name} {float(c.value):.6g}" for c in self)
        return f"<Conditions n = {self.n}: {values}>"

    def table(self) -> Table:
        """The four enclosures beside double precision, and its relative error."""
        heads, rows = ("matrix", "at least", "at most", "double precision", "off by"), list[tuple[str, ...]]()
        for c in self:
            words = ("overflow", "")
            if c.double is not None and c.relative_error is not None:
                words = (f"{c.double:.6e}", f"{100 * c.relative_error:+.2g} %")
            rows.append((c.name, c.value.lower, c.value.upper, *words))
        return heads, rows


def condition(
    n: int,
    tau: str | int | Fraction = "0.2",
    rho: str | int | Fraction = "1/6371000",
    digits: int = 30,
    *,
    progress: Callable[[str], None] = lambda matrix: None,
) -> Conditions:
    """Certified 2-norm condition numbers of the observability matrices of a polynomial motion seen by its position.

    n        : order of the motion, 1 to 120: n states, n positions
    tau, rho : step in seconds, positive, and factor of the speed in 1/m, not zero: text, int or Fraction, read exactly
    digits   : significant digits of the enclosures, 1 to 2000
    progress : called with the name of each matrix that is done

    The condition number is the largest over the smallest singular value. Their squares are eigenvalues of ``N^T N``,
    enclosed with certainty; beside it stands what double precision makes of it.

    Returns :class:`Conditions`. Raises NavsymError of the kinds ``domain`` (a float, a value out of range),
    ``syntax`` (text that is no number) and ``too-large``. Source: trajectory:table.

    >>> import navsym as nav
    >>> found = nav.condition(3, tau="0.2")
    >>> print(found.N_f.value)
    70.92313380667867...
    >>> found.N_f.trustworthy
    True
    """
    for name, number in (("n", n), ("digits", digits)):
        if isinstance(number, bool) or not isinstance(number, int):
            raise DomainError(f"expected an integer; got {quote(number)}; give one", where=f"condition: {name}")
    tau, rho = read_exactly(tau, "condition: tau", "s"), read_exactly(rho, "condition: rho", "1/m")
    parts = {}
    try:
        check_request(n, rho, tau)
        check_digits(digits)
        for name, rows, equilibrate in four_matrices(n, rho, tau):
            exact = condition_number(rows, digits=max(digits, BESIDE_DOUBLES), equilibrate=equilibrate)
            parts[name] = MatrixCondition(name, exact, digits, double_condition(rows, equilibrate))
            progress(name)
    except NavsymError as error:
        raise error.at("condition") from None
    return Conditions(n, tau, rho, digits, **parts)


def read_exactly(value: Any, where: str, unit: str) -> Fraction:
    """The exact number of a decimal or a fraction, between 1e-100 and 1e100 or zero.

    value : text such as ``"1/6371000"``, an int, a Fraction or a Decimal
    """
    from navsym.language.values import write_value

    text = drop_unit(write_value(value, where, unit), where, unit).strip()
    if not QUOTIENT.fullmatch(text):
        numbers = "a decimal, or a fraction of two, of at most 60 digits"
        message = f"expected {numbers}, such as 1/6371000; got {quote(text)}; write it so"
        raise ExpressionSyntaxError(message, where=where)
    above, _, below = text.partition("/")
    if below and Fraction(below) == 0:
        raise ExpressionSyntaxError("expected a denominator that is not zero; got 0; correct it", where=where)
    number = Fraction(above) / (Fraction(below) if below else 1)
    if number and not Fraction(1, 10**100) <= abs(number) <= 10**100:
        raise TooLargeError(f"expected a number between 1e-100 and 1e100; got {text}; rescale it", where=where)
    return number
