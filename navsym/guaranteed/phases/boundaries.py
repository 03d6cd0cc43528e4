"""Where one regime ends and the next begins: located from closed forms, or by Newton and two proofs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import sympy as sp
from flint import arb, arb_mat

from navsym.core.balls import enclose, precision
from navsym.core.exact import decimal, lower_end, to_fmpq, to_rational, upper_end
from navsym.guaranteed.certificate.basis import make_basis, unit_fraction
from navsym.guaranteed.certificate.enclosure import PanelProblem, dot_product
from navsym.guaranteed.certificate.fixed import certify_touch, stationary_fraction
from navsym.guaranteed.certificate.polish import ContactSolution, sharpen_contacts
from navsym.guaranteed.estimability import is_equal
from navsym.guaranteed.phases import walk
from navsym.guaranteed.phases.closed_forms import BITS, GOAL, ClosedForm
from navsym.guaranteed.phases.family import Family, U
from navsym.guaranteed.phases.patterns import Pattern, PatternInterval, contact_pattern, sample_contacts
from navsym.guaranteed.phases.recognise import recognise_constant
from navsym.guaranteed.phases.walk import walk_to
from navsym.guaranteed.search.exchange import Contacts
from navsym.language.expression import to_text

DIGITS = 34
#: A root belongs to a change that the scan saw this near, relative.
REACH = 2e-3


@dataclass(frozen=True, slots=True)
class Boundary:
    """A length at which the pattern changes.

    at           : closed form, or None
    lower, upper : decimal strings that enclose it
    why          : what happens there
    proved       : True when the event in the closed forms, or the change of pattern inside the enclosure, is proved
    """

    at: sp.Expr | None
    lower: str
    upper: str
    why: str
    proved: bool

    def document(self) -> dict[str, Any]:
        """The row of the boundary in the document of the verb."""
        at = None if self.at is None else to_text(self.at)
        return {"at": at, "lower": self.lower, "upper": self.upper, "why": self.why}


def locate_boundary(
    family: Family, left: PatternInterval, right: PatternInterval, before: ClosedForm | None, after: ClosedForm | None
) -> Boundary:
    """The change from one span to the next, as exactly as it can be had."""
    guess = float(left.upper)
    if before is not None and after is not None and before.dual == after.dual:
        # Both are optimal on either side for a while: where the search went from one to the other says nothing.
        reach = min(guess - float(left.lower), float(right.upper) - guess)
    else:
        # A guess near zero has no size of its own, and patterns next to each other are told apart only so far.
        reach = REACH * max(abs(guess), float(right.upper - left.lower))
    for expression, why in boundary_events(family, left, before, right, after):
        found = recognise_root(expression, family.parameter, guess, reach)
        if found is not None:
            with precision(200):
                ball = enclose(found, bits=200)
                return Boundary(found, lower_end(ball, DIGITS), upper_end(ball, DIGITS), why, True)
    return locate_implicitly(family, left, right)


def boundary_events(
    family: Family, left: PatternInterval, before: ClosedForm | None, right: PatternInterval, after: ClosedForm | None
) -> Iterator[tuple[sp.Expr, str]]:
    """Expressions that vanish at the change, with words: a weight, the room of an instant, the room below the bound."""
    yield from bound_slacks(family, before, after, right)
    yield from bound_slacks(family, after, before, left)
    for closed, span in ((before, left), (after, right)):
        if closed is None:
            continue
        for i, w in enumerate(closed.weights):
            if w.free_symbols:
                yield w, f"the weight at {family.time(closed.places[i])} vanishes"
        for place, (k, kind, _) in zip(closed.places, span.pattern, strict=True):
            if kind == "no":
                start, stop = family.panels[k]
                why = f"the instant {family.time(place)} reaches an end of {family.stretch_name}"
                yield stop - place, why
                yield place - start, why


def bound_slacks(
    family: Family, closed: ClosedForm | None, other: ClosedForm | None, span: PatternInterval
) -> Iterator[tuple[sp.Expr, str]]:
    """Slacks of one dual polynomial below its bound at the times of the other regime, as far as these are exact.

    Without a closed form of the other regime only the ends of the interval are.
    """
    if closed is None:
        return
    for i, (k, kind, sign) in enumerate(span.pattern):
        if other is None and kind == "no":
            continue
        u = other.places[i] if other is not None else family.panels[k][("from", "to").index(kind)]
        if any(j == k and v == u for j, v in zip(closed.panels, closed.places, strict=True)):
            continue
        f = sum((x * h.subs(U, u) for x, h in zip(closed.dual, family.rows[k], strict=True)), sp.S.Zero)
        yield family.sigma[k] - sign * f, f"the dual polynomial reaches its bound at {family.time(u)}"


def recognise_root(expression: sp.Expr, T: sp.Symbol, guess: float, reach: float) -> sp.Expr | None:
    """A recognised root within reach of the guess, proved to be one: zero is the numerator, and not the denominator."""
    top, bottom = sp.fraction(sp.together(expression))
    if T not in top.free_symbols:
        return None

    def function(t: mpmath.mpf) -> mpmath.mpf:
        return mpmath.mpf(str(sp.N(top.subs(T, sp.Float(mpmath.nstr(t, 60), 60)), 60)))

    with mpmath.workdps(60):
        try:
            root = mpmath.findroot(function, mpmath.mpf(guess), tol=1e-50)
            near = abs(root - guess) < reach
        except (ValueError, ZeroDivisionError):
            return None
        found = recognise_constant(sp.Rational(mpmath.nstr(root, 55))) if near else None
    if found is None or not is_equal(top.subs(T, found), sp.S.Zero):
        return None
    return None if enclose(bottom.subs(T, found), bits=200).contains(0) else found


# -- without closed forms ---------------------------------------------------------------------------


def solve_pattern(
    family: Family, T: sp.Rational, pattern: Pattern, near: Contacts, near_T: sp.Rational
) -> ContactSolution:
    """The solution of the optimality system of a pattern at T, started from contacts at a nearby length."""
    old, new = make_basis(family.exact(near_T)), make_basis(family.exact(T))
    with precision(BITS):
        x = old.transform.transpose() * arb_mat([[arb(float(c))] for c in near.dual])
        y = new.transform.transpose().solve(x)
    dual = np.array([float(y[i, 0].mid()) for i in range(near.dual.size)])
    start = Contacts(near.panel, near.u, near.inner, near.sign, near.weights * (old.scale / new.scale), dual, 0.0)
    return sharpen_contacts(family.exact(T).panels, new, start, BITS, GOAL)


def nearby_contacts(
    family: Family, span: PatternInterval, edge: Fraction, side: int
) -> Iterator[tuple[Contacts, sp.Rational]]:
    """Contacts of the span's pattern inside it, farther and farther from the edge."""
    width = span.upper - span.lower
    for share in (Fraction(1, 500), Fraction(1, 100), Fraction(1, 20), Fraction(1, 5)):
        T = (edge + side * share * width).limit_denominator(10**7)
        _, contacts = sample_contacts(family, T, span.pattern)
        if contact_pattern(contacts) == span.pattern:
            yield contacts, to_rational(T)


