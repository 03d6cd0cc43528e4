"""exp(x t) modulo a quartic that is a quadratic in the square of u = x - alpha.

Two coupled oscillators, a Schuler loop turned by the Earth, a beam: two frequencies, damped waves
or two exponents, in closed form.
"""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from navsym.models.parameter_ring import Poly, Ring, expanded, quotient, sign
from navsym.models.polynomials import Coefficients, product
from navsym.models.transition.pieces import (
    RATIONAL,
    Factor,
    Form,
    Frame,
    Piece,
    Surd,
    Wave,
    direct,
    inverted,
    reality,
    root_of,
    scaled,
    times,
    wave,
)


def shifted(ring: Ring, base: Coefficients) -> Coefficients:
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
    root = exact_root(ring, b)
    complex_pair = sign(ring, a * a - 4 * b) < 0
    if root is not None and (complex_pair or sign(ring, a) >= 0):
        kind, sums, conditions = product_waves(frame, a, root, complex_pair)
    elif complex_pair:
        return None
    else:
        kind, sums, conditions = nested_waves(frame, a, b)
    ring, d, u = frame.ring, frame.d, [-alpha, frame.ring.one]
    square = product(ring, u, u)
    square[0] += a / 2
    polys = [([ring.one], ring.one), (u, d), (square, d**2), (product(ring, square, u), d**3)]
    pieces = (
        Piece(tuple(replace(w, weight=(w.weight[0], w.weight[1] * divisor)) for w in waves), poly)
        for waves, (poly, divisor) in zip(sums, polys, strict=True)
    )
    growth = frame.growth(alpha)
    return Form(base, 1, kind, factor, tuple(scaled(piece, growth) for piece in pieces), conditions)


def exact_root(ring: Ring, b: Poly) -> Poly | None:
    """The polynomial square root of b, of positive sign if signs are declared, or None."""
    content, factors = b.factor()
    root = sp.sqrt(sp.Rational(int(content.p), int(content.q)))
    if content < 0 or not root.is_Rational or any(int(power) % 2 for _, power in factors):
        return None
    result = ring.one * int(root.p) / int(root.q)
    for base, power in factors:
        result *= base ** (int(power) // 2)
    return -result if sign(ring, result) < 0 else result


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
    P, M = root_of(frame, (2 * c + a) / 4), root_of(frame, (2 * c - a if complex_pair else a - 2 * c) / 4)
    even, odd = (sp.cosh, sp.sinh) if complex_pair else (sp.cos, sp.sin)
    cP, sP, cM, sM = sp.cos(P.value * t), sp.sin(P.value * t), even(M.value * t), odd(M.value * t)
    unit = frame.d**2, c
    minus = 1 if complex_pair else -1
    both = times(ring, times(ring, inverted(P), inverted(M)), ((ring.one, ring.one * 2), RATIONAL))
    sums = (
        (Wave(cP * cM, (ring.one, ring.one)),),
        (
            wave(ring, sP * cM, direct(P), (unit, RATIONAL)),
            wave(ring, cP * sM, direct(M), ((unit[0] * minus, c), RATIONAL)),
        ),
        (wave(ring, sP * sM, both),),
        (
            wave(ring, sP * cM, inverted(P), ((unit[0], 2 * c), RATIONAL)),
            wave(ring, cP * sM, inverted(M), ((-unit[0], 2 * c), RATIONAL)),
        ),
    )
    return "damped waves" if complex_pair else "two frequencies", sums, reality(ring, P, M)


def nested_waves(frame: Frame, a: Poly, b: Poly) -> tuple[str, Sums, tuple[sp.Basic, ...]]:
    """s = (-a +- sqrt(a^2 - 4 b)) / 2, roots within roots."""
    ring, t = frame.ring, frame.time
    delta = root_of(frame, a * a - 4 * b, 4)
    middle = quotient(ring, a, frame.d**2)
    signs = sign(ring, a), sign(ring, b)
    grows = signs[1] < 0 or signs == (-1, 1), signs == (-1, 1)
    half, over = ((ring.one, ring.one * 2), RATIONAL), inverted(delta)
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
    conditions = [*reality(ring, delta), sp.Ne(expanded(ring, b), 0)]
    if signs[1] == 0 or (signs[1] > 0 and signs[0] == 0):
        conditions += [sp.Gt(expanded(ring, a), 0), sp.Gt(expanded(ring, b), 0)]
    return ("two frequencies", "exponents and waves", "two exponents")[sum(grows)], sums, tuple(conditions)


def nested_wave(function: sp.Expr, scale: sp.Expr, factor: Factor) -> Wave:
    """A wave whose constant has a root within a root; it is not combined with others."""
    return Wave(function, factor[0], Surd(scale * factor[1].value))
