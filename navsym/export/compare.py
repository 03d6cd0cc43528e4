"""A function that computes in doubles beside a formula: how far apart they may be, and where."""

from __future__ import annotations

import functools
import heapq
import html
import inspect
import math
import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from typing import Any

from flint import arb, arb_mat, arb_series, fmpq_mat, fmpz_mat

from navsym.claims.display import write_card
from navsym.core.answers import Answer, named
from navsym.core.balls import precision, series_terms
from navsym.core.errors import DomainError, EmptyError, ShapeError, TooLargeError, UnknownSymbolError
from navsym.export.accuracy.rounding import DOUBLE, float_above, followed, up
from navsym.export.differences import exact_range
from navsym.export.expression_graph import Graph
from navsym.export.tracing import UntraceableError, trace, write_trace
from navsym.language.names import quote
from navsym.language.values import write_value
from navsym.prove.formulas import prove
from navsym.prove.grant import write_numerals
from navsym.prove.rooms.goals import player

BITS = 192
POINTS = 400
#: Most points: half a minute of a short function.
MOST_POINTS = 1_000_000
BOXES = 600
ULPS = 4  # of a library function: the widest of what C libraries and numpy state
ROUND = 120  # boxes after which the bound has to have fallen
ORDER = 8  # of the series of a smooth difference
DIRECTIONS = 40  # along which series are taken, at most
CLOSE = 1.05  # a bound this near to what was seen, or to that of the round before, is not divided further
ARITHMETIC = replace(DOUBLE, library=ULPS)
ROUNDED = f"each operation rounded once, library functions within {ULPS} ulps"

Box = tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True, repr=False)
class FunctionComparison(Answer):
    """How far a function of doubles is from a formula.

    how       : "certified" when ``bound`` holds for every double in the ranges, "sampled" when it is the largest
                difference at the points that were tried
    bound     : decimal, rounded up; None where the function has no value at ``worst``
    worst     : name -> the double at which the largest difference was seen, as its shortest decimal
    deviation : the difference seen there, rounded up; None where the function has no value
    evidence  : what was traced and proved, or why nothing could be certified
    points    : number of points tried
    """

    how: str
    bound: str | None
    worst: Mapping[str, str]
    deviation: str | None
    evidence: str
    points: int

    def document(self) -> dict[str, Any]:
        """The comparison as plain data."""
        return named(self, "how bound worst deviation evidence points")

    def __repr__(self) -> str:
        place = ", ".join(f"{name} = {value}" for name, value in self.worst.items())
        return f"<{self.how}: {'no value' if self.bound is None else f'at most {self.bound}'}; worst at {place}>"

    def _repr_html_(self) -> str:
        return write_card([html.escape(repr(self)[1:-1]), html.escape(self.evidence)])


