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
from navsym.prove.relations import cofactors
from navsym.prove.rooms import equations, forms, letters, quadrics, signs
from navsym.prove.rooms.goals import Hole, Holes, Proof, Room, fails, player, sample_goal, subterms, vanishes

Rounds = Sequence[tuple[int, int, int]]
ROOMS: dict[str, Room] = {
    name: room
    for module in (cofactors, equations, forms, letters, quadrics, signs)
    for name, room in vars(module).items()
}


def choose(names: str) -> tuple[Room, ...]:
    """The rooms of these names."""
    return tuple(ROOMS[f"by_{name}"] for name in names.split())


#: The rooms in the order of their cost: cheap ones, those that think longer, those of the last resort.
EQUATIONS = (
    choose(
        "algebra one_angle cofactors elimination letters modulus values values_of_constants inverse factors_of_roots "
        "exponents equal_squares known_signs"
    ),
    choose(
        "roots_of_symbols sums_of_hypotheses logarithms_of_products empty_case bounds_that_meet integers "
        "sides_of_zero gradient"
    ),
)
SIGNS = (
    choose(
        "number positive_radicand existence identity kinks elimination sums_of_hypotheses "
        "range roots bounds corners product letters common_parts sum few_balls values side squares cones forms quadrics"
    ),
    choose(
        "constant known_signs cofactors hypothesis cases quadratic roots_of_symbols substitution slope "
        "contacts tails modulus logarithms empty_case integers"
    ),
    choose("concavity many_balls"),
)

#: Depth of proofs, number of rules tried and kinds of rooms, one round after the other: the same on every machine.
#: The time is a net below.
ROUNDS = ((8, 200, 1), (8, 300, 2), (8, 400, 3), (12, 1200, 3))
SECONDS = 30.0
#: Fewer: for signs, and for conditions that need not be listed where they are easy.
SIGN_ROUNDS, EASY = ((8, 200, 1), (8, 400, 3)), ((6, 60, 2),)
#: Parts of a term for which only cheap rooms are asked; parts of a goal that count as one more try, and parts of all
#: cells when balls fail: each takes about as long as a rule on a short term.
LONG, PARTS, PARTS_OF_CELLS = 600, 40, 2000
BALLS = (signs.by_few_balls, signs.by_many_balls)

REFUSALS = (player.Refused, ArithmeticError, ValueError, KeyError, TypeError, RecursionError)
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
    undecided: set[Any] = field(default_factory=set)  # rooms of balls with goals that they do not prove

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

    def go_round(self, ask: Callable[[], Any], rounds: Rounds) -> Any:
        """What the player answers, which fills its holes by this search; None where no round has an answer."""
        before = (ctx.prec, ctx.cap)
        ctx.prec = 128
        try:
            player.prove, player.prove_all = self.prove, self.prove_all
            for self.most_depth, self.tries, self.kinds in rounds:
                self.lost.clear()
                try:
                    if (answer := ask()) is not None:
                        return answer
                except REFUSALS:
                    continue
            return None
        finally:
            ctx.prec, ctx.cap = before
            player.prove = check_rule

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
        if not any(fails(goal.relation, value) for value in sample) and not vanishes(goal):
            parts = sum(1 for _ in itertools.islice(subterms(goal.term), LONG + 1))
            self.tries -= parts // PARTS
            self.depth += 1
            try:
                kinds = EQUATIONS if goal.relation == "=" else SIGNS
                few = 1 if parts > LONG else self.kinds
                for room in itertools.chain(*kinds[:few]):
                    if self.leaves_out(room) or (room in BALLS and not self.affords_balls(room, key, goal)):
                        continue
                    for candidate in guard(room(goal, sample)):
                        if self.is_spent():
                            return None
                        self.tries -= 1
                        if self.plays(candidate, goal):
                            del self.lost[key]
                            self.found[key, goal.exists] = candidate
                            return candidate
                    if room in BALLS:
                        self.undecided.add((room, key))
                        self.tries -= count_cells(room, goal)
            finally:
                self.depth -= 1
        return None

    def affords_balls(self, room: Room, key: Any, goal: Any) -> bool:
        """Whether balls are new to a goal and take no more than what is left."""
        return self.balls and (room, key) not in self.undecided and count_cells(room, goal) <= self.tries

    def leaves_out(self, room: Room) -> bool:
        """Whether a room is not asked, because what it makes has been made already."""
        if room is forms.by_forms:
            return self.rules[-1:] == ["equal"]  # one form of a form is one of the first
        if room in (signs.by_squares, equations.by_equal_squares):
            return self.rules.count("squares") > 1
        if room is equations.by_empty_case:
            return "empty" in self.rules
        return room is equations.by_gradient and "derivative" in self.rules

    def is_spent(self) -> bool:
        """Whether nothing more is to be tried."""
        return self.tries <= 0 or time.process_time() > self.deadline

    def plays(self, candidate: Proof, goal: Any) -> bool:
        """Whether the rule of a candidate applies and its holes can be filled."""
        self.rules.append(candidate["rule"])
        try:
            check_rule(candidate, goal)
        except REFUSALS:
            return False
        finally:
            self.rules.pop()
        return True


def count_cells(room: Any, goal: Any) -> int:
    """The tries that a room of balls takes where it fails; a box without closed sides is one cell."""
    closed = any(None not in goal.box[name][:2] for name in player.symbols_of(goal.term))
    return (200 + room.keywords["cells"] if closed else 1) * sum(1 for _ in subterms(goal.term)) // PARTS_OF_CELLS


def guard(candidates: Iterator[Proof]) -> Iterator[Proof]:
    """The candidates of a room; one that fails while it thinks has no more."""
    try:
        yield from candidates
    except (NavsymError, player.Refused, ArithmeticError, ValueError, TypeError, AttributeError, NotImplementedError):
        return


def find_proof(goal: Any, seconds: float = SECONDS, rounds: Rounds = ROUNDS, balls: bool = True) -> Proof | None:
    """A proof of a goal of the checker as plain data, or None; it is still to be granted.

    balls : whether boxes may be divided into cells
    """
    search = Search(time.process_time() + seconds, balls)
    return plain(search.go_round(lambda: search.find(goal), rounds))


def find_filled(check: Callable[[], Any], seconds: float) -> Any:
    """What a check of the player returns when the search can fill the holes that it comes upon; else None."""
    return Search(time.process_time() + seconds).go_round(check, ROUNDS[1:3])


def plain(proof: Any) -> Any:
    """The same without the classes of holes; of signs, those that were asked for."""
    if isinstance(proof, dict):
        return {key: plain(value) for key, value in proof.items()}
    return [plain(value) for value in getattr(proof, "noted", proof)] if isinstance(proof, list) else proof


def rules_of(proof: Any) -> set[str]:
    """The names of the rules of a proof; a ball of one number is exact and has none."""
    if isinstance(proof, list):
        return set().union(*map(rules_of, proof))
    if not isinstance(proof, dict):
        return set()
    is_number = proof.get("rule") == "balls" and proof["cells"] == 1
    own = {proof["rule"]} if "rule" in proof and not is_number else set()
    return own.union(*map(rules_of, proof.values()))
