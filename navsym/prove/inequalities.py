"""Bounds: printed relation derived on a whole box."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import sympy as sp
from flint import arb

from navsym.claims.statement import Bound, Box, Equation
from navsym.claims.verdict import OPEN, REFUTED, Verdict
from navsym.core.balls import UnsupportedError
from navsym.core.errors import DomainError
from navsym.prove.assumptions import remaining_assumptions
from navsym.prove.equations import (
    UNBROKEN,
    decide_equation,
    find_beats,
    judge_look,
    judge_sample,
    list_entries,
    refute_by_sample,
    shape_of,
)
from navsym.prove.sampling.points import search_counterexample
from navsym.prove.sampling.second_look import Look, look_again, look_at_places
from navsym.prove.wording import point_text, scope_of

#: relation -> when a finite ball of printed - derived contradicts it.
EXCLUDES: dict[str, Callable[[arb], bool]] = {
    "<": lambda ball: bool(ball >= 0),
    "<=": lambda ball: bool(ball > 0),
    ">": lambda ball: bool(ball <= 0),
    ">=": lambda ball: bool(ball < 0),
    "!=": lambda ball: bool(ball == 0),
}


#: Relations that equality breaks.
STRICT = ("<", ">", "!=")


def decide_bound(statement: Bound) -> Verdict:
    """Verdict of an inequality by what may break it; ``=`` is handed to the equations."""
    if statement.relation == "=":
        return decide_equation(Equation(statement.printed, statement.derived, statement.box, exists=statement.exists))
    if statement.relation not in EXCLUDES:
        raise DomainError(f"expected one of = != < <= > >=; got {statement.relation!r}; correct the relation")
    difference = difference_of(statement)
    scope = scope_of(difference, statement.box)
    sides = [*list_entries(statement.printed), *list_entries(statement.derived)]
    try:
        existing = (*sides, *statement.exists)
        verdict = decide_difference(difference, statement.relation, statement.box, scope, existing)
        if verdict.status == REFUTED:
            return verdict
        return replace(verdict, assumptions=remaining_assumptions(sides, statement.box))
    except UnsupportedError as error:
        return Verdict(OPEN, "none", scope, evidence=str(error))


def difference_of(statement: Bound) -> sp.Expr:
    """Printed - derived; of matrices the sum of the squares, which vanishes only where they are equal."""
    if shape_of(statement.printed) != shape_of(statement.derived):
        raise DomainError("expected sides of one shape; got two shapes; correct one of them")
    pairs = zip(list_entries(statement.printed), list_entries(statement.derived), strict=True)
    differences = [printed - derived for printed, derived in pairs]
    if not shape_of(statement.printed):
        return differences[0]
    if statement.relation != "!=":
        raise DomainError(f"expected = or != between matrices; got {statement.relation}; compare them entry by entry")
    return sp.Add(*(difference**2 for difference in differences))


def decide_difference(
    difference: sp.Expr, relation: str, box: Box, scope: str, sides: Sequence[sp.Expr] = ()
) -> Verdict:
    """Verdict of ``difference relation 0``: broken by a point where the sides exist, CONFIRMED, or OPEN.

    Never CONFIRMED across a change of sign.
    """
    sample = search_counterexample(difference, EXCLUDES[relation], box, sides=sides)
    if sample.points == 0:
        return judge_sample(sample, scope, f"printed {relation} derived")
    if sample.counterexample is not None:
        return refute_by_sample(sample)
    look = look_at_places(difference, EXCLUDES[relation], box, sides, relation in STRICT)
    if look is not None and look.touching is not None:  # false, without a point that could be written down
        words = doubt_of(look, relation)
        return Verdict(REFUTED, "real roots", "one point", evidence=words, counterexample={})
    if look is not None and look.counterexample is None:
        return Verdict(OPEN, "real roots", scope, evidence=UNBROKEN)
    if look is None:
        low = -difference if "<" in relation else difference
        goals = (difference**2, difference, -difference) if relation == "!=" else (low,)
        look = look_again(difference, EXCLUDES[relation], box, sides, relation in STRICT, goals)
        doubt = doubt_of(look, relation)
        if not doubt and look.counterexample is None:
            doubt = find_beats(difference, box)
        if doubt:
            return Verdict(OPEN, "sampling", scope, evidence=doubt)
    return judge_look(look, sample, scope, f"printed {relation} derived")


def doubt_of(look: Look, relation: str) -> str:
    """Why a relation without a counterexample must not be CONFIRMED; empty when nothing speaks against it."""
    if look.counterexample is not None:
        return ""
    if relation == "!=" and look.positive and look.negative:
        places = " and ".join(str(dict(point_text(point))) for point in (look.negative, look.positive))
        return f"printed - derived changes its sign between {places}: a continuous difference has a zero there"
    if look.touching is not None:
        near = {symbol.name: f"{float(value):.12g}" for symbol, value in look.touching.items()}
        return f"the sides come within 1e-60 of each other near {near}: equality there would break the relation"
    return ""
