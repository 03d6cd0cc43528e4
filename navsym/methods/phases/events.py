"""Where one regime ends and the next begins: located from closed forms, or by Newton and two proofs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import mpmath
import numpy as np
import sympy as sp
from flint import arb, arb_mat, fmpq

from navsym.claims import PROVED, Equation
from navsym.methods.phases.closed import BITS, GOAL, Closed, constant, number
from navsym.methods.phases.family import Family, U
from navsym.methods.phases.scan import Pattern, Span, pattern_of, sample
from navsym.numeric.exchange import Contacts
from navsym.proof.balls import enclose, precision
from navsym.proof.decimals import decimal, lower_end, upper_end
from navsym.proof.enclosure import Problem, rational, total
from navsym.proof.ladder import decide
from navsym.proof.optimality import peak, touch
from navsym.proof.optimality_basis import as_fraction, make_basis
from navsym.proof.optimality_polish import Polished, polish

DIGITS = 34


@dataclass(frozen=True, slots=True)
class Boundary:
    """A length at which the pattern changes.

    at           : closed form, or None
    lower, upper : decimal strings that enclose it
    why          : what happens there
    proved       : True when the event, or the change of pattern inside the enclosure, is proved
    """

    at: sp.Expr | None
    lower: str
    upper: str
    why: str
    proved: bool


def boundary(
    family: Family, left: Span, right: Span, before: Closed | None, after: Closed | None
) -> Boundary:
    """The change from one span to the next, as exactly as it can be had."""
    guess = float(left.upper)
    for expression, why in events(family, left, before, right, after):
        found = exact_root(expression, family.parameter, guess)
        if found is not None:
            with precision(200):
                ball = enclose(found, bits=200)
                return Boundary(found, lower_end(ball, DIGITS), upper_end(ball, DIGITS), why, True)
    return implicit(family, left, right)


def events(
    family: Family, left: Span, before: Closed | None, right: Span, after: Closed | None
) -> Iterator[tuple[sp.Expr, str]]:
    """Expressions that vanish at the change, with words: a weight, the room of an instant, the room below the bound."""
    yield from rooms_below(family, before, after, right)
    yield from rooms_below(family, after, before, left)
    for closed, span in ((before, left), (after, right)):
        if closed is None:
            continue
        for i, w in enumerate(closed.weights):
            if w.free_symbols:
                yield (
                    sp.fraction(sp.together(w))[0],
                    f"the weight at {family.time(closed.places[i])} vanishes",
                )
        for i, (_, kind, _) in enumerate(span.pattern):
            if kind == "no":
                yield (
                    family.stop - closed.places[i],
                    f"the instant {family.time(closed.places[i])} reaches an end of the interval",
                )
                yield (
                    closed.places[i] - family.start,
                    f"the instant {family.time(closed.places[i])} reaches an end of the interval",
                )


def rooms_below(
    family: Family, closed: Closed | None, other: Closed | None, span: Span
) -> Iterator[tuple[sp.Expr, str]]:
    """What one dual polynomial leaves below the bound at the instants of the other regime."""
    if closed is None or other is None:
        return
    for (k, _, sign), u in zip(span.pattern, other.places, strict=True):
        f = sum((x * h.subs(U, u) for x, h in zip(closed.dual, family.rows[k], strict=True)), sp.S.Zero)
        room = sp.fraction(sp.together(family.sigma[k] - sign * f))[0]
        yield room, f"the dual polynomial reaches its bound at {family.time(u)}"


def exact_root(expression: sp.Expr, T: sp.Symbol, guess: float) -> sp.Expr | None:
    """A recognised root near the guess, proved to be one."""
    if T not in expression.free_symbols:
        return None

    def function(t: mpmath.mpf) -> mpmath.mpf:
        return mpmath.mpf(str(sp.N(expression.subs(T, sp.Float(mpmath.nstr(t, 60), 60)), 60)))

    with mpmath.workdps(60):
        try:
            root = mpmath.findroot(function, mpmath.mpf(guess), tol=1e-50)
            near = abs(root - guess) < 2e-3 * abs(guess)
        except (ValueError, ZeroDivisionError):
            return None
        found = constant(sp.Rational(mpmath.nstr(root, 55))) if near else None
    if found is None or decide(Equation(expression.subs(T, found), sp.S.Zero)).status is not PROVED:
        return None
    return found


# -- without closed forms ---------------------------------------------------------------------------


def forced(family: Family, T: sp.Rational, pattern: Pattern, near: Contacts, near_T: sp.Rational) -> Polished:
    """The solution of the optimality system of a pattern at T, started from contacts at a nearby length."""
    old, new = make_basis(family.exact(near_T)), make_basis(family.exact(T))
    with precision(BITS):
        x = old.transform.transpose() * arb_mat([[arb(float(c))] for c in near.dual])
        y = new.transform.transpose().solve(x)
    dual = np.array([float(y[i, 0].mid()) for i in range(near.dual.size)])
    start = Contacts(
        near.panel, near.u, near.inner, near.sign, near.weights * (old.scale / new.scale), dual, 0.0
    )
    return polish(family.exact(T).panels, new, start, BITS, GOAL)


def anchor(family: Family, span: Span, edge: Fraction, side: int) -> tuple[Contacts, sp.Rational] | None:
    """Contacts of the span's pattern a little inside it, next to the edge."""
    width = span.upper - span.lower
    for share in (Fraction(1, 500), Fraction(1, 100), Fraction(1, 20), Fraction(1, 5)):
        T = (edge + side * share * width).limit_denominator(10**7)
        _, contacts = sample(family, T)
        if pattern_of(contacts) == span.pattern:
            return contacts, sp.Rational(T.numerator, T.denominator)
    return None


