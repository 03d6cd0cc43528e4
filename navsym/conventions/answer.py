"""The conventions of a model: :func:`find_conventions`, its answer and document."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from fractions import Fraction
from typing import Any

from navsym.claims.verdict import PROVED, REFUTED
from navsym.conventions.card import HALF, Card
from navsym.conventions.converting import Conversion, convert
from navsym.conventions.generating import list_missing
from navsym.conventions.measuring import RESET_MARK
from navsym.conventions.points import BITS
from navsym.conventions.proof import Prover
from navsym.conventions.reading import HIDDEN, Problem, matrix_of, print_matrix
from navsym.conventions.search import (
    SIGNS,
    Block,
    Comparison,
    Mismatch,
    Outcome,
    find_candidates,
    find_nearest,
    list_blocks,
    plain_card,
)
from navsym.core.answers import Answer
from navsym.core.balls import precision
from navsym.core.errors import DomainError

FEW = 30  # nearest cards of which one is looked for whose mends have names in the file


@dataclass(frozen=True, slots=True)
class Conflict:
    """A block that must change.

    block, entries : its sides, and the entries that differ, from 1
    change, status : the mended rows, and how it is known that they differ
    places         : of a matrix of source code, where the entries are assigned
    """

    block: tuple[str, str]
    entries: tuple[tuple[int, int], ...]
    change: str
    status: str
    matrix: str = "F"
    places: tuple[str, ...] = ()

    def document(self) -> dict[str, Any]:
        """The conflict as JSON data."""
        entries = [list(entry) for entry in self.entries]
        words = {"change": self.change, "status": self.status, "matrix": self.matrix}
        places = {"places": list(self.places)} if self.places else {}
        return {"block": list(self.block), "entries": entries, **words, **places}


@dataclass(frozen=True, slots=True)
class Exclusion:
    """A card that differs from one of the answer in one field, an entry of F that excludes it, and a point."""

    card: Card
    field: str
    block: tuple[str, str] | None
    entry: tuple[int, int] | None
    point: Mapping[str, str]
    why: str

    def document(self) -> dict[str, Any]:
        """The exclusion as JSON data."""
        sides = {"block": self.block and list(self.block), "entry": self.entry and list(self.entry)}
        return {**asdict(self), "card": self.card.document(), **sides}


@dataclass(frozen=True, slots=True, eq=False)
class Conventions(Answer):
    """All cards under which a model is right, or the fewest blocks that must change.

    cards        : every :class:`Card` whose error dynamics are those of the model
    complete     : True where each card is proved and each other one excluded at an exact point
    conflicts    : with no card: the blocks that must change for ``nearest``, one of the cards that ask for the fewest
    alternatives : other sets of as few blocks
    excluded     : the neighbours of the cards, with what excludes them; ``examined`` counts all cards
    unused       : tables of the file that say nothing about the error dynamics, and states without a role
    problem      : the model and what was said about it
    undecided    : cards that no point excludes and that are not proved; they are none of ``cards``
    proofs       : certificates of the entries that agree with a card or differ from it; ``navsym check`` replays them

    >>> import navsym as nav
    >>> found = nav.conventions("examples/conventions.toml")
    >>> [card.error for card in found.cards], found.complete
    (['estimate - truth', 'truth - estimate'], True)
    """

    name: str
    cards: tuple[Card, ...]
    complete: bool
    conflicts: tuple[Conflict, ...]
    nearest: Card | None
    alternatives: tuple[tuple[tuple[str, str], ...], ...]
    excluded: tuple[Exclusion, ...]
    examined: int
    unused: tuple[str, ...]
    problem: Problem
    undecided: tuple[Card, ...] = ()
    proofs: tuple[Mapping[str, Any], ...] = ()

    def convert(
        self, card: Card | None = None, progress: Callable[[int, int], None] = lambda done, of: None, **changes: str
    ) -> Conversion:
        """The model in the errors of another card: T, F, H and G, proved on the text of the model.

        card     : one of ``cards``; the first one unless it is given, which is that of the file where it has one
        progress : called with (steps done, all steps)
        changes  : fields that define the errors, such as ``attitude_error="frame"``: also error, rotation_sign,
                   attitude_size, bias_sign, angle, position_error, vector_error; everything else stays

        Raises DomainError for another field, for a model without a card or with dropped blocks.

        >>> import navsym as nav
        >>> found = nav.conventions("examples/conventions.toml")
        >>> found.convert(attitude_error="body").T[3][3:6]
        ('c11', 'c21', 'c31')
        """
        if not callable(progress):
            raise DomainError(f"expected a function of two numbers; got {progress!r}; leave it out", where="progress")
        if not self.cards or (card is not None and card not in self.cards):
            message = "expected a card of the model; got none; mend the conflicts first, or take one of cards"
            raise DomainError(message, where="convert: card")
        return convert(self.problem, card or self.cards[0], changes, progress)

    def model(self) -> dict[str, Any]:
        """F, and H, G and reset where there are any, as the table [model] of a file.

        >>> import navsym as nav
        >>> nav.conventions("examples/card.toml").model()["F"][0][3:6]
        ['0', '-f3', 'f2']
        """
        names = [name for name in ("F", "H", "G", "reset") if getattr(self.problem, name)]
        matrices = {name: print_matrix(getattr(self.problem, name)) for name in names}
        return {"name": self.name, "states": list(self.problem.states), **matrices}

    def units(self) -> dict[str, str]:
        """The units of the states, and of the quantities that have a name, under the first card or the nearest.

        >>> import navsym as nav
        >>> units = nav.conventions("examples/card.toml").units()
        >>> units["dv1"], units["bg1"], units["f1"]
        ('m/s', 'rad/s', 'm/s^2')
        """
        card = self.cards[0] if self.cards else self.nearest
        return {} if card is None else self.problem.units(card)

    def certificates(self) -> list[Mapping[str, Any]]:
        """The certificates of single entries; that a card has these entries is derived, not certified."""
        return [*self.proofs]

    def latex(self) -> str:
        r"""The first card, or the nearest one, and F in LaTeX, block by block.

        >>> import navsym as nav
        >>> print(nav.conventions("examples/conventions.toml").latex().splitlines()[2])
        \delta v = \hat v - v \\
        """
        from navsym.conventions.typeset import model_latex

        card = self.cards[0] if self.cards else self.nearest
        return "" if card is None else model_latex(self.problem, card, {"F": print_matrix(self.problem.F)}, card)

    def _repr_latex_(self) -> str:
        return rf"$\displaystyle {self.latex()}$"

    def document(self) -> dict[str, Any]:
        """The answer as plain data: the JSON document of the verb."""
        return {
            "cards": [card.document() for card in self.cards],
            "complete": self.complete,
            "undecided": [card.document() for card in self.undecided],
            "conflicts": [conflict.document() for conflict in self.conflicts],
            "nearest": None if self.nearest is None else self.nearest.document(),
            "alternatives": [[list(block) for block in blocks] for blocks in self.alternatives],
            "excluded": [exclusion.document() for exclusion in self.excluded],
            "examined": self.examined,
            "unused": list(self.unused),
            "model": self.model(),
            "units": self.units(),
        }

    def __repr__(self) -> str:
        if self.cards:
            first = self.cards[0]
            words = ", ".join(str(w) for w in (first.frame, first.axes, first.error, first.angle) if w)
            more = f" and {len(self.cards) - 1} more" if len(self.cards) > 1 else ""
            return f"Conventions({self.name}: {words}{more})"
        if self.undecided:
            return f"Conventions({self.name}: no card is proved, {len(self.undecided)} are undecided)"
        blocks = "; ".join(" by ".join(conflict.block) for conflict in self.conflicts)
        return f"Conventions({self.name}: no card; change {blocks})"


def find_conventions(problem: Problem) -> Conventions:
    """All cards under which a model is right, or with none the fewest blocks that must change.

    For each card the error equations are derived from the nonlinear mechanisation, to first order along the true flow,
    and compared with F block by block: by the prover where they agree, at an exact point where they differ.
    """
    prover, comparison = Prover(problem), Comparison(problem)
    findings = find_candidates(problem, comparison)
    proved = {card: is_card_proved(card, comparison, prover) for card in findings.candidates}
    cards = tuple(card for card in findings.candidates if proved[card])
    undecided = tuple(card for card in findings.candidates if not proved[card])
    conflicts: tuple[Conflict, ...] = ()
    nearest: Card | None = None
    alternatives: tuple[tuple[Block, ...], ...] = ()
    if not findings.candidates:
        require_possible(findings.excluded)
        outcomes = sorted(find_nearest(problem, comparison), key=rank_outcome)
        if outcomes:
            best = next((outcome for outcome in outcomes[:FEW] if has_names(outcome, prover)), outcomes[0])
            nearest, mismatches = best.card, best.mismatches
            conflicts = tuple(state_conflict(best, m, comparison, prover) for m in mismatches)
            sets = dict.fromkeys(tuple(m.block for m in outcome.mismatches) for outcome in [best, *outcomes])
            alternatives = tuple(sets)[1:]
    examined = len(findings.candidates) + sum(outcome.count for outcome in findings.excluded)
    excluded = tuple(find_neighbours(cards, findings.excluded, comparison))
    said = cards, not undecided, conflicts, nearest, alternatives, excluded, examined
    return Conventions(problem.name, *said, problem.unused, problem, undecided, tuple(prover.certificates))


def require_possible(excluded: Sequence[Outcome]) -> None:
    """Refuse quantities that contradict each other under every card."""
    reasons = dict.fromkeys(outcome.impossible for outcome in excluded)
    if reasons and all(reasons):
        message = f"expected quantities that a card may have; got a contradiction in {', '.join(reasons)}; correct them"
        raise DomainError(message, where="conventions: quantities")


def is_card_proved(card: Card, comparison: Comparison, prover: Prover) -> bool:
    """True where the prover grants every block of the card that is not dropped."""
    plain = plain_card(card)
    with precision(BITS):
        signs = {block: comparison.block_sign(card, block) for block in list_blocks(prover.problem)}
    return all(prover.is_right(plain, block, sign) for block, sign in signs.items() if block not in card.dropped)


def rank_outcome(outcome: Outcome) -> tuple[Any, ...]:
    """Order of the cards that ask for as few changes: blocks of biases before others, fewest entries, plain errors."""
    entries = sum(len(m.entries) for m in outcome.mismatches)
    biased = -sum(m.block == ("velocity", "accelerometer_bias") for m in outcome.mismatches)
    gyros = -sum(m.block == ("attitude", "gyro_bias") for m in outcome.mismatches)
    card = outcome.card
    plain = card.vector_error != "difference", card.attitude_size == HALF, card.error != "estimate - truth"
    return biased, gyros, entries, len(card.dropped), *plain


def has_names(outcome: Outcome, prover: Prover) -> bool:
    """True where the file names all quantities in the blocks of the card that must change."""
    blocks = (
        prover.block_texts(plain_card(outcome.card), mismatch.block, Fraction(1)) for mismatch in outcome.mismatches
    )
    return not any(list_missing(block) for block in blocks)


def state_conflict(outcome: Outcome, mismatch: Mismatch, comparison: Comparison, prover: Prover) -> Conflict:
    """The change of one block, with the checker's word that the entries differ."""
    card, block = outcome.card, mismatch.block
    rows, columns = (prover.problem.places(side) for side in block)
    with precision(BITS):
        sign = comparison.block_sign(card, block)
    ways = (prover.block_texts(plain_card(card), block, sign, rates) for rates in (True, False))
    expected = min(ways, key=lambda rows: (HIDDEN in repr(rows), len(repr(rows))))
    written = print_matrix(prover.problem.block(*block))
    places = [(rows.index(i), columns.index(j)) for i, j in mismatch.entries]
    verdicts = (prover.compare(plain_card(card), written[i][j], expected[i][j]).status for i, j in places)
    granted = all(status == REFUTED for status in verdicts)  # with a point of the relations at which they differ
    entries = tuple((i + 1, j + 1) for i, j in mismatch.entries)
    order = [sorted(range(len(side)), key=side.__getitem__) for side in (rows, columns)]
    change = describe_change(written, expected, prover, card, "1 + " * (block[0] == RESET_MARK + block[1]), order)
    return Conflict(block, entries, change, "PROVED" if granted else "OPEN", matrix_of(block))


