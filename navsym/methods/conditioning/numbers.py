"""Condition numbers known with certainty, and what double precision makes of them.

Two independent routes give the same enclosure: the exact characteristic polynomial with proved extreme
roots (any rational matrix) and Perron bounds for chessboard signs (the matrices of this paper; faster).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from navsym.errors import DomainError, TooLargeError
from navsym.methods.conditioning.enclosure import Enclosure
from navsym.methods.conditioning.exact import Rows, condition_by_polynomial
from navsym.methods.conditioning.perron import condition_by_signs
from navsym.models.earth.motion import observability_rows, power_rows

#: Beyond this size the printed digits of the entries alone fill megabytes.
LARGEST_ORDER = 120
LARGEST_DIGITS = 2000

#: A double-precision value further off than this is not to be used.
TRUST = 0.10


@dataclass(frozen=True, slots=True)
class Conditioning:
    """Certified 2-norm condition number of one matrix, with what double precision makes of it.

    name      : N_p, N_pN, N_f or N_s
    enclosure : certified bounds of the condition number
    double    : value by singular values in double precision
    """

    name: str
    enclosure: Enclosure
    double: float

    @property
    def error(self) -> float:
        """Relative error of the double-precision value."""
        if not math.isfinite(self.double):
            return math.inf
        return float(Fraction(self.double) / self.enclosure.lower - 1)

    @property
    def trustworthy(self) -> bool:
        """True when the double-precision value is within :data:`TRUST`, relative, of the certified one."""
        return abs(self.error) <= TRUST


def condition_number(rows: Rows, *, digits: int = 30, equilibrate: bool = False) -> Enclosure:
    """Certified 2-norm condition number of a matrix with exact rational entries.

    rows        : (m, n) exact numbers, m >= n and full column rank
    equilibrate : scale the columns to unit length first (their norms may be irrational)

    Raises DomainError and TooLargeError (digits), and NotEstimableError when the columns are dependent (the
    condition number is infinite).
    """
    if digits < 1:
        raise DomainError(f"expected 1 to {LARGEST_DIGITS}; got {digits}; ask for at least one", where="digits")
    if digits > LARGEST_DIGITS:
        raise TooLargeError(f"expected 1 to {LARGEST_DIGITS}; got {digits}; ask for fewer", where="digits")
    found = condition_by_signs(rows, digits=digits, equilibrate=equilibrate)
    return found or condition_by_polynomial(rows, digits=digits, equilibrate=equilibrate)


def condition_numbers(
    n: int,
    rho: Fraction | int | str,
    tau: Fraction | int | str,
    *,
    digits: int = 30,
    progress: Callable[[str], None] = lambda matrix: None,
) -> dict[str, Conditioning]:
    """Condition numbers of N_p, N_pN, N_f, N_s (trajectory:table), certified and in double precision.

    n        : order of the polynomial motion model, 1 to 120
    rho, tau : exact numbers, rho nonzero (1/m), tau positive (s), text is read as a fraction or a decimal
    progress : called with the name of each matrix that is done
    Raises DomainError and TooLargeError for numbers outside these ranges.
    """
    rho, tau = Fraction(rho), Fraction(tau)
    check_request(n, rho, tau)
    measured, powers = observability_rows(n, rho, tau), power_rows(n)
    # Signs of columns do not change a norm, so N_pN and N_s agree for every nonzero rho and tau;
    # both are computed from their own definitions all the same.
    exact = {}
    for name, rows, equilibrate in (
        ("N_p", measured, False),
        ("N_pN", measured, True),
        ("N_f", powers, False),
        ("N_s", powers, True),
    ):
        exact[name] = condition_number(rows, digits=digits, equilibrate=equilibrate)
        progress(name)
    doubles = double_values(measured, powers)
    return {name: Conditioning(name, exact[name], doubles[name]) for name in exact}


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


# -- double precision beside it --------------------------------------------------------------------


def double_values(measured: Rows, powers: Rows) -> dict[str, float]:
    """The same four numbers by singular values in double precision."""
    plain, whole = doubles(measured), doubles(powers)
    return {
        "N_p": double_condition(plain),
        "N_pN": double_condition(plain / column_norms(plain)),
        "N_f": double_condition(whole),
        "N_s": double_condition(whole / column_norms(whole)),
    }


def doubles(rows: Rows) -> np.ndarray:
    """Exact rows as an array (m, n) of the nearest doubles."""
    return np.array([[float(x) for x in row] for row in rows])


def column_norms(matrix: np.ndarray) -> np.ndarray:
    """Norms with the largest entry taken out, so that squares neither overflow nor vanish."""
    scale = np.abs(matrix).max(axis=0)
    scale[scale == 0] = 1.0
    return scale * np.linalg.norm(matrix / scale, axis=0)


def double_condition(matrix: np.ndarray) -> float:
    """Largest over smallest singular value of a matrix (m, n) in doubles; inf where that is no number."""
    if not np.all(np.isfinite(matrix)):
        return math.inf
    values = np.linalg.svd(matrix, compute_uv=False)
    return float(values[0] / values[-1]) if values[-1] > 0 else math.inf


# -- document --------------------------------------------------------------------------------------


def warnings_of(found: dict[str, Conditioning]) -> list[str]:
    """One sentence for each double-precision value that is off by more than ten per cent."""
    return [
        f"{c.name}: the double-precision value {c.double:.4e} is off by {100 * c.error:+.1f} %"
        for c in found.values()
        if not c.trustworthy
    ]


def document(
    n: int, rho: Fraction | str, tau: Fraction | str, digits: int, progress: Callable[[str], None] = lambda matrix: None
) -> dict[str, Any]:
    """What ``navsym condition`` prints: enclosures, double-precision values and warnings for the four matrices.

    Arguments as in :func:`condition_numbers`, and the same errors; ``digits`` significant digits in the enclosures.
    """
    found = condition_numbers(n, rho, tau, digits=digits, progress=progress)
    parts: dict[str, Any] = {"n": n, "rho": str(Fraction(rho)), "tau": str(Fraction(tau)), "digits": digits}
    for name, c in found.items():
        lower, upper = c.enclosure.decimal(digits)
        finite = math.isfinite(c.double)
        parts[name] = {
            "lower": lower,
            "upper": upper,
            "double": c.double if finite else None,
            "relative_error": c.error if finite else None,
            "trustworthy": c.trustworthy,
        }
    return parts | {"warnings": warnings_of(found)}
