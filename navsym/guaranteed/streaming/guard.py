"""Guaranteed estimation in operation: at every epoch the target at that time, with an enclosed radius."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import isfinite
from typing import Any

import numpy as np
from flint import arb, arb_mat, fmpq

from navsym.core.balls import precision
from navsym.core.errors import DomainError, DuplicateError, ShapeError, TooLargeError, UnknownSymbolError
from navsym.core.exact import decimal, to_fmpq
from navsym.core.numbers import Number
from navsym.guaranteed.streaming.estimate import Estimate, Exclusion, Plan
from navsym.guaranteed.streaming.exchange import (
    Cloud,
    Optimum,
    bounds_of,
    exchange,
    price_basis,
    solve_basis,
    violated_row,
)
from navsym.guaranteed.streaming.explanations import Combination, contradiction, explain_data
from navsym.guaranteed.streaming.flow import BITS, Flow
from navsym.guaranteed.streaming.memory import MOST_ROWS, STRIDE, Memory, Row
from navsym.guaranteed.streaming.numbers import read_exact, to_float
from navsym.guaranteed.streaming.scarce import find_contradiction, solve_scarce
from navsym.language.names import quote
from navsym.models.model import Model, as_model

BOUNDS = ("bounded", "variance")
MOST_OUTLIERS = 4
#: Times are not larger: turns through larger angles have no digits left at the working precision.
LATEST = 10**21
#: The middle of values of the target is zero where it is less than this part of their width.
ROUNDING = arb("1e-40")

Taken = list[tuple[int, fmpq, fmpq | None]]


class Guard:
    """The guaranteed estimator of a target, epoch by epoch.

    At every epoch it holds the linear unbiased estimate ``sum w_i z_i`` of the target at the time of that epoch, from
    all epochs so far or from the last ``memory``, whose radius ``sum sigma_i |w_i|`` is the least there is. The weights
    bound the radius from above, a dual vector x with ``|x . h_i| <= sigma_i`` from below, both in ball arithmetic.

    model    : a :class:`navsym.Model`, or the path of a model file; its interval is not used
    target   : name of the target; not needed where the model has one
    bound    : "bounded": ``|r_i| <= sigma_i``; "variance": standard deviations of at most sigma_i, any correlation
    memory   : epochs that are remembered; None: all
    outliers : at most so many epochs have gross errors of any size, at unknown places; 0 to 4
    step     : time between epochs, for :meth:`step` without ``t``; the first epoch is then at 0
    values   : exact values of parameters of the model

    Times, measurements and bounds are exact: a float is the decimal that it prints as. Under "variance" no data are
    impossible. Under "bounded" data that no state explains raise InconsistentError, which names the epochs of a
    contradiction; the guard stays as it was. With outliers, estimate and radius are the middle and half the
    width of all values of the target at states that explain all epochs but so many.

    Raises NotEstimableError for a target that the measurements never show, DomainError for F(t) and for parameters
    without a value.

    >>> import navsym as nav
    >>> model = nav.Model(states="x v", F=[["0", "1"], ["0", "0"]], H=["x"], sigma="1", targets={"speed": "v"})
    >>> guard = nav.Guard(model, "speed")
    >>> for k, z in enumerate([0.1, 1.2, 1.9, 3.1]):
    ...     estimate = guard.step(z, t=k)
    >>> estimate
    Estimate(speed at 3: 1.0 within 0.666667, bounded)
    >>> estimate.check()
    <1 checked, all ACCEPTED>
    """

    def __init__(
        self,
        model: Model | str | os.PathLike[str],
        target: str | None = None,
        bound: str = "bounded",
        *,
        memory: int | None = None,
        outliers: int = 0,
        step: Any = None,
        values: Mapping[str, Any] | None = None,
    ):
        if bound not in BOUNDS:
            message = f'expected "bounded" or "variance"; got {quote(bound)}; choose one'
            raise DomainError(message, where="Guard: bound")
        self.bound = bound
        self.length = None if memory is None else whole_number(memory, 1, MOST_ROWS, "Guard: memory")
        self.outliers = whole_number(outliers, 0, MOST_OUTLIERS, "Guard: outliers")
        if self.outliers and bound == "variance":
            message = 'expected bounded errors beside gross errors; got "variance"; leave the bound out'
            raise DomainError(message, where="Guard: outliers")
        self.pace = None if step is None else read_exact(step, "Guard: step")
        if self.pace is not None and not self.pace > 0:
            got = str(self.pace)
            raise DomainError(f"expected a positive time step; got {got}; correct it", where="Guard: step")
        self.model = as_model(model, "Guard: model").with_values(**dict(values or {}))
        with precision(BITS):
            self.flow = Flow(self.model.read(), target, "Guard")
        if bound == "variance" and any(b.norm == "l1" for b in self.flow.blocks):
            message = 'expected bounded errors where their sizes add up; got standard deviations; drop the "l1" block'
            raise DomainError(message, where="Guard: bound")
        self.memory = Memory(self.flow, self.length)
        # Hints for the search; nothing that is said of an epoch rests on them.
        self.basis: list[int] = []
        self.signs: list[int] = []
        self.solved: Optimum | None = None
        self.plan: Plan | None = None
        self.state: arb_mat | None = None
        self.epochs = 0
        self.alike = 0
        self.pattern: Any = None
        self.choose_kinds()

    @property
    def target(self) -> str:
        """Name of the target."""
        return self.flow.target

    @property
    def radius_kind(self) -> str:
        """The noise law: "bounded", "variance" or "outliers"."""
        return "outliers" if self.outliers else self.bound

    @property
    def remembered(self) -> int:
        """Number of measurements in memory."""
        return len(self.memory)

    def __repr__(self) -> str:
        span = "all epochs" if self.length is None else f"the last {self.length} epochs"
        return f"Guard({quote(self.target)[1:-1]}: {self.radius_kind}, {span}; {self.epochs} so far)"

    # One epoch

    def step(self, z: Any = None, t: Any = None, *, sigma: Any = None) -> Estimate:
        """Take the measurements of an epoch and return the estimate at its time.

        z     : name -> number, a list with one entry per measurement, or one number where the model has one
                measurement; None is no measurement
        t     : time of the epoch, later than the last; the last time plus ``step`` where it is left out
        sigma : noise bounds in this epoch in place of the model's, given as z is

        Raises NavsymError for what is no finite number, for times that do not rise, and InconsistentError for data
        that no state explains where errors are bounded; the guard is then as before.
        """
        at = self.next_time(t)
        taken = self.read_values(z, sigma)
        before, mark = vars(self).copy(), self.memory.mark()
        with precision(BITS):
            try:
                self.move_hints(lambda: self.memory.add(at, taken))
                self.note_pattern(at, taken)
                self.change_kinds()
                answer, since = self.answer(at, len(taken)), self.memory.restart
            except BaseException:
                self.__dict__.update(before)
                self.memory.take_back(mark)
                raise
            self.epochs += 1
            if self.length is not None and self.memory.gone >= max(self.length, STRIDE):
                self.move_hints(self.memory.refer_within_doubles)
        return answer if since is None else replace(answer, since=since)

    def next_time(self, t: Any) -> fmpq:
        """The time of the epoch, later than the last."""
        before = self.memory.times[-1] if self.memory.times else None
        if t is None:
            if self.pace is None:
                raise DomainError("expected a time; got none; give t, or a step to Guard", where="Guard.step: t")
            return fmpq(0) if before is None else before + self.pace
        at = read_exact(t, "Guard.step: t")
        if abs(at) > LATEST:
            message = f"expected times of at most 1e21 in size; got {to_float(at):.3g}; take another unit of time"
            raise TooLargeError(message, where="Guard.step: t")
        if before is not None and at <= before:
            got = f"{to_float(at):.12g} after {to_float(before):.12g}"
            kind = DuplicateError if at == before else DomainError
            raise kind(f"expected times that rise; got {got}; sort them and join equal ones", where="Guard.step: t")
        return at

    def read_values(self, z: Any, sigma: Any) -> Taken:
        """(measurement, value, own noise bound) of what was measured."""
        given, bounds = self.name_values(z, "z"), self.name_values(sigma, "sigma")
        taken: Taken = []
        for j, name in enumerate(self.flow.names):
            if given.get(name) is None:
                continue
            own = bounds.get(name)
            bound = None if own is None else read_exact(own, f"Guard.step: sigma of {name}")
            if bound is not None and not bound > 0:
                message = f"expected a positive noise bound; got {quote(own)}; correct it"
                raise DomainError(message, where=f"Guard.step: sigma of {name}")
            taken.append((j, read_exact(given[name], f"Guard.step: {name}"), bound))
        return taken

    def name_values(self, given: Any, what: str) -> dict[str, Any]:
        """Values by their names, or in the order of the model."""
        names, where = self.flow.names, f"Guard.step: {what}"
        if isinstance(given, Mapping):
            for name in given:
                if name not in names:
                    got = f"got {quote(name)}; name one of {', '.join(names)}"
                    raise UnknownSymbolError(f"expected a measurement of the model; {got}", where=where)
            return dict(given)
        given = given.tolist() if isinstance(given, np.ndarray) else given
        values = [] if given is None else list(given) if isinstance(given, list | tuple) else [given]
        if given is not None and len(values) != len(names):
            message = f"expected {len(names)} values, one per measurement; got {len(values)}; put None for none"
            raise ShapeError(message, where=where)
        return dict(zip(names, values, strict=False))

    def choose_kinds(self) -> None:
        """Keep the unknowns that the measurements in memory need, and note whether they can show the target."""
        self.kinds = self.memory.kinds()
        self.showing = self.flow.choose_unknowns(self.kinds)

    def change_kinds(self) -> None:
        """The same when a measurement appears or disappears; all rows are then written in the new unknowns."""
        if self.kinds == self.memory.kinds():
            return
        before = self.flow.columns
        self.choose_kinds()
        if self.flow.columns != before:
            self.memory.refer_within_doubles()
            self.basis, self.signs, self.solved, self.plan, self.state = [], [], None, None, None

    def note_pattern(self, at: fmpq, taken: Taken) -> None:
        """Count the epochs that repeat the one before: same step, same measurements, same bounds."""
        times = self.memory.times
        pattern = (at - times[-2] if len(times) > 1 else None, [(j, own) for j, _, own in taken])
        self.alike = self.alike + 1 if pattern == self.pattern else 1
        self.pattern = pattern

    def move_hints(self, change: Callable[[], None]) -> None:
        """Change the memory; where it is referred to another time, places of rows change with it."""
        memory = self.memory
        reference, since, moved = memory.reference, memory.since, memory.moved
        change()
        if memory.reference != reference:
            self.basis = [i - memory.moved + moved for i in self.basis]
            self.solved = self.state = None
        if memory.since != since:
            self.alike = 0

    def answer(self, at: fmpq, fresh: int) -> Estimate:
        """The estimate from what is in memory."""
        if self.outliers and self.showing:
            return self.answer_with_outliers(at)
        self.plan = (self.repeat(at, fresh) or self.optimise(at, fresh)) if self.showing else None
        if self.bound == "bounded" and self.plan:
            self.need_consistent(fresh)
        elif self.bound == "bounded":
            self.need_scarcely_consistent(at)
        if not self.showing:
            return Estimate(to_float(at), self.target, None, self.radius_kind)
        plan = self.plan or solve_scarce(self.flow, self.memory.rows[self.memory.first :], at)
        if plan is None:
            return Estimate(to_float(at), self.target, None, self.radius_kind)
        value, count = float(plan.value()), sum(not w.contains(0) for w in plan.weights)
        if not isfinite(value) or not isfinite(float(plan.upper)):
            message = f"expected a target and a radius within the range of doubles; got {quote(self.target)} beyond it"
            raise TooLargeError(f"{message}; measure earlier, or take another unit", where=f"t = {to_float(at):.12g}")
        return Estimate(
            to_float(at), self.target, value, self.radius_kind, count, low=plan.lower, high=plan.upper, plan=plan
        )

    def repeat(self, at: fmpq, fresh: int) -> Plan | None:
        """The weights of the epoch before, where the problem is the same but for its time.

        With F, h and bounds constant a shift of all times changes nothing, so that a full memory of equal epochs has
        the optimum that it had: a fixed-memory rule with constant weights.
        """
        before, memory = self.plan, self.memory
        if self.length is None or before is None or self.alike <= self.length + 1 or not self.flow.is_invariant:
            return None
        self.basis = [i + fresh for i in self.basis]
        return replace(before, now=at, rows=Window(memory.rows, memory.first, len(memory.rows)))

    def optimise(self, at: fmpq, fresh: int) -> Plan | None:
        """The optimum, from the last support where that is still in memory."""
        memory = self.memory
        if len(memory) < self.flow.size:
            self.solved, self.basis, self.signs = None, [], []
            return None
        cloud, target = memory.cloud(), memory.target()
        if cloud.cones:  # each epoch by itself: combinations of rows are not kept
            self.basis, self.signs, start = [], [], cloud.start() or []
            self.solved = exchange(cloud, target, start) if start else None
            return None if self.solved is None else self.make_plan(at, self.solved, cloud)
        old = self.solved
        kept = bool(self.basis) and min(self.basis) >= memory.first
        found = None
        if kept:  # also after a restart, so that a tie ends as it would have without one
            if old is not None and old.basis == self.basis:
                found = price_basis(cloud, target, old.basis, old.signs, old.inverse)
            else:
                found = solve_basis(cloud, target, self.basis, self.signs)
            if found is not None and violated_row(cloud, found) is None:
                self.solved, self.signs = found, found.signs
                return self.make_plan(at, found, cloud)
        support = moved_basis(self.basis, memory.rows, memory.first) or (self.basis if kept else [])
        found = exchange(cloud, target, support) if support else None
        if found is None:
            start = cloud.start() or []
            found = exchange(cloud, target, start) if start else None
        self.solved = found
        self.basis, self.signs = (found.basis, found.signs) if found else ([], [])
        return None if found is None else self.make_plan(at, found, cloud)

    def make_plan(self, at: fmpq, found: Optimum, cloud: Cloud) -> Plan:
        """The weights as the estimate keeps them."""
        rows, first = self.memory.rows, self.memory.first
        weights = cloud.spread(found) if cloud.cones else dict(zip(found.basis, found.weights.entries(), strict=True))
        window, places = Window(rows, first, len(rows)), [i - first for i in weights]
        bounds = bounds_of(cloud, found)
        return Plan(self.flow, at, window, self.flow.columns, places, self.signs, [*weights.values()], *bounds)

    def interval(self) -> Number | None:
        """All values of the target at the last epoch that the data allow, as an enclosure from both sides.

        Of all states that keep every bound, or every bound but those of ``outliers`` epochs. It is never wider than
        estimate and radius say, and often much narrower, because it uses the data. None under "variance", where data
        exclude nothing, and while the state is not determined.

        >>> import navsym as nav
        >>> guard = nav.Guard(nav.Model(states="b", F=[["0"]], H=["b"], sigma="1/2"))
        >>> [guard.step(z, t=k).value for k, z in enumerate(["3", "3.75"])]
        [3.0, 3.0]
        >>> guard.interval()
        Number(lower='3.25', upper='3.5')
        """
        memory = self.memory
        if self.bound == "variance" or not self.showing or len(memory) < self.flow.size:
            return None
        with precision(BITS):
            start = memory.cloud().start() or []
            found = explain_data(memory, self.outliers, start, [])
            if found.low is None or found.high is None:
                return None
            low, high = to_fmpq(found.low[0].lower()), to_fmpq(found.high[1].upper())
            return Number(decimal(low, 24, -1), decimal(high, 24, 1))

    # Saved and continued

    def save(self, path: str | os.PathLike[str] | None = None) -> dict[str, Any]:
        """The guard as plain data, written to a JSON file where a path is given; :meth:`load` continues from it.

        Model, options and the measurements in memory are exact, the last support is a hint. Raises OutputError.
        """
        from navsym.guaranteed.streaming.state import write_state

        return write_state(self, path)

    @staticmethod
    def load(source: str | os.PathLike[str] | Mapping[str, Any]) -> Guard:
        """The guard that :meth:`save` wrote: a path, or its plain data. It goes on as the saved one would.

        Raises NavsymError for a file that is not one.

        >>> import navsym as nav
        >>> guard = nav.Guard(nav.Model(states="b", F=[["0"]], H=["b"], sigma="1/2"))
        >>> first = guard.step(3, t=0)
        >>> nav.Guard.load(guard.save()).step("3.5", t=1) == guard.step("3.5", t=1)
        True
        """
        from navsym.guaranteed.streaming.state import read_state

        return read_state(source)

    # Data that contradict each other

    def is_explained(self, new: int) -> bool:
        """Whether the state that keeps the bounds of the rows before keeps those of all rows from a place on."""
        cloud, rows = self.memory.cloud(data=True, first=new), range(new, len(self.memory.rows))
        return self.state is not None and bool(cloud.gauge(self.state, rows) <= 1)

    def need_consistent(self, fresh: int) -> None:
        """Raise InconsistentError where no state is proved to keep all bounds; look where the last one does not.

        In balls: doubles see nothing where measurements are 1e15 times their bounds.
        """
        memory = self.memory
        if self.is_explained(len(memory.rows) - fresh):
            return
        ends, start = [], self.basis or memory.cloud().start() or []
        for sign in (1, -1):
            cloud = memory.cloud(data=True)
            found = exchange(cloud, memory.target() * sign, start, [s * sign for s in self.signs])
            if found is None:
                return
            if found.ray is not None:
                rows = [memory.rows[i] for i, w in cloud.spread(found).items() if not w.contains(0)]
                raise contradiction((row.t for row in rows), 0)
            ends.append(found.dual)
        self.state = ((ends[0] + ends[1]) / 2).mid()

    def need_scarcely_consistent(self, at: fmpq) -> None:
        """The same where the measurements do not determine the state."""
        memory = self.memory
        if rows := find_contradiction(self.flow, memory.rows[memory.first :], at, self.outliers):
            raise contradiction((row.t for row in rows), self.outliers)

    def answer_with_outliers(self, at: fmpq) -> Estimate:
        """Middle and half width of the target over all explanations."""
        memory = self.memory
        self.basis = self.basis if self.basis and min(self.basis) >= memory.first else memory.cloud().start() or []
        self.signs = []
        found = explain_data(memory, self.outliers, self.basis, [])
        if found.low is None or found.high is None:
            self.basis = []  # another start is taken when there is more to choose from
            self.need_scarcely_consistent(at)
            return Estimate(to_float(at), self.target, None, "outliers")
        times = [to_float(t) for t in memory.times[memory.oldest :]]
        (low, low_inner), (high_inner, high) = found.low, found.high
        centre = (low + high) / 2
        excluded = [memory.times[memory.oldest + e] for e in found.excluded]
        return Estimate(
            to_float(at),
            self.target,
            0.0 if abs(centre) < (high - low) * ROUNDING else float(centre),
            "outliers",
            excluded=tuple(map(to_float, excluded)),
            others=tuple(tuple(times[e] for e in s) for s in found.others),
            low=((high_inner - low_inner) / 2).max(arb(0)),
            high=(high - low) / 2,
            exclusion=self.prepare_exclusion(at, excluded, found.contradictions) if excluded else None,
        )

    def prepare_exclusion(
        self, at: fmpq, excluded: list[fmpq], contradictions: Sequence[Sequence[Combination]]
    ) -> Exclusion:
        """What the certificate of the excluded epochs is made of, when it is asked for."""
        used = {(one.places, one.factors): one for rows in contradictions for one in rows}
        renamed = {key: k for k, key in enumerate(sorted(used, key=lambda key: key[0]))}
        found = [[renamed[one.places, one.factors] for one in rows] for rows in contradictions]
        rows = [([self.memory.rows[i] for i in key[0]], key[1], used[key].sigma) for key in renamed]
        return Exclusion(self.flow, at, rows, self.flow.columns, found, excluded, self.outliers)


class Window(Sequence[Any]):
    """Part of a list that only grows: what was in memory at one epoch, without a copy."""

    __slots__ = ("entries", "first", "last")

    def __init__(self, entries: list[Any], first: int, last: int):
        self.entries, self.first, self.last = entries, first, last

    def __len__(self) -> int:
        return self.last - self.first

    def __getitem__(self, place: Any) -> Any:
        if isinstance(place, slice):
            return self.entries[self.first : self.last][place]
        if not 0 <= place < len(self):  # the list behind goes on growing, and iteration ends here
            raise IndexError(place)
        return self.entries[self.first + place]


def moved_basis(basis: Sequence[int], rows: Sequence[Row], first: int) -> list[int]:
    """The support as it moves on with time, each row to the next of its measurement; empty where two become one."""
    moved = []
    for i in basis:
        k, j = max(i + 1, first), rows[i].j
        while k < len(rows) and rows[k].j != j:
            k += 1
        moved.append(k if k < len(rows) else i)
    return moved if len(set(moved)) == len(moved) and min(moved, default=0) >= first else []


def whole_number(value: Any, low: int, high: int, where: str) -> int:
    """An int of a range. Raises DomainError."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or not low <= value <= high:
        message = f"expected a whole number from {low} to {high}; got {quote(value)}; choose one"
        raise DomainError(message, where=where)
    return int(value)
