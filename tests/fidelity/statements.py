"""The claims of every paper with their statements, derived once."""

from __future__ import annotations

import importlib
from functools import cache

import sympy as sp

from navsym.claims import Optimum, Property, claims_of
from navsym.claims.paper import paper_names
from navsym.prove.equations import entries

PAPERS = paper_names()


@cache
def claims(paper):
    return [(claim, claim.derive()) for claim in claims_of(importlib.import_module(f"navsym_papers.{paper}"))]


def assertions(paper):
    """Claims with formulas on both sides."""
    return [(claim, s) for claim, s in claims(paper) if not isinstance(s, Property)]


def formulas(statement):
    """Every expression of a statement, the ends of its ranges included."""
    fields = ("printed", "derived")
    if isinstance(statement, Optimum):
        fields = ("regressors", "functional", "interval", "dual", "support", "weights", "value")
    found = [part for name in fields for part in entries(getattr(statement, name))]
    ends = [end for pair in statement.box.values() for end in pair if end is not None]
    return [*found, *(end for end in (sp.sympify(e, strict=True) for e in ends) if end.is_finite)]


def symbols_in(statement):
    return set().union(*(formula.free_symbols for formula in formulas(statement)))
