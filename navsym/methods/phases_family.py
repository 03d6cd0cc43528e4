"""A family of guaranteed problems: fixed regressors on an interval whose length is the parameter.

For a constant model the regressors depend on ``u = T - t`` only, the time before the estimate; for
regressors given directly they depend on t alone. Either way only the interval [0, T] grows, so the
optimum never increases with T: between two lengths it lies between the two values.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sympy as sp

from navsym.errors import DomainError, EmptyError
from navsym.methods.guaranteed_problem import GuaranteedProblem, Rows, Stretch, chosen_target, stretches_of
from navsym.proof.enclosure import Problem
from navsym.text.modeltypes import BasisFile, ModelFile

#: Time before the estimate, or the variable of the basis.
U = sp.Symbol("u", real=True)


@dataclass(frozen=True, slots=True, eq=False)
class Family:
    """Problems on [0, T] for T in a range.

    rows         : regressors in U, one row per measurement
    functional   : P
    sigma        : noise bounds
    parameter    : the symbol T
    backward     : True when U counts back from the end, ``t = T - u``
    measurements : names
    """

    rows: Rows
    functional: tuple[sp.Expr, ...]
    sigma: tuple[sp.Expr, ...]
    parameter: sp.Symbol
    backward: bool
    measurements: tuple[str, ...]
    target: str

    def problem(self, T: Any) -> GuaranteedProblem:
        """The member with an exact length."""
        stretch = Stretch(sp.S.Zero, sp.sympify(T, strict=True), self.rows)
        return GuaranteedProblem((stretch,), self.functional, self.sigma, U, self.measurements, self.target)

    def exact(self, T: Any) -> Problem:
        return self.problem(T).exact()

    def time(self, u: sp.Expr) -> sp.Expr:
        """The instant that the coordinate u means."""
        return sp.expand(self.parameter - u) if self.backward else u


def family_of(found: ModelFile | BasisFile, target: str | None, parameter: str) -> Family:
    """The family of a file whose interval ends at the parameter.

    Raises DomainError when the parameter is not the length of the interval, when F depends on the
    time, or when other parameters have no value.
    """
    name, functional = chosen_target(found, target)
    if isinstance(found, BasisFile):
        start, end = found.interval
        family = direct(found, name, functional, start, end, parameter)
    else:
        family = backward(found, name, functional, parameter)
    others = sorted(
        {
            s.name
            for part in (*family.functional, *family.sigma, *(h for r in family.rows for h in r))
            for s in part.free_symbols
        }
        - {U.name}
    )
    if others:
        raise DomainError(
            f"expected one parameter, {parameter}; got also {', '.join(others)}; give --set {others[0]}=…"
        )
    return family


def direct(
    found: BasisFile, name: str, functional: tuple[sp.Expr, ...], start: sp.Expr, end: sp.Expr, parameter: str
) -> Family:
    symbol = need_length(end, parameter)
    if start != 0:
        raise DomainError(f"interval: expected it to start at 0; got {start}; shift the variable")
    rows = tuple(tuple(h.subs(found.variable, U) for h in row) for row in found.H)
    names = tuple(f"z{j + 1}" for j in range(len(rows)))
    return Family(rows, functional, found.sigma, symbol, False, names, name)


def backward(found: ModelFile, name: str, functional: tuple[sp.Expr, ...], parameter: str) -> Family:
    if found.T is None:
        raise EmptyError("expected the length of the interval; got no [interval]; add T", where="interval.T")
    symbol = need_length(found.T, parameter)
    (stretch,) = stretches_of(found) if len(found.pieces) == 1 else (None,)
    if stretch is None:
        raise DomainError("F: expected one constant matrix; got pieces; solve for single lengths instead")
    rows = tuple(tuple(sp.expand(h).subs(found.time, symbol - U) for h in row) for row in stretch.rows)
    rows = tuple(tuple(settled(h, symbol) for h in row) for row in rows)
    names = tuple(m.name for m in found.measurements)
    return Family(rows, functional, tuple(m.sigma for m in found.measurements), symbol, True, names, name)


def settled(h: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
    """Arguments expanded, so that ``T - (T - u)`` is u."""
    done = h.replace(lambda e: isinstance(e, sp.Function), lambda e: e.func(*(sp.expand(a) for a in e.args)))
    done = done.replace(lambda e: e.is_Pow and e.base == sp.E, lambda e: sp.exp(sp.expand(e.exp)))
    return sp.expand(done) if symbol in done.free_symbols else done


def need_length(end: sp.Expr, parameter: str) -> sp.Symbol:
    if not isinstance(end, sp.Symbol) or end.name != parameter:
        raise DomainError(
            f'expected an interval that ends at the parameter {parameter}; got the end {end}; write T = "{parameter}"'
        )
    return end
