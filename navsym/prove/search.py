"""Search for proofs that the checker accepts: a goal goes in, a proof comes out, or nothing.

Each room is a function of a goal that yields proofs by one rule of the checker, with holes where the premises stand.
A copy of the checker plays the rule and comes upon the goals of its premises itself, for which the search goes on. What
a room gets wrong is refused, so that a room which errs costs an answer, never a truth; adding one is adding a function.
"""

from __future__ import annotations

import functools
import importlib.util
import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
import scipy.optimize
import sympy as sp
from flint import arb, ctx, fmpq, fmpq_mpoly
from sympy.simplify.fu import TR8

from navsym import checker
from navsym.core.errors import NavsymError
from navsym.core.exact import to_fmpq
from navsym.language.expression import parse, symbol, to_text
from navsym.prove.signs.polynomials import choose_pair
from navsym.prove.signs.products import as_product

Term = tuple[Any, ...]
Proof = dict[str, Any]

#: Depths of proofs and numbers of rules that are tried, one after the other: the same on every machine. The time is a
#: net below.
ROUNDS = ((4, 80), (7, 200), (12, 400))
SECONDS = 30.0
CELLS = (120, 2500)
SHARES = (fmpq(1, 2), fmpq(1, 7), fmpq(12, 13), fmpq(1, 1000), fmpq(1, 3), fmpq(999, 1000))


class Hole(dict[str, Any]):
    """A proof that is still to be found."""


class Holes(list[Any]):
    """Proofs of premises whose number is not known yet."""


def load_player() -> Any:
    """A second checker, which fills holes where the first would refuse them; it grants nothing."""
    spec = importlib.util.spec_from_file_location("navsym.prove.player", checker.__file__)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


player = load_player()
player.MOST_EFFORT = 30_000  # what takes longer is no candidate
check_rule = player.prove


@dataclass(slots=True)
class Search:
    """One search: its limit of time, its depth, and the goals that were given up."""

    deadline: float
    tries: int
    most_depth: int
    depth: int = 0
    lost: dict[Any, int] = field(default_factory=dict)
    rules: list[str] = field(default_factory=list)

    def prove(self, proof: Any, goal: Any) -> None:
        """Fill a hole, or check what is no hole."""
        if not isinstance(proof, Hole):
            check_rule(proof, goal)
            return
        found = self.find(goal)
        player.require(found is not None, "no proof was found")
        proof.update(found or {})

    def prove_all(self, proofs: Any, goals: Sequence[Any]) -> None:
        """The same for a list."""
        if isinstance(proofs, Holes) and not proofs:
            for goal in goals:
                proofs.append(Hole())
                self.prove(proofs[-1], goal)
            return
        for proof, goal in zip(player.read_list(proofs, lambda entry: entry, len(goals)), goals, strict=True):
            self.prove(proof, goal)

    def find(self, goal: Any) -> Proof | None:
        """A proof of a goal, or None."""
        key = (goal.term, goal.relation, tuple(sorted(goal.box.items())), goal.given)
        left = self.most_depth - self.depth
        if left <= 0 or self.lost.get(key, -1) >= left or self.is_spent():
            return None
        self.lost[key] = left  # a goal among its own premises is none of them
        sample = sample_goal(goal)
        if not any(fails(goal.relation, value) for value in sample):
            self.depth += 1
            try:
                for room in EQUATIONS if goal.relation == "=" else SIGNS:
                    if room is by_forms and self.rules[-1:] == ["equal"]:
                        continue  # one form of a form is one of the first
                    if room is by_squares and self.rules.count("squares") > 1:
                        continue  # squares of squares of squares only grow
                    for candidate in guard(room(goal, sample)):
                        if self.is_spent():
                            return None
                        self.tries -= 1
                        if self.plays(candidate, goal):
                            del self.lost[key]
                            return candidate
            finally:
                self.depth -= 1
        return None

    def is_spent(self) -> bool:
        """Whether nothing more is to be tried."""
        return self.tries <= 0 or time.process_time() > self.deadline

    def plays(self, candidate: Proof, goal: Any) -> bool:
        """Whether the rule of a candidate applies and its holes can be filled."""
        self.rules.append(candidate["rule"])
        try:
            check_rule(candidate, goal)
        except (player.Refused, ZeroDivisionError, ArithmeticError, ValueError, KeyError, TypeError, RecursionError):
            return False
        finally:
            self.rules.pop()
        return True


