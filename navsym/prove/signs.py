"""Signs of expressions on whole boxes, by proofs that the checker accepts.

``prove_sign(f, box)`` asks the search for a proof that f has a value everywhere on the box and is nonnegative (or
positive) there, and has the checker play it; what is not proved comes back as unknown.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import sympy as sp

from navsym import checker
from navsym.claims.statement import Box
from navsym.core.balls import UnsupportedError, exact_ball, precision, tape
from navsym.core.errors import NavsymError
from navsym.language.expression import to_text
from navsym.prove.identities import is_zero
from navsym.prove.products import as_product
from navsym.prove.rooms.goals import player
from navsym.prove.sampling.points import Range, ranges_of, value_at, write_range
from navsym.prove.sampling.second_look import Look, look_at_places, zeros_of
from navsym.prove.search import SIGN_ROUNDS, Rounds, find_proof, rules_of


class Sign(IntEnum):
    """What is known of an expression on a box."""

    UNKNOWN = 0
    NONNEGATIVE = 1
    NONZERO = 2
    POSITIVE = 3


@dataclass(frozen=True, slots=True)
class SignProof:
    """A sign with its reason."""

    sign: Sign
    reason: str = ""
    exact: bool = False  # no balls were used

    def at_least(self, wanted: Sign) -> bool:
        """Whether the known sign gives the wanted one; what is nonzero may be negative."""
        return self.sign in (wanted, Sign.POSITIVE)


UNKNOWN = SignProof(Sign.UNKNOWN)
BITS = 128
RELATIONS = {Sign.NONNEGATIVE: ">=", Sign.POSITIVE: ">", Sign.NONZERO: "!="}


def prove_sign(
    expression: sp.Expr, box: Box, wanted: Sign = Sign.NONNEGATIVE, rounds: Rounds = SIGN_ROUNDS
) -> SignProof:
    """Prove that the expression has a value everywhere on the box and a sign there, or return unknown.

    A product form of it is tried as well.
    """
    expression = sp.sympify(expression, strict=True)
    limits = ranges_of(sorted(expression.free_symbols, key=str), box)
    points = {symbol: limit.lower for symbol, limit in limits.items() if limit.lower == limit.upper is not None}
    expression, limits = expression.subs(points), {s: limit for s, limit in limits.items() if s not in points}
    if not expression.free_symbols:
        proof = constant_sign(expression)
        return proof if proof.at_least(wanted) else UNKNOWN
    try:
        if is_known_to_fail(expression, limits, wanted):
            return UNKNOWN
        forms = dict.fromkeys(form for form in (expression, as_product(expression)) if form is not None)
        exact = prove_conditions(expression, limits, rounds)
        for form in forms if exact is not None else ():
            found = prove_term(player.parse(to_text(form)), RELATIONS[wanted], limits, rounds)
            if found is not None:
                return SignProof(wanted, f"{form} {RELATIONS[wanted]} 0", exact=found and bool(exact))
    except (NavsymError, UnsupportedError, checker.Refused, player.Refused, RecursionError):
        pass
    return UNKNOWN


def is_known_to_fail(expression: sp.Expr, limits: Mapping[sp.Symbol, Range], wanted: Sign) -> bool:
    """Whether a place is known at which an expression in one symbol has another sign."""
    if len(limits) != 1:
        return False
    ((symbol, limit),) = limits.items()
    is_strict = wanted != Sign.NONNEGATIVE
    places = [limit.lower, limit.upper, *zeros_of(expression, symbol, {})] if is_strict else []
    known = [place for place in places if place is not None and limit.contains(place)]
    values = [value_at(tape(expression), {symbol: place}) for place in known]
    if any(value.is_finite() and value.contains(0) for value in values):
        return True
    is_below = (lambda ball: False) if wanted == Sign.NONZERO else (lambda ball: bool(ball < 0))
    look = look_at_places(expression, is_below, {symbol: (limit.lower, limit.upper)}, (), is_strict)
    return look is not None and look != Look()


def prove_conditions(expression: sp.Expr, limits: Mapping[sp.Symbol, Range], rounds: Rounds) -> bool | None:
    """Whether exact proofs show that the expression has a value everywhere; None where that is not proved."""
    exact = True
    for relation, term in player.conditions(player.parse(to_text(expression))):
        found = prove_term(term, relation, limits, rounds)
        if found is None:
            return None
        exact = exact and found
    return exact


def prove_term(term: Any, relation: str, limits: Mapping[sp.Symbol, Range], rounds: Rounds) -> bool | None:
    """Whether a proof of ``term relation 0`` that the checker grants is exact; None where there is none."""
    written = {symbol.name: write_range(limit) for symbol, limit in limits.items()}

    def goal_of(read: Callable[[Any], Any]) -> dict[str, Any]:
        return {name: read(limit) for name, limit in written.items()}

    goal = player.Goal(term, relation, goal_of(player.read_range))
    proof = find_proof(goal, rounds=rounds, balls=False) or find_proof(goal, rounds=rounds)
    if proof is None:
        return None
    with precision(BITS):
        checker.prove(proof, checker.Goal(term, relation, goal_of(checker.read_range)))
    return "balls" not in rules_of(proof)


def constant_sign(expression: sp.Expr) -> SignProof:
    """Sign of a number: by a ball, or exactly zero by the normal form."""
    for bits in (64, 256, 1024):
        ball = exact_ball(expression, bits)
        if ball > 0:
            return SignProof(Sign.POSITIVE, "a positive number", exact=True)
        if ball < 0:
            return SignProof(Sign.NONZERO, "a negative number", exact=True)
    if is_zero(expression):
        return SignProof(Sign.NONNEGATIVE, "zero", exact=True)
    return UNKNOWN
