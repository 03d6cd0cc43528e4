"""All formulas one token away from the proven ones: refuted with an exact point, or proved to hold as well.

A mutant is evaluated at exact points first, where nearly all fall; what is left is decided like a claim.
What the ladder holds for true is looked at once more by another route: both sides are evaluated to forty
digits at points of the box. A difference there is a false proof, the worst defect.
"""

from __future__ import annotations

import random
import signal
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import sympy as sp

from navsym.claims import REFUTED, Bound, Claim, Equation, Optimum
from navsym.core.errors import NavsymError
from navsym.prove.ladder import decide
from navsym.prove.sampling.points import draw_points
from navsym.prove.wording import expression_text, point_text
from navsym.verification.sides import hash_statement
from tests.attacks.campaigns.batches import Batch, Result, result
from tests.attacks.campaigns.changes import (
    Assertion,
    Change,
    apply_change,
    changes,
    derived_parts,
    find_refuting_point,
    free_symbols,
    printed_parts,
    rows,
)
from tests.attacks.campaigns.edits import is_formula

#: For one mutant that no point has refuted. A mutant of an inequality is often a weaker one that holds with
#: room to spare, and its proof is another task than noticing a slip: it gets a short look only.
SECONDS, SECONDS_OF_BOUND = 20.0, 0.3


class OutOfTimeError(Exception):
    """A mutant took longer than its share of time."""


def make_batches(claims: Iterable[Claim], share: float = 1.0, seed: int = 0) -> list[Batch]:
    """One batch for each claim that is declared to hold; a random share of its mutants, fixed by the seed."""
    held = [claim for claim in claims if claim.expect.holds]
    return [
        Batch(f"{claim.id} {hash_statement(claim.derive(), None)} {share} {seed}", (claim, share, seed))
        for claim in held
    ]


def judge(task: tuple[Claim, float, int]) -> Result:
    """Counts by outcome and by kind of change; wrong: a proof that numbers deny.

    Outcomes: refuted (an exact point is kept), held (proved to be true as well), undefined (no real
    formula, or without a value at every point), open.
    """
    claim, share, seed = task
    statement = claim.derive()
    if not isinstance(statement, (Equation, Bound, Optimum)):
        return result(Counter())
    return judge_statement(claim.id, statement, share, random.Random(f"{claim.id} {seed}"))


def judge_statement(name: str, statement: Assertion, share: float, source: random.Random) -> Result:
    """The result of a statement: a random share of its changes, at the points of a table first and then decided.

    Kept: the points that refute, the number of one for every change taken (None where none does), and what deciding
    has refuted.
    """
    counts: Counter[str] = Counter()
    wrong: list[Any] = []
    undecided: list[Any] = []
    table = rows(statement)
    where: list[int | None] = []
    slow: list[Any] = []
    for change in changes(statement):
        if source.random() >= share:
            continue
        place = None if change.box is not None else find_refuting_point(statement, change, table)
        outcome, why = ("refuted", "") if place is not None else decide_slowly(statement, change, slow)
        counts.update((outcome, f"kind {change.kind}"))
        where.append(place)
        if outcome in ("open", "wrong"):
            entry = {"claim": name, "change": describe(statement, change), "why": why}
            (wrong if outcome == "wrong" else undecided).append(entry)
    used = sorted({place for place in where if place is not None})
    kept = {"claim": name, "points": {str(k): dict(point_text(table[k].point)) for k in used}, "at": where}
    return result(counts, wrong, undecided, [kept, *({"claim": name, **item} for item in slow)])


def decide_slowly(statement: Assertion, change: Change, kept: list[Any]) -> tuple[str, str]:
    """Outcome of a mutant that no point of the table has refuted, with the reason."""
    seconds = SECONDS_OF_BOUND if isinstance(statement, Bound) else SECONDS
    try:
        with limit_time(seconds):
            return decide_mutant(statement, change, kept)
    except OutOfTimeError:
        return "open", f"no point refutes it, and no proof within {seconds:g} s"
    except (NavsymError, RecursionError) as error:
        return "open", str(error)


