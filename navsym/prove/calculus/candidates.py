"""Candidates of antiderivatives, telescopers and Taylor quotients, from sympy and a few tables; nothing is believed."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Iterator
from itertools import pairwise, product
from typing import Any

import sympy as sp
from sympy.concrete.gosper import gosper_term
from sympy.integrals.rationaltools import ratint
from sympy.simplify.fu import TR1, TR2, TR8

from navsym.core.errors import NavsymError
from navsym.prove.calculus.exponentials import list_exponentials
from navsym.prove.rooms.goals import (
    SHARES,
    Hole,
    Holes,
    from_sympy,
    inner_point,
    player,
    subterms,
    to_sympy,
    write_term,
)

Entry = dict[str, Any] | str
MOST_ORDER = 6
TROUBLE = (
    ValueError, TypeError, NotImplementedError, ArithmeticError, AttributeError, KeyError, RecursionError,
    sp.polys.polyerrors.BasePolynomialError,
)  # fmt: skip


class Signs(list[Any]):
    """No signs yet; those that are asked for are noted."""

    def __init__(self) -> None:
        super().__init__()
        self.noted: list[Any] = []


def list_candidates(question: Any, goal: Any) -> Iterator[Callable[[], Entry]]:
    """Entries for the rule of a question, each made anew with empty holes."""
    makers: dict[str, Callable[..., Iterator[Callable[[], Entry]]]] = {
        "integral": list_integrals,
        "sum": list_sums,
        "product": list_products,
        "limit": list_limits,
        "expm": list_exponentials,
    }
    if question.kind in ("sum", "product") and not player.symbols_of(("+", question.low, question.high)):
        yield lambda: "terms"
    yield from makers[question.kind](question, goal)


# Integrals


def list_integrals(question: Any, goal: Any) -> Iterator[Callable[[], Entry]]:
    """Antiderivatives with the ways to take them at the ends, without a cut and with one."""
    for cuts in list_cuts(question, goal):
        places = [question.low, *cuts, question.high]
        pairs = [*pairwise(places)]
        signs = [[sign_at_middle(part, question, goal, pair) for part in list_bends(question)] for pair in pairs]
        columns = [list_antiderivatives(question, goal, *row) for row in zip(pairs, signs, strict=True)]
        for forms in zip(*columns, strict=False):
            for ways in list_ways(pairs):
                for plain in (True, False):
                    yield functools.partial(make_integral, cuts, forms, ways, plain)


def make_integral(cuts: list[Any], forms: tuple[str, ...], ways: Any, plain: bool) -> Entry:
    """The entry of a rule, with holes."""
    pieces = [
        {
            "antiderivative": form, "limits": list(way), "continuous": Holes(), "smooth": Holes(),
            "equal": None if plain else Hole(), "signs": Signs(),
        }
        for form, way in zip(forms, ways, strict=True)
    ]  # fmt: skip
    return {"cuts": [write_term(cut) for cut in cuts], "pieces": pieces}


def list_ways(pairs: list[Any]) -> Iterator[list[tuple[int, int]]]:
    """For each piece whether its ends are taken by limits: at infinity always, elsewhere where values fail."""
    far = [[int(player.is_infinite(end)) for end in pair] for pair in pairs]
    inside, *outside = len(pairs) == 1, far[0][0], far[-1][1]
    for inner, first, last in product(*((0, 1)[: 2 - known] for known in (inside, *outside))):
        ways = [[end or inner for end in pair] for pair in far]
        ways[0][0], ways[-1][1] = outside[0] or first, outside[1] or last
        yield [(low, high) for low, high in ways]


def list_bends(question: Any) -> list[Any]:
    """What absolute values are taken of."""
    return [*dict.fromkeys(part[1] for part in subterms(question.term) if part[0] == "abs")]


def list_cuts(question: Any, goal: Any) -> Iterator[list[Any]]:
    """No cut; the zeros of what absolute values are taken of; 0 between two infinite ends."""
    if player.is_infinite(question.low) and player.is_infinite(question.high):
        yield [player.ZERO]
        return
    x, range_of_x = to_sympy(("symbol", question.variable)), sp.S.Reals
    if not player.symbols_of(question.low) | player.symbols_of(question.high):  # waves have finitely many zeros there
        range_of_x = sp.Interval(*sorted((to_sympy(question.low), to_sympy(question.high)), key=float))
    zeros: set[Any] = set()
    for bend in list_bends(question):
        u = to_sympy(bend)
        found = sp.solveset(u, x, range_of_x if u.free_symbols == {x} else sp.S.Reals)
        zeros |= set(found) if isinstance(found, sp.FiniteSet) else set()
    inside = [z for z in zeros if lies_between(z, question)]
    if inside:
        yield [player.parse(from_sympy(z)) for z in sorted(inside, key=lambda z: float(z) if z.is_number else 0.0)]
    yield []


def lies_between(zero: Any, question: Any) -> bool:
    """Whether a zero lies between two numbers; where the ends are symbols it may."""
    ends = [sp.oo if player.is_infinite(e) else to_sympy(e) for e in (question.low, question.high)]
    if not (zero.is_number and all(e.is_number for e in ends)):
        return True
    low, high = sorted(float(e) for e in ends)
    return bool(low < float(zero) < high)


def sign_at_middle(part: Any, question: Any, goal: Any, pair: Any) -> int:
    """The sign of a term at a point between two ends and inside the box."""
    values = {name: player.Jet(inner_point(limit, 1, 0)) for name, limit in goal.box.items()}
    values[question.variable] = player.Jet(middle_of(pair, values))
    return -1 if player.value_of(part, values) < 0 else 1


def middle_of(pair: Any, values: Any) -> Any:
    """A point between two ends."""
    low, high = (None if player.is_infinite(e) else player.value_of(e, values) for e in pair)
    if low is None or high is None:
        return high - SHARES[1] if high is not None else 0 if low is None else low + SHARES[1]
    return low + (high - low) * SHARES[4]


def list_antiderivatives(question: Any, goal: Any, pair: Any, signs: list[int]) -> Iterator[str]:
    """Texts of antiderivatives, the likely ones first."""
    x, f = to_sympy(("symbol", question.variable)), to_sympy(question.term)
    for bend, sign in zip(list_bends(question), signs, strict=True):
        f = f.subs(sp.Abs(to_sympy(bend)), sign * to_sympy(bend))
    quotient = lower_exponentials(f, x, pair)
    known = {to_sympy(("symbol", n)): sp.Symbol(n, positive=True) for n, r in goal.box.items() if is_positive(r)}
    back = {value: key for key, value in known.items()}
    seen, is_far = set[str](), any(map(player.is_infinite, pair))
    from sympy.integrals.manualintegrate import manualintegrate  # takes long to load, and few claims have integrals

    for method in (integrate_terms, integrate_bells, integrate_quotient_of_cosine, manualintegrate, integrate_slowly):
        try:
            found = integrate_by(method, (f if method is integrate_terms else quotient).subs(known), x)
            if found is None:
                continue
            form = turn_logarithms(choose_branch(found).subs(back), question, goal, pair)
            text = from_sympy(lower_exponentials(join_logarithms(form) if is_far else form, x, pair))
        except (NavsymError, *TROUBLE):
            continue
        if text not in seen:
            seen.add(text)
            yield text
        if method is integrate_bells:
            return  # the others look for long, and find nothing else


@functools.lru_cache(maxsize=64)
def integrate_by(method: Callable[[Any, Any], Any], f: Any, x: Any) -> Any:
    """What a method finds, or None; a statement that is refuted is read several times."""
    try:
        return method(f, x)
    except TROUBLE:
        return None


def is_positive(limit: Any) -> bool:
    """Whether a range has numbers > 0 only, or 0 at its end."""
    return limit.low is not None and not player.value_of(limit.low, {}) < 0


def choose_branch(form: Any) -> Any:
    """The general branch of a form by cases, with inverse hyperbolic functions as logarithms."""
    inverse = (sp.asinh, sp.acosh, sp.atanh)
    form = form.replace(lambda e: isinstance(e, sp.Piecewise), lambda e: e.args[0][0])
    return form.replace(lambda e: isinstance(e, inverse), lambda e: e.rewrite(sp.log))


def turn_logarithms(form: Any, question: Any, goal: Any, pair: Any) -> Any:
    """The form with log(-u) for log(u) where u is negative at a point of the range."""
    found = {}
    for part in form.atoms(sp.log):
        term = player.parse(from_sympy(part.args[0]))
        if sign_at_middle(term, question, goal, pair) < 0:
            found[part] = sp.log(-part.args[0])
    return form.xreplace(found)


def join_logarithms(form: Any) -> Any:
    """Logarithms as one where their shares have rational ratios: the parts of a sum may grow, and the sum not."""
    if len(form.atoms(sp.log)) < 2:
        return form
    groups: dict[Any, list[tuple[Any, Any]]] = {}
    rest = sp.S.Zero
    for term in sp.Add.make_args(sp.expand(form)):
        share, logarithm = term.as_independent(sp.log, as_Add=False)
        if isinstance(logarithm, sp.log):
            number, beside = share.as_coeff_Mul(rational=True)
            groups.setdefault(beside, []).append((number, logarithm.args[0]))
        else:
            rest += term
    for beside, parts in groups.items():
        common = sp.ilcm(1, *(number.q for number, _ in parts))
        rest += beside / common * sp.log(sp.Mul(*(part ** (number * common) for number, part in parts)))
    return rest


def lower_exponentials(form: Any, x: Any, pair: Any) -> Any:
    """A quotient with exponentials that fall towards its far end: over the largest one of the divisor there."""
    if not any(map(player.is_infinite, pair)):
        return form
    top, bottom = (sp.expand(part) for part in sp.fraction(sp.together(form)))
    factors = [
        [e.args[0] for e in sp.Mul.make_args(term) if isinstance(e, sp.exp)] for term in sp.Add.make_args(bottom)
    ]
    rates = [sp.diff(sp.Add(*inside), x) for inside in factors]
    if not (any(rates) and all(rate.is_number for rate in rates)):
        return form
    share = sp.exp(-x * (min(rates) if player.is_infinite(pair[0]) else max(rates)))
    return sp.expand(top * share) / sp.expand(bottom * share)


def guess_integrals(question: Any, sides: Iterable[str]) -> Iterator[Callable[[], Entry]]:
    """The other side of an equation, with the variable in the place of the upper end, as an antiderivative."""
    end, x = question.high, ("symbol", question.variable)
    for text in sides if end[0] == "symbol" and end != player.INFINITY else ():
        try:
            form = player.substitute(player.parse(text), {end[1]: x})
        except player.Refused:
            continue
        if question.variable in player.symbols_of(form):
            for plain in (True, False):
                yield functools.partial(make_integral, [], (write_term(form),), [(0, 0)], plain)


def integrate_slowly(f: Any, x: Any) -> Any:
    found = sp.integrate(f, x)
    return None if found.has(sp.Integral) else found


def integrate_terms(f: Any, x: Any) -> Any:
    """A sum of quotients of polynomials, and of polynomials times exponentials times sines and cosines of a x + b."""
    terms = sp.Add.make_args(sp.expand(linearise(f, x)))
    quotients = [t for t in terms if t.is_rational_function(x) and not t.is_polynomial(x)]
    fractions = sp.Add.make_args(sp.apart(sp.together(sp.Add(*quotients)), x)) if quotients else ()
    total = sp.Add(*(ratint(fraction, x, real=True) for fraction in fractions))
    for term in (t for t in terms if t not in quotients):
        share, rest = term.as_independent(x, as_Add=False)
        found = integrate_wave(sp.powsimp(rest), x)
        if found is None:
            return None
        total += share * found
    return total


def linearise(f: Any, x: Any) -> Any:
    """Products of sines and cosines as sums, with exponents multiplied out."""
    f = sp.expand(f, power_exp=False)
    f = sp.expand(TR8(f)) if f.has(sp.sin, sp.cos) else f
    return f.replace(lambda e: isinstance(e, (sp.exp, sp.sin, sp.cos)), lambda e: e.func(sp.expand(e.args[0])))


def integrate_wave(term: Any, x: Any) -> Any:
    """x**n exp(a x + b) cos(c x + d), or with sin: by parts, with the two components of exp((a + i c) x)."""
    n, a, phase, kind = 0, sp.Integer(0), None, ""
    inside: Any = sp.Integer(0)
    for factor in sp.Mul.make_args(term):
        if factor == x or (factor.is_Pow and factor.base == x and factor.exp.is_Integer and factor.exp > 0):
            n += int(factor.as_base_exp()[1])
        elif isinstance(factor, sp.exp) and sp.degree(factor.args[0], x) == 1:
            inside += factor.args[0]
        elif isinstance(factor, (sp.sin, sp.cos)) and phase is None and sp.degree(factor.args[0], x) == 1:
            phase, kind = factor.args[0], factor.func.__name__
        elif factor != 1:
            return None
    a = sp.Poly(inside, x).coeff_monomial(x) if inside != 0 else a
    c = sp.Poly(phase, x).coeff_monomial(x) if phase is not None else sp.Integer(0)
    if a == 0 and c == 0:
        return x ** (n + 1) / (n + 1)
    # integral x**n E = sum over k of (-1)**k n!/(n - k)! x**(n - k) E/(a + i c)**(k + 1), E = exp(inside + i phase)
    square, re, im = a**2 + c**2, sp.Integer(0), sp.Integer(0)
    p, q = sp.Integer(1), sp.Integer(0)
    for k in range(n + 1):
        p, q = (p * a + q * c) / square, (q * a - p * c) / square
        share = (-1) ** k * sp.ff(n, k) * x ** (n - k)
        re, im = re + share * p, im + share * q
    if phase is None:
        return re * sp.exp(inside)
    wave = re * sp.cos(phase) - im * sp.sin(phase) if kind == "cos" else re * sp.sin(phase) + im * sp.cos(phase)
    return wave * sp.exp(inside)


def integrate_bells(f: Any, x: Any) -> Any:
    """A sum of polynomials times exp(-a x**2 + b x + c): by parts from the error function."""
    total = sp.Integer(0)
    for term in sp.Add.make_args(sp.expand(f, power_exp=False)):
        share, rest = term.as_independent(x, as_Add=False)
        factors = sp.Mul.make_args(rest)
        inside = sp.Add(*(factor.args[0] for factor in factors if isinstance(factor, sp.exp)))
        beside = sp.Mul(*(factor for factor in factors if not isinstance(factor, sp.exp)))
        if not (inside.is_polynomial(x) and beside.is_polynomial(x) and sp.degree(inside, x) == 2):
            return None
        exponent, powers = sp.Poly(inside, x), sp.Poly(beside, x)
        a, b, c = (sp.factor(q) for q in (-exponent.nth(2), exponent.nth(1), exponent.nth(0)))
        bell = sp.exp(sp.cancel(-a * x**2 + b * x + c))
        top = sp.exp(sp.cancel(c + b**2 / (4 * a)))
        parts = [sp.sqrt(sp.pi) / (2 * sp.sqrt(a)) * top * sp.erf(sp.sqrt(a) * (x - b / (2 * a)))]
        # (x**(n - 1) bell)' = ((n - 1) x**(n - 2) - 2 a x**n + b x**(n - 1)) bell
        for n in range(1, powers.degree() + 1):
            lower = (n - 1) * parts[n - 2] if n > 1 else 0
            parts.append((lower + b * parts[n - 1] - x ** (n - 1) * bell) / (2 * a))
        total += share * sum(powers.nth(n) * part for n, part in enumerate(parts))
    return total


def integrate_quotient_of_cosine(f: Any, x: Any) -> Any:
    """s/(p + q cos u) for a linear u, without the jumps of tan(u/2)."""
    top, bottom = sp.fraction(sp.together(f))
    bottom = sp.expand(TR8(sp.expand(bottom)))  # squares as cosines of the double angle
    waves = [w for w in bottom.atoms(sp.cos, sp.sin) if w.has(x)]
    if len(waves) != 1 or top.has(x):
        return None
    wave, (u,) = waves[0], waves[0].args
    poly = sp.Poly(bottom, wave)
    if poly.degree() != 1 or poly.coeff_monomial(1).has(x) or sp.degree(u, x) != 1:
        return None
    p, q = poly.coeff_monomial(1), poly.coeff_monomial(wave)
    shift = u if isinstance(wave, sp.cos) else u - sp.pi / 2
    root = sp.sqrt(p**2 - q**2)
    angle = sp.atan(q * sp.sin(shift) / (p + root + q * sp.cos(shift)))
    return top / root * (shift - 2 * angle) / sp.diff(u, x)


# Sums and products


def list_sums(question: Any, goal: Any) -> Iterator[Callable[[], Entry]]:
    """Telescopers by Gosper's algorithm, whole and term by term, and of sines."""
    k = sp.Symbol(question.variable, integer=True)
    f = to_sympy(question.term).subs(to_sympy(("symbol", question.variable)), k)
    seen: set[str] = set()
    for method in (telescope_parts, telescope):
        try:
            found = method(f, k)
            text = None if found is None else from_sympy(found.subs(k, to_sympy(("symbol", question.variable))))
        except (NavsymError, *TROUBLE):
            continue
        if text is not None and text not in seen:
            seen.add(text)
            for plain in (True, False):
                yield functools.partial(make_sum, text, plain, player.is_infinite(question.high))


