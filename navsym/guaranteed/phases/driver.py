"""The complete solution as a parameter varies: regimes, boundaries, closed forms.

A regime is a range of the parameter with one pattern of instants. Where instants, weights and value have a
closed form it is proved as a primal-dual pair for all values of the regime; elsewhere the optimum is
certified for every value by contacts that are followed rigorously, and slivers around boundaries by
two-sided certificates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

import sympy as sp
from flint import fmpq

from navsym.claims import CERTIFIED, OPEN
from navsym.core.balls import enclose
from navsym.core.exact import decimal, from_decimal, lower_end, to_fmpq, to_fraction, to_rational, upper_end
from navsym.guaranteed.certificate.range import RangeProof
from navsym.guaranteed.phases.answer import Phases, Regime, end_text
from navsym.guaranteed.phases.boundaries import Boundary, locate_boundary, unlocated_boundary
from navsym.guaranteed.phases.budget import DEFAULT_SECONDS, Budget
from navsym.guaranteed.phases.certify_range import covered, follow_regime
from navsym.guaranteed.phases.closed_forms import ClosedForm, propose_closed_forms
from navsym.guaranteed.phases.family import Family
from navsym.guaranteed.phases.narrow import Sliver, certify_slivers
from navsym.guaranteed.phases.neighbours import Ends, boundary_middle, cuts_of, extend_forms, merge_regimes, prove_form
from navsym.guaranteed.phases.patterns import BRACKET, COUNT, PatternInterval, scan_patterns
from navsym.guaranteed.phases.singular_values import (
    RegularInterval,
    SingularValue,
    family_intervals,
    need_range,
    real_intervals,
    singular_boundary,
    split_at_singular_values,
    unsolved_boundary,
)
from navsym.guaranteed.solver import solve_problem

# One regime settled: its proved closed form, or contacts followed for every value, slivers, holes and a table.


POINTS = 5
#: Next to a singular value this part of the range is left, and named in ``uncovered``.
MARGIN = Fraction(1, 100_000)
DIGITS = 34


RegimeLimits = tuple[fmpq, fmpq, fmpq, fmpq]


def regime_limits(
    family: Family,
    lower: sp.Expr,
    upper: sp.Expr,
    low: Fraction,
    high: Fraction,
    changes: Sequence[Boundary],
    singular: set[sp.Expr],
) -> list[RegimeLimits]:
    """For every regime: where it must be covered (outer) and where exact contacts are followed (inner)."""
    margin = to_fmpq(MARGIN * (high - low))
    marks = [end_marks(family, lower, -1, singular, margin)]
    marks += [(from_decimal(b.lower), from_decimal(b.upper)) for b in changes]
    marks.append(end_marks(family, upper, 1, singular, margin))
    done: list[RegimeLimits] = []
    for k, (left, right) in enumerate(pairwise(marks)):
        outer = left[0] if k == 0 else (left[0] + left[1]) / 2
        done.append((outer, left[1], right[0], right[1] if k == len(changes) else (right[0] + right[1]) / 2))
    return done


def end_marks(family: Family, end: sp.Expr, side: int, singular: set[sp.Expr], margin: fmpq) -> tuple[fmpq, fmpq]:
    """An end of the range as two rationals in order, the outer at or beyond it, the inner where contacts start."""
    ball = enclose(end, bits=200)
    if end.is_Rational:
        at = to_fmpq(end)
    else:
        at = from_decimal(lower_end(ball, DIGITS) if side < 0 else upper_end(ball, DIGITS))
    vanishing = side < 0 and end == 0 and family.growing
    inner = at - side * margin if end in singular and not vanishing else at
    return (at, inner) if side < 0 else (inner, at)


def settle_regime(
    family: Family,
    span: PatternInterval,
    ends: tuple[sp.Expr, sp.Expr],
    limits: RegimeLimits,
    closed: ClosedForm | None,
    limit: Budget,
    *,
    certify: bool,
    unique: bool,
) -> tuple[list[Regime], list[tuple[str, str]]]:
    """One regime: its proved closed form, or contacts followed for every value, slivers and holes.

    Where holes are left the regime is given in parts, which lie between them.
    """
    a, b = ends
    name = f"from {end_text(a)} to {end_text(b)}"
    if closed is not None:
        done = follow_within(family, span, limits, limit, name) if unique else RangeProof((), ())
        held, status = (limits[1], limits[2]), closed.verdict.status
        return [Regime(family, span, a, b, closed, status, (), done.documents, (), held, longest_run(done))], []
    shown = limit.share(1 / 4).within(f"the table of values {name}", value_table, family, span) or ()
    if not certify:
        return [Regime(family, span, a, b, None, OPEN, shown)], [(end_text(a, -1), end_text(b, 1))]
    done = follow_within(family, span, limits, limit.share(3 / 4), name)
    thin: list[Sliver] = []
    holes: list[tuple[fmpq, fmpq]] = []
    edges = [limits[0], *(edge for run in covered(done.pieces) for edge in run), limits[3]]
    for left, right in zip(edges[::2], edges[1::2], strict=True):
        made, left_over = certify_slivers(family, left, right, limit.met) if left < right else ([], [])
        thin += made
        holes += left_over
    run = longest_run(done)
    status = CERTIFIED if run is not None else OPEN
    whole = Regime(family, span, a, b, None, status, shown, done.documents, tuple(thin), run, run)
    parts = cut_at_holes(whole, done, limits, holes) if run is not None and holes else [whole]
    return parts, [(end_text(to_rational(p), -1), end_text(to_rational(q), 1)) for p, q in holes]


def cut_at_holes(
    regime: Regime, done: RangeProof, limits: RegimeLimits, holes: Sequence[tuple[fmpq, fmpq]]
) -> list[Regime]:
    """The parts of a regime between its holes, each with the pieces, slivers and values that lie in it."""
    marks = [limits[0], *(edge for hole in holes for edge in hole), limits[3]]
    parts, name = [], regime.family.parameter.name
    # A range certificate stands alone or with the identities that tie it to the problem.
    starts = [to_fmpq(sp.Rational(c.get("of", [c])[0]["from"])) for c in regime.certificates]
    for a, b in zip(marks[::2], marks[1::2], strict=True):
        runs = [run for run in covered(done.pieces) if a <= run[0] and run[1] <= b]
        slivers = tuple(s for s in regime.slivers if a <= s.start and s.end <= b)
        if not runs and not slivers:
            continue
        run = max(runs, key=lambda one: one[1] - one[0], default=None)
        part = replace(
            regime,
            lower=regime.lower if a == limits[0] else to_rational(a),
            upper=regime.upper if b == limits[3] else to_rational(b),
            table=tuple(row for row in regime.table if a <= to_fmpq(sp.Rational(row[name])) <= b),
            certificates=tuple(c for at, c in zip(starts, regime.certificates, strict=True) if a <= at < b),
            slivers=slivers,
            status=OPEN if run is None else CERTIFIED,
            held=run,
            alone=run,
        )
        parts.append(part)
    return parts


def follow_within(family: Family, span: PatternInterval, limits: RegimeLimits, limit: Budget, name: str) -> RangeProof:
    """The contacts of a regime followed as far as the tests and the limit allow."""
    done = follow_regime(family, span.pattern, limits[1], limits[2], limit.met)
    if limit.met():
        limit.gives_up(f"following the contacts {name}")
    return done


def longest_run(done: RangeProof) -> tuple[fmpq, fmpq] | None:
    """The longest stretch that the followed contacts cover without a gap."""
    return max(covered(done.pieces), key=lambda run: run[1] - run[0], default=None)


def value_table(family: Family, span: PatternInterval) -> tuple[dict[str, Any], ...]:
    """Enclosures of the value, instants and weights at a few values of the parameter."""
    rows = []
    for k in range(POINTS):
        T = (span.lower + (span.upper - span.lower) * Fraction(2 * k + 1, 2 * POINTS)).limit_denominator(1000)
        found = solve_problem(family.problem(to_rational(T)), 20)
        places, end = [point.document() for point in found.support], family.at(family.stop, to_rational(T))
        for place in places if family.backward else ():
            place["at"] = decimal(to_fmpq(enclose(end - sp.Rational(place["at"]), bits=200)), 20)
        places.sort(key=lambda place: sp.Rational(place["at"]))
        rows.append({family.parameter.name: str(T), "lower": found.lower, "upper": found.upper, "support": places})
    return tuple(rows)


# Where the pattern changes, from closed forms that are proved between the changes.
#
# A change is located from closed forms as they are guessed; they are proved between the changes. Where a proof fails
# a change that rests on the guess is located again without it, and what is proved on either side is proved anew.


Forms = Sequence[ClosedForm | None]


def locate_changes(
    family: Family, spans: Sequence[PatternInterval], closed: Sequence[ClosedForm | None], limit: Budget
) -> tuple[Boundary, ...]:
    """The changes from each span to the next, as exactly as they are had within the limit."""
    shares = (limit.share(1 / (len(spans) - 1 - k)) for k in range(len(spans) - 1))
    return tuple(
        locate_change(family, left, right, part, *forms) or unlocated_boundary(left.upper)
        for part, (left, right), forms in zip(shares, pairwise(spans), pairwise(closed), strict=False)
    )


def locate_change(
    family: Family,
    left: PatternInterval,
    right: PatternInterval,
    limit: Budget,
    before: ClosedForm | None = None,
    after: ClosedForm | None = None,
) -> Boundary | None:
    """The change from one span to the next; None when it is not had within the limit."""
    return limit.within(
        f"the change of pattern near {float(left.upper):.6g}", locate_boundary, family, left, right, before, after
    )  # type: ignore[no-any-return]


def agree_on_forms(
    family: Family,
    spans: Sequence[PatternInterval],
    guesses: Sequence[Sequence[ClosedForm]],
    changes: Sequence[Boundary],
    ends: Ends,
    limit: Budget,
) -> tuple[list[Boundary], list[ClosedForm | None]]:
    """The changes and the closed forms proved between them, each in agreement with the other.

    changes : located from the first guess of every span
    After the first round a form only stays or falls, and no change moves unless one beside it fell.
    """
    rest: list[ClosedForm | None] = [g[0] if g else None for g in guesses]
    parts = list(pairwise(cuts_of(changes, ends)))
    forms = [
        prove_form(family, g, part, limit.share(1 / (len(spans) - k)))
        for k, (g, part) in enumerate(zip(guesses, parts, strict=True))
    ]
    while not all(map(is_same_form, rest, forms)):
        changes, before = relocate_changes(family, spans, changes, rest, forms, limit), parts
        rest, parts = forms, list(pairwise(cuts_of(changes, ends)))
        forms = [
            form if form is None or part == old else prove_form(family, [form], part, limit.share(1 / 2))
            for form, part, old in zip(rest, parts, before, strict=True)
        ]
    return list(changes), forms


def relocate_changes(
    family: Family,
    spans: Sequence[PatternInterval],
    changes: Sequence[Boundary],
    rest: Forms,
    forms: Forms,
    limit: Budget,
) -> list[Boundary]:
    """The changes, those located again that rest on another closed form than is proved beside them."""
    found = []
    for k, b in enumerate(changes):
        if b.at is not None and not (is_same_form(rest[k], forms[k]) and is_same_form(rest[k + 1], forms[k + 1])):
            left, right = spans[k : k + 2]
            b = locate_change(family, left, right, limit, *forms[k : k + 2]) or unlocated_boundary(left.upper)
        found.append(b)
    return found


def is_same_form(one: ClosedForm | None, other: ClosedForm | None) -> bool:
    """True for the same estimator and dual, whatever the verdicts."""
    if one is None or other is None:
        return one is other
    return (one.panels, one.places, one.weights, one.dual) == (other.panels, other.places, other.weights, other.dual)


#: A span below this part of the range is given up when its neighbours are proved to meet.
SHORT = Fraction(1, 50)


def find_phases(
    family: Family,
    lower: sp.Expr,
    upper: sp.Expr,
    *,
    certify: bool = True,
    unique: bool = False,
    seconds: float = DEFAULT_SECONDS,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> Phases:
    """All regimes for values of the parameter between two exact numbers.

    The range is split at singular values. certify : follow regimes without a closed form rigorously.
    unique : follow the others as well, which proves that no other estimator is optimal.
    seconds : of work, after which what is known is returned: ``uncovered`` names the rest, ``given_up`` what was left
    progress : called with (finished, all) steps of the search: each stretch is scanned, each regime settled
    Raises DomainError for a range without length, lengths of the interval below zero, and seconds that are none.
    """
    need_range(family, lower, upper)
    limit = Budget.of(seconds)
    plan, lost, edges = plan_range(family, lower, upper, limit.share(1 / 4))
    steps = StepCounter(progress, len(plan) * (COUNT - 1))
    parts = [
        solve_interval(section, steps, limit.share(1 / (len(plan) - k)), certify=certify, unique=unique)
        for k, section in enumerate(plan)
    ]
    uncovered = [*lost, *(pair for part in parts for pair in part.uncovered)]
    singular = {s.at: s for section in plan for s in section.singular}
    known = [singular_boundary(s) for s in singular.values() if not (s.at == lower == 0 and plan[0].family.growing)]
    known += [unsolved_boundary(section) for section in plan if section.unknown]
    changes = {b if b.at is None else b.at: b for b in (*known, *edges)}
    inner = [b for part in parts for b in part.boundaries]
    ties = {id(tie): tie for section in plan for tie in section.ties}
    return Phases(
        plan[-1].family if plan else family,
        lower,
        upper,
        tuple(regime for part in parts for regime in part.regimes),
        tuple(sorted((*changes.values(), *inner), key=lambda b: sp.Rational(b.lower))),
        tuple(uncovered),
        tuple(ties.values()),
        tuple(limit.given_up),
    )


def plan_range(
    family: Family, lower: sp.Expr, upper: sp.Expr, limit: Budget
) -> tuple[list[RegularInterval], list[tuple[str, str]], list[Boundary]]:
    """Regular intervals of the range, the ends of parts without any, and boundaries of imaginary parts.

    Parts without any are imaginary, or were not split within the budget.
    """
    plan: list[RegularInterval] = []
    lost: list[tuple[str, str]] = []
    edges: list[Boundary] = []
    for part in family_intervals(family, lower, upper):
        real, imaginary = real_intervals(*part)
        lost += [(end_text(one.lower), end_text(one.upper)) for one in imaginary]
        name = family.parameter.name
        inside = ((end, one) for one in imaginary for end in (one.lower, one.upper) if end not in (lower, upper))
        edges += [singular_boundary(SingularValue(end, one.in_words(name))) for end, one in inside]
        for one in real:
            ends = end_text(one[1]), end_text(one[2])
            found = limit.share(1 / 2).within(
                f"singular values from {ends[0]} to {ends[1]}", split_at_singular_values, *one
            )
            plan += found or []
            lost += [ends] if found is None else []
    return plan, lost, edges


class StepCounter:
    """Counts the steps of a search that finds more of them on its way.

    A closed form that is guessed and one that is settled are worth ten looks of a scan each.
    """

    LOOKS = 10

    def __init__(self, progress: Callable[[int, int], None], of: int):
        self.progress, self.done, self.of = progress, 0, of

    def found(self, regimes: int) -> None:
        """The scan of a stretch found so many regimes to settle."""
        self.of += 2 * regimes * self.LOOKS
        self.progress(self.done, self.of)

    def did(self, steps: int = 1) -> None:
        """So many steps are done."""
        self.done += steps
        self.progress(self.done, self.of)


def solve_interval(section: RegularInterval, steps: StepCounter, limit: Budget, **follow: bool) -> Phases:
    """All regimes between two values without a singular one inside."""
    family, lower, singular = section.family, section.lower, section.names
    low, high = inner_range(lower, section.upper, singular)
    spans = scan_interval(family, low, high, steps, limit)
    upper = section.upper if spans[-1].upper == high else to_rational(spans[-1].upper)
    spans = drop_accidental_intervals(family, spans, limit.share(1 / 4))
    steps.found(len(spans))
    guesses = guess_forms(family, spans, steps, limit.share(1 / 2))
    spans, guesses = limit.share(1 / 4).within("closed forms next to others", extend_forms, family, spans, guesses) or (
        spans,
        guesses,
    )
    first = locate_changes(family, spans, [g[0] if g else None for g in guesses], limit.share(1 / 2))
    changes, forms = agree_on_forms(family, spans, guesses, first, (lower, upper), limit.share(3 / 4))
    merge_regimes(family, spans, forms, changes, (lower, upper), limit.share(1 / 4))
    cuts = cuts_of(changes, (lower, upper))
    limits = regime_limits(family, lower, upper, low, high, changes, singular)
    regimes: list[list[Regime]] = []
    uncovered = []
    for k, span in enumerate(spans):
        part = limit.share(1 / (len(spans) - k))
        parts, holes = settle_regime(family, span, (cuts[k], cuts[k + 1]), limits[k], forms[k], part, **follow)
        regimes.append(parts)
        uncovered += holes
        steps.did(StepCounter.LOOKS)
    if upper != section.upper:
        uncovered.append((end_text(upper, -1), end_text(section.upper)))
    honest = tuple(
        b if b.proved else bracket_boundary(b, before[-1], after[0])
        for b, (before, after) in zip(changes, pairwise(regimes), strict=True)
    )
    rows = tuple(regime for parts in regimes for regime in parts)
    return Phases(family, lower, upper, rows, honest, tuple(uncovered))


def scan_interval(
    family: Family, low: Fraction, high: Fraction, steps: StepCounter, limit: Budget
) -> list[PatternInterval]:
    """The spans of a section, up to where half of its time allows."""
    half = limit.share(1 / 2)

    def step() -> bool:
        steps.did()
        return not half.met()

    spans = scan_patterns(family, low, high, step=step)
    if spans[-1].upper != high:
        limit.gives_up(f"the search for patterns from {float(spans[-1].upper):.6g} to {float(high):.6g}")
    return spans


def guess_forms(
    family: Family, spans: Sequence[PatternInterval], steps: StepCounter, limit: Budget
) -> list[list[ClosedForm]]:
    """Closed forms of every span, not yet proved."""
    found = []
    for k, span in enumerate(spans):
        what = f"the search for a closed form from {float(span.lower):.6g} to {float(span.upper):.6g}"
        found.append(limit.share(1 / (len(spans) - k)).within(what, propose_closed_forms, family, span) or [])
        steps.did(StepCounter.LOOKS)
    return found


def drop_accidental_intervals(family: Family, spans: list[PatternInterval], limit: Budget) -> list[PatternInterval]:
    """The intervals without short ones between neighbours that are proved to follow each other.

    There contacts merge, and the search in double precision takes one pattern for another, or for several.
    """
    short = SHORT * (spans[-1].upper - spans[0].lower)
    kept, rest = spans[:1], spans[1:]
    while rest:
        beyond = next((k for k, span in enumerate(rest) if span.upper - span.lower >= short), 0)
        found = locate_change(family, kept[-1], rest[beyond], limit) if beyond else None
        if found is not None and found.proved:
            cut = to_fraction(enclose(boundary_middle(found), bits=200))
            kept[-1], rest = replace(kept[-1], upper=cut), rest[beyond:]
            rest[0] = replace(rest[0], lower=cut)
        kept.append(rest.pop(0))
    return kept


def bracket_boundary(guess: Boundary, before: Regime, after: Regime) -> Boundary:
    """A change that was not located lies between the last value of one proved pattern and the first of the other.

    Where a pattern is proved nowhere, the bracket is that of the search, and the regime is uncovered. Where both are
    proved up to one value it is the bracket of that value in the search: either may go on beyond.
    """
    last = before.held[1] if before.held else to_fmpq(before.span.lower)
    first = after.held[0] if after.held else to_fmpq(after.span.upper)
    if not last < first:
        last, first = min(last, first) - to_fmpq(BRACKET), max(last, first) + to_fmpq(BRACKET)
    return replace(guess, lower=decimal(last, DIGITS, -1), upper=decimal(first, DIGITS, 1))


def inner_range(lower: sp.Expr, upper: sp.Expr, singular: set[sp.Expr]) -> tuple[Fraction, Fraction]:
    """Rational values just inside the range, further inside at singular ends."""
    a, b = (to_fraction(enclose(e, bits=200)) for e in (lower, upper))
    steps = [Fraction(1, 400) if e in singular else Fraction(1, 10**9) for e in (lower, upper)]
    low, high = a + steps[0] * (b - a), b - steps[1] * (b - a)
    return low.limit_denominator(10**12), high.limit_denominator(10**12)