Others = Sequence[tuple[int, float, int]]


def rooms(found: Polished, problem: Problem, others: Others) -> list[tuple[str, arb]]:
    """Quantities that are positive inside a regime: sizes of the weights, distances to the ends, rooms below the
    bound near the contacts of the regime beyond (panel, u, sign)."""
    sizes = [
        (f"the weight of contact {i + 1} vanishes", s * w)
        for i, (s, w) in enumerate(zip(found.sign, found.weights, strict=True))
    ]
    gaps = [
        (f"contact {i + 1} reaches an end of the interval", gap)
        for i, v in enumerate(found.v) if found.inner[i] for gap in (v, 1 - v)
    ]  # fmt: skip
    below = []
    for k, u, s in others:
        place = as_fraction(u)
        if all(j != k or bool(abs(v - arb(place)) > 1e-3) for j, v in zip(found.panel, found.v, strict=True)):
            panel = problem.panels[k]
            f = total(found.dual, panel.rows(arb(peak(panel, found.dual, place))))
            why = f"the dual polynomial reaches its bound at another instant of measurement {k + 1}"
            below.append((why, panel.bound() - s * f))
    return sizes + gaps + below


def implicit(family: Family, left: Span, right: Span) -> Boundary:
    """The length at which a room of one of the two patterns closes; enclosed by two exact-contact proofs."""
    edge = left.upper
    starts = [anchor(family, span, edge, side) for span, side in ((left, -1), (right, 1))]
    for span, start, beyond in ((left, starts[0], starts[1]), (right, starts[1], starts[0])):
        if start is None:
            continue
        c = None if beyond is None else beyond[0]
        others = [] if c is None else list(zip(c.panel.tolist(), c.u.tolist(), c.sign.tolist(), strict=True))
        found = closing(family, span.pattern, start, edge, others)
        if found is not None:
            root, why = found
            return enclosed(family, left, right, root, why)
    text = decimal(fmpq(edge.numerator, edge.denominator), 8)
    return Boundary(None, text, text, "the pattern of instants changes; not located further", False)


def closing(
    family: Family, pattern: Pattern, start: tuple[Contacts, sp.Rational], edge: Fraction, others: Others
) -> tuple[sp.Rational, str] | None:
    """Secant steps on the room that closes next to the edge."""
    contacts, T0 = start

    def rooms_at(T: sp.Rational) -> list[tuple[str, arb]]:
        with precision(BITS):
            return rooms(forced(family, T, pattern, contacts, T0), family.exact(T), others)

    target = sp.Rational(edge.numerator, edge.denominator)
    first, second = (rooms_at(T) for T in (T0, (T0 + target) / 2))
    best: tuple[float, int] | None = None
    for i, ((_, a), (_, b)) in enumerate(zip(first, second, strict=True)):
        if not (a.is_finite() and b.is_finite()):
            continue
        drop = float((a - b).mid())
        if drop != 0.0:
            zero = float(T0) + float(a.mid()) / drop * float((target - T0) / 2)
            miss = abs(zero - float(edge))
            if best is None or miss < best[0]:
                best = (miss, i)
    if best is None:
        return None
    i = best[1]
    p, q = T0, (T0 + target) / 2
    fp, fq = number(first[i][1].mid()), number(second[i][1].mid())
    for _ in range(14):
        if fq == fp or abs(fq) < sp.Rational(1, 10**45):
            break
        step = q - fq * (q - p) / (fq - fp)
        step = sp.Rational(round(step * 10**60), 10**60)
        p, fp = q, fq
        q = step
        if abs(q - target) > abs(T0 - target) * 3 + sp.Rational(1, 1000):
            return None
        room = rooms_at(q)[i][1]
        if not room.is_finite():
            return None
        fq = number(room.mid())
    return q, first[i][0]


def enclosed(family: Family, left: Span, right: Span, root: sp.Rational, why: str) -> Boundary:
    """Exact contacts of the left pattern just below and of the right pattern just above the root."""
    for places in (32, 24, 16, 10, 6):
        delta = sp.Rational(1, 10**places) * root
        below, above = (
            sp.Rational(round(v * 10 ** (places + 4)), 10 ** (places + 4))
            for v in (root - delta, root + delta)
        )
        if proves(family, left, below, -1) and proves(family, right, above, 1):
            return Boundary(None, exact_decimal(below), exact_decimal(above), why, True)
    text = decimal(fmpq(int(root.p), int(root.q)), 20)
    return Boundary(None, text, text, why + "; not enclosed by proofs", False)


def exact_decimal(x: sp.Rational) -> str:
    return decimal(fmpq(int(x.p), int(x.q)), 60)


def proves(family: Family, span: Span, T: sp.Rational, side: int) -> bool:
    """True when exact contacts of the span's pattern are proved optimal at T."""
    edge = span.upper if side < 0 else span.lower
    start = anchor(family, span, edge, side)
    if start is None:
        return False
    found = forced(family, T, span.pattern, *start)
    problem = family.exact(T)
    basis = make_basis(problem)
    return found.residual < 1e-45 and touch(problem, basis, found, 50, BITS) is not None


__all__ = ["Boundary", "boundary", "rational"]
