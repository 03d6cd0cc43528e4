"""Families with regressors that depend on the others for every value of the parameter: they are left out, exactly."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import sympy as sp

from navsym.claims import PROVED, REFUTED, Equation
from navsym.errors import NotEstimableError
from navsym.methods.guaranteed.dependence import recognised
from navsym.methods.phases.family import Family, U
from navsym.proof.ladder import decide
from navsym.proof.optimality.basis import DependentError, make_basis
from navsym.text.expression import to_text


def without_dependent(family: Family, value: sp.Rational) -> tuple[Family, tuple[dict[str, Any], ...]]:
    """The family without dependent unknowns, and identity certificates that tie it to the whole one.

    value : a value of the parameter at which dependence is looked for; it is proved for all of them

    Raises NotEstimableError when the functional needs what no measurement shows.
    """
    ties: list[dict[str, Any]] = []
    while True:
        try:
            make_basis(family.exact(value))
        except DependentError as found:
            relation = [recognised(c) for c in found.relation]
            if any(c is None for c in relation):
                raise
            family = dropped(family, found, relation, ties)
        else:
            return family, tuple(ties)


def dropped(
    family: Family, found: DependentError, relation: list[sp.Rational | None], ties: list[dict[str, Any]]
) -> Family:
    """One unknown fewer: ``H_k = sum c_j H_j`` and ``P_k = sum c_j P_j``, both proved."""
    k = found.index
    for row in (*family.rows, family.functional):
        other = sum((c * h for c, h in zip(relation, row, strict=False) if c), sp.S.Zero)
        verdict = decide(Equation(row[k], other))
        if verdict.status is not PROVED or verdict.assumptions:
            if row is family.functional and verdict.status is REFUTED:
                raise NotEstimableError(
                    f"functional: expected one that the measurements determine; got one that changes along a "
                    f"direction of unknown {k + 1} which no measurement shows; estimate another combination"
                )
            raise found
        symbols = sorted({s.name for s in (row[k] - other).free_symbols | {U, family.parameter}})
        left, right = to_text(sp.sympify(row[k], strict=True)), to_text(sp.sympify(other, strict=True))
        ties.append({"kind": "identity", "left": left, "right": right, "symbols": symbols})
    rows = tuple(tuple(h for j, h in enumerate(row) if j != k) for row in family.rows)
    functional = tuple(p for j, p in enumerate(family.functional) if j != k)
    left_out = (*family.left_out, family.unknowns[k])
    return replace(family, rows=rows, functional=functional, left_out=left_out)
