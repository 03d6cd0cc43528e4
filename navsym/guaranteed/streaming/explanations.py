"""States that explain all epochs but a few: the target over all of them, and which epochs no explanation can keep.

A set E of epochs explains the data when some state keeps the bounds of all other epochs. The tree of sets starts at the
empty one. Where the rows outside E admit no state, Farkas' weights contradict each other, and every
explanation that contains E contains one of their epochs too. Where they admit one, the weights of the optimum bound the
target for every explanation that keeps their epochs; the others contain one of them. So the children of E are
E with one of these at most m + 1 epochs, the tree ends at sets of K epochs, and its bounds hold for all explanations.
Combinations of measurements that are bounded together are rows of their epoch.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from flint import arb, arb_mat, fmpq, fmpq_mat

from navsym.core.errors import InconsistentError
from navsym.core.exact import to_fmpq
from navsym.guaranteed.streaming.exchange import Cloud, Optimum, cost_of, exchange
from navsym.guaranteed.streaming.flow import in_row_space, pivot_columns
from navsym.guaranteed.streaming.memory import Memory
from navsym.guaranteed.streaming.numbers import NUMBER, read_exact, to_float
from navsym.guaranteed.streaming.scarce import MOST, reduced_cloud

Epochs = frozenset[int]
#: A dual is drawn by less than this part of the way to states that keep all bounds.
NEAR = 1e-14


class Combination(NamedTuple):
    """Rows of one epoch with exact factors, and the bound of their sum."""

    places: tuple[int, ...]
    factors: tuple[fmpq, ...]
    sigma: arb


@dataclass(slots=True)
class Search:
    """One direction of the target: the largest value of P d over all explanations.

    memory   : what the rows and the target came from
    epoch    : (N,) the epoch of each row in memory
    upper    : bound of the target that no explanation exceeds
    best     : the rows of the set of epochs with that bound, the target in their unknowns, and its optimum
    explained : sets of epochs that explain the data
    refuted   : those that do not, with independent rows and one more, which contradict each other
    open     : whether some set stays undecided, so that no bound is known
    """

    memory: Memory
    cloud: Cloud
    target: arb_mat
    epoch: np.ndarray
    most: int
    side: int
    upper: arb | None = None
    best: tuple[Cloud, arb_mat, Optimum] | None = None
    explained: set[Epochs] = field(default_factory=set)
    refuted: dict[Epochs, list[Combination]] = field(default_factory=dict)
    open: bool = False

    def without(self, excluded: Epochs) -> Cloud:
        """The rows of all other epochs, as yet without combinations: two that are nearly one make a weak basis."""
        return replace(self.cloud, active=~np.isin(self.epoch, list(excluded)) if excluded else None)

    def visit(self, excluded: Epochs, start: Sequence[int], signs: Sequence[int]) -> None:
        """The tree below a set of epochs."""
        if self.open or excluded in self.refuted or excluded in self.explained:
            return
        cloud, target, first = self.without(excluded), self.target, self.cloud.first
        if cloud.cones or not start or any(self.epoch[i - first] in excluded for i in start):
            start, signs = cloud.start() or [], []
        fresh, found = replace(cloud), exchange(cloud, target, start, signs) if start else None
        if found is None and (scarce := self.reduce(excluded)) is not None:
            cloud, target, shown = scarce
            fresh, found = replace(cloud), exchange(cloud, target, cloud.start() or [])
            start, signs = [], []
            if found is not None and found.ray is None and not shown:
                found = None  # states that keep all bounds take every value of the target
        if found is None:
            self.open = True
            return
        if found.ray is not None:
            rows = [i for i, w in found.ray.items() if not w.is_zero()]
            parts = ((i, *cloud.parts(i)) for i in (*found.basis, rows[-1]))
            self.refuted[excluded] = [
                Combination(tuple(at), tuple(map(to_fmpq, a.entries())), cloud.sigma[i]) for i, at, a in parts
            ]
        else:
            rows = [i for i, w in zip(found.basis, found.weights.entries(), strict=True) if not w.is_zero()]
            self.note(fresh, target, cloud, excluded, found)
        if len(excluded) < self.most:
            for e in sorted({int(self.epoch[cloud.parts(i)[0][0] - first]) for i in rows}):
                self.visit(excluded | {e}, *((found.basis, found.signs) if start else ([], [])))

    def reduce(self, excluded: Epochs) -> tuple[Cloud, arb_mat, bool] | None:
        """Rows that do not determine the state, in the unknowns that they do determine; None where one is irrational.

        Places are those in memory. Also the target in these unknowns and whether the rows show it; any other if not.
        """
        memory, flow, first = self.memory, self.memory.flow, self.cloud.first
        rows, now = memory.rows[first:], memory.times[-1]
        active = ~np.isin(self.epoch, list(excluded))
        table = [flow.exact_row(row.j, row.t, now) for row in rows] if len(rows) <= MOST else [None]
        functional = [flow.exact_target(k) for k in range(len(flow.functional))]
        known = [line for line, use in zip(table, active, strict=False) if use]
        if None in table or None in functional or not known:
            return None
        columns, shown = pivot_columns(known), in_row_space(functional, known)  # type: ignore[arg-type]
        if not columns:
            return None
        cloud = reduced_cloud(flow, rows, table, columns, data=True)  # type: ignore[arg-type]
        blank = [arb(0)] * first
        cones = [(cone, [i + first for i in places]) for cone, places in cloud.cones]
        vectors = [arb_mat(1, len(columns))] * first + [*cloud.vectors]
        cloud = replace(
            cloud, vectors=vectors, sigma=[*blank, *cloud.sigma], offset=[*blank, *cloud.offset], cones=cones
        )
        target = arb_mat([[functional[k] if shown else fmpq(1) for k in columns]])  # type: ignore[misc]
        return replace(cloud, first=first, active=active), target * self.side, shown

    def note(self, fresh: Cloud, target: arb_mat, cloud: Cloud, excluded: Epochs, found: Optimum) -> None:
        """The bound of a set that is not refuted."""
        self.explained.add(excluded)
        weights = dict(zip(found.basis, found.weights.entries(), strict=True))
        cost = arb(cost_of(cloud, weights).upper())
        if self.upper is None or cost > self.upper:
            self.upper, self.best = cost, (fresh, target, found)

    def reached(self) -> arb:
        """A value that some explanation takes, near the bound; minus infinity where none is known.

        A dual that breaks bounds of several measurements by its rounding is drawn towards the middle of states that
        keep them, as far as convexity asks: (1 - p) outside + p inside = 1.
        """
        if self.best is None:
            return arb("-inf")
        cloud, goal, found = self.best
        if found.ratio == 1:  # the dual keeps every bound for certain: it is a state
            return (goal * found.dual)[0, 0]  # type: ignore[no-any-return]
        m = goal.ncols()
        rows = [i for i in range(cloud.first, len(cloud.vectors)) if cloud.may_use(i)]
        end, sides = found.dual.mid(), arb_mat([[int(i == k) for i in range(m)] for k in range(m)]).tolist()
        outside, states = cloud.gauge(end, rows), [end]
        for target in (-goal, *(arb_mat([row]) * sign for row in sides for sign in (1, -1))):
            other = exchange(replace(cloud), target, cloud.start() or [])
            if other is None or other.ray is not None:
                break
            states.append(other.dual.mid())
            middle = (sum(states[1:], states[0]) / len(states)).mid()
            inside = cloud.gauge(middle, rows)
            part = arb(((outside - 1) / (outside - inside)).upper()).max(arb(0))
            if inside < 1 and part < NEAR:  # without room inside nothing is known to be a state
                return (goal * (end + (middle - end) * part))[0, 0]  # type: ignore[no-any-return]
        return self.reach_exactly(cloud, found)

    def reach_exactly(self, cloud: Cloud, found: Optimum) -> arb:
        """The value of the dual where that is a state in rational numbers: states may have no room inside at all."""
        memory, flow, known = self.memory, self.memory.flow, {}
        goal = [flow.exact_target(k) for k in range(len(flow.functional))]
        for i, row in enumerate(memory.rows):
            if i >= cloud.first and cloud.may_use(i):
                known[i] = flow.exact_row(row.j, row.t, memory.times[-1]), row.z, row.text
        lines = [line for line, *_ in known.values()]
        if cloud.cones or None in lines or None in goal or not all(NUMBER.fullmatch(s) for *_, s in known.values()):
            return arb("-inf")
        columns = pivot_columns([known[i][0] for i in found.basis])  # type: ignore[misc]
        table = [[known[i][0][c] for c in columns] for i in found.basis]  # type: ignore[index]
        right = [[known[i][1] + s * read_exact(known[i][2], "")] for i, s in zip(found.basis, found.signs, strict=True)]
        x = fmpq_mat(table).solve(fmpq_mat(right)).entries()
        value = lambda line: sum((line[c] * e for c, e in zip(columns, x, strict=True)), fmpq(0))  # noqa: E731
        holds = all(abs(value(line) - z) <= read_exact(sigma, "") for line, z, sigma in known.values())
        return arb(value(goal)) * self.side if holds else arb("-inf")


@dataclass(frozen=True, slots=True)
class Explanations:
    """What is known about the target from all explanations of the data by at most K gross errors.

    low, high : enclosures of the ends of its values; None while they are not bounded
    sets      : the smallest sets of epochs (places in memory) that explain the data
    contradictions : rows that contradict each other, see Search
    """

    low: tuple[arb, arb] | None
    high: tuple[arb, arb] | None
    sets: tuple[Epochs, ...]
    contradictions: tuple[Sequence[Combination], ...] = ()

    @property
    def excluded(self) -> list[int]:
        """Epochs that belong to every explanation."""
        return sorted(frozenset.intersection(*self.sets)) if self.sets else []

    @property
    def others(self) -> list[list[int]]:
        """All smallest sets, where there are several."""
        return [sorted(s) for s in self.sets] if len(self.sets) > 1 else []


def explain_data(memory: Memory, most: int, basis: Sequence[int], signs: Sequence[int]) -> Explanations:
    """Bounds of the target over all states that keep all epochs in memory but ``most``.

    Raises InconsistentError where no state does.
    """
    epoch = np.repeat(np.arange(len(memory.counts) - memory.oldest), memory.counts[memory.oldest :])
    target = memory.target()
    searches = []
    for sign in (1, -1):
        search = Search(memory, memory.cloud(data=True), target * sign, epoch, most, sign)
        search.visit(frozenset(), basis, [s * sign for s in signs])
        if not search.open and not search.explained:
            rows = [i for one in search.refuted[frozenset()] for i in one.places]
            raise contradiction((memory.rows[i].t for i in rows), most)
        searches.append(search)
    up, down = searches
    if up.open or down.open:
        return Explanations(None, None, ())
    sets = up.explained | down.explained
    smallest = sorted((s for s in sets if not any(other < s for other in sets)), key=sorted)
    assert up.upper is not None and down.upper is not None
    high, low = (up.reached(), up.upper), (-down.upper, -down.reached())
    return Explanations(low, high, tuple(smallest), tuple({**up.refuted, **down.refuted}.values()))


def contradiction(times: Iterable[fmpq], most: int) -> InconsistentError:
    """The error for data that no state explains; it names the epochs of one contradiction."""
    at = ", ".join(f"{t:.12g}" for t in sorted(set(map(to_float, times))))
    but = f" but {most}" if most else ""
    remedy = "raise sigma, or allow more gross errors" if most else "check them, raise sigma, or allow gross errors"
    got = f"a contradiction at t = {at}"
    message = f"expected data that some state explains in all epochs{but}; got {got}; {remedy} (outliers)"
    return InconsistentError(message, where=f"t = {at}")