def compare(
    function: Callable[..., Any], formula: Any, /, *, points: int = POINTS, seconds: float = 20.0, **ranges: Any
) -> FunctionComparison:
    """A function of doubles beside a formula: a bound of their difference, and the worst point that was seen.

    The function is called once with numbers that note what is done with them. Where it does nothing but operations and
    elementary functions (its own, or numpy's or math's), the operations are compared with the formula exactly and their
    roundings are bounded in balls: the bound is certified for every double in the ranges. A compiled function, a branch
    or a table cannot be followed, and is sampled.

    function : of one number for each range; called by names where its signature has them all, else in their order
    formula  : text in the language of files, or an expression of sympy
    points   : number of points at which the function is called
    seconds  : limit of the search for a proof that the operations are the formula
    ranges   : name -> two finite ends, ``x=("0", "3")``, exact

    Raises EmptyError without a range or a value, UnknownSymbolError for a name without a range, ShapeError or
    DomainError for ranges that are none, and the errors of :func:`navsym.prove` for a formula that is none.

    >>> import math
    >>> import navsym as nav
    >>> found = nav.compare(lambda x: math.sin(x)/x, "sin(x)/x", x=("1/1000", "3"))
    >>> found.how, float(found.bound) < 2e-15
    ('certified', True)
    >>> nav.compare(lambda x: x if x > 1 else 1.0, "x", x=("0", "2")).how
    'sampled'
    """
    box, names = tuple(read_box(ranges).values()), tuple(ranges)
    if not callable(function):
        message = f"expected a function of numbers; got {type(function).__name__}; give a callable, such as math.sin"
        raise DomainError(message, where="compare: function")
    if not isinstance(points, int) or isinstance(points, bool) or not 2 <= points <= MOST_POINTS:
        message = f"expected 2 to {MOST_POINTS} points; got {quote(points)}; correct it"
        raise DomainError(message, where="compare: points")
    formula = write_value(formula, "compare: formula")
    prove(formula, "=", formula, seconds=seconds, **ranges)  # the reader's errors, and a range of no name of it
    try:
        term = player.parse(write_numerals(formula))
    except player.Refused as error:
        message = f"expected operations and elementary functions of numbers; got {error}; write it with abs"
        raise DomainError(message, where="compare: formula") from None
    for name in sorted(player.symbols_of(term) - set(names)):
        message = f'expected a range for each name; got none of {name}; write {name}=("0", "1")'
        raise UnknownSymbolError(message, where="compare")
    sides = Sides(function, term, names, takes_names(function, names))
    seen = [sample for point in sample_points(box, points) if (sample := sides.measure(point)) is not None]
    if not seen:
        raise EmptyError("expected a formula with values in the ranges; got none; correct them", where="compare")
    worst = max(seen, key=lambda sample: sample.difference)
    try:
        bound, evidence = certify(sides, formula, box, [sample.point for sample in seen], worst, ranges, seconds)
        how = "certified"
    except (UntraceableError, TooLargeError) as error:  # the trace may be deeper than what is read
        bound, how, evidence = worst.difference, "sampled", f"not certified: {error}"
    place = {name: repr(value) for name, value in zip(names, worst.point, strict=True)}
    return FunctionComparison(how, write_upper(bound), place, write_upper(worst.difference), evidence, len(seen))


@dataclass(frozen=True, slots=True)
class Sample:
    """A point, what the function gave there, and an upper bound of its difference from the formula."""

    point: tuple[float, ...]
    value: float
    difference: float


@dataclass(frozen=True, slots=True)
class Sides:
    """The function and the formula, as a term that balls enclose."""

    function: Callable[..., Any]
    term: Any
    names: tuple[str, ...]
    by_name: bool

    def measure(self, point: Sequence[float]) -> Sample | None:
        """The difference at a point; None where the formula has no value, infinite where only the function has none."""
        with precision(BITS):
            exact = player.value_of(self.term, {n: player.Jet(arb(x)) for n, x in zip(self.names, point, strict=True)})
            if not exact.is_finite():
                return None
            try:
                given = dict(zip(self.names, point, strict=True))
                value = float(self.function(**given) if self.by_name else self.function(*point))
            except Exception:  # any error of the caller's function is: no value here
                value = math.nan
            if not math.isfinite(value):
                return Sample(tuple(point), value, math.inf)
            return Sample(tuple(point), value, float_above(abs(arb(value) - exact)))


def read_box(ranges: Mapping[str, Any]) -> dict[str, tuple[float, float]]:
    """The first and the last double of each range; raises NavsymError for a range that has none, or no two ends."""
    if not ranges:
        raise EmptyError('expected a range for each argument; got none; write x=("0", "3")', where="compare")
    found = {}
    for name, ends in ranges.items():
        where = f"compare: {name}"
        if not isinstance(ends, (tuple, list)):
            raise ShapeError(f'expected two ends; got {quote(ends)}; write {name}=("0", "3")', where=where)
        with precision(BITS):
            lower, upper = (player.value_of(player.parse(str(end)), {}) for end in exact_range(name, ends))
            low, high = 0.0 + float_above(lower), 0.0 - float_above(-upper)  # and never -0.0
            if not (lower.is_finite() and upper.is_finite() and low <= high):
                message = f"expected two finite ends in order, a double between; got {quote(ends)}; correct them"
                raise DomainError(message, where=where)
            found[name] = (low, high)
    return found


