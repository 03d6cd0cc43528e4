"""Rooms that write a term otherwise: other forms, and one new number for an exponential, a root or a half angle."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterator
from typing import Any

import sympy as sp
from flint import arb
from sympy.simplify.fu import TR8

from navsym.core.errors import NavsymError
from navsym.language.expression import symbol, to_text
from navsym.prove.products import as_product
from navsym.prove.rooms.equations import rewrite_atom
from navsym.prove.rooms.goals import Hole, Holes, Proof, Term, abstract, factor, player, to_sympy, write_term

#: Digits of a number up to which polynomials are factored.
MOST_DIGITS = 40
Form = tuple[sp.Expr, sp.Expr, tuple[str | None, str | None], sp.Expr | None]
FREE, UPWARD = (None, None), ("0", None)


def by_forms(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """The term written otherwise: as a product, as one fraction, expanded."""
    for text in list_forms(goal.term):
        yield {"rule": "equal", "to": text, "defined": Holes(), "proof": Hole()}


@functools.lru_cache(maxsize=4096)
def list_forms(term: Term) -> tuple[str, ...]:
    """Texts of other forms of a term."""
    expression, own, forms = to_sympy(term), write_term(term), dict[str, None]()
    is_heavy = any(len(digits) > MOST_DIGITS for digits in re.findall(r"\d+", own))
    for rewrite in FORMS[-1:] if is_heavy else FORMS:
        try:
            other = rewrite(expression)
            text = to_text(other) if other is not None else own
        except (NavsymError, ArithmeticError, ValueError, TypeError, AttributeError, NotImplementedError, KeyError):
            continue
        if player.parse(text) != term and len(text) < 6 * len(own) + 200:
            forms[text] = None
    return tuple(forms)


def complete_square(expression: sp.Expr) -> sp.Expr | None:
    """a v**2 + b v + c as a (v + b/(2 a))**2 + rest, for the first symbol of degree two."""
    for v in sorted(expression.free_symbols, key=str):
        if expression.is_polynomial(v) and sp.degree(expression, v) == 2:
            a, b, c = sp.Poly(expression, v).all_coeffs()
            return a * (v + b / (2 * a)) ** 2 + factor(c - b**2 / (4 * a))
    return None


def halve_angle(expression: sp.Expr) -> sp.Expr | None:
    """c - c cos(u) as 2 c sin(u/2)**2, and c + c cos(u) as 2 c cos(u/2)**2, beside the other terms of a sum."""
    number, rest = expression.as_coeff_Add()
    for term in sp.Add.make_args(rest) if number > 0 else ():
        share, wave = term.as_coeff_Mul()
        if wave.func is sp.cos and abs(share) == number:
            half = (sp.cos if share > 0 else sp.sin)(wave.args[0] / 2)
            return rest - term + 2 * number * half**2
    return None


FORMS: tuple[Callable[[sp.Expr], sp.Expr | None], ...] = (
    as_product,
    factor,
    sp.factor_terms,
    lambda e: sp.expand(e),
    lambda e: sp.expand(TR8(sp.expand(e))) if e.has(sp.sin, sp.cos) else None,
    lambda e: factor(sp.expand_trig(e)) if e.has(sp.atan, sp.asin, sp.acos) else None,
    halve_angle,
    complete_square,
)


def by_one_angle(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Sines and cosines of multiples of x/d by those of x/d alone, where hypotheses are to be divided by."""
    expression = to_sympy(goal.term) if goal.zeros else sp.S.Zero
    for x in sorted(expression.free_symbols, key=str):
        angles = {node.args[0] for node in expression.atoms(sp.sin, sp.cos, sp.tan, sp.cot) if node.has(x)}
        shares = {sp.expand(angle / x) for angle in angles}
        if len(shares) > 1 and all(share.is_Rational for share in shares):
            d = sp.ilcm(1, *(share.q for share in shares))
            form = sp.expand_trig(expression.subs(x, d * x)).subs(x, x / d)
            form = form.replace(sp.cot, lambda u: sp.cos(u) / sp.sin(u)).replace(
                sp.tan, lambda u: sp.sin(u) / sp.cos(u)
            )
            yield {"rule": "equal", "to": to_text(form), "defined": Holes(), "proof": Hole()}


