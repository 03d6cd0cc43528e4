"""Places recognised from samples: ``a p + b``, the same over p, a share of the interval. Guesses, to be proved."""

from __future__ import annotations

from collections.abc import Sequence

import mpmath
import sympy as sp

from navsym.guaranteed.phases.family import Family, U

NEAR = sp.Rational(1, 10**40)
#: Integers up to this size are looked for in relations.
SHORT = 1000


def recognise_constant(x: sp.Rational) -> sp.Expr | None:
    """The exact number within 1e-40 of a rational with many digits, or None.

    It is a rational, a rational multiple of pi, a cosine share ``(1 - cos(pi r))/2``, a rational multiple of a root,
    or one of those of :func:`recognise_relation`.
    """
    pi = sp.Rational(str(sp.pi.evalf(90)))
    for unit, base in ((sp.Integer(1), sp.Integer(1)), (pi, sp.pi)):
        best = sp.Rational(x / unit).limit_denominator(720)
        if abs(best * unit - x) < NEAR:
            return best * base
    if 0 < x < 1:
        r = sp.acos(1 - 2 * sp.Float(str(sp.N(x, 90)), 90)) / sp.Float(pi, 90)
        best = sp.Rational(str(r)).limit_denominator(120)
        shown = (1 - sp.cos(sp.pi * best)) / 2
        if abs(sp.Rational(str(shown.evalf(90))) - x) < NEAR:
            return shown
    for q in (2, 3, 5, 6):
        root = sp.Rational(str(sp.sqrt(q).evalf(90)))
        best = sp.Rational(x / root).limit_denominator(720)
        if abs(best * root - x) < NEAR:
            return best * sp.sqrt(q)
    return recognise_relation(x)


def recognise_relation(x: sp.Rational) -> sp.Expr | None:
    """``a + b pi``, a root of a quadratic polynomial, or a logarithm or arctangent of one, with short coefficients."""
    with mpmath.workdps(50):
        at = mpmath.mpf(int(x.p)) / int(x.q)
        line = integer_relation([at, mpmath.mpf(1), mpmath.pi])
        if line is not None and line[0]:
            return -(line[1] + line[2] * sp.pi) / sp.Integer(line[0])
        found = recognise_quadratic(at)
        for function, inverse, period in ((mpmath.exp, sp.log, 0), (mpmath.tan, sp.atan, sp.pi)):
            inner = recognise_quadratic(function(at)) if found is None and abs(at) < 20 else None
            found = found if inner is None else inverse(inner) + period * int(mpmath.nint(at / mpmath.pi))
        return found


def recognise_quadratic(at: mpmath.mpf) -> sp.Expr | None:
    """The rational number or the root of a quadratic polynomial next to a number."""
    c = integer_relation([at * at, at, mpmath.mpf(1)])
    if c is None:
        return None
    roots = sp.roots(sp.Poly(c, sp.Symbol("x"))).keys()
    return min(roots, key=lambda root: abs(mpmath.mpmathify(sp.N(root, 40)) - at))


def integer_relation(values: Sequence[mpmath.mpf]) -> list[int] | None:
    """Short integers c with ``sum c_i values_i`` next to zero."""
    return mpmath.pslq(values, tol=mpmath.mpf(10) ** -40, maxcoeff=SHORT, maxsteps=2000)


def linear_place(values: Sequence[sp.Rational], lengths: Sequence[sp.Rational], T: sp.Symbol) -> sp.Expr | None:
    """``a T + b`` through the first two samples, confirmed on all of them."""
    slope = (values[1] - values[0]) / (lengths[1] - lengths[0])
    start = values[0] - slope * lengths[0]
    if any(abs(slope * t + start - v) > NEAR for v, t in zip(values, lengths, strict=True)):
        return None
    a, b = recognise_constant(slope), recognise_constant(start)
    return None if a is None or b is None else a * T + b


def simple_place(values: Sequence[sp.Rational], parameters: Sequence[sp.Rational], p: sp.Symbol) -> sp.Expr | None:
    """A place linear in the parameter or in its reciprocal."""
    found = linear_place(values, parameters, p)
    if found is not None or any(v == 0 for v in parameters):
        return found
    scaled = linear_place([v * q for v, q in zip(values, parameters, strict=True)], parameters, p)
    return None if scaled is None else sp.expand(scaled / p)


def recognise_place(
    family: Family, panel: int, values: Sequence[sp.Rational], parameters: Sequence[sp.Rational]
) -> sp.Expr | None:
    """A place linear in the parameter or its reciprocal, else a fixed share of its panel, else the middle of one.

    The middle only where the regressors do not change on the panel: there one place is as good as another, and the
    place of a search says nothing.
    """
    found = simple_place(values, parameters, family.parameter)
    found = fixed_share(family, panel, values, parameters) if found is None else found
    if found is not None or any(h.has(U) for h in family.rows[panel]):
        return found
    start, stop = family.panels[panel]
    return (start + stop) / 2


def fixed_share(
    family: Family, panel: int, values: Sequence[sp.Rational], parameters: Sequence[sp.Rational]
) -> sp.Expr | None:
    """A fixed share of the panel, to nine digits: where the dual polynomial is flat, no place is better known."""
    shares = []
    for value, p in zip(values, parameters, strict=True):
        start, end = (sp.Rational(str(sp.N(e, 40))) for e in family.ends(p, panel))
        share = (value - start) / (end - start)
        best = share.limit_denominator(60)
        if abs(best - share) > sp.Rational(1, 10**9):
            return None
        shares.append(best)
    start, stop = family.panels[panel]
    return start + (stop - start) * shares[0] if len(set(shares)) == 1 else None
