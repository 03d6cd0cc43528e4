"""A room that puts one number in the place of a part of a term, with the range that the part has.

Nothing is lost where the symbols of the part stand nowhere else and its range is known: exp(-exp(-x)) < 1 for all x
becomes exp(u) < 1 for u < 0. A linear part may leave fewer symbols even where they stand elsewhere: in
exp(x + y) >= 1 + x + y all of x + y is u.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import sympy as sp
from flint import arb

from navsym.language.expression import symbol, to_text
from navsym.prove.rooms.goals import Proof, Term, abstract, player, subterms, to_sympy, write_term

#: Parts that are tried for one goal, and parts of a term up to which they are sought.
MOST_PARTS, MOST_TERMS = 8, 120
RISING = {
    "exp": (player.ZERO, None),
    "log": (None, None),
    "sqrt": (None, None),
    "sinh": (None, None),
    "asin": (None, None),
    "tanh": (player.MINUS_ONE, player.ONE),
    "atan": (player.parse("-pi/2"), player.parse("pi/2")),
    "erf": (player.MINUS_ONE, player.ONE),
}


class Span(NamedTuple):
    """The values of a term: between two terms without symbols, None at infinity; which ends do not belong to them."""

    low: Term | None
    high: Term | None
    open_low: bool = False
    open_high: bool = False

    def raise_by(self, function: Callable[[Term], Term]) -> Span:
        """The span of a rising function that has no limit at infinity."""
        low, high = (None if end is None else fold(function(end)) for end in (self.low, self.high))
        return Span(low, high, self.open_low, self.open_high)

    def turn(self) -> Span:
        """The span of the negative."""
        low, high, *flags = self.raise_by(player.negate)
        return Span(high, low, *reversed(flags))

    def write(self) -> list[Any]:
        """The range of a new symbol."""
        flags = [word for word, is_open in zip(("open-low", "open-high"), self[2:], strict=True) if is_open]
        return [*(None if end is None else write_term(end) for end in self[:2]), flags]


WHOLE = Span(None, None)
#: What is known of a function whatever it is taken of.
OUTER = {"sqrt": Span(player.ZERO, None), "abs": Span(player.ZERO, None), "cosh": Span(player.ONE, None)}
OUTER |= {"sin": Span(player.MINUS_ONE, player.ONE), "cos": Span(player.MINUS_ONE, player.ONE)}


def by_letters(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A number u in the place of a part that alone has its symbols: larger parts first."""
    for part, name in choose_parts(goal):
        form = player.replace(goal.term, part, ("symbol", name))
        is_lonely = not player.symbols_of(form) & player.symbols_of(part)
        is_bent = is_lonely and player.symbols_of(player.differentiate(form, name))
        known = {} if goal.relation == "=" else OUTER
        span = find_span(part, goal.box) or known.get(part[0]) if is_bent else None
        if span is not None:  # of u + c the sign is as hard as that of the part
            if any(p in (("asin", part), ("acos", part)) for p in subterms(goal.term)):
                span = cut_to_sine(span)
            yield abstract({name: write_term(part)}, {name: span.write()}, write_term(form))


def cut_to_sine(span: Span) -> Span:
    """The part of a span that an inverse sine takes."""
    low, high = (None if end is None else player.value_of(end, {}) for end in (span.low, span.high))
    if low is None or low < -1:
        span = span._replace(low=player.MINUS_ONE, open_low=False)
    return span._replace(high=player.ONE, open_high=False) if high is None or high > 1 else span


