"""An equation between matrices of any size as a sum of relations with words on both sides: what the rule ``words`` takes.

Words, and words inside traces in every rotation, are reduced by a completion of the relations. What is left is 0 by the
algebra of numbers, or by hypotheses between numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from flint import Ordering, fmpq, fmpq_mpoly_ctx

from navsym.core.rational_functions import Quotient, add_fractions, cancel_fraction, multiply_fractions
from navsym.prove.relations.cofactors import read_terms, write_polynomial
from navsym.prove.rooms.goals import Term, player, write_term
from navsym.prove.words.completion import Completion, complete

Word = tuple[tuple[str, bool], ...]
Share = dict[str, Any]
MOST_DEGREE = 4  # of a number in a symbol that is replaced


class Ratio:
    """A rational function of numbers of the statement."""

    __slots__ = ("quotient",)

    def __init__(self, quotient: Quotient):
        self.quotient = quotient

    def __add__(self, other: Any) -> Ratio:
        return self if other == 0 else Ratio(add_fractions(self.quotient, other.quotient))

    __radd__ = __add__

    def __mul__(self, other: Any) -> Ratio:
        if isinstance(other, Ratio):
            return Ratio(multiply_fractions(self.quotient, other.quotient))
        return Ratio(Quotient(self.quotient.top * other, self.quotient.bottom))

    __rmul__ = __mul__

    def __neg__(self) -> Ratio:
        return self * -1

    def __truediv__(self, other: Any) -> Ratio:
        return self * Ratio(cancel_fraction(other.quotient.bottom, other.quotient.top))

    def __rtruediv__(self, other: Any) -> Ratio:
        return Ratio(cancel_fraction(self.quotient.bottom, self.quotient.top)) * other

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Ratio):
            return self.quotient == other.quotient
        return bool(self.quotient.top == other and self.quotient.bottom == 1)

    __hash__ = None  # type: ignore[assignment]


class Letters:
    """Words of the checker as texts of one character for each letter, and their numbers."""

    def __init__(self, algebra: Any):
        self.algebra = algebra
        letters = [(name, turned) for name in algebra.sizes for turned in (False, True)]
        letters = [pair for pair in letters if not (pair[1] and pair[0] in algebra.symmetric)]
        letters.sort(key=lambda pair: rank_letter(pair[0]))
        self.letters = letters
        self.signs = {pair: chr(0x100 + k) for k, pair in enumerate(letters)}
        numbers = [c for r in algebra.relations for c in r.body.values()]
        self.parts = [*dict.fromkeys(g for c in numbers for g in player.list_generators(c))]
        self.ring = fmpq_mpoly_ctx.get([f"x{k}" for k in range(len(self.parts))], Ordering.degrevlex)
        self.generators = dict(zip(self.parts, self.ring.gens(), strict=True))

    def write(self, word: Word) -> str:
        return "".join(self.signs[letter] for letter in word)

    def read(self, text: str) -> Word:
        return tuple(self.letters[ord(sign) - 0x100] for sign in text)

    def spell(self, text: str) -> str:
        """A word as certificates have it."""
        return " ".join(name + ".T" * turned for name, turned in self.read(text))

    def to_field(self, c: Term) -> Any:
        if not self.parts:
            return player.constant_of(c)
        return Ratio(cancel_fraction(*player.to_quotient(c, self.generators, self.ring)))

    def to_term(self, c: Any) -> Term:
        if not isinstance(c, Ratio):
            return player.number(c)
        top, bottom = (player.parse(write_polynomial(read_terms(p), self.parts) or "0") for p in c.quotient)
        return top if bottom == player.ONE else player.multiply_terms(top, ("^", bottom, player.MINUS_ONE))


def rank_letter(name: str) -> int:
    """Letters in the place of sums come first, inverses last: the last ones are replaced."""
    return 0 if name.startswith("arg__") else 2 if name.startswith("inv__") else 1


def find_shares(document: Any, end: float) -> list[Share] | None:
    """Shares of which the sum is the difference of the sides; None where none are found in time."""
    algebra = player.Words(document)
    _, x = algebra.state()
    x = x if isinstance(x, player.Typed) else player.Typed(1, 1, {(): x})
    letters = Letters(algebra)
    places = [k for k, r in enumerate(algebra.relations) if set(r[:2]) != {1}]
    given = [
        {letters.write(word): letters.to_field(c) for word, c in algebra.relations[k].body.items()} for k in places
    ]
    tried = -1
    for completion in complete(given, end):
        if len(completion.rules) < 3 * tried // 2:
            continue
        tried = len(completion.rules)
        shares = Settlement(letters, x, completion, places).settle()
        if shares is not None:
            return shares
    return Settlement(letters, x, completion, places).settle() if len(completion.rules) != tried else None


class Settlement:
    """One try with the rules of a completion; ``shares`` is what was taken off the difference so far."""

    def __init__(self, letters: Letters, x: Any, completion: Completion, places: Sequence[int]):
        self.letters, self.algebra, self.x = letters, letters.algebra, x
        self.completion, self.places = completion, places
        self.body: dict[Word, Term] = dict(x.body)
        self.shares: list[Share] = []

    def settle(self) -> list[Share] | None:
        """The shares, where nothing is left."""
        for _ in range(3):
            before = dict(self.body)
            self.reduce_words()
            self.reduce_traces()
            self.use_numbers()
            if self.is_settled():
                return self.shares
            if self.body == before:
                return None
        return None

    def is_settled(self) -> bool:
        return all(player.is_identity(c) for c in self.body.values())

    def normalise(self, word: Word) -> tuple[list[tuple[Word, Term]], list[tuple[Term, str, int, str]]] | None:
        """What a word is equal to, and the relations for it; None for a word that is reduced."""
        rest, steps = self.completion.reduce({self.letters.write(word): 1})
        if not steps:
            return None
        parts = [(self.letters.read(text), self.letters.to_term(c)) for text, c in rest.items()]
        taken = self.completion.trace_back(steps)
        return parts, [(self.letters.to_term(c), left, k, right) for (left, k, right), c in taken.items()]

    def share(self, c: Term, left: str, k: int, right: str, word: Word | None) -> None:
        spell = self.letters.spell
        factor = None if word is None else spell(self.letters.write(word))
        share = {"coefficient": write_term(c), "left": spell(left), "right": spell(right)}
        self.shares.append({**share, "relation": k, "word": factor})

    def reduce_words(self) -> None:
        """The words of the difference by their normal forms."""
        pairs: list[tuple[Word, Term]] = []
        for word, c in self.body.items():
            found = self.normalise(word)
            if found is None:
                pairs.append((word, c))
                continue
            pairs += [(own, player.multiply_numbers(c, d)) for own, d in found[0]]
            for d, left, k, right in found[1]:
                self.share(player.multiply_numbers(c, d), left, self.places[k], right, None)
        self.body = self.algebra.gather(pairs)

    def reduce_traces(self) -> None:
        """Traces by those of normal forms, in the rotation that leaves the least."""
        for name in sorted(set().union(*map(player.symbols_of, self.body.values()))):
            if not name.startswith("trace__"):
                continue
            ways = [way for way in map(self.normalise_trace, self.list_rotations(name)) if way is not None]
            if ways:
                value, taken = min(ways, key=lambda way: len(write_term(way[0])))
                self.replace(name, value, [(c, left, self.places[k], right) for c, left, k, right in taken])

    def list_rotations(self, name: str) -> Iterator[Word]:
        order = [*self.algebra.sizes]
        marks = name.removeprefix("trace__").split("_")
        word = tuple((order[int(mark.removesuffix("t"))], mark.endswith("t")) for mark in marks)
        for own in (word, self.algebra.turn(word)):
            for k in range(len(own)):
                yield own[k:] + own[:k]

    def normalise_trace(self, word: Word) -> tuple[Term, list[tuple[Term, str, int, str]]] | None:
        found = self.normalise(word)
        if found is None:
            return None
        rows = self.algebra.rows_of(word[0])
        return self.algebra.trace(self.algebra.gather(found[0]), rows), found[1]

    def use_numbers(self) -> None:
        """Hypotheses between numbers give one of their symbols by the others."""
        for k, r in enumerate(self.algebra.relations):
            if set(r[:2]) != {1}:
                continue
            (term,) = r.body.values()
            for name in sorted(player.symbols_of(term), reverse=True):
                slope = player.differentiate(term, name)
                if slope[0] == "number" and slope != player.ZERO:
                    inverse = ("^", slope, player.MINUS_ONE)
                    value = player.subtract(("symbol", name), ("*", inverse, term))
                    own = player.substitute(value, {name: player.ZERO})
                    self.replace(name, own, [(inverse, "", k, "")])
                    break

    def replace(self, name: str, value: Term, taken: Sequence[tuple[Term, str, int, str]]) -> None:
        """One symbol by what it is equal to: f(s) - f(u) = (s - u) e(s, u) for a polynomial f."""
        step = player.subtract(("symbol", name), value)
        for word, c in [*self.body.items()]:
            if name not in player.symbols_of(c):
                continue
            slopes = [c]
            while len(slopes) <= MOST_DEGREE and name in player.symbols_of(slopes[-1]):
                slopes.append(player.differentiate(slopes[-1], name))
            if name in player.symbols_of(slopes[-1]):
                continue
            parts, factor = [], player.ONE  # Taylor's formula for f(s) - f(s - h), over h
            for j, slope in enumerate(slopes[1:], 1):
                parts.append(player.multiply_terms(factor, slope))
                factor = ("*", factor, player.negate(step), player.number(fmpq(1, j + 1)))
            quotient = player.add_terms(parts)
            self.body[word] = player.substitute(c, {name: value})
            for d, left, k, right in taken:
                self.share(player.multiply_numbers(quotient, d), left, k, right, word)
