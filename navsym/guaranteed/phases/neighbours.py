"""Closed forms that hold in more than one regime: taken over from neighbours, and neighbours made one.

Where several estimators are optimal, the places that a search finds say nothing, and a change of pattern need not be
a boundary. Places and weights that carry the functional in one regime carry it beyond; with signs that are those of a
dual they are optimal there. A guess first, in doubles by weak duality; then proved on the whole.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import groupby, product

import numpy as np
import sympy as sp
from flint import arb_mat

from navsym.claims import OPEN, Verdict
from navsym.core.balls import enclose
from navsym.core.exact import to_rational
from navsym.guaranteed.certificate.basis import to_doubles
from navsym.guaranteed.phases.answer import end_text
from navsym.guaranteed.phases.boundaries import Boundary, recognise_root
from navsym.guaranteed.phases.budget import Budget
from navsym.guaranteed.phases.closed_forms import ClosedForm, is_feasible, prove_closed_form, solve_weights
from navsym.guaranteed.phases.family import Family
from navsym.guaranteed.phases.patterns import Pattern, PatternInterval, sample_contacts
from navsym.guaranteed.search.exchange import regressor_rows
from navsym.prove.identities import is_zero

LARGEST, NEAR = 720, 1e-8
#: Where a guess is looked at in a span, and the shares of a flat panel that may carry the functional.
SHARES = tuple(map(Fraction, ("0.03", "0.23", "0.59", "0.97")))
PARTS = 12
#: A carrier of the functional with the pattern it gives a span.
Carrier = tuple[Pattern, ClosedForm]
Ends = tuple[sp.Expr, sp.Expr]


def inner_values(span: PatternInterval) -> list[Fraction]:
    """Values inside the span."""
    return [(span.lower + (span.upper - span.lower) * share).limit_denominator(10**6) for share in SHARES]


def is_optimal_at(family: Family, closed: ClosedForm, T: Fraction) -> bool:
    """A dual within its bound costs the value of the weights, and the places are inside; in doubles."""
    value = to_rational(T)

    def number(e: sp.Expr) -> float:
        return float(enclose(family.at(e, value)).mid())

    for k, place in zip(closed.panels, closed.places, strict=True):
        start, stop = family.panels[k]
        if not (number(place - start) >= -NEAR and number(stop - place) >= -NEAR):
            return False
    x = np.array([number(e) for e in closed.dual])
    cost = sum(number(family.sigma[k]) * abs(number(w)) for k, w in zip(closed.panels, closed.weights, strict=True))
    reached = sum(a * number(p) for a, p in zip(x, family.functional, strict=True))
    return bool(abs(cost - reached) <= NEAR * abs(cost)) and is_feasible(family, value, x)


def holding_form(
    family: Family, values: Sequence[Fraction], carriers: Sequence[Carrier], duals: Sequence[tuple[sp.Expr, ...]]
) -> Iterator[Carrier]:
    """Carriers with duals next to which they are optimal at all values; not yet proved."""
    for (pattern, closed), dual in product(carriers, duals):
        value = closed.value
        if dual != closed.dual:
            value = sp.expand(sum((x * p for x, p in zip(dual, family.functional, strict=True)), sp.S.Zero))
        guess = replace(closed, dual=dual, value=value, verdict=Verdict(OPEN, "none"))
        if all(is_optimal_at(family, guess, T) for T in values):
            yield pattern, guess


def extend_forms(
    family: Family, spans: Sequence[PatternInterval], guesses: Sequence[list[ClosedForm]]
) -> tuple[list[PatternInterval], list[list[ClosedForm]]]:
    """Spans and their guesses; neighbours without any are made one when one closed form holds on all of them."""
    runs = [list(run) for _, run in groupby(range(len(spans)), key=lambda k: k if guesses[k] else -1)]
    kept: list[tuple[PatternInterval, list[ClosedForm]]] = []
    for run in runs:
        first, last = run[0], run[-1]
        whole = PatternInterval(spans[first].lower, spans[last].upper, spans[first].pattern)
        found = None
        if not guesses[first]:
            beside = [(spans[k].pattern, g) for k in (first - 1, last + 1) if 0 <= k < len(spans) for g in guesses[k]]
            before = [(spans[first - 1].pattern, g) for g in guesses[first - 1]] if first else []
            found = take_over_form(family, whole, beside, before)
        kept += [found] if found else [(spans[k], guesses[k]) for k in run]
    return [span for span, _ in kept], [list(guess) for _, guess in kept]


def take_over_form(
    family: Family, span: PatternInterval, beside: Sequence[Carrier], before: Sequence[Carrier]
) -> tuple[PatternInterval, list[ClosedForm]] | None:
    """A span with the pattern and the closed form of a regime beside it, or of a flat dual; None without one."""
    dual = constant_dual(family, span)
    if dual is None:
        return None
    carriers = [*beside, *(one for pair in before for one in freeze_carriers(family, pair, span.lower))]
    for source in (lambda: carriers, lambda: list(flat_carriers(family, span))):
        fits = list(holding_form(family, inner_values(span), source(), [dual]))
        if fits:
            pattern = with_signs(family, *fits[0], span)
            return replace(span, pattern=pattern), [guess for _, guess in fits]
    return None


def with_signs(family: Family, pattern: Pattern, closed: ClosedForm, span: PatternInterval) -> Pattern:
    """The pattern with the signs that the weights have inside the span."""
    T = to_rational(inner_values(span)[1])
    signs = [1 if bool(enclose(family.at(w, T)) > 0) else -1 for w in closed.weights]
    return tuple((p, e, sign) for (p, e, _), sign in zip(pattern, signs, strict=True))


def constant_dual(family: Family, span: PatternInterval) -> tuple[sp.Expr, ...] | None:
    """The dual that all values inside the span share, when its entries are short rational numbers."""
    known: tuple[sp.Expr, ...] | None = None
    for T in inner_values(span):
        basis, contacts = sample_contacts(family, T)
        x = to_doubles(basis.transform.transpose() * arb_mat([[float(c)] for c in contacts.dual]))[:, 0]
        short = tuple(to_rational(Fraction(float(c)).limit_denominator(LARGEST)) for c in x)
        if np.abs(x - np.array(short, dtype=float)).max() > NEAR * max(1.0, np.abs(x).max()) or known not in (
            None,
            short,
        ):
            return None
        known = short
    return known


def freeze_carriers(family: Family, pair: Carrier, edge: Fraction) -> Iterator[Carrier]:
    """Carriers at the values next to the edge where one of their weights vanishes, kept from there on.

    The interval of a growing family holds them for every larger value.
    """
    pattern, closed = pair
    T, reach = family.parameter, float(2e-3 * max(edge, Fraction(1, 1000)))
    for weight in closed.weights if family.growing else ():
        root = recognise_root(weight, T, float(edge), reach) if T in weight.free_symbols else None
        if root is not None:
            yield from freeze_carrier(family, pattern, closed, root)


def freeze_carrier(family: Family, pattern: Pattern, closed: ClosedForm, root: sp.Expr) -> list[Carrier]:
    """A carrier at one value; contacts without weight are left out, and those at its end are inside beyond it.

    None where a weight has a pole.
    """
    weights = [family.at(w, root) for w in closed.weights]
    if any(w.has(sp.zoo, sp.nan, sp.oo) for w in weights):
        return []
    rows = [
        (mark if mark[1] == "from" else (mark[0], "no", mark[2]), panel, sp.expand(family.at(place, root)), w)
        for mark, panel, place, w in zip(pattern, closed.panels, closed.places, weights, strict=True)
        if not is_zero(w)
    ]
    marks, panels, places, left = zip(*rows, strict=True)
    return [(marks, replace(closed, panels=panels, places=places, weights=left))]


def flat_carriers(family: Family, span: PatternInterval) -> Iterator[Carrier]:
    """Fixed shares of panels on which the dual polynomial is its bound throughout, with weights for them.

    Of a growing family, shares of the shortest interval also, which do not move.
    """
    fixed = [span.lower.limit_denominator(1000)] if family.growing else []
    for T in (*fixed, *inner_values(span)):
        pattern, shares = flat_shares(family, T)
        places = []
        for (k, _, _), share in zip(pattern, shares, strict=True):
            start, stop = (family.ends(to_rational(T), k)) if T in fixed else family.panels[k]
            places.append(start + (stop - start) * share)
        if T in fixed:
            pattern = tuple((k, "no" if end == "to" else end, s) for k, end, s in pattern)
        one = PatternInterval(span.lower, span.upper, pattern)
        weights = solve_weights(family, one, places, to_rational(T)) if pattern else None
        if weights is not None:
            panels = tuple(k for k, _, _ in pattern)
            yield pattern, ClosedForm(panels, tuple(places), weights, (), sp.S.Zero, Verdict(OPEN, "none"))


def flat_shares(family: Family, T: Fraction) -> tuple[Pattern, list[sp.Rational]]:
    """Marks and shares of places on flat panels that carry the functional at a value; none where no panel is flat."""
    from scipy.optimize import linprog

    basis, contacts = sample_contacts(family, T)
    coefficients, shares = basis.panels.coefficients, np.arange(PARTS + 1)
    marks, columns = [], []
    for k in range(len(coefficients)):
        rows = regressor_rows(coefficients, np.full(PARTS + 1, k), 2 * shares / PARTS - 1)
        f = rows @ contacts.dual
        if np.abs(f - np.sign(f[0])).max() < NEAR:
            marks += [(k, int(j), int(np.sign(f[0]))) for j in shares]
            columns += list(rows)
    if not marks:
        return (), []
    signed = np.array(columns).T * np.array([s for _, _, s in marks])
    cost = np.array([0.0 if j in (0, PARTS) else 1.0 for _, j, _ in marks])
    answer = linprog(cost, A_eq=signed, b_eq=basis.panels.functional, method="highs-ds")
    chosen = [mark for mark, w in zip(marks, answer.x, strict=True) if w > NEAR] if answer.success else []
    kinds = {0: "from", PARTS: "to"}
    return tuple((k, kinds.get(j, "no"), s) for k, j, s in chosen), [sp.Rational(j, PARTS) for _, j, _ in chosen]


def cuts_of(changes: Sequence[Boundary], ends: Ends) -> list[sp.Expr]:
    """The ends of the range with the changes between."""
    return [ends[0], *map(boundary_middle, changes), ends[1]]


def boundary_middle(b: Boundary) -> sp.Expr:
    """The exact value of a boundary, or the middle of its bracket."""
    return b.at if b.at is not None else (sp.Rational(b.lower) + sp.Rational(b.upper)) / 2


def prove_form(family: Family, guesses: Sequence[ClosedForm], ends: Ends, limit: Budget) -> ClosedForm | None:
    """The closed form that is proved between the ends within the limit."""
    found = prove_closed_form(family, guesses, *ends, seconds=limit.left()) if guesses and not limit.met() else None
    if found is not None and found.verdict.status.holds:
        return found
    if guesses and limit.met():
        limit.gives_up(f"the proof of a closed form from {end_text(ends[0])} to {end_text(ends[1])}")
    return None


def merge_regimes(
    family: Family,
    spans: list[PatternInterval],
    forms: list[ClosedForm | None],
    changes: list[Boundary],
    ends: Ends,
    limit: Budget,
) -> None:
    """Makes one, in place, of neighbours for which one closed form is proved, or whose pattern is the same."""
    k = 0
    while k < len(changes):
        cuts = cuts_of(changes, ends)
        left, right = spans[k], spans[k + 1]
        whole = PatternInterval(left.lower, right.upper, left.pattern)
        same = forms[k] is forms[k + 1] is None and left.pattern == right.pattern
        shared = None if same else shared_form(family, spans, forms, k, (cuts[k], cuts[k + 2]), limit)
        if shared is None and not same:
            k += 1
            continue
        pattern, form = shared or (left.pattern, None)
        spans[k : k + 2], forms[k : k + 2] = [replace(whole, pattern=pattern)], [form]
        del changes[k]
        k = max(k - 1, 0)


def shared_form(
    family: Family,
    spans: Sequence[PatternInterval],
    forms: Sequence[ClosedForm | None],
    k: int,
    ends: Ends,
    limit: Budget,
) -> Carrier | None:
    """A closed form of span k or the next that is proved on both, from one end to the other.

    The interval of a growing family holds places of the start for every larger value: those of span k, and of the
    one before, which ends there.
    """
    carriers = [(spans[j].pattern, form) for j in (k, k + 1) if (form := forms[j]) is not None]
    duals = list(dict.fromkeys(form.dual for _, form in carriers))
    if carriers and family.growing and ends[0] != 0:
        ending = [(spans[j].pattern, form) for j in (k - 1, k) if j >= 0 and (form := forms[j]) is not None]
        carriers += [one for pair in ending for one in freeze_carrier(family, *pair, ends[0])]
    values = [T for pair in zip(inner_values(spans[k]), inner_values(spans[k + 1]), strict=True) for T in pair]
    for pattern, guess in holding_form(family, values, carriers, duals):
        done = prove_form(family, [guess], ends, limit.share(1 / 2))
        if done is not None:
            return pattern, done
    return None
