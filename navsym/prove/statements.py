"""Statements of a caller, checked before anything is decided: exact formulas and ranges, nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import sympy as sp

from navsym.claims.statement import Finding, Property, Statement
from navsym.core.errors import DomainError
from navsym.language.names import join_place, quote


def require_statement(statement: Any) -> None:
    """Refuse what is no statement, and a part of one that is no exact formula: DomainError with the part's name."""
    if not isinstance(statement, Statement):
        expected = "an Equation, Bound, Optimum or Property"
        remedy = "write Equation(left, right) or Bound(left, '<=', right)"
        message = f"expected {expected}; got {quote(statement)}; {remedy}"
        raise DomainError(message, where="statement")
    kind = type(statement).__name__
    if isinstance(statement, Property):
        if not isinstance(statement.derived, Finding):
            message = f"expected a Finding; got {quote(statement.derived)}; write Finding(value, method)"
            raise DomainError(message, where=f"{kind}: derived")
        return
    for field in fields(statement):
        value = getattr(statement, field.name)
        if field.name == "box":
            require_box(value, f"{kind}: box")
        elif field.name not in ("relation", "written") and not (field.name == "tolerance" and value is None):
            require_formulas(value, f"{kind}: {field.name}")


def require_box(box: Any, where: str) -> None:
    """Refuse a box that is no mapping of symbols to pairs of exact numbers."""
    if not isinstance(box, Mapping):
        raise DomainError(f"expected ranges by symbol; got {quote(box)}; write {{T: (0, 1)}}", where=where)
    for symbol, ends in box.items():
        if not isinstance(symbol, sp.Symbol) or not isinstance(ends, (tuple, list)) or len(ends) != 2:
            got = f"{quote(symbol)} with {quote(ends)}"
            raise DomainError(f"expected a symbol and two ends; got {got}; write {{T: (0, 1)}}", where=where)
        require_formulas([end for end in ends if end is not None], join_place(where, symbol.name))


def require_formulas(value: Any, where: str) -> None:
    """Refuse a value, or an entry of a matrix or list, that is neither an exact number nor a formula of sympy."""
    if isinstance(value, (tuple, list, sp.MatrixBase)):
        for entry in value:
            require_formula(entry, where)
    else:
        require_formula(value, where)


def require_formula(value: Any, where: str) -> None:
    """Refuse text, which sympy would execute, floats, and everything that is no formula."""
    if isinstance(value, float) or (isinstance(value, sp.Basic) and value.has(sp.Float)):
        number = value if isinstance(value, float) else min(value.atoms(sp.Float), key=str)
        got, exact = f"the float {float(number)!r}", f'Rational("{float(number)!r}")'
        raise DomainError(f"expected an exact number; got {got}; write {exact}", where=where)
    try:
        formula = sp.sympify(value, strict=True)
    except sp.SympifyError:
        formula = None
    if not isinstance(formula, sp.Expr):
        message = f"expected an exact number or a formula of sympy; got {quote(value)}; use navsym.prove for text"
        raise DomainError(message, where=where)
