"""A room that puts one number in the place of a part of a term, with the range that the part has.

Nothing is lost where the symbols of the part stand nowhere else and its range is known: exp(-exp(-x)) < 1 for all x
becomes exp(u) < 1 for u < 0. A linear part may leave fewer symbols even where they stand elsewhere: in
exp(x + y) >= 1 + x + y all of x + y is u.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import sympy as sp
from flint import arb, fmpq

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

    def turn(self) -> Span:
        """The span of the negative."""
        low, high = (None if end is None else fold(player.negate(end)) for end in self[:2])
        return Span(high, low, self.open_high, self.open_low)

    def write(self) -> list[Any]:
        """The range of a new symbol."""
        flags = [word for word, is_open in zip(("open-low", "open-high"), self[2:], strict=True) if is_open]
        return [*(None if end is None else write_term(end) for end in self[:2]), flags]


WHOLE = Span(None, None)


def by_letters(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A number u in the place of a part that alone has its symbols: larger parts first."""
    for part, name in list_parts(goal):
        form = player.replace(goal.term, part, ("symbol", name))
        is_lonely = not player.symbols_of(form) & player.symbols_of(part)
        span = find_span(part, goal.box) if is_lonely and player.symbols_of(player.differentiate(form, name)) else None
        if span is not None:  # of u + c the sign is as hard as that of the part
            if any(p in (("asin", part), ("acos", part)) for p in subterms(goal.term)):
                span = span._replace(low=span.low or player.MINUS_ONE, high=span.high or player.ONE)
            yield abstract({name: write_term(part)}, {name: span.write()}, write_term(form))


def by_common_parts(goal: Any, sample: list[arb]) -> Iterator[Proof]:
    """A number u in the place of a sum that leaves fewer symbols or irrational numbers, though it stands elsewhere too."""
    for part, name in list_parts(goal):
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


def list_parts(goal: Any) -> Iterator[tuple[Term, str]]:
    """Parts of a term that are no symbols, numbers or multiples of a part, larger ones first, with a new name.

    Of symbols in hypotheses there are none: the letter would not know of them.
    """
    bound = set(player.set_union(map(player.symbols_of, (*goal.given, *goal.zeros))))
    parts = [*dict.fromkeys(subterms(goal.term))][:-1]
    name = "u"
    while name in goal.box:
        name += "u"
    count = 0
    for part in reversed(parts if len(parts) <= MOST_TERMS else []):
        names = player.symbols_of(part)
        if part[0] != "symbol" and names and not names & bound and not is_multiple(part) and count < MOST_PARTS:
            count += 1
            yield part, name


def is_multiple(part: Term) -> bool:
    """Whether a term is a number times something: a letter for that alone gains as much."""
    return part[0] == "*" and sum(1 for f in player.list_factors(part) if player.symbols_of(f)) == 1


def measure(expression: sp.Expr) -> tuple[int, int]:
    """How many symbols and how many irrational numbers an expression has."""
    return len(expression.free_symbols), count_numbers(expression)


def count_numbers(expression: sp.Expr) -> int:
    """Irrational numbers in an expression."""
    return sum(1 for part in sp.preorder_traversal(expression) if part.is_number and not part.is_Rational)


# Ranges of terms


def fold(end: Term) -> Term:
    """A rational number as one, any other term as it is."""
    value = player.constant_of(end)
    return end if value is None else player.number(value)


def is_even(exponent: Term) -> bool:
    """Whether an exponent is a whole even number above zero."""
    q = player.constant_of(exponent)
    return q is not None and q > 0 and q.q == 1 and int(q) % 2 == 0


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
    if inner is None:
        return None
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
    ends = [None if any(s[k] is None for s in spans) else fold(("+", *(s[k] for s in spans))) for k in (0, 1)]
    return Span(*ends, any(s.open_low for s in spans), any(s.open_high for s in spans))


def span_of_product(term: Term, box: Any) -> Span | None:
    """A multiple of a span by a number of known sign."""
    factors = player.list_factors(term)
    moving = [f for f in factors if player.symbols_of(f)]
    inner = find_span(moving[0], box) if len(moving) == 1 else None
    share = ("*", player.ONE, *(f for f in factors if f is not moving[0]))
    value = player.value_of(share, {})
    if inner is None or not (value > 0 or value < 0):
        return None
    if value < 0:
        inner, share = inner.turn(), player.negate(share)
    return Span(*(None if end is None else fold(("*", share, end)) for end in inner[:2]), *inner[2:])


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
    return Span(*(None if end is None else fold(power(end)) for end in inner[:2]), *inner[2:])


def raise_ends(kind: str, inner: Span) -> Span:
    """The span of a rising function: its value at 0, its limits where it has some, else its values at the ends."""
    if kind == "sqrt" and (inner.low is None or player.value_of(inner.low, {}) < 0):
        inner = inner._replace(low=player.ZERO, open_low=False)
    ends, is_open = [], []
    for k, limit in enumerate(RISING[kind]):
        end = inner[k]
        at_zero = end == player.ZERO and kind != "log"
        value = None if end is None else (kind, end)
        ends.append((player.ONE if kind == "exp" else player.ZERO) if at_zero else value if limit is None else limit)
        is_open.append(inner[k + 2] if at_zero or limit is None else True)
    return Span(*ends, *is_open)


def fold_at_zero(inner: Span, function: Any) -> Span | None:
    """The span of a function that falls below 0 and rises above it."""
    low, high = (None if end is None else player.value_of(end, {}) for end in inner[:2])
    if low is not None and low >= 0:
        return Span(*(None if end is None else fold(function(end)) for end in inner[:2]), *inner[2:])
    if high is not None and high <= 0:
        return fold_at_zero(inner.turn(), function)
    least = fold(function(player.ZERO))
    least = player.ONE if least == ("cosh", player.ZERO) else player.ZERO
    if low is None or high is None:
        return Span(least, None)
    sizes = (-low, high)
    if not (sizes[0] >= sizes[1] or sizes[1] >= sizes[0]):
        return None
    k = 0 if sizes[0] >= sizes[1] else 1
    end = inner[k] if k else player.negate(inner[0])
    return Span(least, fold(function(fold(end))), False, inner[k + 2] and not sizes[0] == sizes[1])
