"""The claims of every paper with their statements, derived once for all tests of a paper.

Tests whose first parameter is a paper run in the process that holds its statements (tests/conftest.py).
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest
import sympy as sp

from navsym.claims import Claim, Optimum, Property, Statement
from navsym.claims.paper import import_paper, paper_names
from navsym.prove.equations import list_entries
from navsym.verification.papers import PaperModule, paper_module

PAPERS = paper_names()

#: Every paper, and which of its claims: about a dozen in every run, the others in the long ones. One has no others.
IN_PARTS = [
    *((name, "a dozen") for name in PAPERS),
    *(pytest.param(name, "the others", marks=pytest.mark.long) for name in PAPERS if name != "alpha_beta_filter"),
]


@cache
def claims(paper: str) -> list[tuple[Claim, Statement]]:
    """Every claim of a paper with its statement."""
    return [(claim, claim.derive()) for claim in paper_module(import_paper(paper)).claims]


@cache
def module(paper: str) -> PaperModule:
    """The paper as the verb ``verify`` takes it; its claims have been derived."""
    known = tuple(replace(claim, derive=lambda statement=statement: statement) for claim, statement in claims(paper))
    return replace(paper_module(import_paper(paper)), claims=known)


def part_of(items, part):
    """About a dozen from all over a list, or the others."""
    step = max(1, len(items) // 12)
    return [item for place, item in enumerate(items) if (place % step == 0) == (part == "a dozen")]


def assertions(paper):
    """Claims with formulas on both sides."""
    return [(claim, s) for claim, s in claims(paper) if not isinstance(s, Property)]


def formulas(statement):
    """Every expression of a statement, the ends of its ranges included."""
    fields = ("printed", "derived")
    if isinstance(statement, Optimum):
        fields = ("regressors", "functional", "interval", "dual", "support", "weights", "value")
    found = [part for name in fields for part in list_entries(getattr(statement, name))]
    ends = [end for pair in statement.box.values() for end in pair if end is not None]
    return [*found, *(end for end in (sp.sympify(e, strict=True) for e in ends) if end.is_finite)]


def symbols_in(statement):
    return set().union(*(formula.free_symbols for formula in formulas(statement)))
