"""Goals, their terms and samples, and the second checker that plays the rules of a search."""

from __future__ import annotations

import functools
import importlib.util
import operator
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import Any

import sympy as sp
from flint import Ordering, arb, fmpq, fmpq_mpoly_ctx
from sympy.polys.polyerrors import BasePolynomialError
from sympy.polys.polyutils import dict_from_expr

from navsym import checker
from navsym.core.exact import to_fmpq, to_rational
from navsym.core.rational_functions import factor_exactly, polynomial_sum
from navsym.language.expression import parse, symbol
from navsym.language.printer import to_text

Term = tuple[Any, ...]
Proof = dict[str, Any]
Room = Callable[[Any, list[arb]], Iterator[Proof]]

X: Term = ("symbol", "x")
SHARES = (fmpq(1, 2), fmpq(1, 7), fmpq(12, 13), fmpq(1, 1000), fmpq(1, 3), fmpq(999, 1000))


class Hole(dict[str, Any]):
    """A proof that is still to be found."""


class Holes(list[Any]):
    """Proofs of premises whose number is not known yet."""


def abstract(terms: dict[str, str], ranges: dict[str, Any], to: str) -> Proof:
    """The rule that puts new numbers, by name, in the place of terms."""
    holes: Proof = {"inside": Holes(), "defined": Holes(), "proof": Hole()}
    return {"rule": "abstract", "terms": terms, "ranges": ranges, "to": to} | holes


def load_player() -> Any:
    """A second checker, which fills holes where the first would refuse them; it grants nothing."""
    spec = importlib.util.spec_from_file_location("navsym.prove.player", checker.__file__)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


player = load_player()
player.MOST_EFFORT = 30_000  # what takes longer is no candidate
MOST_KEPT = 1 << 14
#: The degree up to which polynomials are factored: exp(-10**12*x) is a power of exp(-x).
MOST_DEGREE = 1000


def keep_by_identity(function: Callable[[Term], Any]) -> Callable[[Term], Any]:
    """The function, computed once for each object: a cache by equality walks through all of a term each time."""
    known: dict[int, tuple[Term, Any]] = {}

    def answer(term: Term) -> Any:
        if id(term) not in known:
            if len(known) > MOST_KEPT:
                known.clear()
            known[id(term)] = (term, function(term))
        return known[id(term)][1]

    return answer


player.symbols_of = keep_by_identity(player.symbols_of.__wrapped__)
player.constant_of = keep_by_identity(player.constant_of.__wrapped__)


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
    known = {part: f"erf__{k}" for k, part in enumerate(dict.fromkeys(subterms(term))) if part[0] == "erf"}
    for part in [*reversed(known)]:  # the outer ones first
        term = player.replace(term, part, ("symbol", known[part]))
    result = parse(write_term(term), {name: symbol(name) for name in player.symbols_of(term)})
    values = {symbol(name): sp.erf(to_sympy(part[1])) for part, name in known.items()}
    return result.xreplace({letter: value for letter, value in values.items() if result.has(letter)})


def from_sympy(expression: sp.Expr) -> str:
    """The text of a candidate; erf is no function of files of numbers."""
    known = {part: symbol(f"erf__{k}") for k, part in enumerate(expression.atoms(sp.erf))}
    text = to_text(expression.xreplace(known)) if known else to_text(expression)
    for part, letter in known.items():
        text = text.replace(str(letter), f"erf({from_sympy(part.args[0])})")
    return text


def factor(expression: sp.Expr) -> sp.Expr:
    """The expression as a quotient of irreducible rational factors, in which functions and roots are letters."""
    result = sp.Integer(1)
    for part, sign in zip(sp.fraction(sp.together(expression)), (1, -1), strict=True):
        try:
            terms, letters = dict_from_expr(part)
        except BasePolynomialError:  # a number, or x - x, which nobody has expanded
            terms, letters = {}, ()
        is_plain = all(c.is_Rational and len(e) > 0 and max(e) <= MOST_DEGREE for e, c in terms.items())
        if not terms or not is_plain:
            result *= part**sign
            continue
        context = fmpq_mpoly_ctx.get([f"g{k}" for k in range(len(letters))], Ordering.lex)
        content, factors = factor_exactly(context.from_dict({powers: to_fmpq(c) for powers, c in terms.items()}))
        for polynomial, power in factors:
            result *= polynomial_sum(letters, polynomial) ** (sign * int(power))
        result *= to_rational(content) ** sign
    return result


def subterms(term: Term) -> Iterator[Term]:
    """The parts of a term, inner ones first."""
    for part in term[1:]:
        if isinstance(part, tuple):
            yield from subterms(part)
    yield term


#: The index of a root up to which it is taken away by powers; x**5.25588 is an exponential instead.
MOST_INDEX = 60


def index_of(part: Term) -> int:
    """2 for a square root, n for a power with exponent m/n, else 1."""
    if part[0] == "sqrt":
        return 2
    return int((player.constant_of(part[2]) or fmpq(1)).q) if part[0] == "^" else 1


def is_root(part: Term) -> bool:
    """Whether a term is a root or an absolute value."""
    return part[0] == "abs" or 1 < index_of(part) <= MOST_INDEX


def join(terms: Sequence[Term]) -> Term:
    """The sum of terms."""
    return terms[0] if len(terms) == 1 else ("+", *terms)


# Samples


