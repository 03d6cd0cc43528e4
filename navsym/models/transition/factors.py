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
from dataclasses import replace

import sympy as sp

from navsym.core.errors import DomainError
from navsym.core.rational_functions import cancel_fraction, factor_exactly, multiply_coefficients, polynomial_sum
from navsym.models.transition.pieces import (
    LAMBDA,
    RATIONAL,
    Factor,
    Form,
    Frame,
    Piece,
    Root,
    Surd,
    Wave,
    in_lambda,
    multiply_constants,
    reality_conditions,
    root_of_quotient,
    scale_piece,
    wave,
)
from navsym.models.transition.rings import Coefficients, Poly, Ring, declared_sign, write_quotient

# exp(x t) modulo a quartic that is a quadratic in the square of u = x - alpha.
#
# Two coupled oscillators, a Schuler loop turned by the Earth, a beam: two frequencies, damped waves
# or two exponents, in closed form.


def shift_quartic(ring: Ring, base: Coefficients) -> Coefficients:
    """Coefficients in u = mu - alpha of a monic quartic, alpha chosen to remove the cube."""
    alpha, result = base[3] / -4, [base[-1]]
    for c in reversed(base[:-1]):
        result = [low + alpha * high for low, high in zip([ring.zero, *result], [*result, ring.zero], strict=True)]
        result[0] += c
    return result


def biquadratic(frame: Frame, base: Coefficients, depressed: Coefficients, factor: sp.Expr) -> Form | None:
    """The form of u^4 + a u^2 + b; None when the quartic has other terms or complex roots in s = u^2.

    With s1, s2 the roots in s,

    exp(u t) = (C1 + C2)/2 + u (S1 + S2)/2 + (u^2 + a/2) ((C1 - C2) + u (S1 - S2)) / (s1 - s2).
    """
    ring, (b, linear, a, _, _) = frame.ring, depressed
    if not linear.is_zero():
        return None
    alpha = base[3] / -4
    root = polynomial_root(ring, b)
    complex_pair = declared_sign(ring, a * a - 4 * b) < 0
    if root is not None and (complex_pair or declared_sign(ring, a) >= 0):
        kind, sums, conditions = product_waves(frame, a, root, complex_pair)
    elif complex_pair:
        return None
    else:
        kind, sums, conditions = nested_waves(frame, a, b)
    ring, d, u = frame.ring, frame.d, [-alpha, frame.ring.one]
    square = multiply_coefficients(u, u)
    square[0] += a / 2
    polys = [([ring.one], ring.one), (u, d), (square, d**2), (multiply_coefficients(square, u), d**3)]
    pieces = (
        Piece(tuple(replace(w, weight=(w.weight[0], w.weight[1] * divisor)) for w in waves), poly)
        for waves, (poly, divisor) in zip(sums, polys, strict=True)
    )
    growth = frame.growth(alpha)
    return Form(base, 1, kind, factor, tuple(scale_piece(piece, growth) for piece in pieces), conditions)


