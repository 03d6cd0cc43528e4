"""exp(x t) modulo one irreducible factor q^m of a characteristic polynomial, in closed form.

The factor is given for B = d A (polynomial entries), in the variable mu = d lambda. A form is a
sum of pieces, each a function of time times a polynomial in mu over a divisor:

    linear      (mu - a)^m          exp(alpha t) t^j
    quadratic   ((mu - alpha)^2 - D)^m   with D < 0: cos, sin; D > 0: cosh, sinh
    biquadratic u^4 + a u^2 + b, u = mu - alpha: two frequencies, or damped waves
    other       a sum over the roots, only for m = 1

The functions of a root are even in it (cos(w t), sin(w t)/w), so the sign taken for a square root
does not matter, and the formulas hold over the complex numbers even where a radicand is negative.
"""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp

from navsym.errors import DomainError
from navsym.models.parameter_ring import Poly, Ring, cancelled, sign
from navsym.models.polynomials import Coefficients, product
from navsym.models.transition.biquadratic import biquadratic, shifted
from navsym.models.transition.pieces import (
    LAMBDA,
    RATIONAL,
    Form,
    Frame,
    Piece,
    Root,
    Wave,
    in_lambda,
    reality,
    root_of,
    scaled,
)

HALF = sp.Rational(1, 2)


def form_of(ring: Ring, base: Coefficients, times: int, d: Poly, time: sp.Expr) -> Form:
    """The closed form of exp(x t) modulo base^times; DomainError when there is none."""
    frame = Frame(ring, d, time)
    factor = in_lambda(frame, base)
    if len(base) == 2:
        return linear(frame, base, times, factor)
    if len(base) == 3:
        return quadratic(frame, base, times, factor)
    if times > 1:
        raise DomainError(
            f"A: expected no repeated factor of degree above two; got ({factor})^{times} in the "
            "characteristic polynomial, which has no closed form here; put in numbers or split the system"
        )
    depressed = shifted(ring, base) if len(base) == 5 else None
    form = None if depressed is None else biquadratic(frame, base, depressed, factor)
    return form or implicit(frame, base, factor)


# --- linear --------------------------------------------------------------------------------------


def linear(frame: Frame, base: Coefficients, times: int, factor: sp.Expr) -> Form:
    """exp(alpha t) * sum_j t^j (x - alpha)^j / j!."""
    ring, growth = frame.ring, frame.growth(-base[0])
    pieces, power = [], [ring.one]
    for j in range(times):
        weight = ring.one, frame.d**j * int(sp.factorial(j))
        pieces.append(Piece((Wave(frame.time**j * growth, weight),), power))
        power = product(ring, power, base)
    kind = "constant" if base[0].is_zero() and times == 1 else "exponential"
    return Form(base, times, "polynomial" if base[0].is_zero() and times > 1 else kind, factor, tuple(pieces))


# --- quadratic -----------------------------------------------------------------------------------


def quadratic(frame: Frame, base: Coefficients, times: int, factor: sp.Expr) -> Form:
    """exp(alpha t) * sum_j q^j (C_j + u S_j), u = x - alpha, u^2 = D + q.

    C_j and S_j are the Taylor coefficients in D of cosh(sqrt(D) t) and sinh(sqrt(D) t) / sqrt(D).
    """
    ring = frame.ring
    alpha = base[1] / -2
    D = alpha * alpha - base[0]
    oscillates = sign(ring, D) <= 0
    root = root_of(frame, -D if oscillates else D)
    cosine, sine = (sp.cos, sp.sin) if oscillates else (sp.cosh, sp.sinh)
    waves = {"C": cosine(root.value * frame.time), "S": sine(root.value * frame.time)}
    u = [-alpha, ring.one]
    pieces, power = [], [ring.one]
    for j, (even, odd) in enumerate(taylor(times)):
        for terms, poly, degree in ((even, power, 2 * j), (odd, product(ring, power, u), 2 * j + 1)):
            combined = tuple(taylor_wave(frame, item, waves, root, D, degree) for item in terms.items())
            pieces.append(Piece(combined, poly))
        power = product(ring, power, base)
    kind = "trigonometric" if oscillates else "hyperbolic"
    grown = tuple(scaled(piece, frame.growth(alpha)) for piece in pieces)
    return Form(base, times, kind, factor, grown, reality(ring, root))


#: Term t^k D^-e times C or S, with its coefficient.
Taylor = dict[tuple[int, int, str], sp.Rational]


def taylor(count: int) -> Iterator[tuple[Taylor, Taylor]]:
    """Coefficients C_j, S_j for j < count, by dC/dD = t S / 2 and dS/dD = (t C - S) / (2 D)."""
    even: Taylor = {(0, 0, "C"): sp.S.One}
    odd: Taylor = {(0, 0, "S"): sp.S.One}
    for j in range(count):
        yield even, odd
        even, odd = (differentiated(terms, sp.Rational(1, j + 1)) for terms in (even, odd))


def differentiated(terms: Taylor, factor: sp.Rational) -> Taylor:
    """factor * d/dD of a sum of terms."""
    result: Taylor = {}

    def put(k: int, e: int, wave: str, c: sp.Rational) -> None:
        result[k, e, wave] = result.get((k, e, wave), sp.S.Zero) + factor * c

    for (k, e, wave), c in terms.items():
        put(k, e + 1, wave, -e * c)
        if wave == "C":
            put(k + 1, e, "S", c * HALF)
        else:
            put(k + 1, e + 1, "C", c * HALF)
            put(k, e + 1, "S", -c * HALF)
    return {key: c for key, c in result.items() if c}


def taylor_wave(
    frame: Frame,
    item: tuple[tuple[int, int, str], sp.Rational],
    waves: dict[str, sp.Expr],
    root: Root,
    D: Poly,
    degree: int,
) -> Wave:
    """One Taylor term; a polynomial of the given degree in x needs d to that degree below it."""
    (k, e, wave), c = item
    above, below = frame.d ** (2 * e) * int(c.p), D**e * frame.d**degree * int(c.q)
    surd = RATIONAL
    if wave == "S":
        (top, bottom), surd = root.inverse, root.surd
        above, below = above * top, below * bottom
    return Wave(frame.time**k * waves[wave], cancelled(above, below), surd)


# --- other -------------------------------------------------------------------------------------------


def implicit(frame: Frame, base: Coefficients, factor: sp.Expr) -> Form:
    """exp(x t) = sum_l R_l(t) sum_k q_{k+l+1} x^k, R_l(t) = sum over roots of rho^l exp(rho t) / q'(rho).

    R_{l+1} is the derivative of R_l; at t = 0 all but the last vanish, and the last is one.
    """
    rho, n = sp.Dummy("rho"), len(base) - 1
    monic = factor.subs(LAMBDA, rho)
    slope = monic.diff(rho)
    pieces = tuple(
        Piece(
            (
                Wave(
                    root_sum(monic, rho, rho**k * sp.exp(rho * frame.time) / slope),
                    (frame.ring.one, frame.d ** (n - k - 1)),
                ),
            ),
            base[k + 1 :],
        )
        for k in range(n)
    )
    return Form(base, 1, "sum over roots", factor, pieces)


def root_sum(monic: sp.Expr, rho: sp.Symbol, summand: sp.Expr) -> sp.Expr:
    """The summand added up over the roots of the polynomial, left as it stands."""
    return sp.RootSum(monic, sp.Lambda(rho, summand), rho, auto=False)
