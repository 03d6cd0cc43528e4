"""A family of guaranteed problems with one parameter: the length of the interval, or any other.

For a constant model the regressors depend on ``u = T - t`` only, the time before the estimate; for
regressors given directly they depend on t. A growing family has fixed regressors and ends at the
parameter; otherwise the parameter may enter the regressors, the ends, the noise bounds and the functional.

Where F is given in pieces U is the time and the rows change at the cuts; lengths that end in an earlier piece
are a family of their own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import sympy as sp

from navsym.core.balls import enclose
from navsym.core.errors import DomainError, EmptyError
from navsym.guaranteed.certificate.enclosure import Panel, PanelProblem
from navsym.guaranteed.problem import (
    GuaranteedProblem,
    RegressorPiece,
    Rows,
    chosen_target,
    divide_blocks,
    exact_pieces,
)
from navsym.guaranteed.time_varying import has_varying_system
from navsym.models.modelfile import BasisFile, ModelFile

#: Time before the estimate, or the variable of the basis.
U = sp.Symbol("u", real=True)


@dataclass(frozen=True, eq=False)
class Family:
    """Problems with one free parameter, or with others beside it.

    rows         : regressors in U, one row per panel: the measurements on the first stretch, on the next, …
    functional   : P
    sigma        : noise bounds, one per panel
    parameter    : the symbol that varies
    backward     : True when U counts back from the end, ``t = end - u``
    measurements : names, one per panel
    start, end   : ends of U; by default 0 and the parameter
    left_out     : places of unknowns that depend on the others and are not among the columns of rows
    cuts         : places in U where one stretch ends and the next begins, in order
    shorter      : the family of lengths up to ``least``, below which this one does not hold, or None
    beside       : other parameters, with the values at which a search looks at them; formulas keep them free
    """

    rows: Rows
    functional: tuple[sp.Expr, ...]
    sigma: tuple[sp.Expr, ...]
    parameter: sp.Symbol
    backward: bool
    measurements: tuple[str, ...]
    target: str
    start: sp.Expr = sp.S.Zero
    end: sp.Expr | None = None
    left_out: tuple[int, ...] = ()
    cuts: tuple[sp.Expr, ...] = ()
    shorter: Family | None = None
    least: sp.Expr = sp.S.Zero
    beside: Mapping[sp.Symbol, sp.Rational] = field(default_factory=dict)

    @property
    def chain(self) -> tuple[Family, ...]:
        """The families of all lengths, that of the shortest first."""
        return (self,) if self.shorter is None else (*self.shorter.chain, self)

    @property
    def many(self) -> int:
        """How many measurements there are."""
        return len(self.rows) // (len(self.cuts) + 1)

    @cached_property
    def panels(self) -> tuple[tuple[sp.Expr, sp.Expr], ...]:
        """The ends in U of every panel."""
        return tuple(pair for pair in pairwise((self.start, *self.cuts, self.stop)) for _ in range(self.many))

    @property
    def unknowns(self) -> tuple[int, ...]:
        """Places of the unknowns of the rows among all of them."""
        every = range(len(self.functional) + len(self.left_out))
        return tuple(k for k in every if k not in self.left_out)

    @property
    def stop(self) -> sp.Expr:
        """The end of U."""
        return self.parameter if self.end is None else self.end

    @property
    def stretch_name(self) -> str:
        """What a panel is called."""
        return "a piece of the interval" if self.cuts else "the interval"

    @cached_property
    def growing(self) -> bool:
        """True when only the interval [0, parameter] grows; the optimum then never increases."""
        fixed = [*self.functional, *self.sigma, *(h for row in self.rows for h in row)]
        free = {s for part in fixed for s in part.free_symbols}
        return self.start == 0 and self.stop == self.parameter and self.parameter not in free and not self.cuts

    def at(self, expression: sp.Expr, value: Any) -> sp.Expr:
        """An expression with a value for the parameter, and those beside it."""
        values = {self.parameter: value, **self.beside}
        here = {symbol: values[symbol] for symbol in values.keys() & expression.free_symbols}
        return expression.subs(here) if here else expression

    def ends(self, value: Any, panel: int = 0) -> tuple[sp.Expr, sp.Expr]:
        """The ends in U of a panel for one value."""
        start, stop = self.panels[panel]
        return self.at(start, value), self.at(stop, value)

    def problem(self, value: Any) -> GuaranteedProblem:
        """The member with an exact value of the parameter."""
        value = sp.sympify(value, strict=True)
        n = self.many
        rows = [tuple(self.at(h, value) for h in row) for row in self.rows]
        functional = tuple(self.at(p, value) for p in self.functional)
        sigma = tuple(self.at(s, value) for s in self.sigma[:n])
        stretches = tuple(RegressorPiece(*self.ends(value, k), tuple(rows[k : k + n])) for k in range(0, len(rows), n))
        return GuaranteedProblem(stretches, functional, sigma, U, self.measurements[:n], self.target)

    def exact(self, value: Any) -> PanelProblem:
        """The member with an exact value of the parameter, as panels for the proofs."""
        return self.problem(value).exact()

    @cached_property
    def moving(self) -> PanelProblem:
        """The problem with the parameter left free."""
        panels = [Panel(j % self.many, row, U, *self.panels[j], self.sigma[j]) for j, row in enumerate(self.rows)]
        return PanelProblem(tuple(panels), self.functional)

    def real_near(self, value: Any) -> Family:
        """The family with real square roots at a value: ``sqrt(c) = i sqrt(-c)``, sines of ``i x`` as hyperbolic sines.

        It holds where no radicand changes its sign.
        """
        parts = [*self.functional, *(h for row in self.rows for h in row)]
        roots = {e for part in parts for e in part.atoms(sp.Pow) if e.exp.is_Rational and e.exp.q == 2}
        turned = {
            e: (sp.I * sp.sqrt(-e.base)) ** e.exp.p
            for e in roots
            if U not in e.free_symbols and bool(enclose(self.at(e.base, value)) < 0)
        }
        if not turned:
            return self
        rows = tuple(tuple(sp.expand(h.xreplace(turned)) for h in row) for row in self.rows)
        return replace(self, rows=rows, functional=tuple(sp.expand(x.xreplace(turned)) for x in self.functional))

    def time(self, u: sp.Expr) -> sp.Expr:
        """The instant that the coordinate u means."""
        return sp.expand(self.stop - u) if self.backward else u


def family_of(found: ModelFile | BasisFile, target: str | None, parameter: str, *beside: str) -> Family:
    """The family of a file with one parameter free, and perhaps others beside it.

    Raises DomainError when nothing depends on the parameter, when F depends on the time or has eigenvalues without a
    closed form, or when other parameters have no value.
    """
    name, functional = chosen_target(found, target)
    symbol = declared_symbol(found, parameter)
    if isinstance(found, BasisFile):
        family = direct_family(found, name, functional, symbol)
    else:
        family = model_family(found, name, functional, symbol)
    refuse_others(family, {declared_symbol(found, other).name for other in beside})
    refuse_sums_over_roots(family)
    return family


def declared_symbol(found: ModelFile | BasisFile, parameter: str) -> sp.Symbol:
    """The symbol of a declared parameter that has no value."""
    if parameter not in found.parameters:
        names = ", ".join(found.parameters) or "none"
        raise DomainError(f"expected a parameter of the file without a value; got {parameter}; choose one of: {names}")
    return found.parameters[parameter].symbol


def refuse_others(family: Family, beside: set[str]) -> None:
    """Raises DomainError when the family depends on symbols that are none of its parameters, or not on the first."""
    parts = [*family.functional, *family.sigma, *(h for r in family.rows for h in r)]
    parts += [family.start, *family.cuts, family.stop]
    free = {s for part in parts for s in part.free_symbols} - {U}
    parameter = family.parameter.name
    others = sorted({s.name for s in free} - {parameter} - beside)
    if others:
        raise DomainError(
            f"expected one parameter, {parameter}; got also {', '.join(others)}; give --set {others[0]}=…"
        )
    if family.parameter not in free:
        raise DomainError(
            f"expected a problem that depends on {parameter}; got one that does not; choose another parameter"
        )


def refuse_sums_over_roots(family: Family) -> None:
    """Raises DomainError where regressors are sums over the roots of a polynomial, which no certificate can name."""
    for one in family.chain:
        if any(h.has(sp.RootSum) for row in one.rows for h in row):
            raise DomainError(
                f"F: expected eigenvalues with a closed form, for all values of {family.parameter.name}; got the roots "
                "of a polynomial that has none; solve for single values instead"
            )


def direct_family(found: BasisFile, name: str, functional: tuple[sp.Expr, ...], symbol: sp.Symbol) -> Family:
    """The family of a basis file: its regressors, written in U, on its interval."""
    start, end = found.interval
    rows = tuple(tuple(h.subs(found.variable, U) for h in row) for row in found.H)
    names = tuple(f"z{j + 1}" for j in range(len(rows)))
    return Family(rows, functional, found.sigma, symbol, False, names, name, start, end)


def model_family(found: ModelFile, name: str, functional: tuple[sp.Expr, ...], symbol: sp.Symbol) -> Family:
    """The family of a model file: backward in time for one F, forward for an F in pieces.

    Raises EmptyError without an interval, and DomainError where F depends on the time.
    """
    found = divide_blocks(found, "phases")
    if found.T is None:
        raise EmptyError("expected the length of the interval; got no [interval]; add T", where="interval.T")
    if has_varying_system(found):
        raise DomainError(
            "F: expected matrices without the time; got F(t), whose regressors are polynomials with an error of which "
            "only a bound is known, so that no contact is exact; solve for single values instead"
        )
    make = backward_family if len(found.pieces) == 1 else forward_family
    return make(found, name, functional, symbol)


def backward_family(found: ModelFile, name: str, functional: tuple[sp.Expr, ...], symbol: sp.Symbol) -> Family:
    """One F: the regressors depend on the time before the end."""
    (stretch,), T = exact_pieces(found), found.T or sp.S.Zero
    rows = tuple(tuple(sp.expand(h).subs(found.time, T - U) for h in row) for row in stretch.rows)
    rows = tuple(tuple(expand_arguments(h, T, symbol) for h in row) for row in rows)
    names = tuple(m.name for m in found.measurements)
    sigma = tuple(m.sigma for m in found.measurements)
    return Family(rows, functional, sigma, symbol, True, names, name, sp.S.Zero, T)


def forward_family(found: ModelFile, name: str, functional: tuple[sp.Expr, ...], symbol: sp.Symbol) -> Family:
    """F in pieces: regressors in time, stretch by stretch, and families of their own for shorter lengths.

    Raises DomainError when the pieces end at a length that depends on the parameter otherwise than by being it.
    """
    T, last, n = found.T or sp.S.Zero, found.pieces[-1], len(found.pieces)
    stretches = exact_pieces(found)
    rows = tuple(
        tuple(expand_arguments(h.subs(found.time, U), T, symbol) for h in row) for s in stretches for row in s.rows
    )
    names, sigma = tuple(m.name for m in found.measurements) * n, tuple(m.sigma for m in found.measurements) * n
    cuts = tuple(piece.start for piece in found.pieces[1:])
    moved = symbol in T.free_symbols and not any(symbol in cut.free_symbols for cut in cuts)
    if moved and symbol != T:
        raise DomainError(f"interval: expected the length {symbol} itself where F comes in pieces; got {T}; rename it")
    *before, end = found.pieces[:-1]
    without = replace(found, pieces=(*before, replace(end, end=found.T)))  # the last piece
    shorter = model_family(without, name, functional, symbol) if moved else None
    least = last.start if moved else sp.S.Zero
    return Family(rows, functional, sigma, symbol, False, names, name, sp.S.Zero, T, (), cuts, shorter, least)


def expand_arguments(h: sp.Expr, T: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
    """Arguments expanded, so that ``T - (T - u)`` is u."""
    done = h.replace(lambda e: isinstance(e, sp.Function), lambda e: e.func(*(sp.expand(a) for a in e.args)))
    done = done.replace(lambda e: e.is_Pow and e.base == sp.E, lambda e: sp.exp(sp.expand(e.exp)))
    return sp.expand(done) if T.free_symbols or symbol in done.free_symbols else done
