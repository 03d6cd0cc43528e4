"""Answers of the questions in a statement, with the proofs that their rules ask for.

A candidate comes from :mod:`navsym.prove.calculus.candidates` with holes for proofs. The player plays the rule of the
checker on it, and the search fills the holes; what the rule refuses is no answer.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import chain, islice
from typing import Any

from flint import ctx

from navsym.prove.calculus import candidates
from navsym.prove.calculus.candidates import Signs, guess_integrals, list_candidates
from navsym.prove.grant import BITS, REFUSALS, Document
from navsym.prove.rooms.goals import Hole, player, values_of
from navsym.prove.search import SECONDS, find_filled, plain

MOST_CANDIDATES = 16  # of one question; formulas of textbooks need three
TROUBLE = (*REFUSALS, *candidates.TROUBLE)
MOST_POINTS = 3


def guess_sign(c: Any, signs: Any, goal: Any) -> int:
    """The sign of a number at sample points, noted with its proof; what a rule asks the player."""
    if isinstance(signs, Signs) and player.symbols_of(c):
        values = values_of(goal, c)
        entry = [1 if values and all(value > 0 for value in values) else -1, Hole()]
        signs.noted.append(entry)
        return take_sign(c, [entry], goal)
    return take_sign(c, signs, goal)


take_sign, player.ask_sign = player.ask_sign, guess_sign


class Search(player.Answers):  # type: ignore[misc,name-defined]
    """Answers that are sought when they are asked for; those that were found stay for the next case."""

    def __init__(self, point: Mapping[str, Any] | None = None, seconds: float = SECONDS, sides: Sequence[str] = ()):
        super().__init__([], None if point is None else dict(point))
        self.sides = sides
        self.deadline, self.found, self.known = time.process_time() + seconds, list[Any](), dict[Any, Any]()

    def settle(self, question: Any, goal: Any) -> Any:
        """The value of a question with the first candidate that its rule accepts."""
        key = (question._replace(value=""), goal.exists, goal.given, goal.zeros, tuple(sorted(goal.box.items())))
        if key not in self.known:
            self.known[key] = self.seek(question, goal)
        found = self.known[key]
        player.require(found is not None, f"no closed form of the {question.kind} was found")
        self.found.append(found[0])
        return found[1]

    def seek(self, question: Any, goal: Any) -> tuple[Any, Any] | None:
        """The first answer and its value."""
        try:
            guesses = guess_integrals(question, self.sides) if question.kind == "integral" else ()
            for make in chain(guesses, islice(list_candidates(question, goal), MOST_CANDIDATES)):
                found = play(make, question, goal, self.deadline - time.process_time())
                if found is not None:
                    return found
        except TROUBLE:
            pass
        return None


def play(make: Callable[[], Any], question: Any, goal: Any, seconds: float) -> tuple[Any, Any] | None:
    """A candidate with its holes filled, and the value that its rule gives."""
    tried: list[Any] = []

    def check() -> Any:
        tried.append(make())
        return player.ANSWERS[question.kind](tried[-1], question, goal)

    value = find_filled(check, seconds)
    return None if value is None else (plain(tried[-1]), value)


def read_with_answers(document: Document, point: Mapping[str, Any] | None = None, seconds: float = SECONDS) -> Any:
    """The cases of a statement, its box and the answers of its questions; raises Refused."""
    answers = Search(point, seconds, [document["left"], document["right"]])
    with at_precision():
        cases, box = player.read_statement(document, answers)
    return cases, box, answers.found


def settle_entries(reader: Any, entries: Iterable[Any], box: Mapping[str, Any]) -> list[Any]:
    """The terms that a reader has read, with the values of the questions in them; raises Refused."""
    with at_precision():
        goals = player.settle_questions(reader, [(entry, "=", (entry,)) for entry in entries], box, Search())
    return [term for term, _, _ in goals]


@contextmanager
def at_precision() -> Iterator[None]:
    """The precision at which the checker will read."""
    before, ctx.prec = ctx.prec, BITS[0]
    try:
        yield
    finally:
        ctx.prec = before
