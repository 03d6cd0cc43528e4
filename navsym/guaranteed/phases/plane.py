"""Maps in two parameters: regions with closed forms between curves, each proved as a whole; points where curves meet.

The one-parameter search sketches slices, at a few values of the second parameter. Places and changes that are exact on
slices with the same order of patterns are recognised as formulas in the second parameter; weights and dual follow by
exact algebra with both parameters free. A part of a region lies between two curves ``first = b(second)``: with
``first = left + (right - left) s`` it is a box, and the closed form is proved on all of it, as that of a regime is.
Slices propose and prove nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations, groupby, pairwise

import sympy as sp

from navsym.claims import OPEN, REFUTED
from navsym.core.balls import enclose
from navsym.core.errors import NavsymError
from navsym.core.exact import to_rational
from navsym.guaranteed.estimability import is_equal
from navsym.guaranteed.phases.answer import Curve, Meeting, Part, PhaseMap, Regime
from navsym.guaranteed.phases.boundaries import boundary_events, recognise_root
from navsym.guaranteed.phases.budget import Budget
from navsym.guaranteed.phases.closed_forms import (
    ClosedForm,
    complete_forms,
    decide_form,
    recognise_places,
    sample_regime,
    signed_parameter,
)
from navsym.guaranteed.phases.driver import Ends, StepCounter, inner_range, is_same_form, plan_range, scan_interval
from navsym.guaranteed.phases.family import Family
from navsym.guaranteed.phases.patterns import Pattern, PatternInterval
from navsym.guaranteed.phases.recognise import simple_place
from navsym.guaranteed.phases.singular_values import need_order, need_range

#: Slices at first; one more within this part of the range from each end; and the parts of the range down to which
#: slices are put between different orders of patterns, and beside orders that few have.
SLICES, OUTERMOST, NEAR, NARROWEST = 7, Fraction(1, 50), Fraction(1, 40), Fraction(1, 800)
#: Slices that an order of patterns needs: two determine a line, the third confirms it.
ENOUGH = 3
#: A part that is not proved at once is halved so often.
HALVINGS = 2
#: How near to a change that a scan saw its curve has to pass.
CLOSE = 1e-4
#: Exact numbers nearer than this are looked at for equality.
SAME = 1e-9
#: Seconds for the first attempt in each coordinate: a proof that exists is mostly had soon.
QUICK = 12.0
#: Digits of the constants from which formulas are recognised.
DIGITS = 90
#: The share of a part, from its left curve to its right one.
ACROSS = sp.Symbol("across", positive=True)


@dataclass(frozen=True, slots=True, eq=False)
class Slice:
    """One value of the second parameter: patterns in order, and the places of their measurements where these are exact.

    singular : for each change of pattern the singular value at which it is, or None
    """

    value: sp.Rational
    spans: tuple[PatternInterval, ...]
    places: tuple[tuple[sp.Expr, ...] | None, ...]
    singular: tuple[sp.Expr | None, ...]

    @property
    def order(self) -> tuple[Pattern, ...]:
        """The patterns in order."""
        return tuple(span.pattern for span in self.spans)


@dataclass(frozen=True, slots=True, eq=False)
class Band:
    """Slices next to each other with one order of patterns, lifted: forms and curves with both parameters free."""

    slices: tuple[Slice, ...]
    forms: tuple[ClosedForm | None, ...]
    curves: tuple[sp.Expr | None, ...]
    why: tuple[str, ...]
    family: Family

    @property
    def middle(self) -> Slice:
        """The slice in the middle, whose values a search takes."""
        return self.slices[len(self.slices) // 2]

    @property
    def edges(self) -> Ends:
        """The values of its first and last slice."""
        return self.slices[0].value, self.slices[-1].value


def find_map(
    family: Family,
    second: sp.Symbol,
    first_ends: Ends,
    second_ends: Ends,
    limit: Budget,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> PhaseMap:
    """The map of a family with one parameter beside: regions, curves, meeting points, and what is not proved."""
    need_range(family, *first_ends)
    need_order(*second_ends)
    steps = StepCounter(progress, 0)
    slices = cut_slices(family, second, first_ends, second_ends, limit.share(1 / 2), steps)
    groups = [list(run) for _, run in groupby(slices, key=lambda one: one.order)]
    bands = [lift_band(family, second, group, limit.share(1 / 4)) for group in groups]
    cuts = cut_range(bands, second, first_ends, second_ends)
    parts: list[Part] = []
    for k, (band, (before, after)) in enumerate(zip(bands, pairwise(cuts), strict=False)):
        parts += prove_band(band, second, first_ends, (before[1], after[0]), limit.share(1 / (len(bands) - k)))
    gaps = [pair for pair in (cuts if bands else [second_ends]) if pair[0] != pair[1]]
    curves = join_curves(bands, cuts, first_ends, second) if bands else []
    meetings = find_meetings(curves, cuts, family.parameter, second)
    return PhaseMap(
        family,
        second,
        first_ends,
        second_ends,
        tuple(parts),
        tuple(curves),
        tuple(meetings),
        tuple(gaps),
        tuple(limit.given_up),
    )


def cut_slices(
    family: Family, second: sp.Symbol, first_ends: Ends, second_ends: Ends, limit: Budget, steps: StepCounter
) -> list[Slice]:
    """Slices in order of the second parameter: about equally spaced ones, and more where orders of patterns change.

    Their values are short fractions: a search for exact constants knows no others.
    """
    low, high = (Fraction(str(sp.N(end, 30))) for end in second_ends)
    found: dict[Fraction, Slice | None] = {}

    def cut(a: Fraction, b: Fraction) -> None:
        value = simplest_between(a + (b - a) / 4, b - (b - a) / 4)
        exact = to_rational(value)
        one = slice_family(family, second, exact)
        found[value] = sketch_slice(one, exact, first_ends, limit.share(1 / 4), steps)

    marks = [Fraction(0), OUTERMOST, *(Fraction(k, SLICES) for k in range(1, SLICES)), 1 - OUTERMOST, Fraction(1)]
    for a, b in pairwise(low + (high - low) * mark for mark in marks):
        cut(a, b)
    while not limit.met():
        gap = next(gaps_to_cut({v: one for v, one in found.items() if one is not None}, low, high, found), None)
        if gap is None:
            break
        cut(*gap)
    return [one for _, one in sorted(found.items()) if one is not None]


def simplest_between(a: Fraction, b: Fraction) -> Fraction:
    """The fraction with the least denominator between two others."""
    bottom = next(d for d in range(1, 10**9) if math.ceil(a * d) <= b * d)
    return Fraction(math.ceil(a * bottom), bottom)


def gaps_to_cut(
    slices: dict[Fraction, Slice], low: Fraction, high: Fraction, tried: Collection[Fraction]
) -> Iterator[tuple[Fraction, Fraction]]:
    """Gaps between slices in which one more helps.

    They lie between different orders of patterns, or beside an order that fewer than ENOUGH slices have.
    """
    values = sorted(slices)
    orders = [None, *(slices[value].order for value in values), None]
    groups = [len(run) for run in (list(run) for _, run in groupby(orders)) for _ in run]
    for k, (a, b) in enumerate(pairwise([low, *values, high])):
        rare = min(groups[k] if orders[k] else ENOUGH, groups[k + 1] if orders[k + 1] else ENOUGH) < ENOUGH
        least = NARROWEST if rare else NEAR if None not in orders[k : k + 2] else Fraction(2)
        new = not any(a < value < b for value in tried)
        if b - a > least * (high - low) and orders[k] != orders[k + 1] and new:
            yield a, b


def slice_family(family: Family, second: sp.Symbol, value: sp.Rational) -> Family:
    """The family with one parameter: a value for the second."""
    put = lambda e: sp.sympify(e, strict=True).subs(second, value)  # noqa: E731
    return replace(
        family,
        rows=tuple(tuple(map(put, row)) for row in family.rows),
        functional=tuple(map(put, family.functional)),
        sigma=tuple(map(put, family.sigma)),
        start=put(family.start),
        end=put(family.stop),
        cuts=tuple(map(put, family.cuts)),
        beside={},
    )


def sketch_slice(family: Family, value: sp.Rational, ends: Ends, limit: Budget, steps: StepCounter) -> Slice | None:
    """The slice at a value; None where the one-parameter search fails or leaves a part out."""
    spans: list[PatternInterval] = []
    places: list[tuple[sp.Expr, ...] | None] = []
    singular: list[sp.Expr | None] = []
    try:
        plan, lost, _ = plan_range(family, *ends, limit)
        for section in plan:
            if section.family.left_out or lost:
                return None
            low, high = inner_range(section.lower, section.upper, section.names)
            here = scan_interval(section.family, low, high, steps, limit)
            if here[-1].upper != high:
                return None
            singular += [*([section.lower] if spans else []), *([None] * (len(here) - 1))]
            places += [recognise_places(section.family, s, sample_regime(section.family, s)) for s in here]
            spans += here
    except NavsymError:
        return None
    return Slice(value, tuple(spans), tuple(places), tuple(singular)) if spans else None


# From slices to formulas


def lift_band(family: Family, second: sp.Symbol, slices: Sequence[Slice], limit: Budget) -> Band:
    """Closed forms and curves with both parameters free, as far as the slices determine them."""
    middle = slices[len(slices) // 2]
    here = replace(family, beside={second: middle.value})
    forms: list[ClosedForm | None] = []
    for k in range(len(middle.spans)):
        what = f"a formula on slice {second.name} = {middle.value}"
        forms.append(limit.share(1 / 2).within(what, lift_form, here, second, slices, k))
    found = [lift_curve(here, second, slices, forms, k) for k in range(len(middle.singular))]
    return Band(tuple(slices), tuple(forms), tuple(at for at, _ in found), tuple(why for _, why in found), here)


def lift_form(family: Family, second: sp.Symbol, slices: Sequence[Slice], k: int) -> ClosedForm | None:
    """The closed form of the k-th pattern of a band; None when its places are not recognised."""
    known = [(one, places) for one in slices if (places := one.places[k]) is not None]
    if len(known) < ENOUGH:
        return None
    clear = [one for one, _ in known]
    columns = zip(*(places for _, places in known), strict=True)
    lifted = [lift_place(column, clear, family.parameter, second) for column in columns]
    places = tuple(place for place in lifted if place is not None)
    middle = clear[len(clear) // 2]
    here = replace(family, beside={second: middle.value})
    samples = sample_regime(here, middle.spans[k]) if len(places) == len(lifted) else []
    guesses = complete_forms(here, middle.spans[k], places, samples) if samples else []
    return next(iter(guesses), None)


def lift_curve(
    family: Family, second: sp.Symbol, slices: Sequence[Slice], forms: Sequence[ClosedForm | None], k: int
) -> tuple[sp.Expr | None, str]:
    """The curve between two patterns of a band, on which a weight, a room or a slack of a closed form vanishes."""
    if slices[0].singular[k] is not None:
        return lift_numbers([one.singular[k] for one in slices], slices, second), "the regressors are dependent"
    T, spans = family.parameter, slices[len(slices) // 2].spans
    for event, why in boundary_events(family, spans[k], forms[k], spans[k + 1], forms[k + 1]):
        at = lift_roots(event, T, second, slices, k)
        if at is not None:
            return at, why
    return None, ""


def lift_roots(event: sp.Expr, T: sp.Symbol, second: sp.Symbol, slices: Sequence[Slice], k: int) -> sp.Expr | None:
    """A formula of the roots of an event on slices, next to the changes that the scans saw."""
    found: list[tuple[Slice, sp.Expr]] = []
    for one in slices:
        guess = float(one.spans[k].upper)
        root = recognise_root(event.subs(second, one.value), T, guess, CLOSE * max(1.0, guess))
        found += [] if root is None else [(one, root)]
        if not found:
            return None
    return lift_numbers([root for _, root in found], [one for one, _ in found], second)


def lift_place(
    column: Sequence[sp.Expr], slices: Sequence[Slice], first: sp.Symbol, second: sp.Symbol
) -> sp.Expr | None:
    """A place as a formula in both parameters, from its formulas ``a first + b + c/first`` on slices."""
    polynomials = [sp.Poly(sp.expand(place * first), first) for place in column]
    total = sp.S.Zero
    for power in range(3):
        factor = lift_numbers([p.coeff_monomial(first**power) for p in polynomials], slices, second)
        if factor is None:
            return None
        total += factor * first ** (power - 1)
    exact = all(p.degree() <= 2 for p in polynomials)
    return total if exact else None


def lift_numbers(numbers: Sequence[sp.Expr | None], slices: Sequence[Slice], second: sp.Symbol) -> sp.Expr | None:
    """A formula in the second parameter with these exact values: linear in it or its reciprocal, or the root of one."""
    known = [x for x in numbers if x is not None and not x.free_symbols]
    if len(known) < max(len(numbers), ENOUGH):
        return None
    values = [sp.Rational(str(sp.N(x, DIGITS))) for x in known]
    where = [one.value for one in slices]
    found = simple_place(values, where, second)
    if found is None and all(v > 0 for v in values):
        square = simple_place([sp.Rational(str(sp.N(x**2, DIGITS))) for x in known], where, second)
        found = None if square is None else sp.sqrt(square)
    return found


# Where one order of patterns ends and the next begins


def cut_range(bands: Sequence[Band], second: sp.Symbol, first_ends: Ends, second_ends: Ends) -> list[Ends]:
    """The ends of the second range, and where each band ends and the next begins: in order, some as gaps."""
    beyond = to_double(second_ends[1] - second_ends[0]) * float(NEAR)
    cuts = [(second_ends[0], second_ends[0])]
    for one, other in pairwise(bands):
        cut, last = meet_bands(one, other, second, first_ends, beyond), cuts[-1][1]
        if not to_double(last) < to_double(cut[0]) <= to_double(cut[1]) < to_double(second_ends[1]):
            start = max(last, one.edges[1], key=to_double)
            cut = start, max(start, other.edges[0], key=to_double)
        cuts.append(cut)
    return [*cuts, (second_ends[1], second_ends[1])]


def meet_bands(one: Band, other: Band, second: sp.Symbol, first_ends: Ends, beyond: float) -> Ends:
    """Where one band ends and the next begins: the same exact value twice, or the last slice and the first.

    There two curves of a band meet, one of them meets an end of the first range, or two values are equal. A scan does
    not see patterns next to an end of its range, so that the value may lie a little beyond the slices.
    """
    low, high = one.edges[1], other.edges[0]
    middle, reach = float(low + high) / 2, float(high - low) / 2 + beyond
    found: dict[sp.Expr, int] = {}
    for event in [*closing_events(one, first_ends), *closing_events(other, first_ends), *value_events(one, other)]:
        root = recognise_root(sp.together(event), second, middle, reach)
        if root is not None:
            found[root] = found.get(root, 0) + 1
    best = max(found, key=lambda root: found[root], default=None)
    return (low, high) if best is None else (best, best)


def closing_events(band: Band, first_ends: Ends) -> Iterator[sp.Expr]:
    """Distances of curves of a band from each other and from the ends of the first range; one that vanishes ends it."""
    known = [at for at in band.curves if at is not None]
    yield from (b - a for a, b in combinations([*known, *first_ends], 2) if (b - a).free_symbols)


def value_events(one: Band, other: Band) -> Iterator[sp.Expr]:
    """Differences of values of two bands that do not depend on the first parameter, up to factors that do."""
    T = one.family.parameter
    for a in one.forms:
        for b in other.forms:
            if a is None or b is None or a.value == b.value:
                continue
            for factor in sp.Mul.make_args(sp.factor(sp.together(a.value - b.value))):
                if T not in factor.free_symbols and factor.free_symbols:
                    yield factor.args[0] if factor.is_Pow else factor


# Proofs


def prove_band(band: Band, second: sp.Symbol, first_ends: Ends, ends: Ends, limit: Budget) -> list[Part]:
    """Parts between the known curves of a band, from one end of the first range to the other.

    Every value of the first parameter lies between two neighbours, in whatever order the curves are.
    """
    marks = [first_ends[0], *band.curves, first_ends[1]]
    known = [k for k, mark in enumerate(marks) if mark is not None]
    parts: list[Part] = []
    for j, (a, b) in enumerate(pairwise(known) if to_double(ends[1] - ends[0]) > 0 else ()):
        share = limit.share(1 / (len(known) - 1 - j))
        form = band.forms[a] if b == a + 1 else None
        rest = Part(*ends, Regime(band.family, band.middle.spans[a], marks[a], marks[b], None, OPEN))  # type: ignore[arg-type]
        parts += [rest] if form is None else prove_part(rest, form, second, share, HALVINGS, band.edges)
    return parts


def prove_part(
    part: Part, form: ClosedForm, second: sp.Symbol, limit: Budget, halvings: int, edges: Sequence[sp.Expr] = ()
) -> list[Part]:
    """A part with its closed form, where that is proved on all of it; else cut at the edges, and then in halves."""
    regime = part.regime
    if limit.met():
        limit.gives_up(f"the proof of a closed form for {second.name} from {part.low} to {part.high}")
        return [part]
    name, value, box = signed_parameter(second, part.low, part.high)
    choices = list(first_coordinates(part, second))
    for k, (at, ends) in enumerate([*choices, *choices]):
        puts = {regime.family.parameter: at.subs(second, value), second: value}
        seconds = limit.share(1 / (2 * len(choices) - k + (halvings > 0))).left()
        seconds = min(seconds, QUICK) if k < len(choices) else seconds
        verdict = decide_form(regime.family, form, puts, {ACROSS: ends, name: box}, seconds, most=0)
        if verdict.status.holds and not verdict.assumptions:
            proved = replace(form, verdict=verdict)
            return [replace(part, regime=replace(regime, closed=proved, status=verdict.status))]
        if verdict.status is REFUTED:
            break
    if not halvings:
        return [part]
    inside = [e for e in edges if bool(enclose(part.low) < enclose(e)) and bool(enclose(e) < enclose(part.high))]
    marks = [part.low, *(inside or [(part.low + part.high) / 2]), part.high]
    done: list[Part] = []
    for k, (low, high) in enumerate(pairwise(marks)):
        share = limit.share(1 / (len(marks) - 1 - k))
        done += prove_part(replace(part, low=low, high=high), form, second, share, halvings - 1)
    return done


def first_coordinates(part: Part, second: sp.Symbol) -> Iterator[tuple[sp.Expr, Ends]]:
    """The first parameter as ``left + (right - left) s``, or as ``g s`` with a curve ``c g`` beside the part; and s.

    Each takes all values in the part; the second may take more, where the closed form then has to hold as well.
    """
    left, right = part.regime.lower, part.regime.upper
    yield left + (right - left) * ACROSS, (sp.S.Zero, sp.S.One)
    if bool(enclose(part.low) > 0):
        for g in dict.fromkeys(side.as_independent(second)[1] for side in (left, right)):
            ratios = [side / g for side in (left, right)]
            if all(is_power(ratio, second) for ratio in ratios):
                ends = [ratio.subs(second, end) for end in (part.low, part.high) for ratio in ratios]
                yield g * ACROSS, (min(ends, key=to_double), max(ends, key=to_double))


def is_power(ratio: sp.Expr, second: sp.Symbol) -> bool:
    """True for a positive number times a power of the second parameter, which is positive: it is monotone."""
    factor, power = ratio.as_independent(second)
    base, exponent = power.as_base_exp()
    good = power == 1 or (base == second and exponent.is_Rational)
    return bool(good and bool(enclose(factor) > 0))


# Curves and the points where they meet


def join_curves(bands: Sequence[Band], cuts: Sequence[Ends], first_ends: Ends, second: sp.Symbol) -> list[Curve]:
    """Curves between different closed forms; the same formula in neighbouring bands is one curve."""
    found: dict[sp.Expr, Curve] = {}
    for band, (before, after) in zip(bands, pairwise(cuts), strict=True):
        for k, at in enumerate(band.curves):
            if at is None or is_same_form(band.forms[k], band.forms[k + 1]):
                continue
            old = found.get(at)
            low = before[1] if old is None else old.low
            found[at] = Curve(band.family.parameter.name, at, second.name, low, after[0], band.why[k])
    upright = [
        one
        for pair, cut in zip(pairwise(bands), cuts[1:-1], strict=True)
        for one in split_at(*pair, cut, first_ends, second)
    ]
    return [*found.values(), *upright]


def split_at(one: Band, other: Band, cut: Ends, first_ends: Ends, second: sp.Symbol) -> Iterator[Curve]:
    """The stretches of an exact end of two bands on which their closed forms differ."""
    if cut[0] != cut[1]:
        return
    for i, mine in enumerate(sides_at(one, first_ends, second, cut[0])):
        for j, theirs in enumerate(sides_at(other, first_ends, second, cut[0])):
            if mine is None or theirs is None or is_same_form(one.forms[i], other.forms[j]):
                continue
            low, high = max(mine[0], theirs[0], key=to_double), min(mine[1], theirs[1], key=to_double)
            if to_double(high - low) > SAME:
                why = "the order of the patterns changes"
                yield Curve(second.name, cut[0], one.family.parameter.name, low, high, why)


def sides_at(band: Band, first_ends: Ends, second: sp.Symbol, value: sp.Expr) -> list[Ends | None]:
    """The values between which each pattern of a band lies on a slice; None where they are not known."""
    marks = [
        None if mark is None else mark.subs(second, value) for mark in (first_ends[0], *band.curves, first_ends[1])
    ]
    return [None if a is None or b is None else (a, b) for a, b in pairwise(marks)]


def find_meetings(curves: Sequence[Curve], cuts: Sequence[Ends], first: sp.Symbol, second: sp.Symbol) -> list[Meeting]:
    """Points at exact ends of bands through which two curves pass."""
    found: list[Meeting] = []
    for z in (a for a, b in cuts[1:-1] if a == b):
        marks = [(e, c) for c in curves for e in c.values_at(second.name, z)]
        for at, _ in marks:
            near = [c for e, c in marks if abs(to_double(e - at)) < SAME and is_equal(e, at)]
            new = all(abs(to_double(at - m.first)) > SAME or m.second != z for m in found)
            if len({c.at for c in near}) > 1 and new:
                found.append(Meeting(first.name, at, second.name, z, tuple(c.equation for c in near)))
    return found


def to_double(x: sp.Expr) -> float:
    """A double next to an exact number."""
    return float(enclose(x).mid())