def guard(candidates: Iterator[Proof]) -> Iterator[Proof]:
    """The candidates of a room; one that fails while it thinks has no more."""
    try:
        yield from candidates
    except (NavsymError, player.Refused, ArithmeticError, ValueError, TypeError, AttributeError, NotImplementedError):
        return


def find_proof(goal: Any, seconds: float = SECONDS) -> Proof | None:
    """A proof of a goal of the checker as plain data, or None; it is still to be granted."""
    before, deadline = (ctx.prec, ctx.cap), time.process_time() + seconds
    ctx.prec = 128
    try:
        for depth, tries in ROUNDS:
            search = Search(deadline, tries, depth)
            player.prove, player.prove_all = search.prove, search.prove_all
            found = search.find(goal)
            if found is not None:
                return plain(found)
        return None
    finally:
        ctx.prec, ctx.cap = before
        player.prove = check_rule


def plain(proof: Any) -> Any:
    """The same without the classes of holes."""
    if isinstance(proof, dict):
        return {key: plain(value) for key, value in proof.items()}
    return [plain(value) for value in proof] if isinstance(proof, list) else proof


# Terms


def write_term(term: Term) -> str:
    """Text that is read back as the same term."""
    match term:
        case ("number", q):
            return write_number(q)
        case ("pi",):
            return "pi"
        case ("symbol", name):
            return str(name)
        case ("+", *terms):
            return f"({' + '.join(map(write_term, terms))})"
        case ("*", *factors):
            return f"({'*'.join(map(write_term, factors))})"
        case ("^", base, exponent):
            return f"({write_term(base)}**{write_term(exponent)})"
        case (name, *arguments):
            return f"{name}({', '.join(map(write_term, arguments))})"
    raise ValueError(term)


