"""Search for proofs that the checker accepts: a goal goes in, a proof comes out, or nothing.

Each room is a function of a goal that yields proofs by one rule of the checker, with holes where the premises stand.
A copy of the checker plays the rule and comes upon the goals of its premises itself, for which the search goes on. What
a room gets wrong is refused, so that a room which errs costs an answer, never a truth; adding one is adding a function.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from flint import ctx

from navsym.core.errors import NavsymError
from navsym.prove.relations.cofactors import by_cofactors, by_elimination, by_sums_of_hypotheses
from navsym.prove.rooms.equations import (
    by_algebra,
    by_cases,
    by_empty_case,
    by_equal_squares,
    by_exponents,
    by_factors_of_roots,
    by_gradient,
    by_inverse,
    by_logarithms_of_products,
    by_modulus,
    by_sides_of_zero,
    by_values,
    by_values_of_constants,
)
from navsym.prove.rooms.forms import (
    by_divisors,
    by_forms,
    by_hypothesis,
    by_known_signs,
    by_one_angle,
    by_roots_of_symbols,
    by_substitution,
)
from navsym.prove.rooms.goals import Hole, Holes, Proof, Room, fails, player, sample_goal, subterms
from navsym.prove.rooms.quadrics import by_quadrics
from navsym.prove.rooms.signs import (
    by_bounds,
    by_concavity,
    by_cones,
    by_constant,
    by_contacts,
    by_corners,
    by_divided_root,
    by_divided_term,
    by_existence,
    by_few_balls,
    by_identity,
    by_logarithms,
    by_many_balls,
    by_number,
    by_positive_radicand,
    by_product,
    by_quadratic,
    by_range,
    by_roots,
    by_side,
    by_slope,
    by_squares,
    by_sum,
)

#: The rooms in the order of their cost: cheap ones, those that think longer, those of the last resort.
EQUATIONS: tuple[tuple[Room, ...], ...] = (
    (
        by_algebra, by_one_angle, by_cofactors, by_elimination, by_modulus, by_values,
        by_values_of_constants, by_inverse, by_factors_of_roots, by_exponents, by_equal_squares,
    ),
    (
        by_known_signs, by_roots_of_symbols, by_sums_of_hypotheses, by_logarithms_of_products, by_empty_case,
        by_sides_of_zero, by_gradient,
    ),
)  # fmt: skip
SIGNS: tuple[tuple[Room, ...], ...] = (
    (
        by_number, by_positive_radicand, by_existence, by_divided_root, by_divided_term, by_identity,
        by_elimination, by_sums_of_hypotheses, by_range, by_roots, by_bounds, by_corners, by_product, by_sum,
        by_few_balls, by_values, by_side, by_squares, by_cones, by_forms, by_quadrics,
    ),
    (
        by_constant, by_known_signs, by_cofactors, by_hypothesis, by_cases, by_quadratic, by_divisors,
        by_roots_of_symbols, by_substitution, by_slope, by_contacts, by_modulus, by_logarithms, by_empty_case,
    ),
    (by_concavity, by_many_balls),
)  # fmt: skip

#: Depth of proofs, number of rules tried and kinds of rooms, one round after the other: the same on every machine.
#: The time is a net below.
ROUNDS = ((8, 200, 1), (8, 300, 2), (8, 400, 3), (12, 1200, 3))
SECONDS = 30.0
#: Parts of a term for which only cheap rooms are asked.
LONG = 600

check_rule = player.prove


@dataclass(slots=True)
class Search:
    """One search: its limit of time, its depth, and the goals that were given up or found."""

    deadline: float
    balls: bool = True  # whether boxes may be divided into cells
    found: dict[Any, Proof] = field(default_factory=dict)
    tries: int = 0
    most_depth: int = 0
    kinds: int = 0
    depth: int = 0
    lost: dict[Any, int] = field(default_factory=dict)
    rules: list[str] = field(default_factory=list)

    def prove(self, proof: Any, goal: Any) -> None:
        """Fill a hole, or check what is no hole."""
        if not isinstance(proof, Hole):
            check_rule(proof, goal)
            return
        found = self.find(goal)
        player.require(found is not None, "no proof was found")
        proof.update(found or {})

    def prove_all(self, proofs: Any, goals: Sequence[Any]) -> None:
        """The same for a list."""
        if isinstance(proofs, Holes) and not proofs:
            for goal in goals:
                proofs.append(Hole())
                self.prove(proofs[-1], goal)
            return
        for proof, goal in zip(player.read_list(proofs, lambda entry: entry, len(goals)), goals, strict=True):
            self.prove(proof, goal)

    def find(self, goal: Any) -> Proof | None:
        """A proof of a goal, or None."""
        key = (goal.term, goal.relation, tuple(sorted(goal.box.items())), goal.given, goal.zeros)
        if (key, goal.exists) in self.found:
            return self.found[key, goal.exists]
        left = self.most_depth - self.depth
        if left <= 0 or self.lost.get(key, -1) >= left or self.is_spent():
            return None
        self.lost[key] = left  # a goal among its own premises is none of them
        sample = sample_goal(goal)
        if any(fails(goal.relation, value) for value in sample):
            sample = sample_goal(goal, is_strict=True)
        if not any(fails(goal.relation, value) for value in sample):
            self.depth += 1
            try:
                kinds = EQUATIONS if goal.relation == "=" else SIGNS
                few = 1 if is_long(goal.term) else self.kinds
                for room in itertools.chain(*kinds[:few]):
                    if self.leaves_out(room):
                        continue
                    for candidate in guard(room(goal, sample)):
                        if self.is_spent():
                            return None
                        self.tries -= 1
                        if self.plays(candidate, goal):
                            del self.lost[key]
                            self.found[key, goal.exists] = candidate
                            return candidate
            finally:
                self.depth -= 1
        return None

    def leaves_out(self, room: Room) -> bool:
        """Whether a room is not asked: what it makes has been made already, or rests on many balls."""
        if room in (by_few_balls, by_many_balls):
            return not self.balls
        if room is by_forms:
            return self.rules[-1:] == ["equal"]  # one form of a form is one of the first
        if room in (by_squares, by_equal_squares):
            return self.rules.count("squares") > 1
        if room is by_empty_case:
            return "empty" in self.rules
        return room is by_gradient and "derivative" in self.rules

    def is_spent(self) -> bool:
        """Whether nothing more is to be tried."""
        return self.tries <= 0 or time.process_time() > self.deadline

    def plays(self, candidate: Proof, goal: Any) -> bool:
        """Whether the rule of a candidate applies and its holes can be filled."""
        self.rules.append(candidate["rule"])
        try:
            check_rule(candidate, goal)
        except (player.Refused, ZeroDivisionError, ArithmeticError, ValueError, KeyError, TypeError, RecursionError):
            return False
        finally:
            self.rules.pop()
        return True


def is_long(term: Any) -> bool:
    """Whether a term has many parts: algebra may take minutes with it."""
    return next(itertools.islice(subterms(term), LONG, None), None) is not None


def guard(candidates: Iterator[Proof]) -> Iterator[Proof]:
    """The candidates of a room; one that fails while it thinks has no more."""
    try:
        yield from candidates
    except (NavsymError, player.Refused, ArithmeticError, ValueError, TypeError, AttributeError, NotImplementedError):
        return


def find_proof(
    goal: Any, seconds: float = SECONDS, rounds: Sequence[tuple[int, int, int]] = ROUNDS, balls: bool = True
) -> Proof | None:
    """A proof of a goal of the checker as plain data, or None; it is still to be granted.

    balls : whether boxes may be divided into cells
    """
    before, search = (ctx.prec, ctx.cap), Search(time.process_time() + seconds, balls)
    ctx.prec = 128
    try:
        player.prove, player.prove_all = search.prove, search.prove_all
        for search.most_depth, search.tries, search.kinds in rounds:
            search.lost.clear()
            found = search.find(goal)
            if found is not None:
                return plain(found)
        return None
    finally:
        ctx.prec, ctx.cap = before
        player.prove = check_rule


def find_filled(check: Callable[[], Any], seconds: float) -> Any:
    """What a check of the player returns when the search can fill the holes that it comes upon; else None."""
    before, search = (ctx.prec, ctx.cap), Search(time.process_time() + seconds)
    ctx.prec = 128
    try:
        player.prove, player.prove_all = search.prove, search.prove_all
        for search.most_depth, search.tries, search.kinds in ROUNDS[1:3]:
            search.lost.clear()
            try:
                return check()
            except (player.Refused, ArithmeticError, ValueError, KeyError, TypeError, RecursionError):
                continue
        return None
    finally:
        ctx.prec, ctx.cap = before
        player.prove = check_rule


def plain(proof: Any) -> Any:
    """The same without the classes of holes."""
    if isinstance(proof, dict):
        return {key: plain(value) for key, value in proof.items()}
    return [plain(value) for value in proof] if isinstance(proof, list) else proof


def rules_of(proof: Any) -> set[str]:
    """The names of the rules of a proof; a ball of one number is exact and has none."""
    if isinstance(proof, list):
        return set().union(*map(rules_of, proof))
    if not isinstance(proof, dict):
        return set()
    is_number = proof.get("rule") == "balls" and proof["cells"] == 1
    own = {proof["rule"]} if "rule" in proof and not is_number else set()
    return own.union(*map(rules_of, proof.values()))