FurtherContacts = Sequence[tuple[int, float, int]]
#: What closes: ("weight", contact), ("start" or "end", contact), ("bound", place among those of the regime beyond).
Slack = tuple[str, int]


def pattern_slacks(found: ContactSolution, problem: PanelProblem, others: FurtherContacts) -> dict[Slack, arb]:
    """Quantities that are positive inside a regime.

    They are the sizes of the weights, the distances of inner contacts from the ends, and the slacks below the bound
    near those contacts (panel, u, sign) of the next regime that are none of this one.
    """
    done: dict[Slack, arb] = {}
    for i, (s, w, v) in enumerate(zip(found.sign, found.weights, found.v, strict=True)):
        done["weight", i] = s * w
        if found.inner[i]:
            done["start", i], done["end", i] = v, 1 - v
    for i, (k, u, s) in enumerate(others):
        place, panel = unit_fraction(u), problem.panels[k]
        if all(j != k or bool(abs(v - arb(place)) > 1e-3) for j, v in zip(found.panel, found.v, strict=True)):
            f = dot_product(found.dual, panel.rows(arb(stationary_fraction(panel, found.dual, place))))
            done["bound", i] = panel.bound() - s * f
    return {room: size for room, size in done.items() if size.is_finite()}


def slack_words(family: Family, room: Slack, others: FurtherContacts) -> str:
    """What happens where a room closes; others are the contacts of the regime beyond."""
    kind, i = room
    if kind == "weight":
        return f"the weight of contact {i + 1} vanishes"
    if kind == "bound":
        measurement = others[i][0] % family.many + 1
        return f"the dual polynomial reaches its bound at another instant of measurement {measurement}"
    return f"contact {i + 1} reaches an end of {family.stretch_name}"


