"""Rooms of equations: exact algebra, inverse functions by their definitions, equal squares, derivatives."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import combinations, pairwise
from typing import Any

import sympy as sp
from flint import arb, fmpq

from navsym.language.expression import to_text
from navsym.prove.rooms.goals import (
    MOST_INDEX,
    Hole,
    Holes,
    Proof,
    Term,
    factor,
    index_of,
    inner_point,
    is_below,
    is_root,
    player,
    simple_point,
    subterms,
    to_sympy,
    values_of,
    write_term,
)


def by_algebra(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Both sides have one normal form."""
    yield {"rule": "identity"}


MOST_ZEROS, MOST_INTEGERS = 2, 16


def by_empty_case(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A hypothesis that no point of the goal meets, as x <= 0 for a positive x."""
    few = not sample and len(goal.zeros) <= MOST_ZEROS  # where something has to be 0 there is no sample at all
    for k, h in enumerate((*goal.given, *goal.zeros) if few else ()):
        proof: Proof = Hole()
        if k < len(goal.given):
            proof = {"rule": "equal", "to": to_text(-to_sympy(h)), "defined": Holes(), "proof": proof}
        yield {"rule": "empty", "hypothesis": k, "proof": proof}


def by_bounds_that_meet(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Not above 0 and not below, by hypotheses and ranges."""
    if goal.given and goal.term[0] != "number":
        yield {"rule": "between", "proofs": Holes()}


def by_integers(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A whole number one by one: all there are, or those around the places between them where the term fails."""
    for name in sorted(n for n, limit in goal.box.items() if limit.integer):
        low, high = (None if end is None else int(player.find_whole(end)[1]) for end in goal.box[name][:2])
        if low is not None and high is not None and high - low <= MOST_INTEGERS:
            yield count_integers(name, low, high)
        elif player.symbols_of(goal.term) == {name} and goal.relation != "=":
            first = low if low is not None else -MOST_INTEGERS if high is None else high - 2 * MOST_INTEGERS
            places = [first + fmpq(k, 4) for k in range(8 * MOST_INTEGERS)]
            values = [player.value_of(goal.term, {name: player.Jet(arb(place))}) for place in places]
            signs = [(v > 0) - (v < 0) for v in values]
            changes = [s != t if goal.relation == "!=" else s < 0 for s, t in pairwise(signs)]
            if bad := [place for place, fails in zip(places, changes, strict=False) if fails]:
                start, end = int(bad[0].floor()), int(bad[-1].floor()) + 1
                below = split_at(name, end, [count_integers(name, start, end), Hole()])
                yield split_at(name, start, [Hole(), below])


def count_integers(name: str, low: int, high: int) -> Proof:
    """The rule that takes whole numbers one by one."""
    return {"rule": "integers", "symbol": name, "from": low, "proofs": [Hole() for _ in range(low, high + 1)]}


def split_at(name: str, at: Any, proofs: list[Any]) -> Proof:
    """The rule that takes the two sides of a number."""
    return {"rule": "split", "symbol": name, "at": str(at), "proofs": proofs}


MANY_VALUES = 3


def by_values(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """An absolute value by its two cases; two that are compared have squares, which take no cases."""
    terms = player.list_terms(goal.term)
    if goal.relation == "=" or len(terms) != 2 or not all(any(map(is_root, player.list_factors(t))) for t in terms):
        yield from by_cases(goal, sample)


def by_kinks(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """The two sides of a zero of many absolute values of one symbol, or their values where the range has no zero.

    Of k values there are k + 1 pieces, and 2**k cases.
    """
    values = [*dict.fromkeys(part for part in subterms(goal.term) if part[0] == "abs")]
    names = player.symbols_of(goal.term)
    if len(names) != 1 or len(values) < MANY_VALUES:
        return
    try:
        lines = {value: player.to_fraction(value[1]) for value in values}
    except player.Refused:
        return
    if any(top.degree() != 1 or bottom.degree() > 0 for top, bottom in lines.values()):
        return
    (name,) = names
    limit = goal.box[name]
    inside = limit._replace(open_low=True, open_high=True, nonzero=False)
    zeros = sorted({-top[0] / top[1] for top, _ in lines.values()})
    zeros = [zero for zero in zeros if player.is_inside(player.number(zero), inside)]
    if zeros:
        yield split_at(name, zeros[len(zeros) // 2], Holes())
        return
    proof: Proof = Hole()
    for value in values:
        is_negative = player.value_of(value[1], {name: player.Jet(inner_point(limit, 0, 0))}) < 0
        sign = player.negate(value[1]) if is_negative else value[1]
        proof = rewrite_atom(write_term(value), write_term(sign)) | {"proof": proof}
    yield proof


def by_cases(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """The first absolute value that has no other one inside, by its two cases."""
    for part in dict.fromkeys(p for p in subterms(goal.term) if p[0] == "abs"):
        if not any(p[0] == "abs" for p in subterms(part[1])):
            yield {"rule": "cases", "of": write_term(part[1]), "proofs": Holes()}
            return


def by_modulus(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """sqrt(u) and |u| as what they are where its sign is known, all at once and one by one; |u v| as |u| |v|."""
    values = {part: list_moduli(goal, part) for part in dict.fromkeys(filter(is_root, subterms(goal.term)))}
    known = [(part, signed[0]) for part, signed in values.items() if len(signed) == 1]
    if len(known) > 1:
        proof: Proof = Hole()
        for part, value in known:
            proof = rewrite_atom(write_term(part), value) | {"proof": proof}
        yield proof
    for part, signed in values.items():
        yield from (rewrite_atom(write_term(part), value) for value in signed)
        if part[0] == "abs" and len(factors := player.list_factors(part[1])) > 1:
            yield rewrite_atom(write_term(part), write_term(("*", *(("abs", factor) for factor in factors))))


def list_moduli(goal: Any, part: Term) -> list[str]:
    """What a root may be, of one sign or the other, as far as samples tell."""
    inside = to_sympy(part[1])
    if inside.has(sp.sin, sp.cos) and sp.count_ops(inside) < 60:
        inside = sp.trigsimp(factor(inside))  # by sin(x)**2 + cos(x)**2 = 1
    power = sp.Integer(1) if part[0] == "abs" else sp.Rational(1, 2)
    power = power if part[0] != "^" else sp.Rational(str(player.constant_of(part[2])))
    root = inside if part[0] == "abs" else sp.powdenest(sp.sqrt(factor(inside)) ** (2 * power), force=True)
    if root.has(sp.Pow) and part[0] != "abs" and any(not p.exp.is_Integer for p in root.atoms(sp.Pow)):
        return []
    text = to_text(root)
    return [value for value in (text, f"-({text})") if not is_below(values_of(goal, player.parse(value)))]


def by_factors_of_roots(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A root of a product: whole powers before it, then as the product of the roots of what has one sign."""
    yield from by_another_root(goal)
    for part in dict.fromkeys(p for p in subterms(goal.term) if p[0] in ("sqrt", "^") and is_root(p)):
        exponent = sp.Rational(1, 2) if part[0] == "sqrt" else sp.Rational(str(player.constant_of(part[2])))
        factors = factor(to_sympy(part[1])).as_powers_dict()
        whole = {base: power for base, power in factors.items() if (power * exponent).is_Integer}
        rest = sp.expand(sp.Mul(*(base**power for base, power in factors.items() if base not in whole)))
        for rows in (whole | ({rest: 1} if rest != 1 else {}) if whole else {}, factors):
            text = write_roots(goal, rows, exponent)
            if text is not None and [*rows.values()] not in ([], [1]):
                yield rewrite_atom(write_term(part), text)
            elif text is None and rows is not factors:
                yield from by_sides_of_zero(goal, sample)


def by_another_root(goal: Any) -> Iterator[Proof]:
    """sqrt(c u) = sqrt(c) sqrt(u) for a number c; sqrt(u) = sqrt(u v)/sqrt(v) for numbers with a simple sqrt(u v)."""
    roots = [p for p in dict.fromkeys(subterms(goal.term)) if p[0] == "sqrt" and player.constant_of(p[1]) is None]
    for one, other in combinations(roots, 2):
        value = None
        if not player.symbols_of(one) | player.symbols_of(other):
            whole = sp.sqrtdenest(sp.sqrt(sp.expand(to_sympy(one[1]) * to_sympy(other[1]))))
            simple = all(power.base.is_Rational for power in whole.atoms(sp.Pow))
            value = f"({to_text(whole)})/({write_term(one)})" if simple else None
        elif player.symbols_of(one) == player.symbols_of(other):
            pairs = zip(values_of(goal, other[1]), values_of(goal, one[1]), strict=False)
            ratio = next((Fraction(float(v / u)).limit_denominator(1000) for v, u in pairs if u > 0 and v > 0), None)
            multiple = player.parse(f"({ratio or 0})*({write_term(one[1])})")
            value = (
                f"sqrt({ratio})*{write_term(one)}" if player.is_identity(player.subtract(other[1], multiple)) else None
            )
        if value is not None:
            yield rewrite_atom(write_term(other), value)


def write_roots(goal: Any, factors: dict[sp.Expr, Any], exponent: sp.Rational) -> str | None:
    """The product of the roots of factors, or of what is opposite to them; None where a factor changes its sign."""
    texts, sign = [], 1
    for base, power in factors.items():
        where_defined = ("*", player.ZERO, goal.term)
        values = values_of(goal, ("+", player.parse(to_text(base)), where_defined))
        if is_below(values) and is_below(values, -1):
            return None
        sign *= (-1) ** int(power) if is_below(values) else 1
        positive = to_text(-base if is_below(values) else base)
        is_whole = (power * exponent).is_Integer
        texts.append(f"({positive})**({power * exponent})" if is_whole else f"(({positive})**({exponent}))**({power})")
    return "*".join(texts) if sign > 0 else None


def rewrite_atom(atom: str, value: str) -> Proof:
    """The rule that puts a value in the place of an inverse function."""
    return {"rule": "rewrite", "from": atom, "to": value, "defined": Holes(), "proof": Hole()} | {
        "equal": solve_for(atom, value)
    }


def solve_for(atom: str, value: str, share: str = "1") -> Proof:
    """The rule that an inverse function has a value."""
    holes: Proof = {"defined": Holes(), "proofs": Holes()}
    return {"rule": "solve", "share": share, "atom": atom, "value": value} | holes


#: Letters of a term up to which logarithms are spread.
LONGEST = 600


def is_exponential(power: Term) -> bool:
    """Whether an exponent is no number, or one with too long a divisor for a root."""
    return player.constant_of(power[2]) is None or index_of(power) > MOST_INDEX


def by_logarithms_of_products(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Logarithms as sums over the factors of what they are of; a**b and a**5.25588 as exponentials first."""
    if len(write_term(goal.term)) > LONGEST:
        return  # many digits, of which factors are sought for long
    powers = [p for p in subterms(goal.term) if p[0] == "^" and is_exponential(p)]
    if powers:
        term = goal.term
        for part in dict.fromkeys(reversed(powers)):  # the outer ones first
            term = player.replace(term, part, ("exp", ("*", part[2], ("log", part[1]))))
        yield {"rule": "equal", "to": write_term(term), "defined": Holes(), "proof": Hole()}
    for part in dict.fromkeys(p for p in subterms(goal.term) if p[0] == "log"):
        own = to_sympy(part)
        if own.func is sp.log:
            own = sp.expand_log(sp.log(factor(own.args[0])), force=True, factor=True)
        if player.parse(to_text(own)) != part:
            yield rewrite_atom(write_term(part), to_text(own))
            return


INVERSES = (sp.asin, sp.acos, sp.atan, sp.log, sp.atan2)


def by_exponents(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Every exponent as one fraction, and one exponential in each term: exponents that are equal are then alike."""
    proof: Proof = Hole()
    for exponent in dict.fromkeys(p[1] for p in subterms(goal.term) if p[0] == "exp"):
        plain = to_text(sp.cancel(to_sympy(exponent)))
        is_left = any(p[0] == "log" and p[1][0] == "exp" for p in subterms(exponent))  # to the room of logarithms
        if player.parse(plain) != exponent and not is_left:
            proof = rewrite_atom(write_term(exponent), plain) | {"equal": {"rule": "identity"}, "proof": proof}
    if not proof:
        form = to_text(sp.powsimp(to_sympy(goal.term), combine="exp"))
        proof = {"rule": "equal", "to": form, "defined": Holes(), "proof": proof} if "exp" in form else proof
    if proof:
        yield proof


def by_values_of_constants(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """What the algebra system makes of inverse functions and nested roots: acos(0) = pi/2, asin(-x) = -asin(x)."""
    for part in dict.fromkeys(p for p in subterms(goal.term) if p[0] in ("asin", "acos", "atan", "log", "atan2")):
        own = to_sympy(part)
        value = own.func(*map(sp.expand, own.args))  # atan(0*x) has a symbol and is a number
        rest = [f for f in INVERSES if f is not sp.atan or part[0] != "atan2"]
        is_other = part[0] in ("asin", "acos", "atan") and player.parse(to_text(value)) != part
        if (value.is_number and value.is_finite and not value.has(*rest)) or is_other:
            yield rewrite_atom(write_term(part), to_text(value))
            return
    for part in dict.fromkeys(p for p in subterms(goal.term) if is_root(p) and p[0] != "abs"):
        own = sp.S.NaN if player.symbols_of(part) else to_sympy(part)
        if own.is_number and own.has(sp.Pow) and (value := denest(own)) != own:
            yield rewrite_atom(write_term(part), to_text(value))
            return


def denest(root: sp.Expr) -> sp.Expr:
    """A nested root as a sum of simpler ones, where one is found: for cube roots a guess from its digits."""
    plain = sp.sqrtdenest(root)
    inner = sorted(root.base.atoms(sp.Pow), key=str) if root.is_Pow else []
    if plain != root or not inner or not root.base.is_Add:
        return plain
    return sp.nsimplify(root, inner, tolerance=sp.Rational(1, 10**25))


def by_inverse(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """The equation solved for an inverse function, and the definition of that."""
    expression = to_sympy(goal.term)
    atoms = {to_text(atom): atom for atom in expression.atoms(sp.log, sp.asin, sp.acos, sp.atan, sp.atan2, sp.Abs)}
    roots = {to_text(p): p for p in expression.atoms(sp.Pow) if p.exp.is_Rational and p.exp.q > 1}
    own = {**atoms, **roots}
    for text, atom in sorted(own.items(), key=lambda pair: -len(pair[0])):
        rest = sp.expand_mul(expression, deep=False)
        share = rest.coeff(atom)
        value = sp.expand_mul(atom - rest / share, deep=False) if share.is_Rational and share != 0 else None
        if value is None or value.has(atom):
            continue
        yield solve_for(text, to_text(value), str(share))


def by_equal_squares(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Equal squares of two sides of one sign."""
    terms = player.list_terms(goal.term)
    if len(terms) < 2 or not any(map(is_root, subterms(goal.term))):
        return
    for left in terms[:4]:
        rest = tuple(player.negate(t) for t in terms if t is not left)
        right = rest[0] if len(rest) == 1 else ("+", *rest)
        for sign in (1, -1):
            if not is_below(values_of(goal, left), sign) and not is_below(values_of(goal, right), sign):
                yield {"rule": "squares", "left": write_term(left), "right": write_term(right), "sign": sign} | {
                    "defined": Holes(), "proofs": Holes()
                }  # fmt: skip


def by_sides_of_zero(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """The parts of a range beside zero, on each of which odd functions have one sign."""
    names = sorted(player.symbols_of(goal.term))
    if len(names) == 1 and any(is_root(part) for part in subterms(goal.term)):
        limit = goal.box[names[0]]
        if player.is_inside(player.ZERO, limit._replace(open_low=True, open_high=True, nonzero=False)):
            yield split_at(names[0], 0, Holes())


SMOOTH = ("asin", "acos", "atan", "atan2", "log", "erf")


def by_gradient(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Derivatives that vanish, and one value."""
    names = sorted(player.symbols_of(goal.term))
    if not names or not any(part[0] in SMOOTH for part in subterms(goal.term)):
        return
    for k in range(3):
        point = {name: str(simple_point(goal.box[name], k)) for name in names}
        yield {"rule": "derivative", "point": point, "value": Hole(), "slopes": Holes(), "defined": Holes()}