def describe_change(
    written: list[list[str]],
    expected: list[list[str]],
    prover: Prover,
    card: Card,
    diagonal: str,
    order: list[list[int]],
) -> str:
    """The change in words where it is a sign or a transposition, and the mended rows.

    diagonal : what stands before the diagonal of the rows, a unit for the reset
    order    : of rows and columns, as they stand in the matrix
    """

    def agrees(sign: str, turned: bool) -> bool:
        if turned and len(written) != 3:
            return False
        rows = [*zip(*written, strict=True)] if turned else written
        pairs = ((f"{sign}({rows[i][j]})", expected[i][j]) for i in range(len(rows)) for j in range(3))
        return all(prover.compare(plain_card(card), *pair).status == PROVED for pair in pairs)

    ways = ("-", False, "change the sign"), ("", True, "transpose"), ("-", True, "transpose and change the sign")
    words = next((f"{text}: write" for sign, turned, text in ways if agrees(sign, turned)), "write")
    rows = [[diagonal * (i == j) + x for j, x in enumerate(row)] for i, row in enumerate(expected)]
    rows = [[rows[i][j] for j in order[1]] for i in order[0]]
    lacking = list_missing(rows).items()
    missing = "".join(f"; {HIDDEN}{name} is {word}, which [quantities] lacks" for name, word in lacking)
    return f"{words} [{', '.join('[' + ', '.join(row) + ']' for row in rows)}]".replace("1 + 0", "1") + missing


