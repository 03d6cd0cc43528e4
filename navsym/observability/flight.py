"""A model along a given flight, in balls: transition matrix and information, from node to node.

``Phi' = F Phi`` and ``W' = (H Phi)^T R^-1 (H Phi)`` start at the unit matrix and at zero. Over a constant piece both
are blocks of one exponential (Van Loan 1978). Where F or H move they are Taylor polynomials in the time with the
remainder of Lagrange: its coefficient is taken over a box that holds all that moves (Moore, Interval Analysis, chapter
11). A model in steps multiplies. Samples add ``(H Phi)^T R^-1 (H Phi)`` at their times.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce
from typing import Any

import sympy as sp
from flint import arb, arb_mat, arb_series, ctx, fmpq

from navsym.core.balls import Tape, enclose, series_terms, tape
from navsym.core.errors import DomainError, EmptyError, TooLargeError
from navsym.core.exact import to_fmpq
from navsym.language.expression import symbol
from navsym.models.along import model_along_motion
from navsym.models.modelfile import ModelFile

#: Terms of a Taylor polynomial, halvings of one step, tries of a box, and samples of a flight.
ORDER, HALVINGS, BOXES, SAMPLES = 30, 16, 30, 20_000
#: Largest remainder of a Taylor polynomial.
SMALL = arb(2) ** -100


@dataclass(frozen=True, slots=True, eq=False)
class Reach:
    """What is known at a time: values of all that moves, Phi from the start, and the information on the first state."""

    at: fmpq
    values: Mapping[sp.Symbol, arb]
    Phi: arb_mat
    W: arb_mat


@dataclass(frozen=True, slots=True, eq=False)
class Flight:
    """A model with numbers for all that it holds.

    pieces : (end, F in rows, whether F and H stand still), in order; the last has no end. Phi of a model in steps
    H      : rows over their standard deviations
    rates  : what moves -> its derivative, the time among it;  first : its values at the start
    every  : step of samples, None for noise that is white in time
    known, sizes : constant spans that come again, and the size of the next Taylor step
    """

    size: int
    pieces: Sequence[tuple[fmpq | None, list[Tape], bool]]
    H: list[Tape]
    rates: Mapping[sp.Symbol, Tape]
    first: Mapping[sp.Symbol, sp.Expr]
    end: fmpq
    every: fmpq | None = None
    steps: bool = False
    known: dict[Any, tuple[arb_mat, arb_mat]] = field(default_factory=dict)
    sizes: list[fmpq] = field(default_factory=list)

    @property
    def is_moving(self) -> bool:
        """Whether F or H move somewhere."""
        return not all(still for _, _, still in self.pieces)

    def start(self) -> Reach:
        """The start of the flight, with the sample there."""
        self.known.clear()
        values = {s: enclose(value, bits=ctx.prec) for s, value in self.first.items()}
        return self.sampled(Reach(fmpq(0), values, unit_matrix(self.size), arb_mat(self.size, self.size)))

    def nodes(self, after: fmpq, until: fmpq) -> Iterator[fmpq]:
        """Ends of pieces and times of samples behind one time, up to another."""
        ends = [end for end, _, _ in self.pieces if end is not None]
        while after < until:
            later = [until, *(end for end in ends if end > after)]
            after = min(later if self.every is None else [*later, ((after / self.every).floor() + 1) * self.every])
            yield after

    def advance(self, reach: Reach, until: fmpq) -> Reach:
        """What is known at a later time."""
        for node in self.nodes(reach.at, until):
            while reach.at < node:
                reach = self.step(reach, node)
            reach = self.sampled(reach)
        return reach

    def sampled(self, reach: Reach) -> Reach:
        """With the sample of this time, if there is one."""
        if self.every is None or (reach.at / self.every).q != 1:
            return reach
        seen = self.matrix(self.H, reach.values) * reach.Phi
        return replace(reach, W=reach.W + seen.transpose() * seen)

    def matrix(self, entries: list[Tape], values: Mapping[sp.Symbol, arb]) -> arb_mat:
        """Entries in rows of n. Raises DomainError where one has no value."""
        found = [arb(entry.run(values)) for entry in entries]
        if not all(entry.is_finite() for entry in found):
            raise DomainError("expected F, h and sigma with a value all along; got none; change the flight")
        return arb_mat(len(found) // self.size, self.size, found)

    def step(self, reach: Reach, until: fmpq) -> Reach:
        """As far as one formula leads, without samples."""
        F, still = next((F, still) for end, F, still in self.pieces if end is None or end > reach.at)
        if not still:
            return self.taylor_step(reach, until, F)
        span = until - reach.at
        key = (id(F), int(span.p), int(span.q))
        if key not in self.known:
            zero = arb_mat(self.size, self.size)
            self.known[key] = (self.matrix(F, {}), zero) if self.steps else self.exponential(F, span)
        return joined(reach, until, {s: v + arb(span) for s, v in reach.values.items()}, *self.known[key])

    def exponential(self, F: list[Tape], span: fmpq) -> tuple[arb_mat, arb_mat]:
        """Phi and W over a constant piece: exp([[-F', Q], [0, F]] h) = [[*, X], [0, Phi]], and W = Phi' X."""
        n, A = self.size, self.matrix(F, {}).tolist()
        seen = self.matrix(self.H, {}) if self.every is None else arb_mat(1, n)
        Q = (seen.transpose() * seen).tolist()
        rows = [[*(-row[i] for row in A), *Q[i]] for i in range(n)] + [[arb(0)] * n + row for row in A]
        whole = (arb_mat(rows) * arb(span)).exp().tolist()
        X, Phi = (arb_mat([row[n:] for row in part]) for part in (whole[:n], whole[n:]))
        return Phi, Phi.transpose() * X

    # Where F or H move

    def taylor_step(self, reach: Reach, until: fmpq, F: list[Tape]) -> Reach:
        """A step that is halved until its remainder is small; the next one starts from there."""
        whole = until - reach.at
        before = list(self.sizes)
        span = first = min([whole, *before])
        while True:
            box = self.box_over(reach.values, arb(span))
            found = self.try_step(reach, span, F, box) if box is not None else None
            if found is not None:
                self.sizes[:] = [max([*self.sizes, *(before if span == first else [])])]
                return found
            if span * 2**HALVINGS < self.end:
                break
            span = span / 2
        got = f"a singularity near t = {float(reach.at.p) / float(reach.at.q):.6g}"
        raise DomainError(f"expected functions that are analytic along the flight; got {got}; shorten it")

    def box_over(self, values: Mapping[sp.Symbol, arb], h: arb) -> dict[sp.Symbol, arb] | None:
        """Where all that moves stays over a step: a box that Picard's operator maps into itself."""
        box, whole = dict(values), arb(0).union(h)
        for _ in range(BOXES):
            mapped = {s: value + whole * arb(self.rates[s].run(box)) for s, value in values.items()}
            if not all(value.is_finite() for value in mapped.values()):
                return None
            if all(box[s].contains(value) for s, value in mapped.items()):
                return mapped
            box = {s: arb(value.mid(), (value.rad() * 1.25).upper()) for s, value in mapped.items()}
        return None

    def try_step(self, reach: Reach, span: fmpq, F: list[Tape], box: Mapping[sp.Symbol, arb]) -> Reach | None:
        """The step over a span; None where the remainder is too large."""
        n, h = self.size, arb(span)
        try:
            rows = self.matrix(F, box).tolist()
        except DomainError:
            return None
        bound = reduce(arb.max, [sum((abs(x) for x in row), arb(0)).upper() for row in rows]) * h
        if not bound < 4:
            return None
        around = arb_mat(n, n, [arb(0, bound.exp().upper())] * (n * n))  # |Phi| <= exp(|F| h)
        thin, wide = self.expand(reach.values, unit_matrix(n), F), self.expand(box, around, F)
        rest = [part[ORDER] * h**ORDER for part in wide]
        largest = reduce(arb.max, [abs(x).upper() for part in rest for x in part.entries()])
        if not largest < SMALL:
            return None
        self.sizes[:] = [2 * span if largest * 2**ORDER < SMALL else span]
        moved, Phi, W = (
            sum((part[k] * h**k for k in range(1, ORDER)), part[0] + last)
            for part, last in zip(thin, rest, strict=True)
        )
        values = dict(zip(reach.values, moved.entries(), strict=True))
        return joined(reach, reach.at + span, values, Phi, W)

    def expand(
        self, values: Mapping[sp.Symbol, arb], Phi: arb_mat, F: list[Tape]
    ) -> tuple[list[arb_mat], list[arb_mat], list[arb_mat]]:
        """Coefficients 0 ... ORDER of all that moves, of Phi from its first one, and of W from zero."""
        with series_terms(ORDER + 1):
            series = {s: arb_series([value]) for s, value in values.items()}
            alone = all(not rate.expression.free_symbols for rate in self.rates.values())
            for _ in range(1 if alone else ORDER):
                slopes = {s: arb_series(self.rates[s].run(series)) for s in series}
                series = {s: values[s] + slope.integral() for s, slope in slopes.items()}
            moved = coefficients([*series.values()], 1)
            A = coefficients([arb_series(entry.run(series)) for entry in F], self.size)
            H = self.H if self.every is None else []
            C = coefficients([arb_series(entry.run(series)) for entry in H] or [arb_series([0])] * self.size, self.size)
        flow, seen, W = [Phi], list[arb_mat](), [arb_mat(self.size, self.size)]
        for k in range(ORDER):
            share = arb(1) / (k + 1)
            seen.append(convolved(C, flow, k))
            W.append(convolved([part.transpose() for part in seen], seen, k) * share)
            flow.append(convolved(A, flow, k) * share)
        return moved, flow, W


def unit_matrix(n: int) -> arb_mat:
    """The unit matrix."""
    return arb_mat(n, n, [int(i == j) for i in range(n) for j in range(n)])


def joined(reach: Reach, at: fmpq, values: Mapping[sp.Symbol, arb], Phi: arb_mat, W: arb_mat) -> Reach:
    """What is known after one more span with this Phi and W of its own."""
    return Reach(at, values, Phi * reach.Phi, reach.W + reach.Phi.transpose() * W * reach.Phi)


def coefficients(entries: Sequence[arb_series], columns: int) -> list[arb_mat]:
    """Coefficients 0 ... ORDER of a matrix of series."""
    return [arb_mat(len(entries) // columns, columns, [entry[k] for entry in entries]) for k in range(ORDER + 1)]


def convolved(left: Sequence[arb_mat], right: Sequence[arb_mat], k: int) -> arb_mat:
    """Coefficient k of a product of two matrices of series."""
    return sum((left[i] * right[k - i] for i in range(1, k + 1)), left[0] * right[k])


# From a model


def flight_of(
    found: ModelFile, first: Mapping[sp.Symbol, sp.Expr], end: fmpq, every: fmpq | None, where: str
) -> Flight:
    """The flight of a model without free parameters.

    first : values of all that moves at the start, but the time;  every : step of samples, None for white noise

    Raises DomainError for inputs, relations, symbols without a value and ends that are not rational; TooLargeError.
    """
    if found.inputs or found.relations:
        got = "unknown inputs" if found.inputs else "relations"
        raise DomainError(f"expected a model without inputs and relations; got {got}; leave them out", where=where)
    if not found.measurements:
        raise EmptyError("expected at least one measurement; got none; add a row h", where=where)
    every = fmpq(1) if found.Phi is not None else every
    if every is not None and end > every * SAMPLES:
        raise TooLargeError(f"expected at most {SAMPLES} samples; got more; shorten the flight", where=where)
    along = model_along_motion(found)
    states = [symbol(name) for name in found.states]
    listed = [[sp.diff(m.z, x) for x in states] if m.z is not None else m.h for m in found.measurements]
    H = [sp.sympify(x / m.sigma, strict=True) for row, m in zip(listed, found.measurements, strict=True) for x in row]
    given = [along.F] if found.Phi is not None or found.dynamics else [piece.F for piece in found.pieces]
    ends = [*[piece.end for piece in found.pieces][:-1], None]
    rates = {found.time: sp.Integer(1), **along.rates}
    needed = moving_symbols([*H, *(x for F in given for x in F)], rates)
    known = {found.time: sp.Integer(0), **first}
    loose = {s for e in (*H, *(x for F in given for x in F), *(rates[s] for s in needed)) for s in e.free_symbols}
    for s in sorted(loose - (known.keys() & rates.keys()), key=str):
        what, remedy = ("start", "start") if s in rates else ("value", "values")
        message = f'expected a {what} of {s}; got none; give {remedy}={{"{s}": "1"}} (--{remedy[:5]} {s}=1)'
        raise DomainError(message.replace("--value", "--set"), where=where)
    still = not needed
    pieces = [
        (
            rational_time(stop, where) if stop is not None else None,
            [tape(x) for x in F],
            still or not (moving_symbols([*H, *F], rates)),
        )
        for F, stop in zip(given, ends, strict=True)
    ]
    programs = {s: tape(rates[s]) for s in needed}
    starts = {s: known[s] for s in needed}
    return Flight(len(states), pieces, [tape(x) for x in H], programs, starts, end, every, found.Phi is not None)


def moving_symbols(entries: Sequence[sp.Expr], rates: Mapping[sp.Symbol, sp.Expr]) -> list[sp.Symbol]:
    """What moves in some entries, and in the rates of that."""
    needed: set[sp.Symbol] = set()
    fresh = {s for entry in entries for s in entry.free_symbols} & rates.keys()
    while fresh:
        needed |= fresh
        fresh = ({s for name in fresh for s in rates[name].free_symbols} & rates.keys()) - needed
    return sorted(needed, key=str)


def rational_time(value: sp.Expr, where: str) -> fmpq:
    """A time as a fraction. Raises DomainError for others."""
    if not value.is_Rational:
        raise DomainError(f"expected times that are fractions; got {value}; round it", where=where)
    return to_fmpq(value)