def make_sum(text: str, plain: bool, endless: bool) -> Entry:
    """The entry of a rule, with holes."""
    count = None if endless else Hole()
    equal = None if plain else Hole()
    own = {"telescoper": text, "defined": Holes(), "equal": equal, "start": Holes(), "count": count}
    return {**own, "signs": Signs()}


def telescope_parts(f: Any, k: Any) -> Any:
    """G of each kind of term: polynomial, times powers, times sines and cosines."""
    total = sp.Integer(0)
    groups: dict[Any, Any] = {}
    for term in sp.Add.make_args(sp.expand(linearise(f, k), power_base=False)):
        share, rest = term.as_independent(k, as_Add=False)
        polynomial = rest.is_polynomial(k)
        key = 1 if polynomial else rest
        groups[key] = groups.get(key, 0) + share * (rest if polynomial else 1)
    for key, share in groups.items():
        part = telescope(share, k) if key == 1 else telescope(key, k)
        if part is None:
            return None
        total += part if key == 1 else share * part
    return total


def telescope(f: Any, k: Any) -> Any:
    """G with G(k + 1) - G(k) = f(k)."""
    if f == 0 or not f.has(k):
        return f * k
    waves = [w for w in f.atoms(sp.sin, sp.cos) if w.has(k)]
    if waves:
        return telescope_wave(f, waves, k)
    ratio = gosper_term(f, k)
    if ratio is None:
        return None
    return sp.factor(sp.cancel(ratio * f)) if f.is_rational_function(k) else sp.factor(sp.simplify(ratio)) * f