def decide_mutant(statement: Assertion, change: Change, kept: list[Any]) -> tuple[str, str]:
    """Outcome of a mutant by the ladder, with the reason; the counterexample of a refutation is added to ``kept``.

    ``held`` where the change is none or is proved equal to the printed formula, and where the mutant is proved, unless
    numbers deny it: that is ``wrong``.
    """
    mutant = apply_change(statement, change)
    if is_same_tree(statement, mutant, change):
        return "held", "the same formula"
    if not all(is_formula(part) for part in printed_parts(mutant)):
        return "undefined", "no real formula"
    verdict = decide(mutant)
    if verdict.status == REFUTED and verdict.counterexample is not None:
        kept.append({"change": describe(statement, change), "point": dict(verdict.counterexample)})
        return "refuted", verdict.evidence
    if not verdict.status.holds and is_same_formula(statement, mutant, change):
        return "held", "proved equal to what was printed"
    if verdict.status.holds:
        return ("wrong", "proved, and numbers deny it") if is_denied(mutant) else ("held", verdict.evidence)
    if has_no_value(mutant):
        return "undefined", "no value at any point"
    return "open", f"{verdict.status}: {verdict.evidence}"


def is_same_tree(statement: Assertion, mutant: Assertion, change: Change) -> bool:
    """True when sympy has built the printed formula again."""
    return change.edit is not None and changed_formula(mutant, change) == printed_parts(statement)[change.part]


def is_same_formula(statement: Assertion, mutant: Assertion, change: Change) -> bool:
    """True when the changed formula is proved equal to the one that was printed, on the same box."""
    if change.edit is None:
        return False
    old = printed_parts(statement)[change.part]
    return decide(Equation(changed_formula(mutant, change), old, statement.box)).status.holds


def changed_formula(mutant: Assertion, change: Change) -> sp.Expr:
    """The printed formula of a mutant that was changed; a spoilt equation has this entry alone."""
    return printed_parts(mutant)[0 if isinstance(mutant, Equation) else change.part]


def has_no_value(mutant: Assertion) -> bool:
    """True when some printed formula has no finite value at any point of the box."""
    table = rows(mutant)
    return any(not any(row.values.of(part).is_finite() for row in table) for part in printed_parts(mutant))


@contextmanager
def limit_time(seconds: float) -> Iterator[None]:
    """Raise OutOfTimeError in the block after so many seconds of this process."""

    def ring(*_: object) -> None:
        raise OutOfTimeError

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def describe(statement: Assertion, change: Change) -> str:
    """The change in words, with its place in the formula."""
    if change.box is not None:
        ends = "; ".join(
            f"{s} in [{expression_text(low)}, {expression_text(high)}]" for s, (low, high) in change.box.items()
        )
        return f"range: {ends}"
    if change.order is not None:
        return f"{change.kind}: entries in the order {list(change.order)}"
    assert change.edit is not None
    node: Any = printed_parts(statement)[change.part]
    for place in change.edit.path:
        node = node.args[place]
    words = f"{expression_text(node)} -> {expression_text(change.edit.replacement)}"
    return f"{change.kind} in entry {change.part + 1} at {list(change.edit.path)}: {words}"


# -- the second look -----------------------------------------------------------------------------

DENIES: dict[str, Callable[[sp.Expr, sp.Expr], bool]] = {
    "=": lambda value, least: abs(value) > least,
    "!=": lambda value, least: False,  # a number near zero is not zero
    "<": lambda value, least: value > least,
    "<=": lambda value, least: value > least,
    ">": lambda value, least: value < -least,
    ">=": lambda value, least: value < -least,
}


def is_denied(mutant: Assertion, count: int = 8, digits: int = 40) -> bool:
    """True when both sides are numbers at a point of the box and the statement does not hold there.

    Of an optimum the equality of value and dual value is looked at.
    """
    relation = mutant.relation if isinstance(mutant, Bound) else "="
    least = sp.Float(10) ** (-digits // 2)
    if isinstance(mutant, Equation) and mutant.tolerance is not None:
        least += sp.sympify(mutant.tolerance, strict=True).evalf(digits)
    for point in draw_points(free_symbols(mutant), mutant.box, count, seed=99):
        for difference in subtract_sides(mutant):
            value = difference.subs(point).evalf(digits)
            if value.is_Float and DENIES[relation](value, least):
                return True
    return False


def subtract_sides(mutant: Assertion) -> list[sp.Expr]:
    """Printed less derived entries; of an optimum, the value less that of the dual."""
    if isinstance(mutant, Optimum):
        of_dual = sum(x * p for x, p in zip(mutant.dual, mutant.functional, strict=True))
        return [sp.sympify(mutant.value - of_dual, strict=True)]
    return [p - d for p, d in zip(printed_parts(mutant), derived_parts(mutant), strict=True)]
