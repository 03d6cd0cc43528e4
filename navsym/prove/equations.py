"""Equations and inequalities: whatever may break one is tried; what nothing breaks is left to the search for a proof.

An exact point where a ball excludes the relation refutes; of an equation the normal form proves. What has neither but
holds at every sampled point is CONFIRMED, never more, until a proof is found.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import replace

import sympy as sp
import sympy.tensor.tensor  # the first sum loads it: in each child again, for 30 ms
from flint import arb

from navsym.claims.statement import Bound, Box, Equation
from navsym.claims.verdict import CERTIFIED, CONFIRMED, OPEN, PROVED, REFUTED, Verdict
from navsym.core.balls import UnsupportedError, enclose, exact_ball, precision
from navsym.core.errors import DomainError
from navsym.prove.assumptions import remaining_assumptions
from navsym.prove.identities import has_unique_form, is_zero, vanishes_identically
from navsym.prove.sampling.points import Sample, search_counterexample
from navsym.prove.sampling.second_look import BITS, Look, look_again, look_at_places
from navsym.prove.signs import Sign, prove_sign
from navsym.prove.wording import decimal_ends, point_text, refute_at_point, scope_of

ENOUGH_POINTS = 32
TURNS = 120  # radians: twenty turns of a wave

#: relation -> when a finite ball of printed - derived contradicts it.
EXCLUDES: dict[str, Callable[[arb], bool]] = {
    "=": lambda ball: not ball.contains(0),
    "<": lambda ball: bool(ball >= 0),
    "<=": lambda ball: bool(ball > 0),
    ">": lambda ball: bool(ball <= 0),
    ">=": lambda ball: bool(ball < 0),
    "!=": lambda ball: bool(ball == 0),
}
#: Symbols from which on a search by the rooms that think little comes before a long look, and its bounds.
MANY, FIRST = 4, ((8, 100, 1),)
#: Relations that equality breaks.
STRICT = ("<", ">", "!=")
STRENGTH = (REFUTED, OPEN, CONFIRMED, CERTIFIED, PROVED)


def decide_equation(statement: Equation) -> Verdict:
    """Verdict of an equation between scalars, matrices or sequences, entry by entry."""
    printed, derived = list_entries(statement.printed), list_entries(statement.derived)
    if shape_of(statement.printed) != shape_of(statement.derived):
        return Verdict(
            REFUTED,
            method="shape",
            evidence=f"printed shape {shape_of(statement.printed)}, derived {shape_of(statement.derived)}",
            counterexample={},
        )
    verdicts = [decide_entry(p, d, statement) for p, d in zip(printed, derived, strict=True)]
    verdict = weakest_verdict(verdicts)
    if verdict.status == REFUTED:
        return verdict
    return replace(verdict, scope=scope_of(sp.Tuple(*printed, *derived), statement.box))


def shape_of(side: object) -> tuple[int, ...]:
    """Rows and columns of a matrix, the length of a sequence, nothing for a scalar."""
    if isinstance(side, sp.MatrixBase):
        return tuple(side.shape)
    return (len(side),) if isinstance(side, (tuple, list)) else ()


def list_entries(side: object) -> list[sp.Expr]:
    """The scalar expressions of a side; never a string, which sympy would execute."""
    if isinstance(side, (sp.MatrixBase, tuple, list)):
        return [sp.sympify(entry, strict=True) for entry in side]
    return [sp.sympify(side, strict=True)]


def weakest_verdict(verdicts: Sequence[Verdict]) -> Verdict:
    """The weakest verdict of several entries; assumptions and counts are those of all."""
    weakest = min(verdicts, key=lambda verdict: STRENGTH.index(verdict.status))
    if len(verdicts) == 1:
        return weakest
    place = verdicts.index(weakest) + 1
    assumptions = tuple(dict.fromkeys(a for verdict in verdicts for a in verdict.assumptions))
    prefix = f"{len(verdicts)} entries, the weakest is number {place}: "
    return replace(weakest, assumptions=assumptions, evidence=prefix + weakest.evidence)


def decide_entry(printed: sp.Expr, derived: sp.Expr, statement: Equation) -> Verdict:
    """Verdict of one entry; what the sides need to exist is said, also what subtraction cancels."""
    difference, box = printed - derived, statement.box
    divisors = [sp.sympify(part, strict=True) for part in statement.nonzero]
    sides = (printed, derived, *statement.exists, *(1 / part for part in divisors if part != 0))
    tolerance = None if statement.tolerance is None else sp.sympify(statement.tolerance, strict=True)
    try:
        verdict = decide_difference(difference, "=", box, scope_of(difference, box), sides, tolerance)
    except UnsupportedError as error:
        return Verdict(OPEN, "none", scope_of(difference, box), evidence=str(error))
    if verdict.status == REFUTED:
        return verdict
    scope = scope_of(sp.Tuple(printed, derived), box)
    return replace(verdict, scope=scope, assumptions=remaining_assumptions((printed, derived), box, divisors))


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
    difference: sp.Expr,
    relation: str,
    box: Box,
    scope: str,
    sides: Sequence[sp.Expr] = (),
    tolerance: sp.Expr | None = None,
) -> Verdict:
    """Verdict of ``difference relation 0``, or of ``|difference| <= tolerance``: broken by a point, CONFIRMED, or OPEN.

    An equation is PROVED where exact algebra shows it.

    sides : what has to have a value at a point of the statement
    """
    excludes, what = EXCLUDES[relation], "equality" if relation == "=" else f"printed {relation} derived"
    margins = {"=": (), "!=": (difference**2, difference, -difference)}.get(relation)
    margins = ((-difference if "<" in relation else difference),) if margins is None else margins
    if tolerance is not None:
        what, margins = f"within {tolerance}", (tolerance - difference, tolerance + difference)

        def excludes(ball: arb) -> bool:
            with precision(BITS):  # abs rounds to the working precision, which hides an excess of 1e-30
                return bool(abs(ball) > enclose(tolerance, bits=BITS))

    sample = search_counterexample(difference, excludes, box, sides=sides)
    if sample.counterexample is not None and sample.difference is not None:
        return refute_at_point(sample.counterexample, sample.difference)
    if sample.points == 0:  # what exists nowhere has every relation to everything
        return judge_sample(sample, scope, what)
    is_equation = relation == "=" and tolerance is None
    if is_equation and vanishes_identically(difference):
        return Verdict(PROVED, "normal form", scope, evidence="printed - derived is zero by exact algebra")
    if is_equation and not difference.free_symbols and is_zero(difference):
        return Verdict(PROVED, "exact number", scope, evidence="printed - derived is exactly zero")
    look = look_at_roots(difference, relation, box, sides, () if tolerance is None else margins)
    if look is not None and look.touching is not None:  # false, without a point that could be written down
        return Verdict(REFUTED, "real roots", "one point", evidence=doubt_of(look, relation), counterexample={})
    if look is not None and look.counterexample is None and not is_equation:
        words = "no sign between real roots contradicts it; no proof was found"
        return Verdict(OPEN, "real roots", scope, evidence=words)
    if look is None:
        settled = functools.cache(lambda: not is_equation and is_easily_proved(difference, relation, box, margins))
        look = look_again(difference, excludes, box, sides, relation in STRICT, margins, settled)
    verdict = judge_look(look, sample, scope, what)
    doubt = doubt_of(look, relation)
    if not doubt and verdict.status == CONFIRMED:
        doubt = find_beats(difference, box) if not is_equation else ""
        if is_equation and has_unique_form(difference):
            doubt = f"{verdict.evidence}, and the normal form of printed - derived is not zero"
    return Verdict(OPEN, "sampling", scope, evidence=doubt) if doubt else verdict


def look_at_roots(
    difference: sp.Expr, relation: str, box: Box, sides: Sequence[sp.Expr], margins: Sequence[sp.Expr]
) -> Look | None:
    """A look at all signs of the difference, or of its margins, by real roots; None where these do not tell all."""
    if not margins:
        return look_at_places(difference, EXCLUDES[relation], box, sides, relation in STRICT)
    looks = [look_at_places(margin, EXCLUDES[">="], box, sides) for margin in margins]
    broken = (look for look in looks if look is not None and look.counterexample is not None)
    return next(broken, None if None in looks else Look())


def is_easily_proved(difference: sp.Expr, relation: str, box: Box, margins: Sequence[sp.Expr]) -> bool:
    """Whether cheap rooms prove a relation, so that nothing breaks it: a long look takes seconds in many symbols."""
    if len(difference.free_symbols) < MANY:
        return False
    wanted = {"!=": Sign.NONZERO, "<": Sign.POSITIVE, ">": Sign.POSITIVE}.get(relation, Sign.NONNEGATIVE)
    parts = (difference,) if relation == "!=" else margins
    return all(prove_sign(part, box, wanted, FIRST).at_least(wanted) for part in parts)


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


def find_beats(difference: sp.Expr, box: Box) -> str:
    """Why sines and cosines may meet where no sample was: on a whole line, or in a range with many turns; or empty."""
    waves = difference.atoms(sp.sin, sp.cos)
    for symbol in difference.free_symbols:
        limits = sp.Tuple(*box.get(symbol, (-sp.oo, sp.oo)))
        slopes = [slope for wave in waves if (slope := sp.diff(wave.args[0], symbol)) != 0]
        if any(end is None or end.is_infinite for end in limits):
            if any(not sp.cancel(slope / slopes[0]).is_Rational for slope in slopes[1:]):
                return "waves whose periods have no common multiple meet as nearly as one likes, far beyond all samples"
        elif any(abs(exact_ball(slope * (limits[1] - limits[0]))) > TURNS for slope in slopes if slope.is_number):
            return f"waves turn often between {limits[0]} and {limits[1]}, and may meet where no sample was"
    return ""


def judge_look(look: Look, sample: Sample, scope: str, what: str) -> Verdict:
    """REFUTED by the point of a second look, OPEN where the margin falls beyond it, else what the samples say."""
    if look.falling is not None:
        near = {symbol.name: str(sp.N(value, 12)) for symbol, value in look.falling.items()}
        words = f"the margin still falls near {near}, beyond all samples"
        return Verdict(OPEN, "sampling", scope, evidence=words)
    if look.counterexample is None or look.difference is None:
        return judge_sample(sample, scope, what)
    return refute_at_point(look.counterexample, look.difference, look.exact)


def judge_sample(sample: Sample, scope: str, what: str) -> Verdict:
    """CONFIRMED with its count when enough points could be evaluated, otherwise OPEN."""
    if sample.points == 0:
        return Verdict(OPEN, "sampling", scope, evidence="no exact point of the box could be evaluated")
    largest = decimal_ends(sample.largest).upper if sample.largest is not None else "0"
    evidence = f"{what} at {sample.points} exact points, largest residual {largest}; no proof was found"
    enough = sample.points >= ENOUGH_POINTS
    return Verdict(CONFIRMED if enough else OPEN, "sampling", scope, evidence=evidence)