def locate_implicitly(family: Family, left: PatternInterval, right: PatternInterval) -> Boundary:
    """The length at which a room of one of the two patterns closes; enclosed by two exact-contact proofs."""
    edge = left.upper
    starts = [next(nearby_contacts(family, span, edge, side), None) for span, side in ((left, -1), (right, 1))]
    guesses = []
    for span, start, beyond in ((left, starts[0], starts[1]), (right, starts[1], starts[0])):
        if start is None:
            continue
        c = None if beyond is None else beyond[0]
        others = [] if c is None else list(zip(c.panel.tolist(), c.u.tolist(), c.sign.tolist(), strict=True))
        found = find_closing_slack(family, span.pattern, start, edge, others)
        if found is not None:
            guesses.append(enclose_change(family, left, right, *found))
            if guesses[-1].proved:
                return guesses[-1]
    return next(iter(guesses), unlocated_boundary(edge))


def unlocated_boundary(edge: Fraction) -> Boundary:
    """A change of which no more is known than that the search saw it at the edge."""
    text = decimal(to_fmpq(edge), 8)
    return Boundary(None, text, text, "the pattern of instants changes; not located further", False)


def find_closing_slack(
    family: Family, pattern: Pattern, start: tuple[Contacts, sp.Rational], edge: Fraction, others: FurtherContacts
) -> tuple[sp.Rational, str] | None:
    """Where the room that closes next to the edge is zero, and what closes."""
    contacts, T0 = start

    def rooms_at(T: sp.Rational) -> dict[Slack, arb]:
        with precision(BITS):
            return pattern_slacks(solve_pattern(family, T, pattern, contacts, T0), family.exact(T), others)

    target = to_rational(edge)
    middle = (T0 + target) / 2
    first, second = rooms_at(T0), rooms_at(middle)
    room = nearest_closing(first, second, float(T0), float(target))
    if room is None:
        return None

    def size(T: sp.Rational) -> sp.Rational | None:
        found = rooms_at(T).get(room)
        return None if found is None else to_rational(found.mid())

    ends = (T0, to_rational(first[room].mid())), (middle, to_rational(second[room].mid()))
    root = secant_root(size, *ends, target, abs(T0 - target) * 3 + sp.Rational(1, 1000))
    return None if root is None else (root, slack_words(family, room, others))


def nearest_closing(first: dict[Slack, arb], second: dict[Slack, arb], start: float, edge: float) -> Slack | None:
    """The room that, extended from its sizes at the start and half-way to the edge, closes nearest to the edge."""
    misses: dict[Slack, float] = {}
    for room in first.keys() & second.keys():
        drop = float((first[room] - second[room]).mid())
        if drop != 0.0:
            misses[room] = abs(start + float(first[room].mid()) / drop * (edge - start) / 2 - edge)
    return min(sorted(misses), key=lambda room: misses[room], default=None)


