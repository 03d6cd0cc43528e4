"""An equation between matrices of any size as a sum of relations with words on both sides, for the rule ``words``.

Words, and words inside traces in every rotation, are reduced by a completion of the relations. What is left is 0 by the
algebra of numbers, or by hypotheses between numbers.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import Any

from flint import Ordering, fmpq, fmpq_mat, fmpq_mpoly_ctx

from navsym.core.rational_functions import Ratio, cancel_fraction
from navsym.prove.relations.cofactors import read_terms, write_polynomial
from navsym.prove.rooms.goals import Term, player, write_term
from navsym.prove.words.completion import Completion, complete

Word = tuple[tuple[str, bool], ...]
Share = dict[str, Any]
MOST_TRACES = 60
MOST_DEGREE = 4  # of a number in a symbol that is replaced


class Letters:
    """Words of the checker as texts of one character for each letter, and their numbers."""

    def __init__(self, algebra: Any, numbers: Sequence[Term]):
        self.algebra = algebra
        letters = [(name, turned) for name in algebra.sizes for turned in (False, True)]
        letters = [pair for pair in letters if not (pair[1] and pair[0] in algebra.symmetric)]
        # those in the place of sums come first, inverses last: the last ones are replaced
        letters.sort(key=lambda pair: 0 if pair[0].startswith("arg__") else 2 if pair[0].startswith("inv__") else 1)
        self.letters = letters
        self.signs = {pair: chr(0x100 + k) for k, pair in enumerate(letters)}
        numbers = [*numbers, *(c for r in algebra.relations for c in r.body.values())]
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


def find_shares(document: Any, end: float) -> list[Share] | None:
    """Shares of which the sum is the difference of the sides; None where none are found in time."""
    algebra = player.Words(document)
    _, x = algebra.state()
    x = x if isinstance(x, player.Typed) else player.Typed(1, 1, {(): x})
    scalars = find_scalars(algebra, x.body)
    if not scalars:
        return search_shares(algebra, x, (), end)
    for some, share in (((), 0.15), (scalars, 0.5), ((), 1.0)):
        now = time.process_time()
        shares = search_shares(algebra, x, some, now + (end - now) * share)
        if shares is not None:
            return shares
    return None


def find_above(document: Any) -> list[dict[str, Any]] | None:
    """The difference of an inequality as a sum of c trace(X) or c trace(X Y) with c > 0, X and Y nonnegative."""
    algebra = player.Words(document)
    relation, x = algebra.state()
    known = None if isinstance(x, player.Typed) else read_linear(x)
    if known is None or any(c * player.SIGNS[relation][0] < 0 or not name for name, c in known.items()):
        return None
    found = [(abs(c), find_factors(algebra, name)) for name, c in known.items()]
    if not all(texts for _, texts in found):
        return None
    return [{"coefficient": str(c), "matrices": texts} for c, texts in found]


def find_factors(algebra: Any, name: str) -> list[str]:
    """The texts of one or two nonnegative matrices of whose product a symbol is the trace; else none."""
    if not name.startswith("trace__"):
        return [f"eye({name})"] if name in algebra.dimensions else []
    ways = [(word[:k], word[k:]) for word in list_rotations(algebra, name) for k in range(len(word))]
    for parts in sorted(ways, key=lambda way: len(way[0])):
        texts = [" @ ".join(spell_letter(algebra, *letter) for letter in part) for part in parts if part]
        factors = [algebra.read(text) for text in texts]
        if all(isinstance(f, player.Typed) and f.known in ("positive", "nonnegative") for f in factors):
            return texts
    return []


def spell_letter(algebra: Any, name: str, turned: bool) -> str:
    """A letter as texts have it: the inverse of a name or of a sum."""
    if name.startswith("inv__"):
        return f"inv({spell_letter(algebra, algebra.inverses[name], False)})" + ".T" * turned
    body = next((body for body, own in algebra.arguments if own == name), None)
    if body is None:
        return name + ".T" * turned
    words = (" @ ".join(spell_letter(algebra, *letter) for letter in word) for word in body)
    return " + ".join(f"{write_term(c)}*({word})" for word, c in zip(words, body.values(), strict=True))


def search_shares(algebra: Any, x: Any, scalars: Sequence[tuple[Term, Word]], end: float) -> list[Share] | None:
    """The same with rules that take some numbers out of words; their steps are none of the certificate."""
    letters = Letters(algebra, [symbol for symbol, _ in scalars])
    places: list[int | None] = [k for k, r in enumerate(algebra.relations) if set(r[:2]) != {1}]
    sums = [algebra.relations[k].body for k in places]
    sums += [
        {word: player.ONE, own: player.negate(c)} for c, part in scalars for word, own in list_scaled(algebra, part)
    ]
    places += [None] * (len(sums) - len(places))
    given = [{letters.write(word): letters.to_field(c) for word, c in terms.items()} for terms in sums]
    tried, completion = 0, Completion(())
    for completion in complete(given, end):
        if 2 * len(completion.rules) >= 3 * tried:
            tried = len(completion.rules)
            shares = Settlement(letters, x, completion, places).settle()
            if shares is not None and is_defined(algebra, shares):
                return shares
    shares = Settlement(letters, x, completion, places).settle()
    return shares if shares is not None and is_defined(algebra, shares) else None


def is_defined(algebra: Any, shares: Sequence[Share]) -> bool:
    """Whether the numbers of all shares exist wherever the statement has a value."""
    try:
        for text in {share["coefficient"] for share in shares}:
            algebra.check_coefficient(player.parse(text))
    except player.Refused:
        return False
    return True


def read_linear(term: Term) -> dict[str, fmpq] | None:
    """The numbers before the symbols of a term, and the one without by no name; None where it is not linear."""
    parts = [*dict.fromkeys(player.list_generators(term))]
    ring = fmpq_mpoly_ctx.get([f"x{k}" for k in range(len(parts))], Ordering.degrevlex)
    top, bottom = player.to_quotient(term, dict(zip(parts, ring.gens(), strict=True)), ring)
    terms = read_terms(top)
    if bottom != 1 or any(sum(powers) > 1 for powers in terms) or any(part[0] != "symbol" for part in parts):
        return None
    return {"".join(p[1] for p, e in zip(parts, powers, strict=True) if e): c for powers, c in terms.items()}


def find_scalars(algebra: Any, body: dict[Word, Term]) -> list[tuple[Term, Word]]:
    """The numbers among the symbols of a difference and of hypotheses that are words with one row and one column."""
    terms = [*body.values(), *(c for r in algebra.relations if set(r[:2]) == {1} for c in r.body.values())]
    names = sorted(set().union(*map(player.symbols_of, terms)))
    words = ((name, next(list_rotations(algebra, name))) for name in names if name.startswith("trace__"))
    found = []
    for name, word in words:
        cut = next((k for k, letter in enumerate(word) if algebra.rows_of(letter) == 1), None)
        if cut is not None:
            found.append((("symbol", name), word[cut:] + word[:cut]))
    return found


def list_scaled(algebra: Any, part: Word) -> Iterator[tuple[Word, Word]]:
    """Words with a number among them, and what stands beside it: they differ by the number, in no words at all."""
    for own in (part, algebra.turn(part)):
        for name, (rows, columns) in algebra.sizes.items():
            if 1 in (rows, columns):
                column, row = ((name, rows == 1),), ((name, columns == 1),)
                yield column + own, column
                yield own + row, row


def list_rotations(algebra: Any, name: str) -> Iterator[Word]:
    """The words of which a symbol is the trace."""
    order = [*algebra.sizes]
    marks = name.removeprefix("trace__").split("_")
    word = tuple((order[int(mark.removesuffix("t"))], mark.endswith("t")) for mark in marks)
    for own in (word, algebra.turn(word)):
        for k in range(len(own)):
            yield own[k:] + own[:k]


class Settlement:
    """One try with the rules of a completion; ``shares`` is what was taken off the difference so far."""

    def __init__(self, letters: Letters, x: Any, completion: Completion, places: Sequence[int | None]):
        self.letters, self.algebra, self.x = letters, letters.algebra, x
        self.completion, self.places = completion, places
        self.body: dict[Word, Term] = dict(x.body)
        self.shares: list[Share] = []

    def settle(self) -> list[Share] | None:
        """The shares, where nothing is left."""
        for _ in range(3):
            before = dict(self.body)
            self.reduce_words()
            self.use_numbers()
            self.reduce_traces()
            if self.is_settled() or self.solve_traces():
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
        taken = self.completion.trace_back(steps).items()
        own = [(c, left, self.places[k], right) for (left, k, right), c in taken]
        return parts, [(self.letters.to_term(c), left, k, right) for c, left, k, right in own if k is not None]

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
                self.share(player.multiply_numbers(c, d), left, k, right, None)
        self.body = self.algebra.gather(pairs)

    def reduce_traces(self) -> None:
        """Traces by those of normal forms, in the rotation that leaves the least."""
        for name in sorted(set().union(*map(player.symbols_of, self.body.values()))):
            if not name.startswith("trace__"):
                continue
            ways = [way for way in map(self.normalise_trace, list_rotations(self.algebra, name)) if way is not None]
            if ways:
                value, taken = min(ways, key=lambda way: len(write_term(way[0])))
                self.replace(name, value, taken)

    def normalise_trace(self, word: Word) -> tuple[Term, list[tuple[Term, str, int, str]]] | None:
        found = self.normalise(word)
        if found is None:
            return None
        rows = self.algebra.rows_of(word[0])
        return self.algebra.trace(self.algebra.gather(found[0]), rows), found[1]

    def solve_traces(self) -> bool:
        """A number that is linear in traces, by linear algebra: every rotation of a word gives an equation."""
        wanted = read_linear(self.body.get((), player.ZERO)) if {*self.body} == {()} else None
        if wanted is None or self.letters.parts:
            return False
        waiting, known = sorted(wanted), set[str]()
        equations: list[tuple[dict[str, fmpq], list[tuple[Term, str, int, str]]]] = []
        while waiting and len(known) < MOST_TRACES:
            name = waiting.pop(0)
            if name in known or not name.startswith("trace__"):
                continue
            known.add(name)
            for way in map(self.normalise_trace, list_rotations(self.algebra, name)):
                value = None if way is None else read_linear(player.subtract(("symbol", name), way[0]))
                if way is not None and value:
                    equations.append((value, way[1]))
                    waiting += sorted(value)
        names = [*dict.fromkeys(name for row in (wanted, *(row for row, _ in equations)) for name in row)]
        columns = [row for row, _ in (*equations, (wanted, []))]
        reduced, rank = fmpq_mat([[row.get(name, fmpq(0)) for row in columns] for name in names]).rref()
        pivots = [next(j for j in range(len(columns)) if reduced[i, j] != 0) for i in range(rank)]
        if len(equations) in pivots:
            return False
        for i, pivot in enumerate(pivots):
            for c, left, k, right in equations[pivot][1]:
                self.share(player.multiply_numbers(player.number(reduced[i, len(equations)]), c), left, k, right, ())
        return True

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