def telescope_wave(f: Any, waves: list[Any], k: Any) -> Any:
    """sin(a k + b) is the difference of -cos(a k + b - a/2)/(2 sin(a/2)), and so for cos."""
    if len(waves) != 1:
        return None
    wave, (u,) = waves[0], waves[0].args
    share = sp.cancel(f / wave)
    if share.has(k) or sp.degree(u, k) != 1:
        return None
    a = sp.diff(u, k)
    middle, divisor = sp.expand(u - a / 2), 2 * sp.sin(a / 2)
    return share * (-sp.cos(middle) if isinstance(wave, sp.sin) else sp.sin(middle)) / divisor


def list_products(question: Any, goal: Any) -> Iterator[Callable[[], Entry]]:
    """G with G(k + 1) = f(k) G(k), from polynomials above that are those below with k + s in the place of k."""
    k = to_sympy(("symbol", question.variable))
    f = join_powers(to_sympy(question.term), k)
    sides: list[list[sp.Poly]] = []
    for part in sp.fraction(sp.cancel(f)):
        rows = sp.factor_list(part, k)[1] if part.is_polynomial(k) else []
        sides.append([sp.Poly(factor, k).monic() for factor, power in rows for _ in range(power)])
    share = sp.cancel(f * sp.prod(h.as_expr() for h in sides[1]) / sp.prod(g.as_expr() for g in sides[0]))
    form = sp.S.One
    for g in sides[0]:
        below = [(h, s) for h in sides[1] if (s := find_shift(g, h)) is not None]
        if not below:
            return
        h, s = below[0]
        sides[1].remove(h)
        form *= sp.prod(h.as_expr().subs(k, k + j) for j in range(s))
        form /= sp.prod(g.as_expr().subs(k, k + j) for j in range(-s))
    if sides[1] or share.has(k):
        return
    text = from_sympy(form * share**k if share != 1 else form)
    for plain in (True, False):
        yield functools.partial(make_sum, text, plain, player.is_infinite(question.high))


