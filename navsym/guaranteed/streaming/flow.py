"""What a model says at exact times: transitions and regressors as balls, as rationals where they are, and as text."""

from __future__ import annotations

import re
from collections import OrderedDict
from collections.abc import Sequence
from functools import cached_property
from typing import Any, NamedTuple

import sympy as sp
from flint import arb, arb_mat, fmpq, fmpq_mat

from navsym.core.balls import Tape, precision, tape
from navsym.core.errors import DomainError, EmptyError, NavsymError, NotEstimableError
from navsym.core.exact import to_fmpq
from navsym.guaranteed.problem import chosen_target
from navsym.guaranteed.streaming.numbers import to_float
from navsym.guaranteed.time_varying import has_varying_system
from navsym.language.expression import to_text
from navsym.language.names import quote
from navsym.models.modelfile import BasisFile, ModelFile
from navsym.models.transition.exponential import transition_matrix

#: Working precision of all balls of the stream. Sixty-four products between two exponentials lose less than half.
BITS = 192
#: Transitions over these spans are remembered.
REMEMBERED = 256
#: The word for the span of time in the text of a transition.
SPAN = re.compile(r"\bspan\b")


class Together(NamedTuple):
    """Measurements whose errors are bounded together: their places in the model, a norm and an exact shape."""

    members: tuple[int, ...]
    norm: str
    shape: fmpq_mat

    def size(self, members: Sequence[int], sigma: Sequence[Any], matrix: Any) -> Any:
        """The size of the cone of some members: all noise that they can have beside any of the others."""
        if self.norm != "l2":
            return matrix([[s] for s in sigma])
        k = [self.members.index(j) for j in members]
        return matrix(
            [[a * b * self.shape[i, j] for j, b in zip(k, sigma, strict=True)] for i, a in zip(k, sigma, strict=True)]
        )