def find_neighbours(cards: Sequence[Card], outcomes: Sequence[Outcome], comparison: Comparison) -> list[Exclusion]:
    """Excluded cards that differ from one of the answer in one field; each once."""
    neighbours: dict[Card, Exclusion] = {}
    names = [f.name for f in fields(Card) if f.name != "dropped"]
    for outcome in outcomes:
        for card in cards:
            signs: dict[str, Any] = {} if outcome.count == 1 else {k: getattr(card, k) for k in SIGNS}
            other = replace(outcome.card, **signs)
            different = [name for name in names if getattr(card, name) != getattr(other, name)]
            if len(different) == 1 and other not in neighbours:
                neighbours[other] = exclude(replace(outcome, card=other), different[0], comparison)
    return list(neighbours.values())


def exclude(outcome: Outcome, name: str, comparison: Comparison) -> Exclusion:
    """Why a card is excluded."""
    card = outcome.card
    if outcome.impossible:
        why = f"{outcome.impossible} contradicts the other quantities"
        return Exclusion(card, name, None, None, {}, why)
    mismatch = outcome.mismatches[0]
    i, j = mismatch.entries[0]
    point, written, expected = comparison.show(card, mismatch.block, mismatch.entries[0], mismatch.point)
    why = f"{matrix_of(mismatch.block)}[{i + 1},{j + 1}] is {written}, and {expected} for this card"
    return Exclusion(card, name, mismatch.block, (i + 1, j + 1), point, why)