Point = tuple[sp.Rational, sp.Rational]


def secant_root(
    size: Callable[[sp.Rational], sp.Rational | None], one: Point, two: Point, target: sp.Rational, reach: sp.Rational
) -> sp.Rational | None:
    """A root by secant steps, within reach of the target; None when they run away."""
    (p, fp), (q, fq) = one, two
    for _ in range(14):
        if fq == fp or abs(fq) < sp.Rational(1, 10**45):
            break
        step = q - fq * (q - p) / (fq - fp)
        p, fp, q = q, fq, sp.Rational(round(step * 10**60), 10**60)
        found = size(q) if abs(q - target) <= reach else None
        if found is None:
            return None
        fq = found
    return q


def enclose_change(
    family: Family, left: PatternInterval, right: PatternInterval, root: sp.Rational, why: str
) -> Boundary:
    """Exact contacts of the left pattern just below and of the right pattern just above the root."""
    for proof, sizes in ((is_pattern_optimal, (32, 24, 16, 10, 6)), (is_pattern_optimal_near, (32, 16))):
        for places in sizes:
            delta = abs(root or sp.Integer(1)) / sp.Integer(10) ** places
            below, above = (
                sp.Rational(round(v * 10 ** (places + 4)), 10 ** (places + 4)) for v in (root - delta, root + delta)
            )
            if proof(family, left, below, -1, root) and proof(family, right, above, 1, root):
                return Boundary(None, exact_decimal(below), exact_decimal(above), why, True)
    text = decimal(to_fmpq(root), 20)
    return Boundary(None, text, text, why + "; not enclosed by proofs", False)


def exact_decimal(x: sp.Rational) -> str:
    """A decimal string of a rational, to 60 digits."""
    return decimal(to_fmpq(x), 60)


def is_pattern_optimal(family: Family, span: PatternInterval, T: sp.Rational, side: int, root: sp.Rational) -> bool:
    """True when exact contacts of the span's pattern are proved optimal at T."""
    edge = span.upper if side < 0 else span.lower
    problem = family.exact(T)
    basis = make_basis(problem)
    for start in nearby_contacts(family, span, edge, side):
        found = solve_pattern(family, T, span.pattern, *start)
        regular = found.residual < 1e-45 and not has_double_contact(problem, found)
        if regular and certify_touch(problem, basis, found, 50, BITS) is not None:
            return True
    return False


def has_double_contact(problem: PanelProblem, found: ContactSolution) -> bool:
    """True when a contact stands where two pieces meet.

    The end of the other piece touches as well, and no strict bound holds there.
    """
    many = 1 + max(panel.measurement for panel in problem.panels)
    contacts = {(int(k), to_fmpq(at)) for k, at in zip(found.panel, found.v, strict=True)}
    twins = {(k - many, 1) for k, v in contacts if v == 0} | {(k + many, 0) for k, v in contacts if v == 1}
    with precision(BITS):
        for k, v in twins - contacts:
            if 0 <= k < len(problem.panels):
                panel = problem.panels[k]
                room = panel.bound() - abs(dot_product(found.dual, panel.rows(arb(v))))
                if bool(abs(room) < arb(10) ** -40 * panel.bound()):
                    return True
    return False


def is_pattern_optimal_near(
    family: Family, span: PatternInterval, T: sp.Rational, side: int, root: sp.Rational
) -> bool:
    """The same where the pattern is singular at the root itself: it is followed there with many digits."""
    if is_pattern_optimal(family, span, T, side, root):
        return True
    edge = span.upper if side < 0 else span.lower
    for contacts, begin in nearby_contacts(family, span, edge, side):
        found = walk_to(family, solve_pattern(family, begin, span.pattern, contacts, begin), begin, root, T)
        problem = family.exact(T)
        if found is not None and not has_double_contact(problem, found):
            return certify_touch(problem, make_basis(problem), found, walk.WALK_DIGITS, walk.WALK_BITS) is not None
    return False