class Flow:
    """``x(t) = Phi(t, s) x(s)`` and ``z_j(t) = h_j(t) x(t) + r_j`` of a model without free parameters.

    names    : measurements
    target   : name of the target; ``functional`` its entries, exact
    columns  : the unknowns that are kept for the measurements in memory; the others depend on them
    size     : m, their number
    blocks   : measurements whose errors are bounded together

    Raises DomainError for a parameter without a value, for F(t) and for a target that is zero, EmptyError without
    measurements, and NotEstimableError for a target outside everything that the measurements can ever show.
    """

    def __init__(self, contents: ModelFile | BasisFile, target: str | None, where: str):
        self.contents = contents
        self.target, self.functional = chosen_target(contents, target, where)
        if isinstance(contents, BasisFile):
            self.time, self.F = contents.variable, []
            self.h = list(contents.H)
            self.sigmas = tuple(contents.sigma)
        else:
            self.time, self.F = contents.time, list(contents.pieces)
            self.h = [m.h for m in contents.measurements]
            self.sigmas = tuple(m.sigma for m in contents.measurements)
        self.names = name_measurements(contents)
        self.blocks = list_blocks(contents, self.names)
        self.need_values(where)
        n = len(self.functional)
        self.columns, self.size = list(range(n)), n
        self.spaces: dict[frozenset[int], list[int] | None] = {}
        if not self.choose_unknowns(frozenset(range(len(self.h)))):
            message = (
                f"expected a target that the measurements can show; got {quote(self.target)}, which is outside the"
            )
            raise NotEstimableError(f"{message} observable subspace; add a measurement", where=f"{where}: target")
        self.memory: OrderedDict[Any, arb_mat] = OrderedDict()
        self.stride = fmpq(0)
        with precision(BITS):
            balls = [[tape(p).run({}) for p in self.functional]]
            self.row_of_target = arb_mat(balls)
            self.systems = [
                arb_mat([[tape(sp.sympify(e, strict=True)).run({}) for e in row] for row in piece.F.tolist()])
                for piece in self.F
            ]
        self.programs: list[list[Tape]] = [[tape(e) for e in row] for row in self.h]
        self.constant = [not any(e.has(self.time) for e in row) for row in self.h]
        self.steady: dict[int, arb_mat] = {}
        self.terms: dict[int, list[fmpq_mat] | None] = {}
        self.bounds: dict[int, tuple[arb, str]] = {}

    @cached_property
    def is_steady(self) -> bool:
        """Whether F is constant for all times."""
        return len(self.F) < 2

    @cached_property
    def is_invariant(self) -> bool:
        """Whether a shift of all times changes nothing."""
        return (
            bool(self.F)
            and self.is_steady
            and all(self.constant)
            and not any(sp.sympify(s, strict=True).has(self.time) for s in self.sigmas)
        )

    @cached_property
    def ends(self) -> list[fmpq | None]:
        """Ends of the pieces; None where the last goes on."""
        given = [piece.end for piece in self.F]
        if any(end is None or not end.is_Rational for end in given[:-1]):
            raise DomainError("expected pieces that end at rational times; got others; write these as fractions")
        return [to_fmpq(end) if end is not None and end.is_Rational else None for end in given]

    def need_values(self, where: str) -> None:
        """Refuse what the stream has no meaning for."""
        if not self.h:
            raise EmptyError("expected a measurement; got none; add a [[measurement]]", where=f"{where}: model")
        if isinstance(self.contents, ModelFile) and has_varying_system(self.contents):
            message = "expected F constant or in pieces; got F(t); give it piece by piece with [[piece]]"
            raise DomainError(message, where=f"{where}: model")
        entries = [e for row in self.h for e in row] + [e for p in self.F for e in p.F] + [*self.functional]
        free = {x.name for e in entries for x in sp.sympify(e, strict=True).free_symbols - {self.time}}
        free |= {x.name for e in self.sigmas for x in sp.sympify(e, strict=True).free_symbols - {self.time}}
        if free:
            got, given = f"none for {', '.join(sorted(free))}", " ".join(f"--set {name}=…" for name in sorted(free))
            message = f"expected a value for every parameter; got {got}; give them as values (Python) or {given}"
            raise DomainError(message, where=f"{where}: values")
        if all(p == 0 for p in self.functional):
            message = "expected a target that is not zero; got zeros; every estimator of it is free"
            raise DomainError(message, where=f"{where}: target")

    @cached_property
    def is_rational(self) -> bool:
        """Whether F, h and the functional are rational numbers, so that spaces are known exactly."""
        entries = [*(e for row in self.h for e in row), *(e for p in self.F for e in p.F), *self.functional]
        return bool(self.F) and self.is_steady and all(sp.sympify(e, strict=True).is_Rational for e in entries)

    def choose_unknowns(self, kinds: frozenset[int]) -> bool:
        """Keep the unknowns in which some measurements are unbiased; False where they never show the target.

        Every regressor ``h exp(F s)`` lies in the row space of the observability matrix (Cayley and Hamilton), and a
        vector of that space is determined by its entries at the pivots. Without rational numbers all are kept.
        """
        if not self.is_rational:
            return bool(kinds)
        if kinds not in self.spaces:
            self.spaces[kinds] = self.reduce_unknowns(kinds)
        columns = self.spaces[kinds]
        if columns is not None:
            self.columns, self.size = columns, len(columns)
        return columns is not None

    def reduce_unknowns(self, kinds: frozenset[int]) -> list[int] | None:
        """Pivots of the observability matrix; None where the target is not in its row space."""
        if not kinds:
            return None
        F = fmpq_mat([[to_fmpq(e) for e in row] for row in self.F[0].F.tolist()])
        blocks = [fmpq_mat([[to_fmpq(e) for e in self.h[j]] for j in sorted(kinds)])]
        for _ in range(F.nrows() - 1):
            blocks.append(blocks[-1] * F)
        rows = [row for block in blocks for row in block.tolist()]
        functional = [to_fmpq(p) for p in self.functional]
        return pivot_columns(rows) if in_row_space(functional, rows) else None

    # Balls

    def transition(self, start: fmpq, end: fmpq) -> arb_mat | None:
        """Phi(end, start) as a matrix of balls; None for a model without dynamics."""
        if not self.F:
            return None
        if self.is_steady:
            return self.long_exponential(end - start)
        if end < start:
            return self.transition(end, start).inv()  # type: ignore[union-attr]
        total, at = None, start
        for k in range(len(self.F)):
            last = self.ends[k]
            if last is not None and last <= at and not (k == len(self.F) - 1 and at == end):
                continue
            until = end if last is None or last >= end else last
            step = self.exponential(k, until - at)
            total, at = (step if total is None else step * total), until
            if at == end:
                return total
        raise self.outside(end)

    def long_exponential(self, span: fmpq) -> arb_mat:
        """exp(F span) as a product of two that come again: of whole strides, and of what is left.

        A product of many steps was rejected: balls about rotations grow with every factor.
        """
        if self.stride == 0 or span <= self.stride:
            return self.exponential(0, span)
        whole = (span / self.stride).floor() * self.stride
        far = self.exponential(0, whole)
        return far if whole == span else self.exponential(0, span - whole) * far

    def outside(self, t: fmpq) -> NavsymError:
        """The error for a time that no piece covers."""
        got = f"t = {to_float(t):.12g}"
        return DomainError(f"expected a time inside the pieces of the model; got {got}; extend the last piece")

    def exponential(self, piece: int, span: fmpq) -> arb_mat:
        """exp(F span), remembered."""
        key = (piece, span.p, span.q)
        found = self.memory.get(key)
        if found is None:
            found = (self.systems[piece] * arb(span)).exp()
            self.memory[key] = found
            if len(self.memory) > REMEMBERED:
                self.memory.popitem(last=False)
        return found

    def row(self, j: int, t: fmpq) -> arb_mat:
        """h_j(t), (1, n)."""
        known = self.steady.get(j)
        if known is not None:
            return known
        found = arb_mat([[arb(program.run({self.time: arb(t)})) for program in self.programs[j]]])
        if not all(e.is_finite() for e in found.entries()):
            message = f"expected a regressor with a value; got none of {quote(self.names[j])}; correct h"
            raise DomainError(message, where=f"t = {t}")
        if self.constant[j]:
            self.steady[j] = found
        return found

    def sigma(self, j: int, t: fmpq) -> tuple[arb, str]:
        """The noise bound of a measurement and its text, which has no time in it any more."""
        known = self.bounds.get(j)
        if known is not None:
            return known
        text = to_text(self.sigmas[j])
        value = arb(tape(sp.sympify(self.sigmas[j], strict=True)).run({self.time: arb(t)}))
        if not value > 0:
            message = f"expected a positive noise bound; got {quote(text)} of {quote(self.names[j])}; correct sigma"
            raise DomainError(message, where=f"t = {t}")
        answer = value, put_number(text, self.time.name, t)
        if not self.sigmas[j].has(self.time):
            self.bounds[j] = answer
        return answer

    def cut(self, row: arb_mat) -> arb_mat:
        """A row without the unknowns that are not kept."""
        if self.size == len(self.functional):
            return row
        entries = row.entries()
        return arb_mat([[entries[k] for k in self.columns]])

    def ball_row(self, j: int, t: fmpq, now: fmpq) -> list[arb]:
        """``h_j(t) Phi(t, now)`` for t <= now, all unknowns."""
        row = self.row(j, t)
        back = None if t == now else self.transition(now, t)
        return (row if back is None else row * back).entries()  # type: ignore[no-any-return]

    # Exact and as text

    def exact_target(self, k: int) -> fmpq | None:
        """An entry of the functional where it is rational."""
        p = self.functional[k]
        return to_fmpq(p) if p.is_Rational else None

    @cached_property
    def system(self) -> fmpq_mat | None:
        """F of all times where it is rational; zero without dynamics."""
        n = len(self.functional)
        if not self.F:
            return fmpq_mat(n, n)
        if not self.is_steady or not all(e.is_Rational for e in self.F[0].F):
            return None
        return fmpq_mat([[to_fmpq(e) for e in row] for row in self.F[0].F.tolist()])

    def series(self, h: fmpq_mat) -> list[fmpq_mat] | None:
        """``h F**k / k!`` from k = 0 on, where these end: then ``h exp(F t)`` is a polynomial; else None."""
        if self.system is None:
            return None
        terms = [h]
        while any(terms[-1].entries()) and len(terms) <= h.ncols():
            terms.append(terms[-1] * self.system * fmpq(1, len(terms)))
        return None if any(terms[-1].entries()) else terms

    def exact_row(self, j: int, t: fmpq, now: fmpq) -> list[fmpq] | None:
        """``h_j(t) Phi(t, now)`` as rational numbers, all unknowns; None where it is not seen to be rational."""
        at = sp.Rational(int(t.p), int(t.q))
        h = [e if not e.has(self.time) else e.xreplace({self.time: at}) for e in self.h[j]]
        if not all(e.is_Rational for e in h):
            return None
        row = fmpq_mat([[to_fmpq(e) for e in h]])
        if t == now:
            return row.entries()  # type: ignore[no-any-return]
        if j not in self.terms:
            self.terms[j] = self.series(row)
        terms = self.terms[j] if self.constant[j] else self.series(row)
        if terms is None:
            return None
        total = fmpq_mat(1, row.ncols())
        for term in reversed(terms):
            total = total * (t - now) + term
        return total.entries()  # type: ignore[no-any-return]

    @cached_property
    def closed_form(self) -> list[list[str]] | None:
        """exp(F span) as texts of ``span``; None where there is no formula."""
        if not self.F or not self.is_steady:
            return None
        try:
            matrix = transition_matrix(self.F[0].F, sp.Symbol("span", real=True)).matrix
        except NavsymError:
            return None
        if any(e.has(sp.RootSum) for e in matrix):
            return None
        return [[to_text(e) for e in row] for row in matrix.tolist()]

    def row_text(self, j: int, t: fmpq, now: fmpq) -> list[str] | None:
        """The entries of ``h_j(t) Phi(t, now)`` as formulas without symbols; None where there are none."""
        h = [put_number(to_text(e), self.time.name, t) for e in self.h[j]]
        if not self.F or (t == now and self.closed_form is not None):
            return h
        if self.closed_form is None:
            return None
        span = f"({t - now})"
        return [self.entry_text(h, [row[k] for row in self.closed_form], span) for k in range(len(h))]

    @staticmethod
    def entry_text(h: Sequence[str], column: Sequence[str], span: str) -> str:
        """``sum_k h_k Phi_k`` as text."""
        terms = []
        for a, b in zip(h, column, strict=True):
            if a != "0" and b != "0":
                entry = SPAN.sub(span, b)
                terms.append(f"({entry})" if a == "1" else f"({a})*({entry})")
        return " + ".join(terms) or "0"