def write_number(q: fmpq) -> str:
    """A number as one token where it is a decimal, else as a quotient."""
    top, bottom, places = abs(int(q.p)), int(q.q), 0
    while bottom % 2 == 0 or bottom % 5 == 0:
        bottom = bottom // 2 if bottom % 2 == 0 else bottom // 5
        places += 1
    if bottom != 1:
        return f"({q.p}/{q.q})"
    digits = str(top * 10**places // int(q.q)).rjust(places + 1, "0")
    text = f"{digits[:-places]}.{digits[-places:]}" if places else digits
    return f"(-{text})" if q < 0 else text


@functools.lru_cache(maxsize=4096)
def to_sympy(term: Term) -> sp.Expr:
    """The term for the algebra system, all symbols real: a source of candidates."""
    return parse(write_term(term), {name: symbol(name) for name in player.symbols_of(term)})


def subterms(term: Term) -> Iterator[Term]:
    """The parts of a term, inner ones first."""
    for part in term[1:]:
        if isinstance(part, tuple):
            yield from subterms(part)
    yield term


# Samples


def sample_goal(goal: Any) -> list[arb]:
    """Balls of the term at some points of the box at which all has a value and the hypotheses hold."""
    names = sorted(player.symbols_of(goal.term).union(*map(player.symbols_of, goal.given)))
    values = []
    for k in range(len(SHARES) + 4 if names else 1):
        place = {name: player.Jet(inner_point(goal.box[name], k, i)) for i, name in enumerate(names)}
        if any(not player.value_of(t, place) >= 0 for t in goal.given):
            continue
        value = player.value_of(goal.term, place)
        if value.is_finite():
            values.append(value)
    return values


def inner_point(limit: Any, k: int, i: int) -> arb:
    """The k-th point of a range for the i-th symbol."""
    share = SHARES[(k + i * (k // 2)) % len(SHARES)]
    low, high = (None if end is None else player.value_of(end, {}).mid() for end in (limit.low, limit.high))
    if limit.integer:
        return arb(int(float(low if low is not None else -3 if high is None else high - 5)) + k)
    if low is not None and high is not None:
        return arb(low + (high - low) * share)
    far = arb(share / (1 - share))
    return low + far if low is not None else high - far if high is not None else far - arb(2) / 3


def fails(relation: str, value: arb) -> bool:
    """Whether the ball contradicts the relation."""
    return bool(player.FAILURES[relation](value))


def is_below(values: Sequence[arb], sign: int = 1) -> bool:
    """Whether some value is certainly below zero."""
    return any(value * sign < 0 for value in values)


def values_of(goal: Any, term: Term) -> list[arb]:
    return sample_goal(goal._replace(term=term))


# Rooms of equations

Room = Callable[[Any, list[arb]], Iterator[Proof]]


def by_algebra(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Both sides have one normal form."""
    yield {"rule": "identity"}


def by_values(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """An absolute value by its two cases."""
    for part in dict.fromkeys(p for p in subterms(goal.term) if p[0] == "abs"):
        if not any(p[0] == "abs" for p in subterms(part[1])):
            yield {"rule": "cases", "of": write_term(part[1]), "proofs": Holes()}
            return


def by_modulus(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """sqrt(u) and |u| as what they are where its sign is known."""
    for part in dict.fromkeys(p for p in subterms(goal.term) if p[0] in ("sqrt", "abs", "^")):
        if part[0] == "^" and not (player.constant_of(part[2]) or fmpq(1)).q > 1:
            continue
        inside = to_sympy(part[1])
        power = sp.Integer(1) if part[0] == "abs" else sp.Rational(1, 2)
        power = power if part[0] != "^" else sp.Rational(str(player.constant_of(part[2])))
        root = inside if part[0] == "abs" else sp.powdenest(sp.sqrt(sp.factor(inside)) ** (2 * power), force=True)
        if root.has(sp.Pow) and any(not p.exp.is_Integer for p in root.atoms(sp.Pow)):
            continue
        text = to_text(root)
        for value in (text, f"-({text})"):
            if not is_below(values_of(goal, player.parse(value))):
                yield rewrite_atom(write_term(part), value)


def rewrite_atom(atom: str, value: str) -> Proof:
    """The rule that puts a value in the place of an inverse function."""
    return {"rule": "rewrite", "from": atom, "to": value, "defined": Holes(), "proof": Hole()} | {
        "equal": solve_for(atom, value)
    }


def solve_for(atom: str, value: str, share: str = "1") -> Proof:
    """The rule that an inverse function has a value."""
    holes: Proof = {"defined": Holes(), "proofs": Holes()}
    return {"rule": "solve", "share": share, "atom": atom, "value": value} | holes


def by_logarithms_of_products(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Logarithms as sums over the factors of what they are of; symbolic powers as exponentials first."""
    powers = [p for p in subterms(goal.term) if p[0] == "^" and player.constant_of(p[2]) is None]
    if powers:
        term = goal.term
        for part in dict.fromkeys(powers):
            term = player.replace(term, part, ("exp", ("*", part[2], ("log", part[1]))))
        yield {"rule": "equal", "to": write_term(term), "defined": Holes(), "proof": Hole()}
    for part in dict.fromkeys(p for p in subterms(goal.term) if p[0] == "log"):
        own = to_sympy(part)
        spread = sp.expand_log(sp.log(sp.factor(own.args[0])) if own.args else own, force=True)
        if spread != own:
            yield rewrite_atom(write_term(part), to_text(spread))
            return


def by_values_of_constants(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """An inverse function of a number as the number that the algebra system has for it: acos(0) = pi/2."""
    for part in dict.fromkeys(p for p in subterms(goal.term) if p[0] in ("asin", "acos", "atan", "log", "atan2")):
        value = sp.S.NaN if player.symbols_of(part) else to_sympy(part)
        if value.is_number and value.is_finite and not value.has(sp.asin, sp.acos, sp.atan, sp.log, sp.atan2):
            yield rewrite_atom(write_term(part), to_text(value))
            return


def by_inverse(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """The equation solved for an inverse function, and the definition of that."""
    expression = to_sympy(goal.term)
    atoms = {to_text(atom): atom for atom in expression.atoms(sp.log, sp.asin, sp.acos, sp.atan, sp.atan2, sp.Abs)}
    roots = {to_text(p): p for p in expression.atoms(sp.Pow) if p.exp.is_Rational and p.exp.q > 1}
    own = {**atoms, **roots}
    for text, atom in sorted(own.items(), key=lambda pair: -len(pair[0])):
        rest = sp.expand_mul(expression)
        share = rest.coeff(atom)
        value = sp.expand_mul(atom - rest / share) if share.is_Rational and share != 0 else None
        if value is None or value.has(atom):
            continue
        yield solve_for(text, to_text(value), str(share))


def by_equal_squares(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Equal squares of two sides of one sign."""
    terms = player.list_terms(goal.term)
    if len(terms) < 2 or not any(p[0] in ("sqrt", "abs", "^") for p in subterms(goal.term)):
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
            yield {"rule": "split", "symbol": names[0], "at": "0", "proofs": Holes()}


def by_gradient(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Derivatives that vanish, and one value."""
    names = sorted(player.symbols_of(goal.term))
    if not names:
        return
    for k in range(3):
        point = {name: str(simple_point(goal.box[name], k)) for name in names}
        yield {"rule": "derivative", "point": point, "value": Hole(), "slopes": Holes(), "defined": Holes()}


def simple_point(limit: Any, k: int) -> fmpq:
    """A simple rational number in a range, if it is wide."""
    numbers = [fmpq(n, d) for d in (1, 2, 4, 10) for n in (0, 1, -1, 3, -3, 7)][k:]
    inside = [n for n in numbers if player.is_inside(player.number(n), limit)]
    return inside[0] if inside else to_fmpq(inner_point(limit, k, 0).mid())


def draw_points(box: Any, count: int) -> Iterator[dict[str, fmpq]]:
    """Points of a box in rational numbers: simple ones first, then ones at which few things coincide."""
    for k in range(count):
        point = {}
        for i, (name, limit) in enumerate(box.items()):
            if k < count // 3:
                point[name] = simple_point(limit, (k + 2 * i * k) % 6)
            elif limit.low is None and limit.high is None and not limit.integer:
                point[name] = fmpq(sp.prime(i + 2) + k, 1 + (k + i) % 7)
            else:
                point[name] = short_number(inner_point(limit, k, i), limit)
        if all(player.is_inside(player.number(value), box[name]) for name, value in point.items()):
            yield point


def short_number(ball: arb, limit: Any) -> fmpq:
    """A short fraction near a ball in the range, else the middle of the ball."""
    middle = Fraction(str(to_fmpq(ball.mid())))
    for size in (1, 10, 1000, 10**6):
        near = middle.limit_denominator(size)
        q = fmpq(near.numerator, near.denominator)
        if player.is_inside(player.number(q), limit):
            return q
    return to_fmpq(ball.mid())


# Rooms of signs


def by_number(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Numbers by a ball, or because they are zero."""
    if player.symbols_of(goal.term):
        return
    for bits in (64, 256, 2048):
        yield {"rule": "balls", "bits": bits, "cells": 1}
    if goal.relation == ">=":
        yield {"rule": "zero", "proof": Hole()}


def by_identity(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Zero, or a hypothesis."""
    if goal.relation == ">=" and all(value.contains(0) for value in sample):
        yield {"rule": "identity"}
    if goal.relation == ">=":
        weights = find_weights(goal)
        if weights is not None:
            yield {"rule": "given", "weights": weights}


def find_weights(goal: Any) -> list[str] | None:
    """Weights >= 0 of the hypotheses that may add up to the term: least squares over the coefficients."""
    if not goal.given:
        return None
    forms = [sp.expand(to_sympy(t)).as_coefficients_dict() for t in (goal.term, *goal.given)]
    monomials = list(dict.fromkeys(m for form in forms for m in form))
    rows = [[float(form.get(m, 0)) for m in monomials] for form in forms]
    weights, rest = scipy.optimize.nnls(np.transpose(rows[1:]), np.array(rows[0]))
    return [str(Fraction(w).limit_denominator(1000)) for w in weights] if rest < 1e-9 else None


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


def by_few_balls(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    yield from by_balls(goal, CELLS[0])


def by_many_balls(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    yield from by_balls(goal, CELLS[1])


def by_balls(goal: Any, cells: int) -> Iterator[Proof]:
    """Cells of a bounded box."""
    names = player.symbols_of(goal.term).union(*map(player.symbols_of, goal.given))
    if names and all(goal.box[n].low is not None and goal.box[n].high is not None for n in names):
        yield {"rule": "balls", "bits": 64, "cells": cells // 4}


def by_product(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """The signs of the factors."""
    factors = player.list_factors(goal.term)
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
        values = values_of(goal, base)
        sign = -1 if is_below(values) else 1
        if is_below(values, sign) and not weak and goal.relation != "!=":
            return
        entries.append([sign, Hole()])
    yield {"rule": "product", "factors": entries}


def by_sum(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """Terms of one sign each."""
    terms = player.list_terms(goal.term)
    if len(terms) < 2 or goal.relation == "!=":
        return
    values = [values_of(goal, term) for term in terms]
    if any(is_below(v) for v in values):
        return
    strict = [k for k, v in enumerate(values) if v and all(x > 0 for x in v)]
    for k in strict[:3] if goal.relation == ">" else [0]:
        yield {"rule": "sum", "proofs": Holes(), "strict": k}


def by_forms(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """The term written otherwise: as a product, as one fraction, expanded."""
    for text in list_forms(goal.term):
        yield {"rule": "equal", "to": text, "defined": Holes(), "proof": Hole()}


@functools.lru_cache(maxsize=4096)
def list_forms(term: Term) -> tuple[str, ...]:
    """Texts of other forms of a term."""
    expression, own, forms = to_sympy(term), write_term(term), dict[str, None]()
    for rewrite in FORMS:
        try:
            other = rewrite(expression)
            text = to_text(other) if other is not None else own
        except (NavsymError, ArithmeticError, ValueError, TypeError, AttributeError, NotImplementedError, KeyError):
            continue
        if player.parse(text) != term and len(text) < 6 * len(own) + 200:
            forms[text] = None
    return tuple(forms)


FORMS: tuple[Callable[[sp.Expr], sp.Expr | None], ...] = (
    as_product,
    lambda e: sp.factor(e),
    sp.factor_terms,
    lambda e: sp.expand(e),
    lambda e: sp.factor(sp.together(e)),
    lambda e: sp.expand(TR8(sp.expand(e))) if e.has(sp.sin, sp.cos) else None,
    lambda e: sp.factor(sp.together(sp.expand_trig(e))) if e.has(sp.atan, sp.asin, sp.acos) else None,
    lambda e: complete_square(e),
)


def complete_square(expression: sp.Expr) -> sp.Expr | None:
    """a v**2 + b v + c as a (v + b/(2 a))**2 + rest, for the first symbol of degree two."""
    for v in sorted(expression.free_symbols, key=str):
        if expression.is_polynomial(v) and sp.degree(expression, v) == 2:
            a, b, c = sp.Poly(expression, v).all_coeffs()
            return a * (v + b / (2 * a)) ** 2 + sp.factor(c - b**2 / (4 * a))
    return None


def by_quadratic(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """The discriminant of a polynomial of degree two in a symbol."""
    if goal.relation == "!=":
        return
    expression = to_sympy(goal.term)
    for v in sorted(expression.free_symbols, key=str):
        if expression.is_polynomial(v) and sp.degree(expression, v) == 2:
            texts = [to_text(part) for part in sp.Poly(expression, v).all_coeffs()]
            yield {"rule": "quadratic", "symbol": v.name, "coefficients": texts} | {
                "defined": Holes(), "proofs": Holes()
            }  # fmt: skip


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
            yield {"rule": "squares", "left": write_term(join(left)), "right": write_term(join(right)), "sign": 1} | {
                "defined": Holes(), "proofs": Holes()
            }  # fmt: skip


def is_root(part: Term) -> bool:
    """Whether a term is a root or an absolute value."""
    return part[0] in ("sqrt", "abs") or (part[0] == "^" and (player.constant_of(part[2]) or fmpq(1)).q > 1)


def join(terms: Sequence[Term]) -> Term:
    return terms[0] if len(terms) == 1 else ("+", *terms)


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
            for strict in (0, 1) if goal.relation == ">" and is_open else (0,):
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


#: Comparisons of variables in one proof by cones.
MOST_SPLITS = 300


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


def by_contacts(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A zero inside the range: the parts beside it one by one."""
    for name in sorted(player.symbols_of(goal.term)):
        limit = goal.box[name]
        for place in ("0", "1", "pi/2", "pi", "-1", "1/2", "2", "-pi/2", "exp(1)", "exp(-1)", "pi/4", "3"):
            value = player.parse(place)
            inside = limit._replace(open_low=True, open_high=True)
            if not player.is_inside(value, inside):
                continue
            touching = player.value_of(goal.term, {name: player.Jet(player.value_of(value, {}))})
            if len(player.symbols_of(goal.term)) == 1 and not touching.contains(0) and place != "0":
                continue
            yield {"rule": "split", "symbol": name, "at": place, "proofs": Holes()}
            if place == "0":
                continue
            return


def by_substitution(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """One number u in the place of an exponential, a root, or the tangent of a half angle."""
    expression = to_sympy(goal.term)
    u = sp.Symbol("u_", real=True)
    name = "u"
    while name in goal.box:
        name += "u"
    new = symbol(name)
    for make in (by_exponentials, by_root, by_tangent):
        for term, form, low, dense in make(expression, u):
            body: Proof = {"rule": "abstract", "terms": {name: to_text(term)}, "ranges": {name: [low, None, []]}}
            body |= {"to": to_text(sp.factor(form.xreplace({u: new}))), "inside": Holes(), "defined": Holes()}
            body |= {"proof": Hole()}
            if dense is None:
                yield body
            elif goal.relation == ">=":
                point = {s.name: "1/7" for s in dense.free_symbols}
                outer = {"rule": "dense", "except": to_text(dense), "point": point, "defined": Holes(), "proof": body}
                yield outer


Form = tuple[sp.Expr, sp.Expr, str | None, sp.Expr | None]


def by_exponentials(expression: sp.Expr, u: sp.Symbol) -> Iterator[Form]:
    """u = exp(x/d)."""
    hyper = expression.rewrite(sp.exp) if expression.has(sp.sinh, sp.cosh, sp.tanh) else expression
    arguments = [node.args[0] for node in hyper.atoms(sp.exp)]
    symbols = {s for a in arguments for s in a.free_symbols}
    if len(symbols) != 1:
        return
    (x,) = symbols
    shares = [sp.expand(a / x) for a in arguments]
    if not all(s.is_Rational for s in shares):
        return
    d = sp.ilcm(*(s.q for s in shares))
    step = sp.igcd(*(int(s * d) for s in shares))
    powers = {node: u ** sp.Rational(s * d, step) for node, s in zip(hyper.atoms(sp.exp), shares, strict=False)}
    powers = {node: u ** (sp.expand(node.args[0] / x) * d / step) for node in hyper.atoms(sp.exp)}
    form = hyper.xreplace(powers)
    if not form.has(x):
        yield sp.exp(x * sp.Rational(step, d)), form, "0", None


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
    q = sp.ilcm(*(p.exp.q for p in roots))
    a, b = base.subs(x, 0), sp.diff(base, x)
    form = expression.xreplace({p: u ** (p.exp * q) for p in roots}).subs(x, (u**q - a) / b)
    yield sp.Pow(base, sp.Rational(1, q)), form, "0", None


def by_tangent(expression: sp.Expr, u: sp.Symbol) -> Iterator[Form]:
    """u = tan(x/(2 d)) for the one angle of which all others are multiples."""
    waves = expression.atoms(sp.sin, sp.cos)
    symbols = {s for node in waves for s in node.free_symbols}
    if len(symbols) != 1:
        return
    (x,) = symbols
    shares = {node: sp.expand(node.args[0] / x) for node in waves}
    if not all(s.is_Rational for s in shares.values()):
        return
    d = sp.ilcm(*(s.q for s in shares.values()))
    step = sp.igcd(*(int(s * d) for s in shares.values()))
    turns = {node: int(s * d) // step for node, s in shares.items()}
    if max(map(abs, turns.values())) > 8:
        return
    cosine, sine = (1 - u**2) / (1 + u**2), 2 * u / (1 + u**2)
    values = {node: (sp.chebyshevt(abs(n), cosine) if node.func is sp.cos else
                     sp.sign(n) * sine * sp.chebyshevu(abs(n) - 1, cosine)) for node, n in turns.items()}  # fmt: skip
    form = expression.xreplace(values)
    if not form.has(x):
        half = x * sp.Rational(step, 2 * d)
        yield sp.tan(half), form, None, sp.cos(half)


def by_logarithms(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A sum of logarithms by its exponential."""
    if any(p[0] == "log" for p in subterms(goal.term)) and not any(p[0] == "exp" for p in subterms(goal.term)):
        yield {"rule": "exponential", "proof": Hole()}


EQUATIONS: tuple[Room, ...] = (
    by_algebra,
    by_values,
    by_modulus,
    by_logarithms_of_products,
    by_values_of_constants,
    by_inverse,
    by_equal_squares,
    by_sides_of_zero,
    by_gradient,
)
SIGNS: tuple[Room, ...] = (
    by_number, by_identity, by_range, by_roots, by_bounds, by_few_balls, by_values, by_product, by_sum, by_side,
    by_squares, by_slope, by_cones, by_forms, by_quadratic, by_substitution, by_concavity, by_contacts, by_modulus,
    by_logarithms,
    by_many_balls,
)  # fmt: skip
