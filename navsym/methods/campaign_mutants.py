"""All formulas one token away from the proven ones: refuted with an exact point, or proved equal.

A mutant that the ladder holds for true is looked at once more by another route: both sides are
evaluated to forty digits at points of the box. A difference there is a false proof, the worst defect.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import sympy as sp

from navsym.claims import REFUTED, Box, Claim, Equation
from navsym.errors import NavsymError
from navsym.methods.campaign import Batch, Result, result
from navsym.methods.dependencies import fingerprint
from navsym.proof.equations import decide_equation, entries
from navsym.proof.mutants import mutants
from navsym.proof.sampling import points
from navsym.proof.wording import text_of


@dataclass(frozen=True, slots=True, eq=False)
class Mutant:
    """A formula one token away from a printed one, beside what was derived."""

    claim: str
    formula: sp.Expr
    derived: sp.Expr
    box: Box


def equations(claims: Iterable[Claim]) -> Iterator[tuple[str, Equation]]:
    """The equations without tolerance among the claims that are declared to hold."""
    for claim in claims:
        if claim.expect.holds:
            statement = claim.derive()
            if isinstance(statement, Equation) and statement.tolerance is None:
                yield claim.id, statement


def mutants_of(claims: Iterable[Claim]) -> Iterator[Mutant]:
    """Every mutant of every entry of every equation."""
    for name, statement in equations(claims):
        for printed, derived in zip(entries(statement.printed), entries(statement.derived), strict=True):
            for formula in mutants(printed):
                yield Mutant(name, formula, derived, statement.box)


def batches(claims: Iterable[Claim], share: float = 1.0, seed: int = 0) -> list[Batch]:
    """One batch for each claim that is declared to hold; a random share of its mutants, fixed by the seed."""
    held = [claim for claim in claims if claim.expect.holds]
    return [Batch(f"{claim.id} {fingerprint(claim)} {share} {seed}", (claim, share, seed)) for claim in held]


def judge(task: tuple[Claim, float, int]) -> Result:
    """Counts: refuted, proved (equal to what was derived) and open; wrong: a proof that numbers deny."""
    claim, share, seed = task
    source = random.Random(f"{claim.id} {seed}")
    counts: Counter[str] = Counter()
    wrong: list[Any] = []
    undecided: list[Any] = []
    kept: list[Any] = []
    for mutant in mutants_of([claim]):
        if source.random() >= share:
            continue
        status, why, point = verdict_of(mutant)
        entry = {"claim": mutant.claim, "formula": text_of(mutant.formula)}
        counts[status] += 1
        if status == "refuted":
            kept.append({**entry, "point": point})
        elif status == "open":
            undecided.append({**entry, "why": why})
        elif differs(mutant):
            wrong.append({**entry, "why": "proved, and yet the sides differ to forty digits"})
    return result(counts, wrong, undecided, kept)


def verdict_of(mutant: Mutant) -> tuple[str, str, dict[str, str] | None]:
    try:
        verdict = decide_equation(Equation(mutant.formula, mutant.derived, mutant.box))
    except NavsymError as error:
        return "open", str(error), None
    if verdict.status == REFUTED and verdict.counterexample is not None:
        return "refuted", verdict.evidence, dict(verdict.counterexample)
    return ("proved" if verdict.status.holds else "open"), f"{verdict.status}: {verdict.evidence}", None


def differs(mutant: Mutant, count: int = 4, digits: int = 40) -> bool:
    """True when both sides are numbers at a point of the box and are not equal there."""
    difference = mutant.formula - mutant.derived
    symbols = sorted(difference.free_symbols, key=str)
    for point in points(symbols, mutant.box, count, seed=99):
        value = difference.subs(point).evalf(digits)
        if value.is_Float and abs(value) > sp.Float(10) ** (-digits // 2):
            return True
    return False