def find_shift(g: sp.Poly, h: sp.Poly) -> int | None:
    """The whole s with g(k) = h(k + s), for polynomials with leading coefficient 1."""
    n, k = g.degree(), g.gen
    s = sp.simplify((g.nth(n - 1) - h.nth(n - 1)) / n)
    is_moved = n == h.degree() and s.is_Integer and sp.expand(h.as_expr().subs(k, k + s) - g.as_expr()) == 0
    return int(s) if is_moved else None


def join_powers(f: Any, k: Any) -> Any:
    """Powers with k in the exponent as one exponential, which is none where k cancels: r**(k + 1)/r**k = r."""
    apart = f.replace(
        lambda e: e.is_Pow and e.exp.has(k), lambda e: sp.exp(e.exp * sp.expand_log(sp.log(e.base), force=True))
    )
    return sp.powsimp(apart, combine="exp").replace(sp.exp, lambda e: sp.exp(sp.expand(e)))


# Limits


def list_limits(question: Any, goal: Any) -> Iterator[Callable[[], Entry]]:
    """Growth at infinity, Taylor quotients of rising order at a number, or in 1/x at infinity."""
    x, f, far = to_sympy(("symbol", question.variable)), to_sympy(question.term), player.is_infinite(question.low)
    if far:
        yield lambda: {"signs": Signs()}
        f = f.subs(x, 1 / x if question.low == player.INFINITY else -1 / x)
    top, bottom = sp.fraction(sp.together(TR2(TR1(f))))  # tan as sin/cos
    a = sp.Integer(0) if far else to_sympy(question.low)
    around = [
        t for _, t in player.set_union(map(player.conditions, (question.term, *question.needs)))
        if question.variable in player.symbols_of(t) and not far
    ]  # fmt: skip
    orders = [order_of_zero(to_sympy(t), x, a) for t in around]
    order = order_of_zero(bottom, x, a)
    yield lambda: {
        "top": from_sympy(top), "bottom": from_sympy(bottom), "order": order, "defined": Holes(), "zeros": Holes(),
        "pole": Holes(), "around": orders, "signs": Signs(),
    }  # fmt: skip


def order_of_zero(f: Any, x: Any, a: Any) -> int:
    """How many derivatives vanish at a point before one that does not."""
    for order in range(MOST_ORDER + 1):
        if sp.simplify(sp.diff(f, x, order).subs(x, a)) != 0:
            return order
    return 0
