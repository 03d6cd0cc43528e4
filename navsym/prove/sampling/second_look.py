"""A second look before CONFIRMED: the places where a statement that passed the first points is still false.

The first points are ordinary and their balls have 128 bits. Here the same points are tried with 2,048
bits, then ends and corners of the box, diagonals (symbols that are equal), points far out or near a
finite end, and the place to which a descent of the difference leads, with its coordinates snapped to
simple rational numbers and multiples of pi. A REFUTED that comes out rests on one exact point, as
ever: a ball that excludes the relation, or a difference that is exactly zero where it must not be.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial

import sympy as sp
from flint import arb

from navsym.claims.statement import Box
from navsym.core.balls import UnsupportedError, enclose, exact_ball, precision, tape
from navsym.core.errors import NavsymError
from navsym.core.exact import to_fmpq, to_rational
from navsym.prove.identities import is_zero
from navsym.prove.rooms.goals import factor
from navsym.prove.sampling.descent import Guess, find_lowest
from navsym.prove.sampling.points import AWKWARD, Point, Range, draw_points, ranges_of, value_at
from navsym.prove.sampling.real_roots import Root, list_places

# Exact points at which a factor of an expression vanishes: (x + y - 3)**2 > 0 fails on a whole line.
#
# A descent comes as near to such a line as its digits allow and never lies on it. Here a factor that is a
# polynomial of degree one or two in some symbol is solved for it, at ordinary points of the others.


PLACES = 6
MOST_FACTORS = 8
MOST_MEETINGS = 24
INVERSES = {
    sp.exp: sp.log, sp.log: sp.exp, sp.sin: sp.asin, sp.cos: sp.acos, sp.tan: sp.atan, sp.asin: sp.sin, sp.acos: sp.cos,
    sp.atan: sp.tan, sp.sinh: sp.asinh, sp.tanh: sp.atanh, sp.cosh: sp.acosh, sp.Abs: sp.Abs,
}  # fmt: skip
SYMMETRIC = (sp.Abs, sp.cos, sp.cosh)
WAVES = (sp.sin, sp.cos, sp.tan)
MOST_EDGES = 8
RAYS = (10**2, 10**5, 10**9)

#: Functions that are zero where their argument is.
VANISHING = (sp.Abs, sp.sin, sp.tan, sp.atan, sp.asin, sp.sinh, sp.tanh)


def zeros_of_factors(difference: sp.Expr, limits: Mapping[sp.Symbol, Range]) -> Iterator[Point]:
    """Points of the box where a factor or what stands under a root or in an absolute value is zero."""
    sharp = [node.args[0] for node in difference.atoms(sp.Abs, sp.Pow) if node.is_Function or node.exp.is_Rational]
    kinks = sorted((part for part in sharp if part.free_symbols), key=str)
    bases = dict.fromkeys(map(unwrap_factor, (*sp.Mul.make_args(factor(difference)), *kinks)))
    for base in list(bases)[:MOST_FACTORS]:
        for symbol in sorted(base.free_symbols, key=str):
            yield from zeros_in(base, symbol, limits)


def unwrap_factor(factor: sp.Expr) -> sp.Expr:
    """What a power or a function like |u| vanishes with."""
    base = factor.as_base_exp()[0]
    return unwrap_factor(base.args[0]) if isinstance(base, VANISHING) else base


def zeros_in(base: sp.Expr, symbol: sp.Symbol, limits: Mapping[sp.Symbol, Range]) -> Iterator[Point]:
    """Points where a part vanishes, by one symbol, at ordinary points of the others."""
    others = [other for other in limits if other is not symbol]
    for point in draw_points(others, {s: (limit.lower, limit.upper) for s, limit in limits.items()}, PLACES):
        for value in zeros_of(base, symbol, point):
            if limits[symbol].contains(value):
                yield {**point, symbol: value}


def zeros_of(part: sp.Expr, symbol: sp.Symbol, point: Point) -> list[sp.Expr]:
    """Real values of a symbol at which a part vanishes: of degree one or two in it, or with the symbol only once."""
    slope = sp.diff(part, symbol)
    curve = sp.expand(sp.diff(slope, symbol) / 2)
    try:
        if symbol in curve.free_symbols:
            found = invert(part.subs(point), symbol)
        else:
            found = roots_of(*(p.subs({**point, symbol: 0}) for p in (curve, slope, part)))
        return [value for value in found if value.is_real and exact_ball(value).is_finite()]
    except UnsupportedError:
        return []


def meeting_points(difference: sp.Expr, limits: Mapping[sp.Symbol, Range]) -> Iterator[Point]:
    """Points at which arguments of functions, or what is squared, vanish together: where peaks and narrow dips are.

    One symbol after the other, in both orders, takes a root of an argument that holds no later symbol, or an end.
    """
    nodes = (node for node in difference.atoms(sp.Function, sp.Pow) if node.is_Function or node.exp.is_Rational)
    parts = sorted({node.args[0] for node in nodes if node.args[0].free_symbols}, key=str)[:MOST_FACTORS]
    for order in dict.fromkeys((tuple(limits), tuple(limits)[::-1])):
        points: list[Point] = [{}]
        for symbol in order:
            points = [{**p, symbol: v} for p in points for v in values_beside(parts, symbol, limits[symbol], p)]
            points = points[:MOST_MEETINGS]
        yield from (point for point in points if point)


def values_beside(parts: Sequence[sp.Expr], symbol: sp.Symbol, limit: Range, point: Point) -> list[sp.Expr]:
    """Values of a symbol at which a part vanishes, those before it being known, and values between and beside them.

    Without any, or for the first symbol, the edges of its range, too.
    """
    known, values = {symbol, *point}, dict[sp.Expr, None]()
    for part in parts:
        if symbol in part.free_symbols <= known:
            values |= dict.fromkeys(v for v in zeros_of(part, symbol, point) if limit.contains(v))
    zeros = sorted(values, key=lambda v: exact_ball(v).mid())
    between = ((low + high) / 2 for low, high in itertools.pairwise(zeros))
    steps = (v + step for v in zeros for step in (1, -1))  # (x - 1000)**2 ((x - 1000)**2 - 2) is lowest a unit away
    values |= dict.fromkeys(v for v in (*between, *steps) if limit.contains(v))
    if point and zeros:
        return [*values]
    return [*values, *values_at_edges(limit)[:MOST_EDGES]]


def invert(part: sp.Expr, symbol: sp.Symbol) -> list[sp.Expr]:
    """Roots of ``c + a f(u)`` with inverses of f, and so on inwards, where the symbol stands once."""
    values: list[sp.Expr] = [sp.Integer(0)]
    while part != symbol:
        rest, own = part.as_independent(symbol, as_Add=part.is_Add)
        if part.is_Add or part.is_Mul:
            values = [value - rest if part.is_Add else value / rest for value in values]
        elif part.is_Pow and not part.exp.free_symbols:
            own, values = part.base, [value ** (1 / part.exp) for value in values]
        elif part.func in INVERSES:
            own, values = part.args[0], [INVERSES[part.func](value) for value in values]
            values += [-value for value in values if part.func in SYMMETRIC and value != 0]
            turn = 2 * sp.pi if part.func in WAVES else 0
            values += [value + sign * turn for value in values for sign in (1, -1) if turn]
        else:
            return []
        if own == part or own.count(symbol) != 1:
            return []
        part = own
    return values


def roots_of(a: sp.Expr, b: sp.Expr, c: sp.Expr) -> list[sp.Expr]:
    """Real roots of ``a x**2 + b x + c`` with numbers; none where a ball cannot tell."""
    if any(part.has(sp.nan, sp.zoo, sp.oo) for part in (a, b, c)):
        return []
    if a == 0:
        return [] if exact_ball(b).contains(0) else [-c / b]
    discriminant = b**2 - 4 * a * c
    if exact_ball(a).contains(0) or not exact_ball(discriminant) > 0:
        return []
    root = sp.sqrt(discriminant)
    return [(-b - root) / (2 * a), (-b + root) / (2 * a)]


BITS = 2048
#: Points are exp(-n) away from a zero, with so many bits; the last n only where the margin falls.
CLOSE, CLOSE_BITS = (130, 1_300, 13_000, 130_000), (20_000, 190_000)
FAR_AWAY = (130, 1_300, 13_000, 10**15)
HIDDEN = 1e-20
MOST_APPROACHES = 24
ORDINARY = 24
SHARP = 1e-100
FAR = tuple(sp.Integer(10) ** k for k in (3, 12, 31))
NEAR = tuple(sp.Rational(1, 10**k) for k in (3, 12, 31, 75, 150, 300))
DENOMINATORS = (1, 2, 3, 4, 6, 12, 100, 10**12, 10**150)
TOUCHING = 1e-60
MOST_DIGITS = 20_000
MOST_ROOT = 100

#: A descent that comes so near to an end of a range is meant to reach it.
NEARBY = 1e-3

#: What a compass search in floats leaves open of a coordinate.
SAME = Fraction(1, 10**12)


@dataclass(frozen=True, slots=True)
class Look:
    """What the second look found: a counterexample, or two points between which the sign changes."""

    counterexample: Point | None = None
    difference: arb | None = None
    exact: bool = False  # the difference is exactly zero there
    positive: Point | None = None
    negative: Point | None = None
    touching: Point | None = None  # the difference is almost zero there, and equality would break the relation
    falling: Point | None = None  # the margin still falls there, as log(x) does for x to 0: nobody knows how far


def look_again(
    difference: sp.Expr,
    excludes: Callable[[arb], bool],
    box: Box,
    sides: Sequence[sp.Expr] = (),
    zero_breaks: bool = False,
    goals: Sequence[sp.Expr] = (),
    settled: Callable[[], bool] = bool,
) -> Look:
    """Look again for a point that breaks ``difference relation 0``.

    excludes    : true for a finite ball that contradicts the relation
    sides       : expressions that have to be finite at the point
    zero_breaks : an exactly vanishing difference contradicts the relation, as for < and !=
    goals       : expressions whose lowest place is worth a try
    settled     : whether no point breaks the relation; asked before places that take long to find
    """
    symbols = sorted(difference.free_symbols | set().union(*(s.free_symbols for s in sides)), key=str)
    limits = ranges_of(symbols, box)

    def far_places() -> Iterator[Point]:
        if not settled():
            yield from meeting_points(difference, limits)
            for way, goal in itertools.product((descents, rays), goals):
                yield from way(goal, limits)

    zeros = zeros_of_factors(difference, limits) if zero_breaks else ()
    positive = negative = touching = None
    for point in itertools.chain(draw_points(symbols, box, ORDINARY), special_points(limits), zeros, far_places()):
        ball = sharp_value(difference, point, sides)
        if ball is None:
            continue
        if excludes(ball):
            return Look(point, ball)
        if zero_breaks and ball.contains(0) and is_zero_at(difference, point):
            return Look(point, arb(0), exact=True)
        touching = point if zero_breaks and abs(ball) < TOUCHING else touching
        positive = point if positive is None and ball > 0 else positive
        negative = point if negative is None and ball < 0 else negative
    found = Look() if settled() else look_close(difference, excludes, limits, sides, goals)
    if found.counterexample is not None:
        return found
    return replace(found, positive=positive, negative=negative, touching=touching)


def look_at_places(
    difference: sp.Expr,
    excludes: Callable[[arb], bool],
    box: Box,
    sides: Sequence[sp.Expr] = (),
    zero_breaks: bool = False,
) -> Look | None:
    """A look at all signs of a difference in one symbol, by its real roots; None where these do not tell them all."""
    limits = ranges_of(sorted(difference.free_symbols | set().union(*(s.free_symbols for s in sides)), key=str), box)
    if len(limits) != 1 or not difference.free_symbols:
        return None
    ((symbol, limit),) = limits.items()
    try:
        places = list_places(difference, sides, limit)
        if places is None:
            return None

        def find(values: Iterable[sp.Expr]) -> Iterator[Point]:
            there = ({symbol: value} for value in values if limit.contains(value))
            return (point for point in there if all(exists_at(side, point) for side in sides))

        for point in filter(None, (next(find(numbers), None) for numbers in places.between)):
            ball = find_sign_ball(difference, point)
            if ball is None and zero_breaks and is_zero_at(difference, point):
                return Look(point, arb(0), exact=True)
            if ball is not None and excludes(ball):
                return Look(point, ball)
        if zero_breaks:
            for point in find(root.at for root in places.roots if root.at is not None):
                if is_zero_at(difference, point):
                    return Look(point, arb(0), exact=True)
            if hidden := find_hidden_zero(difference, symbol, places.roots):
                return Look(touching=hidden)
    except (UnsupportedError, NavsymError):
        return None
    return Look() if places.complete else None


def find_sign_ball(difference: sp.Expr, point: Point) -> arb | None:
    """A ball of the difference that tells its sign, with as many bits as that takes; None where none does."""
    balls = (value_at(tape(difference), point, bits) for bits in (BITS, 16 * BITS))
    return next((ball for ball in balls if ball.is_finite() and not ball.contains(0)), None)


def find_hidden_zero(difference: sp.Expr, symbol: sp.Symbol, roots: Sequence[Root]) -> Point | None:
    """A place beside a root without a formula at which the difference may be zero."""
    for root in (root for root in roots if root.at is None):
        with precision(BITS):
            ball = enclose(tape(difference), {symbol: arb(root.lower).union(arb(root.upper))}, BITS)
        if ball.is_finite() and ball.contains(0):
            return {symbol: to_rational((root.lower + root.upper) / 2)}
    return None


def look_close(
    difference: sp.Expr,
    excludes: Callable[[arb], bool],
    limits: Mapping[sp.Symbol, Range],
    sides: Sequence[sp.Expr],
    goals: Sequence[sp.Expr],
) -> Look:
    """Look beside zeros and far out: a counterexample, or a place where a goal still falls."""
    programs, falling = [tape(part) for part in (difference, *goals, *sides)], None
    for points, sizes in itertools.islice(approaches(difference, limits), MOST_APPROACHES):
        rows: list[list[arb]] = []
        for point, bits in zip(points, sizes, strict=False):
            rows.append([value_at(program, point, bits) for program in programs])
            if not all(ball.is_finite() for ball in rows[-1]):
                break
            if excludes(rows[-1][0]):
                return Look(point, rows[-1][0])
            if len(rows) == 3:
                if not any(map(is_falling, [*zip(*rows, strict=True)][1 : len(goals) + 1])):
                    break
                falling = point
    return Look(falling=falling)


def approaches(difference: sp.Expr, limits: Mapping[sp.Symbol, Range]) -> Iterator[tuple[list[Point], tuple[int, ...]]]:
    """Points that near a zero of what a logarithm or a division is of, an end of a range, or infinity, with their bits.

    Where no formula gives the zero of a logarithm, a descent finds it, and points stay further off.
    """
    logs = [node.args[0] for node in difference.atoms(sp.log) if node.free_symbols]
    poles = [node.base for node in difference.atoms(sp.Pow) if node.exp.is_negative or not node.exp.is_number]
    home = {symbol: home_value(limit) for symbol, limit in limits.items()}
    for symbol, limit in limits.items():
        rest = {other: value for other, value in home.items() if other is not symbol}
        centres = [end for end in (limit.lower, limit.upper) if end is not None]
        for pole in sorted((*logs, *poles), key=str):
            centres += zeros_of(pole, symbol, rest) if symbol in pole.free_symbols else []
        ways = [([sign * sp.exp(n) for n in FAR_AWAY], (BITS,) * 4) for sign in (1, -1)]
        for centre, sign in itertools.product(dict.fromkeys(centres), (1, -1)):
            near = [centre + sign * sp.exp(-n) for n in (CLOSE if centre else FAR_AWAY)]
            ways.append((near, (CLOSE_BITS[0],) * 3 + CLOSE_BITS[1:] if centre else (BITS,) * 4))
        for values, bits in ways:
            if all(limit.contains(value) for value in values):
                yield [{**rest, symbol: value} for value in values], bits
    for pole in sorted(set(logs), key=str):
        hidden = unwrap_factor(pole)
        for place in find_lowest(hidden**2, {s: limits[s] for s in limits if s in hidden.free_symbols}):
            point = {**home, **{symbol: to_rational(value) for symbol, value in place.items()}}
            symbol = min(place, key=str)
            near = [point[symbol] + sp.Rational(1, 10**n) for n in (3, 6, 12)]
            inside = all(limits[s].contains(v) for s, v in point.items()) and all(map(limits[symbol].contains, near))
            if inside and abs(value_at(tape(hidden), point)) < HIDDEN:
                yield [{**point, symbol: value} for value in near], (BITS,) * 3


def is_falling(margins: Sequence[arb]) -> bool:
    """Whether positive margins fall and do not converge: the last step is more than half of the one before."""
    first, middle, last = margins[:3]
    return bool(last > 0 and first - middle > 0 and 2 * (middle - last) > first - middle)


def sharp_value(difference: sp.Expr, point: Point, sides: Sequence[sp.Expr]) -> arb | None:
    """Ball of the difference with many bits; None where a side has no value.

    A ball across a jump, such as that of ``atan2(sin(T), cos(T))`` at pi, says nothing; there the exact
    values of the functions are put in first.
    """
    try:
        if not all(exists_at(side, point) for side in sides):
            return None
        ball = value_at(tape(difference), point, BITS)
        if ball.is_finite() and (not ball.contains(0) or ball.rad() < SHARP):
            return ball
        put_in = put_in_numbers(difference, point)
        if put_in is None:
            return None
        ball = enclose(tape(put_in), {}, BITS)
    except UnsupportedError:
        return None
    return ball if ball.is_finite() else None


def exists_at(side: sp.Expr, point: Point) -> bool:
    """A value by balls, or, as for a root of zero at an end of the range, with the exact numbers put in."""
    if value_at(tape(side), point, BITS).is_finite():
        return True
    # every part has to exist: 1/log(0) would come out as 1/zoo = 0
    parts = [put_in_numbers(node, point) for node in sp.preorder_traversal(side) if not node.is_Atom]
    if any(part is None or part.has(sp.nan, sp.zoo, sp.oo, -sp.oo, sp.I) for part in parts):
        return False
    return all(enclose(tape(part), {}, BITS).is_finite() for part in parts)


def put_in_numbers(expression: sp.Expr, point: Point) -> sp.Expr | None:
    """The expression with exact numbers put in; None where that would multiply out a power with too many digits."""
    exponents = [power.exp for power in expression.atoms(sp.Pow) if power.exp.free_symbols]
    turned = [node.args[0] for node in expression.atoms(sp.exp) if node.has(sp.log)]  # exp(y log x) becomes x**y
    exponents += [argument.replace(sp.log, lambda *_: sp.Integer(1)) for argument in turned]
    within = set().union(*(exponent.free_symbols for exponent in exponents)) & point.keys()
    if any(point[symbol].is_Rational and point[symbol].q > MOST_ROOT for symbol in within):
        return None
    sizes = (1 + abs(value_at(tape(exponent), point)) for exponent in exponents)
    try:  # the exponents of a power of a power are multiplied
        digits = max((len(str(value)) for value in point.values()), default=1) if exponents else 1
        return expression.subs(point) if math.prod(sizes, start=arb(digits)) < MOST_DIGITS else None
    except OverflowError:  # roots of numbers with hundreds of digits
        return None


def is_zero_at(difference: sp.Expr, point: Point) -> bool:
    try:
        put_in = put_in_numbers(difference, point)
        return put_in is not None and is_zero(put_in)
    except UnsupportedError:
        return False


# -- special points ---------------------------------------


def special_points(limits: dict[sp.Symbol, Range]) -> Iterator[Point]:
    """Corners, diagonals, and points far out or near an end: one symbol at a time, and all at once."""
    if not limits:
        return
    ends = {symbol: values_at_edges(limit) for symbol, limit in limits.items()}
    yield from diagonals(limits)
    yield from corners(ends)
    home = {symbol: home_value(limit) for symbol, limit in limits.items()}
    for symbol, values in ends.items():
        yield from ({**home, symbol: value} for value in values)
    for step in range(max(map(len, ends.values()))):
        yield {symbol: values[min(step, len(values) - 1)] for symbol, values in ends.items()}


def values_at_edges(limit: Range) -> list[sp.Expr]:
    """Ends of a range, and values near a finite end and far towards an infinite one."""
    found: list[sp.Expr] = []
    for end, inwards in ((limit.lower, 1), (limit.upper, -1)):
        if end is None:
            found += [-inwards * value for value in (*FAR, *NEAR)]
        else:
            found += [end, *(end + inwards * value for value in NEAR)]
    return [value for value in found if limit.contains(value)] or [home_value(limit)]


def home_value(limit: Range) -> sp.Expr:
    """An ordinary value of the range."""
    if limit.lower is not None and limit.upper is not None:
        middle = (limit.lower + limit.upper) / 2
        return middle if limit.contains(middle) else limit.lower
    if limit.lower is not None:
        return limit.lower + 1
    return limit.upper - 1 if limit.upper is not None else sp.Integer(1)


def corners(ends: dict[sp.Symbol, list[sp.Expr]]) -> Iterator[Point]:
    """Both outermost values of every symbol, up to 64 combinations."""
    pairs = [(values[0], values[-1]) for values in ends.values()]
    for corner in itertools.islice(itertools.product(*pairs), 64):
        yield dict(zip(ends, corner, strict=True))


def diagonals(limits: dict[sp.Symbol, Range]) -> Iterator[Point]:
    """All symbols equal, opposite, and every pair equal."""
    symbols = list(limits)
    home = {symbol: home_value(limit) for symbol, limit in limits.items()}
    groups = [tuple(symbols), *(itertools.combinations(symbols, 2) if len(symbols) > 2 else ())]
    for group, value in itertools.product(groups[:16], AWKWARD):
        for signs in ((1,) * len(group), (1,) + (-1,) * (len(group) - 1)):
            point = {**home, **{s: sign * value for s, sign in zip(group, signs, strict=True)}}
            if all(limits[symbol].contains(point[symbol]) for symbol in group):
                yield point


# -- where the difference is lowest ---------------------------------------


def descents(goal: sp.Expr, limits: dict[sp.Symbol, Range]) -> Iterator[Point]:
    """The lowest places that a descent finds, with every coordinate snapped in the same way.

    Then one coordinate after the other is held at a simple number and the rest descends again: what is
    lowest along a whole line has points there that cannot be rounded at once.
    """
    if not limits or any(limit.integer for limit in limits.values()):
        return
    held: Point = {}
    while len(held) < len(limits):
        rest = {symbol: limit for symbol, limit in limits.items() if symbol not in held}
        places = list(find_lowest(goal.subs(held), rest))
        yield from snap_places(places, held, limits)
        ends = nearby_ends(places[0], rest) if places else {}
        if ends and len(ends) < len(rest):  # lowest on a face: once more, inside that face
            face = {symbol: limit for symbol, limit in rest.items() if symbol not in ends}
            yield from snap_places(list(find_lowest(goal.subs({**held, **ends}), face)), {**held, **ends}, limits)
        symbol = next(iter(rest))
        value = round_to_fraction(DENOMINATORS[5], places[0][symbol]) if places else None
        if value is None or not limits[symbol].contains(value):
            return
        held[symbol] = value


def rays(goal: sp.Expr, limits: dict[sp.Symbol, Range]) -> Iterator[Point]:
    """Far out where the terms of highest degree of a polynomial are lowest, with one coordinate before the others.

    A form that is negative in a narrow cone only, as x**2 + 4 x y + 3.999 y**2, has no lowest place to descend to.
    """
    if not limits or not goal.is_polynomial(*limits):
        return
    terms = sp.Poly(goal, *limits).terms()
    degree = max(sum(exponents) for exponents, _ in terms)
    form = sp.Add(*(c * sp.Mul(*map(sp.Pow, limits, e)) for e, c in terms if sum(e) == degree))
    for symbol, sign in itertools.product(limits, (1, -1)):
        rest = {other: limit for other, limit in limits.items() if other is not symbol}
        for place in find_lowest(form.subs(symbol, sign), rest) if rest else ({},):
            direction = {symbol: sp.Integer(sign), **{s: round_to_simplest(value) for s, value in place.items()}}
            for size in RAYS:
                point = {s: size * value for s, value in direction.items()}
                if all(limits[s].contains(value) for s, value in point.items()):
                    yield point


def snap_places(places: Sequence[Guess], held: Point, limits: dict[sp.Symbol, Range]) -> Iterator[Point]:
    """The places with their coordinates rounded in every way, those that are held as they are."""
    for place, snap in itertools.product(places, list_snappings()):
        point = {**held, **{symbol: snap(value) for symbol, value in place.items()}}
        if all(limits[symbol].contains(value) for symbol, value in point.items()):
            yield point


def nearby_ends(place: Guess, limits: dict[sp.Symbol, Range]) -> Point:
    """The coordinates that lie almost at an end of their range, moved to that end."""
    ends = ((symbol, end) for symbol in place for end in (limits[symbol].lower, limits[symbol].upper))
    inside = ((symbol, end) for symbol, end in ends if end is not None and limits[symbol].contains(end))
    return {symbol: end for symbol, end in inside if abs(exact_ball(end) - to_fmpq(place[symbol])) < NEARBY}


def list_snappings() -> Iterator[Callable[[Fraction], sp.Expr]]:
    """Ways to round a coordinate to a simple exact number."""
    yield from (partial(round_to_fraction, denominator) for denominator in DENOMINATORS)
    yield round_to_simplest
    yield from (partial(round_to_turns, denominator) for denominator in (6, 24))


def round_to_fraction(denominator: int, value: Fraction) -> sp.Expr:
    """The nearest fraction with a denominator of at most so much."""
    return to_rational(value.limit_denominator(denominator))


def round_to_simplest(value: Fraction) -> sp.Expr:
    """A fraction with few digits that a float cannot tell from the value."""
    shorter = (value.limit_denominator(10**k) for k in range(1, 9))
    return to_rational(next((short for short in shorter if abs(short - value) < SAME), value))


def round_to_turns(denominator: int, value: Fraction) -> sp.Expr:
    """The nearest simple multiple of pi."""
    return sp.pi * to_rational((value / Fraction(math.pi)).limit_denominator(denominator))
