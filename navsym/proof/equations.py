"""Equations: first try to break them, then to prove them.

The rungs, in order: an exact point where a ball excludes equality; the normal form; absolute
values and roots of squares resolved by proved signs; both sides squared when both are
nonnegative; equal derivatives and one common point on an interval without singularities.
What passes none of them but agrees at every sampled point is CONFIRMED, never more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import sympy as sp
from flint import arb

from navsym.claims.statement import Box, Equation
from navsym.claims.verdict import CERTIFIED, CONFIRMED, OPEN, PROVED, REFUTED, Verdict
from navsym.proof.balls import UnsupportedError, enclose, tape
from navsym.proof.bounds import Sign, prove_sign
from navsym.proof.certificates import identity_certificate
from navsym.proof.normal_form import (
    OutsideLanguageError,
    Reduction,
    UndefinedExpressionError,
    reduce_to_zero,
    vanishes_identically,
)
from navsym.proof.sampling import Point, Sample, points, search_counterexample
from navsym.proof.second_look import BITS, Look, second_look
from navsym.proof.wording import decimal_ends, point_text, scope_of, text_of

ENOUGH_POINTS = 32

#: Functions inside an angle that make angles depend on each other: |a| and a, say.
BENT = (sp.Abs, sp.sign, sp.Max, sp.Min)


def decide_equation(statement: Equation) -> Verdict:
    """Verdict of an equation between scalars, matrices or sequences, entry by entry."""
    printed, derived = entries(statement.printed), entries(statement.derived)
    if shape_of(statement.printed) != shape_of(statement.derived):
        return Verdict(
            REFUTED,
            method="shape",
            evidence=f"printed shape {shape_of(statement.printed)}, derived {shape_of(statement.derived)}",
            counterexample={},
        )
    verdicts = [decide_entry(p, d, statement) for p, d in zip(printed, derived, strict=True)]
    verdict = combine(verdicts)
    if verdict.status == REFUTED:
        return verdict
    return replace(verdict, scope=scope_of(sp.Tuple(*printed, *derived), statement.box))


def shape_of(side: object) -> tuple[int, ...]:
    if isinstance(side, sp.MatrixBase):
        return tuple(side.shape)
    return (len(side),) if isinstance(side, (tuple, list)) else ()


def entries(side: object) -> list[sp.Expr]:
    """The scalar expressions of a side; never a string, which sympy would execute."""
    if isinstance(side, (sp.MatrixBase, tuple, list)):
        return [sp.sympify(entry, strict=True) for entry in side]
    return [sp.sympify(side, strict=True)]


STRENGTH = (REFUTED, OPEN, CONFIRMED, CERTIFIED, PROVED)


def combine(verdicts: Sequence[Verdict]) -> Verdict:
    """The weakest verdict of several entries; assumptions and counts are those of all."""
    weakest = min(verdicts, key=lambda verdict: STRENGTH.index(verdict.status))
    if len(verdicts) == 1:
        return weakest
    place = verdicts.index(weakest) + 1
    assumptions = tuple(dict.fromkeys(a for verdict in verdicts for a in verdict.assumptions))
    prefix = f"{len(verdicts)} entries, the weakest is number {place}: "
    certificate = None
    if all(verdict.certificate for verdict in verdicts):
        certificate = {"kind": "all", "of": [dict(verdict.certificate or {}) for verdict in verdicts]}
    return replace(
        weakest, assumptions=assumptions, evidence=prefix + weakest.evidence, certificate=certificate
    )


def decide_entry(printed: sp.Expr, derived: sp.Expr, statement: Equation) -> Verdict:
    box = statement.box
    try:
        if statement.tolerance is not None:
            return decide_numeral(printed, derived, statement)
        sample = search_counterexample(
            printed - derived,
            lambda b: not b.contains(0),
            box,
            sides=finite_sides(printed, derived, statement),
        )
        if sample.counterexample is not None:
            return refuted(sample)
        return prove_equal(printed, derived, statement, sample)
    except UndefinedExpressionError as error:
        return Verdict(OPEN, "normal form", scope_of(printed - derived, box), evidence=str(error))
    except (UnsupportedError, OutsideLanguageError) as error:
        return Verdict(OPEN, "none", scope_of(printed - derived, box), evidence=str(error))


def finite_sides(printed: sp.Expr, derived: sp.Expr, statement: Equation) -> tuple[sp.Expr, ...]:
    """What has to have a value at a point of the statement."""
    divisors = (sp.sympify(part, strict=True) for part in statement.nonzero)
    return (printed, derived, *statement.exists, *(1 / part for part in divisors if part != 0))


def refuted(sample: Sample) -> Verdict:
    assert sample.counterexample is not None and sample.difference is not None
    return broken(sample.counterexample, sample.difference)


# -- numerals ---------------------------------------


def decide_numeral(printed: sp.Expr, derived: sp.Expr, statement: Equation) -> Verdict:
    """``|printed - derived| <= tolerance``, the meaning of a printed numeral."""
    tolerance = sp.sympify(statement.tolerance, strict=True)
    difference, box = printed - derived, statement.box
    sample = search_counterexample(
        difference,
        lambda ball: bool(abs(ball) > enclose(tolerance)),
        box,
        sides=finite_sides(printed, derived, statement),
    )
    if sample.counterexample is not None:
        return refuted(sample)
    for side in (tolerance - difference, tolerance + difference):
        if not prove_sign(side, box).at_least(Sign.NONNEGATIVE):
            look = second_look(
                difference,
                lambda ball: bool(abs(ball) > enclose(tolerance, bits=BITS)),
                box,
                finite_sides(printed, derived, statement),
                goals=(tolerance - difference, tolerance + difference),
            )
            return after_look(look, sample, scope_of(difference, box), f"within {tolerance}")
    return Verdict(
        CERTIFIED,
        method="ball arithmetic",
        scope=scope_of(difference, box),
        evidence=f"|printed - derived| <= {tolerance} everywhere on the box",
    )


# -- exact equality ---------------------------------------


@dataclass(frozen=True, slots=True)
class Proof:
    method: str
    evidence: str
    reduction: Reduction


def prove_equal(printed: sp.Expr, derived: sp.Expr, statement: Equation, sample: Sample) -> Verdict:
    rungs: tuple[Callable[[sp.Expr, sp.Expr, Box], Proof | None], ...] = (
        by_normal_form,
        by_resolved_signs,
        by_squares,
        by_derivative,
    )
    if sample.points == 0:  # what exists nowhere is equal to everything
        return sampled(sample, scope_of(printed - derived, statement.box), "equality")
    for rung in rungs:
        proof = rung(printed, derived, statement.box)
        if proof is not None:
            return proved(proof, printed, derived, statement)
    return unproved(printed, derived, statement, sample)


def unproved(printed: sp.Expr, derived: sp.Expr, statement: Equation, sample: Sample) -> Verdict:
    """What no rung proves: broken by a second look, or sampled; OPEN when the normal form denies it."""
    difference, scope = printed - derived, scope_of(printed - derived, statement.box)
    sides = finite_sides(printed, derived, statement)
    look = second_look(difference, lambda ball: not ball.contains(0), statement.box, sides)
    verdict = after_look(look, sample, scope, "equality")
    if verdict.status == CONFIRMED and not difference.has(*BENT) and reduce_to_zero(difference).complete:
        evidence = f"{verdict.evidence}, and the normal form of printed - derived is not zero"
        return replace(verdict, status=OPEN, method="normal form", evidence=evidence)
    return verdict


def after_look(look: Look, sample: Sample, scope: str, what: str) -> Verdict:
    """REFUTED by the point of a second look, else what the samples say."""
    if look.counterexample is None or look.difference is None:
        return sampled(sample, scope, what)
    return broken(look.counterexample, look.difference, look.exact)


def broken(point: Point, difference: arb, exact: bool = False) -> Verdict:
    """REFUTED at one exact point."""
    ends = ("0", "0") if exact else decimal_ends(difference)
    evidence = (
        "the difference is exactly zero there"
        if exact
        else f"the sides differ by {ends[0]} at an exact point"
    )
    method = "exact point" if exact else "exact point, ball arithmetic"
    return Verdict(
        REFUTED, method, "one point", evidence=evidence, counterexample=point_text(point), difference=ends
    )


def proved(proof: Proof, printed: sp.Expr, derived: sp.Expr, statement: Equation) -> Verdict:
    return Verdict(
        PROVED,
        method=proof.method,
        scope=scope_of(sp.Tuple(printed, derived), statement.box),
        assumptions=remaining_assumptions(proof.reduction, statement),
        evidence=proof.evidence,
        certificate=identity_certificate(printed, derived) if proof.method == "normal form" else None,
    )


def sampled(sample: Sample, scope: str, what: str) -> Verdict:
    """CONFIRMED with its count when enough points could be evaluated, otherwise OPEN."""
    if sample.points == 0:
        return Verdict(OPEN, "sampling", scope, evidence="no exact point of the box could be evaluated")
    largest = decimal_ends(sample.largest)[1] if sample.largest is not None else "0"
    evidence = f"{what} at {sample.points} exact points, largest residual {largest}; no proof was found"
    enough = sample.points >= ENOUGH_POINTS
    return Verdict(CONFIRMED if enough else OPEN, "sampling", scope, evidence=evidence)


def by_normal_form(printed: sp.Expr, derived: sp.Expr, box: Box) -> Proof | None:
    reduction = reduce_to_zero(printed - derived)
    if not reduction.zero:
        return None
    reduction = with_sides(reduction, printed, derived)
    return Proof("normal form", f"printed - derived reduces to 0 in {reduction.ring}", reduction)


def with_sides(reduction: Reduction, *sides: sp.Expr) -> Reduction:
    """Add the divisors and radicands of the sides, which subtraction may have cancelled."""
    parts = [reduction, *(reduce_to_zero(side) for side in sides)]

    def union(name: str) -> tuple[sp.Basic, ...]:
        return tuple(dict.fromkeys(item for part in parts for item in getattr(part, name)))

    return replace(
        reduction, divisors=union("divisors"), radicands=union("radicands"), arguments=union("arguments")
    )


def by_resolved_signs(printed: sp.Expr, derived: sp.Expr, box: Box) -> Proof | None:
    """Replace |u| and sqrt(u**2) by u or -u where the sign of u is proved, and reduce again."""
    difference, notes = resolve_signs(printed - derived, box)
    if not notes:
        return None
    reduction = reduce_to_zero(difference)
    if not reduction.zero:
        return None
    reduction = with_sides(reduction, printed, derived)
    return Proof("normal form after signs", f"{'; '.join(notes)}; then 0 in {reduction.ring}", reduction)


def resolve_signs(expression: sp.Expr, box: Box) -> tuple[sp.Expr, list[str]]:
    notes: list[str] = []
    found = [node for node in expression.atoms(sp.Abs, sp.Pow) if signed_inside(node) is not None]
    for node in sorted(found, key=sp.default_sort_key):
        inside = signed_inside(node)
        assert inside is not None
        for value in (inside, -inside):
            if prove_sign(value, box).at_least(Sign.NONNEGATIVE):
                expression = expression.subs(node, value)
                notes.append(f"{node} = {value} on the box")
                break
    return expression, notes


def signed_inside(node: sp.Basic) -> sp.Expr | None:
    """u for |u| and for sqrt(u**2); None for anything else."""
    if isinstance(node, sp.Abs):
        return node.args[0]
    if isinstance(node, sp.Pow) and node.exp == sp.Rational(1, 2) and isinstance(node.base, sp.Pow):
        inner = node.base
        if isinstance(inner.exp, sp.Integer) and inner.exp % 2 == 0 and inner.exp > 0:
            return inner.base ** (inner.exp / 2)
    return None


def by_squares(printed: sp.Expr, derived: sp.Expr, box: Box) -> Proof | None:
    """Equal squares and both sides nonnegative: what roots of sums need."""
    if not (printed - derived).atoms(sp.Pow, sp.Abs):
        return None
    reduction = reduce_to_zero(printed**2 - derived**2)
    if not reduction.zero:
        return None
    for flip in (1, -1):
        if all(prove_sign(flip * side, box).at_least(Sign.NONNEGATIVE) for side in (printed, derived)):
            reduction = with_sides(reduction, printed, derived)
            return Proof("squares", f"both sides of one sign, squares equal in {reduction.ring}", reduction)
    return None


def by_derivative(printed: sp.Expr, derived: sp.Expr, box: Box) -> Proof | None:
    """One symbol: the derivative of the difference vanishes and so does one value.

    Needs an interval on which nothing is divided by zero and no root or logarithm ends, so
    that the difference is one smooth function there.
    """
    difference = printed - derived
    if len(difference.free_symbols) != 1:
        return None
    (symbol,) = difference.free_symbols
    if symbol.is_integer or difference.has(sp.Abs, sp.sign, sp.Max, sp.Min, sp.atan2):
        return None
    reduction = reduce_to_zero(sp.diff(difference, symbol))
    if not reduction.zero or not smooth_on(difference, box):
        return None
    point = common_point(difference, symbol, box)
    if point is None:
        return None
    reduction = with_sides(reduction, printed, derived)
    return Proof("derivative", f"equal derivatives, and equal at {symbol} = {point}", reduction)


def smooth_on(expression: sp.Expr, box: Box) -> bool:
    """True when divisors, radicands, arguments of logarithms are proved to stay away from zero."""
    conditions = reduce_to_zero(expression)
    inner = [*conditions.radicands, *conditions.arguments]
    inner += [a for node in expression.atoms(sp.asin, sp.acos) for a in (1 - node.args[0], 1 + node.args[0])]
    inner += [p.base for p in expression.atoms(sp.Pow) if p.exp.is_Rational and not p.exp.is_Integer]
    inner += [node.args[0] for node in expression.atoms(sp.log)]
    divisors = [*conditions.divisors]
    divisors += [sp.cos(node.args[0]) for node in expression.atoms(sp.tan, sp.sec)]
    divisors += [sp.sin(node.args[0]) for node in expression.atoms(sp.cot, sp.csc)]
    return all(is_positive(item, box) for item in inner) and all(is_nonzero(item, box) for item in divisors)


def is_positive(expression: sp.Basic, box: Box) -> bool:
    """True when the expression is proved to be positive on the box."""
    return prove_sign(expression, box, Sign.POSITIVE).at_least(Sign.POSITIVE)


def is_nonzero(expression: sp.Basic, box: Box) -> bool:
    """True when the expression is proved to keep one sign on the box."""
    return is_positive(expression, box) or is_positive(-expression, box)


def common_point(difference: sp.Expr, symbol: sp.Symbol, box: Box) -> sp.Expr | None:
    for point in points([symbol], box, 12):
        value = difference.subs(point)
        if (
            not value.has(sp.nan, sp.zoo, sp.oo)
            and enclose(tape(value)).contains(0)
            and vanishes_identically(value)
        ):
            return point[symbol]
    return None


# -- assumptions ---------------------------------------


def remaining_assumptions(reduction: Reduction, statement: Equation) -> tuple[str, ...]:
    """What the proof took for granted and the box does not guarantee."""
    box, found = statement.box, []
    for divisor in (*reduction.divisors, *statement.nonzero):
        if not is_nonzero(divisor, box):
            found.append(f"{text_of(divisor)} != 0")
    for radicand in reduction.radicands:
        if not prove_sign(radicand, box).at_least(Sign.NONNEGATIVE):
            found.append(f"{text_of(radicand)} >= 0")
    for argument in reduction.arguments:
        if not is_positive(argument, box):
            found.append(f"{text_of(argument)} > 0")
    return tuple(dict.fromkeys(found))
