"""Sums of words modulo relations: a noncommutative Groebner basis of bounded degree, with cofactors.

A word is a text of one character for each letter. Words are compared by their length, then as texts. Two relations
whose leading words overlap give a new one (Mora, An introduction to commutative and noncommutative Groebner bases,
1994); the process need not end, so that time and the length of overlaps are bounded. Every relation remembers of
which others it was made: a sum that reduces to 0 is a sum of ``c left relation right``.
"""

from __future__ import annotations

import heapq
import re
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

Sum = dict[str, Any]  # word -> number, which is not 0
Step = tuple[Any, str, int, str]  # number, left word, relation, right word: all that is subtracted

MOST_LETTERS = 14  # of an overlap
MOST_TERMS = 400


def order(word: str) -> tuple[int, str]:
    return len(word), word


@dataclass(slots=True)
class Rule:
    """A relation with leading number 1, and the steps of which it is the sum."""

    lead: str
    terms: Sum
    steps: list[Step]
    is_active: bool = True


class Completion:
    """Relations that are made complete step by step.

    given : sums that are 0; a step names one by its place, and a rule by its place behind all of them
    """

    def __init__(self, given: Sequence[Sum]):
        self.count = len(given)
        self.rules: list[Rule] = []
        self.pattern: re.Pattern[str] | None = None
        self.places: dict[str, int] = {}
        self.waiting: list[tuple[tuple[int, str], int, Sum, list[Step]]] = []
        self.number = 0
        for k, terms in enumerate(given):
            self.wait(max(terms, key=order, default=""), dict(terms), [(1, "", k, "")])

    def wait(self, word: str, terms: Sum, steps: list[Step]) -> None:
        """Put a sum that is 0 in the queue, short overlaps first."""
        self.number += 1
        if len(word) <= MOST_LETTERS:
            heapq.heappush(self.waiting, (order(word), self.number, terms, steps))

    def reduce(self, terms: Sum) -> tuple[Sum, list[Step]]:
        """What is left of a sum, and the steps that were subtracted."""
        rest, done, steps = dict(terms), Sum(), list[Step]()
        while rest:
            word = max(rest, key=order)
            c = rest.pop(word)
            found = self.pattern.search(word) if self.pattern else None
            if found is None:
                done[word] = c
                continue
            place = self.places[found[0]]
            left, right = word[: found.start()], word[found.end() :]
            add_multiple(rest, -c, left, self.rules[place].terms, right, self.rules[place].lead)
            steps.append((c, left, self.count + place, right))
        return done, steps

    def advance(self) -> bool:
        """Reduce the next sum of the queue and note what is left; whether there was one."""
        if not self.waiting:
            return False
        _, _, terms, steps = heapq.heappop(self.waiting)
        rest, taken = self.reduce(terms)
        if rest and len(rest) <= MOST_TERMS and max(rest, key=order) != "":
            self.note(rest, [*steps, *((-c, left, k, right) for c, left, k, right in taken)])
        return True

    def note(self, rest: Sum, steps: list[Step]) -> None:
        """A new rule, and its overlaps with all others; rules whose leading word it divides are reduced again."""
        lead = max(rest, key=order)
        c = rest[lead]
        if c != 1:
            rest = {word: d / c for word, d in rest.items()}
            steps = [(d / c, left, k, right) for d, left, k, right in steps]
        place, own = len(self.rules), Rule(lead, rest, steps)
        self.rules.append(own)
        for k, rule in enumerate(self.rules[:-1]):
            if rule.is_active and lead in rule.lead:
                rule.is_active = False
                self.wait(rule.lead, dict(rule.terms), [(1, "", self.count + k, "")])
        for k, rule in enumerate(self.rules):
            if rule.is_active:
                self.overlap(k, place)
                if k != place:
                    self.overlap(place, k)
        active = [rule.lead for rule in self.rules if rule.is_active]
        self.places = {rule.lead: k for k, rule in enumerate(self.rules) if rule.is_active}
        self.pattern = re.compile("|".join(map(re.escape, sorted(active, key=len))))

    def overlap(self, i: int, j: int) -> None:
        """The end of the first leading word is the beginning of the second one."""
        first, second = self.rules[i], self.rules[j]
        for size in range(1, min(len(first.lead), len(second.lead))):
            if first.lead.endswith(second.lead[:size]):
                left, right = first.lead[:-size], second.lead[size:]
                terms = {word + right: c for word, c in first.terms.items()}
                add_multiple(terms, -1, left, second.terms, "")
                steps: list[Step] = [(1, "", self.count + i, right), (-1, left, self.count + j, "")]
                self.wait(first.lead + right, terms, steps)

    def trace_back(self, steps: Sequence[Step]) -> dict[tuple[str, int, str], Any]:
        """The same sum by the given relations alone: (left word, relation, right word) -> number."""
        total: dict[tuple[int, str, str], Any] = {}
        for c, left, k, right in steps:
            add_to(total, (k, left, right), c)
        while total and (k := max(total)[0]) >= self.count:
            for key in [key for key in total if key[0] == k]:
                c, (_, left, right) = total.pop(key), key
                for d, before, own, behind in self.rules[k - self.count].steps:
                    add_to(total, (own, left + before, behind + right), c * d)
        return {(left, k, right): c for (k, left, right), c in total.items()}


def add_to(total: dict[Any, Any], key: Any, c: Any) -> None:
    """Add to one number of a sum, which has no zeros."""
    value = total.get(key, 0) + c
    if value == 0:
        total.pop(key, None)
    else:
        total[key] = value


def add_multiple(
    total: Sum, c: Any, left: str, terms: Mapping[str, Any], right: str, besides: str | None = None
) -> None:
    """Add c left terms right, but for one word of the terms."""
    for word, d in terms.items():
        if word != besides:
            add_to(total, left + word + right, c * d)


def complete(given: Sequence[Sum], end: float) -> Iterator[Completion]:
    """The completion after each new rule, until nothing is left to do or the time is over."""
    completion, known = Completion(given), -1
    while time.process_time() < end:
        if len(completion.rules) != known:
            known = len(completion.rules)
            yield completion
        if not completion.advance():
            return
