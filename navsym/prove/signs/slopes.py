"""Signs by derivatives, squares, cases and quotients: each way asks the same question about something simpler.

A way is a function of the expression, the ranges, the wanted sign and ``prove``, which it calls for what is
left to show; it returns unknown when that fails.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from math import lcm

import sympy as sp

from navsym.core.balls import exact_ball
from navsym.prove.identities.cases import half_range
from navsym.prove.identities.normal_form import (
    divisors_inside,
    logarithms_inside,
    radicands_inside,
    vanishes_identically,
)
from navsym.prove.identities.numbers import is_zero
from navsym.prove.identities.transcendental import factor_exactly
from navsym.prove.sampling.points import Range
from navsym.prove.signs.exact import UNKNOWN, Limits, Sign, SignProof, constant_sign, is_entire
from navsym.prove.signs.subdivision import guess_points
from navsym.prove.signs.sums import cases_of_sum

Prove = Callable[[sp.Expr, Limits, Sign], SignProof]

#: Functions with jumps, whose derivative says nothing about the jump.
JUMPING = (sp.atan2, sp.sign, sp.Max, sp.Min)
BENT = (*JUMPING, sp.Abs)
MOST_DERIVATIVES = 7


def ranges_in(limits: Limits, expression: sp.Expr) -> dict[sp.Symbol, Range]:
    """The ranges of the symbols that occur."""
    return {s: limits[s] for s in expression.free_symbols}


def is_defined(expression: sp.Expr, limits: Limits, prove: Prove) -> bool:
    """No divisor, radicand or argument of a logarithm leaves its range: the expression is continuous.

    Factoring may cancel a pole, and so may a derivative: that of atan(tan(x)) is 1.
    """
    return roots_exist(expression, limits, prove) and all(
        is_never_zero(d, limits, prove) for d in dict.fromkeys(divisors_inside(expression))
    )


def roots_exist(expression: sp.Expr, limits: Limits, prove: Prove) -> bool:
    """No radicand and no argument of a logarithm leaves its range."""
    needs = [(radicand, Sign.NONNEGATIVE) for radicand in dict.fromkeys(radicands_inside(expression))]
    needs += [(argument, Sign.POSITIVE) for argument in dict.fromkeys(logarithms_inside(expression))]
    return all(prove(inside, ranges_in(limits, inside), wanted).at_least(wanted) for inside, wanted in needs)


def is_never_zero(divisor: sp.Expr, limits: Limits, prove: Prove) -> bool:
    """One sign on the whole box."""
    positive = Sign.POSITIVE
    return any(prove(d, ranges_in(limits, divisor), positive).at_least(positive) for d in (divisor, -divisor))


def is_left_out(limit: Range) -> bool:
    """True when the lower end does not belong to the range."""
    return limit.open_lower or (limit.nonzero and limit.lower == 0)


def is_continuous_to_end(expression: sp.Expr, symbol: sp.Symbol, end: sp.Expr, limits: Limits, prove: Prove) -> bool:
    """True when the expression is continuous up to an end that is left out.

    There a value may exist that is no limit: x**(1/log(x)) is e for x > 0, and 0**0 = 1 at zero.
    """
    limit = limits[symbol]
    if end != limit.lower or not is_left_out(limit):
        return True
    inside = [node.args[0] for node in expression.atoms(sp.log)]
    inside += [power.base for power in expression.atoms(sp.Pow) if not power.exp.is_Rational]
    inside += [divisor**2 for divisor in divisors_inside(expression)]
    at_end = [part.subs(symbol, end) for part in inside if part.has(symbol)]
    return not any(part.has(sp.nan, sp.zoo, sp.oo) for part in at_end) and all(
        prove(part, ranges_in(limits, part), Sign.POSITIVE).at_least(Sign.POSITIVE) for part in at_end
    )


def by_monotony(expression: sp.Expr, limits: Limits, wanted: Sign, prove: Prove) -> SignProof:
    """Reduce to the end of one range at which the expression is smallest."""
    if expression.has(*JUMPING) or not is_defined(expression, limits, prove):
        return UNKNOWN
    for symbol, limit in ranges_in(limits, expression).items():
        if limit.integer:
            continue  # sympy simplifies derivatives by it, cos(2 pi n) = 1 say
        slope = sp.diff(expression, symbol)
        for direction, end in ((1, limit.lower), (-1, limit.upper)):
            at_end = sp.nan if end is None else expression.subs(symbol, end)
            if at_end.has(sp.nan, sp.zoo, sp.oo) or not is_continuous_to_end(expression, symbol, end, limits, prove):
                continue
            floor = prove(at_end, ranges_in(limits, at_end), Sign.NONNEGATIVE)
            if floor.sign == Sign.UNKNOWN:
                continue
            rising = prove(direction * slope, limits, Sign.NONNEGATIVE)
            if rising.sign == Sign.UNKNOWN:
                rising = rises_almost_everywhere(direction * slope, symbol, limits, prove)
            if rising.sign == Sign.UNKNOWN:
                continue
            lifted = direction == 1 and is_left_out(limit) and rises_at_once(expression, limits, rising)
            sign = Sign.POSITIVE if floor.sign == Sign.POSITIVE or lifted else Sign.NONNEGATIVE
            if sign >= wanted:
                exact = floor.exact and rising.exact
                return SignProof(sign, f"monotone in {symbol}", floor.boxes + rising.boxes, exact)
    return UNKNOWN


def rises_almost_everywhere(slope: sp.Expr, symbol: sp.Symbol, limits: Limits, prove: Prove) -> SignProof:
    """Not negative wherever it exists, and it exists but for finitely many values of the symbol.

    A continuous function with such a derivative does not fall: that of asin(x) - x is infinite at x = 1.
    """
    top, bottom = sp.fraction(sp.together(slope))
    if slope.has(*BENT) or not bottom.has(symbol) or not vanishes_identically(slope - top / bottom):
        return UNKNOWN
    divisors = dict.fromkeys([*divisors_inside(slope), *divisors_inside(1 / bottom)])
    seldom = all(has_few_zeros(d, symbol) or is_never_zero(d, limits, prove) for d in divisors)
    if not seldom or not roots_exist(sp.Tuple(slope, top, bottom), limits, prove):
        return UNKNOWN
    for sign in (1, -1):
        below = prove(sign * bottom, ranges_in(limits, bottom), Sign.NONNEGATIVE)
        if below.sign != Sign.UNKNOWN:
            above = prove(sp.expand(sign * top), ranges_in(limits, top), Sign.NONNEGATIVE)
            sign_there = min(above.sign, Sign.NONNEGATIVE)
            return SignProof(sign_there, "", above.boxes + below.boxes, above.exact and below.exact)
    return UNKNOWN


def has_few_zeros(divisor: sp.Expr, symbol: sp.Symbol) -> bool:
    """A polynomial in the symbol whose leading coefficient is a rational number: finitely many zeros."""
    if not divisor.has(symbol) or not divisor.is_polynomial(symbol):
        return False
    leading = sp.Poly(divisor, symbol).LC()
    return bool(leading.is_Rational and leading != 0)


def rises_at_once(expression: sp.Expr, limits: Limits, slope: SignProof) -> bool:
    """True when a function that does not fall is above its lower end everywhere else.

    If it stayed there for a while, an analytic function of one symbol would be constant.
    """
    if slope.sign == Sign.POSITIVE:
        return True
    if len(limits) != 1 or not is_entire(expression):
        return False
    ((symbol, limit),) = limits.items()
    if limit.lower is None:
        return False
    inside = limit.lower + 1 if limit.upper is None else (limit.lower + limit.upper) / 2
    gained = expression.subs(symbol, inside) - expression.subs(symbol, limit.lower)
    return constant_sign(gained).sign == Sign.POSITIVE


def by_taylor(expression: sp.Expr, limits: Limits, wanted: Sign, simple: Prove) -> SignProof:
    """f and its derivatives up to k - 1 nonnegative at an end of one range, and the k-th one on the whole range.

    At an upper end the derivatives of odd order count with the other sign. Every derivative has to exist on
    the whole range: a kink would be invisible in the higher ones.
    """
    if expression.has(*BENT) or not is_defined(expression, limits, simple):
        return UNKNOWN
    for symbol, limit in ranges_in(limits, expression).items():
        if limit.integer:
            continue  # sympy simplifies derivatives by it, cos(2 pi n) = 1 say
        for direction, end in ((1, limit.lower), (-1, limit.upper)):
            if end is None:
                continue
            proof = taylor_at(expression, symbol, (end, direction), limits, simple)
            if proof.at_least(wanted):
                return proof
    return UNKNOWN


def taylor_at(
    expression: sp.Expr, symbol: sp.Symbol, end: tuple[sp.Expr, int], limits: Limits, simple: Prove
) -> SignProof:
    """One symbol and one end of its range."""
    place, direction = end
    derivative, floor, exact, strict = expression, Sign.POSITIVE, True, False
    for order in range(1, MOST_DERIVATIVES):
        value = derivative.subs(symbol, place)
        if value.has(sp.nan, sp.zoo, sp.oo) or not is_continuous_to_end(derivative, symbol, place, limits, simple):
            return UNKNOWN
        at_end = simple(value, ranges_in(limits, value), Sign.NONNEGATIVE)
        if at_end.sign == Sign.UNKNOWN:
            return UNKNOWN
        floor = at_end.sign if order == 1 else floor
        strict = strict or at_end.sign == Sign.POSITIVE
        slope = direction * sp.diff(derivative, symbol)
        if not is_defined(slope, limits, simple):
            return UNKNOWN
        derivative = factor_exactly(slope)
        rest = simple(derivative, limits, Sign.NONNEGATIVE)
        exact = exact and at_end.exact and rest.exact
        if rest.sign != Sign.UNKNOWN:
            inside = direction == 1 and is_left_out(limits[symbol])
            lifted = inside and (strict or rises_at_once(expression, limits, rest))
            sign = Sign.POSITIVE if floor == Sign.POSITIVE or lifted else Sign.NONNEGATIVE
            words = f"derivatives at {symbol} = {place} not negative, nor that of order {order} anywhere"
            return SignProof(sign, words, at_end.boxes + rest.boxes, exact)
    return UNKNOWN


def between_contacts(expression: sp.Expr, limits: Limits, wanted: Sign, prove: Prove) -> SignProof:
    """Zeros of even order inside one range, at guessed exact points; the parts between them are proved apart."""
    if wanted > Sign.NONNEGATIVE or expression.has(*JUMPING):
        return UNKNOWN
    for symbol, limit in ranges_in(limits, expression).items():
        if limit.integer:
            continue
        contacts = contacts_of(expression, symbol, limit)
        if not contacts:
            continue
        ends = [limit.lower, *contacts, limit.upper]
        parts = [Range(a, b) for a, b in pairwise(ends)]
        parts[0] = replace(parts[0], open_lower=limit.open_lower)
        proofs = []
        for part in parts:
            proofs.append(prove(expression, {**limits, symbol: part}, wanted))
            if not proofs[-1].at_least(wanted):
                break
        else:
            places = ", ".join(map(str, contacts))
            boxes, exact = sum(proof.boxes for proof in proofs), all(proof.exact for proof in proofs)
            return SignProof(Sign.NONNEGATIVE, f"zero at {symbol} = {places}, proved between", boxes, exact)
    return UNKNOWN


def contacts_of(expression: sp.Expr, symbol: sp.Symbol, limit: Range) -> list[sp.Expr]:
    """Inner points, in order, at which the expression vanishes whatever the other symbols are."""
    guesses = guess_points(limit)
    several = len(expression.free_symbols) > 1
    found = [p for p in (guesses[:4] if several else guesses) if vanishes_at(expression, symbol, p)]
    return sorted(found, key=lambda point: float(exact_ball(point).mid()))


def vanishes_at(expression: sp.Expr, symbol: sp.Symbol, point: sp.Expr) -> bool:
    value = expression.subs(symbol, point)
    if value.has(sp.nan, sp.zoo, sp.oo):
        return False
    return vanishes_identically(value) if value.free_symbols else is_zero(value)


def by_squares(expression: sp.Expr, limits: Limits, wanted: Sign, prove: Prove) -> SignProof:
    """L - R is not negative when L is not and L**2 - R**2 is not: what roots and absolute values need."""
    if not isinstance(expression, sp.Add) or not has_root(expression) or not is_defined(expression, limits, prove):
        return UNKNOWN
    for left, right in sides_of(expression):
        squares = sp.expand(left**2 - right**2)
        if squares.count_ops() > 4 * expression.count_ops() + 40:
            continue
        proof = prove(squares, ranges_in(limits, squares), wanted)
        if not proof.at_least(wanted):
            continue
        side = prove(left, ranges_in(limits, left), Sign.NONNEGATIVE)
        if side.sign != Sign.UNKNOWN:
            reason = f"squares of {left} and {right}; {proof.reason}"
            return replace(proof, reason=reason, exact=proof.exact and side.exact)
    return UNKNOWN


def has_root(expression: sp.Expr) -> bool:
    return expression.has(sp.Abs) or any(p.exp.is_Rational and not p.exp.is_Integer for p in expression.atoms(sp.Pow))


def sides_of(expression: sp.Add) -> list[tuple[sp.Expr, sp.Expr]]:
    """The expression as L - R: by the signs of the terms, and with the roots on one side."""
    minus = sp.Add(*(term for term in expression.args if term.could_extract_minus_sign()))
    rooted = sp.Add(*(term for term in expression.args if has_root(term)))
    rest = expression - rooted
    candidates = [(expression - minus, -minus), (rooted, -rest), (rest, -rooted)]
    return [pair for pair in dict.fromkeys(candidates) if pair[0] != 0 and pair[1] != 0]


def by_values(expression: sp.Expr, limits: Limits, wanted: Sign, prove: Prove) -> SignProof:
    """An absolute value by cases: the parts of the range for |x|, both signs everywhere for |u|."""
    values = sorted(expression.atoms(sp.Abs), key=sp.default_sort_key)
    inner = next((value for value in values if not value.args[0].has(sp.Abs)), None)
    if inner is None:
        return UNKNOWN
    proofs = []
    for sign in signs_of(inner.args[0], limits, prove):
        narrowed = half_range(limits, inner.args[0], sign)
        if narrowed is not None:
            case = expression.xreplace({inner: sign * inner.args[0]})
            proofs.append(prove(case, ranges_in(narrowed, case), wanted))
            if not proofs[-1].at_least(wanted):
                return UNKNOWN
    worst = min(proofs, key=lambda proof: proof.sign)
    return replace(worst, reason=f"both signs of {inner}; {worst.reason}", exact=all(p.exact for p in proofs))


def signs_of(inside: sp.Expr, limits: Limits, prove: Prove) -> tuple[int, ...]:
    """The signs that the inside of an absolute value may have on the box."""
    if isinstance(inside, sp.Symbol):
        return (1, -1)
    proved = [s for s in (1, -1) if prove(s * inside, ranges_in(limits, inside), Sign.NONNEGATIVE).sign != Sign.UNKNOWN]
    return (proved[0],) if proved else (1, -1)


def by_sums(expression: sp.Expr, limits: Limits, wanted: Sign, prove: Prove) -> SignProof:
    """The absolute value of a sum of symbols by a variable of its own: |sin x - sin y| <= |x - y|."""
    values = sorted(expression.atoms(sp.Abs), key=sp.default_sort_key)
    found = (cases_of_sum(expression, value, limits) for value in values if not value.args[0].is_Symbol)
    cases = next((cases for cases in found if cases is not None), None)
    if not cases or not is_defined(expression, limits, prove):
        return UNKNOWN
    proofs = []
    for forms in cases:
        tried = (prove(form.expression, form.limits, wanted) for form in forms)
        proofs.append(next((proof for proof in tried if proof.at_least(wanted)), UNKNOWN))
        if not proofs[-1].at_least(wanted):
            return UNKNOWN
    worst = min(proofs, key=lambda proof: proof.sign)
    return replace(worst, reason=f"a variable for the sum; {worst.reason}", exact=all(p.exact for p in proofs))


def by_quotient(expression: sp.Expr, limits: Limits, wanted: Sign, prove: Prove) -> SignProof:
    """A sum of fractions as one: the signs of its numerator and of its denominator."""
    top, bottom = sp.fraction(sp.together(expression))
    if not bottom.free_symbols or top == expression or not vanishes_identically(expression - top / bottom):
        return UNKNOWN
    below = prove(bottom, ranges_in(limits, bottom), Sign.POSITIVE)
    if below.sign != Sign.POSITIVE or not is_defined(expression, limits, prove):
        return UNKNOWN
    above = prove(sp.expand(top), ranges_in(limits, top), wanted)
    if not above.at_least(wanted):
        return UNKNOWN
    return replace(above, reason=f"over {bottom}: {above.reason}", exact=above.exact and below.exact)


# Sums of logarithms by what they are logarithms of: c log u + d log v + w >= 0 says u**c v**d exp(w) >= 1.


MOST_POWERS = 12


def by_exponential(expression: sp.Expr, limits: Limits, wanted: Sign, prove: Prove) -> SignProof:
    """The exponential of a multiple of the sum, with what has negative powers on the other side."""
    split = logarithms_of(expression)
    if split is None or not is_defined(expression, limits, prove):
        return UNKNOWN
    powers, rest = split
    above = sp.Mul(*(u**p for u, p in powers.items() if p > 0)) * sp.exp(rest)
    below = sp.Mul(*(u**-p for u, p in powers.items() if p < 0))
    difference = sp.expand(above - below)
    proof = prove(difference, ranges_in(limits, difference), wanted)
    return replace(proof, reason=f"{above} against {below}: {proof.reason}") if proof.at_least(wanted) else UNKNOWN


def logarithms_of(expression: sp.Expr) -> tuple[dict[sp.Expr, int], sp.Expr] | None:
    """Arguments with whole coefficients, and the rest, of a multiple of the sum; None where that is no such sum."""
    shares: dict[sp.Expr, sp.Rational] = {}
    rest = sp.Integer(0)
    for term in sp.Add.make_args(sp.expand_mul(expression)):
        share, inner = term.as_coeff_Mul()
        if isinstance(inner, sp.log):
            shares[inner.args[0]] = shares.get(inner.args[0], sp.Integer(0)) + share
        else:
            rest += term
    if not shares or rest.has(sp.log) or not all(share.is_Rational for share in shares.values()):
        return None
    n = lcm(*(int(share.q) for share in shares.values()))
    powers = {u: int(share * n) for u, share in shares.items()}
    return (powers, n * rest) if sum(map(abs, powers.values())) <= MOST_POWERS else None