def by_common_parts(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A number u in the place of a sum whose symbols stand elsewhere too, where fewer of them remain."""
    for part, name in choose_parts(goal):
        form = player.replace(goal.term, part, ("symbol", name))
        linear, u = to_sympy(part) if part[0] == "+" else sp.S.Zero, symbol(name)
        for v in map(symbol, sorted(player.symbols_of(form) & player.symbols_of(part))):
            c = linear.coeff(v)
            rest = sp.expand(linear - c * v)
            if not (c.is_Rational and c != 0) or v in rest.free_symbols:
                continue
            shorter = sp.expand(to_sympy(form).xreplace({v: (u - rest) / c}))
            if measure(shorter) < measure(to_sympy(goal.term)):
                span = find_span(part, goal.box) or WHOLE
                yield abstract({name: write_term(part)}, {name: span.write()}, to_text(shorter))
                break


def choose_parts(goal: Any) -> Iterator[tuple[Term, str]]:
    """Parts of a term that are no symbols, numbers or multiples of a part, larger ones first, with a new name.

    Of symbols in hypotheses there are none: the letter would not know of them.
    """
    bound = set(player.set_union(map(player.symbols_of, (*goal.given, *goal.zeros))))
    parts = [*dict.fromkeys(subterms(goal.term))][:-1]

    def is_worth(part: Term) -> bool:
        names = player.symbols_of(part)
        return part[0] != "symbol" and bool(names) and not names & bound and not gains_nothing(part)

    name = "u"
    while name in goal.box:
        name += "u"
    for part in itertools.islice(filter(is_worth, reversed(parts if len(parts) <= MOST_TERMS else [])), MOST_PARTS):
        yield part, name


def gains_nothing(part: Term) -> bool:
    """Whether a term is a number times something, or a fraction beside a symbol: a letter for that gains as much."""
    parts = player.list_factors(part) if part[0] == "*" else player.list_terms(part)
    moving = [p for p in parts if player.symbols_of(p)]
    if part[0] == "*":
        return len(moving) == 1
    is_shift = len(moving) == 1 and moving[0][0] == "symbol"
    return is_shift and all(p in moving or player.constant_of(p) is not None for p in parts)


def measure(expression: sp.Expr) -> tuple[int, int]:
    """How many symbols and how many irrational numbers an expression has."""
    return len(expression.free_symbols), count_numbers(expression)


def count_numbers(expression: sp.Expr) -> int:
    """Irrational numbers in an expression."""
    return sum(1 for part in sp.preorder_traversal(expression) if part.is_number and not part.is_Rational)


# Ranges of terms


def fold(end: Term) -> Term:
    """A rational number as one, any other term as it is; the algebra of the player takes no root of 0."""
    if end[0] in ("^", "abs") and end[1] == player.ZERO:
        return player.ZERO
    value = player.constant_of(end)
    return end if value is None else player.number(value)


def find_span(term: Term, box: Any) -> Span | None:
    """The values that a term takes, where each symbol stands in it once and it is made of simple steps; else None."""
    if not player.symbols_of(term):
        return Span(fold(term), fold(term))
    kind = term[0]
    if kind == "symbol":
        return Span(*box[term[1]][:4])
    if kind in ("+", "*"):
        return span_of_sum(term, box) if kind == "+" else span_of_product(term, box)
    if kind == "^":
        return span_of_power(term, box)
    inner = find_span(term[1], box)
    if inner is None or any(end is not None and player.constant_of(end) is None for end in inner[:2]):
        return None  # values at ends that are no fractions are long to compare
    if kind in ("sin", "cos"):
        return Span(player.MINUS_ONE, player.ONE) if None in inner[:2] else None
    if kind in ("cosh", "abs"):
        return fold_at_zero(inner, lambda end: (kind, end))
    return raise_ends(kind, inner) if kind in RISING else None


def span_of_sum(term: Term, box: Any) -> Span | None:
    """The sum of spans of terms without common symbols."""
    spans, seen = [], set[str]()
    for part in player.list_terms(term):
        span = None if player.symbols_of(part) & seen else find_span(part, box)
        if span is None:
            return None
        seen |= player.symbols_of(part)
        spans.append(span)
    lows, highs, *flags = zip(*spans, strict=True)
    low, high = (None if None in ends else fold(("+", *ends)) for ends in (lows, highs))
    return Span(low, high, *map(any, flags))


def span_of_product(term: Term, box: Any) -> Span | None:
    """A multiple of a span by a number of known sign, or a product of symbols of one sign or without bounds."""
    factors = player.list_factors(term)
    moving = [f for f in factors if player.symbols_of(f)]
    share = ("*", player.ONE, *(f for f in factors if f not in moving))
    inner: Span | None
    names, value = [f[1] for f in moving if f[0] == "symbol"], player.value_of(share, {})
    if len(moving) > 1 and len(set(names)) == len(moving):
        limits = [Span(*box[name][:4]) for name in names]
        is_above = all(s.low == player.ZERO and s.high is None for s in limits)
        if not is_above and any(s[:2] != (None, None) for s in limits):
            return None
        inner = Span(player.ZERO, None, all(s.open_low for s in limits)) if is_above else WHOLE
    else:
        inner = find_span(moving[0], box) if len(moving) == 1 else None
    if inner is None or not (value > 0 or value < 0):
        return None
    if value < 0:
        inner, share = inner.turn(), player.negate(share)
    return inner.raise_by(lambda end: ("*", share, end))


def span_of_power(term: Term, box: Any) -> Span | None:
    """An even power of anything, an odd one, and a broken one above 0."""
    inner, q = find_span(term[1], box), player.constant_of(term[2])
    if inner is None or q is None or q <= 0:
        return None

    def power(end: Term) -> Term:
        return ("^", end, term[2])

    if q.q == 1 and int(q) % 2 == 0:
        return fold_at_zero(inner, power)
    if q.q > 1 and (inner.low is None or player.value_of(inner.low, {}) < 0):
        inner = inner._replace(low=player.ZERO, open_low=False)
    return inner.raise_by(power)


def raise_ends(kind: str, inner: Span) -> Span:
    """The span of a rising function: its values at the ends, its limits at infinity."""
    if kind == "sqrt" and (inner.low is None or player.value_of(inner.low, {}) < 0):
        inner = inner._replace(low=player.ZERO, open_low=False)
    sides = zip(RISING[kind], inner[:2], inner[2:], strict=True)
    (low, open_low), (high, open_high) = (raise_end(kind, limit, *side) for limit, *side in sides)
    return Span(low, high, open_low, open_high)


def raise_end(kind: str, limit: Term | None, end: Any, is_open: Any) -> tuple[Term | None, bool]:
    """One end, and whether it is left out; the limit where the value hardly differs from it."""
    if end is None:
        return limit, limit is not None
    if end == player.ZERO and kind != "log":
        return player.ONE if kind == "exp" else player.ZERO, is_open
    value = (kind, end)
    is_far = limit is not None and player.value_of(player.subtract(value, limit), {}).contains(0)
    return (limit, True) if is_far else (value, is_open)


def fold_at_zero(inner: Span, function: Callable[[Term], Term]) -> Span | None:
    """The span of a function that falls below 0 and rises above it."""
    low, high = (None if end is None else player.value_of(end, {}) for end in (inner.low, inner.high))
    if low is not None and low >= 0:
        return inner.raise_by(function)
    if high is not None and high <= 0:
        return inner.turn().raise_by(function)
    least = player.ONE if function(player.ZERO)[0] == "cosh" else player.ZERO
    if low is None or high is None:
        return Span(least, None)
    wider = inner if high > -low else inner.turn() if -low > high else None
    return wider and Span(least, wider.raise_by(function).high, False, wider.open_high)
