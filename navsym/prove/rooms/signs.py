"""Rooms of inequalities: balls, signs of factors and terms, ends of ranges, squares, slopes, real roots, cones."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator
from typing import Any

import sympy as sp
from flint import arb, fmpq, fmpq_mat, fmpq_mpoly

from navsym.core.exact import to_fmpq
from navsym.language.expression import to_text
from navsym.prove.rooms.goals import (
    Hole,
    Holes,
    Proof,
    Term,
    is_below,
    is_root,
    join,
    player,
    simple_point,
    subterms,
    to_sympy,
    values_of,
    write_term,
)

CELLS = (120, 2500)
#: Comparisons of variables in one proof by cones.
MOST_SPLITS = 300
#: Symbols of separate terms whose corners are looked at.
MOST_CORNERS = 6
#: Numbers in a term whose sums are compared with it.
MOST_NUMBERS = 4
FEW_SAMPLES = 4


def by_number(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Numbers by a ball, or because they are zero."""
    if player.symbols_of(goal.term):
        return
    for bits in (64, 256, 2048):
        yield {"rule": "balls", "bits": bits, "cells": 1}
    if goal.relation == ">=":
        yield {"rule": "zero", "proof": Hole()}


def by_constant(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A term that seems to be one number, such as a sum of the numbers in it: by the equation."""
    if len(sample) >= FEW_SAMPLES and player.symbols_of(goal.term):
        for number in list_constants(goal):
            if all((value - arb(number)).contains(0) for value in sample):
                proof: Proof = {"rule": "rewrite", "from": write_term(goal.term), "to": f"({number})"}
                yield proof | {"defined": Holes(), "equal": Hole(), "proof": Hole()}
                return


def list_constants(goal: Any) -> list[fmpq]:
    """Zero and the sums of numbers among the terms, as far as the relation allows them."""
    numbers = [q for t in flatten(goal.term) if (q := player.constant_of(t)) is not None and q != 0][:MOST_NUMBERS]
    subsets = (chosen for n in range(len(numbers) + 1) for chosen in itertools.combinations(numbers, n))
    sums = dict.fromkeys(sum(chosen, fmpq(0)) for chosen in subsets)
    return [q for q in sums if q > 0 or (q == 0 and goal.relation == ">=") or (q != 0 and goal.relation == "!=")]


def flatten(term: Term) -> Iterator[Term]:
    """The terms of a sum, of sums inside it, and of their negatives."""
    for part in player.list_terms(term):
        if part[0] == "*" and part[1] == player.MINUS_ONE and len(part) == 3 and part[2][0] == "+":
            yield from map(player.negate, flatten(part[2]))
        else:
            yield part


def by_identity(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Zero, or a hypothesis."""
    if goal.relation == ">=" and all(value.contains(0) for value in sample):
        yield {"rule": "identity"}
    if goal.relation == ">=" and (weights := find_weights(goal)) is not None:
        yield {"rule": "given", "weights": weights}


def find_weights(goal: Any) -> list[str] | None:
    """Weights >= 0 of the hypotheses that add up to the term.

    Least squares over the coefficients (Lawson and Hanson, Solving least squares problems, 1974), in fractions: a
    library of numbers takes half a second to load, in each child again.
    """
    if not goal.given:
        return None
    forms = [sp.expand(to_sympy(t)).as_coefficients_dict() for t in (goal.term, *goal.given)]
    monomials = dict.fromkeys(m for form in forms for m in form)
    rows = [[to_fmpq(form.get(m, 0)) for form in forms] for m in monomials]
    columns, wanted = fmpq_mat([row[1:] for row in rows]), fmpq_mat([row[:1] for row in rows])
    slopes, squares = columns.transpose() * wanted, columns.transpose() * columns
    weights: dict[int, fmpq] = {}
    while True:
        x = fmpq_mat([[weights.get(k, fmpq(0))] for k in range(len(goal.given))])
        if columns * x == wanted:
            return [str(value[0]) for value in x.tolist()]
        rising = slopes - squares * x
        best = max(range(len(goal.given)), key=lambda k: rising[k, 0])
        if rising[best, 0] <= 0:
            return None
        weights = keep_positive(weights | {best: fmpq(0)}, slopes, squares)


def keep_positive(weights: dict[int, fmpq], slopes: fmpq_mat, squares: fmpq_mat) -> dict[int, fmpq]:
    """The least squares of chosen columns; those whose weight would fall below zero on the way are left out."""
    while True:
        names = [*weights]
        best = fmpq_mat([[squares[i, j] for j in names] for i in names]).solve(
            fmpq_mat([[slopes[i, 0]] for i in names])
        )
        target = {k: best[i, 0] for i, k in enumerate(names)}
        falling = [weights[k] / (weights[k] - target[k]) for k in names if target[k] <= 0]
        if not falling:
            return target
        weights = {k: w + min(falling) * (target[k] - w) for k, w in weights.items()}
        weights = {k: w for k, w in weights.items() if w > 0}


def by_range(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A multiple of the distance from an end of a range."""
    if goal.relation == "!=" or len(player.symbols_of(goal.term)) != 1:
        return
    (name,) = player.symbols_of(goal.term)
    if any(part[0] not in ("+", "*", "number", "symbol", "pi", "^") for part in subterms(goal.term)):
        return
    slope = player.differentiate(goal.term, name)
    if player.symbols_of(slope):
        return
    share = player.constant_of(slope)
    if share is not None and share != 0:
        yield {"rule": "range", "symbol": name, "end": int(share < 0), "share": f"{abs(share)}"}


def by_side(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """!= by the one sign that the term has."""
    if goal.relation == "!=":
        for sign in (1, -1):
            if not is_below(sample, sign):
                yield {"rule": "side", "sign": sign, "proof": Hole()}


def by_roots(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A rational function of one symbol by its real roots."""
    names = player.symbols_of(goal.term)
    if len(names) == 1 and all(p[0] in ("+", "*", "^", "number", "symbol") for p in subterms(goal.term)):
        limit = goal.box[next(iter(names))]
        yield {"rule": "roots", "from": outer_end(limit.low, -1), "to": outer_end(limit.high, 1)}


def outer_end(end: Term | None, sign: int) -> str | None:
    """A rational end, or a near rational number beyond it."""
    if end is None:
        return None
    q = player.constant_of(end)
    if q is None:
        ball = player.value_of(end, {})
        q = to_fmpq((ball.upper() if sign > 0 else ball.lower()) + arb(sign) * arb(2) ** -80)
        q = fmpq(int(q * 2**100 + sign), 2**100)
    return str(q)


def by_bounds(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Least values of the terms, and the half turn of an angle."""
    if goal.relation == "!=" or not any(p[0] in player.SPANS for p in subterms(goal.term)):
        return
    factors = player.list_factors(goal.term)
    waves = [f for f in factors if f[0] in ("sin", "cos")]
    if len(waves) == 1 and sum(bool(player.symbols_of(f)) for f in factors) == 1:
        yield from by_angle(goal, waves[0])
    yield {"rule": "bounded", "proof": Hole()}


def by_angle(goal: Any, wave: Term) -> Iterator[Proof]:
    """The half turn in which an angle lies."""
    share = player.constant_of(("*", player.ONE, *(f for f in player.list_factors(goal.term) if f != wave)))
    angles = [float(v.mid()) / 3.141592653589793 for v in values_of(goal, wave[1])]
    if share and angles:
        middle = sum(angles) / len(angles) + (0 if wave[0] == "sin" else 0.5)
        k = int(middle // 1)
        if (share > 0) == (k % 2 == 0):
            yield {"rule": "angle", "turn": k, "share": str(abs(share)), "proofs": Holes()}


def by_balls(goal: Any, sample: list[arb], cells: int) -> Iterator[Proof]:
    """Cells of a box; symbols without ends have to stand in functions that are bounded."""
    names = player.symbols_of(goal.term).union(*map(player.symbols_of, goal.given))
    far = {n for n in names if goal.box[n].low is None or goal.box[n].high is None}
    if names and (not far or any(p[0] in player.SPANS and player.symbols_of(p) & far for p in subterms(goal.term))):
        yield {"rule": "balls", "bits": 64 if cells == CELLS[0] else 128, "cells": cells // 4}


by_few_balls, by_many_balls = (functools.partial(by_balls, cells=cells) for cells in CELLS)


def by_product(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """The signs of the factors."""
    factors = player.list_factors(goal.term)
    if not sample and goal.given:
        return  # nothing speaks against a wrong sign
    if len(factors) == 1 and factors[0][0] in ("+", "symbol", "number", "sin", "cos", "tan", "log", "atan"):
        return
    entries: list[Any] = []
    for factor in factors:
        base, q = (factor[1], player.constant_of(factor[2])) if factor[0] == "^" else (factor, fmpq(1))
        positive = factor[0] in ("exp", "cosh") or q is None or (q < 0 and (q.q > 1 or int(q) % 2 == 0))
        weak = q is not None and (q.q > 1 or int(q) % 2 == 0 or factor[0] in ("abs", "sqrt", "acos"))
        if factor[0] == "number" or positive or (weak and goal.relation == ">="):
            entries.append(None)
            continue
        values = values_of(goal, base) or [
            player.value_of(base, dict.fromkeys(goal.box, player.Jet(arb(0))))
        ]  # a guess
        sign = -1 if is_below(values) else 1
        if is_below(values, sign) and not weak and goal.relation != "!=":
            return
        entries.append([sign, Hole()])
    yield {"rule": "product", "factors": entries}


def by_sum(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Terms of one sign each."""
    terms = player.list_terms(goal.term)
    if len(terms) < 2 or goal.relation == "!=" or (goal.given and not sample):
        return
    values = [values_of(goal, term) for term in terms]
    if any(is_below(v) for v in values):
        yield from separate(goal, [*flatten(goal.term)])
        yield from split_slack(goal)
        return
    strict = [k for k, v in enumerate(values) if v and all(x > 0 for x in v)]
    strict.sort(key=lambda k: bool(player.symbols_of(terms[k])))  # numbers first
    for k in strict[:3] if goal.relation == ">" else [0]:
        yield {"rule": "sum", "proofs": Holes(), "strict": k}


def separate(goal: Any, terms: list[Term]) -> Iterator[Proof]:
    """The terms of each symbol for themselves, where no two have one in common; what remains above 0 is strict.

    A number is shared out so that each part is 0 where its symbols are, or at the end of its range where it is least.
    """
    groups: list[list[Term]] = []
    for term in terms:
        names = player.symbols_of(term)
        joined = [g for g in groups if names & player.symbols_of(join(g))]
        groups = [g for g in groups if g not in joined] + [[t for g in joined for t in g] + [term]]
    moving = [join(g) for g in groups if player.symbols_of(join(g))]
    rest = join([t for g in groups if not player.symbols_of(join(g)) for t in g] or [player.ZERO])
    is_below_zero = player.value_of(rest, {}) < 0
    at_zero = dict.fromkeys(player.symbols_of(join(terms)), player.ZERO)
    ways = [[player.substitute(part, at_zero) if is_below_zero else player.ZERO for part in moving]]
    if (least := [least_at_ends(part, goal.box) for part in moving]) and None not in least:
        ways.append(least)
    for values in ways if len(moving) > 1 else ():
        parts = [("+", part, player.negate(value)) for part, value in zip(moving, values, strict=True)]
        whole = ("+", *(("*", player.ONE, part) for part in (*parts, ("+", rest, *values))))
        proof: Proof = {"rule": "sum", "proofs": Holes(), "strict": len(moving)}
        yield {"rule": "equal", "to": write_term(whole), "defined": Holes(), "proof": proof}


def least_at_ends(term: Term, box: Any) -> Term | None:
    """The lesser value of a term in one symbol at the ends of its range; None where it has no two ends."""
    names = player.symbols_of(term)
    ends = [end for name in names for end in box[name][:2]]
    if len(names) != 1 or None in ends:
        return None
    low, high = (player.substitute(term, dict.fromkeys(names, end)) for end in ends)
    return high if player.value_of(player.subtract(low, high), {}) > 0 else low


def split_slack(goal: Any) -> Iterator[Proof]:
    """c P > Q with c > 1 by P > Q and (c - 1) P >= 0, for what the terms > 0 have as common factor c."""
    if not any(is_root(part) for part in subterms(goal.term)):
        return
    expression = sp.expand(to_sympy(goal.term))
    terms = expression.as_coefficients_dict()
    above = {t: c for t, c in terms.items() if c > 0 and not is_below(values_of(goal, player.parse(to_text(t))))}
    c = min(above.values(), default=sp.Integer(1))
    if c > 1 and len(above) < len(terms):
        rest = sp.Add(*((c - 1) / c * share * t for t, share in above.items()))
        to = f"1*({to_text(sp.expand(expression - rest))}) + ({to_text(sp.factor_terms(rest))})"
        proof: Proof = {"rule": "sum", "proofs": Holes(), "strict": 0}
        yield {"rule": "equal", "to": to, "defined": Holes(), "proof": proof}


def by_quadratic(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """The discriminant of a polynomial of degree two in a symbol."""
    if goal.relation == "!=":
        return
    expression = to_sympy(goal.term)
    for v in sorted(expression.free_symbols, key=str):
        if expression.is_polynomial(v) and sp.degree(expression, v) == 2:
            texts = [to_text(part) for part in sp.Poly(expression, v).all_coeffs()]
            yield {"rule": "quadratic", "symbol": v.name, "coefficients": texts, "defined": Holes(), "proofs": Holes()}


def by_corners(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """The corners of the box in the symbols of which the term is of degree one."""
    if goal.relation == "!=":
        return
    expression = to_sympy(goal.term)
    if len(expression.free_symbols) < len(player.symbols_of(goal.term)):  # 0 s
        yield {"rule": "equal", "to": to_text(expression), "defined": Holes(), "proof": Hole()}
    ends = {v: goal.box[v.name] for v in sorted(expression.free_symbols, key=str)}
    closed = [v for v, limit in ends.items() if limit.low is not None and limit.high is not None]
    names = [v.name for v in closed if expression.is_polynomial(v) and sp.degree(expression, v) == 1]
    if len(names) > MOST_CORNERS and all(len(t.free_symbols) < 2 for t in sp.Add.make_args(sp.expand(expression))):
        return  # corners double with each symbol, and the terms are separate
    for name in names:
        yield {"rule": "corners", "symbols": [name], "proofs": Holes()}


def by_squares(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """L > R by L >= 0 and L**2 > R**2: roots and absolute values."""
    if goal.relation == "!=" or not any(is_root(part) for part in subterms(goal.term)):
        return
    terms = player.list_terms(goal.term)
    if len(terms) < 2:
        return
    values = [values_of(goal, term) for term in terms]
    above = [t for t, v in zip(terms, values, strict=True) if not is_below(v)]
    rooted = [t for t in terms if any(is_root(part) for part in subterms(t))]
    for left in (above, rooted, [t for t in terms if t not in rooted]):
        right = [player.negate(t) for t in terms if t not in left]
        if left and right and not is_below(values_of(goal, join(left))):
            sides = (join(left), join(right))
            squares = sp.expand(to_sympy(sides[0]) ** 2 - to_sympy(sides[1]) ** 2)
            reduced: Proof = {"rule": "equal", "to": to_text(squares), "defined": Holes(), "proof": Hole()}
            proof = {"rule": "squares", "left": write_term(sides[0]), "right": write_term(sides[1]), "sign": 1}
            yield proof | {"defined": Holes(), "proofs": [reduced, Hole()]}


def by_slope(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Least at an end of the range of a symbol."""
    if goal.relation == "!=":
        return
    for name in sorted(player.symbols_of(goal.term)):
        limit = goal.box[name]
        slope = values_of(goal, player.differentiate(goal.term, name))
        for upper, end, is_open in ((0, limit.low, limit.open_low), (1, limit.high, limit.open_high)):
            if end is None or is_below(slope, -1 if upper else 1):
                continue
            ways: tuple[Any, ...] = (0,)
            if goal.relation == ">" and is_open:
                single = len(player.symbols_of(goal.term)) == 1
                ways = (0, write_term(player.number(simple_point(limit, 1))) if single else 1, 1)
            for strict in dict.fromkeys(ways):
                holes = {key: Holes() for key in ("continuous", "smooth")} | {"slope": Hole(), "floor": Hole()}
                yield {"rule": "slope", "symbol": name, "end": upper, "strict": strict, **holes}


def by_concavity(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Above its chord."""
    for name in sorted(player.symbols_of(goal.term)) if goal.relation == ">=" else ():
        limit = goal.box[name]
        if limit.low is None or limit.high is None:
            continue
        second = player.differentiate(player.differentiate(goal.term, name), name)
        if not is_below(values_of(goal, second), -1):
            holes = {"continuous": Holes(), "smooth": Holes(), "curve": Hole(), "floors": Holes()}
            yield {"rule": "concave", "symbol": name, **holes}


def by_cones(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A polynomial with coefficients >= 0 in variables that are compared with each other."""
    if goal.relation == "!=" or any(p[0] not in ("+", "*", "^", "number", "symbol") for p in subterms(goal.term)):
        return
    names = sorted(player.symbols_of(goal.term))
    if not 1 < len(names) <= 6:
        return
    terms = player.to_polynomial(goal.term, names)
    limits = [goal.box[n] for n in names]
    signs = [(1, -1) if r.low is None and r.high is None else (1,) for r in limits]
    budget, splits = [MOST_SPLITS], []
    for chosen in itertools.product(*signs):
        polynomial, _ = player.make_cone(terms, limits, chosen)
        splits.append(split_cone(polynomial, budget, 0))
        if splits[-1] is False:
            return
    yield {"rule": "cones", "splits": splits}


def split_cone(polynomial: fmpq_mpoly, budget: list[int], depth: int) -> Any:
    """The comparisons that leave no negative coefficient: null, a list, or False."""
    rows = polynomial.to_dict()
    negative = {powers: c for powers, c in rows.items() if c < 0}
    if not negative:
        return None
    budget[0] -= 1
    pair = choose_pair(rows, negative, depth)
    if budget[0] < 0 or depth > 12 or pair is None:
        return False
    variables, parts = polynomial.context().gens(), []
    for larger, smaller in (pair, pair[::-1]):
        moved = [v + variables[smaller] if k == larger else v for k, v in enumerate(variables)]
        parts.append(split_cone(polynomial.compose(*moved), budget, depth + 1))
        if parts[-1] is False:
            return False
    return [*pair, *parts]


def choose_pair(terms: dict[Any, Any], negative: dict[Any, Any], depth: int) -> tuple[int, int] | None:
    """The two variables to compare; None when a negative term has only one, so that nothing can mend it.

    Best are y_i, y_j with a negative term between two positive ones, as in y_i**2 - y_i y_j + y_j**2.
    """
    scores: dict[tuple[int, int], Any] = {}
    for exponents, value in negative.items():
        places = [i for i, e in enumerate(exponents) if e]
        if len(places) < 2:
            return None
        for pair in itertools.combinations(places, 2):
            framed = all(terms.get(shift_power(exponents, i, j), 0) > 0 for i, j in (pair, pair[::-1]))
            scores[pair] = scores.get(pair, 0) - (value if framed else 0)
    best = max(scores.values())
    ranked = sorted(pair for pair, score in scores.items() if score == best)
    return ranked[depth % len(ranked)]


def shift_power(exponents: Any, i: int, j: int) -> tuple[int, ...]:
    """One power moved from y_j to y_i."""
    return tuple(int(e) + (k == i) - (k == j) for k, e in enumerate(exponents))


def by_tails(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A range without an end: cut behind the last place where the slope of the term turns."""
    for name in sorted(player.symbols_of(goal.term)) if goal.relation != "!=" else ():
        limit = goal.box[name]
        if len(player.symbols_of(goal.term)) > 1 or not (limit.low is None or limit.high is None):
            continue
        slope = player.differentiate(goal.term, name)
        for sign in [s for s, end in ((1, limit.high), (-1, limit.low)) if end is None]:
            far = [sign * fmpq(2) ** k for k in range(-3, 8)]
            rises = [bool(player.value_of(slope, {name: player.Jet(arb(x))}) * sign > 0) for x in far]
            turns = [k for k, rise in enumerate(rises) if not rise]
            if turns and turns[-1] < len(far) - 2 and player.is_inside(player.number(far[turns[-1] + 1]), limit):
                yield {"rule": "split", "symbol": name, "at": str(far[turns[-1] + 1]), "proofs": Holes()}


def by_contacts(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A zero inside the range: the parts beside it one by one."""
    for name in sorted(player.symbols_of(goal.term)):
        limit = goal.box[name]
        for place in ("0", "1", "pi/2", "pi", "-1", "1/2", "2", "-pi/2", "exp(1)", "exp(-1)", "pi/4", "3"):
            value = player.parse(place)
            inside = limit._replace(open_low=True, open_high=True, nonzero=False)
            if not player.is_inside(value, inside):
                continue
            touching = player.value_of(goal.term, {name: player.Jet(player.value_of(value, {}))})
            if len(player.symbols_of(goal.term)) == 1 and not touching.contains(0) and place != "0":
                continue
            yield {"rule": "split", "symbol": name, "at": place, "proofs": Holes()}
            if place == "0":
                continue
            return


def by_logarithms(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A sum of logarithms by its exponential, where exponentials stand in logarithms only."""
    outside = list_outside(goal.term)
    if any(p[0] == "log" for p in outside) and not any(p[0] == "exp" for p in outside):
        yield {"rule": "exponential", "proof": Hole()}


def list_outside(term: Term) -> list[Term]:
    """The parts of a term, but for those inside logarithms."""
    return (
        [term] if term[0] == "log" else [term, *(p for x in term[1:] if isinstance(x, tuple) for p in list_outside(x))]
    )


POWER: Proof = {"rule": "product", "factors": [None]}  # a whole power of even exponent, or an exponential


def by_positive_radicand(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """sqrt(u) > 0 or != 0 where u > 0: its square is u, and it is >= 0."""
    if goal.term[0] == "sqrt" and goal.relation in (">", "!="):
        square: Proof = {"rule": "equal", "to": write_term(goal.term[1]), "defined": Holes(), "proof": Hole()}
        body = compare_squares(goal.term, square, POWER)
        yield body if goal.relation == ">" else {"rule": "side", "sign": 1, "proof": body}


def compare_squares(term: Term, above: Proof, side: Proof) -> Proof:
    """A term > 0 by its square, and because it is >= 0."""
    body: Proof = {"rule": "squares", "left": write_term(term), "right": "0", "sign": 1, "defined": Holes()}
    return body | {"proofs": [above, side]}


def invert_twice(term: Term, u: Term) -> Iterator[Proof]:
    """c u != 0 as c (u**(-1))**(-1), which is never 0."""
    (c, rest), (d, other) = to_sympy(term).as_coeff_Mul(), to_sympy(u).as_coeff_Mul()
    if rest == other and c != 0:
        proof: Proof = {"rule": "product", "factors": [None, None]}
        yield {"rule": "equal", "to": f"({c / d})*(({write_term(u)})**(-1))**(-1)", "defined": Holes(), "proof": proof}


def divide_by_fourth(u: Term) -> Proof:
    """v > 0 by v u**(-4) = u**(-2), for v = u**2."""
    powers = [write_term(("^", u, player.number(-n))) for n in (4, 2)]
    shorter: Proof = {"rule": "equal", "to": powers[1], "defined": Holes(), "proof": POWER}
    return {"rule": "multiply", "by": powers[0], "defined": Holes(), "positive": POWER, "proof": shorter}


def by_existence(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """The sign of u where something has a root or the logarithm of u, or is divided by u or by its root.

    u = sqrt(u)**2 >= 0 and u = exp(log(u)) > 0; divided by sqrt(u), u > 0; divided by u, u != 0, and > 0 where u >= 0.
    """
    own = player.set_union(map(player.conditions, goal.exists)) if player.symbols_of(goal.term) else ()
    for relation, u in own:
        inner = u[1] if relation == "!=" and u[0] == "sqrt" else u
        if not player.symbols_of(u) or (relation == ">=" and goal.relation != ">="):
            continue
        if relation == goal.relation == "!=":
            yield from invert_twice(goal.term, u)
        if player.is_identity(player.subtract(goal.term, inner)):
            if relation != "!=":
                form = ("exp", ("log", u)) if relation == ">" else ("^", ("sqrt", u), player.number(2))
                proof = POWER if goal.relation != "!=" else {"rule": "side", "sign": 1, "proof": POWER}
                yield {"rule": "equal", "to": write_term(form), "defined": Holes(), "proof": proof}
            elif inner is not u and goal.relation in (">", "!="):
                yield divide_by_fourth(u)
        sides = (u, player.negate(u)) if relation == "!=" and goal.relation == ">" else ()
        if any(player.is_identity(player.subtract(goal.term, side)) for side in sides):
            yield compare_squares(goal.term, divide_by_fourth(u), Hole())
