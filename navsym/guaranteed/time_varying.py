"""Regressors without a closed form: polynomials with a proved error, by Taylor integration.

They are needed where F depends on the time, and where its characteristic polynomial has a factor whose roots
no formula of the language gives.

``Psi(tau) = Phi(tau, T)`` satisfies ``dPsi/dtau = F(tau) Psi`` with ``Psi(T) = I``. From the right end e of a
step it is expanded in ``s = e - tau``: ``(k + 1) Psi_{k+1} = -sum_i F_i Psi_{k-i}``, with the coefficient of the
remainder over the whole step from an enclosure ``|Psi(s)| <= |Psi(0)| exp(s sup|F|)`` there. The polynomial
gets rational coefficients; everything else is one error, a number of which only a bound is known.
Moore, Interval Analysis, chapter 11.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import sympy as sp
from flint import arb, arb_mat, arb_series, fmpq

from navsym.core.balls import enclose, precision, series_terms
from navsym.core.errors import DomainError, TooLargeError
from navsym.core.exact import decimal, from_decimal, to_fmpq, to_rational
from navsym.guaranteed.certificate.enclosure import interval_ball, joint_tape
from navsym.guaranteed.certificate.moving import series_coefficient
from navsym.models.modelfile import ModelFile, Piece

#: The error of a regressor; everything about it is its bound.
ERROR = sp.Symbol("e", real=True)
BITS = 320
ORDER = 40
DIGITS = 60
#: A step is halved until its remainder is below this.
WANTED = arb(10) ** -45
MOST_STEPS = 60


@dataclass(frozen=True, slots=True, eq=False)
class TaylorStep:
    """Psi on [start, end]: polynomials in ``end - t`` and the largest error of an entry."""

    start: fmpq
    end: fmpq
    polynomials: list[list[list[fmpq]]]
    error: arb


def has_varying_system(found: ModelFile) -> bool:
    """True when F contains the time."""
    return any(found.time in piece.F.free_symbols for piece in found.pieces)


def to_rational_interval(found: ModelFile) -> tuple[ModelFile, sp.Expr]:
    """The model on [0, S], S rational, and T - S: what F without the time does depends on T - t alone.

    Where T is rational, where F depends on the time or is given piece by piece, the model itself and zero.
    """
    assert found.T is not None
    if found.T.is_Rational or has_varying_system(found) or len(found.pieces) > 1:
        return found, sp.S.Zero
    above = to_fmpq(enclose(found.T).upper())
    S = to_rational(above)
    return replace(found, T=S, pieces=(replace(found.pieces[0], end=None),)), found.T - S


def integrate_steps(found: ModelFile) -> list[TaylorStep]:
    """Psi on steps from 0 to T, in order. Raises DomainError for ends that are not rational, and TooLargeError."""
    done: list[TaylorStep] = []
    n = len(found.states)
    with precision(BITS):
        Psi = arb_mat([[int(i == j) for j in range(n)] for i in range(n)])
        for piece in reversed(found.pieces):
            end = found.T if piece.end is None else piece.end
            at, last = rational_end(end), rational_end(piece.start)
            size = at - last
            while at > last:
                if len(done) >= MOST_STEPS:
                    raise TooLargeError(
                        f"F: expected a motion that {MOST_STEPS} steps of order {ORDER} resolve; got more; "
                        "shorten the interval"
                    )
                step, Psi, size = longest_step(found, piece, Psi, at, min(size, at - last))
                done.append(step)
                at = step.start
    return list(reversed(done))


def rational_end(end: sp.Expr | None) -> fmpq:
    """An end of the interval as a rational of flint; raises DomainError where it is none."""
    if end is None or not end.is_Rational:
        raise DomainError(f"interval: expected rational ends where F depends on the time; got {end}; give fractions")
    return to_fmpq(end)


def longest_step(
    found: ModelFile, piece: Piece, Psi: arb_mat, at: fmpq, size: fmpq
) -> tuple[TaylorStep, arb_mat, fmpq]:
    """One step to the left of ``at``, halved until its remainder is small; Psi at its left end; the next size."""
    for _ in range(40):
        made = taylor_step(found, piece, Psi, at, size)
        if made is not None:
            return *made, size
        size = size / 2
    raise DomainError(f"F: expected functions that are analytic on the interval; got a singularity near {at}")


def taylor_step(
    found: ModelFile, piece: Piece, Psi: arb_mat, at: fmpq, size: fmpq
) -> tuple[TaylorStep, arb_mat] | None:
    """Psi on ``[at - size, at]``, or None when the remainder is too large."""
    n, h = Psi.nrows(), arb(size)
    thin = system_coefficients(found, piece, arb(at))
    wide = system_coefficients(found, piece, interval_ball(at - size, at))
    bound = row_norm(wide[0])
    growth = (bound * h).exp() * row_norm(Psi)
    if not growth.is_finite() or bool(bound * h > 8):
        return None
    last = solution_coefficients(wide, arb_mat(n, n, [arb(0, growth.upper())] * n**2))[-1]
    rest = row_norm(last) * h**ORDER
    if not bool(rest < WANTED * row_norm(Psi)):
        return None
    parts = [part.entries() for part in solution_coefficients(thin, Psi)[:-1]]
    columns = list(zip(*parts, strict=True))  # the coefficients of every entry
    rounded = [[from_decimal(decimal(c, DIGITS)) for c in column] for column in columns]
    away = [
        sum((abs(c - arb(q)) * h**k for k, (c, q) in enumerate(zip(column, row, strict=True))), rest)
        for column, row in zip(columns, rounded, strict=True)
    ]
    ends = [sum((c * h**k for k, c in enumerate(column)), arb(0, rest.upper())) for column in columns]
    polynomials = [rounded[i * n : (i + 1) * n] for i in range(n)]
    return TaylorStep(at - size, at, polynomials, largest_upper_end(away)), arb_mat(n, n, ends)


def system_coefficients(found: ModelFile, piece: Piece, at: arb) -> list[arb_mat]:
    """Taylor coefficients of F in ``s``, ``t = at - s``; with a ball for every place in it."""
    n = len(found.states)
    with series_terms(ORDER + 1):
        entries = joint_tape(list(piece.F)).run({found.time: arb_series([at, arb(-1)])})
        return [arb_mat(n, n, [series_coefficient(f, k) for f in entries]) for k in range(ORDER + 1)]


def solution_coefficients(F: Sequence[arb_mat], Psi: arb_mat) -> list[arb_mat]:
    """Taylor coefficients 0 … ORDER of Psi in s."""
    done = [Psi]
    for k in range(ORDER):
        total = F[0] * done[k]
        for i in range(1, k + 1):
            total = total + F[i] * done[k - i]
        done.append(total * (arb(-1) / (k + 1)))
    return done


def row_norm(A: arb_mat) -> arb:
    """Largest sum of moduli of a row."""
    return largest_upper_end([sum((abs(a).upper() for a in row), arb(0)) for row in A.tolist()])


def largest_upper_end(values: Sequence[arb]) -> arb:
    """An exact number not below any of the balls; no number at all where one of them is none."""
    top = values[0].upper()
    for value in values[1:]:
        top = top.max(value.upper()).upper()
    return top


def step_regressors(found: ModelFile, step: TaylorStep, shift: sp.Expr) -> tuple[tuple[tuple[sp.Expr, ...], ...], arb]:
    """``h_j(t) Psi(t)`` on a step moved by ``shift``, with :data:`ERROR` added, and the bound of that error."""
    n = len(found.states)
    local = to_rational(step.end) + shift - found.time
    Psi = [[horner_form(c, local) for c in row] for row in step.polynomials]
    rows, bound = [], arb(0)
    for measurement in found.measurements:
        sizes = [largest_on_step(h, found.time, shift, step.start, step.end) for h in measurement.h]
        bound = largest_upper_end([bound, sum(sizes, arb(0)) * step.error])
        rows.append(
            # Unevaluated zeros are left out: sympy would study the signs of long polynomials for them.
            tuple(sp.Add(ERROR, *(h * Psi[i][j] for i, h in enumerate(measurement.h) if h != 0)) for j in range(n))
        )
    return tuple(rows), bound


def horner_form(c: list[fmpq], at: sp.Expr) -> sp.Expr:
    """The polynomial with coefficients c, lowest power first, at an expression, in Horner's form."""
    value: sp.Expr = sp.S.Zero
    for a in reversed(c):
        value = value * at + to_rational(a)
    return value


def largest_on_step(h: sp.Expr, time: sp.Symbol, shift: sp.Expr, start: fmpq, end: fmpq, halvings: int = 8) -> arb:
    """Largest modulus of h on a step moved by ``shift``; parts of it where one ball is too coarse to be a number."""
    place = interval_ball(start, end) + enclose(shift, bits=BITS)
    size = abs(enclose(h, {time: place}, bits=BITS)).upper()
    if size.is_finite() or halvings == 0:
        return size
    middle = (start + end) / 2
    return largest_upper_end(
        [largest_on_step(h, time, shift, *part, halvings - 1) for part in ((start, middle), (middle, end))]
    )


def error_bound(bounds: list[arb]) -> fmpq:
    """A short rational above all bounds, never zero. Raises DomainError where one is no number."""
    top = largest_upper_end(bounds)
    if not top.is_finite():
        raise DomainError("h: expected functions that are finite on the interval; got a singular one; change it")
    return max(from_decimal(decimal(top, 3, 1)), fmpq(1, 10**DIGITS))
