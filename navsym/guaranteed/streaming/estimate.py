"""The answer of one epoch: estimate, radius, where they come from, and the certificate on demand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from flint import arb, arb_mat, fmpq, fmpq_mat

from navsym.claims.display import write_card, write_table
from navsym.core.answers import Answer
from navsym.core.balls import precision
from navsym.core.exact import decimal, lower_end, to_fmpq, upper_end
from navsym.core.numbers import Number
from navsym.guaranteed.streaming.flow import BITS, Flow, pivot_columns
from navsym.guaranteed.streaming.memory import Row, group_rows, list_cones
from navsym.guaranteed.streaming.numbers import NUMBER, read_exact, to_float
from navsym.language.expression import to_text
from navsym.language.names import quote

#: Digits of radii and duals.
DIGITS = 24
#: Smaller radii are not told from zero.
LEAST = arb("1e-1000")


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """The weights of an epoch and what they came from.

    rows    : the measurements in memory then
    columns : the unknowns in which the weights are unbiased; the others follow from them
    basis   : places among the rows
    signs   : sides of the dual there
    weights : balls
    lower, upper : of the radius
    whole   : whether the optimum over these rows is that over all rows in memory by itself
    """

    flow: Flow
    now: fmpq
    rows: Sequence[Row]
    columns: Sequence[int]
    basis: Sequence[int]
    signs: Sequence[int]
    weights: Sequence[arb]
    lower: arb
    upper: arb
    whole: bool = True

    def support(self) -> list[tuple[Row, arb]]:
        """Rows with a weight that is not zero, as far as balls tell."""
        pairs = [(self.rows[i], w) for i, w in zip(self.basis, self.weights, strict=True)]
        return [(row, w) for row, w in pairs if not w.contains(0)]

    def noise(self) -> list[tuple[Row, arb]]:
        """Errors that attain the radius: of the support, and of what is bounded together with it."""
        sides = {i: self.rows[i].sigma * (1 if w > 0 else -1) for i, w in zip(self.basis, self.weights, strict=True)}
        weights = dict(zip(self.basis, self.weights, strict=True))
        done = {i: r for i, r in sides.items() if not weights[i].contains(0)}
        for cone, places in list_cones(self.flow, self.rows):
            own = arb_mat([[weights.get(i, arb(0))] for i in places])
            if not all(e.contains(0) for e in own.entries()):
                done |= dict(zip(places, cone.worst(own), strict=True))
        return [(self.rows[i], r) for i, r in done.items()]

    def value(self) -> arb:
        """``sum w z``."""
        pairs = zip(self.basis, self.weights, strict=True)
        return sum((w * self.rows[i].z for i, w in pairs), arb(0))


@dataclass(frozen=True, slots=True, eq=False)
class Exclusion:
    """Why no set of at most ``most`` epochs explains the data without those excluded.

    rows           : measurements that contradict each other: those of one epoch with factors, and the bound of the sum
    contradictions : places among them: independent rows, and one that depends on these
    excluded       : times of the epochs
    """

    flow: Flow
    now: fmpq
    rows: Sequence[tuple[Sequence[Row], Sequence[fmpq], arb]]
    columns: Sequence[int]
    contradictions: Sequence[Sequence[int]]
    excluded: Sequence[fmpq]
    most: int


@dataclass(frozen=True, eq=False, repr=False)
class Estimate(Answer):
    """The target at the time of one epoch.

    t        : the time
    target   : its name
    value    : the estimate, a double; None while the target is not estimable
    radius   : the guaranteed error, a :class:`Number` with ``lower`` and ``upper``; None while not estimable
    kind     : "bounded", "variance" or "outliers"
    excluded : times of the epochs that every explanation of the data gives a gross error
    others   : other sets of times that explain the data, where there are several
    support  : number of measurements with a weight
    since    : the oldest epoch that counts, where regressors of those before are too large for doubles, after a long
               gap of a system that grows and decays; else None

    >>> import navsym as nav
    >>> guard = nav.Guard(nav.Model(states="b", F=[["0"]], H=["b"], sigma="1/2"))
    >>> guard.step(3, t=0)
    Estimate(b at 0: 3.0 within 0.5, bounded)
    """

    t: float
    target: str
    value: float | None
    kind: str
    support: int = 0
    excluded: tuple[float, ...] = ()
    others: tuple[tuple[float, ...], ...] = ()
    low: arb | None = field(default=None)
    high: arb | None = field(default=None)
    plan: Plan | None = field(default=None)
    exclusion: Exclusion | None = field(default=None)
    since: float | None = None

    @cached_property
    def radius(self) -> Number | None:
        """Enclosure of the radius."""
        if self.low is None or self.high is None:
            return None
        with precision(BITS):
            return enclose_radius(self.low, self.high)

    @property
    def weights(self) -> list[tuple[float, str, float]]:
        """(time, measurement, weight) of the support."""
        rows = self.plan.support() if self.plan else []
        return [(to_float(row.t), self.plan.flow.names[row.j], float(w)) for row, w in rows]  # type: ignore[union-attr]

    def worst_case(self) -> list[tuple[float, str, float]]:
        """(time, measurement, error) of the noise that attains the radius; all others may be zero.

        ``r_i = sigma_i sign(w_i)`` on the support, so that ``sum w_i r_i`` is the radius; where errors are bounded
        together, those of the block with the largest ``sum w_i r_i``. Under "variance" the errors
        are these numbers times one common random factor of variance 1: the worst correlation.

        >>> import navsym as nav
        >>> guard = nav.Guard(nav.Model(states="b", F=[["0"]], H=["b"], sigma="1/2"))
        >>> guard.step(3, t=0).worst_case()
        [(0.0, 'z1', 0.5)]
        """
        if self.plan is None:
            return []
        with precision(BITS):
            return [(to_float(row.t), self.plan.flow.names[row.j], float(r)) for row, r in self.plan.noise()]

    @cached_property
    def certificate(self) -> Mapping[str, Any] | None:
        """Plain data that the independent checker replays: kind ``gap``, one panel for each measurement in memory.

        On a panel regressor and bound are constant, so that the optimum over panels is that over measurements. Where
        measurements are bounded together the kind is ``cones``, and numbers that are not rational leave None. For
        "outliers" the kind is ``exclusion``: at most so many epochs with gross errors cannot explain the data without
        those excluded. None while the target is not estimable, where nothing is excluded, where exp(F t) has no
        formula, and for radii below 1e-1000.
        """
        if self.exclusion is not None:
            return write_exclusion(self.exclusion)
        if self.plan is None or not self.plan.whole or self.plan.upper < LEAST:
            return None
        return (write_cones if self.plan.flow.blocks else write_certificate)(self.plan)

    def document(self, *, certificate: bool = True) -> dict[str, Any]:
        """The row of the epoch in the document of ``navsym guard``, with its certificate or with null in its place."""
        rest: dict[str, Any] = {"others": [list(times) for times in self.others]} if self.others else {}
        rest |= {} if self.since is None else {"since": self.since}
        return {
            "t": self.t,
            "estimate": self.value,
            "radius": None if self.radius is None else self.radius.document(),
            "support": self.support,
            "excluded": list(self.excluded),
            "certificate": self.certificate if certificate else None,
        } | rest

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Estimate) and all(
            getattr(self, name) == getattr(other, name)
            for name in "t target value kind support excluded others radius weights since".split()
        )

    def __hash__(self) -> int:
        return hash((self.t, self.target, self.value))

    def __repr__(self) -> str:
        name, kind = quote(self.target)[1:-1], self.kind + ("" if self.since is None else f", since {self.since:g}")
        if self.value is None or self.high is None:
            return f"Estimate({name} at {self.t:g}: not estimable yet, {kind})"
        return f"Estimate({name} at {self.t:g}: {self.value!r} within {float(self.high.mid()):.6g}, {kind})"

    def _repr_html_(self) -> str:
        rows = [(f"{t:g}", name, f"{w:.6g}") for t, name, w in self.weights]
        return write_card([repr(self), write_table(("time", "measurement", "weight"), rows)], "")


def enclose_radius(low: arb, high: arb) -> Number:
    """Decimals outside both ends, by less than 1e-23 of them; 0 and 1e-1000 where both are below.

    The ends move apart before they are rounded: a radius such as 1 or 2/3 then has the same digits however its balls
    were computed.
    """
    if high < LEAST:
        return Number("0", "1e-1000")
    margin = fmpq(1, 10**28)
    below, above = to_fmpq(low.lower()), to_fmpq(high.upper())
    lower = decimal(max(below - abs(below) * margin, fmpq(0)), DIGITS, -1)
    return Number(lower, decimal(above + abs(above) * margin, DIGITS, 1))


def write_exclusion(why: Exclusion) -> dict[str, Any] | None:
    """The certificate of kind exclusion; None where a regressor has no formula."""
    flow, rows, columns, contradictions = why.flow, [], why.columns, why.contradictions
    with precision(BITS):
        table = [[flow.exact_row(row.j, row.t, why.now) for row in members] for members, *_ in why.rows]
        known = not any(None in numbers for numbers in table)
        if known:  # rows may show less than the state: each contradiction then takes rows of weight zero
            entries = zip(why.rows, table, strict=True)
            lines = [(fmpq_mat([factors]) * fmpq_mat(own)).entries() for (_, factors, _), own in entries]  # type: ignore[arg-type]
            columns, contradictions = pivot_columns(lines), [complete(places, lines) for places in contradictions]
        for (members, factors, sigma), numbers in zip(why.rows, table, strict=True):
            texts = [flow.row_text(row.j, row.t, why.now) for row in members] if not known else numbers
            if None in texts:
                return None
            own = members[0].own if len(members) == 1 else None
            rows.append(
                {
                    "epoch": str(members[0].t),
                    "H": [combine_entries(factors, [line[k] for line in texts]) for k in columns],  # type: ignore[index]
                    "z": combine_entries(factors, [row.z for row in members]),
                    "sigma": upper_end(sigma, 50) if own is None else str(own),
                }
            )
    return {
        "kind": "exclusion",
        "rows": rows,
        "most": why.most,
        "excluded": [str(t) for t in why.excluded],
        "contradictions": [list(places) for places in contradictions],
        "bits": BITS + 64,
        "cells": min(len(why.excluded) * len(columns) ** why.most + 1000, 20_000),
    }


def complete(places: Sequence[int], lines: Sequence[Sequence[fmpq]]) -> list[int]:
    """Independent rows with others that make them a basis of all rows, and the last row."""
    order = [*places[:-1], *range(len(lines))]
    return [order[k] for k in pivot_columns(list(zip(*(lines[i] for i in order), strict=True)))] + [places[-1]]


def combine_entries(factors: Sequence[fmpq], entries: Sequence[Any]) -> str:
    """The sum of factors times entries: a number where these are numbers, else a formula."""
    if not any(isinstance(e, str) for e in entries):
        return str(sum((a * e for a, e in zip(factors, entries, strict=True)), fmpq(0)))
    terms = [str(e) if a == 1 else f"({a})*({e})" for a, e in zip(factors, entries, strict=True)]
    return " + ".join(terms)


def write_cones(plan: Plan) -> dict[str, Any] | None:
    """The certificate of kind cones; None where a regressor, a bound or the functional is not rational."""
    from navsym.guaranteed.blocks import Part, certify_optimum

    flow, rows, columns = plan.flow, list(plan.rows), plan.columns
    with precision(BITS):
        exact = [flow.exact_row(row.j, row.t, plan.now) for row in rows]
    functional = [p for p in map(flow.exact_target, columns) if p is not None]
    if None in exact or len(functional) < len(columns) or not all(NUMBER.fullmatch(row.text) for row in rows):
        return None
    sigma, parts = [read_exact(row.text, "sigma") for row in rows], []
    groups = group_rows(flow, rows)
    alone = {i for _, places in groups for i in places}.symmetric_difference(range(len(rows)))
    for block, places in [*groups, *((None, [i]) for i in sorted(alone))]:
        own = [sigma[i] for i in places]
        size = block.size([rows[i].j for i in places], own, fmpq_mat) if block else fmpq_mat([own])
        H = fmpq_mat([[exact[i][k] for k in columns] for i in places])  # type: ignore[index]
        parts.append(Part(H, block.norm if block else "linf", size))
    return certify_optimum(parts, fmpq_mat([[p] for p in functional]))


def write_certificate(plan: Plan) -> dict[str, Any] | None:
    """The certificate of kind gap; None where a regressor has no formula."""
    flow = plan.flow
    with precision(BITS):
        texts = [flow.row_text(row.j, row.t, plan.now) for row in plan.rows]
        if any(text is None for text in texts):
            return None
        support = [plan.rows[i] for i in plan.basis]
        whole = [flow.ball_row(row.j, row.t, plan.now) for row in support]
        balls = arb_mat([[row[k] for k in plan.columns] for row in whole])
        side = arb_mat([[row.sigma * s] for row, s in zip(support, plan.signs, strict=True)])
        shrink = arb(fmpq(10**15 - 1, 10**15)) * plan.lower / plan.upper
        dual = [decimal(e * shrink, 60) for e in (balls.inv() * side).entries()]
        panels = [
            {"measurement": row.j, "from": "0", "to": "1", "sigma": row.text, "H": [text[k] for k in plan.columns]}
            for row, text in zip(plan.rows, texts, strict=True)
            if text is not None
        ]
        return {
            "kind": "gap",
            "variable": "place",
            "panels": panels,
            "functional": [to_text(flow.functional[k]) for k in plan.columns],
            "bits": BITS + 64,
            "cells": min(len(plan.rows) // 4 + 1, 20_000),
            "parameter": "none",
            "from": "0",
            "to": "0",
            "lower": lower_end(plan.upper * shrink, DIGITS),
            "upper": upper_end(plan.upper, DIGITS),
            "dual": dual,
            "support": [[i, "0"] for i in plan.basis],
        }