def name_measurements(contents: ModelFile | BasisFile) -> tuple[str, ...]:
    """The names of measurements; z1, z2 … where there are regressors alone."""
    if isinstance(contents, BasisFile):
        return tuple(f"z{k + 1}" for k in range(len(contents.H)))
    return tuple(m.name for m in contents.measurements)


def list_blocks(contents: ModelFile | BasisFile, names: Sequence[str]) -> list[Together]:
    """Measurements of a model that are bounded together; bounds of each alone are left out."""
    found = [b for b in getattr(contents, "blocks", ()) if b.norm != "linf" and len(b.names) > 1]
    shapes = [fmpq_mat([[to_fmpq(e) for e in row] for row in b.shape.tolist()]) for b in found]
    return [Together(tuple(map(names.index, b.names)), b.norm, shape) for b, shape in zip(found, shapes, strict=True)]


def put_number(text: str, name: str, value: fmpq) -> str:
    """The text with a number in place of a symbol."""
    return re.sub(rf"\b{re.escape(name)}\b", f"({value})", text)


def pivot_columns(rows: Sequence[Sequence[fmpq]]) -> list[int]:
    """Columns at which the reduced echelon form of the rows has its leading ones."""
    reduced, rank = fmpq_mat([list(row) for row in rows]).rref()
    table = reduced.tolist()
    return [next(k for k, e in enumerate(table[i]) if e != 0) for i in range(rank)]


def in_row_space(vector: Sequence[fmpq], rows: Sequence[Sequence[fmpq]]) -> bool:
    """Whether a vector is a combination of the rows, exactly."""
    matrix = [list(row) for row in rows]
    return fmpq_mat(matrix).rank() == fmpq_mat([*matrix, list(vector)]).rank()