def by_substitution(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """One number u in the place of an exponential, a root or a tangent of a half angle."""
    expression = to_sympy(goal.term)
    u = sp.Symbol("u_", real=True)
    name = "u"
    while name in goal.box:
        name += "u"
    new = symbol(name)
    for make in (by_exponentials, by_root, by_tangent):
        for term, form, ends, dense in make(expression, u):
            to = to_text(factor(form.xreplace({u: new})))
            body = abstract({name: to_text(term)}, {name: [*ends, []]}, to)
            if dense is None:
                yield body
            elif goal.relation == ">=":
                point = {s.name: "1/7" for s in dense.free_symbols}
                outer = {"rule": "dense", "except": to_text(dense), "point": point, "defined": Holes(), "proof": body}
                yield outer


def by_exponentials(expression: sp.Expr, u: sp.Symbol) -> Iterator[Form]:
    """u = exp(x/d)."""
    hyper = expression.rewrite(sp.exp) if expression.has(sp.sinh, sp.cosh, sp.tanh) else expression
    x, step, turns = count_steps(hyper.atoms(sp.exp))
    form = hyper.xreplace({node: u**n for node, n in turns.items()})
    if turns and not form.has(x):
        yield sp.exp(x * step), form, UPWARD, None


def count_steps(nodes: set[Any]) -> tuple[sp.Symbol | None, Any, dict[Any, int]]:
    """The one symbol x, the largest step and whole numbers n with arguments n step x; nothing where there are none."""
    symbols = {s for node in nodes for s in node.free_symbols}
    x = next(iter(symbols), None)
    shares = {node: sp.expand(node.args[0] / x) for node in nodes} if len(symbols) == 1 else {}
    if not shares or not all(s.is_Rational for s in shares.values()):
        return x, 1, {}
    d = sp.ilcm(1, *(s.q for s in shares.values()))
    step = sp.Rational(sp.igcd(0, *(int(s * d) for s in shares.values())), d)
    return x, step, {node: int(s / step) for node, s in shares.items()}


def by_root(expression: sp.Expr, u: sp.Symbol) -> Iterator[Form]:
    """u = (a + b x)**(1/q)."""
    roots = [p for p in expression.atoms(sp.Pow) if p.exp.is_Rational and p.exp.q > 1]
    bases = {p.base for p in roots}
    if len(bases) != 1:
        return
    (base,) = bases
    symbols = base.free_symbols
    if len(symbols) != 1 or not base.is_polynomial() or sp.degree(base) != 1:
        return
    (x,) = symbols
    q = sp.ilcm(1, *(p.exp.q for p in roots))
    a, b = base.subs(x, 0), sp.diff(base, x)
    form = expression.xreplace({p: u ** (p.exp * q) for p in roots}).subs(x, (u**q - a) / b)
    yield sp.Pow(base, sp.Rational(1, q)), form, UPWARD, None


def by_tangent(expression: sp.Expr, u: sp.Symbol) -> Iterator[Form]:
    """u = tan(x/(2 d)) for the one angle of which all others are multiples."""
    x, step, turns = count_steps({node for node in expression.atoms(sp.sin, sp.cos) if node.free_symbols})
    if not turns or max(map(abs, turns.values())) > 8:
        return
    cosine, sine = (1 - u**2) / (1 + u**2), 2 * u / (1 + u**2)
    values = {node: (sp.chebyshevt(abs(n), cosine) if node.func is sp.cos else
                     sp.sign(n) * sine * sp.chebyshevu(abs(n) - 1, cosine)) for node, n in turns.items()}  # fmt: skip
    form = expression.xreplace(values)
    if not form.has(x):
        half = x * step / 2
        yield sp.tan(half), form, FREE, sp.cos(half)


def by_roots_of_symbols(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Positive symbols as whole powers of new ones, where roots are taken of their products."""
    expression = to_sympy(goal.term)
    roots = [p for p in expression.atoms(sp.Pow) if p.exp.is_Rational and p.exp.q > 1 and p.base.free_symbols]
    if not roots or not all(part.is_Symbol for p in roots for part in p.base.as_powers_dict()):
        return
    q, terms, ranges, new = sp.ilcm(1, *(p.exp.q for p in roots)), {}, {}, {}
    for v in sorted(set().union(*(p.base.free_symbols for p in roots)), key=str):
        limit, name = goal.box[v.name], f"{v.name}_root"
        if limit.low is None or name in goal.box or player.value_of(limit.low, {}) < 0:
            return
        is_open = limit.open_low or not player.value_of(limit.low, {}).contains(0)
        terms[name], ranges[name] = to_text(sp.root(v, q)), ["0", None, ["open-low"] if is_open else []]
        new[v] = sp.Symbol(name, positive=True)
    form = expression.xreplace({v: u**q for v, u in new.items()}).xreplace({u: symbol(u.name) for u in new.values()})
    proof = abstract(terms, ranges, to_text(form))
    for p in roots:  # of products: by factors
        apart = sp.Mul(
            *(sp.Pow(v, n * p.exp, evaluate=False) for v, n in p.base.as_powers_dict().items()), evaluate=False
        )
        if not p.base.is_Symbol:
            proof = rewrite_atom(to_text(p), to_text(apart)) | {"proof": proof}
    yield proof


def by_known_signs(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Real symbols with one sign wherever the term has a value, or by a range without 0, as new ones that are > 0."""
    known = player.with_weaker(player.set_union(map(player.conditions, (goal.term, *goal.exists))))
    terms, ranges, form = {}, {}, goal.term
    for name in sorted(player.symbols_of(goal.term)):
        v, new, limit = ("symbol", name), f"{name}_p", goal.box[name]
        beside = [end == player.ZERO and limit.nonzero for end in (limit.low, limit.high)]
        if new in goal.box or not (any(beside) or ((">=", v) in known and limit.low is None)):
            continue
        is_open = any(beside) or {(">", v), ("!=", v), ("!=", ("sqrt", v))} & known
        far = None if not any(beside) else limit.high if beside[0] else limit.low and player.negate(limit.low)
        terms[new] = f"-{name}" if beside == [False, True] else name
        ranges[new] = ["0", far and write_term(far), ["open-low"] if is_open else []]
        letter = ("symbol", new)
        form = player.replace(form, v, player.negate(letter) if beside == [False, True] else letter)
    if terms:
        yield abstract(terms, ranges, write_term(form))


def by_hypothesis(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A hypothesis c v + r >= 0 as a number u >= 0, and v = (u - r)/c."""
    for k, given in enumerate(goal.given):
        linear = to_sympy(given)
        for v in sorted(linear.free_symbols & to_sympy(goal.term).free_symbols, key=str):
            c = linear.coeff(v)
            name = f"{v.name}_{k}"
            rest = linear - c * v
            if not (c.is_Rational and c != 0 and rest != 0) or v in rest.free_symbols or name in goal.box:
                continue
            u = symbol(name)
            form = to_text(to_sympy(goal.term).xreplace({v: (u - rest) / c}))
            yield abstract({name: write_term(given)}, {name: ["0", None, []]}, form)