def sample_goal(goal: Any, is_strict: bool = False) -> list[arb]:
    """Balls of the term at some points of the box at which it has a value and the hypotheses hold.

    None where something has to be 0: points of the box hardly meet that. ``is_strict`` leaves out ends that do not
    belong to a range, and points at which something else has no value.
    """
    within = (*goal.given, *(goal.exists if is_strict else ()))
    if list_bonds(goal.zeros, (goal.term, *within)):
        return []
    names = sorted(player.symbols_of(goal.term).union(*map(player.symbols_of, within)))
    values: list[arb] = []
    wanted = len(SHARES) + 4
    for k in range((4 * wanted if goal.given else wanted) if names else 1):
        if len(values) == wanted:
            break
        place = {name: player.Jet(inner_point(goal.box[name], k, i)) for i, name in enumerate(names)}
        if any(not ball_of(t, place) >= 0 for t in goal.given):
            continue
        value = ball_of(goal.term, place)
        if value.is_finite() and not (is_strict and is_outside(goal, place)):
            values.append(value)
    return values


def list_bonds(zeros: Sequence[Term], others: Sequence[Term]) -> list[Term]:
    """What has to be 0, without what only gives a symbol that stands nowhere else: u = sqrt(a**2 + 1)."""
    for k, zero in enumerate(zeros):
        rest = [*zeros[:k], *zeros[k + 1 :]]
        names = player.symbols_of(zero).difference(*map(player.symbols_of, (*rest, *others)))
        if any(player.constant_of(player.differentiate(zero, name)) for name in names):
            return list_bonds(rest, others)
    return [*zeros]


def ball_of(term: Term, place: dict[str, Any]) -> arb:
    """What the checker's ``value_of`` gives, in a quarter of the time: most parts are sums, products and symbols."""
    kind = term[0]
    if kind == "symbol":
        return place[term[1]].parts[0]
    if kind == "number":
        return arb(term[1])
    if kind in ("+", "*"):
        values = [ball_of(part, place) for part in term[1:]]
        return functools.reduce(operator.add if kind == "+" else operator.mul, values)
    if kind in ("sin", "cos", "exp"):
        return getattr(ball_of(term[1], place), kind)()
    if kind == "^" and term[2][0] == "number":
        return player.value_of(("^", X, term[2]), {"x": player.Jet(ball_of(term[1], place))})
    return player.value_of(term, place)


def is_outside(goal: Any, place: dict[str, Any]) -> bool:
    """Whether a point lies at an open end, or something has no value there."""
    for name, point in place.items():
        limit, value = goal.box[name], point.parts[0]
        ends = ((limit.low, limit.open_low), (limit.high, limit.open_high), (player.ZERO, limit.nonzero))
        if any(is_open and end is not None and value == player.value_of(end, {}) for end, is_open in ends):
            return True
    known = set(place)
    parts = (t for t in goal.exists if player.symbols_of(t) <= known)
    return not all(player.value_of(t, place).is_finite() for t in parts)


def vanishes(goal: Any) -> bool:
    """Whether a term that is to be no zero is 0 where all symbols are 0, or all are 1, or as near as ranges allow."""
    names = player.symbols_of(goal.term).union(*map(player.symbols_of, (*goal.given, *goal.exists)))
    for k in (0, 1) if goal.relation in (">", "!=") and not goal.zeros else ():
        place = {name: player.Jet(arb(simple_point(goal.box[name], k))) for name in names}
        is_there = ball_of(goal.term, place) == 0 and all(ball_of(t, place) >= 0 for t in goal.given)
        if is_there and not is_outside(goal, place):
            return True
    return False


def values_of(goal: Any, term: Term) -> list[arb]:
    """Balls of another term at the points of a goal.

    If they have both signs, and something exists for one sign of its parts only, those where all of it has a value.
    """
    values = sample_goal(goal._replace(term=term))
    if is_below(values) and is_below(values, -1):
        needed = player.set_union(map(player.conditions, goal.exists))
        if any(relation != "!=" for relation, _ in needed):
            return sample_goal(goal._replace(term=term), is_strict=True)
    return values


def fails(relation: str, value: arb) -> bool:
    """Whether the ball contradicts the relation."""
    return bool(player.FAILURES[relation](value))


def is_below(values: Sequence[arb], sign: int = 1) -> bool:
    """Whether some value is certainly below zero."""
    return any(value * sign < 0 for value in values)


# Points


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


@functools.lru_cache(maxsize=4096)
def as_term(value: Any) -> Term:
    """A coordinate of a point as a term: a rational number, or a term already."""
    return value if isinstance(value, tuple) else player.number(value)


def simple_point(limit: Any, k: int) -> fmpq:
    """A simple rational number in a range, if it is wide."""
    numbers = [fmpq(n, d) for d in (1, 2, 4, 10) for n in (0, 1, -1, 3, -3, 7)][k:]
    inside = next((n for n in numbers if player.is_inside(player.number(n), limit)), None)
    return inside if inside is not None else to_fmpq(inner_point(limit, k, 0).mid())


def draw_points(box: Any, count: int) -> Iterator[dict[str, fmpq]]:
    """Points of a box in rational numbers: simple ones first, then ones at which few things coincide."""
    for k in range(count):
        point = {}
        for i, (name, limit) in enumerate(box.items()):
            if k < count // 3:
                point[name] = simple_point(limit, (k + 2 * i * k) % max(6, count // 3))
            elif limit.low is None and limit.high is None and not limit.integer:
                number = fmpq(sp.prime(i + 2) + k, 1 + (k + i) % 7)
                point[name] = (number, 1 / number, -number, -1 / number)[(k + i // 2) % 4]
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
