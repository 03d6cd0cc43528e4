"""Equations: first try to break them, then to prove them.

An exact point where a ball excludes equality refutes; the normal form proves. What has neither but agrees at
every sampled point is CONFIRMED, never more, until the search finds a proof.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import sympy as sp
from flint import arb

from navsym.claims.statement import Box, Equation
from navsym.claims.verdict import CERTIFIED, CONFIRMED, OPEN, PROVED, REFUTED, Verdict
from navsym.core.balls import UnsupportedError, enclose, exact_ball, precision
from navsym.prove.assumptions import remaining_assumptions
from navsym.prove.identities import has_unique_form, is_zero, vanishes_identically
from navsym.prove.sampling.points import Sample, search_counterexample
from navsym.prove.sampling.second_look import BITS, Look, look_again, look_at_places
from navsym.prove.wording import decimal_ends, refute_at_point, scope_of

ENOUGH_POINTS = 32
UNBROKEN = "no sign between real roots contradicts it; no proof was found"
TURNS = 120  # radians: twenty turns of a wave


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


STRENGTH = (REFUTED, OPEN, CONFIRMED, CERTIFIED, PROVED)


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
    box = statement.box
    try:
        if statement.tolerance is not None:
            return decide_numeral(printed, derived, statement)
        sample = search_counterexample(
            printed - derived, excludes_zero, box, sides=finite_sides(printed, derived, statement)
        )
        if sample.counterexample is not None:
            return refute_by_sample(sample)
        return prove_equal(printed, derived, statement, sample)
    except UnsupportedError as error:
        return Verdict(OPEN, "none", scope_of(printed - derived, box), evidence=str(error))


def excludes_zero(ball: arb) -> bool:
    """Whether a ball breaks an equation."""
    return not ball.contains(0)


def finite_sides(printed: sp.Expr, derived: sp.Expr, statement: Equation) -> tuple[sp.Expr, ...]:
    """What has to have a value at a point of the statement."""
    divisors = (sp.sympify(part, strict=True) for part in statement.nonzero)
    return (printed, derived, *statement.exists, *(1 / part for part in divisors if part != 0))


def refute_by_sample(sample: Sample) -> Verdict:
    """REFUTED by the point of a sample."""
    assert sample.counterexample is not None and sample.difference is not None
    return refute_at_point(sample.counterexample, sample.difference)


# -- numerals ---------------------------------------


def decide_numeral(printed: sp.Expr, derived: sp.Expr, statement: Equation) -> Verdict:
    """``|printed - derived| <= tolerance``, the meaning of a printed numeral."""
    tolerance = sp.sympify(statement.tolerance, strict=True)
    difference, box = printed - derived, statement.box

    def is_beyond(ball: arb) -> bool:
        with precision(BITS):  # abs rounds to the working precision, which hides an excess of 1e-30
            return bool(abs(ball) > enclose(tolerance, bits=BITS))

    sample = search_counterexample(difference, is_beyond, box, sides=finite_sides(printed, derived, statement))
    if sample.counterexample is not None:
        return refute_by_sample(sample)
    if sample.points == 0:  # what exists nowhere is near to everything
        return judge_sample(sample, scope_of(difference, box), f"within {tolerance}")
    sides, scope, what = finite_sides(printed, derived, statement), scope_of(difference, box), f"within {tolerance}"
    for side in (tolerance - difference, tolerance + difference):
        look = look_at_places(side, lambda ball: bool(ball < 0), box, sides)
        if look is not None and look.counterexample is not None:
            return judge_look(look, sample, scope, what)
    goals = (tolerance - difference, tolerance + difference)
    judged = judge_look(look_again(difference, is_beyond, box, sides, goals=goals), sample, scope, what)
    doubt = find_beats(difference, box) if judged.status == CONFIRMED else ""
    judged = replace(judged, status=OPEN, evidence=doubt) if doubt else judged
    return replace(judged, assumptions=assumptions_of(printed, derived, statement))


def assumptions_of(printed: sp.Expr, derived: sp.Expr, statement: Equation) -> tuple[str, ...]:
    """What the two sides need to exist; subtraction may have cancelled it."""
    return remaining_assumptions((printed, derived), statement.box, statement.nonzero)


# -- exact equality ---------------------------------------


def prove_equal(printed: sp.Expr, derived: sp.Expr, statement: Equation, sample: Sample) -> Verdict:
    if sample.points == 0:  # what exists nowhere is equal to everything
        return judge_sample(sample, scope_of(printed - derived, statement.box), "equality")
    difference = printed - derived
    if vanishes_identically(difference):
        method, evidence = "normal form", "printed - derived is zero by exact algebra"
    elif not difference.free_symbols and is_zero(difference):
        method, evidence = "exact number", "printed - derived is exactly zero"
    else:
        return decide_unproved(printed, derived, statement, sample)
    return Verdict(
        PROVED,
        method=method,
        scope=scope_of(sp.Tuple(printed, derived), statement.box),
        assumptions=assumptions_of(printed, derived, statement),
        evidence=evidence,
    )


def decide_unproved(printed: sp.Expr, derived: sp.Expr, statement: Equation, sample: Sample) -> Verdict:
    """What no rung proves: broken by a second look, or sampled; OPEN when the normal form denies it."""
    difference, scope = printed - derived, scope_of(printed - derived, statement.box)
    sides = finite_sides(printed, derived, statement)
    look = look_at_places(difference, excludes_zero, statement.box, sides)
    if look is None:
        look = look_again(difference, excludes_zero, statement.box, sides)
    verdict = judge_look(look, sample, scope, "equality")
    if verdict.status == REFUTED:
        return verdict
    if verdict.status == CONFIRMED and has_unique_form(difference):
        evidence = f"{verdict.evidence}, and the normal form of printed - derived is not zero"
        verdict = replace(verdict, status=OPEN, method="normal form", evidence=evidence)
    return replace(verdict, assumptions=assumptions_of(printed, derived, statement))


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