def polynomial_root(ring: Ring, b: Poly) -> Poly | None:
    """The polynomial square root of b, of positive sign if signs are declared, or None."""
    content, factors = factor_exactly(b)
    root = sp.sqrt(sp.Rational(int(content.p), int(content.q)))
    if content < 0 or not root.is_Rational or any(int(power) % 2 for _, power in factors):
        return None
    result = ring.one * int(root.p) / int(root.q)
    for base, power in factors:
        result *= base ** (int(power) // 2)
    return -result if declared_sign(ring, result) < 0 else result


#: (C1 + C2)/2, (S1 + S2)/2, (C1 - C2)/(s1 - s2), (S1 - S2)/(s1 - s2), each a sum of waves.
Sums = tuple[tuple[Wave, ...], tuple[Wave, ...], tuple[Wave, ...], tuple[Wave, ...]]


def product_waves(frame: Frame, a: Poly, c: Poly, complex_pair: bool) -> tuple[str, Sums, tuple[sp.Basic, ...]]:
    """b = c^2: products of waves, with P = sqrt(2 c + a)/2 and M = sqrt(a - 2 c)/2 or sqrt(2 c - a)/2.

    Two frequencies P + M and P - M, P^2 - M^2 = c:

        cos P cos M,  (P sin P cos M - M cos P sin M)/c,  sin P sin M/(2 P M),
        (M sin P cos M - P cos P sin M)/(2 P M c);

    for M imaginary (complex_pair) cosh M and sinh M, P^2 + M^2 = c, and the sign in the second changes.
    """
    ring, t = frame.ring, frame.time
    P, M = (
        root_of_quotient(frame, (2 * c + a) / 4),
        root_of_quotient(frame, (2 * c - a if complex_pair else a - 2 * c) / 4),
    )
    even, odd = (sp.cosh, sp.sinh) if complex_pair else (sp.cos, sp.sin)
    cP, sP, cM, sM = sp.cos(P.value * t), sp.sin(P.value * t), even(M.value * t), odd(M.value * t)
    unit = frame.d**2, c
    minus = 1 if complex_pair else -1
    both = multiply_constants(
        ring, multiply_constants(ring, P.inverse, M.inverse), ((ring.one, ring.one * 2), RATIONAL)
    )
    sums = (
        (Wave(cP * cM, (ring.one, ring.one)),),
        (
            wave(ring, sP * cM, P.factor, (unit, RATIONAL)),
            wave(ring, cP * sM, M.factor, ((unit[0] * minus, c), RATIONAL)),
        ),
        (wave(ring, sP * sM, both),),
        (
            wave(ring, sP * cM, P.inverse, ((unit[0], 2 * c), RATIONAL)),
            wave(ring, cP * sM, M.inverse, ((-unit[0], 2 * c), RATIONAL)),
        ),
    )
    return "damped waves" if complex_pair else "two frequencies", sums, reality_conditions(ring, P, M)


def nested_waves(frame: Frame, a: Poly, b: Poly) -> tuple[str, Sums, tuple[sp.Basic, ...]]:
    """s = (-a +- sqrt(a^2 - 4 b)) / 2, roots within roots."""
    ring, t = frame.ring, frame.time
    delta = root_of_quotient(frame, a * a - 4 * b, 4)
    middle = write_quotient(ring, a, frame.d**2)
    signs = declared_sign(ring, a), declared_sign(ring, b)
    grows = signs[1] < 0 or signs == (-1, 1), signs == (-1, 1)
    half, over = ((ring.one, ring.one * 2), RATIONAL), delta.inverse
    negative = (-over[0][0], over[0][1]), over[1]
    pairs = []
    for direction, grow in zip((1, -1), grows, strict=True):
        s = (-middle + direction * delta.value) / 2
        root = sp.sqrt(s if grow else -s)
        even, odd = (sp.cosh, sp.sinh) if grow else (sp.cos, sp.sin)
        pairs.append((even(root * t), (odd(root * t), 1 / root)))
    (C1, S1), (C2, S2) = pairs
    sums = (
        (wave(ring, C1, half), wave(ring, C2, half)),
        (nested_wave(*S1, half), nested_wave(*S2, half)),
        (wave(ring, C1, over), wave(ring, C2, negative)),
        (nested_wave(*S1, over), nested_wave(*S2, negative)),
    )
    conditions = [*reality_conditions(ring, delta), sp.Ne(polynomial_sum(ring.generators, b), 0)]
    if signs[1] == 0 or (signs[1] > 0 and signs[0] == 0):
        conditions += [sp.Gt(polynomial_sum(ring.generators, a), 0), sp.Gt(polynomial_sum(ring.generators, b), 0)]
    return ("two frequencies", "exponents and waves", "two exponents")[sum(grows)], sums, tuple(conditions)


def nested_wave(function: sp.Expr, scale: sp.Expr, factor: Factor) -> Wave:
    """A wave whose constant has a root within a root; it is not combined with others."""
    return Wave(function, factor[0], Surd(scale * factor[1].value))


HALF = sp.Rational(1, 2)


def closed_form(ring: Ring, base: Coefficients, times: int, d: Poly, time: sp.Expr) -> Form:
    """The closed form of exp(x t) modulo base^times; DomainError when there is none."""
    frame = Frame(ring, d, time)
    factor = in_lambda(frame, base)
    if len(base) == 2:
        return linear_form(frame, base, times, factor)
    if len(base) == 3:
        return quadratic_form(frame, base, times, factor)
    if times > 1:
        raise DomainError(
            f"A: expected no repeated factor of degree above two; got ({factor})^{times} in the "
            "characteristic polynomial, which has no closed form here; put in numbers or split the system"
        )
    depressed = shift_quartic(ring, base) if len(base) == 5 else None
    form = None if depressed is None else biquadratic(frame, base, depressed, factor)
    return form or implicit_form(frame, base, factor)


# --- linear --------------------------------------------------------------------------------------


def linear_form(frame: Frame, base: Coefficients, times: int, factor: sp.Expr) -> Form:
    """exp(alpha t) * sum_j t^j (x - alpha)^j / j!."""
    ring, growth = frame.ring, frame.growth(-base[0])
    pieces, power = [], [ring.one]
    for j in range(times):
        weight = ring.one, frame.d**j * int(sp.factorial(j))
        pieces.append(Piece((Wave(frame.time**j * growth, weight),), power))
        power = multiply_coefficients(power, base)
    kind = "constant" if base[0].is_zero() and times == 1 else "exponential"
    return Form(base, times, "polynomial" if base[0].is_zero() and times > 1 else kind, factor, tuple(pieces))


# --- quadratic -----------------------------------------------------------------------------------


def quadratic_form(frame: Frame, base: Coefficients, times: int, factor: sp.Expr) -> Form:
    """exp(alpha t) * sum_j q^j (C_j + u S_j), u = x - alpha, u^2 = D + q.

    C_j and S_j are the Taylor coefficients in D of cosh(sqrt(D) t) and sinh(sqrt(D) t) / sqrt(D).
    """
    ring = frame.ring
    alpha = base[1] / -2
    D = alpha * alpha - base[0]
    oscillates = declared_sign(ring, D) <= 0
    root = root_of_quotient(frame, -D if oscillates else D)
    cosine, sine = (sp.cos, sp.sin) if oscillates else (sp.cosh, sp.sinh)
    waves = {"C": cosine(root.value * frame.time), "S": sine(root.value * frame.time)}
    u = [-alpha, ring.one]
    pieces, power = [], [ring.one]
    for j, (even, odd) in enumerate(taylor_coefficients(times)):
        for terms, poly, degree in ((even, power, 2 * j), (odd, multiply_coefficients(power, u), 2 * j + 1)):
            combined = tuple(taylor_wave(frame, item, waves, root, D, degree) for item in terms.items())
            pieces.append(Piece(combined, poly))
        power = multiply_coefficients(power, base)
    kind = "trigonometric" if oscillates else "hyperbolic"
    grown = tuple(scale_piece(piece, frame.growth(alpha)) for piece in pieces)
    return Form(base, times, kind, factor, grown, reality_conditions(ring, root))


#: Term t^k D^-e times C or S, with its coefficient.
Taylor = dict[tuple[int, int, str], sp.Rational]


def taylor_coefficients(count: int) -> Iterator[tuple[Taylor, Taylor]]:
    """Coefficients C_j, S_j for j < count, by dC/dD = t S / 2 and dS/dD = (t C - S) / (2 D)."""
    even: Taylor = {(0, 0, "C"): sp.S.One}
    odd: Taylor = {(0, 0, "S"): sp.S.One}
    for j in range(count):
        yield even, odd
        even, odd = (differentiate_terms(terms, sp.Rational(1, j + 1)) for terms in (even, odd))


def differentiate_terms(terms: Taylor, factor: sp.Rational) -> Taylor:
    """factor * d/dD of a sum of terms."""
    result: Taylor = {}

    def put(k: int, e: int, kind: str, c: sp.Rational) -> None:
        result[k, e, kind] = result.get((k, e, kind), sp.S.Zero) + factor * c

    for (k, e, kind), c in terms.items():
        put(k, e + 1, kind, -e * c)
        if kind == "C":
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
        (top, bottom), surd = root.inverse
        above, below = above * top, below * bottom
    return Wave(frame.time**k * waves[wave], cancel_fraction(above, below), surd)


# --- other -------------------------------------------------------------------------------------------


def implicit_form(frame: Frame, base: Coefficients, factor: sp.Expr) -> Form:
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
                    sp.RootSum(monic, sp.Lambda(rho, rho**k * sp.exp(rho * frame.time) / slope), rho, auto=False),
                    (frame.ring.one, frame.d ** (n - k - 1)),
                ),
            ),
            base[k + 1 :],
        )
        for k in range(n)
    )
    return Form(base, 1, "sum over roots", factor, pieces)