def takes_names(function: Callable[..., Any], names: Sequence[str]) -> bool:
    """True when the function has parameters of exactly these names."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return False
    named = {p.name for p in parameters if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY) and p.default is p.empty}
    return named == set(names)


def sample_points(box: Box, count: int) -> Iterator[tuple[float, ...]]:
    """Corners, the middle, and points that are the same in every run."""
    generator = random.Random(0)
    corners = product(*box) if len(box) < 8 else [tuple(low for low, _ in box), tuple(high for _, high in box)]
    fixed = [*corners, tuple(low / 2 + high / 2 for low, high in box)]
    yield from fixed[:count]
    for _ in range(count - len(fixed)):
        yield tuple(min(max(generator.uniform(low, high), low), high) for low, high in box)


# The certified bound


def certify(
    sides: Sides,
    formula: str,
    box: Box,
    points: Sequence[tuple[float, ...]],
    worst: Sample,
    ranges: Mapping[str, Any],
    seconds: float,
) -> tuple[float, str]:
    """A bound of the difference on the whole box, and what it rests on; raises UntraceableError where there is none."""
    if worst.difference == math.inf:
        raise UntraceableError(f"the function has no value at {worst.point}")
    graph, literals = trace(sides.function, sides.names, sides.by_name)
    require_faithful(sides, graph, literals, points)
    text = write_trace(graph)
    if text is None:
        raise UntraceableError("the traced formula is too long")
    # Only a text with every name takes a declaration of each.
    uses_all = set(sides.names) <= player.symbols_of(player.parse(text))
    is_same = uses_all and prove(text, "=", formula, seconds=seconds, **ranges).holds
    difference = None if is_same else player.parse(f"({text}) - ({write_numerals(formula)})")

    def bound_on(part: Box) -> float:
        """Roundings, and what the exact operations differ from the formula."""
        with precision(BITS):
            inputs = [arb(low).union(arb(high)) for low, high in part]
            rounding = followed(graph, inputs, ARITHMETIC, literals)[graph.roots[0]].absolute
            apart = arb(0) if difference is None else up(enclose_on(difference, sides.names, part))
            total = rounding + apart
            return float_above(total)

    bound, part = divide_boxes(bound_on, box, worst.difference)
    if bound == math.inf:
        place = ", ".join(f"{n} in [{a!r}, {b!r}]" for n, (a, b) in zip(sides.names, part, strict=True))
        raise UntraceableError(f"no finite bound was found on {place}")
    operations = sum(graph.operations().values())
    words = "proved to be the formula" if is_same else "compared with the formula in balls"
    return bound, f"{operations} operations were traced and {words}; {ROUNDED}"


def require_faithful(sides: Sides, graph: Graph, literals: Sequence[Any], points: Sequence[tuple[float, ...]]) -> None:
    """Refuse a trace that is not what the function does: at every point its value lies where the trace says."""
    for point in points[:: max(1, len(points) // 40)]:
        found = followed(graph, [arb(x) for x in point], ARITHMETIC, literals)[graph.roots[0]]
        sample = sides.measure(point)
        value = math.nan if sample is None else sample.value
        near = found.value + arb(0, found.absolute) if found.absolute.is_finite() else None
        if near is not None and not near.contains(arb(value)):
            raise UntraceableError(f"the function does something else at {point} than with the number that takes notes")


def enclose_on(term: Any, names: Sequence[str], part: Box) -> arb:
    """The smaller of two balls of a term on a box: that of its values, and that of its series where it has one."""
    plain = player.value_of(term, {n: player.Jet(arb(a).union(arb(b))) for n, (a, b) in zip(names, part, strict=True)})
    found = [x for x in (arb(plain), enclose_by_series(term, names, part)) if x.is_finite()]
    return min(found, key=lambda x: float_above(abs(x)), default=arb.nan())


def enclose_by_series(term: Any, names: Sequence[str], part: Box) -> arb:
    """Taylor's polynomial in the middle of a box and Lagrange's rest; NaN at a kink.

    With x = m + r d and each |d_k| <= 1, f is a sum of homogeneous polynomials in d. Series along as many directions
    as the last of them has terms give their coefficients, so that what two formulas have in common cancels. The rest
    is the next coefficient along any direction from anywhere in the box.
    """
    last = max(k for k in range(1, ORDER) if k == 1 or math.comb(len(names) + k - 1, k) <= DIRECTIONS)
    ends = [(arb(low), arb(high)) for low, high in part]
    middles, halves = [(a + b) / 2 for a, b in ends], [(b - a) / 2 for a, b in ends]
    wide = [a.union(b) for a, b in ends]

    def series_along(starts: Sequence[arb], steps: Sequence[arb]) -> arb_series:
        place = {n: player.Jet(arb_series([x, step])) for n, x, step in zip(names, starts, steps, strict=True)}
        return arb_series(player.evaluate(term, place, player.strict).enclose())

    try:
        with series_terms(last + 2):
            rest = up(series_along(wide, [arb(0, up(h)) for h in halves])[last + 1])
            found = {
                d: series_along(middles, [h * k for h, k in zip(halves, d, strict=True)])
                for d in whole_vectors(len(names), last)
            }
    except (player.Refused, ValueError):  # no derivative, or a bound that is not finite
        return arb.nan()
    total = next(iter(found.values()))[0] + arb(0, rest)
    for degree in range(1, last + 1):
        chosen, inverse = interpolation(len(names), last, degree)
        values = arb_mat([[found[d][degree]] for d in chosen])
        total += sum((arb(0, up(c)) for c in (arb_mat(inverse) * values).entries()), arb(0))
    return total


def whole_vectors(size: int, total: int) -> list[tuple[int, ...]]:
    """Vectors of whole numbers from 0 on with this sum."""
    return [v for v in product(range(total + 1), repeat=size) if sum(v) == total]


@functools.cache
def interpolation(size: int, last: int, degree: int) -> tuple[list[tuple[int, ...]], fmpq_mat]:
    """Directions among those of the last degree, and what turns values there into coefficients of this degree.

    On the plane of vectors with one sum they are a lattice on which each polynomial of the degree is determined.
    """
    chosen = [v for v in whole_vectors(size, last) if v[0] >= last - degree]
    powers = whole_vectors(size, degree)
    rows = [[math.prod(x**k for x, k in zip(v, p, strict=True)) for p in powers] for v in chosen]
    return chosen, fmpq_mat(fmpz_mat(rows)).inv()


def divide_boxes(bound_on: Callable[[Box], float], box: Box, seen: float) -> tuple[float, Box]:
    """The bound on the worst of the boxes into which a box is divided, and that box."""
    heap, before = [(-bound_on(box), box)], math.inf
    for done in range(BOXES):
        worst, part = heap[0]
        if done % ROUND == ROUND - 1:
            if -worst > before / CLOSE and before < math.inf:
                break
            before = -worst
        widths = [(high - low, k) for k, (low, high) in enumerate(part)]
        width, k = max(widths)
        middle = part[k][0] / 2 + part[k][1] / 2
        if -worst <= CLOSE * seen or not part[k][0] < middle < part[k][1] or width == 0:
            break
        heapq.heappop(heap)
        for ends in ((part[k][0], middle), (middle, part[k][1])):
            half = (*part[:k], ends, *part[k + 1 :])
            heapq.heappush(heap, (-bound_on(half), half))
    return -heap[0][0], heap[0][1]


def write_upper(value: float) -> str | None:
    """Three digits of a number, rounded up; None for infinity."""
    if value == math.inf:
        return None
    if value == 0:
        return "0"
    exponent = math.floor(math.log10(value)) - 2
    digits = str(math.ceil(Fraction(value) / Fraction(10) ** exponent))
    return f"{digits[0]}.{digits[1:]}e{exponent + len(digits) - 1}"
